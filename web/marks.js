// @ts-check
// Marks by hand: a click on the model makes an edge sharp, keeps a vertex or opens a face. What lies under the pointer is the
// engine's to say; a mark is a command, and Undo takes it back. Part of the panel, and fetched with it.

import { byId, el, setAttr, setText } from "./dom.js";
import { Parameters } from "./parameters.js";

/** @typedef {import("./protocol.js").State} State */

/** A click moves no farther, in CSS pixels. */
const STILL = 5;

const SHARP = { name: "Sharpness", summary: "How many levels it stays sharp; 10 is for ever, 0 takes it away.", high: 10, default: 10 };
/** What can be marked: command, button, what to click, and its amount. */
const KINDS = /** @type {const} */ ([
  ["crease", "Crease", "Click or tap an edge of the cage.", SHARP],
  ["corner", "Corner", "Click or tap near a vertex of the cage.", SHARP],
  ["hole", "Hole", "Click or tap a face of the cage: it is refined and not shown.", null],
  ["knot", "Knot", "Click or tap an edge of the cage.", { name: "Interval", summary: "Small ones pull the surface to the edge; others are 1.", high: 4, default: 0.5 }],
]);

export class Marks {
  /** @type {HTMLButtonElement[]} */ #buttons;
  #hint = el("p", { id: "mark-hint", role: "status", hidden: true });
  #amount;
  #kind = "";
  /** The amount of each kind, as last chosen. @type {Record<string, string>} */ #amounts = {};
  /** Whether the cage is shown for the marks' sake. */
  #caged = false;
  /** @type {State | null} */ #state = null;
  root;

  /** @param {(command: string) => void} send */
  constructor(send) {
    this.send = send;
    this.#amount = new Parameters((text) => {
      this.#amounts[this.#kind] = text;
      this.#show();
    }, "mark-amount", "Mark");
    this.#buttons = KINDS.map(([kind, label]) =>
      el("button", { type: "button", id: `mark-${kind}`, "aria-pressed": false, onclick: () => this.#choose(this.#kind === kind ? "" : kind) }, label));
    this.root = el("fieldset", { id: "marks" }, el("legend", {}, "Mark by hand"), el("div", { className: "segments" }, ...this.#buttons), this.#hint, this.#amount.root);
    const stage = byId("stage");
    /** @type {PointerEvent | null} */
    let down = null;
    stage.addEventListener("pointerdown", (event) => {
      // A second finger turns or zooms.
      down = event.isPrimary && event.button === 0 ? event : null;
    });
    stage.addEventListener("pointerup", (event) => {
      if (!this.#kind || !down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > STILL) return;
      const box = stage.getBoundingClientRect();
      this.send(`mark ${this.#kind} ${this.#text} ${event.clientX - box.left} ${event.clientY - box.top}`);
      down = null;
    });
  }

  /** Ends it: the panel is closed. */
  end() {
    this.#choose("");
  }

  get #row() {
    return KINDS.find(([kind]) => kind === this.#kind);
  }

  /** The amount as a word; holes have none and take any. */
  get #text() {
    return this.#amounts[this.#kind] ?? String(this.#row?.[3]?.default ?? 0);
  }

  /** @param {string} kind */
  #choose(kind) {
    const cage = this.#state?.values["cage"] === "on";
    if (kind && !this.#kind && !cage) this.send("view cage=on");
    if (!kind && this.#kind && this.#caged) this.send("view cage=off");
    if (!this.#kind) this.#caged = !cage;
    this.#kind = kind;
    byId("stage").classList.toggle("marking", kind !== "");
    this.#show();
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    // Knots mean something to one scheme.
    const knots = state.scheme === "nurss" || state.runs.some(({ leave, name }) => /nurss/i.test(leave + name));
    const knot = this.#buttons[3];
    if (knot) knot.hidden = !knots;
    if (!knots && this.#kind === "knot") this.#choose("");
    this.#show();
  }

  #show() {
    this.#buttons.forEach((button, i) => setAttr(button, "aria-pressed", String(KINDS[i]?.[0] === this.#kind)));
    const row = this.#row;
    this.#hint.hidden = !row;
    if (row) setText(this.#hint, row[2]);
    const amount = row?.[3];
    this.#amount.show({ scheme: `mark ${this.#kind}`, params: !amount ? [] : [{
      key: "amount", ...amount, kind: "number", low: 0, value: Number(this.#text), text: this.#text, choices: [], command: "",
    }] });
  }
}
