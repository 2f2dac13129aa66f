// @ts-check
// The slider: a ruler with one notch a level, each with the face count that the engine predicts for it. Dragged, clicked,
// arrowed and wheeled. It shows the last state and sends the notch's own command; while a pointer holds it, the thumb
// follows the pointer and everything else follows the engine.

import { byId, el, full, setAttr, setText, short } from "./dom.js";

/** @typedef {import("./protocol.js").State} State */

/** How far the wheel turns for one level, in CSS pixels. */
const WHEEL_STEP = 60;

export class Ruler {
  #root = byId("level");
  #faces = byId("faces");
  #rail = el("div", { className: "rail" });
  #done = el("div", { className: "done" });
  #pending = el("div", { className: "pending", hidden: true });
  #thumb = el("div", { className: "thumb" });
  /** @type {HTMLElement[]} */ #notches = [];
  /** @type {State | null} */ #state = null;
  /** The level that the last gesture asked for: a fast drag must not ask twice. */
  #asked = -1;
  #held = false;
  #wheel = 0;

  /** @param {(command: string, drag: boolean) => void} send */
  constructor(send) {
    this.send = send;
    this.#root.append(this.#rail, this.#done, this.#pending, this.#thumb);
    const root = this.#root;
    root.addEventListener("pointerdown", (event) => this.#grab(event));
    root.addEventListener("pointermove", (event) => this.#held && this.#follow(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) root.addEventListener(end, () => this.#release());
    root.addEventListener("keydown", (event) => this.#key(event));
    byId("dock").addEventListener("wheel", (event) => this.#turn(event), { passive: false });
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    const levels = state.levels;
    if (this.#notches.length !== levels.length) this.#rebuild(levels.length);
    setAttr(this.#root, "aria-valuemax", String(Math.max(0, ...levels.filter((l) => l.allowed).map((l) => l.level))));
    setAttr(this.#root, "aria-valuenow", String(state.level));
    const now = levels[state.level];
    setAttr(this.#root, "aria-valuetext", now ? `Level ${now.level}, ${full(now.faces)} faces` : "");
    levels.forEach((level, i) => {
      const notch = this.#notches[i];
      if (!notch) return;
      const [name, faces] = /** @type {[HTMLElement, HTMLElement]} */ (/** @type {unknown} */ (notch.children));
      setText(name, level.label);
      setText(faces, short(level.faces));
      if (notch.title !== level.title) notch.title = level.title;
      notch.classList.toggle("out", !level.allowed);
      notch.classList.toggle("now", i === state.level);
      notch.classList.toggle("shown", i === state.shown.level);
    });
    if (this.#asked === state.level || !state.busy) this.#asked = -1;
    if (!this.#held) this.#place(state.level);
    this.#count();
  }

  /** The share of the work towards the wanted level that is done; negative hides it. @param {number} done */
  progress(done) {
    const state = this.#state;
    this.#pending.hidden = done < 0 || !state;
    if (!state) return;
    const from = Math.min(state.shown.level, state.level);
    this.#pending.style.setProperty("--from", String(from));
    this.#pending.style.setProperty("--to", String(from + Math.abs(state.level - state.shown.level) * Math.max(0, done)));
  }

  /** One level up or down, where there is one. @param {number} by */
  step(by) {
    if (this.#state) this.#ask((this.#asked < 0 ? this.#state.level : this.#asked) + by);
  }

  #count() {
    const state = this.#state;
    if (!state) return;
    const level = state.levels[this.#held && this.#asked >= 0 ? this.#asked : state.level];
    if (level) setText(this.#faces, `${full(level.faces)} ${level.faces === 1 ? "face" : "faces"}`);
  }

  /** @param {number} count */
  #rebuild(count) {
    for (const notch of this.#notches) notch.remove();
    this.#root.style.setProperty("--last", String(Math.max(1, count - 1)));
    this.#notches = Array.from({ length: count }, (_, i) => {
      const notch = el("div", { className: "notch", "data-level": i }, el("b"), el("span"));
      notch.style.setProperty("--at", String(i));
      return notch;
    });
    this.#root.append(...this.#notches);
  }

  /** @param {number} at a level, or a place between two while the thumb is held */
  #place(at) {
    this.#root.style.setProperty("--at", String(at));
  }

  /** The place of a pointer in levels, not rounded. @param {PointerEvent} event */
  #at(event) {
    const box = this.#rail.getBoundingClientRect();
    const last = this.#notches.length - 1;
    return Math.min(last, Math.max(0, ((event.clientX - box.left) / box.width) * last));
  }

  /** @param {PointerEvent} event */
  #grab(event) {
    if (event.button !== 0 || !this.#state) return;
    this.#root.setPointerCapture(event.pointerId);
    this.#held = true;
    this.#root.classList.add("held");
    this.#follow(event);
  }

  /** @param {PointerEvent} event */
  #follow(event) {
    const at = this.#at(event);
    this.#ask(Math.round(at));
    const top = this.#top();
    // Past the last level that fits the thumb gives a little and comes back.
    this.#place(at > top ? top + (1 - 1 / (1 + (at - top) * 0.6)) * 0.35 : at);
  }

  #release() {
    if (!this.#held) return;
    this.#held = false;
    this.#root.classList.remove("held");
    // The same level once more, not as part of a drag: whatever comes next is an undo step of its own.
    const last = this.#state?.levels[this.#asked >= 0 ? this.#asked : this.#state.level];
    if (last) this.send(last.command, false);
    this.#place(this.#asked >= 0 ? this.#asked : (this.#state?.level ?? 0));
    this.#count();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const steps = /** @type {Record<string, number>} */ ({
      ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -2, PageUp: 2, Home: -99, End: 99,
    });
    const by = steps[event.key];
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.step(by);
  }

  /** @param {WheelEvent} event */
  #turn(event) {
    if (event.ctrlKey) return;
    event.preventDefault();
    const scale = event.deltaMode === 0 ? 1 : WHEEL_STEP;
    this.#wheel += (Math.abs(event.deltaX) > Math.abs(event.deltaY) ? event.deltaX : -event.deltaY) * scale;
    const steps = Math.trunc(this.#wheel / WHEEL_STEP);
    this.#wheel -= steps * WHEEL_STEP;
    if (steps) this.step(Math.sign(steps));
  }

  /** The highest level that fits the budget. */
  #top() {
    return Math.max(0, (this.#state?.levels.filter((l) => l.allowed).length ?? 1) - 1);
  }

  /** @param {number} level */
  #ask(level) {
    const wanted = Math.min(this.#top(), Math.max(0, level));
    const current = this.#asked < 0 ? this.#state?.level : this.#asked;
    if (wanted === current) return;
    this.#asked = wanted;
    const command = this.#state?.levels[wanted]?.command;
    if (command) this.send(command, this.#held);
    if (!this.#held) this.#place(wanted);
    this.#count();
  }
}
