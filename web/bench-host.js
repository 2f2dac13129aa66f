// @ts-check
// The page's side of the benchmark's threads: which engines there are, and calls into one that answer with promises. `?bench`
// (bench.js) and `cargo xtask bench` (bench/browser.mjs) both drive the engines through this.

/** @typedef {import("./bench-worker.js").Cage} Cage */
/** @typedef {import("./bench-worker.js").Surface} Surface */

/**
 * Engines in the order of tables; `on` says what they compute with, `shaded` whether they store normals beside points and corners. three-subdivide is a library that does not ship: it is
 * offered where the address says that whoever serves the page has put it beside. `excuse`: what it is known to do wrong.
 * @type {{ id: string, name: string, on: "wasm" | "js" | "webgpu", shaded?: boolean, excuse?: string }[]}
 */
// Its edge points are found again by hundredths of their coordinates, rounded at two widths: a few are not, and stay midpoints.
export const ENGINES = [
  { id: "limn-wasm", name: "Limn, WebAssembly", on: "wasm" },
  { id: "limn-wasm-shaded", name: "Limn, WebAssembly + normals", on: "wasm", shaded: true },
  ...(navigator.gpu ? [/** @type {const} */ ({ id: "limn-webgpu", name: "Limn, WebGPU + normals", on: "webgpu", shaded: true })] : []),
  ...(location.hash === "#peers" ? [/** @type {const} */ ({ id: "three-subdivide", name: "three-subdivide", on: "js", excuse: "leaves some edge points of fine meshes where they were" })] : []),
];

/** What a reader of the figures has to know of the engines that are not there. */
export const NOTES = ENGINES.some(({ on }) => on === "webgpu") ? [] : ["This browser has no WebGPU: no rows for it."];

/** Compiled once for all threads, so that what a browser has compiled well stays so. @type {Promise<WebAssembly.Module> | null} */
let compiled = null;
function compile() {
  compiled ??= fetch(new URL("../pkg/trial/limn_kernel_bg.wasm", import.meta.url)).then((answer) => answer.arrayBuffer()).then((bytes) => WebAssembly.compile(bytes));
  // Another try may find the network there.
  compiled.catch(() => (compiled = null));
  return compiled;
}

/** One engine in a thread of its own. */
export class Thread {
  #worker = new Worker(new URL("./bench-worker.js", import.meta.url), { type: "module", name: "limn benchmark" });
  /** @type {Map<number, { done: (result: any) => void, fail: (error: Error) => void }>} */
  #waiting = new Map();
  #last = 0;

  constructor() {
    this.#worker.onmessage = ({ data: { id, result, error } }) => {
      const call = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error === undefined) call?.done(result);
      else call?.fail(new Error(error));
    };
    this.#worker.onerror = (event) => {
      event.preventDefault();
      this.#fail(event.message || "the thread could not be started");
    };
  }

  /** @param {string} id */
  static async open(id) {
    const module = await compile();
    const thread = new Thread();
    try {
      await thread.call("open", id, module);
    } catch (error) {
      thread.close();
      throw error;
    }
    return thread;
  }

  /** @param {string} call one of the calls in bench-worker.js @param {...unknown} args @returns {Promise<any>} */
  call(call, ...args) {
    this.#last += 1;
    const id = this.#last;
    return new Promise((done, fail) => {
      this.#waiting.set(id, { done, fail });
      this.#worker.postMessage({ id, call, args });
    });
  }

  /** Ends the thread and gives its memory back. */
  close() {
    this.#worker.terminate();
    this.#fail("the thread was ended");
  }

  /** @param {string} why */
  #fail(why) {
    for (const { fail } of this.#waiting.values()) fail(new Error(why));
    this.#waiting.clear();
  }
}

/** What a page may know of the machine. @returns {Promise<{ browser: string, adapter: string, cores: number, memory: number | null }>} */
export async function machine() {
  let adapter = "";
  try {
    const info = (await navigator.gpu?.requestAdapter())?.info;
    adapter = info ? [info.vendor, info.architecture, info.description].filter(Boolean).join(" ") || "without a name" : "";
  } catch {
    // No adapter, then.
  }
  const brands = /** @type {{ brands: { brand: string, version: string }[], platform: string } | undefined} */ (Reflect.get(navigator, "userAgentData"));
  const brand = brands?.brands.find(({ brand }) => !/not/i.test(brand));
  const browser = brand ? `${brand.brand} ${brand.version}, ${brands?.platform}` : navigator.userAgent;
  return { browser, adapter, cores: navigator.hardwareConcurrency, memory: Reflect.get(navigator, "deviceMemory") ?? null };
}
