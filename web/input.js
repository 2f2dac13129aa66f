// @ts-check
// Raw pointer and wheel events, gathered for one frame and sent as one array of numbers. What a drag, a pinch or a double
// click means is the engine's business: it has the camera and the model.

import { byId } from "./dom.js";

/** Numbers an event has in a batch: kind, pointer, x, y (CSS pixels), a, b, modifiers, time (milliseconds). */
const STRIDE = 8;
const KIND = { down: 0, move: 1, up: 2, cancel: 3, wheel: 4 };

/** Listens on the stage, which outlives every canvas in it. @param {(batch: Float32Array) => void} send */
export function listen(send) {
  const stage = byId("stage");
  /** @type {number[]} */
  let batch = [];
  let waiting = false;

  const flush = () => {
    waiting = false;
    if (batch.length) send(new Float32Array(batch));
    batch = [];
  };

  /** @param {number} kind @param {MouseEvent} event @param {number} pointer @param {number} a @param {number} b */
  const push = (kind, event, pointer, a, b) => {
    const box = stage.getBoundingClientRect();
    const touch = event instanceof PointerEvent && event.pointerType === "touch";
    const modifiers =
      (event.shiftKey ? 1 : 0) | (event.ctrlKey ? 2 : 0) | (event.altKey ? 4 : 0) | (event.metaKey ? 8 : 0) | (touch ? 16 : 0);
    const x = event.clientX - box.left;
    const y = event.clientY - box.top;
    const last = batch.length - STRIDE;
    if (kind === KIND.move && last >= 0 && batch[last] === KIND.move && batch[last + 1] === pointer) batch.length = last;
    batch.push(kind, pointer, x, y, a, b, modifiers, event.timeStamp);
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(flush);
    }
  };

  /** Pointer ids can be large; a batch of 32-bit floats wants small ones. @type {number[]} */
  const pointers = [];
  /** @param {PointerEvent} event */
  const slot = (event) => {
    let at = pointers.indexOf(event.pointerId);
    if (at < 0) at = pointers.includes(-1) ? pointers.indexOf(-1) : pointers.length;
    pointers[at] = event.pointerId;
    return at;
  };

  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    stage.classList.add("turning");
    push(KIND.down, event, slot(event), event.button, event.buttons);
  });
  stage.addEventListener("pointermove", (event) => {
    if (pointers.includes(event.pointerId)) push(KIND.move, event, slot(event), event.button, event.buttons);
  });
  /** @param {number} kind */
  const end = (kind) => (/** @type {PointerEvent} */ event) => {
    const at = pointers.indexOf(event.pointerId);
    if (at < 0) return;
    push(kind, event, at, event.button, event.buttons);
    pointers[at] = -1;
    if (pointers.every((p) => p < 0)) stage.classList.remove("turning");
  };
  stage.addEventListener("pointerup", end(KIND.up));
  stage.addEventListener("pointercancel", end(KIND.cancel));
  stage.addEventListener("lostpointercapture", end(KIND.cancel));
  stage.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const scale = event.deltaMode === 0 ? 1 : event.deltaMode === 1 ? 33 : 400;
      push(KIND.wheel, event, -1, event.deltaX * scale, event.deltaY * scale);
    },
    { passive: false },
  );
  // Safari's own pinch gesture would zoom the whole page.
  for (const name of ["gesturestart", "gesturechange"]) stage.addEventListener(name, (event) => event.preventDefault());
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
}
