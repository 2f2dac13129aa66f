//! The stage of a track that makes the last level of patches, and what becomes of it where they do not fit.
//!
//! ```text
//!   Patches ── done ──> the last level, corners and normals with it
//!           └─ unfit ─> Points of this level; patches are tried again at the next
//! ```

use super::{Stage, Track, zeroed};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::patch::{self, Patches};
use crate::plan::{Plan, Step};
use crate::refine::sharp_at;
use crate::refined::{Faces, Refined};
use crate::sink::Cursor;
use crate::split::Level;

impl Track {
    /// Takes the buffers of a level with the same counts and faces.
    pub(crate) fn reuse(&mut self, old: Refined) {
        if self.patches_from.is_none() || !self.new_points.is_empty() {
            return;
        }
        self.new_points = old.points;
        self.normals = old.known_normals.filter(|_| self.shaded).unwrap_or_default();
        if let Faces::Quads(corners) | Faces::Triangles(corners) = old.faces {
            (self.corners, self.listed_before) = (corners, true);
        }
    }

    /// Takes no patches.
    pub(crate) fn no_patches(&mut self) {
        self.patches_from = None;
    }

    /// Makes the last level of patches.
    pub(super) fn patch(
        &mut self,
        level: &Level<'_>,
        mesh: &Mesh,
        plan: &Plan,
        steps: &[Step],
        quota: &mut usize,
    ) -> Option<Option<Owned>> {
        let step = steps.get(self.level as usize)?;
        let sharp = sharp_at(steps, self.level, mesh, &self.corner);
        let tags = plan.tags(step, self.level, sharp, self.creases.as_ref());
        if self.patches.is_none() {
            self.patches = Patches::new(*step, plan.rules, plan.level - self.level, self.counts).map(Box::new);
        }
        let progress = match &mut self.patches {
            Some(patches) => {
                let [counts, _] = patches.counts();
                zeroed(&mut self.new_points, counts.vertices as usize);
                zeroed(
                    &mut self.normals,
                    if self.shaded && patches.can_shade() { counts.vertices as usize } else { 0 },
                );
                zeroed(&mut self.corners, counts.corners as usize);
                let (points, normals) = (&mut self.new_points[..], &mut self.normals[..]);
                let corners = if self.listed_before { &mut [] } else { &mut self.corners[..] };
                let old = self.points.as_deref().unwrap_or(&mesh.positions);
                patches.work(level, &tags, old, &mut patch::Out { points, normals, corners }, quota)
            }
            None => patch::Progress::Unfit,
        };
        match (progress, self.patches.take()) {
            (patch::Progress::Done, Some(patches)) => {
                self.level = plan.level;
                [self.counts, self.before] = patches.counts();
                self.points = Some(std::mem::take(&mut self.new_points));
                return Some(None);
            }
            (patch::Progress::More, patches) => self.patches = patches,
            _ => {
                // Marks fade, and rings become alike: perhaps from the next level on.
                self.patches_from = Some(self.level + 1).filter(|from| from + 2 <= plan.level);
                (self.new_points, self.normals, self.corners) = Default::default();
                self.listed_before = false;
                self.stage = Stage::Points(Cursor::default());
            }
        }
        None
    }
}
