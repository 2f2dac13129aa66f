//! glTF by hand: small files put together here, each checking the values that come out, or the exact sentence.

use std::collections::BTreeMap;

use limn_formats::{Limits, Model, ReadError, Warning, read};
use limn_mesh::{Weld, soup::NONE};
use serde_json::{Value, json};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\nrest";

/// A file under construction: one buffer, a view for each accessor.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    primitives: Vec<Value>,
    /// Merged into the root at the end.
    more: Value,
}

impl File {
    fn bytes(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        self.views.len() - 1
    }

    fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8], more: Value) -> usize {
        let view = self.bytes(bytes);
        let mut value = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        merge(&mut value, more);
        self.accessors.push(value);
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = kind[3..].parse().unwrap_or(1);
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(5126, kind, values.len() / width, &bytes, json!({}))
    }

    fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(5123, "SCALAR", values.len(), &bytes, json!({}))
    }

    /// The unit square's corners 0 1 2 3, counter-clockwise.
    fn square(&mut self) -> usize {
        self.floats("VEC3", &[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.])
    }

    /// The square as two triangles.
    fn two_triangles() -> File {
        let mut file = File::default();
        let (positions, indices) = (file.square(), file.indices(&[0, 1, 2, 0, 2, 3]));
        file.primitives.push(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        file
    }

    fn root(&self, buffer: Value) -> Value {
        let mut root = json!({
            "asset": {"version": "2.0"},
            "buffers": [buffer],
            "bufferViews": self.views,
            "accessors": self.accessors,
            "meshes": [{"primitives": self.primitives}],
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}],
            "scene": 0,
        });
        merge(&mut root, self.more.clone());
        root
    }

    fn with(mut self, more: Value) -> File {
        self.more = more;
        self
    }

    fn gltf(&self) -> Vec<u8> {
        self.root(json!({"uri": "My%20Data.bin", "byteLength": self.bin.len()})).to_string().into_bytes()
    }

    fn glb(&self) -> Vec<u8> {
        glb(self.root(json!({"byteLength": self.bin.len()})).to_string().as_bytes(), Some(&self.bin))
    }

    fn try_read(&self) -> Result<(Model, Vec<Warning>), ReadError> {
        let files: BTreeMap<String, Vec<u8>> =
            [("my data.bin".to_owned(), self.bin.clone()), ("Pic.png".to_owned(), PNG.to_vec())].into();
        let one = read("dir/a.gltf", &self.gltf(), &files, &Limits::default());
        let two = read("dir/a.glb", &self.glb(), &files, &Limits::default());
        match (&one, &two) {
            (Err(one), Err(two)) => {
                assert_eq!(one.to_string().replace("gltf", "glb"), two.to_string().replace("gltf", "glb"))
            }
            _ => assert_eq!(one, two),
        }
        one
    }

    fn read(&self) -> (Model, Vec<String>) {
        let (model, warnings) = self.try_read().expect("reads");
        (model, warnings.iter().map(ToString::to_string).collect())
    }

    fn quiet(&self) -> Model {
        let (model, warnings) = self.read();
        assert_eq!(warnings, [""; 0]);
        model
    }

    fn fails(&self) -> String {
        self.try_read().expect_err("must fail").to_string()
    }
}

fn merge(value: &mut Value, more: Value) {
    if let (Value::Object(value), Value::Object(more)) = (value, more) {
        value.extend(more);
    }
}

fn glb(json: &[u8], bin: Option<&[u8]>) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk, pad) in [(b"JSON", Some(json), b' '), (b"BIN\0", bin, 0)] {
        let Some(chunk) = chunk else { continue };
        let size = chunk.len().next_multiple_of(4);
        out.extend((size as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
        out.resize(out.len().next_multiple_of(4), pad);
    }
    let length = (out.len() as u32).to_le_bytes();
    out[8..12].copy_from_slice(&length);
    out
}

const SQUARE: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

#[test]
fn two_triangles() {
    let model = File::two_triangles().quiet();
    assert_eq!(model.name, "a");
    assert_eq!(model.soup.positions, SQUARE);
    assert_eq!(model.soup.corners, [0, 1, 2, 0, 2, 3]);
    assert_eq!(model.soup.offsets, [0, 3, 6]);
    assert_eq!((model.weld, model.triangulated), (Weld::Exact, true));
    assert!(model.soup.parts.is_empty());
    assert!(model.groups.is_empty() && model.soup.uvs.is_empty() && model.soup.face_materials.is_empty());
}

#[test]
fn every_mode_that_has_faces() {
    for (mode, indices, corners) in [
        (4, Some(&[0, 1, 2, 2, 3, 0][..]), &[0, 1, 2, 2, 3, 0][..]),
        (5, Some(&[0, 1, 3, 2]), &[0, 1, 3, 1, 2, 3]),
        (6, Some(&[0, 1, 2, 3]), &[0, 1, 2, 0, 2, 3]),
        (6, None, &[0, 1, 2, 0, 2, 3]),
        (5, None, &[0, 1, 2, 1, 3, 2]),
    ] {
        let mut file = File::default();
        let mut primitive = json!({"attributes": {"POSITION": file.square()}, "mode": mode});
        if let Some(indices) = indices {
            primitive["indices"] = file.indices(indices).into();
        }
        file.primitives = vec![primitive];
        assert_eq!(file.quiet().soup.corners, corners, "mode {mode}");
    }
    let mut file = File::two_triangles();
    for mode in 0..4 {
        file.primitives.push(json!({"attributes": {"POSITION": 0}, "mode": mode}));
    }
    assert_eq!(file.read().1, ["4 primitives of points or lines (first meshes[0].primitives[1]) are not used."]);
    file.primitives.push(json!({"attributes": {"POSITION": 0}, "mode": 9}));
    assert_eq!(file.fails(), "meshes[0].primitives[5]: its mode is none that glTF has.");
}

#[test]
fn leftover_indices() {
    let mut file = File::default();
    let (positions, indices) = (file.square(), file.indices(&[0, 1, 2, 3]));
    file.primitives.push(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let (model, warnings) = file.read();
    assert_eq!(model.soup.corners, [0, 1, 2]);
    assert_eq!(
        warnings,
        [
            "1 primitive with leftover indices that make no triangle (first meshes[0].primitives[0]) is cut to whole triangles."
        ]
    );
}

#[test]
fn polygons_by_their_encoding() {
    let mut file = File::default();
    let positions = file.square();
    let indices = file.indices(&[0, 1, 2, 0, 2, 3, 1, 2, 3]);
    let extension = json!({"FB_ngon_encoding": {}});
    file.primitives.push(json!({"attributes": {"POSITION": positions}, "indices": indices, "extensions": extension}));
    let model = file.with(json!({"extensionsUsed": ["FB_ngon_encoding"]})).quiet();
    assert_eq!(model.soup.corners, [0, 1, 2, 3, 1, 2, 3]);
    assert_eq!(model.soup.offsets, [0, 4, 7]);
    assert!(!model.triangulated);
}

#[test]
fn transforms_and_instances() {
    let turn = std::f64::consts::FRAC_1_SQRT_2;
    let file = File::two_triangles().with(json!({
        "nodes": [
            {"children": [1, 2], "translation": [10, 0, 0], "scale": [2, 2, 2], "name": "unused"},
            {"mesh": 0, "rotation": [0, 0, turn, turn], "name": "turned"},
            {"mesh": 0, "matrix": [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 5, 1], "name": "mirrored"},
            {"mesh": 0, "name": "outside the scene"},
        ],
    }));
    let model = file.quiet();
    let close = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-6)
    };
    assert!(close(&model.soup.positions[..4], &[[10., 0., 0.], [10., 2., 0.], [8., 2., 0.], [8., 0., 0.]]));
    assert!(close(&model.soup.positions[4..], &[[10., 0., 10.], [8., 0., 10.], [8., 2., 10.], [10., 2., 10.]]));
    // The mirrored faces are turned round.
    assert_eq!(model.soup.corners, [0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6]);
    assert_eq!(model.groups, ["turned", "mirrored"]);
    assert_eq!(model.soup.face_groups, [0, 0, 1, 1]);
    // Objects that touch are not welded together.
    assert_eq!(model.soup.parts, [0, 0, 0, 0, 1, 1, 1, 1]);
}

#[test]
fn instancing_extension() {
    let mut file = File::two_triangles();
    let move_to = file.floats("VEC3", &[0., 0., 0., 0., 0., 7.]);
    let scale = file.floats("VEC3", &[1., 1., 1., -2., 1., 1.]);
    let extension = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": move_to, "SCALE": scale}}});
    let file = file.with(json!({
        "nodes": [{"mesh": 0, "extensions": extension, "translation": [1, 0, 0]}],
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
    }));
    let model = file.quiet();
    assert_eq!(model.soup.positions[..2], [[1., 0., 0.], [2., 0., 0.]]);
    assert_eq!(model.soup.positions[4..6], [[1., 0., 7.], [-1., 0., 7.]]);
    assert_eq!(model.soup.corners[6..], [4, 6, 5, 4, 7, 6]);
}

#[test]
fn without_nodes_or_scenes() {
    let mut file = File::two_triangles().with(json!({"nodes": [], "scenes": [], "scene": null}));
    assert_eq!(file.fails(), "The file: its scene is not a whole number.");
    file.more["scene"] = 0.into();
    assert_eq!(file.fails(), "The file: its scene is 0, but the file has only 0.");
    let root = |file: &File| {
        let mut root = file.root(json!({"byteLength": file.bin.len()}));
        root.as_object_mut().unwrap().retain(|k, _| !matches!(k.as_str(), "scene" | "scenes"));
        glb(root.to_string().as_bytes(), Some(&file.bin))
    };
    let (model, _) = read("a.glb", &root(&file), &(), &Limits::default()).unwrap();
    assert_eq!(model.soup.positions, SQUARE);
    // Root nodes are those that are no child.
    file.more = json!({"nodes": [{"mesh": 0}, {"children": [0], "translation": [0, 0, 3]}]});
    let (model, _) = read("a.glb", &root(&file), &(), &Limits::default()).unwrap();
    assert_eq!(model.soup.positions[2], [1., 1., 3.]);
    assert_eq!(model.soup.face_count(), 2);
}

#[test]
fn several_primitives_share_what_they_share() {
    let mut file = File::default();
    let (square, other) = (file.square(), file.floats("VEC3", &[5., 0., 0., 6., 0., 0., 6., 1., 0.]));
    let (a, b) = (file.indices(&[0, 1, 2]), file.indices(&[0, 2, 3]));
    file.primitives = vec![
        json!({"attributes": {"POSITION": square}, "indices": a, "material": 1}),
        json!({"attributes": {"POSITION": other}}),
        json!({"attributes": {"POSITION": square}, "indices": b, "material": 1}),
    ];
    let model = file.with(json!({"materials": [{"name": "no"}, {"name": "yes", "doubleSided": true}]})).quiet();
    assert_eq!(model.soup.positions.len(), 7);
    assert_eq!(model.soup.corners, [0, 1, 2, 4, 5, 6, 0, 2, 3]);
    assert_eq!(model.soup.face_materials, [0, NONE, 0]);
    assert_eq!(model.materials.len(), 1);
    assert_eq!((model.materials[0].name.as_str(), model.materials[0].double_sided), ("yes", true));
}

#[test]
fn sparse_accessors() {
    let mut file = File::two_triangles();
    let (at, values) = (file.bytes(&[3, 1]), file.bytes(&[9f32, 8., 7., 6., 5., 4.].map(f32::to_le_bytes).concat()));
    let sparse = |count: usize| json!({"count": count, "indices": {"bufferView": at, "componentType": 5121}, "values": {"bufferView": values}});
    file.accessors[0]["sparse"] = sparse(2);
    let expected = [[0., 0., 0.], [6., 5., 4.], [1., 1., 0.], [9., 8., 7.]];
    assert_eq!(file.quiet().soup.positions, expected);
    // On top of zeros.
    file.accessors[0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(file.quiet().soup.positions, [[0.; 3], [6., 5., 4.], [0.; 3], [9., 8., 7.]]);
    file.accessors[0]["sparse"] = sparse(3);
    assert_eq!(file.fails(), format!("accessors[0].sparse: its 3 elements need 3 bytes, but bufferViews[{at}] has 2."));
    file.accessors[0]["sparse"] = sparse(5);
    assert_eq!(file.fails(), "accessors[0].sparse: it replaces 5 elements of 4.");
    file.accessors[0]["sparse"] = sparse(1);
    file.bin[file.views[at]["byteOffset"].as_u64().unwrap() as usize] = 4;
    assert_eq!(file.fails(), "accessors[0].sparse: it replaces element 4, but there are only 4.");
}

#[test]
fn quantised_attributes() {
    let cases: [(u32, bool, Vec<u8>, [f32; 3]); 8] = [
        (5120, false, [5i8, -128, 127].map(|v| v as u8).to_vec(), [5., -128., 127.]),
        (5120, true, [0i8, -128, 127].map(|v| v as u8).to_vec(), [0., -1., 1.]),
        (5121, false, vec![0, 7, 255], [0., 7., 255.]),
        (5121, true, vec![0, 51, 255], [0., 0.2, 1.]),
        (5122, false, [1i16, -32768, 32767].map(i16::to_le_bytes).concat(), [1., -32768., 32767.]),
        (5122, true, [0i16, -32768, 32767].map(i16::to_le_bytes).concat(), [0., -1., 1.]),
        (5123, false, [0u16, 300, 65535].map(u16::to_le_bytes).concat(), [0., 300., 65535.]),
        (5123, true, [0u16, 13107, 65535].map(u16::to_le_bytes).concat(), [0., 0.2, 1.]),
    ];
    for (component, normalized, element, expected) in cases {
        let mut file = File::default();
        // Elements are padded to four bytes, as the specification asks.
        let stride = element.len().next_multiple_of(4);
        let mut bytes = Vec::new();
        for _ in 0..3 {
            bytes.extend(&element);
            bytes.resize(bytes.len().next_multiple_of(4), 99);
        }
        let positions = file.accessor(component, "VEC3", 3, &bytes, json!({"normalized": normalized}));
        file.views[0]["byteStride"] = stride.into();
        file.primitives.push(json!({"attributes": {"POSITION": positions}}));
        let model = file.with(json!({"extensionsRequired": ["KHR_mesh_quantization"]})).quiet();
        assert_eq!(model.soup.positions, [expected; 3], "{component} {normalized}");
    }
}

#[test]
fn colours_stay_linear() {
    for (component, kind, bytes, expected) in [
        (5126, "VEC3", [0.25f32, 0.5, 1.0].map(f32::to_le_bytes).concat(), [0.25, 0.5, 1., 1.]),
        (5126, "VEC4", [0.25f32, 0.5, 1.0, 0.5].map(f32::to_le_bytes).concat(), [0.25, 0.5, 1., 0.5]),
        (5121, "VEC4", vec![51, 0, 255, 102], [0.2, 0., 1., 0.4]),
        (5123, "VEC4", [13107u16, 0, 65535, 26214].map(u16::to_le_bytes).concat(), [0.2, 0., 1., 0.4]),
    ] {
        let mut file = File::two_triangles();
        let color = file.accessor(component, kind, 4, &bytes.repeat(4), json!({"normalized": component != 5126}));
        file.primitives[0]["attributes"]["COLOR_0"] = color.into();
        assert_eq!(file.quiet().soup.colors, [expected; 4], "{component} {kind}");
        // A second surface without colours.
        let plain = file.floats("VEC3", &[0.; 9]);
        file.primitives.push(json!({"attributes": {"POSITION": plain}}));
        let (model, warnings) = file.read();
        assert_eq!(model.soup.colors[4..], [[1.; 4]; 3]);
        assert_eq!(warnings, ["3 vertices without a colour in a coloured file are read as white."]);
    }
}

#[test]
fn materials_and_pictures() {
    let mut file = File::two_triangles();
    let picture = file.bytes(PNG);
    let uv = file.floats("VEC2", &[0., 0., 1., 0., 1., 0.75, 0., 0.75]);
    file.primitives[0]["material"] = 0.into();
    file.primitives[0]["attributes"]["TEXCOORD_0"] = uv.into();
    for (image, name) in [
        (json!({"bufferView": picture, "mimeType": "image/png", "name": "inside"}), "inside"),
        (json!({"uri": "sub/pic.png"}), "Pic.png"),
        (json!({"uri": "data:image/png;base64,iVBORw0KGgpyZXN0"}), ""),
    ] {
        file.more = json!({
            "images": [image], "textures": [{"source": 0}],
            "materials": [{"name": "m", "alphaMode": "BLEND", "pbrMetallicRoughness": {
                "baseColorFactor": [0.25, 0.5, 1, 0.5], "baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        });
        let model = file.quiet();
        assert_eq!(model.materials[0].base_color, [0.25, 0.5, 1., 0.5]);
        assert_eq!(model.materials[0].texture, Some(0));
        assert!(!model.materials[0].double_sided);
        assert_eq!((model.images[0].name.as_str(), model.images[0].mime.as_str()), (name, "image/png"));
        assert_eq!(model.images[0].bytes, PNG);
        // v counts up.
        assert_eq!(model.soup.uvs, [[0., 1.], [1., 1.], [1., 0.25], [0., 0.25]]);
        assert_eq!(model.soup.uv_corners, [0, 1, 2, 0, 2, 3]);
    }
    file.more["images"] = json!([{"uri": "no%20such.png"}]);
    file.more["materials"][0]["alphaMode"] = "OPAQUE".into();
    let (model, warnings) = file.read();
    assert_eq!(warnings, ["1 picture (no such.png) is missing, so its surface shows without it."]);
    assert_eq!((model.materials[0].texture, model.materials[0].base_color), (None, [0.25, 0.5, 1., 1.]));
    file.more["images"] = json!([{"uri": "data:,what"}]);
    assert_eq!(file.read().1, ["1 picture in a format that browsers do not show (images[0]) is left out."]);
}

#[test]
fn moved_textures_and_other_coordinate_sets() {
    let mut file = File::two_triangles();
    let zero = file.floats("VEC2", &[9.; 8]);
    let one = file.accessor(
        5123,
        "VEC2",
        4,
        &[0u16, 0, 65535, 0, 65535, 65535, 0, 65535].map(u16::to_le_bytes).concat(),
        json!({"normalized": true}),
    );
    file.primitives[0]["material"] = 0.into();
    file.primitives[0]["attributes"]["TEXCOORD_0"] = zero.into();
    file.primitives[0]["attributes"]["TEXCOORD_1"] = one.into();
    let quarter = std::f64::consts::FRAC_PI_2;
    let transform = json!({"offset": [0.5, 0.25], "rotation": quarter, "scale": [2, 4], "texCoord": 1});
    let info = json!({"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": transform}});
    file.more = json!({
        "images": [{"uri": "Pic.png"}], "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": info}}],
    });
    let (model, warnings) = file.read();
    // Turned counter-clockwise as seen with v down: (u, v) -> (v, -u) after scaling.
    let down = [[0.5, 0.25], [0.5, -1.75], [4.5, -1.75], [4.5, 0.25]];
    for (uv, [u, v]) in model.soup.uvs.iter().zip(down) {
        assert!((uv[0] - u).abs() < 1e-6 && (uv[1] - (1.0 - v)).abs() < 1e-6, "{uv:?}");
    }
    assert_eq!(
        warnings,
        [
            "1 vertex attribute other than position, colour and first texture coordinate (such as TEXCOORD_0) is not used."
        ]
    );
}

#[test]
fn specular_glossiness_stands_in() {
    let mut file = File::two_triangles();
    file.primitives[0]["material"] = 0.into();
    let old = json!({"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 0, 1]}});
    let file = file.with(json!({"materials": [{"extensions": old}]}));
    assert_eq!(file.quiet().materials[0].base_color, [0.5, 0.25, 0., 1.]);
}

#[test]
fn what_is_not_used_is_said() {
    let mut file = File::two_triangles();
    let attributes = &mut file.primitives[0]["attributes"];
    attributes["NORMAL"] = 0.into();
    attributes["JOINTS_0"] = 0.into();
    attributes["_HEAT"] = 0.into();
    file.primitives[0]["targets"] = json!([{"POSITION": 0}, {"POSITION": 0}]);
    file.primitives[0]["material"] = 0.into();
    let primitive = file.primitives[0].clone();
    let file = file.with(json!({
        "meshes": [{"primitives": [primitive]}, {"primitives": []}],
        "materials": [{"normalTexture": {"index": 0}, "extensions": {"KHR_materials_clearcoat": {}}}],
        "animations": [{}], "cameras": [{}, {}], "skins": [{}],
        "extensions": {"KHR_lights_punctual": {"lights": [{}]}},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_clearcoat", "ACME_gizmo"],
    }));
    assert_eq!(
        file.read().1,
        [
            "1 skin is not used: the model is shown in its bind pose.",
            "2 morph targets are not used.",
            "1 animation is not used.",
            "2 cameras are not used.",
            "1 light is not used.",
            "2 optional extensions (ACME_gizmo, KHR_materials_clearcoat) are not used.",
            "1 mesh outside the scene that is shown is not used.",
            "4 normals are not used because Limn computes its own.",
            "2 material settings other than base colour are not used.",
            "1 vertex attribute other than position, colour and first texture coordinate (such as _HEAT) is not used.",
        ]
    );
}

#[test]
fn broken_extras_do_not_cost_the_shape() {
    for broken in [json!(99), json!("x"), json!(1)] {
        let mut file = File::two_triangles();
        file.primitives[0]["attributes"]["COLOR_0"] = broken.clone();
        let (model, warnings) = file.read();
        assert_eq!(model.soup.positions, SQUARE);
        assert!(model.soup.colors.is_empty());
        assert_eq!(
            warnings,
            [format!(
                "1 vertex attribute that breaks the rules of glTF (first COLOR_0 {broken} of meshes[0].primitives[0]) is left out."
            )]
        );
    }
}

#[test]
fn small_offences_do_not_cost_the_shape() {
    let mut file = File::two_triangles();
    file.accessors[0]["name"] = 7.into();
    file.accessors[0]["count"] = 4.0.into();
    file.accessors[0]["extensions"] = json!([]);
    file.accessors[0]["max"] = "none".into();
    file.views[1]["target"] = "elements".into();
    file.primitives[0]["indices"] = 1.0.into();
    file.primitives[0]["extras"] = json!(["anything"]);
    // Not needed, so what is wrong with them does not matter.
    file.primitives.push(json!({"mode": 1, "attributes": {"POSITION": "x"}, "indices": "x", "material": "x"}));
    file.primitives.push(json!({"attributes": {"NORMAL": 0}, "indices": "x", "material": 1e300}));
    file.accessors.push(json!({"count": "many"}));
    file.views.push(json!("a view"));
    let pointer = json!({"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": []});
    let file = file.with(json!({
        "scenes": [{"nodes": [0.0]}, {"name": "empty"}], "scene": 0.0,
        "nodes": [{"mesh": 0.0, "skin": -1, "camera": "front", "weights": {}, "children": 5}, {"mesh": 99}],
        "materials": [{"alphaMode": 5}], "cameras": [{"type": "none"}], "animations": [pointer], "samplers": [[]],
        "extensions": [], "extras": 1,
    }));
    let (model, warnings) = file.read();
    assert_eq!(
        (model.soup.positions.as_slice(), model.soup.corners.as_slice()),
        (&SQUARE[..], &[0, 1, 2, 0, 2, 3][..])
    );
    assert_eq!(
        warnings,
        [
            "1 primitive of points or lines (first meshes[0].primitives[1]) is not used.",
            "1 primitive without positions (first meshes[0].primitives[2]) is left out.",
            "1 animation is not used.",
            "1 camera is not used.",
        ]
    );
}

#[test]
fn numbers_past_32_bits_are_not_cut_off() {
    let past = |n: u64| json!((1u64 << 32) + n);
    let change = |edit: &dyn Fn(&mut File)| {
        let mut file = File::two_triangles();
        edit(&mut file);
        file.fails()
    };
    assert_eq!(
        change(&|f| f.accessors[0]["bufferView"] = past(0)),
        "accessors[0]: its bufferView is 4294967296, which is more than 32 bits can number."
    );
    assert_eq!(
        change(&|f| f.primitives[0]["attributes"]["POSITION"] = past(0)),
        "meshes[0].primitives[0]: its POSITION is 4294967296, which is more than 32 bits can number."
    );
    assert_eq!(
        change(&|f| f.primitives[0]["mode"] = past(4)),
        "meshes[0].primitives[0]: its mode is 4294967300, which is more than 32 bits can number."
    );
    assert_eq!(
        change(&|f| f.more = json!({"nodes": [{"mesh": past(0)}]})),
        "nodes[0]: its mesh is 4294967296, which is more than 32 bits can number."
    );
    // Byte counts may be as large.
    assert_eq!(
        change(&|f| f.views[0]["byteLength"] = past(48)),
        "bufferViews[0]: its 4294967344 bytes from byte 0 lie outside buffer 0, which has 60."
    );
}

#[test]
fn attribute_names_are_taken_literally() {
    let mut file = File::two_triangles();
    for name in ["TEXCOORD_00", "TEXCOORD_+0", "COLOR_00"] {
        file.primitives[0]["attributes"][name] = 0.into();
    }
    let (model, warnings) = file.read();
    assert!(model.soup.uvs.is_empty() && model.soup.colors.is_empty());
    assert_eq!(
        warnings,
        [
            "3 vertex attributes other than position, colour and first texture coordinate (such as COLOR_00) are not used."
        ]
    );
}

#[test]
fn transforms_keep_64_bits() {
    // Seen from the middle of the Earth; in 32 bits the step is half a unit there.
    let file = File::two_triangles().with(json!({
        "nodes": [{"children": [1], "translation": [6378137.3, 0, 0]}, {"mesh": 0, "translation": [-6378137.2, 0, 0]}],
    }));
    let [x, ..] = file.quiet().soup.positions[0];
    assert!((x - 0.1).abs() < 1e-6, "{x}");
}

#[test]
fn broken_elements_are_named() {
    let change = |edit: &dyn Fn(&mut File)| {
        let mut file = File::two_triangles();
        edit(&mut file);
        file.fails()
    };
    assert_eq!(change(&|f| f.accessors[0] = json!({})), "accessors[0]: it has no count.");
    assert_eq!(change(&|f| f.accessors[0]["type"] = 3.into()), "accessors[0]: it has no type.");
    assert_eq!(change(&|f| f.views[1] = json!([])), "bufferViews[1]: it has no buffer.");
    assert_eq!(
        change(&|f| f.accessors[1]["sparse"] = json!({"count": 1, "indices": {"bufferView": 0, "componentType": 5121}})),
        "accessors[1]: it has no values."
    );
    assert_eq!(
        change(&|f| f.primitives[0]["indices"] = json!({})),
        "meshes[0].primitives[0]: its indices is not a whole number."
    );
    assert_eq!(
        change(&|f| {
            f.primitives[0]["material"] = 0.into();
            f.more = json!({"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0]}}]});
        }),
        "materials[0]: its baseColorFactor is not a list of 4 numbers."
    );
}

#[test]
fn errors_name_the_element() {
    let change = |edit: fn(&mut File)| {
        let mut file = File::two_triangles();
        edit(&mut file);
        file.fails()
    };
    /// A change to a good file, and what is said then.
    type Case = (fn(&mut File), &'static str);
    let cases: [Case; 22] = [
        (
            |f| f.accessors[0]["count"] = 5.into(),
            "accessors[0]: its 5 elements need 60 bytes, but bufferViews[0] has 48.",
        ),
        (
            |f| f.accessors[0]["count"] = 4_000_000_000u64.into(),
            "accessors[0]: its 4000000000 elements need 48000000000 bytes, but bufferViews[0] has 48.",
        ),
        (
            |f| f.accessors[0]["byteOffset"] = u64::MAX.into(),
            "accessors[0]: its 4 elements need more than 2^64 bytes, but bufferViews[0] has 48.",
        ),
        (|f| f.accessors[0]["count"] = (-1).into(), "accessors[0]: its count is not a whole number."),
        (
            |f| f.accessors[0]["componentType"] = 5124.into(),
            "accessors[0]: its componentType is none that glTF 2.0 has.",
        ),
        (|f| f.accessors[0]["type"] = "MAT4".into(), "accessors[0]: its type is a matrix, which cannot be used here."),
        (|f| f.accessors[0]["type"] = "VEC2".into(), "accessors[0]: positions must have three components."),
        (|f| f.accessors[0]["bufferView"] = 7.into(), "accessors[0]: its bufferView is 7, but the file has only 2."),
        (
            |f| f.accessors[1]["componentType"] = 5122.into(),
            "accessors[1]: indices must be unsigned integers, one each.",
        ),
        (
            |f| f.views[0]["byteStride"] = 4.into(),
            "accessors[0]: its elements of 12 bytes do not fit the byteStride of 4.",
        ),
        (
            |f| f.views[0]["byteStride"] = 9_000_000_000_000_000_000u64.into(),
            "bufferViews[0]: its byteStride is 9000000000000000000, which is more than 32 bits can number.",
        ),
        (|f| f.views[0]["buffer"] = 1.into(), "bufferViews[0]: its buffer is 1, but the file has only 1."),
        (
            |f| f.views[0]["byteLength"] = 2_000_000_000.into(),
            "bufferViews[0]: its 2000000000 bytes from byte 0 lie outside buffer 0, which has 60.",
        ),
        (
            |f| f.primitives[0]["indices"] = 2.into(),
            "meshes[0].primitives[0]: its indices is 2, but the file has only 2.",
        ),
        (
            |f| f.primitives[0]["material"] = 0.into(),
            "meshes[0].primitives[0]: its material is 0, but the file has only 0.",
        ),
        (
            |f| f.bin[54..56].copy_from_slice(&[4, 0]),
            "accessors[1]: element 3 names vertex 4, but meshes[0].primitives[0] has only 4.",
        ),
        (
            |f| f.bin[4..8].copy_from_slice(&f32::NAN.to_le_bytes()),
            "accessors[0]: the position of element 0 is not a finite number.",
        ),
        (
            |f| f.bin[24..28].copy_from_slice(&f32::INFINITY.to_le_bytes()),
            "accessors[0]: the position of element 2 is not a finite number.",
        ),
        (
            |f| f.more = json!({"nodes": [{"mesh": 0, "scale": [1e300, 1, 1]}]}),
            "accessors[0]: the position of element 1 leaves the range of numbers when its node moves it.",
        ),
        (
            |f| f.more = json!({"nodes": [{"children": [0]}]}),
            "nodes[0]: it is reached twice, but the nodes of a scene must form a tree.",
        ),
        (
            |f| f.more = json!({"nodes": [{"children": [1.5]}]}),
            "nodes[0]: its children name node 1.5, which is not a whole number.",
        ),
        (
            |f| f.more = json!({"nodes": [{"mesh": 0, "matrix": [1, 2]}]}),
            "nodes[0]: its matrix is not a list of 16 numbers.",
        ),
    ];
    for (edit, message) in cases {
        assert_eq!(change(edit), message);
    }
}

#[test]
fn errors_of_the_whole_file() {
    let fails =
        |name: &str, bytes: &[u8]| read(name, bytes, &(), &Limits::default()).expect_err("must fail").to_string();
    let good = File::two_triangles();
    assert_eq!(
        fails("a.gltf", &good.gltf()),
        "The file My%20Data.bin is missing (a.gltf needs it): open it together with the model."
    );
    let with = |more: Value| File::two_triangles().with(more).fails();
    assert_eq!(
        with(json!({"extensionsRequired": ["KHR_draco_mesh_compression"]})),
        "The file requires the glTF extension KHR_draco_mesh_compression, which Limn does not read: export the model without Draco compression."
    );
    assert_eq!(
        with(json!({"extensionsRequired": ["EXT_meshopt_compression"]})),
        "The file requires the glTF extension EXT_meshopt_compression, which Limn does not read: export the model without meshopt compression."
    );
    assert_eq!(
        with(json!({"extensionsRequired": ["ACME_gizmo"]})),
        "The file requires the glTF extension ACME_gizmo, which Limn does not read: export the model without it."
    );
    File::two_triangles().with(json!({"extensionsRequired": ["KHR_materials_unlit"]})).quiet();
    let version = |v: Value| fails("a.gltf", json!({"asset": v}).to_string().as_bytes());
    assert_eq!(
        version(json!({"version": "1.0"})),
        "a.gltf is glTF 1.0; Limn reads glTF 2: convert it with a current exporter."
    );
    assert_eq!(
        version(json!({"version": "2.0", "minVersion": "2.1"})),
        "a.gltf is glTF 2.1; Limn reads glTF 2: convert it with a current exporter."
    );
    assert_eq!(version(json!({})), "asset: a.gltf does not state a glTF version, so it is not glTF.");
    assert_eq!(
        fails("a.gltf", br#"{"meshes": {"a": 1}}"#),
        "a.gltf is glTF 1.0; Limn reads glTF 2: convert it with a current exporter."
    );
    assert_eq!(version(json!({"version": "2.0"})), "a.gltf has no faces: it has no meshes.");
    assert_eq!(with(json!({"nodes": [{}]})), "dir/a.gltf has no faces: no node of its scene shows a mesh.");
    assert_eq!(with(json!({"meshes": [{"primitives": []}]})), "dir/a.gltf has no faces: its meshes have no triangles.");
    assert_eq!(
        fails("a.gltf", b"{\"asset\":\n  {\"version\""),
        "a.gltf is not valid JSON at line 2, column 12: EOF while parsing an object."
    );
    // The container.
    let file = good.glb();
    assert_eq!(
        fails("a.glb", &file[..10]),
        "a.glb is a damaged GLB file: it ends at byte 10 inside the header at byte 0."
    );
    let length = file.len();
    assert_eq!(
        fails("a.glb", &file[..length - 1]),
        format!("a.glb is a damaged GLB file: its header claims {length} bytes, but the file has only {}.", length - 1)
    );
    let mut huge = file.clone();
    huge[8..12].copy_from_slice(&2_000_000_000u32.to_le_bytes());
    assert_eq!(
        fails("a.glb", &huge),
        format!("a.glb is a damaged GLB file: its header claims 2000000000 bytes, but the file has only {length}.")
    );
    let mut chunk = file.clone();
    chunk[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(
        fails("a.glb", &chunk),
        format!(
            "a.glb is a damaged GLB file: the chunk at byte 12 claims 4294967295 bytes, but only {} are left.",
            length - 20
        )
    );
    let mut old = file.clone();
    old[4] = 1;
    assert_eq!(fails("a.glb", &old), "a.glb is glTF 1; Limn reads glTF 2: convert it with a current exporter.");
    let json = good.root(json!({"byteLength": 60})).to_string();
    assert_eq!(
        fails("a.glb", &glb(json.as_bytes(), None)),
        "buffers[0]: it has neither a uri nor a binary part in the file."
    );
    assert_eq!(
        fails("a.glb", &glb(json.as_bytes(), Some(&good.bin[..40]))),
        "buffers[0]: it should have 60 bytes, but only 40 are there; the file is cut short."
    );
    assert_eq!(fails("a.glb", b"OK"), "a.glb is a damaged GLB file: it does not begin with \"glTF\" or \"{\".");
}

#[test]
fn formats_are_told_by_content() {
    let fails =
        |name: &str, bytes: &[u8]| read(name, bytes, &(), &Limits::default()).expect_err("must fail").to_string();
    let glb = File::two_triangles().glb();
    assert!(read("wrong.obj", &glb, &(), &Limits::default()).is_ok());
    assert!(read("wrong.glb", b"\n v 0 0 0", &(), &Limits::default()).is_err());
    let obj = b"# no extension\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert!(read("model", obj, &(), &Limits::default()).is_ok());
    assert!(read("model.txt", obj, &(), &Limits::default()).is_ok());
    assert_eq!(
        fails("photo.jpg", b"\xff\xd8\xff\xe0"),
        "photo.jpg is in no format that Limn reads: it reads OBJ (.obj), glTF (.gltf) and binary glTF (.glb)."
    );
    assert_eq!(fails("a.glb", b""), "a.glb is empty.");
}

#[test]
fn the_memory_budget_holds() {
    let file = File::two_triangles();
    let read = |bytes| read("a.glb", &file.glb(), &(), &Limits { bytes });
    assert!(read(100_000).is_ok());
    for limit in [0, 100, 1000, 3000] {
        assert!(matches!(read(limit), Err(ReadError::TooBig { limit: l, .. }) if l == limit), "{limit}");
    }
    // Elements without properties are three bytes each in the file, and hundreds once read.
    let empty = vec![json!({}); 10_000];
    for more in [json!({"nodes": empty}), json!({"meshes": [{"primitives": empty}]})] {
        let mut root = json!({"asset": {"version": "2.0"}});
        merge(&mut root, more);
        let read = |bytes| limn_formats::read("a.gltf", root.to_string().as_bytes(), &(), &Limits { bytes });
        assert!(matches!(read(2_000_000), Err(ReadError::TooBig { .. })));
        assert!(matches!(read(10_000_000), Err(ReadError::NoFaces { .. })));
    }
    // Two billion zeros that cost the file nothing.
    let mut file = File::two_triangles();
    file.accessors[0].as_object_mut().unwrap().remove("bufferView");
    file.accessors[0]["count"] = 2_000_000_000.into();
    assert_eq!(file.fails(), "The model would need 32.1 GB of memory, more than the limit of 1 GB.");
    // Four billion instances.
    let mut file = File::two_triangles();
    file.accessors.push(json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u64}));
    let extension = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}});
    let file = file.with(json!({"nodes": [{"mesh": 0, "extensions": extension}]}));
    assert_eq!(file.fails(), "The instances would need 448.1 GB of memory, more than the limit of 1 GB.");
}

#[test]
fn references_are_listed() {
    use limn_formats::references;
    let file = File::two_triangles().with(json!({
        "images": [{"uri": "a b.png"}, {"uri": "data:image/png;base64,"}, {"bufferView": 0}, {"uri": "a b.png"}],
    }));
    assert_eq!(references("a.gltf", &file.gltf()), ["My%20Data.bin", "a b.png"]);
    assert_eq!(references("a.glb", &file.glb()), ["a b.png"]);
    let obj = b"mtllib a.mtl my b.mtl # all\nv 0 0 0\n  mtllib a.mtl\n# mtllib no.mtl\n";
    assert_eq!(references("a.obj", obj), ["a.mtl", "my b.mtl"]);
    let mtl = b"newmtl a\nmap_Kd -s 1 1 1 dir\\my pic.png\nmap_Ks no.png\nmap_Kd -clamp on 2.png";
    assert_eq!(references("a.MTL", mtl), ["dir\\my pic.png", "2.png"]);
    assert_eq!(references("a.gltf", b"{"), [""; 0]);
}
