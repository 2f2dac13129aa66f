//! J-splines on triangles (J. Rossignac, S. Schaefer, "J-splines", 2008; s = 1/2 is Jarek's scheme, which M. Powell's
//! "Surface subdivision" of 2003 tries): one dial from interpolating to approximating.
//!
//! With L(v) = mean of v's neighbours - v:
//!
//! ```text
//!   a ----- x ----- b       edge point  x = (a + b)/2 - (1 - s)/8 (L(a) + L(b))
//!                           vertex      v' = v + s/4 L(v)
//!
//!   s = 0   through the vertices        s = 1   cubic B-spline like        between them: either's overshoot halved
//! ```
//!
//! Boundaries are the J-spline of their curve: the same with the two neighbours along it (s = 0 is the four-point curve, s =
//! 1 the cubic B-spline). Creases are boundaries from both sides ([`crate::apart`]), a choice of this house. With `move=off` vertices are left where they were, whatever s: what Powell's program did, which
//! never stored the moved vertices, oscillation and all. Cost: about 50 ns an output face (two rings an edge).

use super::{Accepts, Creasing, Domain, Family, Info, Param, Scheme, Tags, along_curve};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};

/// See the module.
#[derive(Debug)]
pub struct JSpline;

impl Scheme for JSpline {
    const INFO: Info = Info {
        id: "j-spline",
        name: "J-spline",
        group: "approximating",
        summary: "A dial between going through the vertices and smoothing them.",
        source: "Rossignac & Schaefer 2008",
        accepts: Accepts::Triangles,
        family: Family::Primal,
        interpolating: false,
        params: &[
            Param {
                key: "s",
                name: "Smoothing",
                summary: "0 goes through the vertices, 1 smooths most, 1/2 is Jarek's.",
                domain: Domain::Number { low: 0.0, high: 1.5, default: 0.5 },
            },
            Param {
                key: "move",
                name: "Old vertices",
                summary: "Whether they move; off repeats a known program's mistake.",
                domain: Domain::Choice(&["on", "off"]),
            },
        ],
    };

    const CREASES: Creasing = Creasing::Apart;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let [s, still, _] = tags.params;
        let pull = (s - 1.0) / 8.0;
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            let (a, b) = (c.origin(h), c.origin(c.next(h)));
            if is_boundary(c.twin(h)) {
                boundary_point(c, h, pull, tags, row);
                return;
            }
            row.pair(a, b, 0.5);
            laplacian(c, h, pull, tags, row);
            laplacian(c, c.twin(h), pull, tags, row);
        });
        sink.pass(0, c.vertices(), |v, row| {
            if still == 0.0 {
                laplacian(c, c.vertex_half_edge(v), s / 4.0, tags, row);
            }
            row.vertex(v, 1.0);
        });
    }
}

/// Adds `weight` times L of the vertex that `h` leaves: of the ring, or of the boundary's curve; nothing at a sharp vertex.
#[inline(never)]
fn laplacian<C: Connectivity>(c: &C, h: u32, weight: f64, tags: Tags<'_>, row: &mut impl Row) {
    let v = c.origin(h);
    if tags.is_sharp(c, v) {
        return;
    }
    let start = c.first_spoke(h);
    let mut k = 0.0;
    let arriving = c.turn_from(start, |_| k += 1.0);
    match arriving {
        Some(arriving) => row.pair(c.origin(c.next(start)), c.origin(arriving), weight / 2.0),
        None => _ = c.turn_from(start, |h| row.vertex(c.origin(c.next(h)), weight / k)),
    }
    row.vertex(v, -weight);
}

/// The edge point of boundary half-edge `h`, in an order that does not depend on the side.
#[inline(never)]
fn boundary_point<C: Connectivity>(c: &C, h: u32, pull: f64, tags: Tags<'_>, row: &mut impl Row) {
    let (a, b) = (c.origin(h), c.origin(c.next(h)));
    // Where the curve ends nothing pulls.
    match along_curve(c, h, tags) {
        [None, None] => row.pair(a, b, 0.5),
        [Some(before), Some(after)] => {
            row.pair(a, b, 0.5 - pull / 2.0);
            row.pair(before, after, pull / 2.0);
        }
        [Some(before), None] => {
            row.vertex(a, 0.5 - pull);
            row.vertex(b, 0.5 + pull / 2.0);
            row.vertex(before, pull / 2.0);
        }
        [None, Some(after)] => {
            row.vertex(a, 0.5 + pull / 2.0);
            row.vertex(b, 0.5 - pull);
            row.vertex(after, pull / 2.0);
        }
    }
}
