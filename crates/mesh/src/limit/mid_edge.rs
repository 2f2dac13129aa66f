//! Mid-edge's limit masks.
//!
//! Every face becomes that of its edges' midpoints, forever: it shrinks to its centroid, and its corners turn about it as
//! cos and sin of 2 pi i / n, each step with the factor cos^2 (pi / n). A vertex's face begins with the midpoints of its n edges:
//!
//! ```text
//!   inside, n edges   v / 2 + mean of neighbours / 2         tangents: cos and sin of 2 pi i / n
//!   two faces         no face of its own, but two steps on an edge's midpoint with four neighbours, to which this applies
//!   rim               (1, 6, 1) / 8, the quadratic B-spline's          along it; and n1 + n(k-1) - 2 v, k faces, across it:
//!   rim, half way     (1, 2, 1) / 4 for old vertices; midpoints stay     two steps keep that with the factor 1/4
//!   corner            itself
//! ```
//!
//! "Half way" is before the second of two steps. Cost: the valence. Limit: vertices of two faces beside another such are left where they are.

use super::{Mask, Ring};
use crate::split::Split;
use crate::topology::Connectivity;
use std::f64::consts::PI;

/// The mask of `v` before a step by `split`.
pub(super) fn mask(c: &impl Connectivity, ring: &Ring, split: Split, v: u32, mask: &mut Mask) {
    let (n, faces) = (&ring.neighbours, ring.spokes.len());
    let Split::MidEdge { cut, corners } = split else { return mask.keep(v) };
    if ring.arriving.is_none() {
        return match faces {
            2 => between_two(c, ring, v, mask),
            _ => inside(n, v, mask),
        };
    }
    let triangle = c.face_half_edges(c.face(ring.spokes[0])).len() == 3;
    if corners && faces == 1 && (triangle || !cut) {
        mask.keep(v);
        return ring.corner_tangents(v, mask);
    }
    let (first, last) = (n[0], n[faces]);
    let end = match (cut, faces) {
        (false, _) => 0.125,
        (true, 1) => 0.25,
        (true, _) => 0.0,
    };
    mask.point.extend([(first, end), (last, end), (v, 1.0 - 2.0 * end)]);
    let (inner, other) = (n[1], n[faces - 1]);
    mask.tangents.extend([(first, [1.0, 0.0], 0), (last, [-1.0, 0.0], 0)]);
    mask.tangents.extend([(inner, [0.0, 1.0], 0), (other, [0.0, 1.0], 0), (v, [0.0, -2.0], 0)]);
    mask.sectors = 1;
}

fn inside(neighbours: &[u32], v: u32, mask: &mut Mask) {
    let n = neighbours.len() as f64;
    mask.point.push((v, 0.5));
    for (i, &e) in neighbours.iter().enumerate() {
        let angle = 2.0 * PI * i as f64 / n;
        mask.point.push((e, 0.5 / n));
        mask.tangents.push((e, [libm::cos(angle), libm::sin(angle)], 0));
    }
    mask.sectors = 1;
}

/// With neighbours a and b, and what follows them in both faces, the midpoint's four neighbours are v / 4 + a / 2 + next / 4.
fn between_two(c: &impl Connectivity, ring: &Ring, v: u32, mask: &mut Mask) {
    let of_two = |v: u32| {
        let mut n = 0;
        c.turn(v, |_| n += 1).is_none() && n == 2
    };
    let (a, b) = (ring.neighbours[0], ring.neighbours[1]);
    if of_two(a) || of_two(b) {
        return mask.keep(v);
    }
    mask.point.extend([(v, 0.375), (a, 0.25), (b, 0.25)]);
    let (h, t) = (ring.spokes[0], ring.spokes[1]);
    // The vertex after the next, and the one before the last.
    let after = |h: u32| c.origin(c.next(c.next(h)));
    let before = |h: u32| c.origin(c.prev(c.prev(h)));
    for (end, next, w) in
        [(a, after(h), [1.0, 0.0]), (b, before(h), [0.0, 1.0]), (b, after(t), [-1.0, 0.0]), (a, before(t), [0.0, -1.0])]
    {
        mask.point.push((next, 1.0 / 32.0));
        mask.tangents.push((end, w.map(|w| 2.0 * w), 0));
        mask.tangents.push((next, w, 0));
    }
    mask.sectors = 1;
}
