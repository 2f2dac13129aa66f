// Where models come from beside a dropped file: an address, a link that names a file, the file dialog, a folder; and all of
// them once more by Reload.

import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, describe, test } from "node:test";
import { mkdir, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { PNG } from "pngjs";
import { cards, cmd, difference, drop, launch, picture, ready, scratch, serveSite, state, tidy, visit } from "./harness.mjs";

/** An open box: five quads. */
const BOX = `o box
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 4 1 5 8
`;
/** The same, closed. */
const CLOSED = `${BOX}f 3 4 8 7\n`;

describe("a source", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** Lets other sites read its files. @type {Awaited<ReturnType<typeof serveSite>>} */ let open;
  /** Does not. @type {Awaited<ReturnType<typeof serveSite>>} */ let closed;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Awaited<ReturnType<typeof visit>>} */ let page;
  before(async () => {
    [site, open, closed] = await Promise.all([serveSite(), serveSite({ cors: true }), serveSite()]);
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    for (const server of [site, open, closed]) server?.close();
    await tidy();
  });
  beforeEach(async () => {
    page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:torus;scheme+catmull-clark;level+1" });
  });
  afterEach(async () => {
    // The browser itself logs answers that it did not like.
    assert.deepEqual(page.errors.filter((text) => !/Failed to load resource|blocked by CORS/.test(text)), []);
    await page.context().close();
  });

  test("is an address: opened, linked, and read again", async () => {
    open.extra.set("/models/box 1.obj", BOX);
    await cmd(page, `open ${open.url}models/box%201.obj`);
    await ready(page, (state) => state.model.name.includes("box"));
    assert.equal((await state(page)).shown.faces, 5);
    await cmd(page, "level 3");
    await ready(page, (state) => state.shown.level === 3);
    assert.deepEqual(await cards(page), []);
    const sent = await picture(page);
    const { link } = await state(page);
    const other = await visit(browser, site.url, { renderer: "webgpu", hash: link });
    // Ready means ready: what a link names is waited for.
    assert.equal((await state(other)).shown.faces, 5 * 64, "the link brings model and level");
    assert.equal(await other.evaluate(() => location.hash), link);
    assert.equal(difference(sent, await picture(other)).share, 0, "and the picture");
    await other.context().close();

    open.extra.set("/models/box 1.obj", CLOSED);
    await page.locator("#reload").click();
    await ready(page, (state) => state.shown.faces === 6 * 64);
    assert.equal((await state(page)).shown.level, 3, "read again at the same level");
    assert.equal(await page.locator("#undo").getAttribute("title"), "Undo reload");
  });

  test("is an address: typed into the menu, or dropped", async () => {
    open.extra.set("/box.obj", BOX);
    await page.locator("#model").click();
    await page.locator("#url").fill(`${open.url}box.obj`);
    await page.locator("#url").press("Enter");
    await ready(page, (state) => state.model.name === "box.obj");
    assert.ok(await page.locator("#models").isHidden(), "the menu has closed");
    assert.equal(await page.locator("#model-name").textContent(), "box.obj");

    open.extra.set("/tent.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
    const session = await page.context().newCDPSession(page);
    const data = { items: [{ mimeType: "text/uri-list", data: `${open.url}tent.obj` }], dragOperationsMask: 1 };
    for (const type of /** @type {const} */ (["dragEnter", "dragOver", "drop"])) {
      await session.send("Input.dispatchDragEvent", { type, x: 480, y: 200, data });
    }
    await ready(page, (state) => state.model.name === "tent.obj" && state.shown.faces === 4);
  });

  /** @type {Record<string, { url: () => string, says: RegExp }>} */
  const refused = {
    "whose server lets nobody read it": { url: () => `${closed.url}box.obj`, says: /^box\.obj could not be opened \| .*box\.obj: it could not be reached, or its server does not allow .*\(CORS\)/ },
    "that is not there": { url: () => `${open.url}gone.obj`, says: /^gone\.obj could not be opened \| .*the server answered 404/ },
    "where nobody listens": { url: () => "http://127.0.0.1:9/box.obj", says: /^box\.obj could not be opened \| .*could not be reached/ },
    "with something else": { url: () => `${open.url}page.obj`, says: /^page\.obj could not be opened/ },
  };
  for (const [what, { url, says }] of Object.entries(refused)) {
    test(`is an address ${what}: one card, and the model stays`, async () => {
      closed.extra.set("/box.obj", BOX);
      open.extra.set("/page.obj", "<!doctype html><p>Please sign in</p>");
      const before = await state(page);
      const good = await picture(page);
      await cmd(page, `open ${url()}`);
      await page.waitForFunction(() => document.querySelector("#cards .card.error"));
      await ready(page);
      const shown = await cards(page);
      console.log(`  ${shown.map((card) => card.text).join("\n  ")}`);
      assert.equal(shown.length, 1, JSON.stringify(shown));
      assert.match(shown[0]?.text ?? "", says);
      assert.equal((await state(page)).text, before.text);
      assert.ok(await page.locator("#progress").isHidden());
      assert.deepEqual((await picture(page)).data, good.data);
    });
  }

  test("is an address that takes long: Cancel ends it", async () => {
    let over = false;
    open.extra.set("/slow.obj", (response) => {
      response.writeHead(200, { "content-length": 1_000_000 });
      const drip = setInterval(() => response.write("# and so it goes on\n".repeat(50)), 50);
      response.on("close", () => {
        clearInterval(drip);
        over = true;
      });
    });
    const before = await state(page);
    await cmd(page, `open ${open.url}slow.obj`);
    await page.waitForFunction(() => /Reading slow\.obj {2}\d+%/.test(document.getElementById("progress-what")?.textContent ?? ""));
    await page.locator("#cancel").click();
    await ready(page);
    await page.waitForTimeout(300);
    assert.ok(over, "nothing is read any more");
    assert.ok(await page.locator("#progress").isHidden(), "and nothing says that it is");
    assert.equal((await state(page)).text, before.text);
    assert.deepEqual(await cards(page), []);
  });

  test("is a file that a link names: asked for, and then all is as it was sent", async () => {
    const folder = await scratch();
    const path = join(folder, "box.obj");
    await writeFile(path, BOX);
    await drop(page, [path]);
    await ready(page, (state) => state.model.name === "box.obj");
    await cmd(page, "boundary edge-and-corner");
    await cmd(page, "level 3");
    await cmd(page, "view edges=on");
    await ready(page, (state) => state.shown.level === 3);
    const sent = await picture(page);
    await page.locator("#copy").click();
    assert.match((await page.locator("#toast").textContent()) ?? "", /names box\.obj but does not hold it/);
    const { link, text } = await state(page);

    const other = await visit(browser, site.url, { renderer: "webgpu", hash: link });
    const [card, ...more] = await cards(other);
    assert.deepEqual(more, []);
    assert.match(card?.text ?? "", /^This link shows box\.obj \|/);
    assert.match((await state(other)).model.name, /creature/, "something to look at meanwhile");
    assert.equal(await other.evaluate(() => location.hash), link, "the address waits, too");

    // Another file by that name is not the one.
    const wrong = join(await scratch(), "box.obj");
    await writeFile(wrong, CLOSED);
    await give(other, wrong);
    await other.waitForFunction(() => document.querySelector("#cards .card.error"));
    assert.match((await cards(other)).map((card) => card.text).join("\n"), /box\.obj could not be opened \| .*size is \d+ bytes, not \d+/);
    assert.match((await state(other)).model.name, /creature/);
    await other.locator("#cards .card.error .dismiss").click();

    await give(other, path);
    await ready(other, (state) => state.model.name === "box.obj" && state.shown.level === 3);
    assert.equal((await state(other)).shown.faces, 5 * 64);
    assert.equal((await state(other)).text, text);
    assert.deepEqual(await cards(other), []);
    assert.equal(difference(sent, await picture(other)).share, 0);
    assert.deepEqual(other.errors, []);
    await other.context().close();
  });

  test("is a file that a link names and that has changed since: it can be opened as a new model", async () => {
    const folder = await scratch();
    const path = join(folder, "box.obj");
    await writeFile(path, BOX);
    const hash = "#1;open+file:box.obj,9999,0123456789abcdef;scheme+catmull-clark;level+3";
    const other = await visit(browser, site.url, { renderer: "webgpu", hash });
    await drop(other, [path]);
    await other.waitForFunction(() => document.querySelector("#cards .card.error"));
    assert.match((await cards(other)).map((card) => card.text).join("\n"), /open it as a new model instead/);
    await drop(other, [path]);
    await ready(other, (state) => state.model.name === "box.obj" && state.shown.faces === 5);
    assert.deepEqual(await cards(other), []);
    await other.context().close();
  });

  test("is chosen in the file dialog, and Reload says what the browser allows", async () => {
    const path = join(await scratch(), "box.obj");
    await writeFile(path, BOX);
    // The dialog is caught from here on.
    page.on("filechooser", () => {});
    await page.waitForTimeout(100);
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.keyboard.press("o")]);
    assert.ok(chooser.isMultiple());
    await chooser.setFiles([path]);
    await ready(page, (state) => state.model.name === "box.obj" && state.shown.faces === 5);
    await cmd(page, "level 2");
    await ready(page, (state) => state.shown.level === 2);
    const before = await picture(page);
    await page.locator("#reload").click();
    await page.waitForTimeout(500);
    await ready(page, (state) => state.shown.level === 2);
    assert.deepEqual(await cards(page), [], "unchanged, it is read again");
    assert.deepEqual((await picture(page)).data, before.data);

    await writeFile(path, CLOSED);
    await page.locator("#reload").click();
    await page.waitForFunction(() => document.querySelector("#cards .card"));
    const [card] = await cards(page);
    assert.match(card?.text ?? "", /^box\.obj has changed on disk: open it again \|/);
    assert.equal((await state(page)).shown.faces, 5 * 16, "what was there stays");
    // The card's own button opens the dialog, and what was done to the model is done to the new file.
    const [again] = await Promise.all([page.waitForEvent("filechooser"), page.locator("#cards .main").click()]);
    await again.setFiles([path]);
    await ready(page, (state) => state.model.name === "box.obj" && state.shown.faces === 6 * 16);
    assert.deepEqual(await cards(page), [], "the card has done its work");
  });

  test("is a folder: the model finds its materials and pictures, again after a change", async () => {
    const folder = join(await scratch(), "crate");
    await mkdir(join(folder, "models/textures"), { recursive: true });
    const green = new PNG({ width: 4, height: 4 });
    for (let i = 0; i < green.data.length; i += 4) green.data.set([10, 220, 20, 255], i);
    await writeFile(join(folder, "models/textures/green.png"), PNG.sync.write(green));
    // Two others of that name: only the path tells which is meant.
    const red = new PNG({ width: 4, height: 4 });
    for (let i = 0; i < red.data.length; i += 4) red.data.set([220, 20, 10, 255], i);
    for (const old of ["a-old", "z-old"]) {
      await mkdir(join(folder, old));
      await writeFile(join(folder, old, "green.png"), PNG.sync.write(red));
    }
    await writeFile(join(folder, "models/crate.mtl"), "newmtl paint\nKd 1 1 1\nmap_Kd textures/green.png\n");
    const textured = (/** @type {string} */ text) => text
      .replace("o box\n", "mtllib crate.mtl\no box\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl paint\n")
      .replace(/f (\d) (\d) (\d) (\d)/g, "f $1/1 $2/2 $3/3 $4/4");
    await writeFile(join(folder, "models/crate.obj"), textured(BOX));
    await writeFile(join(folder, "readme.txt"), "A crate.\n");
    await writeFile(join(folder, ".hidden.obj"), "not a model");
    await drop(page, [folder]);
    await ready(page, (state) => state.model.name === "crate.obj");
    assert.deepEqual((await cards(page)).filter((card) => card.kind === "error"), []);
    assert.ok(greens(await picture(page)) > 5_000, `${greens(await picture(page))} green pixels`);

    await writeFile(join(folder, "models/crate.obj"), textured(CLOSED));
    await page.locator("#reload").click();
    await ready(page, (state) => state.shown.faces === 6);
    assert.ok(greens(await picture(page)) > 5_000);
  });

  test("is a folder with nothing in it: that is said", async () => {
    await drop(page, [await scratch()]);
    await page.waitForFunction(() => /no files/.test(document.getElementById("toast")?.textContent ?? ""));
    assert.match((await state(page)).model.name, /torus/);
  });
});

/** Gives a file to the card that asks for it. @param {import("playwright-core").Page} page @param {string} path */
async function give(page, path) {
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.locator("#cards .main").click()]);
  await chooser.setFiles([path]);
}

/** @param {PNG} png */
function greens(png) {
  let count = 0;
  for (let i = 0; i < png.data.length; i += 4) {
    const [r, g, b] = [png.data[i] ?? 0, png.data[i + 1] ?? 0, png.data[i + 2] ?? 0];
    if (g > 60 && g > 2 * r && g > 2 * b) count += 1;
  }
  return count;
}
