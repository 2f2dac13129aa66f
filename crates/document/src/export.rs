//! A refined level as files.
//!
//! The extension chooses the format: `.obj` keeps polygons, full precision and the canonical order of vertices; `.glb` is for
//! programs that draw. Groups, materials, pictures, texture coordinates and vertex colours go along, each face with those of
//! the face that it came from. Vertices that building the mesh had split are written once. Cost: linear in the level.

use limn_formats::parcel::pack_export;
use limn_formats::{Export, ExportFaces, Origin, OutFile, WriteError, write_glb, write_obj};
use limn_mesh::{Faces, Refined};

use crate::document::Document;

/// Why nothing was written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The extension is of no format that can be written.
    #[error("`{file}` does not say in which format to write; end it in .obj or .glb")]
    Format {
        /// The name given.
        file: String,
    },
    /// No model is open, or the level was refined from another mesh.
    #[error("the level to export is not of the model that is open; refine it again")]
    Stale,
    /// The writer refused.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The formats that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Wavefront OBJ, with an MTL file if there are materials.
    Obj,
    /// Binary glTF 2.0.
    Glb,
}

/// The format that a file's name asks for, by its extension in any case.
///
/// # Errors
/// [`ExportError::Format`].
pub fn format(file: &str) -> Result<ExportFormat, ExportError> {
    match file.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase()).as_deref() {
        Some("obj") => Ok(ExportFormat::Obj),
        Some("glb") => Ok(ExportFormat::Glb),
        _ => Err(ExportError::Format { file: file.to_owned() }),
    }
}

impl Document {
    /// The files of the export command: the first has the name `file` (its last part, if it is a path), those that it refers
    /// to come after it. `refined` is the present level.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn export(&self, refined: &Refined, file: &str) -> Result<Vec<OutFile>, ExportError> {
        let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
        let mut files = self.with_export(refined, file, |export, format| match format {
            ExportFormat::Obj => write_obj(export),
            ExportFormat::Glb => write_glb(export).map(|bytes| vec![OutFile { name: name.to_owned(), bytes }]),
        })??;
        if let Some(first) = files.first_mut() {
            // As the person wrote it, capitals of the extension included.
            first.name = name.to_owned();
        }
        Ok(files)
    }

    /// The same, not yet written: packed for a writer elsewhere ([`limn_formats::parcel`]).
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn export_packed(&self, refined: &Refined, file: &str) -> Result<Vec<u8>, ExportError> {
        self.with_export(refined, file, |export, _| pack_export(export))
    }

    fn with_export<T>(
        &self,
        refined: &Refined,
        file: &str,
        take: impl FnOnce(&Export<'_>, ExportFormat) -> T,
    ) -> Result<T, ExportError> {
        let format = format(file)?;
        let (Some(model), Some(soup), Some(mesh)) = (self.model(), self.soup(), self.mesh()) else {
            return Err(ExportError::Stale);
        };
        if !std::sync::Arc::ptr_eq(mesh, refined.mesh()) {
            return Err(ExportError::Stale);
        }
        let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let faces = match &refined.faces {
            Faces::Polygons { offsets, corners } => ExportFaces::Polygons { offsets, corners },
            Faces::Triangles(corners) => ExportFaces::Triangles(corners),
            Faces::Quads(corners) => ExportFaces::Quads(corners),
        };
        // What a face of the level inherits from its face of the model.
        let inherit = |of: &[u32]| -> Vec<u32> {
            if of.is_empty() {
                return Vec::new();
            }
            let source = |f: usize| of.get(refined.face_source(f as u32) as usize).copied();
            (0..faces.count()).map(|f| source(f).unwrap_or(limn_mesh::NONE)).collect()
        };
        let (face_groups, face_materials) = (inherit(&soup.face_groups), inherit(&soup.face_materials));
        let normals = (format == ExportFormat::Glb).then(|| refined.normals());
        let export = Export {
            name: stem,
            points: &refined.points,
            origin: Some(Origin {
                level: refined.level,
                sources: &mesh.vertex_source,
                positions: mesh.weld_class.len() as u32,
                in_order: mesh.face_source.is_sorted(),
            }),
            faces,
            normals: normals.as_deref(),
            uv: refined.uv.as_ref().map(|uv| (&uv.values[..], &uv.corners[..])),
            colors: &refined.colors,
            face_groups: &face_groups,
            group_names: &model.groups,
            face_materials: &face_materials,
            materials: &model.materials,
            images: &model.images,
        };
        Ok(take(&export, format))
    }
}
