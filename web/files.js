// @ts-check
// Files from a drop (folders too), from the file dialog, and read again for Reload.

import { byId } from "./dom.js";

/** @typedef {import("./protocol.js").NamedFile} NamedFile */

/**
 * What Chromium alone has: a handle that reads the file as it is at the time.
 * @typedef {DataTransferItem & { getAsFileSystemHandle?: () => Promise<FileSystemHandle | null> }} WithHandle
 */

/** More files than this in one drop is a mistake, not a model. */
const MOST_FILES = 2_000;

/**
 * @param {(files: NamedFile[]) => void} open
 * @param {(url: string) => void} openUrl
 */
export function listen(open, openUrl) {
  const picker = byId("files", HTMLInputElement);
  picker.addEventListener("change", () => {
    const files = [...(picker.files ?? [])].map((file) => ({ name: file.webkitRelativePath || file.name, file }));
    // The same file may be chosen again.
    picker.value = "";
    if (files.length) open(files);
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
    const files = await gather(event.dataTransfer);
    if (files.length) open(files);
    else if (url) openUrl(url);
  });
}

/** Shows the file dialog. */
export function pick() {
  byId("files", HTMLInputElement).click();
}

/**
 * The same files as they are on disk now. Throws where one cannot be read any more.
 * @param {NamedFile[]} files
 * @returns {Promise<NamedFile[]>}
 */
export async function again(files) {
  return Promise.all(
    files.map(async (named) => {
      const file = named.handle ? await named.handle.getFile() : named.file;
      // A file without a handle that has changed on disk fails here, not later in the worker.
      await file.slice(0, 1).arrayBuffer();
      return { ...named, file };
    }),
  );
}

/** @param {DataTransfer} transfer @returns {Promise<NamedFile[]>} */
async function gather(transfer) {
  // The list is valid only until the event is over: take everything from it before the first await.
  const items = [...transfer.items].filter((item) => item.kind === "file");
  const plain = [...transfer.files];
  const found = items.map((item) => ({
    entry: item.webkitGetAsEntry?.() ?? null,
    file: item.getAsFile(),
    handle: /** @type {WithHandle} */ (item).getAsFileSystemHandle?.().catch(() => null) ?? null,
  }));
  /** @type {NamedFile[]} */
  const files = [];
  for (const { entry, file, handle } of found) {
    if (entry?.isDirectory) {
      await walk(/** @type {FileSystemDirectoryEntry} */ (entry), files);
    } else if (file) {
      const known = await handle;
      files.push(known?.kind === "file" ? { name: file.name, file, handle: /** @type {FileSystemFileHandle} */ (known) } : { name: file.name, file });
    }
  }
  return files.length ? files : plain.map((file) => ({ name: file.name, file }));
}

/** @param {FileSystemDirectoryEntry} folder @param {NamedFile[]} into */
async function walk(folder, into) {
  const reader = folder.createReader();
  for (;;) {
    // A reader hands out a hundred or so at a time.
    const some = await new Promise((done, fail) => reader.readEntries(done, fail)).catch(() => []);
    if (!some.length) return;
    for (const entry of /** @type {FileSystemEntry[]} */ (some)) {
      if (into.length >= MOST_FILES || entry.name.startsWith(".")) continue;
      if (entry.isDirectory) await walk(/** @type {FileSystemDirectoryEntry} */ (entry), into);
      else {
        const file = await new Promise((done) => /** @type {FileSystemFileEntry} */ (entry).file(done, () => done(null)));
        if (file) into.push({ name: entry.fullPath.replace(/^\//, ""), file: /** @type {File} */ (file) });
      }
    }
  }
}
