//! Kobbelt's interpolating quads (L. Kobbelt, "Interpolatory subdivision on open quadrilateral nets with arbitrary
//! topology", 1996): the four-point curve in both directions of the net, and a virtual point where there is no opposite.
//!
//! ```text
//!   k_i-2 --- l_i-1 --- k_i-1        edge point   9/16 (p + l_i) - 1/16 (the points behind p and behind l_i)
//!     |         |         |          behind p     l_i+2 at valence 4, else v_i below
//!   l_i+2 ----- p ------ l_i ---     face point   the same rule on four edge points in a row
//!     |         |         |
//!   k_i+1 --- l_i+1 ---- k_i         v_i = 4/n sum l - (l_i-1 + l_i + l_i+1)
//!                                          + q (k_i-2 + k_i-1 + k_i + k_i+1 - 4/n sum k),   q = 1/9
//! ```
//!
//! Why this one: a face beside p has two rows of edge points through it, and both must give the same face point. With
//! a = 9/16 and b = -1/16 all their terms agree but those behind p,
//!
//! ```text
//!   a b v_i + a b l_i-1 + b b k_i-2  =  a b v_i+1 + a b l_i+2 + b b k_i+2
//! ```
//!
//! which the formula fulfils with q = -b/a = 1/9 for every i; the condition leaves open one point that all v_i share, and
//! the symmetric one makes valence 4 the regular rule. In the next faces along a spoke, and where extraordinary vertices are
//! neighbours, two rows differ (the condition leaves nothing to choose there): the mean of both is taken, which no
//! numbering changes.
//!
//! A boundary is the four-point curve of its own vertices ([`super::Boundary`] says what corners do). Behind a boundary
//! vertex p lies 2p - the mean of its inner neighbours, behind a boundary edge's point the reflection of the point across
//! the face. Creases are boundaries from both sides ([`crate::apart`]). The paper takes quads only. Other faces are taken here for the one step after which there are none: k_i of
//! such a face completes a parallelogram, its point is 9/8 of the mean of its edge points - 1/8 of the mean of those
//! beyond, which on quads is the rule above.
//!
//! C1 as far as eigenvalues tell: next to 1 the largest at valences 3, 5, 6, 7 are the pairs 0.4263, 0.5379, 0.5597, 0.5732
//! of frequency 1, and the others at most 0.2509, 0.3619, 0.4263, 0.4697 (tests/naive_quads.rs measures them). Cost: about
//! 50 ns an output face.

use super::butterfly::four_points;
use super::{Accepts, Creasing, Family, Info, Scheme, Tags};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};

/// See the module.
#[derive(Debug)]
pub struct Kobbelt;

/// The four-point rule's tension: 1/2 + w of the inner points, -w of the outer ones.
const W: f64 = 1.0 / 16.0;
/// w / (1/2 + w).
const Q: f64 = 1.0 / 9.0;

impl Scheme for Kobbelt {
    const INFO: Info = Info {
        id: "kobbelt",
        name: "Kobbelt",
        group: "interpolating",
        summary: "Smooths quads through their own vertices; other faces become quads in the first step.",
        source: "Kobbelt 1996",
        accepts: Accepts::Polygons,
        family: Family::Primal,
        interpolating: true,
        params: &[],
    };

    const CREASES: Creasing = Creasing::Apart;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let edge_point = split.first_edge_point(c);
        sink.pass(edge_point, c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            let twin = c.twin(h);
            if is_boundary(twin) {
                return four_points(c, h, W, tags, row);
            }
            row.pair(c.origin(h), c.origin(twin), 0.5 + W);
            behind(c, h, row);
            behind(c, twin, row);
        });
        sink.pass(split.first_face_point(c), c.faces(), |f, row| {
            let corners = c.face_half_edges(f);
            let n = corners.len();
            let share = 1.0 / n as f64;
            for h in corners.clone() {
                row.child(edge_point + c.edge(h), (1.0 + 2.0 * W) * share);
            }
            for h in corners.clone() {
                match across(c, c.twin(h)) {
                    Some(beyond) => row.child(edge_point + c.edge(beyond), -2.0 * W * share),
                    None => {
                        row.child(edge_point + c.edge(h), -4.0 * W * share);
                        match across(c, h) {
                            Some(own) => row.child(edge_point + c.edge(own), 2.0 * W * share),
                            // No edge lies opposite: the reflection in the mean of them all.
                            None => {
                                row.child(edge_point + c.edge(h), -2.0 * W * share);
                                for x in corners.clone() {
                                    row.child(edge_point + c.edge(x), 4.0 * W * share * share);
                                }
                            }
                        }
                    }
                }
            }
        });
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
    }
}

/// The side opposite to `h` in its face, if that is a quad.
#[inline(always)]
fn across<C: Connectivity>(c: &C, h: u32) -> Option<u32> {
    (!is_boundary(h) && c.face_half_edges(c.face(h)).len() == 4).then(|| c.next(c.next(h)))
}

/// Adds -w of the point behind the origin of inner half-edge `h`. Cost: the valence.
#[inline(never)]
fn behind<C: Connectivity>(c: &C, h: u32, row: &mut impl Row) {
    let (p, start) = (c.origin(h), c.first_spoke(h));
    let mut faces = 0u32;
    let arriving = c.turn_from(start, |_| faces += 1);
    if arriving.is_some() {
        let share = W / f64::from(faces - 1);
        row.vertex(p, -2.0 * W);
        c.turn_from(start, |spoke| {
            if spoke != start {
                row.vertex(c.origin(c.next(spoke)), share);
            }
        });
        return;
    }
    let (mean, mut j) = (4.0 / f64::from(faces), 0);
    c.turn_from(h, |spoke| {
        if faces == 4 {
            if j == 2 {
                row.vertex(c.origin(c.next(spoke)), -W);
            }
            j += 1;
            return;
        }
        // How many of the places the ring has at j, counted from `h`.
        let at = |places: &[u32]| places.iter().filter(|&&p| p % faces == j).count() as f64;
        let l = mean - at(&[0, 1, faces - 1]);
        let k = Q * (at(&[0, 1, faces - 1, faces - 2]) - mean);
        row.vertex(c.origin(c.next(spoke)), -W * l);
        match across(c, spoke) {
            Some(opposite) => row.vertex(c.origin(opposite), -W * k),
            None => {
                row.pair(c.origin(c.next(spoke)), c.origin(c.prev(spoke)), -W * k);
                row.vertex(p, W * k);
            }
        }
        j += 1;
    });
}
