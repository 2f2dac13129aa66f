//! What is written: borrowed arrays, so that a refined level goes out without a copy.

use limn_mesh::soup::NONE;

use crate::{Image, Material, Model};

/// Faces as the mesh kernel holds them: polygons of any size, or all triangles, or all quads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExportFaces<'a> {
    /// Face `f` has `corners[offsets[f]..offsets[f + 1]]`.
    Polygons {
        /// One more than there are faces, or empty for none.
        offsets: &'a [u32],
        /// Indices into the points.
        corners: &'a [u32],
    },
    /// Three indices a face.
    Triangles(&'a [u32]),
    /// Four indices a face.
    Quads(&'a [u32]),
}

impl Default for ExportFaces<'_> {
    fn default() -> Self {
        ExportFaces::Triangles(&[])
    }
}

impl<'a> ExportFaces<'a> {
    /// How many faces there are.
    pub fn count(&self) -> usize {
        match self {
            ExportFaces::Polygons { offsets, .. } => offsets.len().saturating_sub(1),
            ExportFaces::Triangles(corners) => corners.len() / 3,
            ExportFaces::Quads(corners) => corners.len() / 4,
        }
    }

    /// All corners, face by face.
    pub fn corners(&self) -> &'a [u32] {
        match self {
            ExportFaces::Polygons { corners, .. } | ExportFaces::Triangles(corners) | ExportFaces::Quads(corners) => {
                corners
            }
        }
    }

    /// Where face `f` stands in the corners; empty if there is no such face.
    pub fn range(&self, f: usize) -> std::ops::Range<usize> {
        match self {
            ExportFaces::Polygons { offsets, .. } => match (offsets.get(f), offsets.get(f + 1)) {
                (Some(a), Some(b)) => *a as usize..*b as usize,
                _ => 0..0,
            },
            ExportFaces::Triangles(_) => 3 * f..3 * f + 3,
            ExportFaces::Quads(_) => 4 * f..4 * f + 4,
        }
    }

    /// The corners of face `f`; empty if there is no such face.
    pub fn face(&self, f: usize) -> &'a [u32] {
        self.corners().get(self.range(f)).unwrap_or_default()
    }
}

/// Where the vertices of a level came from. Vertices of level 0 are the level's first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin<'a> {
    /// The level.
    pub level: u32,
    /// The position of the file behind each vertex of level 0.
    pub sources: &'a [u32],
    /// How many positions the file has.
    pub positions: u32,
    /// Whether level 0 lies in the file's order.
    pub in_order: bool,
}

/// A surface to write. Empty slices mean that there is none of a thing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Export<'a> {
    /// The base name of the files, without an extension; names the glTF mesh.
    pub name: &'a str,
    /// Vertex positions, written in this order.
    pub points: &'a [[f32; 3]],
    /// What tells copies of split vertices from vertices that touch, and the file's order; none: points are written as they are.
    pub origin: Option<Origin<'a>>,
    /// The faces.
    pub faces: ExportFaces<'a>,
    /// Unit normals, one for each point, or none.
    pub normals: Option<&'a [[f32; 3]]>,
    /// Texture coordinates (v up) and for every corner of `faces` one of them, or [`NONE`].
    pub uv: Option<(&'a [[f32; 2]], &'a [u32])>,
    /// Linear RGBA for each point, or empty.
    pub colors: &'a [[f32; 4]],
    /// The group of each face, or empty.
    pub face_groups: &'a [u32],
    /// The groups' names.
    pub group_names: &'a [String],
    /// The material of each face, or [`NONE`]; or empty.
    pub face_materials: &'a [u32],
    /// The materials.
    pub materials: &'a [Material],
    /// The pictures that the materials use.
    pub images: &'a [Image],
}

impl<'a> Export<'a> {
    /// A model as it was read.
    pub fn from_model(model: &'a Model) -> Self {
        let soup = &model.soup;
        Export {
            name: &model.name,
            points: &soup.positions,
            origin: None,
            faces: ExportFaces::Polygons { offsets: &soup.offsets, corners: &soup.corners },
            normals: None,
            uv: (!soup.uv_corners.is_empty()).then_some((&soup.uvs, &soup.uv_corners)),
            colors: &soup.colors,
            face_groups: &soup.face_groups,
            group_names: &model.groups,
            face_materials: &soup.face_materials,
            materials: &model.materials,
            images: &model.images,
        }
    }

    /// The group of a face, if the file has groups.
    pub(crate) fn group(&self, face: usize) -> Option<u32> {
        self.face_groups.get(face).copied()
    }

    /// The material of a face, if it has one.
    pub(crate) fn material(&self, face: usize) -> Option<u32> {
        self.face_materials.get(face).copied().filter(|m| *m != NONE && (*m as usize) < self.materials.len())
    }

    /// Checks that indices and lengths fit together, so that the writers need not.
    pub(crate) fn check(&self) -> Result<(), WriteError> {
        let bad = |what| Err(WriteError::Inconsistent { what });
        let (points, corners) = (self.points.len(), self.faces.corners());
        if corners.iter().any(|c| *c as usize >= points) {
            return bad("a face uses a point that is not there");
        }
        if let ExportFaces::Polygons { offsets, corners } = self.faces {
            let rising = offsets.windows(2).all(|w| w.first() <= w.last());
            if !rising || offsets.last().is_some_and(|last| *last as usize != corners.len()) {
                return bad("the face offsets do not fit the corners");
            }
        }
        if self.normals.is_some_and(|n| n.len() != points) || !(self.colors.is_empty() || self.colors.len() == points) {
            return bad("there is not one normal or colour for each point");
        }
        if let Some((values, uv_corners)) = self.uv
            && (uv_corners.len() != corners.len()
                || uv_corners.iter().any(|c| *c != NONE && *c as usize >= values.len()))
        {
            return bad("the texture coordinates do not fit the corners");
        }
        Ok(())
    }
}

/// One file of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct OutFile {
    /// File name with extension.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Why a model could not be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WriteError {
    /// The arrays do not fit together.
    #[error("The model cannot be written because {what}.")]
    Inconsistent {
        /// What does not fit.
        what: &'static str,
    },
    /// GLB counts its bytes in 32 bits.
    #[error(
        "The model would make a GLB of {bytes} bytes, and the format ends at 4294967295: write OBJ, or a lower level."
    )]
    TooLarge {
        /// The size it would have.
        bytes: u64,
    },
}
