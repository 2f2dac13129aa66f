//! Poke: a triangle for every side of every face, around the face's centroid. Folklore; sqrt3 is this with its edges turned.
//!
//! ```text
//!   .-------.         .-------.
//!   |       |         | \   / |         again:   .       every triangle becomes three;
//!   |       |   -->   |   x   |                 /|\      no edge is ever split
//!   |       |         | /   \ |                / x \
//!   '-------'         '-------'               '-----'
//! ```
//!
//! What was not a triangle is one after the first step, on any polygons: the plainest way to a scheme that takes triangles only.
//! Cost: linear, as the other stored splits. Limit: angles shrink with every level, it never smooths, and rims stay as coarse as they are.

use super::{Accepts, Creasing, Family, Info, Scheme, Tags, face_centroids};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct Poke;

impl Scheme for Poke {
    const INFO: Info = Info {
        id: "poke",
        name: "Poke",
        group: "linear",
        summary: "Makes triangles of any polygons, around the middle of each.",
        source: "folklore",
        accepts: Accepts::Polygons,
        family: Family::Poke,
        interpolating: true,
        params: &[],
    };

    const CREASES: Creasing = Creasing::Rules;
    const LIMIT: LimitRule = LimitRule::Itself;

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, _: Tags<'_>, sink: &mut K) {
        face_centroids(c, split, sink);
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
    }
}
