//! Interpolating sqrt3 (U. Labsik, G. Greiner, "Interpolatory sqrt(3)-subdivision", 2000): sqrt3's split, and every vertex
//! stays where it is. All that is computed is the new point of each triangle:
//!
//! ```text
//!       .-----x-----.        regular (all six-valent):  a 32/81, x -1/81, the six others -2/81
//!      / \   / \   / \
//!     . - - a - - a - .      beside a vertex of another valence n: of its ring alone, with c = 2/3 cos(pi / n)
//!      \ / \ o / \ /           vertex       1 - c^2
//!       x - - a - - x          neighbour j  (c^2 + 2c cos((2j+1) pi/n) + 2c^2 cos((2j+1) 2pi/n)) / n
//!        \   / \   /           n = 3        8/9 and 4, -5, 4 / 27        n = 4   7/9 and 2, -1, -1, 2 / 9
//!         . - - - .            (0 and n - 1 are the triangle's own); the mean over such corners
//! ```
//!
//! Boundaries change in every second step, when each edge is cut in three by the cubic through four points along it:
//! (-5, 60, 30, -4) / 81 and its mirror image; behind a corner the curve goes straight on. In the other steps a triangle with
//! one boundary edge p, q and its third vertex r takes r / 2 + (p + q) / 3 - (the two vertices across its other edges) / 12,
//! exact for quadratics along the rim; with two, 7/24 of the vertex between them, 3/8 of the others, -1/24 of the one across;
//! with three, the mean. Where a triangle only touches a rim, vertices that are not there are those of a neighbour turned over
//! its boundary edge: p + q - r. (The weights of one and two edges are those that OpenMesh states. Its figures agree where
//! they do not depend on where a face's list of vertices begins: not in triangles with two boundary edges.)
//!
//! Infinitely sharp edges are boundaries from both sides, as in sqrt3.
//!
//! C1. Cost: linear; wider stencils than sqrt3. Limit: like every interpolating scheme it ripples where a mesh is not smooth.

use super::{Accepts, Creasing, Family, Info, Scheme, Tags, along_curve};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};
use std::f64::consts::PI;

/// See the module.
#[derive(Debug)]
pub struct InterpolatingSqrt3;

impl Scheme for InterpolatingSqrt3 {
    const INFO: Info = Info {
        id: "interpolating-sqrt3",
        name: "Interpolating √3",
        group: "interpolating",
        summary: "Goes through the vertices of triangles, with the fewest new ones a step: three for one.",
        source: "Labsik & Greiner 2000",
        accepts: Accepts::Triangles,
        family: Family::Sqrt3,
        interpolating: true,
        params: &[],
    };

    const CREASES: Creasing = Creasing::ApartForEver;

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let trisect = split == (Split::Sqrt3 { trisect: true });
        let (old, faces) = (c.vertices(), c.faces());
        sink.pass(old, faces, |f, row| {
            let corners = c.face_half_edges(f);
            let on_boundary = |h: &u32| is_boundary(c.twin(*h));
            if let Some(h) = corners.clone().find(|&h| trisect && c.is_rim(h)) {
                return third(c, h, false, tags, row);
            }
            match corners.clone().find(on_boundary) {
                Some(h) => beside_rim(c, h, row),
                None => inside(c, corners, row),
            }
        });
        sink.pass(old + faces, if trisect { c.boundary_half_edges() } else { 0 }, |r, row| {
            third(c, c.boundary_half_edge(r), true, tags, row);
        });
        sink.pass(0, old, |v, row| row.vertex(v, 1.0));
    }
}

/// The valence of `v` if it is one that the regular weights are not made for: inside, and not six.
fn irregular<C: Connectivity>(c: &C, v: u32) -> Option<u32> {
    let mut n = 0;
    let arriving = c.turn(v, |_| n += 1);
    (arriving.is_none() && n != 6).then_some(n)
}

/// The point of a triangle without a boundary edge.
#[inline(never)]
fn inside<C: Connectivity>(c: &C, corners: std::ops::Range<u32>, row: &mut impl Row) {
    let valences = [0, 1, 2].map(|i| irregular(c, c.origin(corners.start + i)));
    let count = valences.iter().flatten().count();
    for (h, n) in corners.zip(valences) {
        match n {
            Some(n) => ring(c, h, n, 1.0 / count as f64, row),
            None if count == 0 => {
                row.vertex(c.origin(h), 32.0 / 81.0);
                // The neighbour across the edge that leaves here, and those behind its other two edges.
                let across = c.twin(h);
                row.vertex(c.origin(c.prev(across)), -1.0 / 81.0);
                behind(c, c.next(across), row);
                behind(c, c.prev(across), row);
            }
            None => {}
        }
    }
}

/// -2/81 of the vertex across `h`; on a boundary, of the triangle's own third vertex turned over it.
fn behind<C: Connectivity>(c: &C, h: u32, row: &mut impl Row) {
    let (w, across) = (-2.0 / 81.0, c.twin(h));
    if is_boundary(across) {
        row.pair(c.origin(h), c.origin(c.next(h)), w);
        row.vertex(c.origin(c.prev(h)), -w);
    } else {
        row.vertex(c.origin(c.prev(across)), w);
    }
}

/// `weight` times the rule of the ring of the vertex that `h` leaves, of valence `n`.
fn ring<C: Connectivity>(c: &C, h: u32, n: u32, weight: f64, row: &mut impl Row) {
    row.vertex(c.origin(h), weight * own(n));
    let mut j = 0;
    c.turn_from(h, |spoke| {
        row.vertex(c.origin(c.next(spoke)), weight * neighbour(n, j));
        j += 1;
    });
}

fn own(n: u32) -> f64 {
    match n {
        3 => 8.0 / 9.0,
        4 => 7.0 / 9.0,
        _ => {
            let c = 2.0 / 3.0 * libm::cos(PI / f64::from(n));
            1.0 - c * c
        }
    }
}

/// The weight of the spoke `j` places on from the triangle's first, which is neighbour n - 1 of the module's formula.
fn neighbour(n: u32, j: u32) -> f64 {
    match (n, j) {
        (3, 0 | 1) => 4.0 / 27.0,
        (3, _) => -5.0 / 27.0,
        (4, 0 | 1) => 2.0 / 9.0,
        (4, _) => -1.0 / 9.0,
        _ => {
            let n = f64::from(n);
            let (c, a) = (2.0 / 3.0 * libm::cos(PI / n), (2.0 * f64::from(j) - 1.0) * PI / n);
            (c * c + 2.0 * c * libm::cos(a) + 2.0 * c * c * libm::cos(2.0 * a)) / n
        }
    }
}

/// The point of a triangle with boundary edges, `h` the first of them, where they are not cut.
#[inline(never)]
fn beside_rim<C: Connectivity>(c: &C, h: u32, row: &mut impl Row) {
    let across = |h: u32| Some(c.twin(h)).filter(|t| !is_boundary(*t)).map(|t| c.origin(c.prev(t)));
    let (p, q, r) = (c.origin(h), c.origin(c.next(h)), c.origin(c.prev(h)));
    match (across(c.next(h)), across(c.prev(h))) {
        (None, None) => [p, q, r].into_iter().for_each(|v| row.vertex(v, 1.0 / 3.0)),
        (Some(x), None) => two_edges(p, [q, r], x, row),
        (None, Some(x)) => two_edges(q, [r, p], x, row),
        (Some(x), Some(y)) => match irregular(c, r) {
            Some(n) => ring(c, c.prev(h), n, 1.0, row),
            None => {
                row.vertex(r, 0.5);
                row.pair(p, q, 1.0 / 3.0);
                row.pair(x, y, -1.0 / 12.0);
            }
        },
    }
}

/// Of a triangle with two boundary edges, which meet in `between`.
fn two_edges(between: u32, others: [u32; 2], across: u32, row: &mut impl Row) {
    row.vertex(between, 7.0 / 24.0);
    row.pair(others[0], others[1], 3.0 / 8.0);
    row.vertex(across, -1.0 / 24.0);
}

/// The first or the second point that cuts boundary half-edge `h` in three.
#[inline(never)]
fn third<C: Connectivity>(c: &C, h: u32, second: bool, tags: Tags<'_>, row: &mut impl Row) {
    let (a, b) = (c.origin(h), c.origin(c.next(h)));
    let [before, after] = along_curve(c, h, tags);
    let (near, far, behind, beyond) = if second { (b, a, after, before) } else { (a, b, before, after) };
    // Straight on behind a corner: twice the corner less its neighbour.
    let (mut of_near, mut of_far) = (60.0, 30.0);
    match behind {
        None => (of_near, of_far) = (of_near - 10.0, of_far + 5.0),
        Some(behind) => row.vertex(behind, -5.0 / 81.0),
    }
    match beyond {
        None => (of_near, of_far) = (of_near + 4.0, of_far - 8.0),
        Some(beyond) => row.vertex(beyond, -4.0 / 81.0),
    }
    row.vertex(near, of_near / 81.0);
    row.vertex(far, of_far / 81.0);
}
