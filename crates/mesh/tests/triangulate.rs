//! Triangulation: the right diagonal, whole coverage, and n - 2 triangles whatever comes.

use limn_mesh::shapes::SHAPES;
use limn_mesh::soup::{NONE, Soup};
use limn_mesh::triangulate::{triangulate, triangulate_soup};
use proptest::prelude::*;

fn run(points: &[[f32; 3]]) -> Vec<[u32; 3]> {
    let polygon: Vec<u32> = (0..points.len() as u32).collect();
    let mut out = vec![[9, 9, 9]];
    triangulate(points, &polygon, &mut out);
    out
}

fn flat(points: &[[f32; 2]]) -> Vec<[f32; 3]> {
    points.iter().map(|&[x, y]| [x, y, 0.0]).collect()
}

/// Twice the signed area in the plane z = 0.
fn area2(points: &[[f32; 3]], corners: &[u32]) -> f64 {
    let at = |i: usize| points[corners[i % corners.len()] as usize].map(f64::from);
    (0..corners.len()).map(|i| at(i)[0] * at(i + 1)[1] - at(i)[1] * at(i + 1)[0]).sum()
}

/// Every side once, every diagonal once each way: a triangulation of the polygon as a surface.
fn assert_covers(n: usize, triangles: &[[u32; 3]]) {
    assert_eq!(triangles.len(), n - 2);
    let mut edges: Vec<(u32, u32)> =
        triangles.iter().flat_map(|t| (0..3).map(|i| (t[i], t[(i + 1) % 3])).collect::<Vec<_>>()).collect();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|w| w[0] != w[1]), "an edge is used twice the same way");
    for &(a, b) in &edges {
        assert!((a as usize) < n && (b as usize) < n && a != b);
        let side = (a as usize + 1) % n == b as usize;
        assert!(side != edges.binary_search(&(b, a)).is_ok(), "edge {a} {b}");
    }
}

/// Covers, and all triangles lie inside: none is turned over and the areas add up.
fn assert_inside(points: &[[f32; 3]], triangles: &[[u32; 3]]) {
    assert_covers(points.len(), triangles);
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let sign = area2(points, &all).signum();
    for t in triangles {
        assert!(area2(points, t) * sign > 0.0, "{t:?} is flat or turned over");
    }
}

#[test]
fn small_polygons() {
    assert!(run(&[]).is_empty() && run(&flat(&[[0.0, 0.0], [1.0, 0.0]])).is_empty());
    assert_eq!(run(&flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])), [[0, 1, 2]]);
}

#[test]
fn quads_take_the_shorter_diagonal() {
    let short_02 = [[0.0, 0.0], [2.0, -1.0], [3.0, 0.5], [1.0, 1.5]];
    let long = |q: [[f32; 2]; 4], i: usize, j: usize| (q[i][0] - q[j][0]).hypot(q[i][1] - q[j][1]);
    assert!(long(short_02, 0, 2) > long(short_02, 1, 3));
    assert_eq!(run(&flat(&short_02)), [[0, 1, 3], [1, 2, 3]]);
    let turned = [short_02[1], short_02[2], short_02[3], short_02[0]];
    assert_eq!(run(&flat(&turned)), [[0, 1, 2], [0, 2, 3]]);
    // Ties: the diagonal at corner 0.
    assert_eq!(run(&flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn concave_quads_take_the_inner_diagonal() {
    // The outer diagonal is much the shorter.
    let dart = [[0.0, 0.0], [10.0, -0.5], [8.0, 0.0], [10.0, 0.5]];
    assert_eq!(run(&flat(&dart)), [[0, 1, 2], [0, 2, 3]]);
    for turn in 0..4 {
        let turned: Vec<[f32; 2]> = (0..4).map(|i| dart[(i + turn) % 4]).collect();
        assert_inside(&flat(&turned), &run(&flat(&turned)));
    }
    // A corner in the middle of a side: the shorter diagonal would cut a flat triangle off.
    assert_eq!(run(&flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 5.0]])), [[0, 1, 3], [1, 2, 3]]);
    // Bent, and seen from below; the outer diagonal is the shorter one.
    let bent = [[0.0, 0.0, 0.0], [10.0, 0.3, 0.5], [8.0, 0.0, 0.0], [10.0, 0.3, -0.5]];
    assert_eq!(run(&bent), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn larger_polygons_lose_the_shortest_ear_first() {
    // A house: the ears at the eaves have the shortest diagonals, both alike; the tie goes to diagonal 0 3.
    let house = flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.2], [0.0, 1.0]]);
    let triangles = run(&house);
    assert_eq!(triangles, [[3, 4, 0], [3, 0, 1], [1, 2, 3]]);
    assert_inside(&house, &triangles);
    let c = flat(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [0.0, 3.0]]);
    assert_inside(&c, &run(&c));
}

#[test]
fn straight_corners_make_no_flat_triangles() {
    let square: Vec<[f32; 3]> = (0..4)
        .flat_map(|side| {
            (0..5).map(move |i| {
                let t = i as f32;
                [[t, 0.0, 0.0], [5.0, t, 0.0], [5.0 - t, 5.0, 0.0], [0.0, 5.0 - t, 0.0]][side]
            })
        })
        .collect();
    assert_inside(&square, &run(&square));
    // All but one corner on a line.
    let fan: Vec<[f32; 3]> = (0..9).map(|i| [i as f32, 0.0, 0.0]).chain([[4.0, 3.0, 0.0]]).collect();
    assert_inside(&fan, &run(&fan));
}

#[test]
fn a_keyhole_around_a_hole() {
    // A square with a square hole, joined by a cut that is walked twice.
    let ring = flat(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ]);
    let triangles = run(&ring);
    assert_inside(&ring, &triangles);
    let total: f64 = triangles.iter().map(|t| area2(&ring, t)).sum();
    assert_eq!(total, 2.0 * 12.0);
}

#[test]
fn a_plate_with_many_holes() {
    // Forty square holes in a row, each joined to the lower side by a cut that is walked twice.
    let mut plate = vec![[0.0, 0.0]];
    for i in 0..40 {
        let x = 3.0 * i as f32 + 1.0;
        plate.extend([[x, 0.0], [x, 1.0], [x, 2.0], [x + 1.0, 2.0], [x + 1.0, 1.0], [x, 1.0], [x, 0.0]]);
    }
    plate.extend([[120.0, 0.0], [120.0, 3.0], [0.0, 3.0]]);
    let plate = flat(&plate);
    let triangles = run(&plate);
    assert_inside(&plate, &triangles);
    assert_eq!(triangles.iter().map(|t| area2(&plate, t)).sum::<f64>(), 2.0 * (360.0 - 40.0));
}

#[test]
fn tilted_polygons_are_cut_like_flat_ones() {
    // An L that leans in all three axes.
    let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 5.0], [0.0, 5.0]];
    let expected = run(&flat(&l));
    assert_inside(&flat(&l), &expected);
    let tilt: Vec<[f32; 3]> =
        l.iter().map(|&[x, y]| [0.6 * x + 100.0, 0.48 * x + 0.8 * y, 0.64 * x - 0.6 * y]).collect();
    assert_eq!(run(&tilt), expected);
    let back: Vec<[f32; 3]> = l.iter().rev().map(|&[x, y]| [x, y, 0.0]).collect();
    assert_inside(&back, &run(&back));
}

#[test]
fn broken_polygons_still_give_n_minus_2() {
    let nan = f32::NAN;
    for points in [
        vec![[0.0; 3]; 7],
        (0..9).map(|i| [i as f32, 2.0 * i as f32, 0.0]).collect(),
        vec![[nan; 3]; 6],
        vec![[0.0, 0.0, 0.0], [1.0, nan, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, f32::INFINITY], [0.0, 2.0, 0.0]],
        // A star of five points, drawn in one line, and a figure of eight.
        (0..5).map(|i| [(2.513 * i as f32).cos(), (2.513 * i as f32).sin(), 0.0]).collect(),
        flat(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]),
        flat(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]]),
        vec![[f32::MAX, 0.0, 0.0], [0.0, f32::MAX, 0.0], [-f32::MAX, 0.0, 0.0], [0.0, -f32::MAX, 0.0], [1.0, 1.0, 0.0]],
        (0..3000).map(|i| [(i % 7) as f32, (i % 3) as f32, 0.0]).collect(),
    ] {
        assert_covers(points.len(), &run(&points));
    }
    // Positions that are not there.
    let mut out = Vec::new();
    triangulate(&[], &[0, 5, NONE, 7, 9], &mut out);
    assert_covers(5, &out);
}

#[test]
fn ten_thousand_corners() {
    let n = 10_000;
    let circle: Vec<[f32; 3]> = (0..n)
        .map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(n))
        .map(|a| [a.cos() as f32, a.sin() as f32, 0.0])
        .collect();
    assert_covers(n as usize, &run(&circle));
    // A comb: half of its corners are reflex.
    let mut comb: Vec<[f32; 3]> = (0..n / 2).map(|i| [i as f32, if i % 2 == 0 { 1.0 } else { 100.0 }, 0.0]).collect();
    comb.extend((0..n / 2).rev().map(|i| [i as f32, if i % 2 == 0 { 0.0 } else { 99.0 }, 0.0]));
    assert_inside(&comb, &run(&comb));
    // A spiral, and points in no order at all.
    let spiral = |i: i32, r: f64| {
        let a = f64::from(i) * 0.02;
        [((1.0 + a + r) * a.cos()) as f32, ((1.0 + a + r) * a.sin()) as f32, 0.0]
    };
    let spiral: Vec<[f32; 3]> =
        (0..n / 2).map(|i| spiral(i, 0.0)).chain((0..n / 2).rev().map(|i| spiral(i, 2.0))).collect();
    assert_inside(&spiral, &run(&spiral));
    let mut seed = 1u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 16_777_216.0
    };
    let tangle: Vec<[f32; 3]> = (0..n).map(|_| [random(), random(), random()]).collect();
    assert_covers(n as usize, &run(&tangle));
}

#[test]
fn a_soup_keeps_its_channels() {
    let mut soup = Soup::from_faces(
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]],
        &[&[3, 2, 4][..], &[0, 1, 2, 3], &[0, 1]],
    );
    soup.uvs = (0..9).map(|i| [i as f32, 0.0]).collect();
    soup.uv_corners = vec![0, 1, 2, 3, 4, 5, NONE, 7, 8];
    soup.colors = vec![[0.1, 0.2, 0.3, 1.0]; 5];
    soup.face_groups = vec![4, 5, 6];
    soup.face_materials = vec![NONE, 1, 2];
    let (cut, split) = triangulate_soup(&soup);
    assert_eq!(split, 1);
    assert_eq!((&cut.positions, &cut.uvs, &cut.colors), (&soup.positions, &soup.uvs, &soup.colors));
    assert_eq!(cut.offsets, [0, 3, 6, 9, 11]);
    assert_eq!(cut.corners, [3, 2, 4, 0, 1, 2, 0, 2, 3, 0, 1]);
    assert_eq!(cut.uv_corners, [0, 1, 2, 3, 4, 5, 3, 5, NONE, 7, 8]);
    assert_eq!(cut.face_groups, [4, 5, 5, 6]);
    assert_eq!(cut.face_materials, [NONE, 1, 1, 2]);
    assert_eq!(triangulate_soup(&Soup::default()), (Soup::default(), 0));
}

#[test]
fn built_in_models_keep_their_surface() {
    for shape in SHAPES {
        let soup = (shape.build)();
        let (cut, _) = triangulate_soup(&soup);
        let expected: usize = (0..soup.face_count()).map(|f| soup.face(f).len() - 2).sum();
        assert_eq!(cut.face_count(), expected, "{}", shape.name);
        assert!((0..expected).all(|f| cut.face(f).len() == 3));
    }
}

proptest! {
    /// Star-shaped polygons are simple: every one must be cut inside, wherever it starts and whichever way it turns.
    #[test]
    fn simple_polygons_are_cut_inside(radii in prop::collection::vec(0.1f32..1.0, 4..60), turn in 0usize..60, back: bool) {
        let n = radii.len();
        let mut points: Vec<[f32; 3]> = radii
            .iter()
            .enumerate()
            .map(|(i, r)| (r, std::f32::consts::TAU * i as f32 / n as f32))
            .map(|(r, a)| [r * a.cos(), r * a.sin(), 0.0])
            .collect();
        points.rotate_left(turn % n);
        if back {
            points.reverse();
        }
        assert_inside(&points, &run(&points));
    }

    #[test]
    fn any_points_give_n_minus_2(points in prop::collection::vec(prop::array::uniform3(-2i8..3), 3..40)) {
        let points: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
        assert_covers(points.len(), &run(&points));
    }
}
