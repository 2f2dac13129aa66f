// Pictures of the page for people to look at: `cargo xtask screenshots` writes them to target/screenshots, a laptop and
// a phone in the dark and in the light theme, with the panel closed and open.

import { mkdir } from "node:fs/promises";
import { join } from "node:path";
import { ROOT, cmd, launch, picture, ready, serveSite, visit } from "./harness.mjs";

const folder = join(ROOT, "target/screenshots");
await mkdir(folder, { recursive: true });
const site = await serveSite();
const browser = await launch();
const devices = {
  laptop: { width: 1440, height: 900, scale: 1 },
  phone: { width: 390, height: 844, scale: 2, touch: true },
};
try {
  for (const [device, size] of Object.entries(devices)) {
    for (const scheme of /** @type {const} */ (["dark", "light"])) {
      const page = await visit(browser, site.url, { ...size, scheme, renderer: "webgpu" });
      const save = async (/** @type {string} */ what) => {
        await picture(page);
        const path = join(folder, `${device}-${scheme}-${what}.png`);
        await page.screenshot({ path });
        console.log(path);
      };
      await save("first");
      await page.locator("#model").click();
      await save("models");
      await page.keyboard.press("Escape");
      await page.locator("#panel-toggle").click();
      for (const tab of ["view", "surface", "report", "help", "console"]) {
        await page.locator(`#tab-${tab}`).click();
        await page.waitForTimeout(300);
        await save(`panel-${tab}`);
      }
      await cmd(page, "open builtin:pawn");
      await ready(page, (state) => state.model.name.includes("pawn"));
      await cmd(page, "info");
      await cmd(page, "levle 2");
      await save("console");
      await page.locator("#tab-console").focus();
      await page.keyboard.press("Escape");
      await cmd(page, "level 2");
      await ready(page, (state) => state.shown.level === 2);
      await cmd(page, "view edges=on");
      await page.waitForTimeout(200);
      await save("edges");
      await cmd(page, "view edges=off cage=on");
      await cmd(page, "level 100");
      await page.waitForSelector("#cards .card");
      await save("card");
      await page.context().close();
    }
  }
} finally {
  await browser.close();
  site.close();
}
