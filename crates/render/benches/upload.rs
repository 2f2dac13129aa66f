//! What the CPU does between a level and its picture, natively. `cargo bench -p limn-render`
//!
//! **Packing**: surfaces of shared quads, whole, in slices as the engine makes them: bounds, normals and indices into
//! scratch memory, and from there into the queue's. In ns a face (a face has about one point), beside what storing the same
//! 40 bytes twice takes at the bandwidth of plain stores measured in the same run.
//!
//! **A frame**: recording and submitting one of an orbit, in µs. Nothing in it may grow with the faces.
//!
//! Draws with whatever Vulkan there is; a driver in software takes other cores for what it rasterises.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../../mesh/benches/timing/mod.rs"]
mod timing;

use glam::Vec3;
use limn_render::{Faces, Gpu, Renderer, Style, SurfaceData, Tier, wgpu};
use std::hint::black_box;
use std::time::Instant;
use timing::{bandwidth, middle};

/// The slice that the engine takes between two looks at the clock.
const SLICE: usize = 16 << 10;

/// A square of n x n quads bent to a bowl, split once: points, normals, quads, and where face and edge points begin.
struct Bowl {
    points: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    quads: Vec<u32>,
    parents: [u32; 2],
}

fn bowl(n: u32) -> Bowl {
    let place = |x: f32, y: f32| {
        let p = Vec3::new(x, x * x + y * y, y);
        (p.to_array(), Vec3::new(-2.0 * x, 1.0, -2.0 * y).normalize().to_array())
    };
    let at = |i: u32, half: f32| (i as f32 + half) / n as f32 * 2.0 - 1.0;
    let grid =
        |w: u32, h: u32, x: f32, y: f32| (0..h).flat_map(move |j| (0..w).map(move |i| place(at(i, x), at(j, y))));
    let faces = (n + 1) * (n + 1);
    let [across, down] = [faces + n * n, faces + n * n + n * (n + 1)];
    let (points, normals) = grid(n + 1, n + 1, 0.0, 0.0)
        .chain(grid(n, n, 0.5, 0.5))
        .chain(grid(n, n + 1, 0.5, 0.0))
        .chain(grid(n + 1, n, 0.0, 0.5))
        .unzip();
    let quads = (0..n * n).flat_map(|f| {
        let (i, j) = (f % n, f / n);
        let old = |i: u32, j: u32| j * (n + 1) + i;
        let corners = [old(i, j), old(i + 1, j), old(i + 1, j + 1), old(i, j + 1)];
        let [bottom, top] = [across + j * n + i, across + (j + 1) * n + i];
        let [left, right] = [down + j * (n + 1) + i, down + j * (n + 1) + i + 1];
        let edges = [bottom, right, top, left];
        (0..4).flat_map(move |k| [corners[k], edges[k], faces + f, edges[(k + 3) % 4]])
    });
    Bowl { points, normals, quads: quads.collect(), parents: [faces, across] }
}

fn main() {
    let instance = Gpu::instance(Tier::Native);
    let Ok(gpu) = pollster::block_on(Gpu::new(&instance, None, Tier::Native)) else {
        println!("no Vulkan here: nothing is measured");
        return;
    };
    println!("{}", gpu.describe());
    let mut renderer = Renderer::new(gpu, wgpu::TextureFormat::Rgba8Unorm);
    let bytes_per_second = bandwidth();
    println!("medians, one thread; plain stores {:.1} GB/s", bytes_per_second / 1e9);
    println!("{:>9} {:>10} {:>10} {:>10} {:>12}", "faces", "points", "indices", "limit", "frame");
    for n in [71, 620, 708] {
        let bowl = bowl(n);
        let mut data = SurfaceData::new(&bowl.points, &bowl.normals, Faces::Quads(&bowl.quads));
        data.parents = Some(bowl.parents);
        let faces = data.faces.count() as f64;
        let upload = |indices: bool| {
            let mut upload = renderer.upload(&data).unwrap_or_else(|e| panic!("{e}"));
            let slices = bowl.points.len().div_ceil(SLICE);
            let mut step = || upload.step(renderer.gpu(), &data, SLICE).unwrap_or_else(|e| panic!("{e}"));
            let start = Instant::now();
            (0..slices).for_each(|_| _ = step());
            let half = start.elapsed().as_secs_f64();
            while !step() {}
            let all = start.elapsed().as_secs_f64();
            drop(black_box(upload.finish()));
            // What was written is handed over and forgotten before the next run.
            renderer.gpu().queue.submit(std::iter::empty());
            let _ = renderer.gpu().device.poll(wgpu::PollType::wait_indefinitely());
            if indices { all - half } else { half }
        };
        let [points, indices] = [false, true].map(|indices| middle(9, || upload(indices)) * 1e9 / faces);
        renderer.set_surface(&data).unwrap_or_else(|e| panic!("{e}"));
        let limit = 40.0 * 2.0 / bytes_per_second * 1e9;
        let frame = frame(&mut renderer) * 1e6;
        println!("{faces:>9} {points:>7.2} ns {indices:>7.2} ns {limit:>7.2} ns {frame:>9.1} µs");
    }
}

/// Seconds of the CPU for one frame of an orbit; waiting for the picture is not counted.
fn frame(renderer: &mut Renderer) -> f64 {
    let size = [64, 64];
    let texture = renderer.gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let mut turn = 0.0f32;
    middle(9, || {
        turn += 0.1;
        let eye = [3.0 * turn.cos(), 2.0, 3.0 * turn.sin()];
        let camera = common::perspective(eye, [0.0; 3], 1.0, 2.0);
        let frame = common::frame(camera, Style::dark());
        let start = Instant::now();
        renderer.draw(&view, size, &frame).unwrap_or_else(|e| panic!("{e}"));
        let spent = start.elapsed().as_secs_f64();
        let _ = renderer.gpu().device.poll(wgpu::PollType::wait_indefinitely());
        spent
    })
}
