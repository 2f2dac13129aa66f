//! The panel's rows, held against the commands that they send.

use super::*;

fn value<'a>(values: &'a Values, id: &str) -> &'a str {
    &values.0.iter().find(|v| v.0 == id).unwrap().1
}

#[test]
fn every_choice_is_a_command_that_chooses_it() {
    let mut document = Document::new(1 << 30);
    document.run("open builtin:pawn").unwrap();
    for control in CONTROLS {
        for choice in control.choices {
            document.run(choice.command).unwrap_or_else(|e| panic!("{}: {e}", choice.command));
            if control.kind != "actions" {
                assert_eq!(value(&values(&document), control.id), choice.value, "{}", choice.command);
            }
        }
    }
}

#[test]
fn every_scheme_s_parameters_are_set_by_their_own_commands() {
    for entry in limn_mesh::SCHEMES {
        let mut document = Document::new(1 << 30);
        assert_eq!(parameters(&document), []);
        document.run("open builtin:pawn").unwrap();
        document.run(&format!("scheme {}", entry.info.id)).unwrap();
        for at in 0..entry.info.params.len() {
            let row = parameters(&document).swap_remove(at);
            let param = &entry.info.params[at];
            assert_eq!((row.key, row.value, row.default), (param.key, param.domain.default(), param.domain.default()));
            let lines = match row.kind {
                "number" | "whole" => {
                    assert!(row.choices.is_empty() && row.low < row.high);
                    [row.low, row.high].map(|v| (v.to_string(), format!("{}{v}", row.command))).to_vec()
                }
                _ => row.choices.iter().rev().map(|c| (c.value.to_owned(), c.command.clone())).collect(),
            };
            let others = |rows: Vec<Parameter>| {
                rows.into_iter().map(|r| r.text).enumerate().filter(|r| r.0 != at).collect::<Vec<_>>()
            };
            let before = others(parameters(&document));
            for (text, line) in lines {
                document.run(&line).unwrap_or_else(|e| panic!("{line}: {e}"));
                assert_eq!(parameters(&document)[at].text, text, "{line}");
                assert_eq!(others(parameters(&document)), before, "{line} keeps the others");
            }
            // Set to something at last, so that the next ones have something to keep.
            let word = row.choices.last().map_or(row.high.to_string(), |c| c.value.to_owned());
            document.run(&format!("{}{word}", row.command)).unwrap();
        }
    }
}

#[test]
fn later_schemes_can_be_left_out() {
    let mut document = Document::new(1 << 30);
    assert_eq!(runs(&document), []);
    document.run("open builtin:pawn").unwrap();
    document.run("scheme loop weights=warren").unwrap();
    document.run("scheme butterfly from=1 w=0.05").unwrap();
    document.run("scheme catmull-clark from=3").unwrap();
    let rows = runs(&document);
    assert_eq!(
        rows.iter().map(|r| (r.from, &*r.name)).collect::<Vec<_>>(),
        [(1, "Butterfly, w 0.05"), (3, "Catmull–Clark")]
    );
    assert_eq!(rows[1].leave, "scheme butterfly from=3 w=0.05");
    document.run(&rows[1].leave).unwrap();
    assert_eq!(runs(&document), rows[..1]);
    document.run(&rows[0].leave).unwrap();
    assert_eq!(runs(&document), []);
    assert!(document.text().contains("scheme loop weights=warren"));
}

#[test]
fn butterfly_s_tension_and_loop_s_weights() {
    let mut document = Document::new(1 << 30);
    document.run("open builtin:pawn").unwrap();
    document.run("scheme butterfly w=0.05").unwrap();
    let [tension] = &parameters(&document)[..] else { panic!("one parameter") };
    assert_eq!((tension.name, tension.kind, &*tension.text), ("Tension", "number", "0.05"));
    assert_eq!([tension.low, tension.high, tension.default, tension.value], [0.0, 0.125, 0.0625, 0.05]);
    assert_eq!(tension.command, "scheme butterfly w=");
    document.run("scheme loop weights=warren").unwrap();
    let [weights] = &parameters(&document)[..] else { panic!("one parameter") };
    assert_eq!((&*weights.text, weights.value, weights.choices[1].label.as_str()), ("warren", 1.0, "Warren"));
    assert_eq!(weights.choices[0].command, "scheme loop weights=loop");
    document.run("scheme linear").unwrap();
    assert_eq!(parameters(&document), []);
}

#[test]
fn rows_that_make_no_difference_are_off() {
    let disabled = |document: &Document| disabled(document, &Facts::of(document, document.mesh().unwrap()));
    let mut document = Document::new(1 << 30);
    document.run("open builtin:cube").unwrap();
    assert_eq!(
        disabled(&document),
        ["textures", "colors", "kinds", "boundary", "crease-decay", "face-varying", "quads", "triangle-rule"]
    );
    document.run("open builtin:grid").unwrap();
    assert!(!disabled(&document).contains(&"boundary"));
    document.run("open builtin:pawn").unwrap();
    assert_eq!(
        disabled(&document),
        ["textures", "colors", "kinds", "boundary", "crease-decay", "face-varying", "triangle-rule"]
    );
    document.run("scheme linear").unwrap();
    assert!(disabled(&document).contains(&"limit"));
    document.run("scheme catmull-clark").unwrap();
    document.run("crease angle 30 2").unwrap();
    assert_eq!(disabled(&document), ["textures", "colors", "kinds", "boundary", "face-varying"]);
    document.run("scheme doo-sabin").unwrap();
    assert!(disabled(&document).contains(&"kinds"), "level 0 has no kinds");
    document.run("level 1").unwrap();
    assert!(!disabled(&document).contains(&"kinds"));
}

/// An orbiting camera asks five times a second: the answers are those of the facts, whatever polygons there are by now.
#[test]
fn what_a_moving_camera_sends_walks_over_no_polygons() {
    let mut open = Document::new(1 << 30);
    open.run("open builtin:grid").unwrap();
    let mut document = Document::new(1 << 30);
    document.run("open builtin:pawn").unwrap();
    let of = |document: &Document| Facts::of(document, document.mesh().unwrap());
    let (grid, pawn) = (of(&open), of(&document));
    let off = |facts: &Facts, row: &str| disabled(&document, facts).contains(&row);
    for row in ["quads", "boundary"] {
        assert_ne!(off(&grid, row), off(&pawn, row), "{row}");
    }
}

#[test]
fn the_view_s_defaults_are_among_the_choices() {
    let document = Document::new(1 << 30);
    let values = values(&document);
    for control in CONTROLS.iter().filter(|c| c.tab == "view" && c.kind != "actions") {
        let value = value(&values, control.id);
        assert!(control.choices.iter().any(|c| c.value == value), "{} {value}", control.id);
    }
}
