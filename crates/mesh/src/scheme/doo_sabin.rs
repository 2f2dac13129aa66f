//! Doo-Sabin (D. Doo, M. Sabin, "Behaviour of recursive division surfaces near extraordinary points", 1978), and Doo's
//! midpoint variant (D. Doo, "A subdivision algorithm for smoothing down irregularly shaped polyhedrons", 1978).
//!
//! Every corner of a face of k corners has an image: with the corner itself counted 0 and the others 1 .. k - 1 round the
//! face, the weights are
//!
//! ```text
//!   .-----------.      Doo-Sabin   w0 = 1/4 + 5/(4k)      wj = (3 + 2 cos(2 pi j / k)) / (4k)
//!   | x       x |      midpoint    (corner + its two edges' midpoints + centroid) / 4
//!   |   face    |
//!   | x       x |      both give 9, 3, 3, 1 sixteenths on quads: the biquadratic B-spline
//!   '-----------'
//! ```
//!
//! On a boundary the images nearest to it are those of Chaikin's curve, 3/4 of the vertex and 1/4 of the next one along it;
//! a vertex of one face stays, or is cut off as the rest of the curve ([`super::Boundary`]). New faces are quads but for
//! those in the place of other faces and vertices, which stay as they are: C1. Cost: about 7 ns an output face
//! where nothing has a rim, else 20.

use super::{Accepts, Boundary, Family, Info, Scheme, Tags};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};
use std::array::from_fn;
use std::f64::consts::PI;

/// See the module.
#[derive(Debug)]
pub struct DooSabin;

impl Scheme for DooSabin {
    const INFO: Info = Info {
        id: "doo-sabin",
        name: "Doo–Sabin",
        group: "dual",
        summary: "Cuts the corners of any polygons: a face for every face, edge and vertex.",
        source: "Doo & Sabin 1978",
        accepts: Accepts::Polygons,
        family: Family::Dual,
        interpolating: false,
        params: &[],
    };

    const LIMIT: LimitRule = LimitRule::DooSabin { midpoint: false };

    fn rules<C: Connectivity, K: Sink>(c: &C, _: Split, tags: Tags<'_>, sink: &mut K) {
        images(c, tags, sink, |k, j| weight(false, k, j));
    }
}

/// See the module.
#[derive(Debug)]
pub struct Midpoint;

impl Scheme for Midpoint {
    const INFO: Info = Info {
        id: "doo-sabin-midpoint",
        name: "Doo–Sabin, midpoint",
        group: "dual",
        summary: "Doo–Sabin with the simplest weights: the mean of corner, edge midpoints and centroid.",
        source: "Doo 1978",
        accepts: Accepts::Polygons,
        family: Family::Dual,
        interpolating: false,
        params: &[],
    };

    const LIMIT: LimitRule = LimitRule::DooSabin { midpoint: true };

    fn rules<C: Connectivity, K: Sink>(c: &C, _: Split, tags: Tags<'_>, sink: &mut K) {
        images(c, tags, sink, |k, j| weight(true, k, j));
    }
}

/// The weight of the corner `j` places on in a face of `k` in the image of a corner.
pub(crate) fn weight(midpoint: bool, k: usize, j: usize) -> f64 {
    match (k, j) {
        // The corner counts once, and half in each midpoint.
        (_, 0) if midpoint => 0.5 + 0.25 / k as f64,
        _ if midpoint && (j == 1 || j + 1 == k) => 0.125 + 0.25 / k as f64,
        _ if midpoint => 0.25 / k as f64,
        (k, 0) => 0.25 + 1.25 / k as f64,
        (4, 2) => 0.0625,
        (4, _) => 0.1875,
        _ => (3.0 + 2.0 * libm::cos(2.0 * PI * j as f64 / k as f64)) / (4.0 * k as f64),
    }
}

/// The image of every corner: along the boundary, or by `weight(k, j)` of the corner `j` places on in a face of `k`.
#[inline(never)]
fn images<C: Connectivity, K: Sink>(c: &C, tags: Tags<'_>, sink: &mut K, weight: fn(usize, usize) -> f64) {
    // Of faces of 3 to 8 corners, so that cosines are not taken for every corner.
    let table: [[f64; 8]; 6] = from_fn(|i| from_fn(|j| if j < i + 3 { weight(i + 3, j) } else { 0.0 }));
    let (odd, mut first) = (c.first_quad(), c.half_edges());
    if odd < c.faces() {
        first = c.face_half_edges(odd).start;
    }
    sink.pass(0, first, |h, row| {
        let face = c.face_half_edges(c.face(h));
        let last = if h == face.start { face.end - 1 } else { h - 1 };
        let (after, before) = (is_boundary(c.twin(h)), is_boundary(c.twin(last)));
        match (after, before) {
            (false, false) => {
                let k = face.len();
                let round = (h..face.end).chain(face.start..h);
                match table.get(k - 3) {
                    Some(weights) => round.zip(weights).for_each(|(x, &w)| row.vertex(c.origin(x), w)),
                    None => round.enumerate().for_each(|(j, x)| row.vertex(c.origin(x), weight(k, j))),
                }
            }
            // Rounded, this is the image before the corner.
            (true, true) if tags.rules.boundary == Boundary::EdgeAndCorner => row.vertex(c.origin(h), 1.0),
            (after, _) => on_curve(row, c.origin(h), c.origin(if after && !before { c.next(h) } else { c.prev(h) })),
        }
    });
    let quad = |i: u32| {
        let h = first + 4 * i;
        [c.origin(h), c.origin(h + 1), c.origin(h + 2), c.origin(h + 3)]
    };
    sink.quads(first, c.faces() - odd, quad, from_fn(|j| weight(4, j)));
    sink.pass(c.half_edges(), tags.lone.len() as u32, |i, row| {
        let h = tags.lone[i as usize];
        on_curve(row, c.origin(h), c.origin(c.next(h)));
    });
}

/// Chaikin's corner cutting.
#[inline(always)]
fn on_curve(row: &mut impl Row, v: u32, next: u32) {
    row.vertex(v, 0.75);
    row.vertex(next, 0.25);
}
