// @ts-check
// Files from a drop and from the file dialog. What walks through dropped folders comes with the first drop: see dropped.js.

import { byId } from "./dom.js";

/** @typedef {import("./protocol.js").NamedFile} NamedFile */

/**
 * What Chromium alone has: a handle that reads the file as it is at the time.
 * @typedef {DataTransferItem & { getAsFileSystemHandle?: () => Promise<FileSystemHandle | null> }} WithHandle
 */

/** What opens files, and what takes those of the dialog that is open. @type {(files: NamedFile[]) => void} */
let opener = () => {};
let taker = opener;

/**
 * @param {(files: NamedFile[]) => void} open
 * @param {(url: string) => void} openUrl
 * @param {(why: string) => void} fail
 */
export function listen(open, openUrl, fail) {
  const picker = byId("files", HTMLInputElement);
  opener = open;
  picker.addEventListener("change", () => {
    const files = [...(picker.files ?? [])].map((file) => ({ name: file.webkitRelativePath || file.name, file }));
    // The same file may be chosen again.
    picker.value = "";
    if (files.length) taker(files);
  });

  const root = document.documentElement;
  /** Every element under the pointer enters and leaves on its own. */
  let depth = 0;
  const holds = (/** @type {DragEvent} */ event) =>
    ["Files", "text/uri-list"].some((kind) => event.dataTransfer?.types.includes(kind));
  addEventListener("dragenter", (event) => {
    if (!holds(event)) return;
    event.preventDefault();
    depth += 1;
    root.classList.add("dropping");
  });
  addEventListener("dragleave", () => {
    depth = Math.max(0, depth - 1);
    if (!depth) root.classList.remove("dropping");
  });
  addEventListener("dragover", (event) => {
    if (!holds(event) || !event.dataTransfer) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "copy";
  });
  addEventListener("drop", async (event) => {
    depth = 0;
    root.classList.remove("dropping");
    if (!holds(event) || !event.dataTransfer) return;
    event.preventDefault();
    const url = event.dataTransfer.getData("text/uri-list").split(/\r?\n/).find((line) => line && !line.startsWith("#"));
    // The event's list is valid only until the event is over: everything is taken from it before the first await.
    const taken = take(event.dataTransfer);
    try {
      const { gather } = await import("./dropped.js");
      const files = await gather(taken);
      if (files.length) open(files);
      else if (url) openUrl(url);
      else fail("What was dropped holds no files");
    } catch {
      fail("A part of Limn could not be loaded: is the network there?");
    }
  });
}

/** Shows the file dialog. @param {(files: NamedFile[]) => void} [take] what to do with the files; opens them otherwise */
export function pick(take = opener) {
  taker = take;
  byId("files", HTMLInputElement).click();
}

/** @param {DataTransfer} transfer @returns {import("./dropped.js").Dropped[]} */
function take(transfer) {
  return [...transfer.items].filter((item) => item.kind === "file").map((item) => ({
    entry: item.webkitGetAsEntry?.() ?? null,
    file: item.getAsFile(),
    handle: /** @type {WithHandle} */ (item).getAsFileSystemHandle?.().catch(() => null) ?? null,
  }));
}
