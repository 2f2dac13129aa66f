// Real models to test with, from npm packages that ship them, and large ones made here.
//
//   lamp.obj     a desk lamp of 1996: quads, triangles and polygons of up to 24 corners, a missing material library
//   teapot.obj   triangles
//   bunny.glb    the Stanford bunny as triangles; its package compresses it with Draco, so glTF-Transform writes a
//                plain GLB of it, which makes it a GLB by another program than Limn

import { createWriteStream } from "node:fs";
import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { once } from "node:events";
import { Logger, NodeIO } from "@gltf-transform/core";
import { KHRDracoMeshCompression } from "@gltf-transform/extensions";
import draco3d from "draco3d";
import { ROOT, scratch } from "./harness.mjs";

const require = createRequire(import.meta.url);
const OBJ = join(ROOT, "node_modules/obj-mtl-loader/example/public/test/objfiles");

/** The path of a real OBJ. @param {"lamp" | "teapot"} name */
export function realObj(name) {
  return join(OBJ, `${name}.obj`);
}

/** Writes a real GLB and returns its path. @param {"bunny"} name */
export async function realGlb(name) {
  const source = await readFile(require.resolve(`@pmndrs/assets/models/${name}.glb.js`), "utf8");
  const base64 = /base64,([A-Za-z0-9+/=]+)/.exec(source)?.[1];
  if (!base64) throw new Error("the package holds no model where it used to");
  const io = reader();
  io.registerDependencies({ "draco3d.decoder": await draco3d.createDecoderModule({}) });
  const document = await io.readBinary(Buffer.from(base64, "base64"));
  for (const extension of document.getRoot().listExtensionsUsed()) extension.dispose();
  const path = join(await scratch(), `${name}.glb`);
  await writeFile(path, await io.writeBinary(document));
  return path;
}

function reader() {
  // It warns about extensions that it does not know, such as our mark for polygons.
  return new NodeIO().setLogger(new Logger(Logger.Verbosity.ERROR)).registerExtensions([KHRDracoMeshCompression]);
}

/** What another program finds in a GLB: its triangles, all meshes together. @param {Buffer} bytes */
export async function readGlb(bytes) {
  const document = await reader().readBinary(bytes);
  let triangles = 0;
  let vertices = 0;
  /** @type {[number[], number[]]} */
  const bounds = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  for (const mesh of document.getRoot().listMeshes()) {
    for (const primitive of mesh.listPrimitives()) {
      const position = primitive.getAttribute("POSITION");
      if (!position || primitive.getMode() !== 4) throw new Error("a primitive that is no triangles");
      triangles += (primitive.getIndices()?.getCount() ?? position.getCount()) / 3;
      vertices += position.getCount();
      const [low, high] = [position.getMinNormalized([]), position.getMaxNormalized([])];
      for (let axis = 0; axis < 3; axis += 1) {
        bounds[0][axis] = Math.min(bounds[0][axis] ?? 0, low[axis] ?? 0);
        bounds[1][axis] = Math.max(bounds[1][axis] ?? 0, high[axis] ?? 0);
      }
    }
  }
  return { triangles, vertices, bounds };
}

/** Positions and faces of an OBJ, read here in the plainest way. @param {string} text */
export function readObj(text) {
  /** @type {number[][]} */ const positions = [];
  /** @type {number[][]} */ const faces = [];
  for (const line of text.split("\n")) {
    const [key, ...words] = line.trim().split(/\s+/);
    if (key === "v") positions.push(words.slice(0, 3).map(Number));
    else if (key === "f") faces.push(words.map((word) => Number(word.split("/")[0]) - 1));
  }
  return { positions, faces };
}

/** Writes an OBJ of a wavy square with `2 * side * side` triangles and returns its path. @param {number} side */
export async function largeObj(side) {
  const path = join(await scratch(), `wave-${2 * side * side}.obj`);
  const out = createWriteStream(path);
  let block = "";
  const flush = async (/** @type {number} */ most) => {
    if (block.length > most) {
      if (!out.write(block)) await once(out, "drain");
      block = "";
    }
  };
  for (let j = 0; j <= side; j += 1) {
    for (let i = 0; i <= side; i += 1) {
      const [x, y] = [(2 * i) / side - 1, (2 * j) / side - 1];
      block += `v ${x.toFixed(6)} ${(0.2 * Math.sin(5 * x) * Math.cos(4 * y)).toFixed(6)} ${y.toFixed(6)}\n`;
    }
    await flush(1 << 18);
  }
  for (let j = 0; j < side; j += 1) {
    for (let i = 0; i < side; i += 1) {
      const a = j * (side + 1) + i + 1;
      const [b, c, d] = [a + 1, a + side + 2, a + side + 1];
      block += `f ${a} ${d} ${c}\nf ${a} ${c} ${b}\n`;
    }
    await flush(1 << 18);
  }
  await flush(0);
  out.end();
  await once(out, "close");
  return path;
}
