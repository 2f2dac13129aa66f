//! The cages that benchmarks refine, all closed and all made by code, with the same bits natively and as WebAssembly.
//!
//! ```text
//!   torus(n)   n x n quads               mixed(n)   a torus whose rows take turns:
//!   sphere(n)  8 n^2 triangles,                     quads | two triangles each | hexagons | triangle and pentagon
//!              an octahedron pushed out             [][]    [/][/]               [    ]     [   /]
//! ```
//!
//! Cost: linear. Limit: sizes are small enough for 32-bit indices; nothing is checked.
#![expect(clippy::indexing_slicing, reason = "every index is made here, for the array that it is used on")]

use limn_mesh::{Soup, shape, triangulate_soup};
use std::f64::consts::TAU;

/// The cage of a name, whose size is `n`: `torus` and `triangles` (n by n cells), `sphere` (8 n^2 triangles), and the built-in models
/// by their names, in triangles after `-triangles`. Empty if there is none of that name.
pub fn cage(name: &str, n: u32) -> Soup {
    let model = |name: &str| shape(name).map(|shape| (shape.build)()).unwrap_or_default();
    match (name, name.strip_suffix("-triangles")) {
        ("torus", _) => torus(n, n),
        ("triangles", _) => torus_triangles(n, n),
        ("sphere", _) => sphere(n as i32),
        (_, Some(name)) => triangulate_soup(&model(name)).0,
        _ => model(name),
    }
}

/// A ring of `n` by `m` quads, every vertex of valence 4. Radii 1 and 0.4.
pub fn torus(n: u32, m: u32) -> Soup {
    let faces: Vec<[u32; 4]> = cells(n, m).map(|(i, j)| corners(n, m, i, j)).collect();
    Soup::from_faces(ring(n, m), &faces)
}

/// The same of triangles: `2 n m`, every vertex of valence 6.
pub fn torus_triangles(n: u32, m: u32) -> Soup {
    let faces: Vec<[u32; 3]> = cells(n, m)
        .flat_map(|(i, j)| {
            let [a, b, c, d] = corners(n, m, i, j);
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Soup::from_faces(ring(n, m), &faces)
}

/// Every fourth of a torus's rings as a crease, by turns of sharpness 2.5 and infinitely sharp.
pub fn rings(n: u32, m: u32) -> Vec<([u32; 2], f32)> {
    let sharp = cells(n, m).filter(|(_, j)| j % 4 == 0);
    sharp.map(|(i, j)| ([j * n + i, j * n + (i + 1) % n], if j % 8 == 0 { 2.5 } else { 10.0 })).collect()
}

/// A ring of faces of three to six corners; `m` divisible by 4.
pub fn mixed(n: u32, m: u32) -> Soup {
    let mut soup = Soup { positions: ring(n, m), ..Soup::default() };
    for (i, j) in cells(n, m) {
        let [a, b, c, d] = corners(n, m, i, j);
        let [_, e, f, _] = corners(n, m, (i + 1) % n, j);
        match (j % 4, i % 2) {
            (0, _) => soup.push_face(&[a, b, c, d]),
            (1, _) => {
                soup.push_face(&[a, b, c]);
                soup.push_face(&[a, c, d]);
            }
            // Two cells in a row, without the side between them.
            (2, 0) => soup.push_face(&[a, b, e, f, c, d]),
            (3, 0) => {
                soup.push_face(&[b, e, f]);
                soup.push_face(&[a, b, f, c, d]);
            }
            _ => {}
        }
    }
    soup
}

/// A unit sphere of `8 n^2` triangles: the lattice points with |x| + |y| + |z| = n, pushed out. Six of valence 4.
pub fn sphere(n: i32) -> Soup {
    // One place for every x and y, and for either side of the equator.
    let side = 2 * n + 1;
    let mut ids = vec![u32::MAX; 2 * (side * side) as usize];
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut faces = Vec::new();
    for octant in 0..8 {
        let sign = [1 - 2 * (octant & 1), 1 - (octant & 2), 1 - (octant & 4) / 2];
        let mut id = |i: i32, j: i32| {
            let p = [sign[0] * i, sign[1] * j, sign[2] * (n - i - j)];
            let id = &mut ids[(2 * ((p[0] + n) * side + p[1] + n) + i32::from(p[2] < 0)) as usize];
            if *id == u32::MAX {
                *id = positions.len() as u32;
                let length = p.iter().map(|x| f64::from(x * x)).sum::<f64>().sqrt();
                positions.push(p.map(|x| (f64::from(x) / length) as f32));
            }
            *id
        };
        let turned = sign.iter().product::<i32>() < 0;
        let mut push = |[a, b, c]: [u32; 3]| faces.push(if turned { [a, c, b] } else { [a, b, c] });
        for i in 0..n {
            for j in 0..n - i {
                push([id(i, j), id(i + 1, j), id(i, j + 1)]);
                if i + j + 1 < n {
                    push([id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
                }
            }
        }
    }
    Soup::from_faces(positions, &faces)
}

/// The same mesh with vertices and faces in a random order, the same on every run.
pub fn shuffled(soup: &Soup) -> Soup {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut order = |n: usize| {
        let mut order: Vec<u32> = (0..n as u32).collect();
        for i in (1..n).rev() {
            // xorshift64 (Marsaglia 2003).
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            order.swap(i, (state % (i as u64 + 1)) as usize);
        }
        order
    };
    let place = order(soup.positions.len());
    let mut positions = soup.positions.clone();
    for (from, &to) in place.iter().enumerate() {
        positions[to as usize] = soup.positions[from];
    }
    let face = |&f: &u32| soup.face(f as usize).iter().map(|&v| place[v as usize]).collect::<Vec<_>>();
    let faces: Vec<_> = order(soup.face_count()).iter().map(face).collect();
    Soup::from_faces(positions, &faces)
}

fn cells(n: u32, m: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..m).flat_map(move |j| (0..n).map(move |i| (i, j)))
}

fn corners(n: u32, m: u32, i: u32, j: u32) -> [u32; 4] {
    let (right, up) = ((i + 1) % n, (j + 1) % m);
    [j * n + i, j * n + right, up * n + right, up * n + i]
}

fn ring(n: u32, m: u32) -> Vec<[f32; 3]> {
    cells(n, m)
        .map(|(i, j)| {
            let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
            let r = 1.0 + 0.4 * libm::cos(v);
            [r * libm::cos(u), 0.4 * libm::sin(v), -r * libm::sin(u)].map(|x| x as f32)
        })
        .collect()
}
