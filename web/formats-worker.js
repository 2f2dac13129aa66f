// @ts-check
// One job of formats.js: loads the formats' module, reads or writes, answers.

/** @typedef {import("./formats.js").ReadJob} ReadJob */
/** @typedef {import("./formats.js").WriteJob} WriteJob */
/** @typedef {import("./formats.js").Answer} Answer */

const scope = /** @type {{ postMessage(answer: Answer, transfer: Transferable[]): void, onmessage: ((event: MessageEvent<ReadJob | WriteJob>) => void) | null }} */ (/** @type {unknown} */ (self));

scope.onmessage = async ({ data }) => {
  try {
    const base = new URL("../pkg/files/", import.meta.url);
    const wasm = fetch(new URL("limn_files_bg.wasm", base));
    /** @type {import("./formats.js").FilesModule} */
    const module = await import(new URL("limn_files.js", base).href);
    await module.default({ module_or_path: wasm });
    if ("packed" in data) {
      const files = module.write(data.packed, data.file);
      scope.postMessage({ files }, files.map((f) => f.bytes.buffer));
    } else {
      const parcel = module.read(data.names, data.bytes, data.wanted, data.budget);
      scope.postMessage({ parcel }, parcel ? [parcel.buffer] : []);
    }
  } catch (error) {
    // The writers throw sentences; anything else is a trap, most often for want of memory.
    const text = typeof error === "string" ? error : `it needs more memory than there is, or is damaged in a way that Limn does not know (${error instanceof Error ? error.message : error})`;
    scope.postMessage({ error: text }, []);
  }
};
