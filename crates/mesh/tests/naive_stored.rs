//! Doo-Sabin and sqrt3 against the plainest program that can be written from their papers: polygons, maps, f64, no
//! half-edges. Numbers of vertices differ, so points are matched by place.

mod common;

use common::polygons::{Point, Polygons, compare, mean, mix, polygons};
use common::{build, gallery};
use limn_mesh::Boundary;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A rule for the image of corner `i` of a face.
type Image = fn(&[Point], usize) -> Point;

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
    let mut out = Polygons { points: p.points.clone(), faces: Vec::new() };
    for v in 0..p.points.len() {
        let (ring, closed) = p.ring(&a, v);
        out.points[v] = if closed {
            let n = ring.len() as f64;
            let alpha = (4.0 - 2.0 * (TAU / n).cos()) / 9.0;
            mix(&[(1.0 - alpha, p.points[v]), (alpha, mean(ring.iter().map(|&w| &p.points[w])))])
        } else if trisect && !is_corner(v) {
            let w = 4.0 / 27.0;
            mix(&[(19.0 / 27.0, p.points[v]), (w, p.points[a.rim[v][0]]), (w, p.points[a.rim[v][1]])])
        } else {
            p.points[v]
        };
    }
    // Corners in order from the rim edge on, if there is one and it is cut; else from anywhere.
    let cut: Vec<Option<[usize; 3]>> = p
        .faces
        .iter()
        .map(|f| {
            let turn = |i: usize| [f[i], f[(i + 1) % 3], f[(i + 2) % 3]];
            (0..3).map(turn).find(|t| trisect && a.edges[&(t[0].min(t[1]), t[0].max(t[1]))].len() == 1)
        })
        .collect();
    let mut centres: Vec<Vec<usize>> = Vec::new();
    for (f, face) in p.faces.iter().enumerate() {
        let new = out.points.len();
        match cut[f] {
            None => {
                out.points.push(mean(face.iter().map(|&v| &p.points[v])));
                centres.push(vec![new]);
            }
            Some([x, y, _]) => {
                let beyond = |v: usize, w: usize| match is_corner(v) {
                    true => mix(&[(2.0, p.points[v]), (-1.0, p.points[w])]),
                    false => p.points[*a.rim[v].iter().find(|&&u| u != w).unwrap()],
                };
                let third = |v: usize, w: usize| {
                    mix(&[(16.0 / 27.0, p.points[v]), (10.0 / 27.0, p.points[w]), (1.0 / 27.0, beyond(v, w))])
                };
                out.points.extend([third(x, y), third(y, x)]);
                centres.push(vec![new, new + 1]);
            }
        }
    }
    // What an edge's end (v, w) of face f sees as the face's centre: the rim's points are dealt to the other two edges.
    let centre = |f: usize, v: usize, w: usize| match cut[f] {
        Some([_, y, z]) if [v, w].contains(&y) && [v, w].contains(&z) => centres[f][1],
        _ => centres[f][0],
    };
    for (f, face) in p.faces.iter().enumerate() {
        for i in 0..3 {
            let (v, w) = (face[i], face[(i + 1) % 3]);
            let sides = &a.edges[&(v.min(w), v.max(w))];
            match sides.iter().find(|&&g| g != f) {
                Some(&g) => out.faces.push(vec![v, centre(g, v, w), centre(f, v, w)]),
                None if trisect => out.faces.push(vec![centres[f][0], centres[f][1], face[(i + 2) % 3]]),
                None => out.faces.push(vec![v, w, centres[f][0]]),
            }
        }
    }
    out
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

#[test]
fn sqrt3_equals_its_paper() {
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
            let step = std::cell::Cell::new(0);
            compare(&name, &mesh, "sqrt3", boundary, start, |p| {
                step.set(step.get() + 1);
                sqrt3(p, step.get() % 2 == 0, &corners)
            });
        }
    }
}

/// S. Olsen, "Doo-Sabin subdivision and its reverse" (2004), and the pawn: numbers of faces.
#[test]
fn doo_sabin_makes_the_faces_that_reports_count() {
    let counts = |name: &str, level: u32| {
        let mesh = build(&(limn_mesh::shape(name).unwrap().build)());
        let plan = limn_mesh::Plan::new(limn_mesh::scheme("doo-sabin").unwrap(), Boundary::default(), level);
        let refined = limn_mesh::refine(&mesh, &plan, u64::MAX).unwrap();
        let kinds = [limn_mesh::FaceKind::Face, limn_mesh::FaceKind::Edge, limn_mesh::FaceKind::Vertex];
        (refined.faces.count(), kinds.map(|k| refined.kinds.iter().filter(|x| **x == k).count()))
    };
    assert_eq!(counts("cube", 1), (26, [6, 12, 8]));
    assert_eq!(counts("pawn", 3).0, 14_594);
    assert_eq!(counts("mouse", 3).0, 3_490);
    assert_eq!(counts("mouse", 4).0, 13_954);
}
