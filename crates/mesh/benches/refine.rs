//! Refinement from indexed faces to what drawing needs, ns an output face. `cargo bench -p limn-mesh`
//!
//! Prints, for every scheme and level, the medians of topology (soup to half-edges), of the refinement itself (points and
//! corner indices; half-edges of the last level are not built) and of smooth normals, beside the time it takes to store the
//! same bytes at the bandwidth measured in the same run. One thread.

use limn_mesh::{Boundary, Mesh, Plan, Soup, Weld, refine, scheme, shape, triangulate_soup};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

fn median(runs: usize, mut f: impl FnMut()) -> f64 {
    f();
    let mut t: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            f();
            start.elapsed().as_secs_f64()
        })
        .collect();
    t.sort_by(f64::total_cmp);
    t[t.len() / 2]
}

/// Bytes a second that plain stores reach on memory that has been touched.
fn bandwidth() -> f64 {
    let mut buffer = vec![0u64; 1 << 24];
    let mut k = 0;
    let t = median(7, || {
        k += 1;
        buffer.iter_mut().for_each(|x| *x = k);
        black_box(&buffer);
    });
    (buffer.len() * 8) as f64 / t
}

fn row(name: &str, id: &str, soup: &Soup, level: u32, bytes_per_second: f64) {
    let build = || Arc::new(Mesh::build(soup, Weld::Off).map(|(m, _)| m).unwrap_or_else(|e| panic!("{e}")));
    let mesh = build();
    let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
    let plan = Plan { scheme: entry, boundary: Boundary::default(), level };
    let run = |mesh: &Arc<Mesh>| refine(mesh, plan, u64::MAX).unwrap_or_else(|e| panic!("{e}"));
    let refined = run(&mesh);
    let faces = refined.faces.count() as f64;
    let runs = if faces > 1e6 { 9 } else { 21 };
    let ns = |t: f64| t * 1e9 / faces;
    let topology = ns(median(runs, || drop(black_box(build()))));
    let points = ns(median(runs, || drop(black_box(run(&mesh)))));
    let all = ns(median(runs, || drop(black_box(run(&build())))));
    let normals = ns(median(runs, || drop(black_box(refined.normals()))));
    let stored = refined.points.len() as f64 * 12.0 + refined.faces.corners().len() as f64 * 4.0;
    println!(
        "{name:<22} {id:<14} {level:>2} {faces:>10} {topology:>9.2} {points:>9.2} {all:>9.2} {normals:>9.2} {:>9.2}",
        ns(stored / bytes_per_second)
    );
}

fn main() {
    // Lets the allocator keep what the runs give back: the figures are for warm memory.
    drop(black_box(vec![1u8; 31 << 20]));
    let bytes_per_second = bandwidth();
    println!("ns an output face, medians, one thread; plain stores {:.1} GB/s", bytes_per_second / 1e9);
    println!(
        "{:<22} {:<14} {:>2} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "model", "scheme", "L", "faces", "topology", "refine", "together", "normals", "limit"
    );
    let quads = shape("creature").map(|s| (s.build)()).unwrap_or_default();
    let (triangles, _) = triangulate_soup(&quads);
    for level in 1..=5 {
        row("creature", "catmull-clark", &quads, level, bytes_per_second);
    }
    for level in 1..=5 {
        row("creature, triangles", "loop", &triangles, level, bytes_per_second);
    }
    for level in 1..=5 {
        row("creature", "linear", &quads, level, bytes_per_second);
    }
    let pawn = shape("pawn").map(|s| (s.build)()).unwrap_or_default();
    row("pawn", "loop", &pawn, 6, bytes_per_second);
    for name in ["torus", "cube", "icosahedron"] {
        let soup = shape(name).map(|s| (s.build)()).unwrap_or_default();
        row(name, "catmull-clark", &soup, if name == "torus" { 5 } else { 8 }, bytes_per_second);
    }
    let grid = shape("grid").map(|s| (s.build)()).unwrap_or_default();
    row("grid (open)", "catmull-clark", &grid, 6, bytes_per_second);
}
