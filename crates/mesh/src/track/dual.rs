//! The steps of a track through dual splits whose connectivity is arithmetic: [`crate::split::DualLevel`].
//!
//! ```text
//!   level 0 ── in general ──> level 1 ── arithmetic ──> level 2 ── arithmetic ──> ...      where nothing has a rim
//! ```

use super::Track;
use crate::holes;
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::plan::Step;
use crate::split::{DualLevel, Level, dual};
use crate::topology::Connectivity;

impl Track {
    /// Whether the step from this level is a dual split after another, without rims, holes, creases and what else is carried
    /// from half-edge to half-edge.
    pub(super) fn is_arithmetic(&self, mesh: &Mesh, steps: &[Step]) -> bool {
        let is_dual = |step: u32| steps.get(step as usize).is_some_and(|s| s.split.is_dual());
        let twice = self.level.checked_sub(1).is_some_and(is_dual) && is_dual(self.level);
        let plain = !self.uv && self.wide.is_empty() && self.creases.is_none();
        let plain = plain && mesh.holes.is_empty() && mesh.knots.is_empty();
        twice && plain && self.before.boundary == 0 && self.before.digons == 0
    }

    /// Makes the half-edges of the next level, or lists the corners of the last.
    pub(super) fn dual(&mut self, level: &Level<'_>, steps: &[Step], closes: bool) -> Option<Owned> {
        match level {
            Level::Base(c) => self.dual_of(*c, steps, closes),
            Level::Dual(c) => self.dual_of(*c, steps, closes),
            _ => unreachable!("a dual split made the level"),
        }
    }

    fn dual_of(&mut self, c: &impl Connectivity, steps: &[Step], closes: bool) -> Option<Owned> {
        let (split, following) = (steps[self.level as usize].split, steps.get(self.level as usize + 1));
        let below = (following.is_some() || closes).then(|| Owned::Dual(DualLevel::below(c)).stored_for(following));
        let parents = match following {
            Some(_) => dual::parents(c),
            None => {
                let cut = DualLevel::cut(c);
                (self.offsets, self.corners, self.kinds) = (cut.offsets, cut.corners, cut.kinds);
                cut.source
            }
        };
        self.source = holes::descend(&self.source, parents);
        self.advance(split);
        below
    }
}
