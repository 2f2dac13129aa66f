// @ts-check
// Dropped files, with those in dropped folders, and files read again for Reload. Loaded with the first drop or Reload.

/** @typedef {import("./protocol.js").NamedFile} NamedFile */

/**
 * What a drop says of one of its files.
 * @typedef {{ entry: FileSystemEntry | null, file: File | null, handle: Promise<FileSystemHandle | null> | null }} Dropped
 */

/** More files than this in one drop is a mistake, not a model. */
const MOST_FILES = 2_000;

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

/** The files of a drop, those in folders by their paths. @param {Dropped[]} dropped @returns {Promise<NamedFile[]>} */
export async function gather(dropped) {
  /** @type {NamedFile[]} */
  const files = [];
  for (const { entry, file, handle } of dropped) {
    if (entry?.isDirectory) {
      await walk(/** @type {FileSystemDirectoryEntry} */ (entry), files);
    } else if (file) {
      const known = await handle;
      files.push(known?.kind === "file" ? { name: file.name, file, handle: /** @type {FileSystemFileHandle} */ (known) } : { name: file.name, file });
    }
  }
  return files;
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
