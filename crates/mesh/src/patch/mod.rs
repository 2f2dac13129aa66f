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
//!                                      recorded rows (`class.rs`)          sums of normals on borders ──> normals
//! ```
//!
//! What patches share (corners, sides) is written by one of them, or kept aside (two points a half-edge, and one sum of
//! normals a border point) until all are there: every point is stored once, so there are no cracks. The numbering is the
//! general engine's, which everything downstream goes on using; a numbering of its own (corners, edges, interiors) would
//! save half a nanosecond a point and need a second way of everything.
//!
//! Which schemes: those whose children depend on one ring ([`crate::scheme::Scheme::RING`]). Which steps: the last ones of
//! a plan, if they are at least two of one scheme and nothing happens between. Where patches have too many kinds of rings
//! (every crease of another sharpness), or a ring that cannot be unfolded, the general engine goes on from the same level.
//!
//! Cost: see `grid.rs`; about 100 ns a patch for its ring and borders. Memory beside the result: 24 bytes a half-edge of
//! the start level, 12 a point on its sides for normals, 4 bytes times the ring a point for each class.

mod class;
mod drag;
mod grid;
mod layout;
mod ring;

use crate::mesh::Mesh;
use crate::plan::{Plan, Step};
use crate::scheme::{Boundary, Rules, Tags};
use crate::split::{Level, on};
use crate::topology::{Connectivity, Counts, is_boundary};
use class::Classes;
pub use drag::{Drag, Moved};
use grid::{MOST_STEPS, Planes, Rows, Spline};
use layout::{Layout, Run};
use ring::Ring;
use std::ops::Range;

/// How deep a patch is cut at most: deeper ones would leave the caches.
pub(crate) const DEEPEST: u32 = MOST_STEPS.ilog2();

type Point = [f32; 3];

/// The level that patches start at, if the last steps of a plan can be taken at once.
pub(crate) fn start(mesh: &Mesh, plan: &Plan, steps: &[Step]) -> Option<u32> {
    let last = steps.last()?;
    // What carries colours, ties copies or leaves faces out goes level by level.
    let all_shown = mesh.holes.is_empty() && (plan.rules.boundary != Boundary::None || mesh.counts().boundary == 0);
    let plain = mesh.colors.is_empty() && mesh.tied.is_empty() && all_shown;
    if !last.scheme.ring || plan.closes() || !plain {
        return None;
    }
    let same = |step: &Step| step.scheme == last.scheme && step.params == last.params && step.split == last.split;
    let run = steps.iter().rev().take_while(|step| same(step)).count() as u32;
    let first = (plan.level - run).max(plan.level.saturating_sub(DEEPEST)).max(1);
    // Fairing happens at levels on the way.
    let first = plan.fairings.iter().filter(|f| f.iterations > 0).map(|f| f.at).fold(first, u32::max);
    (first + 2 <= plan.level).then_some(first)
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
    worker: Worker,
    kept: Kept,
    rims: Rims,
    /// The next patch, then edge, then vertex.
    next: u32,
}

/// What one thread needs for itself.
#[derive(Debug)]
struct Worker {
    classes: Classes,
    /// The kernel of regular patches, where it has a better one than a table.
    spline: Option<Spline>,
    ring: Ring,
    controls: Vec<Point>,
    points: Planes,
    normals: Planes,
    rows: Rows,
    ids: Vec<u32>,
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

/// Sides of patches on the boundary, with their `m` points and normals.
#[derive(Debug, Default)]
struct Rims {
    half_edges: Vec<u32>,
    points: Vec<Point>,
    normals: Vec<Point>,
}

/// The parts of the buffers that belong to consecutive patches.
struct Target<'a> {
    points: Vec<&'a mut [Point]>,
    normals: Vec<&'a mut [Point]>,
    corners: Vec<&'a mut [u32]>,
    anchors: [&'a mut [Anchor]; 2],
    rims: &'a mut Rims,
}

impl Patches {
    /// Prepares the patches of a level with `counts` to be cut `depth` times by `step`; none if ids leave 32 bits.
    pub(crate) fn new(step: Step, rules: Rules, depth: u32, counts: Counts) -> Option<Patches> {
        let layout = Layout::new(step.split, depth, counts)?;
        let spline = (step.scheme.info.id == "catmull-clark").then(|| Spline::new(depth));
        let m = layout.m;
        let worker = Worker {
            classes: Classes::new(step, rules, &layout),
            spline,
            ring: Ring::default(),
            controls: Vec::new(),
            points: Planes::new(m),
            normals: Planes::new(m),
            rows: Rows::new(),
            ids: vec![0; layout.sides * m],
        };
        Some(Patches { layout, worker, kept: Kept::default(), rims: Rims::default(), next: 0 })
    }

    /// Counts of the last level, and of the one before.
    pub(crate) fn counts(&self) -> [Counts; 2] {
        self.layout.counts
    }

    /// Whether normals are cheaper here than afterwards: not on small grids, where borders are most of the work.
    pub(crate) fn can_shade(&self) -> bool {
        self.layout.depth > 2
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
    fn work_on<C: Connectivity>(
        &mut self,
        c: &C,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        quota: &mut usize,
    ) -> Progress {
        let (patches, m) = (c.faces(), self.layout.m);
        if self.kept.points.is_empty() {
            if !ring::is_local(tags) {
                return Progress::Unfit;
            }
            let half_edges = c.half_edges() as usize;
            self.kept.points = bytemuck::zeroed_vec(half_edges);
            self.kept.normals = bytemuck::zeroed_vec(if out.normals.is_empty() { 0 } else { half_edges });
        }
        if self.next < patches {
            let from = self.next;
            let to = from.saturating_add((*quota / self.faces()).clamp(1, 1 << 20) as u32).min(patches);
            let Patches { layout, worker, kept, rims, .. } = self;
            let mut target = Target::cut(layout, from..to, out, (kept, rims));
            if !worker.run(layout, (c, tags, old), from..to, &mut target) {
                return Progress::Unfit;
            }
            self.next = to;
            *quota = quota.saturating_sub((to - from) as usize * self.faces());
            return Progress::More;
        }
        let all = patches + c.edges() + c.vertices();
        let from = self.next - patches;
        let to = from.saturating_add((*quota / m).clamp(1, 1 << 20) as u32).min(all - patches);
        self.borders(c, from..to, out);
        *quota = quota.saturating_sub((to - from) as usize * m);
        self.next = patches + to;
        if self.next < all {
            return Progress::More;
        }
        self.boundary(c, out);
        Progress::Done
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

    fn again_on<C: Connectivity>(
        &mut self,
        c: &C,
        tags: &Tags<'_>,
        old: &[Point],
        out: &mut Out<'_>,
        patches: &[u32],
        ids: &mut Vec<Range<u32>>,
    ) {
        let sides = self.layout.sides as u32;
        self.rims = Rims::default();
        for group in patches.chunk_by(|a, b| a + 1 == *b) {
            let range = group[0]..group[0] + group.len() as u32;
            let Patches { layout, worker, kept, rims, .. } = self;
            let mut target = Target::cut(layout, range.clone(), out, (kept, rims));
            // Their rings have been met before.
            worker.run(layout, (c, tags, old), range.clone(), &mut target);
            ids.extend(
                self.layout.runs.iter().map(|run| run.base + run.per * range.start..run.base + run.per * range.end),
            );
        }
        let edges = c.edges();
        for h in patches.iter().flat_map(|&q| sides * q..sides * (q + 1)) {
            let (e, v) = (c.edge(h), c.origin(h));
            self.borders(c, e..e + 1, out);
            self.borders(c, edges + v..edges + v + 1, out);
            ids.extend([v..v + 1, self.layout.first_edge + e..self.layout.first_edge + e + 1]);
        }
        self.boundary(c, out);
        let m = self.layout.m;
        for &h in &self.rims.half_edges {
            let (seam, rank) = self.layout.seam(c, h);
            let nobodys = (1..m).filter(|p| *p != m / 2 && seam.own[*p] == 0);
            ids.extend(nobodys.map(|p| seam.base[p] + seam.other[p] * rank).map(|id| id..id + 1));
        }
    }

    /// Puts together what patches left for edges and vertices: edges first, then vertices.
    fn borders<C: Connectivity>(&self, c: &C, range: Range<u32>, out: &mut Out<'_>) {
        let (first, kept) = (self.layout.first_edge, &self.kept);
        let edges = c.edges();
        let shaded = !kept.normals.is_empty();
        for e in range.start.min(edges)..range.end.min(edges) {
            let (h, id) = (c.edge_half_edge(e) as usize, (first + e) as usize);
            out.points[id] = kept.points[h][1];
            if shaded {
                out.normals[id] = kept.normals[h][1];
            }
        }
        for v in range.start.max(edges)..range.end.max(edges) {
            let v = v - edges;
            out.points[v as usize] = kept.points[c.vertex_half_edge(v) as usize][0];
            if shaded {
                let mut sum = [0.0; 3];
                c.turn(v, |h| (0..3).for_each(|k| sum[k] += kept.normals[h as usize][0][k]));
                out.normals[v as usize] = crate::refined::unit(sum);
            }
        }
    }

    /// Writes what is on boundaries and no patch owns.
    fn boundary<C: Connectivity>(&self, c: &C, out: &mut Out<'_>) {
        let (layout, m) = (&self.layout, self.layout.m);
        for (i, &h) in self.rims.half_edges.iter().enumerate() {
            let (seam, rank) = layout.seam(c, h);
            for p in (1..m).filter(|p| *p != m / 2 && seam.own[*p] == 0) {
                let id = (seam.base[p] + seam.other[p] * rank) as usize;
                out.points[id] = self.rims.points[i * m + p];
                if !out.normals.is_empty() {
                    out.normals[id] = self.rims.normals[i * m + p];
                }
            }
        }
    }
}

/// Cuts disjoint parts, by rising starts, out of a slice.
fn parts<T>(mut rest: &mut [T], ranges: impl Iterator<Item = Range<usize>>) -> Vec<&mut [T]> {
    let mut begin = 0;
    let mut out = Vec::new();
    for range in ranges {
        let (_, behind) = rest.split_at_mut(range.start - begin);
        let (part, behind) = behind.split_at_mut(range.len());
        out.push(part);
        (rest, begin) = (behind, range.end);
    }
    out
}

impl<'a> Target<'a> {
    fn cut(
        layout: &Layout,
        patches: Range<u32>,
        out: &'a mut Out<'_>,
        (kept, rims): (&'a mut Kept, &'a mut Rims),
    ) -> Target<'a> {
        let part = |run: &Run, times: usize| {
            let at = |q: u32| (run.base + run.per * q) as usize * times;
            at(patches.start)..at(patches.end)
        };
        let side = |q: u32| layout.sides * q as usize;
        let sides = side(patches.start)..side(patches.end);
        let wanted = |wanted: bool, runs: &'_ [Run]| if wanted { runs.to_vec() } else { Vec::new() };
        let normals = wanted(!out.normals.is_empty(), &layout.runs);
        let faces = wanted(!out.corners.is_empty(), &layout.face_runs);
        let shaded = if normals.is_empty() { 0..0 } else { sides.clone() };
        Target {
            points: parts(out.points, layout.runs.iter().map(|run| part(run, 1))),
            normals: parts(out.normals, normals.iter().map(|run| part(run, 1))),
            corners: parts(out.corners, faces.iter().map(|run| part(run, layout.sides))),
            anchors: [&mut kept.points[sides], &mut kept.normals[shaded]],
            rims,
        }
    }
}

/// The level that patches start at, what its rules have to know, and its points.
type Start<'a, C> = (&'a C, &'a Tags<'a>, &'a [Point]);

impl Worker {
    /// Evaluates patches; false if they do not pay.
    fn run<C: Connectivity>(
        &mut self,
        layout: &Layout,
        start: Start<'_, C>,
        patches: Range<u32>,
        target: &mut Target<'_>,
    ) -> bool {
        #[cfg(target_arch = "x86_64")]
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { self.run_wide(layout, start, patches, target) };
        }
        self.run_here(layout, start, patches, target)
    }

    /// The same statements, compiled for vectors of eight: the same bits, for lanes do not meet.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_wide<C: Connectivity>(
        &mut self,
        layout: &Layout,
        start: Start<'_, C>,
        patches: Range<u32>,
        target: &mut Target<'_>,
    ) -> bool {
        self.run_here(layout, start, patches, target)
    }

    #[inline(always)]
    fn run_here<C: Connectivity>(
        &mut self,
        layout: &Layout,
        (c, tags, old): Start<'_, C>,
        patches: Range<u32>,
        target: &mut Target<'_>,
    ) -> bool {
        let (sides, m) = (layout.sides, layout.m);
        let most = 24 + c.faces() as usize / 16;
        for q in patches.clone() {
            if !self.ring.read(c, sides, q, tags) || !self.evaluate(layout, old, most, !target.normals.is_empty()) {
                return false;
            }
            let i = (q - patches.start) as usize;
            for (run, part) in layout.runs.iter().zip(&mut target.points) {
                let per = run.per as usize;
                self.points.copy(layout.places_of(run), &mut part[i * per..(i + 1) * per]);
            }
            let shaded = !target.normals.is_empty();
            if shaded {
                grid::sum_normals(sides, m, &self.points, &mut self.rows, &mut self.normals);
                let sums = layout.border.chunks_exact(m).map(|side| self.normals.point(side[0]));
                target.anchors[1][sides * i..].iter_mut().zip(sums).for_each(|(anchor, sum)| anchor[0] = sum);
                let size = (sides, m, layout.points);
                grid::add_across(size, &layout.border, &self.points, &mut self.rows, &mut self.normals);
                grid::normalise(&mut self.normals, layout.points);
                for (run, part) in layout.runs.iter().zip(&mut target.normals) {
                    let per = run.per as usize;
                    self.normals.copy(layout.places_of(run), &mut part[i * per..(i + 1) * per]);
                }
            }
            for (side, border) in layout.border.chunks_exact(m).enumerate() {
                let (h, at) = (sides as u32 * q + side as u32, sides * i + side);
                target.anchors[0][at] = [self.points.point(border[0]), self.points.point(border[m / 2])];
                if shaded {
                    target.anchors[1][at][1] = self.normals.point(border[m / 2]);
                }
                if is_boundary(c.twin(h)) {
                    target.rims.half_edges.push(h);
                    target.rims.points.extend(border.iter().map(|&place| self.points.point(place)));
                    if shaded {
                        target.rims.normals.extend(border.iter().map(|&place| self.normals.point(place)));
                    }
                }
            }
            if !target.corners.is_empty() {
                self.list(layout, c, q, i, &mut target.corners);
            }
        }
        true
    }

    /// The points of the patch whose ring was read; false if there are more than `most` tables already.
    #[inline(always)]
    fn evaluate(&mut self, layout: &Layout, old: &[Point], most: usize, shaded: bool) -> bool {
        let ring = &self.ring;
        if let (true, Some(spline), Some(controls)) = (ring.key.is_empty(), &self.spline, ring.controls.first_chunk()) {
            let controls: &[u32; 16] = controls;
            spline.evaluate(layout.m, &controls.map(|v| old[v as usize]), shaded, &mut self.points);
            return true;
        }
        let Some(number) = self.classes.number(&ring.key) else { return false };
        if self.classes.get(number).is_none() {
            if self.classes.tabled() >= most {
                return false;
            }
            self.classes.prepare(number);
        }
        let Some(table) = self.classes.get(number) else { return false };
        self.controls.clear();
        self.controls.extend(table.active.iter().map(|&k| old[ring.controls[usize::from(k)] as usize]));
        let strips = if shaded { layout.sides * (layout.m + 1) } else { 0 };
        table.evaluate(&self.controls, grid::strips(layout.points) + strips, &mut self.points);
        true
    }

    /// The corners of patch `q`'s faces.
    #[inline(always)]
    fn list<C: Connectivity>(&mut self, layout: &Layout, c: &C, q: u32, i: usize, out: &mut [&mut [u32]]) {
        let (sides, m) = (layout.sides, layout.m);
        for (side, ids) in self.ids.chunks_exact_mut(m).enumerate() {
            let h = (sides as u32) * q + side as u32;
            let (seam, other) = layout.seam(c, h);
            seam.ids(q, other, ids);
            ids[0] = c.origin(h);
            ids[m / 2] = layout.first_edge + c.edge(h);
        }
        let ids = &self.ids[..];
        for ((run, part), on_border) in layout.face_runs.iter().zip(out).zip(&layout.on_border) {
            let per = run.per as usize * sides;
            let range = run.first..run.first + per;
            let part = &mut part[i * per..(i + 1) * per];
            let template = layout.faces[range.clone()].iter().zip(&layout.face_steps[range]);
            for (corner, (base, step)) in part.iter_mut().zip(template) {
                *corner = base.wrapping_add(step.wrapping_mul(q));
            }
            for &[at, slot] in on_border {
                part[usize::from(at)] = ids[usize::from(slot)];
            }
        }
    }
}
