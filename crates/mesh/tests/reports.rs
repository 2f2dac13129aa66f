//! Counts that the reports on Doo-Sabin print, on meshes of the same counts: a closed mesh of E edges and Euler number X has
//! 2 * 4 * E vertices after two steps, and X more faces.

mod common;

use common::build;
use limn_mesh::{Boundary, Plan, Soup, predict, refine, scheme};

/// Appends a double pyramid over a ring of `n`: 2 n triangles. Every second side of the ring, `joined` of them, joins the two
/// triangles that it lies between to a quad.
fn double_pyramid(soup: &mut Soup, n: u32, joined: u32) {
    let base = soup.positions.len() as u32;
    let shift = 3.0 * base as f32;
    soup.positions.extend([[shift, 0.0, 1.0], [shift, 0.0, -1.0]]);
    soup.positions.extend((0..n).map(|i| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / n as f32).sin_cos();
        [shift + cos, sin, 0.0]
    }));
    let (top, bottom) = (base, base + 1);
    for i in 0..n {
        let (a, b) = (base + 2 + i, base + 2 + (i + 1) % n);
        if i % 2 == 1 && i / 2 < joined {
            soup.push_face(&[top, a, bottom, b]);
        } else {
            soup.push_face(&[top, a, b]);
            soup.push_face(&[bottom, b, a]);
        }
    }
}

/// A ball of `rings` rings of `n` vertices between two poles, whose first `cut` quads are cut in two.
fn ball(rings: u32, n: u32, cut: u32) -> Soup {
    let mut soup = Soup { positions: vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], ..Soup::default() };
    for r in 1..=rings {
        let (sin, cos) = (std::f32::consts::PI * r as f32 / (rings + 1) as f32).sin_cos();
        soup.positions.extend((0..n).map(|i| {
            let (s, c) = (std::f32::consts::TAU * i as f32 / n as f32).sin_cos();
            [sin * c, sin * s, cos]
        }));
    }
    let at = |r: u32, i: u32| 2 + r * n + i % n;
    for i in 0..n {
        soup.push_face(&[0, at(0, i), at(0, i + 1)]);
        soup.push_face(&[1, at(rings - 1, i + 1), at(rings - 1, i)]);
        for r in 0..rings - 1 {
            let quad = [at(r, i), at(r + 1, i), at(r + 1, i + 1), at(r, i + 1)];
            if i * (rings - 1) + r < cut {
                soup.push_face(&[quad[0], quad[1], quad[2]]);
                soup.push_face(&[quad[2], quad[3], quad[0]]);
            } else {
                soup.push_face(&quad);
            }
        }
    }
    soup
}

#[test]
fn doo_sabin_counts_of_olsen_s_models() {
    // 22 parts, 2 parts, 1 part.
    let mut many = Soup::default();
    (0..21).for_each(|i| double_pyramid(&mut many, 14, if i < 2 { 4 } else { 0 }));
    double_pyramid(&mut many, 16, 0);
    let mut two = Soup::default();
    double_pyramid(&mut two, 130, 0);
    double_pyramid(&mut two, 129, 0);
    for (soup, level0, parts, level2) in [
        (many, [354, 922, 612], 22, [7376, 7420]),
        (two, [263, 777, 518], 2, [6216, 6220]),
        (ball(15, 41, 193), [617, 1464, 849], 1, [11712, 11714]),
    ] {
        let mesh = build(&soup);
        let c = mesh.counts();
        assert_eq!([c.vertices, c.edges, c.faces], level0);
        assert_eq!((mesh.stats().components, c.boundary, c.euler()), (parts, 0, 2 * parts as i64));
        let plan = Plan::new(scheme("doo-sabin").unwrap(), Boundary::default(), 2);
        let refined = refine(&mesh, &plan, u64::MAX).unwrap();
        assert_eq!([refined.points.len() as u64, refined.faces.count() as u64], level2);
        assert_eq!(predict(&mesh, &plan).unwrap().unwrap().counts, refined.counts);
    }
}
