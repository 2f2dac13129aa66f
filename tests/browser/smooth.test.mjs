// The page stays smooth while a large model is read and refined: no task of its main thread over 50 ms, and orbiting
// goes on. Best of three, because other programs run on a test machine as well.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { basename } from "node:path";
import { cmd, drop, launch, ready, serveSite, state, tidy, visit } from "./harness.mjs";
import { largeObj } from "./models.mjs";

/** Two triangles a square: 708 squares a side make a little over a million. */
const SIDE = 708;
/** The longest task that is allowed, milliseconds. */
const LONGEST = 50;
/** Different views that are drawn while the engine works; few, because drawing this model in software takes
 * seconds, and all the work no more than three. */
const TURNS = 2;

describe("a million triangles", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {string} */ let model;
  before(async () => {
    site = await serveSite();
    browser = await launch();
    model = await largeObj(SIDE);
  });
  after(async () => {
    await browser?.close();
    site?.close();
    await tidy();
  });

  test("are read and refined while the page stays smooth and the model turns", { timeout: 600_000 }, async () => {
    /** @type {{ longest: number, turns: number, seconds: number }[]} */
    const runs = [];
    for (let run = 0; run < 3; run += 1) {
      runs.push(await once());
      const last = runs.at(-1);
      console.log(`longest task ${last?.longest} ms, ${last?.turns} views while busy, ${last?.seconds.toFixed(1)} s in all`);
      if (last && last.longest <= LONGEST && last.turns >= TURNS) break;
    }
    const best = runs.filter((run) => run.turns >= TURNS).sort((a, b) => a.longest - b.longest)[0];
    assert.ok(best, "the model did not turn while it was worked on");
    assert.ok(best.longest <= LONGEST, `a task of ${best.longest} ms, at most ${LONGEST} are allowed`);
  });

  async function once() {
    const page = await visit(browser, site.url, { renderer: "webgpu" });
    await page.waitForTimeout(300);
    await page.evaluate(() => {
      /** @type {number[]} */
      const tasks = [];
      new PerformanceObserver((list) => tasks.push(...list.getEntries().map((entry) => entry.duration))).observe({ type: "longtask" });
      // What the engine says while it works: every new view is a frame that it drew.
      const links = new Set();
      const watch = () => {
        const root = document.documentElement;
        if (root.dataset["state"] === "busy") links.add(Reflect.get(window, "limn").state?.link);
        requestAnimationFrame(watch);
      };
      watch();
      Object.assign(window, { tasks, links });
    });
    const start = performance.now();
    await drop(page, [model]);
    const name = basename(model, ".obj");
    const done = ready(page, (state, name) => state.model.name.includes(name), name, 240_000).then(async () => {
      await cmd(page, `level ${(await state(page)).shown.level + 1}`);
      await page.waitForTimeout(200);
      await ready(page, () => true, null, 240_000);
      return true;
    });
    // Turn the model to and fro until everything is done.
    let turning = true;
    const turn = (async () => {
      await page.mouse.move(480, 250);
      await page.mouse.down();
      for (let step = 0; turning; step += 1) {
        await page.mouse.move(480 + 120 * Math.sin(step / 9), 250 + 40 * Math.sin(step / 13));
        await page.waitForTimeout(16);
      }
      await page.mouse.up();
    })();
    try {
      await done;
    } finally {
      turning = false;
      await turn;
    }
    const seconds = (performance.now() - start) / 1000;
    const { tasks, links } = await page.evaluate(() => ({ tasks: Reflect.get(window, "tasks"), links: Reflect.get(window, "links").size }));
    const seen = await state(page);
    assert.ok(seen.shown.faces >= 2 * SIDE * SIDE, `${seen.shown.faces} faces`);
    await page.context().close();
    return { longest: Math.round(Math.max(0, ...tasks)), turns: links, seconds };
  }
});
