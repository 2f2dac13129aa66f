//! The patch kernel: all points of the last levels in one dispatch, with no level between.
//!
//! ```text
//!   level 0 ── fused ──► level 1 ── patches ──────────────► level L         a team of invocations a patch; points and normals
//!              gather       └───── half-edges ── climb ──► faces, and normals of level 1's vertices
//! ```
//!
//! The GPU's twin of `limn-mesh`'s `patch/`, from whose tables it is put together ([`PatchTables`]): the same rings, classes and runs
//! of ids. Each point is stored once, in 16 bytes with its normal; nothing else grows with the level but the faces. Those need
//! the half-edges of level L - 1, which are not built: twin and origin are found by climbing to level 1's (`climb.wgsl`).
//!
//! Cost, bytes a face of level L: 16 written for points and normals, and once 24 for indices. Memory besides: of a face of level 1
//! some 150 bytes, and the tables of rings that are no spline's (4 bytes times the ring a value). Limits: rings of up to
//! [`MOST_CONTROLS`] points, 16 KB of workgroup memory; what carries colours or texture coordinates goes level by level.

use crate::cage::Size;
use crate::fused::{Chain, drawn, level};
use crate::kernels::{Kernel, Level, Split, Variant};
use crate::program::{Builder, Dispatch, Limits, Program, Role};
use crate::{Cage, Error, Rules};
use limn_mesh::PatchTables;

/// Control points that a ring may have, as long as plate and ring fit in workgroup memory: around one vertex of valence 46.
const MOST_CONTROLS: u32 = 100;

/// How a workgroup is shared among patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Team {
    sides: u32,
    /// Steps along a side.
    m: u32,
    /// Invocations a patch.
    size: u32,
    /// Patches a workgroup.
    pub teams: u32,
}

impl Team {
    /// That of patches cut `depth` times: large enough that all of a patch's points are made in as few rounds as they can be, in
    /// multiples of eight.
    pub(crate) fn new(split: Split, depth: u32) -> Team {
        let sides = if split == Split::Triangle { 3 } else { 4 };
        let (size, teams) = match (sides, depth) {
            (4, 0..=2) => (24, 4),
            (4, 3) => (72, 3),
            (4, 4) => (136, 1),
            (4, _) => (208, 1),
            (_, 0..=2) => (16, 4),
            (_, 3) => (40, 4),
            (_, 4) => (136, 1),
            _ => (176, 1),
        };
        Team { sides, m: 1 << depth, size, teams }
    }

    /// Values of a table: the grid's, and those across its sides.
    fn values(self) -> u32 {
        let Team { sides, m, .. } = self;
        if sides == 4 { (m + 1) * (m + 5) } else { (m + 1) * (m + 2) / 2 + 3 * m }
    }

    /// What stands before the kernel's text.
    pub(crate) fn constants(self) -> String {
        let Team { m, size, teams, .. } = self;
        let w = m + 3;
        format!(
            "const M = {m}u;\nconst W = {w}u;\nconst FOURS = {}u;\nconst TEAM = {size}u;\nconst TEAMS = {teams}u;\n\
             const GROUP_SIZE = {}u;\nconst CONTROLS = {}u;\nconst PLATES = {}u;\n",
            self.values().div_ceil(4),
            size * teams,
            MOST_CONTROLS * teams,
            3 * w * w * teams,
        )
    }

    /// Bytes of workgroup memory.
    #[cfg(test)]
    fn bytes(self) -> u32 {
        self.teams * (16 * MOST_CONTROLS + 12 * (self.m + 3) * (self.m + 3))
    }
}

/// The program that refines `cage` by `rules` to where `tables` end; none if a ring is too large.
///
/// # Errors
/// As [`crate::fused`].
pub fn patched(cage: &Cage<'_>, rules: &Rules, tables: &PatchTables, limits: Limits) -> Result<Option<Program>, Error> {
    let split = rules.scheme.split();
    let sides = if split == Split::Triangle { 3 } else { 4 };
    if tables.patches.iter().any(|ring| ring.count > MOST_CONTROLS) || tables.sides != sides {
        return Ok(None);
    }
    let mut builder = Builder::new(limits);
    let (mut once, mut each): (Vec<Dispatch>, Vec<Dispatch>) = Default::default();
    let vertices = cage.start.len() as u32;
    let id = builder.make("cage", 16 * u64::from(vertices), Role::Cage)?;
    let to = (tables.start, true);
    let first = Chain::walk(&mut builder, (cage, id), rules, to, Role::Work, (&mut once, &mut each))?;

    // The sizes of the levels that are passed over.
    let faces = u64::from(first.numbers.faces);
    let mut sizes = vec![Size {
        half_edges: first.numbers.half_edges.into(),
        vertices: first.count.into(),
        faces,
        edges: first.next.vertices - u64::from(first.count) - if sides == 4 { faces } else { 0 },
    }];
    for k in 0..tables.depth as usize {
        let next = sizes.get(k).map_or_else(Default::default, |s| s.split(split));
        sizes.push(next);
    }
    let [.., before, parent, last] = sizes[..] else { return Ok(None) };
    let count = last.vertices as u32;

    let [half_edges, starts, ..] = first.read;
    let rings = builder.filled("patches", &[&rings(tables)])?;
    let lists = builder.filled("control points", &[&lists(tables), &tables.controls])?;
    let weights = builder.filled("weights of patches", &[&weights(tables)])?;
    let points = builder.make("the vertices", 16 * last.vertices, Role::Vertices)?;
    let variant = Variant { split, base: false, creased: false, scheme: 0 };
    let all = Level { end: tables.patches.len() as u32, ..first.numbers };
    let read = [half_edges, starts, rings, lists, weights];
    let kernel = Kernel::Patches(variant, tables.depth);
    each.extend(builder.step(kernel, &all, &read, &[first.values, points]));

    let climbs = tables.depth - 1;
    let numbers = Level {
        step: climbs,
        rest: (2 * parent.edges - parent.half_edges) as u32,
        ..level(rules, 0, tables.start + climbs, parent, before)
    };
    let climbs = Some(first.count);
    let chain = Chain { numbers, next: last, values: points, count, climbs, ..first };
    drawn(builder, (id, vertices), &chain, [None, None], (once, each)).map(Some)
}

/// `struct Patch` of the kernel.
fn rings(tables: &PatchTables) -> Vec<[u32; 4]> {
    // Tables stand behind the spline.
    let mut begin = before_tables(tables) as u32;
    let mut begins = Vec::with_capacity(tables.tables.len());
    for table in &tables.tables {
        begins.push(begin);
        begin += table.controls * fours(tables) as u32;
    }
    let weights = |table: Option<u32>| table.and_then(|t| begins.get(t as usize).copied()).unwrap_or(0);
    let rims = tables.border.iter().filter(|[.., per]| *per > 0).count() as u32;
    let all = tables.owned.len() as u32 + 2 * tables.sides;
    let points = |rim: bool| if rim { all + rims } else { all };
    tables.patches.iter().map(|ring| [ring.first, ring.count, weights(ring.table), points(ring.rim)]).collect()
}

/// Fours of a table's row.
fn fours(tables: &PatchTables) -> usize {
    tables.cells.len().div_ceil(4)
}

/// Fours before the first table: 0 is none.
fn before_tables(tables: &PatchTables) -> usize {
    tables.spline.len().max(1)
}

fn weights(tables: &PatchTables) -> Vec<[f32; 4]> {
    let mut out = tables.spline.clone();
    out.resize(before_tables(tables), [0.0; 4]);
    for row in tables.tables.iter().flat_map(|table| table.weights.chunks_exact(tables.cells.len())) {
        let (whole, rest) = row.as_chunks::<4>();
        out.extend_from_slice(whole);
        if !rest.is_empty() {
            out.push([0, 1, 2, 3].map(|i| rest.get(i).copied().unwrap_or(0.0)));
        }
    }
    out
}

/// Where each list begins, then the lists: cells, owned, runs, border; control points come behind. Of the border first the corners and
/// middles of sides (0 and 1 for what they are), then what may be nobody's.
fn lists(tables: &PatchTables) -> Vec<u32> {
    // Values that fill up fours go to the first cell, which nobody reads.
    let mut cells: Vec<u32> = tables.cells.iter().map(|&cell| cell.into()).collect();
    cells.resize(4 * fours(tables), 0);
    let owned = tables.owned.iter().map(|&[cell, run]| u32::from(cell) | u32::from(run) << 16);
    let m = 1 << tables.depth;
    let sides = || (0..).zip(tables.border.chunks_exact(m));
    let of_side = |side: u32, cell: u32| cell | side << 16;
    let ends = sides().flat_map(|(side, points)| {
        [(0, points[0][0]), (1, points[m / 2][0])].map(|(kind, cell)| [of_side(side, cell), kind, 0])
    });
    let rims = sides()
        .flat_map(|(side, points)| points.iter().map(move |&[cell, base, per]| [of_side(side, cell), base, per]));
    let border: Vec<[u32; 3]> = ends.chain(rims.filter(|[.., per]| *per > 0)).collect();
    let lists: [Vec<u32>; 4] = [cells, owned.collect(), tables.runs.as_flattened().to_vec(), border.into_flattened()];
    let mut begin = 1 + lists.len() as u32;
    let mut out = vec![begin];
    for list in &lists {
        begin += list.len() as u32;
        out.push(begin);
    }
    out.extend(lists.concat());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What every WebGPU device has.
    #[test]
    fn a_workgroup_takes_what_is_always_there() {
        for (split, depth) in [Split::Quad, Split::Triangle].into_iter().flat_map(|s| (2..=5).map(move |d| (s, d))) {
            let team = Team::new(split, depth);
            assert!(team.bytes() <= 16_384, "{team:?}: {} bytes", team.bytes());
            assert!(team.size * team.teams <= 256, "{team:?}");
            assert!(team.size > team.m + 3, "{team:?}: no team has a whole row");
        }
    }
}
