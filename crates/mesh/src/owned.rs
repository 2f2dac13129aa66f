//! Half-edges of a level that a refinement makes and gives up again, whichever way they are held.
//!
//! ```text
//!   quad split ─> Quads ──┐                  filled in slices, two words a half-edge
//!   triangle   ─> Triangles ─> stored_for    in full, where the next scheme needs that
//!   others     ─> Stored, Dual               come whole
//! ```
//!
//! Cost: about 3 ns a half-edge.

use crate::FULL;
use crate::crease::Creases;
use crate::plan::Step;
#[cfg(feature = "full")]
use crate::split::DualLevel;
use crate::split::{FaceShape, Level, QuadLevel, Split, TriangleLevel, on};
use crate::topology::{Connectivity, Topology};

/// Half-edges of a level between the first and the last.
#[derive(Debug)]
pub(crate) enum Owned {
    Quads(QuadLevel),
    Triangles(TriangleLevel),
    Stored(Topology),
    #[cfg(feature = "full")]
    Dual(DualLevel),
}

impl Owned {
    /// The level below, to be filled. A stored one comes whole.
    pub(crate) fn below(parent: &Level<'_>, split: Split, creases: Option<&Creases>) -> Owned {
        match (split, parent) {
            (Split::Quad, _) => Owned::Quads(QuadLevel::below(parent)),
            (Split::Triangle, _) => Owned::Triangles(TriangleLevel::below(parent)),
            (_, Level::Base(t)) if FULL => {
                Owned::Stored(split.cut(t, creases).connect(t, split, split.children(*t), creases))
            }
            _ => unreachable!("stored levels come of stored levels"),
        }
    }

    pub(crate) fn view(&self) -> Level<'_> {
        match self {
            Owned::Quads(q) => Level::Quads(q),
            Owned::Triangles(t) => Level::Triangles(t),
            Owned::Stored(t) => Level::Base(t),
            #[cfg(feature = "full")]
            Owned::Dual(d) => Level::Dual(d),
        }
    }

    /// Gives up what listing the faces that `split` makes does not read: where these are only shown, nothing else will.
    pub(crate) fn shed(&mut self, split: Split) {
        match (self, split) {
            _ if !FULL => {}
            (Owned::Stored(t), Split::Dual { .. }) => (t.origin, t.edge) = Default::default(),
            (Owned::Stored(t), Split::Sqrt3 { .. }) => (t.edge, t.edge_half_edge) = Default::default(),
            #[cfg(feature = "full")]
            (Owned::Dual(d), Split::Dual { .. }) => d.shed_origins(),
            _ => {}
        }
    }

    /// The same level as the next step wants it held.
    pub(crate) fn stored_for(self, next: Option<&Step>) -> Owned {
        match self {
            implicit if !FULL => implicit,
            Owned::Stored(t) => Owned::Stored(t),
            Owned::Quads(q) if next.is_some_and(|s| s.stored) => Owned::Stored(Topology::of(&q)),
            Owned::Triangles(t) if next.is_some_and(|s| s.stored) => Owned::Stored(Topology::of(&t)),
            #[cfg(feature = "full")]
            Owned::Dual(d) if !next.is_some_and(|s| s.split.is_dual()) => Owned::Stored(Topology::of(&d)),
            implicit => implicit,
        }
    }

    /// Fills up to `quota` faces, then vertices; true when complete.
    pub(crate) fn fill(&mut self, parent: &Level<'_>, at: &mut u32, quota: &mut usize) -> bool {
        on!(parent, c => {
            let (faces, all) = (c.faces(), c.faces() + c.vertices());
            let end = at.saturating_add((*quota).min(1 << 30) as u32).min(all);
            let (from, to) = ((*at).min(faces), end.min(faces));
            let (old_from, old_to) = ((*at).max(faces) - faces, end.max(faces) - faces);
            // Without other schemes after it a scheme's own split made the parent.
            match self {
                Owned::Quads(q) if FULL || c.sure_shape() != Some(FaceShape::Triangles) => {
                    q.fill(*c, from, to);
                    q.fill_vertices(*c, old_from, old_to);
                }
                Owned::Triangles(t) if FULL || c.sure_shape() != Some(FaceShape::Quads) => {
                    t.fill(*c, from, to);
                    t.fill_vertices(*c, old_from, old_to);
                }
                _ => {}
            }
            *quota -= (end - *at) as usize;
            *at = end;
            end == all
        })
    }
}
