//! Plans of more than one scheme, and fairing between levels: the fast path against the slow one, predictions against what
//! is there, and a change of schemes against refining a refined mesh anew.

mod common;

use common::{build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::topology::validate;
use limn_mesh::{
    Boundary, Connectivity, Counts, Fairing, Job, Mesh, Plan, RefineError, Run, SCHEMES, Soup, Weld, predict, refine,
    scheme,
};
use std::sync::Arc;

fn exact(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

fn run(id: &str, from: u32) -> Run {
    Run { from, scheme: scheme(id).unwrap(), params: Default::default() }
}

/// The mesh that a level is, built from its faces.
fn again(mesh: &Arc<Mesh>, plan: &Plan) -> Arc<Mesh> {
    let refined = refine(mesh, plan, u64::MAX).unwrap();
    let mut soup = Soup { positions: refined.points.clone(), ..Soup::default() };
    (0..refined.faces.count()).for_each(|f| soup.push_face(refined.faces.face(f)));
    Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0)
}

fn far(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs())).fold(0.0, f32::max)
}

/// Points in an order of their own: ids follow the parent's half-edges, and a mesh that is built anew numbers its edges anew.
fn sorted(points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut sorted: Vec<_> = points.iter().map(|p| p.map(|x| (x * 1e4).round())).collect();
    sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
    sorted
}

#[test]
fn any_scheme_after_any_other() {
    for (name, soup) in gallery().into_iter().take(12) {
        let mesh = build(&soup);
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for first in SCHEMES {
                for second in SCHEMES {
                    let mut plan = Plan::new(first, boundary, 3);
                    plan.later = vec![Run { from: 1, scheme: second, params: Default::default() }, run("linear", 2)];
                    let what = format!("{name}, {} then {}", first.info.id, second.info.id);
                    let mut depth = 0;
                    let slow = evaluate(&mesh, &plan, &exact(&mesh), |level| {
                        validate(level).unwrap_or_else(|e| panic!("{what}, level {depth}: {e}"));
                        let settled = |c: Counts| Counts {
                            rim: [c.rim[0], c.rim[1], c.rim[2] + c.rim[3], 0],
                            triangles: [0; 2],
                            ..c
                        };
                        let predicted = predict(&mesh, &plan.to(depth)).unwrap().unwrap();
                        assert_eq!(settled(level.counts()), settled(predicted.counts), "{what}, level {depth}");
                        depth += 1;
                    });
                    let slow = match slow {
                        Ok(points) => points,
                        Err(
                            RefineError::NeedsTriangles { .. }
                            | RefineError::NeedsTrianglesAt { .. }
                            | RefineError::Uncounted { .. },
                        ) => continue,
                        Err(e) => panic!("{what}: {e}"),
                    };
                    let fast = refine(&mesh, &plan, u64::MAX).unwrap();
                    let slow: Vec<_> = slow.iter().map(|p| p.map(|x| x as f32)).collect();
                    assert!(far(&fast.points, &slow) < 1e-4, "{what}: {}", far(&fast.points, &slow));
                    assert_eq!(predict(&mesh, &plan).unwrap().unwrap().counts, fast.counts, "{what}");
                    assert_eq!(fast.counts.faces as usize, fast.faces.count(), "{what}");
                    for f in (0..fast.faces.count()).step_by(7) {
                        assert!((fast.face_source(f as u32) as usize) < soup.face_count(), "{what}");
                    }
                    // In slices as in one go.
                    let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
                    let mut last = 0.0;
                    while !job.step(57) {
                        assert!(job.progress() >= last, "{what}");
                        last = job.progress();
                    }
                    assert_eq!(job.finish().points, fast.points, "{what}");
                }
            }
        }
    }
}

/// The second scheme sees a mesh like any other. Closed meshes: corners of an open one are those of level 0 only.
#[test]
fn a_later_scheme_refines_the_level_that_is_there() {
    for name in ["cube", "torus", "icosahedron"] {
        let mesh = build(&(limn_mesh::shape(name).unwrap().build)());
        for first in SCHEMES {
            // Random displacement goes by the number of the level.
            for second in SCHEMES.iter().filter(|s| !s.info.is_random()) {
                let mut plan = Plan::new(first, Boundary::default(), 2);
                plan.later = vec![Run { from: 1, scheme: second, params: Default::default() }];
                let Ok(both) = refine(&mesh, &plan, u64::MAX) else { continue };
                let between = again(&mesh, &plan.to(1));
                let one = refine(&between, &Plan::new(second, Boundary::default(), 1), u64::MAX).unwrap();
                let (a, b) = (sorted(&both.points), sorted(&one.points));
                assert!(far(&a, &b) <= 1.0, "{name}, {} then {}", first.info.id, second.info.id);
                assert_eq!(one.counts.faces, both.counts.faces);
            }
        }
    }
}

/// Two boxes: faces know in which they began, whatever was done to them.
#[test]
fn faces_of_mixed_plans_know_their_part() {
    let cube = (limn_mesh::shape("cube").unwrap().build)();
    let mut two = Soup::default();
    for shift in [-10.0, 10.0] {
        let base = two.positions.len() as u32;
        two.positions.extend(cube.positions.iter().map(|p| [p[0] + shift, p[1], p[2]]));
        (0..6).for_each(|f| two.push_face(&cube.face(f).iter().map(|v| v + base).collect::<Vec<_>>()));
    }
    let mesh = build(&limn_mesh::triangulate_soup(&two).0);
    for ids in
        [["loop", "catmull-clark", "doo-sabin"], ["sqrt3", "loop", "linear"], ["doo-sabin", "linear", "catmull-clark"]]
    {
        let mut plan = Plan::new(scheme(ids[0]).unwrap(), Boundary::default(), 4);
        plan.later = vec![run(ids[1], 1), run(ids[2], 3)];
        let refined = refine(&mesh, &plan, u64::MAX).unwrap();
        let mut seen = [0; 24];
        for f in 0..refined.faces.count() {
            let source = refined.face_source(f as u32) as usize;
            assert_eq!(refined.points[refined.faces.face(f)[0] as usize][0] < 0.0, source < 12, "{ids:?}: face {f}");
            seen[source] += 1;
        }
        assert!(seen.iter().all(|&n| n > 0), "{ids:?}");
    }
}

#[test]
fn a_scheme_of_triangles_after_quads_is_refused_with_a_way_out() {
    let mesh = build(&(limn_mesh::shape("cube").unwrap().build)());
    let mut plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), 3);
    plan.later = vec![run("loop", 2)];
    let error = refine(&mesh, &plan, u64::MAX).unwrap_err();
    assert_eq!(
        error.to_string(),
        "Loop refines triangles only, and the faces of level 2 are not; put `scheme poke from=2` between"
    );
    assert!(refine(&mesh, &plan.to(2), u64::MAX).is_ok());
}

/// Taubin's filter written as in the paper, on vertices and their neighbours.
fn taubin(mut points: Vec<[f64; 3]>, faces: &[Vec<u32>], iterations: usize, corner_stays: bool) -> Vec<[f64; 3]> {
    let n = points.len();
    let mut sides = vec![Vec::new(); n];
    let mut around = vec![0; n];
    for face in faces {
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            sides[a as usize].push(b);
            sides[b as usize].push(a);
            around[a as usize] += 1;
        }
    }
    let ring: Vec<Vec<u32>> = (0..n)
        .map(|v| {
            let once: Vec<u32> =
                sides[v].iter().copied().filter(|w| sides[v].iter().filter(|x| *x == w).count() == 1).collect();
            if !once.is_empty() {
                return if corner_stays && around[v] == 1 { Vec::new() } else { once };
            }
            let mut all = sides[v].clone();
            all.sort_unstable();
            all.dedup();
            all
        })
        .collect();
    for _ in 0..iterations {
        for factor in [0.6307, -0.6732] {
            points = (0..n)
                .map(|v| {
                    let mut p = points[v];
                    for k in 0..3 {
                        let mean =
                            ring[v].iter().map(|&w| points[w as usize][k]).sum::<f64>() / ring[v].len().max(1) as f64;
                        p[k] += if ring[v].is_empty() { 0.0 } else { factor * (mean - p[k]) };
                    }
                    p
                })
                .collect();
        }
    }
    points
}

#[test]
fn fairing_is_taubin_s() {
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        // The reference knows a vertex's neighbours by their numbers: no double edges, no split vertices.
        if mesh.positions.len() != soup.positions.len() || mesh.counts().digons > 0 {
            continue;
        }
        let t = &mesh.topology;
        let faces: Vec<Vec<u32>> =
            (0..t.faces()).map(|f| t.face_half_edges(f).map(|h| t.origin(h)).collect()).collect();
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let mut plan = Plan::new(scheme("linear").unwrap(), boundary, 0);
            plan.fairings = vec![Fairing { at: 0, iterations: 10 }];
            let naive = taubin(exact(&mesh), &faces, 10, boundary == Boundary::EdgeAndCorner);
            let slow = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
            let worst = slow.iter().zip(&naive).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()));
            assert!(worst.fold(0.0, f64::max) < 1e-12, "{name}, {boundary:?}");
            let fast = refine(&mesh, &plan, u64::MAX).unwrap();
            let naive: Vec<_> = naive.iter().map(|p| p.map(|x| x as f32)).collect();
            assert!(far(&fast.points, &naive) < 1e-5, "{name}, {boundary:?}");
        }
    }
}

/// Before, between and after levels, of every kind of split.
#[test]
fn fairing_at_any_level() {
    for name in ["pawn", "torus", "grid"] {
        let Some(shape) = limn_mesh::shape(name) else { continue };
        let mesh = build(&limn_mesh::triangulate_soup(&(shape.build)()).0);
        for scheme in SCHEMES {
            for level in 0..=2 {
                let mut plan = Plan::new(scheme, Boundary::default(), level);
                plan.fairings = (0..=level).map(|at| Fairing { at, iterations: 3 + at }).collect();
                let what = format!("{name}, {}, level {level}", scheme.info.id);
                let slow = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
                let slow: Vec<_> = slow.iter().map(|p| p.map(|x| x as f32)).collect();
                let fast = refine(&mesh, &plan, u64::MAX).unwrap();
                assert!(far(&fast.points, &slow) < 1e-4, "{what}: {}", far(&fast.points, &slow));
                let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
                while !job.step(97) {}
                assert!((job.progress() - 1.0).abs() < 1e-6, "{what}: progress ends at {}", job.progress());
                assert_eq!(job.finish().points, fast.points, "{what}");
            }
        }
    }
}
