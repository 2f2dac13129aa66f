//! Fractal displacement: against the scheme that it wraps and a displacement written anew, and what it promises beside.

mod common;

use common::{build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::topology::is_boundary;
use limn_mesh::{Boundary, Connectivity, Mesh, Params, Plan, RefineError, Split, refine, scheme, triangulate_soup};

type Point = [f64; 3];

const OVER: [&str; 3] = ["linear", "loop", "catmull-clark"];

fn plan(over: usize, seed: f64, amount: f64, level: u32) -> Plan {
    let mut plan = Plan::new(scheme("fractal").unwrap(), Boundary::EdgeOnly, level);
    for (at, value) in [over as f64, seed, amount].into_iter().enumerate() {
        assert!(plan.params.set(&plan.scheme.info, at, value));
    }
    plan
}

fn exact(mesh: &Mesh) -> Vec<Point> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

/// The unit vectors' generator once more, from the description in the module.
fn vector(seed: f64, level: u32, vertex: u64) -> Point {
    let next = |x: u64| {
        let mut z = x.wrapping_add(0x9e3779b97f4a7c15);
        for (shift, factor) in [(30, 0xbf58476d1ce4e5b9u64), (27, 0x94d049bb133111eb)] {
            z = (z ^ z >> shift).wrapping_mul(factor);
        }
        z ^ z >> 31
    };
    let mut state = next(next(next(seed.to_bits()) ^ u64::from(level)) ^ vertex << 32);
    loop {
        let bits = |k: u32| (state >> (21 * k) & ((1 << 21) - 1)) as f64;
        let p = [0, 1, 2].map(|k| (2.0 * bits(k) + 1.0) / 2f64.powi(21) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
            return p;
        }
        state = next(state);
    }
}

/// Nothing is added with amount 0: bit for bit the scheme that is wrapped, points, colours and texture coordinates. With any
/// amount, colours and texture coordinates are its.
#[test]
fn without_an_amount_it_is_the_scheme_itself() {
    for (name, mut soup) in gallery() {
        soup.colors = soup.positions.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
        for (over, id) in OVER.into_iter().enumerate() {
            let soup = if id == "loop" { triangulate_soup(&soup).0 } else { soup.clone() };
            let mesh = build(&soup);
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let mut ours = plan(over, 3.0, 0.0, 2);
                ours.rules.boundary = boundary;
                let wrapped = refine(&mesh, &Plan::new(scheme(id).unwrap(), boundary, 2), u64::MAX).unwrap();
                let refined = refine(&mesh, &ours, u64::MAX).unwrap();
                assert_eq!(refined.points, wrapped.points, "{name} over {id}");
                assert_eq!(refined.faces, wrapped.faces, "{name} over {id}");
                assert_eq!(refined.colors, wrapped.colors, "{name} over {id}");
                ours.params.set(&ours.scheme.info, 2, 0.2);
                let moved = refine(&mesh, &ours, u64::MAX).unwrap();
                assert_ne!(moved.points, wrapped.points, "{name} over {id}");
                assert_eq!(moved.colors, wrapped.colors, "{name} over {id}");
            }
        }
    }
}

/// Over a linear split: midpoints and centroids, each with its own vector, half as long at the second level.
#[test]
fn new_points_of_inner_edges_and_faces_are_moved() {
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        if mesh.face_shape() == limn_mesh::FaceShape::Triangles {
            continue;
        }
        // Inner edges are met from both sides.
        let t = &mesh.topology;
        let sides = (0..t.half_edges()).map(|h| {
            let [p, q] = [h, t.next(h)].map(|h| mesh.positions[t.origin(h) as usize].map(f64::from));
            let length = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
            if is_boundary(t.twin(h)) { length } else { length / 2.0 }
        });
        let size = sides.sum::<f64>() / f64::from(t.edges());
        let linear = Plan::new(scheme("linear").unwrap(), Boundary::EdgeOnly, 1);
        let mut parent = exact(&mesh);
        let mut moved = 0;
        for level in 0..2 {
            // What the level's own linear split would give, from the displaced level before it.
            let ours = evaluate(&mesh, &plan(0, 9.0, 0.1, level + 1), &exact(&mesh), |_| ()).unwrap();
            let mut still = None;
            evaluate(&mesh, &linear.to(level + 1), &exact(&mesh), |c| {
                if c.vertices() as usize != parent.len() {
                    return;
                }
                let mut points = parent.clone();
                let middle = |corners: &[u32]| -> Point {
                    let n = corners.len() as f64;
                    [0, 1, 2].map(|k| corners.iter().map(|&v| parent[v as usize][k]).sum::<f64>() / n)
                };
                let push = |points: &mut Vec<Point>, p: Point, rim: bool| {
                    let by = vector(9.0, level, points.len() as u64);
                    let reach = if rim { 0.0 } else { 0.1 * size / f64::from(1 << level) };
                    points.push([0, 1, 2].map(|k| p[k] + reach * by[k]));
                };
                for f in 0..c.faces() {
                    let corners: Vec<u32> = c.face_half_edges(f).map(|h| c.origin(h)).collect();
                    push(&mut points, middle(&corners), false);
                }
                for e in 0..c.edges() {
                    let h = c.edge_half_edge(e);
                    let rim = is_boundary(c.twin(h));
                    moved += u32::from(!rim);
                    push(&mut points, middle(&[c.origin(h), c.origin(c.next(h))]), rim);
                }
                still = Some(points);
            })
            .unwrap();
            let expected = still.unwrap();
            assert_eq!(expected.len(), ours.len());
            for (v, (p, q)) in expected.iter().zip(&ours).enumerate() {
                let close = (0..3).all(|k| (p[k] - q[k]).abs() < 1e-12 * (1.0 + size));
                assert!(close, "{name}, level {level}, vertex {v}: {p:?} and {q:?}");
            }
            parent = ours;
        }
        assert!(moved > 0 || mesh.counts().edges == mesh.counts().boundary, "{name}");
    }
}

#[test]
fn a_seed_is_a_surface() {
    let mesh = build(&(limn_mesh::shape("cube").unwrap().build)());
    let points = |seed| refine(&mesh, &plan(2, seed, 0.1, 4), u64::MAX).unwrap().points;
    assert_eq!(points(5.0), points(5.0));
    assert_ne!(points(5.0), points(6.0));
    // As it was when it was first made: a link must show the same surface for ever.
    let first = points(5.0)[8];
    assert_eq!(first.map(f32::to_bits), FIRST, "{first:?} {:x?}", first.map(f32::to_bits));
}

const FIRST: [u32; 3] = [0xbd61_596e, 0xbc39_4141, 0xbf61_f621];

/// Displacement is even: no direction and no octant is preferred, and half of the ball's volume gets half of the vectors.
#[test]
fn vectors_fill_the_ball_evenly() {
    let n = 40_000;
    let all: Vec<Point> = (0..n).map(|v| vector(1.0, 0, v)).collect();
    let mean = |f: &dyn Fn(&Point) -> f64| all.iter().map(f).sum::<f64>() / n as f64;
    for k in 0..3 {
        assert!(mean(&|p| p[k]).abs() < 0.01);
        // The variance along a direction of the uniform ball is 1/5.
        assert!((mean(&|p| p[k] * p[k]) - 0.2).abs() < 0.01);
        assert!(mean(&|p| p[k] * p[(k + 1) % 3]).abs() < 0.01);
    }
    let half = 0.5f64.powf(2.0 / 3.0);
    assert!((mean(&|p| f64::from(p.iter().map(|x| x * x).sum::<f64>() < half)) - 0.5).abs() < 0.01);
}

#[test]
fn it_takes_what_the_wrapped_scheme_takes() {
    let mesh = build(&(limn_mesh::shape("cube").unwrap().build)());
    let info = &scheme("fractal").unwrap().info;
    assert!(matches!(refine(&mesh, &plan(1, 1.0, 0.1, 1), u64::MAX), Err(RefineError::NeedsTriangles { .. })));
    let triangles = build(&triangulate_soup(&(limn_mesh::shape("cube").unwrap().build)()).0);
    assert_eq!(plan(0, 1.0, 0.1, 1).split(&triangles), Ok(Split::Triangle));
    assert_eq!(plan(2, 1.0, 0.1, 1).split(&triangles), Ok(Split::Quad));
    assert_eq!(info.behind(&Params::default().of(info)).id, "linear");
}
