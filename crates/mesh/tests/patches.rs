//! Patch grids against the slow way: points of recorded rows in f64, faces of the general engine, normals of the faces around.

mod common;

use common::{build, cage, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::*;
use proptest::prelude::*;

fn diagonal(points: &[[f32; 3]]) -> f64 {
    let [low, high] = bounds(points);
    (0..3).map(|k| f64::from(high[k] - low[k]).powi(2)).sum::<f64>().sqrt()
}

/// Holds a level against rows, and its faces and normals against those of the general engine. Says whether patches made it.
fn check(soup: &Soup, id: &str, level: u32, boundary: Boundary, what: &str) -> bool {
    let mesh = build(soup);
    let plan = Plan::new(scheme(id).unwrap(), boundary, level);
    let job = || Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
    let (mut fast, general) = (job().shaded().finish(), job().level_by_level().finish());
    let positions: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let exact = evaluate(&mesh, &plan, &positions, |_| ()).unwrap();
    let size = diagonal(&mesh.positions);
    assert_eq!(fast.points.len(), exact.len(), "{what}");
    for (v, (p, q)) in fast.points.iter().zip(&exact).enumerate() {
        for k in 0..3 {
            assert!((f64::from(p[k]) - q[k]).abs() <= 1e-6 * size, "{what}: vertex {v} is {p:?}, not {q:?}");
        }
    }
    assert_eq!(fast.faces, general.faces, "{what}");
    assert_eq!((fast.counts, fast.parent_ranges), (general.counts, general.parent_ranges), "{what}");
    let Some(known) = fast.known_normals.take() else { return fast.points != general.points };
    for (v, (n, m)) in known.iter().zip(fast.normals()).enumerate() {
        let off = (0..3).map(|k| (n[k] - m[k]).abs()).fold(0.0, f32::max);
        // Points are known to a few digits of a small face's size.
        assert!(off <= 5e-3, "{what}: the normal of {v} is {n:?}, not {m:?}");
    }
    true
}

/// So many faces at a vertex that no table would pay: the general engine makes them.
#[test]
fn poles_agree() {
    for closed in [false, true] {
        let soup = common::fan(300, closed);
        check(&soup, "catmull-clark", 3, Boundary::default(), "a fan of 300");
        check(&soup, "loop", 3, Boundary::default(), "a fan of 300");
    }
    let half = common::half_pole(20_000);
    let plan = Plan::new(scheme("loop").unwrap(), Boundary::EdgeOnly, 3);
    let job = || Job::new(build(&half), plan.clone(), u64::MAX).unwrap();
    assert_eq!(job().finish().points, job().level_by_level().finish().points);
}

const BOUNDARIES: [Boundary; 2] = [Boundary::EdgeAndCorner, Boundary::EdgeOnly];

#[test]
fn the_gallery_agrees() {
    for (name, soup) in gallery() {
        let (triangles, _) = triangulate_soup(&soup);
        for (level, boundary) in [(3, BOUNDARIES[0]), (4, BOUNDARIES[1])] {
            for (soup, id) in [(&soup, "catmull-clark"), (&soup, "linear"), (&triangles, "loop")] {
                check(soup, id, level, boundary, &format!("{name}, {id}, level {level}, {boundary:?}"));
            }
        }
    }
}

#[test]
fn what_should_be_made_of_patches_is() {
    let creature = (shape("creature").unwrap().build)();
    let (triangles, _) = triangulate_soup(&creature);
    let grid = (shape("grid").unwrap().build)();
    for (soup, id, level) in [
        (&creature, "catmull-clark", 3),
        (&triangles, "loop", 4),
        (&triangles, "linear", 3),
        (&grid, "catmull-clark", 7),
    ] {
        assert!(check(soup, id, level, Boundary::default(), id), "{id} at level {level} went level by level");
    }
}

/// The same with creases and corners, sharp and semi-sharp.
#[test]
fn creases_agree() {
    let mut patched = 0;
    for (name, sharpness) in
        [("cube", [10.0, 10.0]), ("torus", [10.0, 2.5]), ("grid", [1.5, 3.0]), ("mouse", [10.0, 0.5])]
    {
        let mut soup = (shape(name).unwrap().build)();
        let mesh = build(&soup);
        let t = &mesh.topology;
        for e in (0..t.edges()).step_by(5) {
            let h = t.edge_half_edge(e);
            let ends = [h, t.next(h)].map(|h| t.origin(h));
            soup.marks.creases.push((ends, sharpness[e as usize / 5 % 2]));
        }
        soup.marks.corners.push((1, 10.0));
        soup.marks.corners.push((3, 1.5));
        for level in 3..=5 {
            let what = format!("{name} with creases {sharpness:?}, level {level}");
            patched += usize::from(check(&soup, "catmull-clark", level, Boundary::default(), &what));
            let (triangles, _) = triangulate_soup(&soup);
            check(&triangles, "loop", level, Boundary::default(), &format!("{what}, triangles"));
        }
    }
    assert!(patched >= 6, "only {patched} of 12 went by patches");
}

/// Colours go by the same rules as points, alpha with them.
#[test]
fn colours_agree() {
    for (name, id) in [("creature", "catmull-clark"), ("grid", "catmull-clark"), ("pawn", "loop"), ("grid", "linear")] {
        for clear in [false, true] {
            let mut soup = (shape(name).unwrap().build)();
            let color = |i: usize| {
                [i as f32 % 7.0 / 7.0, i as f32 % 5.0 / 5.0, 0.25, if clear { i as f32 % 3.0 / 3.0 } else { 0.8 }]
            };
            soup.colors = (0..soup.positions.len()).map(color).collect();
            if id == "loop" {
                soup = triangulate_soup(&soup).0;
            }
            let plan = Plan::new(scheme(id).unwrap(), Boundary::default(), 4);
            let job = || Job::new(build(&soup), plan.clone(), u64::MAX).unwrap().shaded();
            let (fast, general) = (job().finish(), job().level_by_level().finish());
            assert!(fast.known_normals.is_some(), "{name}, {id} went level by level");
            assert_eq!(fast.colors.len(), general.colors.len());
            for (v, (a, b)) in fast.colors.iter().zip(&general.colors).enumerate() {
                assert!((0..4).all(|k| (a[k] - b[k]).abs() <= 1e-6), "{name}, {id}: vertex {v} is {a:?}, not {b:?}");
            }
            let mut sliced = job();
            while !sliced.step(997) {}
            let sliced = sliced.finish();
            assert_eq!((&fast.points, &fast.colors), (&sliced.points, &sliced.colors), "{name}, {id}");
            soup.colors.clear();
            let plain = Job::new(build(&soup), plan.clone(), u64::MAX).unwrap().finish();
            assert_eq!((&fast.points, &fast.faces), (&plain.points, &plain.faces), "{name}, {id}");
        }
    }
}

/// So do texture coordinates, on half-edges of their own.
#[test]
fn texture_coordinates_agree() {
    use FaceVarying::*;
    for (name, id) in
        [("creature", "catmull-clark"), ("grid", "catmull-clark"), ("pawn", "loop"), ("cube", "catmull-clark")]
    {
        let mut soup = (shape(name).unwrap().build)();
        if id == "loop" {
            soup = triangulate_soup(&soup).0;
        }
        // Every eighth face has a chart of its own.
        let (mut uvs, mut corners) = (soup.positions.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(), Vec::new());
        for f in 0..soup.face_count() {
            for &v in soup.face(f) {
                let [x, y, z] = soup.positions[v as usize];
                uvs.push([x + 10.0, y + z]);
                corners.push(if f % 8 == 0 { uvs.len() as u32 - 1 } else { v });
            }
        }
        (soup.uvs, soup.uv_corners) = (uvs, corners);
        for face_varying in [None, CornersOnly, CornersPlus1, CornersPlus2, Boundaries, All] {
            let mut plan = Plan::new(scheme(id).unwrap(), Boundary::default(), 4);
            plan.rules.face_varying = face_varying;
            let job = || Job::new(build(&soup), plan.clone(), u64::MAX).unwrap();
            let what = format!("{name}, {id}, {face_varying:?}");
            let (fast, general) = (job().finish().uv.unwrap(), job().level_by_level().finish().uv.unwrap());
            assert_eq!(fast.corners, general.corners, "{what}");
            assert_eq!(fast.values.len(), general.values.len(), "{what}");
            for (v, (a, b)) in fast.values.iter().zip(&general.values).enumerate() {
                assert!((0..2).all(|k| (a[k] - b[k]).abs() <= 1e-5), "{what}: value {v} is {a:?}, not {b:?}");
            }
            // Sums in f32 and in f64 differ somewhere, but those of halves.
            let same = fast.values == general.values;
            assert!(same == (face_varying == Boundaries) || face_varying == All, "{what}: how it was made");
            let mut sliced = job();
            while !sliced.step(997) {}
            assert_eq!(Some(fast), sliced.finish().uv, "{what}");
        }
    }
}

/// Slices of any length make the same bits, and (in a build that shares large work among threads) so do threads.
#[test]
fn slices_make_the_same() {
    let mesh = build(&(shape("creature").unwrap().build)());
    let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), 4);
    let job = || Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap().shaded();
    let (whole, mut sliced) = (job().finish(), job());
    while !sliced.step(20_000) {}
    let sliced = sliced.finish();
    assert!(whole.points == sliced.points && whole.known_normals == sliced.known_normals);
    assert_eq!(whole.faces, sliced.faces);

    let mesh = build(&(shape("mouse").unwrap().build)());
    let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), 4);
    let job = || Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap().shaded();
    let whole = job().finish();
    for rows in [1, 7, 100, 5000] {
        let mut sliced = job();
        while !sliced.step(rows) {}
        let sliced = sliced.finish();
        assert_eq!(whole.points, sliced.points, "{rows} rows at a time");
        assert_eq!(whole.known_normals, sliced.known_normals, "{rows} rows at a time");
        assert_eq!(whole.faces, sliced.faces, "{rows} rows at a time");
    }
}

/// Buffers of another surface over the same half-edges are filled anew, whatever was in them.
#[test]
fn buffers_are_used_again() {
    let soup = (shape("mouse").unwrap().build)();
    let mut moved = soup.clone();
    moved.positions.iter_mut().for_each(|p| *p = [p[1], -p[0], 2.0 * p[2]]);
    for level in 3..=4 {
        let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), level);
        let job = |soup: &Soup| Job::new(build(soup), plan.clone(), u64::MAX).unwrap().shaded();
        let old = job(&soup).finish();
        let buffers = [old.points.as_ptr(), old.known_normals.as_ref().unwrap().as_ptr()];
        let (fresh, reused) = (job(&moved).finish(), job(&moved).reusing(old).finish());
        let filled = [reused.points.as_ptr(), reused.known_normals.as_ref().unwrap().as_ptr()];
        assert_eq!(buffers, filled, "level {level}: other buffers were filled");
        assert_eq!((&fresh.points, &fresh.faces), (&reused.points, &reused.faces), "level {level}");
        assert_eq!(fresh.known_normals, reused.known_normals, "level {level}");
        // So are another model's, corners with them, whether there is room or not.
        let mut turned = moved.clone();
        let last = turned.face_count() - 1;
        let corners = turned.face(last).len();
        let first = turned.corners.len() - corners;
        turned.corners[first..].rotate_left(1);
        for other in [turned, (shape("cube").unwrap().build)(), (shape("creature").unwrap().build)()] {
            let reused = job(&moved).reusing(job(&other).finish()).finish();
            assert_eq!((&fresh.points, &fresh.faces), (&reused.points, &reused.faces), "level {level}");
            assert_eq!(fresh.known_normals, reused.known_normals, "level {level}");
        }
    }
}

/// What is dragged is what is made anew, to the last bit, and only what was named has changed.
#[test]
fn dragging_is_making_anew() {
    for (name, id) in
        [("creature", "catmull-clark"), ("grid", "catmull-clark"), ("mouse", "catmull-clark"), ("pawn", "loop")]
    {
        let mut soup = (shape(name).unwrap().build)();
        let mesh = build(&soup);
        let plan = Plan::new(scheme(id).unwrap(), Boundary::default(), 4);
        let mut drag = Drag::new(mesh.clone(), &plan, u64::MAX).unwrap().unwrap();
        for v in [0u32, 7, 20] {
            let to = drag.cage()[v as usize].map(|x| x + 0.25);
            let before = (drag.points().to_vec(), drag.normals().to_vec());
            let moved = drag.move_vertices(&[(v, to)]);
            soup.positions[mesh.vertex_source[v as usize] as usize] = to;
            let fresh = Job::new(build(&soup), plan.clone(), u64::MAX).unwrap().shaded().finish();
            assert_eq!(drag.points(), fresh.points, "{name}, vertex {v}");
            assert_eq!(Some(drag.normals()), fresh.known_normals.as_deref(), "{name}, vertex {v}");
            assert_eq!(drag.corners(), fresh.faces.corners(), "{name}, vertex {v}");
            let mut named = vec![false; fresh.points.len()];
            moved.vertices.iter().for_each(|range| named[range.start as usize..range.end as usize].fill(true));
            for (i, named) in named.iter().enumerate() {
                let same = (before.0[i], before.1[i]) == (drag.points()[i], drag.normals()[i]);
                assert!(same || *named, "{name}: {i} changed and was not named");
            }
            assert!(name != "creature" || moved.patches < 150, "{} patches", moved.patches);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn random_cages_agree(soup in cage(), level in 3u32..5, edges in any::<bool>()) {
        let boundary = BOUNDARIES[usize::from(edges)];
        check(&soup, "catmull-clark", level, boundary, "a random cage");
        let (triangles, _) = triangulate_soup(&soup);
        check(&triangles, "loop", level, boundary, "a random cage of triangles");
    }
}
