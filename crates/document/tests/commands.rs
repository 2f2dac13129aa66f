//! The grammar: what is written is what is read, and what cannot be read is said in one sentence.

use limn_document::command::{COMMANDS, Command, SchemeWords, complete, parse_all, parse_script, spec};
use limn_document::view::{Background, CameraSet, Edges, Shading, VIEW_KEYS};
use limn_document::{Source, Stamp, ViewSet, camera};
use limn_mesh::{Boundary, Weld};
use proptest::prelude::*;

fn message(line: &str) -> String {
    line.parse::<Command>().unwrap_err().to_string()
}

#[test]
fn every_row_has_an_example_that_comes_back_as_written() {
    for row in COMMANDS {
        let command: Command = row.example.parse().unwrap_or_else(|e| panic!("{}: {e}", row.example));
        assert_eq!(command.name(), row.name);
        assert_eq!(command.class(), row.class);
        assert_eq!(command.to_string(), row.example);
        assert!(row.usage().starts_with(row.name) && row.help().contains(row.summary));
    }
}

#[test]
fn the_usage_lines_are_what_people_type() {
    let usage = |name: &str| spec(name).unwrap().usage();
    assert_eq!(usage("scheme"), "scheme ID [KEY=VALUE ...]");
    assert_eq!(usage("weld"), "weld exact|EPS|off");
    assert_eq!(usage("scale"), "scale [S]");
    assert_eq!(usage("info"), "info [--json]");
    assert_eq!(usage("boundary"), "boundary none|edge-only|edge-and-corner");
}

#[test]
fn several_commands_stand_in_a_line() {
    let line =
        "scheme catmull-clark s=0.5 level -1 scale scale 2 view edges=bold cage=on info --json help level export level";
    let words: Vec<&str> = line.split(' ').collect();
    let texts: Vec<String> = parse_all(&words).unwrap().iter().map(Command::to_string).collect();
    assert_eq!(
        texts,
        [
            "scheme catmull-clark s=0.5",
            "level -1",
            "scale",
            "scale 2",
            "view edges=bold cage=on",
            "info --json",
            "help level",
            "export level",
        ]
    );
}

#[test]
fn scripts_have_comments_blank_lines_and_line_numbers() {
    let script = "version 1\n\n# a cube\nopen builtin:cube  # six quads\r\n  level 2 info\n";
    let texts: Vec<String> = parse_script(script).unwrap().iter().map(Command::to_string).collect();
    assert_eq!(texts, ["version 1", "open builtin:cube", "level 2", "info"]);
    let error = parse_script("open builtin:cube\n\nlevel two\n").unwrap_err().to_string();
    assert_eq!(error, "line 3: `level` takes a whole number, not `two`; it is written `level N`");
}

#[test]
fn errors_say_what_and_what_to_do() {
    assert_eq!(message(""), "there is no command here; `help` lists them");
    assert_eq!(message("levle 2"), "there is no command `levle`; did you mean `level`?");
    assert_eq!(message("frobnicate"), "there is no command `frobnicate`; `help` lists them");
    assert_eq!(message("level"), "`level` needs a whole number; it is written `level N`");
    assert_eq!(message("level 2 3"), "`level` ends before `3`; it is written `level N`");
    assert_eq!(
        message("level 99999999999"),
        "`level` takes a whole number, not `99999999999`; it is written `level N`"
    );
    assert_eq!(message("scale -2"), "`scale` ends before `-2`; it is written `scale [S]`");
    assert_eq!(message("quads maybe"), "`quads` takes on or off, not `maybe`; it is written `quads on|off`");
    assert_eq!(
        message("open cube"),
        "`open` takes builtin:NAME, file:NAME or a web address, not `cube`; it is written `open SOURCE`"
    );
    assert_eq!(message("view"), "`view` needs at least one KEY=VALUE; it is written `view KEY=VALUE ...`");
    assert_eq!(message("view edges=dotted"), "`view edges=` takes off|on|bold|only, not `dotted`");
    assert!(message("view colour=red").starts_with("`view` does not know the key `colour`; it knows shading, edges,"));
    assert_eq!(message("export \"a b"), "the quote that opens at character 8 is never closed; add a closing \"");
    let words = ["level", "2", "nonsense"];
    assert_eq!(parse_all(&words).unwrap_err().to_string(), "`level` ends before `nonsense`; it is written `level N`");
}

#[test]
fn values_out_of_range_are_no_values() {
    for bad in [
        "weld 0",
        "weld -1e-3",
        "weld 0.2",
        "weld nan",
        "scale 0",
        "scale inf",
        "view fov=4",
        "view fov=121",
        "view fov=nan",
        "view camera=0,91,1,0,0,0",
        "view camera=0,0,0,0,0,0",
        "view camera=0,0,1,0,0",
        "view camera=0,0,1,0,0,inf",
        "view background=12345",
        "view background=gggggg",
        "view hide=%2",
        "view hide=%ff",
        "scheme Loop",
    ] {
        assert!(bad.parse::<Command>().is_err(), "{bad}");
    }
    assert_eq!("view background=#Fa0".parse::<Command>().unwrap().to_string(), "view background=ffaa00");
    assert_eq!("view camera=-190,0,1,0,0,0".parse::<Command>().unwrap().to_string(), "view camera=170,0,1,0,0,0");
}

#[test]
fn completion_knows_commands_arguments_and_keys() {
    assert_eq!(complete("le"), ["level"]);
    assert_eq!(complete("re"), ["redo", "reload"]);
    assert_eq!(complete("boundary "), ["none", "edge-only", "edge-and-corner"]);
    assert_eq!(complete("open builtin:t"), ["builtin:t-shape", "builtin:torus", "builtin:tetrahedron"]);
    assert_eq!(complete("scheme ").len(), limn_mesh::SCHEMES.len());
    assert_eq!(complete("scheme mod"), ["modified-butterfly"]);
    assert_eq!(complete("view sh"), ["shading="]);
    assert_eq!(complete("view edges=o"), ["edges=off", "edges=on", "edges=only"]);
    assert_eq!(complete("view edges=on cam"), ["camera="]);
    assert_eq!(complete("level 2 inf"), ["info"]);
    assert_eq!(complete("info "), ["--json"]);
    assert_eq!(complete("level "), Vec::<String>::new());
    assert_eq!(complete("nonsense "), Vec::<String>::new());
    assert_eq!(complete("").len(), COMMANDS.len());
}

#[test]
fn every_word_of_every_key_is_taken() {
    for key in VIEW_KEYS {
        for word in key.words {
            let text = format!("view {}={word}", key.name);
            assert_eq!(text.parse::<Command>().unwrap().to_string(), text);
        }
    }
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![-1e3_f32..1e3, -1e30_f32..1e30, Just(0.0), Just(1e-30)]
}

fn source() -> impl Strategy<Value = Source> {
    prop_oneof![
        "[a-z][a-z-]{0,8}".prop_map(Source::Builtin),
        (".+", any::<u64>(), any::<u64>())
            .prop_map(|(name, size, hash)| Source::File { name, stamp: Some(Stamp { size, hash }) }),
        "[^,]+".prop_map(|name| Source::File { name, stamp: None }),
        "https?://.*".prop_map(Source::Url),
    ]
}

fn set() -> impl Strategy<Value = ViewSet> {
    let pose = (-179.9_f32..180.0, -90.0_f32..=90.0, 1e-6_f32..1e6, [number(), number(), number()])
        .prop_map(|(yaw, pitch, distance, target)| CameraSet::Pose { yaw, pitch, distance, target });
    prop_oneof![
        prop_oneof![Just(Shading::Smooth), Just(Shading::Flat)].prop_map(ViewSet::Shading),
        prop_oneof![Just(Edges::Off), Just(Edges::On), Just(Edges::Bold), Just(Edges::Only)].prop_map(ViewSet::Edges),
        any::<bool>().prop_map(ViewSet::Points),
        any::<bool>().prop_map(ViewSet::Cage),
        any::<bool>().prop_map(ViewSet::TwoSided),
        any::<bool>().prop_map(ViewSet::Textures),
        any::<bool>().prop_map(ViewSet::Colors),
        any::<bool>().prop_map(ViewSet::Kinds),
        any::<[u8; 3]>().prop_map(|c| ViewSet::Background(Background::Color(c))),
        Just(ViewSet::Background(Background::Transparent)),
        proptest::collection::btree_set(any::<String>(), 0..4).prop_map(|n| ViewSet::Hide(n.into_iter().collect())),
        Just(ViewSet::Up(camera::UpAxis::Z)),
        Just(ViewSet::Projection(camera::Projection::Orthographic)),
        (5.0_f32..=120.0).prop_map(ViewSet::Fov),
        pose.prop_map(ViewSet::Camera),
        proptest::sample::select(&camera::Standard::ALL[..]).prop_map(|s| ViewSet::Camera(CameraSet::Standard(s))),
        Just(ViewSet::Camera(CameraSet::Fit)),
    ]
}

/// Any command that can be said.
fn command() -> impl Strategy<Value = Command> {
    let parameters = proptest::collection::vec(("[a-z][a-z0-9-]{0,4}", any::<String>()), 0..3);
    prop_oneof![
        source().prop_map(Command::Open),
        prop_oneof![Just(Weld::Exact), Just(Weld::Off), (1e-9_f32..0.1).prop_map(Weld::Relative)]
            .prop_map(Command::Weld),
        any::<bool>().prop_map(Command::Quads),
        Just(Command::Triangulate),
        Just(Command::Center),
        proptest::option::of(1e-30_f32..1e30).prop_map(Command::Scale),
        ("[a-z][a-z0-9-]{0,12}", parameters.clone()).prop_map(|(id, parameters)| Command::Scheme { id, parameters }),
        // No scheme has the name of a command.
        proptest::collection::vec(("[a-z][a-z0-9]{0,6}-scheme", parameters), 0..4).prop_map(|panes| {
            Command::Compare(panes.into_iter().map(|(id, parameters)| SchemeWords { id, parameters }).collect())
        }),
        prop_oneof![Just(Boundary::EdgeOnly), Just(Boundary::EdgeAndCorner)].prop_map(Command::Boundary),
        any::<i32>().prop_map(Command::Level),
        proptest::collection::vec(set(), 1..4).prop_map(Command::View),
        any::<bool>().prop_map(|json| Command::Info { json }),
        ".+".prop_map(|file| Command::Export { file }),
        Just(Command::Undo),
        Just(Command::Redo),
        Just(Command::Reload),
        any::<i32>().prop_map(Command::Version),
        proptest::option::of(0..COMMANDS.len()).prop_map(|i| Command::Help(i.map(|i| COMMANDS[i].name))),
    ]
}

proptest! {
    #[test]
    fn what_is_written_is_what_is_read(command in command()) {
        let text = command.to_string();
        prop_assert!(!text.contains(['\n', '\r']));
        prop_assert_eq!(&text.parse::<Command>().unwrap(), &command, "{}", text);
    }

    #[test]
    fn commands_in_a_row_stay_apart(commands in proptest::collection::vec(command(), 0..6)) {
        let script: String = commands.iter().map(|c| format!("{c}\n")).collect();
        prop_assert_eq!(&parse_script(&script).unwrap(), &commands);
    }

    #[test]
    fn links_bring_back_any_command(first in source(), commands in proptest::collection::vec(command(), 0..6)) {
        let mut said = vec![Command::Open(first)];
        said.extend(commands.into_iter().filter(|c| c.class() != limn_document::Class::Action));
        let link = limn_document::link::write(said.iter().map(Command::to_string));
        prop_assert!(link.bytes().all(|b| b.is_ascii_graphic() && !b"<>\"'`{}|\\^".contains(&b)), "{}", link);
        prop_assert_eq!(&limn_document::link::read(&link).unwrap(), &said, "{}", link);
    }

    #[test]
    fn no_text_makes_the_parser_or_completion_panic(line in ".*") {
        let _ = line.parse::<Command>();
        let _ = parse_script(&line);
        let _ = complete(&line);
        let _ = limn_document::link::read(&line);
    }
}
