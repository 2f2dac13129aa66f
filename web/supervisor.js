// @ts-check
// The engine's lifetime. It runs in a worker and is disposable: after a fault, or when it does not answer, it is ended and a
// new one replays the document's text on a new canvas. The page keeps just two things for that, and reads neither: the
// source's files and the latest text.
//
//   first replay: the text as it was before the work that was going on
//   second:       the source alone
//   third:        the built-in model, and a card that says so

import { byId } from "./dom.js";

/** @typedef {import("./protocol.js").ToEngine} ToEngine */
/** @typedef {import("./protocol.js").FromEngine} FromEngine */
/** @typedef {import("./protocol.js").NamedFile} NamedFile */
/** @typedef {import("./protocol.js").Renderer} Renderer */

/** How long a cancelled engine may take to answer, in milliseconds. */
const CANCEL_PATIENCE = 2_000;
/** How long an engine that is not reading a file may be silent. */
const SILENCE = 12_000;
/** An engine that has worked this long is healthy: the next fault counts as a first one. */
const HEALTHY = 10_000;

export class Supervisor {
  /** @type {Worker | { terminate(): void, postMessage(message: ToEngine): void } | null} */ engine = null;
  /** @type {HTMLCanvasElement | null} */ #canvas = null;
  /** @type {NamedFile[]} */ #files = [];
  /** Whether they were read. */ #taken = false;
  /** Files that are on their way: they become the source once the engine shows them. @type {NamedFile[] | null} */ #coming = null;
  /** The text of the last state with nothing going on, and the part of it that opens the model. */
  #settled = "";
  #origin = "";
  /** @type {Renderer | null} */ #renderer;
  #attempt = 0;
  #since = 0;
  #heard = 0;
  #cancel = 0;
  #reading = false;
  /** @type {Promise<void>} */ #inline = Promise.resolve();

  /**
   * @param {(message: FromEngine) => void} receive
   * @param {() => import("./protocol.js").Size} size
   * @param {() => import("./protocol.js").Theme} theme
   */
  constructor(receive, size, theme) {
    this.receive = receive;
    this.size = size;
    this.theme = theme;
    const asked = location.search;
    this.#renderer = /=webgpu/.test(asked) ? "webgpu" : /=webgl/.test(asked) ? "webgl2" : null;
    setInterval(() => this.#listen(), 3_000);
  }

  /** The files that the model on the screen was read from. */
  get files() {
    return this.#files;
  }

  /** Starts an engine on a new canvas. @param {string} text what it begins with @param {string} [notice] */
  start(text, notice = "") {
    const canvas = document.createElement("canvas");
    canvas.className = "fresh";
    byId("stage").append(canvas);
    this.#canvas = canvas;
    this.#since = this.#heard = performance.now();
    this.#reading = true;
    const size = this.size();
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const message = { renderer: this.#renderer, size, theme: this.theme(), calm, text, files: this.#files.map(plain), notice };
    if ("transferControlToOffscreen" in canvas && workersDraw()) {
      const worker = new Worker(new URL(`./worker.js${location.search}`, import.meta.url), { type: "module", name: "limn engine" });
      this.engine = worker;
      worker.onmessage = (event) => this.engine === worker && this.#hear(event.data);
      worker.onerror = (event) => {
        event.preventDefault();
        if (this.engine === worker) this.#lost(event.message || "the engine could not be loaded");
      };
      // Whoever ends the worker, the picture returns.
      worker.terminate = () => {
        Worker.prototype.terminate.call(worker);
        if (this.engine === worker) this.#lost("it was ended");
      };
      const offscreen = canvas.transferControlToOffscreen();
      worker.postMessage({ type: "start", canvas: offscreen, ...message }, [offscreen]);
    } else {
      this.#startHere({ type: "start", canvas, ...message });
    }
  }

  /** @param {ToEngine} message */
  send(message) {
    if (message.type === "open" || message.type === "reload") {
      this.#coming = message.files;
      this.#taken = false;
      this.#reading = true;
      message = { ...message, files: message.files.map(plain) };
    }
    if (message.type === "cancel" && !this.#cancel) {
      this.#cancel = window.setTimeout(() => {
        this.#cancel = 0;
        // What the visitor wanted: nothing needs to be explained.
        this.#replace(this.#settled || location.hash, "");
      }, CANCEL_PATIENCE);
    }
    this.engine?.postMessage(message);
  }

  /** @param {FromEngine} message */
  #hear(message) {
    this.#heard = performance.now();
    clearTimeout(this.#cancel);
    this.#cancel = 0;
    if (message.type === "fault") {
      if (message.kind === "renderer" && this.#renderer !== "webgl2") {
        // A canvas that has been asked for WebGPU never gives WebGL2: the new engine gets a new one.
        this.#renderer = "webgl2";
        this.#replace(this.#settled || location.hash, "");
      } else if (message.kind === "renderer") {
        this.#end();
        this.receive({
          type: "card",
          card: { id: "fault", kind: "error", title: "This browser cannot draw the model", lines: [message.message], ask: "" },
        });
        this.receive(message);
      } else {
        this.#lost(message.message);
      }
      return;
    }
    if (message.type === "drawn") this.#retire();
    if (message.type === "taken") {
      this.#taken = true;
      return;
    }
    if (message.type === "progress") this.#reading = message.what.startsWith("Reading");
    if (message.type === "state" && !message.busy) {
      this.#reading = false;
      this.#settled = message.text;
      this.#origin = message.origin;
      if (this.#coming && this.#taken) {
        // A file that could not be opened leaves the last model, and that model's files.
        const shown = this.#coming.some(({ name }) => message.origin.includes(name.split("/").pop() ?? name));
        if (shown && message.model?.reload === "file") this.#files = this.#coming;
        this.#coming = null;
      }
      if (performance.now() - this.#since > HEALTHY) this.#attempt = 0;
    }
    this.receive(message);
  }

  /** A heartbeat: a dead worker says nothing, and nobody tells the page. */
  #listen() {
    if (!this.engine || document.visibilityState !== "visible") {
      this.#heard = performance.now();
      return;
    }
    if (!this.#reading && performance.now() - this.#heard > SILENCE) this.#lost("it did not answer");
    else this.engine.postMessage({ type: "ping" });
  }

  /** @param {string} why */
  #lost(why) {
    console.warn(`limn: the engine is replaced: ${why}`);
    if (performance.now() - this.#since > HEALTHY) this.#attempt = 0;
    this.#attempt += 1;
    if (this.#attempt === 1) this.#replace(this.#settled || location.hash, why);
    else if (this.#attempt === 2) this.#replace(this.#origin, why);
    else if (this.#attempt === 3) {
      this.#files = [];
      this.#replace("", why);
    } else {
      this.#end();
      const lines = [`It stopped ${this.#attempt} times in a row: ${why}.`, "Reload the page to try again."];
      this.receive({ type: "card", card: { id: "fault", kind: "error", title: "The engine does not start", lines, ask: "" } });
      this.receive({ type: "fault", kind: "trap", message: why });
    }
  }

  /** @param {string} text @param {string} why */
  #replace(text, why) {
    this.#end();
    this.receive({ type: "progress", what: "", done: 0, cancel: false });
    const notices = [
      "",
      "Your model is back as it was before the last command.",
      "Your model is back without its commands.",
      "The model could not be brought back, so here is the built-in one.",
    ];
    this.start(text, why && `The engine stopped: ${why}. ${notices[this.#attempt] ?? ""}`);
  }

  #end() {
    const old = this.engine;
    this.engine = null;
    clearTimeout(this.#cancel);
    this.#cancel = 0;
    old?.terminate();
    this.#coming = null;
  }

  /** The old canvas kept its last picture until now. */
  #retire() {
    for (const canvas of byId("stage").querySelectorAll("canvas")) if (canvas !== this.#canvas) canvas.remove();
    this.#canvas?.classList.remove("fresh");
  }

  /**
   * The same engine on the page's own thread, where workers cannot draw.
   * @param {Extract<ToEngine, { type: "start" }>} start
   */
  #startHere(start) {
    /** @type {((message: ToEngine) => void) | null} */
    let deliver = null;
    const self = {
      terminate: () => { deliver = () => {}; },
      /** @param {ToEngine} message */
      postMessage: (message) => void this.#inline.then(() => deliver?.(message)),
    };
    this.engine = self;
    this.#inline = import("./host.js").then(({ createHost }) => {
      deliver = createHost((message) => this.engine === self && this.#hear(message));
      deliver(start);
    });
  }
}

/** Handles do not travel, and the engine has no use for them. @param {NamedFile} named */
function plain({ name, file }) {
  return { name, file };
}

/** Safari before 17 transfers canvases that then give no GPU context. */
function workersDraw() {
  try {
    return new OffscreenCanvas(1, 1).getContext("webgl2") !== null || "gpu" in navigator;
  } catch {
    return false;
  }
}
