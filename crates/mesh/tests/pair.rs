//! Triangle pairs back to quads: the same quads come back, seams and true triangles stay.

use limn_mesh::pair::{ASK_BELOW, pair_triangles};
use limn_mesh::shapes::shape;
use limn_mesh::soup::{NONE, Soup};

const QUAD_SHAPES: &[&str] = &["cube", "torus", "grid", "t-shape", "moebius", "creature"];

fn build(name: &str) -> Soup {
    (shape(name).unwrap().build)()
}

/// Every quad cut along the diagonal at its first corner, or along the other.
fn cut(soup: &Soup, other: bool) -> Vec<[u32; 3]> {
    (0..soup.face_count())
        .flat_map(|f| {
            let [a, b, c, d] = *soup.face(f) else { panic!("not a quad") };
            if other { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] }
        })
        .collect()
}

/// The quads, each turned so that its lowest corner is first, sorted.
fn quads(soup: &Soup) -> Vec<[u32; 4]> {
    let mut list: Vec<[u32; 4]> = (0..soup.face_count())
        .filter_map(|f| <[u32; 4]>::try_from(soup.face(f)).ok())
        .map(|mut q| {
            let lowest = (0..4).min_by_key(|&i| q[i]).unwrap();
            q.rotate_left(lowest);
            q
        })
        .collect();
    list.sort_unstable();
    list
}

fn shuffle<T>(list: &mut [T], mut seed: u32) {
    for i in (1..list.len()).rev() {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        list.swap(i, (seed >> 8) as usize % (i + 1));
    }
}

#[test]
fn consecutive_halves_come_back_exactly() {
    for name in QUAD_SHAPES {
        let soup = build(name);
        for other in [false, true] {
            let triangles = Soup::from_faces(soup.positions.clone(), &cut(&soup, other));
            let (back, report) = pair_triangles(&triangles);
            assert_eq!((report.quads, report.triangles_left), (soup.face_count(), 0), "{name}");
            assert_eq!(back, soup, "{name}");
            assert!(report.confidence > 0.6, "{name}: {report:?}");
        }
    }
}

#[test]
fn shuffled_halves_come_back_nearly_all() {
    for name in QUAD_SHAPES {
        let soup = build(name);
        for seed in 0..4 {
            let mut triangles = cut(&soup, seed % 2 == 1);
            shuffle(&mut triangles, seed);
            triangles.iter_mut().enumerate().for_each(|(i, t)| t.rotate_left((i + seed as usize) % 3));
            let (back, report) = pair_triangles(&Soup::from_faces(soup.positions.clone(), &triangles));
            let (expected, found) = (quads(&soup), quads(&back));
            let same = found.iter().filter(|q| expected.binary_search(q).is_ok()).count();
            assert!(same * 100 >= expected.len() * 95, "{name}: {same} of {} ({report:?})", expected.len());
        }
    }
}

#[test]
fn true_triangles_are_not_taken_for_quads() {
    for name in ["tetrahedron", "octahedron", "icosahedron", "pawn"] {
        let soup = build(name);
        let (_, report) = pair_triangles(&soup);
        assert!(report.confidence < ASK_BELOW, "{name}: {report:?}");
    }
    // A flat sheet of equal triangles, each with three partners.
    let row = |y: usize| (0..12).map(move |x| [x as f32 + 0.5 * (y % 2) as f32, y as f32 * 0.866, 0.0]);
    let mut faces = Vec::new();
    for y in 0..11u32 {
        for x in 0..11u32 {
            let [a, b, c, d] = [y * 12 + x, y * 12 + x + 1, y * 12 + x + 13, y * 12 + x + 12];
            faces.extend(if y % 2 == 0 { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    let (_, report) = pair_triangles(&Soup::from_faces((0..12).flat_map(row).collect(), &faces));
    assert!(report.confidence < ASK_BELOW, "{report:?}");
}

/// Two triangles that make the unit square.
fn square() -> Soup {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    Soup::from_faces(positions, &[[0, 1, 2], [0, 2, 3]])
}

#[test]
fn channels_stay_with_their_corners() {
    let mut soup = square();
    soup.push_face(&[3, 2, 1, 0]);
    soup.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 1.0]];
    // The second triangle has its own copy of the corner at (1, 1).
    soup.uv_corners = vec![0, 1, 2, 0, 4, 3, 3, 2, 1, 0];
    soup.colors = vec![[0.5; 4]; 4];
    soup.face_groups = vec![2, 2, 3];
    soup.face_materials = vec![1, 1, NONE];
    let (paired, report) = pair_triangles(&soup);
    assert_eq!((report.quads, report.triangles_left, report.confidence), (1, 0, 1.0));
    assert_eq!(paired.corners, [0, 1, 2, 3, 3, 2, 1, 0]);
    assert_eq!(paired.uv_corners, [0, 1, 2, 3, 3, 2, 1, 0]);
    assert_eq!((paired.face_groups, paired.face_materials), (vec![2, 3], vec![1, NONE]));
    assert_eq!((paired.positions, paired.uvs, paired.colors), (soup.positions, soup.uvs, soup.colors));
}

#[test]
fn what_differs_is_not_joined() {
    let apart = |change: &dyn Fn(&mut Soup)| {
        let mut soup = square();
        change(&mut soup);
        let (back, report) = pair_triangles(&soup);
        assert_eq!(report.quads, 0, "{soup:?}");
        assert_eq!((back.offsets, back.corners, back.uv_corners), (soup.offsets, soup.corners, soup.uv_corners));
    };
    apart(&|s| s.face_groups = vec![0, 1]);
    apart(&|s| s.face_materials = vec![NONE, 0]);
    // A texture seam along the diagonal.
    apart(&|s| {
        s.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
        s.uv_corners = vec![0, 1, 2, 0, 4, 3];
    });
    // Folded by 90 degrees, concave, without area, not a number, turned against each other.
    apart(&|s| s.positions[3] = [0.5, 0.5, 1.0]);
    apart(&|s| s.positions[3] = [1.5, 3.0, 0.0]);
    apart(&|s| s.positions[3] = [0.5, 0.5, 0.0]);
    apart(&|s| s.positions[3] = [f32::NAN, 0.5, 0.0]);
    apart(&|s| s.corners = vec![0, 1, 2, 0, 3, 2]);
    // A third triangle on the edge, corners that are not there, corners twice.
    apart(&|s| s.push_face(&[2, 0, 1]));
    apart(&|s| s.corners = vec![0, 1, 2, 0, 2, 9]);
    apart(&|s| s.corners = vec![0, 0, 2, 0, 2, 3]);
}

#[test]
fn single_triangles_between_quads_do_not_shift_the_pairs() {
    // A strip: a triangle, two squares, a triangle, written in order.
    let positions = [[0.0, 0.5], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0], [3.0, 0.0], [3.0, 1.0], [4.0, 0.5]];
    let soup = Soup::from_faces(
        positions.iter().map(|&[x, y]: &[f32; 2]| [x, y, 0.0]).collect(),
        &[[0, 1, 2], [1, 3, 4], [1, 4, 2], [3, 5, 6], [3, 6, 4], [5, 7, 6]],
    );
    let (back, report) = pair_triangles(&soup);
    assert_eq!((report.quads, report.triangles_left), (2, 2));
    assert_eq!(back.corners, [0, 1, 2, 1, 3, 4, 2, 3, 5, 6, 4, 5, 7, 6]);
}

#[test]
fn an_exporters_order_joins_what_looks_alone_would_not() {
    // A kite so sharp, and a fold of 60 degrees: joined when written as two halves, left alone in any other order.
    for far in [[0.8, 0.9, 0.0], [0.25, 0.75, 0.612]] {
        let mut soup = square();
        soup.positions[3] = far;
        assert_eq!(pair_triangles(&soup).1.quads, 1, "{far:?}");
        assert_eq!(pair_triangles(&soup).1.confidence, 0.0, "{far:?}");
        soup.corners = vec![0, 1, 2, 3, 0, 2];
        assert_eq!(pair_triangles(&soup).1.quads, 0, "{far:?}");
    }
}

#[test]
fn nothing_gives_nothing() {
    let (soup, report) = pair_triangles(&Soup::default());
    assert_eq!(soup, Soup::default());
    assert_eq!((report.quads, report.triangles_left, report.confidence), (0, 0, 0.0));
}
