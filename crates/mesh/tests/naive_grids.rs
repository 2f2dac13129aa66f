//! Triangles to quads, and the n-way split, against the plainest program that can be written from their description.

mod common;

use common::polygons::{Point, Polygons, compare, mean, mix, polygons};
use common::{build, distance, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, FaceShape, Mesh, Plan, Run, Soup, predict, refine, scheme};
use std::collections::BTreeMap;
use std::sync::Arc;

fn exact(mesh: &Mesh) -> Vec<Point> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

/// Meshes without vertices that were cut apart.
fn whole() -> impl Iterator<Item = (String, Soup, Arc<Mesh>)> {
    let all = gallery().into_iter().filter(|(_, s)| s.face_count() <= 200).map(|(n, s)| (n, build(&s), s));
    all.filter(|(_, m, s)| m.positions.len() == s.positions.len()).map(|(n, m, s)| (n, s, m))
}

/// Centroids and midpoints; then every vertex to the mean of its quads' centroids, by 4 / n; along rims and at corners the
/// curve's rule.
fn tri_to_quad(p: &Polygons, averaged: bool, boundary: Boundary) -> Polygons {
    let a = p.around();
    let mut out = Polygons { points: p.points.clone(), faces: Vec::new() };
    let mut middle = BTreeMap::new();
    for &(v, w) in a.edges.keys() {
        middle.insert((v, w), out.points.len());
        out.points.push(mean([&p.points[v], &p.points[w]]));
    }
    for face in &p.faces {
        let centre = out.points.len();
        out.points.push(mean(face.iter().map(|&v| &p.points[v])));
        let n = face.len();
        for i in 0..n {
            let at = |j: usize| (face[j % n].min(face[(j + 1) % n]), face[j % n].max(face[(j + 1) % n]));
            out.faces.push(vec![face[i], middle[&at(i)], centre, middle[&at(i + n - 1)]]);
        }
    }
    if !averaged {
        return out;
    }
    let around = out.around();
    let mut moved = out.points.clone();
    for (v, place) in moved.iter_mut().enumerate() {
        let own = out.points[v];
        if around.rim[v].is_empty() {
            let quads = &around.faces[v];
            let centroids: Vec<Point> =
                quads.iter().map(|&f| mean(out.faces[f].iter().map(|&w| &out.points[w]))).collect();
            let weight = 4.0 / quads.len() as f64;
            *place = mix(&[(1.0 - weight, own), (weight, mean(&centroids))]);
        } else if v < p.points.len() && !(boundary == Boundary::EdgeAndCorner && a.faces[v].len() == 1) {
            // Averaging the halved curve: a quarter of both midpoints, half of the vertex.
            let [x, y] = around.rim[v][..] else { panic!("a curve") };
            *place = mix(&[(0.5, own), (0.25, out.points[x]), (0.25, out.points[y])]);
        }
    }
    out.points = moved;
    out
}

#[test]
fn triangles_to_quads_equal_their_description() {
    for (name, soup, mesh) in whole().filter(|(_, _, m)| m.face_shape() != FaceShape::Polygons) {
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for (id, averaged) in [("tri-to-quad 0", true), ("tri-to-quad 1", false)] {
                compare(&name, &mesh, id, boundary, polygons(&soup), |p| tri_to_quad(p, averaged, boundary));
            }
        }
        // On quads it is Catmull and Clark's scheme.
        if mesh.face_shape() == FaceShape::Quads {
            let at = |id| {
                let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 2);
                evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap()
            };
            assert!(distance(&at("tri-to-quad"), &at("catmull-clark")) < 1e-12, "{name}");
        }
    }
}

/// Baumgartner's table: a pyramid, a cube, and as many triangles as his dragon has, in a strip.
#[test]
fn triangles_to_quads_make_the_faces_that_the_report_counts() {
    let strip = |n: u32| {
        let positions = (0..n + 2).map(|i| [i as f32, (i % 2) as f32, 0.1 * (i % 7) as f32]).collect();
        let faces: Vec<[u32; 3]> = (0..n).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
        Soup::from_faces(positions, &faces)
    };
    let cube = limn_mesh::triangulate_soup(&(limn_mesh::shape("cube").unwrap().build)()).0;
    for (soup, counts) in [
        (common::fan(3, true), [6, 18, 72, 288, 1_152]),
        (cube, [12, 36, 144, 576, 2_304]),
        (strip(609), [609, 1_827, 7_308, 29_232, 116_928]),
    ] {
        let mesh = build(&soup);
        for (level, count) in (0..).zip(counts) {
            let plan = Plan::new(scheme("tri-to-quad").unwrap(), Boundary::default(), level);
            assert_eq!(refine(&mesh, &plan, u64::MAX).unwrap().faces.count(), count);
            assert_eq!(predict(&mesh, &plan).unwrap().unwrap().counts.faces, count as u64);
        }
    }
}

/// Points are where they are: equal places are one vertex.
struct Places {
    out: Polygons,
    known: BTreeMap<[i64; 3], usize>,
}

impl Places {
    fn face(&mut self, corners: &[Point]) {
        let face = corners.iter().map(|p| {
            // Half a step aside, so that rounding does not part what is equal.
            let key = p.map(|x| (x * 1e7 + 0.271_828).floor() as i64);
            let next = self.known.len();
            let v = *self.known.entry(key).or_insert(next);
            if v == self.out.points.len() {
                self.out.points.push(*p);
            }
            v
        });
        let face = face.collect();
        self.out.faces.push(face);
    }
}

fn n_way(p: &Polygons, n: usize) -> Polygons {
    let mut places = Places { out: Polygons { points: Vec::new(), faces: Vec::new() }, known: BTreeMap::new() };
    let size = n as f64;
    for face in &p.faces {
        let at = |i: usize| p.points[face[i % face.len()]];
        let k = face.len();
        if k == 3 {
            let point = |x: usize, y: usize| {
                let (x, y) = (x as f64 / size, y as f64 / size);
                mix(&[(1.0 - x - y, at(0)), (x, at(1)), (y, at(2))])
            };
            for (x, y) in (0..n).flat_map(|x| (0..n - x).map(move |y| (x, y))) {
                places.face(&[point(x, y), point(x + 1, y), point(x, y + 1)]);
                if x + y + 2 <= n {
                    places.face(&[point(x + 1, y), point(x + 1, y + 1), point(x, y + 1)]);
                }
            }
            continue;
        }
        let centre = mean(&(0..k).map(at).collect::<Vec<_>>());
        let point = |i: usize, x: usize, y: usize| {
            let (x, y) = (2.0 * x as f64 / size, 2.0 * y as f64 / size);
            let (along, back) = (mean([&at(i), &at(i + 1)]), mean([&at(i), &at(i + k - 1)]));
            mix(&[((1.0 - x) * (1.0 - y), at(i)), (x * (1.0 - y), along), (x * y, centre), ((1.0 - x) * y, back)])
        };
        let half = n / 2;
        for i in 0..k {
            for (x, y) in (0..half).flat_map(|x| (0..half).map(move |y| (x, y))) {
                places.face(&[point(i, x, y), point(i, x + 1, y), point(i, x + 1, y + 1), point(i, x, y + 1)]);
            }
            if n % 2 == 1 {
                for y in 0..half {
                    let far = |y| point((i + 1) % k, y, half);
                    places.face(&[point(i, half, y), far(y), far(y + 1), point(i, half, y + 1)]);
                }
            }
        }
        if n % 2 == 1 {
            places.face(&(0..k).map(|i| point(i, half, half)).collect::<Vec<_>>());
        }
    }
    places.out
}

#[test]
fn n_way_equals_its_description() {
    for (name, soup, mesh) in whole().filter(|(_, s, _)| s.face_count() <= 60) {
        if soup.face_count() <= 20 {
            for n in [2, 3] {
                compare(&name, &mesh, &format!("n-way {n}"), Boundary::default(), polygons(&soup), |p| n_way(p, n));
            }
        }
        for n in 2..=7 {
            let mut plan = Plan::new(scheme("n-way").unwrap(), Boundary::default(), 1);
            assert!(plan.params.set(&plan.scheme.info, 0, n as f64));
            let (ours, naive) = (evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap(), n_way(&polygons(&soup), n));
            assert!(distance(&ours, &naive.points) < 1e-12, "{name}, {n}");
            assert_eq!(refine(&mesh, &plan, u64::MAX).unwrap().faces.count(), naive.faces.len(), "{name}, {n}");
        }
    }
}

/// Two and two parts are four, two and three are six; two are the linear scheme's.
#[test]
fn n_way_multiplies() {
    let n_way = scheme("n-way").unwrap();
    let run = |from: u32, n: u32| {
        let mut run = Run { from, scheme: n_way, params: Default::default() };
        assert!(run.params.set(&n_way.info, 0, f64::from(n)));
        run
    };
    for (name, _, mesh) in whole().filter(|(_, s, m)| s.face_count() <= 30 && m.face_shape() != FaceShape::Polygons) {
        let points = |first: u32, second: Option<u32>| {
            let mut plan = Plan::new(n_way, Boundary::default(), 1 + u32::from(second.is_some()));
            plan.params = run(0, first).params;
            plan.later.extend(second.map(|n| run(1, n)));
            evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap()
        };
        let linear = |level| {
            let plan = Plan::new(scheme("linear").unwrap(), Boundary::default(), level);
            evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap()
        };
        for (a, b) in [
            (points(4, None), points(2, Some(2))),
            (points(6, None), points(3, Some(2))),
            (points(6, None), points(2, Some(3))),
            (points(2, None), linear(1)),
            (points(4, None), linear(2)),
        ] {
            assert!(distance(&a, &b) < 1e-12, "{name}");
        }
    }
}

/// A planar face keeps its place: its pieces fill it, facing as it does.
#[test]
fn n_way_keeps_planar_faces() {
    for k in 3..=9 {
        let prism = common::prism(k);
        let mesh = build(&prism);
        let area = |points: &[[f32; 3]], face: &[u32]| -> [f64; 3] {
            let p = |v: u32| points[v as usize].map(f64::from);
            let mut sum = [0.0; 3];
            for w in face[1..].windows(2) {
                let [a, b] = [w[0], w[1]].map(|v| [0, 1, 2].map(|i| p(v)[i] - p(face[0])[i]));
                let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                (0..3).for_each(|i| sum[i] += cross[i] / 2.0);
            }
            sum
        };
        for n in 2..=5 {
            let mut plan = Plan::new(scheme("n-way").unwrap(), Boundary::default(), 1);
            assert!(plan.params.set(&plan.scheme.info, 0, f64::from(n)));
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            let mut sums = vec![([0.0; 3], 0.0); prism.face_count()];
            for f in 0..refined.faces.count() {
                let own = area(&refined.points, refined.faces.face(f));
                let sum = &mut sums[refined.face_source(f as u32) as usize];
                (0..3).for_each(|i| sum.0[i] += own[i]);
                sum.1 += own.iter().map(|x| x * x).sum::<f64>().sqrt();
            }
            for (f, (sum, size)) in sums.iter().enumerate() {
                let whole = area(&prism.positions, prism.face(f));
                let length = whole.iter().map(|x| x * x).sum::<f64>().sqrt();
                // The sum of areas is that of the face, and no piece is turned over.
                assert!((0..3).all(|i| (sum[i] - whole[i]).abs() < 1e-5) && (size - length).abs() < 1e-5, "{k}, {n}");
            }
        }
    }
}
