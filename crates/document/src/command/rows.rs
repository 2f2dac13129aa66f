//! The commands themselves, a row each: see [`super::table`] for what a row says.

use limn_mesh::{Boundary, Decay, FaceVarying, TriangleRule};

use super::table::{Class, Keys, Kind, Spec, Value, arg, maybe};
use super::{Command, CreaseWhere, SchemeWords};

const SWITCH: Kind = Kind::Word(&["on", "off"]);

fn is_on(value: Option<Value>) -> Option<bool> {
    match value? {
        Value::Word(word) => Some(word == "on"),
        _ => None,
    }
}

/// The words of the face-varying rules, in their order.
pub(super) const FACE_VARYING: [&str; 6] =
    ["none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"];

const RULES: [FaceVarying; 6] = [
    FaceVarying::None,
    FaceVarying::CornersOnly,
    FaceVarying::CornersPlus1,
    FaceVarying::CornersPlus2,
    FaceVarying::Boundaries,
    FaceVarying::All,
];

fn face_varying(word: &str) -> Option<FaceVarying> {
    FACE_VARYING.iter().position(|w| *w == word).and_then(|i| RULES.get(i).copied())
}

/// The word of a face-varying rule.
pub(super) fn face_varying_word(rule: FaceVarying) -> &'static str {
    RULES.iter().position(|r| *r == rule).and_then(|i| FACE_VARYING.get(i).copied()).unwrap_or_default()
}

/// Every command, in the order in which help lists them.
pub static COMMANDS: &[Spec] = &[
    Spec {
        name: "open",
        class: Class::Model,
        args: &[arg("SOURCE", Kind::Source)],
        flags: &[],
        keys: Keys::None,
        summary: "open a model: builtin:NAME, file:NAME,SIZE,HASH or a web address",
        detail: "Models of triangles open in Loop, others in Catmull-Clark, at level 0.",
        example: "open builtin:cube",
        build: |p| match p.values.into_iter().next()? {
            Value::Source(source) => Some(Command::Open(source)),
            _ => None,
        },
    },
    Spec {
        name: "weld",
        class: Class::Setting,
        args: &[arg("HOW", Kind::Weld)],
        flags: &[],
        keys: Keys::None,
        summary: "which vertices of the file are one: those in the same place, those nearer than EPS, or none",
        detail: "EPS is a fraction of the bounding box's diagonal. At first as the format needs it: exact for glTF, off for OBJ.",
        example: "weld exact",
        build: |p| match p.values.into_iter().next()? {
            Value::Weld(weld) => Some(Command::Weld(weld)),
            _ => None,
        },
    },
    Spec {
        name: "quads",
        class: Class::Setting,
        args: &[arg("SWITCH", SWITCH)],
        flags: &[],
        keys: Keys::None,
        summary: "pair triangles back to quads",
        detail: "Turned on while the scheme is one for triangles, it changes that to catmull-clark.",
        example: "quads on",
        build: |p| Some(Command::Quads(is_on(p.values.into_iter().next())?)),
    },
    Spec {
        name: "triangulate",
        class: Class::Model,
        args: &[],
        flags: &[],
        keys: Keys::None,
        summary: "split every face into triangles by its shortest diagonals",
        detail: "",
        example: "triangulate",
        build: |_| Some(Command::Triangulate),
    },
    Spec {
        name: "center",
        class: Class::Model,
        args: &[],
        flags: &[],
        keys: Keys::None,
        summary: "move the middle of the bounding box to the origin",
        detail: "",
        example: "center",
        build: |_| Some(Command::Center),
    },
    Spec {
        name: "scale",
        class: Class::Model,
        args: &[maybe("S", Kind::Positive)],
        flags: &[],
        keys: Keys::None,
        summary: "multiply all coordinates by S",
        detail: "Without S the longest side of the bounding box becomes 1.",
        example: "scale 2.5",
        build: |p| match p.values.into_iter().next() {
            Some(Value::Number(s)) => Some(Command::Scale(Some(s))),
            None => Some(Command::Scale(None)),
            Some(_) => None,
        },
    },
    Spec {
        name: "crease",
        class: Class::Model,
        args: &[
            arg("A-B-...|angle|none", Kind::ChainOr(&["angle", "none"])),
            maybe("DEG", Kind::Sharpness),
            maybe("S", Kind::Sharpness),
        ],
        flags: &[],
        keys: Keys::None,
        summary: "make edges S sharp: those along A-B-..., or those that faces meet in at more than DEG degrees (`angle DEG S`)",
        detail: "S keeps an edge sharp for S levels; 10 and more, or inf, for ever; 0 makes it smooth. Vertices are numbered from 0 \
                 as in the file. `crease none` takes all away.",
        example: "crease 4-5-1 2.5",
        build: |p| {
            let mut values = p.values.into_iter();
            let first = values.next()?;
            let mut number = || match values.next() {
                Some(Value::Number(n)) => Some(n),
                _ => None,
            };
            let (place, sharpness) = match first {
                Value::Chain(vertices) => (CreaseWhere::Chain(vertices), number()?),
                Value::Word("angle") => (CreaseWhere::Angle(number().filter(|a| *a <= 180.0)?), number()?),
                Value::Word(_) => (CreaseWhere::Everywhere, 0.0),
                _ => return None,
            };
            number().is_none().then_some(Command::Crease { place, sharpness })
        },
    },
    Spec {
        name: "corner",
        class: Class::Model,
        args: &[arg("V", Kind::Index), arg("S", Kind::Sharpness)],
        flags: &[],
        keys: Keys::None,
        summary: "make vertex V S sharp",
        detail: "As for `crease`: 10 and more is for ever, 0 is smooth.",
        example: "corner 7 10",
        build: |p| match p.values[..] {
            [Value::Index(v), Value::Number(s)] => Some(Command::Corner { vertex: v, sharpness: s }),
            _ => None,
        },
    },
    Spec {
        name: "hole",
        class: Class::Model,
        args: &[arg("F", Kind::Index)],
        flags: &[],
        keys: Keys::None,
        summary: "refine face F and do not show it",
        detail: "Its neighbours are refined as if it were there. Faces are numbered from 0 as in the file.",
        example: "hole 3",
        build: |p| match p.values[..] {
            [Value::Index(f)] => Some(Command::Hole(f)),
            _ => None,
        },
    },
    Spec {
        name: "knot",
        class: Class::Model,
        args: &[arg("A-B", Kind::Knot), arg("D", Kind::Sharpness)],
        flags: &[],
        keys: Keys::None,
        summary: "set the knot interval of edge A-B at A (A=B: at both ends), for the scheme nurss",
        detail: "Intervals are 1 unless set; what counts is how they compare with each other. 0 at every vertex of a row, toward \
                 those beside it, makes a crease of the row.",
        example: "knot 4=5 0.5",
        build: |p| match p.values[..] {
            [Value::Knot(ends, both), Value::Number(d)] if d < f32::MAX => {
                Some(Command::Knot { ends, both, interval: d })
            }
            _ => None,
        },
    },
    Spec {
        name: "scheme",
        class: Class::Setting,
        args: &[arg("ID", Kind::Scheme)],
        flags: &[],
        keys: Keys::Parameters,
        summary: "choose the subdivision scheme",
        detail: "A scheme for triangles cuts other faces into triangles first. Parameters follow as KEY=VALUE; the others have their \
                 defaults. from=K leaves the first K levels to the scheme before.",
        example: "scheme loop weights=warren",
        build: |p| match p.values.into_iter().next()? {
            Value::Text(id) => Some(Command::Scheme { id, parameters: p.parameters }),
            _ => None,
        },
    },
    Spec {
        name: "fair",
        class: Class::Setting,
        args: &[arg("HOW", Kind::Word(&["taubin"])), arg("N", Kind::Whole)],
        flags: &[],
        keys: Keys::Parameters,
        summary: "smooth the model, or level K, by N iterations of Taubin's filter, without shrinking it",
        detail: "at=K says which level, before it is refined further; 0 is the model itself. N = 0 takes it back.",
        example: "fair taubin 10 at=1",
        build: |p| match p.values.get(1)? {
            Value::Whole(n) => Some(Command::Fair { iterations: *n, parameters: p.parameters }),
            _ => None,
        },
    },
    Spec {
        name: "compare",
        class: Class::Setting,
        args: &[arg("ID|off", Kind::Scheme)],
        flags: &[],
        keys: Keys::Schemes,
        summary: "show up to three more schemes beside the present one, on the same model and level",
        detail: "Parameters follow an id. Choosing one of them with `scheme` makes the two change places. `compare off` ends it; \
                 files and `info` are of the present scheme.",
        example: "compare loop weights=warren butterfly",
        build: |p| match p.values.into_iter().next()? {
            Value::Text(id) if id == "off" => {
                (p.parameters.is_empty() && p.more.is_empty()).then(|| Command::Compare(Vec::new()))
            }
            Value::Text(id) => {
                let mut panes = vec![SchemeWords { id, parameters: p.parameters }];
                panes.extend(p.more);
                Some(Command::Compare(panes))
            }
            _ => None,
        },
    },
    Spec {
        name: "boundary",
        class: Class::Setting,
        args: &[arg("RULE", Kind::Word(&["none", "edge-only", "edge-and-corner"]))],
        flags: &[],
        keys: Keys::None,
        summary: "smooth the rim of an open model everywhere, keep its corners, or leave the faces at it out",
        detail: "With none the rim is smoothed as with edge-only, and faces that touch it are refined and not shown.",
        example: "boundary edge-only",
        build: |p| match p.values.into_iter().next()? {
            Value::Word("none") => Some(Command::Boundary(Boundary::None)),
            Value::Word("edge-only") => Some(Command::Boundary(Boundary::EdgeOnly)),
            Value::Word(_) => Some(Command::Boundary(Boundary::EdgeAndCorner)),
            _ => None,
        },
    },
    Spec {
        name: "crease-decay",
        class: Class::Setting,
        args: &[arg("RULE", Kind::Word(&["uniform", "chaikin"]))],
        flags: &[],
        keys: Keys::None,
        summary: "how creases soften from level to level: by one, or evened out along the crease first",
        detail: "",
        example: "crease-decay chaikin",
        build: |p| match p.values.into_iter().next()? {
            Value::Word("uniform") => Some(Command::CreaseDecay(Decay::Uniform)),
            Value::Word(_) => Some(Command::CreaseDecay(Decay::Chaikin)),
            _ => None,
        },
    },
    Spec {
        name: "triangle-rule",
        class: Class::Setting,
        args: &[arg("RULE", Kind::Word(&["catmull-clark", "smooth"]))],
        flags: &[],
        keys: Keys::None,
        summary: "what catmull-clark makes of triangles: the same as of other polygons, or something smoother",
        detail: "",
        example: "triangle-rule smooth",
        build: |p| match p.values.into_iter().next()? {
            Value::Word("smooth") => Some(Command::TriangleRule(TriangleRule::Smooth)),
            Value::Word(_) => Some(Command::TriangleRule(TriangleRule::CatmullClark)),
            _ => None,
        },
    },
    Spec {
        name: "face-varying",
        class: Class::Setting,
        args: &[arg("RULE", Kind::Word(&FACE_VARYING))],
        flags: &[],
        keys: Keys::None,
        summary: "where texture coordinates stay linear along seams",
        detail: "From none (smooth everywhere) over corners and junctions to all (linear everywhere), as OpenSubdiv has them.",
        example: "face-varying boundaries",
        build: |p| match p.values.into_iter().next()? {
            Value::Word(word) => Some(Command::FaceVarying(face_varying(word)?)),
            _ => None,
        },
    },
    Spec {
        name: "limit",
        class: Class::Setting,
        args: &[arg("SWITCH", SWITCH)],
        flags: &[],
        keys: Keys::None,
        summary: "move the level's vertices to where endless refinement takes them, and shade with that surface's normals",
        detail: "Faces stay those of the level. Schemes that go through their vertices change the normals only; linear ones nothing.",
        example: "limit on",
        build: |p| Some(Command::Limit(is_on(p.values.into_iter().next())?)),
    },
    Spec {
        name: "level",
        class: Class::Setting,
        args: &[arg("N", Kind::Whole)],
        flags: &[],
        keys: Keys::None,
        summary: "show the model refined N times; 0 is the model itself",
        detail: "A level that does not fit the memory budget is refused with its predicted counts.",
        example: "level 3",
        build: |p| match p.values.into_iter().next()? {
            Value::Whole(n) => Some(Command::Level(n)),
            _ => None,
        },
    },
    Spec {
        name: "view",
        class: Class::View,
        args: &[],
        flags: &[],
        keys: Keys::View,
        summary: "change how the model is shown",
        detail: "",
        example: "view edges=bold shading=flat camera=front",
        build: |p| Some(Command::View(p.view)),
    },
    Spec {
        name: "info",
        class: Class::Action,
        args: &[],
        flags: &["--json"],
        keys: Keys::None,
        summary: "count vertices, edges and faces, and tell what the surface is like",
        detail: "With --json as one JSON object.",
        example: "info --json",
        build: |p| Some(Command::Info { json: p.flags.contains(&"--json") }),
    },
    Spec {
        name: "export",
        class: Class::Action,
        args: &[arg("FILE", Kind::File)],
        flags: &[],
        keys: Keys::None,
        summary: "write the present level to FILE.obj or FILE.glb",
        detail: "",
        example: "export out.obj",
        build: |p| match p.values.into_iter().next()? {
            Value::Text(file) => Some(Command::Export { file }),
            _ => None,
        },
    },
    Spec {
        name: "undo",
        class: Class::Action,
        args: &[],
        flags: &[],
        keys: Keys::None,
        summary: "take back the last change of the model or of a setting",
        detail: "",
        example: "undo",
        build: |_| Some(Command::Undo),
    },
    Spec {
        name: "redo",
        class: Class::Action,
        args: &[],
        flags: &[],
        keys: Keys::None,
        summary: "do again what was taken back last",
        detail: "",
        example: "redo",
        build: |_| Some(Command::Redo),
    },
    Spec {
        name: "reload",
        class: Class::Action,
        args: &[],
        flags: &[],
        keys: Keys::None,
        summary: "read the file again and keep everything done to it",
        detail: "",
        example: "reload",
        build: |_| Some(Command::Reload),
    },
    Spec {
        name: "version",
        class: Class::Action,
        args: &[arg("N", Kind::Whole)],
        flags: &[],
        keys: Keys::None,
        summary: "say which version of these commands a script is written in",
        detail: "The present one is 1, which a script without this line is taken for.",
        example: "version 1",
        build: |p| match p.values.into_iter().next()? {
            Value::Whole(n) => Some(Command::Version(n)),
            _ => None,
        },
    },
    Spec {
        name: "help",
        class: Class::Action,
        args: &[maybe("COMMAND", Kind::Command)],
        flags: &[],
        keys: Keys::None,
        summary: "list the commands, or explain one",
        detail: "",
        example: "help level",
        build: |p| match p.values.into_iter().next() {
            Some(Value::Word(name)) => Some(Command::Help(Some(name))),
            None => Some(Command::Help(None)),
            Some(_) => None,
        },
    },
];
