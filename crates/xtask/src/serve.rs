//! `cargo xtask serve`: build the page, serve it, rebuild on reload.
//!
//! ```text
//! /                 index.html        from the working tree, as it is now
//! /web/...          modules, styles   from the working tree, as they are now
//! /pkg/webgpu/...   glue and wasm     built before the page gets them, when a source is newer
//! /pkg/files/...    the file formats  the same; built behind the first page
//! /pkg/kernel/...   rare schemes      the same
//! /pkg/webgl/...    the fallback      the same
//! /pkg/trial/...    for ?bench        the same
//! ```
//!
//! The WebGPU module is built first and the address printed as soon as it is there; the fallback follows in the
//! background, and a page that asks for it early waits. Nothing watches the disk: asking for a page compares the
//! sources' times with the last build's (a few milliseconds) and rebuilds when it must. A build that fails shows the
//! compiler's words in place of the page.

use crate::arguments::Arguments;
use crate::process::say;
use crate::server::{self, Response};
use crate::wasm::{self, Module, Profile};
use crate::{dist, paths};
use anyhow::Result;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Builds and serves until it is stopped.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let profile = if arguments.flag("--release") { Profile::Dist } else { Profile::Serve };
    let port = arguments.value("--port")?.map(|port| port.parse()).transpose();
    let port = port.map_err(|_| anyhow::anyhow!("--port takes a number from 0 to 65535"))?;
    let modules = match arguments.value("--only")? {
        Some(id) => vec![Module::parse(&id)?, Module::Files, Module::Kernel, Module::Trial],
        None => Module::ALL.to_vec(),
    };
    arguments.finish()?;

    // The port first: a build of a minute that ends in "address in use" helps nobody.
    let listener = server::listen(port)?;
    let site: &'static Site = Box::leak(Box::new(Site::new(profile, modules.clone())));
    if let Err(error) = site.build(modules[0]) {
        // Serving goes on: the page shows the error, and a reload after the repair builds again.
        eprintln!("\nxtask: {}", error.to_string().lines().next().unwrap_or_default());
    }
    let address = listener.local_addr()?;
    println!("\n  Limn is at http://localhost:{}/    (Ctrl+C ends it; reload the page to rebuild)\n", address.port());
    std::thread::spawn(move || {
        for &module in &modules[1..] {
            if let Err(error) = site.build(module) {
                eprintln!("\nxtask: {error:#}");
            }
        }
        if profile == Profile::Dist
            && modules.len() == Module::ALL.len()
            && let Err(error) =
                dist::assemble(profile, &paths::dist(), &Module::ALL).and_then(|()| dist::report(&paths::dist()))
        {
            eprintln!("\nxtask: {error:#}");
        }
    });
    server::serve(&listener, move |path, query| site.answer(path, query));
    Ok(())
}

/// What is served, and the locks that keep two requests from building the same module at once.
struct Site {
    profile: Profile,
    modules: Vec<Module>,
    building: [Mutex<()>; Module::ALL.len()],
}

impl Site {
    fn new(profile: Profile, modules: Vec<Module>) -> Self {
        Self { profile, modules, building: Default::default() }
    }

    fn build(&self, module: Module) -> Result<()> {
        let _guard = self.building[module as usize].lock().unwrap_or_else(PoisonError::into_inner);
        wasm::build(module, self.profile)
    }

    fn answer(&self, path: &str, query: &str) -> Response {
        match path {
            "/" | "/index.html" => {
                let forced =
                    self.modules.iter().copied().find(|module| query.contains(&format!("renderer={}", module.id())));
                match self.build(forced.unwrap_or(self.modules[0])) {
                    Ok(()) => file(&paths::root().join("index.html")),
                    Err(error) => {
                        Response { status: 500, mime: server::mime("error.html"), body: sorry(&error.to_string()) }
                    }
                }
            }
            _ if path.starts_with("/web/") => file(&paths::root().join(&path[1..])),
            _ => match self.package_file(path) {
                Some((module, name)) => match self.build(module) {
                    Ok(()) => file(&module.package(self.profile).join(name)),
                    Err(error) => Response::text(500, error.to_string()),
                },
                None => Response::text(404, format!("There is nothing at {path}.\n")),
            },
        }
    }

    fn package_file(&self, path: &str) -> Option<(Module, String)> {
        let (id, name) = path.strip_prefix("/pkg/")?.split_once('/')?;
        let module = self.modules.iter().copied().find(|module| module.id() == id)?;
        Some((module, module.files().into_iter().find(|file| file == name)?))
    }
}

fn file(path: &Path) -> Response {
    match fs::read(path) {
        Ok(body) => Response { status: 200, mime: server::mime(&path.to_string_lossy()), body },
        Err(_) => {
            say(format!("{} was asked for and is not there", paths::shown(path)));
            Response::text(404, "There is no such file.\n")
        }
    }
}

/// The page that stands in for one that does not build.
fn sorry(error: &str) -> Vec<u8> {
    let text = error.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<!doctype html><meta charset=utf-8><title>Limn does not build</title>\
         <body style='background:#1b1d21;color:#e8e6e3;margin:2rem'><pre style='font:14px/1.5 monospace;white-space:pre-wrap'>{text}</pre>"
    )
    .into_bytes()
}
