// @ts-check
// The panel on the right (a sheet from below on a phone): how the model is shown, how its surface is made, what its file held,
// the console and the help. Its rows come from the engine's table of controls; what is chosen comes with every state. It is
// fetched when it is first reached for: see drawer.js.

import { byId, el, full, setAttr, setText } from "./dom.js";
import { spell } from "./keys.js";
import { Marks } from "./marks.js";
import { Parameters } from "./parameters.js";
import { Plan } from "./plan.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Hello} Hello */
/** @typedef {"view" | "surface" | "report" | "console" | "help"} Tab */
/** @typedef {{ command: string, text: string, ok: boolean, offer: import("./protocol.js").Offer | null }} Line */

/** @type {[Tab, string][]} */
const TABS = [["view", "View"], ["surface", "Surface"], ["report", "Report"], ["console", "Console"], ["help", "Help"]];

export class Panel {
  #root = byId("panel");
  #log = el("ol", { "aria-label": "Console output", "aria-live": "polite", id: "log" });
  #groups = el("fieldset", { className: "groups", hidden: true }, el("legend", {}, "Groups"));
  #scheme = el("section", { id: "scheme" });
  #report = "";
  #hiddenGroups = "";
  /** @type {Hello["schemes"]} */ #schemes = [];
  /** @type {string[]} */ #typed = [];
  #recalled = 0;

  /** @param {(command: string, echo?: boolean, drag?: boolean) => void} send @param {() => void} resized @param {number} most lines of the console */
  constructor(send, resized, most) {
    this.send = send;
    this.resized = resized;
    this.most = most;
    this.parameters = new Parameters((command, drag) => send(command, false, drag), "parameters", "Parameters");
    this.plan = new Plan(send);
    this.marks = new Marks(send);
    const input = el("input", {
      id: "command", name: "command", type: "text", autocomplete: "off", autocapitalize: "off", spellcheck: false, enterKeyHint: "go",
      placeholder: "scheme loop", onkeydown: (/** @type {KeyboardEvent} */ event) => this.#recall(event, input),
    });
    input.setAttribute("list", "commands");
    const form = el("form", { id: "console", onsubmit: (/** @type {Event} */ event) => this.#submit(event, input) },
      el("label", { for: "command" }, "Command"), input, el("datalist", { id: "commands" }));
    const tabs = TABS.map(([tab, label]) =>
      el("button", { role: "tab", type: "button", id: `tab-${tab}`, "aria-controls": `pane-${tab}`, onclick: () => this.open(tab) }, label));
    this.#root.replaceChildren(
      el("div", { id: "tabs", role: "tablist", "aria-label": "Panel", onkeydown: (/** @type {KeyboardEvent} */ event) => this.#roam(event) }, ...tabs),
      el("button", { id: "panel-close", type: "button", "aria-label": "Close the panel", title: "Close (Esc)", onclick: () => this.close() }, "Close"),
      ...TABS.map(([tab]) =>
        el("div", { role: "tabpanel", id: `pane-${tab}`, "aria-labelledby": `tab-${tab}` }, ...(tab === "console" ? [this.#log, form] : []))),
    );
    this.#choose("view");
  }

  /** Arrows go through the tabs. @param {KeyboardEvent} event */
  #roam(event) {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const at = TABS.findIndex(([tab]) => byId(`tab-${tab}`) === document.activeElement);
    if (!by || at < 0) return;
    event.preventDefault();
    const [next] = TABS[(at + by + TABS.length) % TABS.length] ?? ["view"];
    this.open(next);
    byId(`tab-${next}`).focus();
  }

  /** @param {Event} event @param {HTMLInputElement} input */
  #submit(event, input) {
    event.preventDefault();
    const text = input.value.trim();
    if (!text) return;
    this.#typed.push(text);
    this.#recalled = this.#typed.length;
    input.value = "";
    this.send(text, true);
  }

  /** Up and down go through what was typed. @param {KeyboardEvent} event @param {HTMLInputElement} input */
  #recall(event, input) {
    const by = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (!by || (by > 0 && this.#recalled >= this.#typed.length)) return;
    event.preventDefault();
    this.#recalled = Math.min(this.#typed.length, Math.max(0, this.#recalled + by));
    input.value = this.#typed[this.#recalled] ?? "";
  }

  get shown() {
    return !this.#root.hidden;
  }

  /** Whether a line in the console would be seen. */
  get listening() {
    return this.shown && !byId("pane-console").hidden;
  }

  /** @param {Tab} tab */
  open(tab) {
    this.#choose(tab);
    this.#set(true);
    if (tab === "console") byId("command").focus();
  }

  /** @param {Tab} chosen */
  #choose(chosen) {
    for (const [tab] of TABS) {
      setAttr(byId(`tab-${tab}`), "aria-selected", String(tab === chosen));
      byId(`tab-${tab}`).tabIndex = tab === chosen ? 0 : -1;
      byId(`pane-${tab}`).hidden = tab !== chosen;
    }
  }

  /** Opens a tab, or closes the panel where that tab is open already. @param {Tab} tab */
  flip(tab) {
    if (this.shown && !byId(`pane-${tab}`).hidden) this.close();
    else this.open(tab);
  }

  toggle() {
    if (this.shown) this.close();
    else this.open(TABS.find(([tab]) => !byId(`pane-${tab}`).hidden)?.[0] ?? "view");
  }

  close() {
    const inside = this.#root.contains(document.activeElement);
    this.#set(false);
    if (inside) byId("panel-toggle").focus();
  }

  /** @param {boolean} open */
  #set(open) {
    if (this.#root.hidden !== open) return;
    this.#root.hidden = !open;
    if (!open) this.marks.end();
    document.documentElement.classList.toggle("panelled", open);
    setAttr(byId("panel-toggle"), "aria-expanded", String(open));
    this.resized();
  }

  /** @param {Hello} hello */
  learn(hello) {
    for (const tab of /** @type {const} */ (["view", "surface"])) {
      const rows = hello.controls.filter((c) => c.tab === tab).map((control) => {
        const actions = control.kind === "actions";
        const buttons = control.choices.map((choice) =>
          el("button", {
            type: "button", "data-command": choice.command, "data-value": choice.value, title: control.help,
            ...(actions ? {} : { "aria-pressed": false }), onclick: () => this.send(choice.command),
          }, choice.label),
        );
        return el("fieldset", { id: `control-${control.id}`, className: control.kind, title: control.help },
          el("legend", {}, control.label), el("div", { className: "segments" }, ...buttons));
      });
      byId(`pane-${tab}`).replaceChildren(...(tab === "view" ? [...rows, this.#groups] : [this.#scheme, this.parameters.root, this.plan.root, this.marks.root, ...rows]));
    }
    byId("commands").replaceChildren(...hello.commands.map((c) => el("option", { value: c.name, label: `${c.args}  ${c.help}` })));
    this.plan.learn(hello);
    this.#schemes = hello.schemes;
    this.#help(hello);
  }

  /** @param {State} state */
  show(state) {
    for (const [id, value] of Object.entries(state.values)) {
      const row = document.getElementById(`control-${id}`);
      if (!row) continue;
      const off = state.disabled.includes(id);
      if (row instanceof HTMLFieldSetElement && row.disabled !== off) row.disabled = off;
      for (const button of row.querySelectorAll("button")) {
        if (!row.classList.contains("actions")) setAttr(button, "aria-pressed", String(button.dataset["value"] === value));
      }
    }
    this.#showScheme(state);
    this.parameters.show(state);
    this.plan.show(state);
    this.marks.show(state);
    this.#showGroups(state);
    this.#showReport(state);
  }

  /** @param {State} state */
  #showScheme({ scheme }) {
    if (this.#scheme.dataset["scheme"] === scheme) return;
    this.#scheme.dataset["scheme"] = scheme;
    const { name, summary } = this.#schemes.find(({ id }) => id === scheme) ?? { name: "", summary: "" };
    this.#scheme.replaceChildren(el("h2", {}, name), el("p", {}, summary, " ",
      el("button", { type: "button", className: "link", onclick: () => byId("about").click() }, "How it works")));
  }

  /** @param {State} state */
  #showGroups(state) {
    const key = JSON.stringify(state.groups);
    if (key === this.#hiddenGroups) return;
    this.#hiddenGroups = key;
    this.#groups.hidden = state.groups.length < 2;
    this.#groups.replaceChildren(
      el("legend", {}, "Groups"),
      ...state.groups.map((group) =>
        el("button", { type: "button", "data-command": group.command, "aria-pressed": !group.hidden, title: group.hidden ? "Show" : "Hide",
          onclick: () => this.send(group.command) }, el("b", {}, group.name || "(no name)"), el("span", {}, full(group.faces))),
      ),
    );
  }

  /** @param {State} state */
  #showReport(state) {
    const key = JSON.stringify([state.report, state.model?.facts, state.model?.name]);
    if (key === this.#report) return;
    this.#report = key;
    const count = state.report.length;
    setText(byId("tab-report"), count ? `Report ${count}` : "Report");
    byId("pane-report").replaceChildren(
      el("h2", {}, state.model?.name ?? ""),
      el("dl", {}, ...(state.model?.facts ?? []).flatMap(({ label, value }) => [el("dt", {}, label), el("dd", {}, value)])),
      el("h2", {}, count ? "What the file held" : ""),
      count
        ? el("ul", {}, ...state.report.map(({ text, kind }) => el("li", { className: kind }, text)))
        : el("p", {}, state.model?.builtin ? "Nothing had to be repaired." : "Everything in the file was used, and nothing had to be repaired."),
    );
  }

  /** @param {Line} line */
  log(line) {
    this.#log.append(el("li", { className: line.ok ? "" : "error" }, el("code", {}, line.command), ...(line.text ? [el("pre", {}, line.text)] : []),
      ...(line.offer ? [this.#offer(line.offer)] : [])));
    while (this.#log.children.length > this.most) this.#log.firstElementChild?.remove();
    const pane = byId("pane-console");
    pane.scrollTop = pane.scrollHeight;
  }

  /** What would let a refused command work, once. @param {import("./protocol.js").Offer} offer */
  #offer({ label, commands }) {
    const button = el("button", { type: "button", className: "link", onclick: () => {
      button.remove();
      commands.forEach((command) => this.send(command, true));
    } }, label);
    return button;
  }

  /** @param {Hello} hello */
  #help(hello) {
    /** @type {Map<string, Node[]>} */
    const groups = new Map();
    for (const key of hello.keys.filter((k) => k.label)) {
      const rows = groups.get(key.group) ?? [];
      rows.push(el("dt", {}, ...spell(key).map((part) => el("kbd", {}, part))), el("dd", {}, key.label));
      groups.set(key.group, rows);
    }
    const gestures = [
      ["Drag", "Turn"], ["Right drag, Shift drag", "Move"], ["Scroll, pinch", "Zoom to the pointer"], ["Double click", "Turn around this point"],
      ["Two fingers", "Move and zoom"], ["Drop files", "Open them, with their materials and pictures"],
    ];
    byId("pane-help").replaceChildren(
      el("h2", {}, "Gestures"),
      el("dl", {}, ...gestures.flatMap(([what, does]) => [el("dt", {}, what ?? ""), el("dd", {}, does ?? "")])),
      ...[...groups].flatMap(([name, rows]) => [el("h2", {}, name), el("dl", {}, ...rows)]),
      el("h2", {}, "Commands"),
      el("p", {}, "Every button is a command; the console takes them as text, and so does the command line."),
      el("dl", { className: "commands" }, ...hello.commands.flatMap((c) => [el("dt", {}, el("code", {}, `${c.name} ${c.args}`.trim())), el("dd", {}, c.help)])),
      el("p", { className: "version" }, `Limn ${hello.version}. Nothing you open leaves this device.`),
    );
  }
}
