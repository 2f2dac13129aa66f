// Runs a program that was compiled for WASI under Node: `node tests/wasi.mjs PROGRAM.wasm ARGS ...`.
//
// cargo calls this as its runner for the target wasm32-wasip1, so that Rust's own test harness and benchmarks run in
// V8's WebAssembly as they are, with a clock and standard output but nothing else that a browser would not have. The
// page's module is compiled by the same code generator for a target without a system; arithmetic is the same.

import { readFile } from "node:fs/promises";
import { basename } from "node:path";

// Node says once that WASI is experimental; in a test's output that is noise.
process.removeAllListeners("warning");
const { WASI } = await import("node:wasi");

const [program, ...args] = process.argv.slice(2);
if (!program) {
  console.error("usage: node tests/wasi.mjs PROGRAM.wasm ARGS ...");
  process.exit(2);
}
const wasi = new WASI({
  version: "preview1",
  args: [basename(program), ...args],
  env: { RUST_BACKTRACE: process.env.RUST_BACKTRACE ?? "0", ...environment("CARGO_", "LIMN_", "PROPTEST_") },
  preopens: { ".": process.cwd() },
  returnOnExit: true,
});

let code;
try {
  const module = await WebAssembly.compile(await readFile(program));
  const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
  code = wasi.start(instance);
} catch (error) {
  // A panic on wasm ends in a trap: its message has been printed, and no further test of this program can run.
  console.error(`${basename(program)} trapped: ${error instanceof Error ? error.message : error}`);
  code = 101;
}
process.exitCode = code;

/** The variables of this process whose names begin so. */
function environment(...prefixes) {
  return Object.fromEntries(Object.entries(process.env).filter(([name]) => prefixes.some((prefix) => name.startsWith(prefix))));
}
