//! `cargo xtask bench`: Limn beside other libraries for subdivision, and (`--levels`, `--wasm`) the kernel level by level.
//!
//! ```text
//!   bench [WORD]              bench/: a workspace of its own, so that nothing else builds the peers. A full run writes
//!                             docs/benchmarks, one with --quick, --fresh or --native target/bench/page
//!         --quick             fewer rows and rounds: within three minutes once built
//!         --json              one JSON object a row on standard output, and nothing else there
//!         --fresh             on freshly mapped memory: page faults counted
//!         --native            without the browser
//!         --page              no run: the page once more, of docs/benchmarks/results.json
//!   bench [WORD] --levels     crates/mesh/benches: topology, refinement, normals of every level
//!   bench [WORD] --wasm       the same, and again as WebAssembly under Node, so the tables can be laid side by side
//! ```
//!
//! A word selects rows by name. Besides the Rust crates three things are built where they can be: OpenSubdiv's program by
//! `c++` where its headers are, the kernel's module for it with the page for Chromium, and three-subdivide as one script beside that
//! page. What is not there is one line, and no failure.

use crate::arguments::Arguments;
use crate::process::{self, say};
use crate::wasm::{Module, Profile};
use crate::{dist, paths, test, toolchain};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Runs the benchmarks and prints their tables.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let (wasm, levels) = (arguments.flag("--wasm"), arguments.flag("--levels"));
    let [quick, native, page] = ["--quick", "--native", "--page"].map(|name| arguments.flag(name));
    let [fresh, json] = ["--fresh", "--json"].map(|name| arguments.flag(name));
    let filter = arguments.positional();
    arguments.finish()?;
    if !(wasm || levels) {
        let folder = paths::root().join("target/bench");
        let program = build(&folder)?;
        let mut table = process::program(program);
        let shown = paths::root().join("docs/benchmarks");
        if page {
            return process::run(table.arg("--page").arg(shown));
        }
        let own = [(fresh, "--fresh"), (json, "--json"), (quick, "--quick")];
        table.args(&filter).args(own.iter().filter(|(wanted, _)| *wanted).map(|(_, name)| name));
        if let Some(program) = optional("OpenSubdiv in C++", opensubdiv(&folder)) {
            table.arg("--opensubdiv").arg(program);
        }
        if !native && let Some((chrome, site)) = optional("the browser's engines", browser(&folder)) {
            table.arg("--browser").arg(paths::root().join("bench/browser.mjs"));
            // Nothing here is about the page's weight: it is sent as quickly as it can be packed.
            table.env("CHROME", chrome).env("LIMN_SITE", site).env("LIMN_QUICK", "1");
        }
        // What is kept is a whole run on warm memory.
        let whole = !(quick || fresh || native);
        table.arg("--out").arg(if whole { shown } else { folder.join("page") });
        say("Limn and its peers");
        return process::run(&mut table);
    }
    say("native");
    process::run(process::cargo().args(["bench", "--package", "limn-mesh", "--bench", "refine", "--"]).args(&filter))?;
    if wasm {
        toolchain::ensure_node()?;
        toolchain::ensure_target(toolchain::WASI)?;
        say("WebAssembly under Node");
        process::run(test::wasi("bench").args(["--package", "limn-mesh", "--bench", "refine", "--"]).args(&filter))?;
    }
    Ok(())
}

/// Builds the program with the Rust engines.
fn build(folder: &Path) -> Result<PathBuf> {
    let mut cargo = process::cargo();
    cargo.args(["build", "--quiet", "--release", "--manifest-path", "bench/Cargo.toml", "--target-dir"]).arg(folder);
    process::run(&mut cargo)?;
    Ok(folder.join("release").join(if cfg!(windows) { "limn-bench.exe" } else { "limn-bench" }))
}

/// What is there, or one line that says why it is not.
fn optional<T>(what: &str, found: Result<T>) -> Option<T> {
    found.map_err(|why| say(format!("without {what}: {why:#}"))).ok()
}

/// Compiles OpenSubdiv's program where its headers are.
fn opensubdiv(folder: &Path) -> Result<PathBuf> {
    let compiler = process::on_path(&["c++", "clang++", "g++"]).context("there is no C++ compiler")?;
    // The compiler knows where headers are; it is asked for one.
    let mut probe = process::program(&compiler);
    probe.args(["-std=c++17", "-x", "c++", "-fsyntax-only", "-include", "opensubdiv/far/topologyRefinerFactory.h"]);
    let there = probe.arg("/dev/null").stderr(Stdio::null()).stdout(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        anyhow::bail!("its headers are not installed (Debian: apt install libosd-dev)");
    }
    let program = folder.join("opensubdiv");
    let mut command = process::program(compiler);
    command.args(["-std=c++17", "-O3", "-o"]).arg(&program).args(["bench/opensubdiv.cpp", "-losdCPU"]);
    process::run(&mut command)?;
    Ok(program)
}

/// A Chromium, and the page for it with the kernel's module and what it is compared with.
fn browser(folder: &Path) -> Result<(PathBuf, PathBuf)> {
    let chrome = toolchain::chromium().context("there is no Chromium; install it or set CHROME")?;
    let site = folder.join("site");
    dist::build_with(Profile::Dist, &site, &[Module::Trial])?;
    let mut esbuild = dist::esbuild()?;
    esbuild.args(["bench/three.mjs", "--bundle", "--format=esm", "--minify", "--log-level=warning"]);
    esbuild.arg(format!("--outfile={}", site.join("peers/three-subdivide.js").display()));
    process::run(&mut esbuild)?;
    Ok((chrome, site))
}
