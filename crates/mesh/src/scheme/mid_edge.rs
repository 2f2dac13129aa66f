//! Mid-edge (J. Peters, U. Reif, "The simplest subdivision scheme for smoothing polyhedra", 1997): every edge's midpoint, joined
//! to its four neighbours on the same faces. There is no simpler scheme that smooths.
//!
//! ```text
//!   .-------.-------.        .   o   .   o   .
//!   |       |       |          /   \   /   \           a face for every face and every vertex;
//!   |       |       |   -->  o   f   o   f   o         two steps are one of a dual scheme whose image of a
//!   |       |       |          \   / v \   /           corner v between a and b is (2 v + a + b) / 4
//!   '-------'-------'        .   o   .   o   .
//! ```
//!
//! On quads of valence four the limit is the quadratic box spline of four directions (Zwart and Powell's): C1, and C1 elsewhere
//! too. The paper has closed meshes; without more an open one shrinks and its rim becomes a zigzag. Here the first of two steps
//! keeps the rim's vertices, as corners of the faces around them, and the second cuts them off. The rim's new vertices are then
//! exactly Chaikin's, 3/4 and 1/4: the rim is the quadratic B-spline of its polygon, as Doo and Sabin's is, and every other
//! level shows that polygon. Across the rim it is as if its vertices were there twice: the surface ends in the curve, and rows
//! of faces grow from it by 1, 2, 3 .. to their width inside. Vertices of one face are kept as corners, or cut off like the
//! others ([`super::Boundary`]).
//!
//! Cost: linear; each step makes twice as many faces. Limit: large faces stay visible for long.

use super::{Accepts, Family, Info, Scheme, Tags};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct MidEdge;

impl Scheme for MidEdge {
    const INFO: Info = Info {
        id: "mid-edge",
        name: "Mid-edge",
        group: "dual",
        summary: "Joins the midpoints of edges: the simplest scheme that smooths, two faces for one a step.",
        source: "Peters & Reif 1997",
        accepts: Accepts::Polygons,
        family: Family::MidEdge,
        interpolating: false,
        params: &[],
    };

    const LIMIT: LimitRule = LimitRule::MidEdge;

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        sink.pass(0, c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            row.pair(c.origin(h), c.origin(c.next(h)), 0.5);
        });
        let keeps = matches!(split, Split::MidEdge { cut: false, .. });
        sink.pass(c.edges(), if keeps { c.boundary_half_edges() } else { 0 }, |r, row| {
            row.vertex(c.origin(c.boundary_half_edge(r)), 1.0);
        });
        sink.pass(c.edges(), if keeps { 0 } else { tags.lone.len() as u32 }, |i, row| {
            row.vertex(c.origin(tags.lone[i as usize]), 1.0);
        });
    }
}
