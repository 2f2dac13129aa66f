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
