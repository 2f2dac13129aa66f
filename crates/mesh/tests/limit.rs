//! Limit points, tangents and normals: against OpenSubdiv's (tests/oracles/limit_*.json), and level against level.

mod common;

use common::gallery;
use limn_mesh::limit::{Limit, LimitRule, Projector, limit};
use limn_mesh::refine::{evaluate, evaluate_limit};
use limn_mesh::scheme::Tags;
use limn_mesh::split::Level;
use limn_mesh::topology::is_boundary;
use limn_mesh::{Boundary, Connectivity, Job, Mesh, Plan, SCHEMES, Soup, Split, Weld, refine, scheme};
use serde_json::Value;
use std::cell::RefCell;
use std::sync::Arc;

/// The points of a level, and their limit.
fn level_and_limit(mesh: &Mesh, plan: &Plan, level: u32) -> (Vec<[f64; 3]>, Limit) {
    let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let points = evaluate(mesh, &plan.to(level), &positions, |_| ()).unwrap();
    let found = limits(mesh, plan, &positions, level);
    (points, found)
}

fn limits(mesh: &Mesh, plan: &Plan, positions: &[[f64; 3]], level: u32) -> Limit {
    evaluate_limit(mesh, &plan.to(level), positions).unwrap()
}

/// Calls `f` with a level, what the scheme needs to refine it, and its points.
fn on_level<T: Default>(
    mesh: &Mesh,
    plan: &Plan,
    positions: &[[f64; 3]],
    level: u32,
    f: impl Fn((&Level<'_>, Split, Tags<'_>), &[[f64; 3]]) -> T,
) -> T {
    let split = plan.split(mesh).unwrap().at(level);
    let points = evaluate(mesh, &plan.to(level), positions, |_| ()).unwrap();
    let t = &mesh.topology;
    let corner = |&v: &u32| {
        let start = t.vertex_half_edge(v);
        plan.rules.boundary == Boundary::EdgeAndCorner
            && is_boundary(t.twin(start))
            && is_boundary(t.twin(t.prev(start)))
    };
    // Corners as level 0 has them, which later levels of some schemes cannot tell.
    let sharp: Vec<bool> =
        (0..t.vertices()).map(|v| mesh.sharp.get(v as usize).is_some_and(|s| *s) || corner(&v)).collect();
    let found = RefCell::new((0, T::default()));
    // `evaluate` shows every level but the last.
    evaluate(mesh, &plan.to(level + 1), positions, |view: &Level<'_>| {
        let mut found = found.borrow_mut();
        if found.0 == level {
            let params = plan.params.of(&plan.scheme.info);
            let tags = Tags { sharp: &sharp, ..Tags::new(plan.rules, params) };
            found.1 = f((view, split, tags), &points);
        }
        found.0 += 1;
    })
    .unwrap();
    found.into_inner().1
}

fn triples(v: &Value) -> Vec<[f64; 3]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

fn far(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

fn check(json: &str) {
    let oracle: Value = serde_json::from_str(json).unwrap();
    let positions = triples(&oracle["mesh"]["positions"]);
    let faces: Vec<Vec<u32>> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
    let id = if oracle["scheme"] == "catmark" { "catmull-clark" } else { "loop" };
    let corner = oracle["options"]["vtxBoundary"] == "EDGE_AND_CORNER";
    let boundary = if corner { Boundary::EdgeAndCorner } else { Boundary::EdgeOnly };
    for theirs in oracle["levels"].as_array().unwrap() {
        let level = theirs["level"].as_u64().unwrap() as u32;
        let plan = Plan::new(scheme(id).unwrap(), boundary, level);
        let (points, ours) = level_and_limit(&mesh, &plan, level);
        let [at, goes, normals] = ["positions", "limitPositions", "limitNormals"].map(|key| triples(&theirs[key]));
        assert_eq!(points.len(), at.len());
        for (i, p) in points.iter().enumerate() {
            let j = (0..at.len()).min_by(|&a, &b| far(at[a], *p).total_cmp(&far(at[b], *p))).unwrap();
            assert!(far(at[j], *p) < 1e-7);
            let d = far(ours.points[i], goes[j]);
            assert!(d < 1e-7, "level {level}, vertex {i} at {p:?}: {:?}, not {:?}", ours.points[i], goes[j]);
            if normals[j] != [0.0; 3] {
                let normal = ours.normals[i].unwrap_or_else(|| panic!("level {level}, vertex {i}: no normal"));
                let d = far(normal, normals[j]);
                assert!(d < 1e-6, "level {level}, vertex {i} at {p:?}: normal {normal:?}, not {:?}", normals[j]);
            }
        }
    }
}

macro_rules! oracles {
    ($($name:ident)*) => { $(
        #[test]
        fn $name() {
            check(include_str!(concat!("../../../tests/oracles/limit_", stringify!($name), ".json")));
        }
    )* };
}

oracles! {
    cube_catmark tetra_catmark grid3_catmark_edgeonly grid3_catmark_edgecorner
    icosa_loop tetra_loop gridtri3_loop_edgeonly gridtri3_loop_edgecorner
}

/// Refining does not move the limit: a vertex's limit is that of its child, and so are its normal and tangent plane.
#[test]
fn refining_does_not_move_the_limit() {
    for (name, soup) in gallery() {
        let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for scheme in SCHEMES {
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let plan = Plan::new(scheme, boundary, 0);
                if scheme.info.group == "dual" || plan.split(&mesh).is_err() {
                    continue;
                }
                let what = format!("{name}, {}, {boundary:?}", scheme.info.id);
                let [a, b, c] = [0, 1, 2].map(|level| limits(&mesh, &plan, &positions, level));
                for (level, (a, b)) in [(&a, &b), (&b, &c)].into_iter().enumerate() {
                    for v in 0..a.points.len() {
                        let d = far(a.points[v], b.points[v]);
                        assert!(d < 1e-9, "{what}, level {level}: vertex {v} is off by {d}");
                        let (Some(m), Some(n)) = (a.normals[v], b.normals[v]) else {
                            // Near boundaries the analysis of sqrt3 splits has to wait until they are far away.
                            if scheme.info.id != "interpolating-sqrt3" {
                                assert_eq!(a.normals[v], b.normals[v], "{what}, level {level}: vertex {v}");
                            }
                            continue;
                        };
                        assert!(far(m, n) < 1e-7, "{what}, level {level}: vertex {v}: {m:?} and {n:?}");
                    }
                }
            }
        }
    }
}

/// The closed forms are what the analysis of the rules finds: two ways to every figure.
#[test]
fn analysis_finds_the_closed_forms() {
    for (name, soup) in gallery() {
        let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for scheme in
            SCHEMES.iter().filter(|s| !matches!(s.limit, LimitRule::Analysis | LimitRule::Itself | LimitRule::MidEdge))
        {
            for (boundary, level) in [(Boundary::EdgeOnly, 0), (Boundary::EdgeAndCorner, 0), (Boundary::EdgeOnly, 1)] {
                let plan = Plan::new(scheme, boundary, 0);
                if plan.split(&mesh).is_err() {
                    continue;
                }
                let what = format!("{name}, {}, {boundary:?}, level {level}", scheme.info.id);
                let (compared, smooth) = on_level(&mesh, &plan, &positions, level, |on, points| {
                    let (mut closed, mut analysed) = (Projector::new(scheme, on), Projector::by_analysis(scheme, on));
                    let at = |v: u32| points[v as usize];
                    let (mut compared, mut smooth) = (0, 0);
                    for v in 0..points.len() as u32 {
                        // The analysis leaves the boundaries of sqrt3 alone.
                        if scheme.limit == LimitRule::Sqrt3 && mesh.counts().boundary > 0 {
                            continue;
                        }
                        let (a, b) = (closed.mask(v).clone(), analysed.mask(v).clone());
                        let d = far(a.point(at), b.point(at));
                        assert!(d < 1e-9, "{what}: vertex {v} is off by {d}");
                        compared += 1;
                        if a.sectors != 1 || b.sectors == 0 {
                            continue;
                        }
                        // The same plane: tangents of one are right-angled to the normal of the other.
                        let (Some(m), Some(n)) = (a.normal(at), b.normal(at)) else { continue };
                        assert!(far(m, n) < 1e-9, "{what}: vertex {v}: {m:?}, and by analysis {n:?}");
                        smooth += 1;
                    }
                    (compared, smooth)
                });
                println!("{what}: {compared} points, {smooth} normals");
            }
        }
    }
}

/// Where vertices of a dual scheme go: inside to the mean of their images, on a boundary to the middle between the first
/// image and the last (Chaikin's curve touches its polygon there), at a kept corner nowhere.
#[test]
fn dual_vertices_go_to_the_mean_of_their_images() {
    for (name, soup) in gallery() {
        let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for scheme in SCHEMES.iter().filter(|s| s.info.id.starts_with("doo-sabin")) {
            for (boundary, level) in [(Boundary::EdgeOnly, 0), (Boundary::EdgeAndCorner, 0), (Boundary::EdgeOnly, 1)] {
                let plan = Plan::new(scheme, boundary, 0);
                let images = evaluate(&mesh, &plan.to(level + 1), &positions, |_| ()).unwrap();
                on_level(&mesh, &plan, &positions, level, |on, points| {
                    let (c, limit) = (on.0, limit(scheme, on, points));
                    for v in 0..c.vertices() {
                        let mut own = Vec::new();
                        let curve = c.turn(v, |h| own.push(images[h as usize]));
                        if let Some(arriving) = curve {
                            own = match (own.len(), boundary) {
                                (1, Boundary::EdgeAndCorner) => vec![points[v as usize]],
                                _ => {
                                    let next = points[c.origin(c.next(c.vertex_half_edge(v))) as usize];
                                    let before = points[c.origin(arriving) as usize];
                                    let p = points[v as usize];
                                    vec![std::array::from_fn(|k| 0.75 * p[k] + 0.125 * (next[k] + before[k]))]
                                }
                            };
                        }
                        let mean: [f64; 3] =
                            std::array::from_fn(|k| own.iter().map(|p| p[k]).sum::<f64>() / own.len() as f64);
                        let d = far(limit.points[v as usize], mean);
                        assert!(d < 1e-9, "{name}, {}, {boundary:?}, level {level}: vertex {v}: {d}", scheme.info.id);
                    }
                });
            }
        }
    }
}

/// Mid-edge: a face shrinks to its centroid, whatever the level; along the rim the middles of the edges that are left of its
/// vertices stay, and so do middles of whole edges half way.
#[test]
fn mid_edge_faces_shrink_to_their_centroids() {
    let scheme = scheme("mid-edge").unwrap();
    for (name, soup) in gallery() {
        let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for (boundary, level) in
            [0, 1, 2].into_iter().flat_map(|l| [Boundary::EdgeOnly, Boundary::EdgeAndCorner].map(|b| (b, l)))
        {
            let plan = Plan::new(scheme, boundary, 0);
            let what = format!("{name}, {boundary:?}, level {level}");
            let (found, here) = on_level(&mesh, &plan, &positions, level, |on, points| {
                let rim: Vec<bool> =
                    (0..on.0.vertices()).map(|v| is_boundary(on.0.twin(on.0.vertex_half_edge(v)))).collect();
                (limit(scheme, on, points), rim)
            });
            // The limit of a level and of one two further: every limit point is one there, or the middle of a rim's edge, or
            // the centroid of a face.
            let candidates = on_level(&mesh, &plan, &positions, level + 2, |on, points| {
                let (c, limits) = (on.0, limit(scheme, on, points));
                let centroid = |f: u32| {
                    let corners: Vec<_> = c.face_half_edges(f).map(|h| points[c.origin(h) as usize]).collect();
                    std::array::from_fn(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64)
                };
                let mut all: Vec<[f64; 3]> = (0..c.faces()).map(centroid).collect();
                all.extend((0..c.boundary_half_edges()).map(|r| {
                    let h = c.boundary_half_edge(r);
                    let (p, q) = (points[c.origin(h) as usize], points[c.origin(c.next(h)) as usize]);
                    std::array::from_fn(|k| (p[k] + q[k]) / 2.0)
                }));
                all.extend(limits.points);
                all
            });
            for (v, p) in found.points.iter().enumerate() {
                let d = candidates.iter().map(|q| far(*p, *q)).fold(f64::MAX, f64::min);
                assert!(d < 1e-12, "{what}: vertex {v}, rim {}: {d}", here[v]);
            }
        }
    }
}

/// Six levels further the surface is nearly there: points, and normals where there are any, on the right side.
#[test]
fn refinement_comes_close() {
    for (name, soup) in gallery().into_iter().filter(|(_, s)| s.face_count() <= 24) {
        let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
        let cut = mesh.positions.len() > soup.positions.len();
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for scheme in SCHEMES.iter().filter(|s| s.limit != LimitRule::Itself) {
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let plan = Plan::new(scheme, boundary, 0);
                if plan.split(&mesh).is_err() {
                    continue;
                }
                let dual = scheme.info.group == "dual";
                let depth = match scheme.limit {
                    LimitRule::Sqrt3 => 8,
                    LimitRule::MidEdge => 9,
                    _ => 5,
                };
                let what = format!("{name}, {}, {boundary:?}", scheme.info.id);
                let limit = limits(&mesh, &plan, &positions, 0);
                let deep = refine(&Arc::new(mesh.clone()), &plan.to(depth), u64::MAX).unwrap();
                let normals = deep.normals();
                for v in 0..limit.points.len() {
                    let gap = |w: usize| far(deep.points[w].map(f64::from), limit.points[v]);
                    let w = if dual {
                        (0..deep.points.len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap()
                    } else {
                        v
                    };
                    // A mid-edge face of many corners shrinks slowly, to its centroid.
                    let slow = scheme.limit == LimitRule::MidEdge;
                    let middles = (0..deep.faces.count()).filter(|_| slow).map(|f| {
                        let face = deep.faces.face(f);
                        let sum = |k: usize| face.iter().map(|w| f64::from(deep.points[*w as usize][k])).sum::<f64>();
                        far([0, 1, 2].map(|k| sum(k) / face.len() as f64), limit.points[v])
                    });
                    let gap = middles.fold(gap(w), f64::min);
                    assert!(gap < 0.15, "{what}: vertex {v} is {gap} away");
                    // The nearest point to a cut may be on its other side.
                    let Some(n) = limit.normals[v].filter(|_| !(dual && cut)) else { continue };
                    let cos: f64 = (0..3).map(|k| n[k] * f64::from(normals[w][k])).sum();
                    assert!(cos > 0.9, "{what}: vertex {v}: {n:?} and {:?}", normals[w]);
                }
            }
        }
    }
}

/// What a job makes of a plan that goes to the limit: the points, colours left as they are, normals, whatever the slices.
#[test]
fn jobs_go_to_the_limit() {
    for (name, mut soup) in gallery().into_iter().filter(|(_, s)| s.face_count() <= 60) {
        soup.colors = soup.positions.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
        let mesh = Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0);
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for scheme in SCHEMES {
            for level in 0..=2 {
                let plan = Plan { limit: true, ..Plan::new(scheme, Boundary::default(), level) };
                if plan.split(&mesh).is_err() {
                    continue;
                }
                let what = format!("{name}, {}, level {level}", scheme.info.id);
                let whole = refine(&mesh, &plan, u64::MAX).unwrap();
                let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
                while !job.step(97) {
                    assert!(job.progress() <= 1.0);
                }
                let idle = level == 0 && scheme.limit == LimitRule::Itself;
                assert!(idle || (job.progress() - 1.0).abs() < 1e-6, "{what}: progress ends at {}", job.progress());
                let sliced = job.finish();
                assert_eq!(whole.points, sliced.points, "{what}");
                assert_eq!(whole.limit_normals, sliced.limit_normals, "{what}");
                assert_eq!(whole.normals(), sliced.normals(), "{what}");
                let plain = refine(&mesh, &Plan { limit: false, ..plan.clone() }, u64::MAX).unwrap();
                assert_eq!((&plain.faces, &plain.colors), (&whole.faces, &whole.colors), "{what}");

                let exact = evaluate(&mesh, &plan, &positions, |_| ()).unwrap();
                let found = evaluate_limit(&mesh, &plan, &positions).unwrap();
                assert_eq!(exact, found.points, "{what}");
                let normals = whole.normals();
                for v in 0..exact.len() {
                    let d = far(whole.points[v].map(f64::from), exact[v]);
                    assert!(d < 1e-5, "{what}: vertex {v} is off by {d}");
                    let length: f32 = normals[v].iter().map(|x| x * x).sum();
                    assert!((length - 1.0).abs() < 1e-5 || normals[v] == [0.0; 3], "{what}: {:?}", normals[v]);
                    if let Some(n) = found.normals[v] {
                        // Points in f32 turn the normals of slivers.
                        let cos: f64 = (0..3).map(|k| n[k] * f64::from(normals[v][k])).sum();
                        assert!(cos > 0.999, "{what}: vertex {v}: {n:?} and {:?}", normals[v]);
                    }
                }
            }
        }
    }
}

/// Schemes one after the other, and fairing: the limit is that of the scheme that would come next.
#[test]
fn the_scheme_that_comes_next_says_where_the_limit_is() {
    let mesh = Arc::new(Mesh::build(&(limn_mesh::shape("icosahedron").unwrap().build)(), Weld::Off).unwrap().0);
    let [to_quad, loops] = ["catmull-clark", "loop"].map(|id| scheme(id).unwrap());
    let from = |from| limn_mesh::Run { from, scheme: to_quad, params: limn_mesh::Params::default() };
    let fairings = vec![limn_mesh::Fairing { at: 2, iterations: 3 }];
    let later = vec![from(2)];
    let plan = Plan { later, fairings, limit: true, ..Plan::new(loops, Boundary::default(), 2) };
    let projected = refine(&mesh, &plan, u64::MAX).unwrap();
    // Refined four times more, it is nearly there.
    let deep = refine(&mesh, &Plan { limit: false, level: 6, ..plan.clone() }, u64::MAX).unwrap();
    for (v, p) in projected.points.iter().enumerate() {
        let d = far(p.map(f64::from), deep.points[v].map(f64::from));
        assert!(d < 1e-3, "vertex {v} is {d} away");
    }
    // Triangles only where they are wanted.
    let plan = Plan {
        later: vec![limn_mesh::Run { from: 1, scheme: loops, params: limn_mesh::Params::default() }],
        level: 1,
        ..Plan::new(to_quad, Boundary::default(), 1)
    };
    assert!(refine(&mesh, &plan, u64::MAX).is_ok());
    assert!(refine(&mesh, &Plan { limit: true, ..plan }, u64::MAX).is_err());
}
