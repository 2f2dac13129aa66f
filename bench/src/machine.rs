//! What machine it was: processor, cores, caches, system. A browser says its own.

use serde::{Deserialize, Serialize};
use std::fs;
use std::process::Command;

/// A machine, in words.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's model.
    pub cpu: String,
    /// How many of its cores a program may use.
    pub cores: usize,
    /// Its caches by level.
    pub caches: String,
    /// The operating system.
    pub system: String,
    /// The compilers.
    pub compilers: String,
    /// The browser, if there is one.
    pub browser: String,
    /// The graphics adapter that the browser gives out for computing.
    pub adapter: String,
    /// The day.
    pub date: String,
}

impl Machine {
    /// This one, without the browser.
    pub fn here() -> Self {
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
        let name = release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="));
        let compilers = [said("rustc", &["--version"]), said("c++", &["--version"])];
        Machine {
            cpu: model.map_or_else(|| std::env::consts::ARCH.to_owned(), |m| m.1.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            caches: caches(),
            system: name.map_or_else(|| std::env::consts::OS.to_owned(), |n| n.trim_matches('"').to_owned()),
            compilers: compilers.into_iter().flatten().collect::<Vec<_>>().join(", "),
            date: said("date", &["+%Y-%m-%d"]).unwrap_or_default(),
            ..Machine::default()
        }
    }

    /// In one line.
    pub fn line(&self) -> String {
        let cores = format!("{} core{}", self.cores, if self.cores == 1 { "" } else { "s" });
        let parts = [&self.cpu, &cores, &self.caches, &self.system, &self.browser];
        parts.into_iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join(", ")
    }
}

/// The first line that a program says.
fn said(program: &str, words: &[&str]) -> Option<String> {
    let output = Command::new(program).args(words).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).lines().next()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}

fn caches() -> String {
    let folder = |i: u32| format!("/sys/devices/system/cpu/cpu0/cache/index{i}");
    let read = |i: u32, what: &str| fs::read_to_string(format!("{}/{what}", folder(i))).map(|s| s.trim().to_owned());
    let cache = |i: u32| {
        let (level, kind, size) = (read(i, "level").ok()?, read(i, "type").ok()?, read(i, "size").ok()?);
        let letter = if kind == "Data" { "d" } else { "" };
        (kind != "Instruction").then(|| format!("L{level}{letter} {size}"))
    };
    (0..8).filter_map(cache).collect::<Vec<_>>().join(" ")
}
