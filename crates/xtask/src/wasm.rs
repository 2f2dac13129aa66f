//! Building the wasm modules: the engine, twice, the files' readers and writers, and the kernel with every scheme, three times.
//!
//! ```text
//! crates/engine ──cargo rustc──► target/wasm-webgpu/…/limn_engine.wasm ──wasm-bindgen──► target/wasm-webgpu/pkg-serve/
//!                         └────► target/wasm-webgl/…                   ──────────────►  target/wasm-webgl/pkg-serve/
//! ```
//!
//! There are two engines because WebGL2 support costs half a megabyte that most visitors never need; the page probes
//! for WebGPU and loads one. Browsers without vectors have no WebGPU either: the engine for WebGL2 and the files' module do without
//! (measured: they gain nothing by them), and of the kernel there is one more for these browsers (patches take a quarter of their
//! time by vectors of eight, and as long as level by level without any). `wasm-bindgen` runs in this process, so nobody has to install a command of exactly the
//! right version. Costs, warm: nothing changed, nothing is done; one line changed, a few seconds (profile `serve`);
//! profile `dist` links everything afresh, close to a minute a module.

use crate::process::{self, say, seconds};
use crate::shorten::shorten;
use crate::{paths, toolchain};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};
use wasm_bindgen_cli_support::Bindgen;

/// What is compiled for speed where files are read; the engine only unpacks what that sends.
const READS_FAST: &[&str] = &["profile.dist.package.limn-formats.opt-level=3"];

/// How the kernel's own crate, and what packs its levels, are compiled. The kernel is a few calls, but the passes over the whole linked module run at the level of the
/// crate that is linked, whatever the others are compiled at: at z and at 2 the loops over lanes of `mesh/src/patch/grid.rs`, and
/// patches with them, take twice the time that they take at 3.
const REFINES_FAST: &[&str] =
    &["profile.dist.package.limn-kernel.opt-level=3", "profile.dist.package.limn-layout.opt-level=3"];

/// One of the wasm modules.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Module {
    /// Draws with WebGPU only: what most visitors load.
    WebGpu,
    /// Draws with WebGL2: the fallback.
    WebGl,
    /// Reads and writes model files: loaded when one arrives.
    Files,
    /// Refines by every scheme: loaded when one is chosen that the engine has no rules of.
    Kernel,
    /// The same for browsers without vector instructions.
    Plain,
    /// The kernel with what benchmarks need: loaded by `?bench` alone.
    Trial,
}

impl Module {
    /// All, the one that most visitors load first.
    pub const ALL: [Self; 6] = [Self::WebGpu, Self::Files, Self::Kernel, Self::WebGl, Self::Plain, Self::Trial];

    /// Whether it is an engine: what draws, and what a first visit loads one of.
    pub fn is_engine(self) -> bool {
        matches!(self, Self::WebGpu | Self::WebGl)
    }

    /// Whether it is made of vector instructions, and so runs only where they are.
    fn has_vectors(self) -> bool {
        matches!(self, Self::WebGpu | Self::Kernel | Self::Trial)
    }

    /// The crate that it is made from.
    pub fn crate_name(self) -> &'static str {
        match self {
            Self::WebGpu | Self::WebGl => "limn-engine",
            Self::Files => "limn-files",
            Self::Kernel | Self::Plain | Self::Trial => "limn-kernel",
        }
    }

    /// What cargo is told of its features.
    pub fn features(self) -> &'static [&'static str] {
        match self {
            Self::WebGpu => &["--no-default-features", "--features", "webgpu"],
            Self::WebGl => &["--no-default-features", "--features", "webgl"],
            Self::Kernel | Self::Plain => &["--no-default-features"],
            Self::Files | Self::Trial => &[],
        }
    }

    /// Names of the glue and of the module itself in [`Module::package`].
    pub fn files(self) -> [String; 2] {
        let stem = self.crate_name().replace('-', "_");
        [format!("{stem}.js"), format!("{stem}_bg.wasm")]
    }

    /// Its name in URLs and folders.
    pub fn id(self) -> &'static str {
        match self {
            Self::WebGpu => "webgpu",
            Self::WebGl => "webgl",
            Self::Files => "files",
            Self::Kernel => "kernel",
            Self::Plain => "plain",
            Self::Trial => "trial",
        }
    }

    /// The module with this name.
    pub fn parse(id: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|module| module.id() == id)
            .with_context(|| format!("`{id}` is no module: webgpu, webgl, files, kernel, plain or trial"))
    }

    /// The target folder that it has for itself.
    pub fn target(self) -> PathBuf {
        paths::root().join("target").join(format!("wasm-{}", self.id()))
    }

    /// The folder that holds its glue and its wasm once it is built.
    pub fn package(self, profile: Profile) -> PathBuf {
        self.target().join(format!("pkg-{}", profile.id()))
    }
}

/// How a module is built.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Profile {
    /// Quick to rebuild.
    Serve,
    /// What ships.
    Dist,
}

impl Profile {
    /// Its name in cargo.
    pub fn id(self) -> &'static str {
        match self {
            Self::Serve => "serve",
            Self::Dist => "dist",
        }
    }
}

/// Builds and binds a module unless it is newer than every source.
///
/// A compile error comes back as an error that holds the compiler's words.
pub fn build(module: Module, profile: Profile) -> Result<()> {
    let start = Instant::now();
    let package = module.package(profile);
    // Taken before the build: a file saved while it runs counts as changed.
    let begun = SystemTime::now();
    let stamp = package.join(".built");
    if newest_source()? < modified(&stamp).unwrap_or(SystemTime::UNIX_EPOCH) {
        return Ok(());
    }
    toolchain::ensure_target(toolchain::WASM)?;
    say(format!("building the {} module (profile {})", module.id(), profile.id()));
    let wasm = compile(module, profile)?;
    // cargo leaves the file alone when nothing that matters changed; then the glue is good as well.
    let fresh = matches!((modified(&wasm), modified(&package.join(&module.files()[1]))), (Some(a), Some(b)) if a < b);
    if !fresh {
        bind(module, &wasm, &package, profile)?;
    }
    fs::write(&stamp, b"")?;
    fs::File::options().write(true).open(&stamp)?.set_modified(begun)?;
    say(format!("the {} module is ready after {}", module.id(), seconds(start)));
    Ok(())
}

fn compile(module: Module, profile: Profile) -> Result<PathBuf> {
    let target = module.target();
    let mut command = process::cargo();
    // `cargo rustc --crate-type`: the library is also an rlib (clippy and native tests want one), and cargo skips
    // link-time optimisation for a library that is both.
    command.args(["rustc", "--package", module.crate_name(), "--lib", "--crate-type", "cdylib"]);
    command.args(module.features());
    command.args(["--target", toolchain::WASM, "--profile", profile.id(), "--target-dir"]).arg(&target);
    let faster = match module {
        Module::Files => READS_FAST,
        Module::Kernel | Module::Plain | Module::Trial => REFINES_FAST,
        Module::WebGpu | Module::WebGl => &[],
    };
    command.args(faster.iter().flat_map(|setting| ["--config", setting]));
    command.env("RUSTFLAGS", toolchain::wasm_flags(module.has_vectors()));
    if !process::succeeds(&mut command)? {
        // The compiler has just told the terminal; the second run, of the failing crate alone, is for the page.
        let again = command.args(["--quiet", "--color", "never"]).output()?;
        bail!("the {} module does not build\n\n{}", module.id(), String::from_utf8_lossy(&again.stderr).trim());
    }
    Ok(target.join(toolchain::WASM).join(profile.id()).join(format!("{}.wasm", module.crate_name().replace('-', "_"))))
}

fn bind(module: Module, wasm: &Path, package: &Path, profile: Profile) -> Result<()> {
    fs::create_dir_all(package)?;
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).web(true)?.typescript(true);
    // The page says where the wasm lies; without this the glue would hold a second path, resolved against itself.
    bindgen.omit_default_module_path(true);
    if profile == Profile::Dist {
        bindgen.remove_name_section(true).remove_producers_section(true);
    }
    bindgen.generate(package).with_context(|| format!("wasm-bindgen could not bind {}", paths::shown(wasm)))?;
    if profile == Profile::Dist {
        let [glue, binary] = module.files().map(|name| package.join(name));
        let (short_module, short_glue) = shorten(&fs::read(&binary)?, &fs::read_to_string(&glue)?)?;
        fs::write(glue, short_glue)?;
        fs::write(binary, short_module)?;
    }
    Ok(())
}

/// When the newest file changed that a module is made of.
pub fn newest_source() -> Result<SystemTime> {
    let mut newest = SystemTime::UNIX_EPOCH;
    let how = ["crates/xtask/src/wasm.rs", "crates/xtask/src/toolchain.rs"];
    for file in ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml", ".cargo/config.toml"].into_iter().chain(how) {
        newest = newest.max(modified(&paths::root().join(file)).unwrap_or(newest));
    }
    for name in ["mesh", "compute", "layout", "formats", "document", "render", "engine", "files", "kernel"] {
        newest = newest.max(newest_below(&paths::root().join("crates").join(name))?);
    }
    Ok(newest)
}

fn newest_below(folder: &Path) -> Result<SystemTime> {
    let mut newest = SystemTime::UNIX_EPOCH;
    for entry in fs::read_dir(folder).with_context(|| format!("could not read {}", paths::shown(folder)))? {
        let entry = entry?;
        // A file that is being replaced by an editor may be gone by now.
        let Ok(data) = entry.metadata() else { continue };
        newest = newest.max(if data.is_dir() { newest_below(&entry.path())? } else { data.modified()? });
    }
    // A file that was removed changes its folder's time.
    Ok(newest.max(modified(folder).unwrap_or(newest)))
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|data| data.modified()).ok()
}
