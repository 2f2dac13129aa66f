// Bad input: one sentence that says what and where, the last good model stays on the screen, nothing panics.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { cards, cmd, drop, launch, picture, ready, scratch, serveSite, state, tidy, visit } from "./harness.mjs";
import { realGlb } from "./models.mjs";

/** A glTF of one triangle whose buffer is elsewhere. @param {object} [change] */
function gltf(change = {}) {
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ uri: "missing.bin", byteLength: 36 }],
    ...change,
  });
}

/** Bytes that look like nothing, the same every time. @param {number} count */
function noise(count) {
  const bytes = Buffer.alloc(count);
  let x = 12345;
  for (let i = 0; i < count; i += 1) {
    x = (Math.imul(x, 1103515245) + 12345) >>> 0;
    bytes[i] = x >>> 16;
  }
  return bytes;
}

/** @type {Record<string, { name: string, bytes: (glb: Buffer) => Buffer | string, says: RegExp }>} */
const BAD = {
  "an empty file": { name: "empty.obj", bytes: () => "", says: /empty\.obj/ },
  "a truncated GLB": { name: "cut.glb", bytes: (glb) => glb.subarray(0, Math.floor(glb.length * 0.6)), says: /cut\.glb/ },
  "bytes as text": { name: "noise.obj", bytes: () => noise(40_000), says: /noise\.obj/ },
  "bytes as GLB": { name: "noise.glb", bytes: () => noise(40_000), says: /noise\.glb/ },
  "a coordinate that is no number": { name: "nan.obj", bytes: () => "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", says: /line 2/i },
  "an infinite coordinate": { name: "inf.obj", bytes: () => "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", says: /line 3/i },
  "an index out of range": { name: "range.obj", bytes: () => "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", says: /line 4/i },
  "no faces": { name: "points.obj", bytes: () => "v 0 0 0\nv 1 0 0\nv 0 1 0\n", says: /points\.obj/ },
  "a sibling that was not dropped": { name: "alone.gltf", bytes: () => gltf(), says: /missing\.bin/ },
  "a claim of two gigabytes": {
    name: "huge.gltf",
    bytes: () =>
      gltf({
        accessors: [{ bufferView: 0, componentType: 5126, count: 178_956_970, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] }],
        bufferViews: [{ buffer: 0, byteLength: 2_147_483_640 }],
        buffers: [{ uri: "data:application/octet-stream;base64,AAAAAAAAAAAAAAAA", byteLength: 2_147_483_640 }],
      }),
    says: /huge\.gltf/,
  },
  "a GLB whose header claims two gigabytes": {
    name: "claim.glb",
    bytes: (glb) => {
      const copy = Buffer.from(glb);
      copy.writeUInt32LE(0x7fff_fff0, 8);
      return copy;
    },
    says: /claim\.glb/,
  },
  "a kind of file that is not read": { name: "notes.pdf", bytes: () => "%PDF-1.7", says: /notes\.pdf/ },
};

describe("bad input", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Awaited<ReturnType<typeof visit>>} */ let page;
  /** @type {Buffer} */ let glb;
  before(async () => {
    site = await serveSite();
    browser = await launch();
    glb = await readFile(await realGlb("bunny"));
    // One page for all: whatever came before, the good model must still be there.
    page = await visit(browser, site.url, { renderer: "webgpu", hash: "#1;open+builtin:torus;scheme+catmull-clark;level+2" });
  });
  after(async () => {
    assert.deepEqual(page?.errors.filter((text) => !/404/.test(text)), [], "nothing panicked");
    await browser?.close();
    site?.close();
    await tidy();
  });

  for (const [what, { name, bytes, says }] of Object.entries(BAD)) {
    test(`${what}: one card, and the model stays`, async () => {
      const good = await picture(page);
      const before = await state(page);
      const engine = await page.evaluateHandle(() => Reflect.get(window, "limn").engine);
      const path = join(await scratch(), name);
      await writeFile(path, bytes(glb));
      await drop(page, [path]);
      await page.waitForFunction(() => document.querySelector("#cards .card.error"), null, { timeout: 30_000 });
      await ready(page);
      const shown = await cards(page);
      console.log(`  ${shown.map((card) => card.text).join("\n  ")}`);
      assert.equal(shown.length, 1, JSON.stringify(shown));
      assert.match(shown[0]?.text ?? "", says);
      assert.doesNotMatch(shown[0]?.text ?? "", /panick|unwrap|RangeError|undefined|unreachable/);
      const later = await state(page);
      assert.equal(later.text, before.text, "the document is as it was");
      assert.ok(await page.evaluate((engine) => Reflect.get(window, "limn").engine === engine, engine), "the same engine");
      assert.deepEqual((await picture(page)).data, good.data, "the same picture");
      while (await page.locator("#cards .dismiss").count()) await page.locator("#cards .dismiss").first().click();
    });
  }

  test("a level beyond the budget is refused with its numbers", async () => {
    const before = await state(page);
    await cmd(page, "level 100");
    await page.waitForFunction(() => document.querySelector("#cards .card.error"));
    await ready(page);
    const shown = await cards(page);
    console.log(`  ${shown.map((card) => card.text).join("\n  ")}`);
    assert.equal(shown.length, 1);
    assert.match(shown[0]?.text ?? "", /100/);
    assert.equal((await state(page)).shown.level, before.shown.level);
    assert.equal((await state(page)).text, before.text);
  });
});
