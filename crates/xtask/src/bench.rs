//! `cargo xtask bench`: the kernel beside the other Rust crates for subdivision, and (`--levels`, `--wasm`) level by level.
//!
//! ```text
//!   bench [WORD] [--fresh]    bench/: one table with the peers; a workspace of its own, so that nothing else builds them
//!   bench [WORD] --levels     crates/mesh/benches: topology, refinement, normals of every level
//!   bench [WORD] --wasm       the same, and again as WebAssembly under Node, so the tables can be laid side by side
//! ```
//!
//! A word selects rows by name.

use crate::arguments::Arguments;
use crate::process::{self, say};
use crate::{paths, test, toolchain};
use anyhow::Result;

/// Runs the benchmarks and prints their tables.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let (wasm, levels, fresh) = (arguments.flag("--wasm"), arguments.flag("--levels"), arguments.flag("--fresh"));
    let filter = arguments.positional();
    arguments.finish()?;
    if !(wasm || levels) {
        say("Limn and its peers");
        let mut table = process::cargo();
        table.args(["run", "--quiet", "--release", "--manifest-path", "bench/Cargo.toml"]);
        table.arg("--target-dir").arg(paths::root().join("target/bench")).arg("--").args(&filter);
        if fresh {
            table.arg("--fresh");
        }
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
