// What the browser tests share: a server for the built page that knows what it sent, a Chromium that draws in software
// on both backends, a page that is ready, trusted drops of files, and pictures as pixels.
//
// The variables LIMN_SITE (the built page, default dist/), CHROME and LIMN_CLI (the native command line) come from
// `cargo xtask test`; with defaults for them a single file runs under `node --test` as well.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { existsSync } from "node:fs";
import { mkdir, mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { delimiter, extname, join, normalize, sep } from "node:path";
import { after, afterEach, before } from "node:test";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants } from "node:zlib";
import { chromium } from "playwright-core";
import { PNG } from "pngjs";

/** The project's root folder, with a separator at its end. */
export const ROOT = fileURLToPath(new URL("../../", import.meta.url));
/** The folder with the built page. */
export const SITE = process.env.LIMN_SITE ?? join(ROOT, "dist");
/** The native command line. */
export const CLI = process.env.LIMN_CLI ?? join(ROOT, "target/debug/limn");
/** Whether the page was built quickly: its speed is right, its weight is not. */
export const QUICK = process.env.LIMN_QUICK === "1";
/** Both ways to draw, by the names that the page's address takes. */
export const RENDERERS = /** @type {const} */ (["webgpu", "webgl"]);

const MIME = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
  ".json": "application/json",
  ".wasm": "application/wasm",
};

/**
 * Serves the built page on a free port, compressed with brotli at its highest level as a good host would.
 * `sent` lists every body with its size on the wire, whoever asked for it: pages and workers alike. `extra` holds files
 * that are not part of the page, by path, or functions that answer themselves. With `cors` other sites may read it all.
 * @param {{ cors?: boolean }} [options]
 */
export async function serveSite({ cors = false } = {}) {
  if (!existsSync(join(SITE, "index.html"))) throw new Error(`there is no page at ${SITE}: build it with cargo xtask dist`);
  /** @type {{ path: string, status: number, bytes: number }[]} */
  const sent = [];
  /** @type {Map<string, Buffer | string | ((response: import("node:http").ServerResponse) => void)>} */
  const extra = new Map();
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url ?? "/", "http://localhost").pathname);
    const file = normalize(join(SITE, path === "/" ? "index.html" : path));
    const own = extra.get(path);
    if (cors) response.setHeader("access-control-allow-origin", "*");
    if (typeof own === "function") {
      own(response);
      return;
    }
    let body = own === undefined ? undefined : Buffer.from(own);
    let packed = body;
    if (body === undefined && file.startsWith(normalize(SITE) + sep) && existsSync(file)) {
      body = await readFile(file);
      packed = pack(file, body);
    }
    if (body === undefined || packed === undefined) {
      sent.push({ path, status: 404, bytes: 0 });
      response.writeHead(404).end();
      return;
    }
    sent.push({ path, status: 200, bytes: packed.length });
    response.writeHead(200, {
      "content-type": MIME[/** @type {keyof typeof MIME} */ (extname(file))] ?? "application/octet-stream",
      "content-length": packed.length,
      ...(packed === body ? {} : { "content-encoding": "br" }),
      "cache-control": "no-cache",
    });
    response.end(packed);
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", () => done(undefined)));
  const { port } = /** @type {import("node:net").AddressInfo} */ (server.address());
  return {
    url: `http://127.0.0.1:${port}/`,
    sent,
    extra,
    close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}

/** @type {Map<string, Buffer>} */
const packed = new Map();
/** @param {string} file @param {Buffer} body */
function pack(file, body) {
  const key = `${file} ${body.length}`;
  let small = packed.get(key);
  if (!small) {
    // Highest quality costs seconds for a module; the tests of a quick build have no use for it.
    const quality = QUICK ? 4 : 11;
    small = brotliCompressSync(body, { params: { [constants.BROTLI_PARAM_QUALITY]: quality, [constants.BROTLI_PARAM_SIZE_HINT]: body.length } });
    packed.set(key, small);
  }
  return small;
}

/** Compresses the whole page ahead, so that no test measures it. */
export async function packSite() {
  const names = ["pkg/webgpu/limn_engine_bg.wasm", "pkg/webgl/limn_engine_bg.wasm", "pkg/webgpu/limn_engine.js", "pkg/webgl/limn_engine.js"];
  for (const name of names) pack(join(SITE, name), await readFile(join(SITE, name)));
}

/** Where a Chromium is. */
function chrome() {
  if (process.env.CHROME) return process.env.CHROME;
  const folders = (process.env.PATH ?? "").split(delimiter);
  const names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
  const found = names.flatMap((name) => folders.map((folder) => join(folder, name))).find((path) => existsSync(path));
  if (!found) throw new Error("no Chromium on the PATH; set CHROME");
  return found;
}

/**
 * A headless Chromium that has WebGPU and WebGL2, both drawn in software; or by the machine's own adapter, which may not be there.
 * WebAssembly in it has vectors, unless it is told that the processor has none.
 * @param {{ software?: boolean, vectors?: boolean }} [options]
 */
export function launch({ software = true, vectors = true } = {}) {
  return chromium.launch({
    executablePath: chrome(),
    args: [
      "--no-sandbox",
      ...(software ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--use-webgpu-adapter=swiftshader", "--use-vulkan=swiftshader"] : []),
      ...(vectors ? [] : ["--js-flags=--no-enable-sse4-1"]),
      "--enable-unsafe-webgpu",
      "--enable-features=Vulkan,WebGPU",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
}

/**
 * What most files need: a served page and a browser for all tests of a `describe`, and pages that each test has for itself.
 * After each test no page may have met an error, and all are closed; files made with `scratch` go at the end.
 * @param {Parameters<typeof serveSite>[0]} [options]
 */
export function own(options) {
  /** @type {Awaited<ReturnType<typeof serveSite>>} */ let site;
  /** @type {import("playwright-core").Browser} */ let browser;
  /** @type {Awaited<ReturnType<typeof visit>>[]} */ let open = [];
  before(async () => {
    site = await serveSite(options);
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    site?.close();
    await tidy();
  });
  afterEach(async () => {
    const pages = open.splice(0);
    await Promise.all(pages.map((page) => page.context().close()));
    assert.deepEqual(pages.flatMap(({ errors }) => errors), []);
  });
  return {
    get site() {
      return site;
    },
    get browser() {
      return browser;
    },
    /** @param {Parameters<typeof visit>[2]} [options] */
    visit: async (options) => {
      const page = await visit(browser, site.url, options);
      open.push(page);
      return page;
    },
  };
}

/**
 * Opens the page in a context of its own (nothing cached) and waits until it is ready.
 * @param {import("playwright-core").Browser} browser
 * @param {string} url
 * @param {{ renderer?: "webgpu" | "webgl", search?: string, hash?: string, width?: number, height?: number, scale?: number,
 *   scheme?: "dark" | "light", touch?: boolean, wait?: boolean, reducedMotion?: "reduce" }} [options]
 */
export async function visit(browser, url, options = {}) {
  const { renderer, hash = "", width = 960, height = 640, scale = 1, scheme = "dark", touch = false, wait = true } = options;
  const context = await browser.newContext({
    viewport: { width, height },
    deviceScaleFactor: scale,
    colorScheme: scheme,
    hasTouch: touch,
    reducedMotion: options.reducedMotion ?? "no-preference",
    permissions: ["clipboard-read", "clipboard-write"],
  });
  const page = await context.newPage();
  /** @type {string[]} */
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  // When the first picture is on the canvas, counted from the start of the navigation.
  await page.addInitScript(() => {
    const drawn = () => {
      if (document.querySelector("#stage canvas:not(.fresh)")) {
        Reflect.set(window, "firstFrame", performance.now());
        watch.disconnect();
      }
    };
    const watch = new MutationObserver(drawn);
    watch.observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["class"] });
  });
  const query = options.search ?? (renderer ? `?renderer=${renderer}` : "");
  await page.goto(`${url}${query}${hash}`);
  if (wait) await ready(page);
  return Object.assign(page, { errors });
}

/**
 * Waits until the engine is done with everything it was asked for. A command that was sent just now is on its way for
 * a moment in which the page is still "ready": callers that expect a change say so with `until`.
 * @param {import("playwright-core").Page} page
 * @param {(state: any, extra: any) => boolean} [until] runs in the page, on `limn.state`
 * @param {any} [extra] its second argument
 * @param {number} [timeout] milliseconds
 */
export async function ready(page, until = () => true, extra = null, timeout = 60_000) {
  try {
    await page.waitForFunction(
      ([text, extra]) => {
        const root = document.documentElement;
        const state = Reflect.get(window, "limn")?.state;
        if (root.dataset["state"] === "fault") throw new Error("the page's state is fault");
        if (root.dataset["state"] !== "ready" || !state?.model || state.busy) return false;
        if (!document.querySelector("#stage canvas:not(.fresh)")) return false;
        return new Function(`return (${text})`)()(state, extra);
      },
      /** @type {const} */ ([until.toString(), extra]),
      { timeout, polling: 50 },
    );
  } catch (error) {
    const seen = await page.evaluate(() => ({
      state: document.documentElement.dataset["state"],
      cards: [...document.querySelectorAll("#cards .card")].map((card) => card.textContent),
      text: Reflect.get(window, "limn")?.state?.text,
    }));
    throw new Error(`${error instanceof Error ? error.message.split("\n")[0] : error}; the page shows ${JSON.stringify(seen)}`);
  }
}

/** The engine's last state. @param {import("playwright-core").Page} page @returns {Promise<any>} */
export function state(page) {
  return page.evaluate(() => Reflect.get(window, "limn").state);
}

/** Sends a command. @param {import("playwright-core").Page} page @param {string} text */
export function cmd(page, text) {
  return page.evaluate((text) => Reflect.get(window, "limn").cmd(text), text);
}

/**
 * Drops files on the middle of the page, as a person does: a trusted event with real files.
 * @param {import("playwright-core").Page} page
 * @param {string[]} files absolute paths
 */
export async function drop(page, files) {
  const session = await page.context().newCDPSession(page);
  const size = page.viewportSize() ?? { width: 0, height: 0 };
  const data = { items: [], files, dragOperationsMask: 1 };
  for (const type of /** @type {const} */ (["dragEnter", "dragOver", "drop"])) {
    await session.send("Input.dispatchDragEvent", { type, x: size.width / 2, y: size.height / 3, data });
  }
  await session.detach();
}

/** The title and the lines of every card that is shown. @param {import("playwright-core").Page} page @returns {Promise<{ kind: string, text: string }[]>} */
export function cards(page) {
  return page.$$eval("#cards .card", (cards) =>
    cards.map((card) => ({
      kind: card.classList.contains("error") ? "error" : "note",
      text: [...card.querySelectorAll("h2, p, li")].map((part) => part.textContent).join(" | "),
    })),
  );
}

/**
 * Waits for a file that the page saves; files that come with it (materials) are put beside it.
 * @param {import("playwright-core").Page} page
 * @param {string} name
 * @param {() => Promise<unknown>} act what makes the page save it
 */
export async function download(page, name, act) {
  const folder = await scratch();
  /** @type {Promise<string>[]} */
  const saving = [];
  const save = (/** @type {import("playwright-core").Download} */ file) => {
    const path = join(folder, file.suggestedFilename());
    saving.push(file.saveAs(path).then(() => path));
  };
  page.on("download", save);
  const [wanted] = await Promise.all([
    page.waitForEvent("download", { timeout: 60_000, predicate: (file) => file.suggestedFilename() === name }),
    act(),
  ]);
  await page.waitForTimeout(300);
  page.off("download", save);
  await Promise.all(saving);
  const path = join(folder, wanted.suggestedFilename());
  return { path, bytes: await readFile(path), names: (await Promise.all(saving)).map((path) => path.slice(folder.length + 1)).sort() };
}

/** @type {string[]} */
const folders = [];
/** A fresh folder that goes away with the process. */
export async function scratch() {
  const folder = await mkdtemp(join(tmpdir(), "limn-test-"));
  folders.push(folder);
  return folder;
}
/** Removes what `scratch` made. */
export async function tidy() {
  await Promise.all(folders.splice(0).map((folder) => rm(folder, { recursive: true, force: true })));
}

/**
 * The canvas's picture once it has stopped changing, without the page's furniture over it.
 * @param {import("playwright-core").Page} page
 */
export async function picture(page) {
  let last = await shot(page);
  for (let tries = 0; tries < 40; tries += 1) {
    await page.waitForTimeout(120);
    const next = await shot(page);
    if (Buffer.compare(last, next) === 0) return PNG.sync.read(next);
    last = next;
  }
  throw new Error("the picture does not come to rest");
}

/** @param {import("playwright-core").Page} page */
function shot(page) {
  return page.screenshot({ style: "body > :not(main) { visibility: hidden !important }", animations: "disabled" });
}

/** Saves a picture for people to look at, under target/screenshots. @param {string} name @param {PNG} png */
export async function keep(name, png) {
  const folder = join(ROOT, "target/screenshots");
  await mkdir(folder, { recursive: true });
  const { writeFile } = await import("node:fs/promises");
  await writeFile(join(folder, `${name}.png`), PNG.sync.write(png));
}

/**
 * How much of a picture is not background: the share of pixels that differ from their column's top and bottom by more
 * than a gradient would, and the number of different colours.
 * @param {PNG} png
 */
export function content(png) {
  const colours = new Set();
  let drawn = 0;
  for (let x = 0; x < png.width; x += 1) {
    for (let y = 0; y < png.height; y += 1) {
      const at = 4 * (y * png.width + x);
      colours.add(png.data.readUInt32LE(at));
      const step = x > 0 ? Math.max(...[0, 1, 2].map((c) => Math.abs((png.data[at + c] ?? 0) - (png.data[at - 4 + c] ?? 0)))) : 0;
      if (step > 6) drawn += 1;
    }
  }
  return { colours: colours.size, detail: drawn / (png.width * png.height) };
}

/**
 * Compares two pictures of the same thing. A pixel differs if a channel differs by more than 2 of 255. An edge is
 * where either picture has a step of more than 16 within one pixel around: there, drivers may round coverage
 * differently.
 * @param {PNG} a
 * @param {PNG} b
 */
export function difference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error("the pictures have different sizes");
  const { width, height } = a;
  let inside = 0;
  let atEdges = 0;
  let largest = 0;
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const at = 4 * (y * width + x);
      let delta = 0;
      for (let c = 0; c < 3; c += 1) delta = Math.max(delta, Math.abs((a.data[at + c] ?? 0) - (b.data[at + c] ?? 0)));
      if (delta <= 2) continue;
      largest = Math.max(largest, delta);
      if (range(a, x, y) > 16 || range(b, x, y) > 16) atEdges += 1;
      else inside += 1;
    }
  }
  const pixels = width * height;
  return { inside, atEdges, share: (inside + atEdges) / pixels, largest };
}

/** The largest difference of a channel within one pixel around. @param {PNG} png @param {number} x @param {number} y */
function range(png, x, y) {
  let most = 0;
  for (let c = 0; c < 3; c += 1) {
    let low = 255;
    let high = 0;
    for (let v = Math.max(0, y - 1); v <= Math.min(png.height - 1, y + 1); v += 1) {
      for (let u = Math.max(0, x - 1); u <= Math.min(png.width - 1, x + 1); u += 1) {
        const value = png.data[4 * (v * png.width + u) + c] ?? 0;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    most = Math.max(most, high - low);
  }
  return most;
}
