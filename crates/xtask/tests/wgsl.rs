//! Every shader validates under naga, the translator that wgpu itself uses; without a GPU, in milliseconds.
//!
//! A folder's `common.wgsl` is put before the folder's other files where they need it, as the renderer does. Kernels of refinement are
//! put together of several files with constants before them: `crates/compute/tests/shaders.rs` validates each as it is used.

use naga::front::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::fs;
use std::path::{Path, PathBuf};

fn shaders(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            shaders(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            found.push(path);
        }
    }
}

fn validate(source: &str) -> Result<(), String> {
    let module = wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let validated = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    validated.map(drop).map_err(|error| error.emit_to_string(source))
}

#[test]
fn every_shader_validates() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut found = Vec::new();
    for entry in fs::read_dir(crates).unwrap() {
        shaders(&entry.unwrap().path(), &mut found);
    }
    assert!(!found.is_empty());
    let mut broken = Vec::new();
    for path in found.iter().filter(|path| !path.parent().is_some_and(|folder| folder.ends_with("compute/src/shaders")))
    {
        let source = fs::read_to_string(path).unwrap();
        let common = fs::read_to_string(path.with_file_name("common.wgsl")).unwrap_or_default();
        if let Err(alone) = validate(&source) {
            let error = validate(&format!("{common}\n{source}")).err();
            // A shared file may need nothing; any other file must do alone or with it.
            let error = if path.ends_with("common.wgsl") { Some(alone) } else { error };
            broken.extend(error.map(|error| format!("{}\n{error}", path.strip_prefix(crates).unwrap().display())));
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n\n"));
}

#[test]
fn a_broken_shader_is_noticed() {
    assert!(validate("fn f() -> f32 { return 1u; }").is_err());
    assert!(validate("@fragment fn f( {").is_err());
}
