// @ts-check
// The engine's surroundings: loads the one of the two modules that this browser can draw with, hands it the page's messages,
// and gives it its turns. Long work comes in slices of a few milliseconds; between two of them the thread takes messages, so
// input, Cancel and drawing go on. Runs in a worker, or on the page where workers cannot draw.

/** @typedef {import("./protocol.js").ToEngine} ToEngine */
/** @typedef {import("./protocol.js").FromEngine} FromEngine */
/** @typedef {import("./protocol.js").NamedFile} NamedFile */
/** @typedef {import("./protocol.js").Renderer} Renderer */
/** @typedef {import("./protocol.js").Engine} Engine */

import * as formats from "./formats.js";

/**
 * What the engine asks of its surroundings, beside the messages that go on to the page.
 * @typedef {{ type: "fetch", url: string, turn: number }
 *   | { type: "decode", index: number, mime: string, bytes: Uint8Array<ArrayBuffer>, turn: number }
 *   | { type: "write", name: string, bytes: Uint8Array<ArrayBuffer> }
 *   | { type: "png", name: string, width: number, height: number, bytes: Uint8Array<ArrayBuffer> }} Wish
 */

/** One slice of work, in milliseconds. */
const SLICE = 8;
/** The most that is read from an address, in bytes. */
const MOST_FETCHED = 1 << 30;
/** Files smaller than this are read before anybody could wonder, in bytes. */
const TALKED_ABOUT = 3_000_000;
/** Larger pictures are made smaller while they are decoded: the longest side in pixels. */
const MOST_PIXELS = 4096;

/**
 * @param {(message: FromEngine, transfer?: Transferable[]) => void} post
 * @returns {(message: ToEngine) => void} takes the page's messages
 */
export function createHost(post) {
  /** @type {Engine | null} */
  let engine = null;
  /** @type {ToEngine[]} */
  const waiting = [];
  let dead = false;
  let working = false;
  let framing = false;
  let drawn = false;
  /** Counts what was asked to be opened: an answer to an older wish is dropped. */
  let asked = 0;
  const turns = new MessageChannel();

  /** @param {unknown} error */
  const fault = (error) => {
    if (dead) return;
    dead = true;
    post({ type: "fault", kind: "trap", message: error instanceof Error ? error.message : String(error) });
  };

  /** Every call into the engine: a trap ends it. @param {(engine: Engine) => void} call */
  const enter = (call) => {
    if (dead || !engine) return;
    try {
      call(engine);
    } catch (error) {
      fault(error);
    }
    next();
  };

  const next = () => {
    if (dead || !engine) return;
    if (!working && engine.has_work()) {
      working = true;
      turns.port2.postMessage(0);
    }
    if (!framing && engine.wants_frame()) {
      framing = true;
      requestAnimationFrame(() => {
        framing = false;
        enter((e) => {
          if (e.frame() && !drawn) {
            drawn = true;
            post({ type: "drawn" });
          }
        });
      });
    }
  };
  turns.port1.onmessage = () => {
    working = false;
    enter((e) => e.work(SLICE));
  };

  /** @param {FromEngine | Wish} message */
  const emit = (message) => {
    if (message.type === "fault") dead = true;
    if (message.type === "fetch") void download(message.url, message.turn);
    else if (message.type === "decode") void decode(message);
    else if (message.type === "png") void picture(message);
    else if (message.type === "write") void write(message);
    else post(message);
  };

  /** @param {string} url @param {number} turn */
  const download = async (url, turn) => {
    /** @type {Uint8Array[]} */
    const parts = [];
    try {
      const answer = await fetch(url, { mode: "cors", credentials: "omit" });
      if (!answer.ok) {
        enter((e) => e.fetched(url, turn, undefined, `the server answered ${answer.status} ${answer.statusText}`.trim()));
        return;
      }
      const total = Number(answer.headers.get("content-length")) || 0;
      const reader = answer.body?.getReader();
      let got = 0;
      for (;;) {
        const { done, value } = (await reader?.read()) ?? { done: true, value: undefined };
        if (done || !value) break;
        parts.push(value);
        got += value.length;
        if (got > MOST_FETCHED) throw new RangeError("the file is larger than 1 GB");
        post({ type: "progress", what: `Reading ${new URL(url, location.href).pathname.split("/").pop()}`, done: total ? got / total : -1, cancel: true });
      }
      const bytes = new Uint8Array(got);
      parts.reduce((at, part) => (bytes.set(part, at), at + part.length), 0);
      const name = decodeURIComponent(new URL(url, location.href).pathname.split("/").pop() ?? "");
      const parcel = await formats.read({ names: [name], bytes: [bytes], wanted: undefined, budget: engine?.budget() ?? 0 });
      enter((e) => e.fetched(url, turn, parcel, ""));
    } catch (error) {
      const why = error instanceof RangeError
        ? error.message
        : "it could not be reached, or its server does not allow other sites to read it (CORS); download the file and drop it here instead";
      enter((e) => e.fetched(url, turn, undefined, why));
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

  /** The media types of what exports are made of. @type {Record<string, string>} */
  const types = { obj: "model/obj", mtl: "model/mtl", glb: "model/gltf-binary", png: "image/png", jpg: "image/jpeg", jpeg: "image/jpeg", webp: "image/webp" };

  /** @param {Extract<Wish, { type: "write" }>} wish */
  const write = async ({ name, bytes }) => {
    try {
      for (const out of await formats.write({ packed: bytes, file: name })) {
        const mime = types[out.name.split(".").pop()?.toLowerCase() ?? ""] ?? "application/octet-stream";
        post({ type: "file", name: out.name, mime, bytes: out.bytes }, [out.bytes.buffer]);
      }
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      post({ type: "card", card: { id: "write", kind: "error", title: `${name} could not be written`, lines: [sentence(why)], ask: "" } });
    }
  };

  /** Reads files in a thread of their own. A card tells what goes wrong. @param {NamedFile[]} files @param {string} text @param {boolean} again */
  const parcelOf = async (files, text, again) => {
    const { names, bytes, failed } = await read(files);
    const trouble = (/** @type {string} */ name, /** @type {string} */ why) =>
      post({ type: "card", card: { id: "read", kind: "error", title: `${name} could not be read`, lines: [sentence(why)], ask: "" } });
    if (failed) trouble(failed, "The browser gave no bytes: it may have moved or changed; drop it again.");
    if (!engine || !names.length) return undefined;
    try {
      return await formats.read({ names, bytes, wanted: engine.wanted(text, again), budget: engine.budget() });
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

  /** @param {Extract<ToEngine, { type: "start" }>} start */
  const begin = async (start) => {
    const { canvas } = start;
    // On WebGL2 nobody but the canvas tells that the device is gone.
    canvas.addEventListener("webglcontextlost", () => fault("the graphics device was lost"));
    const renderer = start.renderer ?? (await probe());
    const folder = renderer === "webgpu" ? "webgpu" : "webgl";
    try {
      const base = new URL(`../pkg/${folder}/`, import.meta.url);
      const wasm = fetch(new URL("limn_engine_bg.wasm", base));
      /** @type {import("./protocol.js").EngineModule} */
      const module = await import(new URL("limn_engine.js", base).href);
      await module.default({ module_or_path: wasm });
      const { width, height, scale, insets } = start.size;
      const memory = Reflect.get(navigator, "deviceMemory") ?? 8;
      engine = await module.Engine.create(canvas, renderer, width, height, scale, insets, start.theme, start.calm, memory, emit);
    } catch (error) {
      dead = true;
      post({ type: "fault", kind: "renderer", message: `${renderer === "webgpu" ? "WebGPU" : "WebGL2"}: ${error instanceof Error ? error.message : error}` });
      return;
    }
    // Messages that came meanwhile wait until the files are read: the document comes first.
    const parcel = await parcelOf(start.files, start.text, false);
    enter((e) => e.replay(start.text, start.notice, parcel));
    for (const message of waiting.splice(0)) deliver(message);
  };

  /** @param {ToEngine} message */
  const deliver = (message) => {
    if (dead) return;
    if (message.type === "start") {
      void begin(message);
      return;
    }
    if (!engine) {
      waiting.push(message);
      return;
    }
    switch (message.type) {
      case "open":
      case "reload": {
        const again = message.type === "reload";
        const mine = (asked += 1);
        formats.stop();
        const size = message.files.reduce((sum, { file }) => sum + file.size, 0);
        if (size > TALKED_ABOUT) post({ type: "progress", what: `Reading ${message.files[0]?.name}`, done: -1, cancel: true });
        void parcelOf(message.files, "", again).then((parcel) => {
          // Cancelled, or something else was dropped since.
          if (mine !== asked) return;
          if (parcel || (again && !message.files.length)) enter((e) => e.open(parcel, again));
          post({ type: "taken" });
          if (size > TALKED_ABOUT) post({ type: "progress", what: "", done: 0, cancel: false });
        });
        break;
      }
      case "replay":
        enter((e) => e.replay(message.text, "", undefined));
        break;
      case "cmd":
        enter((e) => e.command(message.text, message.echo ?? false, message.drag ?? false));
        break;
      case "input":
        enter((e) => e.input(message.batch));
        break;
      case "size": {
        const { width, height, scale, insets } = message.size;
        enter((e) => e.resize(width, height, scale, insets));
        break;
      }
      case "theme":
        enter((e) => e.theme(message.theme));
        break;
      case "cancel":
        asked += 1;
        formats.stop();
        post({ type: "progress", what: "", done: 0, cancel: false });
        enter((e) => e.cancel());
        post({ type: "pong" });
        break;
      case "ping":
        post({ type: "pong" });
        break;
    }
  };
  return deliver;
}

/** With a capital and a full stop. @param {string} text */
function sentence(text) {
  const whole = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}

/** Which of the two modules this browser can draw with. @returns {Promise<Renderer>} */
async function probe() {
  try {
    return (await navigator.gpu?.requestAdapter()) ? "webgpu" : "webgl2";
  } catch {
    return "webgl2";
  }
}

/** @param {NamedFile[]} files */
async function read(files) {
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
