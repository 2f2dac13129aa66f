//! Normals of the limit at vertices of a boundary with any number of faces, by every scheme: against the faces around the
//! vertex five levels further on (√3 splits eight and ten), each by its angle there.

mod common;

use limn_mesh::limit::LimitRule;
use limn_mesh::refine::{evaluate, evaluate_limit};
use limn_mesh::{Boundary, Mesh, Plan, SCHEMES, Soup, Weld, refine};
use std::f64::consts::PI;
use std::sync::Arc;

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Half fans of 1 to 9 quads around vertex 0.
fn quads() -> impl Iterator<Item = (String, Soup)> {
    (1..=9u32).map(|n| {
        let mut positions = vec![[0.0, 0.0, 0.5]];
        for i in 0..=2 * n {
            let angle = PI * f64::from(i) / f64::from(2 * n.max(2));
            let r = if i % 2 == 1 { 1.4 } else { 1.0 };
            positions.push([(r * angle.cos()) as f32, (r * angle.sin()) as f32, 0.1 * (i * 7 % 5) as f32]);
        }
        let faces: Vec<[u32; 4]> = (0..n).map(|i| [0, 2 * i + 1, 2 * i + 2, 2 * i + 3]).collect();
        (format!("half a fan of {n} quads"), Soup::from_faces(positions, &faces))
    })
}

/// The mean of the normals of the faces around vertex 0 of a level, by their angles there.
fn normal_of_level(mesh: &Mesh, plan: &Plan, positions: &[Vector]) -> Vector {
    let points = evaluate(mesh, plan, positions, |_| ()).unwrap();
    let level = refine(&Arc::new(mesh.clone()), plan, u64::MAX).unwrap();
    let mut sum = [0.0; 3];
    for f in 0..level.faces.count() {
        let face = level.faces.face(f);
        let Some(i) = face.iter().position(|&v| v == 0) else { continue };
        let to = |i: usize| unit(minus(points[face[i % face.len()] as usize], points[0]));
        let (a, b) = (to(i + 1), to(i + face.len() - 1));
        let (angle, n) = (dot(a, b).clamp(-1.0, 1.0).acos(), unit(cross(a, b)));
        sum = std::array::from_fn(|k| sum[k] + angle * n[k]);
    }
    unit(sum)
}

#[test]
fn normals_at_rims_are_those_of_deep_levels() {
    let keeps = |limit| !matches!(limit, LimitRule::Itself | LimitRule::MidEdge);
    for scheme in SCHEMES.iter().filter(|s| keeps(s.limit) && s.info.group != "dual" && !s.info.is_random()) {
        let mut found = 0;
        for (name, soup) in common::half_fans().chain(quads()) {
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
                let positions: Vec<Vector> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
                let plan = Plan::new(scheme, boundary, 0);
                if plan.split(&mesh).is_err() {
                    continue;
                }
                let Some(normal) = evaluate_limit(&mesh, &plan, &positions).unwrap().normals[0] else { continue };
                // Interpolating √3 comes near at half the distance in two steps.
                let (depth, near) = match scheme.info.id {
                    "sqrt3" => (8, 0.012),
                    "interpolating-sqrt3" => (10, 0.02),
                    _ => (5, 0.012),
                };
                let off = 1.0 - dot(normal, normal_of_level(&mesh, &plan.to(depth), &positions));
                assert!(off < near, "{name}, {}, {boundary:?}: {off}", scheme.info.id);
                found += 1;
            }
        }
        // The wavy ones have no plane from few faces on.
        let least = match scheme.info.id {
            "interpolating-sqrt3" => 10,
            "j-spline" => 4,
            "butterfly" => 5,
            _ => 17,
        };
        assert!(found >= least, "{}: {found} normals", scheme.info.id);
    }
}
