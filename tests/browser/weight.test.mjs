// The page's weight: every body that the server sent for a first visit, what workers fetched included, as brotli at its
// highest level. The budgets are those of the smallest comparable viewers.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { QUICK, RENDERERS, launch, picture, serveSite, visit } from "./harness.mjs";

const BUDGET = { webgpu: 230_000, webgl: 800_000 };

describe("the page's weight", { skip: QUICK && "a quick build is not what ships" }, () => {
  for (const renderer of RENDERERS) {
    test(`is at most ${BUDGET[renderer] / 1000} kB on ${renderer}`, async () => {
      const site = await serveSite();
      const browser = await launch();
      try {
        const page = await visit(browser, site.url, { renderer });
        await picture(page);
        const total = site.sent.reduce((sum, { bytes }) => sum + bytes, 0);
        const list = site.sent.map(({ path, bytes, status }) => `  ${String(bytes).padStart(8)}  ${path}${status === 200 ? "" : ` (${status})`}`);
        console.log(`${list.join("\n")}\n  ${String(total).padStart(8)}  ${renderer} in all, of ${BUDGET[renderer]}`);
        assert.ok(site.sent.some(({ path }) => path.endsWith(".wasm")), "the worker's fetches are counted");
        const paths = site.sent.map(({ path }) => path);
        assert.equal(new Set(paths).size, paths.length, "nothing is fetched twice");
        assert.deepEqual(site.sent.filter(({ status }) => status !== 200), [], "nothing is missing");
        assert.deepEqual(paths.filter((path) => /^\/pkg\/(files|kernel|trial)\//.test(path)), [], "file formats, rare schemes and benchmarks come later");
        assert.ok(total <= BUDGET[renderer], `a first visit transfers ${total} bytes, ${BUDGET[renderer]} are allowed`);
      } finally {
        await browser.close();
        site.close();
      }
    });
  }
});
