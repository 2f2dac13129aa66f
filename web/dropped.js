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
    const known = await handle;
    if (known) await collect(known, known.name, files);
    else if (entry?.isDirectory) await walk(/** @type {FileSystemDirectoryEntry} */ (entry), files);
    else if (file) files.push({ name: file.name, file });
  }
  return files;
}

/** A file, or those in a folder, by handles: they can be read again when they have changed. @param {FileSystemHandle} handle @param {string} name @param {NamedFile[]} into */
async function collect(handle, name, into) {
  if (into.length >= MOST_FILES) return;
  if (handle.kind === "file") {
    const found = /** @type {FileSystemFileHandle} */ (handle);
    into.push({ name, file: await found.getFile(), handle: found });
    return;
  }
  // What a folder holds is not in TypeScript's DOM yet.
  const { values } = /** @type {{ values(): AsyncIterable<FileSystemHandle> }} */ (/** @type {unknown} */ (handle));
  for await (const child of values.call(handle)) {
    if (!child.name.startsWith(".")) await collect(child, `${name}/${child.name}`, into);
  }
}

/** The same where there are no handles. @param {FileSystemDirectoryEntry} folder @param {NamedFile[]} into */
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
