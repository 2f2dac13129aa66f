// @ts-check
// Quiet cards for errors and import reports: each stays until it is dismissed, or until one with the same id replaces it.
// Progress stands above the ruler, with Cancel. What changes is also said to screen readers, once.

import { byId, el, setText } from "./dom.js";
import { pick } from "./files.js";

/** @typedef {import("./protocol.js").Card} Card */
/** @typedef {import("./protocol.js").Progress} Progress */

/** Notes that were dismissed: the same one again, as when a scheme is chosen to and fro, would only be in the way. @type {Set<string>} */
const dismissed = new Set();

/** @param {string} text */
export function say(text) {
  setText(byId("live"), text);
}

/** @param {Card} card @param {() => void} [act] what its button does @param {string} [label] and says */
export function show(card, act = pick, label = card.ask && `Open ${card.ask}`) {
  const cards = byId("cards");
  const id = `card-${card.id}`;
  document.getElementById(id)?.remove();
  if (!card.title && !card.lines.length) return;
  const words = [card.title, ...card.lines].join("\n");
  if (card.kind === "note" && !card.ask && dismissed.has(words)) return;
  const made = el("article", { id, className: `card ${card.kind}`, role: card.kind === "error" ? "alert" : "group" },
    el("h2", {}, card.title),
    ...(card.lines.length > 1 ? [el("ul", {}, ...card.lines.map((line) => el("li", {}, line)))] : card.lines.map((line) => el("p", {}, line))),
    el("div", { className: "row" },
      ...(label ? [el("button", { type: "button", className: "main", onclick: () => act() }, label)] : []),
      el("button", { type: "button", className: "dismiss", "aria-label": `Dismiss: ${card.title}`, onclick: () => {
        dismissed.add(words);
        made.remove();
      } }, "Dismiss"),
    ),
  );
  cards.prepend(made);
  if (card.kind === "note") say(card.title);
}

/** Dismisses the newest card. @returns {boolean} whether there was one */
export function dismiss() {
  const newest = byId("cards").querySelector("button.dismiss");
  if (newest instanceof HTMLButtonElement) newest.click();
  return newest !== null;
}

/** A line that goes away by itself, for what a visitor has just done. @param {string} text */
export function toast(text) {
  say(text);
  document.getElementById("toast")?.remove();
  const made = el("p", { id: "toast", "aria-hidden": true }, text);
  document.body.append(made);
  setTimeout(() => made.remove(), 2_400 + text.length * 30);
}

/** @param {Progress} progress */
export function wait(progress) {
  const box = byId("progress");
  const was = box.hidden;
  box.hidden = !progress.what;
  byId("count").hidden = !box.hidden;
  if (!progress.what) return;
  const share = progress.done >= 0 ? `  ${Math.floor(progress.done * 100)}%` : "";
  setText(byId("progress-what"), progress.what + share);
  byId("cancel").hidden = !progress.cancel;
  if (was) say(progress.what);
}
