//! Model files to polygons and back: OBJ with MTL, and glTF 2.0 as `.gltf` and `.glb`.
//!
//! [`read`] takes a file's bytes, finds out what they are, and gives a [`Model`] with a list of [`Warning`]s, or one
//! [`ReadError`] that says what is wrong and where. Nothing here touches a disk or a network: files next to the model come
//! through [`Files`]. Whatever a file claims, no more memory than [`Limits`] allows is used for it.
//!
//! ```text
//!   bytes + name + siblings ── read ──► Model { soup, groups, materials, images, tags } + warnings
//!   Export { points, faces, ... } ── write_obj ──► .obj (+ .mtl, pictures)
//!                                 └─ write_glb ──► .glb
//! ```

mod error;
mod export;
mod files;
mod model;
mod mtl;
mod obj;
mod scan;
mod write_obj;

pub use error::{Limits, ReadError, Warning, WarningKind};
pub use export::{Export, ExportFaces, OutFile, WriteError};
pub use files::{Files, find};
pub use model::{Image, Material, Model, Tags};
pub use write_obj::write_obj;

/// Reads a model. `name` is the file's name: it decides when the content does not, and appears in messages.
///
/// # Errors
/// One [`ReadError`] when there is no surface to show; trouble that leaves one is in the list of warnings.
pub fn read(name: &str, bytes: &[u8], files: &dyn Files, limits: &Limits) -> Result<(Model, Vec<Warning>), ReadError> {
    obj::read(name, bytes, files, limits)
}
