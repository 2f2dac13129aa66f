//! Random input: nothing panics, whatever is read is consistent, and what is written reads back as the same bits.

use std::collections::BTreeMap;

use limn_formats::{Export, Limits, Model, read, write_glb, write_obj};
use limn_mesh::soup::{NONE, Soup};
use proptest::{collection::vec, prelude::*};

/// Every index of what was read must be in range.
fn check(model: &Model) {
    let s = &model.soup;
    let in_range =
        |list: &[u32], count: usize, none: bool| list.iter().all(|i| (*i as usize) < count || (none && *i == NONE));
    assert!(in_range(&s.corners, s.positions.len(), false));
    assert!(s.positions.iter().flatten().all(|c| c.is_finite()));
    assert!(s.uvs.iter().flatten().all(|c| c.is_finite()));
    assert!(s.colors.is_empty() || s.colors.len() == s.positions.len());
    assert!(s.colors.iter().flatten().all(|c| (0.0..=1.0).contains(c)));
    assert!(s.uv_corners.is_empty() || s.uv_corners.len() == s.corners.len());
    assert!(in_range(&s.uv_corners, s.uvs.len(), true));
    assert!(s.parts.is_empty() || s.parts.len() == s.positions.len());
    assert!(s.face_groups.is_empty() || s.face_groups.len() == s.face_count());
    assert!(in_range(&s.face_groups, model.groups.len(), false));
    assert!(s.face_materials.is_empty() || s.face_materials.len() == s.face_count());
    assert!(in_range(&s.face_materials, model.materials.len(), true));
    assert!(model.materials.iter().all(|m| m.texture.is_none_or(|t| (t as usize) < model.images.len())));
    assert!(s.face_count() > 0 && s.offsets.windows(2).all(|w| w[0] + 3 <= w[1]));
    assert_eq!(*s.offsets.last().unwrap() as usize, s.corners.len());
}

fn try_read(name: &str, bytes: &[u8]) {
    let files: BTreeMap<String, Vec<u8>> =
        [("a.mtl".to_owned(), bytes.to_vec()), ("a.bin".to_owned(), vec![0; 80])].into();
    match read(name, bytes, &files, &Limits { bytes: 1 << 20 }) {
        Ok((model, warnings)) => {
            check(&model);
            assert!(warnings.iter().all(|w| w.count > 0 && w.to_string().ends_with('.')));
            // What can be read can be written.
            write_obj(&Export::from_model(&model)).unwrap();
            write_glb(&Export::from_model(&model)).unwrap();
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.ends_with('.') && !text.contains('\n') && text.len() < 1000, "{text}");
        }
    }
}

const OBJ: &str = "mtllib a.mtl\nnewmtl m\nKd 1 .5 0\nmap_Kd -o 1 2 a.png\no x\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1.5e-3 0\nv -.25 1 0\nvt 0 1\nvt 1 .5\nvn 0 0 1\ng a b\nusemtl m\ns 1\nf 1/1/1 2/2/1 3/1/1 -1/-1/-1\nf 1//1 \\\n 2//1 4//1\nl 1 2\nt crease 2/1/0 0 1 2.5\nt corner 1/1/0 2 3\n# end\n";

fn gltf_text() -> String {
    let base = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,-2,3],"children":[1]},{"mesh":0,"translation":[1,2,3]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},"indices":3,"material":0,"mode":4,"extensions":{"FB_ngon_encoding":{}}}]}],"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,1,0,1],"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"rotation":1}}}}}],"textures":[{"source":0}],"images":[{"bufferView":0}],"accessors":[{"bufferView":0,"componentType":5121,"count":4,"type":"VEC3"},{"bufferView":0,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"},{"bufferView":0,"componentType":5121,"count":4,"type":"VEC4","byteOffset":8},{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":1}}}],"bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},{"buffer":0,"byteOffset":48,"byteLength":6}],"buffers":[{"byteLength":54,"uri":"URI"}]}"#;
    let data = "AAECAwQFBgcICQoLAAECAwQFBgcICQoLAAECAwQFBgcICQoLAAECAwQFBgcICQoLAAECAAID";
    base.replace("URI", &format!("data:;base64,{data}"))
}

fn glb_bytes() -> Vec<u8> {
    let soup = Soup {
        uvs: vec![[0., 0.], [1., 1.]],
        uv_corners: vec![0, 1, 0, NONE, 1, 1, 0],
        ..Soup::from_faces(
            vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 5.]],
            &[&[0, 1, 2][..], &[0, 2, 3, 1]],
        )
    };
    write_glb(&Export::from_model(&Model { soup, ..Model::default() })).unwrap()
}

#[test]
fn the_seeds_read() {
    for (name, bytes) in
        [("a.obj", OBJ.as_bytes().to_vec()), ("a.gltf", gltf_text().into_bytes()), ("a.glb", glb_bytes())]
    {
        let files: BTreeMap<String, Vec<u8>> = [("a.mtl".to_owned(), OBJ.as_bytes().to_vec())].into();
        check(&read(name, &bytes, &files, &Limits::default()).unwrap().0);
    }
}

/// Some bytes overwritten, some removed, some doubled.
fn mutate(mut bytes: Vec<u8>, edits: &[(u8, prop::sample::Index, u8, usize)], alphabet: &[u8]) -> Vec<u8> {
    for (kind, at, value, length) in edits {
        if bytes.is_empty() {
            break;
        }
        let at = at.index(bytes.len());
        let end = (at + length).min(bytes.len());
        match kind % 5 {
            0 => bytes[at] = *value,
            1 => bytes[at] = alphabet[*value as usize % alphabet.len()],
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

fn edits() -> impl Strategy<Value = Vec<(u8, prop::sample::Index, u8, usize)>> {
    vec((0u8..100, any::<prop::sample::Index>(), any::<u8>(), 0usize..20), 1..6).prop_map(|mut edits| {
        // Cutting off is rare, or little would be left.
        edits.iter_mut().for_each(|e| e.0 = if e.0 > 95 { 4 } else { e.0 % 4 });
        edits
    })
}

fn soups() -> impl Strategy<Value = Model> {
    let value = any::<f32>().prop_filter("finite", |v| v.is_finite());
    let points = vec(prop::array::uniform3(value.clone()), 1..20);
    let faces = vec((vec(any::<prop::sample::Index>(), 3..7), 0u32..3), 1..20);
    let uvs = vec(prop::array::uniform2(-8.0f32..8.0), 0..6);
    let colors = vec(prop::array::uniform4(0.0f32..=1.0), 20);
    (points, faces, uvs, colors, any::<bool>()).prop_map(|(positions, faces, uvs, colors, colored)| {
        let count = positions.len();
        let mut soup = Soup { positions, ..Soup::default() };
        for (f, (face, group)) in faces.iter().enumerate() {
            let corners: Vec<u32> = face.iter().map(|i| i.index(count) as u32).collect();
            soup.push_face(&corners);
            soup.face_groups.push(*group);
            soup.face_materials.push(if f % 3 == 0 { NONE } else { (f % 2) as u32 });
            if !uvs.is_empty() {
                let uv = |i: &prop::sample::Index| if i.index(7) == 0 { NONE } else { i.index(uvs.len()) as u32 };
                soup.uv_corners.extend(face.iter().map(uv));
            }
        }
        if soup.uv_corners.iter().any(|uv| *uv != NONE) {
            soup.uvs = uvs;
        } else {
            soup.uv_corners.clear();
        }
        if colored {
            soup.colors = colors[..count].to_vec();
        }
        let materials =
            ["a", "b"].map(|name| limn_formats::Material { name: name.into(), ..Default::default() }).to_vec();
        let groups = ["x", "y", "z"].map(str::to_owned).to_vec();
        Model { name: "m".into(), soup, groups, materials, ..Model::default() }
    })
}

fn bits<const N: usize>(list: &[[f32; N]]) -> Vec<[u32; N]> {
    list.iter().map(|v| v.map(f32::to_bits)).collect()
}

/// The names that a list of numbers stands for.
fn named<'a>(numbers: &[u32], names: &'a [String]) -> Vec<Option<&'a str>> {
    numbers.iter().map(|n| names.get(*n as usize).map(String::as_str)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in vec(any::<u8>(), 0..300)) {
        for name in ["a.obj", "a.gltf", "a.glb", "a"] {
            try_read(name, &bytes);
            try_read(name, &[b"glTF\x02\0\0\0", bytes.as_slice()].concat());
            try_read(name, &[b"{\"asset\":", bytes.as_slice()].concat());
        }
    }

    #[test]
    fn random_text(text in "([vftgo#] |vt |usemtl |[0-9]{1,3}|[-+./e\\\\ \n]|nan|\r\n){0,80}") {
        try_read("a.obj", text.as_bytes());
    }

    #[test]
    fn damaged_obj(edits in edits()) {
        try_read("a.obj", &mutate(OBJ.into(), &edits, b"0123456789/-. \n\\vf#"));
    }

    #[test]
    fn damaged_gltf(edits in edits()) {
        try_read("a.gltf", &mutate(gltf_text().into_bytes(), &edits, b"0123456789-.,:[]{}\""));
    }

    #[test]
    fn damaged_glb(edits in edits()) {
        try_read("a.glb", &mutate(glb_bytes(), &edits, b"0123456789-.,:[]{}\"\0\xff"));
    }

    /// A number anywhere in a JSON replaced by a nasty one.
    #[test]
    fn nasty_numbers(which in any::<prop::sample::Index>(), number in prop::sample::select(vec![
        "-1", "0", "1", "2", "3", "255", "65536", "4294967295", "4294967296", "18446744073709551615", "1e300", "0.5", "-0.0",
        "null", "\"x\"", "[]", "{}", "9007199254740993", "true",
    ])) {
        let text = gltf_text();
        let spots: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit()).map(|(i, _)| i)
            .filter(|i| matches!(text.as_bytes()[i - 1], b':' | b'[' | b',')).collect();
        let at = spots[which.index(spots.len())];
        let end = at + text[at..].find(|c: char| !c.is_ascii_digit()).unwrap();
        try_read("a.gltf", format!("{}{number}{}", &text[..at], &text[end..]).as_bytes());
    }

    #[test]
    fn any_float_reads_correctly_rounded(value in any::<f64>().prop_filter("finite", |v| (*v as f32).is_finite()), digits in 0usize..25) {
        for text in [format!("{value:e}"), format!("{:.digits$e}", value), format!("{:.digits$}", value as f32), format!("{}", value as f32)] {
            let Ok(want) = text.parse::<f32>() else { continue };
            prop_assume!(want.is_finite());
            let file = format!("v 0 {text} 0\nv 1 1 1\nv 1 2 3\nf 1 2 3");
            let (model, _) = read("a.obj", file.as_bytes(), &(), &Limits::default()).unwrap();
            prop_assert_eq!(model.soup.positions[0][1].to_bits(), want.to_bits(), "{}", text);
        }
    }

    /// Decimals right between two floats, and a hair beside.
    #[test]
    fn halfway_floats_read_correctly_rounded(raw in 0x0080_0000u32..0x7f00_0000, nudge in 0usize..3) {
        let (low, high) = (f64::from(f32::from_bits(raw)), f64::from(f32::from_bits(raw + 1)));
        let middle = format!("{:.40e}", (low + high) / 2.0);
        let (mantissa, exponent) = middle.split_once('e').unwrap();
        let text = format!("{mantissa}{}e{exponent}", ["", "1", "0"][nudge]);
        for text in [text, format!("{}e{exponent}", &mantissa[..19.min(mantissa.len())])] {
            let want: f32 = text.parse().unwrap();
            let file = format!("v 0 {text} 0\nv 1 1 1\nv 1 2 3\nf 1 2 3");
            let (model, _) = read("a.obj", file.as_bytes(), &(), &Limits::default()).unwrap();
            prop_assert_eq!(model.soup.positions[0][1].to_bits(), want.to_bits(), "{}", text);
        }
    }

    #[test]
    fn obj_round_trip(model in soups()) {
        let files = write_obj(&Export::from_model(&model)).unwrap();
        let others: BTreeMap<_, _> = files[1..].iter().map(|f| (f.name.clone(), f.bytes.clone())).collect();
        let (back, warnings) = read(&files[0].name, &files[0].bytes, &others, &Limits::default()).unwrap();
        prop_assert_eq!(warnings, vec![]);
        check(&back);
        let (a, b) = (&model.soup, &back.soup);
        prop_assert_eq!(bits(&a.positions), bits(&b.positions));
        prop_assert_eq!(bits(&a.colors), bits(&b.colors));
        prop_assert_eq!(bits(&a.uvs), bits(&b.uvs));
        prop_assert_eq!((&a.offsets, &a.corners, &a.uv_corners), (&b.offsets, &b.corners, &b.uv_corners));
        prop_assert_eq!(named(&a.face_groups, &model.groups), named(&b.face_groups, &back.groups));
        let names = |m: &Model| m.materials.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
        if !b.face_materials.is_empty() {
            let (one, two) = (names(&model), names(&back));
            prop_assert_eq!(named(&a.face_materials, &one), named(&b.face_materials, &two));
        }
    }

    #[test]
    fn glb_round_trip(mut model in soups()) {
        model.soup.face_groups.clear();
        model.soup.face_materials.clear();
        let (back, _) = read("m.glb", &write_glb(&Export::from_model(&model)).unwrap(), &(), &Limits::default()).unwrap();
        check(&back);
        let (a, b) = (&model.soup, &back.soup);
        let count = a.positions.len();
        prop_assert_eq!(bits(&a.positions), bits(&b.positions[..count]));
        if !a.colors.is_empty() {
            prop_assert_eq!(bits(&a.colors), bits(&b.colors[..count]));
        }
        if a.uvs.is_empty() {
            prop_assert_eq!(a.positions.len(), b.positions.len());
        }
        // Polygons that name a vertex twice in a row may run into one another; others come back whole, perhaps turned.
        let simple = |f: usize| a.face(f).iter().enumerate().all(|(i, v)| !a.face(f)[..i].contains(v));
        if (0..a.face_count()).all(simple) {
            prop_assert_eq!(a.face_count(), b.face_count());
            for f in 0..a.face_count() {
                let corners = |s: &Soup| -> Vec<_> {
                    s.face_range(f).map(|c| {
                        let uv = s.uv_corners.get(c).filter(|uv| **uv != NONE).map(|uv| s.uvs[*uv as usize]);
                        // Where there is no texture coordinate GLB has 0 0; v is counted from the other end.
                        (s.positions[s.corners[c] as usize].map(f32::to_bits), uv.map(|[u, v]| [u, 1.0 - (1.0 - v)]))
                    }).collect()
                };
                let (mut one, two) = (corners(a), corners(b));
                if !a.uvs.is_empty() {
                    one.iter_mut().for_each(|c| _ = c.1.get_or_insert([0.0, 0.0]));
                }
                let matches = (0..one.len()).any(|_| {
                    one.rotate_left(1);
                    one.iter().zip(&two).all(|(x, y)| x.0 == y.0 && match (x.1, y.1) {
                        (Some(p), Some(q)) => (p[0] - q[0]).abs() < 1e-6 && (p[1] - q[1]).abs() < 1e-5,
                        (p, q) => p == q,
                    })
                });
                prop_assert!(matches, "face {}: {:?} {:?}", f, one, two);
            }
        }
    }
}
