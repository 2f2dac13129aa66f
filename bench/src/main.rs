//! Limn beside other libraries for subdivision, in one table and on one page. `cargo xtask bench [WORD] [options]`
//!
//! ```text
//!   indexed faces ─ Mesh::build ─> half-edges ─ refine ─> points and faces of level L
//!                  '─────────────── Limn ──────────────'                     in ns a face of level L, one thread
//!                                '── mesh built ──'                          and once more by the general path alone
//!
//!   engines   Limn | the other Rust crates | OpenSubdiv in C++ | in Chromium: Limn as WebAssembly, three-subdivide
//!   rounds    all of them in turn on one input, medians, memory          (rounds.rs)
//!   table     schemes and cages (rows.rs); growth.rs: levels 0 to 7, cages of 6 faces to a million
//!   report    text, or --json: an object a row; page.rs: plots           (docs/benchmarks)
//! ```
//!
//! What a row stores is the same for all but those called "+ normals", which have unit normals as well, and whose ratios are among
//! themselves. `beyond` is what a run holds at most beyond its input and its output, in bytes a face. Figures are medians; `best` is the shortest run: where the two are far apart the machine was busy. `limit` is what storing
//! the same points and corners takes at the bandwidth of plain stores measured at the start. Before anything is timed every
//! engine's points and faces are held against Limn's; one that differs has no figure, and the run fails at its end. Where a
//! library is known to have another rule under the same name a star says so, and counts alone are compared.
//!
//! Memory is warm (the allocator keeps what a run gives back) unless `--fresh` asks for pages that are mapped anew.
//! Options: `--quick` fewer rows and rounds, within three minutes; `--json`; `--fresh`; `--out FOLDER` where the page goes;
//! `--opensubdiv PROGRAM` and `--browser SCRIPT`, which xtask builds and passes; `--page FOLDER` makes the page again of its
//! `results.json`.

mod clock;
mod engines;
mod growth;
mod machine;
mod memory;
mod page;
mod plot;
mod report;
mod rounds;
mod rows;

use engines::Differs;
use machine::Machine;
use report::Report;
use rounds::{Bench, Pace};
use rows::Table;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

#[global_allocator]
static ALLOCATOR: memory::Counting = memory::Counting;

/// What was asked for.
#[derive(Default)]
struct Options {
    word: String,
    quick: bool,
    json: bool,
    fresh: bool,
    out: Option<PathBuf>,
    page: Option<PathBuf>,
    opensubdiv: Option<PathBuf>,
    browser: Option<PathBuf>,
}

impl Options {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Options::default();
        while let Some(word) = words.next() {
            let mut path = || words.next().map(PathBuf::from).ok_or_else(|| format!("{word} needs a path"));
            match word.as_str() {
                "--quick" => options.quick = true,
                "--json" => options.json = true,
                "--fresh" => options.fresh = true,
                "--out" => options.out = Some(path()?),
                "--page" => options.page = Some(path()?),
                "--opensubdiv" => options.opensubdiv = Some(path()?),
                "--browser" => options.browser = Some(path()?),
                _ if word.starts_with('-') => return Err(format!("`{word}` is not an option")),
                _ => options.word = word,
            }
        }
        Ok(options)
    }
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let said = Options::read(words.iter().cloned()).and_then(|options| {
        // glibc reads these when a process starts: memory kept, or every large block mapped afresh.
        if cfg!(all(target_os = "linux", target_env = "gnu")) && std::env::var_os("MALLOC_MMAP_THRESHOLD_").is_none() {
            let limit = if options.fresh { "65536" } else { "4000000000" };
            let me = std::env::current_exe().map_err(|e| e.to_string())?;
            let mut again = Command::new(me);
            again.args(&words).env("MALLOC_MMAP_THRESHOLD_", limit).env("MALLOC_TRIM_THRESHOLD_", limit);
            return again.status().map(|status| status.success()).map_err(|e| e.to_string());
        }
        run(&options)
    });
    match said {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(why) => {
            eprintln!("bench: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Whether every engine made the same surfaces.
fn run(options: &Options) -> Result<bool, String> {
    if let Some(folder) = &options.page {
        let text = std::fs::read_to_string(folder.join("results.json")).map_err(|e| e.to_string())?;
        write(folder, &serde_json::from_str(&text).map_err(|e| e.to_string())?)?;
        return Ok(true);
    }
    let begun = std::time::Instant::now();
    let (engines, machine, notes) = gather(options);
    let rules: Vec<String> = engines
        .iter()
        .flat_map(|e| ["sqrt3", "loop"].map(|id| (e.name().to_owned(), e.differs(id))))
        .filter_map(|(name, differs)| match differs {
            Some(Differs::Rule(why)) => Some(format!("* {name}: {why}.")),
            _ => None,
        })
        .collect();
    let mut bench = Bench::new(engines, machine, if options.quick { Pace::QUICK } else { Pace::FULL });
    bench.report.quick = options.quick;
    bench.report.memory = if options.fresh { "fresh" } else { "warm" }.to_owned();
    bench.report.notes = notes;
    bench.report.notes.extend(rules);
    let json = options.json;
    if !json {
        println!("{}", bench.report.machine.line());
        println!(
            "medians, one thread, {} memory; plain stores {:.1} GB/s",
            bench.report.memory,
            bench.report.measured_bandwidth / 1e9
        );
        println!("{}", report::columns());
    }

    let word = options.word.clone();
    let mut table = Table { bench: &mut bench, word: word.clone(), quick: options.quick, json, missed: Vec::new() };
    table.run()?;
    let missed = table.missed;
    if "powell".contains(&word) && !json {
        rows::powell()?;
    }
    growth::run(&mut bench, &word, json, options.quick)?;

    let (mut report, differ) = bench.finish();
    report.seconds = begun.elapsed().as_secs_f64().round();
    let say = |text: &str| if json { eprintln!("{text}") } else { println!("{text}") };
    report.notes.iter().for_each(|note| say(note));
    missed.iter().for_each(|missed| say(&format!("over its budget: {missed}")));
    differ.iter().for_each(|sentence| say(sentence));
    say(&format!("measured in {:.0} s", report.seconds));
    if let (Some(folder), true) = (&options.out, word.is_empty()) {
        write(folder, &report)?;
        say(&format!("{} has the page", folder.join("index.html").display()));
    }
    Ok(differ.is_empty())
}

/// All engines that are here, the machine with what they say of it, and a sentence for each that is not.
fn gather(options: &Options) -> (Vec<Box<dyn engines::Engine>>, Machine, Vec<String>) {
    let (mut all, mut machine, mut notes) = (engines::natives(), Machine::here(), Vec::new());
    let cpp = options.opensubdiv.as_ref().map(|program| (Command::new(program), clock::CLOCK));
    let browser = options.browser.as_ref().map(|script| {
        let mut node = Command::new("node");
        node.arg(script);
        (node, "wall")
    });
    for (mut command, clock) in [cpp, browser].into_iter().flatten() {
        match engines::remote::start(&mut command, clock) {
            Ok(found) => {
                all.extend(found.engines);
                notes.extend(found.notes);
                for (key, words) in found.machine {
                    match key.as_str() {
                        "browser" => machine.browser = words,
                        "adapter" => machine.adapter = words,
                        _ => {}
                    }
                }
            }
            Err(why) => notes.push(format!("Left out: {why}.")),
        }
    }
    (all, machine, notes)
}

/// Writes the page and what it was made of.
fn write(folder: &Path, report: &Report) -> Result<(), String> {
    let text = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(text)?;
    // A row a line, so that two runs can be laid side by side.
    let mut json = serde_json::to_string(&Report { rows: Vec::new(), ..report.clone() }).map_err(|e| e.to_string())?;
    let rows: Result<Vec<String>, _> = report.rows.iter().map(serde_json::to_string).collect();
    let rows = rows.map_err(|e| e.to_string())?.join(",\n");
    json.truncate(json.len().saturating_sub("]}".len()));
    std::fs::write(folder.join("results.json"), format!("{json}\n{rows}\n]}}\n")).map_err(text)?;
    std::fs::write(folder.join("index.html"), page::page(report)).map_err(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_taken_and_others_refused() {
        let read = |text: &str| Options::read(text.split_whitespace().map(str::to_owned));
        let options = read("loop --quick --json --out a/b").unwrap();
        assert_eq!((options.word.as_str(), options.quick, options.json, options.fresh), ("loop", true, true, false));
        assert_eq!(options.out, Some(PathBuf::from("a/b")));
        assert!(read("--quik").is_err_and(|why| why.contains("--quik")) && read("--out").is_err());
    }

    #[test]
    fn a_report_comes_back_from_its_file() {
        let folder = std::env::temp_dir().join(format!("limn-bench-test-{}", std::process::id()));
        let rows = vec![report::tests::row("limn", "table", 100, 1.0), report::tests::row("peer", "table", 100, 2.0)];
        let report = Report { rows, notes: vec!["A note.".to_owned()], ..Report::default() };
        write(&folder, &report).unwrap();
        let text = std::fs::read_to_string(folder.join("results.json")).unwrap();
        let back: Report = serde_json::from_str(&text).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!((back.rows, back.notes), (report.rows, report.notes));
        assert_eq!(text.lines().count(), 4, "a row a line");
    }
}
