//! Any scheme on the GPU, from sparse rows: the weights that `limn-mesh` records, as plain tables.
//!
//! ```text
//!   level k ── pass 0 ──► some children ── pass 1 (reads them) ──► others .. ──► level k + 1       one dispatch a pass
//! ```
//!
//! Rows depend on connectivity and marks alone, so they stay on the GPU while the cage is edited. Memory: 8 bytes a weight and 4 a
//! row; a row of a regular Catmull-Clark vertex has nine. Limits: the rows of a pass must fit one binding; polygons of the last level
//! are drawn as fans.

use super::finish::Drawn;
use super::kernels::{Kernel, Level};
use super::program::{Builder, Dispatch, Limits, Program, Role};
use super::{Error, Values, colors};
use limn_mesh::Faces;

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
}

/// A plan as rows, and the faces of its last level.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Vertices of level 0.
    pub cage: u32,
    /// Its steps.
    pub levels: &'a [RowLevel],
    /// The last level's faces.
    pub faces: &'a Faces,
    /// As in `limn_render::SurfaceData::parents`.
    pub parents: Option<[u32; 2]>,
    /// What kind each face is, as in `limn_render::SurfaceData::kind_of`; empty if none is.
    pub kinds: &'a [u8],
    /// The bits of a triangle's edges.
    pub flags: EdgeFlags,
}

/// `limn_render::corners::edge_flags`: which edges of a triangle are drawn, from its corners' numbers in their polygon and in the
/// level, the polygon's corners, and the parent level's ranges.
pub type EdgeFlags = fn([u32; 3], [u32; 3], u32, Option<[u32; 2]>) -> u32;

impl RowLevel {
    /// That every row gives a child of this level from what is there.
    fn check(&self, before: u32) -> Result<(), Error> {
        for pass in &self.passes {
            let rows = (pass.offsets.len() as u64).saturating_sub(1);
            let end = pass.offsets.last().map_or(0, |&n| n as usize);
            let expect = |what, found: u64, expected: u64| {
                if found == expected { Ok(()) } else { Err(Error::Mismatch { what, found, expected }) }
            };
            expect("weights", pass.entries.len() as u64, end as u64)?;
            if !pass.moves.is_empty() {
                expect("moves", pass.moves.len() as u64, rows)?;
            }
            if u64::from(pass.first) + rows > u64::from(self.vertices) || !pass.offsets.is_sorted() {
                return Err(Error::Mismatch {
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
                return Err(Error::Index { corner: at as u64, index, vertices: before.max(self.vertices).into() });
            }
        }
        Ok(())
    }
}

/// The faces around every vertex: where each run begins and ends, and the faces.
fn around(faces: &Faces, vertices: u32) -> Result<(Vec<u32>, Vec<u32>), Error> {
    let mut turns = vec![0u32; vertices as usize + 2];
    for (corner, &v) in (0..).zip(faces.corners()) {
        match turns.get_mut(v as usize + 2) {
            Some(n) if v < vertices => *n += 1,
            _ => return Err(Error::Index { corner, index: v, vertices: vertices.into() }),
        }
    }
    for v in 2..turns.len() {
        turns[v] += turns[v - 1];
    }
    let mut spokes = vec![0u32; faces.corners().len()];
    for f in 0..faces.count() {
        for &v in faces.face(f) {
            // Where the next of v goes; in the end every run's start has moved to its end.
            let at = &mut turns[v as usize + 1];
            if let Some(slot) = spokes.get_mut(*at as usize) {
                *slot = f as u32;
            }
            *at += 1;
        }
    }
    turns.truncate(vertices as usize + 1);
    Ok((turns, spokes))
}

/// Every triangle of the faces: three vertices, the face, and the bits of its edges ([`crate::corners`]). Polygons are fans.
fn triangles(rows: &Rows<'_>) -> Vec<[u32; 5]> {
    let mut out = Vec::new();
    for f in 0..rows.faces.count() {
        let polygon = rows.faces.face(f);
        let kind = u32::from(rows.kinds.get(f).copied().unwrap_or(0) & 3) << 6;
        for (i, pair) in polygon.windows(2).enumerate().skip(1) {
            let (&[b, c], Some(&a)) = (pair, polygon.first()) else { continue };
            let local = [0, i as u32, i as u32 + 1];
            let flags = (rows.flags)(local, [a, b, c], polygon.len() as u32, rows.parents) | kind;
            out.push([a, b, c, f as u32, flags]);
        }
    }
    out
}

/// The program that refines by rows. Cost: linear in the last level.
///
/// # Errors
/// [`Error::Mismatch`] and [`Error::Index`] for tables that do not belong together, [`Error::TooLarge`] where a buffer would
/// leave the adapter's limits.
pub fn rows(rows: &Rows<'_>, values: Values, limits: Limits) -> Result<Program, Error> {
    let mut before = rows.cage;
    for level in rows.levels {
        level.check(before)?;
        before = level.vertices;
    }
    let mut builder = Builder::new(limits);
    let cage = builder.make("cage", 16 * u64::from(rows.cage), Role::Cage)?;
    let mut each: Vec<Dispatch> = Vec::new();
    let mut points = cage;
    for (k, level) in rows.levels.iter().enumerate() {
        let role = if k + 1 == rows.levels.len() { Role::Vertices } else { Role::Work };
        let new = builder.make("the vertices", 16 * u64::from(level.vertices), role)?;
        for pass in &level.passes {
            let read = [
                builder.filled("rows", &[&pass.offsets])?,
                builder.filled("weights", &[&pass.entries])?,
                builder.filled("moves", &[&pass.moves])?,
            ];
            let end = pass.offsets.len().saturating_sub(1) as u32;
            let numbers = Level { first_face: pass.first, end, ..Level::default() };
            // Constants move points alone.
            let kernel = Kernel::Rows { moved: !pass.moves.is_empty() && values == Values::Points };
            each.extend(builder.step(kernel, &numbers, &read, &[points, new]));
        }
        points = new;
    }
    if values == Values::Colors {
        return colors(builder, (cage, rows.cage), (Vec::new(), each), (points, before));
    }
    let (turns, spokes) = around(rows.faces, before)?;
    let faces = rows.faces.count() as u32;
    let offsets: Vec<u32> = match rows.faces {
        Faces::Triangles(_) => (0..=faces).map(|f| 3 * f).collect(),
        Faces::Quads(_) => (0..=faces).map(|f| 4 * f).collect(),
        Faces::Polygons { offsets, .. } => offsets.to_vec(),
    };
    let read = [
        builder.filled("faces", &[&offsets])?,
        builder.filled("corners", &[rows.faces.corners()])?,
        builder.filled("turns", &[&turns])?,
        builder.filled("spokes", &[&spokes])?,
    ];
    let normals = builder.make("normals", 16 * u64::from(faces), Role::Work)?;
    let work = [points, normals];
    for (kernel, end) in [(Kernel::ListedFaces, faces), (Kernel::ListedNormals, before)] {
        each.extend(builder.step(kernel, &Level { end, ..Level::default() }, &read, &work));
    }
    let drawn = Drawn::listed(&mut builder, rows)?;
    if let Drawn::Corners { pieces, .. } = &drawn {
        let table = triangles(rows);
        for piece in pieces {
            let mine = table.get(piece.faces.start as usize..piece.faces.end as usize).unwrap_or(&[]);
            let mine = builder.filled("triangles", &[mine])?;
            let [a, b, c, d] = read;
            let numbers = Level { end: piece.faces.len() as u32, ..Level::default() };
            let work = [points, normals, piece.buffer];
            each.extend(builder.step(Kernel::ListedCorners, &numbers, &[a, b, c, d, mine], &work));
        }
    }
    let bounds = Some(builder.bounds(points, before, &mut each)?);
    let (once, cage_vertices) = (Vec::new(), rows.cage);
    let (shaders, buffers) = (builder.shaders(), builder.buffers);
    let (vertices, count, packed) = (points, before, None);
    Ok(Program {
        buffers,
        shaders,
        once,
        each,
        cage,
        cage_vertices,
        vertices,
        count,
        drawn,
        packed,
        bounds,
        runs: Vec::new(),
    })
}
