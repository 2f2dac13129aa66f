//! Reading files, in MB/s of the file. `cargo bench -p limn-formats [-- WORD]`
//!
//! Files of tens of megabytes are made first: a torus as programs write it. For each the median time from bytes to a
//! [`limn_formats::Model`], beside the time that reading the file once and storing the model take at the bandwidth of plain
//! stores measured in the same run. One thread, memory warm, as in a browser, where wasm memory never shrinks (natively the
//! allocator is told to keep it). A word selects rows by name.

#[path = "../../mesh/benches/timing/mod.rs"]
mod timing;

use limn_formats::{Export, ExportFaces, Limits, read, write_glb};
use std::fmt::Write;
use std::hint::black_box;
use timing::{bandwidth, median};

/// A torus of so many quads around and across: points, normals, texture coordinates, quads.
struct Torus {
    points: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    quads: Vec<[u32; 4]>,
}

fn torus(around: u32, across: u32) -> Torus {
    let mut t = Torus { points: Vec::new(), normals: Vec::new(), uvs: Vec::new(), quads: Vec::new() };
    // One row and column more than quads: the seam of the texture, as glTF has it.
    for i in 0..=around {
        for j in 0..=across {
            let (s, r) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(across));
            let (u, v) = (s * std::f64::consts::TAU, r * std::f64::consts::TAU);
            let n = [v.cos() * u.cos(), v.sin(), v.cos() * u.sin()];
            t.points.push([(u.cos() + 0.4 * n[0]) as f32, (0.4 * n[1]) as f32, (u.sin() + 0.4 * n[2]) as f32]);
            t.normals.push(n.map(|x| x as f32));
            t.uvs.push([s as f32, r as f32]);
        }
    }
    let at = |i: u32, j: u32| i * (across + 1) + j;
    for i in 0..around {
        t.quads.extend((0..across).map(|j| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]));
    }
    t
}

/// As an OBJ file: numbers with six decimals, or as short as they can be; with texture coordinates and normals or without.
fn obj(t: &Torus, six: bool, all: bool, triangles: bool) -> Vec<u8> {
    let mut out = String::from("# a torus\no torus\n");
    let line = |out: &mut String, word: &str, values: &[f32]| {
        out.push_str(word);
        for x in values {
            let written = if six { write!(out, " {x:.6}") } else { write!(out, " {x}") };
            written.unwrap_or_else(|e| panic!("{e}"));
        }
        out.push('\n');
    };
    t.points.iter().for_each(|p| line(&mut out, "v", p));
    if all {
        t.uvs.iter().for_each(|p| line(&mut out, "vt", p));
        t.normals.iter().for_each(|p| line(&mut out, "vn", p));
    }
    out.push_str("s 1\nusemtl stone\n");
    let mut face = |corners: &[u32]| {
        out.push('f');
        for c in corners.iter().map(|c| c + 1) {
            let written = if all { write!(out, " {c}/{c}/{c}") } else { write!(out, " {c}") };
            written.unwrap_or_else(|e| panic!("{e}"));
        }
        out.push('\n');
    };
    for &[a, b, c, d] in &t.quads {
        if triangles {
            face(&[a, b, c]);
            face(&[a, c, d]);
        } else {
            face(&[a, b, c, d]);
        }
    }
    out.into_bytes()
}

fn glb(t: &Torus, all: bool) -> Vec<u8> {
    let corners: Vec<u32> = t.quads.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let export = Export {
        name: "torus",
        points: &t.points,
        faces: ExportFaces::Triangles(&corners),
        normals: all.then_some(&t.normals),
        uv: all.then_some((&t.uvs, &corners)),
        ..Export::default()
    };
    write_glb(&export).unwrap_or_else(|e| panic!("{e}"))
}

fn row(name: &str, bytes: &[u8], bytes_per_second: f64) {
    let run = || read(name, bytes, &(), &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
    let (model, _) = run();
    let s = &model.soup;
    let words = s.positions.len() * 3
        + s.uvs.len() * 2
        + s.colors.len() * 4
        + s.parts.len()
        + s.offsets.len()
        + s.corners.len()
        + s.uv_corners.len()
        + s.face_groups.len()
        + s.face_materials.len();
    let t = median(if bytes.len() < 4 << 20 { 51 } else { 9 }, || drop(black_box(run())));
    let mb = bytes.len() as f64 / 1e6;
    let limit = (bytes.len() + words * 4) as f64 / bytes_per_second;
    println!("{name:<34} {mb:>7.1} {:>8.1} {:>8.0} {:>8.0}", t * 1e3, mb / t, mb / limit);
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if cfg!(all(target_os = "linux", target_env = "gnu")) && std::env::var_os("MALLOC_MMAP_THRESHOLD_").is_none() {
        // glibc reads these when a process starts.
        let me = std::env::current_exe().unwrap_or_else(|e| panic!("{e}"));
        let mut again = std::process::Command::new(me);
        again.arg("--").args(&words).env("MALLOC_MMAP_THRESHOLD_", "4000000000");
        assert!(again.env("MALLOC_TRIM_THRESHOLD_", "4000000000").status().is_ok_and(|s| s.success()));
        return;
    }
    let bytes_per_second = bandwidth();
    println!("medians, one thread; plain stores {:.1} GB/s", bytes_per_second / 1e9);
    println!("{:<34} {:>7} {:>8} {:>8} {:>8}", "file", "MB", "ms", "MB/s", "limit");
    let word = words.first().map_or("", |w| w);
    let t = torus(700, 400);
    for (name, bytes) in [
        ("quads, v vt vn, six decimals.obj", obj(&t, true, true, false)),
        ("triangles, v vt vn, shortest.obj", obj(&t, false, true, true)),
        ("quads, v, six decimals.obj", obj(&t, true, false, false)),
        ("triangles, v, shortest.obj", obj(&t, false, false, true)),
        ("positions.glb", glb(&t, false)),
        ("positions, normals, uvs.glb", glb(&torus(1200, 800), true)),
    ] {
        if name.contains(word) {
            row(name, &bytes, bytes_per_second);
        }
    }
}
