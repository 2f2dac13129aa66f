// Fingers on the model: one turns, two move, zoom and twist, a double tap sets what it turns around.

import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, describe, test } from "node:test";
import { launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

describe("touch", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Awaited<ReturnType<typeof visit>>} */ let page;
  /** @type {import("playwright-core").CDPSession} */ let session;
  before(async () => {
    site = await serveSite();
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    site?.close();
  });
  beforeEach(async () => {
    const hash = "#1;open+builtin:cube;scheme+linear;level+1;view+camera=30,20,6,0,0,0";
    page = await visit(browser, site.url, { renderer: "webgpu", hash, width: 390, height: 844, touch: true });
    session = await page.context().newCDPSession(page);
  });
  afterEach(async () => {
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });

  /** @param {"touchStart" | "touchMove" | "touchEnd"} type @param {[number, number][]} points */
  const touch = (type, points) =>
    session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  /** Fingers go from some points to others in eight steps. @param {[number, number][]} from @param {[number, number][]} to */
  const stroke = async (from, to) => {
    await touch("touchStart", from);
    for (let step = 1; step <= 8; step += 1) {
      await touch("touchMove", from.map(([x, y], i) => [x + ((to[i]?.[0] ?? x) - x) * (step / 8), y + ((to[i]?.[1] ?? y) - y) * (step / 8)]));
      await page.waitForTimeout(20);
    }
    await touch("touchEnd", []);
  };
  /** The camera's numbers, from the link. */
  const camera = async () => {
    const text = /camera=([-\d.,]+)/.exec((await state(page)).link)?.[1];
    assert.ok(text, (await state(page)).link);
    const [yaw = NaN, pitch = NaN, distance = NaN, ...target] = text.split(",").map(Number);
    return { yaw, pitch, distance, target };
  };
  /** Waits until the camera has moved and rests. @param {string} link the one before */
  const moved = async (link) => {
    await ready(page, (state, link) => state.link !== link, link);
    for (let last = ""; last !== link; await page.waitForTimeout(500)) [last, link] = [link, (await state(page)).link];
  };

  test("one finger turns", async () => {
    const [before, { link }] = [await camera(), await state(page)];
    const still = await picture(page);
    await stroke([[195, 300]], [[285, 330]]);
    await moved(link);
    const after = await camera();
    assert.ok(Math.abs(after.yaw - before.yaw) > 20, `${before.yaw} -> ${after.yaw}`);
    assert.ok(Math.abs(after.pitch - before.pitch) > 5, `${before.pitch} -> ${after.pitch}`);
    assert.deepEqual([after.distance, ...after.target], [before.distance, ...before.target], "nothing else");
    assert.notDeepEqual((await picture(page)).data, still.data);
    assert.equal(await page.evaluate(() => scrollY + scrollX), 0, "the page does not scroll");
  });

  test("two fingers zoom by as much as they part, and move", async () => {
    const [before, { link }] = [await camera(), await state(page)];
    await stroke([[155, 300], [235, 300]], [[115, 300], [275, 300]]);
    await moved(link);
    const near = await camera();
    assert.ok(Math.abs(before.distance / near.distance - 2) < 0.15, `twice as far apart is twice as near: ${before.distance} -> ${near.distance}`);
    assert.ok(Math.abs(near.yaw - before.yaw) < 1 && Math.abs(near.pitch - before.pitch) < 1, "and does not turn");
    assert.equal(await page.evaluate(() => visualViewport?.scale), 1, "the page itself does not zoom");
    const { link: zoomed } = await state(page);
    await stroke([[155, 300], [235, 300]], [[155, 380], [235, 380]]);
    await moved(zoomed);
    const panned = await camera();
    assert.ok(Math.hypot(...panned.target.map((x, i) => x - (near.target[i] ?? 0))) > 0.1, `${near.target} -> ${panned.target}`);
    assert.ok(Math.abs(panned.distance / near.distance - 1) < 0.02, "together they do not zoom");
  });

  test("a double tap sets the point to turn around", async () => {
    const [before, { link }] = [await camera(), await state(page)];
    assert.deepEqual(before.target, [0, 0, 0]);
    await picture(page);
    // Not one after the other's answer: on a busy machine that would be two taps.
    await Promise.all([touch("touchStart", [[215, 330]]), touch("touchEnd", []), touch("touchStart", [[215, 330]]), touch("touchEnd", [])]);
    await moved(link);
    const { target } = await camera();
    // In the middle of the cube before, on its skin now.
    assert.ok(Math.abs(Math.max(...target.map(Math.abs)) - 1) < 0.01, `the target is ${target}`);
  });

  test("the ruler is dragged by a finger", async () => {
    const box = await page.locator(".notch").nth(1).boundingBox();
    const goal = await page.locator(".notch").nth(3).boundingBox();
    assert.ok(box && goal);
    await stroke([[box.x + box.width / 2, box.y + 13]], [[goal.x + goal.width / 2, goal.y + 13]]);
    await ready(page, (state) => state.shown.level === 3 && state.level === 3);
  });
});
