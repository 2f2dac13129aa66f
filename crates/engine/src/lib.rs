//! limn-engine: the only crate that knows the browser. It joins document, kernel, formats and renderer behind one object
//! of a dozen calls (`Engine`) that `web/host.js` owns, and speaks to the page in the messages of [`protocol`].
//!
//! ```text
//!   host.js ── command, open, input ... ──► Document ──► sync: is what is shown what is wanted?
//!      ▲                                                   │ no
//!      │  work(8 ms) ... work(8 ms) ...                    ▼
//!      └────────────────────────────────── Making: refine ──► normals ──► buffers ──► shown
//!         frame() ──► draw, state
//! ```
//!
//! The document changes at once and the surface follows: there is no queue of commands. The engine compares the mesh and
//! the plan that are wanted with what is shown and with what is being made; a newer wish drops an older job. Long work runs
//! in slices between which the thread takes messages, so orbiting goes on with the last good picture.
//!
//! Everything that can be is free of the browser and tested natively: [`gestures`], [`controls`], [`keys`], [`shorthand`],
//! [`report`], [`pick`], [`making`].

pub mod compare;
pub mod controls;
pub mod gestures;
pub mod keys;
pub mod making;
pub mod pick;
pub mod protocol;
pub mod report;
pub mod shorthand;

#[cfg(target_arch = "wasm32")]
pub mod engine;
#[cfg(target_arch = "wasm32")]
mod kernel;
#[cfg(target_arch = "wasm32")]
mod post;

#[cfg(target_arch = "wasm32")]
pub use engine::Engine;
