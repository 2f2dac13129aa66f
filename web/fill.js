// @ts-check
// Levels that the kernel refines, straight into the buffers that the engine draws from: on the GPU where that is wanted
// (web/compute.js), else here, out of the kernel's memory.
//
//   engine ── draw ──> shape ── buffers are made, and noted ──> run: kernel refines and packs, slice by slice,
//                                                               and its bytes go to queue.writeBuffer or bufferSubData
//
// So a level is copied once, into the GPU's buffers, and the engine gets a box. Loaded with the kernel.

import { note, noted } from "./noted.js";

/**
 * `Filling` of crates/kernel/src/filling.rs.
 * @typedef {{ shape(): Uint32Array, runs(): Uint32Array, bounds(): Float32Array, progress(): number, packs(): boolean,
 *   step(rows: number, target: Target): boolean, free(): void }} Filling
 * @typedef {{ write(buffer: number, offset: number, bytes: Uint8Array<ArrayBuffer>): void }} Target
 * @typedef {{ mesh(bytes: Uint8Array): void, start(plan: Uint8Array, budget: number): object,
 *   fill(plan: Uint8Array, budget: number, limit: number, parts: Uint32Array): Filling | undefined,
 *   draw(plan: Uint8Array, buffer: number, groups: number, parts: Uint32Array, rows: boolean): import("./compute.js").Drawing | undefined }} Kernel
 */

/** One slice of work, in milliseconds, as web/host.js has them. */
const SLICE = 8;
/** Rows of refinement between two looks at the clock. */
const ROWS = 32 << 10;
/** The engine is told of progress so often, in milliseconds. */
const PAUSE = 80;

/** Who waits for a turn of the thread. @type {(() => void)[]} */
const waiting = [];
const turns = new MessageChannel();
turns.port1.onmessage = () => waiting.shift()?.();

/** Lets the thread take messages and draw. @returns {Promise<void>} */
function turn() {
  return new Promise((go) => {
    waiting.push(go);
    turns.port2.postMessage(0);
  });
}

/** Writes to buffers by their numbers. @param {import("./noted.js").Noted} made @returns {Target} */
function target({ maker, buffers }) {
  if (maker && "queue" in maker) {
    const { queue } = maker;
    return { write: (buffer, offset, bytes) => queue.writeBuffer(/** @type {GPUBuffer} */ (buffers[buffer]), offset, bytes) };
  }
  const gl = maker;
  return {
    write: (buffer, offset, bytes) => {
      // wgpu binds what it copies to here and lets go of it: nothing that it remembers changes.
      gl?.bindBuffer(gl.COPY_WRITE_BUFFER, buffers[buffer] ?? null);
      gl?.bufferSubData(gl.COPY_WRITE_BUFFER, offset, bytes);
      gl?.bindBuffer(gl.COPY_WRITE_BUFFER, null);
    },
  };
}

/** A level on its way to the engine's buffers: `Drawing` of crates/engine/src/kernel.rs. */
class Level {
  #filling = /** @type {Filling | null} */ (null);
  #runs = /** @type {Uint32Array} */ (new Uint32Array());
  #found = new Float32Array();
  #error = /** @type {unknown} */ (null);
  /** Milliseconds of refining, and of packing and writing. */
  #spent = [0, 0];

  /** @param {Filling} filling @param {(failed: boolean) => void} wake */
  constructor(filling, wake) {
    this.#filling = filling;
    this.wake = wake;
  }

  shape() {
    note();
    return this.#filling?.shape() ?? new Uint32Array();
  }

  run() {
    const made = target(noted());
    // Not within the engine's call.
    Promise.resolve().then(() => this.#run(made)).catch((error) => {
      // What a trap left behind cannot be freed.
      this.#filling = null;
      this.#error = error;
      this.wake(true);
    });
  }

  /** @param {Target} target */
  async #run(target) {
    let told = performance.now();
    for (;;) {
      const filling = this.#filling;
      if (!filling) return;
      const end = performance.now() + SLICE;
      let [now, done] = [end - SLICE, false];
      while (!done && now < end) {
        const kind = filling.packs() ? 1 : 0;
        done = filling.step(ROWS, target);
        const then = performance.now();
        this.#spent[kind] = (this.#spent[kind] ?? 0) + then - now;
        now = then;
      }
      if (done) break;
      if (now - told > PAUSE) {
        told = now;
        this.wake(false);
      }
      await turn();
    }
    this.#found = new Float32Array([...(this.#filling?.bounds() ?? []), ...this.#spent]);
    this.#runs = this.#filling?.runs() ?? this.#runs;
    this.stop();
    this.wake(false);
  }

  /** The box of the points, lowest coordinates first, and the times; empty until all is there. */
  bounds() {
    if (this.#error) throw this.#error;
    return this.#found;
  }

  runs() {
    return this.#runs;
  }

  progress() {
    return this.#filling?.progress() ?? 1;
  }

  /** Cancels, if there is something left to be. */
  stop() {
    const filling = this.#filling;
    this.#filling = null;
    filling?.free();
  }
}

/**
 * What the GPU refines. A scheme that has kernels of its own, unless the adapter is a program: level 5 of the creature takes that
 * some seconds, and the CPU's patches a twentieth of one. Others go by rows, which cost the CPU more to make than the level itself: for
 * a cage that will move they pay, for showing a level once they do not. The page's address decides it otherwise: `compute=off`
 * is nothing, `compute=on` all there is, by rows where there are no kernels.
 * @returns {Promise<"nothing" | "kernels" | "all">}
 */
async function wanted() {
  const wish = new URLSearchParams(location.search).get("compute");
  if (wish) return wish === "on" ? "all" : "nothing";
  const adapter = await navigator.gpu.requestAdapter();
  // Where browsers told it before.
  const isProgram = adapter?.info.isFallbackAdapter ?? Reflect.get(adapter ?? {}, "isFallbackAdapter") === true;
  return isProgram ? "nothing" : "kernels";
}

/**
 * The kernel for an engine that draws with one or the other: levels that it makes go to the engine's buffers where they can. `wake` is called
 * when something is ready.
 * @param {Kernel} kernel @param {import("./protocol.js").Renderer | undefined} renderer @param {() => void} wake
 */
export async function attach(kernel, renderer, wake) {
  const what = renderer === "webgpu" ? await wanted() : "nothing";
  let gpu = what === "nothing" ? null : await import("./compute.js");
  let works = true;
  return {
    mesh: (/** @type {Uint8Array} */ bytes) => kernel.mesh(bytes),
    start: (/** @type {Uint8Array} */ plan, /** @type {number} */ budget) => kernel.start(plan, budget),
    draw: (/** @type {Uint8Array} */ plan, /** @type {number} */ buffer, /** @type {number} */ groups, /** @type {Uint32Array} */ parts, /** @type {number} */ budget) => {
      const drawing = gpu && kernel.draw(plan, buffer, groups, parts, what === "all");
      if (gpu && drawing) {
        return new gpu.Picture(drawing, (failed) => {
          if (failed) gpu = null;
          wake();
        });
      }
      const filling = works ? kernel.fill(plan, budget, buffer, parts) : undefined;
      return filling && new Level(filling, (failed) => {
        works &&= !failed;
        wake();
      });
    },
  };
}
