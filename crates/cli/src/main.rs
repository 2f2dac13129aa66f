//! `limn`: subdivision surfaces on the command line.
//!
//! The program is the page's document without the page. clap reads what stands before SOURCE; all words behind it are the
//! document's own commands, several in a line, parsed by the same table as links and the console.
//!
//! ```text
//!   limn --memory 2G  model.obj  scheme catmull-clark level 3 export out.glb
//!        clap         SOURCE     document commands, all checked before the first one runs
//! ```
//!
//! Standard output carries what was asked for (`info`, `help`), standard error what there is to remark, and the exit code
//! says what kind of thing went wrong ([`failure::Failure`]).

mod arguments;
mod failure;
mod folder;
mod session;

use std::io::{ErrorKind, Read, Write};
use std::process::ExitCode;

use limn_document::command::{self, Command, parse_all, parse_script};
use limn_document::{Class, Source, parameters};
use limn_mesh::SCHEMES;

use crate::arguments::{Arguments, arguments};
use crate::failure::Failure;
use crate::session::Session;

fn main() -> ExitCode {
    let arguments = arguments();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(message) = failure.message() {
                // Nothing can be done about an error that cannot be told.
                let _ = writeln!(std::io::stderr(), "error: {message}");
            }
            ExitCode::from(failure.code())
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rest = &arguments.words;
    match arguments.source.as_str() {
        "help" => help(rest),
        "schemes" if rest.is_empty() => schemes(),
        "schemes" => Err(Failure::Usage("`limn schemes` takes nothing behind it".into())),
        "run" => match rest.as_slice() {
            [script] => run_script(arguments, script),
            _ => Err(Failure::Usage(
                "`limn run` takes one script, as in `limn run script.limn`, or - for standard input".into(),
            )),
        },
        "" => Err(Failure::Usage("the source is empty; name a model file or builtin:NAME".into())),
        source => {
            let mut commands = parse_all(rest).map_err(|error| Failure::Usage(error.to_string()))?;
            if commands.is_empty() {
                commands.push(Command::Info { json: false });
            }
            let source = Source::parse(source)
                .filter(|s| !matches!(s, Source::File { .. }))
                .unwrap_or_else(|| Source::File { name: source.to_owned(), stamp: None });
            commands.insert(0, Command::Open(source));
            Session::new(arguments, std::path::PathBuf::new()).run(&commands)
        }
    }
}

fn run_script(arguments: &Arguments, script: &str) -> Result<(), Failure> {
    let (name, text) = if script == "-" {
        let mut text = String::new();
        let read = std::io::stdin().read_to_string(&mut text);
        ("standard input", read.map(|_| text))
    } else {
        (script, std::fs::read_to_string(script))
    };
    let text = text.map_err(|error| Failure::Input(format!("{name} cannot be read: {error}")))?;
    let commands = parse_script(&text).map_err(|error| Failure::Usage(format!("{name}, {error}")))?;
    // Only a description without an end is no use to anyone: say what the script leads to.
    let silent = !commands.iter().any(|c| c.class() == Class::Action && !matches!(c, Command::Version(_)));
    let commands = if silent && !commands.is_empty() {
        commands.into_iter().chain([Command::Info { json: false }]).collect()
    } else {
        commands
    };
    // Models are looked for next to the script.
    let folder = std::path::Path::new(script).parent().map(Into::into).unwrap_or_default();
    Session::new(arguments, folder).run(&commands)
}

fn help(words: &[String]) -> Result<(), Failure> {
    match words {
        [] => print(&arguments::manual()),
        [name] if command::spec(name).is_some() => print(&command::help(Some(name))),
        [name, ..] => Err(Failure::Usage(format!("there is no command `{name}`; `limn help` lists them"))),
    }
}

fn schemes() -> Result<(), Failure> {
    let mut text = String::new();
    let width = SCHEMES.iter().map(|s| s.info.id.len()).max().unwrap_or(0);
    for entry in SCHEMES {
        let info = &entry.info;
        text.push_str(&format!("{:width$}  {} ({}). {}\n", info.id, info.name, info.group, info.summary));
        for param in info.params {
            let (key, expected) = (param.key, parameters::expected(param));
            let usual = parameters::text(param, param.domain.default());
            text.push_str(&format!("{:width$}    {key}= {expected}; {usual} unless set. {}\n", "", param.summary));
        }
    }
    print(&text)
}

/// Writes to standard output. A reader that has gone away, such as `head`, is no failure but the end.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Failure::Closed),
        Err(error) => Err(Failure::Output(format!("standard output cannot be written: {error}"))),
    }
}
