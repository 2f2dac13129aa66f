//! OBJ by hand: each small file checks the values that come out, or the exact sentence that is said.

use std::collections::BTreeMap;

use limn_formats::{Files, Limits, Model, ReadError, Warning, WarningKind, read};
use limn_mesh::{Weld, soup::NONE};

fn open_with(text: impl AsRef<[u8]>, files: &dyn Files) -> Result<(Model, Vec<Warning>), ReadError> {
    read("folder/my model.obj", text.as_ref(), files, &Limits::default())
}

fn open(text: impl AsRef<[u8]>) -> (Model, Vec<Warning>) {
    open_with(text, &()).expect("reads")
}

fn quiet(text: impl AsRef<[u8]>) -> Model {
    let (model, warnings) = open(text);
    assert_eq!(warnings, []);
    model
}

fn fails(text: impl AsRef<[u8]>) -> String {
    open_with(text, &()).expect_err("must fail").to_string()
}

fn says(text: impl AsRef<[u8]>) -> Vec<String> {
    open(text).1.iter().map(ToString::to_string).collect()
}

fn files(list: &[(&str, &[u8])]) -> BTreeMap<String, Vec<u8>> {
    list.iter().map(|(n, b)| (n.to_string(), b.to_vec())).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\nrest";

#[test]
fn square() {
    let model = quiet(format!("{SQUARE}f 1 2 3 4\n"));
    assert_eq!(model.name, "my model");
    assert_eq!(model.soup.positions, [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    assert_eq!((&model.soup.offsets[..], &model.soup.corners[..]), (&[0, 4][..], &[0, 1, 2, 3][..]));
    assert_eq!(model.weld, Weld::Off);
    assert!(!model.triangulated && model.groups.is_empty() && model.soup.face_groups.is_empty());
    assert!(model.materials.is_empty() && model.soup.face_materials.is_empty() && model.soup.uvs.is_empty());
}

#[test]
fn every_index_form() {
    let vt = "vt 0 0\nvt 1 0\nvt 1 1\n";
    for (face, corners, uvs) in [
        ("f 1 2 3", [0, 1, 2], [NONE; 3]),
        ("f 2/1 3/2 4/3", [1, 2, 3], [0, 1, 2]),
        ("f 2/3/1 3/2/9 4/1/7", [1, 2, 3], [2, 1, 0]),
        ("f 1//1 2//2 3//3", [0, 1, 2], [NONE; 3]),
        ("f -1 -2 -3", [3, 2, 1], [NONE; 3]),
        ("f -4/-1 -3/-2 -2/-3", [0, 1, 2], [2, 1, 0]),
        ("f -4/-1/-1 2//-1 3/3", [0, 1, 2], [2, NONE, 2]),
        ("f 1/ 2/ 3/", [0, 1, 2], [NONE; 3]),
        ("f 1// 2// 3//", [0, 1, 2], [NONE; 3]),
        ("f +1 +2 +3", [0, 1, 2], [NONE; 3]),
        ("fo 1 2 3", [0, 1, 2], [NONE; 3]),
        ("  f\t1  2\t 3  # a comment", [0, 1, 2], [NONE; 3]),
        ("f 1 2 \\\n 3", [0, 1, 2], [NONE; 3]),
        ("f 1 2\\\r\n3", [0, 1, 2], [NONE; 3]),
    ] {
        let model = quiet(format!("{SQUARE}{vt}{face}\n"));
        assert_eq!(model.soup.corners, corners, "{face}");
        if uvs == [NONE; 3] {
            assert!(model.soup.uv_corners.is_empty() && model.soup.uvs.is_empty(), "{face}");
        } else {
            assert_eq!(model.soup.uv_corners, uvs, "{face}");
            assert_eq!(model.soup.uvs, [[0., 0.], [1., 0.], [1., 1.]]);
        }
    }
}

#[test]
fn faces_before_their_vertices() {
    assert_eq!(quiet(format!("f 1 2 4\n{SQUARE}")).soup.corners, [0, 1, 3]);
}

#[test]
fn texture_corners_on_some_faces_only() {
    let model = quiet(format!("{SQUARE}vt .5 .25 9\nvt .75\nf 1 2 3\nf 1/1 3/2 4\nf 1 2 4\n"));
    assert_eq!(model.soup.uv_corners, [NONE, NONE, NONE, 0, 1, NONE, NONE, NONE, NONE]);
    assert_eq!(model.soup.uvs, [[0.5, 0.25], [0.75, 0.]]);
}

#[test]
fn line_ends_and_byte_order_mark() {
    let unix = format!("# first\n{SQUARE}\nf 1 2 3 4");
    let expected = quiet(&unix);
    for text in [
        unix.replace('\n', "\r\n"),
        unix.replace('\n', "\r"),
        format!("\u{feff}{unix}"),
        unix.replace(' ', "\t  "),
        unix.replace("v 1 0 0", "v\\\n1\\\n0\\\n0\\\n"),
        format!("{unix}\\"),
        format!("{unix} \\\n\\\n"),
    ] {
        assert_eq!(quiet(&text), expected, "{text:?}");
    }
    assert_eq!(fails("v 0 0 0\r\nv 0 0 \\\r\nx"), "Line 2: \"x\" is not a number.");
    assert_eq!(fails("v 0 0 0\rv 0 0 0\rv 0 0 x"), "Line 3: \"x\" is not a number.");
    assert_eq!(fails("v 0 0 \\\n0\n# \\\nv 0 0 x"), "Line 4: \"x\" is not a number.");
}

#[test]
fn a_huge_line() {
    let count = 200_000;
    let mut text: String = (0..count).map(|i| format!("v {i} 0 0\n")).collect();
    text.push('f');
    (1..=count).for_each(|i| text.push_str(&format!(" {i}")));
    let model = quiet(text);
    assert_eq!(model.soup.face_count(), 1);
    assert_eq!(model.soup.corners, (0..count).collect::<Vec<u32>>());
    assert_eq!(model.soup.positions[199_999], [199_999., 0., 0.]);
}

#[test]
fn numbers_are_rounded_correctly() {
    let texts = [
        "0",
        "-0",
        "+1",
        "1.",
        ".5",
        "-.5e1",
        "1e3",
        "1E+3",
        "1e-3",
        "0.1",
        "123456789",
        "16777217",
        "0.30000001192092896",
        "3.4028235e38",
        "1.17549435e-38",
        "1e-45",
        "7e-46",
        "1.00000017881393432617187499",
        "1.00000017881393432617187501",
        "1.000000178813934326171875",
        "0.000000000000000000000000000000000000000000001401298464324817",
        "9007199254740993",
        "123456789012345678901234567890",
        "8.589973e9",
        "340282346638528859811704183484516925440",
        "1e-400",
        "0e999999999",
    ];
    for text in texts {
        let model = quiet(format!("v {text} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3"));
        let want: f32 = text.parse().unwrap();
        assert_eq!(model.soup.positions[0][0].to_bits(), want.to_bits(), "{text}");
    }
    assert_eq!(quiet("v 1 2 3#x\nv 1 2 3\nv 1 2 3.5#x\nf 1 2 3#x").soup.positions[2], [1., 2., 3.5]);
}

#[test]
fn vertex_colours_become_linear() {
    let linear = [0.0, 0.21404114, 1.0, 1.0];
    let (model, warnings) = open("v 0 0 0 0 .5 1\nv 1 0 0 1 1 1 .5\nv 0 1 0\nf 1 2 3");
    assert_eq!(model.soup.colors, [linear, [1., 1., 1., 0.5], [1.; 4]]);
    assert_eq!(warnings[0].to_string(), "1 vertex without a colour in a coloured file is read as white.");
    // 0..255
    let model = quiet("v 0 0 0 0 127.5 255\nv 1 0 0 0 0 0\nv 0 1 0 51 51 51\nf 1 2 3");
    assert_eq!(model.soup.colors, [linear, [0., 0., 0., 1.], [0.033104766, 0.033104766, 0.033104766, 1.]]);
    // The first coloured vertex is not the first vertex.
    assert_eq!(open("v 0 0 0\nv 1 0 0 0 .5 1\nv 0 1 0\nf 1 2 3").0.soup.colors, [[1.; 4], linear, [1.; 4]]);
    // On lines of their own.
    let model = quiet("v 0 0 0\nv 1 0 0\nv 0 1 0\nvc 0 .5 1\nvc 1 1 1\nvc 0 0 0\nf 1 2 3");
    assert_eq!(model.soup.colors, [linear, [1.; 4], [0., 0., 0., 1.]]);
    assert_eq!(
        says("v 0 0 0 0 -1 1\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3"),
        ["1 vertex colour out of range (first on line 1) is clamped."]
    );
}

#[test]
fn weights() {
    assert_eq!(quiet("v 1 2 3 1\nv 1 0 0 1.0\nv 0 1 0\nf 1 2 3").soup.positions[0], [1., 2., 3.]);
    let (model, warnings) = open("v 1 2 3 1\nv 1 0 0 .5\nv 0 1 0 2\nf 1 2 3");
    assert!(model.soup.colors.is_empty());
    assert_eq!(warnings[0].to_string(), "2 vertex weights (w) (first on line 2) are not used.");
}

#[test]
fn groups() {
    let f = "f 1 2 3\n";
    let model = quiet(format!("{SQUARE}{f}g side a # note\n{f}g empty\ng top#1\n{f}g side a\n{f}g\n{f}"));
    assert_eq!(model.groups, ["default", "side a", "top#1"]);
    assert_eq!(model.soup.face_groups, [0, 1, 2, 1, 0]);
    // Objects and their groups.
    let model = quiet(format!("{SQUARE}o A\n{f}g x\n{f}g A\n{f}o B\n{f}g x\n{f}"));
    assert_eq!(model.groups, ["A", "A/x", "A", "B", "B/x"]);
    assert_eq!(model.soup.face_groups, [0, 1, 2, 3, 4]);
}

#[test]
fn dropped_faces_leave_no_trace() {
    let (model, warnings) = open(format!("{SQUARE}vt 0 0\ng a\nf 1/1 2/1\ng b\nf 1 2 3\nf 1\nf\nf 2/1 3/1 4/1\n"));
    assert_eq!(model.soup.corners, [0, 1, 2, 1, 2, 3]);
    assert_eq!(model.soup.offsets, [0, 3, 6]);
    assert_eq!(model.soup.uv_corners, [NONE, NONE, NONE, 0, 0, 0]);
    assert_eq!(model.groups, ["b"]);
    assert_eq!(model.soup.face_groups, [0, 0]);
    assert_eq!(warnings[0].to_string(), "3 faces with fewer than three corners (first on line 7) are left out.");
}

#[test]
fn materials() {
    let mtl = b"newmtl red\r\nKa 1 1 1\nKd 1 0.5 0\nd 0.25\nnewmtl Wood #1\nKd 0 0 0\nTr 0.25\nmap_Kd -s 2 3 0 -o .1 -clamp on Wood%20Floor.PNG\nnewmtl grey\nKd 0.5\nd -halo 0.5\nTr 1\nnewmtl black\nKd 0 0 0\nKd a b c\nnewmtl lost\nKd 0 1 0\nmap_Kd sub\\no such.jpg\nnewmtl unused\nmap_Kd other.png\n";
    let set = files(&[("Model.MTL", mtl), ("textures/wood floor.png", PNG)]);
    let f = "f 1 2 3\n";
    let text = format!(
        "{SQUARE}mtllib ./model.mtl\n{f}usemtl Wood #1\n{f}usemtl red\n{f}{f}usemtl Wood #1\n{f}usemtl\n{f}usemtl grey\n{f}usemtl black\n{f}usemtl lost\n{f}"
    );
    let (model, warnings) = open_with(text, &set).unwrap();
    assert_eq!(model.soup.face_materials, [NONE, 0, 1, 1, 0, NONE, 2, 3, 4]);
    let names: Vec<_> = model.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["Wood #1", "red", "grey", "black", "lost"]);
    let colors: Vec<_> = model.materials.iter().map(|m| m.base_color).collect();
    let half = 0.21404114;
    assert_eq!(
        colors,
        [[1., 1., 1., 0.75], [1., half, 0., 0.25], [half, half, half, 0.5], [0., 0., 0., 1.], [0., 1., 0., 1.]]
    );
    let textures: Vec<_> = model.materials.iter().map(|m| m.texture).collect();
    assert_eq!(textures, [Some(0), None, None, None, None]);
    assert_eq!(model.images.len(), 1);
    assert_eq!(
        (model.images[0].name.as_str(), model.images[0].mime.as_str()),
        ("textures/wood floor.png", "image/png")
    );
    assert_eq!(model.images[0].bytes, PNG);
    let said: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "1 material value that is not a number (first on line 15 of the material file) is skipped.",
            "1 picture (sub\\no such.jpg) is missing, so its surface shows without it.",
            "3 picture options (offset, scale and the like) are not used.",
            "1 material setting other than base colour (such as Ka) is not used.",
        ]
    );
    assert!(warnings[3].is_minor());
}

#[test]
fn material_files_with_blanks_in_their_names() {
    let (red, blue) = (&b"newmtl a\nKd 1 0 0"[..], &b"newmtl b\nKd 0 0 1"[..]);
    let set = files(&[("box red.mtl", red), ("blue.mtl", blue)]);
    let faces = "f 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    for line in
        ["mtllib box red.mtl blue.mtl # note", "mtllib blue.mtl x/box\\ red.mtl", "mtllib box red.mtl\nmtllib BLUE.mtl"]
    {
        let (model, warnings) = open_with(format!("{SQUARE}{line}\n{faces}"), &set).unwrap();
        assert_eq!(warnings, [], "{line}");
        assert_eq!(model.materials[0].base_color, [1., 0., 0., 1.]);
        assert_eq!(model.materials[1].base_color, [0., 0., 1., 1.]);
    }
    assert_eq!(
        says(format!("{SQUARE}mtllib one.mtl two.mtl\n{faces}")),
        [
            "2 material files (one.mtl, two.mtl) are missing, so its materials show plain.",
            "2 material names (a, b) are not defined and shown plain.",
        ]
    );
}

#[test]
fn tags() {
    let model = quiet(format!(
        "{SQUARE}f 1 2 3 4\nt crease 2/1/0 0 1 2.5\nt crease 3/2/0 1 2 3 1 10\nt corner 2/1/0 0 3 4\nt crease 2/1/0  2  0\t0.5\n"
    ));
    assert_eq!(model.soup.marks.creases, [([0, 1], 2.5), ([1, 2], 1.0), ([2, 3], 10.0), ([2, 0], 0.5)]);
    assert_eq!(model.soup.marks.corners, [(0, 4.0), (3, 4.0)]);
    let (model, warnings) = open(format!(
        "{SQUARE}f 1 2 3 4\nt crease 2/1/0 0 4 2.5\nt corner 1/1/0 x 1\nt crease 999999999999/1/0 1\nt interpolateboundary 1/0/0 2\n"
    ));
    assert_eq!(model.soup.marks, limn_mesh::Marks::default());
    assert_eq!(
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "1 tag other than crease and corner (first \"interpolateboundary\" on line 9) is not used.",
            "3 crease and corner tags that do not fit the file (first on line 7) are left out.",
        ]
    );
}

#[test]
fn what_is_not_used_is_said() {
    let text = format!(
        "{SQUARE}vn 0 0 1\nvn 0 0 1\ns off\nl 1 2\nl 2 3\np 1\ncstype bezier\ncurv 0 1 \\\n 1 2 3\nend\nwhatever 3\nlod 1\nf 1 2 3 4\n"
    );
    let (model, warnings) = open(text);
    assert_eq!(model.soup.corners, [0, 1, 2, 3]);
    assert_eq!(
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "2 line elements (first on line 8) are not used.",
            "1 point element (first on line 10) is not used.",
            "3 free-form curve and surface statements (first on line 11) are not used.",
            "2 statements (first \"whatever\" on line 15) are not understood and skipped.",
            "2 normals (first on line 5) are not used because Limn computes its own.",
            "1 smoothing group statement (first on line 7) is not used.",
        ]
    );
    assert_eq!(warnings[0].kind, WarningKind::Lines);
    assert_eq!(warnings[0].count, 2);
}

#[test]
fn texture_coordinates_that_are_not_there() {
    let (model, warnings) = open(format!("{SQUARE}vt 0 0\nvt nan 0\nf 1/1 2/2 3/3\nf 1/0 2/-9 3/1\n"));
    assert_eq!(model.soup.uv_corners, [0, 1, NONE, NONE, NONE, 0]);
    assert_eq!(model.soup.uvs, [[0., 0.], [0., 0.]]);
    assert_eq!(
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "3 corners with a texture coordinate that the file does not have (first on line 8) are read without one.",
            "1 texture coordinate that is not a finite number (first on line 6) is read as 0.",
        ]
    );
}

#[test]
fn errors_are_one_sentence_with_a_line() {
    for (text, message) in [
        ("v 0 0", "Line 1: a vertex needs x, y and z, but only 2 of them are there."),
        ("v", "Line 1: a vertex needs x, y and z, but only 0 of them are there."),
        ("\n\nv 0 zero 0", "Line 3: \"zero\" is not a number."),
        ("v 0 0 nan", "Line 1: \"nan\" is not a finite number."),
        ("v 0 0 -nan(ind)", "Line 1: \"-nan(ind)\" is not a finite number."),
        ("v 0 1.#QNAN 0", "Line 1: \"1.#QNAN\" is not a finite number."),
        ("v -inf 0 0", "Line 1: \"-inf\" is not a finite number."),
        ("v 1e39 0 0", "Line 1: \"1e39\" is not a finite number."),
        ("v 0 0 0 1 nan 0", "Line 1: \"nan\" is not a finite number."),
        ("v 0,5 0 0", "Line 1: \"0,5\" is not a number."),
        ("v 0 0 0\nf 1 1 2", "Line 2: a face uses vertex 2, but the file has only 1."),
        ("v 0 0 0\nf 1 1 0", "Line 2: face corner \"0\" names vertex 0, but vertices count from 1."),
        ("v 0 0 0\nf 1 1 -2//3", "Line 2: face corner \"-2//3\" counts back past the first of 1 vertices so far."),
        ("v 0 0 0\nf 1 1 9999999999", "Line 2: face corner \"9999999999\" names a vertex that the file does not have."),
        (
            "v 0 0 0\nf 1 1 -99999999999999999999",
            "Line 2: face corner \"-99999999999999999999\" counts back past the first of 1 vertices so far.",
        ),
        ("v 0 0 0\nf 1 a 1", "Line 2: \"a\" is not a face corner such as 7, 7/2 or 7//3."),
        ("v 0 0 0\nf 1 1 1.5", "Line 2: \"1.5\" is not a face corner such as 7, 7/2 or 7//3."),
        ("v 0 0 0\nf 1 1 1/1/1/1", "Line 2: \"1/1/1/1\" is not a face corner such as 7, 7/2 or 7//3."),
        ("v 0 0 0\nf 1 1 /1", "Line 2: \"/1\" is not a face corner such as 7, 7/2 or 7//3."),
        ("v 0 0 0\nv 1 0 0\n", "folder/my model.obj has no faces: it has only 2 vertices."),
        ("v 0 0 0\nl 1 1\np 1", "folder/my model.obj has no faces: it has 1 vertex, and 2 lines or points."),
        ("v 0 0 0\nf 1 1\n", "folder/my model.obj has no faces: it has 1 vertex, but no face with three corners."),
        ("# nothing", "folder/my model.obj has no faces: it has no vertices either."),
        ("hello\nthere", "folder/my model.obj has no faces: it has 2 lines that are not OBJ statements."),
        ("v 1 2 3\0", "folder/my model.obj is not text: byte 7 is zero."),
        (" \r\n", "folder/my model.obj is empty."),
        ("", "folder/my model.obj is empty."),
    ] {
        assert_eq!(fails(text), message, "{text:?}");
    }
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain("v 0 0 0".encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert_eq!(fails(utf16), "folder/my model.obj is not text: byte 0 is a UTF-16 mark (save the file as UTF-8).");
}

#[test]
fn the_memory_budget_holds() {
    let text = format!("{SQUARE}{}", "f 1 2 3 4\n".repeat(1000));
    let read = |bytes| read("big.obj", text.as_bytes(), &(), &Limits { bytes });
    // 4 * 12 + 4000 * 4 + 1001 * 4
    assert!(read(20_052).is_ok());
    assert_eq!(
        read(20_051).unwrap_err().to_string(),
        "The model would need 20.1 kB of memory, more than the limit of 20.1 kB."
    );
    let line = format!("v 0 0 0\nf{}", " 1".repeat(1_000_000));
    let error = limn_formats::read("big.obj", line.as_bytes(), &(), &Limits { bytes: 1_000_000 }).unwrap_err();
    assert_eq!(error.to_string(), "The model would need 1.1 MB of memory, more than the limit of 1 MB.");
}
