//! Any scheme on the GPU, from sparse rows: the weights that `limn-mesh` records, as plain tables.
//!
//! ```text
//!   level k ── pass 0 ──► some children ── pass 1 (reads them) ──► others .. ──► level k + 1       one dispatch a pass
//! ```
//!
//! Rows depend on connectivity and marks alone, so they stay on the GPU while the cage is edited. Memory: 8 bytes a weight and 4 a
//! row; a row of a regular Catmull-Clark vertex has nine. To make them costs the CPU 50 to 200 ns a row, several times what refining
//! does, so they pay where the cage will move. Limits: the rows of a pass must fit one binding, and [`by_rows`] makes them for a million
//! vertices at most.

use super::kernels::{Kernel, Level};
use super::program::{Builder, Dispatch, Id, Limits, Program, Role};
use super::{Error, listed, recorded};
use limn_layout::Error as Data;
use limn_mesh::plan::mean_edge;
use limn_mesh::{Connectivity, Mesh, Plan, Refined, predict, refine};
use std::sync::Arc;

/// The rows of children `first ..`, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pass {
    /// The first child.
    pub first: u32,
    /// Where the entries of each row begin, and their number at the end: one more than rows.
    pub offsets: Vec<u32>,
    /// What each weight multiplies, and the weight's bits: a vertex of the level before, or with [`Pass::CHILD`] a child that an
    /// earlier pass gave.
    pub entries: Vec<[u32; 2]>,
    /// What each row's point is moved by; empty if none is.
    pub moves: Vec<[f32; 3]>,
}

impl Pass {
    /// The bit of an entry that says that it is a child.
    pub const CHILD: u32 = 1 << 31;
}

/// The passes of one step, and how many children they give.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowLevel {
    /// In order.
    pub passes: Vec<Pass>,
    /// Vertices of the next level.
    pub vertices: u32,
    /// Where they go to the limit, their tangents there.
    pub tangents: Tangents,
}

/// Two tangents of every vertex, as weights on the points of the level before. Empty if there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tangents {
    /// Where the entries of each vertex begin, and their number at the end: one more than vertices.
    pub offsets: Vec<u32>,
    /// A vertex of the level before, the bits of its weights in both tangents, and the sector of the vertex's neighbourhood that these are
    /// of, in order of sectors.
    pub entries: Vec<[u32; 4]>,
}

/// A plan as rows, and its last level as the CPU made it: faces, and what they carry.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Level 0.
    pub mesh: &'a Mesh,
    /// Its steps.
    pub levels: &'a [RowLevel],
    /// What they make.
    pub level: &'a Refined,
    /// The parts of the file's faces, empty if there is one.
    pub parts: &'a [u32],
}

impl RowLevel {
    /// That every row gives a child of this level from what is there.
    fn check(&self, before: u32) -> Result<(), Data> {
        for pass in &self.passes {
            let rows = (pass.offsets.len() as u64).saturating_sub(1);
            let end = pass.offsets.last().map_or(0, |&n| n as usize);
            let expect = |what, found: u64, expected: u64| {
                if found == expected { Ok(()) } else { Err(Data::Mismatch { what, found, expected }) }
            };
            expect("weights", pass.entries.len() as u64, end as u64)?;
            if !pass.moves.is_empty() {
                expect("moves", pass.moves.len() as u64, rows)?;
            }
            if u64::from(pass.first) + rows > u64::from(self.vertices) || !pass.offsets.is_sorted() {
                return Err(Data::Mismatch {
                    what: "rows",
                    found: u64::from(pass.first) + rows,
                    expected: self.vertices.into(),
                });
            }
            let is_there = |[source, _]: &[u32; 2]| match source & Pass::CHILD {
                0 => *source < before,
                _ => source & !Pass::CHILD < self.vertices,
            };
            if let Some(at) = pass.entries.iter().position(|entry| !is_there(entry)) {
                let index = pass.entries.get(at).map_or(0, |e| e[0] & !Pass::CHILD);
                return Err(Data::Index { corner: at as u64, index, vertices: before.max(self.vertices).into() });
            }
        }
        let Tangents { offsets, entries } = &self.tangents;
        let found = offsets.len() as u64;
        let expected = u64::from(self.vertices) + 1;
        let ends = offsets.is_sorted() && offsets.last().is_none_or(|&n| n as usize == entries.len());
        if found > 0 && found != expected || !ends {
            return Err(Data::Mismatch { what: "tangents", found, expected });
        }
        match entries.iter().position(|entry| entry[0] >= before) {
            Some(at) => {
                let index = entries.get(at).map_or(0, |e| e[0]);
                Err(Data::Index { corner: at as u64, index, vertices: before.into() })
            }
            None => Ok(()),
        }
    }
}

/// Where the scale of constants is found: those that a rule adds are so many mean lengths of the cage's edges, wherever the cage has moved.
fn measured(builder: &mut Builder, mesh: &Mesh, cage: Id, each: &mut Vec<Dispatch>) -> Result<Id, Error> {
    let t = &mesh.topology;
    let ends = |e: u32| [t.edge_half_edge(e), t.next(t.edge_half_edge(e))].map(|h| t.origin(h));
    let edges: Vec<[u32; 2]> = (0..t.edges()).map(ends).collect();
    let edges = builder.filled("edges", &[&edges])?;
    let scale = builder.make("scale", 16, Role::Work)?;
    let numbers = Level { end: 1, rest: t.edges(), a: mean_edge(mesh) as f32, ..Level::default() };
    each.extend(builder.step(Kernel::Measure, &numbers, &[edges], &[cage, scale]));
    Ok(scale)
}

/// The program that refines by rows. Cost: linear in the last level.
///
/// # Errors
/// [`Error::Data`] for tables that do not belong together, [`Error::TooLarge`] where a buffer would
/// leave the adapter's limits.
pub fn rows(rows: &Rows<'_>, limits: Limits) -> Result<Program, Error> {
    let cage_vertices = rows.mesh.topology.vertices();
    let mut before = cage_vertices;
    for level in rows.levels {
        level.check(before)?;
        before = level.vertices;
    }
    let (found, expected) = (rows.level.points.len() as u64, before.into());
    if found != expected {
        return Err(Data::Mismatch { what: "points of the last level", found, expected }.into());
    }
    let mut builder = Builder::new(limits);
    let cage = builder.make("cage", 16 * u64::from(cage_vertices), Role::Cage)?;
    let mut each: Vec<Dispatch> = Vec::new();
    let is_moved = rows.levels.iter().flat_map(|level| &level.passes).any(|pass| !pass.moves.is_empty());
    let scale = if is_moved { Some(measured(&mut builder, rows.mesh, cage, &mut each)?) } else { None };
    let mut points = cage;
    let mut limit = None;
    for (k, level) in rows.levels.iter().enumerate() {
        let role = if k + 1 == rows.levels.len() { Role::Vertices } else { Role::Work };
        let new = builder.make("the vertices", 16 * u64::from(level.vertices), role)?;
        for pass in &level.passes {
            let mut read =
                vec![builder.filled("rows", &[&pass.offsets])?, builder.filled("weights", &[&pass.entries])?];
            let scale = scale.filter(|_| !pass.moves.is_empty());
            if scale.is_some() {
                read.push(builder.filled("moves", &[&pass.moves])?);
            }
            let end = pass.offsets.len().saturating_sub(1) as u32;
            let numbers = Level { first_face: pass.first, end, ..Level::default() };
            let kernel = Kernel::Rows { moved: scale.is_some() };
            let work: Vec<Id> = [points, new].into_iter().chain(scale).collect();
            each.extend(builder.step(kernel, &numbers, &read, &work));
        }
        if !level.tangents.offsets.is_empty() {
            let read = [
                builder.filled("tangents of vertices", &[&level.tangents.offsets])?,
                builder.filled("tangents", &[&level.tangents.entries])?,
            ];
            limit = Some((read, points));
        }
        points = new;
    }
    let (drawn, runs) = listed::drawn(&mut builder, (rows.level, rows.parts), (points, before), limit, &mut each)?;
    let bounds = Some(builder.bounds(points, before, &mut each)?);
    let once = Vec::new();
    let (shaders, buffers) = (builder.shaders(), builder.buffers);
    let (vertices, count, packed) = (points, before, None);
    Ok(Program { buffers, shaders, once, each, cage, cage_vertices, vertices, count, drawn, packed, bounds, runs })
}

/// Vertices of the last level that rows are made for, at most: a million takes 0.2 to 0.6 s, and 150 to 450 MB on the GPU.
const MOST: u64 = 1 << 20;

/// The program that makes of `mesh` by rows what the CPU makes of it, for any plan whose cage moves: with texture coordinates, colours,
/// parts, holes, ties, fairing, and several schemes. None at level 0, and for levels of more than a million vertices. Cost: that of
/// refining once on the CPU, and of [`recorded`].
///
/// # Errors
/// [`Error::Refine`] where the CPU cannot refine it either; as [`rows`].
pub fn by_rows(mesh: &Arc<Mesh>, plan: &Plan, parts: &[u32], limits: Limits) -> Result<Option<Program>, Error> {
    let fits = predict(mesh, plan)?.is_some_and(|p| p.counts.vertices <= MOST);
    if plan.level == 0 || !fits {
        return Ok(None);
    }
    let level = &refine(mesh, plan, u64::MAX)?;
    let levels = &recorded(mesh, plan)?;
    rows(&Rows { mesh, levels, level, parts }, limits).map(Some)
}
