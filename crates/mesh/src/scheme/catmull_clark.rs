//! Catmull-Clark (E. Catmull, J. Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", 1978).
//!
//! Face points are centroids; edge points the mean of the edge's ends and its two face points; a vertex of valence n goes
//! to ((n - 2) v + mean of neighbours + mean of face points) / n. The boundary is the uniform cubic B-spline of its curve.
//!
//! ```text
//!     f --- e --- f          e = (a + b + f + f') / 4
//!     |     |     |          v' = (n-2)/n v + 1/n^2 (sum of neighbours + sum of face points)
//!     e --- v --- e              the usual (Q + 2R + (n-3) v) / n with R the mean of edge midpoints
//! ```
//!
//! With OpenSubdiv's smooth rule of triangles an edge point takes 1/2 - w of each end and w of each face point, w the mean of
//! 0.47 for a triangle and 1/4 for any other face: it matters in the first step only, after which there are quads.
//!
//! Cost: about 20 ns an output face. Limit of smoothness: C2 but at extraordinary vertices, C1 there.

use super::{
    Accepts, Creasing, Family, Info, Reach, Scheme, Tags, TriangleRule, edge_point, face_centroids, vertex_point,
};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// The weight of a triangle's centroid in the points of its edges by the smooth rule: OpenSubdiv's.
const SMOOTH: f64 = 0.47;

/// See the module.
#[derive(Debug)]
pub struct CatmullClark;

impl Scheme for CatmullClark {
    const INFO: Info = Info {
        id: "catmull-clark",
        name: "Catmull–Clark",
        group: "approximating",
        summary: "Smooths any polygons into quads; the standard of film and modelling.",
        source: "Catmull & Clark 1978",
        accepts: Accepts::Polygons,
        family: Family::Primal,
        interpolating: false,
        params: &[],
    };

    const COMMON: bool = true;
    const CREASES: Creasing = Creasing::Rules;
    const LIMIT: LimitRule = LimitRule::CatmullClark;
    const REACH: Reach = Reach::Spline;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let face_point = split.first_face_point(c);
        face_centroids(c, split, sink);
        let smooth_triangles = tags.rules.triangle == TriangleRule::Smooth;
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            edge_point(c, (e, h), &tags, row, |row| {
                let (f, g) = (c.face(h), c.face(c.twin(h)));
                row.vertex(c.origin(h), 1.0);
                row.vertex(c.origin(c.next(h)), 1.0);
                if smooth_triangles {
                    let weight = face_weight(c, f) + face_weight(c, g);
                    row.scale(0.5 - 0.5 * weight);
                    row.child(face_point + f, 0.5 * weight);
                    row.child(face_point + g, 0.5 * weight);
                } else {
                    row.child(face_point + f, 1.0);
                    row.child(face_point + g, 1.0);
                    row.scale(0.25);
                }
            });
        });
        sink.pass(0, c.vertices(), |v, row| {
            vertex_point(c, v, &tags, row, |row| {
                let mut n = 0u32;
                c.turn(v, |h| {
                    row.vertex(c.origin(c.next(h)), 1.0);
                    row.child(face_point + c.face(h), 1.0);
                    n += 1;
                });
                let n = f64::from(n);
                row.scale(1.0 / (n * n));
                row.vertex(v, (n - 2.0) / n);
            });
        });
    }
}

/// What a face's point counts in an edge point, by the smooth rule of triangles; a face on both sides counts for each.
fn face_weight<C: Connectivity>(c: &C, f: u32) -> f64 {
    if c.face_half_edges(f).len() == 3 { SMOOTH } else { 0.25 }
}
