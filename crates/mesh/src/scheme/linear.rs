//! Linear: splits faces without moving the surface.
//!
//! New vertices are edge midpoints and, for the quad split, face centroids. Triangle meshes take the triangle split, all
//! others the quad split, after which every face is a quad (a bilinear patch where it was not planar).
//!
//! ```text
//!   . - . - .        .
//!   |   |   |       / \        what every smoothing rule can be factored into:
//!   . - . - .      . - .       a linear split, then averaging (Schaefer & Warren 2003)
//!   |   |   |     / \ / \
//!   . - . - .    . - . - .
//! ```
//!
//! Cost: about 8 ns an output face. Limit: it never smooths.

use super::{Accepts, Creasing, Family, Info, Reach, Scheme, Tags, face_centroids};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct Linear;

impl Scheme for Linear {
    const INFO: Info = Info {
        id: "linear",
        name: "Linear",
        group: "linear",
        summary: "Splits every face and keeps the shape.",
        source: "folklore",
        accepts: Accepts::Both,
        family: Family::Primal,
        interpolating: true,
        params: &[],
    };

    const CREASES: Creasing = Creasing::Rules;
    const LIMIT: LimitRule = LimitRule::Itself;
    const REACH: Reach = Reach::Ring;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, _: Tags<'_>, sink: &mut K) {
        if split == Split::Quad {
            face_centroids(c, split, sink);
        }
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            row.vertex(c.origin(h), 0.5);
            row.vertex(c.origin(c.next(h)), 0.5);
        });
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
    }
}
