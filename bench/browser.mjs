// Engines in Chromium for `cargo xtask bench`: a real browser on the built page, whose threads (web/bench-host.js) are driven by
// lines of text, so that their runs take turns with the native ones. bench/src/engines/remote.rs has the other side.
//
//   stdin "run limn-wasm 3" ─> page.evaluate ─> worker ─> "ok 0.0421" stdout
//   inputs and results go over the page's own server: they are too large for lines
//
// A page knows only how much time passed. On Linux the system tells how long a thread computed, as for the native engines, so that
// what else the machine does is not taken for the browser's: the worker's figure is read before a run and behind it.
//
// Variables: LIMN_SITE, the page; CHROME, a Chromium. The real graphics adapter is taken where there is one.

import { readFile, readdir, writeFile } from "node:fs/promises";
import { createInterface } from "node:readline";
import { launch, serveSite } from "../tests/browser/harness.mjs";

const site = await serveSite();
/** @type {Buffer} */ let input = Buffer.alloc(0);
/** @type {Buffer} */ let output = Buffer.alloc(0);
site.extra.set("/bench-input", (response) => response.end(input));
site.extra.set("/bench-output", (response) => {
  /** @type {Buffer[]} */ const parts = [];
  response.req.on("data", (part) => parts.push(part)).on("end", () => {
    output = Buffer.concat(parts);
    response.end();
  });
});

/** Opens the page, with the real adapter or with the one in software. @param {boolean} software */
async function open(software) {
  const browser = await launch({ software });
  const page = await browser.newPage();
  await page.goto(`${site.url}?bench#peers`);
  const facts = await page.evaluate(async () => {
    const host = await import(`${location.origin}/web/bench-host.js`);
    /** @type {Map<string, any>} */
    const threads = new Map();
    const thread = (/** @type {string} */ id) => threads.get(id) ?? Promise.reject(new Error(`${id} has no input`));
    const free = (/** @type {string} */ id) => {
      threads.get(id)?.close();
      threads.delete(id);
    };
    Reflect.set(window, "drive", {
      free,
      open: async (/** @type {string} */ id) => {
        free(id);
        threads.set(id, await host.Thread.open(id));
      },
      prepare: async (/** @type {string} */ id, /** @type {string} */ scheme, /** @type {number} */ level) => {
        const bytes = await (await fetch("/bench-input")).arrayBuffer();
        const [vertices = 0, faces = 0, corners = 0, creases = 0] = new Uint32Array(bytes, 0, 4);
        let at = 16;
        const take = (/** @type {any} */ Kind, /** @type {number} */ count) => {
          at += 4 * count;
          return new Kind(bytes, at - 4 * count, count);
        };
        const cage = {
          positions: take(Float32Array, 3 * vertices), counts: take(Uint32Array, faces), corners: take(Uint32Array, corners),
          ends: take(Uint32Array, 2 * creases), sharpness: take(Float32Array, creases),
        };
        // It runs until it is warm.
        await (await thread(id)).call("prepare", cage, scheme, level);
      },
      run: async (/** @type {string} */ id, /** @type {number} */ repeats) => (await thread(id)).call("run", repeats),
      peak: async (/** @type {string} */ id) => (await thread(id)).call("peak"),
      surface: async (/** @type {string} */ id) => {
        const { positions, counts, corners } = await (await thread(id)).call("surface");
        const sizes = new Uint32Array([positions.length / 3, counts.length, corners.length, 0]);
        await fetch("/bench-output", { method: "POST", body: new Blob([sizes, positions, counts, corners]) });
      },
    });
    const engines = [];
    for (const engine of host.ENGINES) {
      // Without an adapter there is no WebGPU.
      const first = await host.Thread.open(engine.id).catch(() => null);
      if (!first) continue;
      // Who cannot tell stores as the first does, which is Limn's module.
      engines.push({ ...engine, bandwidth: (await first.call("bandwidth")) ?? engines[0]?.bandwidth });
      first.close();
    }
    return { engines, notes: host.NOTES, ...(await host.machine()) };
  });
  return { browser, page, facts };
}

/** Where the system tells of the threads that workers are: none where it does not. */
async function workers() {
  /** @type {Set<string>} */
  const found = new Set();
  try {
    const session = await browser.newBrowserCDPSession();
    const { processInfo } = await session.send("SystemInfo.getProcessInfo");
    await session.detach();
    for (const { id } of processInfo.filter(({ type }) => type === "renderer")) {
      for (const task of await readdir(`/proc/${id}/task`)) {
        const folder = `/proc/${id}/task/${task}`;
        // One that has just ended is no error.
        const name = await readFile(`${folder}/comm`, "utf8").catch(() => "");
        if (name.startsWith("DedicatedWorker")) found.add(folder);
      }
    }
  } catch {
    // Another system.
  }
  return found;
}

/** Seconds that a thread has computed since it began. @param {string} folder */
const computed = async (folder) => Number((await readFile(`${folder}/schedstat`, "utf8")).split(" ")[0]) / 1e9;

/** Opens an engine and gives the place of its thread, if it can be told. @param {string} id @returns {Promise<string | undefined>} */
async function begin(id) {
  await drive("free", id);
  const before = await workers();
  await drive("open", id);
  const fresh = [...(await workers())].filter((folder) => !before.has(folder));
  return fresh.length === 1 ? fresh[0] : undefined;
}

let { browser, page, facts } = await open(false);
if (!facts.adapter) {
  await browser.close();
  ({ browser, page, facts } = await open(true));
}
/** Calls into the page. @param {string} call @param {...(string | number)} args @returns {Promise<any>} */
const drive = (call, ...args) => page.evaluate(([call, args]) => Reflect.get(window, "drive")[call](...args), /** @type {const} */ ([call, args]));

/** The threads of engines. @type {Map<string, string>} */
const threads = new Map();
const first = facts.engines[0]?.id ?? "";
const clock = (await begin(first)) ? "thread" : "wall";
await drive("free", first);

for (const { id, name, on, shaded, excuse, bandwidth } of facts.engines) {
  console.log(`engine ${id} ${name}`);
  // A GPU's time is no thread's.
  console.log(`clock ${id} ${on === "webgpu" ? "wall" : clock}`);
  if (shaded) console.log(`shaded ${id}`);
  if (excuse) console.log(`excuse ${id} ${excuse}`);
  console.log(`bandwidth ${id} ${bandwidth}`);
}
console.log(`machine browser ${facts.browser}`);
console.log(`machine adapter ${facts.adapter || "none"}`);
for (const note of facts.notes) console.log(`note ${note}`);
console.log("ready");


/** What is answered behind `ok`. @param {string} command @param {string} id @param {string[]} words */
async function answer(command, id, words) {
  switch (command) {
    case "prepare": {
      const [scheme = "", level = "", path = ""] = words;
      input = await readFile(path);
      const thread = await begin(id);
      if (!thread && clock === "thread") throw new Error("its thread is not found");
      const onGpu = facts.engines.some((/** @type {any} */ engine) => engine.id === id && engine.on === "webgpu");
      threads.set(id, onGpu ? "" : (thread ?? ""));
      await drive("prepare", id, scheme, Number(level));
      return "";
    }
    case "run": {
      const thread = threads.get(id);
      const before = thread ? await computed(thread) : 0;
      const passed = await drive("run", id, Number(words[0]));
      return thread ? (await computed(thread)) - before : passed;
    }
    case "surface":
      await drive("surface", id);
      await writeFile(words[0] ?? "", output);
      output = Buffer.alloc(0);
      return "";
    case "peak": {
      const bytes = await drive("peak", id);
      if (bytes === null) throw new Error("it cannot be told");
      return bytes;
    }
    case "free":
      await drive("free", id);
      return "";
    default:
      throw new Error(`there is no ${command}`);
  }
}

for await (const line of createInterface({ input: process.stdin })) {
  const [command = "", id = "", ...words] = line.trim().split(" ");
  try {
    console.log(`ok ${await answer(command, id, words)}`);
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    console.log(`no ${text.replace(/^page\.evaluate: (Error: )?/, "").split("\n")[0]}`);
  }
}
await browser.close();
site.close();
