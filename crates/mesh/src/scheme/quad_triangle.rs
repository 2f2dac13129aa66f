//! Quads and triangles in one mesh (J. Stam, C. Loop, "Quad/triangle subdivision", 2003): Catmull-Clark where faces are
//! quads, Loop where they are triangles, and one rule for both where they meet. Triangles stay triangles.
//!
//! ```text
//!   edge point: a half from each side                 vertex point, q quads and t triangles around it, S = 3q + 2t
//!
//!     quad      (a + b)/8 + centroid/4                 (1 - w) v + w/S (3/2 sum of (v + l)/2 over its edges
//!     triangle  3 (a + b)/16 + c/8                                     + 3/4 sum of the centroids of its quads
//!                                                                      + (3q/4 + t/2) v)
//!     quad beside triangle: 3/8 of a and b, 1/8 of     w = 12/S if there are quads: 4/q among quads alone
//!     the triangle's c, 1/16 of the quad's others      w = 5/3 - 8/3 (3/8 + cos(2 pi/t)/4)^2 among triangles alone
//! ```
//!
//! That is a linear split followed by Stam and Loop's smoothing, whose weights of a vertex, an edge and a quad's far corner
//! are as 4 : 2 : 1 at a regular vertex (four quads, six triangles, or two quads beside three triangles). Elsewhere the
//! paper leaves one number to choose; w is S. Schaefer and J. Warren's ("A factored approach to subdivision surfaces", 2004),
//! with which quads alone are exactly Catmull-Clark and triangles alone exactly Loop: such levels run as these schemes.
//! Faces of more corners count as quads, as in Catmull-Clark, and become quads.
//!
//! The boundary is the uniform cubic B-spline of its curve; creases are those of both ([`crate::crease`]). C2 among quads and among triangles, C1 where they meet and at
//! extraordinary vertices (the pass that Schaefer and Warren's "On C2 triangle/quad subdivision" of 2005 puts first, which
//! makes the seam C2, is not part of it). Cost: linear; pure meshes run Loop or Catmull-Clark.

use super::loop_::beta;
use super::{
    Accepts, CatmullClark, Creasing, Entry, Family, Honours, Info, Loop, Reach, Scheme, Tags, edge_point, entry,
    vertex_point,
};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct QuadTriangle;

const QUADS: Entry = entry::<CatmullClark>();
const TRIANGLES: Entry = entry::<Loop>();
const MIXED: Entry = entry::<QuadTriangle>();

/// The entry: levels of quads alone and of triangles alone are the other schemes'.
pub(super) const fn quad_triangle() -> Entry {
    Entry {
        info: QuadTriangle::INFO,
        common: QuadTriangle::COMMON,
        reach: Reach::Far,
        honours: Honours::ALL,
        limit: QuadTriangle::LIMIT,
        eval: |level, split, tags, sink| match split {
            Split::Quad => (QUADS.eval)(level, split, tags, sink),
            Split::Triangle => (TRIANGLES.eval)(level, split, tags, sink),
            _ => (MIXED.eval)(level, split, tags, sink),
        },
        record: |level, split, tags, sink| match split {
            Split::Quad => (QUADS.record)(level, split, tags, sink),
            Split::Triangle => (TRIANGLES.record)(level, split, tags, sink),
            _ => (MIXED.record)(level, split, tags, sink),
        },
    }
}

impl Scheme for QuadTriangle {
    const INFO: Info = Info {
        id: "quad-triangle",
        name: "Quad/Triangle",
        group: "approximating",
        summary: "Catmull–Clark on quads and Loop on triangles, smooth where they meet.",
        source: "Stam & Loop 2003",
        accepts: Accepts::Both,
        family: Family::Mixed,
        interpolating: false,
        params: &[],
    };

    const CREASES: Creasing = Creasing::Rules;

    /// States the mixed split's rules.
    fn rules<C: Connectivity, K: Sink>(c: &C, _: Split, tags: Tags<'_>, sink: &mut K) {
        let pointed = tags.lone;
        sink.pass(c.vertices(), pointed.len() as u32, |i, row| centroid(c, pointed[i as usize], 1.0, row));
        sink.pass(c.vertices() + pointed.len() as u32, c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            edge_point(c, (e, h), &tags, row, |row| {
                for side in [h, c.twin(h)] {
                    if is_triangle(c, side) {
                        row.pair(c.origin(h), c.origin(c.next(h)), 3.0 / 16.0);
                        row.vertex(c.origin(c.prev(side)), 0.125);
                    } else {
                        row.pair(c.origin(h), c.origin(c.next(h)), 0.125);
                        centroid(c, c.face(side), 0.25, row);
                    }
                }
            });
        });
        sink.pass(0, c.vertices(), |v, row| {
            vertex_point(c, v, &tags, row, |row| own_rule(c, v, row));
        });
    }
}

/// The rule of an inner vertex.
#[inline(always)]
fn own_rule<C: Connectivity>(c: &C, v: u32, row: &mut impl Row) {
    let (mut quads, mut triangles) = (0u32, 0u32);
    c.turn(v, |h| {
        row.vertex(c.origin(c.next(h)), 1.0);
        if is_triangle(c, h) {
            triangles += 1;
        } else {
            quads += 1;
            centroid(c, c.face(h), 1.0, row);
        }
    });
    if quads == 0 {
        row.scale(beta(triangles));
        return row.vertex(v, 1.0 - f64::from(triangles) * beta(triangles));
    }
    let (q, t) = (f64::from(quads), f64::from(triangles));
    let s = 3.0 * q + 2.0 * t;
    let share = 12.0 / (s * s);
    row.scale(0.75 * share);
    // Its own share, and what the midpoints of its edges have of it.
    row.vertex(v, 1.0 - 12.0 / s + share * (0.75 * q + 0.5 * t + 0.75 * (q + t)));
}

/// Whether the face of `h` is a triangle.
#[inline(always)]
fn is_triangle<C: Connectivity>(c: &C, h: u32) -> bool {
    c.face_half_edges(c.face(h)).len() == 3
}

/// Adds `weight` times the centroid of face `f`.
#[inline(always)]
fn centroid<C: Connectivity>(c: &C, f: u32, weight: f64, row: &mut impl Row) {
    let corners = c.face_half_edges(f);
    let share = weight / corners.len() as f64;
    corners.for_each(|h| row.vertex(c.origin(h), share));
}
