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
//! Cost: about 20 ns an output face. Limit of smoothness: C2 but at extraordinary vertices, C1 there.

use super::{Accepts, Family, Info, Scheme, Tags, face_centroids, kept_or_curve};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};

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
    const LIMIT: LimitRule = LimitRule::CatmullClark;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let face_point = split.first_face_point(c);
        face_centroids(c, split, sink);
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            let (a, b, twin) = (c.origin(h), c.origin(c.next(h)), c.twin(h));
            row.vertex(a, 1.0);
            row.vertex(b, 1.0);
            if is_boundary(twin) {
                row.scale(0.5);
            } else {
                row.child(face_point + c.face(h), 1.0);
                row.child(face_point + c.face(twin), 1.0);
                row.scale(0.25);
            }
        });
        sink.pass(0, c.vertices(), |v, row| {
            if !kept_or_curve(c, v, tags, row) {
                let mut n = 0u32;
                c.turn(v, |h| {
                    row.vertex(c.origin(c.next(h)), 1.0);
                    row.child(face_point + c.face(h), 1.0);
                    n += 1;
                });
                let n = f64::from(n);
                row.scale(1.0 / (n * n));
                row.vertex(v, (n - 2.0) / n);
            }
        });
    }
}
