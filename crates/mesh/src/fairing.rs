//! Fairing by Taubin's lambda | mu filter: smoothing that does not shrink.
//!
//! G. Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995: a step toward the mean of the
//! neighbours with a factor lambda > 0, then one away from it with mu < -lambda. Together they are a low-pass filter whose
//! pass band ends at 1 / lambda + 1 / mu = 0.1 (Taubin's own figures for both).
//!
//! ```text
//!   v  <-  v + lambda (mean of neighbours - v)        one iteration: both passes over all vertices
//!   v  <-  v + mu     (mean of neighbours - v)
//! ```
//!
//! A pass is stated to a sink like a scheme's rules, only that the children are the vertices themselves. A boundary vertex
//! has its two neighbours along the boundary; what the boundary rule or the
//! mesh keeps stays, and so do corners of creases, while a vertex on a crease moves along it, however soft the crease is. Cost: about 20 ns a vertex and
//! pass. Limit: features as fine as the faces are taken for noise.

use crate::crease;
use crate::scheme::Tags;
use crate::sink::{Row, Sink};
use crate::topology::{Connectivity, is_boundary};

/// Taubin's factor of the first pass.
pub const LAMBDA: f64 = 0.6307;
/// Taubin's factor of the second pass.
pub const MU: f64 = -0.6732;
/// More iterations than this are refused: the shape is gone long before.
pub const MOST_ITERATIONS: u32 = 1000;

/// Fairing of one level, before anything is made of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fairing {
    /// The level.
    pub at: u32,
    /// Iterations, two passes each, at most [`MOST_ITERATIONS`].
    pub iterations: u32,
}

impl Fairing {
    /// How many passes it takes.
    pub(crate) fn passes(&self) -> u32 {
        2 * self.iterations.min(MOST_ITERATIONS)
    }
}

/// States pass `pass` of a fairing of `c`: child v is vertex v, moved.
pub(crate) fn rules<C: Connectivity, K: Sink>(c: &C, pass: u32, tags: Tags<'_>, sink: &mut K) {
    let factor = if pass.is_multiple_of(2) { LAMBDA } else { MU };
    sink.pass(0, c.vertices(), |v, row| {
        if tags.is_sharp(c, v) {
            return row.vertex(v, 1.0);
        }
        if tags.creases.is_some_and(|creases| creases.marked(v)) {
            match crease::ends(c, v, &tags) {
                Some([a, b]) => row.pair(a, b, 0.5 * factor),
                None => return row.vertex(v, 1.0),
            }
            return row.vertex(v, 1.0 - factor);
        }
        let start = c.vertex_half_edge(v);
        if is_boundary(c.twin(start)) {
            if let Some(arriving) = c.turn(v, |_| {}) {
                row.pair(c.origin(c.next(start)), c.origin(arriving), 0.5 * factor);
            }
        } else {
            let mut n = 0u32;
            c.turn(v, |h| {
                row.vertex(c.origin(c.next(h)), 1.0);
                n += 1;
            });
            row.scale(factor / f64::from(n));
        }
        row.vertex(v, 1.0 - factor);
    });
}
