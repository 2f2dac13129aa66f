// @ts-check
// The address: the fragment is the document. It follows what is on the screen, at most twice a second, and a new fragment
// (a pasted link, the back button) is sent to the engine as it is.

/** @typedef {import("./protocol.js").State} State */

const INTERVAL = 500;

export class Link {
  /** @type {State | null} */ #state = null;
  /** The link that the page opened with: the address changes only once this one has. */
  #first = "";
  #written = location.hash;
  #moved = false;
  #timer = 0;

  /** @param {(fragment: string) => void} replay */
  constructor(replay) {
    addEventListener("hashchange", () => {
      if (location.hash === this.#written) return;
      this.#written = location.hash;
      this.#first = "";
      this.#moved = false;
      replay(location.hash);
    });
  }

  /** @param {State} state */
  show(state) {
    this.#state = state;
    if (!state.model || state.busy) return;
    this.#first ||= state.link;
    // A visitor's address stays as it came until something changes, a broken one too: it can be read and mended.
    if (state.link !== this.#first) this.#moved = true;
    if (this.#moved) this.#timer ||= window.setTimeout(() => this.#write(), INTERVAL);
  }

  #write() {
    this.#timer = 0;
    const link = this.#state?.link ?? "";
    if (!link || link === this.#written) return;
    this.#written = link;
    history.replaceState(null, "", link);
    this.#written = location.hash;
  }

  /** Puts the link on the clipboard. @returns {Promise<string>} what to tell the visitor */
  async copy() {
    const link = new URL(this.#state?.link ?? location.hash, location.href).href;
    try {
      await navigator.clipboard.writeText(link);
    } catch {
      // No permission, or no secure context: the old way still works from a click.
      const area = document.createElement("textarea");
      area.value = link;
      area.className = "unseen";
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      if (!done) return "";
    }
    return this.#state?.linkNote || "Link copied";
  }
}
