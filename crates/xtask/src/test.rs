//! `cargo xtask test`: every test there is, after setting up what they need.
//!
//! ```text
//! native    cargo test for all crates but the wasm one, documentation examples included
//! wasm      the kernel's and the readers' tests once more, as WebAssembly under Node; and the same bits as native
//! browser   the page as it ships, in a real headless Chromium, on WebGPU and on WebGL2
//! ```
//!
//! Every group runs to its end even when a test fails, the last line counts, and the exit code tells.

use crate::arguments::Arguments;
use crate::process::{self, say, seconds};
use crate::toolchain::{self, WASI};
use crate::wasm::Profile;
use crate::{dist, paths};
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// The crates whose tests also run as WebAssembly.
const ON_WASM: [&str; 3] = ["limn-mesh", "limn-formats", "limn-document"];

/// What the runners reported, added up.
#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
    failures: Vec<String>,
}

/// Runs the tests: all of them, one group (`--only`), or those whose names contain a text (`--filter`).
pub fn run(mut arguments: Arguments) -> Result<()> {
    let filter = arguments.value("--filter")?;
    let only = arguments.value("--only")?;
    let quick = arguments.flag("--quick");
    arguments.finish()?;
    if let Some(group) = &only
        && !["native", "wasm", "browser"].contains(&group.as_str())
    {
        bail!("`{group}` is no group of tests: native, wasm or browser");
    }
    let wanted = |group: &str| only.as_deref().is_none_or(|only| only == group);

    let start = Instant::now();
    let mut tally = Tally::default();
    if wanted("native") {
        native(filter.as_deref(), &mut tally)?;
    }
    if wanted("wasm") {
        wasm(filter.as_deref(), &mut tally)?;
    }
    if wanted("browser") {
        browser(filter.as_deref(), quick, &mut tally)?;
    }
    for failure in &tally.failures {
        println!("failed: {failure}");
    }
    println!("{} passed, {} failed, {} skipped in {}", tally.passed, tally.failed, tally.skipped, seconds(start));
    match (tally.failed, tally.passed) {
        (0, 0) => bail!("no test ran"),
        (0, _) => Ok(()),
        (failed, _) => bail!("{failed} test{} failed", if failed == 1 { "" } else { "s" }),
    }
}

fn native(filter: Option<&str>, tally: &mut Tally) -> Result<()> {
    toolchain::ensure_vulkan()?;
    say("native tests");
    let mut command = process::cargo();
    command.args(["test", "--workspace", "--exclude", "limn-engine", "--no-fail-fast"]).args(filter);
    // There is a driver now: drawing tests that find none have failed, not been skipped.
    command.env("LIMN_GPU", "require");
    tally.rust("native tests", &mut command)?;
    // The engine's own logic is testable without a browser; its wasm parts are compiled out.
    let mut command = process::cargo();
    command.args(["test", "--package", "limn-engine", "--lib", "--no-fail-fast"]).args(filter);
    tally.rust("native tests of the engine", &mut command)
}

fn wasm(filter: Option<&str>, tally: &mut Tally) -> Result<()> {
    toolchain::ensure_node()?;
    toolchain::ensure_target(WASI)?;
    say("tests as WebAssembly under Node");
    let mut command = wasi("test");
    for name in ON_WASM {
        command.args(["--package", name]);
    }
    command.args(["--lib", "--tests", "--no-fail-fast"]).args(filter);
    tally.rust("tests as WebAssembly", &mut command)?;
    if filter.is_none_or(|filter| "hashes_of_refined_models".contains(filter)) {
        same_bits(tally)?;
    }
    Ok(())
}

/// `cargo COMMAND` for WASI, run under Node, in a target folder of its own.
pub fn wasi(subcommand: &str) -> Command {
    let mut command = process::cargo();
    command.args([subcommand, "--target", WASI, "--target-dir"]).arg(paths::root().join("target/wasm-tests"));
    command.env("RUSTFLAGS", toolchain::wasm_flags(true));
    let runner = paths::root().join("tests/wasi.mjs");
    command.env("CARGO_TARGET_WASM32_WASIP1_RUNNER", format!("node {}", runner.display()));
    command
}

/// Compares what `crates/mesh/tests/bits.rs` prints natively and as WebAssembly.
fn same_bits(tally: &mut Tally) -> Result<()> {
    say("the same bits natively and as WebAssembly");
    let lines = |mut command: Command| -> Result<Vec<String>> {
        command.args(["--quiet", "--package", "limn-mesh", "--test", "bits", "--", "--nocapture"]);
        let output = process::output(&mut command)?;
        Ok(output.lines().filter_map(|line| line.find("bits ").map(|at| line[at..].to_owned())).collect())
    };
    let mut native = process::cargo();
    native.arg("test");
    let (native, wasm) = (lines(native)?, lines(wasi("test"))?);
    let differing: Vec<_> = native.iter().zip(&wasm).filter(|(a, b)| a != b).collect();
    if !native.is_empty() && native.len() == wasm.len() && differing.is_empty() {
        println!("{} results have the same bits", native.len());
        tally.passed += 1;
    } else {
        println!("{} results natively, {} as WebAssembly, {} differ", native.len(), wasm.len(), differing.len());
        for (native, wasm) in differing.iter().take(5) {
            println!("  native {native}\n  wasm   {wasm}");
        }
        tally.fail("native and WebAssembly give the same bits");
    }
    Ok(())
}

/// Saves pictures of the page under `target/screenshots`.
pub fn screenshots(arguments: Arguments) -> Result<()> {
    arguments.finish()?;
    let mut node = page(true)?;
    process::run(node.arg("tests/browser/screenshots.mjs"))
}

/// Prints what a level's buffers take when the slider goes there, on the page as it ships.
pub fn slider(arguments: Arguments) -> Result<()> {
    arguments.finish()?;
    let mut node = page(false)?;
    process::run(node.arg("tests/browser/slider.mjs").env("LIMN_QUICK", "1"))
}

/// Sets up what the page's tests need, and returns a Node that knows where it is.
fn page(quick: bool) -> Result<Command> {
    toolchain::ensure_packages()?;
    let chrome = toolchain::ensure_chromium()?;
    let site = if quick { paths::root().join("target/site") } else { paths::dist() };
    dist::build(if quick { Profile::Serve } else { Profile::Dist }, &site)?;
    let mut node = process::program("node");
    node.env("CHROME", chrome).env("LIMN_SITE", site).env("LIMN_CLI", cli());
    if quick {
        node.env("LIMN_QUICK", "1");
    }
    Ok(node)
}

fn browser(filter: Option<&str>, quick: bool, tally: &mut Tally) -> Result<()> {
    let mut command = page(quick)?;
    say("building the command line that reads the page's files back");
    process::run(process::cargo().args(["build", "--quiet", "--package", "limn"]))?;
    say("browser tests");
    let mut files = dist::files(&paths::root().join("tests/browser"))?;
    files.retain(|file| file.to_string_lossy().ends_with(".test.mjs"));
    // One file at a time: each measures, and software drawing takes every core there is.
    command.args(["--test", "--test-reporter=spec", "--test-concurrency=1"]);
    if let Some(filter) = filter {
        command.arg("--test-name-pattern").arg(filter);
    }
    tally.node("browser tests", command.args(files))
}

fn cli() -> impl AsRef<std::ffi::OsStr> {
    let name = if cfg!(windows) { "limn.exe" } else { "limn" };
    paths::root().join(Path::new("target/debug").join(name))
}

impl Tally {
    fn fail(&mut self, what: &str) {
        self.failed += 1;
        self.failures.push(what.to_owned());
    }

    /// Runs cargo's tests and adds up lines such as `test result: ok. 13 passed; 0 failed; 2 ignored; ...`.
    fn rust(&mut self, what: &str, command: &mut Command) -> Result<()> {
        self.runner(what, command, |tally, line| {
            if let Some(name) = line.strip_prefix("test ").and_then(|rest| rest.split_once(" ... FAILED")) {
                tally.failures.push(name.0.to_owned());
            }
            let Some((_, counts)) = line.strip_prefix("test result: ").and_then(|rest| rest.split_once(". ")) else {
                return;
            };
            for part in counts.split(';') {
                match part.trim().split_once(' ').map(|(n, what)| (n.parse().unwrap_or(0), what)) {
                    Some((n, "passed")) => tally.passed += n,
                    Some((n, "failed")) => tally.failed += n,
                    Some((n, "ignored")) => tally.skipped += n,
                    _ => {}
                }
            }
        })
    }

    /// Runs Node's tests and adds up its last lines, such as `ℹ pass 13`.
    fn node(&mut self, what: &str, command: &mut Command) -> Result<()> {
        self.runner(what, command, |tally, line| {
            match line
                .strip_prefix("ℹ ")
                .and_then(|rest| rest.split_once(' '))
                .map(|(what, n)| (what, n.parse().unwrap_or(0)))
            {
                Some(("pass", n)) => tally.passed += n,
                Some(("fail" | "cancelled", n)) => tally.failed += n,
                Some(("skipped" | "todo", n)) => tally.skipped += n,
                _ => {}
            }
        })
    }

    fn runner(&mut self, what: &str, command: &mut Command, mut see: impl FnMut(&mut Self, &str)) -> Result<()> {
        let before = self.failed;
        let good = process::watch(command, |line| see(self, line))?;
        // A runner that did not get as far as counting: a build that failed, a program that trapped.
        if !good && self.failed == before {
            self.fail(what);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str, rust: bool, code: i32) -> Tally {
        let mut tally = Tally::default();
        let mut command = Command::new("sh");
        command.args(["-c", &format!("cat <<'E'\n{text}\nE\nexit {code}")]);
        if rust {
            tally.rust("runner", &mut command).unwrap()
        } else {
            tally.node("runner", &mut command).unwrap()
        }
        tally
    }

    #[test]
    fn counts_of_both_runners_are_added_up() {
        let text = "test a ... FAILED\ntest result: FAILED. 12 passed; 1 failed; 3 ignored; 0 measured; 0 filtered out\n\
                    test result: ok. 4 passed; 0 failed; 0 ignored";
        let tally = printed(text, true, 1);
        assert_eq!((tally.passed, tally.failed, tally.skipped), (16, 1, 3));
        assert_eq!(tally.failures, ["a"]);
        let tally = printed("ℹ tests 5\nℹ pass 3\nℹ fail 1\nℹ cancelled 1\nℹ skipped 0", false, 1);
        assert_eq!((tally.passed, tally.failed, tally.skipped), (3, 2, 0));
    }

    #[test]
    fn a_runner_that_ends_badly_without_counting_is_a_failure() {
        assert_eq!(printed("error: could not compile", true, 101).failures, ["runner"]);
        assert_eq!(printed("test result: ok. 1 passed; 0 failed", true, 0).failed, 0);
    }
}
