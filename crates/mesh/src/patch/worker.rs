//! One thread's work on patches: from a ring to the runs of ids that a patch owns.
//!
//! ```text
//!   ring ─> class or spline ─> grid ─> runs of points         all in the first cache, but what is written
//!                                └──> normals ─> runs         what others share: anchors and rims (`mod.rs`)
//! ```
//!
//! Cost: `grid.rs`.

use super::class::Classes;
use super::grid::{self, Planes, Rows, Spline};
use super::layout::{Layout, Run};
use super::ring::Ring;
use super::{Anchor, Kept, Out, Point};
use crate::plan::Step;
use crate::scheme::{Rules, Tags};
use crate::topology::{Connectivity, is_boundary};
use std::ops::Range;

/// What one thread needs for itself.
#[derive(Debug)]
pub(super) struct Worker {
    classes: Classes,
    /// The kernel of regular patches, where it has a better one than a table.
    spline: Option<Spline>,
    ring: Ring,
    controls: Vec<Point>,
    points: Planes,
    normals: Planes,
    rows: Rows,
    ids: Vec<u32>,
    rims: Rims,
}

/// Sides of patches on the boundary, with their `m` points and normals.
#[derive(Debug, Default)]
pub(super) struct Rims {
    pub half_edges: Vec<u32>,
    pub points: Vec<Point>,
    pub normals: Vec<Point>,
}

/// The parts of the buffers that belong to consecutive patches.
pub(super) struct Target<'a> {
    points: Vec<&'a mut [Point]>,
    normals: Vec<&'a mut [Point]>,
    corners: Vec<&'a mut [u32]>,
    anchors: [&'a mut [Anchor]; 2],
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
    /// The parts of some ranges of patches, which rise.
    pub(super) fn cut(layout: &Layout, ranges: &[Range<u32>], out: &'a mut Out<'_>, kept: &'a mut Kept) -> Vec<Self> {
        // Run by run, and within a run range by range: that is how they lie in memory.
        let all = |runs: &[Run], times: usize| -> Vec<Range<usize>> {
            let part = |run: &Run, range: &Range<u32>| {
                let at = |q: u32| (run.base + run.per * q) as usize * times;
                at(range.start)..at(range.end)
            };
            runs.iter().flat_map(|run| ranges.iter().map(move |range| part(run, range))).collect()
        };
        let sides = || ranges.iter().map(|r| layout.sides * r.start as usize..layout.sides * r.end as usize);
        let nothing: &[Run] = &[];
        let bent_runs = if out.normals.is_empty() { nothing } else { &layout.runs };
        let face_runs = if out.corners.is_empty() { nothing } else { &layout.face_runs };
        let mut points = parts(out.points, all(&layout.runs, 1).into_iter()).into_iter();
        let mut normals = parts(out.normals, all(bent_runs, 1).into_iter()).into_iter();
        let mut corners = parts(out.corners, all(face_runs, layout.sides).into_iter()).into_iter();
        let mut bent = parts(&mut kept.normals, sides().filter(|_| !bent_runs.is_empty())).into_iter();
        let anchors = parts(&mut kept.points, sides()).into_iter();
        let target = |anchors| Target {
            points: Vec::new(),
            normals: Vec::new(),
            corners: Vec::new(),
            anchors: [anchors, bent.next().unwrap_or_default()],
        };
        let mut targets: Vec<Self> = anchors.map(target).collect();
        for i in 0..layout.runs.len() * ranges.len() {
            let target = &mut targets[i % ranges.len()];
            target.points.extend(points.next());
            target.normals.extend(normals.next());
        }
        for i in 0..face_runs.len() * ranges.len() {
            targets[i % ranges.len()].corners.extend(corners.next());
        }
        targets
    }
}

/// The level that patches start at, what its rules have to know, and its points.
pub(super) type Start<'a, C> = (&'a C, &'a Tags<'a>, &'a [Point]);

impl Worker {
    pub(super) fn new(step: Step, rules: Rules, layout: &Layout) -> Worker {
        Worker {
            classes: Classes::new(step, rules, layout),
            spline: (step.scheme.info.id == "catmull-clark").then(|| Spline::new(layout.depth)),
            ring: Ring::default(),
            controls: Vec::new(),
            points: Planes::new(layout.m),
            normals: Planes::new(layout.m),
            rows: Rows::new(),
            ids: vec![0; layout.sides * layout.m],
            rims: Rims::default(),
        }
    }

    pub(super) fn rims(&self) -> &Rims {
        &self.rims
    }

    pub(super) fn forget_rims(&mut self) {
        self.rims = Rims::default();
    }

    /// Evaluates patches; false if they do not pay.
    pub(super) fn run<C: Connectivity>(
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
                    self.rims.half_edges.push(h);
                    self.rims.points.extend(border.iter().map(|&place| self.points.point(place)));
                    if shaded {
                        self.rims.normals.extend(border.iter().map(|&place| self.normals.point(place)));
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
