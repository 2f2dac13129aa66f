//! Quadratic NURSS against the plainest program that can be written from the paper, against Doo-Sabin, and against knot
//! insertion in the B-splines that they are on grids.

mod common;

use common::polygons::{Point, Polygons, mix, polygons};
use common::{build, cage, distance, gallery};
use limn_mesh::refine::{evaluate, evaluate_limit, refine};
use limn_mesh::{Boundary, Mesh, Plan, Soup, scheme};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The interval at a vertex toward another.
type Knots = BTreeMap<(usize, usize), f64>;

fn nurss(p: &Polygons, knots: &Knots, boundary: Boundary) -> (Polygons, Knots) {
    let a = p.around();
    let d = |v: usize, w: usize| knots.get(&(v, w)).copied().unwrap_or(1.0);
    let is_rim = |v: usize, w: usize| a.edges[&(v.min(w), v.max(w))].len() == 1;
    let mut out = Polygons { points: Vec::new(), faces: Vec::new() };
    // What each new vertex is the image of: the face, its vertex, and that one's neighbours in the face.
    let mut of: Vec<(usize, usize, usize, usize)> = Vec::new();
    let mut images: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (f, face) in p.faces.iter().enumerate() {
        let n = face.len();
        let at = |i: usize| face[i % n];
        let c: Vec<f64> = (0..n).map(|k| d(at(k + n - 1), at(k)) * d(at(k + 1), at(k))).collect();
        let sum: f64 = c.iter().sum();
        let c: Vec<f64> = if sum == 0.0 { vec![1.0; n] } else { c };
        let sum: f64 = c.iter().sum();
        let mut sides = Vec::new();
        for i in 0..n {
            let (before, v, after) = (at(i + n - 1), at(i), at(i + 1));
            let cut = |w: usize| {
                let (own, other) = (d(v, w), d(w, v));
                let (own, other) = if own + other == 0.0 { (1.0, 1.0) } else { (own, other) };
                let e = mix(&[(other / (own + other), p.points[v]), (own / (own + other), p.points[w])]);
                mix(&[(0.5, p.points[v]), (0.5, e)])
            };
            let places: Vec<Point> = match (is_rim(before, v), is_rim(v, after)) {
                (false, false) => {
                    let mean = mix(&(0..n).map(|k| (c[k] / sum, p.points[at(k)])).collect::<Vec<_>>());
                    let turned = |j: usize| 1.0 + 2.0 * (TAU * (i as f64 - j as f64) / n as f64).cos();
                    let mut rest: Vec<(f64, Point)> = (0..n).map(|j| (turned(j), p.points[at(j)])).collect();
                    rest.push((-(n as f64), p.points[v]));
                    let w = (c[(i + 2) % n] + c[(i + n - 2) % n]) / (8.0 * sum);
                    vec![mix(&[(0.5, p.points[v]), (0.5, mean), (w, mix(&rest))])]
                }
                (true, false) => vec![cut(before)],
                (false, true) => vec![cut(after)],
                (true, true) if boundary == Boundary::EdgeAndCorner => vec![p.points[v]],
                (true, true) => vec![cut(before), cut(after)],
            };
            let first = out.points.len();
            images.insert((f, v), (first..first + places.len()).collect());
            for place in places {
                sides.push(out.points.len());
                out.points.push(place);
                of.push((f, v, before, after));
            }
        }
        out.faces.push(sides);
    }
    for (&(v, w), faces) in &a.edges {
        if let [f, g] = faces[..] {
            let at = p.faces[f].iter().position(|&x| x == v).unwrap();
            let (v, w) = if p.faces[f][(at + 1) % p.faces[f].len()] == w { (v, w) } else { (w, v) };
            out.faces.push(vec![images[&(f, w)][0], images[&(f, v)][0], images[&(g, v)][0], images[&(g, w)][0]]);
        }
    }
    for v in 0..p.points.len() {
        let (ring, closed) = p.ring(&a, v);
        let spokes = if closed { ring.len() } else { ring.len() - 1 };
        let between = |i: usize| -> usize {
            let (x, y) = (ring[i], ring[(i + 1) % ring.len()]);
            let has = |f: &usize| of[images[&(*f, v)][0]].2 == y && of[images[&(*f, v)][0]].3 == x;
            *a.faces[v].iter().find(|f| has(f)).unwrap()
        };
        if spokes >= 3 {
            out.faces.push((0..spokes).map(|i| images[&(between(i), v)][0]).collect());
        }
    }
    // Along its face an image has the corner's interval toward that neighbour; across an edge of the corner, the one toward
    // its other neighbour.
    let mut new = Knots::new();
    for face in &out.faces {
        for i in 0..face.len() {
            let pair = [face[i], face[(i + 1) % face.len()]];
            for [x, y] in [pair, [pair[1], pair[0]]] {
                let ((f, v, before, after), (g, u, ..)) = (of[x], of[y]);
                let interval = if f == g && u != v {
                    d(v, u)
                } else if f == g {
                    // The two images of a corner.
                    if x < y { d(v, after) } else { d(v, before) }
                } else {
                    // Across the edge that both faces have at v; along the rim, across where the curve around v ends.
                    let theirs = [of[y].2, of[y].3];
                    let shared = [before, after].into_iter().find(|w| theirs.contains(w) && !is_rim(v, *w));
                    let crossed = shared.unwrap_or(if is_rim(v, before) { before } else { after });
                    d(v, if crossed == before { after } else { before })
                };
                new.insert((x, y), interval);
            }
        }
    }
    (out, new)
}

/// Random intervals for every vertex and edge of a soup, in both forms.
fn intervals(soup: &Soup, seed: u64, value: impl Fn(u64) -> f32) -> (Soup, Knots) {
    let mut soup = soup.clone();
    let (mut knots, mut state) = (Knots::new(), seed | 1);
    for f in 0..soup.face_count() {
        let face = soup.face(f).to_vec();
        for (i, &v) in face.iter().enumerate() {
            for [x, y] in [[v, face[(i + 1) % face.len()]], [face[(i + 1) % face.len()], v]] {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let d = value(state >> 40);
                knots.insert((x as usize, y as usize), f64::from(d));
                soup.marks.knots.push(([x, y], d));
            }
        }
    }
    (soup, knots)
}

fn exact(mesh: &Mesh) -> Vec<Point> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

#[test]
fn nurss_equals_its_paper() {
    let mut compared = 0;
    let quarters = |r: u64| 0.25 + (r % 16) as f32 / 4.0;
    // One in three is zero: many faces have no c left at all.
    let zeros = |r: u64| if r.is_multiple_of(3) { 0.0 } else { 1.0 + (r % 2) as f32 };
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 {
            continue; // split vertices: tests/conformance.rs
        }
        for (seed, value) in [(1, &quarters as &dyn Fn(u64) -> f32), (2, &zeros)] {
            let (marked, knots) = intervals(&soup, seed, value);
            let mesh = build(&marked);
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let (mut naive, mut knots) = (polygons(&soup), knots.clone());
                for level in 1..=2 {
                    (naive, knots) = nurss(&naive, &knots, boundary);
                    let plan = Plan::new(scheme("nurss").unwrap(), boundary, level);
                    let ours = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
                    assert!(ours.iter().flatten().all(|x| x.is_finite()), "{name}");
                    let d = distance(&ours, &naive.points);
                    assert!(d < 1e-12, "{name}, level {level}, {boundary:?}: off by {d}");
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 100);
}

#[test]
fn equal_intervals_make_it_doo_sabin() {
    for (name, soup) in gallery() {
        let (marked, _) = intervals(&soup, 1, |_| 2.5);
        let (plain, mesh) = (build(&soup), build(&marked));
        assert!(!mesh.knots.is_empty());
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for level in 1..=3 {
                let doo_sabin = Plan::new(scheme("doo-sabin").unwrap(), boundary, level);
                let nurss = Plan { scheme: scheme("nurss").unwrap(), ..doo_sabin.clone() };
                let expected = evaluate(&plain, &doo_sabin, &exact(&plain), |_| ()).unwrap();
                for mesh in [&plain, &mesh] {
                    let ours = evaluate(mesh, &nurss, &exact(mesh), |_| ()).unwrap();
                    for (p, q) in ours.iter().zip(&expected) {
                        assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-12), "{name}: {p:?} and {q:?}");
                    }
                }
            }
        }
    }
}

/// Boehm's insertion of `t` into a quadratic B-spline.
fn insert(knots: &mut Vec<f64>, points: &mut Vec<Point>, t: f64) {
    let k = knots.iter().rposition(|&x| x <= t).unwrap();
    let point = |i: usize| {
        let ratio = |a: f64, b: f64| (t - a) / (b - a);
        let alpha = if i + 2 <= k {
            1.0
        } else if i > k {
            0.0
        } else {
            ratio(knots[i], knots[i + 2])
        };
        match alpha {
            1.0 => points[i],
            0.0 => points[i - 1],
            _ => mix(&[(alpha, points[i]), (1.0 - alpha, points[i - 1])]),
        }
    };
    let new = (0..=points.len()).map(point).collect();
    *points = new;
    knots.insert(k + 1, t);
}

/// The knots of a quadratic B-spline whose control points have these intervals.
fn knots_of(intervals: &[f64]) -> Vec<f64> {
    let mut knots = vec![-1.0, 0.0];
    intervals.iter().for_each(|d| knots.push(knots.last().unwrap() + d));
    knots.push(knots.last().unwrap() + 1.0);
    knots
}

/// Inserts the middle of every interval in between, of `knots` with the control points `lines`.
fn halve(knots: &[f64], lines: &mut [Vec<Point>]) -> Vec<f64> {
    let mut new = knots.to_vec();
    let middles: Vec<f64> = (2..knots.len() - 3).map(|i| (knots[i] + knots[i + 1]) / 2.0).collect();
    for line in lines {
        let mut own = knots.to_vec();
        middles.iter().for_each(|&t| insert(&mut own, line, t));
        new = own;
    }
    new
}

fn transposed(lines: &[Vec<Point>]) -> Vec<Vec<Point>> {
    (0..lines[0].len()).map(|i| lines.iter().map(|l| l[i]).collect()).collect()
}

/// On a grid: the same control points as knot insertion gives, away from the rim (where the surface has a boundary curve of
/// its own).
#[test]
fn grids_are_biquadratic_b_splines() {
    for (columns, rows, levels) in [
        (vec![1.0, 2.0, 0.5, 3.0, 1.0, 0.25, 2.0, 1.5], vec![2.0, 1.0, 4.0, 0.5, 1.0, 1.0, 3.0], 2),
        (vec![1.0, 2.0, 0.0, 3.0, 1.0, 0.0, 2.0], vec![2.0, 1.0, 4.0, 0.0, 1.0, 5.0], 1),
    ] {
        let (w, h) = (columns.len(), rows.len());
        let place = |i: usize, j: usize| {
            let (x, y) = (i as f32, j as f32);
            [x + 0.1 * y * y, y - 0.2 * x, (x * 1.3).sin() + (y * y * 0.7).cos()]
        };
        let id = |i: usize, j: usize| (j * w + i) as u32;
        let mut soup = Soup::default();
        for j in 0..h {
            (0..w).for_each(|i| soup.positions.push(place(i, j)));
        }
        for (i, j) in (0..w - 1).flat_map(|i| (0..h - 1).map(move |j| (i, j))) {
            soup.push_face(&[id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
        for (i, j) in (0..w).flat_map(|i| (0..h).map(move |j| (i, j))) {
            let mut mark = |to: u32, d: f64| soup.marks.knots.push(([id(i, j), to], d as f32));
            for to in [i.wrapping_sub(1), i + 1].into_iter().filter(|&x| x < w) {
                mark(id(to, j), columns[i]);
            }
            for to in [j.wrapping_sub(1), j + 1].into_iter().filter(|&y| y < h) {
                mark(id(i, to), rows[j]);
            }
        }
        let mesh = build(&soup);
        let mut lines: Vec<Vec<Point>> = (0..h).map(|j| (0..w).map(|i| place(i, j).map(f64::from)).collect()).collect();
        let (mut across, mut up) = (knots_of(&columns), knots_of(&rows));
        for level in 1..=levels {
            across = halve(&across, &mut lines);
            let mut turned = transposed(&lines);
            up = halve(&up, &mut turned);
            lines = transposed(&turned);
            let plan = Plan::new(scheme("nurss").unwrap(), Boundary::default(), level);
            let ours = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
            // The outermost control points differ, one more row of them at every level.
            let rim = if level == 1 { 1 } else { 3 };
            let (lines, mut found) = (&lines[rim..lines.len() - rim], 0);
            for p in lines.iter().flat_map(|l| &l[rim..l.len() - rim]) {
                let d = |q: &Point| (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max);
                let nearest = ours.iter().map(d).fold(f64::MAX, f64::min);
                assert!(nearest < 1e-12, "level {level}: {p:?} is {nearest} away");
                found += 1;
            }
            assert!(found > 60, "{found}");
        }
    }
}

/// A vertex goes to a place on the surface that is there after many steps, which it would miss without its intervals; the fast
/// path goes there too.
#[test]
fn limits_take_intervals_into_account() {
    for name in ["cube", "pyramid", "octahedron"] {
        let soup = (limn_mesh::shape(name).unwrap().build)();
        let (marked, _) = intervals(&soup, 7, |r| 0.5 + (r % 8) as f32 / 4.0);
        let (plain, mesh) = (build(&soup), build(&marked));
        let points = exact(&mesh);
        let plan = |level| Plan::new(scheme("nurss").unwrap(), Boundary::default(), level);
        let fine = evaluate(&mesh, &plan(7), &points, |_| ()).unwrap();
        let farthest = |mesh: &Mesh| {
            let goes = evaluate_limit(mesh, &plan(0), &points).unwrap();
            assert!(goes.normals.iter().all(Option::is_some));
            let away = |p: &Point| {
                let d = |q: &Point| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                fine.iter().map(d).fold(f64::MAX, f64::min)
            };
            goes.points.iter().map(away).fold(0.0, f64::max)
        };
        let (with, without) = (farthest(&mesh), farthest(&plain));
        assert!(with < 0.012 && without > 3.0 * with, "{name}: {with} with intervals, {without} without");
        for level in [0, 2] {
            let plan = Plan { limit: true, ..plan(level) };
            let slow = evaluate(&mesh, &plan, &points, |_| ()).unwrap();
            let fast = refine(&mesh, &plan, u64::MAX).unwrap();
            for (p, q) in fast.points.iter().zip(&slow) {
                assert!((0..3).all(|k| (f64::from(p[k]) - q[k]).abs() < 1e-5), "{name}: {p:?} and {q:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Fast path against slow, rows that sum to one, counts, on anything with any intervals.
    #[test]
    fn random_cages_with_random_intervals(soup in cage(), seed in any::<u64>()) {
        let (marked, _) = intervals(&soup, seed, |r| (r % 5) as f32);
        let mesh = build(&marked);
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let plan = Plan::new(scheme("nurss").unwrap(), boundary, 3);
            let sums = evaluate(&mesh, &plan, &vec![[1.0]; mesh.positions.len()], |_| ()).unwrap();
            prop_assert!(sums.iter().all(|s| (s[0] - 1.0).abs() < 1e-13));
            let slow = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
            let fast = refine(&mesh, &plan, u64::MAX).unwrap();
            for (p, q) in fast.points.iter().zip(&slow) {
                prop_assert!((0..3).all(|k| (f64::from(p[k]) - q[k]).abs() < 1e-4), "{:?} and {:?}", p, q);
            }
        }
    }
}

/// What the report on a model promises: intervals of 0 at the vertices of a row, toward those beside it, make a crease of the row.
/// Along the row, or at both ends of an edge (then the formula says nothing), they do not.
#[test]
fn knots_of_zero_across_a_row_make_a_crease() {
    let at = |i: u32, j: u32| 9 * j + i;
    // Quads over a roof whose ridge is the row j = 4.
    let roof = |y: f32| -0.5 * (y - 4.0).abs();
    let positions = (0..81).map(|v| [(v % 9) as f32, (v / 9) as f32, roof((v / 9) as f32)]).collect();
    let cells = (0..64).map(|f| (f % 8, f / 8));
    let quad = |(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    let smooth = Soup::from_faces(positions, &cells.map(quad).collect::<Vec<_>>());
    // Intervals of 0 at the first vertex toward the second.
    let across = (0..9).flat_map(|i| [[at(i, 4), at(i, 3)], [at(i, 4), at(i, 5)]]);
    let one_side = (0..9).map(|i| [at(i, 4), at(i, 3)]);
    let along = (0..8).flat_map(|i| [[at(i, 4), at(i + 1, 4)], [at(i + 1, 4), at(i, 4)]]);
    let both_ends = across.clone().flat_map(|[a, b]| [[a, b], [b, a]]);
    let cases: [(Vec<[u32; 2]>, bool); 5] = [
        (across.collect(), true),
        (one_side.collect(), true),
        (along.collect(), false),
        (both_ends.collect(), false),
        (Vec::new(), false),
    ];
    for (case, (zeros, crease)) in cases.into_iter().enumerate() {
        let mut soup = smooth.clone();
        soup.marks.knots = zeros.into_iter().map(|ends| (ends, 0.0)).collect();
        let plan = Plan::new(scheme("nurss").unwrap(), Boundary::EdgeAndCorner, 4);
        let points = refine(&build(&soup), &plan, u64::MAX).unwrap().points;
        // A crease leaves the roof as it is.
        let off = points.iter().map(|p| (p[2] - roof(p[1])).abs()).fold(0.0, f32::max);
        assert_eq!(off < 1e-5, crease, "case {case}: {off}");
        assert!(crease || off > 0.05, "case {case}: {off}");
    }
}
