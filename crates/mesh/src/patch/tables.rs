//! Patches as plain tables, for whoever evaluates them elsewhere: a GPU. The same rings, classes and runs of ids as here.
//!
//! A patch is evaluated on a *plate*: its grid with one row of points around it, which is what normals along its sides ask for.
//!
//! ```text
//!    .  s  s  s  s  .        a cell is (j + 1) (m + 3) + i + 1 for the point (i, j) of the grid of m steps;
//!    s  o  o  o  o  s        s are the points across sides, or on a boundary those of the side again (of triangles
//!    s  o  o  o  o  s        the tips of the faces across, on the same slanted axes)
//!    .  s  s  s  s  .
//! ```
//!
//! Cost: that of reading the rings (about 50 ns a patch) and of a table for each kind of ring. Memory: 4 bytes a control point,
//! 4 times the ring a value of each table. Limit: where the CPU takes patches as well (`start`).

use super::class::{Classes, Table, Tabled};
use super::grid::{BLOCK, Spline};
use super::layout::Layout;
use super::ring::{self, Ring};
use crate::crease::Creases;
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::plan::{Plan, Step};
use crate::refine::sharp_at;
use crate::scheme::{Reach, Tags};
use crate::split::{Level, on};
use crate::topology::{Connectivity, Counts, is_boundary};

/// The last levels of a plan as patches: faces of level `start`, each cut `depth` times.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTables {
    /// The level whose faces are patches, at least 1.
    pub start: u32,
    /// How often each is cut, 2 to 5.
    pub depth: u32,
    /// Sides of a patch: 3 or 4.
    pub sides: u32,
    /// One a face of level `start`, in order.
    pub patches: Vec<PatchRing>,
    /// The control points of all patches: vertices of level `start`.
    pub controls: Vec<u32>,
    /// What patches have that no spline makes.
    pub tables: Vec<PatchTable>,
    /// The weights of a uniform cubic B-spline's four points, at every position along an axis of the plate (m + 3): regular quads are
    /// their products. Empty where the scheme has no spline.
    pub spline: Vec<[f32; 4]>,
    /// The cell of each value of a table.
    pub cells: Vec<u16>,
    /// The points that every patch owns, by rising ids: the cell of each, and which of `runs` it is in.
    pub owned: Vec<[u16; 2]>,
    /// Point i of `owned` in run [first, per] of patch q has the id `first + i + per * q`, modulo 2^32.
    pub runs: Vec<[u32; 2]>,
    /// Points along the sides, m a side: cell, base and per. The first is the corner, a vertex of level `start`, and the one in the
    /// middle is of its edge. Of the others those with a per are nobody's where the side lies on the boundary: `base + per * rank`.
    pub border: Vec<[u32; 3]>,
    /// How many of everything there are at the last level.
    pub counts: Counts,
}

/// What a patch depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchRing {
    /// Where its control points begin in [`PatchTables::controls`], and how many these are.
    pub first: u32,
    /// How many there are; 16 of a spline's patch, in four rows along the grid's.
    pub count: u32,
    /// Which of [`PatchTables::tables`] holds; none for the spline.
    pub table: Option<u32>,
    /// Whether a side lies on the boundary.
    pub rim: bool,
}

/// What one kind of ring becomes.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTable {
    /// Control points that count.
    pub controls: u32,
    /// The weight of control k in value i at `k * cells.len() + i`.
    pub weights: Vec<f32>,
}

/// A spline's control points as rows of the plate, of those that a ring lists.
const ROWS: [usize; 16] = [5, 6, 7, 8, 4, 0, 1, 9, 15, 3, 2, 10, 14, 13, 12, 11];

impl PatchTables {
    /// The patches of a plan on a mesh; none where patches do not make its last levels, or do not pay.
    pub fn of(mesh: &Mesh, plan: &Plan) -> Option<PatchTables> {
        let steps: Vec<Step> = plan.walk(mesh).collect::<Result<_, _>>().ok()?;
        let start = super::start(mesh, plan, &steps)?;
        let step = *steps.get(start as usize)?;
        let mut counts = mesh.counts();
        let mut creases = Creases::of(mesh, &mesh.topology, plan.rules.face_varying);
        let mut held: Option<Owned> = None;
        for before in &steps[..start as usize] {
            if before.split != step.split || before.stored {
                return None;
            }
            let level = held.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
            let mut below = Owned::below(&level, step.split, creases.as_ref());
            let mut at = 0;
            while !below.fill(&level, &mut at, &mut { usize::MAX }) {}
            creases = creases.and_then(|c| c.below(&level, step.split, &below.view(), plan.rules.decay));
            counts = step.split.counts(counts)?;
            held = Some(below);
        }
        let level = held?;
        let tags = plan.tags(&step, start, sharp_at(&steps, start, mesh, &[]), creases.as_ref());
        if !ring::is_local(&tags) {
            return None;
        }
        let layout = Layout::new(step.split, plan.level - start, counts)?;
        let spline = (step.scheme.reach == Reach::Spline).then(|| Spline::new(layout.depth));
        let mut tables = PatchTables::empty(&layout, start, spline.as_ref());
        let mut classes = Classes::new(step, plan.rules, &layout);
        on!(&level.view(), c => tables.read(*c, &tags, &mut classes).then_some(tables))
    }

    /// What holds for all patches.
    fn empty(layout: &Layout, start: u32, spline: Option<&Spline>) -> PatchTables {
        let (sides, m) = (layout.sides, layout.m);
        let cells: Vec<u16> = values(sides, m).map(|(_, cell)| cell).collect();
        let cell = |place: u16| cells[usize::from(place)];
        let mut owned = Vec::new();
        let mut runs = Vec::new();
        for run in &layout.runs {
            let number = runs.len() as u16;
            runs.push([run.base.wrapping_sub(owned.len() as u32), run.per]);
            owned.extend(layout.places_of(run).iter().map(|&place| [cell(place), number]));
        }
        let border = (0..sides).flat_map(|side| {
            let rim = layout.rim(side);
            let places = &layout.border[side * m..(side + 1) * m];
            (0..).zip(places).map(move |(p, &place)| (rim, p, place))
        });
        let nobodys = |rim: &super::layout::Seam, p: usize| if rim.own[p] == 0 { rim.other[p] } else { 0 };
        let border = border.map(|(rim, p, place)| [u32::from(cell(place)), rim.base[p], nobodys(rim, p)]).collect();
        PatchTables {
            start,
            depth: layout.depth,
            sides: sides as u32,
            patches: Vec::new(),
            controls: Vec::new(),
            tables: Vec::new(),
            spline: spline.map(Spline::along).unwrap_or_default(),
            owned,
            runs,
            border,
            cells,
            counts: layout.counts[0],
        }
    }

    /// Reads the rings of all patches; false if they do not pay.
    fn read<C: Connectivity>(&mut self, c: &C, tags: &Tags<'_>, classes: &mut Classes) -> bool {
        let (sides, mut ring) = (self.sides as usize, Ring::default());
        let tabled = Tabled::of(c.faces());
        let values: Vec<usize> = values(sides, 1 << self.depth).map(|(value, _)| value).collect();
        // Of each class its table here.
        let mut numbers: Vec<Option<u32>> = Vec::new();
        for q in 0..c.faces() {
            if !ring.read(c, sides, q, tags) {
                return false;
            }
            let first = self.controls.len() as u32;
            if ring.key.is_empty() && !self.spline.is_empty() {
                self.controls.extend(ROWS.map(|k| ring.controls[k]));
                self.patches.push(PatchRing { first, count: 16, table: None, rim: false });
                continue;
            }
            let number = classes.number(&ring.key);
            if classes.get(number).is_none() && !classes.prepare(number, &ring.key, &tabled) {
                return false;
            }
            let Some(table) = classes.get(number) else { return false };
            numbers.resize(numbers.len().max(number as usize + 1), None);
            let known = &mut numbers[number as usize];
            let here = *known.get_or_insert_with(|| {
                self.tables.push(table.by_controls(&values));
                self.tables.len() as u32 - 1
            });
            self.controls.extend(table.active.iter().map(|&k| ring.controls[usize::from(k)]));
            let mut sides = sides as u32 * q..sides as u32 * (q + 1);
            let rim = sides.any(|h| is_boundary(c.twin(h)));
            self.patches.push(PatchRing { first, count: table.active.len() as u32, table: Some(here), rim });
        }
        true
    }
}

/// The values of a grid of `m` steps and the points across its sides, as a class's table has them: which number each has there, and
/// its cell.
fn values(sides: usize, m: usize) -> impl Iterator<Item = (usize, u16)> {
    let steps = m as i32;
    let end = move |j: i32| if sides == 4 { steps } else { steps - j };
    let grid = (0..=steps).flat_map(move |j| (0..=end(j)).map(move |i| [i, j]));
    // Steps along a side from its first corner on; of triangles the tip of the face across.
    let across = move |side: usize, p: i32| match (sides, side) {
        (4, 0) => [p, -1],
        (4, 1) => [steps + 1, p],
        (4, 2) => [steps - p, steps + 1],
        (4, _) => [-1, steps - p],
        (_, 0) => [p + 1, -1],
        (_, 1) => [steps - p, p + 1],
        _ => [-1, steps - p],
    };
    let points = if sides == 4 { (m + 1) * (m + 1) } else { (m + 1) * (m + 2) / 2 };
    // A triangle's strip has a point less than room.
    let strip = if sides == 4 { m + 1 } else { m };
    let strips = (0..sides).flat_map(move |side| {
        let value = move |p: usize| (points + side * (m + 1) + p, across(side, p as i32));
        (0..strip).map(value)
    });
    let cell = move |[i, j]: [i32; 2]| ((j + 1) * (steps + 3) + i + 1) as u16;
    grid.enumerate().chain(strips).map(move |(value, at)| (value, cell(at)))
}

impl Table {
    /// Some of its values, control by control.
    fn by_controls(&self, values: &[usize]) -> PatchTable {
        let n = self.active.len();
        let weight = |k: usize, i: usize| self.weights.get((i / BLOCK * n + k) * BLOCK + i % BLOCK).copied();
        let weights = (0..n).flat_map(|k| values.iter().map(move |&i| weight(k, i).unwrap_or(0.0))).collect();
        PatchTable { controls: n as u32, weights }
    }
}
