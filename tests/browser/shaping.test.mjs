// What shapes a surface beside its scheme: marks, rules, fairing, and schemes that take over later. As commands, which must give
// the native program's points to the bit; by hand, in the panel; and from a file. And what is offered where a scheme cannot.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { describe, test } from "node:test";
import { promisify } from "node:util";
import { CLI, RENDERERS, cards, cmd, difference, download, drop, own, picture, ready, scratch, state, visit } from "./harness.mjs";

const run = promisify(execFile);
const WIDE = { width: 1200, height: 760 };

/** A unit cube as OBJ, eight corners and six squares, with more lines. @param {string} more */
const cube = (more) => `${[0, 1].flatMap((z) => [[0, 0], [1, 0], [1, 1], [0, 1]].map(([x, y]) => `v ${x} ${y} ${z}`)).join("\n")}
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n${more}\n`;

/** The lines of an OBJ file that say where points are and which faces there are. @param {Buffer | string} obj */
const shape = (obj) => String(obj).split("\n").filter((line) => /^[vf] /.test(line)).map((line) => line.replace(/\/\S*/g, "")).join("\n");

describe("commands that shape the surface", () => {
  const here = own();
  const CASES = [
    ["an edge made sharp", "cube", "crease 0-1 10"],
    ["a chain half sharp, softened along it", "cube", "crease 0-1-3 2.5|crease-decay chaikin"],
    ["a corner", "cube", "corner 0 10"],
    ["a hole", "cube", "hole 2"],
    ["knot intervals", "cube", "scheme nurss|knot 0=1 0.25"],
    ["another scheme later", "cube", "scheme doo-sabin from=1"],
    ["a triangle scheme later", "cube", "scheme poke from=1|scheme loop from=2"],
    ["fairing", "pawn", "fair taubin 10"],
    ["fairing of a later level", "pawn", "fair taubin 5 at=1"],
    ["the limit", "pawn", "limit on"],
    ["rims left out", "grid", "boundary none"],
  ];
  for (const [what, model, commands] of CASES) {
    test(`${what} is the command line's, to the bit`, async () => {
      const level = 2;
      const page = await here.visit({ renderer: "webgpu", hash: `#1;open+builtin:${model};level+${level}` });
      await ready(page, (state, level) => state.shown.level === level, level);
      const plain = await download(page, "plain.obj", () => cmd(page, "export plain.obj"));
      const lines = (commands ?? "").split("|");
      for (const line of lines) await cmd(page, line);
      const last = lines.at(-1) ?? "";
      await ready(page, (state, last) => state.text.includes(last), last);
      const made = await download(page, "made.obj", () => cmd(page, "export made.obj"));
      const path = join(await scratch(), "native.obj");
      await run(CLI, [`builtin:${model}`, ...lines.flatMap((line) => line.split(" ")), "level", String(level), "export", path]);
      const native = await readFile(path);
      assert.equal(shape(made.bytes), shape(native));
      assert.notEqual(shape(made.bytes), shape(plain.bytes), "it makes a difference");
      // A link holds it.
      const { link, text } = await state(page);
      const again = await here.visit({ renderer: "webgpu", hash: link });
      await ready(again, (state, text) => state.text === text, text);
      await cmd(page, "undo");
      await ready(page, (state, last) => !state.text.includes(last), last);
    });
  }

  test("texture seams follow their rule", async () => {
    const page = await here.visit({ renderer: "webgpu", ...WIDE });
    const uv = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([u, v]) => `vt ${u} ${v}`).join("\n");
    const path = join(await scratch(), "dice.obj");
    await writeFile(path, `${cube("").split("\nf ")[0]}\n${uv}\n${["4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"]
      .map((face) => `f ${face.split(" ").map((v, i) => `${v}/${i + 1}`).join(" ")}`).join("\n")}\n`);
    await drop(page, [path]);
    await ready(page, (state) => state.model.name === "dice.obj");
    await cmd(page, "level 2");
    await ready(page, (state) => state.shown.level === 2 && !state.disabled.includes("face-varying"));
    const coordinates = async () =>
      String((await download(page, "uv.obj", () => cmd(page, "export uv.obj"))).bytes).split("\n").filter((line) => line.startsWith("vt ")).join("\n");
    const kept = await coordinates();
    await cmd(page, "face-varying all");
    await ready(page, (state) => state.values["face-varying"] === "all");
    const linear = await coordinates();
    await cmd(page, "face-varying none");
    await ready(page, (state) => state.values["face-varying"] === "none");
    const smooth = await coordinates();
    assert.ok(kept && linear && smooth && smooth !== linear, "three sets of coordinates");
    // Linear: a square's quarters.
    assert.deepEqual([...new Set(linear.split("\n").flatMap((line) => line.split(" ").slice(1).map(Number)))].sort(), [0, 0.25, 0.5, 0.75, 1]);
  });

  for (const renderer of RENDERERS) {
    test(`a dropped file's creases are honoured on ${renderer}`, async () => {
      const page = await here.visit({ renderer, ...WIDE });
      const folder = await scratch();
      const shown = async (/** @type {string} */ name, /** @type {string} */ more) => {
        await writeFile(join(folder, name), cube(more));
        await drop(page, [join(folder, name)]);
        await ready(page, (state, name) => state.model.name === name, name);
        await cmd(page, "level 3");
        await ready(page, (state) => state.shown.level === 3);
        return picture(page);
      };
      const round = await shown("round.obj", "");
      assert.ok((await state(page)).disabled.includes("crease-decay"), "nothing is half sharp");
      const tags = [[4, 5], [5, 6], [6, 7], [7, 4]].map(([a, b]) => `t crease 2/1/0 ${a} ${b} 2.5`).join("\n");
      const sharp = await shown("sharp.obj", tags);
      assert.ok(!(await state(page)).disabled.includes("crease-decay"));
      assert.ok(difference(round, sharp).share > 0.02, "another shape");
    });
  }
});

/** How many pixels have the colour of marks on the cage. @param {import("pngjs").PNG} png */
function orange({ data }) {
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += Number((data[i] ?? 0) > 200 && (data[i] ?? 0) > 2 * (data[i + 2] ?? 0));
  return count;
}

describe("shaping by hand", () => {
  const here = own();
  /** A page with the panel open at what shapes the surface. @param {Parameters<typeof visit>[2]} [options] */
  const open = async (options) => {
    const page = await here.visit({ renderer: "webgpu", ...WIDE, hash: "#1;open+builtin:cube;scheme+catmull-clark;level+2", ...options });
    await page.locator("#panel-toggle").click();
    await page.locator("#tab-surface").click();
    return page;
  };

  for (const renderer of RENDERERS) {
    test(`a click marks the edge under it, and undo takes that back, on ${renderer}`, async () => {
      const page = await open({ renderer });
      const before = await picture(page);
      await page.getByRole("button", { name: "Crease", exact: true }).click();
      await ready(page, (state) => state.values.cage === "on");
      assert.equal(orange(await picture(page)), 0, "nothing is marked");
      await page.locator("#mark-hint").getByText("an edge of the cage").waitFor();
      await page.getByRole("slider", { name: "Sharpness" }).fill("3");
      const box = await page.locator("#stage").boundingBox();
      assert.ok(box);
      const place = /** @type {const} */ ([(box.width - 340) / 2, box.height * 0.4]);
      await page.mouse.click(...place);
      await ready(page, (state) => /crease \d+-\d+ 3\n/.test(state.text));
      assert.ok(orange(await picture(page)) > 100, "the cage shows it");
      // A drag turns the model and marks nothing.
      await page.mouse.move(...place);
      await page.mouse.down();
      await page.mouse.move(place[0] + 60, place[1], { steps: 4 });
      await page.mouse.up();
      // Nothing is there.
      await page.mouse.click(40, box.height * 0.4);
      await page.waitForTimeout(200);
      assert.equal((await state(page)).text.match(/crease/g)?.length, 1);
      await page.getByRole("button", { name: "Hole", exact: true }).click();
      assert.ok(await page.getByRole("slider", { name: "Sharpness" }).isHidden(), "a hole has no sharpness");
      await page.mouse.click(...place);
      await ready(page, (state) => /hole \d/.test(state.text));
      await page.locator("#undo").click();
      await page.locator("#undo").click();
      await ready(page, (state) => !/hole|crease/.test(state.text));
      await page.getByRole("button", { name: "Hole", exact: true }).click();
      await ready(page, (state) => state.values.cage === "off");
      await cmd(page, "view camera=home");
      await ready(page);
      assert.equal(difference(before, await picture(page)).inside, 0, "as it was");
    });
  }

  test("a corner by touch, and knots for the scheme that knows them", async () => {
    const page = await open({ width: 390, height: 844, touch: true, hash: "#1;open+builtin:cube;scheme+nurss;level+2" });
    for (const [name, line] of /** @type {const} */ ([["Knot", /knot \d+=\d+ 0.5\n/], ["Corner", /corner \d+ 10\n/]])) {
      await page.getByRole("button", { name, exact: true }).tap();
      await page.locator("#mark-hint").waitFor();
      await page.touchscreen.tap(195, 190);
      await ready(page, (state, line) => new RegExp(line).test(state.text), line.source);
    }
    await cmd(page, "scheme linear");
    await ready(page, (state) => state.shown.scheme === "linear");
    assert.ok(await page.locator("#mark-knot").isHidden());
    assert.ok(await page.locator("#mark-hint").isVisible(), "corners are still marked");
  });

  test("another scheme from a level on; one that cannot follow says why and offers the step between", async () => {
    const page = await open();
    await page.getByLabel("From level", { exact: true }).selectOption("1");
    await page.getByLabel("Scheme from that level on").selectOption({ label: "Loop" });
    const card = page.locator("#card-command");
    await card.waitFor();
    assert.match((await cards(page))[0]?.text ?? "", /scheme loop from=1 .* Loop refines triangles only, and the faces of level 1 are not/);
    await card.getByRole("button", { name: "Poke at level 1, then Loop" }).click();
    await ready(page, (state) => state.text.includes("scheme poke from=1\nscheme loop from=2"));
    assert.deepEqual(await cards(page), [], "the card is done with");
    assert.deepEqual(await page.locator("#runs li").allInnerTexts().then((all) => all.map((one) => one.replace(/\s+/g, " "))), [
      "From level 1 Poke ×", "From level 2 Loop ×",
    ]);
    await cmd(page, "level 3");
    await ready(page, (state) => state.shown.level === 3);
    // 6 squares, 24, poked to 96 triangles, quartered.
    assert.equal((await state(page)).shown.faces, 384);
    await page.getByRole("button", { name: "Leave Loop out" }).click();
    await ready(page, (state) => state.runs.length === 1);
    await page.getByRole("button", { name: "Leave Poke out" }).click();
    await ready(page, (state) => state.runs.length === 0 && state.shown.faces === 384);
    assert.ok(await page.locator("#runs").isHidden());
  });

  test("a level that is too much is offered lower", async () => {
    const page = await open();
    await cmd(page, "level 30");
    const button = page.locator("#card-command").getByRole("button", { name: /^Use level \d+$/ });
    await button.waitFor();
    assert.match((await cards(page))[0]?.text ?? "", /level 30/);
  });

  test("a model of quads is cut for a scheme of triangles, and a card says so", async () => {
    const page = await open();
    await page.locator("#scheme-loop").click();
    await ready(page, (state) => state.shown.scheme === "loop");
    assert.match((await cards(page))[0]?.text ?? "", /6 faces were cut into triangles, which is what the scheme refines/);
    await page.locator("#scheme-tri-to-quad").click();
    await cmd(page, "open builtin:dodecahedron");
    await cmd(page, "scheme tri-to-quad");
    await ready(page, (state) => state.model.name === "dodecahedron" && state.shown.scheme === "tri-to-quad");
    assert.match((await cards(page))[0]?.text ?? "", /12 faces were cut into triangles/);
  });

  test("fairing is a slider for each level", async () => {
    const page = await open({ hash: "#1;open+builtin:pawn;scheme+loop;level+1" });
    const before = await picture(page);
    const slider = page.getByRole("slider", { name: "Iterations" });
    await slider.fill("10");
    await ready(page, (state) => state.fairings.length === 1);
    assert.deepEqual((await state(page)).fairings, [[0, 10]]);
    assert.ok(difference(before, await picture(page)).share > 0.005);
    await page.getByLabel("Level to be faired").selectOption("1");
    assert.equal(await slider.inputValue(), "0", "another level is not faired");
    await slider.fill("4");
    await ready(page, (state) => state.text.includes("fair taubin 10\nfair taubin 4 at=1"));
    await page.getByLabel("Level to be faired").selectOption("0");
    assert.equal(await slider.inputValue(), "10");
    await page.locator("#plan").getByRole("button", { name: "Default" }).click();
    await ready(page, (state) => state.fairings.length === 1 && state.fairings[0][0] === 1);
  });

  test("whole numbers are a slider's places", async () => {
    const page = await open({ hash: "#1;open+builtin:cube;scheme+n-way;level+1" });
    const slider = page.locator("#parameter-n");
    assert.deepEqual(await slider.evaluate((e) => [e.min, e.max, e.step, e.value], undefined), ["2", "16", "1", "3"]);
    assert.equal((await state(page)).shown.faces, 54);
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    await ready(page, (state) => state.shown.faces === 150 && state.text.includes("scheme n-way n=5"));
    await page.keyboard.press("Control+z");
  });
});
