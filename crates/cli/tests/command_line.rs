//! The program as people run it: exact output, exit codes, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A folder of its own for a test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::create_dir_all(self.0.join(name).parent().unwrap()).unwrap();
        std::fs::write(self.0.join(name), content).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_limn"));
        command.args(arguments).current_dir(&self.0).stdin(Stdio::null());
        command
    }

    fn run(&self, line: &str) -> Run {
        Run::from(self.command(&line.split_whitespace().collect::<Vec<_>>()).output().unwrap())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[derive(Debug)]
struct Run {
    code: i32,
    out: String,
    err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Run {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Run { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Run {
    /// The output of a run that went well and had nothing to remark.
    fn ok(self) -> String {
        assert_eq!((self.code, self.err.as_str()), (0, ""), "{}", self.out);
        self.out
    }

    /// Exit code and the one line on standard error of a run that failed.
    fn failed(self) -> (i32, String) {
        assert_eq!(self.out, "");
        assert_eq!(self.err.lines().count(), 1, "{}", self.err);
        (self.code, self.err.trim_end().to_owned())
    }
}

/// The numbers of the `v` lines.
fn points(obj: &str) -> Vec<[f32; 3]> {
    obj.lines()
        .filter_map(|l| l.strip_prefix("v "))
        .map(|l| {
            let n: Vec<f32> = l.split(' ').map(|x| x.parse().unwrap()).collect();
            [n[0], n[1], n[2]]
        })
        .collect()
}

const SQUARE: &str = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4\n";

#[test]
fn info_is_one_json_object_on_standard_output() {
    let folder = Folder::new("info");
    assert_eq!(
        folder.run("builtin:cube level 1 info --json").ok(),
        "{\"name\":\"cube\",\"source\":\"builtin:cube\",\"scheme\":\"catmull-clark\",\"level\":1,\"limit\":false,\
         \"vertices\":26,\"edges\":48,\"faces\":24,\"boundary_loops\":0,\"components\":1,\"genus\":0,\"orientable\":true,\
         \"bounds\":{\"min\":[-1,-1,-1],\"max\":[1,1,1]},\"bytes\":792,\"warnings\":[]}\n"
    );
    // Bounds are those of the level: a Catmull-Clark cube shrinks after the first step, whose face points stay out.
    let json: serde_json::Value = serde_json::from_str(&folder.run("builtin:cube level 3 info --json").ok()).unwrap();
    let high = json["bounds"]["max"][0].as_f64().unwrap();
    assert!(high > 0.8 && high < 1.0, "{high}");
    // The three solids of Baumgartner's table 3.8 and the pawn: V, E, F.
    for (line, counts) in [
        ("builtin:pyramid scheme loop level 2 info --json", [50, 144, 96]),
        ("builtin:cube scheme catmull-clark level 2 info --json", [98, 192, 96]),
        ("builtin:pawn scheme loop level 2 info --json", [2434, 7296, 4864]),
        ("builtin:torus level 1 info --json", [512, 1024, 512]),
    ] {
        let json: serde_json::Value = serde_json::from_str(&folder.run(line).ok()).unwrap();
        assert_eq!(
            [&json["vertices"], &json["edges"], &json["faces"]],
            counts.map(serde_json::Value::from).each_ref(),
            "{line}"
        );
        assert_eq!(json["genus"], i32::from(line.contains("torus")));
    }
    let grid: serde_json::Value = serde_json::from_str(&folder.run("builtin:grid info --json").ok()).unwrap();
    assert_eq!([&grid["boundary_loops"], &grid["genus"], &grid["components"]], [&1, &0, &1]);
    // Without a command: the same for people.
    assert_eq!(
        folder.run("builtin:cube").ok(),
        "model           cube (builtin:cube)\nscheme          catmull-clark, level 0\nvertices        8\nedges           12\n\
         faces           6\nboundary loops  0\ncomponents      1\ngenus           0\nbounds          -1 -1 -1 to 1 1 1\n\
         memory          192 bytes\n"
    );
}

#[test]
fn export_has_full_precision_and_the_canonical_order() {
    let folder = Folder::new("export");
    assert_eq!(folder.run("builtin:cube scheme catmull-clark level 1 export out.obj").ok(), "");
    let p = points(&folder.read("out.obj"));
    assert_eq!(p.len(), 26);
    // Old vertices: (Q + 2 R + S (n - 3)) / n with n = 3 gives 5/9 of the corner; then the middles of the faces.
    for v in &p[..8] {
        assert!(v.iter().all(|x| (x.abs() - 5.0 / 9.0).abs() < 1e-6), "{v:?}");
    }
    let mut faces: Vec<[f32; 3]> = p[8..14].to_vec();
    faces.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(
        faces,
        [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    );
    // Edge points: (two ends + two face points) / 4, that is 3/4 twice and 0 once.
    for e in &p[14..] {
        let mut e = e.map(f32::abs);
        e.sort_by(f32::total_cmp);
        assert_eq!(e, [0.0, 0.75, 0.75]);
    }
    assert_eq!(folder.read("out.obj").lines().filter(|l| l.starts_with("f ")).count(), 24);
    // What is written reads back to the last bit.
    folder.run("builtin:creature level 2 export a.obj").ok();
    folder.run("a.obj export b.obj").ok();
    assert_eq!(points(&folder.read("a.obj")), points(&folder.read("b.obj")));
    // The Loop scheme keeps an octahedron's symmetry: corner 5/8 - (3/8 + cos(2 pi / 4) / 4)^2 away.
    folder.run("builtin:octahedron level 1 export o.obj").ok();
    let p = points(&folder.read("o.obj"));
    let beta = 5.0 / 8.0 - (3.0f64 / 8.0).powi(2);
    let corner = p[0].iter().fold(0.0f32, |m, x| m.max(x.abs()));
    assert!((f64::from(corner) - (1.0 - beta)).abs() < 1e-6, "{corner}");
    assert_eq!(p.len(), 18);
}

#[test]
fn glb_is_written_and_read_back() {
    let folder = Folder::new("glb");
    folder.write("square.obj", SQUARE);
    assert_eq!(folder.run("square.obj level 1 export out.GLB").ok(), "");
    let bytes = std::fs::read(folder.0.join("out.GLB")).unwrap();
    assert_eq!(&bytes[..4], b"glTF");
    let json: serde_json::Value = serde_json::from_str(&folder.run("--quiet out.GLB info --json").ok()).unwrap();
    assert_eq!(json["bounds"], serde_json::json!({"min": [0, 0, 0], "max": [4, 4, 0]}));
    assert_eq!((&json["vertices"], &json["faces"]), (&9.into(), &4.into()));
}

#[test]
fn negative_numbers_and_key_values_are_arguments() {
    let folder = Folder::new("words");
    assert_eq!(
        folder.run("builtin:cube level -1").failed(),
        (1, "error: there is no level -1: level 0 is the model itself and the lowest".into())
    );
    folder.run("builtin:cube view edges=bold camera=-20,-5,3,0,-1,0 level 1 export out.obj").ok();
    assert_eq!(points(&folder.read("out.obj")).len(), 26);
    let (code, message) = folder.run("builtin:cube scheme loop w=2").failed();
    assert_eq!(
        (code, message.as_str()),
        (1, "error: scheme loop w=2: the scheme loop has no parameter `w`; it takes weights")
    );
}

#[test]
fn edits_apply_in_order() {
    let folder = Folder::new("edits");
    folder.write("square.obj", SQUARE);
    folder.run("square.obj center scale 0.5 export out.obj").ok();
    assert_eq!(
        points(&folder.read("out.obj")),
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]
    );
    folder.run("square.obj boundary edge-only level 1 undo undo redo triangulate export out.obj").ok();
    let text = folder.read("out.obj");
    assert_eq!(text.lines().filter(|l| l.starts_with("f ")).collect::<Vec<_>>(), ["f 1 2 3", "f 1 3 4"]);
    // A smooth boundary moves corners to (1 6 1) / 8, a corner stays.
    folder.run("square.obj boundary edge-only level 1 export smooth.obj").ok();
    assert_eq!(points(&folder.read("smooth.obj"))[0], [0.5, 0.5, 0.0]);
    folder.run("square.obj level 1 export sharp.obj").ok();
    assert_eq!(points(&folder.read("sharp.obj"))[0], [0.0, 0.0, 0.0]);
}

#[test]
fn reports_go_to_standard_error_once() {
    let folder = Folder::new("report");
    let run = folder.run("builtin:cube scheme loop level 1 scheme linear scheme loop info --json");
    assert_eq!(
        (run.code, run.err.as_str()),
        (0, "warning: 6 faces were cut into triangles, which is what the scheme refines.\n")
    );
    assert!(run.out.contains("\"warnings\":[\"6 faces were cut into triangles, which is what the scheme refines.\"]"));
    assert_eq!(folder.run("--quiet builtin:cube scheme loop level 1").code, 0);
    assert_eq!(folder.run("-q builtin:cube scheme loop").err, "");
    folder.write("isolated.obj", format!("{SQUARE}v 9 9 9\n"));
    let run = folder.run("isolated.obj export out.obj");
    assert_eq!(run.err, "warning: 1 vertex position used by no face (first: 4) left out.\n");
}

#[test]
fn exit_codes_tell_kinds_of_failure_apart() {
    let folder = Folder::new("codes");
    folder.write("square.obj", SQUARE);
    folder.write("empty.obj", "");
    folder.write("points.obj", "v 0 0 0\n");
    folder.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    folder.write("noise.obj", [0u8, 159, 146, 150, 0, 0]);
    for (line, code, says) in [
        ("", 2, "Usage"),
        ("--bogus builtin:cube", 2, "--bogus"),
        ("builtin:cube levl 2", 2, "did you mean `level`?"),
        ("builtin:cube level", 2, "`level` needs a whole number"),
        ("builtin:cube level 1 x", 2, "`level` ends before `x`"),
        ("builtin:cube export out.stl", 2, "end it in .obj or .glb"),
        ("--memory lots builtin:cube", 2, "as in 500000000"),
        ("run", 2, "limn run script.limn"),
        ("builtin:cube undo", 1, "there is nothing to undo"),
        ("builtin:cube scheme nurbs", 1, "there is no scheme `nurbs`"),
        ("builtin:teapot", 3, "there is no built-in model `teapot`"),
        ("missing.obj", 3, "missing.obj cannot be read"),
        ("https://example.org/a.glb", 3, "download it"),
        ("empty.obj", 3, "empty"),
        ("points.obj", 3, "no faces"),
        ("broken.obj", 3, "ine 4"),
        ("noise.obj", 3, "noise.obj"),
        ("run missing.limn", 3, "missing.limn cannot be read"),
        ("builtin:cube level 100", 4, "level 100 would make more than 2^64 faces; choose level"),
        ("--memory 1M builtin:cube level 9", 4, "would make 1,572,864 faces"),
        ("--memory 10 square.obj", 4, "more than the memory budget of 10"),
        ("builtin:cube export nowhere/out.obj", 74, "cannot be written"),
    ] {
        let run = folder.run(line);
        assert_eq!(run.code, code, "{line}: {}", run.err);
        assert!(run.err.contains(says), "{line}: {}", run.err);
        assert_eq!(run.out, "", "{line}");
        if code != 2 {
            assert!(run.err.starts_with("error: ") && run.err.lines().count() == 1, "{line}: {}", run.err);
        }
    }
    // Nothing runs before all of the line is understood.
    let run = folder.run("builtin:cube export early.obj levl 2");
    assert_eq!(run.code, 2);
    assert!(!folder.0.join("early.obj").exists());
}

#[test]
fn scripts_run_line_by_line_next_to_their_models() {
    let folder = Folder::new("scripts");
    folder.write("deep/square.obj", SQUARE);
    folder.write(
        "deep/a.limn",
        "version 1\n# the square, once\nopen file:square.obj\nlevel 1\n\nexport \"my out.obj\"\ninfo --json\n",
    );
    let out = folder.run("run deep/a.limn").ok();
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["faces"], 4);
    // The stamp makes the source exact: a script made of it fails on another file of the same name.
    let source = json["source"].as_str().unwrap().to_owned();
    assert_eq!(points(&folder.read("my out.obj")).len(), 9);
    folder.write("deep/b.limn", format!("open {source}\n"));
    assert!(folder.run("run deep/b.limn").ok().starts_with(&format!("model           square ({source})\n")));
    folder.write("deep/square.obj", SQUARE.replace("v 4 4 0", "v 4 5 0"));
    let (code, message) = folder.run("run deep/b.limn").failed();
    assert_eq!(code, 3);
    assert!(message.contains("is not the file that was opened before: its content has changed"), "{message}");
    folder.write("bad.limn", "open builtin:cube\nlevel 1\nlevel x\n");
    assert_eq!(
        folder.run("run bad.limn").failed(),
        (2, "error: bad.limn, line 3: `level` takes a whole number, not `x`; it is written `level N`".into())
    );
    folder.write("early.limn", "level 1\n");
    assert_eq!(folder.run("run early.limn").failed().0, 1);
    folder.write("newer.limn", "version 2\nopen builtin:cube\n");
    assert_eq!(folder.run("run newer.limn").failed().0, 2);
    // From standard input, as another program would.
    use std::io::Write;
    let mut child = folder.command(&["run", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"open builtin:cube level 1 info --json").unwrap();
    let run = Run::from(child.wait_with_output().unwrap());
    assert!(run.out.contains("\"vertices\":26"));
}

#[test]
fn siblings_come_from_the_models_folder_and_no_other() {
    let folder = Folder::new("siblings");
    let model = |library: &str| format!("mtllib {library}\nusemtl red\n{SQUARE}");
    folder.write("m/model.obj", model("red.mtl"));
    folder.write("m/deep/nested.obj", model("../red.mtl"));
    folder.write("m/below.obj", model("mtl/blue.mtl"));
    folder.write("m/red.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("m/mtl/blue.mtl", "newmtl red\nKd 0 0 1\n");
    folder.run("m/model.obj export out.obj").ok();
    assert_eq!(folder.read("out.mtl"), "newmtl red\nKd 1 0 0\nd 1\n");
    folder.run("m/below.obj export out.obj").ok();
    assert_eq!(folder.read("out.mtl"), "newmtl red\nKd 0 0 1\nd 1\n");
    // A path that leaves the folder is not followed.
    let run = folder.run("m/deep/nested.obj export out2.obj");
    assert_eq!(run.code, 0);
    assert!(run.err.contains("red.mtl") && run.err.contains("missing"), "{}", run.err);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.0.join("m/red.mtl"), folder.0.join("m/deep/link.mtl")).unwrap();
        folder.write("m/deep/linked.obj", model("link.mtl"));
        assert!(folder.run("m/deep/linked.obj export out3.obj").err.contains("missing"));
    }
}

#[test]
fn reload_reads_the_file_again() {
    let folder = Folder::new("reload");
    folder.write("square.obj", SQUARE);
    folder.run("square.obj scale 2 reload export out.obj").ok();
    assert_eq!(points(&folder.read("out.obj"))[2], [8.0, 8.0, 0.0]);
}

#[test]
fn help_is_enough() {
    let folder = Folder::new("help");
    let help = folder.run("--help").ok();
    for part in [
        "limn [OPTIONS] SOURCE",
        "--memory <BYTES>",
        "scheme ID [KEY=VALUE ...]",
        "export FILE",
        "Exit codes:",
        "74  a file",
        "creature, pawn",
        "catmull-clark, loop, ",
        "limn run script.limn",
    ] {
        assert!(help.contains(part), "{part} is not in\n{help}");
    }
    assert_eq!(folder.run("help").ok(), help);
    assert_eq!(
        folder.run("help level").ok(),
        "level N\n  show the model refined N times; 0 is the model itself.\n  \
         A level that does not fit the memory budget is refused with its predicted counts.\n  Example: level 3\n"
    );
    assert!(folder.run("help view").ok().contains("    edges=off|on|bold|only\n"));
    assert_eq!(
        folder.run("help teapot").failed(),
        (2, "error: there is no command `teapot`; `limn help` lists them".into())
    );
    assert_eq!(folder.run("--version").ok(), format!("limn {}\n", env!("CARGO_PKG_VERSION")));
    let schemes = folder.run("schemes").ok();
    let mut lines = schemes.lines().skip_while(|l| !l.starts_with("loop "));
    assert!(lines.next().is_some_and(|l| l.contains("  Loop (approximating). ")), "{schemes}");
    assert!(
        lines.next().is_some_and(|l| l.trim_start().starts_with("weights= loop or warren; loop unless set. ")),
        "{schemes}"
    );
}
