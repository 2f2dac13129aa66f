// @ts-check
// The page: it forwards what a visitor does to the engine and shows the engine's last state. It keeps no model state of its
// own; what the parts of the page are is in the modules that it joins here.

import * as cards from "./cards.js";
import { Chrome } from "./chrome.js";
import { byId } from "./dom.js";
import { Drawer } from "./drawer.js";
import * as files from "./files.js";
import * as input from "./input.js";
import * as keys from "./keys.js";
import { Link } from "./link.js";
import { Ruler } from "./ruler.js";
import { Supervisor } from "./supervisor.js";

/** @typedef {import("./protocol.js").FromEngine} FromEngine */
/** @typedef {import("./protocol.js").Theme} Theme */

/** The model keeps clear of the page's words, but for their widest parts, which few models reach: CSS pixels. */
const TOP = 44;
const OVERLAP = 16;

const root = document.documentElement;
const stage = byId("stage");

// Theme: the system's, until a visitor chooses.
const dark = matchMedia("(prefers-color-scheme: dark)");
const chosen = () => {
  try {
    return localStorage.getItem("limn-theme");
  } catch {
    return null;
  }
};
/** @returns {Theme} */
const theme = () => (root.dataset["theme"] === "light" ? "light" : "dark");
const setTheme = (/** @type {Theme} */ to) => {
  root.dataset["theme"] = to;
  const label = to === "dark" ? "Light" : "Dark";
  byId("theme").textContent = label;
  byId("theme").title = `Change to the ${label.toLowerCase()} theme`;
};
setTheme(chosen() === "light" || (chosen() !== "dark" && !dark.matches) ? "light" : "dark");

// Size: in device pixels where the browser tells them.
/** @type {[number, number] | null} */
let exact = null;
/** @returns {import("./protocol.js").Size} */
const size = () => {
  const scale = devicePixelRatio || 1;
  const box = stage.getBoundingClientRect();
  const near = [Math.round(box.width * scale), Math.round(box.height * scale)];
  // An emulated screen has another ratio than the device that it is shown on.
  const sound = exact?.every((side, i) => Math.abs(side - (near[i] ?? 0)) <= 1);
  const [width = 1, height = 1] = (sound && exact) || near;
  // Where things will be when they have stopped sliding in: offsets know nothing of animations.
  const [dock, panel] = [byId("dock"), byId("panel")];
  const wide = (/** @type {HTMLElement} */ sheet) => sheet.offsetWidth > box.width * 0.8;
  const right = panel.hidden || wide(panel) ? 0 : box.width - panel.offsetLeft;
  const scheme = document.getElementById("about-scheme");
  const left = !scheme || wide(scheme) ? 0 : scheme.offsetLeft + scheme.offsetWidth;
  const below = [scheme, panel].find((sheet) => sheet && !sheet.hidden && wide(sheet)) ?? dock;
  const bottom = box.height - below.offsetTop;
  return { width: Math.max(1, width), height: Math.max(1, height), scale, insets: [TOP, right, Math.max(0, bottom - OVERLAP), left] };
};

const engine = new Supervisor(receive, size, theme);
const send = (/** @type {string} */ text, echo = false, drag = false) => engine.send({ type: "cmd", text, echo, drag });
const sendSize = () => engine.send({ type: "size", size: size() });
const ruler = new Ruler((text, drag) => send(text, false, drag));
const chrome = new Chrome(send);
const panel = new Drawer(send, sendSize);
const link = new Link((text) => engine.send({ type: "replay", text }));

/**
 * A part of the page that is fetched when it is first needed.
 * @template P
 * @param {() => Promise<P>} load
 */
function later(load) {
  /** @type {Promise<P> | null} */
  let coming = null;
  /** At once where it is there, else when it has come; or only if it was asked for before. @param {(part: P) => void} act @param {boolean} [wanted] */
  return (act, wanted = true) => {
    if (!wanted && !coming) return;
    coming ??= load();
    coming.then(act).catch(() => {
      coming = null;
      cards.toast("A part of Limn could not be loaded: is the network there?");
    });
  };
}
const compare = later(async () => (await import("./compare.js")).Compare.create(send));
const about = later(async () => (await import("./about.js")).About.create(sendSize));
byId("compare").addEventListener("click", () => compare((part) => part.toggle(limn.state)));
byId("about").addEventListener("click", () => about((part) => part.toggle(limn.state)));

/** For the console of the browser, and for tests. */
const limn = {
  /** @type {import("./protocol.js").State | null} */ state: null,
  /** @type {import("./protocol.js").Renderer | null} */ renderer: null,
  cmd: (/** @type {string} */ text) => send(text, true),
  get engine() {
    return engine.engine;
  },
};
Reflect.set(window, "limn", limn);

/** @param {FromEngine} message */
function receive(message) {
  switch (message.type) {
    case "hello":
      limn.renderer = message.renderer;
      keys.learn(message.keys);
      chrome.learn(message);
      panel.learn(message);
      if (limn.state) receive(limn.state);
      break;
    case "state":
      limn.state = message;
      ruler.show(message);
      chrome.show(message);
      panel.show(message);
      link.show(message);
      compare((part) => part.show(message), message.compare.panes.length > 0 || message.values["kinds"] === "on");
      about((part) => part.show(message), false);
      if (message.model || message.busy) root.dataset["state"] = message.busy ? "busy" : "ready";
      break;
    case "progress":
      cards.wait(message);
      ruler.progress(message.what ? message.done : -1);
      if (message.what) root.dataset["state"] = "busy";
      break;
    case "card":
      cards.show(message.card);
      break;
    case "log":
      panel.log(message);
      if (!message.ok && !panel.listening) refused(message);
      break;
    case "file":
      save(message);
      break;
    case "fault":
      root.dataset["state"] = "fault";
      break;
  }
}

/** A command that did nothing: why, and a button for what would let it. @param {Extract<FromEngine, { type: "log" }>} log */
function refused({ command, text, offer }) {
  const card = { id: "command", kind: /** @type {const} */ ("error"), title: command, lines: [text], ask: "" };
  const mend = () => {
    cards.show({ ...card, title: "", lines: [] });
    offer?.commands.forEach((line) => send(line));
  };
  cards.show(card, mend, offer?.label);
}

/** @param {Extract<FromEngine, { type: "file" }>} file */
function save({ name, mime, bytes }) {
  const anchor = document.createElement("a");
  anchor.href = URL.createObjectURL(new Blob([bytes], { type: mime }));
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 60_000);
  cards.toast(`Saved ${name}`);
}

const open = (/** @type {import("./protocol.js").NamedFile[]} */ list) => engine.send({ type: "open", files: list });

async function reload() {
  const kind = limn.state?.model?.reload;
  if (!kind) return;
  try {
    const { again } = await import("./dropped.js");
    engine.send({ type: "reload", files: kind === "file" ? await again(engine.files) : [] });
  } catch {
    const name = limn.state?.model?.name ?? "";
    const lines = ["The browser lets a page read a chosen file only until it changes. Files that were dropped can be read again."];
    const again = () => files.pick((list) => engine.send({ type: "reload", files: list }));
    cards.show({ id: "read", kind: "error", title: `${name} has changed on disk: open it again`, lines, ask: name }, again);
  }
}

async function copy() {
  const said = await link.copy();
  cards.toast(said || "The browser did not allow copying: the link is in the address bar");
}

const flipTheme = () => {
  const to = theme() === "dark" ? "light" : "dark";
  setTheme(to);
  try {
    localStorage.setItem("limn-theme", to);
  } catch {
    // Not remembered, then.
  }
  engine.send({ type: "theme", theme: to });
};

/** @type {Record<import("./protocol.js").Key["page"], () => void>} */
const actions = {
  "": () => {},
  open: () => files.pick(),
  help: () => panel.flip("help"),
  copy: () => void copy(),
  panel: () => panel.toggle(),
  theme: flipTheme,
  console: () => panel.open("console"),
  escape: () => {
    if (document.activeElement instanceof HTMLInputElement) document.activeElement.blur();
    else if (!cards.dismiss() && panel.shown) panel.close();
  },
};
for (const id of /** @type {const} */ (["open", "help", "copy", "theme"])) byId(id).addEventListener("click", actions[id]);
byId("reload").addEventListener("click", () => void reload());
byId("cancel").addEventListener("click", () => engine.send({ type: "cancel" }));
keys.listen(send, (action) => actions[action]());
files.listen(open, (url) => send(`open ${url}`), cards.toast);
input.listen((batch) => engine.send({ type: "input", batch }));
dark.addEventListener("change", () => {
  if (chosen()) return;
  setTheme(dark.matches ? "dark" : "light");
  engine.send({ type: "theme", theme: theme() });
});
addEventListener("resize", sendSize);

const sized = new ResizeObserver(([entry]) => {
  const device = entry?.devicePixelContentBoxSize?.[0];
  exact = device ? [device.inlineSize, device.blockSize] : null;
  sendSize();
});
try {
  sized.observe(stage, { box: "device-pixel-content-box" });
} catch {
  sized.observe(stage);
}
new ResizeObserver(sendSize).observe(byId("dock"));

if (location.search === "?bench") import("./bench.js");
else engine.start(location.hash);
