//! The document: what commands do, that failures do nothing, and that undo is replay.

use limn_document::command::parse_script;
use limn_document::{CommandError, Document, Outcome, Replayed, Source, Stamp};
use limn_formats::parcel::Notice;
use limn_formats::{Limits, Model, read};
use limn_mesh::refine::grouped;
use limn_mesh::{Boundary, Weld, refine};
use proptest::prelude::*;

const BUDGET: u64 = 10 << 20;

fn document(script: &str) -> Document {
    let mut document = Document::new(BUDGET);
    assert_eq!(document.replay(&parse_script(script).unwrap()), Ok(Replayed::Done), "{script}");
    document
}

fn run(document: &mut Document, line: &str) -> Outcome {
    document.run(line).unwrap_or_else(|e| panic!("{line}: {e}"))
}

fn error(document: &mut Document, line: &str) -> String {
    let before = document.text();
    let error = document.run(line).expect_err(line).to_string();
    assert_eq!(document.text(), before, "{line} failed and changed something");
    error
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

/// Two triangles side by side, each with vertices of its own: the last two lie where the first and the third do.
const SEAM: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\nf 1 2 3\nf 5 6 4\n";

#[test]
fn opening_chooses_scheme_and_level() {
    let mut d = Document::new(BUDGET);
    assert_eq!(run(&mut d, "open builtin:tetrahedron"), Outcome::Model);
    assert_eq!(d.text(), "version 1\nopen builtin:tetrahedron\nscheme loop\nlevel 0\n");
    run(&mut d, "level 2");
    run(&mut d, "boundary edge-only");
    assert_eq!(run(&mut d, "open builtin:cube"), Outcome::Model);
    assert_eq!(d.text(), "version 1\nopen builtin:cube\nscheme catmull-clark\nlevel 0\n");
    assert_eq!(d.plan().unwrap().rules.boundary, Boundary::EdgeAndCorner);
    assert_eq!(d.link(), "#1;open+builtin:cube;scheme+catmull-clark;level+0");
    assert_eq!(Document::new(1).link(), "");
}

#[test]
fn outcomes_say_what_to_do_next() {
    let mut d = document("open builtin:cube");
    assert_eq!(run(&mut d, "level 2"), Outcome::Refine);
    assert_eq!(run(&mut d, "level 2"), Outcome::Nothing);
    assert_eq!(run(&mut d, "scheme linear"), Outcome::Refine);
    assert_eq!(run(&mut d, "scheme loop"), Outcome::Model); // triangulated
    assert_eq!(run(&mut d, "view edges=on"), Outcome::View);
    assert_eq!(run(&mut d, "view edges=on"), Outcome::Nothing);
    assert_eq!(run(&mut d, "info --json"), Outcome::Info { json: true });
    assert_eq!(run(&mut d, "export a.obj"), Outcome::Export { file: "a.obj".into() });
    assert_eq!(run(&mut d, "version 1"), Outcome::Nothing);
    let Outcome::Help(text) = run(&mut d, "help level") else { panic!() };
    assert!(text.starts_with("level N\n"));
    let url = Source::Url("https://example.org/a.glb".into());
    assert_eq!(run(&mut d, "open https://example.org/a.glb"), Outcome::Open(url.clone()));
    assert_eq!(d.pending(), Some(&url));
    d.cancel_open();
    assert_eq!(d.pending(), None);
    assert_eq!(d.source(), Some(&Source::Builtin("cube".into())));
}

#[test]
fn failures_are_one_sentence_and_change_nothing() {
    let mut empty = Document::new(BUDGET);
    assert_eq!(error(&mut empty, "level 1"), "`level` needs a model; open one first, as in `open builtin:cube`");
    assert_eq!(error(&mut empty, "undo"), "there is nothing to undo");
    assert!(
        error(&mut empty, "open builtin:teapot")
            .starts_with("there is no built-in model `teapot`; there are creature,")
    );
    let mut d = document("open builtin:cube level 1");
    assert_eq!(error(&mut d, "level -1"), "there is no level -1: level 0 is the model itself and the lowest");
    let unknown = error(&mut d, "scheme nurbs");
    assert!(unknown.starts_with("there is no scheme `nurbs`; there are catmull-clark, loop, "), "{unknown}");
    assert_eq!(error(&mut d, "scheme loop w=1"), "the scheme loop has no parameter `w`; it takes weights");
    assert_eq!(error(&mut d, "redo"), "there is nothing to redo");
    assert_eq!(error(&mut d, "reload"), "cube is built in and has no file to read again");
    assert_eq!(error(&mut d, "view hide=arm"), "the model has no group `arm`; it has no groups");
    assert_eq!(error(&mut d, "version 2"), "version 2 of the commands is not known; this program knows version 1");
    assert_eq!(error(&mut d, "view hide=arm"), "the model has no group `arm`; it has no groups");
    // After all that nothing can be undone but nothing was done either.
    assert_eq!(d.undo_depth(), (0, 0));
}

#[test]
fn the_budget_refuses_with_numbers() {
    let mut d = document("open builtin:cube level 3");
    let fits = d.highest_level();
    assert!(d.predict(fits).unwrap().bytes <= BUDGET && d.predict(fits + 1).unwrap().bytes > BUDGET);
    let message = error(&mut d, &format!("level {}", fits + 1));
    let faces = 6u64 << (2 * (fits + 1));
    assert!(message.contains(&grouped(faces)), "{message}");
    assert!(message.contains(&format!("choose level {fits} or lower")), "{message}");
    assert!(d.run("level 100").unwrap_err().is_budget());
    assert!(d.run("level 2147483647").unwrap_err().is_budget());
    assert_eq!(d.predict(100), None);
    run(&mut d, &format!("level {fits}"));
    d.set_budget(1000);
    assert!(d.run("scheme loop").unwrap_err().is_budget());
    assert_eq!(d.plan().unwrap().scheme.info.id, "catmull-clark");
}

#[test]
fn a_scheme_of_triangles_gets_triangles_and_says_so() {
    let mut d = document("open builtin:cube");
    let quads = d.mesh().unwrap().clone();
    assert!(d.remarks().is_empty());
    run(&mut d, "scheme loop");
    assert!(d.mesh().unwrap().is_triangles());
    // Shortest diagonals, ties by lowest index: the first face keeps its first corner's diagonal.
    assert_eq!(d.soup().unwrap().face_count(), 12);
    assert_eq!(d.soup().unwrap().positions, quads.positions);
    let remarks: Vec<String> = d.remarks().into_iter().map(|r| r.text).collect();
    assert_eq!(remarks, ["6 faces were cut into triangles, which is what the scheme refines."]);
    run(&mut d, "scheme linear");
    assert!(std::sync::Arc::ptr_eq(d.mesh().unwrap(), &quads), "the polygons are not built twice");
    // Triangulated by command they stay so, and there is nothing left to say.
    run(&mut d, "triangulate");
    run(&mut d, "scheme loop");
    assert!(d.remarks().is_empty());
    assert_eq!(d.text(), "version 1\nopen builtin:cube\ntriangulate\nscheme loop\nlevel 0\n");
}

#[test]
fn center_and_scale_move_points_and_keep_the_picture() {
    let mut d = Document::new(BUDGET);
    load(&mut d, "v 2 0 0\nv 6 0 0\nv 6 2 0\nv 2 2 1\nv 99 99 99\nf 1 2 3 4\n");
    d.set_aspect(1.5);
    d.view_mut().camera.orbit(glam::vec2(0.1, 0.0));
    let seen = |d: &Document, v: usize| {
        d.view().camera.project(d.mesh().unwrap().positions[v].into(), 1.5).unwrap().truncate()
    };
    let before = seen(&d, 2);
    assert_eq!(run(&mut d, "center"), Outcome::Model);
    // The vertex that no face uses does not count.
    assert_eq!(
        d.mesh().unwrap().positions,
        [[-2.0, -1.0, -0.5], [2.0, -1.0, -0.5], [2.0, 1.0, -0.5], [-2.0, 1.0, 0.5]]
    );
    assert!((seen(&d, 2) - before).length() < 1e-5);
    run(&mut d, "scale 0.5");
    assert_eq!(d.mesh().unwrap().positions[1], [1.0, -0.5, -0.25]);
    assert!((seen(&d, 2) - before).length() < 1e-5);
    run(&mut d, "scale");
    assert_eq!(d.mesh().unwrap().positions[1], [0.5, -0.25, -0.125]);
    assert!(d.text().contains("center\nscale 0.5\nscale\nscheme"));
    let mut point = document("open builtin:cube");
    run(&mut point, "scale 3e38");
    assert_eq!(
        error(&mut point, "scale 2"),
        "scale 2 would take coordinates out of range; choose a factor nearer to 1"
    );
    run(&mut point, "scale 1e-45");
    run(&mut point, "scale 1e-45"); // everything falls into the origin
    assert!(error(&mut point, "scale").contains("no extent"));
}

#[test]
fn welding_and_pairing_begin_from_the_file() {
    let mut d = Document::new(BUDGET);
    load(&mut d, SEAM);
    let counts = |d: &Document| d.mesh().unwrap().counts();
    assert_eq!((counts(&d).vertices, counts(&d).edges), (6, 6));
    assert_eq!(d.reading(), Some((false, Weld::Off)));
    assert_eq!(run(&mut d, "weld exact"), Outcome::Model);
    assert_eq!((counts(&d).vertices, counts(&d).edges), (4, 5));
    // Classes report their lowest member.
    assert_eq!(d.mesh().unwrap().vertex_source, [0, 1, 2, 3]);
    assert_eq!(d.mesh().unwrap().weld_class, [0, 1, 2, 3, 0, 2]);
    let remarks = d.remarks();
    assert_eq!((remarks[0].text.as_str(), remarks[0].minor), ("2 duplicate positions welded.", true));
    // Loop has no use for quads.
    run(&mut d, "quads on");
    assert_eq!(d.plan().unwrap().scheme.info.id, "catmull-clark");
    assert_eq!((counts(&d).faces, counts(&d).corners), (1, 4));
    assert_eq!(d.text().lines().nth(2), Some("weld exact"));
    assert_eq!(d.text().lines().nth(3), Some("quads on"));
    // Apart, the triangles share no edge.
    run(&mut d, "weld off");
    assert_eq!(counts(&d).faces, 2);
    run(&mut d, "weld 0.01");
    assert_eq!(counts(&d).faces, 1);
    run(&mut d, "quads off");
    assert_eq!(counts(&d).faces, 2);
}

#[test]
fn a_slider_drag_is_one_step() {
    let mut d = document("open builtin:cube");
    for level in [1, 2, 3] {
        d.drag(&format!("level {level}")).unwrap();
    }
    run(&mut d, "level 3");
    assert_eq!(d.undo_depth(), (1, 0));
    assert_eq!(run(&mut d, "undo"), Outcome::Refine);
    assert_eq!(d.plan().unwrap().level, 0);
    run(&mut d, "redo");
    assert_eq!(d.plan().unwrap().level, 3);
    run(&mut d, "level 1");
    run(&mut d, "level 2");
    assert_eq!(d.undo_depth(), (3, 0));
}

#[test]
fn a_parameter_s_drag_is_one_step_of_its_scheme() {
    let mut d = document("open builtin:pawn\nscheme butterfly");
    let scheme =
        |d: &Document| d.commands().into_iter().map(|c| c.to_string()).find(|c| c.starts_with("scheme")).unwrap();
    for w in ["0.06", "0.05", "0.01"] {
        assert_eq!(d.drag(&format!("scheme butterfly w={w}")), Ok(Outcome::Refine));
    }
    assert_eq!(d.undo_steps(), (Some("scheme butterfly w=0.01"), None));
    // Nothing said that the first drag was over.
    for s in ["0.5", "1", "1.25"] {
        d.drag(&format!("scheme j-spline s={s}")).unwrap();
    }
    assert_eq!(run(&mut d, "scheme j-spline s=1.25"), Outcome::Nothing, "let go");
    run(&mut d, "scheme j-spline s=1.25 move=off");
    assert_eq!(d.undo_depth(), (3, 0));
    for expected in ["scheme j-spline s=1.25", "scheme butterfly w=0.01", "scheme butterfly"] {
        run(&mut d, "undo");
        assert_eq!(scheme(&d), expected);
    }
    // To and fro is no step, also where the end names the default.
    for w in ["0.05", "0.07", "0.0625"] {
        d.drag(&format!("scheme butterfly w={w}")).unwrap();
    }
    assert_eq!(run(&mut d, "scheme butterfly w=0.0625"), Outcome::Nothing);
    assert_eq!((scheme(&d), d.undo_depth()), ("scheme butterfly".to_owned(), (0, 0)));
}

#[test]
fn undo_says_what_it_takes_back() {
    let mut d = document("open builtin:cube");
    assert_eq!(d.undo_steps(), (None, None));
    run(&mut d, "level 3");
    run(&mut d, "scheme loop");
    run(&mut d, "scale 2.50");
    assert_eq!(d.undo_steps(), (Some("scale 2.5"), None));
    run(&mut d, "undo");
    assert_eq!(d.undo_steps(), (Some("scheme loop"), Some("scale 2.5")));
    run(&mut d, "open builtin:pawn");
    assert_eq!(d.undo_steps(), (Some("open pawn"), None));
    run(&mut d, "undo");
    assert_eq!(d.undo_steps(), (Some("scheme loop"), Some("open pawn")));
    assert!(d.run("level 40").is_err());
    assert_eq!(d.undo_steps(), (Some("scheme loop"), Some("open pawn")), "a refused command leaves no trace");
}

#[test]
fn undo_brings_back_the_model_before() {
    let mut d = document("open builtin:cube level 2");
    let cube = d.mesh().unwrap().clone();
    run(&mut d, "open builtin:torus");
    assert_eq!(run(&mut d, "undo"), Outcome::Model);
    assert!(std::sync::Arc::ptr_eq(d.mesh().unwrap(), &cube), "snapshots are shared");
    assert_eq!(d.text(), "version 1\nopen builtin:cube\nscheme catmull-clark\nlevel 2\n");
    run(&mut d, "redo");
    assert_eq!(d.source(), Some(&Source::Builtin("torus".into())));
    // Only so many models are held.
    for name in ["cube", "grid", "torus", "cube", "grid"] {
        run(&mut d, &format!("open builtin:{name}"));
        run(&mut d, "level 1");
    }
    while d.run("undo").is_ok() {}
    assert_eq!(d.source(), Some(&Source::Builtin("grid".into())));
    assert_eq!(d.plan().unwrap().level, 0);
}

#[test]
fn a_dropped_file_is_asked_for_and_known_again() {
    let (source, model, warnings) = obj(SEAM);
    let text = format!("open {source}\nlevel 2\nview edges=on");
    let mut d = Document::new(BUDGET);
    let Ok(Replayed::Waiting { source: asked, rest }) = d.replay(&parse_script(&text).unwrap()) else { panic!() };
    assert_eq!(asked, source);
    let (other, changed, _) = obj(&SEAM.replace("v 1 1 0", "v 1 2 0"));
    assert_eq!(
        d.load(other, changed.clone(), &[]).unwrap_err().to_string(),
        "this `a.obj` is not the file that was opened before: its content has changed; open it as a new model instead"
    );
    assert_eq!(d.pending(), Some(&asked));
    let shorter = Source::File { name: "a.obj".into(), stamp: Some(Stamp { size: 1, hash: 0 }) };
    let message = d.load(shorter, changed, &[]).unwrap_err().to_string();
    assert!(message.contains(&format!("its size is 1 bytes, not {}", SEAM.len())), "{message}");
    assert_eq!(d.load(source.clone(), model, &warnings), Ok(Outcome::Model));
    assert_eq!(d.replay(&rest), Ok(Replayed::Done));
    assert_eq!(d.text(), format!("version 1\nopen {source}\nscheme loop\nlevel 2\nview edges=on\n"));
    assert_eq!(d.undo_depth(), (0, 0));
}

#[test]
fn reload_does_everything_again_to_the_new_bytes() {
    let mut d = Document::new(BUDGET);
    load(&mut d, SEAM);
    for line in ["weld exact", "scale 2", "level 4", "view shading=flat"] {
        run(&mut d, line);
    }
    d.view_mut().camera.orbit(glam::vec2(0.2, 0.0));
    let yaw = d.view().camera.yaw;
    let taller = SEAM.replace("v 0 1 0", "v 0 1 5");
    assert!(matches!(run(&mut d, "reload"), Outcome::Open(_)));
    let (source, model, warnings) = obj(&taller);
    assert_eq!(d.load(source.clone(), model, &warnings), Ok(Outcome::Model));
    assert_eq!(d.mesh().unwrap().positions[3], [0.0, 2.0, 10.0]);
    assert_eq!((d.plan().unwrap().level, d.view().camera.yaw), (4, yaw));
    assert!(d.text().contains(&source.to_string()));
    run(&mut d, "undo");
    assert_eq!(d.mesh().unwrap().positions[3], [0.0, 2.0, 0.0]);
    // A model that has grown too large for its level comes at a lower one, and says so.
    run(&mut d, "reload");
    let budget = d.predict(3).unwrap().bytes;
    d.set_budget(budget);
    let (source, model, warnings) = obj(SEAM);
    d.load(source, model, &warnings).unwrap();
    assert_eq!(d.plan().unwrap().level, 3);
    assert!(d.remarks().iter().any(|r| r.text.ends_with("it is shown at level 3.")), "{:?}", d.remarks());
}

#[test]
fn a_model_that_makes_no_mesh_leaves_the_last_one() {
    let mut d = document("open builtin:cube level 2");
    let before = d.text();
    run(&mut d, "open file:bad.obj");
    let soup = limn_mesh::Soup::from_faces(vec![[0.0; 3]; 3], &[[0, 0, 1]]);
    let source = Source::File { name: "bad.obj".into(), stamp: None };
    let error = d.load(source, Model { soup, ..Model::default() }, &[]).unwrap_err();
    assert!(matches!(error, CommandError::Build(_)), "{error}");
    assert_eq!(d.text(), before);
    assert_eq!(d.pending(), None);
}

#[test]
fn groups_are_hidden_by_name() {
    let mut d = Document::new(BUDGET);
    load(&mut d, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng arm, left\nf 1 2 3\ng 100%\nf 1 3 4\n");
    let names = d.model().unwrap().groups.clone();
    run(&mut d, "view \"hide=arm%2C left,100%25\"");
    assert_eq!(d.view().hidden, ["100%", "arm, left"]);
    assert!(names.iter().all(|n| d.view().hides(n)));
    assert!(d.text().ends_with("view \"hide=100%25,arm%2C left\"\n"));
    run(&mut d, "view hide=");
    assert!(d.view().hidden.is_empty());
    run(&mut d, "view hide=100%25");
    run(&mut d, "open builtin:cube");
    assert!(d.view().hidden.is_empty(), "another model has other groups");
}

#[test]
fn info_is_one_object() {
    let mut d = document("open builtin:cube level 1");
    let refined = refine(d.mesh().unwrap(), &d.plan().unwrap(), BUDGET).unwrap();
    let info = d.info(Some(&refined.points)).unwrap();
    let bytes = d.predict(1).unwrap().bytes;
    assert_eq!(
        info.json(),
        format!(
            "{{\"name\":\"cube\",\"source\":\"builtin:cube\",\"scheme\":\"catmull-clark\",\"level\":1,\"limit\":false,\
             \"vertices\":26,\"edges\":48,\"faces\":24,\"boundary_loops\":0,\"components\":1,\"genus\":0,\"orientable\":true,\
             \"bounds\":{{\"min\":[-1,-1,-1],\"max\":[1,1,1]}},\"bytes\":{bytes},\"warnings\":[]}}"
        )
    );
    assert!(info.text().contains("faces           24\n"));
    run(&mut d, "limit on");
    let info = d.info(None).unwrap();
    assert!(info.json().contains("\"level\":1,\"limit\":true,") && info.text().contains("level 1, in the limit\n"));
    run(&mut d, "open builtin:moebius");
    let json = d.info(None).unwrap().json();
    assert!(json.contains("\"genus\":null,\"orientable\":false") && json.contains("one side only"), "{json}");
    assert_eq!(Document::new(1).info(None), None);
}

#[test]
fn the_limit_is_a_setting() {
    let mut d = document("open builtin:cube level 1");
    assert_eq!(run(&mut d, "limit on"), Outcome::Refine);
    assert_eq!(d.text(), "version 1\nopen builtin:cube\nscheme catmull-clark\nlimit on\nlevel 1\n");
    assert_eq!(d.link(), "#1;open+builtin:cube;scheme+catmull-clark;limit+on;level+1");
    let plan = d.plan().unwrap();
    let [there, before] = [plan.clone(), limn_mesh::Plan { limit: false, ..plan }]
        .map(|p| refine(d.mesh().unwrap(), &p, BUDGET).unwrap());
    // The cube's corner goes to 5/9 after one step; at the limit to 1/2 (4 and 1 over its faces: Halstead, Kass & DeRose).
    assert_eq!((before.points[0].map(f32::abs), there.points[0].map(f32::abs)), ([5.0 / 9.0; 3], [0.5; 3]));
    assert!(there.normals()[0].iter().all(|x| (x.abs() - 1.0 / 3f32.sqrt()).abs() < 1e-6));
    run(&mut d, "undo");
    assert!(!d.plan().unwrap().limit);
    run(&mut d, "redo");
    run(&mut d, "limit off");
    assert_eq!(d.link(), "#1;open+builtin:cube;scheme+catmull-clark;level+1");
}

fn line() -> impl Strategy<Value = String> {
    prop_oneof![
        (-1..6).prop_map(|n| format!("level {n}")),
        proptest::sample::select(vec![
            "scheme loop",
            "scheme linear",
            "scheme catmull-clark",
            "scheme bogus",
            "boundary edge-only",
            "boundary edge-and-corner",
            "weld exact",
            "weld off",
            "weld 0.3",
            "weld 0.05",
            "quads on",
            "quads off",
            "limit on",
            "limit off",
            "triangulate",
            "center",
            "scale 2",
            "scale",
            "scale 1e38",
            "undo",
            "undo",
            "undo",
            "redo",
            "redo",
            "open builtin:cube",
            "open builtin:moebius",
            "open builtin:tetrahedron",
            "view edges=on",
            "view camera=top",
        ])
        .prop_map(str::to_owned),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// The shared snapshots that undo and redo bring back are what a new document makes of the text.
    #[test]
    fn undo_and_redo_equal_replay(lines in proptest::collection::vec((line(), any::<bool>()), 1..24)) {
        let mut d = document("open builtin:grid");
        for (line, drag) in &lines {
            let before = d.text();
            let done = if *drag { d.drag(line) } else { d.run(line) };
            if done.is_err() {
                prop_assert_eq!(d.text(), before);
            }
            let again = document(&d.text());
            prop_assert_eq!(again.text(), d.text());
            prop_assert_eq!(again.mesh(), d.mesh());
            prop_assert_eq!(again.plan(), d.plan());
            prop_assert_eq!(again.soup(), d.soup());
            prop_assert_eq!(again.bounds(), d.bounds());
            prop_assert_eq!(again.remarks(), d.remarks());
            let linked = Document::from_link(&d.link()).unwrap();
            prop_assert_eq!(linked, d.commands());
        }
    }

    /// Undoing everything and redoing it passes the same states.
    #[test]
    fn undo_retraces_every_step(lines in proptest::collection::vec(line(), 1..16)) {
        let mut d = document("open builtin:grid");
        let model = |d: &Document| d.text().lines().filter(|l| !l.starts_with("view")).collect::<Vec<_>>().join("\n");
        let mut states = vec![model(&d)];
        for line in lines.iter().filter(|l| !l.ends_with("do")) {
            // Every change is one step, even where trimming keeps the number of steps as it was.
            if let Ok(Outcome::Refine | Outcome::Model) = d.run(line) {
                states.push(model(&d));
            }
        }
        let held = d.undo_depth().0;
        for back in 1..=held {
            run(&mut d, "undo");
            prop_assert_eq!(&model(&d), &states[states.len() - 1 - back]);
        }
        for back in (0..held).rev() {
            run(&mut d, "redo");
            prop_assert_eq!(&model(&d), &states[states.len() - 1 - back]);
        }
    }
}
