//! What the page and the engine say to each other.
//!
//! Page and engine share no memory: the page sends plain messages, `web/host.js` turns each into one call of
//! `Engine`, and the engine posts the messages below. `web/protocol.d.ts` has the same shapes for the page's type
//! checker. The page never computes from a [`State`]; it shows it and sends the command texts that it finds there.
//!
//! ```text
//!   page -> engine                                      engine -> page
//!   start   canvas, size, theme, text, files            hello     once: schemes, models, controls, keys, commands
//!   open    files: they replace the model               state     the whole view model, at most once a frame
//!   reload  the same files, read again                  progress  work longer than 200 ms; empty when it is over
//!   replay  a link's fragment                           card      a quiet message that stays until dismissed
//!   cmd     one command's text                          log       a console line's answer
//!   input   pointer and wheel events of one frame       file      an export's bytes
//!   size    device pixels, what the page covers         drawn     the first picture is on the canvas
//!   theme, cancel, ping                                 pong, fault
//! ```
//!
//! To its surroundings (`web/host.js`) the engine also says `fetch` (an address), `decode` (a picture's bytes) and `png`
//! (pixels to be saved): things that only the browser can do, answered by `Engine`'s `fetched` and `decoded`, or by the
//! page getting a file. A `turn` number in them tells
//! late answers from current ones.
//!
//! A batch of input is a row of numbers for each event: kind, pointer, x, y, a, b, modifiers, time. See
//! [`crate::gestures`] for what they mean.

use serde::Serialize;

/// Sent once, when the engine takes commands.
#[derive(Serialize)]
#[serde(tag = "type", rename = "hello", rename_all = "camelCase")]
pub struct Hello {
    /// `webgpu` or `webgl2`.
    pub renderer: &'static str,
    /// The graphics adapter, for people.
    pub adapter: String,
    /// Of this program.
    pub version: &'static str,
    /// The registry of schemes.
    pub schemes: Vec<SchemeInfo>,
    /// Built-in models.
    pub models: Vec<ModelInfo>,
    /// Rows of the panel.
    pub controls: &'static [crate::controls::Control],
    /// The keyboard.
    pub keys: &'static [crate::keys::Key],
    /// The console's commands.
    pub commands: Vec<CommandInfo>,
}

/// A scheme's pill.
#[derive(Serialize)]
pub struct SchemeInfo {
    /// Permanent id.
    pub id: &'static str,
    /// What people read.
    pub name: &'static str,
    /// Pills of a group stand together.
    pub group: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// What the pill sends.
    pub command: String,
}

/// A built-in model.
#[derive(Serialize)]
pub struct ModelInfo {
    /// `open builtin:NAME` opens it.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
}

/// A command, for help and completion.
#[derive(Serialize)]
pub struct CommandInfo {
    /// Its first word.
    pub name: &'static str,
    /// What follows the name in the usage line.
    pub args: String,
    /// One sentence.
    pub help: String,
    /// `model`, `setting`, `view` or `action`.
    pub class: &'static str,
}

/// Counts and bytes of a level.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Count {
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Faces.
    pub faces: u64,
    /// Bytes in memory: for a level of the ruler at the peak of refining it, for what is shown in memory and on the GPU.
    pub bytes: u64,
}

/// A notch of the ruler.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Which.
    pub level: u32,
    /// What stands under the notch.
    pub label: String,
    /// What it makes, predicted.
    #[serde(flatten)]
    pub count: Count,
    /// Whether it fits the budget.
    pub allowed: bool,
    /// The counts as a sentence, or why it does not fit.
    pub title: String,
    /// What the notch sends.
    pub command: String,
}

/// A group of faces that can be hidden.
#[derive(Serialize)]
pub struct Group {
    /// As the file has it.
    pub name: String,
    /// How many faces of the file.
    pub faces: u64,
    /// Whether it is not drawn.
    pub hidden: bool,
    /// What shows or hides it.
    pub command: String,
}

/// What is known about the model.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ModelState {
    /// File or shape.
    pub name: String,
    /// One line under the name.
    pub summary: String,
    /// Whether it is one of the built-in ones.
    pub builtin: bool,
    /// `file` or `url` if Reload can read it again, else empty.
    pub reload: &'static str,
    /// Rows of the report.
    pub facts: Vec<Fact>,
}

/// A row of the report.
#[derive(Clone, Serialize)]
pub struct Fact {
    /// What.
    pub label: &'static str,
    /// How much.
    pub value: String,
}

/// What is on the screen.
#[derive(Clone, Default, Serialize)]
pub struct Shown {
    /// Counts, and the bytes that it takes.
    #[serde(flatten)]
    pub count: Count,
    /// Its level.
    pub level: u32,
    /// Its scheme.
    pub scheme: &'static str,
}

/// One of several schemes that are shown side by side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pane {
    /// The scheme's id.
    pub scheme: &'static str,
    /// What people read: its name, and what was set of it.
    pub name: String,
    /// What is shown; zeros while there is nothing yet.
    #[serde(flatten)]
    pub count: Count,
    /// Why nothing is shown, or what was done to the model first; may be empty.
    pub note: String,
    /// Its part of the page in CSS pixels: left, top, width, height. The words go to its foot.
    pub rect: [f32; 4],
    /// What makes it the first; empty for the first.
    pub choose: String,
    /// What takes it away; empty for the first.
    pub leave: String,
}

/// Schemes side by side.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Compare {
    /// The present scheme and those beside it; none if there are none beside it.
    pub panes: Vec<Pane>,
    /// What puts another scheme beside them once its id is appended; empty if there is no room.
    pub add: String,
}

/// Milliseconds of the last time each was done.
#[derive(Clone, Copy, Default, Serialize)]
pub struct Times {
    /// Connecting the model's faces.
    pub read: f64,
    /// From the mesh to the level's points and faces.
    pub refine: f64,
    /// Whether the GPU did that.
    pub gpu: bool,
    /// Normals and buffers.
    pub build: f64,
    /// Recording one frame.
    pub draw: f64,
}

/// A line of the report.
#[derive(Clone, Serialize)]
pub struct Remark {
    /// One sentence.
    pub text: String,
    /// `note` or `warning`.
    pub kind: &'static str,
}

/// A parameter of the chosen scheme.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// As in commands.
    pub key: &'static str,
    /// What people read.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// `number` or `choice`.
    pub kind: &'static str,
    /// The least number.
    pub low: f64,
    /// The greatest number.
    pub high: f64,
    /// The number unless set.
    pub default: f64,
    /// The number that is set, or which choice.
    pub value: f64,
    /// The value as a word of a command.
    pub text: String,
    /// Buttons, one a choice; none for numbers.
    pub choices: Vec<ParameterChoice>,
    /// What sets it once the number or the choice's word is appended. Other parameters stay.
    pub command: String,
}

/// A choice of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterChoice {
    /// As in [`Parameter::text`].
    pub value: &'static str,
    /// On the button.
    pub label: String,
    /// What it sends.
    pub command: String,
}

/// A scheme that takes over at a later level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// The level that it begins with.
    pub from: u32,
    /// Its name, and what was set of it.
    pub name: String,
    /// What lets the scheme before it go on in its place.
    pub leave: String,
}

/// What would let a refused command work.
#[derive(Serialize)]
pub struct Offer {
    /// On the button.
    pub label: String,
    /// What it sends, one after the other.
    pub commands: Vec<String>,
}

/// A way to save.
#[derive(Serialize)]
pub struct ExportChoice {
    /// On the button.
    pub label: &'static str,
    /// What it is good for.
    pub help: &'static str,
    /// What the button sends.
    pub command: String,
}

/// The whole view model.
#[derive(Serialize)]
#[serde(tag = "type", rename = "state", rename_all = "camelCase")]
pub struct State {
    /// None until a model has been read.
    pub model: Option<ModelState>,
    /// The chosen scheme.
    pub scheme: &'static str,
    /// Its parameters.
    pub params: Vec<Parameter>,
    /// Schemes that take over later.
    pub runs: Vec<Run>,
    /// Levels that are faired, and by how many iterations.
    pub fairings: Vec<[u32; 2]>,
    /// The chosen level.
    pub level: u32,
    /// The ruler.
    pub levels: Vec<Level>,
    /// What is on the screen, which lags behind what is chosen while work goes on.
    pub shown: Shown,
    /// How long things took.
    pub times: Times,
    /// Whether work goes on.
    pub busy: bool,
    /// Schemes side by side.
    pub compare: Compare,
    /// The chosen value of each control.
    pub values: crate::controls::Values,
    /// Controls that do not apply.
    pub disabled: Vec<&'static str>,
    /// Groups of the model.
    pub groups: Vec<Group>,
    /// What reading and connecting found.
    pub report: Vec<Remark>,
    /// Ways to save.
    pub exports: Vec<ExportChoice>,
    /// What undo would take back, such as `level 3`; none if nothing.
    pub undo: Option<String>,
    /// What redo would do again.
    pub redo: Option<String>,
    /// The document, to be replayed.
    pub text: String,
    /// The part of `text` that opens the model.
    pub origin: String,
    /// The document as a fragment, with its `#`.
    pub link: String,
    /// What the receiver of the link will miss.
    pub link_note: String,
}

/// A message that stays until it is dismissed, or replaced by one with its id; one without title and lines goes away.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Card {
    /// What it is about: `read`, `link`, `report`, `ask`, `fault`, `draw`.
    pub id: &'static str,
    /// `error` or `note`.
    pub kind: &'static str,
    /// One line.
    pub title: String,
    /// Sentences.
    pub lines: Vec<String>,
    /// The file that an open button asks for, or empty.
    pub ask: String,
}

/// All other messages, to the page and to the surroundings.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Message {
    /// Work longer than 200 ms.
    Progress {
        /// What is being done; empty when it is over.
        what: String,
        /// 0 to 1, or negative if unknown.
        done: f32,
        /// Whether Cancel helps.
        cancel: bool,
    },
    /// A quiet message.
    Card {
        /// The card.
        card: Card,
    },
    /// An answer in the console.
    Log {
        /// What was asked.
        command: String,
        /// The answer; may be empty.
        text: String,
        /// Whether it worked.
        ok: bool,
        /// What would let it.
        offer: Option<Offer>,
    },
    /// The engine can do no more.
    Fault {
        /// Why.
        message: String,
        /// `trap` or `renderer`.
        kind: &'static str,
    },
    /// To the surroundings: read an address and call `fetched`.
    Fetch {
        /// The address.
        url: String,
        /// To be given back.
        turn: u32,
    },
}
