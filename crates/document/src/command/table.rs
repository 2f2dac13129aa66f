//! The table of commands: one row a command, from which everything else about the grammar follows.
//!
//! A row is data but for `build`, which turns the values that the parser read, already of the right kinds, into a
//! [`Command`]. Adding a command is a row here, a variant of [`Command`] with its name and its words, and what the document
//! does with it; a test checks that each row's example comes back as it was written.

use std::fmt;

use limn_mesh::marks::INFINITE;
use limn_mesh::{SCHEMES, SHAPES, Weld};

use super::rows::COMMANDS;
use super::{Command, SchemeWords};
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
    /// Vertices joined by hyphens: `4-5-9`, at least two.
    Chain,
    /// [`Kind::Chain`], or one of these words.
    ChainOr(&'static [&'static str]),
    /// Two vertices: `4-5` for the end at the first, `4=5` for both ends.
    Knot,
    /// The number of a vertex or face, from 0.
    Index,
    /// A finite number greater than or equal to 0, or `inf`.
    Sharpness,
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
    /// Of [`Kind::Chain`].
    Chain(Vec<u32>),
    /// Of [`Kind::Knot`], with whether it is meant at both ends.
    Knot([u32; 2], bool),
    /// Of [`Kind::Index`].
    Index(u32),
}

/// The vertices of `4-5-9`.
fn chain(word: &str) -> Option<Vec<u32>> {
    let vertices: Vec<u32> = word.split('-').map(index).collect::<Option<_>>()?;
    (vertices.len() >= 2).then_some(vertices)
}

/// A number of an element: digits only.
fn index(word: &str) -> Option<u32> {
    (!word.starts_with('+')).then(|| word.parse().ok())?
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
            Kind::Chain => chain(word).map(Value::Chain),
            Kind::ChainOr(words) => Kind::Word(words).read(word).or_else(|| Kind::Chain.read(word)),
            Kind::Knot => {
                let (a, both, b) = match word.split_once('-') {
                    Some((a, b)) => (a, false, b),
                    None => word.split_once('=').map(|(a, b)| (a, true, b))?,
                };
                Some(Value::Knot([index(a)?, index(b)?], both))
            }
            Kind::Index => index(word).map(Value::Index),
            Kind::Sharpness if word == "inf" => Some(Value::Number(INFINITE)),
            Kind::Sharpness => single(word).filter(|v| *v >= 0.0).map(Value::Number),
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
            Kind::Chain => "vertices joined by hyphens, as in 4-5-9".into(),
            Kind::ChainOr(words) => format!("{} or {}", words.join(" or "), Kind::Chain.expected()),
            Kind::Knot => "two vertices, as in 4-5 or 4=5".into(),
            Kind::Index => "a number from 0 up".into(),
            Kind::Sharpness => "a number from 0 up, or inf".into(),
        }
    }

    /// The words that can stand here, for completion; empty where anything may.
    pub(super) fn candidates(self) -> Vec<String> {
        match self {
            Kind::Source => SHAPES.iter().map(|s| format!("builtin:{}", s.name)).collect(),
            Kind::Scheme => SCHEMES.iter().map(|s| s.info.id.to_owned()).collect(),
            Kind::Word(words) | Kind::ChainOr(words) => words.iter().map(|&w| w.to_owned()).collect(),
            Kind::Weld => ["exact", "off"].map(str::to_owned).into(),
            Kind::Command => COMMANDS.iter().map(|s| s.name.to_owned()).collect(),
            Kind::Sharpness => vec!["inf".to_owned()],
            Kind::Whole | Kind::Positive | Kind::File | Kind::Chain | Kind::Knot | Kind::Index => Vec::new(),
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
    /// Whether it may be left out. Only the last ones may.
    pub optional: bool,
}

pub(super) const fn arg(name: &'static str, kind: Kind) -> Arg {
    Arg { name, kind, optional: false }
}

pub(super) const fn maybe(name: &'static str, kind: Kind) -> Arg {
    Arg { name, kind, optional: true }
}

/// Which `key=value` words a command takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keys {
    /// None.
    None,
    /// Any, from none up; the scheme says which it knows.
    Parameters,
    /// The same, and between them the ids of more schemes.
    Schemes,
    /// The keys of [`VIEW_KEYS`], at least one.
    View,
}

/// What was read for a command, handed to its row's `build`.
#[derive(Debug, Default)]
pub struct Parsed {
    pub(super) values: Vec<Value>,
    pub(super) flags: Vec<&'static str>,
    pub(super) parameters: Vec<(String, String)>,
    pub(super) more: Vec<SchemeWords>,
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
            Keys::Schemes => text.push_str(" [KEY=VALUE ...] [ID ...]"),
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

/// The row of the command with this name.
pub fn spec(name: &str) -> Option<&'static Spec> {
    COMMANDS.iter().find(|s| s.name == name)
}
