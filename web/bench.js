// @ts-check
// `?bench`: the browser half of the benchmark on a visitor's own device. Nothing of it is loaded by any other visit, and the
// engine that draws is not started.
//
//   cage ── every engine in a thread of its own, warm ── results compared ── rounds in turn ── medians ──> table, JSON

import { ENGINES, NOTES, Thread, machine } from "./bench-host.js";
import { el, full, megabytes, setText, styles } from "./dom.js";

/** @typedef {import("./bench-host.js").Cage} Cage */
/**
 * A row of `cargo xtask bench --json`; bench/src/report.rs says what each is.
 * @typedef {{ series: string, engine: string, name: string, scheme: string, mesh: string, cage_faces: number, level: number, faces: number,
 *   stores: "points, corners" | "points, normals, corners", output_bytes: number,
 *   median_ms: number, best_ms: number, samples: number, ns_per_face: number, times_limn: number, peak_bytes: number | null,
 *   measured_bandwidth: number, limit_ns_per_face: number, clock: "wall", other_rule: false, machine: string }} Row
 */

/** Rounds of a job. */
const ROUNDS = 7;
/** A sample takes at least so many seconds: a browser's clock is coarse. */
const SAMPLE = 0.02;
/** An engine that has used so many seconds for a job has had its rounds. */
const PATIENCE = 4;
/** How far apart results may be, on cages two to three units in size. */
const TOLERANCE = 1e-5;

/** What is run: scheme and its name, cage by name and size and in words, level. @type {[string, string, string, number, string, number][]} */
const JOBS = [
  ["catmull-clark", "Catmull–Clark", "torus", 64, "torus 64×64", 4],
  ["catmull-clark", "Catmull–Clark", "creature", 0, "creature", 5],
  ["loop", "Loop", "sphere", 28, "sphere", 2],
  ["loop", "Loop", "triangles", 64, "torus, triangles", 4],
  ["linear", "Linear", "torus", 64, "torus 64×64", 4],
  ["sqrt3", "√3", "sphere", 56, "sphere", 3],
  ["doo-sabin", "Doo–Sabin", "torus", 64, "torus 64×64", 4],
  ["modified-butterfly", "Modified Butterfly", "triangles", 64, "torus, triangles", 4],
  .../** @type {[string, string, string, number, string, number][]} */ ([0, 2, 4, 6, 7].map((level) => ["catmull-clark", "Catmull–Clark", "cube", 0, "cube", level])),
];

/** A number with about three figures. @param {number} x */
const figures = (x) => (x >= 100 ? full(Math.round(x)) : x.toPrecision(x >= 1 ? 3 : 2));
/** @param {number[]} times */
const median = (times) => times.toSorted((a, b) => a - b)[times.length >> 1] ?? 0;

/** Whether others than Limn on the CPU are there, whose times are compared with its own for what stores the same. */
const PEERS = ENGINES.some(({ on }) => on !== "wasm");

/** How many runs make a sample long enough for the clock, and the seconds that were spent to find out. @param {Thread} thread */
async function fill(thread) {
  let [repeats, spent] = [1, 0];
  for (;;) {
    const took = await thread.call("run", repeats);
    spent += took;
    if (took > SAMPLE / 2 || repeats > 1e5) return /** @type {const} */ ([repeats, spent]);
    // A short one is known by tenths of a millisecond only.
    repeats = Math.ceil(repeats * Math.min(16, SAMPLE / Math.max(took, 1e-9)));
  }
}

class Bench {
  #progress = el("p", { id: "bench-progress", role: "status" });
  #button = el("button", { id: "bench-run", className: "main", type: "button", onclick: () => this.#press() }, "Run");
  #copy = el("button", { id: "bench-copy", type: "button", disabled: true, onclick: () => void this.#json() }, "Copy as JSON");
  #body = el("table", { hidden: true });
  #facts = el("p", { className: "facts" });
  /** @type {Row[]} */ #rows = [];
  #running = false;
  #stop = false;
  /** Those that can be run here. */ #engines = ENGINES;
  /** What is run now, to be ended by Stop. @type {Set<Thread>} */ #threads = new Set();
  #device = "";
  /** Bytes a second of plain stores, by engine; an engine that cannot tell has those of Limn's module. @type {Map<string, number>} */
  #bandwidths = new Map();

  constructor() {
    const notes = [...NOTES, "Other tabs and a low battery slow it down; the page can be read meanwhile."];
    document.title = "Limn: benchmark";
    document.documentElement.classList.add("bench");
    // The page's other parts stay where their scripts look for them; styles hide them.
    document.body.append(el("section", { id: "bench", "aria-label": "Benchmark" },
      el("h1", {}, "How fast is Limn here?"),
      el("p", { className: "lead" }, "Limn's kernel on this device, on one thread: from a cage's indexed faces to all points and faces of a level, and once more with normals. It takes "
        + "less than a minute, and nothing leaves this page."),
      el("p", { className: "acts" }, this.#button, this.#copy, el("a", { href: "./" }, "Open Limn")),
      this.#progress, this.#facts, this.#body,
      el("ul", {}, ...notes.map((note) => el("li", {}, note))),
    ));
    void this.#describe();
  }

  async #describe() {
    const { browser, adapter, cores } = await machine();
    this.#device = `${browser}, ${cores} cores, ${adapter ? `WebGPU: ${adapter}` : "no WebGPU"}`;
    setText(this.#facts, this.#device);
  }

  #press() {
    if (this.#running) {
      this.#stop = true;
      for (const thread of this.#threads) thread.close();
    } else void this.#run();
  }

  /** @param {string} id */
  async #open(id) {
    const thread = await Thread.open(id);
    if (this.#stop) {
      // It was told so meanwhile.
      thread.close();
      throw new Error("stopped");
    }
    this.#threads.add(thread);
    return thread;
  }

  async #run() {
    this.#running = true;
    this.#stop = false;
    this.#rows = [];
    this.#copy.disabled = true;
    this.#body.hidden = true;
    this.#body.replaceChildren(head());
    setText(this.#button, "Stop");
    let said = "";
    try {
      setText(this.#progress, "What plain stores reach");
      this.#engines = [];
      for (const engine of ENGINES) {
        /** @type {Thread} */
        let thread;
        try {
          thread = await this.#open(engine.id);
        } catch (error) {
          // Without an adapter there is no WebGPU; Limn's module has to be there.
          if (this.#stop || engine.on === "wasm") throw error;
          continue;
        }
        this.#engines.push(engine);
        this.#bandwidths.set(engine.id, (await thread.call("bandwidth")) ?? this.#stores());
        this.#close(thread);
      }
      const keeper = await this.#open("limn-wasm");
      setText(this.#facts, `${this.#device}. Plain stores reach ${(this.#stores() / 1e9).toFixed(1)} GB/s; “limit” is what storing the result takes at that.`);
      for (const [at, job] of JOBS.entries()) {
        setText(this.#progress, `${at + 1} of ${JOBS.length}: ${job[1]}, ${job[4]}, level ${job[5]}`);
        await this.#job(job, await keeper.call("cage", job[2], job[3]));
      }
      said = "Done.";
    } catch (error) {
      said = this.#stop ? "Stopped." : `It ended early: ${error instanceof Error ? error.message : error}.`;
    }
    for (const thread of this.#threads) thread.close();
    this.#threads.clear();
    this.#running = false;
    this.#copy.disabled = !this.#rows.length;
    setText(this.#button, "Run again");
    setText(this.#progress, said);
  }

  #stores() {
    return this.#bandwidths.get("limn-wasm") ?? 0;
  }

  /** @param {typeof JOBS[0]} job @param {Cage} cage */
  async #job([scheme, title, , , mesh, level], cage) {
    /** @type {{ id: string, name: string, shaded: boolean, thread: Thread, times: number[], repeats: number, spent: number }[]} */
    const present = [];
    /** @type {string[]} */
    const differ = [];
    for (const { id, name, shaded = false } of this.#engines) {
      const thread = await this.#open(id);
      try {
        await thread.call("prepare", cage, scheme, level);
      } catch (error) {
        if (this.#stop) throw error;
        // It has no such scheme.
        this.#close(thread);
        continue;
      }
      const [repeats, spent] = await fill(thread);
      // The first is Limn on the CPU: what the others are held against.
      const [limn] = present;
      const why = limn ? await limn.thread.call("differs", await thread.call("surface"), TOLERANCE) : "";
      if (why) {
        differ.push(`${name} makes something else here: ${why}.`);
        this.#close(thread);
        continue;
      }
      present.push({ id, name, shaded, thread, times: [], repeats, spent });
    }
    for (let round = 0; round < ROUNDS; round += 1) {
      for (const engine of present) {
        if (engine.spent > PATIENCE && engine.times.length) continue;
        const seconds = await engine.thread.call("run", engine.repeats);
        engine.times.push(seconds / engine.repeats);
        engine.spent += seconds;
      }
    }
    /** @type {Row[]} */
    const rows = [];
    /** What Limn stores, without normals and with them. */
    const stored = [0, 0];
    for (const { id, name, shaded, thread, times } of present) {
      const faces = await thread.call("faces");
      const bandwidth = this.#bandwidths.get(id) ?? this.#stores();
      const middle = median(times);
      const output = stored[Number(shaded)] || (await thread.call("stored"));
      stored[Number(shaded)] = output;
      const like = present.find((other) => other.shaded === shaded);
      rows.push({
        series: "table", engine: id, name, scheme, mesh, cage_faces: cage.counts.length, level, faces,
        stores: shaded ? "points, normals, corners" : "points, corners", output_bytes: output,
        median_ms: middle * 1e3, best_ms: Math.min(...times) * 1e3, samples: times.length, ns_per_face: (middle * 1e9) / faces,
        times_limn: middle / median(like?.times ?? []), peak_bytes: await thread.call("peak"), measured_bandwidth: bandwidth,
        limit_ns_per_face: (output * 1e9) / bandwidth / faces, clock: "wall", other_rule: false, machine: this.#device,
      });
      this.#close(thread);
    }
    this.#rows.push(...rows);
    this.#show(title, rows, differ);
  }

  /** @param {Thread} thread */
  #close(thread) {
    this.#threads.delete(thread);
    thread.close();
  }

  /** @param {string} title @param {Row[]} rows @param {string[]} differ */
  #show(title, rows, differ) {
    const [first] = rows;
    if (!first) return;
    const cells = (/** @type {Row} */ row) => [
      figures(row.median_ms), figures(row.ns_per_face), figures(row.limit_ns_per_face), row.peak_bytes === null ? "–" : megabytes(row.peak_bytes),
      ...(PEERS ? [`×${figures(row.times_limn)}`] : []),
    ].map((text) => el("td", {}, text));
    const what = el("th", { scope: "row", colSpan: PEERS ? 6 : 5 }, title, el("small", {}, `${first.mesh}, level ${first.level}: ${full(first.faces)} faces`));
    const engine = (/** @type {Row} */ row) => el("th", { scope: "row", className: "engine" }, PEERS ? row.name : row.stores);
    const lines = [el("tr", { className: "what" }, what), ...rows.map((row) => el("tr", {}, engine(row), ...cells(row)))];
    const said = differ.map((text) => el("tr", {}, el("td", { className: "differ", colSpan: 6 }, text)));
    this.#body.append(el("tbody", {}, ...lines, ...said));
    this.#body.hidden = false;
  }

  async #json() {
    const text = JSON.stringify({ machine: this.#device, measured_bandwidth: this.#stores(), date: new Date().toISOString().slice(0, 10), notes: NOTES, rows: this.#rows });
    try {
      await navigator.clipboard.writeText(text);
      setText(this.#progress, "Copied.");
    } catch {
      // No permission, or no secure context: shown, to be copied by hand.
      const area = el("textarea", { id: "bench-json", readOnly: true, value: text, "aria-label": "Results as JSON" });
      document.getElementById("bench-json")?.remove();
      this.#progress.after(area);
      area.select();
      setText(this.#progress, "The browser did not allow copying: here it is.");
    }
  }
}

function head() {
  const names = ["", "ms", "ns a face", "limit", "memory", ...(PEERS ? ["ratio"] : [])];
  return el("thead", {}, el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));
}

styles("web/bench.css").then(() => new Bench()).catch(() => document.body.replaceChildren("A part of Limn could not be loaded: is the network there?"));
