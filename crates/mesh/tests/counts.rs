//! Counts in closed form against counting, on meshes where that is not obvious: vertices of two faces, one beside the other;
//! rims whose vertices have one, two and more faces; slits.

mod common;

use common::{build, rubble};
use limn_mesh::refine::evaluate;
use limn_mesh::topology::validate;
use limn_mesh::{Boundary, Connectivity, Counts, Mesh, Plan, RefineError, SCHEMES, Soup, Weld, predict, refine};
use proptest::prelude::*;
use std::sync::Arc;

/// A cube with `n` vertices on one of its edges, and as many on another of the same face.
fn beam(n: u32) -> Soup {
    let cube = (limn_mesh::shape("cube").unwrap().build)();
    let mut soup = Soup { positions: cube.positions.clone(), ..Soup::default() };
    let f = cube.face(0);
    let cut = [[f[0], f[1]], [f[1], f[2]]];
    for [a, b] in cut {
        for i in 1..=n {
            let t = i as f32 / (n + 1) as f32;
            let (p, q) = (cube.positions[a as usize], cube.positions[b as usize]);
            soup.positions.push(std::array::from_fn(|k| p[k] + t * (q[k] - p[k])));
        }
    }
    for f in 0..6 {
        let face = cube.face(f);
        let mut corners = Vec::new();
        for (i, &v) in face.iter().enumerate() {
            corners.push(v);
            let w = face[(i + 1) % 4];
            for (e, [a, b]) in cut.into_iter().enumerate() {
                let first = 8 + e as u32 * n;
                if (v, w) == (a, b) {
                    corners.extend(first..first + n);
                } else if (v, w) == (b, a) {
                    corners.extend((first..first + n).rev());
                }
            }
        }
        soup.push_face(&corners);
    }
    soup
}

/// Two n-gons, back to back.
fn coin(n: u32) -> Soup {
    let positions = (0..n).map(|i| [(i % 3) as f32, i as f32, (i * i) as f32]).collect();
    Soup::from_faces(positions, &[(0..n).collect::<Vec<_>>(), (0..n).rev().collect()])
}

/// A closed fan with a flap on one of its spokes, which slits it there.
fn slit() -> Soup {
    let mut soup = common::fan(5, true);
    soup.positions.push([2.0, 2.0, 2.0]);
    let v = soup.positions.len() as u32 - 1;
    soup.push_face(&[0, 1, v]);
    soup
}

fn check(what: &str, mesh: &Arc<Mesh>, levels: u32) {
    for scheme in SCHEMES {
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let plan = Plan::new(scheme, boundary, levels);
            let what = format!("{what}, {}, {boundary:?}", scheme.info.id);
            let mut depth = 0;
            let settled =
                |c: Counts| Counts { rim: [c.rim[0], c.rim[1], c.rim[2] + c.rim[3], 0], triangles: [0; 2], ..c };
            let positions: Vec<[f64; 1]> = mesh.positions.iter().map(|_| [1.0]).collect();
            let levels = evaluate(mesh, &plan, &positions, |level| {
                validate(level).unwrap_or_else(|e| panic!("{what}, level {depth}: {e}"));
                let predicted = predict(mesh, &plan.to(depth)).unwrap().unwrap();
                assert_eq!(settled(level.counts()), settled(predicted.counts), "{what}, level {depth}");
                depth += 1;
            });
            match levels {
                Err(RefineError::NeedsTriangles { .. }) => continue,
                points => assert!(points.unwrap().iter().all(|p| (p[0] - 1.0).abs() < 1e-13), "{what}"),
            }
            let refined = refine(mesh, &plan, u64::MAX).unwrap();
            assert_eq!(predict(mesh, &plan).unwrap().unwrap().counts, refined.counts, "{what}");
            assert_eq!(refined.counts.faces as usize, refined.faces.count(), "{what}");
            assert_eq!(refined.counts.corners as usize, refined.faces.corners().len(), "{what}");
            assert_eq!(refined.counts.euler(), mesh.counts().euler(), "{what}");
        }
    }
}

#[test]
fn vertices_of_two_faces() {
    for n in 1..=5 {
        check(&format!("beam of {n}"), &build(&beam(n)), 5);
        check(&format!("coin of {}", n + 2), &build(&coin(n + 2)), 5);
    }
}

#[test]
fn slits() {
    let mesh = build(&slit());
    assert_eq!(mesh.counts().boundary, 5);
    check("slit", &mesh, 4);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn counts_of_rubble(soup in rubble()) {
        if let Ok((mesh, _)) = Mesh::build(&soup, Weld::Off) {
            check("rubble", &Arc::new(mesh), 3);
        }
    }
}
