// Refinement on the GPU in a real browser: what WebGPU makes is what the kernel makes on the CPU, vertex by vertex, for every scheme
// that has kernels, at every level, on closed, open, creased and mixed cages.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { own } from "./harness.mjs";

/** Schemes with kernels of their own, and whether they take triangles alone. */
const SCHEMES = /** @type {const} */ ([
  ["catmull-clark", false],
  ["linear", false],
  ["doo-sabin", false],
  ["doo-sabin-midpoint", false],
  ["loop", true],
  ["butterfly", true],
  ["modified-butterfly", true],
  ["sqrt3", true],
]);
/** Kept to what a software adapter takes a second for. */
const MOST = 40_000;

describe("refinement on the GPU", () => {
  const here = own();

  test("gives the points that the CPU gives", { timeout: 240_000 }, async () => {
    const page = await here.visit({ search: "?bench", wait: false });
    await page.waitForSelector("#bench-run");
    const rows = await page.evaluate(
      async ({ schemes, most }) => {
        const { Thread } = await import(`${location.origin}/web/bench-host.js`);
        const [cpu, gpu] = await Promise.all(["limn-wasm", "limn-webgpu"].map((id) => Thread.open(id)));
        const rows = [];
        for (const [scheme, triangles] of schemes) {
          for (const name of ["cube", "mouse", "grid", "creature"]) {
            const cage = await cpu.call("cage", triangles ? `${name}-triangles` : name, 6);
            for (const creased of [false, true]) {
              const marks = creased ? { ends: cage.corners.slice(0, 4), sharpness: new Float32Array([1.5, 10]) } : {};
              for (let level = 1; level <= 4; level += 1) {
                const row = { scheme, name, creased, level, compared: 0, worst: 0, why: "" };
                try {
                  await gpu.call("prepare", { ...cage, ...marks }, scheme, level);
                } catch (error) {
                  row.why = error.message;
                  rows.push(row);
                  break;
                }
                if ((await gpu.call("faces")) > most) break;
                await cpu.call("prepare", { ...cage, ...marks }, scheme, level);
                await cpu.call("run", 1);
                const [ours, theirs] = await Promise.all([gpu, cpu].map((thread) => thread.call("surface")));
                const box = [0, 1, 2].map((k) => {
                  let [low, high] = [Infinity, -Infinity];
                  for (let i = k; i < theirs.positions.length; i += 3) [low, high] = [Math.min(low, theirs.positions[i]), Math.max(high, theirs.positions[i])];
                  return high - low;
                });
                const size = Math.max(...box);
                if (ours.positions.length !== theirs.positions.length) row.why = "the counts differ";
                theirs.positions.forEach((/** @type {number} */ x, /** @type {number} */ i) => {
                  const off = Math.abs(x - ours.positions[i]) / size;
                  // NaN must not pass.
                  if (!(off <= row.worst)) row.worst = off;
                });
                row.compared = theirs.positions.length / 3;
                rows.push(row);
              }
            }
          }
        }
        cpu.close();
        gpu.close();
        return rows;
      },
      { schemes: SCHEMES.map((row) => [...row]), most: MOST },
    );
    const compared = rows.filter(({ compared }) => compared);
    for (const row of compared) assert.ok(row.why === "" && row.worst <= 1e-5, JSON.stringify(row));
    for (const [scheme] of SCHEMES) {
      const most = Math.max(...compared.filter((row) => row.scheme === scheme).map(({ level }) => level));
      assert.ok(most >= 3, `${scheme} was compared to level ${most}`);
    }
    const worst = Math.max(...compared.map((row) => row.worst));
    console.log(`# ${compared.length} levels, at most ${worst.toExponential(1)} of the box off`);
    // Where kernels end the CPU goes on: rims and creases of these.
    const refused = rows.filter(({ compared }) => !compared);
    for (const { scheme, why } of refused) {
      assert.equal(why, "it has no kernels for this", scheme);
      assert.ok(!["catmull-clark", "loop", "linear"].includes(scheme), scheme);
    }
  });
});
