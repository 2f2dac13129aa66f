//! A scheme's parameters as text: `weights=warren`, `w=0.05`.
//!
//! The registry says what there is and what it can be; this reads `key=value` words against it and writes back what was
//! set. Numbers keep the digits that bring them back.

use limn_mesh::fairing::MOST_ITERATIONS;
use limn_mesh::{Domain, Fairing, Info, Param, Params, Plan, Run};

use crate::command::{Command, SchemeWords};
use crate::error::CommandError;
use crate::numbers::{self, number};
use crate::state::find_scheme;

/// Reads words against the scheme's list. A key that comes twice counts the last time.
pub(crate) fn read(info: &'static Info, words: &[(String, String)]) -> Result<Params, CommandError> {
    let mut params = Params::default();
    for (key, text) in words {
        let at = info.params.iter().position(|p| p.key == key);
        let Some((at, param)) = at.and_then(|at| Some((at, info.params.get(at)?))) else {
            return Err(CommandError::UnknownParameter { scheme: info.id, key: key.clone(), known: keys(info) });
        };
        let value = match &param.domain {
            Domain::Number { .. } | Domain::Whole { .. } => number(text),
            Domain::Choice(words) => words.iter().position(|w| w == text).map(|i| i as f64),
        };
        if !value.is_some_and(|v| params.set(info, at, v)) {
            return Err(CommandError::BadParameter {
                key: param.key,
                value: crate::words::shorten(text),
                expected: expected(param),
            });
        }
    }
    Ok(params)
}

/// The highest level that a key can name: more than any budget holds.
const HIGHEST: u32 = 31;

/// Takes the level that `key` names out of words: 0 if none does.
pub(crate) fn level(
    words: &[(String, String)],
    key: &'static str,
) -> Result<(u32, Vec<(String, String)>), CommandError> {
    let (named, others): (Vec<_>, Vec<_>) = words.iter().cloned().partition(|(k, _)| k == key);
    let Some((_, text)) = named.last() else { return Ok((0, others)) };
    let level = text.parse().ok().filter(|l| *l <= HIGHEST).ok_or_else(|| CommandError::BadParameter {
        key,
        value: crate::words::shorten(text),
        expected: format!("a level from 0 to {HIGHEST}"),
    })?;
    Ok((level, others))
}

/// The fairing that `fair taubin N at=K` means.
pub(crate) fn fairing(iterations: i32, words: &[(String, String)]) -> Result<Fairing, CommandError> {
    let (at, others) = level(words, "at")?;
    if let Some((key, _)) = others.first() {
        return Err(CommandError::UnknownKey { command: "fair", key: crate::words::shorten(key), known: "at" });
    }
    let most = |n: &u32| *n <= MOST_ITERATIONS;
    let iterations = u32::try_from(iterations).ok().filter(most).ok_or(CommandError::Iterations(iterations))?;
    Ok(Fairing { at, iterations })
}

/// A scheme by its id, with what follows that in a command.
pub(crate) fn scheme(id: &str, words: &[(String, String)]) -> Result<Run, CommandError> {
    let scheme = find_scheme(id)?;
    Ok(Run { from: 0, scheme, params: read(&scheme.info, words)? })
}

/// The words for what was set.
fn write(info: &Info, params: &Params) -> Vec<(String, String)> {
    let set = info.params.iter().enumerate().filter_map(|(at, p)| Some((p, params.get(at)?)));
    set.map(|(param, value)| (param.key.to_owned(), text(param, value))).collect()
}

/// The command that chooses the scheme of a plan, parameters and all.
pub fn command(plan: &Plan) -> Command {
    run_command(&plan.run(0))
}

/// The command that lets a scheme take over, parameters and all.
pub fn run_command(run: &Run) -> Command {
    let SchemeWords { id, mut parameters } = words(run);
    if run.from > 0 {
        parameters.insert(0, ("from".to_owned(), run.from.to_string()));
    }
    Command::Scheme { id, parameters }
}

/// A scheme with its parameters, as commands name it.
pub fn words(run: &Run) -> SchemeWords {
    SchemeWords { id: run.scheme.info.id.to_owned(), parameters: write(&run.scheme.info, &run.params) }
}

/// The command that sets parameter `at` of a plan's scheme and keeps the others, up to the value, which has to follow.
/// Empty if there is no such parameter.
pub fn prefix(plan: &Plan, at: usize) -> String {
    let info = &plan.scheme.info;
    let Some(param) = info.params.get(at) else { return String::new() };
    let mut others = plan.clone();
    others.params.set(info, at, param.domain.default());
    format!("{} {}=", command(&others), param.key)
}

/// A value as a word.
pub fn text(param: &Param, value: f64) -> String {
    match &param.domain {
        Domain::Number { .. } | Domain::Whole { .. } => numbers::text(value),
        Domain::Choice(words) => words.get(value as usize).copied().unwrap_or_default().to_owned(),
    }
}

/// What a parameter can be, for messages: "a number from 0 to 0.125", "loop or warren".
pub fn expected(param: &Param) -> String {
    match &param.domain {
        Domain::Number { low, high, .. } => {
            format!("a number from {} to {}", numbers::text(*low), numbers::text(*high))
        }
        Domain::Whole { low, high, .. } => format!("a whole number from {low} to {high}"),
        Domain::Choice(words) => words.join(" or "),
    }
}

fn keys(info: &Info) -> String {
    let keys: Vec<&str> = info.params.iter().map(|p| p.key).collect();
    if keys.is_empty() { "it takes none".into() } else { format!("it takes {}", keys.join(", ")) }
}

#[cfg(test)]
mod tests {
    use crate::Document;

    #[test]
    fn parameters_come_back_as_they_were_set() {
        let mut document = Document::new(1 << 30);
        document.run("open builtin:pawn").unwrap();
        for (line, kept) in [
            ("scheme loop weights=warren", "scheme loop weights=warren"),
            ("scheme loop", "scheme loop"),
            ("scheme n-way n=5", "scheme n-way n=5"),
            ("scheme n-way n=3", "scheme n-way"),
            ("scheme tri-to-quad average=off", "scheme tri-to-quad average=off"),
            ("scheme butterfly w=0.05", "scheme butterfly w=0.05"),
            ("scheme j-spline move=off s=1.25", "scheme j-spline s=1.25 move=off"),
            ("scheme j-spline s=0.5 move=off move=on", "scheme j-spline"),
            ("scheme butterfly w=0.01 w=0.0625", "scheme butterfly"),
        ] {
            document.run(line).unwrap();
            assert!(document.text().lines().any(|l| l == kept), "{line}: {}", document.text());
            let mut again = Document::new(1 << 30);
            document.text().lines().for_each(|l| _ = again.run(l).unwrap());
            assert_eq!(again.text(), document.text());
        }
        let before = document.text();
        let refuse = |document: &mut Document, line: &str| document.run(line).unwrap_err().to_string();
        assert_eq!(refuse(&mut document, "scheme loop w=1"), "the scheme loop has no parameter `w`; it takes weights");
        assert_eq!(
            refuse(&mut document, "scheme butterfly w=2"),
            "`w=2` is not possible; w is a number from 0 to 0.125"
        );
        assert_eq!(
            refuse(&mut document, "scheme n-way n=2.5"),
            "`n=2.5` is not possible; n is a whole number from 2 to 16"
        );
        assert_eq!(
            refuse(&mut document, "scheme loop weights=mine"),
            "`weights=mine` is not possible; weights is loop or warren"
        );
        assert_eq!(refuse(&mut document, "scheme linear s=1"), "the scheme linear has no parameter `s`; it takes none");
        assert_eq!(document.text(), before, "a refused scheme changes nothing");
    }

    #[test]
    fn a_prefix_keeps_the_other_parameters() {
        let mut document = Document::new(1 << 30);
        document.run("open builtin:pawn").unwrap();
        document.run("scheme j-spline s=1.25 move=off").unwrap();
        let prefix = |document: &Document, at| super::prefix(&document.plan().unwrap(), at);
        assert_eq!(prefix(&document, 0), "scheme j-spline move=off s=");
        assert_eq!(prefix(&document, 1), "scheme j-spline s=1.25 move=");
        assert_eq!(prefix(&document, 2), "");
        let line = format!("{}0.75", prefix(&document, 0));
        document.run(&line).unwrap();
        assert_eq!(prefix(&document, 1), "scheme j-spline s=0.75 move=");
    }
}
