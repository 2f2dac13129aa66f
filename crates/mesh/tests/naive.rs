//! Schemes against the plainest program that can be written from their papers: polygons, maps, f64, no half-edges.

mod common;

use common::polygons::{Around, Point, Polygons, compare, mean, mix, polygons};
use common::{build, gallery};
use limn_mesh::{Boundary, Plan, scheme};
use std::collections::BTreeMap;

impl Polygons {
    /// Old vertices, then one point a face (quads) and one an edge.
    fn split(&self, a: &Around, triangles: bool) -> Polygons {
        let mut points = self.points.clone();
        if !triangles {
            points.extend(self.faces.iter().map(|f| mean(f.iter().map(|&v| &self.points[v]))));
        }
        let first_edge = points.len();
        let edge: BTreeMap<_, _> = a.edges.keys().enumerate().map(|(i, &k)| (k, first_edge + i)).collect();
        points.extend(a.edges.keys().map(|&(v, w)| mean([&self.points[v], &self.points[w]])));
        let mut faces = Vec::new();
        for (f, face) in self.faces.iter().enumerate() {
            let n = face.len();
            let e = |i: usize| {
                let (v, w) = (face[i % n], face[(i + 1) % n]);
                edge[&(v.min(w), v.max(w))]
            };
            for (i, &v) in face.iter().enumerate() {
                if triangles {
                    faces.push(vec![v, e(i), e(i + n - 1)]);
                } else {
                    faces.push(vec![v, e(i), self.points.len() + f, e(i + n - 1)]);
                }
            }
            if triangles {
                faces.push((0..n).map(e).collect());
            }
        }
        Polygons { points, faces }
    }

    fn rim_rule(&self, a: &Around, v: usize, boundary: Boundary) -> Option<Point> {
        if a.rim[v].is_empty() {
            return None;
        }
        if boundary == Boundary::EdgeAndCorner && a.faces[v].len() == 1 {
            return Some(self.points[v]);
        }
        Some(mix(&[(0.75, self.points[v]), (0.125, self.points[a.rim[v][0]]), (0.125, self.points[a.rim[v][1]])]))
    }

    /// Catmull and Clark 1978: (Q + 2R + (n - 3) S) / n.
    fn catmull_clark(&self, boundary: Boundary) -> Polygons {
        let a = self.around();
        let mut out = self.split(&a, false);
        let f0 = self.points.len();
        for (i, (&(v, w), faces)) in a.edges.iter().enumerate() {
            if let [f, g] = faces[..] {
                let four = [self.points[v], self.points[w], out.points[f0 + f], out.points[f0 + g]];
                out.points[f0 + self.faces.len() + i] = mean(&four);
            }
        }
        for v in 0..f0 {
            out.points[v] = self.rim_rule(&a, v, boundary).unwrap_or_else(|| {
                let n = a.neighbours[v].len() as f64;
                let q = mean(a.faces[v].iter().map(|&f| &out.points[f0 + f]));
                let mids: Vec<Point> =
                    a.neighbours[v].iter().map(|&w| mean([&self.points[v], &self.points[w]])).collect();
                mix(&[(1.0 / n, q), (2.0 / n, mean(&mids)), ((n - 3.0) / n, self.points[v])])
            });
        }
        out
    }

    /// Loop 1987; Warren 1995 with 3 / (8 n) from valence 4 on.
    fn loop_(&self, boundary: Boundary, warren: bool) -> Polygons {
        let a = self.around();
        let mut out = self.split(&a, true);
        for (i, (&(v, w), faces)) in a.edges.iter().enumerate() {
            if faces.len() == 2 {
                let other = |f: usize| *self.faces[f].iter().find(|&&x| x != v && x != w).unwrap();
                out.points[self.points.len() + i] = mix(&[
                    (0.375, self.points[v]),
                    (0.375, self.points[w]),
                    (0.125, self.points[other(faces[0])]),
                    (0.125, self.points[other(faces[1])]),
                ]);
            }
        }
        for v in 0..self.points.len() {
            out.points[v] = self.rim_rule(&a, v, boundary).unwrap_or_else(|| {
                let n = a.neighbours[v].len() as f64;
                let c = 3.0 / 8.0 + (std::f64::consts::TAU / n).cos() / 4.0;
                // The vertex's own weight.
                let alpha = if warren && n > 3.0 { 1.0 - n * (3.0 / (8.0 * n)) } else { 3.0 / 8.0 + c * c };
                let ring = mean(a.neighbours[v].iter().map(|&w| &self.points[w]));
                mix(&[(alpha, self.points[v]), (1.0 - alpha, ring)])
            });
        }
        out
    }

    /// The other neighbour along the rim: from `w` through `v`; the straight continuation where the rim ends at a corner.
    fn further(&self, a: &Around, v: usize, w: usize, boundary: Boundary) -> Point {
        if boundary == Boundary::EdgeAndCorner && a.faces[v].len() == 1 {
            return mix(&[(2.0, self.points[v]), (-1.0, self.points[w])]);
        }
        self.points[*a.rim[v].iter().find(|&&x| x != w).unwrap()]
    }

    /// Triangles split, with new points given by `rule` of each edge's ends and faces.
    fn interpolated(&self, rule: impl Fn(&Around, usize, usize, &[usize]) -> Point) -> Polygons {
        let a = self.around();
        let mut out = self.split(&a, true);
        for (i, (&(v, w), faces)) in a.edges.iter().enumerate() {
            out.points[self.points.len() + i] = rule(&a, v, w, faces);
        }
        out
    }

    fn four_points(&self, a: &Around, v: usize, w: usize, tension: f64, boundary: Boundary) -> Point {
        let outer = [self.further(a, v, w, boundary), self.further(a, w, v, boundary)];
        let near = 0.5 + tension;
        mix(&[(near, self.points[v]), (near, self.points[w]), (-tension, outer[0]), (-tension, outer[1])])
    }

    /// The third corner of the triangle beyond edge (v, w), seen from the triangle whose third corner is `inner`.
    fn beyond(&self, a: &Around, v: usize, w: usize, inner: usize) -> Point {
        let third = |f: &usize| *self.faces[*f].iter().find(|&&x| x != v && x != w).unwrap();
        let sides = &a.edges[&(v.min(w), v.max(w))];
        match sides.iter().map(third).position(|x| x == inner) {
            Some(i) if sides.len() == 2 => self.points[third(&sides[1 - i])],
            _ => mix(&[(1.0, self.points[v]), (1.0, self.points[w]), (-1.0, self.points[inner])]),
        }
    }

    fn eight_points(&self, a: &Around, v: usize, w: usize, faces: &[usize], tension: f64) -> Point {
        let mut terms = vec![(0.5, self.points[v]), (0.5, self.points[w])];
        for f in faces {
            let c = *self.faces[*f].iter().find(|&&x| x != v && x != w).unwrap();
            terms.push((2.0 * tension, self.points[c]));
            terms.push((-tension, self.beyond(a, v, c, w)));
            terms.push((-tension, self.beyond(a, w, c, v)));
        }
        mix(&terms)
    }

    /// Dyn, Levin and Gregory 1990.
    fn butterfly(&self, tension: f64, boundary: Boundary) -> Polygons {
        self.interpolated(|a, v, w, faces| match faces.len() {
            1 => self.four_points(a, v, w, tension, boundary),
            _ => self.eight_points(a, v, w, faces, tension),
        })
    }

    /// Zorin, Schroeder and Sweldens 1996, and the crease rule of the notes of 2000.
    fn modified_butterfly(&self, boundary: Boundary) -> Polygons {
        use std::f64::consts::PI;
        let own = |a: &Around, v: usize, w: usize| -> Option<Point> {
            let (ring, closed) = self.ring(a, v);
            let at = ring.iter().position(|&x| x == w).unwrap();
            let p = |j: usize| self.points[ring[j % ring.len()]];
            if closed {
                let k = ring.len();
                let weights: Vec<f64> = match k {
                    6 => return None,
                    3 => vec![5.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0],
                    4 => vec![3.0 / 8.0, 0.0, -1.0 / 8.0, 0.0],
                    _ => (0..k)
                        .map(|j| j as f64 / k as f64)
                        .map(|t| (0.25 + (2.0 * PI * t).cos() + 0.5 * (4.0 * PI * t).cos()) / k as f64)
                        .collect(),
                };
                let mut terms: Vec<_> = weights.iter().enumerate().map(|(j, &s)| (s, p(at + j))).collect();
                terms.push((0.75, self.points[v]));
                return Some(mix(&terms));
            }
            let k = ring.len() - 1;
            if k == 3 {
                return None;
            }
            let (n, t, i) = (k as f64, PI / k as f64, at as f64);
            let end =
                0.25 * (i * t).cos() - (2.0 * t).sin() * (2.0 * t * i).sin() / (4.0 * n * (t.cos() - (2.0 * t).cos()));
            let mut terms = vec![
                (1.0 - t.sin() * (i * t).sin() / (n * (1.0 - t.cos())), self.points[v]),
                (end, p(0)),
                (-end, p(k)),
            ];
            for j in 1..k {
                let s = j as f64;
                let weight = ((i * t).sin() * (s * t).sin() + 0.5 * (2.0 * i * t).sin() * (2.0 * s * t).sin()) / n;
                terms.push((weight, p(j)));
            }
            Some(mix(&terms))
        };
        self.interpolated(|a, v, w, faces| {
            if faces.len() == 1 {
                return self.four_points(a, v, w, 1.0 / 16.0, boundary);
            }
            match (own(a, v, w), own(a, w, v)) {
                (None, None) => self.eight_points(a, v, w, faces, 1.0 / 16.0),
                (Some(p), None) | (None, Some(p)) => p,
                (Some(p), Some(q)) => mean([&p, &q]),
            }
        })
    }

    /// Jarek's scheme and its kin.
    fn j_spline(&self, s: f64, moves: bool, boundary: Boundary) -> Polygons {
        let a = self.around();
        let toward = |v: usize| -> Point {
            let corner = boundary == Boundary::EdgeAndCorner && a.faces[v].len() == 1;
            let around: Vec<usize> = match (a.rim[v].is_empty(), corner) {
                (true, _) => a.neighbours[v].iter().copied().collect(),
                (false, false) => a.rim[v].clone(),
                (false, true) => vec![v],
            };
            mix(&[(1.0, mean(around.iter().map(|&w| &self.points[w]))), (-1.0, self.points[v])])
        };
        let mut out = self.interpolated(|_, v, w, _| {
            let m = mean([&self.points[v], &self.points[w]]);
            mix(&[(1.0, m), (-(1.0 - s) / 8.0, toward(v)), (-(1.0 - s) / 8.0, toward(w))])
        });
        if moves {
            for v in 0..self.points.len() {
                out.points[v] = mix(&[(1.0, self.points[v]), (s / 4.0, toward(v))]);
            }
        }
        out
    }

    /// A linear split, then every vertex goes toward the mean of its faces' weighted centroids (the vertex itself counts
    /// `own`, the face's other corners share the rest), by a factor of its valence (Schaefer and Warren 2003, whom the
    /// factored program follows).
    fn factored(&self, triangles: bool, own: f64, factor: impl Fn(f64) -> f64) -> Polygons {
        let mut out = self.split(&self.around(), triangles);
        let a = out.around();
        let before = out.points.clone();
        for v in 0..before.len() {
            let mut centroids = Vec::new();
            for &f in &a.faces[v] {
                let face = &out.faces[f];
                let rest = (1.0 - own) / (face.len() - 1) as f64;
                centroids
                    .push(mix(&face.iter().map(|&w| (if w == v { own } else { rest }, before[w])).collect::<Vec<_>>()));
            }
            let w = factor(a.faces[v].len() as f64);
            out.points[v] = mix(&[(1.0 - w, before[v]), (w, mean(&centroids))]);
        }
        out
    }
}

#[test]
fn schemes_equal_their_papers() {
    let mut compared = 0;
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 {
            continue; // split vertices: tests/conformance.rs
        }
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            compare(&name, &mesh, "catmull-clark", boundary, polygons(&soup), |p| p.catmull_clark(boundary));
            compared += 1;
            if mesh.is_triangles() {
                let polygons = || polygons(&soup);
                compare(&name, &mesh, "loop", boundary, polygons(), |p| p.loop_(boundary, false));
                compare(&name, &mesh, "loop 1", boundary, polygons(), |p| p.loop_(boundary, true));
                compare(&name, &mesh, "butterfly", boundary, polygons(), |p| p.butterfly(1.0 / 16.0, boundary));
                compare(&name, &mesh, "butterfly 0.03", boundary, polygons(), |p| p.butterfly(0.03, boundary));
                compare(&name, &mesh, "modified-butterfly", boundary, polygons(), |p| p.modified_butterfly(boundary));
                compare(&name, &mesh, "j-spline", boundary, polygons(), |p| p.j_spline(0.5, true, boundary));
                compare(&name, &mesh, "j-spline 1.2 1", boundary, polygons(), |p| p.j_spline(1.2, false, boundary));
            }
        }
        let triangles = mesh.is_triangles();
        compare(&name, &mesh, "linear", Boundary::EdgeOnly, polygons(&soup), |p| p.split(&p.around(), triangles));
    }
    assert!(compared > 60);
}

/// Linear split and weighted centroids: Loop with weights 1/4, 3/8, 3/8 and factor 5/3 - 8/3 (3/8 + cos(2 pi / n) / 4)^2,
/// Catmull-Clark with plain centroids and factor 4/n.
#[test]
fn factored_rules_give_the_same_points_on_closed_meshes() {
    for name in ["pyramid", "tetrahedron", "octahedron", "icosahedron", "pawn"] {
        let soup = (limn_mesh::shape(name).unwrap().build)();
        compare(name, &build(&soup), "loop", Boundary::EdgeOnly, polygons(&soup), |p| {
            p.factored(true, 0.25, |n| {
                let c = 3.0 / 8.0 + (std::f64::consts::TAU / n).cos() / 4.0;
                5.0 / 3.0 - 8.0 / 3.0 * c * c
            })
        });
    }
    for name in ["cube", "t-shape", "torus"] {
        let soup = (limn_mesh::shape(name).unwrap().build)();
        compare(name, &build(&soup), "catmull-clark", Boundary::EdgeOnly, polygons(&soup), |p| {
            p.factored(false, 0.25, |n| 4.0 / n)
        });
    }
}

/// J. Baumgartner, "Subdivision surfaces" (2003), table 3.8: polygon counts of the pyramid, the cube and the T.
#[test]
fn baumgartners_table() {
    let counts = |name: &str, id: &str, triangulate: bool| -> Vec<usize> {
        let mut soup = (limn_mesh::shape(name).unwrap().build)();
        if triangulate {
            soup = limn_mesh::triangulate_soup(&soup).0;
        }
        let mesh = build(&soup);
        let plan = |level| Plan::new(scheme(id).unwrap(), Boundary::default(), level);
        (0..=4).map(|level| limn_mesh::refine(&mesh, &plan(level), u64::MAX).unwrap().faces.count()).collect()
    };
    for id in ["loop", "linear"] {
        assert_eq!(counts("pyramid", id, false), [6, 24, 96, 384, 1536]);
        assert_eq!(counts("cube", id, true), [12, 48, 192, 768, 3072]);
    }
    for id in ["catmull-clark", "linear"] {
        assert_eq!(counts("cube", id, false), [6, 24, 96, 384, 1536]);
        assert_eq!(counts("t-shape", id, false), [18, 72, 288, 1152, 4608]);
    }
    // His third program splits triangles into three quads: the quad split's counts.
    assert_eq!(counts("pyramid", "catmull-clark", false), [6, 18, 72, 288, 1152]);
    assert_eq!(counts("cube", "catmull-clark", true), [12, 36, 144, 576, 2304]);
}
