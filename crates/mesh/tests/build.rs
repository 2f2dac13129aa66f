//! From polygons to a mesh: whatever a soup holds, the result passes the validator and the report says what was done.

mod common;

use common::{book, bow_tie, rubble};
use limn_mesh::topology::validate;
use limn_mesh::{Connectivity, Mesh, NONE, Note, SCHEMES, Soup, TopologyError, Weld};
use proptest::prelude::*;

fn notes(soup: &Soup) -> Vec<String> {
    Mesh::build(soup, Weld::Off).unwrap().1.notes.iter().map(ToString::to_string).collect()
}

fn square() -> Vec<[f32; 3]> {
    vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]]
}

#[test]
fn nothing_to_say_about_a_clean_mesh() {
    assert_eq!(notes(&Soup::from_faces(square(), &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])), [""; 0]);
}

#[test]
fn degenerate_faces_are_dropped_or_cleaned() {
    let soup = Soup::from_faces(
        square(),
        &[vec![0, 1, 2, 3], vec![0, 0, 1], vec![4, 4, 4, 4], vec![0, 1, 1, 4, 4], vec![1, 2]],
    );
    assert_eq!(
        notes(&soup),
        [
            "3 faces with fewer than three different corners (first: 1) left out",
            "1 face with repeated corners (first: 3) cleaned",
            "1 face (first: 3) turned over to agree with the neighbours",
        ]
    );
    let (mesh, _) = Mesh::build(&soup, Weld::Off).unwrap();
    assert_eq!(mesh.face_source, [0, 3]);
    // A spike is taken out: 0 1 2 1 4 is the triangle 0 1 4.
    let (mesh, _) = Mesh::build(&Soup::from_faces(square(), &[[0, 1, 2, 1, 4]]), Weld::Off).unwrap();
    assert_eq!(mesh.topology.counts().corners, 3);
    assert_eq!(mesh.vertex_source, [0, 1, 4]);
}

#[test]
fn isolated_vertices_are_left_out_and_order_is_kept() {
    let mut positions = square();
    positions.insert(2, [9.0, 9.0, 9.0]);
    let soup = Soup::from_faces(positions, &[[0, 1, 3], [0, 3, 4]]);
    let (mesh, _) = Mesh::build(&soup, Weld::Off).unwrap();
    assert_eq!(mesh.vertex_source, [0, 1, 3, 4]);
    assert_eq!(notes(&soup), ["2 vertex positions used by no face (first: 2) left out"]);
}

#[test]
fn neighbours_are_turned_to_agree_with_the_majority() {
    let soup = Soup::from_faces(square(), &[[0, 1, 4], [1, 2, 4], [2, 4, 3], [3, 0, 4]]);
    let (mesh, report) = Mesh::build(&soup, Weld::Off).unwrap();
    assert_eq!(report.notes, [Note::Turned { count: 1, first: 2 }]);
    let face = |f| mesh.topology.face_half_edges(f).map(|h| mesh.topology.origin(h)).collect::<Vec<_>>();
    assert_eq!((face(0), face(2)), (vec![0, 1, 4], vec![2, 3, 4]));
    assert_eq!(mesh.counts().boundary, 4);
    // The odd one out comes first: it is still the one that turns.
    let soup = Soup::from_faces(square(), &[[0, 4, 1], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    assert_eq!(Mesh::build(&soup, Weld::Off).unwrap().1.notes, [Note::Turned { count: 1, first: 0 }]);
}

#[test]
fn three_faces_on_an_edge_are_cut_apart() {
    let (mesh, report) = Mesh::build(&book(2), Weld::Off).unwrap();
    assert_eq!(report.notes[0], Note::NonManifoldEdges { count: 2, first: [0, 4] });
    assert_eq!(report.notes.len(), 1);
    let stats = mesh.stats();
    assert_eq!((stats.components, stats.boundary_loops), (3, 3));
    // The inside of the cut curve stays a smooth curve; its ends become corners.
    let sharp: Vec<u32> = (0..mesh.positions.len()).filter(|&v| mesh.sharp[v]).map(|v| mesh.vertex_source[v]).collect();
    assert_eq!(sharp, [0, 8, 0, 0, 8, 8]);
}

#[test]
fn fans_that_meet_in_a_point_are_split_and_sharp() {
    let (mesh, report) = Mesh::build(&bow_tie(), Weld::Off).unwrap();
    assert_eq!(report.notes, [Note::NonManifoldVertices { count: 1, first: 0 }]);
    assert_eq!(mesh.vertex_source, [0, 1, 2, 3, 4, 0]);
    assert_eq!(mesh.sharp, [true, false, false, false, false, true]);
}

#[test]
fn one_side_only() {
    let (mesh, report) = Mesh::build(&(limn_mesh::shape("moebius").unwrap().build)(), Weld::Off).unwrap();
    assert!(mesh.one_sided);
    assert_eq!(mesh.stats().genus, None);
    assert!(
        report.notes.iter().any(|n| n.to_string().starts_with("the surface has one side only; cut along")),
        "{report:?}"
    );
}

#[test]
fn stats_know_the_shape() {
    let of = |name: &str| Mesh::build(&(limn_mesh::shape(name).unwrap().build)(), Weld::Off).unwrap().0.stats();
    let (torus, cube, grid) = (of("torus"), of("cube"), of("grid"));
    assert_eq!((torus.genus, torus.components, torus.boundary_loops), (Some(1), 1, 0));
    assert_eq!((cube.genus, cube.components, cube.boundary_loops), (Some(0), 1, 0));
    assert_eq!((grid.genus, grid.components, grid.boundary_loops), (Some(0), 1, 1));
}

#[test]
fn seams_are_found_by_value() {
    // Two triangles, one edge; texture indices differ, values agree at one end only.
    let mut soup = Soup::from_faces(square(), &[[0, 1, 2], [0, 2, 3]]);
    soup.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    soup.uv_corners = vec![0, 1, 2, 3, 4, 5];
    let seams = |soup: &Soup| Mesh::build(soup, Weld::Off).unwrap().0.uv.unwrap().topology.counts().boundary;
    assert_eq!(seams(&soup), 4);
    soup.uvs[4] = [0.9, 1.0];
    assert_eq!(seams(&soup), 6);
    soup.uvs[4] = [1.0, 1.0];
    soup.uv_corners[3] = NONE;
    assert_eq!(seams(&soup), 6);
}

#[test]
fn refused_in_one_sentence() {
    let error = |soup: &Soup| Mesh::build(soup, Weld::Exact).unwrap_err().to_string();
    assert_eq!(error(&Soup::default()), "the model has no faces; drop a model with polygons");
    assert_eq!(
        error(&Soup::from_faces(square(), &[[0, 0, 1]])),
        "the model has no faces (all 1 have fewer than three different corners); drop a model with polygons"
    );
    assert_eq!(
        error(&Soup::from_faces(square(), &[[0, 1, 2], [0, 7, 1]])),
        "face 1 uses vertex 7, but there are only 5 vertices (numbered from 0)"
    );
    let mut soup = Soup::from_faces(square(), &[[0, 1, 2]]);
    soup.positions[4][1] = f32::NAN;
    assert_eq!(error(&soup), "vertex 4 has a coordinate that is not a finite number");
    let mut soup = Soup::from_faces(square(), &[[0, 1, 2]]);
    soup.offsets = vec![0, 2];
    assert!(matches!(Mesh::build(&soup, Weld::Off), Err(TopologyError::Inconsistent { .. })));
}

#[test]
fn parts_that_touch_stay_apart_whatever_happens_to_their_faces() {
    // Two unit squares of two objects, one on top of the other's edge.
    let mut positions = square();
    positions.truncate(4);
    positions.extend([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    let mut soup = Soup::from_faces(positions, &[[0, 1, 2, 3], [4, 5, 6, 7]]);
    let parts = |s: &Soup| Mesh::build(s, Weld::Exact).unwrap().0.stats().components;
    assert_eq!(parts(&soup), 1);
    soup.parts = vec![0, 0, 0, 0, 1, 1, 1, 1];
    let (triangles, _) = limn_mesh::triangulate_soup(&soup);
    let (quads, _) = limn_mesh::pair::pair_triangles(&triangles);
    assert_eq!([&soup, &triangles, &quads].map(parts), [2, 2, 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any faces over a few vertices: no panic, a valid mesh, and every scheme refines it to valid corners.
    #[test]
    fn rubble_becomes_a_mesh(soup in rubble()) {
        match Mesh::build(&soup, Weld::Off) {
            Err(e) => prop_assert!(matches!(e, TopologyError::NoFaces { .. }), "{e}"),
            Ok((mesh, _)) => {
                prop_assert_eq!(validate(&mesh.topology), Ok(()));
                mesh.stats();
                let mesh = std::sync::Arc::new(mesh);
                let boundaries = [limn_mesh::Boundary::EdgeOnly, limn_mesh::Boundary::EdgeAndCorner];
                let takes = |s: &&'static limn_mesh::Entry| s.info.split(mesh.face_shape(), boundaries[0], &[0.0; 3]).is_some();
                for (scheme, boundary) in SCHEMES.iter().filter(takes).flat_map(|s| boundaries.map(|b| (s, b))) {
                    let plan = limn_mesh::Plan::new(scheme, boundary, 2);
                    let refined = limn_mesh::refine(&mesh, &plan, u64::MAX).unwrap();
                    prop_assert_eq!(refined.points.len() as u64, refined.counts.vertices, "{}", scheme.info.id);
                    prop_assert_eq!(refined.faces.count() as u64, refined.counts.faces, "{}", scheme.info.id);
                    if scheme.info.group == "dual" {
                        continue; // Its vertices are corners.
                    }
                    let same = |a: usize, b: usize| refined.points[a].map(f32::to_bits) == refined.points[b].map(f32::to_bits);
                    for v in 0..mesh.positions.len() {
                        let first = mesh.vertex_source.iter().position(|&s| s == mesh.vertex_source[v]).unwrap();
                        prop_assert!(same(v, first), "{}: copies {} and {} part", scheme.info.id, first, v);
                    }
                }
            }
        }
    }
}

/// Marks name positions and faces of the soup; the mesh has them by its own edges, vertices, faces and half-edges.
#[test]
fn marks_find_their_places() {
    // Two quads side by side and a stray position in front.
    let mut points = vec![[9.0, 9.0, 9.0]];
    points.extend((0..6).map(|i| [(i / 2) as f32, (i % 2) as f32, 0.0]));
    let mut soup = Soup::from_faces(points, &[[1u32, 3, 4, 2], [3, 5, 6, 4]]);
    soup.marks.creases = vec![([3, 4], 2.5), ([1, 2], 1.0), ([2, 1], 10.0), ([1, 4], 3.0)];
    soup.marks.corners = vec![(5, 4.0), (0, 1.0)];
    soup.marks.holes = vec![1];
    soup.marks.knots = vec![([3, 4], 2.0), ([5, 6], 0.5), ([6, 5], 0.25)];
    let (mesh, report) = Mesh::build(&soup, Weld::Off).unwrap();
    let t = &mesh.topology;
    let half_edge = |a: u32, b: u32| {
        let at = |h: u32| mesh.vertex_source[t.origin(h) as usize];
        (0..t.half_edges()).find(|&h| at(h) == a && at(t.next(h)) == b).unwrap()
    };
    for (a, b, sharpness) in [(3, 4, 2.5), (4, 3, 2.5), (2, 1, 10.0), (1, 3, 0.0)] {
        assert_eq!(mesh.edge_sharpness[t.edge(half_edge(a, b)) as usize], sharpness, "{a}-{b}");
    }
    let corner: Vec<u32> = (0..6).filter(|&v| mesh.vertex_sharpness[v as usize] > 0.0).collect();
    assert_eq!(corner.iter().map(|&v| mesh.vertex_source[v as usize]).collect::<Vec<_>>(), [5]);
    assert_eq!(mesh.holes, [false, true]);
    let knots = |a, b| {
        let h = half_edge(a, b) as usize;
        [mesh.knots[2 * h], mesh.knots[2 * h + 1]]
    };
    assert_eq!((knots(3, 4), knots(4, 3)), ([2.0, 1.0], [1.0, 2.0]));
    assert_eq!((knots(5, 6), knots(1, 3)), ([0.5, 0.25], [1.0, 1.0]));
    let notes: Vec<_> = report.notes.iter().map(ToString::to_string).collect();
    assert!(
        notes.contains(&"2 marks on what the model does not have (first: edge 1-4) left out".to_owned()),
        "{notes:?}"
    );
    // Copies of a vertex on a cut edge share its marks.
    let mut book = book(4);
    book.marks.creases = vec![([4, 5], 3.0), ([4, 8], 2.0)];
    let mesh = common::build(&book);
    let sharp = |s: f32| mesh.edge_sharpness.iter().filter(|&&x| x == s).count();
    assert_eq!((sharp(3.0), sharp(2.0)), (1, 3), "one edge of a page, and the spine on each of three pages");
}

/// Three sheets on a line, and a closed fan that touches them in a point of it: the fan's vertex goes where the cut's curve goes,
/// as OpenSubdiv has it, at every level and in the limit. A fan at an end of the line keeps all there.
#[test]
fn a_fan_that_touches_a_cut_goes_with_it() {
    let mut positions: Vec<[f32; 3]> = [0.0, 1.0, 1.2, 3.0].map(|z| [0.2 * z * z, 0.0, z]).to_vec();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for (x, y) in [(1.0, 0.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let first = positions.len() as u32;
        positions.extend([0.0, 1.0, 2.0, 3.0].map(|z| [x, y, z]));
        faces.extend((0..3).map(|k| vec![k, k + 1, first + k + 1, first + k]));
    }
    let touching = |at: u32, positions: &mut Vec<[f32; 3]>| {
        let first = positions.len() as u32;
        positions.extend([[0.3, 0.2, 4.0], [0.6, 0.1, 4.0], [0.5, 0.4, 4.2]]);
        (0..3).map(|i| vec![at, first + i, first + (i + 1) % 3]).collect::<Vec<_>>()
    };
    for (at, moves) in [(1u32, true), (0, false)] {
        let mut positions = positions.clone();
        let fan = touching(at, &mut positions);
        let soup = Soup::from_faces(positions.clone(), &[&faces[..], &fan[..]].concat());
        for soup in [soup.clone(), limn_mesh::triangulate_soup(&soup).0] {
            let mesh = common::build(&soup);
            let copies: Vec<usize> = (0..mesh.positions.len()).filter(|&v| mesh.vertex_source[v] == at).collect();
            assert_eq!((copies.len(), mesh.tied.len()), (4, usize::from(moves)));
            assert_eq!(Mesh::unpack(&mesh.pack()).unwrap(), *mesh);
            let exact: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
            for scheme in SCHEMES.iter().filter(|s| !["dual", "linear"].contains(&s.info.group) && !s.info.is_random())
            {
                for (level, limit) in [(1, false), (2, true), (3, false)] {
                    let plan =
                        limn_mesh::Plan { limit, ..limn_mesh::Plan::new(scheme, limn_mesh::Boundary::EdgeOnly, level) };
                    let Ok(refined) = limn_mesh::refine(&mesh, &plan, u64::MAX) else { continue };
                    let place = |v: usize| refined.points[v].map(f32::to_bits);
                    assert!(copies.iter().all(|&v| place(v) == place(copies[0])), "{}, level {level}", scheme.info.id);
                    // The slow way says the same.
                    let slow = limn_mesh::refine::evaluate(&mesh, &plan, &exact, |_| ()).unwrap();
                    for &v in &copies {
                        let off =
                            (0..3).map(|k| (slow[v][k] - f64::from(refined.points[v][k])).abs()).fold(0.0, f64::max);
                        assert!(off < 1e-5, "{}, level {level}: {off}", scheme.info.id);
                    }
                }
            }
            for (id, level) in [("catmull-clark", 1), ("loop", 1)] {
                let plan = limn_mesh::Plan::new(limn_mesh::scheme(id).unwrap(), limn_mesh::Boundary::EdgeOnly, level);
                let Ok(refined) = limn_mesh::refine(&mesh, &plan, u64::MAX) else { continue };
                let p = |v: u32, k: usize| positions[v as usize][k];
                for (k, x) in refined.points[*copies.last().unwrap()].iter().enumerate() {
                    let there = if moves { 0.75 * p(1, k) + 0.125 * (p(0, k) + p(2, k)) } else { p(0, k) };
                    assert!((x - there).abs() < 1e-6, "{id}: {x} and {there}");
                }
            }
        }
    }
}
