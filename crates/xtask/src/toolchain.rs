//! What the project needs from the machine: wasm targets, npm packages, Chromium, a Vulkan driver.
//!
//! Each `ensure_*` looks first and acts only when something is missing. Nothing needs root; where xtask runs as root on
//! a system with apt it installs what is missing, elsewhere one sentence says what to install.

use crate::paths;
use crate::process::{self, say};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

/// The target that the page is built for.
pub const WASM: &str = "wasm32-unknown-unknown";
/// The target that tests and benchmarks are built for when they run as WebAssembly under Node.
pub const WASI: &str = "wasm32-wasip1";

/// What a Chromium may be called.
const CHROMIUMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// What rustc is told for WebAssembly. Vector instructions are in every browser of the last years (Safari's since 16.4), and the
/// compiler uses them only where the bits stay; what others load is built without them. Messages of panics name source files: without the builder's own folders, so that what ships is the same wherever it
/// is built.
pub fn wasm_flags(vectors: bool) -> String {
    let mut flags = std::env::var("RUSTFLAGS").unwrap_or_default();
    if vectors {
        flags.push_str(" -Ctarget-feature=+simd128");
    }
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    // cargo has no way to quote a flag's spaces in this variable.
    if let Some(home) = home.as_deref().and_then(Path::to_str).filter(|home| !home.contains(' ')) {
        flags.push_str(&format!(" --remap-path-prefix={home}/registry/src="));
    }
    flags.trim_start().to_owned()
}

/// Sees to it that rustc can build for `target`.
///
/// `rust-toolchain.toml` could list the targets, but where rustup's auto-install is off a listed target that is missing
/// is ignored without a word. So the target is looked for where rustc would look.
pub fn ensure_target(target: &str) -> Result<()> {
    let sysroot = process::output(process::program("rustc").args(["--print", "sysroot"]))
        .context("Rust's compiler was not found; install it from https://rustup.rs")?;
    if Path::new(&sysroot).join("lib/rustlib").join(target).join("lib").is_dir() {
        return Ok(());
    }
    if process::on_path(&["rustup", "rustup.exe"]).is_none() {
        bail!(
            "this Rust cannot build for {target} and there is no rustup to add it: \
             install Rust from https://rustup.rs, or your system's package for that target"
        );
    }
    say(format!("adding the Rust target {target}"));
    process::run(process::program("rustup").args(["target", "add", target]))
        .with_context(|| format!("rustup could not add the target {target}"))
}

/// Sees to it that rustfmt and clippy are there.
pub fn ensure_components() -> Result<()> {
    for (command, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if process::output(process::cargo().args([command, "--version"])).is_ok() {
            continue;
        }
        if process::on_path(&["rustup", "rustup.exe"]).is_none() {
            bail!(
                "this Rust has no {component} and there is no rustup to add it: install your system's package for it"
            );
        }
        say(format!("adding Rust's component {component}"));
        process::run(process::program("rustup").args(["component", "add", component]))?;
    }
    Ok(())
}

/// Sees to it that Node 20 or newer is there.
pub fn ensure_node() -> Result<()> {
    let version = process::output(process::program("node").arg("--version"))
        .context("Node was not found; install Node 20 or newer from https://nodejs.org or your system's packages")?;
    let major = version.trim_start_matches('v').split('.').next().and_then(|major| major.parse::<u32>().ok());
    if major.is_none_or(|major| major < 20) {
        bail!("Node {version} is too old: install Node 20 or newer");
    }
    Ok(())
}

/// Sees to it that `node_modules` holds what `package-lock.json` says.
pub fn ensure_packages() -> Result<()> {
    ensure_node()?;
    let lock = fs::read(paths::root().join("package-lock.json")).context("package-lock.json is missing")?;
    let stamp = paths::root().join("node_modules/.limn-lock");
    if fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    say("installing the npm packages for development");
    let npm = process::on_path(&["npm", "npm.cmd"]).context("npm was not found; it comes with Node")?;
    process::run(process::program(npm).arg("ci"))?;
    fs::write(stamp, lock)?;
    Ok(())
}

/// Finds a Chromium: `CHROME`, then the PATH, then apt where that is allowed.
pub fn ensure_chromium() -> Result<PathBuf> {
    if let Some(chrome) = std::env::var_os("CHROME").filter(|chrome| !chrome.is_empty()) {
        let path = PathBuf::from(&chrome);
        let found = if path.components().count() > 1 { path.is_file().then_some(path) } else { None };
        return found
            .or_else(|| process::on_path(&[&chrome.to_string_lossy()]))
            .with_context(|| format!("CHROME names {}, which is not there", chrome.to_string_lossy()));
    }
    if let Some(path) = process::on_path(&CHROMIUMS) {
        return Ok(path);
    }
    if may_install()
        && install(&["chromium"])?
        && let Some(path) = process::on_path(&CHROMIUMS)
    {
        return Ok(path);
    }
    bail!(
        "the page's tests need Chromium: install it (Debian: apt install chromium) or set CHROME to a Chrome's or Chromium's path"
    )
}

/// A Chromium, where one is already there.
pub fn chromium() -> Option<PathBuf> {
    let named = std::env::var_os("CHROME").map(PathBuf::from).filter(|path| path.is_file());
    named.or_else(|| process::on_path(&CHROMIUMS))
}

/// Sees to it that there is a Vulkan driver to draw with: Mesa's software driver is enough.
pub fn ensure_vulkan() -> Result<()> {
    let chosen = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some());
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let listed = || folders.iter().any(|folder| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()));
    if chosen || !cfg!(target_os = "linux") || listed() {
        return Ok(());
    }
    if may_install() && install(&["mesa-vulkan-drivers"])? && listed() {
        return Ok(());
    }
    bail!(
        "the drawing tests need a Vulkan driver: install your graphics card's, or Mesa's software driver (Debian: apt install mesa-vulkan-drivers)"
    )
}

/// Whether packages can be installed without asking anyone.
fn may_install() -> bool {
    let root = process::output(process::program("id").arg("-u")).is_ok_and(|id| id == "0");
    root && process::on_path(&["apt-get"]).is_some()
}

fn install(packages: &[&str]) -> Result<bool> {
    say(format!("installing {} with apt", packages.join(" and ")));
    let apt = || {
        let mut command = process::program("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive").arg("-q");
        command
    };
    // Package lists that are a little old are no reason to give up, so only the second result counts.
    process::succeeds(apt().arg("update"))?;
    process::succeeds(apt().args(["install", "-y", "--no-install-recommends"]).args(packages))
}
