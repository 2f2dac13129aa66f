//! `cargo xtask dist`: the folder that ships.
//!
//! `dist/` holds the page as any static host serves it: `index.html`, `web/` and `pkg/` with the wasm modules. The sizes
//! are printed raw and as brotli at its highest level, which is what good hosts send.

use crate::arguments::Arguments;
use crate::process::{self, say};
use crate::wasm::{self, Module, Profile};
use crate::{paths, toolchain};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the modules as they ship and fills `dist/`.
pub fn run(arguments: Arguments) -> Result<()> {
    arguments.finish()?;
    let dist = paths::dist();
    build(Profile::Dist, &dist)?;
    say(format!("{} holds what a static host serves", paths::shown(&dist)));
    report(&dist)
}

/// Builds the modules and fills `site` with them and the page.
pub fn build(profile: Profile, site: &Path) -> Result<()> {
    build_with(profile, site, &Module::ALL)
}

/// The same with some of the modules, for a page that is asked for no others.
pub fn build_with(profile: Profile, site: &Path, modules: &[Module]) -> Result<()> {
    for &module in modules {
        wasm::build(module, profile)?;
    }
    assemble(profile, site, modules)
}

/// Copies the page and built modules into a fresh folder, which takes the old one's place when it is whole.
pub fn assemble(profile: Profile, dist: &Path, modules: &[Module]) -> Result<()> {
    let fresh = paths::root().join("target/site.new");
    remove(&fresh)?;
    copy(&paths::root().join("index.html"), &fresh.join("index.html"))?;
    for from in files(&paths::root().join("web"))? {
        let name = from.strip_prefix(paths::root())?;
        // Type declarations are for editors and `tidy`.
        if !from.to_string_lossy().ends_with(".d.ts") {
            copy(&from, &fresh.join(name))?;
        }
    }
    for module in modules {
        for name in module.files() {
            copy(&module.package(profile).join(&name), &fresh.join("pkg").join(module.id()).join(name))?;
        }
    }
    if profile == Profile::Dist {
        minify(&fresh)?;
    }
    remove(dist)?;
    fs::rename(&fresh, dist).with_context(|| format!("could not fill {}", paths::shown(dist)))
}

/// Takes comments, indentation and long names out of every script and style sheet below a folder, file by file: modules stay
/// the modules that the page imports. The markup loses its indentation; no text in it spans lines.
fn minify(site: &Path) -> Result<()> {
    let page = site.join("index.html");
    let lines = fs::read_to_string(&page)?;
    let lines: Vec<&str> = lines.lines().map(str::trim_start).collect();
    fs::write(&page, lines.join("\n"))?;
    let mut esbuild = esbuild()?;
    esbuild.args(["--minify", "--charset=utf8", "--log-level=warning", "--allow-overwrite"]);
    esbuild.arg(format!("--outdir={0}", site.display())).arg(format!("--outbase={0}", site.display()));
    let text = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "js" || extension == "css");
    process::run(esbuild.args(files(site)?.into_iter().filter(text)))
}

/// The program that shortens and bundles scripts.
pub fn esbuild() -> Result<Command> {
    toolchain::ensure_packages()?;
    let name = if cfg!(windows) { "esbuild.cmd" } else { "esbuild" };
    Ok(process::program(paths::root().join("node_modules/.bin").join(name)))
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("could not empty {}", paths::shown(folder)))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::copy(from, to).with_context(|| format!("could not copy {} to {}", paths::shown(from), paths::shown(to)))?;
    Ok(())
}

/// Every file below a folder, sorted, hidden ones left out.
pub fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let entries = fs::read_dir(folder).with_context(|| format!("could not read {}", paths::shown(folder)))?;
    for entry in entries {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if entry.file_type()?.is_dir() {
            found.extend(files(&entry.path())?);
        } else {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

/// Prints every file of a built page with its size, raw and compressed, and what each renderer adds up to.
pub fn report(dist: &Path) -> Result<()> {
    let mut sums = [(0, 0); Module::ALL.len() + 1];
    println!("{:>12} {:>12}  file", "bytes", "brotli 11");
    for path in files(dist)? {
        let bytes = fs::read(&path)?;
        let small = brotli_size(&bytes)?;
        let name = path.strip_prefix(dist)?.display().to_string();
        println!("{:>12} {small:>12}  {name}", bytes.len());
        let place = Module::ALL
            .iter()
            .position(|module| name.starts_with(&format!("pkg/{}", module.id())))
            .unwrap_or(Module::ALL.len());
        sums[place].0 += bytes.len();
        sums[place].1 += small;
    }
    let page = sums[Module::ALL.len()];
    for (at, module) in Module::ALL.into_iter().enumerate().filter(|(_, module)| module.is_engine()) {
        let (raw, small) = (sums[at].0 + page.0, sums[at].1 + page.1);
        println!("{raw:>12} {small:>12}  everything for {}", module.id());
    }
    Ok(())
}

fn brotli_size(bytes: &[u8]) -> Result<usize> {
    let parameters = brotli::enc::BrotliEncoderParams { quality: 11, lgwin: 22, ..Default::default() };
    let mut out = Vec::new();
    brotli::BrotliCompress(&mut &bytes[..], &mut out, &parameters)?;
    Ok(out.len())
}
