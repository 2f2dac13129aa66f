// @ts-check
// The engines of the benchmark's browser half, in a thread of their own: one worker runs one engine on one input, so that its
// memory begins small and goes with it.
//
//   open engine -> prepare input, scheme, level -> run n times -> seconds;  peak, stored, surface
//                  and runs until it is compiled well
//
// A further engine is one entry of ENGINES; its `run` may be asynchronous.

import { Runner } from "./compute.js";

/** @typedef {{ positions: Float32Array, counts: Uint32Array, corners: Uint32Array, ends: Uint32Array, sharpness: Float32Array }} Cage */
/** @typedef {{ positions: Float32Array, counts: Uint32Array, corners: Uint32Array }} Surface */
/**
 * One engine with its input. `prepare` throws where the engine has no such scheme; `run` goes from indexed faces to a level; `bandwidth` is
 * there where plain stores of the engine's own kind can be measured, in bytes a second, and `stored` the bytes of a level as Limn gives it out.
 * @typedef {{ prepare(cage: Cage, scheme: string, level: number): void | Promise<void>, run(): void | Promise<void>,
 *   surface(): Surface | Promise<Surface>, faces(): number, stored?(): number, peak(): number | null, kernels?(): string[], bandwidth?(): number | Promise<number> }} Engine
 */
/**
 * The part of the kernel's module that is used here: crates/kernel/src/trial/mod.rs.
 * @typedef {{ run(scheme: string, level: number, shaded: boolean): void, clear(): void, faces(): number, vertices(): number, normals(): number, corners(): number, positions(): Float32Array,
 *   draw(scheme: string, level: number, buffer: number, groups: number, rows: boolean): import("./compute.js").Drawing | undefined,
 *   predicted(scheme: string, level: number): number, face_counts(): Uint32Array, face_corners(): Uint32Array, differs(p: Float32Array, n: Uint32Array, c: Uint32Array, tolerance: number): string }} Trial
 * @typedef {{ Trial: { cage(name: string, n: number): Trial, of(p: Float32Array, n: Uint32Array, c: Uint32Array, ends: Uint32Array, sharpness: Float32Array): Trial },
 *   Stores: new (bytes: number) => { store(n: number): number } }} Kernel
 */

/** Bytes that plain stores are measured on. */
const STORED = 1 << 26;

/**
 * A browser compiles twice: at once, and well while the first runs go on. An engine is warm when no run has been a tenth shorter
 * than all before for so many milliseconds.
 */
const STEADY = 400;
/** It is taken for warm after so many milliseconds in any case. */
const PATIENCE = 3000;

/** @param {WebAssembly.Module} compiled @returns {Promise<{ kernel: Kernel, memory: WebAssembly.Memory }>} */
async function load(compiled) {
  const kernel = await import(new URL("../pkg/trial/limn_kernel.js", import.meta.url).href);
  const { memory } = await kernel.default({ module_or_path: compiled });
  return { kernel, memory };
}

/** Limn on the CPU: points and corners, and unit normals if it is shaded. */
class Wasm {
  #trial = /** @type {Trial | null} */ (null);
  #call = () => {};
  #before = 0;
  #grown = -1;

  /** @param {Kernel} kernel @param {WebAssembly.Memory} memory @param {boolean} shaded */
  constructor(kernel, memory, shaded) {
    this.kernel = kernel;
    this.memory = memory;
    this.shaded = shaded;
  }

  /** @param {WebAssembly.Module} compiled @param {boolean} shaded */
  static async open(compiled, shaded) {
    const { kernel, memory } = await load(compiled);
    return new Wasm(kernel, memory, shaded);
  }

  get trial() {
    if (!this.#trial) throw new Error("there is no cage");
    return this.#trial;
  }

  /** @param {Cage} cage @param {string} scheme @param {number} level */
  prepare({ positions, counts, corners, ends, sharpness }, scheme, level) {
    this.#trial = this.kernel.Trial.of(positions, counts, corners, ends, sharpness);
    this.#before = this.memory.buffer.byteLength;
    this.#grown = -1;
    this.#call = () => this.trial.run(scheme, level, this.shaded);
  }

  run() {
    this.#call();
    // After the first run: handing the result over takes memory too.
    if (this.#grown < 0) this.#grown = this.memory.buffer.byteLength - this.#before;
  }

  surface() {
    return { positions: this.trial.positions(), counts: this.trial.face_counts(), corners: this.trial.face_corners() };
  }

  faces() {
    return this.trial.faces();
  }

  /** Points and normals have 12 bytes, corners 4. */
  stored() {
    return 12 * (this.trial.vertices() + this.trial.normals()) + 4 * this.trial.corners();
  }

  /** By how much the first run made the module's memory grow; a run that fits into what was there cannot be told. */
  peak() {
    return this.#grown > 0 ? this.#grown : null;
  }

  /** A cage by name: crates/kernel/src/trial/cages.rs. @param {string} name @param {number} n @returns {Cage} */
  cage(name, n) {
    this.#trial = this.kernel.Trial.cage(name, n);
    return { ...this.surface(), ends: new Uint32Array(), sharpness: new Float32Array() };
  }

  /** How another engine's result differs from the last run's, in a sentence. @param {Surface} other @param {number} tolerance */
  differs({ positions, counts, corners }, tolerance) {
    return this.trial.differs(positions, counts, corners, tolerance);
  }

  /** Bytes a second that plain stores reach: the middle of eleven. */
  bandwidth() {
    const memory = new this.kernel.Stores(STORED);
    const times = Array.from({ length: 12 }, (_, k) => {
      const start = performance.now();
      memory.store(k);
      return performance.now() - start;
    });
    const sorted = times.slice(1).sort((a, b) => a - b);
    return (STORED / (sorted[5] ?? 1)) * 1e3;
  }
}

/**
 * Limn on the GPU: half-edges are built and sent, everything else is computed there, to buffers that a picture could be drawn from. Points
 * and normals; waits for the device. A scheme that it has no kernels for refines on the CPU, so there is nothing to measure.
 */
class Compute {
  #trial = /** @type {Trial | null} */ (null);
  #refiner = /** @type {import("./compute.js").Refiner | null} */ (null);
  #bytes = 0;
  #kernels = /** @type {string[]} */ ([]);
  #wanted = /** @type {[string, number]} */ (["", 0]);

  /** @param {Kernel} kernel @param {GPUDevice} device */
  constructor(kernel, device) {
    this.kernel = kernel;
    this.device = device;
    this.runner = new Runner(device);
  }

  /** @param {WebAssembly.Module} compiled */
  static async open(compiled) {
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) throw new Error("this browser has no WebGPU adapter");
    const { maxBufferSize, maxStorageBufferBindingSize } = adapter.limits;
    const device = await adapter.requestDevice({ requiredLimits: { maxBufferSize, maxStorageBufferBindingSize } });
    return new Compute((await load(compiled)).kernel, device);
  }

  get trial() {
    if (!this.#trial) throw new Error("there is no cage");
    return this.#trial;
  }

  /** @param {Cage} cage @param {string} scheme @param {number} level */
  async prepare({ positions, counts, corners, ends, sharpness }, scheme, level) {
    this.#trial = this.kernel.Trial.of(positions, counts, corners, ends, sharpness);
    this.#wanted = [scheme, level];
    await this.run();
  }

  async run() {
    this.#refiner?.free();
    this.#refiner = null;
    const drawing = this.trial.draw(...this.#wanted, ...this.runner.limits, false);
    if (!drawing) throw new Error("it has no kernels for this");
    // What a driver does not like it tells through scopes alone.
    this.device.pushErrorScope("validation");
    this.#refiner = await this.runner.prepare(drawing, []);
    const { buffers, shaders } = drawing.plan();
    this.#bytes = buffers.reduce((sum, { bytes }) => sum + bytes, 0);
    this.#kernels = shaders.map(({ entry }) => entry);
    drawing.free();
    this.#refiner.run();
    const [error] = await Promise.all([this.device.popErrorScope(), this.device.queue.onSubmittedWorkDone()]);
    if (error) throw new Error(error.message);
  }

  /** Points from the GPU; faces are numbered as the CPU does. */
  async surface() {
    const refiner = this.#refiner;
    if (!refiner) throw new Error("nothing was refined");
    const vertices = new Float32Array(await refiner.read(refiner.vertices, refiner.count * 16));
    const positions = new Float32Array(refiner.count * 3);
    for (let v = 0; v < refiner.count; v += 1) positions.set(vertices.subarray(4 * v, 4 * v + 3), 3 * v);
    this.trial.run(...this.#wanted, false);
    const faces = { counts: this.trial.face_counts(), corners: this.trial.face_corners() };
    this.trial.clear();
    return { positions, ...faces };
  }

  faces() {
    return this.trial.predicted(...this.#wanted);
  }

  /** What ran, by the names of entry points. */
  kernels() {
    return this.#kernels;
  }

  /** Bytes on the GPU. */
  peak() {
    return this.#bytes;
  }
}

/**
 * three-subdivide, where whoever serves the page put it. Loop on triangles; it takes and makes three corners a triangle. It takes points
 * that agree in hundredths for one, so it gets a cage whose finest edges will be eight hundredths long: less, and points are
 * joined; more, and the bits of a float no longer tell hundredths apart.
 */
class Three {
  #scale = 1;
  /** @type {any} */ #input = null;
  /** @type {any} */ #made = null;
  #level = 0;

  /** @param {any} three */
  constructor(three) {
    this.three = three;
  }

  static async open() {
    return new Three(await import(new URL("../peers/three-subdivide.js", import.meta.url).href));
  }

  /** @param {Cage} cage @param {string} scheme @param {number} level */
  prepare({ positions, counts, corners, sharpness }, scheme, level) {
    if (scheme !== "loop" || !level || sharpness.length || counts.some((n) => n !== 3)) throw new Error("it has Loop on triangles");
    // A power of two: no bit is lost.
    this.#scale = 2 ** Math.ceil(Math.log2((0.08 * 2 ** level) / shortest(positions, corners)));
    this.#input = new this.three.BufferGeometry();
    this.#input.setAttribute("position", new this.three.BufferAttribute(positions.map((x) => x * this.#scale), 3));
    this.#input.setIndex(new this.three.BufferAttribute(corners, 1));
    this.#level = level;
    // It wants normals; they are made once, off the clock.
    this.#input.computeVertexNormals();
  }

  run() {
    this.#made = null;
    this.#made = this.three.LoopSubdivision.modify(this.#input, this.#level, { split: false });
  }

  /** Every triangle has corners of its own: those in one place are one vertex. */
  surface() {
    const made = this.#made.index ? this.#made.toNonIndexed() : this.#made;
    const soup = /** @type {Float32Array} */ (made.getAttribute("position").array);
    const bits = new Uint32Array(soup.buffer, soup.byteOffset, soup.length);
    const count = soup.length / 3;
    const slots = new Uint32Array(1 << Math.ceil(Math.log2(count + 1) + 1));
    const corners = new Uint32Array(count);
    const positions = new Float32Array(soup.length);
    let vertices = 0;
    for (let i = 0; i < count; i += 1) {
      const [x = 0, y = 0, z = 0] = [bits[3 * i], bits[3 * i + 1], bits[3 * i + 2]];
      let at = (Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35)) >>> 0;
      at = Math.imul(at ^ (at >>> 15), 0x2c1b3c6d) >>> 0;
      for (;;) {
        at &= slots.length - 1;
        const first = slots[at] ?? 0;
        if (!first) {
          slots[at] = i + 1;
          corners[i] = vertices;
          for (let k = 0; k < 3; k += 1) positions[3 * vertices + k] = (soup[3 * i + k] ?? 0) / this.#scale;
          vertices += 1;
          break;
        }
        const j = 3 * (first - 1);
        if (bits[j] === x && bits[j + 1] === y && bits[j + 2] === z) {
          corners[i] = corners[first - 1] ?? 0;
          break;
        }
        at += 1;
      }
    }
    return { positions: positions.slice(0, 3 * vertices), counts: new Uint32Array(count / 3).fill(3), corners };
  }

  faces() {
    return this.#made.index ? this.#made.index.count / 3 : this.#made.getAttribute("position").count / 3;
  }

  /** JavaScript's heap does not tell. */
  peak() {
    return null;
  }
}

/** The shortest edge of triangles. @param {Float32Array} positions @param {Uint32Array} corners */
function shortest(positions, corners) {
  let least = Infinity;
  corners.forEach((a, i) => {
    const b = corners[i % 3 === 2 ? i - 2 : i + 1] ?? 0;
    const [x = 0, y = 0, z = 0] = [0, 1, 2].map((k) => (positions[3 * a + k] ?? 0) - (positions[3 * b + k] ?? 0));
    least = Math.min(least, Math.hypot(x, y, z));
  });
  return least;
}

/** @type {Record<string, (compiled: WebAssembly.Module) => Promise<Engine>>} */
const ENGINES = {
  "limn-wasm": (compiled) => Wasm.open(compiled, false),
  "limn-wasm-shaded": (compiled) => Wasm.open(compiled, true),
  "limn-webgpu": Compute.open,
  "three-subdivide": Three.open,
};

/** @type {Engine | null} */
let engine = null;
const present = () => {
  if (!engine) throw new Error("no engine is open");
  return engine;
};
const wasm = () => {
  if (!(engine instanceof Wasm)) throw new Error("only Limn's module can");
  return engine;
};

/** Milliseconds of so many runs. @param {number} repeats */
async function time(repeats) {
  const start = performance.now();
  for (let i = 0; i < repeats; i += 1) {
    const running = present().run();
    if (running) await running;
  }
  return performance.now() - start;
}

/** What can be asked. @type {Record<string, (...args: any[]) => unknown>} */
const calls = {
  open: async (/** @type {string} */ id, /** @type {WebAssembly.Module} */ compiled) => {
    const make = ENGINES[id];
    if (!make) throw new Error(`there is no engine ${id}`);
    engine = await make(compiled);
  },
  prepare: async (/** @type {Cage} */ cage, /** @type {string} */ scheme, /** @type {number} */ level) => {
    await present().prepare(cage, scheme, level);
    const begun = performance.now();
    let [best, since, now] = [Infinity, begun, begun];
    do {
      const took = await time(1);
      now = performance.now();
      if (took < 0.9 * best) [best, since] = [took, now];
    } while (now < since + STEADY && now < begun + PATIENCE);
  },
  /** Seconds of so many runs. */
  run: async (/** @type {number} */ repeats) => (await time(repeats)) / 1e3,
  surface: () => present().surface(),
  faces: () => present().faces(),
  /** Bytes of what Limn stores here; null where the engine is another. */
  stored: () => present().stored?.() ?? null,
  peak: () => present().peak(),
  /** What ran on the GPU; null where nothing does. */
  kernels: () => present().kernels?.() ?? null,
  cage: (/** @type {string} */ name, /** @type {number} */ n) => wasm().cage(name, n),
  differs: (/** @type {Surface} */ other, /** @type {number} */ tolerance) => wasm().differs(other, tolerance),
  bandwidth: () => present().bandwidth?.() ?? null,
};

addEventListener("message", async ({ data: { id, call, args } }) => {
  try {
    const found = calls[call];
    if (!found) throw new Error(`there is no ${call}`);
    postMessage({ id, result: await found(...args) });
  } catch (error) {
    postMessage({ id, error: error instanceof Error ? error.message : String(error) });
  }
});
