//! Build, serve, test and measure Limn: `cargo xtask help`.
//!
//! One small program does all of the project's chores, so that a fresh machine needs nothing but Rust and Node:
//!
//! ```text
//! cargo xtask serve ──► toolchain ──► wasm (cargo + wasm-bindgen, in process) ──► server
//!             dist  ──► the same, profile `dist` ──► dist/
//!             test  ──► toolchain, npm, Chromium, Vulkan ──► native, wasm and browser tests
//!             tidy  ──► rustfmt, clippy, tsc, house rules
//!             bench ──► bench/, cargo bench
//! ```
//!
//! Each wasm module has a target folder of its own: two feature sets in one folder relink each other at every start.
//! xtask itself lives in `target/xtask` (see `.cargo/config.toml`), native builds in `target`.

mod arguments;
mod bench;
mod dist;
mod paths;
mod process;
mod rules;
mod serve;
mod server;
mod shorten;
mod test;
mod tidy;
mod toolchain;
mod wasm;

use anyhow::{Result, bail};
use arguments::Arguments;
use std::process::ExitCode;

const HELP: &str = "\
Usage: cargo xtask <command> [options]

  serve   build the page and serve it on this machine
            --release        what ships: optimised for size and speed, also written to dist/
            --port N         the port to listen on (default: 8080, or the next free one)
            --only MODULE    build webgpu or webgl alone
  dist    build what ships into dist/ and print its size
  test    set up what the tests need and run them all
            --only GROUP     native, wasm or browser
            --filter TEXT    only tests whose names contain this
            --quick          the page's tests on quickly built modules, without the budget of its weight
  tidy    rustfmt, clippy, tsc and the house rules
  bench [WORD]
          Limn beside other libraries for subdivision, natively and in Chromium; docs/benchmarks gets the page.
          A word selects rows by scheme, cage and level, and writes no page
            --quick          fewer rows and rounds, within three minutes
            --json           one JSON object a row, and nothing else
            --fresh          on freshly mapped memory
            --native         without the browser
            --page           the page once more, of docs/benchmarks/results.json
            --levels         the kernel alone, level by level
            --wasm           the same, and once more as WebAssembly under Node
  slider  what the buffers of a level take when the slider goes there, piece by piece, on the page as it ships
  screenshots
          pictures of the page, on a laptop and a phone, dark and light, under target/screenshots
  help    this text

While `serve` runs, reload the page: what changed since is rebuilt first.
";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nxtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let mut arguments = Arguments::new(std::env::args().skip(1));
    let command = arguments.positional().unwrap_or_else(|| "help".to_owned());
    match command.as_str() {
        "serve" => serve::run(arguments),
        "dist" => dist::run(arguments),
        "test" => test::run(arguments),
        "screenshots" => test::screenshots(arguments),
        "slider" => test::slider(arguments),
        "tidy" => tidy::run(arguments),
        "bench" => bench::run(arguments),
        "help" | "--help" | "-h" => {
            print!("{HELP}");
            Ok(())
        }
        other => bail!("there is no command `{other}`; `cargo xtask help` lists them"),
    }
}
