//! Writing, and reading back what was written: the same bits.

use std::collections::BTreeMap;

use limn_formats::{
    Export, ExportFaces, Image, Limits, Material, Model, OutFile, WriteError, read, write_glb, write_obj,
};
use limn_mesh::soup::{NONE, Soup};

fn text(file: &OutFile) -> &str {
    std::str::from_utf8(&file.bytes).unwrap()
}

fn reread(files: &[OutFile]) -> Model {
    let others: BTreeMap<_, _> = files[1..].iter().map(|f| (f.name.clone(), f.bytes.clone())).collect();
    let (model, warnings) = read(&files[0].name, &files[0].bytes, &others, &Limits::default()).unwrap();
    assert_eq!(warnings.iter().filter(|w| !w.is_minor()).collect::<Vec<_>>(), [] as [&limn_formats::Warning; 0]);
    model
}

fn reread_glb(bytes: &[u8]) -> Model {
    let (model, warnings) = read("x.glb", bytes, &(), &Limits::default()).unwrap();
    assert_eq!(warnings.iter().filter(|w| !w.is_minor()).collect::<Vec<_>>(), [] as [&limn_formats::Warning; 0]);
    model
}

const POINTS: [[f32; 3]; 6] =
    [[0., 0., -0.], [0.1, 0., 0.], [1.5, 1e-7, 3e20], [0., 1., 0.], [-2., 123456.79, 0.33333334], [7., 8., 9.]];

#[test]
fn obj_text() {
    let export = Export {
        name: "a",
        points: &POINTS,
        faces: ExportFaces::Polygons { offsets: &[0, 3, 7], corners: &[0, 1, 2, 2, 3, 4, 5] },
        ..Export::default()
    };
    let files = write_obj(&export).unwrap();
    assert_eq!(files.len(), 1);
    assert_eq!(files[0].name, "a.obj");
    assert_eq!(
        text(&files[0]),
        "v 0 0 -0\nv 0.1 0 0\nv 1.5 1e-7 3e20\nv 0 1 0\nv -2 123456.79 0.33333334\nv 7 8 9\nf 1 2 3\nf 3 4 5 6\n"
    );
}

#[test]
fn obj_with_everything() {
    let names = ["left side".to_owned(), " top\n # ".to_owned()];
    let materials = [
        Material { name: "Wood #1".into(), base_color: [0.25, 0.5, 1., 0.5], texture: Some(0), double_sided: true },
        Material { name: "unused".into(), ..Material::default() },
        Material { name: "Wood #1".into(), ..Material::default() },
    ];
    let images =
        [Image { name: "dir/wood.png".into(), mime: "image/png".into(), bytes: b"\x89PNG\r\n\x1a\n".to_vec() }];
    let normals = [[0., 0., 1.]; 6];
    let colors = [[0., 0.5, 1., 1.], [1., 1., 1., 0.5], [0.1; 4], [0.2; 4], [0.3; 4], [0.4; 4]];
    let export = Export {
        name: "a",
        origin: None,
        points: &POINTS,
        faces: ExportFaces::Triangles(&[0, 1, 2, 2, 3, 4, 3, 4, 5]),
        normals: Some(&normals),
        uv: Some((&[[0., 0.25], [1., 1.]], &[0, 1, 0, NONE, NONE, NONE, 1, 1, NONE])),
        colors: &colors,
        face_groups: &[0, 1, 0],
        group_names: &names,
        face_materials: &[0, NONE, 2],
        materials: &materials,
        images: &images,
    };
    let files = write_obj(&export).unwrap();
    assert_eq!(files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["a.obj", "a.mtl", "wood.png"]);
    let obj = text(&files[0]);
    let faces = obj.split_once("\ng ").unwrap().1;
    assert_eq!(
        faces,
        "left side\nusemtl Wood #1\nf 1/1/1 2/2/2 3/1/3\ng top  _\nusemtl \nf 3//3 4//4 5//5\ng left side\nusemtl Wood #1.2\nf 4/2/4 5/2/5 6//6\n"
    );
    assert!(obj.starts_with("mtllib a.mtl\nv 0 0 -0 0 0.7353569831 1\nv 0.1 0 0 1 1 1 0.5\n"), "{obj}");
    assert_eq!(
        text(&files[1]),
        "newmtl Wood #1\nKd 0.5370987305 0.7353569831 1\nd 0.5\nmap_Kd wood.png\nnewmtl Wood #1.2\nKd 1 1 1\nd 1\n"
    );
    let model = reread(&files);
    assert_eq!(model.soup.colors, colors);
    assert_eq!(model.materials[0].base_color, [0.25, 0.5, 1., 0.5]);
    assert_eq!(model.images[0].bytes, images[0].bytes);
    assert_eq!(model.soup.uv_corners, [0, 1, 0, NONE, NONE, NONE, 1, 1, NONE]);
    assert_eq!(model.soup.face_materials, [0, NONE, 1]);
    assert_eq!(model.groups, ["left side", "top  _"]);
}

/// The JSON of a GLB.
fn json(glb: &[u8]) -> serde_json::Value {
    let size = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + size]).unwrap()
}

#[test]
fn glb_as_another_reader_sees_it() {
    let normals = [[0., 0., 2.]; 6];
    let points = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [-1., 1., 0.5], [-1., 0., -0.1]];
    let export = Export {
        name: "quote \" here",
        points: &points,
        faces: ExportFaces::Quads(&[0, 1, 2, 3, 0, 3, 4, 5]),
        normals: Some(&normals),
        ..Export::default()
    };
    let bytes = write_glb(&export).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let mesh = file.meshes().next().unwrap();
    assert_eq!(mesh.name(), Some("quote \" here"));
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(blob));
    let positions: Vec<_> = reader.read_positions().unwrap().collect();
    assert_eq!(positions, points);
    assert_eq!(reader.read_normals().unwrap().collect::<Vec<_>>(), [[0., 0., 1.]; 6]);
    assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), [0, 1, 2, 0, 2, 3, 3, 4, 5, 3, 5, 0]);
    let bounds = primitive.bounding_box();
    assert_eq!((bounds.min, bounds.max), ([-1., 0., -0.1], [1., 1., 0.5]));
    let json = json(&bytes);
    assert_eq!(json["extensionsUsed"], serde_json::json!(["FB_ngon_encoding"]));
    for view in json["bufferViews"].as_array().unwrap() {
        assert_eq!(view["byteOffset"].as_u64().unwrap() % 4, 0);
    }
    // Triangles alone need no encoding.
    let triangles = Export { faces: ExportFaces::Triangles(&[0, 1, 2, 0, 2, 3]), ..export };
    assert_eq!(self::json(&write_glb(&triangles).unwrap()).get("extensionsUsed"), None);
}

#[test]
fn polygons_survive_glb() {
    // A concave arrow, whose only good fans start at 2 and 0, beside faces that share their first vertices.
    let points = [[0., 0., 0.], [2., 2., 0.], [0., 1., 0.], [-2., 2., 0.], [0., 5., 0.]];
    let faces: [&[u32]; 5] = [&[0, 1, 2], &[1, 2, 3, 0], &[0, 1, 4, 3], &[0, 1, 2, 3], &[0, 1, 4, 3, 2]];
    let soup = Soup::from_faces(points.to_vec(), &faces);
    let model = Model { soup, ..Model::default() };
    let back = reread_glb(&write_glb(&Export::from_model(&model)).unwrap());
    let read: Vec<&[u32]> = (0..back.soup.face_count()).map(|f| back.soup.face(f)).collect();
    let expected: [&[u32]; 5] = [&[0, 1, 2], &[2, 3, 0, 1], &[0, 1, 4, 3], &[2, 3, 0, 1], &[4, 3, 2, 0, 1]];
    assert_eq!(read[0], expected[0]);
    for (face, (read, original)) in read.iter().zip(faces).enumerate() {
        let turn = original.iter().position(|v| *v == read[0]).unwrap();
        let turned: Vec<u32> = (0..original.len()).map(|i| original[(i + turn) % original.len()]).collect();
        assert_eq!(*read, turned, "face {face}");
        assert!(face == 0 || read[0] != back.soup.face(face - 1)[0], "face {face} starts as the one before");
    }
    // The concave ones fan from a corner that sees all others.
    assert_eq!((read[1][0], read[3][0]), (2, 2), "{read:?}");
}

#[test]
fn glb_splits_vertices_at_seams_only() {
    let uv = [[0., 0.], [0.5, 0.], [0.5, 0.5], [0.25, 0.75], [1., 1.], [0.5, 0.5]];
    let export = Export {
        points: &POINTS[..4],
        faces: ExportFaces::Triangles(&[0, 1, 2, 0, 2, 3]),
        uv: Some((&uv, &[0, 1, 2, 4, 5, 3])),
        ..Export::default()
    };
    let model = reread_glb(&write_glb(&export).unwrap());
    // Point 0 has two texture coordinates; those of point 2 are equal though numbered apart.
    assert_eq!(model.soup.positions[..4], POINTS[..4]);
    assert_eq!(model.soup.positions[4..], [POINTS[0]]);
    assert_eq!(model.soup.corners, [0, 1, 2, 4, 2, 3]);
    assert_eq!(model.soup.uvs, [[0., 0.], [0.5, 0.], [0.5, 0.5], [0.25, 0.75], [1., 1.]]);
    assert_eq!(model.soup.uv_corners, [0, 1, 2, 4, 2, 3]);
}

#[test]
fn glb_groups_and_materials() {
    let names = ["one".to_owned(), "two".to_owned()];
    let materials = [
        Material { name: "a".into(), base_color: [0.1, 0.2, 0.3, 0.4], texture: Some(1), double_sided: false },
        Material { name: "b".into(), ..Material::default() },
    ];
    let images = [
        Image { name: "x".into(), mime: "image/bmp".into(), bytes: b"BM".to_vec() },
        Image { name: "y".into(), mime: "image/webp".into(), bytes: b"RIFF0000WEBPxx".to_vec() },
    ];
    let export = Export {
        points: &POINTS,
        faces: ExportFaces::Triangles(&[0, 1, 2, 2, 3, 4, 3, 4, 5]),
        uv: Some((&[[0.5, 0.5]], &[0; 9])),
        colors: &[[0.25; 4]; 6],
        face_groups: &[1, 0, 1],
        group_names: &names,
        face_materials: &[0, 1, NONE],
        materials: &materials,
        images: &images,
        ..Export::default()
    };
    let model = reread_glb(&write_glb(&export).unwrap());
    assert_eq!(model.soup.positions, POINTS);
    assert_eq!(model.groups, names);
    assert_eq!(model.soup.corners, [2, 3, 4, 0, 1, 2, 3, 4, 5]);
    assert_eq!(model.soup.face_groups, [0, 1, 1]);
    assert_eq!(model.soup.face_materials, [0, 1, NONE]);
    assert_eq!(model.materials[0], materials[1]);
    assert_eq!(model.materials[1], Material { texture: Some(0), ..materials[0].clone() });
    assert_eq!(model.images, [images[1].clone()]);
    assert_eq!(model.soup.colors, [[0.25; 4]; 6]);
}

#[test]
fn what_cannot_be_written() {
    let base = Export { points: &POINTS, faces: ExportFaces::Triangles(&[0, 1, 2]), ..Export::default() };
    let both = |export: Export<'_>| {
        let (obj, glb) = (write_obj(&export).unwrap_err(), write_glb(&export).unwrap_err());
        assert_eq!(obj, glb);
        obj.to_string()
    };
    let corner = Export { faces: ExportFaces::Triangles(&[0, 1, 6]), ..base };
    assert_eq!(both(corner), "The model cannot be written because a face uses a point that is not there.");
    let offsets = Export { faces: ExportFaces::Polygons { offsets: &[0, 4], corners: &[0, 1, 2] }, ..base };
    assert_eq!(both(offsets), "The model cannot be written because the face offsets do not fit the corners.");
    let normals = Export { normals: Some(&[[0., 0., 1.]]), ..base };
    assert_eq!(both(normals), "The model cannot be written because there is not one normal or colour for each point.");
    let uv = Export { uv: Some((&[[0., 0.]], &[0, 0, 1])), ..base };
    assert_eq!(both(uv), "The model cannot be written because the texture coordinates do not fit the corners.");
    let none = Export { faces: ExportFaces::default(), ..base };
    assert_eq!(write_glb(&none), Err(WriteError::Inconsistent { what: "it has no faces" }));
    let nan = Export { points: &[[f32::NAN; 3], [0.; 3], [1.; 3]], ..base };
    assert_eq!(write_glb(&nan), Err(WriteError::Inconsistent { what: "a point is not a finite number" }));
}
