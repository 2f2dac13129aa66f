//! What refining holds at its peak beside the buffers that it returns: exact, by an allocator that counts.

use limn_mesh::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

fn add(bytes: usize) {
    let now = NOW.fetch_add(bytes, Relaxed) + bytes;
    MOST.fetch_max(now, Relaxed);
}

// SAFETY: everything is the system's; numbers are kept beside it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(layout.size());
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        add(layout.size());
        // SAFETY: the caller's promise.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Bytes a face at the peak over the buffers returned (points, corners, and normals if `shaded`), from the soup on.
fn over(soup: &Soup, id: &str, level: u32, shaded: bool, by_level: bool) -> f64 {
    let plan = Plan::new(scheme(id).unwrap(), Boundary::default(), level);
    let before = NOW.load(Relaxed);
    MOST.store(before, Relaxed);
    let mesh = Arc::new(Mesh::build(soup, Weld::Off).unwrap().0);
    let mut job = Job::new(mesh, plan, u64::MAX).unwrap();
    if shaded {
        job = job.shaded();
    }
    if by_level {
        job = job.level_by_level();
    }
    let refined = job.finish();
    let normals = refined.known_normals.as_ref().map_or(0, Vec::len);
    let returned = 12 * (refined.points.len() + normals) + 4 * refined.faces.corners().len();
    assert!(refined.faces.count() >= 100_000, "{id}, level {level} is small");
    let patched = ["catmull-clark", "loop", "linear"].contains(&id) && level > 2 && !by_level;
    assert_eq!(normals, if shaded && patched { refined.points.len() } else { 0 });
    (MOST.load(Relaxed) - before - returned) as f64 / refined.faces.count() as f64
}

/// A torus of n by n quads.
fn torus_of(n: u32) -> Soup {
    let turn = |i: u32| (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
    let point = |i: u32| {
        let ((sin, cos), (y, x)) = (turn(i / n), turn(i % n));
        [(3.0 + x) * cos, (3.0 + x) * sin, y].map(|x| x as f32)
    };
    let faces: Vec<[u32; 4]> = (0..n * n)
        .map(|i| {
            let (j, k) = (i / n, i % n);
            [[j, k], [j + 1, k], [j + 1, k + 1], [j, k + 1]].map(|[j, k]| j % n * n + k % n)
        })
        .collect();
    Soup::from_faces((0..n * n).map(point).collect(), &faces)
}

/// One test: others beside it would count as well.
#[test]
fn refining_holds_little_beside_what_it_returns() {
    let quads = (shape("creature").unwrap().build)();
    let (triangles, _) = triangulate_soup(&quads);
    let grid = (shape("grid").unwrap().build)();
    // Of these the mesh itself is a good part.
    let large = torus_of(256);
    let (large_triangles, _) = triangulate_soup(&torus_of(128));
    for (soup, id, level, most) in [
        (&quads, "catmull-clark", 5, 3.0),
        (&quads, "catmull-clark", 6, 1.0),
        (&large, "catmull-clark", 2, 20.0),
        (&triangles, "loop", 4, 5.0),
        (&triangles, "loop", 5, 1.5),
        (&large_triangles, "loop", 2, 15.0),
        (&quads, "linear", 5, 3.0),
        (&quads, "doo-sabin", 4, 18.0),
        (&quads, "doo-sabin-midpoint", 5, 18.0),
        (&grid, "doo-sabin", 6, 25.0),
        (&large, "doo-sabin", 2, 30.0),
        (&triangles, "sqrt3", 5, 22.0),
        (&large_triangles, "sqrt3", 2, 30.0),
        (&large_triangles, "sqrt3", 3, 25.0),
        (&triangles, "butterfly", 4, 10.0),
        (&triangles, "modified-butterfly", 5, 10.0),
        (&large_triangles, "modified-butterfly", 2, 15.0),
    ] {
        for shaded in [false, true] {
            let bytes = over(soup, id, level, shaded, false);
            println!("{id}, level {level}, shaded: {shaded}: {bytes:.2} bytes a face over what is returned");
            assert!(bytes <= most, "{id}, level {level}, shaded: {shaded}: {bytes:.2} bytes a face");
        }
    }
    // Level by level the parents are held.
    let general = over(&quads, "catmull-clark", 5, false, true);
    println!("level by level: {general:.2}");
    assert!(general > 4.0, "{general:.2}: what is counted?");
}
