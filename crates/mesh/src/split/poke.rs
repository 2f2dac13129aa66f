//! The poke: every face becomes triangles around a new point in it.
//!
//! ```text
//!   n -------- v
//!   | \   h  / |        the triangle of half-edge h: v, n = next, centre; its half-edges are 3h, 3h + 1, 3h + 2
//!   |   \  /   |
//!   |    c     |        twins: 3 twin(h) | 3 next(h) + 2 | 3 prev(h) + 1
//!   |   /  \   |
//!   . -------- .        child vertices: old [0, V) | faces [V, V + F)
//! ```
//!
//! No edge is split, so rims stay as they are. Cost: linear.

use super::stored::Cut;
use crate::connect::UNMATCHED;
use crate::topology::{Connectivity, Topology, is_boundary};

/// The triangles, one a half-edge and in their order.
pub(super) fn faces(c: &Topology) -> Cut {
    let mut out = Cut::with_room(c.half_edges() as usize, 3 * c.half_edges() as usize, false);
    for h in 0..c.half_edges() {
        out.corners.extend([c.origin(h), c.origin(c.next(h)), c.vertices() + c.face(h)]);
        out.close(c.face(h), None);
    }
    out
}

/// Their twins.
pub(super) fn mates(c: &Topology) -> Vec<u32> {
    let sides = |h| {
        let t = c.twin(h);
        [if is_boundary(t) { UNMATCHED } else { 3 * t }, 3 * c.next(h) + 2, 3 * c.prev(h) + 1]
    };
    (0..c.half_edges()).flat_map(sides).collect()
}
