// `?bench`: the page that runs the benchmark's browser half on a visitor's device. It loads no engine that draws, fills its table
// row by row, gives its figures as JSON, and can be stopped. That its inputs are refined right is checked by value.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { own } from "./harness.mjs";

describe("the benchmark's page", () => {
  const here = own();
  /** @param {Parameters<typeof here.visit>[0]} [options] */
  const open = async (options) => {
    here.site.sent.length = 0;
    const page = await here.visit({ ...options, search: "?bench", wait: false });
    await page.waitForSelector("#bench-run");
    return page;
  };

  test("loads no engine, runs, and gives its rows as JSON", async () => {
    const page = await open({ width: 390, height: 844, touch: true });
    assert.deepEqual(here.site.sent.filter(({ path }) => path.startsWith("/pkg/")), [], "nothing is run before it is asked for");
    assert.ok(await page.locator("#bench-copy").isDisabled());
    await page.click("#bench-run");
    await page.waitForFunction(() => document.querySelector("#bench-progress")?.textContent === "Done.", null, { timeout: 180_000, polling: 200 });
    const packages = here.site.sent.map(({ path }) => path).filter((path) => path.startsWith("/pkg/"));
    assert.ok(packages.length && packages.every((path) => path.startsWith("/pkg/trial/")), packages.join());
    await page.click("#bench-copy");
    await page.waitForFunction(() => document.querySelector("#bench-progress")?.textContent === "Copied.");
    const { rows, machine, measured_bandwidth: bandwidth } = JSON.parse(await page.evaluate(() => navigator.clipboard.readText()));
    assert.ok(machine && bandwidth > 1e8, `${machine}, ${bandwidth}`);
    const plain = rows.filter((/** @type {{ engine: string }} */ { engine }) => engine === "limn-wasm");
    const shaded = rows.filter((/** @type {{ engine: string }} */ { engine }) => engine === "limn-wasm-shaded");
    assert.deepEqual([plain.length, shaded.length], Array(2).fill(await page.locator("#bench tbody").count()));
    // Once without normals and once with them: 12 bytes a point more.
    for (const [at, row] of shaded.entries()) {
      assert.deepEqual([plain[at].stores, row.stores], ["points, corners", "points, normals, corners"]);
      const points = (row.output_bytes - plain[at].output_bytes) / 12;
      assert.ok(Number.isInteger(points) && points >= row.faces / 2 && plain[at].output_bytes > 16 * row.faces, JSON.stringify(row));
    }
    for (const row of rows) {
      assert.ok(row.engine && row.scheme && row.median_ms > 0 && row.ns_per_face > row.limit_ns_per_face, JSON.stringify(row));
      assert.ok(Math.abs((row.median_ms * 1e6) / row.faces - row.ns_per_face) < 1e-6 * row.ns_per_face, JSON.stringify(row));
    }
    const faces = plain.map((/** @type {{ faces: number }} */ row) => row.faces);
    assert.deepEqual(faces.slice(-5), [6, 96, 1536, 24576, 98304], "a cube's levels");
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390, "nothing sticks out on a phone");
  });

  test("stops when it is told to", async () => {
    const page = await open();
    await page.click("#bench-run");
    await page.waitForSelector("#bench tbody", { timeout: 60_000 });
    await page.click("#bench-run");
    await page.waitForFunction(() => document.querySelector("#bench-progress")?.textContent === "Stopped.");
    assert.equal(await page.textContent("#bench-run"), "Run again");
  });

  test("an engine whose result is another is told from one whose result is the same", async () => {
    const page = await open();
    const said = await page.evaluate(async () => {
      const { Thread } = await import(`${location.origin}/web/bench-host.js`);
      const thread = await Thread.open("limn-wasm");
      const cube = await thread.call("cage", "cube", 0);
      await thread.call("prepare", cube, "catmull-clark", 1);
      await thread.call("run", 1);
      const surface = await thread.call("surface");
      const same = await thread.call("differs", surface, 1e-5);
      surface.positions[7] += 0.01;
      const moved = await thread.call("differs", surface, 1e-5);
      thread.close();
      return { same, moved, points: [...surface.positions].length };
    });
    assert.equal(said.same, "");
    assert.match(said.moved, /^a point is 1\.0e-2 off/);
    assert.equal(said.points, 3 * 26);
  });
});
