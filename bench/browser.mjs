// Engines in Chromium for `cargo xtask bench`: a real browser on the built page, whose threads (web/bench-host.js) are driven by
// lines of text, so that their runs take turns with the native ones. bench/src/engines/remote.rs has the other side.
//
//   stdin "run limn-wasm 3" ─> page.evaluate ─> worker ─> "ok 0.0421" stdout
//   inputs and results go over the page's own server: they are too large for lines
//
// Variables: LIMN_SITE, the page; CHROME, a Chromium. The real graphics adapter is taken where there is one.

import { readFile, writeFile } from "node:fs/promises";
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
      prepare: async (/** @type {string} */ id, /** @type {string} */ scheme, /** @type {number} */ level) => {
        free(id);
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
        threads.set(id, await host.Thread.open(id));
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
      const first = await host.Thread.open(engine.id);
      // Who cannot tell stores as the first does, which is Limn's module.
      engines.push({ ...engine, bandwidth: (await first.call("bandwidth")) ?? engines[0]?.bandwidth });
      first.close();
    }
    return { engines, notes: host.NOTES, ...(await host.machine()) };
  });
  return { browser, page, facts };
}

let { browser, page, facts } = await open(false);
if (!facts.adapter) {
  await browser.close();
  ({ browser, page, facts } = await open(true));
}
for (const { id, name, excuse, bandwidth } of facts.engines) {
  console.log(`engine ${id} ${name}`);
  if (excuse) console.log(`excuse ${id} ${excuse}`);
  console.log(`bandwidth ${id} ${bandwidth}`);
}
console.log(`machine browser ${facts.browser}`);
console.log(`machine adapter ${facts.adapter || "none"}`);
for (const note of facts.notes) console.log(`note ${note}`);
console.log("ready");

/** Calls into the page. @param {string} call @param {...(string | number)} args @returns {Promise<any>} */
const drive = (call, ...args) => page.evaluate(([call, args]) => Reflect.get(window, "drive")[call](...args), /** @type {const} */ ([call, args]));
/** Engines that have run since they got their input. @type {Set<string>} */
const warm = new Set();
/** @param {string} id */
const warmed = async (id) => {
  if (!warm.has(id)) await drive("run", id, 1);
  warm.add(id);
};

/** What is answered behind `ok`. @param {string} command @param {string} id @param {string[]} words */
async function answer(command, id, words) {
  switch (command) {
    case "prepare": {
      const [scheme = "", level = "", path = ""] = words;
      input = await readFile(path);
      warm.delete(id);
      await drive("prepare", id, scheme, Number(level));
      return "";
    }
    case "run": {
      const seconds = await drive("run", id, Number(words[0]));
      warm.add(id);
      return seconds;
    }
    case "surface":
      await warmed(id);
      await drive("surface", id);
      await writeFile(words[0] ?? "", output);
      output = Buffer.alloc(0);
      return "";
    case "peak": {
      await warmed(id);
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
