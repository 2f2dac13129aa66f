//! Texture coordinates on their way through steps whose faces leave their parents: the mesh's own half-edges go beside them.
//!
//! ```text
//!   level ── charts::carry ──> next level of the charts
//!   beside ── split ─────────> next level of the mesh           which says how faces meet on seams
//! ```

use super::Track;
use crate::FULL;
use crate::charts::{self, Channel};
use crate::crease::Creases;
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::plan::{Plan, Step};
use crate::split::{Level, Split};
use crate::topology::Connectivity;

impl Track {
    /// Takes texture coordinates through a step whose faces leave their parents: a whole level.
    pub(super) fn chart(
        &mut self,
        level: &Level<'_>,
        mesh: &Mesh,
        plan: &Plan,
        (step, following): (&Step, Option<&Step>),
        quota: &mut usize,
    ) -> Option<Owned> {
        let held = self.beside.take();
        let own = held.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
        let (Level::Base(own), Level::Base(seams)) = (own, level) else {
            unreachable!("a step says when it needs stored half-edges")
        };
        let (values, pins) = (std::mem::take(&mut self.wide), std::mem::take(&mut self.pins));
        let old = Channel { topology: (*seams).clone(), values, pins };
        let knots = if self.level == 0 { &mesh.knots } else { &self.knots };
        let creases = self.beside_creases.take();
        let sharp = [creases.as_ref(), self.creases.as_ref()];
        let (new, rows) = charts::carry(own, &old, (knots, sharp), (step, self.level), plan.rules);
        *quota = quota.saturating_sub(rows);
        self.level += 1;
        self.before = self.counts;
        self.counts = new.topology.counts();
        (self.wide, self.pins) = (new.values, new.pins);
        self.creases = None;
        if following.is_none() {
            self.corners = new.topology.origins().to_vec();
            return None;
        }
        self.knots = step.split.knots(&Level::Base(own), knots, &step.split.lone(own));
        let below = Owned::below(&Level::Base(own), step.split, creases.as_ref());
        self.beside_creases =
            creases.and_then(|c| c.below(&Level::Base(own), step.split, &below.view(), plan.rules.decay));
        if let (Some(creases), Level::Base(own)) = (&self.beside_creases, below.view()) {
            // Numbers of half-edges are the same in both.
            let t = &new.topology;
            let vertex = |v: u32| creases.vertex(own.origin(t.vertex_half_edge(v)));
            self.creases = Creases::marked_by(t, |h| creases.edge(own.edge(h)), vertex, Vec::new());
        }
        self.beside = Some(below);
        Some(Owned::Stored(new.topology))
    }

    /// Takes the mesh's own half-edges one level further, where texture coordinates will have to know them.
    pub(super) fn follow(&mut self, mesh: &Mesh, plan: &Plan, split: Split, following: Option<&Step>) {
        if !FULL || !self.charted || following.is_none() {
            return;
        }
        let held = self.beside.take();
        let level = held.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
        let mut below = Owned::below(&level, split, None);
        let mut at = 0;
        while !below.fill(&level, &mut at, &mut { usize::MAX }) {}
        let creases = self.beside_creases.take();
        let below = below.stored_for(following);
        self.beside_creases = creases.and_then(|c| c.below(&level, split, &below.view(), plan.rules.decay));
        self.beside = Some(below);
    }
}
