// A scheme's parameters in the panel: sliders and buttons made from the state, each of them a command.

import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, describe, test } from "node:test";
import { cmd, launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

describe("a scheme's parameters", () => {
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
    page = await visit(browser, site.url, { renderer: "webgpu", width: 1200, height: 720, hash: "#1;open+builtin:icosahedron;scheme+butterfly;level+3" });
    await page.keyboard.press("b");
    await page.locator("#tab-surface").click();
    await page.locator("#parameters").waitFor({ state: "visible" });
  });
  afterEach(async () => {
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
  const slider = () => page.getByRole("slider", { name: "Tension" });
  const scheme = async () => (await state(page)).text.split("\n").find((/** @type {string} */ line) => line.startsWith("scheme"));
  const set = (/** @type {string} */ text) => ready(page, (state, text) => state.params[0]?.text === text, text);
  /** Where a share of the slider is, in pixels. @param {number} share */
  const place = async (share) => {
    const box = await slider().boundingBox();
    assert.ok(box);
    return /** @type {const} */ ([box.x + 8 + share * (box.width - 16), box.y + box.height / 2]);
  };

  test("a number is dragged: the surface follows, the link holds it, and it is one step", async () => {
    assert.equal(await slider().inputValue(), "0.0625");
    assert.ok(await page.locator("#parameters button").isDisabled(), "it has its default");
    const round = await picture(page);
    const link = (await state(page)).link;
    await page.mouse.move(...(await place(0.5)));
    await page.mouse.down();
    for (const share of [0.4, 0.3, 0.2]) {
      await page.mouse.move(...(await place(share)), { steps: 3 });
      await page.waitForTimeout(60);
    }
    await page.mouse.move(...(await place(0)), { steps: 3 });
    // Not let go yet, and shown all the same.
    await set("0");
    const flat = await picture(page);
    assert.notDeepEqual(flat.data, round.data, "without tension triangles stay flat");
    await page.mouse.up();
    await page.waitForTimeout(200);
    assert.equal(await scheme(), "scheme butterfly w=0");
    assert.notEqual((await state(page)).link, link);
    assert.match((await state(page)).link, /scheme\+butterfly\+w=0;/);
    assert.equal(await page.evaluate(() => location.hash), (await state(page)).link);
    assert.equal(await page.locator("#parameters output").textContent(), "0");
    assert.equal((await state(page)).undo, "scheme butterfly w=0");
    await page.locator("#undo").click();
    await set("0.0625");
    assert.equal((await state(page)).undo, null, "one step, whatever it passed");
    assert.equal(await slider().inputValue(), "0.0625", "the slider goes back as well");
    assert.deepEqual((await picture(page)).data, round.data);
    await page.locator("#redo").click();
    await set("0");
    assert.deepEqual((await picture(page)).data, flat.data);
    // The same surface as the linear scheme's, point for point: the link opens it elsewhere.
    const other = await visit(browser, site.url, { renderer: "webgpu", hash: (await state(page)).link });
    assert.equal((await state(other)).params[0].value, 0);
    assert.deepEqual(other.errors, []);
    await other.context().close();
  });

  test("keys move a slider by its step, a held key is one step to undo, and it goes back to its default", async () => {
    await slider().focus();
    await page.keyboard.press("ArrowRight");
    await set("0.06375");
    await page.keyboard.down("ArrowRight");
    await page.keyboard.down("ArrowRight");
    await page.keyboard.down("ArrowRight");
    await page.keyboard.up("ArrowRight");
    await set("0.0675");
    assert.equal((await state(page)).shown.level, 3, "arrows on a slider are the slider's");
    await page.getByRole("button", { name: "Default" }).click();
    await set("0.0625");
    assert.equal(await scheme(), "scheme butterfly", "a default needs no word");
    assert.equal(await slider().inputValue(), "0.0625");
    for (const before of ["0.0675", "0.06375", "0.0625"]) {
      await page.locator("#undo").click();
      await set(before);
    }
    assert.equal((await state(page)).undo, null);
    await page.mouse.dblclick(...(await place(0.8)));
    await page.waitForTimeout(300);
    await set("0.0625");
    assert.equal(await scheme(), "scheme butterfly", "a double click, too");
    // What the console sets, the slider shows.
    await cmd(page, "scheme butterfly w=0.1");
    await set("0.1");
    assert.equal(await slider().inputValue(), "0.1");
    await page.locator("#parameters output").filter({ hasText: "0.1" }).waitFor();
  });

  test("a choice is pressed, and rows change with the scheme", async () => {
    await cmd(page, "scheme loop");
    await ready(page, (state) => state.shown.scheme === "loop");
    const weights = page.getByRole("group", { name: "Weights" });
    const pressed = () => weights.locator('[aria-pressed="true"]').allTextContents();
    assert.deepEqual(await pressed(), ["Loop"]);
    assert.equal(await slider().count(), 0, "Loop has no tension");
    const before = await picture(page);
    await weights.getByRole("button", { name: "Warren" }).click();
    await set("warren");
    assert.deepEqual(await pressed(), ["Warren"]);
    assert.notDeepEqual((await picture(page)).data, before.data, "vertices of valence five move otherwise");
    assert.equal(await scheme(), "scheme loop weights=warren");
    await weights.getByRole("button", { name: "Loop" }).click();
    await set("loop");
    assert.equal(await scheme(), "scheme loop");
    assert.deepEqual((await picture(page)).data, before.data);
    await cmd(page, "scheme linear");
    await ready(page, (state) => state.shown.scheme === "linear");
    assert.ok(await page.locator("#parameters").isHidden(), "linear has none");
    // Two at once: each keeps the other.
    await cmd(page, "scheme j-spline");
    await ready(page, (state) => state.shown.scheme === "j-spline");
    await page.getByRole("group", { name: "Old vertices" }).getByRole("button", { name: "Off" }).click();
    await ready(page, (state) => state.params[1]?.text === "off");
    await page.getByRole("slider", { name: "Smoothing" }).focus();
    await page.keyboard.press("ArrowLeft");
    await set("0.49");
    assert.equal(await scheme(), "scheme j-spline s=0.49 move=off");
  });

  test("a slider that moves faster than the surface is made ends at its last value", async () => {
    await cmd(page, "level 5");
    await ready(page, (state) => state.shown.level === 5);
    await page.mouse.move(...(await place(0.5)));
    await page.mouse.down();
    // What is made meanwhile is seen meanwhile: the times tell of a surface that was made since.
    const times = new Set();
    for (let share = 0.5; share > 0.1; share -= 0.03) {
      await page.mouse.move(...(await place(share)));
      times.add((await state(page)).times.refine);
    }
    await page.mouse.move(...(await place(0)));
    assert.ok(times.size > 1, "something was shown before the hand rested");
    await page.mouse.up();
    await set("0");
    const last = await picture(page);
    await cmd(page, "scheme butterfly w=0.1");
    await set("0.1");
    await cmd(page, "scheme butterfly w=0");
    await set("0");
    assert.deepEqual((await picture(page)).data, last.data, "no older answer was left standing");
  });
});
