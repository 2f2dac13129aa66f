//! The built-in models are what their names and summaries say.

use limn_mesh::shapes::{SHAPES, shape};
use limn_mesh::soup::Soup;
use std::collections::BTreeMap;

fn build(name: &str) -> Soup {
    (shape(name).unwrap_or_else(|| panic!("no shape {name}")).build)()
}

/// How often each directed edge occurs.
fn directed_edges(soup: &Soup) -> BTreeMap<(u32, u32), u32> {
    let mut edges = BTreeMap::new();
    for f in 0..soup.face_count() {
        let face = soup.face(f);
        for (i, &a) in face.iter().enumerate() {
            *edges.entry((a, face[(i + 1) % face.len()])).or_insert(0) += 1;
        }
    }
    edges
}

fn undirected_edges(soup: &Soup) -> BTreeMap<(u32, u32), u32> {
    let mut edges = BTreeMap::new();
    for ((a, b), count) in directed_edges(soup) {
        *edges.entry((a.min(b), a.max(b))).or_insert(0) += count;
    }
    edges
}

fn counts(soup: &Soup) -> [usize; 3] {
    [soup.positions.len(), undirected_edges(soup).len(), soup.face_count()]
}

/// Six times the enclosed volume.
fn volume6(soup: &Soup) -> f64 {
    let mut sum = 0.0;
    for f in 0..soup.face_count() {
        let p: Vec<[f64; 3]> = soup.face(f).iter().map(|&v| soup.positions[v as usize].map(f64::from)).collect();
        for i in 1..p.len() - 1 {
            let (a, b, c) = (p[0], p[i], p[i + 1]);
            sum += a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
    }
    sum
}

/// A name; vertices, edges, faces; how many faces have how many corners.
type Expected = (&'static str, [usize; 3], &'static [(usize, usize)]);

const EXPECTED: &[Expected] = &[
    ("creature", [1452, 2900, 1450], &[(4, 1450)]),
    ("pawn", [154, 456, 304], &[(3, 304)]),
    ("mouse", [57, 109, 54], &[(4, 53), (6, 1)]),
    ("t-shape", [20, 36, 18], &[(4, 18)]),
    ("torus", [128, 256, 128], &[(4, 128)]),
    ("moebius", [32, 48, 16], &[(4, 16)]),
    ("grid", [81, 144, 64], &[(4, 64)]),
    ("cube", [8, 12, 6], &[(4, 6)]),
    ("pyramid", [5, 9, 6], &[(3, 6)]),
    ("tetrahedron", [4, 6, 4], &[(3, 4)]),
    ("octahedron", [6, 12, 8], &[(3, 8)]),
    ("icosahedron", [12, 30, 20], &[(3, 20)]),
    ("dodecahedron", [20, 30, 12], &[(5, 12)]),
];

#[test]
fn counts_are_exact() {
    assert_eq!(SHAPES.iter().map(|s| s.name).collect::<Vec<_>>(), EXPECTED.iter().map(|e| e.0).collect::<Vec<_>>());
    for (name, expected, degrees) in EXPECTED {
        let soup = build(name);
        assert_eq!(counts(&soup), *expected, "{name}");
        let mut found = BTreeMap::new();
        (0..soup.face_count()).for_each(|f| *found.entry(soup.face(f).len()).or_insert(0) += 1);
        assert_eq!(found.into_iter().collect::<Vec<_>>(), *degrees, "{name}");
    }
}

#[test]
fn closed_shapes_are_closed_outward_and_of_their_genus() {
    for shape in SHAPES.iter().filter(|s| !["grid", "moebius"].contains(&s.name)) {
        let soup = (shape.build)();
        let edges = directed_edges(&soup);
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1, "{}: edge {a} {b} occurs {count} times", shape.name);
            assert!(edges.contains_key(&(b, a)), "{}: edge {a} {b} is open", shape.name);
        }
        let [v, e, f] = counts(&soup).map(|n| n as i64);
        assert_eq!(v - e + f, if shape.name == "torus" { 0 } else { 2 }, "{}", shape.name);
        assert!(volume6(&soup) > 0.5, "{}: inside out", shape.name);
        // Every vertex is the middle of one fan of at least three faces.
        let mut fans: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); soup.positions.len()];
        for f in 0..soup.face_count() {
            let face = soup.face(f);
            for i in 0..face.len() {
                let (before, after) = (face[(i + face.len() - 1) % face.len()], face[(i + 1) % face.len()]);
                fans[face[i] as usize].insert(after, before);
            }
        }
        for (vertex, fan) in fans.iter().enumerate() {
            let start = *fan.keys().next().unwrap();
            let (mut at, mut steps) = (fan[&start], 1);
            while at != start {
                (at, steps) = (fan[&at], steps + 1);
            }
            assert!(steps == fan.len() && steps >= 3, "{}: vertex {vertex} has {steps} of {}", shape.name, fan.len());
        }
    }
}

#[test]
fn sizes_are_alike() {
    for shape in SHAPES {
        let soup = (shape.build)();
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for p in &soup.positions {
            assert!(p.iter().all(|x| x.is_finite()), "{}", shape.name);
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let longest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
        assert!((1.6..=2.6).contains(&longest), "{}: {longest}", shape.name);
        assert!((low[0] + high[0]).abs() < 0.6, "{}: off to one side", shape.name);
        // No vertex is idle and none doubles another.
        let mut used = vec![false; soup.positions.len()];
        soup.corners.iter().for_each(|&v| used[v as usize] = true);
        assert!(used.iter().all(|&u| u), "{}: a vertex is in no face", shape.name);
        let mut bits: Vec<[u32; 3]> = soup.positions.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
        bits.sort_unstable();
        assert!(bits.windows(2).all(|w| w[0] != w[1]), "{}: two vertices share a place", shape.name);
    }
}

#[test]
fn regular_solids_are_regular() {
    for (name, edge, radius) in [
        ("cube", 2.0, 3f64.sqrt()),
        ("tetrahedron", 8f64.sqrt(), 3f64.sqrt()),
        ("octahedron", 2f64.sqrt(), 1.0),
        ("icosahedron", 1.0514622242382672, 1.0),
        ("dodecahedron", 0.7136441795461799, 1.0),
    ] {
        let soup = build(name);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let at = |v: u32| soup.positions[v as usize].map(f64::from);
        for v in 0..soup.positions.len() as u32 {
            assert!((length(at(v)) - radius).abs() < 1e-6, "{name}");
        }
        for &(a, b) in undirected_edges(&soup).keys() {
            let found = length([0, 1, 2].map(|k| at(a)[k] - at(b)[k]));
            assert!((found - edge).abs() < 1e-6, "{name}: {found}");
        }
    }
}

#[test]
fn the_grid_is_open_and_faces_up() {
    let soup = build("grid");
    assert!(directed_edges(&soup).values().all(|&n| n == 1));
    assert_eq!(undirected_edges(&soup).values().filter(|&&n| n == 1).count(), 32);
    assert_eq!(soup.positions[0], [-1.0, 0.5, -1.0]);
    assert_eq!(soup.positions[44], [1.0, 0.25, 0.0]);
    assert_eq!(soup.positions[80], [1.0, -0.5, 1.0]);
    // Seen from above the first quad turns anticlockwise.
    let [a, b, c] = [0, 1, 2].map(|i| soup.positions[soup.face(0)[i] as usize]);
    assert!((b[2] - a[2]) * (c[0] - b[0]) - (b[0] - a[0]) * (c[2] - b[2]) > 0.0);
}

#[test]
fn the_moebius_strip_has_one_side_and_one_rim() {
    let soup = build("moebius");
    // One edge is run twice the same way, and no reversal of faces could help: it would move the conflict on.
    let doubled: Vec<_> = directed_edges(&soup).into_iter().filter(|&(_, n)| n == 2).collect();
    assert_eq!(doubled.len(), 1);
    let uses = undirected_edges(&soup);
    assert!(uses.values().all(|&n| n <= 2));
    // The rim is one loop through all 32 vertices.
    let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (&(a, b), _) in uses.iter().filter(|&(_, &n)| n == 1) {
        neighbours.entry(a).or_default().push(b);
        neighbours.entry(b).or_default().push(a);
    }
    let (mut before, mut at, mut steps) = (0, neighbours[&0][0], 1);
    while at != 0 {
        let next = if neighbours[&at][0] == before { neighbours[&at][1] } else { neighbours[&at][0] };
        (before, at, steps) = (at, next, steps + 1);
    }
    assert_eq!(steps, 32);
}

#[test]
fn positions_are_where_they_should_be() {
    assert_eq!(build("cube").positions[5], [1.0, -1.0, 1.0]);
    assert_eq!(build("pyramid").positions[4], [0.0, 1.0, 0.0]);
    assert_eq!(build("octahedron").positions[3], [0.0, -1.0, 0.0]);
    assert_eq!(build("torus").positions[0], [0.0, 0.0, 1.0]);
    let pawn = build("pawn");
    assert_eq!((pawn.positions[0], pawn.positions[153]), ([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]));
    // The T spans three cells by two by one, and its stem is the middle third below.
    let t = build("t-shape");
    let low = |k: usize| t.positions.iter().map(|p| p[k]).fold(f32::INFINITY, f32::min);
    assert_eq!([low(0), low(1), low(2)], [-1.0, -2.0 / 3.0, -1.0 / 3.0]);
    assert!(t.positions.iter().filter(|p| p[1] < -0.5).all(|p| p[0].abs() == 1.0 / 3.0));
}

#[test]
fn the_mouse_gives_the_papers_counts() {
    // Doo–Sabin: faces of step k on a closed mesh are its Euler characteristic and half the corners of step k - 1.
    let [v, e, f] = counts(&build("mouse"));
    let mut faces = v + e + f;
    for _ in 1..3 {
        faces = (faces - 2) * 4 + 2;
    }
    assert_eq!((faces, (faces - 2) * 4 + 2), (3490, 13954));
    // It is the same from left and right.
    let soup = build("mouse");
    for p in &soup.positions {
        assert!(soup.positions.contains(&[-p[0], p[1], p[2]]), "{p:?}");
    }
}

#[test]
fn the_creature_stands_and_looks_ahead() {
    let soup = build("creature");
    let low = |k: usize| soup.positions.iter().map(|p| p[k]).fold(f32::INFINITY, f32::min);
    let high = |k: usize| soup.positions.iter().map(|p| p[k]).fold(f32::NEG_INFINITY, f32::max);
    // Four feet on the ground: vertices at y = 0 on either side, in front and behind.
    assert_eq!(low(1), 0.0);
    for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        assert!(soup.positions.iter().any(|p| p[1] < 0.001 && p[0] * x > 0.1 && p[2] * z > 0.1), "{x} {z}");
    }
    // The head is high and in front, the tail behind.
    let top = soup.positions.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert!(top[1] > 1.3 && top[2] > 0.3, "{top:?}");
    assert!(high(2) > 1.0 && low(2) < -1.0);
    // Corners of 3 to 6 edges, nearly all of 4.
    let mut edges = vec![0; soup.positions.len()];
    soup.corners.iter().for_each(|&v| edges[v as usize] += 1);
    assert!(edges.iter().all(|n| (3..=6).contains(n)));
    assert!(edges.iter().filter(|&&n| n == 4).count() > 1200);
    // No edge is so short that welding by distance could take it.
    for (a, b) in undirected_edges(&soup).into_keys() {
        let [p, q] = [a, b].map(|v| soup.positions[v as usize]);
        assert!((0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f32>() > 1e-6, "{a} {b}");
    }
}

#[test]
fn unknown_names_are_unknown() {
    assert!(shape("Cube").is_none() && shape("").is_none());
}
