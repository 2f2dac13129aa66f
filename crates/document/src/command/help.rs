//! What the table tells people: the text of `help`, and what can be typed next.

use super::parse::parse_words;
use super::rows::COMMANDS;
use super::table::{Keys, Kind, spec};
use crate::view::VIEW_KEYS;
use crate::words;

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
                None if row.keys == Keys::Schemes => found.extend(Kind::Scheme.candidates()),
                None => {}
            }
            // Behind a whole command the next may begin.
            if !start.is_empty() && words.get(from..).is_some_and(|w| parse_words(w).is_ok()) {
                let all = COMMANDS.iter().map(|s| s.name.to_owned());
                let more: Vec<String> = all.filter(|name| !found.contains(name)).collect();
                found.extend(more);
            }
            found.extend(row.flags.iter().filter(|f| !given.iter().any(|g| g == *f)).map(|&f| f.to_owned()));
        }
    }
    found.retain(|word| word.starts_with(&start));
    found
}
