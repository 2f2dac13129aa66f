//! From the kernel's meshes and plans to programs: which plans have kernels of their own, and the tables of both ways.
//!
//! ```text
//!   mesh, plan ── rules ──► Rules, Tables ── fused ──► Program        one dispatch a level
//!                   └ none ── recorded ──► RowLevel .. ── rows ──►    one dispatch a pass
//! ```
//!
//! What is not made here at all says [`program`]: its caller refines on the CPU. Cost: linear in the cage.

use crate::program::{Limits, Program};
use crate::rows::{Pass, RowLevel};
use crate::{Cage, Error, Rules, Scheme, Values, fused};
use limn_mesh::refine::{Recorded, RefineError, record};
use limn_mesh::sink::Source;
use limn_mesh::{Boundary, Connectivity, Decay, Mesh, Plan, TriangleRule};

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
        let half_edges = 0..t.half_edges();
        let sharp = |h: u32| mesh.edge_sharpness.get(t.edge(h) as usize).copied().unwrap_or(0.0);
        Tables {
            twin: half_edges.clone().map(|h| t.twin(h)).collect(),
            edge: half_edges.clone().map(|h| t.edge(h)).collect(),
            start: (0..t.vertices()).map(|v| t.vertex_half_edge(v)).collect(),
            sharpness: if mesh.edge_sharpness.is_empty() { vec![] } else { half_edges.map(sharp).collect() },
        }
    }

    /// With what the mesh has itself.
    pub fn cage<'a>(&'a self, mesh: &'a Mesh) -> Cage<'a> {
        Cage {
            offsets: mesh.topology.offsets(),
            twin: &self.twin,
            origin: mesh.topology.origins(),
            edge: &self.edge,
            start: &self.start,
            stays: &mesh.sharp,
            joined: &mesh.joined,
            sharpness: &self.sharpness,
            vertex_sharpness: &mesh.vertex_sharpness,
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

/// The program of a plan that is shown as a whole: none where the CPU has to do it, because the scheme has no kernels of its own on
/// such a mesh, or for what is not drawn of points alone (colours, texture coordinates, hidden faces, limits).
///
/// # Errors
/// As [`fused`].
pub fn program(mesh: &Mesh, plan: &Plan, limits: Limits) -> Result<Option<Program>, Error> {
    let bare = mesh.colors.is_empty() && mesh.uv.is_none() && mesh.holes.is_empty();
    let whole = mesh.topology.boundary_half_edges() == 0 || plan.rules.boundary != Boundary::None;
    match rules(mesh, plan).filter(|_| bare && whole && plan.level > 0) {
        Some(rules) => {
            let tables = Tables::of(mesh);
            fused(&tables.cage(mesh), &rules, plan.level, Values::Points, limits).map(Some)
        }
        None => Ok(None),
    }
}

/// The plan's rows, step by step. Cost: that of recording, some 200 ns a row.
///
/// # Errors
/// As `limn_mesh::refine::record`.
pub fn recorded(mesh: &Mesh, plan: &Plan) -> Result<Vec<RowLevel>, RefineError> {
    let mut levels: Vec<RowLevel> = Vec::new();
    record(mesh, plan, |what| match what {
        Recorded::Level(vertices) => levels.push(RowLevel { passes: Vec::new(), vertices }),
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
    })?;
    for pass in levels.iter_mut().flat_map(|l| &mut l.passes).filter(|p| !p.moves.is_empty()) {
        pass.moves.resize(pass.offsets.len().saturating_sub(1), [0.0; 3]);
    }
    Ok(levels)
}
