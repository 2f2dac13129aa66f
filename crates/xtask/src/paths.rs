//! Where things lie, all relative to the workspace's root.
//!
//! The root is known at compile time from this crate's own place, so xtask works from any folder of the project.

use std::path::{Path, PathBuf};

/// The workspace's root folder.
pub fn root() -> &'static Path {
    // crates/xtask -> crates -> root
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new("."))
}

/// The folder that `cargo xtask dist` fills.
pub fn dist() -> PathBuf {
    root().join("dist")
}

/// `path` as a person reads it: relative to the root where it lies below it.
pub fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}
