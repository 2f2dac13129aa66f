// Schemes side by side: on both backends each pane shows its own surface from one camera; pills, labels and links.

import assert from "node:assert/strict";
import { after, afterEach, before, describe, test } from "node:test";
import { RENDERERS, cmd, launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

const PAWN = "#1;open+builtin:pawn;scheme+loop;compare+linear;level+2;view+background=ffffff";

/**
 * The box of what is drawn in a part of a picture on white, and how dark it is: light falls from above, so only the model
 * and its shadow are not white.
 * @param {import("pngjs").PNG} png @param {[number, number, number, number]} rect
 */
function drawn(png, [left, top, width, height]) {
  const box = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity, pixels: 0 };
  for (let y = Math.ceil(top); y < top + height; y += 1) {
    for (let x = Math.ceil(left); x < left + width; x += 1) {
      const at = 4 * (y * png.width + x);
      if (Math.max(png.data[at] ?? 255, png.data[at + 1] ?? 255, png.data[at + 2] ?? 255) > 215) continue;
      box.pixels += 1;
      box.left = Math.min(box.left, x - left);
      box.right = Math.max(box.right, x - left);
      box.top = Math.min(box.top, y - top);
      box.bottom = Math.max(box.bottom, y - top);
    }
  }
  return box;
}

/** How many pixels of two parts of one size differ. @param {import("pngjs").PNG} png @param {number[]} a @param {number[]} b */
function differing(png, a, b) {
  const [[ax = 0, ay = 0, width = 0, height = 0], [bx = 0, by = 0]] = [a, b];
  let count = 0;
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const [p, q] = [4 * ((Math.round(ay) + y) * png.width + Math.round(ax) + x), 4 * ((Math.round(by) + y) * png.width + Math.round(bx) + x)];
      if ([0, 1, 2].some((c) => Math.abs((png.data[p + c] ?? 0) - (png.data[q + c] ?? 0)) > 12)) count += 1;
    }
  }
  return count;
}

describe("schemes side by side", () => {
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
  afterEach(async () => {
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
  const there = (/** @type {number} */ count) =>
    ready(page, (state, count) => state.compare.panes.length === count && state.compare.panes.every((/** @type {any} */ p) => p.faces || p.note), count);

  for (const renderer of RENDERERS) {
    test(`each pane shows its own surface from one camera on ${renderer}`, async () => {
      page = await visit(browser, site.url, { renderer, width: 1000, height: 700, hash: PAWN });
      await there(2);
      const { panes } = (await state(page)).compare;
      const [a, b] = panes.map((/** @type {any} */ p) => p.rect);
      assert.deepEqual([b[0] - a[0], b[1] - a[1], b[2], b[3]], [500, 0, 500, a[3]], "two of one size, side by side");
      let png = await picture(page);
      const [first, second] = [drawn(png, a), drawn(png, b)];
      assert.ok(first.pixels > 3000 && second.pixels > 3000, `${first.pixels} ${second.pixels}`);
      // The linear one is the model's own hull: somewhat larger, in the same place.
      assert.ok(differing(png, a, b) > 1500, "not the same picture");
      for (const side of /** @type {const} */ (["left", "right", "top", "bottom"])) {
        assert.ok(Math.abs(first[side] - second[side]) < 24, `${side}: ${first[side]} and ${second[side]}`);
      }
      // The same scheme in both is the same picture, pixel for pixel but for edges.
      await cmd(page, "compare loop weights=warren");
      await ready(page, (state) => state.compare.panes[1]?.name === "Loop, weights warren" && state.compare.panes[1].faces > 0);
      png = await picture(page);
      assert.ok(differing(png, a, b) < first.pixels / 4, "Warren's weights differ little");
      // A turn in the second pane turns both.
      await page.mouse.move(760, 300);
      await page.mouse.down();
      await page.mouse.move(840, 250, { steps: 4 });
      await page.mouse.up();
      await ready(page, (state) => /camera=/.test(state.text));
      const turned = await picture(page);
      assert.ok(differing(turned, a, b) < first.pixels / 4, "still one camera");
      let moved = 0;
      for (let i = 0; i < png.data.length; i += 4) moved += Number(Math.abs((png.data[i] ?? 0) - (turned.data[i] ?? 0)) > 12);
      assert.ok(moved > 1500, "the model turned");
      // What is left is alone in the middle again.
      await cmd(page, "compare off");
      await there(0);
      const alone = drawn(await picture(page), [0, 44, 1000, 450]);
      assert.ok(Math.abs(alone.left + alone.right - 1000) < 80, "in the middle");
    });
  }

  test("pills put schemes side by side, labels take them away, and the link holds them", async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", width: 1200, height: 760, hash: "#1;open+builtin:cube;scheme+catmull-clark;level+2" });
    const compare = page.locator("#compare");
    await compare.click();
    await page.locator("#compare-hint").filter({ hasText: "beside Catmull–Clark" }).waitFor();
    assert.equal(await compare.getAttribute("aria-pressed"), "true");
    const pill = (/** @type {string} */ id) => page.locator(`#scheme-${id}`);
    await pill("loop").click();
    await there(2);
    assert.ok(await page.locator("#compare-hint").isHidden());
    assert.equal((await state(page)).scheme, "catmull-clark", "the first stays");
    assert.equal(await pill("loop").getAttribute("aria-checked"), "true");
    assert.equal(await pill("loop").getAttribute("role"), "checkbox");
    await page.locator(".pane").nth(1).filter({ hasText: "cut into triangles" }).waitFor();
    assert.match((await page.locator(".pane").nth(0).textContent()) ?? "", /Catmull–Clark96 faces, 98 vertices/);
    // With the keyboard: arrows move, Space chooses.
    await pill("linear").focus();
    await page.keyboard.press("Space");
    await there(3);
    await page.keyboard.press("ArrowLeft");
    assert.equal((await state(page)).compare.panes.length, 3, "arrows choose nothing");
    // A scheme of the other module, fetched for a pane.
    await pill("doo-sabin").click();
    await there(4);
    const { link, undo, compare: all } = await state(page);
    assert.match(link, /;compare\+loop\+linear\+doo-sabin;/);
    assert.equal(undo, "compare loop linear doo-sabin");
    assert.deepEqual(all.panes.map((/** @type {any} */ p) => p.faces), [96, 192, 96, 98]);
    assert.equal(all.add, "");
    assert.equal(await pill("sqrt3").getAttribute("aria-disabled"), "true", "four is all");
    // Four make two rows; labels stand in their panes.
    for (let i = 0; i < 4; i += 1) {
      const [x, y, w, h] = all.panes[i].rect;
      const label = await page.locator(".pane").nth(i).locator("p").first().boundingBox();
      assert.ok(label && label.x >= x && label.x + label.width <= x + w && label.y > y && label.y + label.height <= y + h + 1, `${i}`);
    }
    // Another visitor sees the same.
    const other = await visit(browser, site.url, { renderer: "webgpu", width: 1200, height: 760, hash: link });
    await ready(other, (state) => state.compare.panes.length === 4 && state.compare.panes.every((/** @type {any} */ p) => p.faces));
    await other.locator(".pane").nth(3).waitFor();
    assert.equal((await state(other)).text, (await state(page)).text);
    assert.deepEqual(other.errors, []);
    await other.context().close();
    // Away with one; another becomes the first; done.
    await page.getByRole("button", { name: "Leave Linear out" }).click();
    await there(3);
    await page.getByRole("button", { name: "Doo–Sabin", exact: true }).nth(0).click();
    await ready(page, (state) => state.scheme === "doo-sabin");
    assert.deepEqual((await state(page)).compare.panes.map((/** @type {any} */ p) => p.scheme), ["doo-sabin", "loop", "catmull-clark"]);
    await there(3);
    await compare.click();
    await there(0);
    assert.equal(await page.locator(".pane").count(), 0);
    assert.equal(await pill("linear").getAttribute("role"), "radio");
    await page.locator("#undo").click();
    await there(3);
  });

  test("a double click turns about the point that was hit, whichever pane it is in", async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", width: 1000, height: 700, hash: PAWN, reducedMotion: "reduce" });
    await there(2);
    const target = async () => {
      await ready(page, (state) => /camera=/.test(state.text));
      return (await state(page)).text.match(/camera=([^ \n]*)/)?.[1];
    };
    const [, second] = (await state(page)).compare.panes;
    const [x, y, w, h] = second.rect;
    await page.mouse.dblclick(x + w / 2, y + h * 0.4);
    const there2 = await target();
    await cmd(page, "view camera=home");
    await ready(page, (state) => !/camera=/.test(state.text));
    await page.waitForTimeout(600);
    await page.mouse.dblclick(x - 500 + w / 2, y + h * 0.4);
    const there1 = await target();
    const numbers = (/** @type {string | undefined} */ text) => (text ?? "").split(",").map(Number);
    // The two surfaces differ, so the points do, a little.
    const far = Math.hypot(...[3, 4, 5].map((i) => (numbers(there1)[i] ?? 0) - (numbers(there2)[i] ?? 9)));
    assert.ok(far < 0.3, `${there1} and ${there2}`);
  });

  test("on a phone panes are stacked, and faces are coloured by kind", async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", width: 390, height: 844, touch: true, hash: "#1;open+builtin:cube;scheme+doo-sabin;compare+linear;level+2;view+kinds=on" });
    await there(2);
    const { panes } = (await state(page)).compare;
    assert.equal(panes[0].rect[0], panes[1].rect[0]);
    assert.ok(panes[1].rect[1] >= panes[0].rect[1] + panes[0].rect[3] - 1, "one above the other");
    await page.locator("#kinds").waitFor();
    assert.match((await page.locator("#kinds").textContent()) ?? "", /a face.*an edge.*a vertex/);
    const png = await picture(page);
    /** Pixels of a hue, in degrees, that are far from grey. @param {number[]} rect @param {number} low @param {number} high */
    const hue = ([x0 = 0, y0 = 0, w = 0, h = 0], low, high) => {
      let count = 0;
      for (let y = Math.ceil(y0); y < y0 + h; y += 1) {
        for (let x = Math.ceil(x0); x < x0 + w; x += 1) {
          const at = 4 * (y * png.width + x);
          const [r = 0, g = 0, b = 0] = png.data.subarray(at, at + 3);
          const [max, min] = [Math.max(r, g, b), Math.min(r, g, b)];
          if (max - min < 40) continue;
          const turn = max === r ? (g - b) / (max - min) : max === g ? 2 + (b - r) / (max - min) : 4 + (r - g) / (max - min);
          const degrees = (turn * 60 + 360) % 360;
          if (degrees >= low && degrees < high) count += 1;
        }
      }
      return count;
    };
    const colours = panes.map((/** @type {any} */ p) => [[25, 55], [190, 225], [145, 175]].map(([low, high]) => hue(p.rect, low ?? 0, high ?? 0)));
    assert.ok(colours[0].every((/** @type {number} */ n) => n > 200), `orange, blue and green: ${colours[0]}`);
    assert.ok(colours[1].every((/** @type {number} */ n) => n === 0), `quads of the linear scheme have no kinds: ${colours[1]}`);
    await cmd(page, "view kinds=off");
    await page.locator("#kinds").waitFor({ state: "hidden" });
  });

  test("a pane that does not fit says so, and the others stay", async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", width: 1000, height: 700, hash: "#1;open+builtin:cube;scheme+linear;level+2" });
    await cmd(page, "compare nothing");
    await page.locator(".card").filter({ hasText: "There is no scheme `nothing`" }).waitFor();
    await cmd(page, "compare linear");
    await page.locator(".card").filter({ hasText: "it is the present scheme" }).waitFor();
    await cmd(page, "compare loop");
    await there(2);
    const top = (await state(page)).levels.filter((/** @type {any} */ l) => l.allowed).length - 1;
    assert.ok(top > 5);
  });
});
