//! Why a command did nothing: one enum, one sentence each that says what to do instead.

use limn_mesh::fairing::MOST_ITERATIONS;
use limn_mesh::{RefineError, SCHEMES, SHAPES};

use crate::build::BuildError;
use crate::command::{ParseError, VERSION};
use crate::compare::MOST_BESIDE;

/// Why a command did nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CommandError {
    /// The text is no command.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// No model is open.
    #[error("`{0}` needs a model; open one first, as in `open builtin:cube`")]
    NoModel(&'static str),
    /// There is no such built-in model.
    #[error("there is no built-in model `{name}`; there are {}", shape_names())]
    UnknownShape {
        /// The name asked for.
        name: String,
    },
    /// There is no such scheme.
    #[error("there is no scheme `{id}`; there are {}", scheme_ids())]
    UnknownScheme {
        /// The id asked for.
        id: String,
    },
    /// The scheme does not take this parameter.
    #[error("the scheme {scheme} has no parameter `{key}`; {known}")]
    UnknownParameter {
        /// The scheme's id.
        scheme: &'static str,
        /// The key given.
        key: String,
        /// What it takes, in words.
        known: String,
    },
    /// A parameter cannot be that.
    #[error("`{key}={value}` is not possible; {key} is {expected}")]
    BadParameter {
        /// The parameter.
        key: &'static str,
        /// The value given.
        value: String,
        /// What it can be.
        expected: String,
    },
    /// No edge joins the two vertices.
    #[error("no edge joins vertices {0} and {1}; vertices are numbered from 0 as in the file")]
    NoEdge(u32, u32),
    /// There is no such vertex or face.
    #[error("there is no {what} {index}; the model has {count}, numbered from 0")]
    NoElement {
        /// "vertex" or "face".
        what: &'static str,
        /// The number given.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A command does not take this key.
    #[error("`{command}` does not know the key `{key}`; it knows {known}")]
    UnknownKey {
        /// The command.
        command: &'static str,
        /// The key given.
        key: String,
        /// The key that it knows.
        known: &'static str,
    },
    /// Fewer than none, or too many.
    #[error("{0} iterations are not possible; a whole number from 0 to {MOST_ITERATIONS} is")]
    Iterations(i32),
    /// More schemes side by side than there is room for.
    #[error("compare shows up to {MOST_BESIDE} schemes beside the present one, not {0}; leave some out")]
    TooManyPanes(usize),
    /// A scheme beside itself.
    #[error("compare names {0} twice, or it is the present scheme; give each another scheme or other parameters")]
    SamePane(String),
    /// A level below the model itself.
    #[error("there is no level {0}: level 0 is the model itself and the lowest")]
    NegativeLevel(i32),
    /// The polygons make no mesh.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The level does not fit the budget.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// Nothing to take back.
    #[error("there is nothing to undo")]
    NothingToUndo,
    /// Nothing to do again.
    #[error("there is nothing to redo")]
    NothingToRedo,
    /// A built-in model has no file.
    #[error("{0} is built in and has no file to read again")]
    NothingToReload(String),
    /// The file read is not the one asked for.
    #[error("this `{name}` is not the file that was opened before: its {differs}; open it as a new model instead")]
    OtherFile {
        /// The file's name.
        name: String,
        /// What is different: "size is 12 bytes, not 10".
        differs: String,
    },
    /// A script in another version of the grammar.
    #[error("version {0} of the commands is not known; this program knows version {VERSION}")]
    Version(i32),
    /// A view command hides a group that the model does not have.
    #[error("the model has no group `{name}`{}", group_names(.groups))]
    UnknownGroup {
        /// The name given.
        name: String,
        /// The first few groups that there are.
        groups: Vec<String>,
    },
}

impl CommandError {
    /// Whether the budget refused the command; the same command works with a higher one.
    pub fn is_budget(&self) -> bool {
        matches!(self, CommandError::Refine(RefineError::TooLarge { .. }))
    }
}

fn shape_names() -> String {
    SHAPES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ")
}

fn scheme_ids() -> String {
    SCHEMES.iter().map(|s| s.info.id).collect::<Vec<_>>().join(", ")
}

fn group_names(groups: &[String]) -> String {
    if groups.is_empty() { "; it has no groups".into() } else { format!("; it has {}", groups.join(", ")) }
}
