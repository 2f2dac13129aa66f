// @ts-check
// What happens from level to level: schemes that take over from the first, and fairing. Each choice is a command. Part of the
// panel, and fetched with it.

import { el, setText } from "./dom.js";
import { Parameters } from "./parameters.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Hello} Hello */

/** The most iterations that the slider gives; commands take more. */
const MOST = 50;

export class Plan {
  #runs = el("ol", { id: "runs" });
  #from = el("select", { id: "plan-from", "aria-label": "From level", onchange: () => this.#show() });
  #scheme = el("select", { id: "plan-scheme", "aria-label": "Scheme from that level on", onchange: () => this.#choose() });
  #at = el("select", { id: "fair-at", "aria-label": "Level to be faired", onchange: () => this.#show() });
  #fair;
  #made = "";
  /** @type {State | null} */ #state = null;
  root;

  /** @param {(command: string, echo?: boolean, drag?: boolean) => void} send */
  constructor(send) {
    this.send = send;
    this.#fair = new Parameters((command, drag) => send(command + (Number(this.#at.value) ? ` at=${this.#at.value}` : ""), false, drag), "fairing", "Fairing");
    this.root = el("section", { id: "plan", "aria-label": "From level to level" },
      el("fieldset", {},
        el("legend", {}, "Another scheme later"), this.#runs,
        el("p", { className: "sentence" }, "From level", this.#from, "on", this.#scheme)),
      el("fieldset", {},
        el("legend", {}, "Fairing"),
        el("p", { className: "sentence" }, "Smooth level", this.#at, "before it is refined"), this.#fair.root));
  }

  /** @param {Hello} hello */
  learn({ schemes }) {
    const groups = [...new Set(schemes.map(({ group }) => group))];
    this.#scheme.replaceChildren(
      el("option", { value: "" }, "choose a scheme"),
      ...groups.map((group) => el("optgroup", { label: group }, ...schemes.filter((s) => s.group === group)
        .map(({ command, name, summary }) => el("option", { value: command, title: summary }, name)))),
    );
  }

  #choose() {
    if (this.#scheme.value) this.send(`${this.#scheme.value} from=${this.#from.value}`);
    // It names what to do next, not what was done: that stands above.
    this.#scheme.value = "";
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    this.#show();
  }

  #show() {
    const state = this.#state;
    if (!state) return;
    const made = JSON.stringify(state.runs);
    if (made !== this.#made) {
      this.#made = made;
      const focused = this.#runs.contains(document.activeElement);
      this.#runs.replaceChildren(...state.runs.map(({ from, name, leave }) =>
        el("li", {}, el("span", {}, `From level ${from}`), el("b", {}, name),
          el("button", { type: "button", className: "leave", title: "Leave it out", "aria-label": `Leave ${name} out`, onclick: () => this.send(leave) }, "×"))));
      this.#runs.hidden = !state.runs.length;
      if (focused) (this.#runs.querySelector("button") ?? this.#scheme).focus();
    }
    const last = Math.max(state.level, ...state.levels.filter((l) => l.allowed).map(({ level }) => level));
    levels(this.#from, 1, Math.max(1, last - 1));
    levels(this.#at, 0, last);
    const at = Number(this.#at.value);
    const value = state.fairings.find(([level]) => level === at)?.[1] ?? 0;
    this.#fair.show({ scheme: `fair ${at}`, params: [{
      key: "fair", name: "Iterations", summary: "Taubin's filter: small bumps go first. A fine model keeps its size, a coarse cage shrinks.", kind: "whole", low: 0, high: MOST,
      default: 0, value, text: String(value), choices: [], command: "fair taubin ",
    }] });
  }
}

/** Gives a list these levels. @param {HTMLSelectElement} list @param {number} first @param {number} last */
function levels(list, first, last) {
  const count = last - first + 1;
  while (list.options.length > count) list.lastElementChild?.remove();
  while (list.options.length < count) list.append(el("option", {}));
  [...list.options].forEach((option, i) => setText(option, String(first + i)));
}
