//! From the kernel's meshes and plans to refiners, and their vertices back.

use limn_compute::{Program, Rows, Rules, Tables, Values, fused, recorded};
use limn_mesh::{Faces, Mesh, Plan, Refined};
use limn_render::refine::{Compute, Refiner, limits};
use limn_render::{Gpu, pack};

/// The faces of a level as the renderer has them.
pub fn faces(refined: &Refined) -> limn_render::Faces<'_> {
    match &refined.faces {
        Faces::Polygons { offsets, corners } => limn_render::Faces::Polygons { offsets, corners },
        Faces::Triangles(corners) => limn_render::Faces::Triangles(corners),
        Faces::Quads(corners) => limn_render::Faces::Quads(corners),
    }
}

/// Refines by rows.
pub fn by_rows(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, plan: &Plan, refined: &Refined) -> Refiner {
    let levels = recorded(mesh, plan).unwrap();
    let rows = Rows { mesh, levels: &levels, level: refined, parts: &[] };
    run(gpu, compute, mesh, limn_compute::rows(&rows, limits(gpu)).unwrap(), Values::Points)
}

/// Refines by kernels made for the scheme.
pub fn by_kernels(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, rules: &Rules, level: u32, what: Values) -> Refiner {
    let tables = Tables::of(mesh);
    run(gpu, compute, mesh, fused(&tables.cage(mesh), rules, level, what, limits(gpu)).unwrap(), what)
}

fn run(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, program: Program, what: Values) -> Refiner {
    let mut refiner = Refiner::new(gpu, compute, &program).unwrap();
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

/// The box that a refiner found around its points.
pub fn read_bounds(gpu: &Gpu, refiner: &Refiner) -> Option<[[f32; 3]; 2]> {
    let words = words(gpu, refiner.bounds()?, 24);
    limn_compute::bounds(words.try_into().ok()?)
}

/// The four words of every vertex that a refiner made.
pub fn read_words(gpu: &Gpu, refiner: &Refiner) -> Vec<[u32; 4]> {
    words(gpu, refiner.vertices(), u64::from(refiner.count()) * 16).as_chunks().0.to_vec()
}

fn words(gpu: &Gpu, from: &wgpu::Buffer, bytes: u64) -> Vec<u32> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(from, 0, &buffer, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let mapped = buffer.slice(..).get_mapped_range().unwrap();
    bytemuck::cast_slice(&mapped).to_vec()
}
