//! Base colours and their pictures.
//!
//! Of a glTF material Limn shows the base colour factor, the base colour picture and whether it is double-sided. The older
//! specular-glossiness extension's diffuse colour stands in where there is no metallic-roughness one. Opacity counts only
//! where the material says so (`alphaMode`). Only materials that some surface uses are kept.

use gltf::json::{material::AlphaMode, texture::Info, validation::Checked};

use super::{container::Source, document::UvTransform};
use crate::{
    Image, Material, ReadError,
    error::{WarningKind, Warnings},
    files::{data_uri, find, image_type, percent_decode},
};

/// Where a material's picture takes its texture coordinates.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct UvUse {
    /// The number of the `TEXCOORD` attribute.
    pub set: u32,
    pub transform: Option<UvTransform>,
}

/// The materials and pictures in use, numbered in the order of their first use.
pub(super) struct Materials<'s> {
    source: &'s Source<'s>,
    /// By the number in the file.
    known: Vec<Option<(u32, UvUse)>>,
    images: Vec<Option<Option<u32>>>,
    pub out: Vec<Material>,
    pub pictures: Vec<Image>,
}

impl<'s> Materials<'s> {
    pub fn new(source: &'s Source<'s>) -> Self {
        Materials {
            source,
            known: vec![None; source.document.materials.len()],
            images: vec![None; source.document.images.len()],
            out: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// The number of a material in what is built, and where its picture takes its coordinates.
    pub fn get(&mut self, number: usize, warnings: &mut Warnings) -> Result<(u32, UvUse), ReadError> {
        if let Some(Some(known)) = self.known.get(number) {
            return Ok(*known);
        }
        let material = self.source.document.materials.get(number)?;
        let json = &material.json;
        let base = &json.pbr_metallic_roughness;
        let [r, g, b, a] = base.base_color_factor.0.map(|c| c.clamp(0.0, 1.0));
        let opaque = matches!(json.alpha_mode, Checked::Valid(AlphaMode::Opaque));
        let base_color = [r, g, b, if opaque { 1.0 } else { a }];
        let (texture, set) = match &base.base_color_texture {
            Some(info) => (self.texture(info, number, warnings)?, info.tex_coord),
            None => (None, 0),
        };
        let uv = UvUse { set, transform: material.transform };
        let name = json.name.clone().unwrap_or_default();
        warnings.add(WarningKind::MaterialSettings, material.unused, || None);
        let result = (self.out.len() as u32, uv);
        self.out.push(Material { name, base_color, texture, double_sided: json.double_sided });
        if let Some(slot) = self.known.get_mut(number) {
            *slot = Some(result);
        }
        Ok(result)
    }

    fn texture(&mut self, info: &Info, material: usize, warnings: &mut Warnings) -> Result<Option<u32>, ReadError> {
        let document = &self.source.document;
        let number = document.textures.check(info.index.value(), "index", format_args!("materials[{material}]"))?;
        let place = format_args!("textures[{number}]");
        match document.textures.get(number)?.source.value() {
            // This is how the crate says that there is none.
            none if none == u32::MAX as usize => {
                warnings.name(WarningKind::TextureFormat, &place.to_string());
                Ok(None)
            }
            image => self.image(document.images.check(image, "source", place)?, warnings),
        }
    }

    fn image(&mut self, number: usize, warnings: &mut Warnings) -> Result<Option<u32>, ReadError> {
        if let Some(Some(known)) = self.images.get(number) {
            return Ok(*known);
        }
        let result = self.load_image(number, warnings)?;
        if let Some(slot) = self.images.get_mut(number) {
            *slot = Some(result);
        }
        Ok(result)
    }

    fn load_image(&mut self, number: usize, warnings: &mut Warnings) -> Result<Option<u32>, ReadError> {
        let place = format_args!("images[{number}]");
        let source = self.source;
        let image = source.document.images.get(number)?;
        let mut name = image.name.clone().unwrap_or_default();
        let view = match image.buffer_view {
            Some(view) => Some(source.document.views.check(view.value(), "bufferView", place)?),
            None => None,
        };
        let decoded;
        let bytes = match (view, image.uri.as_deref()) {
            (Some(view), _) => match source.view(view) {
                Ok((bytes, _)) => bytes,
                // A picture is no reason to refuse the shape.
                Err(error) => {
                    warnings.name(WarningKind::TextureMissing, error.to_string().trim_end_matches('.'));
                    return Ok(None);
                }
            },
            (None, Some(uri)) if uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:")) => {
                source.budget.borrow_mut().spend("A picture", uri.len() as u64, 1)?;
                decoded = data_uri(uri).map(|(_, bytes)| bytes).unwrap_or_default();
                &decoded
            }
            (None, Some(uri)) => match find(source.files, uri) {
                Some((found, bytes)) => {
                    name = found;
                    bytes
                }
                None => {
                    warnings.name(WarningKind::TextureMissing, &percent_decode(uri));
                    return Ok(None);
                }
            },
            (None, None) => &[],
        };
        let Some(mime) = image_type(bytes) else {
            let label = if name.is_empty() { format!("images[{number}]") } else { name };
            warnings.name(WarningKind::TextureFormat, &label);
            return Ok(None);
        };
        source.budget.borrow_mut().spend("A picture", bytes.len() as u64, 1)?;
        self.pictures.push(Image { name, mime: mime.to_owned(), bytes: bytes.to_vec() });
        Ok(Some(self.pictures.len() as u32 - 1))
    }
}
