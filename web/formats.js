// @ts-check
// Reading and writing model files in a thread of its own, one for each job: the picture goes on meanwhile, the thread's memory
// goes with it, and a job can be ended at any moment. The formats' module is loaded by the first job, not by the first visit.

/**
 * What a job is told, and what it answers.
 * @typedef {{ names: string[], bytes: Uint8Array<ArrayBuffer>[], wanted: string | undefined, budget: number }} ReadJob
 * @typedef {{ packed: Uint8Array<ArrayBuffer>, file: string }} WriteJob
 * @typedef {{ name: string, bytes: Uint8Array<ArrayBuffer> }} OutFile
 * @typedef {{ parcel?: Uint8Array<ArrayBuffer>, files?: OutFile[], error?: string }} Answer
 */

/**
 * The formats' module, as wasm-bindgen makes it: crates/files/src/lib.rs says what the calls do.
 * @typedef {{
 *   default(source: { module_or_path: Promise<Response> }): Promise<unknown>,
 *   read(names: string[], bytes: Uint8Array[], wanted: string | undefined, budget: number): Uint8Array<ArrayBuffer> | undefined,
 *   write(packed: Uint8Array, file: string): OutFile[],
 * }} FilesModule
 */

/** @type {Set<() => void>} */
const running = new Set();

/** Ends every reading; they never answer. What a visitor saves goes on. */
export function stop() {
  for (const end of running) end();
}

/** Reads the model among files: a parcel for the engine, undefined where there are no files. @param {ReadJob} job */
export async function read(job) {
  return (await run(job, job.bytes)).parcel;
}

/** Writes an export of the engine's as files. @param {WriteJob} job */
export async function write(job) {
  return (await run(job, [job.packed])).files ?? [];
}

/** @param {ReadJob | WriteJob} job @param {Uint8Array<ArrayBuffer>[]} bytes @returns {Promise<Answer>} */
function run(job, bytes) {
  return new Promise((resolve, reject) => {
    const worker = new Worker(new URL("formats-worker.js", import.meta.url), { type: "module" });
    const end = () => {
      worker.terminate();
      running.delete(end);
    };
    if ("names" in job) running.add(end);
    worker.onmessage = (/** @type {MessageEvent<Answer>} */ { data }) => {
      end();
      if (data.error === undefined) resolve(data);
      else reject(new Error(data.error));
    };
    worker.onerror = (event) => {
      end();
      reject(new Error(event.message || "its reader could not be loaded; reload the page"));
    };
    worker.postMessage(job, [...new Set(bytes.map((b) => b.buffer))]);
  });
}
