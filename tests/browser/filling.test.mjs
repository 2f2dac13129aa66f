// Levels that go out of the kernel's memory straight into the GPU's buffers: the same pixels as of levels that the engine packs, on both backends,
// and everything that needs a level on the CPU afterwards still gets one.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { describe, test } from "node:test";
import { promisify } from "node:util";
import { CLI, RENDERERS, cards, cmd, content, difference, download, drop, keep, own, picture, ready, scratch, state } from "./harness.mjs";

describe("levels straight into buffers", () => {
  const here = own();
  /** @param {"webgpu" | "webgl"} renderer @param {string} hash */
  const open = (renderer, hash) => here.visit({ search: `?renderer=${renderer}&compute=off`, hash });

  /** The picture, and the one of the same level packed by the engine: the overlay of points wants it there, and it stays. @param {Awaited<ReturnType<typeof open>>} page */
  const both = async (page) => {
    const straight = await picture(page);
    await cmd(page, "view points=on");
    await ready(page, (state) => state.text.includes("points") || state.link.includes("points"));
    await cmd(page, "view points=off");
    await ready(page, (state) => !state.link.includes("points"));
    return { straight, packed: await picture(page) };
  };

  for (const renderer of RENDERERS) {
    test(`gives the pixels of a level that the engine packs, on ${renderer}`, { timeout: 180_000 }, async () => {
      for (const hash of [
        "#1;open+builtin:creature;scheme+catmull-clark;level+4;view+edges=on",
        "#1;open+builtin:icosahedron;scheme+loop;level+4;view+edges=bold",
        "#1;open+builtin:dodecahedron;scheme+doo-sabin;level+3;view+edges=bold",
        "#1;open+builtin:cube;crease+0-1+10;scheme+catmull-clark;level+3;limit+on",
      ]) {
        const page = await open(renderer, hash);
        const { straight, packed } = await both(page);
        assert.ok(content(straight).detail > 0.0005, `detail ${content(straight).detail} of ${hash}`);
        const found = difference(straight, packed);
        if (found.share > 0) await Promise.all([keep("filling-straight", straight), keep("filling-packed", packed)]);
        assert.deepEqual(found, { inside: 0, atEdges: 0, share: 0, largest: 0 }, hash);
        assert.match((await page.textContent("#status-engine")) ?? "", / on the CPU /);
        await page.close();
      }
    });
  }

  test("materials and texture coordinates go along, on webgl", { timeout: 90_000 }, async () => {
    const folder = await scratch();
    const corner = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1} ${(i >> 1) & 1} ${(i >> 2) & 1}`);
    const faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "2 4 8 6", "4 3 7 8", "3 1 5 7"];
    const list = (/** @type {boolean} */ uv) => faces.map((face, f) =>
      `usemtl ${f % 2 ? "red" : "blue"}\nf ${face.split(" ").map((v, k) => (uv ? `${v}/${k + 1}` : v)).join(" ")}`);
    await writeFile(join(folder, "box.mtl"), "newmtl red\nKd 0.9 0.2 0.1\nnewmtl blue\nKd 0.1 0.3 0.9\n");
    await writeFile(join(folder, "plain.obj"), ["mtllib box.mtl", ...corner, ...list(false)].join("\n"));
    await writeFile(join(folder, "mapped.obj"), ["mtllib box.mtl", ...corner, "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", ...list(true)].join("\n"));
    for (const name of ["plain.obj", "mapped.obj"]) {
      const page = await open("webgl", "");
      await drop(page, [name, "box.mtl"].map((file) => join(folder, file)));
      await ready(page, (state, name) => state.model.name === name, name);
      await cmd(page, "level 4");
      await ready(page, (state) => state.shown.level === 4);
      await cmd(page, "view camera=iso");
      await page.waitForTimeout(300);
      const { straight, packed } = await both(page);
      const found = difference(straight, packed);
      if (found.share > 0) await Promise.all([keep("filling-parts-straight", straight), keep("filling-parts-packed", packed)]);
      assert.deepEqual(found, { inside: 0, atEdges: 0, share: 0, largest: 0 }, name);
      const reds = [...Array(straight.width * straight.height).keys()].filter((i) => (straight.data[4 * i] ?? 0) > 1.5 * (straight.data[4 * i + 2] ?? 0));
      assert.ok(reds.length > 1000, `${reds.length} red pixels of ${name}`);
      await page.close();
    }
  });

  test("a file has the bits of the command line, and the pointer finds the surface", async () => {
    const page = await open("webgl", "#1;open+builtin:pawn;scheme+loop;level+3");
    const file = await download(page, "page.obj", () => cmd(page, "export page.obj"));
    const native = join(await scratch(), "page.obj");
    await promisify(execFile)(CLI, ["builtin:pawn", "scheme", "loop", "level", "3", "export", native]);
    const lines = (/** @type {Buffer} */ bytes) => bytes.toString().split("\n").filter((line) => /^[vf] /.test(line));
    assert.deepEqual(lines(file.bytes), lines(await readFile(native)));
    await cmd(page, "level 4");
    await ready(page, (state) => state.shown.level === 4);
    const before = (await state(page)).link;
    await page.mouse.dblclick(480, 300);
    await ready(page, (state, link) => state.link !== link, before);
  });

  test("a later wish ends the one before, and Undo goes back", async () => {
    const page = await open("webgl", "#1;open+builtin:creature;scheme+catmull-clark;level+3");
    const before = await picture(page);
    for (const level of [5, 3, 5, 4]) await cmd(page, `level ${level}`);
    await ready(page, (state) => state.shown.level === 4);
    assert.equal((await state(page)).shown.faces, 1450 * 256);
    await cmd(page, "level 3");
    await ready(page, (state) => state.shown.level === 3);
    assert.equal(difference(before, await picture(page)).share, 0);
    await cmd(page, "undo");
    await ready(page, (state) => state.shown.level === 4);
    assert.deepEqual(await cards(page), []);
  });

  test("what cannot be filled is packed by the engine", async () => {
    const source = await readFile(new URL("../../web/fill.js", import.meta.url), "utf8");
    const broken = source.replace("step(ROWS, target)", "step(ROWS, { write() { throw new Error('lost'); } })");
    assert.notEqual(broken, source);
    here.site.extra.set("/web/fill.js", broken);
    try {
      const page = await open("webgl", "#1;open+builtin:cube;scheme+catmull-clark;level+3");
      assert.match((await page.textContent("#status-engine")) ?? "", / on the CPU /);
      assert.equal((await state(page)).shown.faces, 384);
      assert.deepEqual(await cards(page), []);
    } finally {
      here.site.extra.delete("/web/fill.js");
    }
  });
});
