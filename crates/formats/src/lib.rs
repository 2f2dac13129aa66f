//! Model files to polygons and back: OBJ with MTL, and glTF 2.0 as `.gltf` and `.glb`.
//!
//! [`read`] takes a file's bytes, finds out what they are, and gives a [`Model`] with a list of [`Warning`]s, or one
//! [`ReadError`] that says what is wrong and where. Nothing here touches a disk or a network: files next to the model come
//! through [`Files`]. Whatever a file claims, no more memory than [`Limits`] allows is used for it.
//!
//! ```text
//!   bytes + name + siblings ── read ──► Model { soup, groups, materials, images } + warnings
//!   Export { points, faces, ... } ── write_obj ──► .obj (+ .mtl, pictures)
//!                                 └─ write_glb ──► .glb
//! ```

mod error;
mod export;
mod files;
mod gltf;
mod merge;
mod model;
mod mtl;
mod obj;
pub mod parcel;
mod scan;
mod write_glb;
mod write_obj;

pub use error::{Limits, ReadError, Warning, WarningKind};
pub use export::{Export, ExportFaces, Origin, OutFile, WriteError};
pub use files::{Files, find};
pub use model::{Image, Material, Model};
pub use write_glb::write_glb;
pub use write_obj::write_obj;

/// Reads a model. `name` is the file's name: it decides when the content does not, and appears in messages.
///
/// # Errors
/// One [`ReadError`] when there is no surface to show; trouble that leaves one is in the list of warnings.
pub fn read(name: &str, bytes: &[u8], files: &dyn Files, limits: &Limits) -> Result<(Model, Vec<Warning>), ReadError> {
    match format(name, bytes)? {
        Format::Gltf => gltf::read(name, bytes, files, limits),
        Format::Obj => obj::read(name, bytes, files, limits),
    }
}

/// The files that a model needs beside it, as it names them: an OBJ's material files, a material file's pictures, a glTF's
/// buffers and pictures. For loaders that fetch siblings by name; a name may be percent-encoded or have folders.
///
/// Each name once, in the order of the file; empty if the file cannot be read. Cost: one pass over the bytes.
pub fn references(name: &str, bytes: &[u8]) -> Vec<String> {
    let is_mtl = name.rsplit_once('.').is_some_and(|(_, e)| e.eq_ignore_ascii_case("mtl"));
    let mut names = match format(name, bytes) {
        Ok(Format::Gltf) => gltf::references(bytes),
        _ if is_mtl => mtl::pictures(bytes),
        Ok(Format::Obj) => obj::references(bytes),
        Err(_) => Vec::new(),
    };
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names
}

enum Format {
    Obj,
    Gltf,
}

/// Finds a file's format: content first, since names lie, then the extension.
fn format(name: &str, bytes: &[u8]) -> Result<Format, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty { file: name.to_owned() });
    }
    if gltf::is_gltf(bytes) {
        return Ok(Format::Gltf);
    }
    let extension = name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase());
    match extension.as_deref() {
        Some("obj") => Ok(Format::Obj),
        Some("glb" | "gltf" | "vrm") => {
            let problem = "it does not begin with \"glTF\" or \"{\"".to_owned();
            Err(ReadError::Container { file: name.to_owned(), problem })
        }
        // A name without a known extension may still be OBJ: some line begins like a vertex.
        _ if obj::looks_like_obj(bytes) => Ok(Format::Obj),
        _ => Err(ReadError::UnknownFormat { file: name.to_owned() }),
    }
}
