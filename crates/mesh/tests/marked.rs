//! Marks that no other library computes the same: holes, rims that are left out, creases at cut edges, creases through several
//! schemes, fairing; and what every scheme promises, on marked meshes.

mod common;

use common::{book, build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::{
    Boundary, Connectivity, Decay, Fairing, Job, Mesh, Params, Plan, RefineError, Run, SCHEMES, Soup, refine, scheme,
    shape, triangulate_soup,
};
use std::collections::BTreeMap;
use std::sync::Arc;

fn marked(mut soup: Soup) -> Soup {
    for f in (0..soup.face_count()).step_by(2) {
        let face = soup.face(f).to_vec();
        soup.marks.creases.push(([face[0], face[1]], [0.5, 1.25, 2.5, 10.0][f % 4]));
        soup.marks.creases.push(([face[1], face[2]], 10.0));
        if f % 3 == 0 {
            soup.marks.corners.push((face[0], [1.5, 10.0][f % 2]));
            soup.marks.holes.push(f as u32);
        }
    }
    soup
}

fn exact(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

fn far(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs())).fold(0.0, f64::max)
}

#[test]
fn schemes_keep_their_promises_on_marked_meshes() {
    for (name, soup) in gallery().into_iter().filter(|g| g.1.face_count() <= 60) {
        let mesh = build(&marked(soup));
        let positions = exact(&mesh);
        for scheme in SCHEMES.iter().filter(|s| !s.info.is_random()) {
            for (boundary, decay) in [(Boundary::None, Decay::Chaikin), (Boundary::EdgeAndCorner, Decay::Uniform)] {
                if scheme.info.split(mesh.face_shape(), boundary, &Params::default().of(&scheme.info)).is_none() {
                    continue;
                }
                let what = format!("{name}, {}, {boundary:?}", scheme.info.id);
                let mut plan = Plan::new(scheme, boundary, 2);
                plan.rules.decay = decay;
                let slow = match evaluate(&mesh, &plan, &positions, |_| ()) {
                    Ok(points) => points,
                    Err(RefineError::NeedsTrianglesAt { .. }) => continue,
                    Err(e) => panic!("{what}: {e}"),
                };
                let ones = vec![[1.0f64]; positions.len()];
                let sums = evaluate(&mesh, &plan, &ones, |_| ()).unwrap();
                assert!(sums.iter().all(|s| (s[0] - 1.0).abs() < 1e-14), "{what}: rows do not sum to one");
                let map = |p: &[f64; 3]| [2.0 * p[0] - p[1] + 3.0, 0.5 * p[2] + p[0], p[1] + 0.25 * p[2] - 7.0];
                let mapped: Vec<_> = positions.iter().map(map).collect();
                let there = evaluate(&mesh, &plan, &mapped, |_| ()).unwrap();
                assert!(far(&there, &slow.iter().map(map).collect::<Vec<_>>()) < 1e-11, "{what}: not affine invariant");
                let fast = refine(&mesh, &plan, u64::MAX).unwrap();
                let points: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
                assert!(far(&points, &slow) < 1e-4, "{what}: fast and slow differ by {}", far(&points, &slow));
                assert_eq!(fast.counts.faces, fast.faces.count() as u64 + fast.hidden, "{what}");
                if boundary == Boundary::EdgeAndCorner && scheme.honours.corners {
                    for v in (0..positions.len()).filter(|&v| mesh.vertex_sharpness.get(v) == Some(&10.0)) {
                        assert_eq!(fast.points[v], mesh.positions[v], "{what}: a corner moves");
                    }
                }
                let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
                while !job.step(37) {}
                let sliced = job.finish();
                assert_eq!((&sliced.points, &sliced.faces), (&fast.points, &fast.faces), "{what}");
            }
        }
    }
}

/// Children of holes are not listed, and nothing else is missing; vertices stay.
#[test]
fn holes_are_refined_and_not_shown() {
    for (name, soup) in gallery().into_iter().filter(|g| g.1.face_count() <= 60) {
        let plain = build(&soup);
        let mut soup = soup;
        soup.marks.holes = (0..soup.face_count() as u32).step_by(3).collect();
        let holed = build(&soup);
        for scheme in SCHEMES.iter().filter(|s| !s.info.is_random()) {
            for level in 0..=2 {
                let plan = Plan::new(scheme, Boundary::default(), level);
                let (Ok(a), Ok(b)) = (refine(&plain, &plan, u64::MAX), refine(&holed, &plan, u64::MAX)) else {
                    continue;
                };
                let what = format!("{name}, {}, level {level}", scheme.info.id);
                assert_eq!(a.points, b.points, "{what}");
                let hole = |f: usize| soup.marks.holes.contains(&a.face_source(f as u32));
                let face = |f: usize| (a.faces.face(f).to_vec(), a.face_source(f as u32));
                let all = (0..a.faces.count()).filter(|&f| !hole(f)).map(face);
                let shown: Vec<_> =
                    (0..b.faces.count()).map(|f| (b.faces.face(f).to_vec(), b.face_source(f as u32))).collect();
                if scheme.honours.corners {
                    assert_eq!(shown, all.collect::<Vec<_>>(), "{what}");
                } else {
                    // Faces across edges and around vertices go with the hole, whichever face they are counted to.
                    assert!(shown.iter().all(|s| !soup.marks.holes.contains(&s.1)), "{what}");
                    assert!(level == 0 || b.kinds.len() == shown.len(), "{what}");
                }
                assert_eq!(b.hidden, (a.faces.count() - b.faces.count()) as u64, "{what}");
            }
        }
    }
}

/// Faces that touch the rim are left out, but where the rim is infinitely sharp; a cut edge is no rim.
#[test]
fn rims_are_left_out() {
    let mut soup = (shape("grid").unwrap().build)();
    let mesh = build(&soup);
    let t = &mesh.topology;
    let rim = |v: u32| t.twin(t.vertex_half_edge(v)) >> 31 == 1;
    let inner = (0..t.faces()).filter(|&f| t.face_half_edges(f).all(|h| !rim(t.origin(h)))).count();
    for level in 0..=2 {
        let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::None, level);
        assert_eq!(refine(&mesh, &plan, u64::MAX).unwrap().faces.count(), inner << (2 * level));
    }
    let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::None, 1);
    let smooth = refine(&mesh, &plan, u64::MAX).unwrap();
    let edge_only = Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeOnly, 1);
    assert_eq!(smooth.points, refine(&mesh, &edge_only, u64::MAX).unwrap().points);
    soup.marks.creases = (0..t.boundary_half_edges())
        .map(|r| t.boundary_half_edge(r))
        .map(|h| ([t.origin(h), t.origin(t.next(h))].map(|v| mesh.vertex_source[v as usize]), 10.0))
        .collect();
    let sharp = refine(&build(&soup), &plan, u64::MAX).unwrap();
    assert_eq!((sharp.hidden, sharp.faces.count() as u32), (0, t.half_edges()));
}

/// Copies of a vertex on an edge of three faces stay together where a crease arrives from one side.
#[test]
fn creases_do_not_tear_cut_edges() {
    for sharpness in [0.5, 1.5, 10.0] {
        for second in [None, Some(0.75)] {
            let mut soup = book(4);
            // Into the first page, at the second vertex of the spine; and into the second.
            soup.marks.creases.push(([4, 5], sharpness));
            soup.marks.creases.extend(second.map(|s| ([4, 6], s)));
            let mesh = build(&soup);
            assert!(mesh.positions.len() > soup.positions.len());
            for decay in [Decay::Uniform, Decay::Chaikin] {
                let mut plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeAndCorner, 3);
                plan.rules.decay = decay;
                let points = refine(&mesh, &plan, u64::MAX).unwrap().points;
                for v in 0..mesh.positions.len() {
                    for w in 0..v {
                        if mesh.vertex_source[v] == mesh.vertex_source[w] {
                            assert_eq!(points[v], points[w], "{sharpness}, {second:?}");
                        }
                    }
                }
            }
        }
    }
}

/// A cube with an infinitely sharp square: its curve is the one that the square alone would have, whatever comes between.
#[test]
fn creases_survive_a_change_of_schemes() {
    let mut soup = (shape("cube").unwrap().build)();
    let top = soup.face(0).to_vec();
    soup.marks.creases = (0..4).map(|i| ([top[i], top[(i + 1) % 4]], 10.0)).collect();
    let cube = build(&soup);
    let face = Soup::from_faces(top.iter().map(|&v| soup.positions[v as usize]).collect(), &[[0u32, 1, 2, 3]]);
    let square = build(&face);
    let run = |id: &str, from| Run { from, scheme: scheme(id).unwrap(), params: Params::default() };
    for ids in [["linear", "catmull-clark"], ["catmull-clark", "linear"], ["catmull-clark", "quad-triangle"]] {
        let mut plan = Plan::new(scheme(ids[0]).unwrap(), Boundary::EdgeOnly, 3);
        plan.later = vec![run(ids[1], 1)];
        let (a, b) = (refine(&cube, &plan, u64::MAX).unwrap(), refine(&square, &plan, u64::MAX).unwrap());
        for (i, &v) in top.iter().enumerate() {
            let (p, q) = (a.points[v as usize], b.points[i]);
            assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-6), "{ids:?}: {p:?} is to be {q:?}");
        }
    }
    let triangles = build(&triangulate_soup(&soup).0);
    let mut plan = Plan::new(scheme("loop").unwrap(), Boundary::EdgeOnly, 3);
    plan.later = vec![run("catmull-clark", 1)];
    let a = refine(&triangles, &plan, u64::MAX).unwrap();
    let b = refine(&square, &Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeOnly, 3), u64::MAX).unwrap();
    for (i, &v) in top.iter().enumerate() {
        let (p, q) = (a.points[v as usize], b.points[i]);
        assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-6), "loop: {p:?} is to be {q:?}");
    }
}

#[test]
fn fairing_keeps_what_is_sharp() {
    let mut soup = (shape("cube").unwrap().build)();
    let top = soup.face(0).to_vec();
    soup.marks.creases = (0..4).map(|i| ([top[i], top[(i + 1) % 4]], 3.0)).collect();
    soup.marks.corners = vec![((0..8).find(|v| !top.contains(v)).unwrap(), 2.0)];
    let mesh = build(&soup);
    let mut plan = Plan::new(scheme("linear").unwrap(), Boundary::EdgeOnly, 0);
    plan.fairings = vec![Fairing { at: 0, iterations: 7 }];
    let points = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
    let stays = soup.marks.corners[0].0 as usize;
    assert_eq!(points[stays], exact(&mesh)[stays]);
    // The square by itself: four vertices on a closed curve.
    let mut square: Vec<[f64; 3]> = top.iter().map(|&v| soup.positions[v as usize].map(f64::from)).collect();
    for _ in 0..7 {
        for factor in [0.6307, -0.6732] {
            let old = square.clone();
            for i in 0..4 {
                for k in 0..3 {
                    square[i][k] += factor * ((old[(i + 1) % 4][k] + old[(i + 3) % 4][k]) / 2.0 - old[i][k]);
                }
            }
        }
    }
    let ours: Vec<[f64; 3]> = top.iter().map(|&v| points[v as usize]).collect();
    assert!(far(&ours, &square) < 1e-12, "{}", far(&ours, &square));
}

#[test]
fn plans_know_what_they_ignore() {
    let mesh: Arc<Mesh> = build(&marked((shape("cube").unwrap().build)()));
    let first =
        |id: &str| Plan::new(scheme(id).unwrap(), Boundary::default(), 2).ignores(mesh.marks()).map(|e| e.0.info.id);
    assert_eq!(first("catmull-clark"), None);
    assert_eq!(first("linear"), None);
    assert_eq!(first("doo-sabin"), Some("doo-sabin"));
    assert_eq!(first("kobbelt"), None);
    // What is semi-sharp means nothing where edges are turned; what lasts does.
    let mut soup = triangulate_soup(&(shape("cube").unwrap().build)()).0;
    soup.marks.creases.push(([soup.face(0)[0], soup.face(0)[1]], 10.0));
    let turned = Plan::new(scheme("sqrt3").unwrap(), Boundary::default(), 2);
    assert!(turned.ignores(build(&soup).marks()).is_none());
    let mut semi = soup.clone();
    semi.marks.creases[0].1 = 2.0;
    let honours = turned.ignores(build(&semi).marks()).unwrap().1;
    assert!(honours.creases && !honours.semi_sharp && honours.corners);
    let mut plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), 2);
    plan.later = vec![Run { from: 1, scheme: scheme("doo-sabin").unwrap(), params: Params::default() }];
    assert_eq!(plan.ignores(mesh.marks()).map(|e| e.0.info.id), Some("doo-sabin"));
    assert!(plan.ignores(build(&(shape("cube").unwrap().build)()).marks()).is_none());
}

/// Three sheets that share a line: whatever the scheme, each ends there in the same curve, to the bit, as on any rim.
#[test]
fn non_manifold_edges_are_infinitely_sharp() {
    let quads = book(3);
    let triangles = triangulate_soup(&quads).0;
    for scheme in SCHEMES.iter().filter(|s| !s.info.is_random()) {
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            for (level, soup) in (1..=3).flat_map(|l| [(l, &quads), (l, &triangles)]) {
                let mesh = build(soup);
                let plan = Plan::new(scheme, boundary, level);
                let Ok(whole) = refine(&mesh, &plan, u64::MAX) else { continue };
                // Where vertices are cut off only those of one face are corners, and sheets of triangles end in one or two.
                if !scheme.honours.corners && boundary == Boundary::EdgeAndCorner && mesh.is_triangles() {
                    continue;
                }
                let mut sides = BTreeMap::new();
                for f in 0..whole.faces.count() {
                    let face = whole.faces.face(f);
                    for (i, &v) in face.iter().enumerate() {
                        let w = face[(i + 1) % face.len()];
                        *sides.entry((v.min(w), v.max(w))).or_insert(0) += 1;
                    }
                }
                // Edges of one face, by the places of their ends.
                let at = |v: u32| whole.points[v as usize];
                let mut curve = BTreeMap::new();
                let mut rim = Vec::new();
                for ((v, w), _) in sides.into_iter().filter(|s| s.1 == 1) {
                    let mut ends = [v, w].map(|v| at(v).map(f32::to_bits));
                    ends.sort();
                    *curve.entry(ends).or_insert(0) += 1;
                    rim.extend([v, w]);
                }
                let what = format!("{}, {boundary:?}, level {level}", scheme.info.id);
                assert!(curve.values().all(|n| [1, 3].contains(n)), "{what}: a sheet is torn off");
                let shared = curve.values().filter(|n| **n == 3).count();
                assert!(shared >= 3, "{what}: {shared} shared edges");
                for (i, &v) in rim.iter().enumerate() {
                    for &w in &rim[..i] {
                        let d = (0..3).map(|k| (at(v)[k] - at(w)[k]).abs()).fold(0.0, f32::max);
                        assert!(d == 0.0 || d > 1e-4, "{what}: {d} between two sheets");
                    }
                }
            }
        }
    }
}
