// @ts-check
// Notes the buffers that the engine makes for others to fill: wgpu hands out none of its own on the web.
//
//   note() ── the engine makes buffers, in the order of Surface::reserve ── noted()

/** Who makes buffers, and those it has made. @typedef {{ maker: GPUDevice | WebGL2RenderingContext | null, buffers: (GPUBuffer | WebGLBuffer)[] }} Noted */

/** @type {Noted | null} */
let open = null;
let watched = false;

/** @param {{ prototype: any } | undefined} type a class that has `createBuffer` */
function watch(type) {
  if (!type) return;
  const create = type.prototype.createBuffer;
  type.prototype.createBuffer = function (/** @type {unknown[]} */ ...described) {
    const buffer = create.apply(this, described);
    if (open) {
      open.maker = this;
      open.buffers.push(buffer);
    }
    return buffer;
  };
}

/** Notes buffers from now on. */
export function note() {
  if (!watched) for (const name of ["GPUDevice", "WebGL2RenderingContext"]) watch(Reflect.get(globalThis, name));
  watched = true;
  open = { maker: null, buffers: [] };
}

/** What was made since, and nothing more is noted. @returns {Noted} */
export function noted() {
  const found = open ?? { maker: null, buffers: [] };
  open = null;
  return found;
}
