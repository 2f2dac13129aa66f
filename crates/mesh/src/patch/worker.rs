//! One thread's work on patches: from rings to the runs of ids that patches own.
//!
//! ```text
//!   ring ─> class ─> eight of a class ─> grids ─> runs of points       all in the first caches, but what is written
//!            (waits for others)             └──> normals ─> runs       what others share: anchors and rims (`mod.rs`)
//! ```
//!
//! Patches wait until eight of their class are there. Those that are left over at the end are evaluated one by one, into lanes
//! of the same grids.
//!
//! Cost: `grid.rs`.

use super::class::{Classes, Tabled};
use super::grid::{self, Cell, LANES, Rows, Spline, cell, lanes};
use super::layout::{Layout, Run};
use super::ring::Ring;
use super::turn::{self, Eight, Turn};
use super::{Anchor, Kept, Out, Point};
use crate::plan::Step;
use crate::scheme::{Reach, Rules, Tags};
use crate::topology::{Connectivity, is_boundary};
use std::ops::Range;

/// So many of a class, if not eight, are still worked on at once.
const FEW: usize = 5;

/// What one thread needs for itself.
#[derive(Debug)]
pub(super) struct Worker {
    classes: Classes,
    ring: Ring,
    /// By class; the first are those that the spline makes.
    waiting: Vec<Waiting>,
    room: Room,
    rims: Rims,
}

/// Patches of a class, and the control points of each: control by control, a patch a lane. Numbers that were stored one by one
/// are not read as vectors here: that would wait until everything stored before is in the cache, results among it.
#[derive(Debug, Default)]
struct Waiting {
    patches: Vec<u32>,
    controls: Vec<Eight>,
}

/// The grids of eight patches.
#[derive(Debug)]
struct Room {
    /// The kernel of regular patches, where it has a better one than a table.
    spline: Option<Spline>,
    controls: Vec<Cell>,
    /// Of one patch.
    lone: Vec<Point>,
    points: Vec<Cell>,
    normals: Vec<Cell>,
    lines: Vec<Cell>,
    rows: Rows,
    /// The ids of points, place by place, of these eight patches and of those before; and of one side.
    ids: [Vec<Eight>; 2],
    side: Vec<u32>,
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
    /// The first patch.
    first: u32,
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
    /// Says that the points of a patch will be written soon: they lie in so many places that the processor cannot guess these.
    #[inline(always)]
    fn expect(&self, layout: &Layout, q: u32, turn: impl Turn) {
        let i = (q - self.first) as usize;
        for parts in [&self.points, &self.normals] {
            for (run, part) in layout.runs.iter().zip(parts) {
                turn.expect(part, i * run.per as usize, run.per as usize);
            }
        }
    }

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
        let target = |(anchors, range): (_, &Range<u32>)| Target {
            first: range.start,
            points: Vec::new(),
            normals: Vec::new(),
            corners: Vec::new(),
            anchors: [anchors, bent.next().unwrap_or_default()],
        };
        let mut targets: Vec<Self> = anchors.zip(ranges).map(target).collect();
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

/// The level that patches start at, what its rules have to know, its points, and which tables were made.
pub(super) type Start<'a, C> = (&'a C, &'a Tags<'a>, &'a [Point], &'a Tabled);

impl Worker {
    pub(super) fn new(step: Step, rules: Rules, layout: &Layout) -> Worker {
        Worker {
            classes: Classes::new(step, rules, layout),
            ring: Ring::default(),
            waiting: vec![Waiting::default()],
            room: Room {
                spline: (step.scheme.reach == Reach::Spline).then(|| Spline::new(layout.depth)),
                controls: Vec::new(),
                lone: Vec::new(),
                points: grid::room(layout.m),
                normals: grid::room(layout.m),
                lines: Vec::new(),
                rows: Rows::new(layout.m),
                ids: [0, 1].map(|_| vec![[0; LANES]; layout.points]),
                side: vec![0; layout.m],
            },
            rims: Rims::default(),
        }
    }

    pub(super) fn rims(&self) -> &Rims {
        &self.rims
    }

    pub(super) fn forget_rims(&mut self) {
        self.rims = Rims::default();
    }

    /// Takes patches on, and with `finish` leaves none waiting; false if they do not pay.
    pub(super) fn run<C: Connectivity>(
        &mut self,
        layout: &Layout,
        start: Start<'_, C>,
        patches: Range<u32>,
        finish: bool,
        target: &mut Target<'_>,
    ) -> bool {
        #[cfg(target_arch = "x86_64")]
        if let Some(wide) = turn::Wide::new() {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { self.run_wide(layout, start, patches, finish, (target, wide)) };
        }
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        return self.run_here(layout, start, patches, finish, (target, turn::Fours));
        #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
        self.run_here(layout, start, patches, finish, (target, turn::Plain))
    }

    /// The same statements, compiled for vectors of eight: the same bits, for lanes do not meet.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_wide<C: Connectivity>(
        &mut self,
        layout: &Layout,
        start: Start<'_, C>,
        patches: Range<u32>,
        finish: bool,
        out: (&mut Target<'_>, turn::Wide),
    ) -> bool {
        self.run_here(layout, start, patches, finish, out)
    }

    #[inline(always)]
    fn run_here<C: Connectivity>(
        &mut self,
        layout: &Layout,
        (c, tags, old, tabled): Start<'_, C>,
        patches: Range<u32>,
        finish: bool,
        (target, turn): (&mut Target<'_>, impl Turn),
    ) -> bool {
        let Worker { classes, ring, waiting, room, rims } = self;
        let shaded = !target.normals.is_empty();
        if !target.corners.is_empty() {
            room.list(layout, c, patches.clone(), (target, turn));
        }
        let mut next = patches.start;
        // Which classes have been emptied of groups, and of lone patches.
        let (mut emptied, mut cleared) = (0, 0);
        let mut group = Vec::with_capacity(LANES);
        // Reading goes on until a group is full or all is read: the arithmetic stands here once.
        loop {
            let mut ready = None;
            while ready.is_none() && next < patches.end {
                if !ring.read(c, layout.sides, next, tags) {
                    return false;
                }
                let Some(class) = room.class_of(classes, ring, waiting, tabled) else { return false };
                waiting[class].add(next, ring, room.active(classes, class));
                target.expect(layout, next, turn);
                ready = (waiting[class].patches.len() == LANES).then_some(class);
                next += 1;
            }
            while ready.is_none() && finish && emptied < waiting.len() {
                let enough = if room.is_spline(emptied) { 1 } else { FEW };
                ready = (waiting[emptied].patches.len() >= enough).then_some(emptied);
                emptied += 1;
            }
            group.clear();
            if let Some(class) = ready {
                room.evaluate(layout, classes, class, &waiting[class], old, shaded);
                group.append(&mut waiting[class].patches);
            }
            while ready.is_none() && finish && group.len() < LANES && cleared < waiting.len() {
                let Waiting { patches, controls } = &mut waiting[cleared];
                let Some(q) = patches.pop() else {
                    cleared += 1;
                    continue;
                };
                let from = patches.len();
                room.lone.clear();
                room.lone.extend(controls.iter().map(|control| old[control[from] as usize]));
                room.evaluate_one(layout, classes, cleared, (group.len(), shaded));
                group.push(q);
            }
            if group.is_empty() {
                return true;
            }
            room.hand_out(layout, c, &group, rims, (target, turn));
        }
    }
}

impl Waiting {
    #[inline(always)]
    fn add(&mut self, q: u32, ring: &Ring, active: Option<&[u16]>) {
        let lane = self.patches.len();
        self.patches.push(q);
        self.controls.resize(active.map_or(ring.controls.len(), <[u16]>::len), [0; LANES]);
        match active {
            Some(active) => {
                for (control, &k) in self.controls.iter_mut().zip(active) {
                    control[lane] = ring.controls[usize::from(k)];
                }
            }
            None => {
                for (control, &v) in self.controls.iter_mut().zip(&ring.controls) {
                    control[lane] = v;
                }
            }
        }
    }
}

impl Room {
    fn is_spline(&self, class: usize) -> bool {
        class == 0 && self.spline.is_some()
    }

    /// Where patches with this ring wait; none if there are too many tables already.
    #[inline(always)]
    fn class_of(
        &self,
        classes: &mut Classes,
        ring: &Ring,
        waiting: &mut Vec<Waiting>,
        tabled: &Tabled,
    ) -> Option<usize> {
        if ring.key.is_empty() && self.spline.is_some() {
            return Some(0);
        }
        let number = classes.number(&ring.key);
        if classes.get(number).is_none() && !classes.prepare(number, &ring.key, tabled) {
            return None;
        }
        let class = number as usize + 1;
        if waiting.len() <= class {
            waiting.resize_with(class + 1, Waiting::default);
        }
        Some(class)
    }

    /// Which of a class's control points count; none if all.
    #[inline(always)]
    fn active<'a>(&self, classes: &'a Classes, class: usize) -> Option<&'a [u16]> {
        classes.get((class as u32).checked_sub(1)?).map(|table| &table.active[..])
    }

    /// How many points are wanted of a table.
    #[inline(always)]
    fn count(layout: &Layout, shaded: bool) -> usize {
        layout.points + if shaded { layout.sides * (layout.m + 1) } else { 0 }
    }

    /// The points of a class's patches. Lanes without one have the last one's.
    #[inline(always)]
    fn evaluate(
        &mut self,
        layout: &Layout,
        classes: &Classes,
        class: usize,
        group: &Waiting,
        old: &[Point],
        shaded: bool,
    ) {
        self.controls.clear();
        let last = group.patches.len().clamp(1, LANES) - 1;
        for control in &group.controls {
            let at = |lane: usize| old[control[lane.min(last)] as usize];
            let p = lanes!(L => at(L));
            self.controls.push(cell!(K, L => p[L][K]));
        }
        if let (0, Some(spline)) = (class, &self.spline) {
            spline.evaluate(layout.m, &self.controls, shaded, &mut self.lines, &mut self.points);
        } else if let Some(table) = classes.get(class as u32 - 1) {
            table.evaluate(&self.controls, &mut self.points[..Room::count(layout, shaded)]);
        }
    }

    /// The points of a lone patch, in a lane.
    #[inline(always)]
    fn evaluate_one(&mut self, layout: &Layout, classes: &Classes, class: usize, (lane, shaded): (usize, bool)) {
        if let Some(table) = classes.get(class as u32 - 1) {
            table.evaluate_one(&self.lone, lane, &mut self.points[..Room::count(layout, shaded)]);
        }
    }

    /// Writes what patches own, one in each lane, and keeps what they share.
    #[inline(always)]
    fn hand_out<C: Connectivity>(
        &mut self,
        layout: &Layout,
        c: &C,
        patches: &[u32],
        rims: &mut Rims,
        (target, turn): (&mut Target<'_>, impl Turn),
    ) {
        let (sides, m) = (layout.sides, layout.m);
        let shaded = !target.normals.is_empty();
        let first = target.first;
        deal(layout, &self.points, patches, first, &mut target.points, turn);
        if shaded {
            let size = (sides, m, layout.points);
            grid::shade(size, &layout.border, &self.points, &mut self.rows, &mut self.normals);
            deal(layout, &self.normals, patches, first, &mut target.normals, turn);
        }
        for (lane, &q) in patches.iter().enumerate() {
            let i = (q - first) as usize;
            let point = |place: u16| self.points[usize::from(place)].point(lane);
            let normal = |place: u16| self.normals[usize::from(place)].point(lane);
            for (side, border) in layout.border.chunks_exact(m).enumerate() {
                let (h, at) = (sides as u32 * q + side as u32, sides * i + side);
                target.anchors[0][at] = [point(border[0]), point(border[m / 2])];
                if shaded {
                    target.anchors[1][at] = [normal(border[0]), normal(border[m / 2])];
                }
                if is_boundary(c.twin(h)) {
                    rims.half_edges.push(h);
                    rims.points.extend(border.iter().map(|&place| point(place)));
                    if shaded {
                        rims.normals.extend(border.iter().map(|&place| normal(place)));
                    }
                }
            }
        }
    }

    /// The corners of patches' faces: eight patches after eight, whatever their classes, so that runs are written from end to end.
    #[inline(always)]
    fn list<C: Connectivity>(
        &mut self,
        layout: &Layout,
        c: &C,
        patches: Range<u32>,
        (target, turn): (&mut Target<'_>, impl Turn),
    ) {
        let mut group = patches.start..patches.start;
        while group.start < patches.end {
            let before = group.clone();
            group = before.end..patches.end.min(before.end + LANES as u32);
            // Long before they are read, see [`Waiting`].
            self.ids.swap(0, 1);
            self.number(layout, c, group.clone());
            for (run, part) in layout.face_runs.iter().zip(&target.corners) {
                let per = run.per as usize * layout.sides;
                turn.expect(part, (group.start - target.first) as usize * per, group.len() * per);
            }
            let lanes: Eight = std::array::from_fn(|l| before.start + l as u32);
            for (run, part) in layout.face_runs.iter().zip(&mut target.corners).filter(|_| !before.is_empty()) {
                let (places, per) = (&layout.faces[run.first..], run.per as usize * layout.sides);
                let run = turn::Run { places, per, patches: &lanes[..before.len()], first: target.first };
                turn.ids(&run, &self.ids[1], part);
            }
        }
    }

    /// The ids of the points of up to eight consecutive patches.
    #[inline(always)]
    fn number<C: Connectivity>(&mut self, layout: &Layout, c: &C, patches: Range<u32>) {
        let (sides, m, ids) = (layout.sides as u32, layout.m, &mut self.ids[0]);
        let lanes: Eight = std::array::from_fn(|l| patches.start + l as u32);
        for (ids, &[base, per]) in ids.iter_mut().zip(&layout.ids) {
            for l in 0..LANES {
                ids[l] = base.wrapping_add(per.wrapping_mul(lanes[l]));
            }
        }
        for (lane, q) in patches.enumerate() {
            for (h, border) in (sides * q..).zip(layout.border.chunks_exact(m)) {
                let (seam, other) = layout.seam(c, h);
                seam.ids(q, other, &mut self.side);
                self.side[0] = c.origin(h);
                self.side[m / 2] = layout.first_edge + c.edge(h);
                for (&id, &place) in self.side.iter().zip(border) {
                    ids[usize::from(place)][lane] = id;
                }
            }
        }
    }
}

/// Writes the points that patches own, one in each lane.
#[inline(always)]
fn deal(layout: &Layout, cells: &[Cell], patches: &[u32], first: u32, out: &mut [&mut [Point]], turn: impl Turn) {
    for (run, part) in layout.runs.iter().zip(out) {
        let (places, per) = (&layout.places[run.first..], run.per as usize);
        turn.points(&turn::Run { places, per, patches, first }, cells, part);
    }
}
