//! Commands for creases, corners, holes, knots, fairing and schemes from a level on: what they do, that text and undo hold
//! them, and what is refused.

use limn_document::Document;
use limn_mesh::Connectivity;

fn document(source: &str) -> Document {
    let mut d = Document::new(1 << 30);
    d.run(&format!("open builtin:{source}")).unwrap();
    d
}

/// Runs a line; the text then has `kept` (empty: does not have the command at all), replaying it gives the same text, and
/// undo and redo go back and forth.
fn keeps(d: &mut Document, line: &str, kept: &str) {
    let before = d.text();
    d.run(line).unwrap_or_else(|e| panic!("{line}: {e}"));
    let text = d.text();
    if kept.is_empty() {
        let name = line.split(' ').next().unwrap();
        assert!(!text.lines().any(|l| l.starts_with(&format!("{name} "))), "{line}: {text}");
    } else {
        assert!(text.lines().any(|l| l == kept), "{line}: {text}");
    }
    let mut again = Document::new(1 << 30);
    text.lines().for_each(|l| _ = again.run(l).unwrap_or_else(|e| panic!("{l}: {e}")));
    assert_eq!(again.text(), text);
    assert_eq!(again.plan(), d.plan());
    assert_eq!(again.mesh().unwrap(), d.mesh().unwrap());
    if text != before {
        d.run("undo").unwrap();
        assert_eq!(d.text(), before, "{line} undone");
        d.run("redo").unwrap();
    }
    assert_eq!(d.text(), text);
    let link = Document::from_link(&d.link()).unwrap();
    let mut linked = Document::new(1 << 30);
    linked.replay(&link).unwrap();
    assert_eq!(linked.text(), text, "{line} in a link");
}

#[test]
fn creases_and_corners() {
    let mut d = document("cube");
    keeps(&mut d, "crease 0-1 2.5", "crease 0-1 2.5");
    let sharp = |d: &Document| {
        let mesh = d.mesh().unwrap();
        let t = &mesh.topology;
        let ends = |e: u32| {
            let h = t.edge_half_edge(e);
            let [a, b] = [t.origin(h), t.origin(t.next(h))];
            [a.min(b), a.max(b)]
        };
        let mut all: Vec<([u32; 2], f32)> =
            mesh.edge_sharpness.iter().enumerate().filter(|e| *e.1 > 0.0).map(|(e, s)| (ends(e as u32), *s)).collect();
        all.sort_by_key(|edge| edge.0);
        all
    };
    assert_eq!(sharp(&d), [([0, 1], 2.5)]);
    keeps(&mut d, "crease 1-0 inf", "crease 1-0 10");
    assert_eq!(sharp(&d), [([0, 1], 10.0)]);
    keeps(&mut d, "crease none", "crease none");
    assert_eq!(sharp(&d), []);
    // All twelve edges of a cube turn by 90 degrees.
    keeps(&mut d, "crease angle 89 3", "crease angle 89 3");
    assert_eq!(sharp(&d).len(), 12);
    keeps(&mut d, "crease none", "crease none");
    keeps(&mut d, "crease angle 90 3", "crease angle 90 3");
    assert_eq!(sharp(&d).len(), 0, "more than, not from");
    keeps(&mut d, "corner 7 inf", "corner 7 10");
    let corners: Vec<usize> =
        d.mesh().unwrap().vertex_sharpness.iter().enumerate().filter(|v| *v.1 > 0.0).map(|v| v.0).collect();
    assert_eq!(corners, [7]);
    keeps(&mut d, "crease-decay chaikin", "crease-decay chaikin");
    keeps(&mut d, "crease-decay uniform", "");
    keeps(&mut d, "triangle-rule smooth", "triangle-rule smooth");
    keeps(&mut d, "triangle-rule catmull-clark", "");
    keeps(&mut d, "face-varying boundaries", "face-varying boundaries");
    keeps(&mut d, "face-varying all", "face-varying all");
    keeps(&mut d, "hole 3", "hole 3");
    assert_eq!(d.mesh().unwrap().holes, [false, false, false, true, false, false]);
    // Cut into triangles, both halves are holes; a triangle scheme's own triangulation likewise.
    keeps(&mut d, "scheme loop", "scheme loop");
    assert_eq!(d.mesh().unwrap().holes.iter().filter(|h| **h).count(), 2);
}

#[test]
fn a_chain_is_many_edges() {
    let mut d = document("cube");
    let ring = {
        let mesh = d.mesh().unwrap();
        let t = &mesh.topology;
        let mut v: Vec<String> = t.face_half_edges(0).map(|h| t.origin(h).to_string()).collect();
        v.push(v[0].clone());
        v.join("-")
    };
    keeps(&mut d, &format!("crease {ring} 1.5"), &format!("crease {ring} 1.5"));
    assert_eq!(d.mesh().unwrap().edge_sharpness.iter().filter(|s| **s == 1.5).count(), 4);
}

#[test]
fn knots_and_fairing() {
    let mut d = document("cube");
    let (a, b) = {
        let t = &d.mesh().unwrap().topology;
        (t.origin(0), t.origin(t.next(0)))
    };
    keeps(&mut d, &format!("knot {a}-{b} 0.5"), &format!("knot {a}-{b} 0.5"));
    let knots = |d: &Document| [d.mesh().unwrap().knots[0], d.mesh().unwrap().knots[1]];
    assert_eq!(knots(&d), [0.5, 1.0]);
    keeps(&mut d, &format!("knot {a}={b} 0.25"), &format!("knot {a}={b} 0.25"));
    assert_eq!(knots(&d), [0.25, 0.25]);
    keeps(&mut d, "fair taubin 10 at=2", "fair taubin 10 at=2");
    keeps(&mut d, "fair taubin 5", "fair taubin 5");
    keeps(&mut d, "fair taubin 7 at=0", "fair taubin 7");
    assert_eq!(d.plan().unwrap().fairings.iter().map(|f| (f.at, f.iterations)).collect::<Vec<_>>(), [(0, 7), (2, 10)]);
    keeps(&mut d, "fair taubin 0 at=2", "fair taubin 7");
    keeps(&mut d, "fair taubin 0", "");
}

#[test]
fn a_scheme_from_a_level_on() {
    let mut d = document("cube");
    keeps(&mut d, "scheme doo-sabin", "scheme doo-sabin");
    keeps(&mut d, "scheme catmull-clark from=1", "scheme catmull-clark from=1");
    keeps(&mut d, "scheme linear from=3", "scheme linear from=3");
    d.run("level 4").unwrap();
    let runs = |d: &Document| {
        let plan = d.plan().unwrap();
        (0..4).map(|step| plan.run(step).scheme.info.id).collect::<Vec<_>>()
    };
    assert_eq!(runs(&d), ["doo-sabin", "catmull-clark", "catmull-clark", "linear"]);
    // From 2 on for good: what came at 3 goes.
    keeps(&mut d, "scheme linear from=2", "scheme linear from=2");
    assert_eq!(runs(&d), ["doo-sabin", "catmull-clark", "linear", "linear"]);
    // What is there already is only told other parameters, and takes over from no equal.
    keeps(&mut d, "scheme doo-sabin", "scheme catmull-clark from=1");
    keeps(&mut d, "scheme doo-sabin from=1", "scheme doo-sabin");
    assert_eq!(runs(&d), ["doo-sabin"; 4]);
    keeps(&mut d, "scheme linear from=1", "scheme linear from=1");
    keeps(&mut d, "scheme catmull-clark", "scheme catmull-clark");
    assert!(d.plan().unwrap().later.is_empty(), "another first scheme goes all the way");
}

#[test]
fn a_later_scheme_s_parameters() {
    let mut d = document("pawn");
    d.run("scheme loop").unwrap();
    keeps(&mut d, "scheme butterfly from=2 w=0.05", "scheme butterfly from=2 w=0.05");
    keeps(&mut d, "scheme loop weights=warren", "scheme butterfly from=2 w=0.05");
    keeps(&mut d, "scheme butterfly w=0.01 from=2", "scheme butterfly from=2 w=0.01");
}

#[test]
fn what_is_refused() {
    let mut d = document("cube");
    let before = d.text();
    for (line, why) in [
        ("crease 0-7 1", "no edge joins vertices 0 and 7; vertices are numbered from 0 as in the file"),
        ("crease 0-99 1", "there is no vertex 99; the model has 8, numbered from 0"),
        ("corner 8 1", "there is no vertex 8; the model has 8, numbered from 0"),
        ("hole 6", "there is no face 6; the model has 6, numbered from 0"),
        ("knot 0-7 1", "no edge joins vertices 0 and 7; vertices are numbered from 0 as in the file"),
        ("crease 0-1", "`crease` needs other arguments; it is written `crease A-B-...|angle|none [DEG] [S]`"),
        ("crease angle 200 1", "`crease` needs other arguments; it is written `crease A-B-...|angle|none [DEG] [S]`"),
        ("crease angle 20", "`crease` needs other arguments; it is written `crease A-B-...|angle|none [DEG] [S]`"),
        (
            "crease 0 1",
            "`crease` takes angle or none or vertices joined by hyphens, as in 4-5-9, not `0`; it is written `crease A-B-...|angle|none [DEG] [S]`",
        ),
        ("corner 0 -1", "`corner` takes a number from 0 up, or inf, not `-1`; it is written `corner V S`"),
        ("fair taubin 10 from=1", "`fair` does not know the key `from`; it knows at"),
        ("fair taubin -1", "-1 iterations are not possible; a whole number from 0 to 1000 is"),
        ("fair taubin 2000", "2000 iterations are not possible; a whole number from 0 to 1000 is"),
        ("fair taubin 2 at=99", "`at=99` is not possible; at is a level from 0 to 31"),
        ("scheme linear from=-1", "`from=-1` is not possible; from is a level from 0 to 31"),
    ] {
        assert_eq!(d.run(line).unwrap_err().to_string(), why, "{line}");
        assert_eq!(d.text(), before);
    }
    // A scheme of triangles behind quads is refused where it would begin, and only there.
    d.run("scheme loop from=2").unwrap();
    d.run("level 2").unwrap();
    let error = d.run("level 3").unwrap_err().to_string();
    assert!(error.contains("the faces of level 2 are not; put `scheme poke from=2` between"), "{error}");
}
