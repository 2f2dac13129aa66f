//! From words to commands, by the table alone.
//!
//! ```text
//!   words   scheme loop level -1 info --json
//!           ^----- ^--- scheme takes one argument; `level` is no KEY=VALUE, so the next command begins
//! ```
//!
//! One word of lookahead decides everything, so reading is linear. Messages say what was expected and how the command is
//! written; a misspelt command is offered the nearest name.

use std::str::FromStr;

use super::rows::COMMANDS;
use super::table::{Keys, Parsed, Spec, spec};
use super::{Command, SchemeWords, table};
use crate::view::{VIEW_KEYS, ViewSet};
use crate::words::{self, WordError, shorten};

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
    #[error("there is no command `{word}`; {}", did_you_mean(*.near))]
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
    near.map_or_else(|| "`help` lists them".to_owned(), |name| format!("did you mean `{name}`?"))
}

fn known(keys: &[&'static str]) -> String {
    if keys.is_empty() { String::new() } else { format!("; it knows {}", keys.join(", ")) }
}

/// The command's name that differs least from `word`, if little: by at most two fifths of its letters.
fn nearest(word: &str) -> Option<&'static str> {
    let best = COMMANDS.iter().map(|s| (distance(word, s.name), s.name)).min()?;
    (best.0 * 5 <= best.1.len() * 2).then_some(best.1)
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
    let spec = spec(name).ok_or_else(|| ParseError::Unknown { word: shorten(name), near: nearest(name) })?;
    let mut parsed = Parsed::default();
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
                        word: shorten(word),
                        expected: arg.kind.expected(),
                        usage: spec.usage(),
                    });
                }
            }
            args.next();
        } else if let Some((key, value)) =
            word.split_once('=').filter(|(key, _)| spec.keys != Keys::None && table::is_id(key))
        {
            read_key(spec, key, value, &mut parsed)?;
        } else if spec.keys == Keys::Schemes && table::is_id(word) && table::spec(word).is_none() {
            parsed.more.push(SchemeWords { id: word.to_owned(), parameters: Vec::new() });
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
                key: shorten(key),
                keys: VIEW_KEYS.iter().map(|k| k.name).collect(),
            })?;
            let set = ViewSet::parse(key, value).ok_or_else(|| ParseError::KeyValue {
                command: spec.name,
                key: shorten(key),
                value: shorten(value),
                expected: known.values(),
            })?;
            parsed.view.push(set);
        }
        // To the left: of the last scheme named.
        Keys::Parameters | Keys::Schemes | Keys::None => {
            let list = parsed.more.last_mut().map_or(&mut parsed.parameters, |words| &mut words.parameters);
            list.push((key.to_owned(), value.to_owned()));
        }
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
                    word: shorten(first.as_ref()),
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
                word: shorten(word),
                usage: spec(command.name()).map(Spec::usage).unwrap_or_default(),
            }),
        }
    }
}
