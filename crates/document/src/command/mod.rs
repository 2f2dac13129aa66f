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

mod help;
mod parse;
mod rows;
mod table;

use std::fmt;

use limn_mesh::{Boundary, Decay, FaceVarying, TriangleRule, Weld};

pub use help::{complete, help};
pub use parse::{ParseError, parse_all, parse_script, parse_words};
pub use rows::COMMANDS;
pub use table::{Arg, Class, Keys, Kind, Parsed, Spec, Value, spec};

use crate::numbers::text_single;
use crate::source::Source;
use crate::view::ViewSet;
use crate::words::quote;

/// The version of the grammar.
pub const VERSION: u32 = 1;

/// A scheme and what is set of it, as words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SchemeWords {
    /// Its id; whether there is such a scheme is the document's to say.
    pub id: String,
    /// What stands behind it as `key=value`, in order.
    pub parameters: Vec<(String, String)>,
}

fn write_words(f: &mut fmt::Formatter<'_>, first: &str, parameters: &[(String, String)]) -> fmt::Result {
    write!(f, " {first}")?;
    parameters.iter().try_for_each(|(key, value)| write!(f, " {}", quote(&format!("{key}={value}"))))
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
    /// Fair a level.
    Fair {
        /// How many iterations.
        iterations: i32,
        /// What stands behind it as `key=value`.
        parameters: Vec<(String, String)>,
    },
    /// Make edges sharp or smooth.
    Crease {
        /// Which.
        place: CreaseWhere,
        /// 0 or more.
        sharpness: f32,
    },
    /// Make a vertex sharp or smooth.
    Corner {
        /// Which, in the file's numbers.
        vertex: u32,
        /// 0 or more.
        sharpness: f32,
    },
    /// Refine a face and do not show it.
    Hole(u32),
    /// Set a knot interval.
    Knot {
        /// The edge, in the file's numbers.
        ends: [u32; 2],
        /// Whether it is set at both ends, or at the first.
        both: bool,
        /// 0 or more.
        interval: f32,
    },
    /// What happens at the rim.
    Boundary(Boundary),
    /// Move the level's points to the limit.
    Limit(bool),
    /// How creases soften.
    CreaseDecay(Decay),
    /// What Catmull-Clark makes of triangles.
    TriangleRule(TriangleRule),
    /// What seams do to texture coordinates.
    FaceVarying(FaceVarying),
    /// Show schemes beside the present one; none ends that.
    Compare(Vec<SchemeWords>),
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

/// Which edges a crease is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum CreaseWhere {
    /// Those between these vertices, one after the other, in the file's numbers; two at least.
    Chain(Vec<u32>),
    /// Those whose faces' normals are more than so many degrees apart, 0 to 180.
    Angle(f32),
    /// All that are sharp, which become smooth.
    Everywhere,
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
            Command::Fair { .. } => "fair",
            Command::Crease { .. } => "crease",
            Command::Corner { .. } => "corner",
            Command::Hole(_) => "hole",
            Command::Knot { .. } => "knot",
            Command::Compare(_) => "compare",
            Command::Boundary(_) => "boundary",
            Command::Limit(_) => "limit",
            Command::CreaseDecay(_) => "crease-decay",
            Command::TriangleRule(_) => "triangle-rule",
            Command::FaceVarying(_) => "face-varying",
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
            Command::Weld(Weld::Relative(fraction)) => write!(f, " {}", text_single(*fraction)),
            Command::Quads(on) | Command::Limit(on) => f.write_str(if *on { " on" } else { " off" }),
            Command::Scale(Some(s)) => write!(f, " {}", text_single(*s)),
            Command::Scheme { id, parameters } => write_words(f, id, parameters),
            Command::Compare(panes) if panes.is_empty() => f.write_str(" off"),
            Command::Compare(panes) => panes.iter().try_for_each(|words| write_words(f, &words.id, &words.parameters)),
            Command::Fair { iterations, parameters } => write_words(f, &format!("taubin {iterations}"), parameters),
            Command::Crease { place, sharpness } => {
                match place {
                    CreaseWhere::Chain(vertices) => {
                        let words: Vec<String> = vertices.iter().map(u32::to_string).collect();
                        write!(f, " {}", words.join("-"))?;
                    }
                    CreaseWhere::Angle(degrees) => write!(f, " angle {}", text_single(*degrees))?,
                    CreaseWhere::Everywhere => return f.write_str(" none"),
                }
                write!(f, " {}", text_single(*sharpness))
            }
            Command::Corner { vertex, sharpness } => write!(f, " {vertex} {}", text_single(*sharpness)),
            Command::Hole(face) => write!(f, " {face}"),
            Command::Knot { ends: [a, b], both, interval } => {
                write!(f, " {a}{}{b} {}", if *both { '=' } else { '-' }, text_single(*interval))
            }
            Command::CreaseDecay(Decay::Uniform) => f.write_str(" uniform"),
            Command::CreaseDecay(Decay::Chaikin) => f.write_str(" chaikin"),
            Command::TriangleRule(TriangleRule::CatmullClark) => f.write_str(" catmull-clark"),
            Command::TriangleRule(TriangleRule::Smooth) => f.write_str(" smooth"),
            Command::FaceVarying(rule) => write!(f, " {}", rows::face_varying_word(*rule)),
            Command::Boundary(Boundary::None) => f.write_str(" none"),
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
