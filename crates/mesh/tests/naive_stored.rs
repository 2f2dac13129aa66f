//! Schemes whose levels are stored in full against the plainest program that can be written from their papers: polygons, maps, f64, no
//! half-edges. Numbers of vertices differ, so points are matched by place.

mod common;

use common::polygons::{Point, Polygons, compare, mean, mix, polygons, turned};
use common::{build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, FaceKind, Plan, predict, refine, scheme};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A rule for the image of corner `i` of a face.
type Image = fn(&[Point], usize) -> Point;
/// A step of the sqrt3 split: whether rims are cut, and their corners.
type Turning = fn(&Polygons, bool, &[usize]) -> Polygons;

fn doo_sabin(face: &[Point], i: usize) -> Point {
    let n = face.len() as f64;
    let weight = |j: usize| match j == i {
        true => 0.25 + 5.0 / (4.0 * n),
        false => (3.0 + 2.0 * (TAU * (j as f64 - i as f64) / n).cos()) / (4.0 * n),
    };
    mix(&face.iter().enumerate().map(|(j, p)| (weight(j), *p)).collect::<Vec<_>>())
}

fn midpoint(face: &[Point], i: usize) -> Point {
    let n = face.len();
    let mids = [(i + 1) % n, (i + n - 1) % n].map(|j| mean([&face[i], &face[j]]));
    mean([&face[i], &mids[0], &mids[1], &mean(face)])
}

/// Doo and Sabin 1978; along boundaries Chaikin's curve, with v-faces wherever three faces meet.
fn dual(p: &Polygons, image: Image, boundary: Boundary) -> Polygons {
    let a = p.around();
    let mut out = Polygons { points: Vec::new(), faces: Vec::new() };
    // The image of vertex v in face f; at a rounded corner the two, in the face's order.
    let mut images: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    let is_rim = |v: usize, w: usize| a.edges[&(v.min(w), v.max(w))].len() == 1;
    for (f, face) in p.faces.iter().enumerate() {
        let n = face.len();
        let points: Vec<Point> = face.iter().map(|&v| p.points[v]).collect();
        for (i, &v) in face.iter().enumerate() {
            let (before, after) = (face[(i + n - 1) % n], face[(i + 1) % n]);
            let cut = |w: usize| mix(&[(0.75, p.points[v]), (0.25, p.points[w])]);
            let places = match (is_rim(before, v), is_rim(v, after)) {
                (false, false) => vec![image(&points, i)],
                (true, false) => vec![cut(before)],
                (false, true) => vec![cut(after)],
                (true, true) if boundary == Boundary::EdgeAndCorner => vec![p.points[v]],
                (true, true) => vec![cut(before), cut(after)],
            };
            let first = out.points.len();
            images.insert((f, v), (first..first + places.len()).collect());
            out.points.extend(places);
        }
        out.faces.push(face.iter().flat_map(|&v| images[&(f, v)].clone()).collect());
    }
    for (&(v, w), faces) in &a.edges {
        if let [f, g] = faces[..] {
            // In f the edge runs from v to w or the other way; the new face lies between.
            let at = p.faces[f].iter().position(|&x| x == v).unwrap();
            let (v, w) = if p.faces[f][(at + 1) % p.faces[f].len()] == w { (v, w) } else { (w, v) };
            out.faces.push(vec![images[&(f, w)][0], images[&(f, v)][0], images[&(g, v)][0], images[&(g, w)][0]]);
        }
    }
    for v in 0..p.points.len() {
        let (ring, closed) = p.ring(&a, v);
        let spokes = if closed { ring.len() } else { ring.len() - 1 };
        // The face between two neighbours that follow each other.
        let between = |i: usize| -> usize {
            let (x, y) = (ring[i], ring[(i + 1) % ring.len()]);
            *a.faces[v]
                .iter()
                .find(|&&f| {
                    let face = &p.faces[f];
                    let at = face.iter().position(|&w| w == v).unwrap();
                    face[(at + 1) % face.len()] == x && face[(at + face.len() - 1) % face.len()] == y
                })
                .unwrap()
        };
        if spokes >= 3 {
            out.faces.push((0..spokes).map(|i| images[&(between(i), v)][0]).collect());
        }
    }
    out
}

/// Kobbelt 2000: centroids, turned edges, relaxed vertices; boundaries trisected in every second step.
fn sqrt3(p: &Polygons, trisect: bool, corners: &[usize]) -> Polygons {
    let a = p.around();
    let is_corner = |v: usize| corners.contains(&v);
    let mut old = p.points.clone();
    for (v, place) in old.iter_mut().enumerate() {
        let (ring, closed) = p.ring(&a, v);
        if closed {
            let n = ring.len() as f64;
            let alpha = (4.0 - 2.0 * (TAU / n).cos()) / 9.0;
            *place = mix(&[(1.0 - alpha, p.points[v]), (alpha, mean(ring.iter().map(|&w| &p.points[w])))]);
        } else if trisect && !is_corner(v) {
            let w = 4.0 / 27.0;
            *place = mix(&[(19.0 / 27.0, p.points[v]), (w, p.points[a.rim[v][0]]), (w, p.points[a.rim[v][1]])]);
        }
    }
    let third = |v: usize, w: usize| {
        let beyond = match is_corner(v) {
            true => mix(&[(2.0, p.points[v]), (-1.0, p.points[w])]),
            false => p.points[*a.rim[v].iter().find(|&&u| u != w).unwrap()],
        };
        mix(&[(16.0 / 27.0, p.points[v]), (10.0 / 27.0, p.points[w]), (1.0 / 27.0, beyond)])
    };
    turned(p, &a, trisect, old, |f| mean(p.faces[f].iter().map(|&v| &p.points[v])), third)
}

/// Labsik and Greiner 2000: vertices stay, centres by twelve points or by the rings of irregular vertices.
fn interpolating_sqrt3(p: &Polygons, trisect: bool, corners: &[usize]) -> Polygons {
    let a = p.around();
    // The third vertex of the face beside edge (v, w) that is not `f`; beyond a rim none.
    let across = |f: usize, v: usize, w: usize| -> Option<(usize, usize)> {
        let g = *a.edges[&(v.min(w), v.max(w))].iter().find(|&&g| g != f)?;
        Some((g, *p.faces[g].iter().find(|&&u| u != v && u != w).unwrap()))
    };
    let valence = |v: usize| Some(a.neighbours[v].len()).filter(|&n| a.rim[v].is_empty() && n != 6);
    // The rule of an irregular vertex for the face between its neighbours v and w.
    let ring = |at: usize, v: usize, w: usize| -> Point {
        let (mut ring, _) = p.ring(&a, at);
        let n = ring.len();
        let first = ring.iter().position(|&u| u == v).unwrap();
        ring.rotate_left(first);
        if ring[1] == w {
            ring.reverse();
            ring.rotate_right(1);
        }
        assert_eq!((ring[0], ring[n - 1]), (v, w));
        let c = 2.0 / 3.0 * (TAU / (2.0 * n as f64)).cos();
        let (own, weights): (f64, Vec<f64>) = match n {
            3 => (8.0 / 9.0, vec![4.0 / 27.0, -5.0 / 27.0, 4.0 / 27.0]),
            4 => (7.0 / 9.0, vec![2.0 / 9.0, -1.0 / 9.0, -1.0 / 9.0, 2.0 / 9.0]),
            _ => {
                let angle = |j: usize| TAU * (2 * j + 1) as f64 / (2.0 * n as f64);
                let weight = |j| (c * c + 2.0 * c * angle(j).cos() + 2.0 * c * c * (2.0 * angle(j)).cos()) / n as f64;
                (1.0 - c * c, (0..n).map(weight).collect())
            }
        };
        let terms = ring.iter().zip(weights).map(|(&u, w)| (w, p.points[u])).chain([(own, p.points[at])]);
        mix(&terms.collect::<Vec<_>>())
    };
    let centre = |f: usize| -> Point {
        let face = &p.faces[f];
        let at = |i: usize| face[i % 3];
        let open: Vec<usize> = (0..3).filter(|&i| across(f, at(i), at(i + 1)).is_none()).collect();
        let point = |v: usize| p.points[v];
        match open[..] {
            [] => {
                let irregular: Vec<Point> =
                    (0..3).filter(|&i| valence(at(i)).is_some()).map(|i| ring(at(i), at(i + 1), at(i + 2))).collect();
                if !irregular.is_empty() {
                    return mean(&irregular);
                }
                let mut terms: Vec<(f64, Point)> = face.iter().map(|&v| (32.0 / 81.0, point(v))).collect();
                for i in 0..3 {
                    let (v, w) = (at(i), at(i + 1));
                    let (g, tip) = across(f, v, w).unwrap();
                    terms.push((-1.0 / 81.0, point(tip)));
                    for (end, other) in [(v, w), (w, v)] {
                        let far = match across(g, end, tip) {
                            Some((_, far)) => point(far),
                            None => mix(&[(1.0, point(end)), (1.0, point(tip)), (-1.0, point(other))]),
                        };
                        terms.push((-2.0 / 81.0, far));
                    }
                }
                mix(&terms)
            }
            [i] => {
                let (v, w, r) = (at(i), at(i + 1), at(i + 2));
                if valence(r).is_some() {
                    return ring(r, v, w);
                }
                let tips = [(w, r), (r, v)].map(|(x, y)| (-1.0 / 12.0, point(across(f, x, y).unwrap().1)));
                mix(&[(0.5, point(r)), (1.0 / 3.0, point(v)), (1.0 / 3.0, point(w)), tips[0], tips[1]])
            }
            [_, _] => {
                let i = (0..3).find(|i| !open.contains(i)).unwrap();
                let (v, w, between) = (at(i), at(i + 1), at(i + 2));
                let (three_eighths, tip) = (3.0 / 8.0, across(f, v, w).unwrap().1);
                mix(&[
                    (7.0 / 24.0, point(between)),
                    (three_eighths, point(v)),
                    (three_eighths, point(w)),
                    (-1.0 / 24.0, point(tip)),
                ])
            }
            _ => mean(face.iter().map(|&v| &p.points[v])),
        }
    };
    let third = |v: usize, w: usize| {
        let behind = |v: usize, w: usize| match corners.contains(&v) {
            true => mix(&[(2.0, p.points[v]), (-1.0, p.points[w])]),
            false => p.points[*a.rim[v].iter().find(|&&u| u != w).unwrap()],
        };
        // The cubic through parameters -1, 0, 1, 2 at 1/3.
        let nodes = [(-1.0, behind(v, w)), (0.0, p.points[v]), (1.0, p.points[w]), (2.0, behind(w, v))];
        let lagrange = |x: f64| nodes.iter().filter(|n| n.0 != x).map(|n| (1.0 / 3.0 - n.0) / (x - n.0)).product();
        mix(&nodes.map(|(x, q)| (lagrange(x), q)))
    };
    turned(p, &a, trisect, p.points.clone(), centre, third)
}

#[test]
fn dual_schemes_equal_their_papers() {
    let mut compared = 0;
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 {
            continue; // split vertices: tests/conformance.rs
        }
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for (id, image) in [("doo-sabin", doo_sabin as Image), ("doo-sabin-midpoint", midpoint)] {
                compare(&name, &mesh, id, boundary, polygons(&soup), |p| dual(p, image, boundary));
                compared += 1;
            }
        }
    }
    assert!(compared > 100);
}

/// Peters and Reif 1997; the rim's vertices are kept in every first step and cut off in every second.
fn mid_edge(p: &Polygons, cut: bool, boundary: Boundary) -> Polygons {
    let a = p.around();
    let points = a.edges.keys().map(|e| mean([&p.points[e.0], &p.points[e.1]])).collect();
    let mut out = Polygons { points, faces: Vec::new() };
    let number: BTreeMap<(usize, usize), usize> = a.edges.keys().enumerate().map(|(i, e)| (*e, i)).collect();
    let middle = |v: usize, w: usize| number[&(v.min(w), v.max(w))];
    let mut kept = BTreeMap::new();
    for v in (0..p.points.len()).filter(|&v| !a.rim[v].is_empty()) {
        let alone = a.faces[v].len() == 1 && p.faces[a.faces[v][0]].len() == 3;
        if !cut || (alone && boundary == Boundary::EdgeAndCorner) {
            kept.insert(v, out.points.len());
            out.points.push(p.points[v]);
        }
    }
    for face in &p.faces {
        let mut corners = Vec::new();
        for (i, &v) in face.iter().enumerate() {
            corners.push(middle(face[(i + face.len() - 1) % face.len()], v));
            corners.extend(kept.get(&v).filter(|_| cut));
        }
        out.faces.push(corners);
    }
    for v in 0..p.points.len() {
        let (ring, _) = p.ring(&a, v);
        let mut corners: Vec<usize> = ring.iter().map(|&w| middle(v, w)).collect();
        corners.extend(kept.get(&v).filter(|_| !cut));
        if corners.len() >= 3 {
            out.faces.push(corners);
        }
    }
    out
}

#[test]
fn mid_edge_equals_its_paper() {
    let image = |face: &[Point], i: usize| {
        let n = face.len();
        mix(&[(0.5, face[i]), (0.25, face[(i + 1) % n]), (0.25, face[(i + n - 1) % n])])
    };
    let mut compared = [0, 0];
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 200 {
            continue;
        }
        let positions: Vec<Point> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let (mut naive, mut twice) = (polygons(&soup), polygons(&soup));
            for level in 1..=4 {
                naive = mid_edge(&naive, level % 2 == 0, boundary);
                let plan = Plan::new(scheme("mid-edge").unwrap(), boundary, level);
                let refined = refine(&mesh, &plan, u64::MAX).unwrap();
                let ours = evaluate(&mesh, &plan, &positions, |_| ()).unwrap();
                assert_eq!(refined.faces.count(), naive.faces.len(), "{name}, level {level}, {boundary:?}");
                let d = common::distance(&ours, &naive.points);
                assert!(d < 1e-12, "{name}, level {level}, {boundary:?}: off by {d}");
                let faces = refined.kinds.iter().filter(|k| **k == FaceKind::Face).count() as u64;
                assert_eq!(
                    faces,
                    predict(&mesh, &plan.to(level - 1)).unwrap().unwrap().counts.faces,
                    "{name}: f-faces"
                );
                compared[0] += 1;
                // Closed, two steps are one of a dual scheme.
                if level % 2 == 0 && mesh.counts().boundary == 0 {
                    twice = dual(&twice, image, boundary);
                    let d = common::distance(&ours, &twice.points);
                    assert!(d < 1e-12, "{name}, level {level}: off by {d}");
                    compared[1] += 1;
                }
            }
        }
    }
    assert!(compared[0] > 200 && compared[1] > 50);
}

/// The rim of two steps is Chaikin's.
#[test]
fn mid_edge_cuts_the_rim_s_corners() {
    let soup = (limn_mesh::shape("grid").unwrap().build)();
    let mesh = build(&soup);
    let rim = |p: &Polygons| -> Vec<[Point; 2]> {
        let edges = p.around().edges.into_iter().filter(|e| e.1.len() == 1);
        edges.map(|((v, w), _)| [p.points[v], p.points[w]]).collect()
    };
    let mut expected: Vec<Point> = Vec::new();
    for [v, w] in rim(&polygons(&soup)) {
        expected.extend([mix(&[(0.75, v), (0.25, w)]), mix(&[(0.25, v), (0.75, w)])]);
    }
    let refined = refine(&mesh, &Plan::new(scheme("mid-edge").unwrap(), Boundary::EdgeOnly, 2), u64::MAX).unwrap();
    let faces = (0..refined.faces.count()).map(|f| refined.faces.face(f).iter().map(|v| *v as usize).collect());
    let points = refined.points.iter().map(|p| p.map(f64::from)).collect();
    let ours = rim(&Polygons { points, faces: faces.collect() });
    assert_eq!(ours.len(), expected.len());
    let starts: Vec<Point> = ours.iter().flatten().copied().collect();
    let twice: Vec<Point> = expected.iter().flat_map(|p| [*p, *p]).collect();
    assert!(common::distance(&starts, &twice) < 1e-6);
}

/// A triangle for every side of every face.
#[test]
fn poke_equals_its_picture() {
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 200 {
            continue;
        }
        compare(&name, &mesh, "poke", Boundary::default(), polygons(&soup), |p| {
            let mut out = Polygons { points: p.points.clone(), faces: Vec::new() };
            for face in &p.faces {
                let middle = out.points.len();
                out.points.push(mean(face.iter().map(|&v| &p.points[v])));
                out.faces.extend((0..face.len()).map(|i| vec![face[i], face[(i + 1) % face.len()], middle]));
            }
            out
        });
    }
}

#[test]
fn sqrt3_schemes_equal_their_papers() {
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 || !mesh.is_triangles() {
            continue;
        }
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let start = polygons(&soup);
            let a = start.around();
            let lone = |v: &usize| boundary == Boundary::EdgeAndCorner && a.faces[*v].len() == 1;
            let corners: Vec<usize> = (0..start.points.len()).filter(lone).collect();
            for (id, rule) in [("sqrt3", sqrt3 as Turning), ("interpolating-sqrt3", interpolating_sqrt3)] {
                let step = std::cell::Cell::new(0);
                compare(&name, &mesh, id, boundary, start.clone(), |p| {
                    step.set(step.get() + 1);
                    rule(p, step.get() % 2 == 0, &corners)
                });
            }
        }
    }
}

/// S. Olsen, "Doo-Sabin subdivision and its reverse" (2004), and the pawn: numbers of faces.
#[test]
fn doo_sabin_makes_the_faces_that_reports_count() {
    let counts = |name: &str, level: u32| {
        let mesh = build(&(limn_mesh::shape(name).unwrap().build)());
        let plan = Plan::new(scheme("doo-sabin").unwrap(), Boundary::default(), level);
        let refined = refine(&mesh, &plan, u64::MAX).unwrap();
        let kinds = [FaceKind::Face, FaceKind::Edge, FaceKind::Vertex];
        (refined.faces.count(), kinds.map(|k| refined.kinds.iter().filter(|x| **x == k).count()))
    };
    assert_eq!(counts("cube", 1), (26, [6, 12, 8]));
    assert_eq!(counts("pawn", 3).0, 14_594);
    assert_eq!(counts("mouse", 3).0, 3_490);
    assert_eq!(counts("mouse", 4).0, 13_954);
}
