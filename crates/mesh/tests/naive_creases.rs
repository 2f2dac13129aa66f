//! Creases against the plainest program that can be written from OpenSubdiv's definition: polygons, maps, f64, no half-edges.

mod common;

use common::polygons::{Around, Point, Polygons, mean, mix, polygons};
use common::{build, distance, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, Decay, Mesh, Plan, Soup, refine, scheme};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

const INFINITE: f32 = 10.0;

/// Polygons with sharp edges, smaller end first, and sharp vertices.
struct Marked {
    p: Polygons,
    edges: BTreeMap<(usize, usize), f32>,
    vertices: BTreeMap<usize, f32>,
}

#[derive(Clone, Copy)]
struct Rules {
    triangles: bool,
    boundary: Boundary,
    decay: Decay,
}

fn less(s: f32) -> f32 {
    if s >= INFINITE { s } else { (s - 1.0).max(0.0) }
}

#[derive(PartialEq)]
enum Rule {
    Smooth,
    Crease(usize, usize),
    Corner,
}

fn rule(vertex: f32, edges: &[(usize, f32)]) -> Rule {
    let sharp: Vec<usize> = edges.iter().filter(|e| e.1 > 0.0).map(|e| e.0).collect();
    match sharp[..] {
        _ if vertex > 0.0 => Rule::Corner,
        [] | [_] => Rule::Smooth,
        [a, b] => Rule::Crease(a, b),
        _ => Rule::Corner,
    }
}

impl Marked {
    fn sharpness(&self, a: &Around, v: usize, w: usize) -> f32 {
        let key = (v.min(w), v.max(w));
        if a.edges[&key].len() == 1 { INFINITE } else { self.edges.get(&key).copied().unwrap_or(0.0) }
    }

    /// The sharpness of the half at `v` of the edge to `w`.
    fn half(&self, a: &Around, v: usize, w: usize, decay: Decay) -> f32 {
        let s = self.sharpness(a, v, w);
        let others: Vec<f32> = (a.neighbours[v].iter().filter(|&&x| x != w).map(|&x| self.sharpness(a, v, x)))
            .filter(|&s| s > 0.0 && s < INFINITE)
            .collect();
        if s <= 0.0 || s >= INFINITE || decay == Decay::Uniform || others.is_empty() {
            return less(s);
        }
        let mean = others.iter().copied().map(f64::from).sum::<f64>() as f32 / others.len() as f32;
        (0.75 * s + 0.25 * mean - 1.0).max(0.0)
    }

    fn smooth(&self, a: &Around, v: usize, rules: Rules) -> Point {
        let n = a.neighbours[v].len() as f64;
        let ring = mean(a.neighbours[v].iter().map(|&w| &self.p.points[w]));
        if rules.triangles {
            let c = 3.0 / 8.0 + (std::f64::consts::TAU / n).cos() / 4.0;
            return mix(&[(3.0 / 8.0 + c * c, self.p.points[v]), (5.0 / 8.0 - c * c, ring)]);
        }
        let q: Vec<Point> = a.faces[v].iter().map(|&f| self.centroid(f)).collect();
        mix(&[(1.0 / n, mean(&q)), (1.0 / n, ring), ((n - 2.0) / n, self.p.points[v])])
    }

    fn centroid(&self, f: usize) -> Point {
        mean(self.p.faces[f].iter().map(|&v| &self.p.points[v]))
    }

    fn vertex_point(&self, a: &Around, v: usize, rules: Rules) -> Point {
        let corner = rules.boundary == Boundary::EdgeAndCorner && !a.rim[v].is_empty() && a.faces[v].len() == 1;
        let own = if corner { INFINITE } else { self.vertices.get(&v).copied().unwrap_or(0.0) };
        let now: Vec<(usize, f32)> = a.neighbours[v].iter().map(|&w| (w, self.sharpness(a, v, w))).collect();
        let next: Vec<(usize, f32)> = a.neighbours[v].iter().map(|&w| (w, self.half(a, v, w, rules.decay))).collect();
        let point = |rule: &Rule| match *rule {
            Rule::Smooth => self.smooth(a, v, rules),
            Rule::Crease(b, c) => {
                mix(&[(0.75, self.p.points[v]), (0.125, self.p.points[b]), (0.125, self.p.points[c])])
            }
            Rule::Corner => self.p.points[v],
        };
        let (parent, child) = (rule(own, &now), rule(less(own), &next));
        if parent == Rule::Smooth || std::mem::discriminant(&parent) == std::mem::discriminant(&child) {
            return point(&parent);
        }
        let mut ending: Vec<f32> =
            now.iter().zip(&next).filter(|(n, x)| n.1 > 0.0 && x.1 == 0.0).map(|(n, _)| n.1).collect();
        if own > 0.0 && less(own) == 0.0 {
            ending.push(own);
        }
        let sum = ending.iter().copied().map(f64::from).sum::<f64>() as f32;
        let share = f64::from((sum / ending.len() as f32).min(1.0));
        mix(&[(share, point(&parent)), (1.0 - share, point(&child))])
    }

    fn edge_point(&self, a: &Around, v: usize, w: usize, rules: Rules) -> Point {
        let ends = [self.p.points[v], self.p.points[w]];
        let s = self.sharpness(a, v, w);
        let both = self.half(a, v, w, rules.decay) > 0.0 && self.half(a, w, v, rules.decay) > 0.0;
        if s > 0.0 && both {
            return mean(&ends);
        }
        let faces = &a.edges[&(v.min(w), v.max(w))];
        let smooth = if rules.triangles {
            let third = |f: usize| self.p.points[*self.p.faces[f].iter().find(|&&x| x != v && x != w).unwrap()];
            mix(&[(0.375, ends[0]), (0.375, ends[1]), (0.125, third(faces[0])), (0.125, third(faces[1]))])
        } else {
            mean(&[ends[0], ends[1], self.centroid(faces[0]), self.centroid(faces[1])])
        };
        let s = f64::from(s);
        mix(&[(s, mean(&ends)), (1.0 - s, smooth)])
    }

    fn refine(&self, rules: Rules) -> Marked {
        let a = self.p.around();
        let mut points: Vec<Point> = (0..self.p.points.len()).map(|v| self.vertex_point(&a, v, rules)).collect();
        let first_face = points.len();
        if !rules.triangles {
            points.extend((0..self.p.faces.len()).map(|f| self.centroid(f)));
        }
        let mut at = BTreeMap::new();
        let mut edges = BTreeMap::new();
        for &(v, w) in a.edges.keys() {
            at.insert((v, w), points.len());
            for (end, other) in [(v, w), (w, v)] {
                edges.insert((end, points.len()), self.half(&a, end, other, rules.decay));
            }
            points.push(self.edge_point(&a, v, w, rules));
        }
        let mut faces = Vec::new();
        for (f, face) in self.p.faces.iter().enumerate() {
            let n = face.len();
            let e = |i: usize| at[&(face[i % n].min(face[(i + 1) % n]), face[i % n].max(face[(i + 1) % n]))];
            for (i, &v) in face.iter().enumerate() {
                let before = e(i + n - 1);
                faces.push(if rules.triangles { vec![v, e(i), before] } else { vec![v, e(i), first_face + f, before] });
            }
            if rules.triangles {
                faces.push((0..n).map(e).collect());
            }
        }
        let vertices = self.vertices.iter().map(|(&v, &s)| (v, less(s))).collect();
        Marked { p: Polygons { points, faces }, edges, vertices }
    }
}

/// A few edges, vertices and their sharpness, in eighths.
fn mark(soup: &mut Soup, seed: u64, share: u32) {
    let mut state = seed | 1;
    let mut random = move |n: u32| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as u32 % n
    };
    for f in 0..soup.face_count() {
        let face = soup.face(f).to_vec();
        for (i, &v) in face.iter().enumerate() {
            let w = face[(i + 1) % face.len()];
            if v < w && random(100) < share {
                let s =
                    [0.125, 0.5, 0.875, 1.0, 1.125, 1.25, 1.5, 2.0, 2.5, 3.25, 9.0, 10.0, 12.0][random(13) as usize];
                soup.marks.creases.push(([v, w], s));
            }
            if random(400) < share {
                soup.marks.corners.push((v, [0.25, 1.0, 1.5, 3.0, 10.0][random(5) as usize]));
            }
        }
    }
}

fn whole(soup: &Soup) -> bool {
    let mesh = build(soup);
    mesh.positions.len() == soup.positions.len() && mesh.counts().digons == 0 && soup.face_count() <= 150
}

fn compare(name: &str, mesh: &Arc<Mesh>, soup: &Soup) {
    let exact: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    for id in ["catmull-clark", "loop"] {
        let triangles = id == "loop";
        if triangles && !mesh.is_triangles() {
            continue;
        }
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for decay in [Decay::Uniform, Decay::Chaikin] {
                let mut naive = Marked {
                    p: polygons(soup),
                    edges: (soup.marks.creases.iter())
                        .map(|&([a, b], s)| ((a.min(b) as usize, a.max(b) as usize), s))
                        .collect(),
                    vertices: soup.marks.corners.iter().map(|&(v, s)| (v as usize, s)).collect(),
                };
                for level in 1..=3 {
                    naive = naive.refine(Rules { triangles, boundary, decay });
                    let mut plan = Plan::new(scheme(id).unwrap(), boundary, level);
                    plan.rules.decay = decay;
                    let slow = evaluate(mesh, &plan, &exact, |_| ()).unwrap();
                    let d = slow.iter().zip(&naive.p.points);
                    // Edge points are numbered differently; old ones are not.
                    let old = d.take(exact.len()).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()));
                    let old = old.fold(0.0, f64::max);
                    let all = distance(&slow, &naive.p.points);
                    // Thirds of sharpness round differently in other orders.
                    let most = if level == 1 || decay == Decay::Uniform { 1e-12 } else { 2e-6 };
                    assert!(old < most && all < most, "{name}, {id}, {boundary:?}, {decay:?}, {level}: {old}, {all}");
                    let fast = refine(mesh, &plan, u64::MAX).unwrap();
                    let fast: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
                    let off = fast.iter().zip(&slow).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()));
                    let off = off.fold(0.0, f64::max);
                    assert!(off < 5e-6, "{name}, {id}, {level}: fast and slow differ by {off}");
                    if slow.len() > 2000 {
                        break;
                    }
                }
            }
        }
    }
}

#[test]
fn creases_equal_their_definition() {
    for (i, (name, mut soup)) in gallery().into_iter().enumerate() {
        if whole(&soup) {
            mark(&mut soup, 77 + i as u64, 25);
            compare(&name, &build(&soup), &soup);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn random_creases_equal_their_definition(
        soup in prop::sample::select(gallery().into_iter().map(|g| g.1).filter(whole).collect::<Vec<_>>()),
        seed in any::<u64>(),
        share in 5u32..60,
    ) {
        let mut soup = soup;
        mark(&mut soup, seed, share);
        compare("random", &build(&soup), &soup);
    }
}
