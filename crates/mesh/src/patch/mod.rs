//! The patch-grid evaluator: many levels at once, at the speed of memory.
//!
//! The general engine makes a level from the one before, point by point through stored twins. But the points inside a face
//! depend on the ring of faces around it alone, however often it is cut. So every face of an early level is a *patch*: its
//! ring is read once, the whole grid of its descendants is computed in a block of memory that fits the first cache, and is
//! written to its place in the recursive numbering, which is a few runs of consecutive ids (`layout.rs`).
//!
//! ```text
//!   level 1 ── rings ──> A P A^T       regular quads                       points, in runs
//!                        T P           everything else: tables of      ──> corners, from a template
//!                                      recorded rows (`class.rs`)          normals, in runs
//! ```
//!
//! What patches share (corners, sides) is written by one of them, or kept aside (two points and two normals
//! a half-edge) until all are there: every point is stored once, so there are no cracks. The numbering is the
//! general engine's, which everything downstream goes on using; a numbering of its own (corners, edges, interiors)
//! would need a second way of everything.
//!
//! Which schemes: those whose children depend on one ring ([`crate::scheme::Scheme::REACH`]). Which steps: the last ones of
//! a plan, if they are at least two of one scheme and nothing happens between. Where patches have too many kinds of rings
//! (every crease of another sharpness), or a ring that cannot be unfolded, the general engine goes on from the same level.
//!
//! With the feature `parallel` threads share the patches (rayon): what they write does not meet, and is the same bits.
//!
//! Cost: at levels 5 and 6 of a thousand faces a tenth of the general engine's for points, a fifth with normals and corners; a
//! half and more of that where grids are 4x4. Memory beside the result: 24 bytes a half-edge of the start level, twice that with
//! normals, 4 bytes times the ring a point for each class; at most 4 bytes a face in all on the levels that tests count. Colours
//! and texture coordinates are evaluated as points: 12 bytes a vertex more while they are.

mod class;
mod drag;
mod grid;
mod layout;
mod ring;
mod tables;
mod turn;
mod worker;

use crate::mesh::Mesh;
use crate::plan::{PATCHED, Plan, Step};
use crate::scheme::{Boundary, Reach, Rules, Tags};
use crate::split::{Level, on};
use crate::topology::{Connectivity, Counts};
use class::Tabled;
pub use drag::{Drag, Moved};
use grid::MOST_STEPS;
use layout::{Layout, Run};
use std::ops::Range;
pub use tables::{PatchRing, PatchTable, PatchTables};
use worker::{Target, Worker};

/// How deep a patch is cut at most: deeper ones would leave the caches.
pub(crate) const DEEPEST: u32 = MOST_STEPS.ilog2();

/// Faces from which on threads share the work.
#[cfg(feature = "parallel")]
const MANY: usize = 1 << 16;

/// Shares a thread: those who are done early take another.
#[cfg(feature = "parallel")]
const SHARES: u64 = 4;

type Point = [f32; 3];

/// The level that patches start at, if the last steps of a plan can be taken at once.
pub(crate) fn start(mesh: &Mesh, plan: &Plan, steps: &[Step]) -> Option<u32> {
    let last = steps.last()?;
    // What ties copies or leaves faces out goes level by level.
    let all_shown = mesh.holes.is_empty() && (plan.rules.boundary != Boundary::None || mesh.counts().boundary == 0);
    let plain = mesh.tied.is_empty() && all_shown;
    if last.scheme.reach == Reach::Far || plan.closes() || !plain {
        return None;
    }
    let same = |step: &Step| step.scheme == last.scheme && step.params == last.params && step.split == last.split;
    let run = steps.iter().rev().take_while(|step| same(step)).count() as u32;
    let first = (plan.level - run).max(plan.level.saturating_sub(DEEPEST)).max(1);
    // Fairing happens at levels on the way.
    let first = plan.fairings.iter().filter(|f| f.iterations > 0).map(|f| f.at).fold(first, u32::max);
    (first + PATCHED - 1 <= plan.level).then_some(first)
}

/// What became of a slice of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// There is more to do.
    More,
    /// All is there.
    Done,
    /// Patches do not pay here; nothing was lost but time.
    Unfit,
}

/// The buffers that are filled: points of the last level, and unless empty its unit normals and its corners.
#[derive(Debug)]
pub(crate) struct Out<'a> {
    pub points: &'a mut [Point],
    pub normals: &'a mut [Point],
    pub corners: &'a mut [u32],
}

/// A level that is evaluated patch by patch.
#[derive(Debug)]
pub(crate) struct Patches {
    layout: Layout,
    step: Step,
    rules: Rules,
    /// As many as threads have been at work.
    workers: Vec<Worker>,
    /// Of each: its patches, and how many of these were taken on.
    shares: Vec<(Range<u32>, u32)>,
    tabled: Tabled,
    kept: Kept,
    /// When patches are done, the next edge, then vertex.
    next: u32,
}

/// What a patch leaves of a side: the point at its corner and the one in its middle; of normals the sum of the patch's own at the
/// corner, and the unit vector in the middle.
type Anchor = [Point; 2];

/// What patches leave for what they share, one a half-edge of the start level; normals if they are wanted.
#[derive(Debug, Default)]
struct Kept {
    points: Vec<Anchor>,
    normals: Vec<Anchor>,
}

impl Patches {
    /// Prepares the patches of a level with `counts` to be cut `depth` times by `step`; none if ids leave 32 bits.
    pub(crate) fn new(step: Step, rules: Rules, depth: u32, counts: Counts) -> Option<Patches> {
        let layout = Layout::new(step.split, depth, counts)?;
        Some(Patches {
            layout,
            step,
            rules,
            workers: Vec::new(),
            shares: Vec::new(),
            tabled: Tabled::default(),
            kept: Kept::default(),
            next: 0,
        })
    }

    /// Counts of the last level, and of the one before.
    pub(crate) fn counts(&self) -> [Counts; 2] {
        self.layout.counts
    }

    /// How many faces a patch is cut into.
    pub(crate) fn faces(&self) -> usize {
        self.layout.m * self.layout.m
    }

    /// Works off patches until `quota` faces are made. `old` are the points of the start level `level`; `tags` its tags.
    pub(crate) fn work(
        &mut self,
        level: &Level<'_>,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        quota: &mut usize,
    ) -> Progress {
        on!(level, c => self.work_on(*c, tags, old, out, quota))
    }

    #[inline(always)]
    fn work_on<C: Connectivity + Sync>(
        &mut self,
        c: &C,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        quota: &mut usize,
    ) -> Progress {
        let m = self.layout.m;
        if self.shares.is_empty() {
            if !ring::is_local(tags) {
                return Progress::Unfit;
            }
            let half_edges = c.half_edges() as usize;
            self.kept.points = bytemuck::zeroed_vec(half_edges);
            self.kept.normals = bytemuck::zeroed_vec(if out.normals.is_empty() { 0 } else { half_edges });
            self.share(c.faces());
        }
        if self.shares.iter().any(|(share, taken)| *taken < share.len() as u32) {
            let most = (*quota / self.faces() / self.shares.len()).clamp(1, 1 << 20) as u32;
            let Some(count) = self.run(most, (c, tags, old), out) else { return Progress::Unfit };
            *quota = quota.saturating_sub(count as usize * self.faces());
            return Progress::More;
        }
        let all = c.edges() + c.vertices();
        let from = self.next;
        let to = from.saturating_add((*quota / m).clamp(1, 1 << 20) as u32).min(all);
        self.borders(c, from..to, out);
        *quota = quota.saturating_sub((to - from) as usize * m);
        self.next = to;
        if self.next < all {
            return Progress::More;
        }
        self.boundary(c, out, |_| ());
        Progress::Done
    }

    /// Begins anew with other values of the same vertices, three channels of which no normals are wanted: all tables are there.
    pub(crate) fn restart(&mut self) {
        self.shares.iter_mut().for_each(|(_, taken)| *taken = 0);
        self.workers.iter_mut().for_each(Worker::forget_rims);
        self.kept.normals = Vec::new();
        self.next = 0;
    }

    /// Evaluates some patches of a level that is there again, by rising numbers, and appends the ids that they and their
    /// borders have.
    pub(crate) fn again(
        &mut self,
        level: &Level<'_>,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        patches: &[u32],
        ids: &mut Vec<Range<u32>>,
    ) {
        on!(level, c => self.again_on(*c, tags, old, out, patches, ids));
    }

    fn again_on<C: Connectivity + Sync>(
        &mut self,
        c: &C,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        patches: &[u32],
        ids: &mut Vec<Range<u32>>,
    ) {
        let sides = self.layout.sides as u32;
        self.workers.iter_mut().for_each(Worker::forget_rims);
        let Patches { layout, workers, kept, tabled, .. } = self;
        let whole = 0..c.faces();
        let mut targets = Target::cut(layout, std::slice::from_ref(&whole), out, kept);
        if let (Some(worker), Some(target)) = (workers.first_mut(), targets.first_mut()) {
            let start = (c, tags, old, &*tabled);
            for group in patches.chunk_by(|a, b| a + 1 == *b) {
                let range = group[0]..group[0] + group.len() as u32;
                let of = |run: &Run| run.base + run.per * range.start..run.base + run.per * range.end;
                ids.extend(layout.runs.iter().map(of));
                // Their rings have been met before.
                worker.run(layout, start, range, false, target);
            }
            worker.run(layout, start, 0..0, true, target);
        }
        let edges = c.edges();
        for h in patches.iter().flat_map(|&q| sides * q..sides * (q + 1)) {
            let (e, v) = (c.edge(h), c.origin(h));
            self.borders(c, e..e + 1, out);
            self.borders(c, edges + v..edges + v + 1, out);
            ids.extend([v..v + 1, self.layout.first_edge + e..self.layout.first_edge + e + 1]);
        }
        self.boundary(c, out, |id| ids.push(id..id + 1));
    }

    /// Cuts the patches into shares: one, unless there is much to do and the feature `parallel` is on.
    fn share(&mut self, patches: u32) {
        #[cfg(feature = "parallel")]
        let n = if patches as usize * self.faces() >= MANY { SHARES * rayon::current_num_threads() as u64 } else { 1 };
        #[cfg(not(feature = "parallel"))]
        let n = 1;
        let at = |i: u64| (u64::from(patches) * i / n) as u32;
        self.shares = (0..n).map(|i| (at(i)..at(i + 1), 0)).collect();
        self.tabled = Tabled::of(patches);
        self.workers.push(Worker::new(self.step, self.rules, &self.layout));
    }

    /// Takes on up to `most` patches of every share; says how many, or none if patches do not pay.
    fn run<C: Connectivity + Sync>(
        &mut self,
        most: u32,
        (c, tags, old): (&C, &Tags<'_>, &[Point]),
        out: &mut Out<'_>,
    ) -> Option<u32> {
        let Patches { layout, workers, shares, kept, tabled, .. } = self;
        let wholes: Vec<Range<u32>> = shares.iter().map(|(share, _)| share.clone()).collect();
        let mut targets = Target::cut(layout, &wholes, out, kept);
        let (layout, start) = (&*layout, (c, tags, old, &*tabled));
        let next = |(share, taken): &mut (Range<u32>, u32)| {
            let from = share.start + *taken;
            let to = from.saturating_add(most).min(share.end);
            *taken = to - share.start;
            from..to
        };
        #[cfg(feature = "parallel")]
        if wholes.len() > 1 {
            use rayon::prelude::*;
            let (step, rules) = (self.step, self.rules);
            let idle = std::sync::Mutex::new(std::mem::take(workers));
            let idle_now = || idle.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let work = |(share, target): (&mut (Range<u32>, u32), &mut Target<'_>)| {
                let taken = idle_now().pop();
                let mut worker = taken.unwrap_or_else(|| Worker::new(step, rules, layout));
                let range = next(share);
                // Who goes on with the share is not known: nothing may wait.
                let fit = worker.run(layout, start, range.clone(), true, target);
                // One that stopped has patches of this share waiting.
                fit.then(|| {
                    idle_now().push(worker);
                    range.len() as u32
                })
            };
            let sum = shares.par_iter_mut().zip(&mut targets).with_max_len(1).map(work).sum();
            *workers = idle.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
            return sum;
        }
        let (worker, share, target) = (workers.first_mut()?, shares.first_mut()?, targets.first_mut()?);
        let range = next(share);
        let last = range.end == share.0.end;
        worker.run(layout, start, range.clone(), last, target).then_some(range.len() as u32)
    }

    /// Puts together what patches left for edges and vertices: edges first, then vertices.
    fn borders<C: Connectivity + Sync>(&self, c: &C, range: Range<u32>, out: &mut Out<'_>) {
        let Kept { points, normals } = &self.kept;
        let (first, edges) = (self.layout.first_edge as usize, c.edges());
        let from = range.start.min(edges);
        let middle = |i: u32| c.edge_half_edge(from + i) as usize;
        let part = first + from as usize..first + range.end.min(edges) as usize;
        fill(&mut out.points[part.clone()], |i| points[middle(i)][1]);
        if !normals.is_empty() {
            fill(&mut out.normals[part], |i| normals[middle(i)][1]);
        }
        let from = range.start.max(edges) - edges;
        let part = from as usize..(range.end.max(edges) - edges) as usize;
        fill(&mut out.points[part.clone()], |i| points[c.vertex_half_edge(from + i) as usize][0]);
        if !normals.is_empty() {
            fill(&mut out.normals[part], |i| {
                let mut sum = [0.0; 3];
                c.turn(from + i, |h| (0..3).for_each(|k| sum[k] += normals[h as usize][0][k]));
                crate::refined::unit(sum)
            });
        }
    }

    /// Writes what is on boundaries and no patch owns, and names it.
    fn boundary<C: Connectivity>(&self, c: &C, out: &mut Out<'_>, mut name: impl FnMut(u32)) {
        let (layout, m) = (&self.layout, self.layout.m);
        for rims in self.workers.iter().map(Worker::rims) {
            for (i, &h) in rims.half_edges.iter().enumerate() {
                let (seam, rank) = layout.seam(c, h);
                for p in (1..m).filter(|p| *p != m / 2 && seam.own[*p] == 0) {
                    let id = seam.base[p] + seam.other[p] * rank;
                    name(id);
                    out.points[id as usize] = rims.points[i * m + p];
                    if !out.normals.is_empty() {
                        out.normals[id as usize] = rims.normals[i * m + p];
                    }
                }
            }
        }
    }
}

/// Fills a part of a buffer; threads share what is long.
#[inline(always)]
fn fill(out: &mut [Point], point: impl Fn(u32) -> Point + Sync) {
    #[cfg(feature = "parallel")]
    if out.len() >= MANY / 4 {
        use rayon::prelude::*;
        let all = out.par_iter_mut().with_min_len(MANY / 16).enumerate();
        return all.for_each(|(i, out)| *out = point(i as u32));
    }
    (0..).zip(out).for_each(|(i, out)| *out = point(i));
}
