// @ts-check
// The engine's errands: what it cannot do itself, because only the browser can. Files are read, addresses fetched, pictures
// decoded, exports written. A first visit needs none of it: host.js loads this module with the first of them.

import * as formats from "./formats.js";

/** @typedef {import("./protocol.js").FromEngine} FromEngine */
/** @typedef {import("./protocol.js").NamedFile} NamedFile */
/** @typedef {import("./protocol.js").Engine} Engine */

/**
 * What the engine asks of its surroundings, beside the messages that go on to the page.
 * @typedef {{ type: "fetch", url: string, turn: number }
 *   | { type: "decode", index: number, mime: string, bytes: Uint8Array<ArrayBuffer>, turn: number }
 *   | { type: "write", name: string, bytes: Uint8Array<ArrayBuffer> }
 *   | { type: "png", name: string, width: number, height: number, bytes: Uint8Array<ArrayBuffer> }} Wish
 */

/**
 * What this module needs of the host: a way to the page, a way into the engine, and how much memory a model may take.
 * @typedef {{
 *   post: (message: FromEngine, transfer?: Transferable[]) => void,
 *   enter: (call: (engine: Engine) => void) => void,
 *   budget: () => number,
 * }} Host
 */

/** The most that is read from an address, in bytes. */
const MOST_FETCHED = 1 << 30;
/** Larger pictures are made smaller while they are decoded: the longest side in pixels. */
const MOST_PIXELS = 4096;

/** The media types of what exports are made of. @type {Record<string, string>} */
const TYPES = { obj: "model/obj", mtl: "model/mtl", glb: "model/gltf-binary", png: "image/png", jpg: "image/jpeg", jpeg: "image/jpeg", webp: "image/webp" };

/** @typedef {ReturnType<typeof createErrands>} Errands */

/** @param {Host} host */
export function createErrands({ post, enter, budget }) {
  let fetching = new AbortController();

  /** Ends what is being read: files, and an address. */
  const stop = () => {
    fetching.abort();
    formats.stop();
  };

  /** @param {Extract<Wish, { type: "fetch" }>} wish */
  const download = async ({ url, turn }) => {
    stop();
    const { signal } = (fetching = new AbortController());
    const fail = (/** @type {string} */ why) => enter((e) => e.fetched(url, turn, undefined, why));
    const name = nameOf(url);
    /** @type {Uint8Array<ArrayBuffer>} */
    let bytes;
    try {
      const answer = await fetch(url, { mode: "cors", credentials: "omit", signal });
      if (!answer.ok) return fail(`the server answered ${answer.status} ${answer.statusText}`.trim());
      const total = Number(answer.headers.get("content-length")) || 0;
      const reader = answer.body?.getReader();
      /** @type {Uint8Array[]} */
      const parts = [];
      let got = 0;
      for (;;) {
        const { done, value } = (await reader?.read()) ?? { done: true, value: undefined };
        if (done || !value) break;
        parts.push(value);
        got += value.length;
        if (got > MOST_FETCHED) {
          fetching.abort();
          return fail("the file is larger than 1 GB");
        }
        // What is sent compressed is longer than it says.
        const share = total ? Math.min(1, got / total) : -1;
        post({ type: "progress", what: `Reading ${name}`, done: share, cancel: true });
      }
      bytes = new Uint8Array(got);
      parts.reduce((at, part) => (bytes.set(part, at), at + part.length), 0);
    } catch {
      // Cancelled: nobody waits for it any more.
      if (signal.aborted) return;
      return fail("it could not be reached, or its server does not allow other sites to read it (CORS); download the file and drop it here instead");
    }
    try {
      const parcel = await formats.read({ names: [name], bytes: [bytes], wanted: undefined, budget: budget() });
      enter((e) => e.fetched(url, turn, parcel, ""));
    } catch (error) {
      fail(error instanceof Error ? error.message : String(error));
    }
  };

  /** @param {Extract<Wish, { type: "decode" }>} wish */
  const decode = async ({ index, mime, bytes, turn }) => {
    /** @type {ImageBitmap | undefined} */
    let bitmap;
    try {
      const options = /** @type {const} */ ({ premultiplyAlpha: "none", colorSpaceConversion: "none" });
      const blob = new Blob([bytes], { type: mime });
      bitmap = await createImageBitmap(blob, options);
      const shrink = MOST_PIXELS / Math.max(bitmap.width, bitmap.height);
      if (shrink < 1) {
        const side = (/** @type {number} */ n) => Math.max(1, Math.round(n * shrink));
        bitmap = await createImageBitmap(blob, { ...options, resizeWidth: side(bitmap.width), resizeHeight: side(bitmap.height) });
      }
    } catch {
      bitmap = undefined;
    }
    enter((e) => e.decoded(turn, index, bitmap));
  };

  /** @param {Extract<Wish, { type: "write" }>} wish */
  const write = async ({ name, bytes }) => {
    try {
      for (const out of await formats.write({ packed: bytes, file: name })) {
        const mime = TYPES[out.name.split(".").pop()?.toLowerCase() ?? ""] ?? "application/octet-stream";
        post({ type: "file", name: out.name, mime, bytes: out.bytes }, [out.bytes.buffer]);
      }
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      post({ type: "card", card: { id: "write", kind: "error", title: `${name} could not be written`, lines: [sentence(why)], ask: "" } });
    }
  };

  /**
   * Reads the model among files, in a thread of its own. A card tells what goes wrong.
   * @param {NamedFile[]} files
   * @param {string | undefined} wanted the file to look for
   * @param {() => boolean} still whether the answer is still asked for
   */
  const read = async (files, wanted, still) => {
    const { names, bytes, failed } = await bytesOf(files);
    const trouble = (/** @type {string} */ name, /** @type {string} */ why) =>
      post({ type: "card", card: { id: "read", kind: "error", title: `${name} could not be read`, lines: [sentence(why)], ask: "" } });
    if (failed) trouble(failed, "The browser gave no bytes: it may have moved or changed; drop it again.");
    if (!names.length || !still()) return undefined;
    try {
      return await formats.read({ names, bytes, wanted, budget: budget() });
    } catch (error) {
      trouble(names[0] ?? "The file", error instanceof Error ? error.message : String(error));
      return undefined;
    }
  };

  /** @param {Extract<Wish, { type: "png" }>} wish */
  const picture = async ({ name, width, height, bytes }) => {
    try {
      const paper = new OffscreenCanvas(width, height);
      const pixels = new Uint8ClampedArray(bytes.buffer, bytes.byteOffset, bytes.length);
      paper.getContext("2d")?.putImageData(new ImageData(pixels, width, height), 0, 0);
      const blob = await paper.convertToBlob({ type: "image/png" });
      const png = new Uint8Array(await blob.arrayBuffer());
      post({ type: "file", name, mime: "image/png", bytes: png }, [png.buffer]);
    } catch (error) {
      post({ type: "card", card: { id: "png", kind: "error", title: "The picture could not be saved", lines: [String(error)], ask: "" } });
    }
  };

  /** Does what the engine asked for. @param {Wish} wish */
  const run = (wish) => {
    switch (wish.type) {
      case "fetch":
        return download(wish);
      case "decode":
        return decode(wish);
      case "write":
        return write(wish);
      case "png":
        return picture(wish);
    }
  };
  return { run, read, stop };
}

/** The last part of an address's path. @param {string} url */
function nameOf(url) {
  const last = url.replace(/[?#].*/, "").split("/").pop() ?? "";
  try {
    return decodeURIComponent(last);
  } catch {
    return last;
  }
}

/** With a capital and a full stop. @param {string} text */
function sentence(text) {
  const whole = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}

/** @param {NamedFile[]} files */
async function bytesOf(files) {
  /** @type {string[]} */ const names = [];
  /** @type {Uint8Array<ArrayBuffer>[]} */ const bytes = [];
  let failed = "";
  for (const { name, file } of files) {
    try {
      bytes.push(new Uint8Array(await file.arrayBuffer()));
      names.push(name);
    } catch {
      failed ||= name;
    }
  }
  return { names, bytes, failed };
}
