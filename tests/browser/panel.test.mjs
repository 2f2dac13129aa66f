// The panel is fetched when a visitor first reaches for it, and knows then what was said before it came.

import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, describe, test } from "node:test";
import { cards, cmd, content, launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

describe("the panel", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Awaited<ReturnType<typeof visit>>} */ let page;
  before(async () => {
    site = await serveSite();
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    site?.close();
  });
  beforeEach(async () => {
    site.sent.length = 0;
    page = await visit(browser, site.url, { renderer: "webgpu", width: 1200, hash: "#1;open+builtin:cube;scheme+catmull-clark;level+1" });
    // What the panel looks like at the moment in which it is first shown.
    await page.evaluate(() => {
      const panel = document.getElementById("panel");
      if (!panel) return;
      new MutationObserver(() => {
        if (!panel.hidden) Reflect.set(window, "firstLook", { ...JSON.parse(JSON.stringify(panel.getBoundingClientRect())), rows: panel.querySelectorAll("fieldset").length });
      }).observe(panel, { attributeFilter: ["hidden"] });
    });
  });
  afterEach(async () => {
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
  const fetched = () => site.sent.map(({ path }) => path).filter((path) => /panel|parameters/.test(path));

  test("is not part of a first visit, and comes whole", async () => {
    assert.deepEqual(fetched(), []);
    await page.locator("#panel-toggle").hover();
    await page.waitForFunction(() => document.getElementById("tab-view"));
    assert.deepEqual(fetched().sort(), ["/web/panel.css", "/web/panel.js", "/web/parameters.js"], "a pointer on the button is enough");
    assert.ok(await page.locator("#panel").isHidden());
    const before = await picture(page);
    await page.locator("#panel-toggle").click();
    const look = await page.evaluate(() => Reflect.get(window, "firstLook"));
    assert.equal(look.width, 328, "styled when it is first seen");
    assert.ok(look.rows > 8, `${look.rows} rows`);
    assert.equal(await page.locator("#panel-toggle").getAttribute("aria-expanded"), "true");
    // The model makes room for it.
    assert.ok(centre(await picture(page)) < centre(before) - 100, "the model moved to the left");
    await page.keyboard.press("Escape");
    assert.ok(await page.locator("#panel").isHidden());
    assert.ok(Math.abs(centre(await picture(page)) - centre(before)) < 4, "and back");
    assert.equal(fetched().length, 3, "fetched once");
  });

  test("tells of what went wrong before it came", async () => {
    await cmd(page, "level 2");
    await ready(page, (state) => state.shown.level === 2);
    await cmd(page, "level 100");
    await page.waitForFunction(() => document.querySelector("#cards .card.error"));
    assert.match((await cards(page))[0]?.text ?? "", /^level 100/, "no panel, so a card says it");
    assert.deepEqual(fetched(), []);
    // Styles that come late hold the panel back.
    await page.route("**/web/panel.css", async (route) => {
      await new Promise((done) => setTimeout(done, 400));
      await route.continue();
    });
    await page.keyboard.press("/");
    await page.waitForFunction(() => document.activeElement?.id === "command");
    assert.equal((await page.evaluate(() => Reflect.get(window, "firstLook"))).width, 328, "styled when it is first seen");
    const lines = await page.locator("#log li code").allTextContents();
    assert.deepEqual(lines, ["level 2", "level 100"]);
    assert.ok(await page.locator("#log li").nth(1).evaluate((line) => line.classList.contains("error")));
    // From now on the console says it, and no card.
    await page.locator("#cards .dismiss").first().click();
    await page.locator("#command").fill("level 99");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.querySelectorAll("#log li").length === 3);
    assert.deepEqual(await cards(page), []);
    const offer = page.locator("#log").getByRole("button", { name: /^Use level \d+$/ });
    assert.equal(await offer.count(), 2, "and what would let it");
    await page.locator("#command").press("ArrowUp");
    assert.equal(await page.locator("#command").inputValue(), "level 99", "what was typed comes back");
  });

  test("opens once for two keys, and shows what is chosen", async () => {
    await page.keyboard.press("?");
    await page.keyboard.press("?");
    await page.waitForFunction(() => document.getElementById("tab-view"));
    await page.waitForTimeout(100);
    assert.ok(await page.locator("#panel").isHidden(), "the second key closes what the first one opens");
    await page.keyboard.press("b");
    await page.locator("#tab-view").click();
    const plain = await picture(page);
    await page.locator("#control-cage").getByRole("button", { name: "On" }).click();
    await page.waitForFunction(() => document.querySelector('#control-cage [aria-pressed="true"]')?.textContent === "On");
    assert.notDeepEqual((await picture(page)).data, plain.data, "the cage");
    await page.locator("#tab-view").focus();
    await page.keyboard.press("ArrowRight");
    assert.ok(await page.locator("#pane-surface").isVisible());
    assert.equal((await state(page)).shown.level, 1, "arrows in the tabs are the tabs'");
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("ArrowLeft");
    assert.ok(await page.locator("#pane-help").isVisible(), "round and round");
    assert.ok(content(plain).colours > 50);
  });

  test("that cannot be fetched is said, and tried again", async () => {
    await page.route("**/web/panel.css", (route) => route.abort());
    await page.keyboard.press("b");
    await page.waitForFunction(() => document.getElementById("toast")?.textContent?.includes("could not be loaded"));
    assert.ok(await page.locator("#panel").isHidden());
    await page.unroute("**/web/panel.css");
    await page.keyboard.press("b");
    await page.locator("#pane-view").waitFor({ state: "visible" });
    page.errors.splice(0, page.errors.length, ...page.errors.filter((text) => !/ERR_FAILED/.test(text)));
  });
});

/** The middle of what is no background, from left to right, at the model's height. @param {import("pngjs").PNG} png */
function centre(png) {
  const row = 4 * png.width * Math.round(png.height * 0.42);
  let [low, high] = [png.width, 0];
  for (let x = 0; x < png.width; x += 1) {
    // The ground is dithered a little.
    if (Math.abs((png.data[row + 4 * x] ?? 0) - (png.data[row] ?? 0)) > 12) [low, high] = [Math.min(low, x), x];
  }
  return (low + high) / 2;
}
