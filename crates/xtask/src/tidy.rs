//! `cargo xtask tidy`: is the house in order?
//!
//! In this order, cheapest first, each to its end: the house rules that are a text scan (`rules.rs`), rustfmt,
//! `tsc --checkJs` on `web/`, shaders under naga, clippy with warnings denied (native crates with all targets, the
//! engine for wasm with either renderer), clippy's restriction lints on input paths, rustdoc with warnings denied.
//!
//! Input paths are all of formats, document and engine outside tests: no `unwrap`, no `expect`, no `panic!` and the
//! like, no indexing or slicing that can panic. Where an index is right by construction, the function says so with
//! `#[expect(clippy::indexing_slicing, reason = "...")]`.

use crate::arguments::Arguments;
use crate::process::{self, say, seconds};
use crate::toolchain::{self, WASM};
use crate::wasm::Module;
use crate::{paths, rules};
use anyhow::{Result, bail};
use std::process::Command;
use std::time::Instant;

/// What may not happen on input paths.
const NO_PANIC: [&str; 7] =
    ["unwrap_used", "expect_used", "indexing_slicing", "panic", "unreachable", "todo", "unimplemented"];

/// Runs every check and fails when one fails.
pub fn run(arguments: Arguments) -> Result<()> {
    arguments.finish()?;
    let start = Instant::now();
    let mut failed = Vec::new();
    let mut check = |what: &'static str, good: bool| {
        if !good {
            failed.push(what);
        }
    };

    say("house rules");
    let wrong = rules::check()?;
    wrong.iter().for_each(|sentence| println!("{sentence}"));
    check("house rules", wrong.is_empty());

    toolchain::ensure_components()?;
    say("rustfmt");
    check("rustfmt", process::succeeds(process::cargo().args(["fmt", "--all", "--check"]))?);
    let bench = ["fmt", "--manifest-path", "bench/Cargo.toml", "--check"];
    check("rustfmt on bench/", process::succeeds(process::cargo().args(bench))?);

    toolchain::ensure_packages()?;
    say("tsc --checkJs on web/");
    let tsc = paths::root().join("node_modules/typescript/bin/tsc");
    check("tsc", process::succeeds(process::program("node").arg(tsc).args(["--project", "tsconfig.json"]))?);

    say("clippy");
    let mut native = process::cargo();
    native.args(["clippy", "--workspace", "--exclude", "limn-engine", "--all-targets", "--", "-D", "warnings"]);
    check("clippy", process::succeeds(&mut native)?);
    let mut paths_native = process::cargo();
    paths_native.args([
        "clippy",
        "--no-deps",
        "--package",
        "limn-formats",
        "--package",
        "limn-document",
        "--package",
        "limn-kernel",
        "--lib",
        "--",
    ]);
    check("clippy on input paths", process::succeeds(no_panic(&mut paths_native))?);

    toolchain::ensure_target(WASM)?;
    for module in Module::ALL {
        say(format!("clippy on the {} module", module.id()));
        let mut clippy = process::cargo();
        clippy.args(["clippy", "--no-deps", "--package", module.crate_name(), "--lib", "--target", WASM]);
        clippy.args(module.features());
        // One folder for all: what they share is checked once, and nothing is linked.
        clippy.arg("--target-dir").arg(paths::root().join("target/wasm-clippy"));
        clippy.env("RUSTFLAGS", toolchain::wasm_flags(true)).args(["--", "-D", "warnings"]);
        check("clippy on a wasm module", process::succeeds(no_panic(&mut clippy))?);
    }

    say("shaders under naga");
    check(
        "shaders",
        process::succeeds(process::cargo().args(["test", "--quiet", "--package", "xtask", "--test", "wgsl"]))?,
    );

    say("rustdoc");
    let mut docs = process::cargo();
    docs.args(["doc", "--quiet", "--no-deps", "--workspace", "--exclude", "limn-engine", "--exclude", "xtask"]);
    check("rustdoc", process::succeeds(docs.env("RUSTDOCFLAGS", "-D warnings"))?);

    if failed.is_empty() {
        println!("tidy in {}", seconds(start));
        return Ok(());
    }
    bail!("not tidy: {}", failed.join(", "))
}

fn no_panic(command: &mut Command) -> &mut Command {
    for lint in NO_PANIC {
        command.arg("-D").arg(format!("clippy::{lint}"));
    }
    command
}

/// The lines of a source that are code, numbered from 1: without comments, and in Rust without the tests at its end.
pub fn code(text: &str, toml: bool) -> impl Iterator<Item = (usize, &str)> {
    let mark = if toml { "#" } else { "//" };
    let end = text.find("\n#[cfg(test)]\nmod tests {").filter(|_| !toml).unwrap_or(text.len());
    (1..)
        .zip(text[..end].lines())
        .map(move |(number, line)| (number, line.split_once(mark).map_or(line, |(code, _)| code)))
}
