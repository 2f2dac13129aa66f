// The controls: slider, keys, schemes, undo and redo, reload, console, export, theme; by what a visitor does.

import assert from "node:assert/strict";
import { after, before, beforeEach, afterEach, describe, test } from "node:test";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { cards, content, cmd, download, drop, launch, picture, ready, scratch, serveSite, state, tidy, visit } from "./harness.mjs";

const CUBE = `o box
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
`;

describe("the controls", () => {
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
    await tidy();
  });
  beforeEach(async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:cube;scheme+catmull-clark;level+1" });
  });
  afterEach(async () => {
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
  const level = (/** @type {number} */ level) => ready(page, (state, level) => state.shown.level === level && state.level === level, level);

  test("keys 0 to 9 and the arrows choose levels", async () => {
    await page.keyboard.press("4");
    await level(4);
    assert.equal((await state(page)).shown.faces, 6 * 4 ** 4);
    await page.keyboard.press("ArrowLeft");
    await level(3);
    await page.keyboard.press("ArrowRight");
    await level(4);
    await page.keyboard.press("0");
    await level(0);
    assert.equal((await state(page)).shown.vertices, 8);
  });

  test("the slider is dragged, clicked and arrowed, and its ticks tell the counts", async () => {
    const slider = page.getByRole("slider", { name: "Level" });
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    await level(2);
    const notch = page.locator(".notch").nth(3);
    const box = await notch.boundingBox();
    assert.ok(box);
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await level(3);
    const first = await page.locator(".notch").nth(0).boundingBox();
    assert.ok(first);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(first.x + first.width / 2, first.y + first.height / 2, { steps: 8 });
    await page.mouse.up();
    await level(0);
    // A drag is one undo entry, whatever it passed.
    await page.keyboard.press("Control+z");
    await level(3);
    const { levels } = await state(page);
    for (const { level, faces, title } of levels.slice(0, 5)) {
      assert.equal(faces, 6 * 4 ** level);
      assert.match(title, new RegExp(faces.toLocaleString("en").replace(/,/g, "[, \\u2009\\u202f]?")));
    }
    assert.equal(await slider.getAttribute("aria-valuenow"), "3");
  });

  test("schemes come from the registry and change the surface", async () => {
    const names = await page.getByRole("radiogroup", { name: "Scheme" }).getByRole("radio").allTextContents();
    assert.ok(names.length >= 3, `${names.length} schemes`);
    await page.keyboard.press("2");
    await level(2);
    const before = await picture(page);
    await page.getByRole("radio", { name: /Loop/ }).click();
    await ready(page, (state) => state.shown.scheme === "loop");
    assert.equal((await state(page)).shown.faces, 12 * 16, "six quads are twelve triangles");
    assert.notDeepEqual((await picture(page)).data, before.data);
  });

  test("on a phone the schemes are one line, which moves to the chosen one", async () => {
    const phone = await visit(browser, site.url, { renderer: "webgpu", width: 390, height: 700, hash: "#1;open+builtin:cube;level+1" });
    const ids = (await phone.$$eval("#schemes button", (pills) => pills.map((pill) => pill.id.replace("scheme-", "")))).reverse();
    for (const id of ids) {
      await cmd(phone, `scheme ${id}`);
      await ready(phone, (state, id) => state.scheme === id, id);
      const [strip, pill, tops] = await phone.evaluate((id) => {
        const box = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id)).getBoundingClientRect();
        return /** @type {const} */ ([box("schemes"), box(`scheme-${id}`), [...document.querySelectorAll("#schemes button")].map((b) => b.getBoundingClientRect().top)]);
      }, id);
      assert.ok(pill.left >= strip.left + 20 && pill.right <= strip.right - 20, `${id} is clear of the fades`);
      assert.equal(new Set(tops).size, 1, "one line");
    }
    assert.equal(await phone.evaluate(() => document.documentElement.scrollWidth), 390, "the page itself does not scroll");
    assert.deepEqual(phone.errors, []);
    await phone.context().close();
  });

  test("a note that was dismissed is not said again for the same model", async () => {
    const scheme = async (/** @type {RegExp} */ name, /** @type {string} */ id) => {
      await page.getByRole("radio", { name }).click();
      await ready(page, (state, id) => state.shown.scheme === id, id);
    };
    await scheme(/Loop/, "loop");
    assert.match((await cards(page)).map((card) => card.text).join("\n"), /^cube: 1 note \| .*triang/);
    await scheme(/Catmull/, "catmull-clark");
    assert.deepEqual(await cards(page), [], "what is over is taken away");
    await scheme(/Loop/, "loop");
    assert.equal((await cards(page)).length, 1, "nobody has dismissed it yet");
    await page.keyboard.press("Escape");
    assert.deepEqual(await cards(page), []);
    await scheme(/Catmull/, "catmull-clark");
    await scheme(/Loop/, "loop");
    await picture(page);
    assert.deepEqual(await cards(page), []);
    await page.keyboard.press("b");
    await page.locator("#tab-report").click();
    assert.match((await page.locator("#pane-report").textContent()) ?? "", /triang/, "the report says it all the same");
    await cmd(page, "open builtin:dodecahedron");
    await cmd(page, "scheme loop");
    await page.waitForFunction(() => /dodecahedron: 1 note/.test(document.getElementById("cards")?.textContent ?? ""));
  });

  test("undo and redo walk through what was done, by button and by key", async () => {
    const start = await picture(page);
    await page.keyboard.press("3");
    await level(3);
    await page.getByRole("radio", { name: /Linear/ }).click();
    await ready(page, (state) => state.shown.scheme === "linear");
    const titles = () => page.$$eval("#undo, #redo", (buttons) => buttons.map((button) => button.getAttribute("title")));
    assert.deepEqual(await titles(), ["Undo scheme linear", "Redo"]);
    await page.locator("#undo").click();
    await ready(page, (state) => state.shown.scheme === "catmull-clark");
    assert.deepEqual(await titles(), ["Undo level 3", "Redo scheme linear"]);
    await page.keyboard.press("Control+z");
    await level(1);
    assert.deepEqual((await picture(page)).data, start.data, "undone to the same picture");
    await page.keyboard.press("Control+Shift+z");
    await level(3);
    await page.locator("#redo").click();
    await ready(page, (state) => state.shown.scheme === "linear");
    assert.equal((await state(page)).redo, null);
  });

  test("W, C and F change the view", async () => {
    const plain = await picture(page);
    await page.keyboard.press("w");
    await ready(page);
    await page.waitForTimeout(100);
    const other = await picture(page);
    assert.notDeepEqual(other.data, plain.data, "edges on or off");
    await page.keyboard.press("w");
    await page.waitForTimeout(100);
    assert.deepEqual((await picture(page)).data, plain.data, "and back");
    await page.keyboard.press("c");
    await page.waitForTimeout(100);
    const caged = await picture(page);
    assert.notDeepEqual(caged.data, plain.data, "the cage");
    await page.keyboard.press("c");
    // Turned and moved away; framed again, the model has its size back.
    await page.keyboard.press("f");
    await page.waitForTimeout(400);
    const framed = content(await picture(page)).detail;
    for (let i = 0; i < 12; i += 1) await page.keyboard.press("-");
    await page.waitForTimeout(400);
    assert.ok(content(await picture(page)).detail < 0.6 * framed, "zoomed out");
    await page.keyboard.press("f");
    await page.waitForTimeout(400);
    const again = content(await picture(page)).detail;
    assert.ok(Math.abs(again - framed) < 0.1 * framed, `framed: ${again}, before: ${framed}`);
  });

  test("edges are the polygons', without the diagonals of triangles", async () => {
    await cmd(page, "level 0");
    await cmd(page, "view camera=front projection=orthographic");
    await ready(page, (state) => state.shown.level === 0 && /front/.test(state.link));
    const plain = await picture(page);
    await page.keyboard.press("w");
    await page.waitForTimeout(100);
    const edged = await picture(page);
    // One square from the front: its diagonals, crossed at eight places, look as they did, and its four sides do not.
    const differs = (/** @type {number} */ x, /** @type {number} */ y) =>
      Math.abs((plain.data[4 * (y * plain.width + x)] ?? 0) - (edged.data[4 * (y * plain.width + x)] ?? 0)) > 8;
    let [left, right, top, bottom] = [plain.width, 0, plain.height, 0];
    for (let y = 0; y < plain.height; y += 1) {
      for (let x = 0; x < plain.width; x += 1) {
        if (differs(x, y)) [left, right, top, bottom] = [Math.min(left, x), Math.max(right, x), Math.min(top, y), Math.max(bottom, y)];
      }
    }
    assert.ok(right - left > 100 && Math.abs(right - left - (bottom - top)) < 4, `a square: ${[left, right, top, bottom]}`);
    for (const t of [0.2, 0.35, 0.5, 0.65, 0.8]) {
      for (const u of [t, 1 - t]) {
        for (let shift = -3; shift <= 3; shift += 1) {
          assert.ok(!differs(Math.round(left + t * (right - left)) + shift, Math.round(top + u * (bottom - top))), `an edge at ${t}, ${u}`);
        }
      }
    }
  });

  test("the mouse orbits, pans and zooms, and the link follows", async () => {
    const before = await picture(page);
    const link = (await state(page)).link;
    await page.mouse.move(480, 250);
    await page.mouse.down();
    await page.mouse.move(560, 290, { steps: 5 });
    await page.mouse.up();
    await ready(page, (state, link) => state.link !== link, link);
    const orbited = await picture(page);
    assert.notDeepEqual(orbited.data, before.data);
    await page.mouse.wheel(0, -300);
    await page.waitForTimeout(300);
    const zoomed = await picture(page);
    assert.notDeepEqual(zoomed.data, orbited.data);
    await page.waitForTimeout(700);
    assert.equal(await page.evaluate(() => location.hash), (await state(page)).link, "the address is the link");
  });

  test("reload reads a dropped file again, and dropping on top replaces", async () => {
    const path = join(await scratch(), "box.obj");
    await writeFile(path, CUBE);
    await drop(page, [path]);
    await ready(page, (state) => state.model.name.includes("box"));
    await cmd(page, "level 2");
    await ready(page, (state) => state.shown.level === 2);
    assert.equal((await state(page)).shown.faces, 96);
    await writeFile(path, CUBE.replace("f 4 1 5 8\n", ""));
    await page.locator("#reload").click();
    await ready(page, (state) => state.shown.faces === 80);
    assert.equal((await state(page)).shown.level, 2, "the level stays");
    const other = join(await scratch(), "tent.obj");
    await writeFile(other, "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
    await drop(page, [other]);
    await ready(page, (state) => state.model.name.includes("tent"));
    assert.equal((await state(page)).shown.scheme, "loop", "triangles open in Loop");
  });

  test("several files at once: an OBJ finds its materials", async () => {
    const folder = await scratch();
    await writeFile(join(folder, "red.obj"), `mtllib red.mtl\nusemtl red\n${CUBE}`);
    await writeFile(join(folder, "red.mtl"), "newmtl red\nKd 0.9 0.05 0.05\n");
    await drop(page, [join(folder, "red.obj"), join(folder, "red.mtl")]);
    await ready(page, (state) => state.model.name.includes("red"));
    const png = await picture(page);
    let red = 0;
    for (let i = 0; i < png.data.length; i += 4) {
      if ((png.data[i] ?? 0) > 1.6 * (png.data[i + 1] ?? 0) && (png.data[i] ?? 0) > 60) red += 1;
    }
    assert.ok(red > 2_000, `${red} red pixels`);
  });

  test("the console takes the document's commands and explains a wrong one", async () => {
    await page.keyboard.press("/");
    await page.locator("#command").fill("level 2");
    await page.keyboard.press("Enter");
    await level(2);
    await page.locator("#command").fill("levle 2");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => /levle/.test(document.getElementById("log")?.lastElementChild?.textContent ?? ""));
    assert.equal((await state(page)).shown.level, 2);
  });

  test("the view is saved as a PNG of its device pixels", async () => {
    const saved = await download(page, "view.png", () => cmd(page, "export view.png"));
    const { PNG } = await import("pngjs");
    const png = PNG.sync.read(await readFile(saved.path));
    assert.deepEqual([png.width, png.height], [960, 640]);
    assert.ok(content(png).colours > 100);
  });

  test("the help lists the keys, and the theme changes", async () => {
    await page.keyboard.press("?");
    await page.locator("#pane-help").waitFor({ state: "visible" });
    const text = (await page.locator("#pane-help").textContent()) ?? "";
    for (const word of ["Edges", "Cage", "Frame"]) assert.match(text, new RegExp(word));
    await page.keyboard.press("Escape");
    // At the left edge, clear of the fades behind the words: that is the engine's ground.
    const ground = async () => (await picture(page)).data[4 * 960 * 250 + 16] ?? NaN;
    assert.ok((await ground()) < 60, `dark: ${await ground()}`);
    await page.locator("#theme").click();
    await page.waitForTimeout(200);
    assert.ok((await ground()) > 200, `light: ${await ground()}`);
    assert.equal(await page.locator("#theme").textContent(), "Dark");
  });
});
