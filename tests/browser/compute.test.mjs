// Refinement on the GPU in a real browser: what WebGPU makes is what the kernel makes on the CPU, vertex by vertex, for every scheme
// that has kernels, at every level, on closed, open, creased and mixed cages.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { describe, test } from "node:test";
import { promisify } from "node:util";
import { PNG } from "pngjs";
import { CLI, cards, cmd, content, difference, download, drop, keep, own, picture, ready, scratch, state } from "./harness.mjs";

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
const MOST = 12_000;

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

  test("gives the same points by patches", { timeout: 240_000 }, async () => {
    const page = await here.visit({ search: "?bench", wait: false });
    await page.waitForSelector("#bench-run");
    const rows = await page.evaluate(async () => {
      const { Thread } = await import(`${location.origin}/web/bench-host.js`);
      const [cpu, gpu] = await Promise.all(["limn-wasm", "limn-webgpu"].map((id) => Thread.open(id)));
      const positions = new Float32Array([0, 0, 0, 1, 0, 0.2, 2, 0, 0, 0, 1, 0.3, 1, 1, 0, 2, 1, 0.1, 0.5, 2, 0.4, 1.5, 1.8, 0]);
      const open = (/** @type {number[][]} */ faces) =>
        ({ positions, counts: new Uint32Array(faces.map(({ length }) => length)), corners: new Uint32Array(faces.flat()) });
      const cages = {
        "a cube": await cpu.call("cage", "cube", 1),
        "a cube in triangles": await cpu.call("cage", "cube-triangles", 1),
        "an open cage": open([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 6], [4, 5, 7, 6]]),
        "an open cage in triangles": open([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 6]]),
      };
      const rows = [];
      for (const [scheme, name, creased, level] of /** @type {const} */ ([
        ["catmull-clark", "a cube", false, 5],
        ["catmull-clark", "a cube", true, 5],
        ["catmull-clark", "an open cage", false, 6],
        ["catmull-clark", "an open cage", true, 5],
        ["linear", "an open cage", false, 5],
        ["loop", "a cube in triangles", false, 5],
        ["loop", "an open cage in triangles", true, 5],
      ])) {
        const cage = cages[name];
        const marks = { ends: cage.corners.slice(0, creased ? 4 : 0), sharpness: new Float32Array(creased ? [1.5, 10] : []) };
        for (const thread of [cpu, gpu]) await thread.call("prepare", { ...cage, ...marks }, scheme, level);
        await cpu.call("run", 1);
        const [ours, theirs] = await Promise.all([gpu, cpu].map((thread) => thread.call("surface")));
        const row = { scheme, name, creased, level, kernels: await gpu.call("kernels"), compared: theirs.positions.length, worst: 0, why: "" };
        let [low, high] = [Infinity, -Infinity];
        for (const x of theirs.positions) [low, high] = [Math.min(low, x), Math.max(high, x)];
        if (ours.positions.length !== theirs.positions.length) row.why = "the counts differ";
        theirs.positions.forEach((/** @type {number} */ x, /** @type {number} */ i) => {
          const off = Math.abs(x - ours.positions[i]) / (high - low);
          // NaN must not pass.
          if (!(off <= row.worst)) row.worst = off;
        });
        rows.push(row);
      }
      cpu.close();
      gpu.close();
      return rows;
    });
    for (const row of rows) {
      const text = JSON.stringify(row);
      assert.ok(row.kernels.includes("patches"), text);
      assert.ok(row.why === "" && row.compared > 3000 && row.worst <= 1e-5, text);
    }
    console.log(`# patches: at most ${Math.max(...rows.map(({ worst }) => worst)).toExponential(1)} of the box off`);
  });

  test("gives by rows what every scheme gives, and follows a cage that moves", { timeout: 120_000 }, async () => {
    const page = await here.visit({ search: "?bench", wait: false });
    const cases = await page.evaluate(async () => {
      const { Runner } = await import(`${location.origin}/web/compute.js`);
      const { Trial, default: load } = await import(`${location.origin}/pkg/trial/limn_kernel.js`);
      await load({ module_or_path: fetch(`${location.origin}/pkg/trial/limn_kernel_bg.wasm`) });
      const device = await (await navigator.gpu.requestAdapter())?.requestDevice();
      const runner = new Runner(device);
      // What passes to the device, and how many buffers are made.
      let sent = /** @type {number[]} */ ([]);
      let made = 0;
      const [write, create] = [device.queue.writeBuffer, device.createBuffer];
      device.queue.writeBuffer = (/** @type {any[]} */ ...args) => (sent.push(args[2].byteLength), write.apply(device.queue, args));
      device.createBuffer = (/** @type {any} */ descriptor) => ((made += 1), create.call(device, descriptor));
      /** @param {Float32Array} ours four numbers a vertex @param {Float32Array} theirs three */
      const distance = (ours, theirs) => {
        if (ours.length / 4 !== theirs.length / 3) return Infinity;
        let worst = 0;
        const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
        theirs.forEach((x, i) => {
          const k = i % 3;
          [low[k], high[k]] = [Math.min(low[k] ?? 0, x), Math.max(high[k] ?? 0, x)];
          const off = Math.abs(x - (ours[4 * ((i - k) / 3) + k] ?? NaN));
          // NaN must not pass.
          if (!(off <= worst)) worst = off;
        });
        return worst / Math.max(...high.map((x, k) => x - (low[k] ?? 0)));
      };
      const cases = [];
      for (const scheme of Trial.schemes()) {
        // The pyramid is open and has faces of three and four corners.
        const pyramid = { positions: new Float32Array([0, 0, 0, 2, 0, 0.1, 2, 2, 0, 0, 2, 0.3, 1, 1, 1.5, 3, 1, 0.2, 3, 3, 0]), counts: [3, 3, 3, 3, 4], corners: [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 5, 6, 2] };
        const cube = Trial.cage("cube", 0);
        const closed = { positions: cube.positions(), counts: cube.face_counts(), corners: cube.face_corners() };
        for (const [name, cage] of Object.entries({ closed, open: pyramid })) {
          for (const creased of [false, true]) {
            const marks = creased ? [new Uint32Array([cage.corners[0], cage.corners[1], cage.corners[1], cage.corners[2]]), new Float32Array([1.5, 10])] : [new Uint32Array(), new Float32Array()];
            const of = (/** @type {Float32Array} */ positions) => {
              const trial = Trial.of(positions, cage.counts, cage.corners, ...marks);
              if (trial.predicted(scheme, 1)) return trial;
              // Cut into triangles, each a fan.
              const fans = [];
              let first = 0;
              for (const n of cage.counts) {
                for (let k = 2; k < n; k += 1) fans.push(cage.corners[first], cage.corners[first + k - 1], cage.corners[first + k]);
                first += n;
              }
              return Trial.of(positions, new Array(fans.length / 3).fill(3), fans, ...marks);
            };
            const there = new Float32Array(cage.positions);
            const elsewhere = there.map((x, i) => (i >= 3 && i < 6 ? 1.5 * x - 0.4 : x));
            const [before, after] = [of(there), of(elsewhere)];
            for (const level of [1, 2, 3]) {
              if (level > 1 && before.predicted(scheme, level) > 3000) break;
              for (const rows of [true, false]) {
                const drawing = before.draw(scheme, level, ...runner.limits, rows);
                const row = { scheme, name, creased, level, rows, there: drawing !== undefined, worst: NaN, moved: NaN, sent: [0], made: 0 };
                cases.push(row);
                if (!drawing) continue;
                const refiner = await runner.prepare(drawing, []);
                const read = async () => new Float32Array(await refiner.read(refiner.vertices, refiner.count * 16));
                refiner.run();
                before.run(scheme, level, false);
                row.worst = distance(await read(), before.positions());
                if (level === 2) {
                  [sent, made] = [[], 0];
                  refiner.move(1, new Float32Array([...elsewhere.slice(3, 6), 0]));
                  refiner.run();
                  [row.sent, row.made] = [[...sent], made];
                  after.run(scheme, level, false);
                  row.moved = distance(await read(), after.positions());
                }
                refiner.free();
                drawing.free();
              }
            }
          }
        }
      }
      return cases;
    });
    const schemes = new Set(cases.map(({ scheme }) => scheme));
    assert.ok(schemes.size >= 18, [...schemes].join());
    for (const row of cases.filter(({ there }) => there)) {
      const what = JSON.stringify(row);
      assert.ok(row.worst <= 1e-5, what);
      if (row.level !== 2) continue;
      // One vertex has moved, and nothing else has passed.
      assert.ok(row.moved <= 1e-5, what);
      assert.deepEqual([row.sent, row.made], [[16], 0], what);
    }
    // Rows there are for everything, kernels for those of SCHEMES.
    assert.deepEqual(cases.filter((row) => row.rows && !row.there), []);
    const fused = new Set(cases.filter((row) => !row.rows && row.there).map(({ scheme }) => scheme));
    assert.deepEqual([...fused].sort(), SCHEMES.map(([scheme]) => scheme).sort());
    for (const scheme of schemes) {
      const most = Math.max(...cases.filter((row) => row.scheme === scheme && row.rows).map(({ level }) => level));
      assert.ok(most >= (scheme === "n-way" ? 2 : 3), `${scheme} was compared to level ${most}`);
    }
    console.log(`# ${cases.filter(({ there }) => there).length} levels, at most ${Math.max(...cases.filter(({ there }) => there).map(({ worst }) => worst)).toExponential(1)} of the box off`);
  });

  /** @param {string} hash @param {"on" | "off"} compute */
  const open = (hash, compute = "on") => here.visit({ search: `?renderer=webgpu&compute=${compute}`, hash });
  /** @param {Awaited<ReturnType<typeof open>>} page */
  const said = (page) => page.textContent("#status-engine");

  test("draws the picture that the CPU's points give", { timeout: 180_000 }, async () => {
    for (const hash of [
      "#1;open+builtin:creature;scheme+catmull-clark;level+3;view+edges=bold",
      "#1;open+builtin:icosahedron;scheme+loop;level+4;view+edges=on",
      "#1;open+builtin:dodecahedron;scheme+doo-sabin;level+3;view+edges=bold",
      "#1;open+builtin:cube;crease+0-1+10;scheme+catmull-clark;level+3",
      // By rows: shared quads, triangles, and polygons of several kinds.
      "#1;open+builtin:cube;scheme+kobbelt;level+3;view+edges=bold",
      "#1;open+builtin:dodecahedron;scheme+mid-edge;level+3;view+edges=bold",
      "#1;open+builtin:cube;scheme+catmull-clark;limit+on;level+2;view+edges=on",
    ]) {
      const [gpu, cpu] = [await open(hash), await open(hash, "off")];
      assert.match((await said(gpu)) ?? "", /^refined in .* on the GPU /, hash);
      assert.match((await said(cpu)) ?? "", /^refined in .* on the CPU /, hash);
      const [a, b] = [await state(gpu), await state(cpu)];
      for (const what of ["vertices", "edges", "faces"]) assert.equal(a.shown[what], b.shown[what], `${what} of ${hash}`);
      const [ours, theirs] = [await picture(gpu), await picture(cpu)];
      assert.ok(content(ours).detail > 0.0005, `detail ${content(ours).detail} of ${hash}`);
      const found = difference(ours, theirs);
      // Polygons of the dual split are cut as fans there, along their shorter diagonals here.
      const [inside, share] = hash.includes("doo-sabin") ? [50, 0.002] : [0, 0.001];
      const good = found.inside <= inside && found.share <= share;
      if (!good) await Promise.all([keep("compute-on", ours), keep("compute-off", theirs)]);
      assert.ok(good, `${JSON.stringify(found)} of ${hash}`);
      await Promise.all([gpu, cpu].map((page) => page.close()));
    }
  });

  test("textures and materials go along", { timeout: 120_000 }, async () => {
    // A cube whose faces have a square of the picture each, and two materials.
    const folder = await scratch();
    const picture8 = new PNG({ width: 64, height: 64 });
    for (let i = 0; i < 64 * 64; i += 1) picture8.data.set((((i >> 3) + (i >> 9)) & 1) === 0 ? [250, 240, 220, 255] : [30, 90, 200, 255], 4 * i);
    const corner = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1} ${(i >> 1) & 1} ${(i >> 2) & 1}`);
    const faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "2 4 8 6", "4 3 7 8", "3 1 5 7"].map((face, f) =>
      `usemtl ${f % 2 ? "plain" : "checked"}\nf ${face.split(" ").map((v, k) => `${v}/${k + 1}`).join(" ")}`);
    await writeFile(join(folder, "box.obj"), ["mtllib box.mtl", ...corner, "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", ...faces].join("\n"));
    await writeFile(join(folder, "box.mtl"), "newmtl checked\nKd 1 1 1\nmap_Kd box.png\nnewmtl plain\nKd 0.9 0.3 0.2\n");
    await writeFile(join(folder, "box.png"), PNG.sync.write(picture8));
    // Kernels, kernels with a crease beside a seam that stays straight, and rows.
    const views = ["level 3", "crease 0-1 10; face-varying boundaries", "scheme doo-sabin"];
    const pictures = [];
    for (const compute of /** @type {const} */ (["on", "off"])) {
      const page = await open("", compute);
      await drop(page, ["box.obj", "box.mtl", "box.png"].map((name) => join(folder, name)));
      await ready(page, (state) => state.model.name === "box.obj");
      await cmd(page, "view camera=iso");
      for (const view of views) {
        const { link } = await state(page);
        for (const command of view.split("; ")) await cmd(page, command);
        await ready(page, (state, link) => state.link !== link, link);
        assert.match((await said(page)) ?? "", compute === "on" ? / on the GPU / : / on the CPU /, view);
        await page.waitForTimeout(300);
        pictures.push(await picture(page));
      }
      await page.close();
    }
    for (const [i, view] of views.entries()) {
      const [ours, theirs] = /** @type {[PNG, PNG]} */ ([pictures[i], pictures[views.length + i]]);
      const found = difference(ours, theirs);
      const good = found.inside === 0 && found.share <= 0.001;
      if (!good) await Promise.all([keep("compute-textures-on", ours), keep("compute-textures-off", theirs)]);
      assert.ok(good, `${view}: ${JSON.stringify(found)}`);
      assert.ok(content(ours).detail > 0.005, `detail ${content(ours).detail} of ${view}`);
    }
  });

  /** Sends commands, and expects the status line to say who refined. @param {Awaited<ReturnType<typeof open>>} page @param {readonly (readonly [string, string])[]} commands */
  const saysAfter = async (page, commands) => {
    for (const [command, where] of commands) {
      await cmd(page, command);
      await page.waitForFunction((text) => document.querySelector("#status-engine")?.textContent?.includes(text), ` on the ${where}PU `);
      await ready(page);
      assert.deepEqual((await cards(page)).filter(({ kind }) => kind === "error"), [], command);
    }
  };

  test("gives the CPU what wants points there, and says so", async () => {
    const page = await open("#1;open+builtin:cube;scheme+catmull-clark;level+3");
    assert.match((await said(page)) ?? "", / on the GPU /);
    await saysAfter(page, [
      // By rows.
      ["scheme j-spline", "G"],
      ["scheme fractal", "G"],
      ["scheme doo-sabin", "G"],
      ["limit on", "G"],
      ["limit off", "G"],
      ["view points=on", "C"],
      ["view points=off", "C"], // what is there stays
      ["level 4", "G"],
      // The cage itself.
      ["level 0", "C"],
    ]);
  });

  test("gives the CPU what the GPU has no kernels for where the address says nothing, and says so", async () => {
    // As if the adapter were none of software.
    const source = await readFile(new URL("../../web/fill.js", import.meta.url), "utf8");
    const faster = source.replace('return isProgram ? "nothing" : "kernels"', 'return "kernels"');
    assert.notEqual(faster, source);
    here.site.extra.set("/web/fill.js", faster);
    try {
      const page = await here.visit({ search: "?renderer=webgpu", hash: "#1;open+builtin:cube;scheme+catmull-clark;level+3" });
      assert.match((await said(page)) ?? "", / on the GPU /);
      await saysAfter(page, [
        ["scheme j-spline", "C"],
        ["scheme doo-sabin", "G"],
        ["limit on", "C"],
        ["limit off", "G"],
        ["scheme linear from=2", "C"],
        ["scheme loop", "G"],
        ["crease 0-1 10", "G"],
        ["scheme sqrt3", "C"],
      ]);
    } finally {
      here.site.extra.delete("/web/fill.js");
    }
  });

  test("leaves it to the CPU once the GPU fails", async () => {
    const source = await readFile(new URL("../../web/compute.js", import.meta.url), "utf8");
    const broken = source.replace("await runner.prepare(this.drawing, drawn)", "await Promise.reject(new Error('lost'))");
    assert.notEqual(broken, source);
    here.site.extra.set("/web/compute.js", broken);
    try {
      const page = await open("#1;open+builtin:cube;scheme+catmull-clark;level+3");
      assert.match((await said(page)) ?? "", / on the CPU /);
      assert.equal((await state(page)).shown.faces, 384);
      assert.deepEqual(await cards(page), []);
    } finally {
      here.site.extra.delete("/web/compute.js");
    }
  });

  test("a file has the bits of the command line", async () => {
    const page = await open("#1;open+builtin:pawn;scheme+loop;level+3");
    assert.match((await said(page)) ?? "", / on the GPU /);
    const file = await download(page, "page.obj", () => cmd(page, "export page.obj"));
    const native = join(await scratch(), "page.obj");
    await promisify(execFile)(CLI, ["builtin:pawn", "scheme", "loop", "level", "3", "export", native]);
    const lines = (/** @type {Buffer} */ bytes) => bytes.toString().split("\n").filter((line) => /^[vf] /.test(line));
    const [ours, theirs] = [lines(file.bytes), lines(await readFile(native))];
    assert.ok(ours.length > 20_000, `${ours.length} lines`);
    assert.deepEqual(ours, theirs);
  });

  test("turns around what is under the pointer, and stops for a later wish", async () => {
    const page = await open("#1;open+builtin:creature;scheme+catmull-clark;level+4");
    const before = (await state(page)).link;
    await page.mouse.dblclick(480, 300);
    await ready(page, (state, link) => state.link !== link, before);
    // Each drops the one before; the last one is shown.
    for (const level of [5, 3, 5, 4]) await cmd(page, `level ${level}`);
    await cmd(page, "level 3");
    await ready(page, (state) => state.shown.level === 3);
    assert.match((await said(page)) ?? "", / on the GPU /);
  });
});
