// The engine is disposable: whoever ends its worker, the same picture returns.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { RENDERERS, cmd, difference, drop, launch, picture, ready, serveSite, state, tidy, visit } from "./harness.mjs";
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
});
