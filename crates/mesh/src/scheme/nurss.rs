//! Quadratic NURSS (T. W. Sederberg, J. Zheng, D. Sewell, M. Sabin, "Non-uniform recursive subdivision surfaces", 1998):
//! Doo-Sabin with knot intervals, the biquadratic B-spline with any knots where faces are a grid.
//!
//! An interval d belongs to a vertex and one of its edges: d(i, j) at i toward j ([`crate::Mesh::knots`]; 1 where none is
//! given). On a face of n corners, with c_k = d(k-1, k) d(k+1, k), C their sum and V = sum of c_k P_k / C,
//!
//! ```text
//!   P'_i = (P_i + V)/2 + (c_i+2 + c_i-2)/(8 C) (sum of (1 + 2 cos(2 pi (i-j)/n)) P_j  -  n P_i)
//!
//!   next level, at the image of corner i:             i-1 |           d(i, i+1) to the image of i+1 and straight away
//!   both pairs of opposite edges have one interval      --+-- P'_i ---- i+1              from it, d(i, i-1) the other way
//! ```
//!
//! Equal intervals make it Doo-Sabin. The paper halves the intervals at every step; only their ratios count, so they stay as
//! they are here. Along a boundary lies the quadratic B-spline of its own intervals: with E = (d(j, i) P_i + d(i, j) P_j) /
//! (d(i, j) + d(j, i)) on an edge, its new points are (P_i + E)/2. Corners are as in Doo-Sabin.
//!
//! An interval of 0 pulls the surface to its vertex, as a double knot does; intervals of 0 at the vertices of a row, toward those
//! beside it, make a crease of the row. Where all of
//! a face's c are 0 (two zero intervals in a row; a knot too many) the formula says nothing, and the face is treated as if its
//! intervals were equal; so is a boundary edge with two zeros. Dual splits carry intervals to the next level, other splits
//! forget them. C1 for positive intervals. Cost: as Doo-Sabin, twice as much where there are intervals.

use super::{Accepts, Boundary, DooSabin, Family, Info, Scheme, Tags};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};
use std::f64::consts::PI;

/// See the module.
#[derive(Debug)]
pub struct Nurss;

impl Scheme for Nurss {
    const INFO: Info = Info {
        id: "nurss",
        name: "NURSS",
        group: "dual",
        summary: "Doo–Sabin with knot intervals, which pull the surface toward vertices and edges.",
        source: "Sederberg, Zheng, Sewell & Sabin 1998",
        accepts: Accepts::Polygons,
        family: Family::Dual,
        interpolating: false,
        params: &[],
    };

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let knots = tags.knots;
        if knots.is_empty() {
            return DooSabin::rules(c, split, tags, sink);
        }
        sink.pass(0, c.half_edges(), |h, row| {
            let before = c.prev(h);
            match (is_boundary(c.twin(h)), is_boundary(c.twin(before))) {
                (false, false) => image(c, knots, h, row),
                // Rounded, this is the image before the corner.
                (true, true) if tags.rules.boundary == Boundary::EdgeAndCorner => row.vertex(c.origin(h), 1.0),
                (true, false) => along(c, knots, h, false, row),
                (_, true) => along(c, knots, before, true, row),
            }
        });
        sink.pass(c.half_edges(), tags.lone.len() as u32, |i, row| {
            along(c, knots, tags.lone[i as usize], false, row);
        });
    }
}

/// The interval at the origin of `h` toward its target.
#[inline(always)]
fn out_of(knots: &[f32], h: u32) -> f64 {
    f64::from(knots[2 * h as usize])
}

/// The interval at the target of `h` toward its origin.
#[inline(always)]
fn back_from(knots: &[f32], h: u32) -> f64 {
    f64::from(knots[2 * h as usize + 1])
}

/// Whether a sum of intervals can be divided by.
fn divides(sum: f64) -> bool {
    sum > 0.0 && sum.is_finite()
}

/// The image of corner `h` inside.
#[inline(never)]
fn image<C: Connectivity>(c: &C, knots: &[f32], h: u32, row: &mut impl Row) {
    let corners = c.face_half_edges(c.face(h));
    let (n, first) = (corners.len() as u32, corners.start);
    // By places counted from `h`.
    let corner = |j: u32| first + (h - first + j) % n;
    let product = |j: u32| out_of(knots, corner(j + n - 1)) * back_from(knots, corner(j));
    let sum: f64 = (0..n).map(product).sum();
    let c_of = |j: u32| if divides(sum) { product(j) / sum } else { 1.0 / f64::from(n) };
    let turn = (c_of(2 % n) + c_of(n - 2)) / 8.0;
    for j in 0..n {
        let cos =
            if n == 4 { [1.0, 0.0, -1.0, 0.0][j as usize] } else { libm::cos(2.0 * PI * f64::from(j) / f64::from(n)) };
        let own = if j == 0 { 0.5 - turn * f64::from(n) } else { 0.0 };
        row.vertex(c.origin(corner(j)), own + 0.5 * c_of(j) + turn * (1.0 + 2.0 * cos));
    }
}

/// The point of the boundary's curve on half-edge `h` next to its origin, or to its target.
#[inline(never)]
fn along<C: Connectivity>(c: &C, knots: &[f32], h: u32, at_target: bool, row: &mut impl Row) {
    let mut ends = [(c.origin(h), out_of(knots, h)), (c.origin(c.next(h)), back_from(knots, h))];
    if at_target {
        ends.reverse();
    }
    let [(v, own), (w, other)] = ends;
    let sum = own + other;
    let share = if divides(sum) { 0.5 * own / sum } else { 0.25 };
    row.vertex(v, 1.0 - share);
    row.vertex(w, share);
}
