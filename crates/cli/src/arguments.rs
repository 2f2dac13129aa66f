//! What stands before SOURCE, and the manual.

use clap::Parser;
use limn_document::command;
use limn_mesh::{SCHEMES, SHAPES};

use crate::failure::CODES;

/// Subdivision surfaces on the command line: the page's commands, natively.
#[derive(Debug, Parser)]
#[command(name = "limn", version, arg_required_else_help = true, disable_help_subcommand = true, max_term_width = 100)]
#[command(override_usage = "limn [OPTIONS] SOURCE [COMMAND [ARGS ...]] ...
       limn [OPTIONS] run SCRIPT
       limn help [COMMAND]
       limn schemes")]
pub struct Arguments {
    /// How much memory a model and a refined level may take, as in 512M or 2G.
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = bytes)]
    pub memory: u64,
    /// Say nothing about the model on standard error, only what went wrong.
    #[arg(long, short)]
    pub quiet: bool,
    /// A model file, builtin:NAME, or one of run, help and schemes (write ./run for a file of that name).
    #[arg(value_name = "SOURCE")]
    pub source: String,
    /// Commands with their arguments, several in a row. Without any, info.
    #[arg(value_name = "COMMAND", trailing_var_arg = true, allow_hyphen_values = true)]
    pub words: Vec<String>,
}

/// Reads the command line; on `--help`, `--version` and errors it ends the program as clap does (0, 0 and 2).
pub fn arguments() -> Arguments {
    use clap::{CommandFactory, FromArgMatches};
    let matches = Arguments::command().after_help(reference()).get_matches();
    Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

/// All that `--help` says.
pub fn manual() -> String {
    use clap::CommandFactory;
    Arguments::command().after_help(reference()).render_help().to_string()
}

/// What is behind clap's own part of the help.
fn reference() -> String {
    let indented = |text: String| text.lines().map(|l| format!("  {l}\n")).collect::<String>();
    let shapes = SHAPES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
    let schemes = SCHEMES.iter().map(|s| s.info.id).collect::<Vec<_>>().join(", ");
    format!(
        "Commands (limn help COMMAND tells more):\n{}\n\
         Schemes: {schemes}\n\
         Built-in models, as builtin:NAME: {shapes}\n\n\
         A script has the same commands, a line each; # begins a comment. Vertices are numbered from 0 in the file's\n\
         order before welding. Files next to the model (.mtl, .bin, pictures) are found in its folder.\n\n\
         Examples:\n  \
           limn model.obj scheme catmull-clark level 3 export out.glb\n  \
           limn builtin:pawn scheme loop level 2 info\n  \
           limn --memory 2G scan.glb weld 1e-6 quads on info --json\n  \
           limn run script.limn\n\n{CODES}",
        indented(command::help(None)),
    )
}

/// Reads a number of bytes with an optional K, M, G or T (powers of 1024; a trailing B or iB is fine).
fn bytes(text: &str) -> Result<u64, String> {
    let bad = || "write a number of bytes, as in 500000000, 512M or 1.5G".to_owned();
    let upper = text.trim().to_ascii_uppercase();
    let number = upper.trim_end_matches('B').trim_end_matches('I');
    let (number, shift) = match number.char_indices().last() {
        Some((at, 'K')) => (&number[..at], 10),
        Some((at, 'M')) => (&number[..at], 20),
        Some((at, 'G')) => (&number[..at], 30),
        Some((at, 'T')) => (&number[..at], 40),
        _ => (number, 0),
    };
    let value = number.trim().parse::<f64>().map_err(|_| bad())? * (1u64 << shift) as f64;
    if value.is_finite() && value >= 1.0 { Ok(value as u64) } else { Err(bad()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(bytes("1000"), Ok(1000));
        assert_eq!(bytes("2G"), Ok(2 << 30));
        assert_eq!(bytes("1.5k"), Ok(1536));
        assert_eq!(bytes("512 MiB"), Ok(512 << 20));
        for bad in ["", "G", "-1", "nan", "inf", "2X", "0"] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_definition_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
