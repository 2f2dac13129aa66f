// Share links: the fragment is the picture.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { cards, cmd, difference, launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

describe("a share link", () => {
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

  test("brings the same picture to somebody else", async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:pawn;scheme+loop;level+2" });
    await page.mouse.move(480, 250);
    await page.mouse.down();
    await page.mouse.move(600, 220, { steps: 6 });
    await page.mouse.up();
    await cmd(page, "view shading=flat");
    await cmd(page, "view cage=on");
    await ready(page, (state) => /cage/.test(state.link));
    const sent = await picture(page);
    await page.locator("#copy").click();
    const link = await page.evaluate(() => navigator.clipboard.readText());
    assert.match(link, /#1;open\+builtin:pawn;/);
    assert.ok(link.startsWith(site.url));
    await page.context().close();

    const other = await visit(browser, site.url, { renderer: "webgpu", hash: new URL(link).hash });
    const received = await picture(other);
    const found = difference(sent, received);
    // Camera numbers in a link are rounded to what the eye cannot tell.
    assert.ok(found.share <= 0.001, `${(100 * found.share).toFixed(3)}% of the pixels differ`);
    assert.deepEqual(await cards(other), []);
    assert.equal((await state(other)).link, new URL(link).hash, "and the link is the same again");
    await other.context().close();
  });

  test("changes the page when it is pasted over the old one", async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:cube" });
    await page.evaluate(() => {
      location.hash = "#1;open+builtin:torus;level+1";
    });
    await ready(page, (state) => state.model.name.includes("torus") && state.shown.level === 1);
    await page.context().close();
  });

  const broken = {
    "a word that is no command": "#1;open+builtin:cube;fly+3",
    "a model that does not exist": "#1;open+builtin:elefant",
    "a version from the future": "#9;open+builtin:cube",
    "a number that is none": "#1;open+builtin:cube;level+high",
    "no text at all": "#%ff%fe%00",
    "a hundred levels": "#1;open+builtin:cube;scheme+catmull-clark;level+100",
  };
  for (const [what, hash] of Object.entries(broken)) {
    test(`says what is wrong with ${what}`, async () => {
      const page = await visit(browser, site.url, { renderer: "webgpu", hash });
      await page.waitForFunction(() => document.querySelector("#cards .card"));
      const shown = await cards(page);
      assert.equal(shown.length, 1, JSON.stringify(shown));
      console.log(`  ${hash}: ${shown[0]?.text}`);
      assert.ok((shown[0]?.text.length ?? 0) > 20);
      assert.ok((await state(page)).model, "there is a model all the same");
      await page.context().close();
    });
  }
});
