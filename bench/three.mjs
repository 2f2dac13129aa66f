// What of three.js and three-subdivide a benchmark needs, bundled by `cargo xtask bench` into one script beside the page that it
// measures. Nothing of it ships.

export { BufferAttribute, BufferGeometry } from "three";
export { LoopSubdivision } from "three-subdivide";
