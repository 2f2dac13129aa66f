//! Limit points, tangents and normals: against OpenSubdiv's (tests/oracles/limit_*.json), and level against level.

mod common;

use limn_mesh::limit::{Limit, LimitRule, Projector, limit};
use limn_mesh::refine::{evaluate, evaluate_limit};
use limn_mesh::scheme::Tags;
use limn_mesh::split::Level;
use limn_mesh::topology::is_boundary;
use limn_mesh::{
    Boundary, Connectivity, Decay, Job, Mesh, Plan, SCHEMES, Soup, Split, TriangleRule, Weld, refine, scheme,
};
use serde_json::Value;
use std::cell::RefCell;
use std::sync::Arc;

/// The shared gallery, and rims whose middle vertex has any number of faces.
fn gallery() -> Vec<(String, Soup)> {
    common::gallery().into_iter().chain(common::half_fans()).collect()
}

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
    let mut soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    for crease in oracle["creases"].as_array().into_iter().flatten() {
        let ends = [0, 1].map(|i| crease[i].as_u64().unwrap() as u32);
        soup.marks.creases.push((ends, crease[2].as_f64().unwrap() as f32));
    }
    for corner in oracle["corners"].as_array().into_iter().flatten() {
        soup.marks.corners.push((corner[0].as_u64().unwrap() as u32, corner[1].as_f64().unwrap() as f32));
    }
    let mesh = Mesh::build(&soup, Weld::Off).unwrap().0;
    let id = if oracle["scheme"] == "catmark" { "catmull-clark" } else { "loop" };
    let corner = oracle["options"]["vtxBoundary"] == "EDGE_AND_CORNER";
    let boundary = if corner { Boundary::EdgeAndCorner } else { Boundary::EdgeOnly };
    // Vertices where one crease that lasts ends. OpenSubdiv takes the smooth mask there, which is not where its own refinement
    // goes: see `darts_go_where_refinement_goes`. And corners, which have no plane.
    let mut ends = vec![0; positions.len()];
    soup.marks.creases.iter().filter(|c| c.1 >= 10.0).flat_map(|c| c.0).for_each(|v| ends[v as usize] += 1);
    let dart = |v: usize| ends.get(v) == Some(&1);
    let corner = |v: usize| soup.marks.corners.iter().any(|c| c.0 as usize == v && c.1 >= 10.0);
    for theirs in oracle["levels"].as_array().unwrap() {
        let level = theirs["level"].as_u64().unwrap() as u32;
        let mut plan = Plan::new(scheme(id).unwrap(), boundary, level);
        if oracle["options"]["creasing"] == "CHAIKIN" {
            plan.rules.decay = Decay::Chaikin;
        }
        if oracle["options"]["triangleSubdivision"] == "SMOOTH" {
            plan.rules.triangle = TriangleRule::Smooth;
        }
        let (points, ours) = level_and_limit(&mesh, &plan, level);
        let [at, goes, normals] = ["positions", "limitPositions", "limitNormals"].map(|key| triples(&theirs[key]));
        assert_eq!(points.len(), at.len());
        for (i, p) in points.iter().enumerate() {
            let j = (0..at.len()).min_by(|&a, &b| far(at[a], *p).total_cmp(&far(at[b], *p))).unwrap();
            assert!(far(at[j], *p) < 1e-7);
            if dart(i) {
                continue;
            }
            let d = far(ours.points[i], goes[j]);
            assert!(d < 1e-7, "level {level}, vertex {i} at {p:?}: {:?}, not {:?}", ours.points[i], goes[j]);
            if normals[j] != [0.0; 3] && !corner(i) {
                let normal = ours.normals[i].unwrap_or_else(|| panic!("level {level}, vertex {i}: no normal"));
                let mut d = far(normal, normals[j]);
                if d > 1e-6 {
                    // On a crease theirs is one side's and ours the mean: the first side's is theirs or its mirror image.
                    let [a, b] = ours.tangents[i];
                    let side = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                    let length = side.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let side = side.map(|x| x / length);
                    let along: f64 = (0..3).map(|k| normal[k] * normals[j][k]).sum();
                    let other = std::array::from_fn(|k| 2.0 * along * normal[k] - normals[j][k]);
                    d = far(side, normals[j]).min(far(side, other));
                }
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
    cube_catmark_crease_uniform cube_catmark_crease_chaikin cube_catmark_corner cube_catmark_cornersemi tetra_catmark_trismooth grid3_catmark_edgecorner_crease_uniform gridtri3_loop_edgeonly_crease_chaikin icosa_loop_crease_uniform tetra_loop_corner icosa_loop_cornersemi
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
                    _ if scheme.info.id.ends_with("sqrt3") => 8,
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
                    // Rules that do not know the valence of a rim's vertex are smooth at few of them.
                    if scheme.limit == LimitRule::Analysis && name.starts_with("half") {
                        continue;
                    }
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
                let idle = level == 0 && (scheme.limit == LimitRule::Itself || scheme.info.is_random());
                assert!(idle || (job.progress() - 1.0).abs() < 1e-6, "{what}: progress ends at {}", job.progress());
                let sliced = job.finish();
                assert_eq!(whole.points, sliced.points, "{what}");
                assert_eq!(whole.known_normals, sliced.known_normals, "{what}");
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

/// A plane of quads, or of triangles, with waves and marks of every kind: fading creases, one that lasts and ends inside, a
/// sharp vertex that fades and one that lasts.
fn marked(triangles: bool) -> Mesh {
    let at = |i: u32, j: u32| 7 * i + j;
    let positions = (0..49).map(|v| [(v / 7) as f32, (v % 7) as f32, ((v * 5 % 11) as f32) * 0.1]).collect();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for (i, j) in (0..36).map(|f| (f / 6, f % 6)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if triangles { faces.extend([vec![a, b, c], vec![a, c, d]]) } else { faces.push(vec![a, b, c, d]) }
    }
    let mut soup = Soup::from_faces(positions, &faces);
    let mut crease = |v: [(u32, u32); 2], s| soup.marks.creases.push((v.map(|(i, j)| at(i, j)), s));
    (1..3).for_each(|j| crease([(3, j), (3, j + 1)], 10.0));
    crease([(1, 1), (1, 2)], 0.5);
    crease([(1, 2), (1, 3)], 1.7);
    crease([(1, 3), (2, 3)], 2.5);
    crease([(5, 0), (5, 1)], 1.0);
    soup.marks.corners.extend([(at(5, 5), 1.5), (at(5, 3), 10.0), (at(1, 3), 0.3)]);
    Mesh::build(&soup, Weld::Off).unwrap().0
}

/// Marks that fade and marks that last: the limit of a level's vertex is that of its child.
#[test]
fn marks_are_followed_to_the_limit() {
    let rims = ["j-spline", "butterfly", "modified-butterfly", "sqrt3", "interpolating-sqrt3"].map(|id| (id, true));
    let own = [("catmull-clark", false), ("catmull-clark", true), ("loop", true), ("kobbelt", false)];
    for (id, triangles) in own.into_iter().chain(rims) {
        let mesh = marked(triangles);
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for (decay, boundary) in [(Decay::Uniform, Boundary::EdgeOnly), (Decay::Chaikin, Boundary::EdgeAndCorner)] {
            let mut plan = Plan::new(scheme(id).unwrap(), boundary, 0);
            plan.rules.decay = decay;
            let [first, second, last] = [0, 1, 4].map(|level| limits(&mesh, &plan, &positions, level));
            for (a, b) in [(&first, &second), (&second, &last)] {
                for v in 0..a.points.len() {
                    // Where a dart of sqrt3 goes is not known.
                    if id == "sqrt3" && [3 * 7 + 1, 3 * 7 + 3].contains(&v) {
                        continue;
                    }
                    let d = far(a.points[v], b.points[v]);
                    assert!(d < 1e-9, "{id}, {decay:?}: vertex {v} is off by {d}");
                    if let (Some(m), Some(n)) = (a.normals[v], b.normals[v]) {
                        assert!(far(m, n) < 1e-6, "{id}, {decay:?}: vertex {v}: {m:?} and {n:?}");
                    }
                }
            }
        }
    }
}

/// What crease vertices of sqrt3 go to is where refinement takes them, inside and on the rim's side alike.
#[test]
fn creases_of_sqrt3_go_where_refinement_goes() {
    let mesh = marked(true);
    let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    for (boundary, from) in [(Boundary::EdgeOnly, 0), (Boundary::EdgeOnly, 1), (Boundary::EdgeAndCorner, 2)] {
        let plan = Plan::new(scheme("sqrt3").unwrap(), boundary, 0);
        let found = limits(&mesh, &plan, &positions, from);
        let deep = evaluate(&mesh, &plan.to(10), &positions, |_| ()).unwrap();
        for (v, p) in found.points.iter().enumerate().filter(|(v, _)| ![3 * 7 + 1, 3 * 7 + 3].contains(v)) {
            assert!(far(*p, deep[v]) < 5e-3, "level {from}, vertex {v}: {p:?} and {:?}", deep[v]);
        }
        assert!(found.normals[3 * 7 + 2].is_some());
    }
}

#[test]
fn darts_go_where_refinement_goes() {
    for (id, triangles) in [("catmull-clark", false), ("loop", true), ("j-spline", true)] {
        let mesh = Arc::new(marked(triangles));
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeOnly, 0);
        let found = limits(&mesh, &plan, &positions, 0);
        let [near, nearer] = [5, 6].map(|level| evaluate(&mesh, &plan.to(level), &positions, |_| ()).unwrap());
        for dart in [3 * 7 + 1, 3 * 7 + 3] {
            // Each step leaves a fixed share of the way: the last two say where it ends.
            for k in 0..3 {
                let [a, b, end] = [near[dart][k], nearer[dart][k], found.points[dart][k]];
                assert!((end - b).abs() < 0.8 * (end - a).abs() + 1e-12, "{id}: {a}, {b}, and the limit {end}");
                assert!((end - b).abs() < 1e-3, "{id}: {b}, and the limit {end}");
            }
        }
    }
}
