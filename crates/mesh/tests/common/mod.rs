//! Meshes that the tests share: built-in shapes, odd ones, and random ones for proptest.
#![allow(dead_code)]

pub mod polygons;

use limn_mesh::{Mesh, SHAPES, Soup, Weld};
use proptest::prelude::*;
use std::sync::Arc;

pub fn build(soup: &Soup) -> Arc<Mesh> {
    Arc::new(Mesh::build(soup, Weld::Off).unwrap().0)
}

/// A cone of `n` triangles around a vertex, open; `closed` adds the mirror image below.
pub fn fan(n: u32, closed: bool) -> Soup {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for i in 0..n {
        let a = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        positions.push([a.cos() as f32, a.sin() as f32, 0.1 * i as f32]);
    }
    let mut faces: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    if closed {
        positions.push([0.1, 0.2, -1.0]);
        faces.extend((0..n).map(|i| [n + 1, 1 + (i + 1) % n, 1 + i]));
    }
    Soup::from_faces(positions, &faces)
}

/// Half fans: 1 to 9 triangles around a vertex of the boundary.
pub fn half_fans() -> impl Iterator<Item = (String, Soup)> {
    (1..=9u32).map(|n| {
        let mut positions = vec![[0.0, 0.0, 0.5]];
        for i in 0..=n {
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(n.max(2));
            positions.push([angle.cos() as f32, angle.sin() as f32, 0.1 * (i * 7 % 5) as f32]);
        }
        let faces: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 1, i + 2]).collect();
        (format!("half a fan of {n}"), Soup::from_faces(positions, &faces))
    })
}

/// `n` triangles at one vertex of the boundary.
pub fn half_pole(n: u32) -> Soup {
    let rim = (0..=n).map(|i| (std::f64::consts::PI * f64::from(i) / f64::from(n)).sin_cos());
    let positions = [[0.0; 3]].into_iter().chain(rim.map(|(y, x)| [x as f32, y as f32, 0.0])).collect();
    Soup::from_faces(positions, &(1..=n).map(|i| [0, i, i + 1]).collect::<Vec<_>>())
}

/// A prism over an n-gon: quads and two n-gons.
pub fn prism(n: u32) -> Soup {
    let mut positions = Vec::new();
    for i in 0..n {
        let a = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        for z in [0.0, 1.5] {
            positions.push([a.cos() as f32, a.sin() as f32 * 1.3, z]);
        }
    }
    let mut faces: Vec<Vec<u32>> = (0..n)
        .map(|i| {
            let j = (i + 1) % n;
            vec![2 * i, 2 * j, 2 * j + 1, 2 * i + 1]
        })
        .collect();
    faces.push((0..n).rev().map(|i| 2 * i).collect());
    faces.push((0..n).map(|i| 2 * i + 1).collect());
    Soup::from_faces(positions, &faces)
}

/// Two triangles that meet in a point only.
pub fn bow_tie() -> Soup {
    let p = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.0, 0.5], [-1.0, -1.0, 0.0]];
    Soup::from_faces(p, &[[0, 1, 2], [0, 3, 4]])
}

/// Three quad strips that share the edges of one polyline of `n` edges.
pub fn book(n: u32) -> Soup {
    let mut positions = Vec::new();
    for i in 0..=n {
        let y = i as f32;
        positions.push([0.0, y, 0.1 * y * y]);
        positions.extend([[1.0, y, 0.3], [-1.0, y, 0.2], [0.1, y, 1.5]]);
    }
    let mut faces = Vec::new();
    for i in 0..n {
        let (a, b) = (4 * i, 4 * i + 4);
        faces.extend((1..4).map(|s| [a, b, b + s, a + s]));
    }
    Soup::from_faces(positions, &faces)
}

/// Named meshes of every kind.
pub fn gallery() -> Vec<(String, Soup)> {
    let mut all: Vec<(String, Soup)> =
        SHAPES.iter().filter(|s| s.name != "creature").map(|s| (s.name.to_owned(), (s.build)())).collect();
    for n in 3..=12 {
        all.push((format!("fan of {n}"), fan(n, false)));
        all.push((format!("closed fan of {n}"), fan(n, true)));
        all.push((format!("prism over {n}"), prism(n)));
    }
    all.push(("bow-tie".to_owned(), bow_tie()));
    all.push(("book".to_owned(), book(3)));
    all
}

/// Random cages: a shape with moved vertices, some faces taken away, some split into triangles, faces in random order and
/// some turned over.
pub fn cage() -> impl Strategy<Value = Soup> {
    let shapes: Vec<Soup> = gallery().into_iter().map(|(_, s)| s).filter(|s| s.face_count() <= 120).collect();
    (prop::sample::select(shapes), any::<u64>(), 0u32..5, 0u32..4).prop_map(|(soup, seed, remove, split)| {
        let mut state = seed | 1;
        let mut random = move |n: u32| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 33) as u32 % n.max(1)
        };
        let positions = soup.positions.iter().map(|p| p.map(|x| x + random(1000) as f32 * 2e-4)).collect();
        let mut faces: Vec<Vec<u32>> = Vec::new();
        for f in 0..soup.face_count() {
            let face = soup.face(f);
            if random(20) < remove {
                continue;
            }
            if random(6) < split {
                faces.extend((1..face.len() - 1).map(|i| vec![face[0], face[i], face[i + 1]]));
            } else {
                faces.push(face.to_vec());
            }
        }
        if faces.is_empty() {
            faces.push(soup.face(0).to_vec());
        }
        for i in (1..faces.len()).rev() {
            faces.swap(i, random(i as u32 + 1) as usize);
        }
        for f in &mut faces {
            if random(7) == 0 {
                f.reverse();
            }
        }
        Soup::from_faces(positions, &faces)
    })
}

/// Any faces at all over a few vertices: everything that can be wrong with a soup but bad indices.
pub fn rubble() -> impl Strategy<Value = Soup> {
    (2u32..9, prop::collection::vec(prop::collection::vec(0u32..8, 0..7), 1..14)).prop_map(|(n, faces)| {
        let positions = (0..n).map(|i| [i as f32, (i * i % 7) as f32, (i * 5 % 3) as f32]).collect();
        let faces: Vec<Vec<u32>> = faces.into_iter().map(|f| f.into_iter().map(|v| v % n).collect()).collect();
        Soup::from_faces(positions, &faces)
    })
}

/// The largest distance when every point of `ours` takes the nearest free point of `theirs`.
pub fn distance(ours: &[[f64; 3]], theirs: &[[f64; 3]]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let mut free = vec![true; theirs.len()];
    let mut worst: f64 = 0.0;
    for p in ours {
        let d = |q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
        let (i, q) =
            theirs.iter().enumerate().filter(|(i, _)| free[*i]).min_by(|a, b| d(a.1).total_cmp(&d(b.1))).unwrap();
        free[i] = false;
        worst = worst.max(d(q).sqrt());
    }
    worst
}
