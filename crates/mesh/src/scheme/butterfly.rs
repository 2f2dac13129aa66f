//! Butterfly (N. Dyn, D. Levin, J. Gregory, "A butterfly subdivision scheme for surface interpolation with tension control",
//! 1990): triangles, every vertex stays where it is.
//!
//! ```text
//!    -w ---- 2w --- -w          edge point (x): 1/2 of each end, 2w of the two opposite vertices,
//!      \    /  \    /            -w of the four wings; w = 1/16 unless set: larger is tighter,
//!       1/2 - x - 1/2            0 is linear
//!      /    \  /    \
//!    -w ---- 2w --- -w
//! ```
//!
//! The weights are the same at every valence, which leaves the limit C1 only where valences are six (and four to seven in
//! practice; [`super::ModifiedButterfly`] mends the rest). A wing beyond a boundary is the reflection of the triangle before
//! it, which keeps linear functions linear. The boundary is the four-point curve of the same authors (-1, 9, 9, -1) / 16;
//! at a corner it ends, as if it went straight on. Creases are boundaries from both sides ([`crate::apart`]).
//!
//! Cost: about 14 ns an output face.

use super::{Accepts, Creasing, Domain, Family, Info, Param, Scheme, Tags, along_curve};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};

/// See the module.
#[derive(Debug)]
pub struct Butterfly;

impl Scheme for Butterfly {
    const INFO: Info = Info {
        id: "butterfly",
        name: "Butterfly",
        group: "interpolating",
        summary: "Smooths triangles through their own vertices, with a tension to choose.",
        source: "Dyn, Levin & Gregory 1990",
        accepts: Accepts::Triangles,
        family: Family::Primal,
        interpolating: true,
        params: &[Param {
            key: "w",
            name: "Tension",
            summary: "How far new points bulge: 0 keeps triangles flat, 1/16 is the smoothest.",
            domain: Domain::Number { low: 0.0, high: 0.125, default: 0.0625 },
        }],
    };

    const CREASES: Creasing = Creasing::Apart;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let w = tags.params[0];
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            if is_boundary(c.twin(h)) {
                row.apart(|row| four_points(c, h, w, tags, row));
            } else {
                eight_points(c, h, w, row);
            }
        });
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
    }
}

/// The butterfly around an inner edge.
#[inline(always)]
pub(super) fn eight_points<C: Connectivity>(c: &C, h: u32, w: f64, row: &mut impl Row) {
    let twin = c.twin(h);
    row.pair(c.origin(h), c.origin(twin), 0.5);
    row.pair(c.origin(c.prev(h)), c.origin(c.prev(twin)), 2.0 * w);
    for side in [c.next(h), c.prev(h), c.next(twin), c.prev(twin)] {
        beyond(c, side, -w, row);
    }
}

/// Adds the vertex opposite to `h` in the neighbouring triangle; beyond a boundary the reflection of the one before it.
#[inline(always)]
fn beyond<C: Connectivity>(c: &C, h: u32, weight: f64, row: &mut impl Row) {
    let twin = c.twin(h);
    if is_boundary(twin) {
        row.apart(|row| reflect(c, h, weight, row));
    } else {
        row.vertex(c.origin(c.prev(twin)), weight);
    }
}

#[inline(never)]
fn reflect<C: Connectivity>(c: &C, h: u32, weight: f64, row: &mut impl Row) {
    row.pair(c.origin(h), c.origin(c.next(h)), weight);
    row.vertex(c.origin(c.prev(h)), -weight);
}

/// The four-point rule on boundary half-edge `h`: 1/2 + w of its ends, -w of the vertices before and after. Where the curve
/// ends, at a corner, it goes straight on behind it.
#[inline(never)]
pub(super) fn four_points<C: Connectivity>(c: &C, h: u32, w: f64, tags: Tags<'_>, row: &mut impl Row) {
    let (a, b) = (c.origin(h), c.origin(c.next(h)));
    let ends = along_curve(c, h, tags);
    let [at_a, at_b] = ends.map(|end| end.is_none());
    // The virtual vertex behind a sharp end a is 2 a - b.
    let share = |own: bool, other: bool| 0.5 + w - if own { 2.0 * w } else { 0.0 } + if other { w } else { 0.0 };
    if at_a == at_b {
        row.pair(a, b, share(at_a, at_b));
    } else {
        row.vertex(a, share(at_a, at_b));
        row.vertex(b, share(at_b, at_a));
    }
    match ends {
        [Some(before), Some(after)] => row.pair(before, after, -w),
        [Some(end), None] | [None, Some(end)] => row.vertex(end, -w),
        [None, None] => {}
    }
}
