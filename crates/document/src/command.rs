//! The grammar: one table of commands that parser, help, console completion, links and the command line share.
//!
//! Every button, key, console line, link and script says the same text commands. [`COMMANDS`] has one row a command: its
//! name and class, what arguments it takes, one line of help and an example. The parser knows only the table; a row's
//! `build` turns the values that it read into a [`Command`]. [`Command`]'s `Display` is the inverse of `parse`.
//!
//! ```text
//!   view            edges=bold shading=flat        level 3          info --json
//!   name            key=value, bound to the left   name argument    name flag
//! ```
//!
//! Since the table says how many words each command takes, several commands fit in a line without separators
//! (`scheme loop level 2 info`), as the command line of the native program has them. An optional argument is taken when
//! the next word can be one, so no optional argument may read like a command's name.
//!
//! The grammar has a [`VERSION`]; a command's meaning never changes within one. New commands and keys may come.

use std::fmt;
use std::str::FromStr;

use limn_mesh::{Boundary, SCHEMES, SHAPES, Weld};

use crate::source::Source;
use crate::view::{VIEW_KEYS, ViewSet};
use crate::words::{self, WordError, quote};

/// The version of the grammar.
pub const VERSION: u32 = 1;

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
    fn read(self, word: &str) -> Option<Value> {
        match self {
            Kind::Source => Source::parse(word).map(Value::Source),
            Kind::Scheme => is_id(word).then(|| Value::Text(word.to_owned())),
            Kind::Whole => word.parse().ok().map(Value::Whole),
            Kind::Positive => word.parse().ok().filter(|v: &f32| v.is_finite() && *v > 0.0).map(Value::Number),
            Kind::Word(words) => words.iter().find(|w| **w == word).map(|w| Value::Word(w)),
            Kind::Weld => match word {
                "exact" => Some(Value::Weld(Weld::Exact)),
                "off" => Some(Value::Weld(Weld::Off)),
                _ => word.parse().ok().filter(|v| *v > 0.0 && *v <= 0.1).map(|v| Value::Weld(Weld::Relative(v))),
            },
            Kind::File => (!word.is_empty()).then(|| Value::Text(word.to_owned())),
            Kind::Command => spec(word).map(|s| Value::Word(s.name)),
        }
    }

    /// What is expected, for messages: "a whole number".
    fn expected(self) -> String {
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
    fn candidates(self) -> Vec<String> {
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
fn is_id(word: &str) -> bool {
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
pub struct Parsed {
    values: Vec<Value>,
    flags: Vec<&'static str>,
    parameters: Vec<(String, String)>,
    view: Vec<ViewSet>,
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
    build: fn(Parsed) -> Option<Command>,
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
        detail: "A scheme for triangles triangulates other faces first, and the report says so.",
        example: "scheme catmull-clark",
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

/// A command, checked in form: the arguments are of their kinds and in their ranges.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Open a model.
    Open(Source),
    /// Which positions are one vertex.
    Weld(Weld),
    /// Pair triangles to quads.
    Quads(bool),
    /// Split faces into triangles.
    Triangulate,
    /// Move the middle to the origin.
    Center,
    /// Multiply coordinates by a finite number above 0; none makes the longest side 1.
    Scale(Option<f32>),
    /// Choose the scheme.
    Scheme {
        /// Its id; whether there is such a scheme is the document's to say.
        id: String,
        /// What stands behind it as `key=value`, in order.
        parameters: Vec<(String, String)>,
    },
    /// What happens at the rim.
    Boundary(Boundary),
    /// Refine so many times.
    Level(i32),
    /// Change how the model is shown; in order, never empty.
    View(Vec<ViewSet>),
    /// Tell about the model.
    Info {
        /// As a JSON object.
        json: bool,
    },
    /// Write the present level.
    Export {
        /// Where.
        file: String,
    },
    /// Take back.
    Undo,
    /// Do again.
    Redo,
    /// Read the file again.
    Reload,
    /// The version of the grammar that a script states.
    Version(i32),
    /// Explain all commands, or the one with this name.
    Help(Option<&'static str>),
}

impl Command {
    /// The word that it begins with.
    pub fn name(&self) -> &'static str {
        match self {
            Command::Open(_) => "open",
            Command::Weld(_) => "weld",
            Command::Quads(_) => "quads",
            Command::Triangulate => "triangulate",
            Command::Center => "center",
            Command::Scale(_) => "scale",
            Command::Scheme { .. } => "scheme",
            Command::Boundary(_) => "boundary",
            Command::Level(_) => "level",
            Command::View(_) => "view",
            Command::Info { .. } => "info",
            Command::Export { .. } => "export",
            Command::Undo => "undo",
            Command::Redo => "redo",
            Command::Reload => "reload",
            Command::Version(_) => "version",
            Command::Help(_) => "help",
        }
    }

    /// What it is about, as the table has it.
    pub fn class(&self) -> Class {
        spec(self.name()).map_or(Class::Action, |s| s.class)
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        match self {
            Command::Open(source) => write!(f, " {}", quote(&source.to_string())),
            Command::Weld(Weld::Exact) => f.write_str(" exact"),
            Command::Weld(Weld::Off) => f.write_str(" off"),
            Command::Weld(Weld::Relative(fraction)) => write!(f, " {fraction}"),
            Command::Quads(on) => f.write_str(if *on { " on" } else { " off" }),
            Command::Scale(Some(s)) => write!(f, " {s}"),
            Command::Scheme { id, parameters } => {
                write!(f, " {id}")?;
                parameters.iter().try_for_each(|(key, value)| write!(f, " {}", quote(&format!("{key}={value}"))))
            }
            Command::Boundary(Boundary::EdgeOnly) => f.write_str(" edge-only"),
            Command::Boundary(Boundary::EdgeAndCorner) => f.write_str(" edge-and-corner"),
            Command::Level(n) | Command::Version(n) => write!(f, " {n}"),
            Command::View(sets) => sets.iter().try_for_each(|set| write!(f, " {}", quote(&set.to_string()))),
            Command::Info { json: true } => f.write_str(" --json"),
            Command::Export { file } => write!(f, " {}", quote(file)),
            Command::Help(Some(name)) => write!(f, " {name}"),
            Command::Triangulate
            | Command::Center
            | Command::Scale(None)
            | Command::Info { json: false }
            | Command::Undo
            | Command::Redo
            | Command::Reload
            | Command::Help(None) => Ok(()),
        }
    }
}

/// Why words are no command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParseError {
    /// Quotes that do not work out.
    #[error(transparent)]
    Words(#[from] WordError),
    /// Nothing but space.
    #[error("there is no command here; `help` lists them")]
    Empty,
    /// No command has this name.
    #[error("there is no command `{word}`{}; `help` lists them", did_you_mean(*.near))]
    Unknown {
        /// What stands where a command belongs.
        word: String,
        /// The command that it looks like.
        near: Option<&'static str>,
    },
    /// The line ends too soon.
    #[error("`{command}` needs {expected}; it is written `{usage}`")]
    Missing {
        /// The command.
        command: &'static str,
        /// What is missing.
        expected: String,
        /// How it is written.
        usage: String,
    },
    /// An argument of the wrong kind.
    #[error("`{command}` takes {expected}, not `{word}`; it is written `{usage}`")]
    Argument {
        /// The command.
        command: &'static str,
        /// What stands there.
        word: String,
        /// What belongs there.
        expected: String,
        /// How it is written.
        usage: String,
    },
    /// A key that the command does not know.
    #[error("`{command}` does not know the key `{key}`{}", known(.keys))]
    Key {
        /// The command.
        command: &'static str,
        /// The key.
        key: String,
        /// The keys that it knows.
        keys: Vec<&'static str>,
    },
    /// A key with a value that it cannot take.
    #[error("`{command} {key}=` takes {expected}, not `{value}`")]
    KeyValue {
        /// The command.
        command: &'static str,
        /// The key.
        key: String,
        /// The value.
        value: String,
        /// What it takes.
        expected: String,
    },
    /// Words behind the end of a single command.
    #[error("`{command}` ends before `{word}`; it is written `{usage}`")]
    Extra {
        /// The command.
        command: &'static str,
        /// The first word too many.
        word: String,
        /// How it is written.
        usage: String,
    },
    /// A line of a script.
    #[error("line {line}: {error}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        error: Box<ParseError>,
    },
}

fn did_you_mean(near: Option<&'static str>) -> String {
    near.map_or_else(String::new, |name| format!("; did you mean `{name}`"))
}

fn known(keys: &[&'static str]) -> String {
    if keys.is_empty() { String::new() } else { format!("; it knows {}", keys.join(", ")) }
}

/// The command's name that differs least from `word`, if little: at most a third of its letters.
fn nearest(word: &str) -> Option<&'static str> {
    let best = COMMANDS.iter().map(|s| (distance(word, s.name), s.name)).min()?;
    (best.0 * 3 <= best.1.len()).then_some(best.1)
}

/// Levenshtein's distance, in bytes. Cost: product of the lengths, of which the first is cut to 32.
fn distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.bytes().take(32).enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        for (cell, cb) in row.iter_mut().skip(1).zip(b.bytes()) {
            let value = (diagonal + usize::from(ca != cb)).min(left + 1).min(*cell + 1);
            diagonal = std::mem::replace(cell, value);
            left = value;
        }
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
    }
    row.last().copied().unwrap_or(usize::MAX)
}

/// Reads the first command of `words` and says how many words it took. Cost: linear in those.
///
/// # Errors
/// [`ParseError`]: no such command, or arguments that do not fit.
pub fn parse_words<S: AsRef<str>>(words: &[S]) -> Result<(Command, usize), ParseError> {
    let name = words.first().ok_or(ParseError::Empty)?.as_ref();
    let spec = spec(name).ok_or_else(|| ParseError::Unknown { word: name.to_owned(), near: nearest(name) })?;
    let mut parsed = Parsed { values: Vec::new(), flags: Vec::new(), parameters: Vec::new(), view: Vec::new() };
    let mut args = spec.args.iter();
    let mut used = 1;
    for word in words.iter().skip(1).map(AsRef::as_ref) {
        if let Some(flag) = spec.flags.iter().find(|f| **f == word) {
            parsed.flags.push(flag);
        } else if let Some(arg) = args.clone().next() {
            match arg.kind.read(word) {
                Some(value) => parsed.values.push(value),
                None if arg.optional => break,
                None => {
                    return Err(ParseError::Argument {
                        command: spec.name,
                        word: word.to_owned(),
                        expected: arg.kind.expected(),
                        usage: spec.usage(),
                    });
                }
            }
            args.next();
        } else if let Some((key, value)) = word.split_once('=').filter(|(key, _)| spec.keys != Keys::None && is_id(key))
        {
            read_key(spec, key, value, &mut parsed)?;
        } else {
            break;
        }
        used += 1;
    }
    let missing = |expected: String| ParseError::Missing { command: spec.name, expected, usage: spec.usage() };
    if let Some(arg) = args.next().filter(|a| !a.optional) {
        return Err(missing(arg.kind.expected()));
    }
    if spec.keys == Keys::View && parsed.view.is_empty() {
        return Err(missing("at least one KEY=VALUE".into()));
    }
    let command = (spec.build)(parsed).ok_or_else(|| missing("other arguments".into()))?;
    Ok((command, used))
}

fn read_key(spec: &'static Spec, key: &str, value: &str, parsed: &mut Parsed) -> Result<(), ParseError> {
    match spec.keys {
        Keys::View => {
            let known = VIEW_KEYS.iter().find(|k| k.name == key).ok_or_else(|| ParseError::Key {
                command: spec.name,
                key: key.to_owned(),
                keys: VIEW_KEYS.iter().map(|k| k.name).collect(),
            })?;
            let set = ViewSet::parse(key, value).ok_or_else(|| ParseError::KeyValue {
                command: spec.name,
                key: key.to_owned(),
                value: value.to_owned(),
                expected: known.values(),
            })?;
            parsed.view.push(set);
        }
        Keys::Parameters | Keys::None => parsed.parameters.push((key.to_owned(), value.to_owned())),
    }
    Ok(())
}

/// All commands of `words`, as they stand on a command line. Cost: linear.
///
/// # Errors
/// The first [`ParseError`].
pub fn parse_all<S: AsRef<str>>(words: &[S]) -> Result<Vec<Command>, ParseError> {
    let mut commands: Vec<Command> = Vec::new();
    let mut rest = words;
    while let Some(first) = rest.first() {
        match parse_words(rest) {
            Ok((command, used)) => {
                commands.push(command);
                rest = rest.get(used..).unwrap_or_default();
            }
            // A stray word behind a command is more likely one argument too many than a command misspelt.
            Err(ParseError::Unknown { near: None, .. }) if !commands.is_empty() => {
                let command = commands.last().map_or("", Command::name);
                return Err(ParseError::Extra {
                    command,
                    word: first.as_ref().to_owned(),
                    usage: spec(command).map(Spec::usage).unwrap_or_default(),
                });
            }
            Err(error) => return Err(error),
        }
    }
    Ok(commands)
}

/// The commands of a script: a line may be empty, a comment, one command or several. Cost: linear.
///
/// # Errors
/// [`ParseError::Line`] with the number of the first line that is wrong.
pub fn parse_script(text: &str) -> Result<Vec<Command>, ParseError> {
    let mut commands = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let read = words::split(line).map_err(ParseError::from).and_then(|words| parse_all(&words));
        commands.extend(read.map_err(|error| ParseError::Line { line: i + 1, error: Box::new(error) })?);
    }
    Ok(commands)
}

impl FromStr for Command {
    type Err = ParseError;

    /// Reads a line that is exactly one command.
    fn from_str(line: &str) -> Result<Command, ParseError> {
        let words = words::split(line)?;
        let (command, used) = parse_words(&words)?;
        match words.get(used) {
            None => Ok(command),
            Some(word) => Err(ParseError::Extra {
                command: command.name(),
                word: word.clone(),
                usage: spec(command.name()).map(Spec::usage).unwrap_or_default(),
            }),
        }
    }
}

/// The text of `help` (all commands, a line each) or `help NAME`.
pub fn help(name: Option<&str>) -> String {
    match name.and_then(spec) {
        Some(spec) => spec.help(),
        None => {
            let width = COMMANDS.iter().map(|s| s.usage().len()).max().unwrap_or(0);
            COMMANDS.iter().map(|s| format!("{:width$}  {}\n", s.usage(), s.summary)).collect()
        }
    }
}

/// What can stand at the end of `line`, which may end within a word: the whole words, in the table's order. Empty where
/// anything or nothing may stand. For the console's completion.
pub fn complete(line: &str) -> Vec<String> {
    let Ok(mut words) = words::split(line) else { return Vec::new() };
    let fresh = line.is_empty() || line.ends_with(char::is_whitespace);
    let start = if fresh { String::new() } else { words.pop().unwrap_or_default() };
    // The last command that the finished words begin, and what it has already.
    let (mut from, mut open) = (0, None);
    while let Some(name) = words.get(from) {
        let Some(row) = spec(name) else { return Vec::new() };
        match words.get(from..).map(parse_words) {
            Some(Ok((_, used))) if from + used < words.len() => from += used,
            _ => {
                open = Some((row, words.get(from + 1..).unwrap_or_default()));
                break;
            }
        }
    }
    let mut found: Vec<String> = Vec::new();
    match open {
        None => found.extend(COMMANDS.iter().map(|s| s.name.to_owned())),
        Some((row, given)) => {
            let plain = given.iter().filter(|w| !row.flags.contains(&w.as_str()) && !w.contains('=')).count();
            match row.args.get(plain) {
                Some(arg) => found.extend(arg.kind.candidates()),
                None if row.keys == Keys::View => {
                    for key in VIEW_KEYS {
                        if key.words.is_empty() || !start.starts_with(&format!("{}=", key.name)) {
                            found.push(format!("{}=", key.name));
                        } else {
                            found.extend(key.words.iter().map(|w| format!("{}={w}", key.name)));
                        }
                    }
                }
                None => {}
            }
            found.extend(row.flags.iter().filter(|f| !given.iter().any(|g| g == *f)).map(|&f| f.to_owned()));
        }
    }
    found.retain(|word| word.starts_with(&start));
    found
}
