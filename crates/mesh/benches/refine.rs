//! Refinement from indexed faces to what drawing needs, in ns an output face. `cargo bench -p limn-mesh [-- WORD]`
//!
//! For every model, scheme and level: the median of topology (soup to half-edges), of refinement (points and corner
//! indices; half-edges of the last level are not built), of both together, and of smooth normals, beside the time that
//! storing the same bytes takes at the bandwidth measured in the same run. One thread.
//!
//! Memory is warm: the allocator keeps what a run gives back, as it does in a browser, where wasm memory never shrinks.
//! Natively a second table shows fresh memory, where every run pays for its page faults. A word selects rows by name.

mod timing;

use limn_mesh::{Boundary, Drag, Mesh, Plan, Soup, Weld, refine, scheme, shape, triangulate_soup};
use std::hint::black_box;
use std::sync::Arc;
use timing::{bandwidth, median};

struct Table {
    word: String,
    bytes_per_second: f64,
}

impl Table {
    fn row(&self, name: &str, id: &str, soup: &Soup, level: u32) {
        if !format!("{name} {id} {level}").contains(&self.word) {
            return;
        }
        let build = || Arc::new(Mesh::build(soup, Weld::Off).map(|(m, _)| m).unwrap_or_else(|e| panic!("{e}")));
        let mesh = build();
        let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
        let plan = Plan::new(entry, Boundary::default(), level);
        let run = |mesh: &Arc<Mesh>| refine(mesh, &plan, u64::MAX).unwrap_or_else(|e| panic!("{e}"));
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
            "{name:<20} {id:<14} {level:>2} {faces:>10} {topology:>9.2} {points:>9.2} {all:>9.2} {normals:>9.2} {:>9.2}",
            ns(stored / self.bytes_per_second)
        );
    }
}

/// One vertex of the cage moved, and what depends on it evaluated again: points and normals.
fn drag(name: &str, id: &str, soup: &Soup, level: u32) {
    let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
    let mesh = Arc::new(Mesh::build(soup, Weld::Off).map(|(m, _)| m).unwrap_or_else(|e| panic!("{e}")));
    let plan = Plan::new(entry, Boundary::default(), level);
    let drag = Drag::new(mesh, &plan, u64::MAX).unwrap_or_else(|e| panic!("{e}"));
    let Some(mut drag) = drag else { panic!("{name} is not made of patches") };
    let (mut v, mut points, mut patches) = (0, 0, 0);
    let t = median(201, || {
        v = (v + 37) % drag.cage().len() as u32;
        let to = drag.cage()[v as usize].map(|x| x + 1e-3);
        let moved = drag.move_vertices(&[(v, to)]);
        points = moved.vertices.iter().map(|range| range.len()).sum::<usize>();
        patches = moved.patches;
    });
    println!("{name:<20} {id:<14} {level:>2} {points:>10} points of {patches} patches (the last) {:>9.3} ms", t * 1e3);
}

fn main() {
    let word = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    // glibc reads these when a process starts: once with memory kept, once with every large block mapped afresh.
    if cfg!(all(target_os = "linux", target_env = "gnu")) && std::env::var_os("MALLOC_MMAP_THRESHOLD_").is_none() {
        for (title, mmap, trim) in [("warm memory", "4000000000", "4000000000"), ("fresh memory", "65536", "65536")] {
            println!("\n{title}");
            let me = std::env::current_exe().unwrap_or_else(|e| panic!("{e}"));
            let status = std::process::Command::new(me)
                .args(["--", &word])
                .env("MALLOC_MMAP_THRESHOLD_", mmap)
                .env("MALLOC_TRIM_THRESHOLD_", trim)
                .status();
            assert!(status.is_ok_and(|s| s.success()));
        }
        return;
    }
    let table = Table { word, bytes_per_second: bandwidth() };
    println!("ns an output face, medians, one thread; plain stores {:.1} GB/s", table.bytes_per_second / 1e9);
    println!(
        "{:<20} {:<14} {:>2} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "model", "scheme", "L", "faces", "topology", "refine", "together", "normals", "limit"
    );
    let built = |name: &str| shape(name).map(|s| (s.build)()).unwrap_or_default();
    let quads = built("creature");
    let (triangles, _) = triangulate_soup(&quads);
    for level in 1..=5 {
        table.row("creature", "catmull-clark", &quads, level);
    }
    for level in 1..=5 {
        table.row("creature, triangles", "loop", &triangles, level);
    }
    for level in 1..=5 {
        table.row("creature", "linear", &quads, level);
    }
    for id in ["sqrt3", "j-spline", "butterfly", "modified-butterfly"] {
        table.row("creature, triangles", id, &triangles, 4);
    }
    for id in ["doo-sabin", "nurss", "kobbelt", "quad-triangle"] {
        table.row("creature", id, &quads, 4);
    }
    table.row("pawn", "loop", &built("pawn"), 6);
    table.row("torus", "catmull-clark", &built("torus"), 5);
    table.row("icosahedron", "catmull-clark", &built("icosahedron"), 8);
    table.row("grid (open)", "catmull-clark", &built("grid"), 6);
    if "drag".contains(&table.word) {
        println!("\na vertex of the cage dragged: median of 201 moves");
        for level in [5, 6] {
            drag("creature", "catmull-clark", &quads, level);
            drag("creature, triangles", "loop", &triangles, level);
        }
    }
}
