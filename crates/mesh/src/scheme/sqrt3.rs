//! Sqrt3 (L. Kobbelt, "sqrt(3)-subdivision", 2000): the slowest growth there is, three triangles for one, all edges turned.
//!
//! ```text
//!   face point    centroid                               a triangle's sides shrink by sqrt(3) a step, and two steps
//!   vertex        (1 - a) v + a mean of neighbours       trisect every edge
//!                 a = (4 - 2 cos(2 pi / n)) / 9
//! ```
//!
//! Boundaries change in every second step only, when each edge is cut in three by the cubic B-spline's ternary rule:
//! (4, 19, 4) / 27 for old vertices, (1, 16, 10) / 27 and its mirror image for new ones. Corners end the curve.
//! Kobbelt makes feature lines by the boundary's rules; here a crease is two boundaries on each other. Only what is infinitely
//! sharp can be one, as an edge is turned in the next step or never.
//! C2 but at extraordinary vertices, C1 there. Cost: linear; `cargo xtask bench` measures it.

use super::{Accepts, Creasing, Family, Info, Scheme, Tags, along_curve};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};

/// See the module.
#[derive(Debug)]
pub struct Sqrt3;

impl Scheme for Sqrt3 {
    const INFO: Info = Info {
        id: "sqrt3",
        name: "√3",
        group: "approximating",
        summary: "Smooths triangles with the fewest new ones a step: three for one.",
        source: "Kobbelt 2000",
        accepts: Accepts::Triangles,
        family: Family::Sqrt3,
        interpolating: false,
        params: &[],
    };

    const CREASES: Creasing = Creasing::ApartForEver;
    const LIMIT: LimitRule = LimitRule::Sqrt3;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let trisect = split == (Split::Sqrt3 { trisect: true });
        let (old, faces) = (c.vertices(), c.faces());
        sink.pass(old, faces, |f, row| {
            let corners = c.face_half_edges(f);
            if let Some(h) = corners.clone().find(|&h| trisect && c.is_rim(h)) {
                return row.apart(|row| third(c, h, false, tags, row));
            }
            corners.for_each(|h| row.vertex(c.origin(h), 1.0 / 3.0));
        });
        sink.pass(old + faces, if trisect { c.boundary_half_edges() } else { 0 }, |r, row| {
            third(c, c.boundary_half_edge(r), true, tags, row);
        });
        let triangle = |f: u32| {
            let h = c.face_half_edges(f).start;
            [c.origin(h), c.origin(h + 1), c.origin(h + 2)]
        };
        let closed = c.boundary_half_edges() == 0 && tags.first_regular < old;
        let summed = closed && sink.rings(old, faces, triangle);
        sink.pass(0, old, |v, row| {
            if summed && v >= tags.first_regular {
                row.child(v, SIX[1]);
                return row.vertex(v, SIX[0]);
            }
            let start = c.vertex_half_edge(v);
            let on_rim = is_boundary(c.twin(start));
            if tags.is_sharp(c, v) || (on_rim && !trisect) {
                row.vertex(v, 1.0);
            } else if on_rim {
                let arriving = c.turn(v, |_| {}).unwrap_or(start);
                row.pair(c.origin(c.next(start)), c.origin(arriving), 4.0 / 27.0);
                row.vertex(v, 19.0 / 27.0);
            } else {
                let mut n = 0u32;
                c.turn(v, |h| {
                    row.vertex(c.origin(c.next(h)), 1.0);
                    n += 1;
                });
                // Most vertices have six neighbours.
                let [own, ring] = if n == 6 { SIX } else { weights(n) };
                row.scale(ring);
                row.vertex(v, own);
            }
        });
    }
}

/// [`weights`] of most vertices.
const SIX: [f64; 2] = [2.0 / 3.0, 1.0 / 18.0];

/// The weights of a vertex of `n` neighbours and of each of these.
#[inline(never)]
fn weights(n: u32) -> [f64; 2] {
    let a = (4.0 - 2.0 * libm::cos(2.0 * std::f64::consts::PI / f64::from(n))) / 9.0;
    [1.0 - a, a / f64::from(n)]
}

/// The first or the second point that cuts boundary half-edge `h` in three. A corner's curve goes straight on behind it.
#[inline(never)]
fn third<C: Connectivity>(c: &C, h: u32, second: bool, tags: Tags<'_>, row: &mut impl Row) {
    let (a, b) = (c.origin(h), c.origin(c.next(h)));
    let (near, far) = if second { (b, a) } else { (a, b) };
    match along_curve(c, h, tags)[usize::from(second)] {
        None => {
            row.vertex(near, 18.0 / 27.0);
            row.vertex(far, 9.0 / 27.0);
        }
        Some(beyond) => {
            row.vertex(near, 16.0 / 27.0);
            row.vertex(far, 10.0 / 27.0);
            row.vertex(beyond, 1.0 / 27.0);
        }
    }
}
