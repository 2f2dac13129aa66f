//! Triangles to three quads, then averaging (J. Baumgartner's third program of 2003, after J. Warren, S. Schaefer, "A factored
//! approach to subdivision surfaces", 2003): Catmull-Clark's averaging on what triangles become when they are cut in quads.
//!
//! ```text
//!        .                 1  linear: centroids and midpoints; later every quad becomes four
//!       / \                2  each vertex moves by w = 4 / n to the mean of its n quads' centroids:
//!      /   \
//!     o     o                 v + w (mean - v)        w = 1 where four quads meet
//!    /  \ /  \
//!   /    x    \            What that is in terms of the level before: centroids stay; an edge a b with midpoint m between faces
//!  /     |     \           whose centroids are f and g goes to m/4 + (a + b)/8 + (f + g)/8 + (midpoints of the four edges beside
//! .------o------.          it on those faces)/16; a vertex to (1 - 2/n) v + (sum of neighbours + sum of centroids) / n^2.
//! ```
//!
//! On quads these are Catmull and Clark's rules. On triangles the edge points are not: it is a scheme of its own, which keeps
//! more of a mesh's shape. Along boundaries averaging takes the boundary only, as Warren and Schaefer have it: the cubic
//! B-spline of the curve; creases are Catmull-Clark's. With `average=off` the first part is left alone: a linear split.
//!
//! Takes triangles, and quads as it leaves them. C2 but at extraordinary vertices. Cost: linear, as Catmull-Clark.

use super::{Accepts, Creasing, Domain, Family, Info, Param, Scheme, Tags, edge_point, face_centroids, vertex_point};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct TriToQuad;

impl Scheme for TriToQuad {
    const INFO: Info = Info {
        id: "tri-to-quad",
        name: "Triangles to quads",
        group: "approximating",
        summary: "Cuts triangles in three quads and averages those, which keeps more of a mesh's shape.",
        source: "Baumgartner 2003, after Warren & Schaefer",
        accepts: Accepts::TrianglesThenQuads,
        family: Family::Quads,
        interpolating: false,
        params: &[Param {
            key: "average",
            name: "Averaging",
            summary: "Whether quads are averaged after the split; off only splits, and keeps the shape.",
            domain: Domain::Choice(&["on", "off"]),
        }],
    };

    const CREASES: Creasing = Creasing::Rules;

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let still = tags.params[0] != 0.0;
        let face_point = split.first_face_point(c);
        face_centroids(c, split, sink);
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            let (a, b) = (c.origin(h), c.origin(c.next(h)));
            if still {
                return row.pair(a, b, 0.5);
            }
            edge_point(c, (e, h), &tags, row, |row| {
                row.pair(a, b, 0.25);
                for h in [h, c.twin(h)] {
                    row.child(face_point + c.face(h), 0.125);
                    // The midpoints before and after: their ends on the edge, and the two others.
                    row.pair(a, b, 1.0 / 32.0);
                    row.pair(c.origin(c.prev(h)), c.origin(c.next(c.next(h))), 1.0 / 32.0);
                }
            });
        });
        sink.pass(0, c.vertices(), |v, row| {
            if still {
                return row.vertex(v, 1.0);
            }
            vertex_point(c, v, &tags, row, |row| {
                let mut n = 0.0;
                c.turn(v, |h| {
                    row.vertex(c.origin(c.next(h)), 1.0);
                    row.child(face_point + c.face(h), 1.0);
                    n += 1.0;
                });
                row.scale(1.0 / (n * n));
                row.vertex(v, 1.0 - 2.0 / n);
            });
        });
    }
}
