//! Random meshes with every kind of mark against what OpenSubdiv computed: positions, the sharpness of every edge, which faces
//! are holes, limit points and normals, and face-varying values.
//!
//! Vertices are known by keys, which both programs hash the same way from what a vertex was made of (itself, the ends of an
//! edge, the corners of a face), so nothing hangs on orders, and copies of a vertex that is no manifold count as one.
//! Some cases are in tests/oracles (random_*.json). `LIMN_OPENSUBDIV_CASES=FOLDER cargo test --test opensubdiv -- --ignored
//! --nocapture` compares any number of them and prints the largest differences by category.

use limn_mesh::refine::{evaluate, evaluate_creased, evaluate_limit};
use limn_mesh::topology::is_boundary;
use limn_mesh::{
    Boundary, Connectivity, Creases, Decay, FaceVarying, Limit, Mesh, Plan, Soup, TriangleRule, Weld, refine, scheme,
};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

fn numbers<const N: usize>(v: &Value) -> Vec<[f64; N]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

/// Sebastiano Vigna's splitmix64.
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The key of what is made from vertices with these keys; `what` is 1 for a vertex, 2 for an edge, 3 for a face.
fn key(mut from: Vec<u64>, what: u64) -> u64 {
    from.sort_unstable();
    from.iter().fold(mix(what), |h, k| mix(h ^ k)) >> 12
}

/// The largest differences of a case.
#[derive(Clone, Copy, Debug, Default)]
struct Differences {
    points: f64,
    fast: f64,
    sharpness: f64,
    /// Faces that one shows and the other does not.
    holes: f64,
    limits: f64,
    /// Limits where OpenSubdiv's masks are not its own refinement's: for information.
    left_out: f64,
    /// How far refinement is from our limits there, by how far it is from theirs.
    astray: f64,
    normals: f64,
    values: f64,
}

impl Differences {
    fn list(&self) -> [(&'static str, f64, f64); 9] {
        [
            ("points", self.points, 2e-7),
            ("points in f32", self.fast, 4e-6),
            ("sharpness", self.sharpness, 1e-5),
            ("holes", self.holes, 0.0),
            ("limits", self.limits, 2e-7),
            ("limits left out", self.left_out, f64::MAX),
            ("refinement from limits left out", self.astray, 0.3),
            ("normals", self.normals, 1e-4),
            ("values", self.values, 2e-6),
        ]
    }
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Ours of one level: the keys of vertices, whether OpenSubdiv's masks of a vertex's limit are those of its rules, and the
/// sharp edges.
#[derive(Default)]
struct Level {
    keys: Vec<u64>,
    masks: Vec<Masks>,
    sharp: Vec<([u64; 2], f32)>,
}

/// Which of OpenSubdiv's masks lead where its own refinement does, `limit.rs` says of ours that they do.
#[derive(Clone, Copy, PartialEq)]
enum Masks {
    Both,
    /// At a curve of more faces than a regular one has on a side: its tangents across belong to rules that know their number.
    Point,
    /// Where a crease ends, and inside at a vertex of two faces: its masks are those of a smooth vertex, or of a corner.
    Neither,
}

fn masks<C: Connectivity>(c: &C, v: u32, creases: Option<&Creases>, most: usize) -> Masks {
    let (mut faces, mut sharp) = (0, Vec::new());
    let along = |h: u32| creases.is_some_and(|all| all.along(c, h) > 0.0);
    let rim = c.turn(v, |h| {
        if along(h) || is_boundary(c.twin(h)) {
            sharp.push(faces);
        }
        faces += 1;
    });
    if rim.is_some() {
        sharp.push(faces);
    }
    match sharp[..] {
        _ if creases.is_some_and(|all| all.vertex(v) > 0.0) => Masks::Both,
        [] if faces == 2 => Masks::Neither,
        [_] => Masks::Neither,
        [a, b] if b - a > most || rim.is_none() && faces + a - b > most => Masks::Point,
        _ => Masks::Both,
    }
}

/// Compares a case. Where OpenSubdiv's masks are not its own refinement's, `deeper` levels further on the points have to be
/// nearer to our limit.
fn compare(oracle: &Value, deeper: u32) -> Differences {
    let faces: Vec<Vec<u32>> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let positions = numbers::<3>(&oracle["mesh"]["positions"]);
    let mut soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    let creases: Vec<(u32, u32, f32)> = serde_json::from_value(oracle["creases"].clone()).unwrap();
    soup.marks.creases = creases.into_iter().map(|(a, b, s)| ([a, b], s)).collect();
    soup.marks.corners = serde_json::from_value(oracle["corners"].clone()).unwrap();
    soup.marks.holes = serde_json::from_value(oracle["holes"].clone()).unwrap();
    if let Some(corners) = oracle["mesh"].get("faceUVs") {
        soup.uvs = numbers::<2>(&oracle["mesh"]["uvs"]).iter().map(|p| p.map(|x| x as f32)).collect();
        soup.uv_corners = serde_json::from_value::<Vec<Vec<u32>>>(corners.clone()).unwrap().concat();
    }
    let mesh = Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0);
    let option = |key: &str| oracle["options"][key].as_str().unwrap();
    let id = if oracle["scheme"] == "catmark" { "catmull-clark" } else { "loop" };
    let boundary = match option("vtxBoundary") {
        "NONE" => Boundary::None,
        "EDGE_ONLY" => Boundary::EdgeOnly,
        _ => Boundary::EdgeAndCorner,
    };
    let mut plan = Plan::new(scheme(id).unwrap(), boundary, 0);
    if option("creasing") == "CHAIKIN" {
        plan.rules.decay = Decay::Chaikin;
    }
    if option("triangleSubdivision") == "SMOOTH" {
        plan.rules.triangle = TriangleRule::Smooth;
    }
    plan.rules.face_varying = match option("fvarLinearInterpolation") {
        "NONE" => FaceVarying::None,
        "CORNERS_ONLY" => FaceVarying::CornersOnly,
        "CORNERS_PLUS1" => FaceVarying::CornersPlus1,
        "CORNERS_PLUS2" => FaceVarying::CornersPlus2,
        "BOUNDARIES" => FaceVarying::Boundaries,
        _ => FaceVarying::All,
    };

    let exact: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let theirs = oracle["levels"].as_array().unwrap();
    let last = theirs.last().unwrap()["level"].as_u64().unwrap() as u32;
    let mut levels: Vec<Level> = Vec::new();
    let mut keys: Vec<u64> = mesh.vertex_source.iter().map(|&v| mix(u64::from(v)) >> 12).collect();
    evaluate_creased(&mesh, &plan.to(last + 1), &exact, |c, creases| {
        let mut level = Level { keys: keys.clone(), ..Level::default() };
        let of = |h: u32| keys[c.origin(h) as usize];
        for e in 0..c.edges() {
            let h = c.edge_half_edge(e);
            let s = if is_boundary(c.twin(h)) { 10.0 } else { creases.map_or(0.0, |all| all.along(c, h)) };
            if s > 0.0 {
                let (a, b) = (of(h), of(c.next(h)));
                level.sharp.push(([a.min(b), a.max(b)], s));
            }
        }
        let corners = |f: u32| c.face_half_edges(f).map(|h| c.origin(h));
        let most = if id == "loop" { 3 } else { 2 };
        level.masks = (0..c.vertices()).map(|v| masks(c, v, creases, most)).collect();
        let mut next: Vec<u64> = keys.iter().map(|&k| key(vec![k], 1)).collect();
        if id != "loop" {
            next.extend((0..c.faces()).map(|f| key(corners(f).map(|v| keys[v as usize]).collect(), 3)));
        }
        next.extend((0..c.edges()).map(|e| {
            let h = c.edge_half_edge(e);
            key(vec![of(h), of(c.next(h))], 2)
        }));
        keys = next;
        levels.push(level);
    })
    .unwrap();

    let mut worst = Differences::default();
    let size = {
        let low = (0..3).map(|k| positions.iter().map(|p| p[k]).fold(f64::MAX, f64::min));
        let high = (0..3).map(|k| positions.iter().map(|p| p[k]).fold(f64::MIN, f64::max));
        low.zip(high).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt()
    };
    for theirs in theirs {
        let number = theirs["level"].as_u64().unwrap() as u32;
        let ours = &levels[number as usize];
        let their_keys: Vec<u64> = serde_json::from_value(theirs["keys"].clone()).unwrap();
        let their_points = numbers::<3>(&theirs["positions"]);
        let mut by_key: HashMap<u64, Vec<usize>> = HashMap::new();
        their_keys.iter().enumerate().for_each(|(i, &k)| by_key.entry(k).or_default().push(i));
        // Every vertex of ours to the one with its key, and every one of theirs met.
        let points = evaluate(&mesh, &plan.to(number), &exact, |_| ()).unwrap();
        let refined = refine(&mesh, &plan.to(number), u64::MAX).unwrap();
        let mut met = vec![false; their_keys.len()];
        // Those of theirs that may be a vertex: two faces back to back make the same points twice.
        let pairs: Vec<Vec<usize>> = (0..points.len())
            .map(|v| {
                let candidates = by_key.get(&ours.keys[v]).unwrap_or_else(|| panic!("vertex {v} is not known"));
                let gap = |i: usize| far(&points[v], &their_points[i]);
                let least = candidates.iter().map(|&i| gap(i)).fold(f64::MAX, f64::min);
                let near: Vec<usize> = candidates.iter().copied().filter(|&i| gap(i) <= least + 1e-9).collect();
                worst.points = worst.points.max(least / size);
                let fast = refined.points[v].map(f64::from);
                worst.fast = worst.fast.max(far(&fast, &their_points[near[0]]) / size);
                near.iter().for_each(|&i| met[i] = true);
                near
            })
            .collect();
        if met.contains(&false) {
            worst.points = worst.points.max(1.0);
        }

        // Sharp edges: by their ends, the least and the greatest.
        let mut sharp: BTreeMap<[u64; 2], [[f32; 2]; 2]> = BTreeMap::new();
        let mut note = |side: usize, ends: [u64; 2], s: f32| {
            let range = &mut sharp.entry(ends).or_insert([[99.0, 0.0]; 2])[side];
            *range = [range[0].min(s.min(10.0)), range[1].max(s.min(10.0))];
        };
        ours.sharp.iter().for_each(|&(ends, s)| note(0, ends, s));
        let edges: Vec<(usize, usize, f32)> = serde_json::from_value(theirs["edgeSharpness"].clone()).unwrap();
        for (a, b, s) in edges {
            let (a, b) = (their_keys[a], their_keys[b]);
            note(1, [a.min(b), a.max(b)], s);
        }
        for [a, b] in sharp.values() {
            let d = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            worst.sharpness = worst.sharpness.max(f64::from(d));
        }

        // Faces that are shown, by their corners.
        let face_key = |corners: Vec<u64>| key(corners, 4);
        let their_faces: Vec<Vec<usize>> = serde_json::from_value(theirs["faces"].clone()).unwrap();
        let holes: BTreeSet<usize> = serde_json::from_value(theirs["holes"].clone()).unwrap();
        let mut shown: BTreeMap<u64, i32> = BTreeMap::new();
        let mut faces_of: HashMap<u64, Vec<usize>> = HashMap::new();
        for (f, face) in their_faces.iter().enumerate() {
            let k = face_key(face.iter().map(|&v| their_keys[v]).collect());
            faces_of.entry(k).or_default().push(f);
            *shown.entry(k).or_default() += i32::from(!holes.contains(&f));
        }
        for f in 0..refined.faces.count() {
            let k = face_key(refined.faces.face(f).iter().map(|&v| ours.keys[v as usize]).collect());
            *shown.entry(k).or_default() -= 1;
        }
        worst.holes = worst.holes.max(f64::from(shown.values().map(|n| n.abs()).sum::<i32>()));

        // Values at the corners of faces.
        if let (Some(uv), Some(values)) = (&refined.uv, theirs.get("uvs")) {
            let values = numbers::<2>(values);
            let corners: Vec<Vec<usize>> = serde_json::from_value(theirs["faceUVs"].clone()).unwrap();
            for f in 0..refined.faces.count() {
                let range: Vec<usize> = refined.faces.range(f).collect();
                let own: Vec<u64> = range.iter().map(|&c| ours.keys[refined.faces.corners()[c] as usize]).collect();
                let gap = |&g: &usize| {
                    let mut worst: f64 = 0.0;
                    for (&c, &k) in range.iter().zip(&own) {
                        let at = their_faces[g].iter().position(|&v| their_keys[v] == k).unwrap();
                        let value = uv.values[uv.corners[c] as usize].map(f64::from);
                        worst = worst.max(far(&value, &values[corners[g][at]]));
                    }
                    worst
                };
                let best = faces_of[&face_key(own.clone())].iter().map(gap).fold(f64::MAX, f64::min);
                worst.values = worst.values.max(best);
            }
        }

        let Some(limits) = theirs.get("limitPositions") else { continue };
        let (limits, normals) = (numbers::<3>(limits), numbers::<3>(&theirs["limitNormals"]));
        let rules: Vec<u32> = serde_json::from_value(theirs["rules"].clone()).unwrap();
        let found = evaluate_limit(&mesh, &plan.to(number), &exact).unwrap();
        let mut copies: HashMap<u64, u32> = HashMap::new();
        ours.keys.iter().for_each(|&k| *copies.entry(k).or_default() += 1);
        let deep = (deeper > 0).then(|| evaluate(&mesh, &plan.to(number + deeper), &exact, |_| ()).unwrap());
        for (v, near) in pairs.iter().enumerate() {
            let masks = ours.masks[v];
            let gap = |i: usize| far(&found.points[v], &limits[i]) / size;
            let d = near.iter().map(|&i| gap(i)).fold(f64::MAX, f64::min);
            let slot = if masks == Masks::Neither { &mut worst.left_out } else { &mut worst.limits };
            *slot = slot.max(d);
            if let Some(deep) = deep.as_ref().filter(|_| masks == Masks::Neither && d > 1e-3) {
                let theirs = near.iter().map(|&i| far(&deep[v], &limits[i])).fold(f64::MAX, f64::min);
                worst.astray = worst.astray.max(far(&deep[v], &found.points[v]) / theirs);
            }
            // Faces around a vertex that is no manifold have no order.
            if masks != Masks::Both || copies[&ours.keys[v]] > 1 {
                continue;
            }
            let d = near.iter().map(|&i| turned(&found, v, rules[i], normals[i])).fold(f64::MAX, f64::min);
            worst.normals = worst.normals.max(d);
        }
    }
    worst
}

/// How far our normal of a vertex is from theirs, where there is one to compare.
fn turned(found: &Limit, v: usize, rule: u32, theirs: [f64; 3]) -> f64 {
    const CORNER: u32 = 8;
    if rule == CORNER || theirs == [0.0; 3] {
        return 0.0;
    }
    let normal = found.normals[v];
    let d = normal.map_or(f64::MAX, |n| far(&n, &theirs));
    if d < 1e-5 {
        return d;
    }
    // On a crease theirs is one side's and ours the mean (if sides do not face each other): the first side's is theirs or its
    // mirror image.
    let [a, b] = found.tangents[v];
    let side = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = side.iter().map(|x| x * x).sum::<f64>().sqrt();
    let side = side.map(|x| x / length);
    let other = match normal {
        Some(n) => {
            let along: f64 = (0..3).map(|k| n[k] * theirs[k]).sum();
            std::array::from_fn(|k| 2.0 * along * n[k] - theirs[k])
        }
        None => theirs.map(|x| -x),
    };
    d.min(far(&side, &theirs)).min(far(&side, &other))
}

fn check(json: &str) {
    let found = compare(&serde_json::from_str(json).unwrap(), 4);
    for (what, d, most) in found.list() {
        assert!(d <= most, "{what}: {d}");
    }
}

macro_rules! oracles {
    ($($name:ident)*) => { $(
        #[test]
        fn $name() {
            check(include_str!(concat!("../../../tests/oracles/random_", stringify!($name), ".json")));
        }
    )* };
}

// Walls are single faces within an edge of three; sheets have creases that end on one; dependent values lean on another.
oracles! {
    marks_catmark marks_loop trismooth darts wall_catmark wall_loop sheets_catmark sheets_loop
    seams_catmark seams_loop seams_sheets seams_boundaries dependent_catmark dependent_loop dependent_chaikin
}

/// At darts and at vertices of two faces OpenSubdiv's limit masks lead elsewhere than its refinement; `check` says that ours
/// do not, and this that there was something to say.
#[test]
fn limits_of_darts_are_not_opensubdivs() {
    let oracle = serde_json::from_str(include_str!("../../../tests/oracles/random_darts.json")).unwrap();
    assert!(compare(&oracle, 0).left_out > 0.05);
}

fn read(path: &std::path::Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
#[ignore = "reads the folder that LIMN_OPENSUBDIV_CASES names"]
fn cases_of_a_folder() {
    let folder = std::env::var("LIMN_OPENSUBDIV_CASES").expect("LIMN_OPENSUBDIV_CASES names a folder");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "json"));
    paths.sort();
    let mut by_category: BTreeMap<String, (usize, Differences)> = BTreeMap::new();
    let mut wrong = Vec::new();
    for path in &paths {
        let oracle = read(path);
        let found = std::panic::catch_unwind(|| compare(&oracle, 0));
        let Ok(found) = found else {
            wrong.push(format!("{}: panics", path.display()));
            continue;
        };
        let category = by_category.entry(oracle["category"].as_str().unwrap().to_owned()).or_default();
        let d = &mut category.1;
        category.0 += 1;
        *d = Differences {
            points: d.points.max(found.points),
            fast: d.fast.max(found.fast),
            sharpness: d.sharpness.max(found.sharpness),
            holes: d.holes.max(found.holes),
            limits: d.limits.max(found.limits),
            left_out: d.left_out.max(found.left_out),
            astray: d.astray.max(found.astray),
            normals: d.normals.max(found.normals),
            values: d.values.max(found.values),
        };
        let over: Vec<String> = found
            .list()
            .iter()
            .filter(|(_, d, most)| d.is_nan() || d > most)
            .map(|(what, d, _)| format!("{what} {d:.2e}"))
            .collect();
        if !over.is_empty() {
            let name = path.file_name().unwrap().to_string_lossy();
            wrong.push(format!("{name} {} {}: {}", oracle["options"], oracle["creases"], over.join(", ")));
        }
    }
    for (category, (cases, d)) in &by_category {
        let figures: Vec<String> = d.list().iter().map(|(what, d, _)| format!("{what} {d:.1e}")).collect();
        println!("{category}: {cases} cases; {}", figures.join(", "));
    }
    assert!(wrong.is_empty(), "{} of {} cases disagree:\n{}", wrong.len(), paths.len(), wrong.join("\n"));
}
