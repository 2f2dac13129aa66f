//! The share link: a document's commands in the fragment of an address.
//!
//! ```text
//!   #1;open+builtin:cube;scheme+loop;level+3;view+edges=bold
//!    |  \______________ commands, parted by ";" ____________/
//!    grammar version
//! ```
//!
//! A space is `+`. Letters, digits and `-._~:/,=@?` stand for themselves, so that a link can be read and edited by hand;
//! everything else is `%` and two hexadecimal digits for each byte of its UTF-8. A sign at the very end is escaped too,
//! since chat programs leave a full stop or comma at the end of an address out of the link. Reading takes more than
//! writing gives: the `#` may be missing, `%20` is a space, and a fragment that some program escaped once more as a whole is
//! unescaped first.
//!
//! A link that cannot be read is an error that names its part; nothing is guessed or left out. Only commands of a document
//! (`open`, models, settings, view) may be in one: a link never writes files or answers questions.

use std::fmt::Write;

use crate::command::{Class, Command, ParseError, VERSION};
use crate::document::Document;
use crate::words::shorten;

/// Why a link cannot be opened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// Nothing behind the `#`.
    #[error("the link is empty; copy it again, from the # on")]
    Empty,
    /// It does not begin with a version and a `;`.
    #[error("the link begins with `{0}` where a version number such as `1;` belongs; copy the whole link again")]
    NoVersion(String),
    /// A version of the grammar that this program does not know.
    #[error(
        "the link was made by a newer Limn (version {0} of the commands, this one knows {VERSION}); reload the page to get it"
    )]
    Newer(u64),
    /// A `%` that two hexadecimal digits do not follow, or bytes that are no UTF-8.
    #[error("part {part} of the link, `{text}`, is damaged: a % code in it is broken; copy the link again")]
    Escape {
        /// Which part, counted from 1 behind the version.
        part: usize,
        /// That part as it stands in the link.
        text: String,
    },
    /// A part that is not a command.
    #[error("part {part} of the link, `{text}`, is not understood: {error}")]
    Command {
        /// Which part, counted from 1 behind the version.
        part: usize,
        /// That part, unescaped.
        text: String,
        /// What is wrong with it.
        error: Box<ParseError>,
    },
    /// A command that acts rather than describes.
    #[error("part {part} of the link, `{text}`, is an action; a link only holds a model and how it is shown")]
    Action {
        /// Which part, counted from 1 behind the version.
        part: usize,
        /// That part, unescaped.
        text: String,
    },
    /// The first command does not open a model.
    #[error("the link names no model: its first part has to be `open` and a source")]
    NoSource,
}

/// The fragment, with its `#`, for these commands (one text each, as [`Command`] writes them).
pub fn write<S: AsRef<str>>(commands: impl IntoIterator<Item = S>) -> String {
    let mut link = format!("#{VERSION}");
    for command in commands {
        link.push(';');
        for c in command.as_ref().chars() {
            match c {
                ' ' => link.push('+'),
                c if c.is_ascii_alphanumeric()
                    || matches!(c, '-' | '.' | '_' | '~' | ':' | '/' | ',' | '=' | '@' | '?') =>
                {
                    link.push(c)
                }
                c => escape(c, &mut link),
            }
        }
    }
    // A program that finds addresses in text takes a sign at their end for the sentence's.
    if let Some(last) = link.pop() {
        match last {
            '.' | ',' | ':' | '?' | '~' | '-' | '_' => escape(last, &mut link),
            c => link.push(c),
        }
    }
    link
}

/// The commands of a fragment, each one checked. The `#` may be missing.
///
/// # Errors
/// [`LinkError`] names the part that cannot be read.
pub fn read(fragment: &str) -> Result<Vec<Command>, LinkError> {
    let text = fragment.trim();
    let text = text.strip_prefix('#').unwrap_or(text);
    if text.is_empty() {
        return Err(LinkError::Empty);
    }
    let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (version, rest) = text.split_at_checked(digits).unwrap_or(("", text));
    // A version is digits and a semicolon, so an escaped semicolon there means that all of it was escaped.
    if rest.get(..3).is_some_and(|s| s.eq_ignore_ascii_case("%3b")) && !rest.contains([';']) {
        let once = unescape(text, false).ok_or_else(|| LinkError::Escape { part: 1, text: shorten(rest) })?;
        return read(&once);
    }
    if version.is_empty() || !(rest.is_empty() || rest.starts_with(';')) {
        return Err(LinkError::NoVersion(shorten(text)));
    }
    match version.parse::<u64>() {
        Ok(v) if v == u64::from(VERSION) => {}
        Ok(0) => return Err(LinkError::NoVersion(shorten(text))),
        other => return Err(LinkError::Newer(other.unwrap_or(u64::MAX))),
    }
    let commands = rest
        .split(';')
        .enumerate()
        // Before the first semicolon there is nothing, and one at the end ends nothing new.
        .filter(|(_, text)| !text.is_empty())
        .map(|(part, text)| read_part(part, text))
        .collect::<Result<Vec<_>, _>>()?;
    match commands.first() {
        Some(Command::Open(_)) => Ok(commands),
        _ => Err(LinkError::NoSource),
    }
}

fn read_part(part: usize, text: &str) -> Result<Command, LinkError> {
    let plain = unescape(text, true).ok_or_else(|| LinkError::Escape { part, text: shorten(text) })?;
    match plain.parse::<Command>() {
        Err(error) => Err(LinkError::Command { part, text: shorten(&plain), error: error.into() }),
        Ok(command) if command.class() == Class::Action => Err(LinkError::Action { part, text: shorten(&plain) }),
        Ok(command) => Ok(command),
    }
}

fn escape(c: char, out: &mut String) {
    let mut buffer = [0; 4];
    for byte in c.encode_utf8(&mut buffer).bytes() {
        // Writing to a string cannot fail.
        let _ = write!(out, "%{byte:02X}");
    }
}

/// `text` with each `%XX` as the byte that it stands for, and `+` as a space if `plus`. `None` for a broken code or if the
/// bytes are no UTF-8.
pub(crate) fn unescape(text: &str, plus: bool) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let mut digit = || char::from(rest.next()?).to_digit(16);
                (digit()? * 16 + digit()?) as u8
            }
            b'+' if plus => b' ',
            byte => byte,
        });
    }
    String::from_utf8(bytes).ok()
}

impl Document {
    /// The fewest commands that lead here from an empty document; empty without a model.
    pub fn commands(&self) -> Vec<Command> {
        let Some(state) = &self.state else { return Vec::new() };
        let mut commands = state.commands();
        let view = self.view().settings();
        if !view.is_empty() {
            commands.push(Command::View(view));
        }
        commands
    }

    /// [`Self::commands`] as a script, a line each behind the grammar's version. What crash recovery keeps.
    pub fn text(&self) -> String {
        let mut text = format!("version {VERSION}\n");
        for command in self.commands() {
            text.push_str(&command.to_string());
            text.push('\n');
        }
        text
    }

    /// [`Self::commands`] as the fragment of an address, with its `#`; empty without a model.
    pub fn link(&self) -> String {
        if self.state.is_none() {
            return String::new();
        }
        write(self.commands().iter().map(Command::to_string))
    }
}
