//! Exports: order, groups, and split vertices put back together.

use limn_document::command::parse_script;
use limn_document::{Document, Outcome, Replayed, Source, Stamp};
use limn_formats::parcel::Notice;
use limn_formats::{Limits, Model, read};
use limn_mesh::refine;

const BUDGET: u64 = 10 << 20;

fn document(script: &str) -> Document {
    let mut document = Document::new(BUDGET);
    assert_eq!(document.replay(&parse_script(script).unwrap()), Ok(Replayed::Done), "{script}");
    document
}

fn run(document: &mut Document, line: &str) -> Outcome {
    document.run(line).unwrap_or_else(|e| panic!("{line}: {e}"))
}

fn obj(text: &str) -> (Source, Model, Vec<Notice>) {
    let source = Source::File { name: "a.obj".into(), stamp: Some(Stamp::of(text.as_bytes())) };
    let (model, warnings) = read("a.obj", text.as_bytes(), &(), &Limits::default()).unwrap();
    (source, model, warnings.iter().map(Notice::from).collect())
}

fn load(document: &mut Document, text: &str) -> Outcome {
    let (source, model, warnings) = obj(text);
    run(document, &format!("open {source}"));
    document.load(source, model, &warnings).unwrap()
}

/// Two triangles side by side, each with vertices of its own.
const SEAM: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\nf 1 2 3\nf 5 6 4\n";

#[test]
fn exports_keep_order_groups_and_materials() {
    let mut d = Document::new(BUDGET);
    load(&mut d, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\ng a\nf 1 2 3 4\ng b\nf 2 5 6 3\n");
    run(&mut d, "scheme linear");
    run(&mut d, "level 1");
    let refined = refine(d.mesh().unwrap(), &d.plan().unwrap(), BUDGET).unwrap();
    let files = d.export(&refined, "dir/out.OBJ").unwrap();
    assert_eq!(files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["out.OBJ"]);
    let text = String::from_utf8(files[0].bytes.clone()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    // Old vertices, then face points, then edge points; each face's four children in its group.
    assert_eq!(
        &lines[..8],
        ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "v 2 0 0", "v 2 1 0", "v 0.5 0.5 0", "v 1.5 0.5 0"]
    );
    let marks: Vec<&str> =
        lines.iter().copied().filter(|l| !l.starts_with('v')).map(|l| &l[..l.len().min(3)]).collect();
    assert_eq!(marks.iter().filter(|m| m.starts_with('f')).count(), 8);
    assert_eq!((marks[0], marks[5]), ("g a", "g b"));
    assert_eq!(
        d.export(&refined, "out.stl").unwrap_err().to_string(),
        "`out.stl` does not say in which format to write; end it in .obj or .glb"
    );
    run(&mut d, "weld exact");
    run(&mut d, "scale 2");
    assert!(d.export(&refined, "out.obj").is_err(), "a level of another mesh");
}

/// Faces in no order are put into one when a mesh is built; a file has its vertices as the model had them all the same.
#[test]
fn exports_of_scattered_faces_keep_the_order_of_vertices() {
    const SIDE: usize = 70;
    let mut text = String::new();
    // Every vertex at a place of its own: numbers times a step that is prime to their count.
    let (vertices, faces) = ((SIDE + 1) * (SIDE + 1), SIDE * SIDE);
    let place = |v: usize| v * 1999 % vertices;
    let mut lines = vec![String::new(); vertices];
    (0..vertices).for_each(|v| lines[place(v)] = format!("v {} {} 0", v % (SIDE + 1), v / (SIDE + 1)));
    text += &lines.join("\n");
    for f in (0..faces).map(|f| f * 1999 % faces) {
        let v = f / SIDE * (SIDE + 1) + f % SIDE;
        let [a, b, c, d] = [v, v + 1, v + SIDE + 2, v + SIDE + 1].map(|v| place(v) + 1);
        text += &format!("\nf {a} {b} {c} {d}");
    }
    let mut d = Document::new(BUDGET);
    load(&mut d, &text);
    assert!(!d.mesh().unwrap().vertex_source.is_sorted());
    run(&mut d, "scheme linear");
    for level in 0..2 {
        run(&mut d, &format!("level {level}"));
        let written = written(&d);
        assert_eq!(written[..vertices], lines[..], "level {level}");
        let (_, model, _) = obj(&written.join("\n"));
        let mut areas = model.soup.corners.chunks(4).map(|face| {
            let [a, _, c, _] = [0, 1, 2, 3].map(|k| model.soup.positions[face[k] as usize]);
            (c[0] - a[0]).abs() * (c[1] - a[1]).abs()
        });
        assert!(areas.all(|area| area == 0.25f32.powi(level)), "level {level}");
    }
}

/// The `v` lines and the number of different ends of the `f` lines of an export.
fn written(d: &Document) -> Vec<String> {
    let refined = refine(d.mesh().unwrap(), &d.plan().unwrap(), BUDGET).unwrap();
    let files = d.export(&refined, "out.obj").unwrap();
    String::from_utf8(files[0].bytes.clone()).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn exports_put_split_vertices_back_together() {
    let mut d = Document::new(BUDGET);
    // Three squares on one edge, and a fourth that touches in its end 1 alone.
    let fins = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 1 0\nv 0 0 1\nv 0 1 1\nv 0 -1 0\nv 1 -1 0\nv 1 -1 1\n\
                f 1 3 4 2\nf 2 6 5 1\nf 1 7 8 2\nf 1 9 10 11\n";
    load(&mut d, fins);
    run(&mut d, "boundary edge-only");
    assert!(d.mesh().unwrap().counts().vertices > 11);
    // Level 0 is the file again, vertex for vertex and face for face.
    let lines = written(&d);
    let vertices = |lines: &[String]| lines.iter().filter(|l| l.starts_with("v ")).count();
    let mut positions: Vec<&str> = lines.iter().map(String::as_str).filter(|l| l.starts_with("v ")).collect();
    let mut expected: Vec<&str> = fins.lines().filter(|l| l.starts_with("v ")).collect();
    positions.sort_unstable();
    expected.sort_unstable();
    assert_eq!(positions, expected);
    // Old vertices, faces and edges become vertices: 11 + 4 + 14, then 29 + 16 + 44.
    for (level, count) in [(1, 11 + 4 + 14), (2, 29 + 16 + 44)] {
        run(&mut d, &format!("level {level}"));
        let lines = written(&d);
        // Written again from the export, nothing has to be welded: it is as connected as the model was.
        let (_, model, _) = obj(&lines.join("\n"));
        let edges: std::collections::BTreeSet<[u32; 2]> = (0..model.soup.face_count())
            .flat_map(|f| {
                let face = model.soup.face(f).to_vec();
                (0..face.len()).map(move |i| {
                    let (a, b) = (face[i], face[(i + 1) % face.len()]);
                    [a.min(b), a.max(b)]
                })
            })
            .collect();
        // V - E + F of three squares on an edge and one in a point is 1, whatever the level.
        let euler = vertices(&lines) as i64 - edges.len() as i64 + model.soup.face_count() as i64;
        assert_eq!(euler, 1, "level {level}: {} vertices", vertices(&lines));
        assert_eq!(vertices(&lines), count, "level {level}");
    }
    // A ribbon with one side is cut across once; its export is whole again.
    let mut ribbon = document("open builtin:moebius level 2");
    let counts = ribbon.predict(2).unwrap().counts;
    assert_eq!(vertices(&written(&ribbon)) as u64, counts.vertices - (1 << 2) - 1);
    // Vertices that only lie in the same place stay apart.
    load(&mut ribbon, SEAM);
    run(&mut ribbon, "level 3");
    let counts = ribbon.predict(3).unwrap().counts;
    assert_eq!(vertices(&written(&ribbon)) as u64, counts.vertices);
}
