// @ts-check
// Schemes side by side: what stands under each picture, pills that put a scheme beside the present one, and the legend of faces
// coloured by kind. The pictures are the engine's; so is what is compared. Fetched when it is first needed.

import { byId, el, full, setAttr, setText, styles } from "./dom.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Pane} Pane */

export class Compare {
  #panes = el("section", { id: "panes", "aria-label": "Schemes side by side" });
  #hint = el("p", { id: "compare-hint", role: "status", hidden: true });
  #legend = el("p", { id: "kinds", hidden: true }, "Made from", ...["a face", "an edge", "a vertex"].map((what) => el("span", {}, what)));
  #button = byId("compare");
  #schemes = byId("schemes");
  /** Whether pills choose what stands beside the present scheme, although nothing does yet. */
  #choosing = false;
  /** @type {State | null} */ #state = null;
  #made = "";

  /** Ready to be shown, styles and all. @param {(command: string) => void} send */
  static async create(send) {
    await styles("web/compare.css");
    return new Compare(send);
  }

  /** @param {(command: string) => void} send */
  constructor(send) {
    this.send = send;
    byId("dock").before(this.#panes, this.#legend);
    byId("dock").append(this.#hint);
    // Before the pills' own listeners, which choose the scheme.
    this.#schemes.addEventListener("click", (event) => this.#press(event), true);
    this.#schemes.addEventListener("keydown", (event) => this.#roam(event), true);
  }

  /** Whether pills put schemes side by side. */
  get #on() {
    return this.#choosing || Boolean(this.#state?.compare.panes.length);
  }

  /** Begins to compare, or ends it. @param {State | null} state */
  toggle(state) {
    const on = !this.#on;
    if (state?.compare.panes.length) this.send("compare off");
    this.#choosing = on;
    if (state) this.show(state);
    if (on) /** @type {HTMLElement | null} */ (this.#schemes.querySelector('[tabindex="0"]'))?.focus({ preventScroll: true });
  }

  /** @param {State} state */
  show(state) {
    const { panes, add } = state.compare;
    // Whoever takes the last one away is done.
    if (this.#state?.compare.panes.length && !panes.length) this.#choosing = false;
    this.#state = state;
    const on = this.#on;
    setAttr(this.#button, "aria-pressed", String(on));
    setText(this.#button, on ? "Done" : "Compare");
    this.#button.title = on ? "Show one scheme alone" : "Schemes side by side";
    document.documentElement.classList.toggle("comparing", on);
    setAttr(this.#schemes, "role", on ? "group" : "radiogroup");
    /** @type {HTMLElement | null} */
    let present = null;
    for (const pill of this.#schemes.querySelectorAll("button")) {
      const id = pill.id.slice("scheme-".length);
      const first = id === state.scheme;
      const beside = !first && panes.some(({ scheme }) => scheme === id);
      if (first) present = pill;
      setAttr(pill, "role", on ? "checkbox" : "radio");
      setAttr(pill, "aria-checked", String(first || beside));
      setAttr(pill, "aria-disabled", String(on && (first || (!beside && !add))));
      pill.classList.toggle("beside", beside);
    }
    this.#hint.hidden = !on || panes.length > 0;
    if (!this.#hint.hidden) setText(this.#hint, `Choose up to three schemes to stand beside ${present?.textContent ?? "this one"}`);
    this.#legend.hidden = state.values["kinds"] !== "on" || state.disabled.includes("kinds");
    this.#label(panes);
  }

  /** @param {Pane[]} panes */
  #label(panes) {
    const made = JSON.stringify(panes.map(({ name, choose, leave }) => [name, choose, leave]));
    if (made !== this.#made) {
      const focus = [...this.#panes.children].findIndex((pane) => pane.contains(document.activeElement));
      this.#made = made;
      this.#panes.replaceChildren(...panes.map((pane) => this.#pane(pane)));
      // The one that took its place has the focus now.
      const next = this.#panes.children[Math.min(focus, panes.length - 1)]?.querySelector("button");
      if (focus >= 0) (next ?? this.#button).focus();
    }
    const left = Math.min(...panes.map(({ rect }) => rect[0]));
    const top = Math.min(...panes.map(({ rect }) => rect[1]));
    panes.forEach(({ rect: [x, y, width, height], faces, vertices, note }, i) => {
      const box = /** @type {HTMLElement} */ (this.#panes.children[i]);
      Object.assign(box.style, { left: `${x}px`, top: `${y}px`, width: `${width}px`, height: `${height}px` });
      box.classList.toggle("right", x > left + 1);
      box.classList.toggle("below", y > top + 1);
      const [, counts, why] = /** @type {[HTMLElement, HTMLElement, HTMLElement]} */ (/** @type {unknown} */ (box.children));
      setText(counts, faces ? `${full(faces)} faces, ${full(vertices)} vertices` : note ? "" : "…");
      setText(why, note);
    });
  }

  /** @param {Pane} pane */
  #pane({ name, choose, leave }) {
    return el("div", { className: "pane", role: "group", "aria-label": name },
      choose
        ? el("div", {},
            el("button", { type: "button", title: `Make ${name} the first`, onclick: () => this.send(choose) }, name),
            el("button", { type: "button", className: "leave", "aria-label": `Leave ${name} out`, title: "Leave it out", onclick: () => this.send(leave) }, "×"))
        : el("div", {}, el("b", {}, name)),
      el("p"), el("p", { className: "note" }));
  }

  /** @param {Event} event */
  #press(event) {
    const pill = event.target instanceof Element ? event.target.closest("button") : null;
    if (!pill || !this.#on || !this.#state) return;
    event.stopPropagation();
    if (pill.getAttribute("aria-disabled") === "true") return;
    const id = pill.id.slice("scheme-".length);
    const { panes, add } = this.#state.compare;
    this.send(panes.findLast(({ scheme, leave }) => leave && scheme === id)?.leave ?? add + id);
  }

  /** Arrows go through the pills and press none of them. @param {KeyboardEvent} event */
  #roam(event) {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const pills = [...this.#schemes.querySelectorAll("button")];
    const at = pills.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    if (!by || at < 0 || !this.#on) return;
    event.preventDefault();
    event.stopPropagation();
    pills[(at + by + pills.length) % pills.length]?.focus();
  }
}
