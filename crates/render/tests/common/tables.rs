//! From the kernel's meshes and plans to the plain tables that the GPU refines, and its vertices back.

use limn_mesh::refine::{Recorded, record};
use limn_mesh::sink::Source;
use limn_mesh::{Boundary, Connectivity, Decay, Faces, Mesh, Plan, Refined, TriangleRule};
use limn_render::refine::{Cage, Compute, Pass, Refiner, RowLevel, Rows, Rules, Scheme, Values};
use limn_render::{Gpu, pack};

/// Level 0 in full.
#[derive(Default)]
pub struct Tables {
    pub twin: Vec<u32>,
    pub edge: Vec<u32>,
    pub start: Vec<u32>,
    pub sharpness: Vec<f32>,
}

impl Tables {
    pub fn of(mesh: &Mesh) -> Tables {
        let t = &mesh.topology;
        let half_edges = 0..t.half_edges();
        let sharp = |h: u32| mesh.edge_sharpness[t.edge(h) as usize];
        Tables {
            twin: half_edges.clone().map(|h| t.twin(h)).collect(),
            edge: half_edges.clone().map(|h| t.edge(h)).collect(),
            start: (0..t.vertices()).map(|v| t.vertex_half_edge(v)).collect(),
            sharpness: if mesh.edge_sharpness.is_empty() { vec![] } else { half_edges.map(sharp).collect() },
        }
    }

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

/// The rules of a plan that has kernels of its own on such a mesh.
pub fn fused(mesh: &Mesh, plan: &Plan) -> Option<Rules> {
    let creased = mesh.edge_sharpness.iter().chain(&mesh.vertex_sharpness).any(|&s| s > 0.0);
    if !mesh.tied.is_empty() || !plan.later.is_empty() || !plan.fairings.is_empty() {
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

/// The plan's rows, step by step.
pub fn rows(mesh: &Mesh, plan: &Plan) -> Vec<RowLevel> {
    let mut levels: Vec<RowLevel> = Vec::new();
    record(mesh, plan, |what| match what {
        Recorded::Level(vertices) => levels.push(RowLevel { passes: Vec::new(), vertices }),
        Recorded::Row(child, weights, offset) => {
            let level = levels.last_mut().unwrap();
            let goes_on = level.passes.last().is_some_and(|pass| {
                let rows = pass.offsets.len() as u32 - 1;
                let made = pass.first..pass.first + rows;
                let reads = |(s, _): &(Source, f64)| matches!(s, Source::Child(c) if made.contains(c));
                made.end == child && !weights.iter().any(reads)
            });
            if !goes_on {
                level.passes.push(Pass { first: child, offsets: vec![0], ..Pass::default() });
            }
            let pass = level.passes.last_mut().unwrap();
            pass.entries.extend(weights.iter().map(|&(source, w)| match source {
                Source::Vertex(v) => [v, (w as f32).to_bits()],
                Source::Child(c) => [c | Pass::CHILD, (w as f32).to_bits()],
            }));
            if offset != [0.0; 3] || !pass.moves.is_empty() {
                pass.moves.resize(pass.offsets.len() - 1, [0.0; 3]);
                pass.moves.push(offset.map(|x| x as f32));
            }
            pass.offsets.push(pass.entries.len() as u32);
        }
    })
    .unwrap();
    for pass in levels.iter_mut().flat_map(|l| &mut l.passes).filter(|p| !p.moves.is_empty()) {
        pass.moves.resize(pass.offsets.len() - 1, [0.0; 3]);
    }
    levels
}

/// The faces of a level as the renderer has them.
pub fn faces(refined: &Refined) -> limn_render::Faces<'_> {
    match &refined.faces {
        Faces::Polygons { offsets, corners } => limn_render::Faces::Polygons { offsets, corners },
        Faces::Triangles(corners) => limn_render::Faces::Triangles(corners),
        Faces::Quads(corners) => limn_render::Faces::Quads(corners),
    }
}

/// What is known of the parent level's vertices.
pub fn parents(refined: &Refined) -> Option<[u32; 2]> {
    match (refined.parent_ranges, &refined.faces) {
        (Some(ranges), _) => Some(ranges),
        (None, Faces::Quads(_)) => None,
        (None, _) => Some([refined.vertex_parents; 2]),
    }
}

/// Refines by rows: points, or the mesh's colours.
pub fn by_rows(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, plan: &Plan, refined: &Refined, what: Values) -> Refiner {
    let levels = rows(mesh, plan);
    let kinds: Vec<u8> = refined.kinds.iter().map(|k| *k as u8 + 1).collect();
    let rows = Rows {
        cage: mesh.topology.vertices(),
        levels: &levels,
        faces: faces(refined),
        parents: parents(refined),
        kinds: &kinds,
    };
    run(gpu, mesh, Refiner::rows(gpu, compute, &rows, what).unwrap(), what)
}

/// Refines by kernels made for the scheme.
pub fn by_kernels(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, rules: &Rules, level: u32, what: Values) -> Refiner {
    let tables = Tables::of(mesh);
    run(gpu, mesh, Refiner::fused(gpu, compute, &tables.cage(mesh), rules, level, what).unwrap(), what)
}

fn run(gpu: &Gpu, mesh: &Mesh, mut refiner: Refiner, what: Values) -> Refiner {
    match what {
        Values::Points => refiner.set_points(gpu, 0, &mesh.positions).unwrap(),
        Values::Colors => refiner.set_values(gpu, 0, &mesh.colors).unwrap(),
    }
    refiner.refine(gpu);
    refiner
}

/// The vertices that a refiner made: points, and unit normals.
pub fn read(gpu: &Gpu, refiner: &Refiner) -> Vec<([f32; 3], [f32; 3])> {
    let vertex = |v: [u32; 4]| {
        let n = [v[3] as u16, (v[3] >> 16) as u16].map(|n| n as i16);
        ([0, 1, 2].map(|k| f32::from_bits(v[k])), pack::unpack_normal(n))
    };
    read_words(gpu, refiner).into_iter().map(vertex).collect()
}

/// The four words of every vertex that a refiner made.
pub fn read_words(gpu: &Gpu, refiner: &Refiner) -> Vec<[u32; 4]> {
    let bytes = u64::from(refiner.count()) * 16;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(refiner.vertices(), 0, &buffer, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = buffer.slice(..).get_mapped_range().unwrap();
    let word = |w: &[u8]| u32::from_le_bytes(w.try_into().unwrap());
    mapped.chunks_exact(16).map(|v| [0, 4, 8, 12].map(|i| word(&v[i..i + 4]))).collect()
}
