//! limn-document: a document is a source plus commands.
//!
//! Every button, key, console line, link and script says the same text commands. This crate knows their grammar
//! ([`command`]), what they do to a model ([`document`]), how they are undone ([`history`]), how they travel in an address
//! ([`link`]), and where the viewer stands ([`camera`], [`view`]). Refined surfaces are derived by the host and never
//! stored. There is no GPU, browser, clock or I/O in here, so the page, the command line and the tests run the same
//! document.
//!
//! ```
//! use limn_document::{Document, Outcome};
//!
//! let mut document = Document::new(1 << 30);
//! assert_eq!(document.run("open builtin:cube")?, Outcome::Model);
//! assert_eq!(document.run("level 3")?, Outcome::Refine);
//! document.run("view edges=bold")?;
//! assert_eq!(document.link(), "#1;open+builtin:cube;scheme+catmull-clark;level+3;view+edges=bold");
//! # Ok::<(), limn_document::CommandError>(())
//! ```

mod bounds;
mod build;
pub mod camera;
pub mod command;
pub mod compare;
mod decimal;
pub mod document;
mod error;
pub mod export;
pub mod history;
pub mod info;
pub mod link;
pub mod numbers;
mod outcome;
pub mod parameters;
mod pinch;
pub mod remedy;
pub mod source;
mod state;
pub mod view;
pub mod words;

pub use build::{BuildError, Remark};
pub use camera::{Bounds, Camera};
pub use command::{COMMANDS, Class, Command, ParseError};
pub use document::Document;
pub use error::CommandError;
pub use info::Info;
pub use link::LinkError;
pub use outcome::{Outcome, Replayed};
pub use source::{Source, Stamp};
pub use view::{View, ViewSet};
