// The engine is disposable: whoever ends its worker, the same picture returns.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { RENDERERS, cards, cmd, difference, drop, launch, picture, ready, serveSite, state, tidy, visit } from "./harness.mjs";
import { realObj } from "./models.mjs";

describe("an engine that dies", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  before(async () => {
    site = await serveSite();
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    site?.close();
    await tidy();
  });

  for (const renderer of RENDERERS) {
    test(`comes back with the same picture on ${renderer}`, { timeout: 120_000 }, async () => {
      const page = await visit(browser, site.url, { renderer });
      await drop(page, [realObj("teapot")]);
      await ready(page, (state) => state.model.name.includes("teapot"));
      await cmd(page, "level 2");
      await ready(page, (state) => state.shown.level === 2);
      const before = await picture(page);
      const text = (await state(page)).text;
      // In the middle of work: a level is on its way when the worker ends.
      await page.evaluate(() => {
        const limn = Reflect.get(window, "limn");
        Reflect.set(window, "ended", limn.engine);
        limn.cmd("level 6");
        setTimeout(() => limn.engine.terminate(), 60);
      });
      await page.waitForFunction(() => Reflect.get(window, "limn").engine !== Reflect.get(window, "ended"));
      await ready(page, (state) => state.shown.level === 2);
      assert.equal((await state(page)).text, text);
      const found = difference(before, await picture(page));
      assert.equal(found.share, 0, `${(100 * found.share).toFixed(3)}% of the pixels differ`);
      assert.equal(await page.locator("#stage canvas").count(), 1, "the old canvas is gone");
      // And it works on.
      await page.keyboard.press("1");
      await ready(page, (state) => state.shown.level === 1);
      await page.context().close();
    });
  }

  /** Ends the engine, and waits for the next one's picture. @param {import("playwright-core").Page} page */
  const end = async (page) => {
    await page.evaluate(() => {
      const limn = Reflect.get(window, "limn");
      Reflect.set(window, "ended", limn.engine);
      limn.state = null;
      limn.engine.terminate();
    });
    await page.waitForFunction(() => Reflect.get(window, "limn").engine !== Reflect.get(window, "ended"));
  };

  test("three times in a row gives up a little more each time", { timeout: 120_000 }, async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu" });
    const creature = await picture(page);
    await drop(page, [realObj("teapot")]);
    await ready(page, (state) => state.model.name.includes("teapot"));
    await cmd(page, "level 1");
    await ready(page, (state) => state.shown.level === 1);
    const { text } = await state(page);

    await end(page);
    await ready(page);
    assert.equal((await state(page)).text, text, "first: all as it was");
    await end(page);
    await ready(page);
    assert.match((await state(page)).model.name, /teapot/, "second: the model");
    assert.equal((await state(page)).shown.level, 0, "without what was done to it");
    await end(page);
    await ready(page);
    assert.match((await state(page)).text, /open builtin:creature/, "third: the built-in model");
    const [card, ...more] = await cards(page);
    assert.deepEqual(more, [], "one card");
    assert.match(card?.text ?? "", /could not be brought back, so here is the built-in one/);
    assert.deepEqual((await picture(page)).data, creature.data, "as on a first visit");
    assert.equal(await page.locator("#stage canvas").count(), 1);

    // It is an engine like any other.
    await drop(page, [realObj("teapot")]);
    await ready(page, (state) => state.model.name.includes("teapot"));

    // And a fourth time is the last: nothing pretends to work.
    await end(page);
    await page.waitForFunction(() => document.documentElement.dataset["state"] === "fault");
    assert.match((await cards(page))[0]?.text ?? "", /^The engine does not start \| It stopped 4 times in a row/);
    await page.context().close();
  });
});

describe("work that takes long", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  before(async () => {
    site = await serveSite();
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    site?.close();
  });

  test("is cancelled: everything is as it was, and the page answers", { timeout: 120_000 }, async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu" });
    await cmd(page, "level 1");
    await ready(page, (state) => state.shown.level === 1);
    const before = await state(page);
    const still = await picture(page);
    const engine = await page.evaluateHandle(() => Reflect.get(window, "limn").engine);
    await cmd(page, "scheme loop");
    await ready(page, (state) => state.shown.scheme === "loop");
    await cmd(page, "undo");
    await ready(page, (state) => state.shown.scheme === "catmull-clark");

    await cmd(page, "level 6");
    // The first such level loads the kernel, which a busy machine talks about.
    await page.waitForFunction(() => /^Refining to level 6 {2}\d+%$/.test(document.querySelector("#progress-what")?.textContent ?? ""), null, { polling: 10 });
    assert.ok(await page.locator("#cancel").isVisible());
    assert.ok(await page.locator("#count").isHidden());
    const start = performance.now();
    await page.locator("#cancel").click();
    await ready(page, (state) => state.level === 1);
    const took = performance.now() - start;
    console.log(`  cancelled after ${Math.round(took)} ms`);
    assert.ok(took < 5_000, `${took} ms`);
    assert.ok(await page.locator("#progress").isHidden());
    const after = await state(page);
    assert.equal(after.text, before.text);
    assert.equal(after.shown.faces, before.shown.faces);
    assert.ok(await page.evaluate((engine) => Reflect.get(window, "limn").engine === engine, engine), "by the same engine");
    assert.deepEqual((await picture(page)).data, still.data);
    assert.deepEqual(await cards(page), []);
    await page.keyboard.press("3");
    await ready(page, (state) => state.shown.level === 3);
    for (const level of [1, 2]) {
      await page.keyboard.press("Control+z");
      await ready(page, (state, level) => state.shown.level === level, level);
    }
    assert.equal((await state(page)).undo, null, "what was cancelled is no step to undo");
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
});
