// How a scheme works: facts and pictures from its own rules, fractions and all.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { RENDERERS, cmd, own, ready } from "./harness.mjs";

describe("how a scheme works", () => {
  const here = own();
  /** @type {Awaited<ReturnType<typeof here.visit>>} */ let page;
  /** The weights in the nth picture with this caption, as they are written there. @param {string} caption @param {number} [nth] */
  const weights = async (caption, nth = 0) => {
    const figure = page.locator("#about-scheme figure").filter({ has: page.getByText(caption, { exact: true }) }).nth(nth);
    return (await figure.locator("text").allTextContents()).sort().join(" ");
  };

  for (const renderer of RENDERERS) test(`Loop and Catmull–Clark draw the fractions that their papers print, on ${renderer}`, async () => {
    page = await here.visit({ renderer, width: 1200, height: 760, hash: "#1;open+builtin:pawn;scheme+loop;level+1" });
    const sheet = page.locator("#about-scheme");
    await page.locator("#about").click();
    await sheet.locator("h1").filter({ hasText: "Loop" }).waitFor();
    assert.equal(await weights("Edge point"), "1/8 1/8 3/8 3/8");
    assert.equal(await weights("Vertex point"), "1/16 1/16 1/16 1/16 1/16 1/16 5/8");
    assert.match((await sheet.locator("dl").textContent()) ?? "", /Takestriangles.*Open rimsa cubic B-spline.*WeightsHow.*loop or warren.*Source.*1987/);
    // Another valence.
    await sheet.getByRole("button", { name: "3", exact: true }).click();
    assert.equal(await weights("Vertex point", 1), "3/16 3/16 3/16 7/16");
    assert.equal(await sheet.getByRole("button", { name: "3", exact: true }).getAttribute("aria-pressed"), "true");
    // Pictures are said as well.
    const said = await sheet.getByRole("img").first().getAttribute("aria-label");
    assert.match(said ?? "", /^Vertex point: weights .*5\/8/);
    // They follow the scheme, and its parameters.
    await cmd(page, "scheme catmull-clark");
    await sheet.locator("h1").filter({ hasText: "Catmull–Clark" }).waitFor();
    assert.equal(await weights("Edge point"), "1/16 1/16 1/16 1/16 3/8 3/8");
    assert.equal(await weights("Face point"), "1/4 1/4 1/4 1/4");
    await cmd(page, "scheme butterfly w=0");
    await sheet.locator("h1").filter({ hasText: "Butterfly" }).waitFor();
    await ready(page, (state) => state.params[0]?.text === "0");
    assert.equal(await weights("Edge point"), "1/2 1/2");
    await cmd(page, "scheme butterfly");
    await ready(page, (state) => state.params[0]?.text === "0.0625");
    assert.equal(await weights("Edge point"), "1/2 1/2 1/8 1/8 −1/16 −1/16 −1/16 −1/16");
    await page.keyboard.press("Escape");
    assert.ok(await sheet.isHidden());
    assert.ok(await page.locator("#about").evaluate((button) => button === document.activeElement), "the focus goes back");
  });

  test("dual schemes show their faces, and the panel leads here", async () => {
    page = await here.visit({ renderer: "webgpu", width: 390, height: 844, touch: true, hash: "#1;open+builtin:cube;scheme+doo-sabin;level+1" });
    await page.locator("#panel-toggle").click();
    await page.locator("#tab-surface").click();
    await page.locator("#scheme").filter({ hasText: "Cuts the corners" }).waitFor();
    await page.locator("#scheme .link").click();
    const sheet = page.locator("#about-scheme");
    await sheet.locator("h1").filter({ hasText: "Doo–Sabin" }).waitFor();
    assert.equal(await weights("Corner of a face"), "1/16 3/16 3/16 9/16");
    await sheet.getByRole("button", { name: "3", exact: true }).click();
    assert.equal(await weights("Corner of a face", 1), "1/6 1/6 2/3");
    assert.equal(await weights("Corner of a face", 2), "1/4 3/4");
    const box = await sheet.boundingBox();
    assert.ok(box && box.width === 390, "from below on a phone");
    await page.locator("#about-close").click();
    assert.ok(await sheet.isHidden());
  });

  test("every scheme of the registry has its line and its pictures", async () => {
    page = await here.visit({ renderer: "webgpu", width: 1200, height: 760, hash: "#1;open+builtin:pawn;scheme+loop;level+0" });
    await page.locator("#about").click();
    const pills = await page.$$eval("#schemes button", (pills) => pills.map((pill) => ({ id: pill.id.slice(7), name: pill.textContent, title: pill.title })));
    for (const { id, name, title } of pills) {
      assert.match(title, /^[A-Z].{20,}\.$/, `${id} says what it does`);
      await cmd(page, `scheme ${id}`);
      await page.locator("#about-scheme h1").filter({ hasText: new RegExp(`^${name}$`) }).waitFor();
      assert.equal(await page.locator("#about-scheme .summary").textContent(), title);
      assert.ok((await page.locator("#about-scheme figure text").count()) > 0, id);
    }
  });
});
