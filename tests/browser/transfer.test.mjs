// A model's bytes change hands between page, engine and the threads that read and write files: they are transferred, never cloned.
//
//   page ── File (a handle, no bytes) ──> engine ── bytes ──> reader ── parcel ──> engine
//                                         engine ── level ──> writer ── files ───> engine ── file ──> page
//
// Every postMessage is wrapped, in the page and in the workers, whose scripts are served with the wrapper before them. Behind a
// transfer a buffer has no bytes left where it was; behind a clone it has all of them.

import assert from "node:assert/strict";
import { readFile, stat } from "node:fs/promises";
import { join } from "node:path";
import { describe, test } from "node:test";
import { RENDERERS, SITE, cmd, download, drop, own, ready } from "./harness.mjs";
import { largeObj } from "./models.mjs";

/** Buffers smaller than this are no part of a model, in bytes. */
const SMALL = 1 << 16;

/**
 * One large buffer that was posted: by whom, in which message, its bytes before, and whether they were gone behind.
 * @typedef {{ from: string, message: string, bytes: number, gone: boolean }} Posted
 */

/** Wraps postMessage wherever it runs, a page or a worker. @param {string} from @param {number} small */
function watch(from, small) {
  const channel = new BroadcastChannel("posted");
  /** Large buffers within a message, at any depth. @param {unknown} value @param {Set<ArrayBuffer>} into */
  const collect = (value, into) => {
    const buffer = ArrayBuffer.isView(value) ? value.buffer : value;
    if (buffer instanceof ArrayBuffer) {
      if (buffer.byteLength >= small) into.add(buffer);
    } else if (Array.isArray(value) || (value && Object.getPrototypeOf(value) === Object.prototype)) {
      for (const part of Object.values(value)) collect(part, into);
    }
    return into;
  };
  // A reader is ended as soon as its answer is there: here not before it has told of it.
  const { terminate } = Worker.prototype;
  Worker.prototype.terminate = function () {
    setTimeout(() => terminate.call(this), 500);
  };
  // A worker's own way out is a property of its scope, not of a prototype.
  const scope = "DedicatedWorkerGlobalScope" in globalThis ? globalThis : null;
  for (const target of [Worker.prototype, MessagePort.prototype, scope]) {
    if (!target) continue;
    const post = /** @type {(message: any, ...rest: any[]) => void} */ (target.postMessage);
    target.postMessage = function (/** @type {any} */ message, /** @type {any[]} */ ...rest) {
      const buffers = [...collect(message, new Set())].map((buffer) => ({ buffer, bytes: buffer.byteLength }));
      post.call(this, message, ...rest);
      const keys = message && typeof message === "object" ? (message.type ?? Object.keys(message).join()) : typeof message;
      for (const { buffer, bytes } of buffers) channel.postMessage({ from, message: keys, bytes, gone: buffer.byteLength === 0 });
    };
  }
}

describe("a model's bytes", () => {
  const here = own();

  for (const renderer of RENDERERS) {
    test(`are transferred between page and workers, never cloned, on ${renderer}`, { timeout: 120_000 }, async () => {
      for (const [name, from] of [["worker", "engine"], ["formats-worker", "files"]]) {
        here.site.extra.set(`/web/${name}.watch.js`, `(${watch})("${from}", ${SMALL});`);
        here.site.extra.set(`/web/${name}.own.js`, await readFile(join(SITE, `web/${name}.js`)));
        here.site.extra.set(`/web/${name}.js`, `import "./${name}.watch.js";\nimport "./${name}.own.js";`);
      }
      const page = await here.visit({ renderer });
      await page.evaluate(
        ([watch, small]) => {
          new Function("small", `(${watch})("page", small)`)(small);
          /** @type {unknown[]} */ const posted = [];
          Reflect.set(window, "posted", posted);
          new BroadcastChannel("posted").onmessage = ({ data }) => posted.push(data);
        },
        /** @type {const} */ ([watch.toString(), SMALL]),
      );
      const path = await largeObj(180);
      const { size } = await stat(path);
      assert.ok(size > 2e6, `${size} bytes`);
      await drop(page, [path]);
      await ready(page, (state) => state.model.name.includes("wave"));
      await cmd(page, "level 1");
      await ready(page, (state) => state.shown.level === 1);
      const file = await download(page, "saved.obj", () => cmd(page, "export saved.obj"));

      // Each way that a model takes, once; and the page sends files, no bytes of them.
      const ways = ["engine: names,bytes,wanted,budget", "files: parcel", "engine: packed,file", "files: files", "engine: file"];
      await page.waitForTimeout(600);
      /** @type {Posted[]} */
      const posted = await page.evaluate(() => Reflect.get(window, "posted"));
      assert.deepEqual(posted.map(({ from, message }) => `${from}: ${message}`).sort(), ways.toSorted());
      const of = (/** @type {string} */ way) => posted.find(({ from, message }) => `${from}: ${message}` === way)?.bytes;
      const [read, parcel, , written, saved] = ways.map(of);
      assert.equal(read, size);
      assert.ok(parcel && parcel > 180 * 180 * 2 * 12, `${parcel} bytes of faces and points`);
      assert.deepEqual([written, saved], [file.bytes.length, file.bytes.length]);
      assert.deepEqual(posted.filter(({ gone }) => !gone), [], "what was cloned");
    });
  }
});
