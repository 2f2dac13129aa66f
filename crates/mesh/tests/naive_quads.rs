//! Kobbelt's interpolating quads against the plainest program that can be written from the paper, the condition it is
//! derived from, and its eigenvalues.

mod common;

use common::polygons::{Around, Point, Polygons, compare, mean, mix, polygons};
use common::{build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, Plan, Soup, scheme};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

type Edges = BTreeMap<(usize, usize), Point>;

fn key(v: usize, w: usize) -> (usize, usize) {
    (v.min(w), v.max(w))
}

/// Four points in a row: between the middle two.
fn four(p: [Point; 4]) -> Point {
    mix(&[(-1.0 / 16.0, p[0]), (9.0 / 16.0, p[1]), (9.0 / 16.0, p[2]), (-1.0 / 16.0, p[3])])
}

fn reflect(through: Point, p: Point) -> Point {
    mix(&[(2.0, through), (-1.0, p)])
}

struct Net<'a> {
    p: &'a Polygons,
    a: &'a Around,
    boundary: Boundary,
}

impl Net<'_> {
    /// The face on the left of the side from `v` to `w`, from `v` on.
    fn left(&self, v: usize, w: usize) -> Option<Vec<usize>> {
        self.a.edges[&key(v, w)].iter().find_map(|&f| {
            let face = &self.p.faces[f];
            let at = face.iter().position(|&x| x == v).unwrap();
            (face[(at + 1) % face.len()] == w).then(|| [&face[at..], &face[..at]].concat())
        })
    }

    /// Behind `v`, seen from `w` along an inner edge.
    fn behind(&self, v: usize, w: usize) -> Point {
        let at = |v: usize| self.p.points[v];
        let (ring, closed) = self.p.ring(self.a, v);
        if !closed {
            let inner: Vec<Point> = ring[1..ring.len() - 1].iter().map(|&x| at(x)).collect();
            return reflect(at(v), mean(&inner));
        }
        let n = ring.len();
        let i = ring.iter().position(|&x| x == w).unwrap();
        let l = |j: usize| at(ring[(i + j) % n]);
        // k(j) lies between l(j) and l(j + 1).
        let k = |j: usize| {
            let face = self.left(v, ring[(i + j) % n]).unwrap();
            if face.len() == 4 { at(face[2]) } else { mix(&[(1.0, l(j)), (1.0, l(j + 1)), (-1.0, at(v))]) }
        };
        let all = |f: &dyn Fn(usize) -> Point| mean(&(0..n).map(f).collect::<Vec<_>>());
        let (ls, ks) = (all(&l), all(&k));
        let mut terms = vec![(4.0, ls), (-1.0, l(n - 1)), (-1.0, l(0)), (-1.0, l(1)), (-4.0 / 9.0, ks)];
        terms.extend([n - 2, n - 1, n, n + 1].map(|j| (1.0 / 9.0, k(j))));
        mix(&terms)
    }

    fn edge_points(&self) -> Edges {
        let at = |v: usize| self.p.points[v];
        let along = |v: usize, w: usize| {
            let corner = self.boundary == Boundary::EdgeAndCorner && self.a.faces[v].len() == 1;
            if corner {
                return reflect(at(v), at(w));
            }
            at(*self.a.rim[v].iter().find(|&&x| x != w).unwrap())
        };
        let point = |(&(v, w), faces): (&(usize, usize), &Vec<usize>)| {
            let outer =
                if faces.len() == 1 { [along(v, w), along(w, v)] } else { [self.behind(v, w), self.behind(w, v)] };
            ((v, w), four([outer[0], at(v), at(w), outer[1]]))
        };
        self.a.edges.iter().map(point).collect()
    }

    /// The edge point on the far side of the quad beyond side (v, w) of a face on its left.
    fn further(&self, e: &Edges, v: usize, w: usize) -> Option<Point> {
        self.left(w, v).filter(|f| f.len() == 4).map(|f| e[&key(f[2], f[3])])
    }

    /// Both rows of edge points through a quad give a face point.
    fn rows(&self, e: &Edges, f: &[usize]) -> [Point; 2] {
        [0, 1].map(|i| {
            let side = |j: usize| (f[(i + j) % 4], f[(i + j + 1) % 4]);
            let [near, far] = [side(0), side(2)];
            let (p, q) = (e[&key(near.0, near.1)], e[&key(far.0, far.1)]);
            let before = self.further(e, near.0, near.1).unwrap_or(reflect(p, q));
            let after = self.further(e, far.0, far.1).unwrap_or(reflect(q, p));
            four([before, p, q, after])
        })
    }

    fn face_point(&self, e: &Edges, f: &[usize]) -> Point {
        if f.len() == 4 {
            return mean(&self.rows(e, f));
        }
        let sides: Vec<_> = (0..f.len()).map(|i| (f[i], f[(i + 1) % f.len()])).collect();
        let own: Vec<Point> = sides.iter().map(|&(v, w)| e[&key(v, w)]).collect();
        let middle = mean(&own);
        let beyond: Vec<Point> = sides
            .iter()
            .zip(&own)
            .map(|(&(v, w), p)| self.further(e, v, w).unwrap_or(reflect(*p, reflect(middle, *p))))
            .collect();
        mix(&[(9.0 / 8.0, middle), (-1.0 / 8.0, mean(&beyond))])
    }
}

fn kobbelt(p: &Polygons, boundary: Boundary) -> Polygons {
    let a = p.around();
    let net = Net { p, a: &a, boundary };
    let e = net.edge_points();
    let mut out = Polygons { points: p.points.clone(), faces: Vec::new() };
    let id: BTreeMap<_, _> = e.keys().enumerate().map(|(i, &k)| (k, p.points.len() + i)).collect();
    out.points.extend(e.values());
    for f in &p.faces {
        let n = f.len();
        let centre = out.points.len();
        out.points.push(net.face_point(&e, f));
        for i in 0..n {
            let (before, v, after) = (f[(i + n - 1) % n], f[i], f[(i + 1) % n]);
            out.faces.push(vec![v, id[&key(v, after)], centre, id[&key(before, v)]]);
        }
    }
    out
}

#[test]
fn kobbelt_equals_its_paper() {
    let mut compared = 0;
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 {
            continue; // split vertices: tests/conformance.rs
        }
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            compare(&name, &mesh, "kobbelt", boundary, polygons(&soup), |p| kobbelt(p, boundary));
            compared += 1;
        }
    }
    assert!(compared > 60);
}

/// `n` sectors of 4 x 4 quads around vertex 0; the other corners of sector s are 1 + 20 s + 5 (x - 1) + y for x from 1 to 4
/// and y from 0 to 4, the spoke at y = 0 among them.
fn star(n: usize) -> Soup {
    let corner = |s: usize, x: usize, y: usize| match (x, y) {
        (0, 0) => 0,
        (0, y) => 1 + 20 * ((s + 1) % n) + 5 * (y - 1),
        (x, y) => 1 + 20 * (s % n) + 5 * (x - 1) + y,
    };
    let mut positions = vec![[0.0f32; 3]; 1 + 20 * n];
    let mut faces = Vec::new();
    for s in 0..n {
        let ray = |s: usize| (TAU * s as f64 / n as f64).sin_cos();
        let ((sin, cos), (sin_1, cos_1)) = (ray(s), ray(s + 1));
        for (x, y) in (0..5).flat_map(|x| (0..5).map(move |y| (x, y))) {
            let (fx, fy) = (x as f64, y as f64);
            let place = [fx * cos + fy * cos_1, fx * sin + fy * sin_1, 0.3 * (fx * 1.7 + fy * fy + s as f64).sin()];
            positions[corner(s, x, y)] = place.map(|x| x as f32);
            if x < 4 && y < 4 {
                let quad = [corner(s, x, y), corner(s, x + 1, y), corner(s, x + 1, y + 1), corner(s, x, y + 1)];
                faces.push(quad.map(|v| v as u32));
            }
        }
    }
    Soup::from_faces(positions, &faces)
}

/// What the virtual points are made for: both rows of edge points give the same face point around the vertex. Far from it
/// they do anyway, and at valence 4 everywhere.
#[test]
fn rows_of_edge_points_agree() {
    for n in 3..=9 {
        let p = polygons(&star(n));
        let a = p.around();
        let net = Net { p: &p, a: &a, boundary: Boundary::EdgeAndCorner };
        let e = net.edge_points();
        let near = |f: &[usize]| n == 4 || f.contains(&0);
        for f in p.faces.iter().filter(|f| near(f)) {
            let [x, y] = net.rows(&e, f);
            assert!((0..3).all(|k| (x[k] - y[k]).abs() < 1e-12), "valence {n}: {x:?} and {y:?}");
        }
    }
}

/// The sizes of the eigenvalues at valence `n`, the largest of every frequency around the vertex, by power iteration on what
/// one step makes of the vertices around vertex 0.
fn eigenvalues(n: usize) -> Vec<f64> {
    let mesh = build(&star(n));
    let plan = Plan::new(scheme("kobbelt").unwrap(), Boundary::EdgeOnly, 1);
    let places: Vec<Point> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    // The fine net's vertex number x, y is born at x/2, y/2 of the flat star: a linear step finds it.
    let flat: Vec<[f64; 2]> = (0..places.len())
        .map(|v| {
            if v == 0 {
                return [0.0; 2];
            }
            let (s, x, y) = ((v - 1) / 20, (v - 1) % 20 / 5 + 1, (v - 1) % 5);
            let ray = |s: usize| (TAU * s as f64 / n as f64).sin_cos();
            let ((sin, cos), (sin_1, cos_1)) = (ray(s), ray(s + 1));
            [x as f64 * cos + y as f64 * cos_1, x as f64 * sin + y as f64 * sin_1]
        })
        .collect();
    let halves = evaluate(&mesh, &Plan::new(scheme("linear").unwrap(), Boundary::EdgeOnly, 1), &flat, |_| ()).unwrap();
    let child: Vec<Option<usize>> =
        flat.iter().map(|p| halves.iter().position(|q| (0..2).all(|k| (q[k] - p[k] / 2.0).abs() < 1e-9))).collect();
    (0..=n / 2)
        .map(|frequency| {
            let turn = |v: usize| (TAU * (frequency * ((v - 1) / 20)) as f64 / n as f64).sin_cos();
            // One value for each place of a sector, the same around but for the turn; nothing at the vertex itself.
            let mut sector: Vec<[f64; 2]> = (0..20).map(|i| [1.0 + (i * 7 % 5) as f64, (i % 3) as f64]).collect();
            let (mut growth, steps) = (0.0, 400);
            for step in 0..steps {
                let data: Vec<[f64; 2]> = (0..flat.len())
                    .map(|v| match v {
                        0 => [0.0; 2],
                        _ => {
                            let ((sin, cos), [re, im]) = (turn(v), sector[(v - 1) % 20]);
                            [re * cos - im * sin, re * sin + im * cos]
                        }
                    })
                    .collect();
                let fine = evaluate(&mesh, &plan, &data, |_| ()).unwrap();
                let next: Vec<[f64; 2]> = (1..21).map(|v| fine[child[v].unwrap()]).collect();
                let size = |s: &[[f64; 2]]| s.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
                if step >= steps / 2 {
                    growth += (size(&next) / size(&sector)).ln();
                }
                let scale = 1.0 / size(&next);
                sector = next.iter().map(|v| v.map(|x| x * scale)).collect();
            }
            (growth / f64::from(steps - steps / 2)).exp()
        })
        .collect()
}

/// A limit with tangents: the largest eigenvalue next to 1 belongs to frequency 1 alone. The module states these figures.
#[test]
fn eigenvalues_allow_a_tangent_plane() {
    for (n, pair) in [(3, 0.4263), (5, 0.5379), (6, 0.5597), (7, 0.5732)] {
        let values = eigenvalues(n);
        assert!((values[1] - pair).abs() < 1e-4, "valence {n}: {values:?}");
        let others = values.iter().enumerate().filter(|(f, _)| *f != 1).map(|(_, x)| *x).fold(0.0, f64::max);
        assert!(others < values[1] - 0.01 && values[1] < 1.0, "valence {n}: {values:?}");
    }
}
