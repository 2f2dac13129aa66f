//! From the kernel's meshes and plans to programs: which plans have kernels of their own, and the tables of all ways.
//!
//! ```text
//!   mesh, plan ── rules ──► Rules, Tables ── fused ──► Program        one dispatch a level
//!                   └ path ──► PatchTables ── patched ──►             one dispatch for all levels but the first
//!                   └ none ── recorded ──► RowLevel .. ── rows ──►    one dispatch a pass
//! ```
//!
//! What is not made here at all says [`program`]: its caller refines on the CPU. Cost: linear in the cage.

use crate::fused::{Beside, beside};
use crate::kernels::Split;
use crate::program::{Limits, Program};
use crate::rows::{Pass, RowLevel, Tangents};
use crate::{Cage, Error, Rules, Scheme, Values, fused, patched};
use limn_mesh::refine::{Recorded, RefineError, record};
use limn_mesh::sink::Source;
use limn_mesh::{Boundary, Connectivity, Decay, FaceVarying, Mesh, PatchTables, Plan, Topology, TriangleRule};

/// Level 0 in full.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    twin: Vec<u32>,
    edge: Vec<u32>,
    start: Vec<u32>,
    sharpness: Vec<f32>,
}

impl Tables {
    /// Those of a mesh.
    pub fn of(mesh: &Mesh) -> Tables {
        let t = &mesh.topology;
        let sharp = |h: u32| mesh.edge_sharpness.get(t.edge(h) as usize).copied().unwrap_or(0.0);
        let sharpness = if mesh.edge_sharpness.is_empty() { vec![] } else { (0..t.half_edges()).map(sharp).collect() };
        Tables { sharpness, ..Tables::on(t) }
    }

    /// Those of half-edges without marks.
    fn on(t: &Topology) -> Tables {
        let half_edges = 0..t.half_edges();
        Tables {
            twin: half_edges.clone().map(|h| t.twin(h)).collect(),
            edge: half_edges.map(|h| t.edge(h)).collect(),
            start: (0..t.vertices()).map(|v| t.vertex_half_edge(v)).collect(),
            sharpness: Vec::new(),
        }
    }

    /// With what the mesh has itself.
    pub fn cage<'a>(&'a self, mesh: &'a Mesh) -> Cage<'a> {
        Cage {
            stays: &mesh.sharp,
            joined: &mesh.joined,
            vertex_sharpness: &mesh.vertex_sharpness,
            ..self.on_half_edges(&mesh.topology)
        }
    }

    fn on_half_edges<'a>(&'a self, t: &'a Topology) -> Cage<'a> {
        Cage {
            offsets: t.offsets(),
            twin: &self.twin,
            origin: t.origins(),
            edge: &self.edge,
            start: &self.start,
            sharpness: &self.sharpness,
            ..Cage::default()
        }
    }
}

/// The rules of a plan whose points have kernels of their own on such a mesh.
pub fn rules(mesh: &Mesh, plan: &Plan) -> Option<Rules> {
    let creased = mesh.edge_sharpness.iter().chain(&mesh.vertex_sharpness).any(|&s| s > 0.0);
    if !mesh.tied.is_empty() || !plan.later.is_empty() || !plan.fairings.is_empty() || plan.limit {
        return None;
    }
    let params = plan.params.of(&plan.scheme.info);
    let scheme = match plan.scheme.info.id {
        "catmull-clark" => {
            let smooth = plan.rules.triangle == TriangleRule::Smooth;
            Scheme::CatmullClark { triangle: if smooth { 0.47 } else { 0.25 } }
        }
        "linear" if mesh.is_triangles() => Scheme::Triangles,
        "linear" => Scheme::Quads,
        "loop" => Scheme::Loop { warren: params[0] == 1.0 },
        "butterfly" if !creased => Scheme::Butterfly { w: params[0] as f32 },
        "modified-butterfly" if !creased => Scheme::ModifiedButterfly,
        "sqrt3" if !creased && mesh.topology.boundary_half_edges() == 0 => Scheme::Sqrt3,
        "doo-sabin" | "doo-sabin-midpoint" if is_all_round(mesh) => {
            Scheme::DooSabin { midpoint: plan.scheme.info.id != "doo-sabin" }
        }
        _ => return None,
    };
    let corners = plan.rules.boundary == Boundary::EdgeAndCorner;
    Some(Rules { scheme, corners, chaikin: plan.rules.decay == Decay::Chaikin })
}

/// Whether a mesh is closed with three and more faces around every vertex.
fn is_all_round(mesh: &Mesh) -> bool {
    let t = &mesh.topology;
    let faces = |v: u32| {
        let mut n = 0;
        t.turn(v, |_| n += 1);
        n
    };
    t.boundary_half_edges() == 0 && (0..t.vertices()).all(|v| faces(v) >= 3)
}

/// How points are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Every level from the one before: [`fused`].
    Fused,
    /// The last levels at once: [`patched`].
    Patches,
}

/// The first level that goes by patches. By how much they were the faster when the same cage moved again (lavapipe, processor time of
/// everything but the box, a cage of 1,450 quads): Catmull-Clark 0.6 times at level 3, 1.0 at 4, 1.9 at 5, 2.5 at 6; Loop 0.6, 0.9
/// and 1.2 at level 5; linear 0.7 at 4 and 1.1 at 5. A small patch pays for the row of points around it and for waiting twice; a large
/// one writes 16 bytes a vertex where levels move some 70, and there is a quarter less memory.
const PATCHED: u32 = 5;

/// The faster of both ways to a level, where there are both.
pub fn path(level: u32) -> Path {
    if level < PATCHED { Path::Fused } else { Path::Patches }
}

/// The program of a plan by kernels made for its scheme, with texture coordinates, colours and parts. `parts` are those of the file's faces,
/// empty if there is one. None of these, which [`crate::by_rows`] makes, or the CPU:
///
/// - schemes without kernels ([`rules`]): all but Catmull-Clark, linear, Loop, both Butterflies, sqrt3, Doo-Sabin and its midpoint variant;
///   creases of both Butterflies and sqrt3; rims of sqrt3 and Doo-Sabin, and there vertices of two faces;
/// - several schemes one after the other, fairing, the limit; edges that three faces share; level 0;
/// - faces that are not shown: holes, and the rim where the boundary rule is none;
/// - of dual splits and sqrt3 texture coordinates, colours and parts; of the others parts that would take more than 1,000 draws;
/// - texture coordinates where a semi-sharp edge meets the end of a seam, or seams that stay straight beside vertices that stay.
///
/// # Errors
/// As [`fused`].
pub fn program(mesh: &Mesh, plan: &Plan, parts: &[u32], limits: Limits) -> Result<Option<Program>, Error> {
    program_by(mesh, plan, parts, limits, None)
}

/// The same by a path that is not chosen; patches only where there are some, else levels.
///
/// # Errors
/// As [`fused`].
pub fn program_by(
    mesh: &Mesh,
    plan: &Plan,
    parts: &[u32],
    limits: Limits,
    by: Option<Path>,
) -> Result<Option<Program>, Error> {
    let whole = mesh.topology.boundary_half_edges() == 0 || plan.rules.boundary != Boundary::None;
    let Some(rules) = rules(mesh, plan).filter(|_| whole && mesh.holes.is_empty() && plan.level > 0) else {
        return Ok(None);
    };
    let tables = Tables::of(mesh);
    let cage = tables.cage(mesh);
    let split = rules.scheme.split();
    if mesh.colors.is_empty() && mesh.uv.is_none() && parts.is_empty() {
        let by = by.unwrap_or_else(|| path(plan.level));
        let tables = if by == Path::Fused { None } else { PatchTables::of(mesh, plan) };
        // What patches have no room for, levels may have.
        if let Some(program) = tables.and_then(|tables| patched(&cage, &rules, &tables, limits).ok().flatten()) {
            return Ok(Some(program));
        }
        return fused(&cage, &rules, plan.level, Values::Points, limits).map(Some);
    }
    let keeps_corners = matches!(split, Split::Quad | Split::Triangle);
    if !keeps_corners || mesh.uv.is_some() && !has_kernels_for_uv(mesh, plan) {
        return Ok(None);
    }
    let Some(runs) = runs(mesh, parts, split, plan.level) else { return Ok(None) };
    let colors = (!mesh.colors.is_empty()).then(|| Beside { cage, rules, values: mesh.colors.clone() });
    let pins = mesh.pinned_uv(&plan.rules);
    let channel = mesh.uv.as_ref().map(|uv| (uv, Tables::on(&uv.topology)));
    // The mesh's own half-edges and those of texture coordinates have the same numbers.
    let own = |u: u32| mesh.topology.origin(u) as usize;
    let sharp = |start: &u32| mesh.vertex_sharpness.get(own(*start)).copied().unwrap_or(0.0);
    let uv_sharpness: Vec<f32> = channel.iter().flat_map(|(_, tables)| tables.start.iter().map(sharp)).collect();
    let linear = if split == Split::Quad { Scheme::Quads } else { Scheme::Triangles };
    let uv = channel.as_ref().map(|(uv, on)| Beside {
        cage: Cage {
            stays: &pins,
            sharpness: &tables.sharpness,
            vertex_sharpness: &uv_sharpness,
            ..on.on_half_edges(&uv.topology)
        },
        // Corners are among the pins, and no others.
        rules: Rules {
            scheme: if plan.rules.face_varying == FaceVarying::All { linear } else { rules.scheme },
            corners: false,
            ..rules
        },
        values: uv.values.iter().map(|&[u, v]| [u, v, 0.0, 0.0]).collect(),
    });
    let mut program = beside((&cage, &rules), [uv.as_ref(), colors.as_ref()], plan.level, limits)?;
    let elements = if split == Split::Quad { 6 } else { 3 };
    program.runs = runs.into_iter().map(|[part, faces]| [part, faces * elements]).collect();
    Ok(Some(program))
}

/// Whether what holds of texture coordinates is seen from their own half-edges, of a split that keeps corners.
fn has_kernels_for_uv(mesh: &Mesh, plan: &Plan) -> bool {
    match plan.rules.face_varying {
        FaceVarying::All => true,
        // Cuts between copies of a vertex are no seams.
        FaceVarying::Boundaries if mesh.sharp.contains(&true) => false,
        _ => !mesh.has_creases_beyond_seams(&plan.rules),
    }
}

/// Parts in the order of a level's faces, and how many faces each run has; none if there are too many runs to be drawn one by one.
fn runs(mesh: &Mesh, parts: &[u32], split: Split, level: u32) -> Option<Vec<[u32; 2]>> {
    /// Draws of a frame, at most.
    const MOST: usize = 1000;
    let mut runs: Vec<[u32; 2]> = Vec::new();
    if parts.is_empty() {
        return Some(runs);
    }
    fn push(runs: &mut Vec<[u32; 2]>, [part, faces]: [u32; 2]) {
        match runs.last_mut() {
            Some(last) if last[0] == part => last[1] += faces,
            _ => runs.push([part, faces]),
        }
    }
    for (f, source) in (0..).zip(&mesh.face_source) {
        let part = parts.get(*source as usize).copied().unwrap_or(0);
        // A quad split's first children are one a corner.
        let children = if split == Split::Quad { mesh.topology.face_half_edges(f).len() as u32 } else { 1 };
        push(&mut runs, [part, children]);
    }
    for _ in u32::from(split == Split::Quad)..level {
        let mut next = Vec::new();
        if split == Split::Quad {
            runs.iter().for_each(|&[part, faces]| push(&mut next, [part, 4 * faces]));
        } else {
            // Those at corners, then those in the middle.
            runs.iter().for_each(|&[part, faces]| push(&mut next, [part, 3 * faces]));
            runs.iter().for_each(|&run| push(&mut next, run));
        }
        runs = next;
        if runs.len() > MOST {
            return None;
        }
    }
    Some(runs)
}

/// The plan's rows, step by step. Cost: that of recording, some 200 ns a row.
///
/// # Errors
/// As `limn_mesh::refine::record`.
pub fn recorded(mesh: &Mesh, plan: &Plan) -> Result<Vec<RowLevel>, RefineError> {
    let mut levels: Vec<RowLevel> = Vec::new();
    record(mesh, plan, |what| match what {
        Recorded::Level(vertices) => levels.push(RowLevel { vertices, ..RowLevel::default() }),
        Recorded::Row(child, weights, offset) => {
            let Some(level) = levels.last_mut() else { return };
            let goes_on = level.passes.last().is_some_and(|pass| {
                let rows = (pass.offsets.len() as u32).saturating_sub(1);
                let made = pass.first..pass.first + rows;
                let reads = |(s, _): &(Source, f64)| matches!(s, Source::Child(c) if made.contains(c));
                made.end == child && !weights.iter().any(reads)
            });
            if !goes_on {
                level.passes.push(Pass { first: child, offsets: vec![0], ..Pass::default() });
            }
            let Some(pass) = level.passes.last_mut() else { return };
            pass.entries.extend(weights.iter().map(|&(source, w)| match source {
                Source::Vertex(v) => [v, (w as f32).to_bits()],
                Source::Child(c) => [c | Pass::CHILD, (w as f32).to_bits()],
            }));
            if offset != [0.0; 3] || !pass.moves.is_empty() {
                pass.moves.resize(pass.offsets.len().saturating_sub(1), [0.0; 3]);
                pass.moves.push(offset.map(|x| x as f32));
            }
            pass.offsets.push(pass.entries.len() as u32);
        }
        Recorded::Tangents(v, weights) => {
            let Some(level) = levels.last_mut() else { return };
            let Tangents { offsets, entries } = &mut level.tangents;
            offsets.resize(v as usize + 1, entries.len() as u32);
            entries.extend(
                weights.iter().map(|&(at, [a, b], sector)| [at, (a as f32).to_bits(), (b as f32).to_bits(), sector]),
            );
            offsets.push(entries.len() as u32);
        }
    })?;
    for pass in levels.iter_mut().flat_map(|l| &mut l.passes).filter(|p| !p.moves.is_empty()) {
        pass.moves.resize(pass.offsets.len().saturating_sub(1), [0.0; 3]);
    }
    Ok(levels)
}
