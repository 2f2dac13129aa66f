// @ts-check
// Where the panel is kept. Most visits never open it, so its script and its styles are fetched when a visitor reaches for it.
// Until then this module keeps what the panel would show: the last state, and the console's lines.

import { toast } from "./cards.js";
import { byId, styles } from "./dom.js";

/** @typedef {import("./protocol.js").State} State */
/** @typedef {import("./protocol.js").Hello} Hello */
/** @typedef {import("./panel.js").Panel} Panel */
/** @typedef {import("./panel.js").Tab} Tab */
/** @typedef {import("./panel.js").Line} Line */

/** How many of the console's lines are kept. */
const LINES = 200;

export class Drawer {
  /** @type {Panel | null} */ #panel = null;
  /** @type {Promise<Panel> | null} */ #coming = null;
  /** @type {Hello | null} */ #hello = null;
  /** @type {State | null} */ #state = null;
  /** @type {Line[]} */ #lines = [];

  /** @param {(command: string, echo?: boolean, drag?: boolean) => void} send @param {() => void} resized */
  constructor(send, resized) {
    this.send = send;
    this.resized = resized;
    const toggle = byId("panel-toggle");
    toggle.addEventListener("click", () => this.toggle());
    // A hand on its way to a button is some hundred milliseconds ahead of its click.
    for (const button of [toggle, byId("help")]) {
      for (const sign of ["pointerenter", "focus"]) button.addEventListener(sign, () => void this.#fetch().catch(() => {}), { once: true });
    }
  }

  get shown() {
    return this.#panel?.shown ?? false;
  }

  /** Whether a line in the console would be seen. */
  get listening() {
    return this.#panel?.listening ?? false;
  }

  /** @param {Tab} tab */
  open(tab) {
    this.#with((panel) => panel.open(tab));
  }

  /** Opens a tab, or closes the panel where that tab is open already. @param {Tab} tab */
  flip(tab) {
    this.#with((panel) => panel.flip(tab));
  }

  toggle() {
    this.#with((panel) => panel.toggle());
  }

  close() {
    this.#panel?.close();
  }

  /** @param {Hello} hello */
  learn(hello) {
    this.#hello = hello;
    this.#panel?.learn(hello);
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    this.#panel?.show(state);
  }

  /** @param {Line} line */
  log(line) {
    if (this.#panel) this.#panel.log(line);
    else this.#lines = [...this.#lines.slice(1 - LINES), line];
  }

  /** At once where the panel is there, else when it has come; what was asked for first is done first. @param {(panel: Panel) => void} act */
  #with(act) {
    if (this.#panel) act(this.#panel);
    else this.#fetch().then(act, () => toast("The panel could not be loaded: is the network there?"));
  }

  #fetch() {
    return (this.#coming ??= this.#load().catch((error) => {
      this.#coming = null;
      throw error;
    }));
  }

  async #load() {
    // Styles first: an unstyled panel is never seen.
    const [{ Panel }] = await Promise.all([import("./panel.js"), styles("web/panel.css")]);
    const panel = new Panel(this.send, this.resized, LINES);
    if (this.#hello) panel.learn(this.#hello);
    if (this.#state) panel.show(this.#state);
    for (const line of this.#lines.splice(0)) panel.log(line);
    this.#panel = panel;
    return panel;
  }
}
