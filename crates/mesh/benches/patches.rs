//! Levels that are made of patches, at the speed of memory, in ns an output face. `cargo bench -p limn-mesh --bench patches [-- WORD]`
//!
//! ```text
//!   points        indexed faces to points, into buffers of another surface over the same half-edges
//!   all           the same to points, normals and corners, all written anew: a surface over other half-edges was there before
//!   first load    all of that in a process of its own, where every page is new; beside it a process that only writes as many
//!                 bytes to new memory
//!   threads       points, and all, by one thread and by two, wall time, beside what two threads of arithmetic gain (feature `parallel`)
//! ```
//!
//! Medians and, in brackets, the best: machines are shared. The limit is the time that plain stores of the same bytes take in
//! the same run, one after the other. A word selects rows by name.

use limn_mesh::{Boundary, Job, Mesh, Plan, Refined, Soup, Weld, scheme, shape, triangulate_soup};
use std::hint::black_box;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// What a process of its own is asked to do.
const FIRST: &str = "first-load";

/// Median and best.
fn times(runs: usize, mut f: impl FnMut()) -> [f64; 2] {
    f();
    let mut t: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            f();
            start.elapsed().as_secs_f64()
        })
        .collect();
    t.sort_by(f64::total_cmp);
    [t[t.len() / 2], t[0]]
}

/// A cage, and the same one with its last face's corners in another order: equal counts, other half-edges.
struct Model {
    name: &'static str,
    cages: [Soup; 2],
    plan: Plan,
}

impl Model {
    fn new(name: &'static str, soup: &Soup, id: &str, level: u32) -> Model {
        let Some(entry) = scheme(id) else { panic!("{id} is not in the registry") };
        let mut other = soup.clone();
        let corners = other.face(other.face_count() - 1).len();
        let first = other.corners.len() - corners;
        other.corners[first..].rotate_left(1);
        Model { name, cages: [soup.clone(), other], plan: Plan::new(entry, Boundary::default(), level) }
    }

    fn job(&self, cage: usize) -> Job {
        let mesh = Mesh::build(&self.cages[cage], Weld::Off).map(|(mesh, _)| mesh).unwrap_or_else(|e| panic!("{e}"));
        Job::new(Arc::new(mesh), self.plan.clone(), u64::MAX).unwrap_or_else(|e| panic!("{e}"))
    }

    fn points(&self, runs: usize) -> [f64; 2] {
        let mut old: Option<Refined> = Some(self.job(0).finish());
        times(runs, || {
            old = old.take().map(|old| black_box(self.job(0).reusing(old).finish()));
        })
    }

    fn all(&self, runs: usize) -> [f64; 2] {
        let mut old: Option<Refined> = Some(self.job(0).shaded().finish());
        let mut i = 0;
        times(runs, || {
            i += 1;
            old = old.take().map(|old| black_box(self.job(i % 2).shaded().reusing(old).finish()));
        })
    }

    /// What a process of its own takes, best of some, in seconds: with `alone` to write that many bytes and no more.
    fn first_load(&self, alone: Option<usize>) -> f64 {
        let me = std::env::current_exe().unwrap_or_else(|e| panic!("{e}"));
        let bytes = alone.unwrap_or(0).to_string();
        let once = || {
            let out = Command::new(&me).args([FIRST, self.name, &self.plan.level.to_string(), &bytes]).output();
            let out = out.unwrap_or_else(|e| panic!("{e}"));
            String::from_utf8_lossy(&out.stdout).trim().parse::<f64>().unwrap_or(f64::NAN)
        };
        (0..9).map(|_| once()).fold(f64::INFINITY, f64::min)
    }
}

fn models() -> Vec<Model> {
    let Some(shape) = shape("creature") else { panic!("no creature") };
    let quads = (shape.build)();
    let (triangles, _) = triangulate_soup(&quads);
    vec![
        Model::new("creature", &quads, "catmull-clark", 5),
        Model::new("creature", &quads, "catmull-clark", 6),
        Model::new("creature, triangles", &triangles, "loop", 4),
        Model::new("creature, triangles", &triangles, "loop", 5),
    ]
}

/// In a process of its own: the seconds that a first load takes, or writing as many bytes.
fn first_load(args: &[String]) {
    let [name, level, bytes] = args else { return };
    let bytes: usize = bytes.parse().unwrap_or(0);
    let model = models().into_iter().find(|m| m.name == name && m.plan.level.to_string() == *level);
    let start = Instant::now();
    if bytes > 0 {
        let mut fresh = vec![0u64; bytes / 8];
        fresh.iter_mut().for_each(|x| *x = 1);
        black_box(&fresh);
    } else if let Some(model) = model {
        black_box(model.job(0).shaded().finish());
    }
    println!("{}", start.elapsed().as_secs_f64());
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let Some(at) = args.iter().position(|a| a == FIRST) {
        first_load(&args[at + 1..]);
        return;
    }
    // glibc reads these when a process starts: memory is kept, as in a browser.
    if cfg!(all(target_os = "linux", target_env = "gnu")) && std::env::var_os("MALLOC_MMAP_THRESHOLD_").is_none() {
        let me = std::env::current_exe().unwrap_or_else(|e| panic!("{e}"));
        let keep = [("MALLOC_MMAP_THRESHOLD_", "4000000000"), ("MALLOC_TRIM_THRESHOLD_", "4000000000")];
        // Threads keep theirs as well, in the same place; and the table is one thread's.
        let same = [("MALLOC_ARENA_MAX", "1"), ("RAYON_NUM_THREADS", "1")];
        let status = Command::new(me).args(&args).envs(keep).envs(same).status();
        assert!(status.is_ok_and(|s| s.success()));
        return;
    }
    let word = args.into_iter().find(|a| !a.starts_with('-')).unwrap_or_default();
    println!("ns an output face, medians (best); limit: as many bytes by plain stores");
    println!(
        "{:<20} {:<14} {:>2} {:>9} {:>14} {:>6} {:>14} {:>6} {:>11} {:>6}",
        "model", "scheme", "L", "faces", "points", "limit", "all", "limit", "first load", "limit"
    );
    let chosen = || {
        let models = models().into_iter();
        models.filter(|m| format!("{} {} {}", m.name, m.plan.scheme.info.id, m.plan.level).contains(&word))
    };
    for model in chosen() {
        let made = model.job(0).finish();
        let faces = made.faces.count();
        let (points, corners) = (made.points.len() * 12, made.faces.corners().len() * 4);
        drop(made);
        let mut buffer = vec![0u64; (2 * points + corners) / 8];
        let mut stores = |bytes: usize| {
            let mut k = 0;
            times(9, || {
                k += 1;
                buffer[..bytes / 8].iter_mut().for_each(|x| *x = k);
                black_box(&buffer);
            })[0]
        };
        let limits = [stores(points), stores(2 * points + corners)].map(|t| t * 1e9 / faces as f64);
        drop(buffer);
        let ns =
            |[median, best]: [f64; 2]| format!("{:.2} ({:.2})", median * 1e9 / faces as f64, best * 1e9 / faces as f64);
        let once = |alone: Option<usize>| model.first_load(alone) * 1e9 / faces as f64;
        println!(
            "{:<20} {:<14} {:>2} {faces:>9} {:>14} {:>6.2} {:>14} {:>6.2} {:>11.2} {:>6.2}",
            model.name,
            model.plan.scheme.info.id,
            model.plan.level,
            ns(model.points(15)),
            limits[0],
            ns(model.all(15)),
            limits[1],
            once(None),
            once(Some(2 * points + corners)),
        );
    }
    #[cfg(feature = "parallel")]
    for model in chosen() {
        threads(&model);
    }
}

/// The same by one thread and by two, in turn: machines are shared, and the best of many counts.
#[cfg(feature = "parallel")]
fn threads(model: &Model) {
    let pools = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build());
    let [Ok(one), Ok(two)] = pools else { panic!("no threads") };
    let mut best = [[f64::INFINITY; 3]; 2];
    for _ in 0..5 {
        for (pool, best) in [&one, &two].into_iter().zip(&mut best) {
            let now = pool.install(|| [model.points(5)[1], model.all(5)[1], arithmetic()]);
            best.iter_mut().zip(now).for_each(|(best, now)| *best = best.min(now));
        }
    }
    let [[points, all, sums], [points_of_two, all_of_two, sums_of_two]] = best.map(|b| b.map(|t| t * 1e3));
    println!(
        "{:<20} {:<14} {:>2} points {points:.2} ms, by two threads {points_of_two:.2} ({:.2}x); all {all:.2} ms, by two \
         {all_of_two:.2} ({:.2}x); what the machine gives: {:.2}x",
        model.name,
        model.plan.scheme.info.id,
        model.plan.level,
        points / points_of_two,
        all / all_of_two,
        sums / sums_of_two
    );
}

/// The best time of two equal pieces of work in registers, as much at once as there are threads.
#[cfg(feature = "parallel")]
fn arithmetic() -> f64 {
    let spin =
        || black_box((0..3_000_000u64).fold(1u64, |x, i| x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(i)));
    times(5, || {
        black_box(rayon::join(spin, spin));
    })[1]
}
