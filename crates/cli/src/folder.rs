//! The files next to a model, read when they are asked for.
//!
//! A model names its siblings, and a hostile one could name any file of the machine: only names that lead down from the
//! model's folder are followed, links included. What was read stays in memory until the program ends, which is soon.

use std::path::{Component, Path, PathBuf};

use limn_formats::Files;

/// How deep below the model's folder names are listed.
const DEPTH: usize = 3;
/// How many names are listed; a model in a home folder must not read the whole disk.
const NAMES: usize = 10_000;

/// The folder that a model lies in.
pub struct Folder {
    root: PathBuf,
    /// Larger files are not read.
    limit: u64,
}

impl Folder {
    /// The folder of the file at `model`.
    pub fn of(model: &Path, limit: u64) -> Folder {
        let root = model.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Folder { root: root.to_owned(), limit }
    }

    fn list(&self, folder: &Path, depth: usize, names: &mut Vec<String>) {
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        let mut folders = Vec::new();
        for entry in entries.flatten() {
            let path = entry.path();
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !hidden => folders.push(path),
                Ok(kind) if kind.is_file() && names.len() < NAMES => {
                    names.extend(path.strip_prefix(&self.root).ok().and_then(Path::to_str).map(str::to_owned));
                }
                _ => {}
            }
        }
        if depth > 1 {
            folders.iter().for_each(|folder| self.list(folder, depth - 1, names));
        }
    }
}

impl Files for Folder {
    fn get(&self, name: &str) -> Option<&[u8]> {
        let relative = Path::new(name);
        if name.is_empty() || !relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)) {
            return None;
        }
        // A link may lead out of the folder: ask the file system where the name really ends.
        let path = self.root.join(relative).canonicalize().ok()?;
        let root = self.root.canonicalize().ok()?;
        let meta = path.metadata().ok().filter(|m| m.is_file() && m.len() <= self.limit)?;
        if !path.starts_with(root) || meta.len() > self.limit {
            return None;
        }
        Some(std::fs::read(path).ok()?.leak())
    }

    fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        self.list(&self.root, DEPTH, &mut names);
        names
    }
}
