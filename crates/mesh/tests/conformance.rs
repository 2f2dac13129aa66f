//! What every scheme in the registry promises, on every mesh: no scheme is named here but where it promises something of
//! its own. See tests/oracles.rs for other libraries' numbers and tests/naive.rs for the papers'.

mod common;

use common::{build, cage, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::sink::Cursor;
use limn_mesh::split::Level;
use limn_mesh::topology::validate;
use limn_mesh::{
    Boundary, Connectivity, Counts, Entry, Job, Mesh, Params, Plan, RefineError, SCHEMES, Soup, Weld, predict, refine,
};
use proptest::prelude::*;
use std::sync::Arc;

fn plans(mesh: &Mesh, level: u32) -> Vec<Plan> {
    let takes = |e: &&'static Entry| {
        e.info.split(mesh.face_shape(), Boundary::EdgeOnly, &Params::default().of(&e.info)).is_some()
    };
    let boundaries = [Boundary::EdgeOnly, Boundary::EdgeAndCorner];
    SCHEMES
        .iter()
        .filter(takes)
        .flat_map(|scheme| boundaries.map(|boundary| Plan::new(scheme, boundary, level)))
        .collect()
}

/// Random displacement knows the numbers of vertices and the size of the mesh, and moves points alone.
fn is_steady(plan: &Plan) -> bool {
    !plan.scheme.info.is_random()
}

/// A dual split's vertices are corners: none is the old vertex of the same number.
fn keeps_vertices(plan: &Plan) -> bool {
    plan.scheme.info.group != "dual"
}

fn exact(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.map(f64::from)).collect()
}

fn diagonal(points: &[[f64; 3]]) -> f64 {
    let side = |k: usize| {
        let all = points.iter().map(|p| p[k]);
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    (0..3).map(|k| side(k).powi(2)).sum::<f64>().sqrt()
}

fn far(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs())).fold(0.0, f64::max)
}

/// Everything that must hold for one mesh; small enough to be called a thousand times.
fn conforms(name: &str, mesh: &Arc<Mesh>) {
    validate(&mesh.topology).unwrap_or_else(|e| panic!("{name}, level 0: {e}"));
    let positions = exact(mesh);
    let size = diagonal(&positions);
    for plan in plans(mesh, 3) {
        let (info, what) = (&plan.scheme.info, format!("{name}, {}", plan.scheme.info.id));
        // Levels pass the validator; rows sum to one, in every pass of every level.
        let ones = vec![[1.0f64]; positions.len()];
        let mut depth = 0;
        let sums = evaluate(mesh, &plan, &ones, |level| {
            validate(level).unwrap_or_else(|e| panic!("{what}, level {depth}: {e}"));
            // Three and more faces at a rim's vertex may be counted together, and triangles not at all after a dual split.
            let settled =
                |c: Counts| Counts { rim: [c.rim[0], c.rim[1], c.rim[2] + c.rim[3], 0], triangles: [0; 2], ..c };
            let predicted = predict(mesh, &plan.to(depth)).unwrap().unwrap();
            assert_eq!(settled(level.counts()), settled(predicted.counts), "{what}, level {depth}");
            depth += 1;
        })
        .unwrap();
        assert_eq!(depth, 3);
        assert!(sums.iter().all(|s| (s[0] - 1.0).abs() < 1e-14), "{what}: rows do not sum to one");

        // Fast path against the slow one, counts against the prediction, the Euler characteristic, the corners.
        let slow = evaluate(mesh, &plan, &positions, |_| ()).unwrap();
        let fast = refine(mesh, &plan, u64::MAX).unwrap();
        let points: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
        assert!(far(&points, &slow) <= 1e-5 * size, "{what}: fast and slow differ by {}", far(&points, &slow));
        let predicted = predict(mesh, &plan).unwrap().unwrap();
        assert_eq!(predicted.counts, fast.counts, "{what}");
        assert_eq!(fast.counts.vertices as usize, fast.points.len(), "{what}");
        assert_eq!(fast.counts.faces as usize, fast.faces.count(), "{what}");
        assert_eq!(fast.counts.euler(), mesh.counts().euler(), "{what}");
        // Real edges, counted from the corners, and every vertex used.
        let mut sides: Vec<[u32; 2]> = Vec::new();
        let mut used = vec![false; fast.points.len()];
        for f in 0..fast.faces.count() {
            let face = fast.faces.face(f);
            for (i, &a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                sides.push([a.min(b), a.max(b)]);
                used[a as usize] = true;
            }
        }
        sides.sort_unstable();
        sides.dedup();
        // Two edges of a cage may join the same vertices, and the poke, which cuts none, leaves them so.
        let t = &mesh.topology;
        let ends = |e: u32| [t.edge_half_edge(e), t.next(t.edge_half_edge(e))].map(|h| t.origin(h));
        let mut own: Vec<_> = (0..t.edges()).map(ends).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        own.sort_unstable();
        own.dedup();
        let twice = if plan.scheme.info.id == "poke" { t.edges() as usize - own.len() } else { 0 };
        assert_eq!(fast.counts.edges as usize - twice, sides.len(), "{what}");
        assert!(used.iter().all(|&u| u), "{what}: a vertex that no face uses");

        // Affine invariance: refining a map of the points is the map of the refined points.
        let map = |p: &[f64; 3]| [2.0 * p[0] - p[1] + 3.0, 0.5 * p[2] + p[0], p[1] + 0.25 * p[2] - 7.0];
        let mapped: Vec<_> = positions.iter().map(map).collect();
        let there = evaluate(mesh, &plan, &mapped, |_| ()).unwrap();
        let back: Vec<_> = slow.iter().map(map).collect();
        assert!(!is_steady(&plan) || far(&there, &back) < 1e-12 * (10.0 + 4.0 * size), "{what}: not affine invariant");

        if info.interpolating {
            assert!(far(&slow[..positions.len()], &positions) == 0.0, "{what}: does not interpolate");
        }
    }
}

#[test]
fn gallery_conforms() {
    for (name, soup) in gallery() {
        conforms(&name, &build(&soup));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn random_cages_conform(soup in cage()) {
        conforms("random cage", &build(&soup));
    }

    /// Faces in another order, vertices with other numbers, corners starting elsewhere: the same points.
    #[test]
    fn relabelling_changes_nothing(soup in cage(), shift in 1u32..50, turn in 0usize..5) {
        let n = soup.positions.len() as u32;
        let id = |v: u32| (v + shift) % n;
        let mut positions = vec![[0.0; 3]; n as usize];
        for (v, p) in soup.positions.iter().enumerate() {
            positions[id(v as u32) as usize] = *p;
        }
        let mut faces: Vec<Vec<u32>> = (0..soup.face_count()).map(|f| soup.face(f).iter().map(|&v| id(v)).collect()).collect();
        faces.rotate_left(shift as usize % soup.face_count());
        for f in &mut faces {
            let by = turn % f.len();
            f.rotate_left(by);
        }
        let (a, b) = (build(&soup), build(&Soup::from_faces(positions, &faces)));
        // Where a one-sided surface is cut depends on where the walk began.
        prop_assume!(!a.one_sided);
        for plan in plans(&a, 2).into_iter().filter(is_steady) {
            let sorted = |mesh: &Arc<Mesh>| {
                let mut p = evaluate(mesh, &plan, &exact(mesh), |_| ()).unwrap();
                p.iter_mut().flatten().for_each(|x| *x = (*x * 1e9).round() * 1e-9 + 0.0);
                p.sort_by(|x, y| x.partial_cmp(y).unwrap());
                p
            };
            // Rounding may put two nearly equal points the other way round: compare sums of sorted coordinates instead of order.
            let (p, q) = (sorted(&a), sorted(&b));
            prop_assert_eq!(p.len(), q.len());
            for k in 0..3 {
                let axis = |v: &[[f64; 3]]| { let mut x: Vec<f64> = v.iter().map(|p| p[k]).collect(); x.sort_by(f64::total_cmp); x };
                for (x, y) in axis(&p).iter().zip(axis(&q)) {
                    prop_assert!((x - y).abs() < 1e-8, "{}: {} against {}", plan.scheme.info.id, x, y);
                }
            }
        }
    }

    /// A job that is stepped in any slices gives what it gives in one go, and its progress never falls.
    #[test]
    fn slices_do_not_matter(soup in cage(), slice in 1usize..400) {
        let mesh = build(&soup);
        for plan in plans(&mesh, 2) {
            let whole = refine(&mesh, &plan, u64::MAX).unwrap();
            let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
            let mut last = 0.0;
            while !job.step(slice) {
                prop_assert!(job.progress() >= last && job.progress() <= 1.0);
                last = job.progress();
            }
            prop_assert!((job.progress() - 1.0).abs() < 1e-6, "progress ends at {}", job.progress());
            let sliced = job.finish();
            prop_assert_eq!(&whole.points, &sliced.points);
            prop_assert_eq!(&whole.faces, &sliced.faces);
        }
    }
}

/// A mirror-symmetric mesh stays mirror-symmetric.
#[test]
fn symmetry_is_kept() {
    for name in ["cube", "octahedron", "torus", "icosahedron"] {
        let mesh = build(&(limn_mesh::shape(name).unwrap().build)());
        for plan in plans(&mesh, 3).into_iter().filter(is_steady) {
            let points = evaluate(&mesh, &plan, &exact(&mesh), |_| ()).unwrap();
            let key = |p: &[f64; 3]| p.map(|x| (x * 1e6).round() as i64);
            let mut all: Vec<_> = points.iter().map(key).collect();
            all.sort_unstable();
            for p in &points {
                let mirrored = key(&[-p[0], p[1], p[2]]);
                let near = (-1..=1).any(|d| all.binary_search(&[mirrored[0] + d, mirrored[1], mirrored[2]]).is_ok())
                    || all.iter().any(|q| (0..3).all(|k| (q[k] - mirrored[k]).abs() <= 1));
                assert!(near, "{name}, {}: {p:?} has no mirror image", plan.scheme.info.id);
            }
        }
    }
}

#[test]
fn ids_are_stable_prefixes() {
    // Vertex 0 of the cube pulled out is vertex 0 on every level.
    let mut soup = (limn_mesh::shape("cube").unwrap().build)();
    let far_out = soup.positions[3].map(|x| x * 9.0);
    soup.positions[3] = far_out;
    let mesh = build(&soup);
    for plan in plans(&mesh, 4).into_iter().filter(keeps_vertices) {
        let points = refine(&mesh, &plan, u64::MAX).unwrap().points;
        let size = |p: &[f32; 3]| p.iter().map(|x| x * x).sum::<f32>();
        let outermost = (0..points.len()).max_by(|&a, &b| size(&points[a]).total_cmp(&size(&points[b]))).unwrap();
        assert_eq!(outermost, 3, "{}", plan.scheme.info.id);
    }
}

#[test]
fn faces_know_their_source() {
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        for plan in plans(&mesh, 3).into_iter().filter(|p| p.scheme.info.id == "linear") {
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            // Linear children lie inside their parent, so their centroid is nearest to a point of it: check by corners'
            // containment in the parent's bounding box.
            for f in 0..refined.faces.count() {
                let parent = soup.face(refined.face_source(f as u32) as usize);
                for k in 0..3 {
                    let of = |v: &u32| soup.positions[*v as usize][k];
                    let low = parent.iter().map(of).fold(f32::MAX, f32::min) - 1e-5;
                    let high = parent.iter().map(of).fold(f32::MIN, f32::max) + 1e-5;
                    let inside =
                        refined.faces.face(f).iter().all(|&v| (low..=high).contains(&refined.points[v as usize][k]));
                    assert!(inside, "{name}: face {f}");
                }
            }
        }
    }
}

/// Two cubes beside each other: whatever the scheme, a face's source lies in the cube that the face lies in, and every
/// source has faces.
#[test]
fn faces_of_every_scheme_know_their_part() {
    let cube = (limn_mesh::shape("cube").unwrap().build)();
    let mut two = Soup::default();
    for shift in [-10.0, 10.0] {
        let base = two.positions.len() as u32;
        two.positions.extend(cube.positions.iter().map(|p| [p[0] + shift, p[1], p[2]]));
        (0..6).for_each(|f| two.push_face(&cube.face(f).iter().map(|v| v + base).collect::<Vec<_>>()));
    }
    let mut schemes = std::collections::BTreeSet::new();
    for soup in [two.clone(), limn_mesh::triangulate_soup(&two).0] {
        let mesh = build(&soup);
        for plan in (1..=3).flat_map(|level| plans(&mesh, level)) {
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            schemes.insert(plan.scheme.info.id);
            for f in 0..refined.faces.count() {
                let source = refined.face_source(f as u32) as usize;
                let left = refined.points[refined.faces.face(f)[0] as usize][0] < 0.0;
                assert_eq!(
                    left,
                    source < soup.face_count() / 2,
                    "{}, level {}: face {f}",
                    plan.scheme.info.id,
                    plan.level
                );
            }
            // Every source has children.
            let sources: std::collections::BTreeSet<u32> =
                (0..refined.faces.count() as u32).map(|f| refined.face_source(f)).collect();
            assert_eq!(sources.len(), soup.face_count(), "{}", plan.scheme.info.id);
        }
    }
    assert_eq!(schemes.len(), SCHEMES.len());
}

#[test]
fn copies_along_cut_edges_stay_equal() {
    for (name, soup) in [
        ("bow-tie", common::bow_tie()),
        ("book", common::book(4)),
        ("moebius", (limn_mesh::shape("moebius").unwrap().build)()),
    ] {
        let mesh = build(&soup);
        assert!(mesh.positions.len() > soup.positions.len(), "{name} should be split");
        for plan in plans(&mesh, 3).into_iter().filter(keeps_vertices) {
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            // Every copy of a vertex keeps company with another: bitwise.
            let at = |v: usize| refined.points[v].map(f32::to_bits);
            for v in 0..mesh.positions.len() {
                for w in 0..v {
                    if mesh.vertex_source[v] == mesh.vertex_source[w] {
                        assert_eq!(at(v), at(w), "{name}, {}: copies {w} and {v}", plan.scheme.info.id);
                    }
                }
            }
        }
    }
    // A curve between sheets is smoothed as a curve, not frozen.
    let mesh = build(&common::book(4));
    for plan in
        plans(&mesh, 1).into_iter().filter(|p| keeps_vertices(p) && is_steady(p) && !p.scheme.info.interpolating)
    {
        let refined = refine(&mesh, &plan, u64::MAX).unwrap();
        let (before, after) = (mesh.positions[8], refined.points[8]);
        let p = |v: usize| mesh.positions[v];
        let curve: [f32; 3] = std::array::from_fn(|k| 0.75 * p(8)[k] + 0.125 * (p(4)[k] + p(12)[k]));
        assert!((0..3).all(|k| (after[k] - curve[k]).abs() < 1e-6), "{before:?} {after:?} {curve:?}");
    }
}

#[test]
fn colours_follow_the_scheme_and_seams_stay_seams() {
    let mut soup = (limn_mesh::shape("cube").unwrap().build)();
    // Colour = position: refined colours must be refined positions.
    soup.colors = soup.positions.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
    // Each face its own square of texture: twelve seams.
    soup.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    soup.uv_corners = (0..24).map(|i| i % 4).collect();
    let mesh = build(&soup);
    let uv = mesh.uv.as_ref().unwrap();
    assert_eq!(uv.topology.counts().boundary, 24);
    assert_eq!(uv.values.len(), 24);
    for plan in plans(&mesh, 2) {
        let refined = refine(&mesh, &plan, u64::MAX).unwrap();
        for (c, p) in refined.colors.iter().zip(&refined.points).filter(|_| is_steady(&plan)) {
            assert!((0..3).all(|k| (c[k] - p[k]).abs() < 1e-5) && (c[3] - 1.0).abs() < 1e-6);
        }
        let uv = refined.uv.as_ref().unwrap();
        assert_eq!(uv.corners.len(), refined.faces.corners().len());
        if !plan.split(&mesh).unwrap().keeps_corners() {
            continue; // Its faces are not face 0's alone: tests/charts.rs.
        }
        // Face 0's children fill its square, corners kept.
        let own = (0..refined.faces.count()).filter(|&f| refined.face_source(f as u32) == 0);
        let mut seen: Vec<[i32; 2]> = own
            .flat_map(|f| refined.faces.range(f))
            .map(|i| uv.values[uv.corners[i] as usize].map(|x| (x * 1000.0).round() as i32))
            .collect();
        seen.sort_unstable();
        seen.dedup();
        let id = plan.scheme.info.id;
        assert!(seen.iter().flatten().all(|x| (0..=1000).contains(x)), "{id}");
        for corner in [[0, 0], [0, 1000], [1000, 0], [1000, 1000]] {
            assert!(seen.contains(&corner), "{id}: {corner:?}");
        }
        if plan.split(&mesh).unwrap() == limn_mesh::Split::Quad {
            assert_eq!(seen.len(), 25, "{id}");
            assert!(seen.contains(&[500, 500]), "{id}");
        }
    }
}

#[test]
fn refused_with_the_numbers() {
    let cube = build(&(limn_mesh::shape("cube").unwrap().build)());
    let plan = |id, level| Plan::new(limn_mesh::scheme(id).unwrap(), Boundary::default(), level);
    let error = refine(&cube, &plan("catmull-clark", 100), 1 << 30).unwrap_err();
    assert_eq!(error.to_string(), "level 100 would make more than 2^64 faces; choose level 11 or lower");
    let error = refine(&cube, &plan("catmull-clark", 12), 1 << 30).unwrap_err();
    assert_eq!(
        error.to_string(),
        "level 12 would make 100,663,296 faces and take 4.0 GB, and the budget is 1.1 GB; choose level 11 or lower"
    );
    let error = refine(&cube, &plan("catmull-clark", 15), u64::MAX).unwrap_err();
    assert!(error.to_string().contains("more than 32-bit numbers can connect"), "{error}");
    let error = refine(&cube, &plan("loop", 1), 1 << 30).unwrap_err();
    assert_eq!(error, RefineError::NeedsTriangles { scheme: "Loop", face: 0, corners: 4 });
    assert!(refine(&cube, &plan("catmull-clark", u32::MAX), 1 << 30).is_err());
    // Level 0 is what is already there: never refused.
    assert!(refine(&cube, &plan("catmull-clark", 0), 0).is_ok());
}

#[test]
fn rows_resume_where_they_stopped() {
    let mesh = build(&(limn_mesh::shape("icosahedron").unwrap().build)());
    for plan in plans(&mesh, 1) {
        let split = plan.split(&mesh).unwrap();
        let tags = limn_mesh::scheme::Tags::new(plan.rules, plan.params.of(&plan.scheme.info));
        let level = Level::Base(&mesh.topology);
        let (mut cursor, mut children) = (Cursor::default(), Vec::new());
        loop {
            let mut take = |child: u32, _: &[_], _| children.push(child);
            if plan.scheme.rows((&level, split, tags), &mut take, &mut cursor, &mut 7) {
                break;
            }
        }
        children.sort_unstable();
        assert!(children.iter().copied().eq(0..split.children(&mesh.topology)), "{}", plan.scheme.info.id);
    }
}

#[test]
fn relative_weld_joins_a_torn_cube() {
    let cube = (limn_mesh::shape("cube").unwrap().build)();
    let mut torn = Soup::default();
    for f in 0..6 {
        let base = torn.positions.len() as u32;
        for (i, &v) in cube.face(f).iter().enumerate() {
            torn.positions.push(cube.positions[v as usize].map(|x| x + 1e-5 * (i + f) as f32));
        }
        torn.push_face(&[base, base + 1, base + 2, base + 3]);
    }
    assert_eq!(Mesh::build(&torn, Weld::Exact).unwrap().0.counts().boundary, 24);
    let (mesh, report) = Mesh::build(&torn, Weld::Relative(1e-4)).unwrap();
    assert_eq!((mesh.counts().vertices, mesh.counts().boundary), (8, 0));
    assert_eq!(report.notes.iter().map(ToString::to_string).collect::<Vec<_>>(), ["16 duplicate positions welded"]);
}
