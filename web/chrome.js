// @ts-check
// The furniture at the edges: the model's name and Open on the left, link, export, theme and help on the right, the scheme's
// pills above the ruler, and the status line below it.

import { byId, duration, el, full, megabytes, setAttr, setText } from "./dom.js";
import { spell } from "./keys.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Hello} Hello */

/** Buttons that open a small list, which closes by itself. @param {string} button @param {string} popup */
function menu(button, popup) {
  const opener = byId(button, HTMLButtonElement);
  const list = byId(popup);
  /** @param {boolean} open */
  const set = (open) => {
    list.hidden = !open;
    setAttr(opener, "aria-expanded", String(open));
  };
  opener.addEventListener("click", () => {
    set(list.hidden === true);
    if (!list.hidden) list.querySelector("button")?.focus({ preventScroll: true });
  });
  addEventListener("pointerdown", (event) => {
    const target = /** @type {Node} */ (event.target);
    if (!list.hidden && !list.contains(target) && !opener.contains(target)) set(false);
  });
  list.addEventListener("keydown", (event) => {
    const items = [...list.querySelectorAll("button")];
    const at = items.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    const by = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (by && at >= 0) items[(at + by + items.length) % items.length]?.focus();
    else if (event.key === "Escape") {
      set(false);
      opener.focus();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  });
  return () => set(false);
}

export class Chrome {
  #models = byId("models");
  #exports = byId("exports");
  #schemes = byId("schemes");
  #closeModels = menu("model", "models");
  #closeExports = menu("export", "exports");
  /** @type {Hello | null} */ #hello = null;

  /** @param {(command: string) => void} send */
  constructor(send) {
    this.send = send;
    this.#schemes.addEventListener("keydown", (event) => this.#roam(event));
    for (const id of ["undo", "redo"]) byId(id).addEventListener("click", () => send(id));
  }

  /** @param {Hello} hello */
  learn(hello) {
    this.#hello = hello;
    this.#models.replaceChildren(
      el("h2", {}, "Built in"),
      ...hello.models.map(({ name, summary }) =>
        el("button", { type: "button", id: `model-${name}`, "data-model": name, onclick: () => this.#choose(`open builtin:${name}`) },
          el("b", {}, name), el("span", {}, summary)),
      ),
      el("form", { id: "open-url", onsubmit: (/** @type {SubmitEvent} */ event) => {
        event.preventDefault();
        const url = byId("url", HTMLInputElement).value.trim();
        if (url) this.#choose(`open ${url}`);
      } },
        el("label", { for: "url" }, "From an address"),
        el("div", {}, el("input", { id: "url", type: "url", required: true, placeholder: "https://…/model.glb" }), el("button", { type: "submit" }, "Open")),
      ),
    );
    /** @type {Map<string, HTMLElement>} */
    const groups = new Map();
    for (const scheme of hello.schemes) {
      let group = groups.get(scheme.group);
      if (!group) {
        group = el("span", { className: "group" }, el("small", { "aria-hidden": true }, scheme.group));
        groups.set(scheme.group, group);
      }
      group.append(
        el("button", {
          type: "button", role: "radio", id: `scheme-${scheme.id}`, "data-command": scheme.command, title: scheme.summary,
          "aria-checked": false, tabIndex: -1, onclick: () => this.send(scheme.command),
        }, scheme.name),
      );
    }
    this.#schemes.replaceChildren(...groups.values());
    for (const key of hello.keys) {
      const button = key.page ? document.getElementById(key.page) : document.getElementById(key.command);
      if (button) setAttr(button, "aria-keyshortcuts", spell(key).join("+"));
    }
  }

  /** @param {string} command */
  #choose(command) {
    this.#closeModels();
    this.send(command);
  }

  /** On a phone the pills are a strip: it moves as far as shows a pill and a bit of the next one. @param {HTMLElement} pill */
  #uncover(pill) {
    const strip = this.#schemes;
    const left = pill.offsetLeft - 104;
    strip.scrollLeft = Math.min(left, Math.max(left + pill.offsetWidth + 128 - strip.clientWidth, strip.scrollLeft));
  }

  /** Arrows go through the pills, as in any radio group. @param {KeyboardEvent} event */
  #roam(event) {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const pills = [...this.#schemes.querySelectorAll("button")];
    const at = pills.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    if (!by || at < 0) return;
    event.preventDefault();
    const next = pills[(at + by + pills.length) % pills.length];
    next?.focus();
    next?.click();
  }

  /** @param {State} state */
  show(state) {
    const { model, shown, times } = state;
    setText(byId("model-name"), model?.name ?? "Limn");
    setText(byId("model-summary"), model?.summary ?? "");
    const title = model ? `${model.name} · Limn` : "Limn";
    if (document.title !== title) document.title = title;
    byId("reload", HTMLButtonElement).disabled = !model?.reload;
    for (const [id, what] of /** @type {[string, string | null][]} */ ([["undo", state.undo], ["redo", state.redo]])) {
      const button = byId(id, HTMLButtonElement);
      button.disabled = what === null;
      button.title = `${id === "undo" ? "Undo" : "Redo"} ${what ?? ""}`.trim();
    }
    /** @type {HTMLElement | null} */
    let next = null;
    for (const pill of this.#schemes.querySelectorAll("button")) {
      const chosen = pill.id === `scheme-${state.scheme}`;
      if (chosen && pill.getAttribute("aria-checked") !== "true") next = pill;
      setAttr(pill, "aria-checked", String(chosen));
      pill.tabIndex = chosen ? 0 : -1;
    }
    // Now that it is as wide as a chosen one is.
    if (next) this.#uncover(next);
    for (const item of this.#models.querySelectorAll("button[data-model]")) {
      setAttr(item, "aria-current", String(model?.builtin === true && item.getAttribute("data-model") === model.name));
    }
    const labels = state.exports.map((e) => e.label).join();
    if (this.#exports.dataset["labels"] !== labels) {
      this.#exports.dataset["labels"] = labels;
      this.#exports.replaceChildren(
        ...state.exports.map(({ label, help, command }) =>
          el("button", { type: "button", id: `export-${label.toLowerCase()}`, "data-command": command, onclick: (/** @type {Event} */ event) => {
            this.#closeExports();
            this.send(/** @type {HTMLElement} */ (event.currentTarget).dataset["command"] ?? command);
          } }, el("b", {}, label), el("span", {}, help)),
        ),
      );
    }
    state.exports.forEach((e, i) => {
      const button = this.#exports.children[i];
      if (button) setAttr(button, "data-command", e.command);
    });

    const part = (/** @type {number} */ n, /** @type {string} */ what) => `${full(n)} ${what}`;
    setText(byId("status-counts"), model
      ? [part(shown.vertices, "vertices"), part(shown.edges, "edges"), part(shown.faces, "faces"), megabytes(shown.bytes)].join("  ·  ")
      : "");
    setText(byId("status-engine"), [
      model ? `refined in ${duration(times.refine)} on the ${times.gpu ? "G" : "C"}PU` : "",
      model ? `drawn in ${duration(times.draw)}` : "",
      this.#hello?.renderer === "webgpu" ? "WebGPU" : this.#hello ? "WebGL2" : "",
    ].filter(Boolean).join("  ·  "));
    byId("status-engine").title = this.#hello ? `${this.#hello.adapter}; connected in ${duration(times.read)}, sent to the GPU in ${duration(times.build)}` : "";
  }
}
