//! Limn beside every other Rust crate for subdivision, in one table. `cargo xtask bench [WORD] [--fresh]`
//!
//! ```text
//!   indexed faces ─ Mesh::build ─> half-edges ─ refine ─> points and faces of level L
//!                  '───────────── all ───────────────'
//!                                '── refine ─'                      in ns a face of level L, one thread
//! ```
//!
//! A row runs Limn and the peers in turns, so that whatever else the machine does meets all of them; figures are medians of
//! the time that the thread computed, and `best` is Limn's shortest run of `all`: where the two are far apart the machine
//! was busy. `limit` is what storing the same points and corners takes at the bandwidth of plain stores measured at the
//! start. Before anything is timed every peer's points and faces are held against Limn's; a peer that differs has no figure,
//! and the run fails at its end. Where a crate is known to have another rule under the same name a star says so, and counts
//! alone are compared.
//!
//! Memory is warm (the allocator keeps what a run gives back) unless `--fresh` asks for pages that are mapped anew.
//! Limit: crates only; no program in another language is run.

mod meshes;
mod peers;
mod same;

use limn_mesh::{Boundary, Faces, Mesh, Plan, Refined, Soup, Weld, refine, scheme, shape, triangulate_soup};
use peers::{Differs, Input, Peer};
use same::Surface;
use std::hint::black_box;
use std::sync::Arc;

/// How far apart points of equal work may lie, in units of meshes that are two to three units in size.
const TOLERANCE: f64 = 1e-5;
/// By how many per cent creases may add to a face's time.
const MORE_FOR_CREASES: f64 = 30.0;
/// What a face may take, in ns: by scheme.
const BUDGETS: [(&str, f64); 7] = [
    ("catmull-clark", 28.0),
    ("loop", 28.0),
    ("linear", 28.0),
    ("sqrt3", 28.0),
    ("doo-sabin", 40.0),
    ("butterfly", 40.0),
    ("modified-butterfly", 40.0),
];

/// Seconds that this thread computed, which other programs on the machine do not count into; elsewhere seconds that passed.
#[cfg(unix)]
fn clock() -> f64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes the one structure that it is given.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
fn clock() -> f64 {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed().as_secs_f64()
}

fn seconds(run: impl FnOnce()) -> f64 {
    let start = clock();
    run();
    clock() - start
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Bytes a second that plain stores reach on memory that has been touched.
fn bandwidth() -> f64 {
    let mut buffer = vec![0u64; 1 << 23];
    let mut times: Vec<f64> = (1..=12)
        .map(|k| {
            seconds(|| {
                buffer.iter_mut().for_each(|x| *x = k);
                black_box(&buffer);
            })
        })
        .collect();
    (buffer.len() * 8) as f64 / median(&mut times[1..])
}

fn build(soup: &Soup) -> Arc<Mesh> {
    Arc::new(Mesh::build(soup, Weld::Off).map(|(mesh, _)| mesh).unwrap_or_else(|e| panic!("{e}")))
}

fn run(mesh: &Arc<Mesh>, plan: &Plan) -> Refined {
    refine(mesh, plan, u64::MAX).unwrap_or_else(|e| panic!("{e}"))
}

fn surface(refined: &Refined) -> Surface {
    let f = &refined.faces;
    let counts = match f {
        Faces::Triangles(_) => vec![3; f.count()],
        Faces::Quads(_) => vec![4; f.count()],
        Faces::Polygons { offsets, .. } => offsets.windows(2).map(|w| w[1] - w[0]).collect(),
    };
    Surface { points: refined.points.clone(), counts, corners: f.corners().to_vec() }
}

struct Table {
    word: String,
    bytes_per_second: f64,
    missed: Vec<String>,
    /// Peers whose result is another, a sentence each: they have no figure.
    differ: Vec<String>,
}

impl Table {
    /// A row with creases and one without, and what they add.
    fn creases(&mut self, id: &str, name: &str, smooth: &Soup, creases: Vec<([u32; 2], f32)>, level: u32) {
        let mut creased = smooth.clone();
        creased.marks.creases = creases;
        let before = self.row(id, name, smooth, level);
        let named = format!("{name}, creases");
        if !self.selects(id, &named, level) {
            return;
        }
        let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
        let one = Plan::new(entry, Boundary::default(), 1);
        if run(&build(smooth), &one).points == run(&build(&creased), &one).points {
            println!("{id:<19}{named:<26}{level:>2} {:>9}  not measured: this scheme does not honour creases", "");
            return;
        }
        let after = self.row(id, &named, &creased, level);
        if let (Some(before), Some(after)) = (before, after) {
            let more = (after / before - 1.0) * 100.0;
            println!("{:>48}creases add {more:.0}% (at most {MORE_FOR_CREASES:.0}%)", "");
            if more > MORE_FOR_CREASES {
                self.missed.push(format!("creases of {id} on {name}: {more:.0}% more"));
            }
        }
    }

    fn selects(&self, id: &str, name: &str, level: u32) -> bool {
        format!("{id} {name} {level}").contains(&self.word)
    }

    /// Prints a row, and returns Limn's ns a face.
    fn row(&mut self, id: &str, name: &str, soup: &Soup, level: u32) -> Option<f64> {
        if !self.selects(id, name, level) {
            return None;
        }
        let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
        let plan = Plan::new(entry, Boundary::default(), level);
        let mesh = build(soup);
        let refined = run(&mesh, &plan);
        let faces = refined.faces.count() as f64;
        let stored = refined.points.len() * 12 + refined.faces.corners().len() * 4;
        let ns = |t: f64| t * 1e9 / faces;
        drop(refined);

        let input = Input::new(soup, &soup.marks.creases);
        let mut present = Vec::new();
        for peer in Peer::ALL {
            let Some(start) = peer.prepare(&input, id, level) else { continue };
            let theirs = start().surface();
            let mut equal = plan.clone();
            let tolerance = match peer.differs(id) {
                Some(Differs::Weights(choice)) => {
                    assert!(equal.params.set(&entry.info, 0, choice));
                    TOLERANCE
                }
                Some(Differs::Rule(_)) => f64::INFINITY,
                None => TOLERANCE,
            };
            if let Err(why) = same::distance(&surface(&run(&mesh, &equal)), &theirs, tolerance) {
                self.differ.push(format!("{id}, {name}, level {level}: Limn and {} differ: {why}", peer.name()));
                continue;
            }
            present.push((peer, Vec::new()));
        }

        let (mut all, mut half) = (Vec::new(), Vec::new());
        for round in 0..if faces > 1e6 { 15 } else { 25 } {
            all.push(seconds(|| drop(black_box(run(&build(soup), &plan)))));
            half.push(seconds(|| drop(black_box(run(&mesh, &plan)))));
            for (peer, times) in &mut present {
                // A peer that takes seconds has three runs.
                if round % 5 == 0 || times.iter().sum::<f64>() < 0.5 {
                    let Some(start) = peer.prepare(&input, id, level) else { continue };
                    times.push(seconds(|| drop(black_box(start()))));
                }
            }
        }
        let (all, half) = (ns(median(&mut all)), (ns(median(&mut half)), ns(all[0])));
        let (half, best) = half;
        let mut line = format!("{id:<19}{name:<26}{level:>2} {faces:>9} {all:>8.1} {half:>8.1} {best:>8.1} ");
        line += &format!("{:>6.1} ", ns(stored as f64 / self.bytes_per_second));
        let budget = BUDGETS.iter().find(|b| b.0 == id).map(|b| b.1);
        line += &match budget {
            Some(b) if all <= b => format!("{b:>6}  met   "),
            Some(b) => format!("{b:>6}  missed"),
            None => format!("{:>14}", ""),
        };
        if budget.is_some_and(|b| all > b) {
            self.missed.push(format!("{id} on {name}: {all:.1} ns"));
        }
        for peer in Peer::ALL {
            line += &match present.iter_mut().find(|p| p.0 == peer) {
                Some((_, times)) => {
                    let t = ns(median(times));
                    let mark = if let Some(Differs::Rule(_)) = peer.differs(id) { "*" } else { "" };
                    format!("{t:>10.0} {:>6}{mark:1}", format!("x{:.0}", t / all))
                }
                None => format!("{:>10} {:>7}", "-", ""),
            };
        }
        println!("{line}");
        Some(all)
    }
}

/// A. Powell, "Surface Subdivision" (2003): seconds for one step of any of his schemes on about so many triangles, on
/// his laptop; most of it went to growing arrays. Beside it one step of Butterfly with smooth normals, from indexed faces.
fn powell() {
    println!("\none step of Butterfly with normals   Powell, 2003    Limn, median      ratio");
    for (n, m, his) in [(15, 10, 4.3), (25, 20, 22.7), (50, 30, 74.2)] {
        let soup = meshes::torus_triangles(n, m);
        let Some(entry) = scheme("butterfly") else { panic!("butterfly is not in the registry") };
        let plan = Plan::new(entry, Boundary::default(), 1);
        let once = || {
            let refined = run(&build(&soup), &plan);
            drop(black_box(refined.normals()));
        };
        once();
        let ours = median(&mut (0..201).map(|_| seconds(once)).collect::<Vec<_>>());
        let triangles = soup.face_count();
        println!("{triangles:>18} triangles {his:>18.1} s {:>12.3} ms {:>10.0}", ours * 1e3, his / ours);
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = words.iter().find(|w| !w.starts_with('-')).cloned().unwrap_or_default();
    // glibc reads these when a process starts: memory kept, or every large block mapped afresh.
    if cfg!(all(target_os = "linux", target_env = "gnu")) && std::env::var_os("MALLOC_MMAP_THRESHOLD_").is_none() {
        let limit = if words.iter().any(|w| w == "--fresh") { "65536" } else { "4000000000" };
        let me = std::env::current_exe().unwrap_or_else(|e| panic!("{e}"));
        let mut again = std::process::Command::new(me);
        again.args(&words).env("MALLOC_MMAP_THRESHOLD_", limit).env("MALLOC_TRIM_THRESHOLD_", limit);
        assert!(again.status().is_ok_and(|status| status.success()));
        return;
    }
    let mut table = Table { word, bytes_per_second: bandwidth(), missed: Vec::new(), differ: Vec::new() };
    let fresh = if words.iter().any(|w| w == "--fresh") { "fresh" } else { "warm" };
    println!(
        "ns a face of the last level, medians, one thread, {fresh} memory; plain stores {:.1} GB/s",
        table.bytes_per_second / 1e9
    );
    print!("{:<19}{:<26}{:>2} {:>9} {:>8} {:>8} ", "scheme", "mesh", "L", "faces", "all", "refine");
    print!("{:>8} {:>6} {:>14}", "best", "limit", "budget        ");
    Peer::ALL.iter().for_each(|peer| print!("{:>18}", peer.name()));
    println!();

    let quads = shape("creature").map(|s| (s.build)()).unwrap_or_default();
    let (triangles, _) = triangulate_soup(&quads);
    let torus = meshes::torus(64, 64);
    let (wide, wide_rings) = (meshes::torus(256, 256), meshes::rings(256, 256));
    let shuffled = meshes::shuffled(&wide);
    let mixed = meshes::mixed(256, 256);
    let sphere = meshes::sphere(112);
    table.creases("catmull-clark", "torus 64x64", &torus, meshes::rings(64, 64), 4);
    // At low levels a larger part of the vertices lies on creases.
    table.creases("catmull-clark", "torus 256x256", &wide, wide_rings.clone(), 2);
    table.row("catmull-clark", "torus 256x256 shuffled", &shuffled, 3);
    table.row("catmull-clark", "mixed polygons", &mixed, 2);
    table.row("catmull-clark", "creature", &quads, 5);
    table.row("linear", "torus 64x64", &torus, 4);
    table.row("linear", "sphere, triangles", &sphere, 2);
    table.row("linear", "creature", &quads, 5);
    table.row("loop", "sphere, triangles", &sphere, 2);
    let triangulated = meshes::torus_triangles(64, 64);
    table.creases("loop", "torus, triangles", &triangulated, meshes::rings(64, 64), 4);
    table.creases("loop", "triangles 256x256", &meshes::torus_triangles(256, 256), wide_rings, 2);
    table.row("loop", "creature, triangles", &triangles, 4);
    table.row("sqrt3", "sphere, triangles", &sphere, 3);
    table.row("sqrt3", "creature, triangles", &triangles, 5);
    table.row("doo-sabin", "torus 64x64", &torus, 4);
    table.row("doo-sabin", "torus 256x256 shuffled", &shuffled, 2);
    table.row("doo-sabin", "mixed polygons", &mixed, 2);
    table.row("doo-sabin", "creature", &quads, 4);
    for id in ["butterfly", "modified-butterfly"] {
        table.row(id, "sphere, triangles", &sphere, 2);
        table.row(id, "creature, triangles", &triangles, 4);
    }
    if "powell".contains(&table.word) {
        powell();
    }
    for (peer, id) in Peer::ALL.iter().flat_map(|p| ["sqrt3", "loop"].map(|id| (p, id))) {
        if let Some(Differs::Rule(why)) = peer.differs(id) {
            println!("* {}: {why}", peer.name());
        }
    }
    for missed in &table.missed {
        println!("over its budget: {missed}");
    }
    table.differ.iter().for_each(|sentence| println!("{sentence}"));
    assert!(table.differ.is_empty(), "rows with a peer left out compare other work");
}
