// The module with every scheme: common schemes never load it, the first rare one loads it once, and a visitor who cannot
// load it keeps the picture.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { after, before, describe, test } from "node:test";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { promisify } from "node:util";
import { CLI, RENDERERS, cards, cmd, download, launch, picture, ready, scratch, serveSite, state, tidy, visit } from "./harness.mjs";

const run = promisify(execFile);
const WASM = "/pkg/kernel/limn_kernel_bg.wasm";
/** Vertices and faces of an OBJ file. @param {Buffer} bytes */
const lines = (bytes) => bytes.toString().split("\n").filter((line) => /^[vf] /.test(line));

describe("the module with every scheme", () => {
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
  /** What was fetched of it so far. */
  const loaded = () => site.sent.map(({ path }) => path).filter((path) => path.startsWith("/pkg/kernel/"));
  /** @param {Awaited<ReturnType<typeof visit>>} page @param {string} id */
  const choose = async (page, id) => {
    await cmd(page, `scheme ${id}`);
    await ready(page, (state, id) => state.shown.scheme === id, id);
  };

  for (const renderer of RENDERERS) {
    test(`comes with the first scheme that needs it, once, on ${renderer}`, async () => {
      site.sent.length = 0;
      const page = await visit(browser, site.url, { renderer, hash: "#1;open+builtin:icosahedron;scheme+catmull-clark;level+2" });
      for (const id of ["loop", "catmull-clark"]) await choose(page, id);
      assert.deepEqual(loaded(), [], "the common schemes do without");
      await choose(page, "doo-sabin");
      assert.deepEqual(loaded().sort(), ["/pkg/kernel/limn_kernel.js", WASM]);
      const { shown } = await state(page);
      assert.deepEqual([shown.vertices, shown.edges, shown.faces], [240, 480, 242]);
      for (const id of ["sqrt3", "loop", "butterfly", "doo-sabin"]) await choose(page, id);
      await cmd(page, "open builtin:octahedron");
      await ready(page, (state) => state.model.name === "octahedron");
      await choose(page, "modified-butterfly");
      assert.equal(loaded().length, 2, "other schemes, and another model, load nothing");
      assert.deepEqual(await cards(page), []);
      assert.deepEqual(page.errors, []);
      await page.context().close();
    });
  }

  test("has a build for browsers without vectors, with the command line's bits", async () => {
    const old = await launch({ vectors: false });
    const folder = await scratch();
    site.sent.length = 0;
    for (const [model, id, level] of [["pawn", "catmull-clark", 4], ["icosahedron", "loop", 5], ["pawn", "doo-sabin", 3]]) {
      const page = await visit(old, site.url, { hash: `#1;open+builtin:${model};scheme+${id};level+${level}` });
      // What the engine for WebGPU is made of it refuses, and draws by the other one.
      assert.equal((await page.locator("#status").textContent())?.includes("WebGL2"), true);
      const file = await download(page, "page.obj", () => cmd(page, "export page.obj"));
      const native = join(folder, `${id}.obj`);
      await run(CLI, [`builtin:${model}`, "scheme", `${id}`, "level", `${level}`, "export", native]);
      assert.deepEqual(lines(file.bytes), lines(await readFile(native)), id);
      assert.deepEqual(await cards(page), []);
      await page.context().close();
    }
    await old.close();
    assert.deepEqual(loaded(), []);
    assert.ok(site.sent.some(({ path }) => path === "/pkg/plain/limn_kernel_bg.wasm"));
  });

  test("makes the same bits as the command line", async () => {
    const folder = await scratch();
    for (const id of ["doo-sabin", "sqrt3", "j-spline"]) {
      const page = await visit(browser, site.url, { renderer: "webgpu", hash: `#1;open+builtin:pawn;scheme+${id};level+2` });
      const file = await download(page, "page.obj", () => cmd(page, "export page.obj"));
      const native = join(folder, "page.obj");
      await run(CLI, ["builtin:pawn", "scheme", id, "level", "2", "export", native]);
      const [a, b] = [lines(file.bytes), lines(await readFile(native))];
      assert.ok(a.length > 1000);
      assert.deepEqual(a, b, id);
      assert.deepEqual(page.errors, []);
      await page.context().close();
    }
  });

  test("takes its work in slices: Cancel goes back, and a new wish drops an older one", { timeout: 120_000 }, async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:creature;scheme+doo-sabin;level+1" });
    const before = await state(page);
    const still = await picture(page);
    await cmd(page, "level 6");
    await page.locator("#cancel").waitFor({ state: "visible" });
    assert.match((await page.locator("#progress-what").textContent()) ?? "", /^Refining to level 6 {2}\d+%$/);
    await page.locator("#cancel").click();
    await ready(page, (state) => state.level === 1);
    assert.equal((await state(page)).text, before.text);
    assert.deepEqual((await picture(page)).data, still.data);
    await cmd(page, "level 6");
    await cmd(page, "level 2");
    await ready(page, (state) => state.shown.level === 2);
    await cmd(page, "level 1");
    await ready(page, (state) => state.shown.level === 1);
    assert.deepEqual((await picture(page)).data, still.data);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });

  test("that cannot be loaded is said, the picture stays, and choosing again works", async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:cube;scheme+catmull-clark;level+2" });
    const before = await state(page);
    const still = await picture(page);
    for (const part of [WASM, "/pkg/kernel/limn_kernel.js"]) {
      site.extra.set(part, (response) => void response.writeHead(404).end());
      await cmd(page, "scheme doo-sabin");
      await page.locator("#cards .card.error").waitFor();
      await ready(page, (state) => state.scheme === "catmull-clark");
      assert.deepEqual(await cards(page), [{ kind: "error", text: "A part of Limn could not be loaded | Doo–Sabin needs it. Check the connection and choose it again." }]);
      assert.equal((await state(page)).text, before.text);
      assert.equal((await state(page)).undo, before.undo, "what could not be done is no step to undo");
      assert.deepEqual((await picture(page)).data, still.data);
      await page.locator("#cards .dismiss").click();
      site.extra.clear();
    }
    await choose(page, "doo-sabin");
    assert.deepEqual(await cards(page), []);
    assert.equal((await state(page)).shown.faces, 98);
    assert.deepEqual(page.errors.filter((text) => !/Failed to load resource/.test(text)), []);
    await page.context().close();
  });

  test("that cannot be loaded for a link leaves the model itself", async () => {
    site.extra.set(WASM, (response) => void response.writeHead(404).end());
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:mouse;scheme+doo-sabin;level+2" });
    assert.equal((await state(page)).shown.level, 0);
    assert.match((await cards(page))[0]?.text ?? "", /^A part of Limn could not be loaded \| Doo–Sabin needs it/);
    site.extra.clear();
    await cmd(page, "level 1");
    await ready(page, (state) => state.shown.level === 1);
    assert.deepEqual(await cards(page), [], "the card goes when it is there");
    await page.context().close();
  });

  test("is waited for: Cancel gives up, progress says what is loaded, and orbiting goes on", async () => {
    const page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:cube;scheme+catmull-clark;level+1" });
    /** @type {(() => void)[]} */
    const held = [];
    const body = await (await fetch(new URL(WASM, site.url))).arrayBuffer();
    site.extra.set(WASM, (response) => {
      held.push(() => response.writeHead(200, { "content-type": "application/wasm" }).end(Buffer.from(body)));
    });
    await cmd(page, "scheme doo-sabin");
    await page.locator("#progress-what").filter({ hasText: "Loading the scheme" }).waitFor();
    const still = await picture(page);
    await cmd(page, "view camera=top");
    await page.waitForTimeout(500);
    assert.notDeepEqual((await picture(page)).data, still.data, "the last picture turns");
    await page.locator("#cancel").click();
    await ready(page, (state) => state.scheme === "catmull-clark");
    assert.ok(await page.locator("#progress").isHidden());
    held.splice(0).forEach((go) => go());
    await page.waitForTimeout(300);
    assert.equal((await state(page)).shown.scheme, "catmull-clark", "what comes late changes nothing");
    site.sent.length = 0;
    await choose(page, "doo-sabin");
    assert.deepEqual(loaded(), [], "and is there the next time");
    site.extra.clear();
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
});
