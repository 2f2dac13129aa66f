//! Faces in no order are put into one: the surface is the same, and every number of the file still names what it named.

use limn_mesh::topology::{is_boundary, validate};
use limn_mesh::{Boundary, Connectivity, Mesh, NONE, Plan, Refined, Soup, Weld, refine, scheme};

/// Quads a side; as many faces as are looked at, and more.
const SIDE: u32 = 72;

/// A wavy sheet with a fin on one inner edge, a crease, a corner, a hole, knots, and texture coordinates with a seam.
fn sheet() -> Soup {
    let at = |i: u32, j: u32| j * (SIDE + 1) + i;
    let mut positions: Vec<[f32; 3]> = (0..=SIDE)
        .flat_map(|j| (0..=SIDE).map(move |i| [i as f32, j as f32, ((i * 7 + j * 5) % 11) as f32 * 0.1]))
        .collect();
    let mut faces: Vec<[u32; 4]> = (0..SIDE)
        .flat_map(|j| (0..SIDE).map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect();
    let top = positions.len() as u32;
    positions.extend([[30.0, 40.0, 3.0], [31.0, 40.0, 3.0]]);
    faces.push([at(30, 40), at(31, 40), top + 1, top]);
    let mut soup = Soup::from_faces(positions, &faces);
    // Texture coordinates are the places, moved to the side right of the middle.
    soup.uvs = (0..2).flat_map(|side| soup.positions.iter().map(move |p| [p[0] + 100.0 * side as f32, p[1]])).collect();
    let count = soup.positions.len() as u32;
    let right = |f: usize| f < (SIDE * SIDE) as usize && f as u32 % SIDE >= SIDE / 2;
    soup.uv_corners = (0..faces.len()).flat_map(|f| faces[f].map(|v| if right(f) { count + v } else { v })).collect();
    soup.marks.creases = vec![([at(5, 9), at(6, 9)], 2.5), ([at(6, 9), at(7, 9)], 10.0)];
    soup.marks.corners = vec![(at(20, 20), 10.0)];
    soup.marks.holes = vec![SIDE * 3 + 8];
    soup.marks.knots = vec![([at(50, 50), at(50, 51)], 2.0)];
    soup
}

/// The same polygons with vertices and faces in no order; `vertex` and `face` say which is which now.
fn scatter(soup: &Soup) -> (Soup, impl Fn(u32) -> u32, impl Fn(u32) -> u32) {
    // Numbers prime to the counts: steps that reach everything.
    let step = |n: usize| {
        (n as u64 * 619 / 1000..)
            .find(|s| (2..=*s).all(|d| !s.is_multiple_of(d) || !(n as u64).is_multiple_of(d)))
            .unwrap()
    };
    let (vertices, faces) = (soup.positions.len() as u64, soup.face_count() as u64);
    let (by, jump) = (step(soup.positions.len()), step(soup.face_count()));
    let vertex = move |v: u32| (u64::from(v) * by % vertices) as u32;
    let face = move |f: u32| (u64::from(f) * jump % faces) as u32;
    let mut positions = vec![[0.0; 3]; vertices as usize];
    (0..vertices as u32).for_each(|v| positions[vertex(v) as usize] = soup.positions[v as usize]);
    let mut old = vec![0; faces as usize];
    (0..faces as u32).for_each(|f| old[face(f) as usize] = f as usize);
    let corners = |&f: &usize| soup.face(f).iter().map(|&v| vertex(v)).collect::<Vec<_>>();
    let mut out = Soup::from_faces(positions, &old.iter().map(corners).collect::<Vec<_>>());
    out.uvs = soup.uvs.clone();
    out.uv_corners = old.iter().flat_map(|&f| soup.uv_corners[soup.face_range(f)].to_vec()).collect();
    let ends = |&([a, b], x): &([u32; 2], f32)| ([vertex(a), vertex(b)], x);
    out.marks.creases = soup.marks.creases.iter().map(ends).collect();
    out.marks.knots = soup.marks.knots.iter().map(ends).collect();
    out.marks.corners = soup.marks.corners.iter().map(|&(v, s)| (vertex(v), s)).collect();
    out.marks.holes = soup.marks.holes.iter().map(|&f| face(f)).collect();
    (out, vertex, face)
}

fn build(soup: &Soup) -> (Mesh, Vec<String>) {
    let (mesh, report) = Mesh::build(soup, Weld::Off).unwrap();
    validate(&mesh.topology).unwrap();
    (mesh, report.notes.iter().map(ToString::to_string).collect())
}

/// For each position of the soup the lowest vertex that stands for it.
fn first_of(mesh: &Mesh) -> Vec<usize> {
    let mut first = vec![NONE as usize; mesh.weld_class.len()];
    mesh.vertex_source.iter().enumerate().rev().for_each(|(v, &s)| first[s as usize] = v);
    first
}

fn level(mesh: Mesh, id: &str) -> Refined {
    refine(&mesh.into(), &Plan::new(scheme(id).unwrap(), Boundary::default(), 2), u64::MAX).unwrap()
}

#[test]
fn scattered_faces_are_put_in_order_and_keep_their_names() {
    let soup = sheet();
    let (scattered, vertex, face) = scatter(&soup);
    let ((whole, said), (mesh, told)) = (build(&soup), build(&scattered));
    // Neighbours lie near one another now, vertices follow faces; in the sheet nothing was moved.
    let t = &mesh.topology;
    let mut apart: Vec<u32> = (0..t.half_edges())
        .filter(|&h| !is_boundary(t.twin(h)))
        .map(|h| t.face(h).abs_diff(t.face(t.twin(h))))
        .collect();
    apart.sort_unstable();
    assert!(apart[apart.len() / 2] < 16, "{}", apart[apart.len() / 2]);
    assert!(whole.face_source.is_sorted() && !mesh.face_source.is_sorted());
    assert_eq!(t.face_half_edges(0).map(|h| t.origin(h)).collect::<Vec<_>>(), [0, 1, 2, 3]);
    // What was said, by the file's numbers.
    let fin = [40 * (SIDE + 1) + 30, 40 * (SIDE + 1) + 31];
    let mut ends = fin.map(&vertex);
    ends.sort_unstable();
    assert_eq!(
        said,
        [format!("1 edge with more than two faces (first: {}-{}) cut apart and kept sharp", fin[0], fin[1])]
    );
    assert_eq!(
        told,
        [format!("1 edge with more than two faces (first: {}-{}) cut apart and kept sharp", ends[0], ends[1])]
    );
    // What was marked.
    let holes =
        |mesh: &Mesh| mesh.holes.iter().zip(&mesh.face_source).filter(|h| *h.0).map(|h| *h.1).collect::<Vec<_>>();
    assert_eq!(holes(&mesh), holes(&whole).into_iter().map(&face).collect::<Vec<_>>());
    for &([a, b], s) in &scattered.marks.creases {
        assert_eq!(mesh.edge_sharpness[mesh.edge_between(a, b).unwrap() as usize], s);
    }
    assert_eq!(mesh.edge_sharpness.iter().filter(|s| **s > 0.0).count(), 2);
    // Every vertex goes where it goes in the sheet, whatever the scheme makes of its marks.
    let (before, after) = (first_of(&whole), first_of(&mesh));
    for id in ["catmull-clark", "linear", "kobbelt"] {
        let (a, b) = (level(whole.clone(), id), level(mesh.clone(), id));
        for v in 0..soup.positions.len() as u32 {
            let (p, q) = (a.points[before[v as usize]], b.points[after[vertex(v) as usize]]);
            let apart = (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f32::max);
            assert!(apart < 1e-5, "{id}: vertex {v} {p:?} {q:?}");
        }
        // Faces come from the faces that they came from, and texture coordinates lie where the faces do.
        let middle = |r: &Refined| {
            let uv = r.uv.as_ref().unwrap();
            let of = |f: usize| {
                let mean = r.faces.range(f).fold([0.0f64; 2], |sum, c| {
                    let x = uv.values[uv.corners[c] as usize];
                    [sum[0] + f64::from(x[0]) / 4.0, sum[1] + f64::from(x[1]) / 4.0]
                });
                (r.face_source(f as u32), mean)
            };
            (0..r.faces.count()).map(of).collect::<Vec<_>>()
        };
        let sorted = |mut rows: Vec<(u32, [f64; 2])>| {
            rows.sort_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])).then(a.1[1].total_cmp(&b.1[1])));
            rows
        };
        let expected = sorted(middle(&a).into_iter().map(|(f, uv)| (face(f), uv)).collect());
        let found = sorted(middle(&b));
        assert_eq!(expected.len(), found.len());
        for ((f, p), (g, q)) in expected.into_iter().zip(found) {
            assert!(f == g && (0..2).all(|k| (p[k] - q[k]).abs() < 1e-4), "{id}: face {f} {p:?}, {g} {q:?}");
        }
    }
}

/// Large meshes in order stay so, where numbers have 32 bits too.
#[test]
fn order_is_kept_where_there_is_some() {
    const SIDE: u32 = 264;
    let at = |i: u32, j: u32| j * (SIDE + 1) + i;
    let places = |n: u32| (0..n).flat_map(move |j| (0..n).map(move |i| (i, j)));
    let positions = places(SIDE + 1).map(|(i, j)| [i as f32, j as f32, 0.0]).collect();
    let faces: Vec<[u32; 4]> =
        places(SIDE).map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect();
    assert!(faces.len() as u64 * u64::from((SIDE + 1) * (SIDE + 1)) > u64::from(u32::MAX));
    let (mesh, _) = Mesh::build(&Soup::from_faces(positions, &faces), Weld::Off).unwrap();
    assert!(mesh.face_source.is_sorted() && mesh.vertex_source.is_sorted());
}

/// Faces of any vertices, with repeats, stray positions and edges of many faces: as many as are put in order.
#[test]
fn rubble_is_put_in_order_whatever_it_holds() {
    let mut state = 1u64;
    let mut below = |n: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(n)) as u32
    };
    let positions: Vec<[f32; 3]> = (0..3000).map(|_| [0; 3].map(|_: u8| below(50) as f32)).collect();
    let faces: Vec<Vec<u32>> = (0..5000)
        .map(|_| {
            let (count, near) = (1 + below(6), below(2900));
            (0..count).map(|_| near + below(90)).collect()
        })
        .collect();
    let mut soup = Soup::from_faces(positions, &faces);
    soup.uvs = (0..40).map(|i| [i as f32, 0.5]).collect();
    soup.uv_corners = (0..soup.corners.len()).map(|i| if i % 13 == 0 { NONE } else { i as u32 % 40 }).collect();
    for weld in [Weld::Off, Weld::Exact] {
        let (mesh, report) = Mesh::build(&soup, weld).unwrap();
        validate(&mesh.topology).unwrap();
        validate(&mesh.uv.as_ref().unwrap().topology).unwrap();
        assert!(!mesh.face_source.is_sorted());
        let mut seen = vec![false; soup.face_count()];
        for f in 0..mesh.topology.faces() {
            let source = mesh.face_source[f as usize] as usize;
            assert!(!std::mem::replace(&mut seen[source], true), "face {source} is there once");
            let mut whole: Vec<u32> = soup.face(source).iter().map(|&v| mesh.weld_class[v as usize]).collect();
            let corners = mesh.topology.face_half_edges(f).map(|h| mesh.topology.origin(h));
            let mut classes: Vec<u32> = corners.clone().map(|v| mesh.vertex_source[v as usize]).collect();
            assert!(corners.zip(&classes).all(|(v, &c)| mesh.positions[v as usize] == soup.positions[c as usize]));
            // Repeated corners and spikes may have gone.
            whole.sort_unstable();
            classes.sort_unstable();
            if classes.len() == whole.len() {
                assert_eq!(classes, whole, "face {source}");
            } else {
                assert!(classes.iter().all(|c| whole.contains(c)), "face {source}");
            }
        }
        // The lowest of each kind is named first.
        let left_out = seen.iter().position(|seen| !seen).unwrap();
        let said: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|s| s.contains(&format!("(first: {left_out}) left out"))), "{said:?}");
    }
}
