//! From a million triangles to half-edges and the first level of Loop, in ms. `cargo bench -p limn-mesh --bench build [-- WORD]`
//!
//! ```text
//!   indexed    1 M triangles, 0.5 M vertices, as OBJ and PLY have them: no welding
//!   unshared   the same with 3 M positions of their own, as STL and flat-shaded glTF have them: exact welding
//! ```
//!
//! For every model the median of building (checks, welding, matching, half-edges), of level 1 from there (points and corner
//! indices), and of both, beside the time that reading the soup once and storing what comes out takes at the bandwidths
//! measured in the same run. One thread. Warm and fresh memory as in `refine.rs`. A word selects rows by name.

mod timing;

use limn_mesh::{Boundary, Mesh, Plan, Soup, Weld, refine, scheme};
use std::hint::black_box;
use std::sync::Arc;
use timing::{bandwidth, median};

/// A torus of `2 * around * across` triangles, row after row.
fn torus(around: u32, across: u32) -> Soup {
    let at = |i: u32, n: u32| f64::from(i % n) / f64::from(n) * std::f64::consts::TAU;
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (at(i, around), at(j, across));
            let r = 1.0 + 0.4 * v.cos();
            positions.push([(r * u.cos()) as f32, (0.4 * v.sin()) as f32, (r * u.sin()) as f32]);
        }
    }
    let vertex = |i: u32, j: u32| (i % around) * across + j % across;
    let mut faces = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Soup::from_faces(positions, &faces)
}

/// The same triangles with vertices and faces in no order: by the remainders of a product with a prime.
fn shuffled(soup: &Soup) -> Soup {
    let n = soup.positions.len();
    let place = |v: usize| (v * 2_654_435_761) % n;
    let mut positions = vec![[0.0; 3]; n];
    soup.positions.iter().enumerate().for_each(|(v, p)| positions[place(v)] = *p);
    let count = soup.face_count();
    let face = |f: usize| -> Vec<u32> {
        soup.face(f * 2_654_435_761 % count).iter().map(|&v| place(v as usize) as u32).collect()
    };
    Soup::from_faces(positions, &(0..count).map(face).collect::<Vec<_>>())
}

/// The same triangles, each with three positions of its own.
fn unshared(soup: &Soup) -> Soup {
    Soup {
        positions: soup.corners.iter().map(|&c| soup.positions[c as usize]).collect(),
        offsets: soup.offsets.clone(),
        corners: (0..soup.corners.len() as u32).collect(),
        ..Soup::default()
    }
}

fn row(name: &str, soup: &Soup, how: Weld, bytes_per_second: f64) {
    let build = || Arc::new(Mesh::build(soup, how).map(|(m, _)| m).unwrap_or_else(|e| panic!("{e}")));
    let mesh = build();
    let Some(entry) = scheme("loop") else { panic!("no Loop") };
    let plan = Plan::new(entry, Boundary::default(), 1);
    let level = |mesh: &Arc<Mesh>| refine(mesh, &plan, u64::MAX).unwrap_or_else(|e| panic!("{e}"));
    let refined = level(&mesh);
    let t = &mesh.topology;
    let words = soup.positions.len() * 3 + soup.corners.len() + soup.offsets.len() // read
        + mesh.weld_class.len() + mesh.vertex_source.len() * 5 + mesh.face_source.len() // stored: sources, positions, starts
        + t.offsets().len() + t.origins().len() * 3 + mesh.counts().edges as usize // origin, twin, edge
        + refined.points.len() * 3 + refined.faces.corners().len();
    let ms = |t: f64| t * 1e3;
    let built = ms(median(9, || drop(black_box(build()))));
    let refining = ms(median(9, || drop(black_box(level(&mesh)))));
    let both = ms(median(9, || drop(black_box(level(&build())))));
    let limit = ms(words as f64 * 4.0 / bytes_per_second);
    println!("{name:<28} {:>9} {built:>8.1} {refining:>8.1} {both:>8.1} {limit:>8.1}", soup.face_count());
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
    let bytes_per_second = bandwidth();
    println!("ms, medians of 9, one thread; plain stores {:.1} GB/s", bytes_per_second / 1e9);
    println!("{:<28} {:>9} {:>8} {:>8} {:>8} {:>8}", "model", "faces", "build", "level 1", "both", "limit");
    let ordered = torus(1000, 500);
    let lost = shuffled(&ordered);
    for (name, soup, how) in [
        ("indexed", &ordered, Weld::Off),
        ("indexed, welded", &ordered, Weld::Exact),
        ("unshared, welded", &unshared(&ordered), Weld::Exact),
        ("indexed, no order", &lost, Weld::Off),
        ("unshared, no order, welded", &unshared(&lost), Weld::Exact),
    ] {
        if name.contains(&word) {
            row(name, soup, how, bytes_per_second);
        }
    }
}
