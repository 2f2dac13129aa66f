//! Polygons as a list of points and a list of faces, and what can be asked of them with maps alone: for the references that
//! are written straight from the papers.
#![allow(dead_code)]

use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, Plan, scheme};
use std::collections::{BTreeMap, BTreeSet};

use super::distance;

pub type Point = [f64; 3];

#[derive(Clone)]
pub struct Polygons {
    pub points: Vec<Point>,
    pub faces: Vec<Vec<usize>>,
}

pub fn mean<'a>(points: impl IntoIterator<Item = &'a Point>) -> Point {
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for p in points {
        sum = [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]];
        n += 1.0;
    }
    sum.map(|x| x / n)
}

pub fn mix(terms: &[(f64, Point)]) -> Point {
    std::array::from_fn(|k| terms.iter().map(|(w, p)| w * p[k]).sum())
}

/// Edges with their faces, and what they say about vertices.
pub struct Around {
    pub edges: BTreeMap<(usize, usize), Vec<usize>>,
    pub neighbours: Vec<BTreeSet<usize>>,
    pub faces: Vec<Vec<usize>>,
    pub rim: Vec<Vec<usize>>,
}

impl Polygons {
    pub fn around(&self) -> Around {
        let n = self.points.len();
        let mut a = Around {
            edges: BTreeMap::new(),
            neighbours: vec![BTreeSet::new(); n],
            faces: vec![Vec::new(); n],
            rim: vec![Vec::new(); n],
        };
        for (f, face) in self.faces.iter().enumerate() {
            for (i, &v) in face.iter().enumerate() {
                let w = face[(i + 1) % face.len()];
                a.edges.entry((v.min(w), v.max(w))).or_default().push(f);
                a.neighbours[v].insert(w);
                a.neighbours[w].insert(v);
                a.faces[v].push(f);
            }
        }
        for (&(v, w), faces) in &a.edges {
            assert!(faces.len() <= 2);
            if faces.len() == 1 {
                a.rim[v].push(w);
                a.rim[w].push(v);
            }
        }
        a
    }

    /// The neighbours of `v` in order, and whether they go all the way round.
    pub fn ring(&self, a: &Around, v: usize) -> (Vec<usize>, bool) {
        let mut after = BTreeMap::new();
        for &f in &a.faces[v] {
            let face = &self.faces[f];
            let i = face.iter().position(|&w| w == v).unwrap();
            after.insert(face[(i + 1) % face.len()], face[(i + face.len() - 1) % face.len()]);
        }
        let first = after.keys().find(|&k| !after.values().any(|w| w == k));
        let closed = first.is_none();
        let mut ring = vec![*first.unwrap_or(after.keys().next().unwrap())];
        while let Some(&w) = after.get(ring.last().unwrap()).filter(|w| **w != ring[0]) {
            ring.push(w);
        }
        (ring, closed)
    }
}

/// The sqrt3 split: `old` are the vertices' new places, `centre` gives a face's point, and `third(v, w)` the point that cuts the
/// rim's edge at a third of the way from v, where edges are cut.
pub fn turned(
    p: &Polygons,
    a: &Around,
    trisect: bool,
    old: Vec<Point>,
    centre: impl Fn(usize) -> Point,
    third: impl Fn(usize, usize) -> Point,
) -> Polygons {
    let mut out = Polygons { points: old, faces: Vec::new() };
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
    for (f, cut) in cut.iter().enumerate() {
        let new = out.points.len();
        match *cut {
            None => {
                out.points.push(centre(f));
                centres.push(vec![new]);
            }
            Some([x, y, _]) => {
                out.points.extend([third(x, y), third(y, x)]);
                centres.push(vec![new, new + 1]);
            }
        }
    }
    // What an edge's end (v, w) of face f sees as the face's centre: the rim's points are dealt to the other two edges.
    let seen = |f: usize, v: usize, w: usize| match cut[f] {
        Some([_, y, z]) if [v, w].contains(&y) && [v, w].contains(&z) => centres[f][1],
        _ => centres[f][0],
    };
    for (f, face) in p.faces.iter().enumerate() {
        for i in 0..3 {
            let (v, w) = (face[i], face[(i + 1) % 3]);
            let sides = &a.edges[&(v.min(w), v.max(w))];
            match sides.iter().find(|&&g| g != f) {
                Some(&g) => out.faces.push(vec![v, seen(g, v, w), seen(f, v, w)]),
                None if trisect => out.faces.push(vec![centres[f][0], centres[f][1], face[(i + 2) % 3]]),
                None => out.faces.push(vec![v, w, centres[f][0]]),
            }
        }
    }
    out
}

pub fn polygons(soup: &limn_mesh::Soup) -> Polygons {
    Polygons {
        points: soup.positions.iter().map(|p| p.map(f64::from)).collect(),
        faces: (0..soup.face_count()).map(|f| soup.face(f).iter().map(|&v| v as usize).collect()).collect(),
    }
}

/// `id` may be followed by values of the scheme's parameters.
pub fn compare(
    what: &str,
    mesh: &limn_mesh::Mesh,
    id: &str,
    boundary: Boundary,
    mut naive: Polygons,
    step: impl Fn(&Polygons) -> Polygons,
) {
    let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    for level in 1..=2 {
        naive = step(&naive);
        let mut words = id.split(' ');
        let mut plan = Plan::new(scheme(words.next().unwrap()).unwrap(), boundary, level);
        for (at, value) in words.enumerate() {
            assert!(plan.params.set(&plan.scheme.info, at, value.parse().unwrap()));
        }
        let ours = evaluate(mesh, &plan, &positions, |_| ()).unwrap();
        let d = distance(&ours, &naive.points);
        assert!(d < 1e-12, "{what}, {id}, level {level}, {boundary:?}: off by {d}");
    }
}
