// @ts-check
// The engine's surroundings: loads the one of the two engines that this browser can draw with, and the kernel with every
// scheme when one is chosen that the engine has no rules of; hands over the page's messages, and gives the engine its turns. Long work comes in slices of a few milliseconds; between two of them the thread takes messages, so
// input, Cancel and drawing go on. Runs in a worker, or on the page where workers cannot draw.

/** @typedef {import("./protocol.js").ToEngine} ToEngine */
/** @typedef {import("./protocol.js").FromEngine} FromEngine */
/** @typedef {import("./protocol.js").NamedFile} NamedFile */
/** @typedef {import("./protocol.js").Renderer} Renderer */
/** @typedef {import("./protocol.js").Engine} Engine */
/** @typedef {import("./errands.js").Wish} Wish */
/** @typedef {import("./errands.js").Errands} Errands */

/** One slice of work, in milliseconds. */
const SLICE = 8;
/** Files smaller than this are read before anybody could wonder, in bytes. */
const TALKED_ABOUT = 3_000_000;
/** Loading that takes less is not talked about, in milliseconds. */
const QUIET = 200;

/**
 * @param {(message: FromEngine, transfer?: Transferable[]) => void} post
 * @returns {(message: ToEngine) => void} takes the page's messages
 */
export function createHost(post) {
  /** @type {Engine | null} */
  let engine = null;
  /** @type {ToEngine[]} */
  const waiting = [];
  /** @type {Renderer | undefined} */
  let drawsOn;
  let dead = false;
  let working = false;
  let framing = false;
  let drawn = false;
  /** Counts what was asked to be opened: an answer to an older wish is dropped. */
  let asked = 0;
  /** @type {Promise<Errands> | null} */
  let errands = null;
  /** Whether the kernel is being loaded, and how often that was tried. */
  let loading = false;
  let tries = 0;
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
    if (!loading && engine.wants_kernel()) void kernel();
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
  /** Loads the module with every scheme into this thread. */
  const kernel = async () => {
    loading = true;
    let what = "";
    const tell = () => post({ type: "progress", what, done: -1, cancel: true });
    const slow = setTimeout(() => {
      if (!engine?.wants_kernel()) return;
      what = "Loading the scheme";
      tell();
    }, QUIET);
    /** @type {import("./protocol.js").Kernel | undefined} */
    let made;
    try {
      // Another address each time: a browser may keep what failed, and a module that ran out of memory is of no more use.
      const { Kernel } = await load((await import("./vectors.js")).KERNEL, tries ? `?${tries}` : "");
      const kernel = new Kernel();
      made = await (await import("./fill.js")).attach(kernel, drawsOn, () => enter((e) => e.work(0)));
    } catch {}
    tries += 1;
    loading = false;
    clearTimeout(slow);
    if (what) {
      what = "";
      tell();
    }
    enter((e) => e.take_kernel(made));
  };

  turns.port1.onmessage = () => {
    working = false;
    enter((e) => e.work(SLICE));
  };

  /** @param {FromEngine | Wish} message */
  const emit = (message) => {
    if (message.type === "fault") dead = true;
    if (message.type === "fetch" || message.type === "decode" || message.type === "png" || message.type === "write") {
      void errand((e) => e.run(message));
    } else post(message);
  };

  /**
   * Does something that only errands.js can, which is loaded by the first of them.
   * @template T @param {(errands: Errands) => T | Promise<T>} act @returns {Promise<T | undefined>}
   */
  const errand = async (act) => {
    /** @type {Errands} */
    let found;
    try {
      found = await (errands ??= import("./errands.js").then(({ createErrands }) =>
        createErrands({ post, enter, budget: () => engine?.budget() ?? 0 })));
    } catch {
      errands = null;
      enter((e) => e.cancel());
      const lines = ["Is the network there? Try again, or reload the page."];
      post({ type: "card", card: { id: "read", kind: "error", title: "A part of Limn could not be loaded", lines, ask: "" } });
      return undefined;
    }
    return act(found);
  };

  /** Reads the model among files. @param {NamedFile[]} files @param {string} text @param {boolean} again @param {() => boolean} still */
  const read = async (files, text, again, still) => {
    if (!files.length) return undefined;
    /** @type {string | undefined} */
    let wanted;
    enter((e) => (wanted = e.wanted(text, again)));
    return errand((e) => e.read(files, wanted, still));
  };

  /** @param {Extract<ToEngine, { type: "start" }>} start */
  const begin = async (start) => {
    const { canvas } = start;
    // On WebGL2 nobody but the canvas tells that the device is gone.
    canvas.addEventListener("webglcontextlost", () => fault("the graphics device was lost"));
    const renderer = (drawsOn = start.renderer ?? (await probe()));
    const folder = renderer === "webgpu" ? "webgpu" : "webgl";
    try {
      const module = await load(folder);
      const { width, height, scale, insets } = start.size;
      const memory = Reflect.get(navigator, "deviceMemory") ?? 8;
      engine = await module.Engine.create(canvas, renderer, width, height, scale, insets, start.theme, start.calm, memory, emit);
    } catch (error) {
      dead = true;
      post({ type: "fault", kind: "renderer", message: `${renderer === "webgpu" ? "WebGPU" : "WebGL2"}: ${error instanceof Error ? error.message : error}` });
      return;
    }
    // Messages that came meanwhile wait until the files are read: the document comes first.
    const parcel = await read(start.files, start.text, false, () => true);
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
        void errands?.then((e) => e.stop());
        const size = message.files.reduce((sum, { file }) => sum + file.size, 0);
        if (size > TALKED_ABOUT) post({ type: "progress", what: `Reading ${message.files[0]?.name}`, done: -1, cancel: true });
        void read(message.files, "", again, () => mine === asked).then((parcel) => {
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
        void errands?.then((e) => e.stop());
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

/**
 * Loads a wasm module and its glue.
 * @param {string} id the folder under pkg/ @param {string} [again] makes the address another one
 * @returns {Promise<import("./protocol.js").WasmModule>}
 */
async function load(id, again = "") {
  const base = new URL(`../pkg/${id}/limn_${id < "w" ? "kernel" : "engine"}`, import.meta.url).href;
  const [module, wasm] = await Promise.all([import(`${base}.js${again}`), fetch(`${base}_bg.wasm`)]);
  await module.default({ module_or_path: wasm });
  return module;
}

/** Which of the two engines this browser can draw with. @returns {Promise<Renderer>} */
async function probe() {
  try {
    return (await navigator.gpu?.requestAdapter()) ? "webgpu" : "webgl2";
  } catch {
    return "webgl2";
  }
}
