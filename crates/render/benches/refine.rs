//! Refinement on the GPU beside the copy bandwidth of the same adapter in the same run. `cargo bench -p limn-render [-- WORD [FACES]]`
//!
//! For every model, scheme and level, by levels and by patches where there are both: the first time (half-edges, points, normals,
//! indices), and what new positions of the cage cost from then on (points and normals), in milliseconds and in ns an output face; before
//! them what it takes the CPU to put the program together, and the memory. Kernels are compiled before anything is timed.
//!
//! ```text
//!   moved    the least bytes that new positions read and write: points and half-edges of every level once, points and normals
//!            of the next once; neighbours are found in caches at best. Corners (72 bytes a triangle, written each time where faces
//!            do not share vertices) are not counted: such rows look worse than their points are. Of patches the points of level 1 and
//!            the rings once, points and normals of the last level once
//!   share    of the copy bandwidth: moved / time, over what a copy of one large buffer reads and writes in its time
//! ```
//!
//! Each figure is the best of five runs of as many repeats as take a tenth of a second, waited for at the end of a run: timestamps
//! of browsers are too coarse, and a wait costs more than a small level. A word selects rows; FACES (6,500,000) is the largest level.

#[path = "../tests/common/tables.rs"]
#[allow(dead_code)]
mod tables;

use limn_compute::{Path, program_by, rules};
use limn_mesh::{Boundary, Mesh, PatchTables, Plan, Soup, Weld, refine, scheme, shape, triangulate_soup};
use limn_render::refine::{Compute, Refiner, limits};
use limn_render::{Gpu, Tier};
use std::time::Instant;

/// The best time of one of `f`, in seconds.
fn best(gpu: &Gpu, mut f: impl FnMut()) -> f64 {
    let wait = || drop(gpu.device.poll(wgpu::PollType::wait_indefinitely()));
    let mut run = |repeats: u32| {
        let start = Instant::now();
        (0..repeats).for_each(|_| f());
        wait();
        start.elapsed().as_secs_f64() / f64::from(repeats)
    };
    let once = run(1).min(run(1));
    let repeats = (0.1 / once).clamp(1.0, 1000.0) as u32;
    (0..5).map(|_| run(repeats)).fold(f64::MAX, f64::min)
}

/// Bytes a second that a copy reads and writes together.
fn bandwidth(gpu: &Gpu) -> f64 {
    let bytes = (256u64 << 20).min(gpu.max_buffer());
    let make = |usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false })
    };
    let (from, to) = (make(wgpu::BufferUsages::COPY_SRC), make(wgpu::BufferUsages::COPY_DST));
    let copy = || {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&from, 0, &to, 0, bytes);
        gpu.queue.submit([encoder.finish()]);
    };
    2.0 * bytes as f64 / best(gpu, copy)
}

/// The least bytes that refining `mesh` by `plan` again moves.
fn moved(mesh: &Mesh, plan: &Plan) -> f64 {
    let counts =
        |level| limn_mesh::predict(mesh, &plan.to(level)).ok().flatten().map_or_else(Default::default, |p| p.counts);
    let read = |level| 20.0 * counts(level).vertices as f64 + 8.0 * counts(level).corners as f64;
    let points = |level: u32| read(level) + 16.0 * counts(level + 1).vertices as f64;
    let all: f64 = (0..plan.level).map(points).sum();
    let normals = 20.0 * counts(plan.level).vertices as f64 + read(plan.level - 1);
    all + normals
}

/// The same of patches.
fn moved_by_patches(mesh: &Mesh, plan: &Plan, tables: &PatchTables) -> f64 {
    let first = limn_mesh::predict(mesh, &plan.to(tables.start)).ok().flatten().map_or(0, |p| p.counts.vertices);
    let rings = 16 * tables.patches.len() + 4 * tables.controls.len();
    32.0 * first as f64 + rings as f64 + 16.0 * tables.counts.vertices as f64
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let word = words.first().cloned().unwrap_or_default();
    let most: u64 = words.get(1).and_then(|n| n.parse().ok()).unwrap_or(6_500_000);
    let instance = Gpu::instance(Tier::Native);
    let gpu = match pollster::block_on(Gpu::new(&instance, None, Tier::Native)) {
        Ok(gpu) => gpu,
        Err(e) => return println!("{e}"),
    };
    let copy = bandwidth(&gpu);
    let info = gpu.adapter.get_info();
    println!(
        "{} ({:?}, {}); a copy moves {:.1} GB/s, read and written together",
        info.name,
        info.device_type,
        info.driver_info,
        copy / 1e9
    );
    println!(
        "{:44} {:>10} {:>7} {:>9} {:>9} {:>9} {:>8} {:>8} {:>6}",
        "model, scheme, level, path", "faces", "MB", "CPU ms", "first ms", "again ms", "ns/face", "GB/s", "share"
    );
    let creature = (shape("creature").expect("a built-in").build)();
    let triangles = triangulate_soup(&creature).0;
    let plans: [(&str, &Soup, &[&str]); 2] = [
        ("creature", &creature, &["catmull-clark", "linear", "doo-sabin"]),
        ("creature in triangles", &triangles, &["loop", "butterfly", "modified-butterfly", "sqrt3"]),
    ];
    let mut compute = Compute::default();
    for (name, soup, ids) in plans {
        let mesh = std::sync::Arc::new(Mesh::build(soup, Weld::Off).expect("a mesh").0);
        for (id, level) in ids.iter().flat_map(|id| (1..=7).map(move |level| (*id, level))) {
            let plan = Plan::new(scheme(id).expect("a scheme"), Boundary::default(), level);
            let Ok(Some(predicted)) = limn_mesh::predict(&mesh, &plan) else { continue };
            let faces = predicted.counts.faces;
            let has_rules = rules(&mesh, &plan).is_some();
            let patches = PatchTables::of(&mesh, &plan).filter(|_| has_rules);
            for path in [Path::Fused, Path::Patches] {
                let kind = if has_rules { format!("{path:?}").to_lowercase() } else { "rows".to_owned() };
                let row = format!("{name}, {id}, {level}, {kind}");
                // Rows are recorded on the CPU first, which takes minutes for millions of faces.
                let many = !has_rules && faces > 500_000;
                if !row.contains(&word) || faces > most || many || (path == Path::Patches && patches.is_none()) {
                    continue;
                }
                let refined = if has_rules { None } else { refine(&mesh, &plan, u64::MAX).ok() };
                let mut put_together = 0.0;
                let mut make = || match &refined {
                    Some(refined) => Ok(tables::by_rows(&gpu, &mut compute, &mesh, &plan, refined)),
                    None => {
                        let start = Instant::now();
                        let program = program_by(&mesh, &plan, &[], limits(&gpu), Some(path));
                        put_together = start.elapsed().as_secs_f64();
                        let program = program.map_err(|e| e.to_string())?.ok_or("it cannot be refined")?;
                        Refiner::new(&gpu, &mut compute, &program).map_err(|e| e.to_string())
                    }
                };
                // Compiles, too.
                drop(make().map(|mut r| r.refine(&gpu)));
                let wait = || drop(gpu.device.poll(wgpu::PollType::wait_indefinitely()));
                wait();
                let mut refiner = match make() {
                    Ok(refiner) => refiner,
                    Err(e) => {
                        println!("{row:44} {faces:>10} {e}");
                        continue;
                    }
                };
                refiner.set_points(&gpu, 0, &mesh.positions).expect("as many points as vertices");
                wait();
                let start = Instant::now();
                refiner.refine(&gpu);
                wait();
                let first = start.elapsed().as_secs_f64();
                let again = best(&gpu, || refiner.refine(&gpu));
                let moved = match (path, &patches) {
                    (Path::Patches, Some(tables)) => moved_by_patches(&mesh, &plan, tables),
                    _ => moved(&mesh, &plan),
                };
                let rate = moved / again;
                let (rate, share) = match has_rules {
                    true => (format!("{:.1}", rate / 1e9), format!("{:.0}%", 100.0 * rate / copy)),
                    false => ("rows".to_owned(), String::new()),
                };
                println!(
                    "{row:44} {faces:>10} {:>7.1} {:>9.3} {:>9.3} {:>9.3} {:>8.3} {rate:>8} {share:>6}",
                    refiner.bytes() as f64 / 1e6,
                    put_together * 1e3,
                    first * 1e3,
                    again * 1e3,
                    again * 1e9 / faces as f64
                );
            }
        }
    }
    gpu.take_errors().iter().for_each(|e| println!("{e}"));
}
