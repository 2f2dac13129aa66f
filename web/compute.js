// @ts-check
// Refinement on the GPU: runs what the kernel puts together (crates/compute) with the browser's own objects.
//
//   plan ──> buffers, pipelines ──> one compute pass: half-edges, points, normals, indices ──> box read back
//
// The engine draws from some of the buffers and makes them itself (web/fill.js). Loaded with the kernel, where the GPU is to refine.

import { note, noted } from "./noted.js";

/**
 * `Listed` of crates/kernel/src/drawing.rs.
 * @typedef {{ shader: number, numbers: number[], bound: [number[], number[]], grid: [number, number] }} Dispatch
 * @typedef {{ buffers: { role: keyof typeof USAGE, bytes: number, filled: boolean, drawn: boolean }[],
 *   shaders: { entry: string, source: string, access: [number[], number[]] }[], once: Dispatch[], each: Dispatch[],
 *   cage: number, vertices: number, count: number, bounds: number | undefined }} Plan
 * @typedef {{ shape(): Uint32Array, runs(): Uint32Array, points(): Float32Array<ArrayBuffer>, contents(id: number): Uint8Array<ArrayBuffer>, plan(): Plan, free(): void }} Drawing
 */

// The numbers of WebGPU's GPUBufferUsage.
const [MAP_READ, COPY_SRC, COPY_DST, INDEX, VERTEX, UNIFORM, STORAGE] = [1, 4, 8, 16, 32, 64, 128];
const USAGE = {
  table: STORAGE | COPY_DST,
  work: STORAGE,
  cage: STORAGE | COPY_DST,
  vertices: STORAGE | VERTEX | COPY_SRC,
  indices: STORAGE | INDEX | COPY_DST,
  corners: STORAGE | VERTEX,
  extras: STORAGE | VERTEX | COPY_DST,
  colors: STORAGE | VERTEX | COPY_SRC,
  bounds: STORAGE | COPY_SRC | COPY_DST,
};
/** Compute shaders, in WebGPU's GPUShaderStage. */
const COMPUTE = 4;
/** Numbers of a dispatch are this far apart, as every adapter wants it. */
const APART = 256;

/** @typedef {{ pipeline: GPUComputePipeline, layouts: GPUBindGroupLayout[] }} Compiled */

/** Compiles shaders, each once, and runs plans on a device. */
export class Runner {
  /** @type {Map<string, Promise<Compiled>>} */
  #compiled = new Map();

  /** @param {GPUDevice} device */
  constructor(device) {
    this.device = device;
  }

  /** What plans for this device may take: bytes of a buffer, and groups in one dimension. @returns {[number, number]} */
  get limits() {
    const { maxBufferSize, maxStorageBufferBindingSize, maxComputeWorkgroupsPerDimension } = this.device.limits;
    return [Math.min(maxBufferSize, maxStorageBufferBindingSize), maxComputeWorkgroupsPerDimension];
  }

  /** @param {Plan["shaders"][number]} shader */
  #compile({ entry, source, access }) {
    const { device } = this;
    const key = entry + source;
    const make = async () => {
      const layouts = access.map((group) =>
        device.createBindGroupLayout({
          entries: group.map((kind, binding) => ({
            binding,
            visibility: COMPUTE,
            buffer: { type: /** @type {const} */ (["uniform", "read-only-storage", "storage"])[kind] ?? "storage" },
          })),
        }));
      const pipeline = await device.createComputePipelineAsync({
        layout: device.createPipelineLayout({ bindGroupLayouts: layouts }),
        compute: { module: device.createShaderModule({ code: source }), entryPoint: entry },
      });
      return { pipeline, layouts };
    };
    const found = this.#compiled.get(key) ?? make();
    this.#compiled.set(key, found);
    return found;
  }

  /**
   * Makes what a drawing needs besides the buffers that are drawn. Nothing runs yet. Rejects where memory is short.
   * @param {Drawing} drawing @param {GPUBuffer[]} drawn in the order of the plan @returns {Promise<Refiner>}
   */
  async prepare(drawing, drawn) {
    const plan = drawing.plan();
    const compiled = await Promise.all(plan.shaders.map((shader) => this.#compile(shader)));
    this.device.pushErrorScope("out-of-memory");
    const refiner = new Refiner(this.device, drawing, plan, compiled, drawn);
    if (!(await this.device.popErrorScope())) return refiner;
    refiner.free();
    throw new Error("the graphics adapter has too little memory");
  }
}

/** A plan with its buffers. */
export class Refiner {
  /** @type {GPUBuffer[]} */
  #own = [];
  /** @type {{ pipeline: GPUComputePipeline, groups: GPUBindGroup[], grid: [number, number] }[]} */
  #once;
  #each;

  /** @param {GPUDevice} device @param {Drawing} drawing @param {Plan} plan @param {Compiled[]} compiled @param {GPUBuffer[]} drawn */
  constructor(device, drawing, plan, compiled, drawn) {
    this.device = device;
    const given = [...drawn];
    const buffers = plan.buffers.map(({ role, bytes, filled, drawn: isDrawn }, id) => {
      const buffer = (isDrawn ? given.shift() : undefined) ?? this.#make(bytes, USAGE[role]);
      if (filled) device.queue.writeBuffer(buffer, 0, drawing.contents(id));
      return buffer;
    });
    const at = (/** @type {number} */ id) => {
      const found = buffers[id];
      if (!found) throw new Error(`there is no buffer ${id}`);
      return found;
    };
    const dispatches = [...plan.once, ...plan.each];
    const numbers = this.#make(Math.max(dispatches.length, 1) * APART, UNIFORM | COPY_DST);
    const words = new Uint32Array((dispatches.length * APART) / 4);
    dispatches.forEach(({ numbers }, i) => words.set(numbers, (i * APART) / 4));
    device.queue.writeBuffer(numbers, 0, words);
    const steps = dispatches.map(({ shader, bound, grid }, i) => {
      const made = compiled[shader];
      if (!made) throw new Error(`there is no shader ${shader}`);
      const groups = bound.map((ids, group) => {
        const resources = ids.map((id) => ({ buffer: at(id) }));
        const all = group ? resources : [{ buffer: numbers, offset: i * APART, size: 64 }, ...resources];
        const entries = all.map((resource, binding) => ({ binding, resource }));
        return device.createBindGroup({ layout: /** @type {GPUBindGroupLayout} */ (made.layouts[group]), entries });
      });
      return { pipeline: made.pipeline, groups, grid };
    });
    this.#once = steps.slice(0, plan.once.length);
    this.#each = steps.slice(plan.once.length);
    this.cage = at(plan.cage);
    this.vertices = at(plan.vertices);
    this.count = plan.count;
    this.bounds = plan.bounds === undefined ? null : at(plan.bounds);
    this.move(0, drawing.points());
  }

  /** @param {number} size @param {number} usage */
  #make(size, usage) {
    const buffer = this.device.createBuffer({ size, usage });
    this.#own.push(buffer);
    return buffer;
  }

  /** Puts points into the cage from a vertex on, four numbers each. @param {number} first @param {Float32Array<ArrayBuffer>} points */
  move(first, points) {
    this.device.queue.writeBuffer(this.cage, first * 16, points);
  }

  /** Refines: everything in one pass. Nothing is waited for. */
  run() {
    const encoder = this.device.createCommandEncoder();
    if (this.bounds) encoder.clearBuffer(this.bounds);
    const pass = encoder.beginComputePass();
    for (const { pipeline, groups, grid } of [...this.#once, ...this.#each]) {
      pass.setPipeline(pipeline);
      groups.forEach((group, i) => pass.setBindGroup(i, group));
      pass.dispatchWorkgroups(...grid);
    }
    this.#once = [];
    pass.end();
    this.device.queue.submit([encoder.finish()]);
  }

  /** Reads a buffer back once everything before has run. @param {GPUBuffer} buffer @param {number} bytes */
  async read(buffer, bytes) {
    const copy = this.device.createBuffer({ size: bytes, usage: MAP_READ | COPY_DST });
    const encoder = this.device.createCommandEncoder();
    encoder.copyBufferToBuffer(buffer, 0, copy, 0, bytes);
    this.device.queue.submit([encoder.finish()]);
    try {
      await copy.mapAsync(MAP_READ);
      return copy.getMappedRange().slice(0);
    } finally {
      copy.destroy();
    }
  }

  /** Lets go of everything but the buffers that are drawn. */
  free() {
    for (const buffer of this.#own) buffer.destroy();
    this.#own = [];
  }
}

/** @type {WeakMap<GPUDevice, Runner>} */
const runners = new WeakMap();

/** A plan of the engine's on its way to the buffers that it draws from: `Drawing` of crates/engine/src/kernel.rs. */
export class Picture {
  #refiner = /** @type {Refiner | null} */ (null);
  #runs;
  #box = new Float32Array();
  #error = /** @type {unknown} */ (null);

  /** @param {Drawing} drawing @param {(failed: boolean) => void} done */
  constructor(drawing, done) {
    this.drawing = drawing;
    this.done = done;
    this.#runs = drawing.runs();
  }

  shape() {
    note();
    return this.drawing.shape();
  }

  runs() {
    return this.#runs;
  }

  run() {
    const { maker, buffers } = noted();
    this.#run(/** @type {GPUDevice | null} */ (maker), /** @type {GPUBuffer[]} */ (buffers)).catch((error) => (this.#error = error)).finally(() => {
      this.drawing.free();
      // Editing the cage would want the rest again.
      this.#refiner?.free();
      this.done(this.#error !== null);
    });
  }

  /** @param {GPUDevice | null} device @param {GPUBuffer[]} drawn */
  async #run(device, drawn) {
    if (!device) throw new Error("no buffer was made");
    const runner = runners.get(device) ?? new Runner(device);
    runners.set(device, runner);
    this.#refiner = await runner.prepare(this.drawing, drawn);
    this.#refiner.run();
    const { bounds } = this.#refiner;
    if (!bounds) throw new Error("nothing says where the points lie");
    this.#box = decode(new Uint32Array(await this.#refiner.read(bounds, 24)));
  }

  /** The box of the points, lowest coordinates first; empty while the GPU is at work. */
  bounds() {
    if (this.#error) throw this.#error;
    return this.#box;
  }

  /** Nobody can tell how far a GPU is. */
  progress() {
    return 0;
  }

  /** What was submitted runs to its end. */
  stop() {}
}

/** As `limn_compute::bounds`; where no point is finite the lowest are above the highest. @param {Uint32Array} words */
function decode(words) {
  if (!words[3]) return new Float32Array([1, 1, 1, -1, -1, -1]);
  const ordered = words.map((word, i) => (i < 3 ? ~word : word));
  return new Float32Array(ordered.map((o) => (o >>> 31 ? o & 0x7fffffff : ~o)).buffer);
}
