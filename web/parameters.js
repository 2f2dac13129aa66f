// @ts-check
// What can be set of the chosen scheme: a slider for a number, buttons for a choice, made from the state. A slider sends its
// value while it moves, which is one step to undo, and once more when it is let go. Part of the panel, and fetched with it.

import { el, setAttr, setText } from "./dom.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Parameter} Parameter */

/** About so many places a slider has. */
const PLACES = 100;

export class Parameters {
  root;
  /** @type {((now: Parameter) => void)[]} */ #rows = [];
  #made = "";

  /** @param {(command: string, drag: boolean) => void} send @param {string} id @param {string} label */
  constructor(send, id, label) {
    this.send = send;
    this.root = el("section", { id, className: "parameters", "aria-label": label, hidden: true });
  }

  /** @param {Pick<State, "scheme" | "params">} state */
  show(state) {
    // Rows stay while their values change: one of them may be in somebody's hand.
    const made = [state.scheme, ...state.params.map(({ key }) => key)].join(" ");
    if (made !== this.#made) {
      this.#made = made;
      const rows = state.params.map((param) => (param.kind === "choice" ? this.#choice(param) : this.#number(param)));
      this.#rows = rows.map(({ show }) => show);
      this.root.hidden = !rows.length;
      this.root.replaceChildren(...rows.map(({ row }) => row));
    }
    state.params.forEach((param, i) => this.#rows[i]?.(param));
  }

  /** @param {Parameter} param */
  #choice(param) {
    let now = param;
    const buttons = param.choices.map(({ value, label }) =>
      el("button", { type: "button", "data-value": value, onclick: () => {
        const choice = now.choices.find((c) => c.value === value);
        if (choice) this.send(choice.command, false);
      } }, label),
    );
    const row = el("fieldset", { id: `parameter-${param.key}`, "aria-describedby": `about-${param.key}` },
      el("legend", {}, param.name), el("div", { className: "segments" }, ...buttons), about(param));
    return { row, show: (/** @type {Parameter} */ to) => {
      now = to;
      for (const button of buttons) setAttr(button, "aria-pressed", String(button.dataset["value"] === to.text));
    } };
  }

  /** @param {Parameter} param */
  #number(param) {
    const { key, kind, low, high, default: initial } = param;
    let now = param;
    // In somebody's hand, or under a key that is held down: the slider is then ahead of the state.
    let held = false;
    let keyed = false;
    const id = `parameter-${key}`;
    const input = el("input", { id, type: "range", "aria-describedby": `about-${key}` });
    // In this order: a value is fitted to the bounds that it meets.
    Object.assign(input, { min: String(low), max: String(high), step: String(kind === "whole" ? 1 : step(low, high, initial)) });
    const value = el("output", { for: id });
    const reset = el("button", { type: "button", title: `Back to ${initial}`, onclick: () => back() }, "Default");
    const ask = (/** @type {boolean} */ drag) => {
      held = drag;
      this.send(now.command + input.value, drag);
      fill();
    };
    const back = () => {
      held = false;
      this.send(now.command + initial, false);
      input.focus();
    };
    const fill = () => input.style.setProperty("--share", String((input.valueAsNumber - low) / (high - low)));
    const release = () => {
      keyed = false;
      if (held) ask(false);
    };
    input.addEventListener("input", () => ask(true));
    input.addEventListener("change", () => keyed || release());
    // A key that repeats is a drag too.
    input.addEventListener("keydown", (event) => (keyed = /^(Arrow|Page|Home|End)/.test(event.key)));
    for (const end of ["keyup", "blur"]) input.addEventListener(end, release);
    input.addEventListener("dblclick", back);
    const row = el("div", { className: "number" }, el("label", { for: id }, param.name), reset, value, input, about(param));
    return { row, show: (/** @type {Parameter} */ to) => {
      now = to;
      setText(value, to.text);
      reset.disabled = to.value === initial;
      setAttr(input, "aria-valuetext", to.text);
      if (held) return;
      if (input.value !== to.text) input.value = to.text;
      fill();
    } };
  }
}

/** @param {Parameter} param */
function about({ key, summary }) {
  return el("p", { id: `about-${key}` }, summary);
}

/**
 * A slider's step: of few digits, a hundredth of the range or less, such that the default and the end are places of their own;
 * without such a one, any. @param {number} low @param {number} high @param {number} initial
 */
function step(low, high, initial) {
  const most = (high - low) / PLACES;
  const ten = 10 ** Math.floor(Math.log10(most));
  const whole = (/** @type {number} */ n) => Math.abs(n - Math.round(n)) < 1e-6;
  const found = [5, 2, 1, 2.5, 1.25, 0.5, 0.2, 0.1]
    .map((n) => n * ten)
    .find((n) => n < most * 1.000001 && whole((initial - low) / n) && whole((high - low) / n));
  return found === undefined ? "any" : Number(found.toPrecision(3));
}
