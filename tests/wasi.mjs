// Runs a program that was compiled for WASI under Node: `node tests/wasi.mjs PROGRAM.wasm ARGS ...`.
//
// cargo calls this as its runner for the target wasm32-wasip1, so that Rust's own test harness and benchmarks run in
// V8's WebAssembly as they are. The page's module is compiled by the same code generator for a target without a system;
// arithmetic is the same. The program gets arguments, some variables, a clock, random bytes and standard output, and no
// files. These few calls stand here because Node's own `node:wasi` keeps using a memory after it has grown and crashes
// on programs that need more of it (nodejs/node#53087).

import { spawnSync } from "node:child_process";
import { randomFillSync } from "node:crypto";
import { readFileSync, writeSync } from "node:fs";
import { basename } from "node:path";

/** Error numbers of WASI: success, not a file of mine, no such call. */
const [OK, BADF, NOSYS] = [0, 8, 52];

/** Ends the program from inside a call. */
class Exit {
  /** @param {number} code */
  constructor(code) {
    this.code = code;
  }
}

const [program, ...words] = process.argv.slice(2);
if (!program) {
  console.error("usage: node tests/wasi.mjs PROGRAM.wasm ARGS ...");
  process.exit(2);
}
const args = [basename(program), ...words].map(terminated);
const passed = /^(RUST|CARGO|LIMN|PROPTEST)_/;
const variables = Object.entries(process.env).filter(([name]) => passed.test(name)).map(([name, value]) => terminated(`${name}=${value}`));

/** The memory, which moves when it grows: taken anew for every call. */
let memory = () => new DataView(new ArrayBuffer(0));

/** @type {Record<string, (...values: any[]) => number>} */
const calls = {
  args_sizes_get: (count, size) => sizes(args, count, size),
  args_get: (pointers, bytes) => strings(args, pointers, bytes),
  environ_sizes_get: (count, size) => sizes(variables, count, size),
  environ_get: (pointers, bytes) => strings(variables, pointers, bytes),
  clock_time_get(clock, _precision, at) {
    // 0 is the calendar's clock, 1 the monotonic one.
    const now = clock === 0 ? BigInt(Date.now()) * 1_000_000n : process.hrtime.bigint();
    memory().setBigUint64(at, now, true);
    return OK;
  },
  random_get(at, size) {
    randomFillSync(new Uint8Array(memory().buffer, at, size));
    return OK;
  },
  fd_write(file, vectors, count, written) {
    if (file !== 1 && file !== 2) return BADF;
    const view = memory();
    let total = 0;
    for (let i = 0; i < count; i += 1) {
      const [at, size] = [view.getUint32(vectors + 8 * i, true), view.getUint32(vectors + 8 * i + 4, true)];
      write(file, new Uint8Array(view.buffer, at, size));
      total += size;
    }
    view.setUint32(written, total, true);
    return OK;
  },
  proc_exit(code) {
    throw new Exit(code);
  },
  sched_yield: () => OK,
  fd_close: () => BADF,
  fd_fdstat_get: () => BADF,
  fd_prestat_get: () => BADF,
  fd_prestat_dir_name: () => BADF,
  fd_read: () => BADF,
};

let code = 0;
try {
  const module = new WebAssembly.Module(readFileSync(program));
  const wanted = WebAssembly.Module.imports(module).filter(({ module }) => module === "wasi_snapshot_preview1");
  const imports = Object.fromEntries(wanted.map(({ name }) => [name, calls[name] ?? (() => NOSYS)]));
  const { exports } = new WebAssembly.Instance(module, { wasi_snapshot_preview1: imports });
  memory = () => new DataView(/** @type {WebAssembly.Memory} */ (exports["memory"]).buffer);
  /** @type {() => void} */ (exports["_start"])();
} catch (error) {
  if (error instanceof Exit) {
    code = error.code;
  } else {
    // A panic on wasm ends in a trap, and no further test of this program can run. The test harness holds back what
    // a test prints until the test is over, the panic's message too: run it again without that.
    if (!words.includes("--nocapture") && !words.includes("--bench")) {
      spawnSync(process.execPath, [process.argv[1] ?? "", program, ...words, "--nocapture"], { stdio: "inherit" });
    } else {
      console.error(`${basename(program)} trapped: ${error instanceof Error ? error.message : error}`);
    }
    code = 101;
  }
}
process.exit(code);

/** @param {string} text */
function terminated(text) {
  return Buffer.from(`${text}\0`, "utf8");
}

/** @param {Buffer[]} list @param {number} count @param {number} size */
function sizes(list, count, size) {
  memory().setUint32(count, list.length, true);
  memory().setUint32(size, list.reduce((sum, { length }) => sum + length, 0), true);
  return OK;
}

/** @param {Buffer[]} list @param {number} pointers @param {number} bytes */
function strings(list, pointers, bytes) {
  const view = memory();
  for (const [i, text] of list.entries()) {
    view.setUint32(pointers + 4 * i, bytes, true);
    new Uint8Array(view.buffer, bytes, text.length).set(text);
    bytes += text.length;
  }
  return OK;
}

/** Writes all of it: a pipe may take less at a time, or nothing for a moment. @param {number} file @param {Uint8Array} bytes */
function write(file, bytes) {
  while (bytes.length) {
    try {
      bytes = bytes.subarray(writeSync(file, bytes));
    } catch (error) {
      if (/** @type {NodeJS.ErrnoException} */ (error).code !== "EAGAIN") throw error;
    }
  }
}
