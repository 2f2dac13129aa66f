// @ts-check
// The engine's thread: everything that it does is in host.js, which also runs on the page where workers cannot draw.

import { createHost } from "./host.js";

const scope = /** @type {import("./protocol.js").WorkerScope} */ (/** @type {unknown} */ (self));
const deliver = createHost((message, transfer) => scope.postMessage(message, transfer ?? []));
scope.onmessage = (event) => deliver(event.data);
