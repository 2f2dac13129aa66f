//! What rules have to know beside the connectivity: how rims and creases are taken, which vertices stay, parameters.
//!
//! ```text
//!   plan, mesh ── a level's tags ──> scheme.rules(connectivity, split, tags, sink)
//! ```

use super::{Boundary, MOST_PARAMS, Rules};
use crate::FULL;
use crate::crease::Creases;
use crate::topology::Connectivity;

/// What rules have to know beside the connectivity.
#[derive(Clone, Copy, Debug)]
pub struct Tags<'a> {
    /// The rules of the plan.
    pub rules: Rules,
    /// The level that is refined.
    pub step: u32,
    /// Vertices that stay where they are, by vertex id; shorter than the vertices where the rest is not.
    pub sharp: &'a [bool],
    /// Vertices of one face that are no corners, as in [`crate::Mesh::joined`].
    pub joined: &'a [bool],
    /// How sharp edges and vertices of the level are; none if none is marked.
    pub creases: Option<&'a Creases>,
    /// Corners that the split treats by name, by their half-edges: of the dual split those with two images, children from
    /// `half_edges()` on; of the mid-edge split those that are kept, children from `edges()` on. Of the mixed
    /// and the n-way split the faces that they have to tell apart.
    pub lone: &'a [u32],
    /// Knot intervals by half-edges, as in [`crate::Mesh::knots`]; empty if all are 1.
    pub knots: &'a [f32],
    /// The mean length of the edges of level 0, where the scheme asks for it.
    pub size: f64,
    /// The scheme's parameters: [`super::Params::of`].
    pub params: [f64; MOST_PARAMS],
    /// Vertices from here on were born in steps of triangles and are regular: of six faces, or three on a boundary or either
    /// side of a crease. No vertex at all where that is not known.
    pub first_regular: u32,
}

impl Tags<'_> {
    /// Tags of a mesh without marks, at level 0.
    pub fn new(rules: Rules, params: [f64; MOST_PARAMS]) -> Tags<'static> {
        let first_regular = u32::MAX;
        let (step, size, creases) = (0, 0.0, None);
        Tags { rules, step, sharp: &[], joined: &[], creases, lone: &[], knots: &[], size, params, first_regular }
    }

    /// Whether `v`, which starts its turn at `start`, is kept.
    #[inline(always)]
    pub(crate) fn is_sharp<C: Connectivity>(&self, c: &C, v: u32) -> bool {
        if (v as usize) < self.sharp.len() && self.sharp[v as usize] {
            return true;
        }
        if FULL && self.creases.is_some_and(|creases| creases.keeps(v)) {
            return true;
        }
        let joined = || self.joined.get(v as usize).is_some_and(|&joined| joined);
        c.is_pinned(v) || (self.rules.boundary == Boundary::EdgeAndCorner && c.is_tip(v) && !joined())
    }
}
