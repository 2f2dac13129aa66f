//! Creases of schemes that take them as rims, against the plainest program that can be written from their papers (polygons,
//! maps, f64, no half-edges), and against meshes that are cut.

mod common;

use common::polygons::{Around, Point, Polygons, mean, mix, polygons};
use common::{build, distance, fan, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::split::Level;
use limn_mesh::topology::validate;
use limn_mesh::{Boundary, Connectivity, Counts, Decay, Mesh, Params, Plan, Run, Soup, predict, refine, scheme};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// A face's point, by those of the edges.
type FacePoint = dyn Fn(&Cut<'_>, &BTreeMap<(usize, usize), Point>, &[usize]) -> Point;

const INFINITE: f32 = 10.0;

fn key(v: usize, w: usize) -> (usize, usize) {
    (v.min(w), v.max(w))
}

fn reflect(through: Point, p: Point) -> Point {
    mix(&[(2.0, through), (-1.0, p)])
}

/// Polygons with sharp edges, smaller end first, and sharp vertices.
#[derive(Clone)]
struct Marked {
    p: Polygons,
    edges: BTreeMap<(usize, usize), f32>,
    vertices: BTreeMap<usize, f32>,
}

/// The same with all that is sharper than a threshold cut.
struct Cut<'a> {
    p: &'a Polygons,
    a: &'a Around,
    /// By vertex, rims among them.
    sharp: Vec<BTreeSet<usize>>,
    corner: Vec<bool>,
}

fn less(s: f32) -> f32 {
    if s >= INFINITE { s } else { (s - 1.0).max(0.0) }
}

impl Marked {
    fn of(soup: &Soup) -> Marked {
        let edges = soup.marks.creases.iter().map(|&([a, b], s)| (key(a as usize, b as usize), s));
        let vertices = soup.marks.corners.iter().map(|&(v, s)| (v as usize, s));
        let p = polygons(soup);
        // A rim is infinitely sharp, whatever else it is called.
        let a = p.around();
        Marked { edges: edges.filter(|e| a.edges[&e.0].len() == 2).collect(), vertices: vertices.collect(), p }
    }

    /// The sharpness of the half at `v` of the edge to `w`.
    fn half(&self, v: usize, w: usize, decay: Decay) -> f32 {
        let s = self.edges[&key(v, w)];
        let others: Vec<f32> = (self.edges.iter())
            .filter(|(e, s)| (e.0 == v || e.1 == v) && **e != key(v, w) && **s > 0.0 && **s < INFINITE)
            .map(|(_, s)| *s)
            .collect();
        if s <= 0.0 || s >= INFINITE || decay == Decay::Uniform || others.is_empty() {
            return less(s);
        }
        (0.75 * s + 0.25 * (others.iter().sum::<f32>() / others.len() as f32) - 1.0).max(0.0)
    }

    fn cut<'a>(&'a self, a: &'a Around, over: f32, boundary: Boundary) -> Cut<'a> {
        let mut sharp = vec![BTreeSet::new(); self.p.points.len()];
        for (&(v, w), faces) in &a.edges {
            if faces.len() == 1 || self.edges.get(&(v, w)).is_some_and(|s| *s > over) {
                sharp[v].insert(w);
                sharp[w].insert(v);
            }
        }
        let corner = |v: usize| {
            let tip = boundary == Boundary::EdgeAndCorner && !a.rim[v].is_empty() && a.faces[v].len() == 1;
            tip || sharp[v].len() > 2 || self.vertices.get(&v).is_some_and(|s| *s > over)
        };
        let corner = (0..sharp.len()).map(corner).collect();
        Cut { p: &self.p, a, sharp, corner }
    }

    /// One step: `old` and `edge` say points on a cut mesh, `face` with the edges' blended points.
    fn step(
        &self,
        (boundary, decay): (Boundary, Decay),
        old: impl Fn(&Cut<'_>, usize) -> Point,
        edge: impl Fn(&Cut<'_>, usize, usize) -> Point,
        face: Option<&FacePoint>,
    ) -> Marked {
        let a = self.p.around();
        // Sharpness counts from each of these on, and how much.
        let fractions = self.edges.values().chain(self.vertices.values()).copied().filter(|s| *s > 0.0 && *s < 1.0);
        let mut from: Vec<f32> = fractions.chain([0.0]).collect();
        from.sort_by(f32::total_cmp);
        from.dedup();
        let until = |i: usize| from.get(i + 1).copied().unwrap_or(1.0);
        let cuts: Vec<(f64, Cut<'_>)> = (0..from.len())
            .map(|i| (f64::from(until(i)) - f64::from(from[i]), self.cut(&a, from[i], boundary)))
            .collect();
        let blend =
            |rule: &dyn Fn(&Cut<'_>) -> Point| mix(&cuts.iter().map(|(w, c)| (*w, rule(c))).collect::<Vec<_>>());

        let mut points: Vec<Point> = (0..self.p.points.len()).map(|v| blend(&|c| old(c, v))).collect();
        let mut ids = BTreeMap::new();
        let mut places = BTreeMap::new();
        let mut edges = BTreeMap::new();
        for &(v, w) in a.edges.keys() {
            ids.insert((v, w), points.len());
            for (end, other) in [(v, w), (w, v)] {
                if self.edges.contains_key(&(v, w)) {
                    edges.insert((end, points.len()), self.half(end, other, decay));
                }
            }
            places.insert((v, w), blend(&|c| edge(c, v, w)));
            points.push(places[&(v, w)]);
        }
        let mut faces = Vec::new();
        for f in &self.p.faces {
            let n = f.len();
            let e = |i: usize| ids[&key(f[i % n], f[(i + 1) % n])];
            if let Some(face) = face {
                points.push(blend(&|c| face(c, &places, f)));
                faces.extend((0..n).map(|i| vec![f[i], e(i), points.len() - 1, e(i + n - 1)]));
            } else {
                faces.extend((0..n).map(|i| vec![f[i], e(i), e(i + n - 1)]));
                faces.push((0..n).map(e).collect());
            }
        }
        let vertices = self.vertices.iter().map(|(&v, &s)| (v, less(s))).collect();
        Marked { p: Polygons { points, faces }, edges, vertices }
    }
}

impl Cut<'_> {
    fn at(&self, v: usize) -> Point {
        self.p.points[v]
    }

    fn is_sharp(&self, v: usize, w: usize) -> bool {
        self.sharp[v].contains(&w)
    }

    /// The neighbours of `v` in order, from `w` on if they go all the way round, else from crease to crease past `w`.
    fn ring(&self, v: usize, w: usize) -> (Vec<usize>, bool) {
        let (mut ring, closed) = self.p.ring(self.a, v);
        if closed && self.sharp[v].len() < 2 {
            let at = ring.iter().position(|&x| x == w).unwrap();
            ring.rotate_left(at);
            return (ring, true);
        }
        if closed {
            let at = ring.iter().position(|&x| self.is_sharp(v, x)).unwrap();
            ring.rotate_left(at);
            ring.push(ring[0]);
        }
        let at = ring.iter().position(|&x| x == w).unwrap();
        let from = (0..=at).rev().find(|&i| self.is_sharp(v, ring[i])).unwrap();
        let to = (at..ring.len()).find(|&i| self.is_sharp(v, ring[i])).unwrap();
        (ring[from..=to].to_vec(), false)
    }

    /// The next point of the curve that comes from `w` through `v`.
    fn further(&self, v: usize, w: usize) -> Point {
        match self.sharp[v].iter().find(|&&x| x != w) {
            Some(&x) if !self.corner[v] => self.at(x),
            _ => reflect(self.at(v), self.at(w)),
        }
    }

    fn four(&self, v: usize, w: usize, tension: f64) -> Point {
        let near = 0.5 + tension;
        let outer = [self.further(v, w), self.further(w, v)];
        mix(&[(near, self.at(v)), (near, self.at(w)), (-tension, outer[0]), (-tension, outer[1])])
    }

    fn third(&self, f: usize, v: usize, w: usize) -> usize {
        *self.p.faces[f].iter().find(|&&x| x != v && x != w).unwrap()
    }

    fn eight(&self, v: usize, w: usize, tension: f64) -> Point {
        let mut terms = vec![(0.5, self.at(v)), (0.5, self.at(w))];
        for &f in &self.a.edges[&key(v, w)] {
            let c = self.third(f, v, w);
            terms.push((2.0 * tension, self.at(c)));
            for (x, inner) in [(v, w), (w, v)] {
                let beyond = self.a.edges[&key(x, c)].iter().find(|&&g| g != f);
                let wing = match beyond {
                    Some(&g) if !self.is_sharp(x, c) => self.at(self.third(g, x, c)),
                    _ => mix(&[(1.0, self.at(x)), (1.0, self.at(c)), (-1.0, self.at(inner))]),
                };
                terms.push((-tension, wing));
            }
        }
        mix(&terms)
    }

    /// Dyn, Levin and Gregory 1990.
    fn butterfly(&self, v: usize, w: usize, tension: f64) -> Point {
        if self.is_sharp(v, w) { self.four(v, w, tension) } else { self.eight(v, w, tension) }
    }

    /// Zorin, Schroeder and Sweldens 1996; the crease rule of the notes of 2000.
    fn modified_butterfly(&self, v: usize, w: usize) -> Point {
        if self.is_sharp(v, w) {
            return self.four(v, w, 1.0 / 16.0);
        }
        match (self.own(v, w), self.own(w, v)) {
            (None, None) => self.eight(v, w, 1.0 / 16.0),
            (Some(p), None) | (None, Some(p)) => p,
            (Some(p), Some(q)) => mean([&p, &q]),
        }
    }

    fn own(&self, v: usize, w: usize) -> Option<Point> {
        let (ring, closed) = self.ring(v, w);
        let mut terms = Vec::new();
        if closed {
            let k = ring.len();
            let weights: Vec<f64> = match k {
                6 => return None,
                3 => vec![5.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0],
                4 => vec![3.0 / 8.0, 0.0, -1.0 / 8.0, 0.0],
                _ => (0..k)
                    .map(|j| 2.0 * PI * j as f64 / k as f64)
                    .map(|t| (0.25 + t.cos() + 0.5 * (2.0 * t).cos()) / k as f64)
                    .collect(),
            };
            terms.extend(weights.iter().zip(&ring).map(|(s, x)| (*s, self.at(*x))));
            terms.push((0.75, self.at(v)));
            return Some(mix(&terms));
        }
        let k = ring.len() - 1;
        if k == 3 {
            return None;
        }
        let (n, t) = (k as f64, PI / k as f64);
        let i = ring.iter().position(|&x| x == w).unwrap() as f64 * t;
        let end = 0.25 * i.cos() - (2.0 * t).sin() * (2.0 * i).sin() / (4.0 * n * (t.cos() - (2.0 * t).cos()));
        terms.push((1.0 - t.sin() * i.sin() / (n * (1.0 - t.cos())), self.at(v)));
        for (j, &x) in ring.iter().enumerate() {
            let s = j as f64 * t;
            let inner = (i.sin() * s.sin() + 0.5 * (2.0 * i).sin() * (2.0 * s).sin()) / n;
            terms.push((
                if j == 0 {
                    end
                } else if j == k {
                    -end
                } else {
                    inner
                },
                self.at(x),
            ));
        }
        Some(mix(&terms))
    }

    /// From `v` to where J-splines pull it.
    fn toward(&self, v: usize) -> Point {
        let around: Vec<usize> = match self.sharp[v].len() {
            _ if self.corner[v] => vec![v],
            2 => self.sharp[v].iter().copied().collect(),
            _ => self.a.neighbours[v].iter().copied().collect(),
        };
        mix(&[(1.0, mean(around.iter().map(|&w| &self.p.points[w]))), (-1.0, self.at(v))])
    }

    /// The face on the left of the side from `v` to `w`, from `v` on.
    fn left(&self, v: usize, w: usize) -> Option<Vec<usize>> {
        self.a.edges[&key(v, w)].iter().find_map(|&f| {
            let face = &self.p.faces[f];
            let at = face.iter().position(|&x| x == v).unwrap();
            (face[(at + 1) % face.len()] == w).then(|| [&face[at..], &face[..at]].concat())
        })
    }

    /// Kobbelt 1996: behind `v`, seen from `w` along a smooth edge.
    fn behind(&self, v: usize, w: usize) -> Point {
        let (ring, closed) = self.ring(v, w);
        if !closed {
            let inner: Vec<Point> = ring[1..ring.len() - 1].iter().map(|&x| self.at(x)).collect();
            return reflect(self.at(v), mean(&inner));
        }
        let n = ring.len();
        let l = |j: usize| self.at(ring[j % n]);
        let k = |j: usize| {
            let face = self.left(v, ring[j % n]).unwrap();
            if face.len() == 4 { self.at(face[2]) } else { mix(&[(1.0, l(j)), (1.0, l(j + 1)), (-1.0, self.at(v))]) }
        };
        let all = |f: &dyn Fn(usize) -> Point| mean(&(0..n).map(f).collect::<Vec<_>>());
        let mut terms = vec![(4.0, all(&l)), (-1.0, l(n - 1)), (-1.0, l(0)), (-1.0, l(1)), (-4.0 / 9.0, all(&k))];
        terms.extend([n - 2, n - 1, n, n + 1].map(|j| (1.0 / 9.0, k(j))));
        mix(&terms)
    }

    fn kobbelt_edge(&self, v: usize, w: usize) -> Point {
        if self.is_sharp(v, w) {
            return self.four(v, w, 1.0 / 16.0);
        }
        let (p, q) = (self.behind(v, w), self.behind(w, v));
        mix(&[(9.0 / 16.0, self.at(v)), (9.0 / 16.0, self.at(w)), (-1.0 / 16.0, p), (-1.0 / 16.0, q)])
    }

    fn kobbelt_face(&self, e: &BTreeMap<(usize, usize), Point>, f: &[usize]) -> Point {
        let n = f.len();
        let side = |i: usize| (f[i % n], f[(i + 1) % n]);
        let own = |i: usize| e[&key(side(i).0, side(i).1)];
        let beyond = |i: usize| {
            let (v, w) = side(i);
            let across = self.left(w, v).filter(|g| g.len() == 4 && !self.is_sharp(v, w));
            across.map(|g| e[&key(g[2], g[3])])
        };
        let middle = mean(&(0..n).map(own).collect::<Vec<_>>());
        // In a quad the edge opposite turned over this one, else the mean of all.
        let turned = |i: usize| if n == 4 { own(i + 2) } else { reflect(middle, own(i)) };
        let outer: Vec<Point> = (0..n).map(|i| beyond(i).unwrap_or(reflect(own(i), turned(i)))).collect();
        mix(&[(9.0 / 8.0, middle), (-1.0 / 8.0, mean(&outer))])
    }
}

/// Steps of the schemes that can take such faces; values of parameters follow the scheme's id.
fn step(id: &str, m: &Marked, rules: (Boundary, Decay)) -> Marked {
    let stay = |c: &Cut<'_>, v: usize| c.at(v);
    match id {
        "butterfly" => m.step(rules, stay, |c, v, w| c.butterfly(v, w, 1.0 / 16.0), None),
        "butterfly 0.03" => m.step(rules, stay, |c, v, w| c.butterfly(v, w, 0.03), None),
        "modified-butterfly" => m.step(rules, stay, |c, v, w| c.modified_butterfly(v, w), None),
        "kobbelt" => {
            m.step(rules, stay, |c, v, w| c.kobbelt_edge(v, w), Some(&|c, places, f| c.kobbelt_face(places, f)))
        }
        _ => {
            let s: f64 = id.split(' ').nth(1).unwrap().parse().unwrap();
            let old = |c: &Cut<'_>, v: usize| mix(&[(1.0, c.at(v)), (s / 4.0, c.toward(v))]);
            let pull = -(1.0 - s) / 8.0;
            let edge = |c: &Cut<'_>, v: usize, w: usize| {
                // Along a crease only its curve pulls, which goes straight on where it ends.
                let along = |v: usize, w: usize| mix(&[(0.5, c.further(v, w)), (0.5, c.at(w)), (-1.0, c.at(v))]);
                let ends = match c.is_sharp(v, w) {
                    true => [along(v, w), along(w, v)],
                    false => [c.toward(v), c.toward(w)],
                };
                mix(&[(0.5, c.at(v)), (0.5, c.at(w)), (pull, ends[0]), (pull, ends[1])])
            };
            m.step(rules, old, edge, None)
        }
    }
}

const ALL: [&str; 6] = ["butterfly", "butterfly 0.03", "modified-butterfly", "kobbelt", "j-spline 0.5", "j-spline 1.2"];

fn plan(id: &str, boundary: Boundary, level: u32) -> Plan {
    let mut words = id.split(' ');
    let mut plan = Plan::new(scheme(words.next().unwrap()).unwrap(), boundary, level);
    for (at, value) in words.enumerate() {
        assert!(plan.params.set(&plan.scheme.info, at, value.parse().unwrap()));
    }
    plan
}

fn exact(mesh: &Mesh) -> Vec<Point> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

fn random(seed: u64) -> impl FnMut(u32) -> u32 {
    let mut state = seed | 1;
    move |n: u32| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as u32 % n
    }
}

/// Edges and vertices of every sharpness.
fn mark(soup: &mut Soup, seed: u64, share: u32) {
    let mut random = random(seed);
    for f in 0..soup.face_count() {
        let face = soup.face(f).to_vec();
        for (i, &v) in face.iter().enumerate() {
            let w = face[(i + 1) % face.len()];
            if v < w && random(100) < share {
                let s = [0.125, 0.5, 0.875, 1.0, 1.25, 1.5, 2.5, 10.0, 10.0, 10.0, 12.0][random(11) as usize];
                soup.marks.creases.push(([v, w], s));
            }
            if random(400) < share {
                soup.marks.corners.push((v, [0.25, 1.0, 1.5, 10.0][random(4) as usize]));
            }
        }
    }
}

/// No vertex is cut apart, and no two faces share two edges.
fn whole(soup: &Soup) -> bool {
    let mesh = build(soup);
    mesh.positions.len() == soup.positions.len() && mesh.counts().digons == 0 && soup.face_count() <= 120
}

#[test]
fn creases_equal_their_definition() {
    let mut compared = 0;
    for (i, (name, soup)) in gallery().into_iter().enumerate().filter(|(_, g)| whole(&g.1)) {
        for share in [8, 35] {
            let mut soup = soup.clone();
            mark(&mut soup, 7 + i as u64 + u64::from(share), share);
            let mesh = build(&soup);
            let start = exact(&mesh);
            for id in ALL {
                if id != "kobbelt" && !mesh.is_triangles() {
                    continue;
                }
                for rules in [(Boundary::EdgeOnly, Decay::Chaikin), (Boundary::EdgeAndCorner, Decay::Uniform)] {
                    let mut naive = Marked::of(&soup);
                    for level in 1..=2 {
                        naive = step(id, &naive, rules);
                        let mut plan = plan(id, rules.0, level);
                        plan.rules.decay = rules.1;
                        let slow = evaluate(&mesh, &plan, &start, |_| ()).unwrap();
                        let d = distance(&slow, &naive.p.points);
                        let most = if level == 1 || rules.1 == Decay::Uniform { 1e-12 } else { 2e-6 };
                        assert!(d < most, "{name}, {id}, {rules:?}, level {level}: off by {d}");
                        let fast = refine(&mesh, &plan, u64::MAX).unwrap();
                        for (p, q) in fast.points.iter().zip(&slow) {
                            let off = (0..3).map(|k| (f64::from(p[k]) - q[k]).abs()).fold(0.0, f64::max);
                            assert!(off < 5e-6, "{name}, {id}, level {level}: fast and slow differ by {off}");
                        }
                        compared += 1;
                    }
                }
            }
        }
    }
    assert!(compared > 300, "{compared}");
}

/// A mesh in two parts by infinitely sharp edges is the parts refined each by itself.
#[test]
fn creases_are_rims_of_the_parts() {
    let mut compared = 0;
    let mut soups: Vec<(String, Soup)> = gallery().into_iter().filter(|g| whole(&g.1)).collect();
    soups.extend((3..=12).map(|n| (format!("closed fan of {n}"), fan(n, true))));
    for (i, (name, soup)) in soups.into_iter().enumerate() {
        let mut random = random(41 + i as u64);
        // Faces around a few vertices, so that both parts are large.
        let seeds: Vec<u32> =
            (0..1 + soup.face_count() as u32 / 20).map(|_| random(soup.positions.len() as u32)).collect();
        let inside = |f: usize| soup.face(f).iter().any(|v| seeds.contains(v));
        let p = polygons(&soup);
        let a = p.around();
        let mut whole = soup.clone();
        let mut sharp = vec![0; soup.positions.len()];
        for (&(v, w), faces) in &a.edges {
            let crease = faces.len() == 2 && inside(faces[0]) != inside(faces[1]);
            if crease {
                whole.marks.creases.push(([v as u32, w as u32], INFINITE));
            }
            if crease || faces.len() == 1 {
                (sharp[v], sharp[w]) = (sharp[v] + 1, sharp[w] + 1);
            }
        }
        let corners = |v: &usize| sharp[*v] > 2 || *v % 7 == 3;
        let corners: Vec<(u32, f32)> = (0..sharp.len()).filter(corners).map(|v| (v as u32, INFINITE)).collect();
        whole.marks.corners.clone_from(&corners);
        let mesh = build(&whole);
        for side in [true, false] {
            let faces: Vec<Vec<u32>> =
                (0..soup.face_count()).filter(|&f| inside(f) == side).map(|f| soup.face(f).to_vec()).collect();
            if faces.is_empty() {
                continue;
            }
            let mut part = Soup::from_faces(soup.positions.clone(), &faces);
            part.marks.corners.clone_from(&corners);
            let part = build(&part);
            for id in ALL.into_iter().chain(["sqrt3", "interpolating-sqrt3"]) {
                if id != "kobbelt" && !mesh.is_triangles() {
                    continue;
                }
                for level in 1..=if id.contains("sqrt3") { 4 } else { 3 } {
                    let plan = plan(id, Boundary::EdgeOnly, level);
                    let (one, other) =
                        (refine(&mesh, &plan, u64::MAX).unwrap(), refine(&part, &plan, u64::MAX).unwrap());
                    let ours = (0..one.faces.count()).filter(|&f| inside(one.face_source(f as u32) as usize) == side);
                    let ours: Vec<u32> = ours.flat_map(|f| one.faces.face(f).to_vec()).collect();
                    assert_eq!(ours.len(), other.faces.corners().len(), "{name}, {id}, level {level}");
                    let valid = |level: &Level<'_>| validate(level).unwrap_or_else(|e| panic!("{name}, {id}: {e:?}"));
                    let slow = [&mesh, &part].map(|m| evaluate(m, &plan, &exact(m), valid).unwrap());
                    let mut real = one.counts;
                    let mut predicted = predict(&mesh, &plan).unwrap().unwrap().counts;
                    // Which boundary vertices have three faces and which more is not told apart.
                    (real.rim, predicted.rim) = ([0; 4], [0; 4]);
                    assert_eq!(real, predicted, "{name}, {id}, level {level}");
                    assert_eq!(one.points.len() as u64, predicted.vertices, "{name}, {id}, level {level}");
                    for (&v, &w) in ours.iter().zip(other.faces.corners()) {
                        let (p, q) = (slow[0][v as usize], slow[1][w as usize]);
                        assert!(
                            (0..3).all(|k| (p[k] - q[k]).abs() < 1e-12),
                            "{name}, {id}, level {level}: {p:?}, {q:?}"
                        );
                        let (p, q) = (one.points[v as usize], other.points[w as usize]);
                        assert!(
                            (0..3).all(|k| (p[k] - q[k]).abs() < 2e-6),
                            "{name}, {id}, level {level}: {p:?}, {q:?}"
                        );
                    }
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 300, "{compared}");
}

/// Counts of every level are those predicted, whatever is sharp: on open meshes, beside inner vertices of two faces, and where
/// a dual step follows, which asks how many faces vertices have.
#[test]
fn creases_change_no_counts() {
    // Two triangles back to back, and a fan that ends in such a pair.
    let pillow = Soup::from_faces(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]], &[[0, 1, 2], [2, 1, 0]]);
    let mut soups: Vec<(String, Soup)> = gallery().into_iter().filter(|g| g.1.face_count() <= 60).collect();
    soups.extend((2..=4).map(|n| (format!("closed fan of {n}"), fan(n, true))));
    soups.push(("pillow".to_owned(), pillow));
    for (i, (name, mut soup)) in soups.into_iter().enumerate() {
        mark(&mut soup, 91 + i as u64, 45);
        let mesh = build(&soup);
        for id in ["sqrt3", "interpolating-sqrt3"] {
            if !mesh.is_triangles() {
                continue;
            }
            for turns in 1..=4 {
                let mut plan = plan(id, Boundary::EdgeAndCorner, 5);
                plan.later = vec![Run { from: turns, scheme: scheme("doo-sabin").unwrap(), params: Params::default() }];
                let mut level = 0;
                evaluate(&mesh, &plan, &exact(&mesh), |c| {
                    validate(c).unwrap_or_else(|e| panic!("{name}, {id}, level {level}: {e:?}"));
                    let (real, told) = (c.counts(), predict(&mesh, &plan.to(level)).unwrap().unwrap().counts);
                    let few = |c: &Counts| (c.vertices, c.edges, c.faces, c.corners, c.boundary, c.digons);
                    assert_eq!(few(&real), few(&told), "{name}, {id}, {turns} turns, level {level}");
                    level += 1;
                })
                .unwrap();
                let done = refine(&mesh, &plan, u64::MAX).unwrap();
                assert_eq!(done.counts, predict(&mesh, &plan).unwrap().unwrap().counts);
                assert_eq!(done.faces.count() as u64, done.counts.faces, "{name}, {id}");
            }
        }
    }
}
