// How long the buffers of a level take when the slider goes there, piece by piece: `cargo xtask slider`.
//
// The built-in creature, 1,450 quads, goes from level 0 to 5 (1.5 M quads) and back some times, on WebGL2 and on WebGPU whose levels the CPU refines. One
// line a slide; the first is cold.
//
//   refine      the kernel's points, normals and corners
//   fill        packing, and writing to buffers; of it `calls` and their time, which is waiting for the browser's GPU process too:
//               where that draws in software, for its drawing
//   cpu         what the system says that the engine's thread computed in all, and the GPU process (on Linux)
//   copy        what copying as many bytes once takes in the same thread, at the same time: the floor of `fill`
//
// The load of the machine stands before. Wall times mean something on an idle machine only; `cpu` does anyway.

import { readFileSync, readdirSync } from "node:fs";
import { cmd, launch, picture, ready, serveSite, state, visit } from "./harness.mjs";

const LEVEL = 5;
const SLIDES = 8;

/** Milliseconds that threads of Chromium have computed: engines' workers, and the GPU process with all of its threads. */
function computed() {
  const sum = { worker: 0, gpu: 0 };
  for (const pid of process.platform === "linux" ? readdirSync("/proc").filter((name) => /^\d+$/.test(name)) : []) {
    try {
      const line = readFileSync(`/proc/${pid}/cmdline`, "utf8");
      const isGpu = line.includes("--type=gpu-process");
      if (!isGpu && !line.includes("--type=renderer")) continue;
      for (const thread of readdirSync(`/proc/${pid}/task`)) {
        const task = `/proc/${pid}/task/${thread}`;
        const spent = Number(readFileSync(`${task}/schedstat`, "utf8").split(" ")[0]) / 1e6;
        if (isGpu) sum.gpu += spent;
        else if (readFileSync(`${task}/comm`, "utf8").startsWith("DedicatedWorker")) sum.worker += spent;
      }
    } catch {
      // A thread that ended meanwhile.
    }
  }
  return sum;
}

/** Counts, in the engine's thread, what is written to buffers. */
function count() {
  const counted = { calls: 0, bytes: 0, spent: 0 };
  Reflect.set(globalThis, "counted", counted);
  for (const [type, name] of /** @type {const} */ ([["GPUQueue", "writeBuffer"], ["WebGL2RenderingContext", "bufferSubData"]])) {
    const prototype = Reflect.get(globalThis, type)?.prototype;
    if (!prototype) continue;
    const write = prototype[name];
    prototype[name] = function (/** @type {any[]} */ ...given) {
      const start = performance.now();
      write.apply(this, given);
      counted.spent += performance.now() - start;
      counted.calls += 1;
      counted.bytes += given[4] ?? given[2].byteLength;
    };
  }
}

const site = await serveSite();
const browser = await launch();
for (const renderer of ["webgl", "webgpu"]) {
  const page = await visit(browser, site.url, { search: `?renderer=${renderer}&compute=off`, hash: "#1;open+builtin:creature;scheme+catmull-clark;level+0" });
  const [worker] = page.workers();
  if (!worker) throw new Error("the engine is in no worker");
  await worker.evaluate(count);
  const load = process.platform === "linux" ? readFileSync("/proc/loadavg", "utf8").split(" ")[0] : "unknown";
  console.log(`${renderer}, load ${load}: milliseconds`);
  for (let slide = 0; slide < SLIDES; slide += 1) {
    await worker.evaluate(() => Object.assign(Reflect.get(globalThis, "counted"), { calls: 0, bytes: 0, spent: 0 }));
    const before = computed();
    await page.evaluate(async (level) => {
      const limn = Reflect.get(window, "limn");
      limn.cmd(`level ${level}`);
      while (limn.state.shown.level !== level) await new Promise((go) => setTimeout(go, 1));
    }, LEVEL);
    const after = computed();
    const { calls, bytes, spent } = await worker.evaluate(() => ({ ...Reflect.get(globalThis, "counted") }));
    const copy = await worker.evaluate((bytes) => {
      const room = Reflect.get(globalThis, "room") ?? [1, 2].map((i) => new Uint8Array(bytes).fill(i));
      Reflect.set(globalThis, "room", room);
      const start = performance.now();
      room[0].set(room[1].subarray(0, room[0].length));
      return performance.now() - start;
    }, bytes);
    const { times } = await state(page);
    const ms = (/** @type {number} */ time) => time.toFixed(1).padStart(6);
    console.log(
      `refine ${ms(times.refine)}  fill ${ms(times.build)}  (${(bytes / 1e6).toFixed(1)} MB in ${calls} calls of ${ms(spent)} in all)` +
      `  cpu: engine ${ms(after.worker - before.worker)}, GPU process ${ms(after.gpu - before.gpu)}  copy ${ms(copy)}`,
    );
    await picture(page);
    await cmd(page, "level 0");
    await ready(page, (state) => state.shown.level === 0);
    await picture(page);
  }
  await page.context().close();
}
await browser.close();
site.close();
