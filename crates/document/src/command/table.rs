//! The table of commands: one row a command, from which everything else about the grammar follows.
//!
//! A row is data but for `build`, which turns the values that the parser read, already of the right kinds, into a
//! [`Command`]. Adding a command is a row here, a variant of [`Command`] with its name and its words, and what the document
//! does with it; a test checks that each row's example comes back as it was written.

use std::fmt;

use limn_mesh::{Boundary, SCHEMES, SHAPES, Weld};

use super::Command;
use crate::numbers::single;
use crate::source::Source;
use crate::view::{VIEW_KEYS, ViewSet};

/// What a command is about, which decides whether it is undone, stored, or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Changes the model: journalled in order, undoable.
    Model,
    /// A setting of which the last one wins: undoable, stored once.
    Setting,
    /// How the model is shown: in the link, not undone.
    View,
    /// Does something and leaves nothing in the document.
    Action,
}

impl Class {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Class::Model => "model",
            Class::Setting => "setting",
            Class::View => "view",
            Class::Action => "action",
        }
    }
}

/// What a word has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// `builtin:NAME`, `file:NAME[,SIZE,HASH]` or a web address.
    Source,
    /// The id of a scheme. Only its form is checked here: lower-case letters, digits and hyphens.
    Scheme,
    /// A whole number of an `i32`.
    Whole,
    /// A finite number greater than zero.
    Positive,
    /// One of these words.
    Word(&'static [&'static str]),
    /// `exact`, `off`, or a fraction of the bounding box's diagonal, more than 0 and at most 0.1.
    Weld,
    /// Any words at all, but not none: a file's name.
    File,
    /// The name of a command.
    Command,
}

/// An argument's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of [`Kind::Source`].
    Source(Source),
    /// Of [`Kind::Whole`].
    Whole(i32),
    /// Of [`Kind::Positive`].
    Number(f32),
    /// Of [`Kind::Weld`].
    Weld(Weld),
    /// Of [`Kind::Word`] or [`Kind::Command`]: from the table.
    Word(&'static str),
    /// Of [`Kind::File`] or [`Kind::Scheme`].
    Text(String),
}

impl Kind {
    /// Reads a word; `None` if it is not of this kind.
    pub(super) fn read(self, word: &str) -> Option<Value> {
        match self {
            Kind::Source => Source::parse(word).map(Value::Source),
            Kind::Scheme => is_id(word).then(|| Value::Text(word.to_owned())),
            Kind::Whole => word.parse().ok().map(Value::Whole),
            Kind::Positive => single(word).filter(|v| *v > 0.0).map(Value::Number),
            Kind::Word(words) => words.iter().find(|w| **w == word).map(|w| Value::Word(w)),
            Kind::Weld => match word {
                "exact" => Some(Value::Weld(Weld::Exact)),
                "off" => Some(Value::Weld(Weld::Off)),
                _ => single(word).filter(|v| *v > 0.0 && *v <= 0.1).map(|v| Value::Weld(Weld::Relative(v))),
            },
            Kind::File => (!word.is_empty()).then(|| Value::Text(word.to_owned())),
            Kind::Command => spec(word).map(|s| Value::Word(s.name)),
        }
    }

    /// What is expected, for messages: "a whole number".
    pub(super) fn expected(self) -> String {
        match self {
            Kind::Source => "builtin:NAME, file:NAME or a web address".into(),
            Kind::Scheme => "the id of a scheme".into(),
            Kind::Whole => "a whole number".into(),
            Kind::Positive => "a number greater than 0".into(),
            Kind::Word(words) => words.join(" or "),
            Kind::Weld => "exact, off, or a fraction of the bounding box greater than 0 and up to 0.1".into(),
            Kind::File => "a file name".into(),
            Kind::Command => "the name of a command".into(),
        }
    }

    /// The words that can stand here, for completion; empty where anything may.
    pub(super) fn candidates(self) -> Vec<String> {
        match self {
            Kind::Source => SHAPES.iter().map(|s| format!("builtin:{}", s.name)).collect(),
            Kind::Scheme => SCHEMES.iter().map(|s| s.info.id.to_owned()).collect(),
            Kind::Word(words) => words.iter().map(|&w| w.to_owned()).collect(),
            Kind::Weld => ["exact", "off"].map(str::to_owned).into(),
            Kind::Command => COMMANDS.iter().map(|s| s.name.to_owned()).collect(),
            Kind::Whole | Kind::Positive | Kind::File => Vec::new(),
        }
    }
}

/// Whether `word` is a lower-case word with digits and hyphens, as ids and keys are.
pub(super) fn is_id(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_lowercase())
        && word.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-' | b'_'))
}

/// An argument in the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arg {
    /// Its name in the usage line, in capitals unless it is literal.
    pub name: &'static str,
    /// What it has to be.
    pub kind: Kind,
    /// Whether it may be left out. Only the last argument may.
    pub optional: bool,
}

const fn arg(name: &'static str, kind: Kind) -> Arg {
    Arg { name, kind, optional: false }
}

const fn maybe(name: &'static str, kind: Kind) -> Arg {
    Arg { name, kind, optional: true }
}

/// Which `key=value` words a command takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keys {
    /// None.
    None,
    /// Any, from none up; the scheme says which it knows.
    Parameters,
    /// The keys of [`VIEW_KEYS`], at least one.
    View,
}

/// What was read for a command, handed to its row's `build`.
#[derive(Debug, Default)]
pub struct Parsed {
    pub(super) values: Vec<Value>,
    pub(super) flags: Vec<&'static str>,
    pub(super) parameters: Vec<(String, String)>,
    pub(super) view: Vec<ViewSet>,
}

/// A row of the table.
pub struct Spec {
    /// The word that the command begins with.
    pub name: &'static str,
    /// What it is about.
    pub class: Class,
    /// Its arguments in order.
    pub args: &'static [Arg],
    /// The flags that may stand anywhere behind the name.
    pub flags: &'static [&'static str],
    /// The `key=value` words that may stand behind it.
    pub keys: Keys,
    /// What it does, in one line.
    pub summary: &'static str,
    /// More about it, for `help NAME`; may be empty.
    pub detail: &'static str,
    /// A command that works.
    pub example: &'static str,
    pub(super) build: fn(Parsed) -> Option<Command>,
}

impl fmt::Debug for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Spec({})", self.usage())
    }
}

impl Spec {
    /// How it is written: `scheme ID [KEY=VALUE ...]`.
    pub fn usage(&self) -> String {
        let mut text = self.name.to_owned();
        for arg in self.args {
            let name = match arg.kind {
                Kind::Word(words) => words.join("|"),
                Kind::Weld => "exact|EPS|off".into(),
                _ => arg.name.to_owned(),
            };
            text.push_str(&if arg.optional { format!(" [{name}]") } else { format!(" {name}") });
        }
        for flag in self.flags {
            text.push_str(&format!(" [{flag}]"));
        }
        match self.keys {
            Keys::None => {}
            Keys::Parameters => text.push_str(" [KEY=VALUE ...]"),
            Keys::View => text.push_str(" KEY=VALUE ..."),
        }
        text
    }

    /// The text that `help NAME` prints.
    pub fn help(&self) -> String {
        let mut text = format!("{}\n  {}.\n", self.usage(), self.summary);
        if !self.detail.is_empty() {
            text.push_str(&format!("  {}\n", self.detail));
        }
        if self.keys == Keys::View {
            for key in VIEW_KEYS {
                text.push_str(&format!("    {}={}\n        {}\n", key.name, key.values(), key.summary));
            }
        }
        text.push_str(&format!("  Example: {}\n", self.example));
        text
    }
}

const SWITCH: Kind = Kind::Word(&["on", "off"]);

fn is_on(value: Option<Value>) -> Option<bool> {
    match value? {
        Value::Word(word) => Some(word == "on"),
        _ => None,
    }
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
        name: "scheme",
        class: Class::Setting,
        args: &[arg("ID", Kind::Scheme)],
        flags: &[],
        keys: Keys::Parameters,
        summary: "choose the subdivision scheme",
        detail: "A scheme for triangles triangulates other faces first, and the report says so. What a scheme lets one set follows as \
                 KEY=VALUE; what is not named has its default.",
        example: "scheme loop weights=warren",
        build: |p| match p.values.into_iter().next()? {
            Value::Text(id) => Some(Command::Scheme { id, parameters: p.parameters }),
            _ => None,
        },
    },
    Spec {
        name: "boundary",
        class: Class::Setting,
        args: &[arg("RULE", Kind::Word(&["edge-only", "edge-and-corner"]))],
        flags: &[],
        keys: Keys::None,
        summary: "smooth the rim of an open model everywhere, or keep its corners",
        detail: "",
        example: "boundary edge-only",
        build: |p| match p.values.into_iter().next()? {
            Value::Word("edge-only") => Some(Command::Boundary(Boundary::EdgeOnly)),
            Value::Word(_) => Some(Command::Boundary(Boundary::EdgeAndCorner)),
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

/// The row of the command with this name.
pub fn spec(name: &str) -> Option<&'static Spec> {
    COMMANDS.iter().find(|s| s.name == name)
}
