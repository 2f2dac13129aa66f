//! The wasm target of the Rust toolchain.
//!
//! `rust-toolchain.toml` could list the target, but where rustup's auto-install is off a listed target that is missing
//! is ignored without a word. So the target is looked for where rustc would look, and added when it is not there.

use crate::process;
use anyhow::{Context, Result, bail};
use std::path::Path;

/// The one target that the page is built for.
pub const WASM: &str = "wasm32-unknown-unknown";

/// Sees to it that rustc can build for wasm.
pub fn ensure_wasm() -> Result<()> {
    let sysroot = process::output(process::program("rustc").args(["--print", "sysroot"]))
        .context("Rust's compiler was not found; install it from https://rustup.rs")?;
    if Path::new(&sysroot).join("lib/rustlib").join(WASM).join("lib").is_dir() {
        return Ok(());
    }
    if process::on_path(&["rustup", "rustup.exe"]).is_none() {
        bail!(
            "this Rust cannot build for {WASM} and there is no rustup to add it: \
             install Rust from https://rustup.rs, or your system's package for that target"
        );
    }
    process::say(format!("adding the Rust target {WASM}"));
    process::run(process::program("rustup").args(["target", "add", WASM]))
        .with_context(|| format!("rustup could not add the target {WASM}"))
}
