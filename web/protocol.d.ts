/**
 * What the page and the engine say to each other: the types of crates/engine/src/protocol.rs, where each message is
 * described. The page never computes from these values; it shows them and sends command texts that it was given.
 */

export type Renderer = "webgpu" | "webgl2";

/** A file by the name that its siblings know it by ("textures/wood.png" for a file in a dropped folder). */
export interface NamedFile {
  name: string;
  file: File;
  /** Where the browser gives one: reads the file anew after it changed on disk. Stays on the page. */
  handle?: FileSystemFileHandle;
}

/** CSS pixels unless said otherwise. */
export interface Size {
  /** Device pixels of the canvas. */
  width: number;
  height: number;
  /** Device pixels per CSS pixel. */
  scale: number;
  /** What the page's furniture covers at each side: the model is centred in the rest. */
  insets: [top: number, right: number, bottom: number, left: number];
}

/** What the page sends. */
export type ToEngine =
  | {
      type: "start";
      canvas: OffscreenCanvas | HTMLCanvasElement;
      renderer: Renderer | null;
      size: Size;
      theme: Theme;
      /** No motion, please. */
      calm: boolean;
      /** A link's fragment or a document's text; empty for a first visit. */
      text: string;
      files: NamedFile[];
      /** Why this engine replaces another one; empty for the first. */
      notice: string;
    }
  | { type: "open"; files: NamedFile[] }
  | { type: "reload"; files: NamedFile[] }
  | { type: "replay"; text: string }
  | { type: "cmd"; text: string; echo?: boolean; drag?: boolean }
  | { type: "input"; batch: Float32Array }
  | { type: "size"; size: Size }
  | { type: "theme"; theme: Theme }
  | { type: "cancel" }
  | { type: "ping" };

export type Theme = "dark" | "light";

/** What the engine sends. */
export type FromEngine =
  | Hello
  | State
  | Progress
  | { type: "card"; card: Card }
  | { type: "log"; command: string; text: string; ok: boolean; offer: Offer | null }
  | { type: "file"; name: string; mime: string; bytes: Uint8Array<ArrayBuffer> }
  | { type: "fault"; message: string; kind: "trap" | "renderer" }
  /** The first picture is on the canvas: an older canvas can go. */
  | { type: "drawn" }
  | { type: "pong" }
  /** The files of the last `open` or `reload` were read; the next state that is not busy shows them, or why not. */
  | { type: "taken" };

/** Sent once, when the engine is ready to take commands: everything that the page's controls are made from. */
export interface Hello {
  type: "hello";
  renderer: Renderer;
  adapter: string;
  version: string;
  schemes: Scheme[];
  models: { name: string; summary: string }[];
  controls: Control[];
  keys: Key[];
  commands: { name: string; args: string; help: string; class: string }[];
}

export interface Scheme {
  id: string;
  name: string;
  group: string;
  summary: string;
  command: string;
}

/** A row of choices in the panel; the chosen one is named in `State.values` under the same id. */
export interface Control {
  id: string;
  tab: "view" | "surface";
  label: string;
  help: string;
  kind: "choice" | "switch" | "actions";
  choices: { value: string; label: string; command: string }[];
}

/** One key: it sends a command, or asks the page for an action that only a page can take. */
export interface Key {
  /** `KeyboardEvent.key`, lower case. */
  key: string;
  shift: boolean;
  /** Ctrl, or Command on a Mac. */
  mod: boolean;
  /** Which heading it stands under in the help. */
  group: string;
  /** Empty for keys that another one's line in the help speaks for. */
  label: string;
  command: string;
  page: "" | "open" | "help" | "copy" | "panel" | "theme" | "console" | "escape";
}

export interface Counts {
  vertices: number;
  edges: number;
  faces: number;
  bytes: number;
}

export interface Level extends Counts {
  level: number;
  label: string;
  allowed: boolean;
  /** A sentence for the title: the counts, or why the level is out of reach. */
  title: string;
  command: string;
}

export interface Group {
  name: string;
  faces: number;
  hidden: boolean;
  command: string;
}

/** One of several schemes that are shown side by side. */
export interface Pane extends Counts {
  scheme: string;
  /** With what was set of it. */
  name: string;
  /** Why nothing is shown, or what was done to the model first; may be empty. */
  note: string;
  /** CSS pixels: left, top, width, height. The words go to its foot. */
  rect: [number, number, number, number];
  /** Makes it the first; empty for the first. */
  choose: string;
  /** Takes it away; empty for the first. */
  leave: string;
}

/** A parameter of the chosen scheme. */
/** A scheme that takes over at a later level. */
export interface Run {
  from: number;
  name: string;
  /** Lets the scheme before it go on in its place. */
  leave: string;
}

/** What would let a refused command work. */
export interface Offer {
  label: string;
  commands: string[];
}

export interface Parameter {
  key: string;
  name: string;
  summary: string;
  kind: "number" | "whole" | "choice";
  /** Of numbers. */
  low: number;
  high: number;
  default: number;
  value: number;
  /** The value as a word of a command. */
  text: string;
  /** Of choices; `text` names the chosen one. */
  choices: { value: string; label: string; command: string }[];
  /** Sets a number that is appended; other parameters stay. */
  command: string;
}

/** The whole view model, sent at most once a frame. */
export interface State {
  type: "state";
  /** Null until a model has been read. */
  model: {
    name: string;
    summary: string;
    builtin: boolean;
    reload: string;
    facts: { label: string; value: string }[];
  } | null;
  scheme: string;
  params: Parameter[];
  /** Schemes that take over later. */
  runs: Run[];
  /** Levels that are faired, and by how many iterations. */
  fairings: [number, number][];
  level: number;
  levels: Level[];
  /** What is on the screen. */
  shown: Counts & { level: number; scheme: string };
  times: { read: number; refine: number; gpu: boolean; build: number; draw: number };
  busy: boolean;
  /** Schemes side by side: none, or the present one and those beside it; `add` takes another one's id, unless it is empty. */
  compare: { panes: Pane[]; add: string };
  values: Record<string, string>;
  /** Controls that do not apply to this model. */
  disabled: string[];
  groups: Group[];
  report: { text: string; kind: "note" | "warning" }[];
  exports: { label: string; help: string; command: string }[];
  /** What undo would take back, such as "level 3"; null if nothing. */
  undo: string | null;
  redo: string | null;
  text: string;
  /** The part of `text` that opens the model. */
  origin: string;
  /** The fragment of a link to this picture, with its "#". */
  link: string;
  /** What the receiver of the link will miss; empty if nothing. */
  linkNote: string;
}

/** Work that takes longer than 200 ms. */
export interface Progress {
  type: "progress";
  /** "Reading cow.obj", "Refining to level 4"; empty when there is nothing to wait for. */
  what: string;
  /** 0 to 1, or negative where nobody can tell. */
  done: number;
  cancel: boolean;
}

/** A quiet message that stays until it is dismissed, or until one with the same id replaces it. */
export interface Card {
  id: string;
  kind: "error" | "note";
  title: string;
  lines: string[];
  /** Ask for these files again: the card shows an open button. */
  ask: string;
}

/** A wasm module as wasm-bindgen makes it: one of the two engines, or the kernel with every scheme. */
export interface WasmModule {
  default(source: { module_or_path: Response | Promise<Response> }): Promise<unknown>;
  Engine: {
    create(
      canvas: OffscreenCanvas | HTMLCanvasElement,
      renderer: Renderer,
      width: number,
      height: number,
      scale: number,
      insets: number[],
      theme: Theme,
      calm: boolean,
      memory: number,
      emit: (message: never) => void,
    ): Promise<Engine>;
  };
  Kernel: new () => import("./fill.js").Kernel;
  /** What is to be told of a scheme, as JSON: crates/kernel/src/about.rs. */
  about(id: string, values: Float64Array, valence: number): string;
}

/** Refines by every scheme; only the engine calls it: crates/kernel/src/lib.rs. */
export type Kernel = Awaited<ReturnType<typeof import("./fill.js").attach>>;

/** The engine's calls: crates/engine/src/engine/mod.rs says what each does. */
export interface Engine {
  replay(text: string, notice: string, parcel: Uint8Array | undefined): void;
  wanted(text: string, again: boolean): string | undefined;
  budget(): number;
  open(parcel: Uint8Array | undefined, again: boolean): void;
  command(text: string, echo: boolean, drag: boolean): void;
  input(batch: Float32Array): void;
  resize(width: number, height: number, scale: number, insets: number[]): void;
  theme(theme: Theme): void;
  cancel(): void;
  has_work(): boolean;
  work(milliseconds: number): void;
  wants_kernel(): boolean;
  take_kernel(kernel: Kernel | undefined): void;
  wants_frame(): boolean;
  frame(): boolean;
  fetched(url: string, turn: number, parcel: Uint8Array | undefined, error: string): void;
  decoded(turn: number, index: number, bitmap: ImageBitmap | undefined): void;
}

/** The part of a dedicated worker's global scope that the engine's thread uses. */
export interface WorkerScope {
  postMessage(message: FromEngine, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToEngine>) => void) | null;
}
