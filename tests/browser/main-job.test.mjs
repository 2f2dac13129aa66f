// The main job on real input: drop a model, refine it to level 3, see it on both backends, export it, and read the
// files back with other programs.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { after, before, describe, test } from "node:test";
import { readFile } from "node:fs/promises";
import { basename } from "node:path";
import { promisify } from "node:util";
import validator from "gltf-validator";
import { CLI, RENDERERS, cards, cmd, difference, download, drop, keep, launch, picture, ready, serveSite, state, tidy, visit } from "./harness.mjs";
import { readGlb, readObj, realGlb, realObj } from "./models.mjs";

const run = promisify(execFile);
const LEVEL = 3;

describe("a real model", () => {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Record<string, { path: string, scheme: string }>} */ let models = {};
  before(async () => {
    site = await serveSite();
    browser = await launch();
    models = {
      OBJ: { path: realObj("lamp"), scheme: "catmull-clark" },
      GLB: { path: await realGlb("bunny"), scheme: "loop" },
    };
  });
  after(async () => {
    await browser?.close();
    site?.close();
    await tidy();
  });

  for (const kind of /** @type {const} */ (["OBJ", "GLB"])) {
    test(`${kind}: dropped, refined, drawn alike on both backends, exported and read back`, { timeout: 300_000 }, async () => {
      const model = models[kind];
      assert.ok(model);
      const name = basename(model.path);
      const native = JSON.parse((await run(CLI, [model.path, "scheme", model.scheme, "level", String(LEVEL), "info", "--json"])).stdout);
      const pictures = [];
      for (const renderer of RENDERERS) {
        const page = await visit(browser, site.url, { renderer });
        await drop(page, [model.path]);
        await ready(page, (state, name) => state.model.name.includes(name), name.replace(/\.\w+$/, ""));
        // The lamp names a material library that is not there: reported, and no reason to refuse the model.
        assert.deepEqual((await cards(page)).filter((card) => card.kind === "error"), []);
        if (kind === "OBJ") {
          const report = (await state(page)).report.map((/** @type {{ text: string }} */ line) => line.text).join("\n");
          assert.match(report, /vp\.mtl/, "what the file asks for and did not get is reported");
        }
        await cmd(page, `scheme ${model.scheme}`);
        await cmd(page, `level ${LEVEL}`);
        await ready(page, (state, [scheme, level]) => state.shown.level === level && state.shown.scheme === scheme, [model.scheme, LEVEL]);
        const shown = (await state(page)).shown;
        assert.deepEqual([shown.vertices, shown.edges, shown.faces], [native.vertices, native.edges, native.faces], "the page and the command line agree");
        pictures.push(await picture(page));

        if (renderer === "webgpu") {
          await readsBack(page, model, native);
        }
        assert.deepEqual(page.errors, []);
        await page.context().close();
      }
      const [a, b] = pictures;
      assert.ok(a && b);
      await Promise.all([keep(`main-${kind.toLowerCase()}-webgpu`, a), keep(`main-${kind.toLowerCase()}-webgl`, b)]);
      const found = difference(a, b);
      assert.equal(found.inside, 0, `${found.inside} pixels away from edges differ by up to ${found.largest}`);
      assert.ok(found.share <= 0.001, `${(100 * found.share).toFixed(3)}% of the pixels differ`);
    });
  }
});

/**
 * Exports both formats and reads them with other programs.
 * @param {import("playwright-core").Page} page
 * @param {{ path: string, scheme: string }} model
 * @param {any} native what the command line says about the same surface
 */
async function readsBack(page, model, native) {
  const obj = await download(page, "refined.obj", () => cmd(page, "export refined.obj"));
  assert.deepEqual(obj.names, ["refined.mtl", "refined.obj"], "materials come in a file of their own");
  const { positions, faces } = readObj(obj.bytes.toString("utf8"));
  assert.equal(positions.length, native.vertices);
  assert.equal(faces.length, native.faces);
  assert.ok(faces.every((face) => face.every((index) => index >= 0 && index < positions.length)));

  // Full precision and canonical order: the command line writes the same coordinates, to the bit.
  const out = `${obj.path}.native.obj`;
  await run(CLI, [model.path, "scheme", model.scheme, "level", String(LEVEL), "export", out]);
  const other = readObj(await readFile(out, "utf8"));
  assert.deepEqual(positions.map((p) => p.map(Math.fround)), other.positions.map((p) => p.map(Math.fround)));
  assert.deepEqual(faces, other.faces);

  const glb = await download(page, "refined.glb", () => cmd(page, "export refined.glb"));
  const report = await validator.validateBytes(new Uint8Array(glb.bytes));
  assert.equal(report.issues.numErrors, 0, JSON.stringify(report.issues.messages.slice(0, 3)));
  assert.equal(report.issues.numWarnings, 0, JSON.stringify(report.issues.messages.slice(0, 3)));
  const read = await readGlb(glb.bytes);
  const corners = faces.reduce((sum, face) => sum + face.length - 2, 0);
  assert.equal(read.triangles, corners, "a polygon of n corners is n - 2 triangles");
  for (const axis of [0, 1, 2]) {
    const values = positions.map((p) => Math.fround(p[axis] ?? NaN));
    const low = values.reduce((a, b) => Math.min(a, b), Infinity);
    const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    assert.deepEqual([read.bounds[0]?.[axis], read.bounds[1]?.[axis]], [low, high]);
  }

  // And once more by Limn: the refined file is a closed, or as open, surface as its source.
  const back = JSON.parse((await run(CLI, [obj.path, "level", "0", "info", "--json"])).stdout);
  assert.deepEqual([back.vertices, back.edges, back.faces], [native.vertices, native.edges, native.faces]);
  assert.deepEqual([back.boundary_loops, back.components], [native.boundary_loops, native.components]);
}
