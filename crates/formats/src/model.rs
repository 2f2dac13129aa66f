//! What a file becomes: polygons, the names of their groups, materials, and pictures that are still encoded.
//!
//! The polygons are a [`limn_mesh::soup::Soup`], unchecked; topology is built from it later. Colours are linear here,
//! whatever the file had: OBJ vertex colours and MTL's `Kd` are display values (sRGB) and are converted, glTF's are linear
//! already. Vertices keep the file's order (glTF: primitives one after another).

use limn_mesh::{Weld, soup::Soup};

/// A model as read from a file, before topology.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The file's name without its folder and extension.
    pub name: String,
    /// Positions, faces, texture coordinates, colours; groups and materials by number.
    pub soup: Soup,
    /// The names that `soup.face_groups` counts from 0. Empty if the file has no groups.
    pub groups: Vec<String>,
    /// The materials that `soup.face_materials` counts from 0; only those that some face uses.
    pub materials: Vec<Material>,
    /// The pictures that materials use.
    pub images: Vec<Image>,
    /// Whether the faces came as triangles because the format has no polygons (glTF without polygon encoding), so that
    /// pairing them back to quads may be offered.
    pub triangulated: bool,
    /// How positions should be welded by default: exactly for glTF, which repeats vertices at seams, off for OBJ.
    pub weld: Weld,
}

/// The surface of some faces, as far as Limn shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The file's name for it; may be empty.
    pub name: String,
    /// Linear RGBA, 0..=1. Multiplies the texture.
    pub base_color: [f32; 4],
    /// The base-colour picture, an index into the model's images.
    pub texture: Option<u32>,
    /// Whether both sides are meant to be seen.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Material { name: String::new(), base_color: [1.0; 4], texture: None, double_sided: true }
    }
}

/// A picture as the file has it, still encoded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// File name or the name given in the model; may be empty.
    pub name: String,
    /// The media type found from the bytes, such as `image/png`.
    pub mime: String,
    /// The encoded picture.
    pub bytes: Vec<u8>,
}

/// The linear value of an sRGB component (IEC 61966-2-1). Values outside 0..=1 follow the same curve.
pub(crate) fn srgb_to_linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
}

/// The sRGB component of a linear value; the inverse of [`srgb_to_linear`].
pub(crate) fn linear_to_srgb(c: f64) -> f64 {
    if c <= 0.04045 / 12.92 { c * 12.92 } else { 1.055 * libm::pow(c, 1.0 / 2.4) - 0.055 }
}

/// The name of a model: its file name without folder and extension.
pub(crate) fn model_name(file: &str) -> String {
    let base = file.rsplit(['/', '\\']).next().unwrap_or(file);
    match base.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => base.to_owned(),
    }
}
