//! `cargo xtask bench`: the kernel's benchmarks, natively or (`--wasm`) as WebAssembly under Node.
//!
//! Both run the same program, so the tables can be laid side by side. Words behind the options go to the benchmark.

use crate::arguments::Arguments;
use crate::process::{self, say};
use crate::{test, toolchain};
use anyhow::Result;

/// Runs the benchmarks and prints their tables.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let wasm = arguments.flag("--wasm");
    let filter = arguments.positional();
    arguments.finish()?;
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
