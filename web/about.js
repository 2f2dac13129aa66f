// @ts-check
// How a scheme works: what it is, what it takes, and its rules as pictures. Facts and weights come from the module with every
// scheme, which records its own rules on small patches; nothing is drawn by hand. Fetched when it is first asked for.

import { byId, el, setAttr, styles } from "./dom.js";
import { KERNEL } from "./vectors.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {{ title: string, target: [number, number], points: [number, number][], faces: number[][], weights: [number, number, string][] }} Stencil */
/**
 * @typedef {{ name: string, group: string, summary: string, source: string, takes: string, rim: string, keeps: boolean, dual: boolean,
 *   params: { name: string, summary: string, range: string }[], valences: number[], stencils: Stencil[] }} Scheme
 */

/** Pixels of a picture to an edge of about 1. */
const UNIT = 68;
/** What is around a picture's points, in pixels: half a point's disc and its outline. */
const MARGIN = 22;

export class About {
  #body = el("div", {});
  #root = el("aside", { id: "about-scheme", "aria-label": "How the scheme works", hidden: true },
    el("button", { id: "about-close", type: "button", title: "Close (Esc)", onclick: () => this.close() }, "Close"), this.#body);
  #button = byId("about");
  #valence = 5;
  #made = "";
  /** @type {State | null} */ #state = null;

  /** Ready to be shown. */
  static async create(/** @type {() => void} */ resized) {
    const base = new URL(`../pkg/${KERNEL}/limn_kernel`, import.meta.url).href;
    /** @type {[import("./protocol.js").WasmModule, unknown]} */
    const [module] = await Promise.all([import(`${base}.js`), styles("web/about.css")]);
    await module.default({ module_or_path: fetch(`${base}_bg.wasm`) });
    return new About(module.about, resized);
  }

  /** @param {(id: string, values: Float64Array, valence: number) => string} tell @param {() => void} resized */
  constructor(tell, resized) {
    this.tell = tell;
    this.resized = resized;
    byId("panel").before(this.#root);
    setAttr(this.#button, "aria-controls", "about-scheme");
    addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || this.#root.hidden || event.defaultPrevented) return;
      event.preventDefault();
      this.close();
    }, true);
  }

  /** @param {State | null} state */
  toggle(state) {
    if (!this.#root.hidden) return this.close();
    // On a phone there is room for one sheet.
    if (matchMedia("(max-width: 640px)").matches) document.getElementById("panel-close")?.click();
    this.#set(true);
    if (state) this.show(state);
    byId("about-close").focus({ preventScroll: true });
  }

  close() {
    const inside = this.#root.contains(document.activeElement) || document.activeElement === document.body;
    this.#set(false);
    if (inside) this.#button.focus({ preventScroll: true });
  }

  /** @param {boolean} open */
  #set(open) {
    this.#root.hidden = !open;
    document.documentElement.classList.toggle("explained", open);
    setAttr(this.#button, "aria-expanded", String(open));
    this.resized();
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    const values = state.params.map(({ value }) => value);
    const made = JSON.stringify([state.scheme, values, this.#valence]);
    if (this.#root.hidden || made === this.#made || !state.scheme) return;
    this.#made = made;
    const text = this.tell(state.scheme, new Float64Array(values), this.#valence);
    if (text) this.#fill(JSON.parse(text));
  }

  /** @param {Scheme} scheme */
  #fill({ name, group, summary, source, takes, rim, keeps, dual, params, valences, stencils }) {
    /** @type {[string, string, string?][]} */
    const facts = [
      ["Kind", group], ["Takes", takes], ["Old vertices", dual ? "cut off: a face for each" : keeps ? "stay where they are" : "move"],
      ["Open rims", rim], ...params.map(({ name, summary, range }) => /** @type {[string, string, string]} */ ([name, summary, range])), ["Source", source],
    ];
    const figures = (/** @type {(title: string) => boolean} */ which) =>
      el("div", { className: "figures" }, ...stencils.filter(({ title }) => which(title)).map(figure));
    const irregular = (/** @type {string} */ title) => /, (valence|face of) /.test(title);
    const open = (/** @type {string} */ title) => title.endsWith(", boundary");
    const parts = [el("h1", {}, name), el("p", { className: "summary" }, summary),
      el("dl", {}, ...facts.flatMap(([what, is, range]) => [el("dt", {}, what), el("dd", {}, is, ...(range ? [el("small", {}, range)] : []))])),
      el("h2", {}, "New points"), figures((title) => !irregular(title) && !open(title)),
      el("h2", { id: "about-irregular" }, dual ? "Faces of other corners" : "At an irregular vertex"),
      el("div", { className: "valences", role: "group", "aria-label": dual ? "Corners" : "Valence" }, ...valences.map((n) =>
        el("button", { type: "button", "aria-pressed": n === this.#valence, "data-valence": n, onclick: () => this.#choose(n) }, String(n)))),
      figures(irregular)];
    if (!stencils.some(({ title }) => irregular(title))) parts.push(el("p", {}, "The same as above."));
    if (stencils.some(({ title }) => open(title))) parts.push(el("h2", {}, "On an open rim"), figures(open));
    this.#body.replaceChildren(...parts);
  }

  /** @param {number} valence */
  #choose(valence) {
    this.#valence = valence;
    if (this.#state) this.show(this.#state);
    /** @type {HTMLElement | null} */ (this.#body.querySelector(`[data-valence="${valence}"]`))?.focus({ preventScroll: true });
  }
}

/** @param {Stencil} stencil */
function figure({ title, target, points, faces, weights }) {
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  const [left, top] = [Math.min(...xs), Math.max(...ys)];
  const at = (/** @type {[number, number]} */ [x, y]) => [MARGIN + (x - left) * UNIT, MARGIN + (top - y) * UNIT];
  const width = 2 * MARGIN + (Math.max(...xs) - left) * UNIT;
  const height = 2 * MARGIN + (top - Math.min(...ys)) * UNIT;
  const short = title.replace(/, .*/, "");
  const said = weights.map(([, , text]) => text).join(", ");
  const picture = svg("svg", { viewBox: `0 0 ${width.toFixed(1)} ${height.toFixed(1)}`, width: width.toFixed(0), role: "img", "aria-label": `${title}: weights ${said}` });
  const [tx = 0, ty = 0] = at(target);
  for (const face of faces) {
    picture.append(svg("polygon", { points: face.map((v) => at(points[v] ?? [0, 0]).map((c) => c.toFixed(1)).join()).join(" ") }));
  }
  let over = false;
  for (const [v, weight, text] of weights) {
    const [x = 0, y = 0] = at(points[v] ?? [0, 0]);
    over ||= Math.hypot(x - tx, y - ty) < 9;
    const size = text.length > 5 ? 9 : text.length > 4 ? 10 : 11.5;
    picture.append(
      svg("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: "17", class: weight < 0 ? "minus" : "plus" }),
      svg("text", { x: x.toFixed(1), y: y.toFixed(1), "font-size": String(size) }, text),
    );
  }
  // A new point in an old one's place is a ring around it.
  picture.append(svg("circle", { cx: tx.toFixed(1), cy: ty.toFixed(1), r: over ? "20.5" : "6", class: over ? "target ring" : "target" }));
  return el("figure", {}, picture, el("figcaption", {}, short));
}

/** @param {string} tag @param {Record<string, string>} attributes @param {string} [text] */
function svg(tag, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}
