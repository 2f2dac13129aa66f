//! Levels that go straight into buffers: the bytes that are drawn, against the level itself.

use std::collections::BTreeSet;
use std::sync::Arc;

use limn_kernel::Kernel;
use limn_layout::corners::Corner;
use limn_layout::{Place, Sink, pack};
use limn_mesh::{Boundary, Faces, Mesh, Plan, Refined, Soup, Weld, refine, scheme, shape};

/// The buffers of a surface.
#[derive(Default)]
struct Buffers {
    vertices: Vec<u8>,
    pieces: Vec<Vec<u8>>,
    extras: Vec<Vec<u8>>,
}

impl Buffers {
    /// Of a shape, before anything is written.
    fn new(shape: &[u32]) -> Buffers {
        let [count, a, b, ends @ ..] = shape else { panic!("{shape:?}") };
        let mut out =
            Buffers { vertices: vec![0xff; if *b > 0 { *count as usize * 16 } else { 0 }], ..Buffers::default() };
        let mut first = 0;
        for end in ends {
            let faces = (end - first) as usize;
            out.pieces.push(vec![0xff; faces * if *b > 0 { 24 } else { 72 }]);
            out.extras.push(vec![0xff; if *b == 0 && *a > 0 { faces * 36 } else { 0 }]);
            first = *end;
        }
        out
    }
}

impl Sink for Buffers {
    fn write(&mut self, place: Place, offset: u64, bytes: &[u8]) {
        let buffer = match place {
            Place::Vertices => &mut self.vertices,
            Place::Piece(i) => &mut self.pieces[i],
            Place::Extra(i) => &mut self.extras[i],
            Place::Colors => panic!("no colours of vertices"),
        };
        buffer[offset as usize..offset as usize + bytes.len()].copy_from_slice(bytes);
    }
}

fn built(name: &str) -> Arc<Mesh> {
    Arc::new(Mesh::build(&(shape(name).unwrap().build)(), Weld::Off).unwrap().0)
}

fn plan(id: &str, level: u32) -> Plan {
    Plan::new(scheme(id).unwrap(), Boundary::default(), level)
}

/// Fills buffers of at most so many bytes; they, the runs of parts and the box.
fn filled(kernel: &Kernel, plan: &Plan, limit: f64, parts: &[u32]) -> (Buffers, Vec<u32>, Vec<f32>) {
    let mut filling = kernel.fill(&plan.pack(), 1e9, limit, parts).unwrap().unwrap();
    let mut out = Buffers::new(&filling.shape());
    let mut last = 0.0;
    while !filling.advance(5000, &mut out).unwrap() {
        assert!((last..=1.0).contains(&filling.progress()), "{last} {}", filling.progress());
        last = filling.progress();
    }
    (out, filling.runs(), filling.bounds())
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn is_level(out: &Buffers, level: &Refined, what: &str) {
    let vertices: &[[u8; 16]] = bytemuck::cast_slice(&out.vertices);
    assert_eq!(vertices.len(), level.points.len(), "{what}");
    let normals = level.normals();
    for (v, (bytes, (point, normal))) in vertices.iter().zip(level.points.iter().zip(&normals)).enumerate() {
        let position: [f32; 3] = bytemuck::pod_read_unaligned(&bytes[..12]);
        assert_eq!(position, *point, "vertex {v} of {what}");
        let found = pack::unpack_normal(bytemuck::pod_read_unaligned(&bytes[12..]));
        assert!(dot(found, *normal) > 0.999, "normal {v} of {what}: {found:?}, not {normal:?}");
    }
    let indices: Vec<u32> = out.pieces.iter().flat_map(|p| bytemuck::pod_collect_to_vec::<u8, u32>(p)).collect();
    let Faces::Quads(quads) = &level.faces else { panic!("no quads: {what}") };
    let expected: Vec<u32> = quads.chunks(4).flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]]).collect();
    assert_eq!(indices, expected, "{what}");
}

#[test]
fn quads_are_drawn_as_they_are_refined() {
    let mut kernel = Kernel::new();
    // One after the other, so that each gets the memory of the one before: larger, smaller, of another mesh, by another scheme.
    for (name, id, level) in [
        ("creature", "catmull-clark", 3),
        ("creature", "catmull-clark", 3),
        ("creature", "linear", 3),
        ("creature", "catmull-clark", 4),
        ("pawn", "catmull-clark", 3),
        ("grid", "catmull-clark", 5),
        ("grid", "kobbelt", 3),
        ("creature", "catmull-clark", 1),
    ] {
        let mesh = built(name);
        kernel.mesh(&mesh.pack()).unwrap();
        let plan = plan(id, level);
        let level = refine(&mesh, &plan, 1 << 30).unwrap();
        let what = format!("{name} by {id}, level {}", plan.level);
        let (out, runs, bounds) = filled(&kernel, &plan, 1e9, &[]);
        is_level(&out, &level, &what);
        assert_eq!(runs, [0, level.faces.count() as u32 * 6], "{what}");
        for k in 0..3 {
            let of = |pick: fn(f32, f32) -> f32| level.points.iter().map(|p| p[k]).reduce(pick).unwrap();
            assert_eq!([bounds[k], bounds[k + 3]], [of(f32::min), of(f32::max)], "{what}");
        }
        // In pieces: buffers that take no more than the vertices.
        let (out, ..) = filled(&kernel, &plan, level.points.len() as f64 * 16.0, &[]);
        assert!(out.pieces.len() > 1);
        is_level(&out, &level, &what);
    }
}

#[test]
fn everything_else_is_drawn_as_corners() {
    let mut kernel = Kernel::new();
    for (name, id) in [("icosahedron", "loop"), ("creature", "doo-sabin"), ("icosahedron", "sqrt3")] {
        let mesh = built(name);
        kernel.mesh(&mesh.pack()).unwrap();
        let plan = plan(id, 3);
        let level = refine(&mesh, &plan, 1 << 30).unwrap();
        let (out, runs, _) = filled(&kernel, &plan, 1e9, &[]);
        let corners: Vec<Corner> =
            out.pieces.iter().flat_map(|p| bytemuck::pod_collect_to_vec::<u8, Corner>(p)).collect();
        assert_eq!(runs, [0, corners.len() as u32]);
        let (normals, mut rest) = (level.normals(), &corners[..]);
        for f in 0..level.faces.count() {
            let polygon = level.faces.face(f);
            let (own, others) = rest.split_at(3 * (polygon.len() - 2));
            rest = others;
            for corner in own {
                assert!(
                    polygon.iter().any(|&v| level.points[v as usize] == corner.position),
                    "face {f} of {name} by {id}"
                );
            }
            for &v in polygon {
                let (point, normal) = (level.points[v as usize], normals[v as usize]);
                let along = |c: &Corner| dot(pack::unpack_normal(c.normal), normal) > 0.999;
                let found = own.iter().any(|c| c.position == point && along(c));
                assert!(found, "vertex {v} of face {f} of {name} by {id}");
            }
        }
        assert!(rest.is_empty(), "{name} by {id}");
    }
}

/// A square of four quads: two parts, in turn; the first with texture coordinates if asked for.
fn four(uv: bool) -> Arc<Mesh> {
    let points = (0..9).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
    let mut soup = Soup::from_faces(points, &[[0u32, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]);
    if uv {
        soup.uvs = (0..9).map(|i| [(i % 3) as f32 / 2.0, (i / 3) as f32 / 2.0]).collect();
        soup.uv_corners = soup.corners.clone();
    }
    Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0)
}

#[test]
fn parts_are_runs() {
    let mut kernel = Kernel::new();
    let mesh = four(false);
    kernel.mesh(&mesh.pack()).unwrap();
    let plan = plan("catmull-clark", 3);
    let level = refine(&mesh, &plan, 1 << 30).unwrap();
    let (out, runs, _) = filled(&kernel, &plan, 1e9, &[0, 1, 0, 1]);
    assert_eq!(runs, [0, 2 * 64 * 6, 1, 2 * 64 * 6]);
    let indices: Vec<u32> = bytemuck::pod_collect_to_vec(&out.pieces[0]);
    let drawn = |range: std::ops::Range<usize>| indices[range].iter().copied().collect::<BTreeSet<u32>>();
    let own = |part: u32| -> BTreeSet<u32> {
        let faces = (0..level.faces.count()).filter(|&f| level.face_source(f as u32) % 2 == part);
        faces.flat_map(|f| level.faces.face(f)).copied().collect()
    };
    assert_eq!(own(0), drawn(0..2 * 64 * 6));
    assert_eq!(own(1), drawn(2 * 64 * 6..4 * 64 * 6));
}

#[test]
fn corners_carry_texture_coordinates() {
    let mut kernel = Kernel::new();
    let mesh = four(true);
    assert!(mesh.uv.is_some());
    kernel.mesh(&mesh.pack()).unwrap();
    let (out, ..) = filled(&kernel, &plan("linear", 2), 1e9, &[]);
    let corners: &[Corner] = &bytemuck::pod_collect_to_vec(&out.pieces[0]);
    let extras: &[[f32; 3]] = &bytemuck::pod_collect_to_vec(&out.extras[0]);
    assert_eq!((corners.len(), extras.len()), (4 * 16 * 6, 4 * 16 * 6));
    for (corner, extra) in corners.iter().zip(extras) {
        assert_eq!([corner.position[0], corner.position[1]], [extra[0] * 2.0, extra[1] * 2.0]);
    }
}

#[test]
fn what_is_not_drawn_whole_is_left_to_others() {
    let mut kernel = Kernel::new();
    let fill = |kernel: &Kernel, plan: &Plan, limit| kernel.fill(&plan.pack(), 1e9, limit, &[]);
    assert!(fill(&kernel, &plan("catmull-clark", 3), 1e9).err().unwrap().contains("no mesh"));
    kernel.mesh(&built("grid").pack()).unwrap();
    assert!(fill(&kernel, &plan("catmull-clark", 3), 1e9).unwrap().is_some());
    // Its vertices fit no buffer; its budget is too small; faces at the rim are left out; there is nothing to refine.
    assert!(fill(&kernel, &plan("catmull-clark", 3), 1000.0).unwrap().is_none());
    assert!(kernel.fill(&plan("catmull-clark", 9).pack(), 1e6, 1e9, &[]).err().unwrap().contains("choose level"));
    assert!(fill(&kernel, &Plan::new(scheme("catmull-clark").unwrap(), Boundary::None, 3), 1e9).unwrap().is_none());
    assert!(fill(&kernel, &plan("catmull-clark", 0), 1e9).unwrap().is_none());
}
