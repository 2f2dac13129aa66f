//! What is shown beside the first pane: which part of the canvas it has, and what is kept of it.
//!
//! Pane 0 is the present scheme's, as if it were alone; the others are made one after the other when it is there. A surface that
//! changes its place is not made again.

use super::Engine;
use crate::compare::{OVERLAP, WORDS};
use crate::gestures::Viewport;
use crate::making::{Made, Work};
use limn_document::compare::Pane;
use limn_mesh::{Refined, predict};
use std::sync::Arc;

/// Faces that are refined and looked through between two frames.
const QUICK: u64 = 100_000;

impl Engine {
    /// Divides the free part of the canvas among the pictures.
    pub(super) fn divide(&mut self) {
        let mut free = self.viewport;
        let count = self.document.beside().len() + 1;
        if count > 1 {
            // One picture may reach under the page's words a little; several have words of their own there.
            free.max.y -= OVERLAP;
        }
        self.views = free.split(count, WORDS);
        self.document.set_aspect(self.views.first().map_or(1.0, Viewport::aspect));
        // Words go with their pictures.
        self.dirty.state |= self.views.len() > 1;
    }

    /// What is shown in a pane.
    pub(super) fn made(&self, pane: usize) -> Option<&Made> {
        match pane {
            0 => self.shown.as_ref(),
            _ => self.beside.get(pane - 1)?.as_ref(),
        }
    }

    /// Brings what is there to its pane, and lets go of what belongs to none.
    pub(super) fn arrange(&mut self, panes: &[(Pane, bool)]) {
        self.divide();
        let beside = panes.len().saturating_sub(1);
        self.beside.resize(self.beside.len().max(beside), None);
        for (i, (pane, corners)) in panes.iter().enumerate() {
            let is = |made: Option<&Made>| made.is_some_and(|m| m.is(&pane.mesh, &pane.plan, *corners));
            if !is(self.made(i))
                && let Some(j) = (i + 1..=self.beside.len()).find(|j| is(self.made(*j)))
            {
                self.renderer.swap(i, j);
                match (i.checked_sub(1), self.beside.get_mut(j - 1)) {
                    (Some(i), _) => self.beside.swap(i, j - 1),
                    (None, Some(other)) => std::mem::swap(&mut self.shown, other),
                    _ => {}
                }
            }
        }
        self.beside.truncate(beside);
        self.renderer.keep_panes(beside + 1);
        for (i, (slot, (pane, _))) in self.beside.iter_mut().zip(panes.iter().skip(1)).enumerate() {
            // Another level of the same scheme may stay until the wanted one is there.
            let fits = |m: &mut Made| m.plan.run(0) == pane.plan.run(0) && pane.refused.is_none();
            if !slot.as_mut().is_some_and(fits) {
                *slot = None;
                self.renderer.show_in(i + 1, None);
            }
        }
    }

    /// A level of the same surface to pick from while its points are on the GPU: as fine as is quick to make.
    pub(super) fn coarser(&mut self, made: &Made) -> Arc<Refined> {
        let mesh = made.refined.mesh().clone();
        let quick = |level: &u32| {
            let counts = predict(&mesh, &made.plan.to(*level)).ok().flatten().map(|p| p.counts);
            counts.is_some_and(|c| c.faces < QUICK)
        };
        let level = (0..=made.plan.level).take_while(quick).last().unwrap_or(0);
        let work = self.work_on(&mesh, &made.plan.to(level), u64::MAX);
        work.and_then(Work::finish).map_or_else(|_| made.refined.clone(), Arc::new)
    }

    /// Whether the first pane is not yet what is wanted.
    pub(super) fn making_first(&self) -> bool {
        self.pane == 0 && (self.making.is_some() || self.wants_kernel)
    }

    /// Leaves the panes beside the first that are not there yet, with `why` in their place.
    pub(super) fn skip(&mut self, why: &str) {
        (self.making, self.wants_kernel) = (None, false);
        for (i, pane) in self.document.panes().into_iter().enumerate().skip(1) {
            if self.made(i).is_none_or(|made| made.plan != pane.plan) {
                self.skipped.push((pane.plan, why.to_owned()));
            }
        }
        self.sync();
    }
}
