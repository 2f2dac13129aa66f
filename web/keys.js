// @ts-check
// The keyboard, as the engine's table says: a key sends its command or asks the page for something only a page can do.
// Nothing that is not in the table is touched, so the browser's own shortcuts stay the browser's.

/** @typedef {import("./protocol.js").Key} Key */

/** @type {Key[]} */
let keys = [];

/** @param {Key[]} table */
export function learn(table) {
  keys = table;
}

/**
 * @param {(command: string) => void} send
 * @param {(action: Key["page"]) => void} act
 */
export function listen(send, act) {
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.altKey || event.isComposing) return;
    const typing = event.target instanceof HTMLElement && event.target.closest("input, textarea, select, [contenteditable]");
    if (typing && event.key !== "Escape") return;
    const mod = event.ctrlKey || event.metaKey;
    const name = event.key.toLowerCase();
    // Arrows belong to tabs and radio groups while one of their buttons has the focus.
    if (name.startsWith("arrow") && event.target instanceof HTMLElement && event.target.closest("[role=tab], [role=radio]")) return;
    const key = keys.find((k) => k.key === name && k.mod === mod && (k.shift === event.shiftKey || /^[^a-z0-9]$/.test(name)));
    if (!key) return;
    event.preventDefault();
    if (key.command) send(key.command);
    else act(key.page);
  });
}

/** "Ctrl Shift Z", or "⌘ ⇧ Z" on a Mac. @param {Key} key */
export function spell(key) {
  const mac = /Mac|iPhone|iPad/.test(navigator.platform);
  const names = /** @type {Record<string, string>} */ ({
    arrowleft: "←", arrowright: "→", arrowup: "↑", arrowdown: "↓", escape: "Esc", " ": "Space",
  });
  const parts = [key.mod ? (mac ? "⌘" : "Ctrl") : "", key.shift ? "Shift" : "", names[key.key] ?? key.key.toUpperCase()];
  return parts.filter(Boolean);
}
