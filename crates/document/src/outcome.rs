//! What a command asks of the host: the document decides, the host reads, refines, draws and writes.

use crate::command::Command;
use crate::source::Source;

/// What the host has to do after a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Nothing changed.
    Nothing,
    /// The picture changed, the surface did not: draw again.
    View,
    /// The plan changed, the mesh did not: refine again.
    Refine,
    /// The mesh changed (the plan may have, too): forget what was derived, refine again.
    Model,
    /// Read this source and answer with [`Document::load`](crate::Document::load), or with [`Document::cancel_open`](crate::Document::cancel_open) if it cannot be read.
    /// Built-in models never ask.
    Open(Source),
    /// Write the present level to this file.
    Export {
        /// The name that the command gave.
        file: String,
    },
    /// Tell about the present level, see [`Document::info`](crate::Document::info).
    Info {
        /// As a JSON object.
        json: bool,
    },
    /// Show this text.
    Help(String),
}

/// What [`Document::replay`](crate::Document::replay) came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Replayed {
    /// The end.
    Done,
    /// A source that the host has to read: after [`Document::load`](crate::Document::load), go on with the rest.
    Waiting {
        /// What to read.
        source: Source,
        /// The commands still to come.
        rest: Vec<Command>,
    },
}
