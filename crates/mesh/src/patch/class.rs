//! Classes of patches: what the general engine makes of a ring, as one table for all patches that have it.
//!
//! A class is a ring (`ring.rs`). One step of the scheme on the ring, recorded as rows, gives the rings of the patch's four
//! children, which are classes again; so a table of depth d is four tables of depth d - 1, each times the rows of a child:
//!
//! ```text
//!   ring ── rows of one step ──> 4 rings          table_d [points of the grid x ring]
//!    class                        classes           = children's table_(d-1) x rows
//! ```
//!
//! No rule of any scheme stands here: whoever says that its children depend on one ring (`Scheme::REACH`) has tables, with
//! rims, creases (semi-sharp ones too: a child's ring is less sharp) and any valence. Sums in f64.
//!
//! Cost: about the squared size of the ring times the points of the grid, once a class and depth. Memory: 4 bytes times the
//! ring a point, per class.

use super::grid::BLOCK;
use super::layout::{Layout, place};
use super::ring::{self, Corner, Ring};
use crate::connect::connect;
use crate::crease::Creases;
use crate::owned::Owned;
use crate::plan::Step;
use crate::scheme::{Boundary, Rules, Tags};
use crate::sink::{Cursor, Source};
use crate::split::{Level, Split};
use crate::topology::{Connectivity, Topology};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Weights of one point: (control point, weight).
type SparseRow = Vec<(u32, f64)>;

/// One of the four faces that a patch becomes.
#[derive(Debug)]
struct Child {
    class: u32,
    /// Its control points, by the parent's.
    rows: Vec<SparseRow>,
}

#[derive(Debug)]
struct Class {
    /// Whether its children were looked for.
    refined: bool,
    corners: Vec<Corner>,
    controls: u32,
    children: Vec<Child>,
    /// What lies across each side: the ends of the spokes of its two corners, or of triangles the tip. None on a boundary.
    across: Vec<Option<[u32; 2]>>,
    /// Table of each depth, as far as they are made: `controls` columns of a grid's points and strips.
    exact: Vec<Vec<f64>>,
}

/// A table as the evaluator reads it: blocks of points, each with its weights control by control.
#[derive(Debug)]
pub(super) struct Table {
    /// Which of the ring's control points count at all.
    pub active: Vec<u16>,
    /// Weight of point `block * lanes + lane` and active control k at `(block * active.len() + k) * lanes + lane`.
    pub weights: Vec<f32>,
}

/// All classes that a refinement has met.
#[derive(Debug)]
pub(super) struct Classes {
    step: Step,
    rules: Rules,
    depth: u32,
    numbers: BTreeMap<Vec<u32>, u32>,
    classes: Vec<Class>,
    /// Grids of depth 0 ..= depth.
    grids: Vec<Grid>,
    /// Tables of the last depth, by class; threads share them.
    tables: Vec<Option<Arc<Table>>>,
}

/// Where the grids and strips of the four children lie in a grid with strips ([`super::grid::room`]); [`INSIDE`] for
/// strips between them.
#[derive(Debug)]
struct Grid {
    /// Where strips begin.
    strips: usize,
    /// Values, strips included.
    points: usize,
    children: Vec<Vec<u16>>,
}

/// No place.
const INSIDE: u16 = u16::MAX;

/// The tables that all threads together have made, none for those that are being made: beyond a number they do not pay. Whether they do
/// must not depend on who met which.
#[derive(Debug, Default)]
pub(super) struct Tabled {
    most: usize,
    met: Mutex<BTreeMap<Vec<u32>, Option<Arc<Table>>>>,
}

impl Tabled {
    /// For a level of so many patches.
    pub(super) fn of(patches: u32) -> Tabled {
        Tabled { most: 24 + patches as usize / 16, met: Mutex::default() }
    }

    /// The table of the class with this key; inside none if it has to be made, none if it is one too many.
    fn ask(&self, key: &[u32]) -> Option<Option<Arc<Table>>> {
        let mut met = self.met.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(table) = met.get(key) {
            return Some(table.clone());
        }
        (met.len() < self.most).then(|| met.insert(key.to_vec(), None).flatten())
    }

    fn give(&self, key: &[u32], table: &Arc<Table>) {
        self.met.lock().unwrap_or_else(PoisonError::into_inner).insert(key.to_vec(), Some(table.clone()));
    }
}

impl Classes {
    pub(super) fn new(step: Step, rules: Rules, layout: &Layout) -> Classes {
        let grids = (0..=layout.depth).map(|d| Grid::new(layout.sides, d)).collect();
        let rules = Rules { boundary: Boundary::EdgeOnly, ..rules };
        let (numbers, classes) = Default::default();
        Classes { step, rules, depth: layout.depth, numbers, classes, grids, tables: Vec::new() }
    }

    /// The number of the class with this key, known or not.
    pub(super) fn number(&mut self, key: &[u32]) -> u32 {
        if let Some(&number) = self.numbers.get(key) {
            return number;
        }
        let number = self.classes.len() as u32;
        self.numbers.insert(key.to_vec(), number);
        let corners = ring::corners(key, self.sides());
        let (children, across, exact) = Default::default();
        self.classes.push(Class { refined: false, corners, controls: 0, children, across, exact });
        self.tables.push(None);
        number
    }

    fn sides(&self) -> usize {
        if self.step.split == Split::Quad { 4 } else { 3 }
    }

    /// Finds the children of a class, and theirs; false if the ring is none of a manifold's.
    fn refine(&mut self, number: u32) -> bool {
        let found = self.classes[number as usize].refined || self.find_children(number);
        self.classes[number as usize].refined = found;
        found
    }

    fn find_children(&mut self, number: u32) -> bool {
        // It may be a child of its own.
        self.classes[number as usize].refined = true;
        let sides = self.sides();
        let corners = self.classes[number as usize].corners.clone();
        let (faces, controls) = ring::faces(&corners);
        let across = (0..sides as u32).map(|side| {
            let ends = [(side + 1) % sides as u32, side];
            let face = faces[1..].iter().find(|face| face[..2] == ends)?;
            Some([face[2], face[face.len() - 1]])
        });
        let across = across.collect();
        let Some(t) = assemble(&faces, controls) else { return false };
        let kept: Vec<bool> = (0..controls as usize).map(|v| corners.get(v).is_some_and(|c| c.kept)).collect();
        let creases = marks(&t, &corners);
        let tags = Tags { sharp: &kept, creases: creases.as_ref(), ..Tags::new(self.rules, self.step.params) };
        let level = Level::Base(&t);
        let split = self.step.split;
        let mut rows: Vec<SparseRow> = vec![Vec::new(); split.children(&t) as usize];
        let mut take = |child: u32, row: &[(Source, f64)], _: [f64; 3]| {
            // What earlier children give is written out.
            let mut dense = vec![0.0; controls as usize];
            for &(source, w) in row {
                match source {
                    Source::Vertex(v) => dense[v as usize] += w,
                    Source::Child(c) => rows[c as usize].iter().for_each(|&(v, x)| dense[v as usize] += w * x),
                }
            }
            rows[child as usize] = (0..).zip(dense).filter(|(_, w)| *w != 0.0).collect();
        };
        self.step.scheme.rows((&level, split, tags), &mut take, &mut Cursor::default(), &mut { usize::MAX });
        let mut below = Owned::below(&level, split, creases.as_ref());
        while !below.fill(&level, &mut 0, &mut { usize::MAX }) {}
        let below = below.view();
        let creases = creases.as_ref().and_then(|c| c.below(&level, split, &below, self.rules.decay));
        let tags = Tags { creases: creases.as_ref(), ..tags };
        // The first face's children: of quads its corners', of triangles these and the one in the middle.
        let faces = match sides {
            4 => [0, 1, 2, 3],
            _ => [0, 1, 2, t.half_edges()],
        };
        let mut children = Vec::new();
        let mut ring = Ring::default();
        for face in faces {
            if !ring.read(&below, sides, face, &tags) {
                return false;
            }
            let class = self.number(&ring.key);
            if !self.refine(class) {
                return false;
            }
            let rows = ring.controls.iter().map(|&v| rows[v as usize].clone()).collect();
            children.push(Child { class, rows });
        }
        let class = &mut self.classes[number as usize];
        (class.controls, class.children, class.across) = (controls, children, across);
        true
    }

    /// Takes the table of `number`, whose key it is, or makes it, of the full depth; false if it is one too many, or its ring cannot be
    /// unfolded.
    pub(super) fn prepare(&mut self, number: u32, key: &[u32], tabled: &Tabled) -> bool {
        let Some(there) = tabled.ask(key) else { return false };
        if there.is_none() && !self.refine(number) {
            return false;
        }
        let table = there.unwrap_or_else(|| {
            self.deepen(number, self.depth as usize);
            let table = Arc::new(self.table(number));
            tabled.give(key, &table);
            table
        });
        self.tables[number as usize] = Some(table);
        true
    }

    /// The table of `number`; none if it was not prepared.
    #[inline(always)]
    pub(super) fn get(&self, number: u32) -> Option<&Table> {
        self.tables[number as usize].as_deref()
    }

    /// Makes exact tables up to a depth.
    fn deepen(&mut self, number: u32, depth: usize) {
        let at = number as usize;
        while self.classes[at].exact.len() <= depth {
            let next = self.classes[at].exact.len();
            let Some(d) = next.checked_sub(1) else {
                // The corners themselves, and what is across.
                let (sides, class, grid) = (self.sides(), &self.classes[at], &self.grids[0]);
                let mut table = vec![0.0; class.controls as usize * grid.points];
                let places: &[usize] = if sides == 4 { &[0, 1, 3, 2] } else { &[0, 1, 2] };
                (0..sides).for_each(|k| table[k * grid.points + places[k]] = 1.0);
                for (side, across) in class.across.iter().enumerate() {
                    let ends = across.unwrap_or([side, (side + 1) % sides].map(|k| k as u32));
                    for (p, control) in ends.into_iter().enumerate().take(sides - 2) {
                        table[control as usize * grid.points + grid.strips + side * 2 + p] = 1.0;
                    }
                }
                self.classes[at].exact.push(table);
                continue;
            };
            let children: Vec<u32> = self.classes[at].children.iter().map(|c| c.class).collect();
            for child in children.into_iter().filter(|&child| child != number) {
                self.deepen(child, d);
            }
            let class = &self.classes[at];
            let points = self.grids[next].points;
            let mut table = vec![0.0; class.controls as usize * points];
            let mut sums = vec![0.0; class.controls as usize * self.grids[d].points];
            for (child, places) in class.children.iter().zip(&self.grids[next].children) {
                let theirs = &self.classes[child.class as usize].exact[d];
                let n = places.len();
                sums.fill(0.0);
                for (row, column) in child.rows.iter().zip(theirs.chunks_exact(n)) {
                    for &(control, w) in row {
                        let sum = &mut sums[control as usize * n..][..n];
                        sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += w * x);
                    }
                }
                for (control, sum) in sums.chunks_exact(n).enumerate() {
                    let column = &mut table[control * points..][..points];
                    let outside = places.iter().zip(sum).filter(|(place, _)| **place != INSIDE);
                    outside.for_each(|(&place, &x)| column[usize::from(place)] = x);
                }
            }
            self.classes[at].exact.push(table);
        }
    }

    fn table(&self, number: u32) -> Table {
        let lanes = BLOCK;
        let exact = &self.classes[number as usize].exact[self.depth as usize];
        let points = self.grids[self.depth as usize].points;
        let columns: Vec<&[f64]> = exact.chunks_exact(points).collect();
        let counts = |column: &[f64]| column.iter().any(|&w| w != 0.0);
        let active: Vec<u16> = (0..).zip(&columns).filter(|(_, c)| counts(c)).map(|(k, _)| k).collect();
        let blocks = points.div_ceil(lanes);
        let mut weights = Vec::with_capacity(blocks * active.len() * lanes);
        for block in 0..blocks {
            for &k in &active {
                let column = columns[usize::from(k)];
                let of = |lane| column.get(block * lanes + lane).map_or(0.0, |&w| w as f32);
                weights.extend((0..lanes).map(of));
            }
        }
        Table { active, weights }
    }
}

impl Grid {
    fn new(sides: usize, depth: u32) -> Grid {
        let m = 1u16 << depth;
        let (w, half) = (usize::from(m) + 1, m / 2);
        let whole = |[i, j]: [u16; 2]| sides == 4 || i + j <= half;
        let inner = || (0..=half).flat_map(|j| (0..=half).map(move |i| [i, j])).filter(|&p| whole(p));
        // How a child's axes lie in the patch: its first corner, its first side's direction and the other's.
        let of = |k: usize, [a, b]: [u16; 2]| match (sides, k) {
            (_, 0) => [a, b],
            (4, 1) => [m - b, a],
            (4, 2) => [m - a, m - b],
            (4, _) => [b, m - a],
            (_, 1) => [m - a - b, a],
            (_, 2) => [b, m - a - b],
            // From the middle of the last side to that of the first, and to that of the second.
            _ => [a + b, half - a],
        };
        let count = |w: usize| if sides == 4 { w * w } else { w * (w + 1) / 2 };
        let begin = count(w);
        // The first half of a side is its corner's child's first, the other half the next one's last.
        let strip = |k: usize, side: usize, p: u16| match (k, side) {
            _ if k >= sides => INSIDE,
            (_, 0) => (begin + k * w) as u16 + p,
            (_, last) if last + 1 == sides => (begin + (k + sides - 1) % sides * w) as u16 + half + p,
            _ => INSIDE,
        };
        let of_child = |k: usize| {
            let mut places: Vec<u16> = inner().map(|p| place(sides, usize::from(m), of(k, p))).collect();
            for side in 0..sides {
                // A triangle's strip has a point less.
                places.extend((0..=half).map(|p| if sides == 3 && p == half { INSIDE } else { strip(k, side, p) }));
            }
            places
        };
        // Of triangles the child in the middle is the last.
        let children = if depth == 0 { Vec::new() } else { (0..4).map(of_child).collect() };
        Grid { strips: begin, points: begin + sides * w, children }
    }
}

/// Half-edges of a ring's faces.
fn assemble(faces: &[Vec<u32>], controls: u32) -> Option<Topology> {
    let mut offsets = vec![0];
    let mut corners = Vec::new();
    for face in faces {
        corners.extend_from_slice(face);
        offsets.push(corners.len() as u32);
    }
    if corners.iter().any(|&v| v >= controls) {
        return None;
    }
    let mut slots: Vec<u32> = (0..corners.len() as u32).collect();
    let m = connect(&offsets, &mut corners, &mut slots, controls as usize);
    let (t, class) = Topology::assemble(offsets, &corners, controls as usize, &m.mate);
    let whole = m.turned.is_empty() && m.non_manifold.is_empty() && m.one_sided.is_empty();
    (whole && class.len() == controls as usize).then_some(t)
}

/// How sharp a ring is.
fn marks(t: &Topology, corners: &[Corner]) -> Option<Creases> {
    if corners.iter().all(|corner| corner.sharpness.is_empty()) {
        return None;
    }
    let mut edges = vec![0.0; t.edges() as usize];
    ring::spokes(corners, t, &mut |h, s| edges[t.edge(h) as usize] = s);
    let vertex = |v: u32| corners.get(v as usize).and_then(|c| c.sharpness.first()).copied().unwrap_or(0.0);
    Creases::marked_by(t, |h| edges[t.edge(h) as usize], vertex, Vec::new())
}
