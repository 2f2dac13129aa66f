//! Texture coordinates by the six rules: against OpenSubdiv's figures (tests/oracles), and against the plainest program that
//! can be written from their description: maps from edges and (vertex, value) pairs, f64, no half-edges, no cut seams.

mod common;

use common::{build, cage, gallery};
use limn_mesh::{Boundary, Connectivity, FaceVarying, Mesh, Plan, Refined, Soup, refine, scheme, triangulate_soup};
use proptest::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

const RULES: [FaceVarying; 6] = [
    FaceVarying::None,
    FaceVarying::CornersOnly,
    FaceVarying::CornersPlus1,
    FaceVarying::CornersPlus2,
    FaceVarying::Boundaries,
    FaceVarying::All,
];

fn refined(mesh: &Arc<Mesh>, id: &str, boundary: Boundary, rule: FaceVarying, level: u32) -> Refined {
    let mut plan = Plan::new(scheme(id).unwrap(), boundary, level);
    plan.rules.face_varying = rule;
    refine(mesh, &plan, u64::MAX).unwrap()
}

fn numbers<const N: usize>(v: &Value) -> Vec<[f64; N]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

/// Each face's corners as place and texture coordinate.
type Corners = Vec<Vec<([f64; 3], [f64; 2])>>;

fn check(json: &str, rule: FaceVarying) {
    let oracle: Value = serde_json::from_str(json).unwrap();
    let level = |k: usize| -> Corners {
        let l = &oracle["levels"][k];
        let (points, uvs) = (numbers::<3>(&l["positions"]), numbers::<2>(&l["uvs"]));
        let faces: Vec<Vec<usize>> = serde_json::from_value(l["faces"].clone()).unwrap();
        let corners: Vec<Vec<usize>> = serde_json::from_value(l["faceUVs"].clone()).unwrap();
        let face = |(f, c): (&Vec<usize>, &Vec<usize>)| f.iter().zip(c).map(|(&p, &u)| (points[p], uvs[u])).collect();
        faces.iter().zip(&corners).map(face).collect()
    };
    assert_eq!(oracle["options"]["vtxBoundary"], "EDGE_AND_CORNER");
    let base = &oracle["levels"][0];
    let faces: Vec<Vec<u32>> = serde_json::from_value(base["faces"].clone()).unwrap();
    let corners: Vec<Vec<u32>> = serde_json::from_value(base["faceUVs"].clone()).unwrap();
    let points = numbers::<3>(&base["positions"]);
    let mut soup = Soup::from_faces(points.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    soup.uvs = numbers::<2>(&base["uvs"]).iter().map(|p| p.map(|x| x as f32)).collect();
    soup.uv_corners = corners.concat();
    let mesh = build(&soup);
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-6);
    for k in 1..=2 {
        let ours = refined(&mesh, "catmull-clark", Boundary::EdgeAndCorner, rule, k as u32);
        let uv = ours.uv.as_ref().unwrap();
        let mut seen = 0;
        for theirs in level(k) {
            // The face with the same places, and its corners in their order.
            let at = |c: usize| ours.points[ours.faces.corners()[c] as usize].map(f64::from);
            let found = (0..ours.faces.count()).find_map(|f| {
                let own: Vec<usize> = ours.faces.range(f).collect();
                let place = |p: &[f64; 3]| own.iter().copied().find(|&c| close(&at(c), p));
                theirs.iter().map(|(p, _)| place(p)).collect::<Option<Vec<_>>>()
            });
            for ((_, value), corner) in theirs.iter().zip(found.expect("a face in the same place")) {
                let own = uv.values[uv.corners[corner] as usize].map(f64::from);
                assert!(close(&own, value), "{rule:?}, level {k}: {own:?} instead of {value:?}");
                seen += 1;
            }
        }
        assert_eq!(seen, uv.corners.len());
    }
}

macro_rules! oracles {
    ($($name:ident $mesh:literal $file:literal $rule:ident;)*) => { $(
        #[test]
        fn $name() {
            check(
                include_str!(concat!("../../../tests/oracles/osd_fvar_", $mesh, "_uv_catmark_", $file, ".json")),
                FaceVarying::$rule,
            );
        }
    )* };
}

oracles! {
    opensubdiv_cube_none "cube" "none" None;
    opensubdiv_cube_corners "cube" "cornersonly" CornersOnly;
    opensubdiv_cube_corners_plus_1 "cube" "cornersplus1" CornersPlus1;
    opensubdiv_cube_corners_plus_2 "cube" "cornersplus2" CornersPlus2;
    opensubdiv_cube_boundaries "cube" "boundaries" Boundaries;
    opensubdiv_cube_all "cube" "all" All;
    opensubdiv_grid_none "grid2" "none" None;
    opensubdiv_grid_corners "grid2" "cornersonly" CornersOnly;
    opensubdiv_grid_corners_plus_1 "grid2" "cornersplus1" CornersPlus1;
    opensubdiv_grid_corners_plus_2 "grid2" "cornersplus2" CornersPlus2;
    opensubdiv_grid_boundaries "grid2" "boundaries" Boundaries;
    opensubdiv_grid_all "grid2" "all" All;
}

type Uv = [f64; 2];
/// A value where it is: the vertex and the value's number.
type Place = (usize, usize);
type Edge = (usize, usize);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Tag {
    Pinned,
    Curve,
    /// Like its vertex, which has no boundary.
    Smooth,
}

/// Faces whose corners name vertices and values.
#[derive(Clone)]
struct Naive {
    faces: Vec<Vec<Place>>,
    values: BTreeMap<Place, Uv>,
    tags: BTreeMap<Place, Tag>,
}

fn edge(a: usize, b: usize) -> Edge {
    (a.min(b), a.max(b))
}

fn mix(terms: &[(f64, Uv)]) -> Uv {
    [0, 1].map(|k| terms.iter().map(|(w, p)| w * p[k]).sum())
}

impl Naive {
    /// The faces on each edge, each with what it has at the lower and at the higher end.
    fn edges(&self) -> BTreeMap<Edge, Vec<(usize, [usize; 2])>> {
        let mut edges: BTreeMap<Edge, Vec<(usize, [usize; 2])>> = BTreeMap::new();
        for (f, face) in self.faces.iter().enumerate() {
            for (i, &(v, a)) in face.iter().enumerate() {
                let (w, b) = face[(i + 1) % face.len()];
                edges.entry(edge(v, w)).or_default().push((f, if v < w { [a, b] } else { [b, a] }));
            }
        }
        edges
    }

    fn of(soup: &Soup, rule: FaceVarying, boundary: Boundary) -> Naive {
        let mut naive = Naive { faces: Vec::new(), values: BTreeMap::new(), tags: BTreeMap::new() };
        for f in 0..soup.face_count() {
            let place = |c: usize| (soup.corners[c] as usize, soup.uv_corners[c] as usize);
            naive.faces.push(soup.face_range(f).map(place).collect());
        }
        for &place in naive.faces.iter().flatten() {
            naive.values.insert(place, soup.uvs[place.1].map(f64::from));
        }
        let edges = naive.edges();
        let is_seam = |e: &Edge| edges[e].len() == 2 && edges[e][0].1 != edges[e][1].1;
        let vertices: BTreeSet<usize> = naive.values.keys().map(|p| p.0).collect();
        for v in vertices {
            let mine: Vec<&Edge> = edges.keys().filter(|e| e.0 == v || e.1 == v).collect();
            let rim = mine.iter().any(|e| edges[e].len() == 1);
            let seams = mine.iter().filter(|e| is_seam(e)).count();
            let faces: Vec<usize> =
                (0..naive.faces.len()).filter(|&f| naive.faces[f].iter().any(|p| p.0 == v)).collect();
            let values: BTreeSet<usize> = naive.values.keys().filter(|p| p.0 == v).map(|p| p.1).collect();
            // How many faces have a value, and in how many pieces those that share edges without a seam are.
            let size = |value: usize| faces.iter().filter(|&&f| naive.faces[f].contains(&(v, value))).count();
            let pieces = |value: usize| {
                let mut left: Vec<usize> =
                    faces.iter().copied().filter(|&f| naive.faces[f].contains(&(v, value))).collect();
                let mut count = 0;
                while let Some(f) = left.pop() {
                    count += 1;
                    let mut piece = vec![f];
                    while let Some(f) = piece.pop() {
                        let joined = |g: usize| {
                            mine.iter().any(|e| {
                                let sides: Vec<usize> = edges[e].iter().map(|s| s.0).collect();
                                !is_seam(e) && sides.contains(&f) && sides.contains(&g)
                            })
                        };
                        let (near, far) = left.iter().partition(|&&g| joined(g));
                        left = far;
                        piece.extend::<Vec<usize>>(near);
                    }
                }
                count
            };
            let corners = rule != FaceVarying::None;
            let linear = rule == FaceVarying::Boundaries;
            let any_apart = values.iter().any(|&x| pieces(x) > 1);
            let all = match rule {
                FaceVarying::CornersPlus1 => values.len() > 2 || values.len() == 2 && any_apart,
                FaceVarying::CornersPlus2 => {
                    values.len() > 2
                        || values.len() == 1 && !rim
                        || values.len() == 2 && (any_apart || values.iter().any(|&x| size(x) == 1))
                }
                _ => linear,
            };
            for &value in &values {
                let tag = if seams == 0 && !rim {
                    Tag::Smooth
                } else if seams == 0 {
                    let kept = faces.len() == 1 && (corners || boundary == Boundary::EdgeAndCorner);
                    if linear || kept { Tag::Pinned } else { Tag::Curve }
                } else if all || pieces(value) > 1 || corners && size(value) == 1 {
                    Tag::Pinned
                } else {
                    Tag::Curve
                };
                naive.tags.insert((v, value), tag);
            }
        }
        naive
    }

    fn step(&self, id: &str, rule: FaceVarying) -> Naive {
        let edges = self.edges();
        let linear = rule == FaceVarying::All;
        let vertices = self.values.keys().map(|p| p.0).max().unwrap() + 1;
        let numbers: BTreeMap<Edge, usize> = edges.keys().copied().zip(vertices..).collect();
        let first_face = vertices + edges.len();
        let value = |p: Place| self.values[&p];
        let centre = |f: usize| {
            let n = self.faces[f].len() as f64;
            mix(&self.faces[f].iter().map(|&p| (1.0 / n, value(p))).collect::<Vec<_>>())
        };
        let straight = |e: &Edge| edges[e].len() < 2 || edges[e][0].1 != edges[e][1].1;
        let mut next = Naive { faces: Vec::new(), values: BTreeMap::new(), tags: BTreeMap::new() };
        // A point on an edge is its face's where the edge is a seam.
        let on_edge = |f: usize, e: Edge| (numbers[&e], if straight(&e) { f } else { 0 });
        for (&e, sides) in &edges {
            for &(f, ends) in sides {
                let [a, b] = [value((e.0, ends[0])), value((e.1, ends[1]))];
                let point = if straight(&e) || linear {
                    mix(&[(0.5, a), (0.5, b)])
                } else if id == "loop" {
                    let apex = |f: usize| value(*self.faces[f].iter().find(|p| p.0 != e.0 && p.0 != e.1).unwrap());
                    mix(&[(0.375, a), (0.375, b), (0.125, apex(sides[0].0)), (0.125, apex(sides[1].0))])
                } else {
                    mix(&[(0.25, a), (0.25, b), (0.25, centre(sides[0].0)), (0.25, centre(sides[1].0))])
                };
                next.values.insert(on_edge(f, e), point);
                let tag = match (straight(&e), rule) {
                    (false, _) => Tag::Smooth,
                    (true, FaceVarying::Boundaries) => Tag::Pinned,
                    _ => Tag::Curve,
                };
                next.tags.insert(on_edge(f, e), tag);
            }
        }
        for (&place, &tag) in &self.tags {
            let own = value(place);
            let around: Vec<usize> = (0..self.faces.len()).filter(|&f| self.faces[f].contains(&place)).collect();
            let mut ends: Vec<Uv> = Vec::new();
            let mut ring: BTreeMap<usize, Uv> = BTreeMap::new();
            for &f in &around {
                let (face, n) = (&self.faces[f], self.faces[f].len());
                let i = face.iter().position(|p| *p == place).unwrap();
                for other in [face[(i + 1) % n], face[(i + n - 1) % n]] {
                    if straight(&edge(place.0, other.0)) {
                        ends.push(value(other));
                    }
                    ring.insert(other.0, value(other));
                }
            }
            let n = around.len() as f64;
            let sum = |w: f64, points: &mut dyn Iterator<Item = Uv>| mix(&points.map(|p| (w, p)).collect::<Vec<_>>());
            let point = match tag {
                _ if linear => own,
                Tag::Pinned => own,
                Tag::Curve => {
                    assert_eq!(ends.len(), 2);
                    mix(&[(0.75, own), (0.125, ends[0]), (0.125, ends[1])])
                }
                Tag::Smooth if id == "loop" => {
                    let c = 0.375 + 0.25 * (std::f64::consts::TAU / n).cos();
                    let beta = (0.625 - c * c) / n;
                    mix(&[(1.0 - n * beta, own), (beta, sum(1.0, &mut ring.values().copied()))])
                }
                Tag::Smooth => {
                    let (q, r) = (
                        sum(1.0 / n, &mut around.iter().map(|&f| centre(f))),
                        sum(0.5 / n, &mut ring.values().copied()),
                    );
                    let r = mix(&[(1.0, r), (0.5, own)]);
                    mix(&[(1.0 / n, q), (2.0 / n, r), ((n - 3.0) / n, own)])
                }
            };
            next.values.insert(place, point);
            next.tags.insert(place, tag);
        }
        for (f, face) in self.faces.iter().enumerate() {
            let n = face.len();
            let point = |i: usize| on_edge(f, edge(face[i % n].0, face[(i + 1) % n].0));
            if id == "loop" {
                next.faces.extend((0..3).map(|i| vec![face[i], point(i), point(i + 2)]));
                next.faces.push(vec![point(0), point(1), point(2)]);
            } else {
                let middle = (first_face + f, 0);
                next.values.insert(middle, centre(f));
                next.tags.insert(middle, Tag::Smooth);
                next.faces.extend((0..n).map(|i| vec![face[i], point(i), middle, point(i + n - 1)]));
            }
        }
        next
    }
}

/// Compares all faces, as sets of texture coordinates a face: the lower left corner first.
fn agree(what: &str, naive: &Naive, ours: &Refined) {
    let uv = ours.uv.as_ref().unwrap();
    let centre = |f: &[Uv]| mix(&f.iter().map(|p| (1.0 / f.len() as f64, *p)).collect::<Vec<_>>());
    let theirs: Vec<Vec<Uv>> = naive.faces.iter().map(|f| f.iter().map(|p| naive.values[p]).collect()).collect();
    let mut sorted: Vec<(i64, usize)> =
        theirs.iter().enumerate().map(|(i, f)| ((centre(f)[0] * 1e4).round() as i64, i)).collect();
    sorted.sort_unstable();
    let mut free = vec![true; theirs.len()];
    assert_eq!(ours.faces.count(), theirs.len());
    for f in 0..ours.faces.count() {
        let own: Vec<Uv> = ours.faces.range(f).map(|c| uv.values[uv.corners[c] as usize].map(f64::from)).collect();
        let key = (centre(&own)[0] * 1e4).round() as i64;
        let near = sorted.partition_point(|s| s.0 < key - 1)..sorted.partition_point(|s| s.0 <= key + 1);
        let close = |a: &Uv, b: &Uv| (a[0] - b[0]).abs() < 2e-6 && (a[1] - b[1]).abs() < 2e-6;
        let found = near.map(|i| sorted[i].1).find(|&i| {
            free[i] && theirs[i].len() == own.len() && {
                let n = own.len();
                (0..n).any(|turn| (0..n).all(|k| close(&own[k], &theirs[i][(k + turn) % n])))
            }
        });
        free[found.unwrap_or_else(|| panic!("{what}: face {f} at {own:?} is nowhere"))] = false;
    }
}

/// The same once it has been oriented and cut apart where three faces meet: the reference knows nothing of that.
fn settled(soup: &Soup) -> Soup {
    let mesh = build(soup);
    let mut settled = Soup { positions: mesh.positions.clone(), ..Soup::default() };
    (0..mesh.topology.faces()).for_each(|f| {
        let range = mesh.topology.face_half_edges(f);
        settled.push_face(&mesh.topology.origins()[range.start as usize..range.end as usize]);
    });
    settled
}

/// Gives every vertex up to three values and every corner one of them: seams, darts, junctions and torn regions.
fn dressed(soup: &Soup, seed: u64, busy: u32) -> Soup {
    let mut state = seed | 1;
    let mut random = move |n: u32| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as u32 % n
    };
    let mut soup = soup.clone();
    soup.uvs =
        (0..3 * soup.positions.len()).map(|_| [random(4096) as f32 / 4096.0, random(4096) as f32 / 4096.0]).collect();
    soup.uv_corners = soup.corners.iter().map(|&v| 3 * v + if random(10) < busy { random(3) } else { 0 }).collect();
    soup
}

fn six_rules(what: &str, soup: &Soup) {
    let mesh = build(soup);
    assert_eq!((mesh.topology.origins(), mesh.sharp.len()), (&soup.corners[..], 0));
    let id = if mesh.is_triangles() { ["catmull-clark", "loop"].as_slice() } else { &["catmull-clark"] };
    for (id, boundary) in id.iter().flat_map(|i| [Boundary::EdgeOnly, Boundary::EdgeAndCorner].map(|b| (*i, b))) {
        for rule in RULES {
            let mut naive = Naive::of(soup, rule, boundary);
            for level in 1..=2 {
                naive = naive.step(id, rule);
                let ours = refined(&mesh, id, boundary, rule, level);
                agree(&format!("{what}, {id}, {boundary:?}, {rule:?}, level {level}"), &naive, &ours);
            }
        }
    }
}

#[test]
fn six_rules_on_the_gallery() {
    for (i, (name, soup)) in gallery().iter().filter(|(_, s)| s.face_count() <= 60).enumerate() {
        let soup = &settled(soup);
        for busy in [0, 1, 4] {
            six_rules(name, &dressed(soup, 7 + i as u64, busy));
            six_rules(name, &dressed(&triangulate_soup(soup).0, 99 + i as u64, busy));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn six_rules_on_random_cages(soup in cage(), seed in any::<u64>(), busy in 0u32..8) {
        prop_assume!(soup.face_count() <= 40);
        six_rules("random cage", &dressed(&settled(&soup), seed, busy));
    }
}
