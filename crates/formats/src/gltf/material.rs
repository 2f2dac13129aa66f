//! Base colours and their pictures.
//!
//! Of a glTF material Limn shows the base colour factor, the base colour picture and whether it is double-sided. The older
//! specular-glossiness extension's diffuse colour stands in where there is no metallic-roughness one. Opacity counts only
//! where the material says so (`alphaMode`). Only materials that some surface uses are kept.

use serde_json::Value;

use super::{
    container::Source,
    json::{bad, extension, index, list, numbers, text},
};
use crate::{
    Image, Material, ReadError,
    error::{WarningKind, Warnings},
    files::{data_uri, find, image_type, percent_decode},
};

/// Where a material's picture takes its texture coordinates.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct UvUse {
    /// The number of the `TEXCOORD` attribute.
    pub set: u64,
    /// Offset, rotation in radians, scale.
    pub transform: Option<([f64; 2], f64, [f64; 2])>,
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

/// Properties that change how a surface looks and that Limn does not show. The metallic and roughness factors are not
/// counted: every material has them, written or not.
const UNUSED: [&str; 4] = ["normalTexture", "occlusionTexture", "emissiveTexture", "emissiveFactor"];

impl<'s> Materials<'s> {
    pub fn new(source: &'s Source<'s>) -> Self {
        Materials {
            source,
            known: vec![None; list(&source.root, "materials").len()],
            images: vec![None; list(&source.root, "images").len()],
            out: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// The number of a material in what is built, and where its picture takes its coordinates.
    pub fn get(&mut self, number: usize, warnings: &mut Warnings) -> Result<(u32, UvUse), ReadError> {
        if let Some(Some(known)) = self.known.get(number) {
            return Ok(*known);
        }
        let place = format_args!("materials[{number}]");
        let Some(value) = list(&self.source.root, "materials").get(number) else {
            return Err(bad(place, "there is no such material"));
        };
        let metal = value.get("pbrMetallicRoughness");
        let diffuse = extension(value, "KHR_materials_pbrSpecularGlossiness");
        let (base, factor, picture) = match (metal, diffuse) {
            (_, Some(diffuse))
                if metal.is_none_or(|m| m.get("baseColorTexture").is_none() && m.get("baseColorFactor").is_none()) =>
            {
                (Some(diffuse), "diffuseFactor", "diffuseTexture")
            }
            (base, _) => (base, "baseColorFactor", "baseColorTexture"),
        };
        let mut material = Material {
            name: text(value, "name").unwrap_or_default().to_owned(),
            double_sided: value.get("doubleSided").and_then(Value::as_bool).unwrap_or(false),
            ..Material::default()
        };
        let mut uv = UvUse { set: 0, transform: None };
        if let Some(base) = base {
            if let Some(color) = numbers::<4>(base, factor, place)? {
                material.base_color = color.map(|c| c.clamp(0.0, 1.0) as f32);
            }
            if let Some(info) = base.get(picture) {
                (material.texture, uv) = self.texture(info, number, warnings)?;
            }
        }
        if matches!(text(value, "alphaMode"), None | Some("OPAQUE")) {
            let [r, g, b, _] = material.base_color;
            material.base_color = [r, g, b, 1.0];
        }
        self.count_unused(value, metal, warnings);
        let result = (self.out.len() as u32, uv);
        self.out.push(material);
        if let Some(slot) = self.known.get_mut(number) {
            *slot = Some(result);
        }
        Ok(result)
    }

    fn count_unused(&self, value: &Value, metal: Option<&Value>, warnings: &mut Warnings) {
        let plain = UNUSED.iter().filter(|key| value.get(**key).is_some()).count();
        let metallic = usize::from(metal.is_some_and(|m| m.get("metallicRoughnessTexture").is_some()));
        let extensions = value.get("extensions").and_then(Value::as_object).map_or(0, |e| {
            e.keys().filter(|k| k.starts_with("KHR_materials_") && *k != "KHR_materials_pbrSpecularGlossiness").count()
        });
        warnings.add(WarningKind::MaterialSettings, (plain + metallic + extensions) as u64, || None);
    }

    fn texture(
        &mut self,
        info: &Value,
        material: usize,
        warnings: &mut Warnings,
    ) -> Result<(Option<u32>, UvUse), ReadError> {
        let place = format_args!("materials[{material}]");
        let textures = list(&self.source.root, "textures");
        let mut uv = UvUse { set: info.get("texCoord").and_then(Value::as_u64).unwrap_or(0), transform: None };
        if let Some(t) = extension(info, "KHR_texture_transform") {
            let offset = numbers(t, "offset", place)?.unwrap_or([0.0; 2]);
            let scale = numbers(t, "scale", place)?.unwrap_or([1.0; 2]);
            let rotation = t.get("rotation").and_then(Value::as_f64).unwrap_or(0.0);
            uv.set = t.get("texCoord").and_then(Value::as_u64).unwrap_or(uv.set);
            if (offset, rotation, scale) != ([0.0; 2], 0.0, [1.0; 2]) {
                uv.transform = Some((offset, rotation, scale));
            }
        }
        let Some(number) = index(info, "index", textures.len(), place)? else {
            return Err(bad(place, "its picture names no texture"));
        };
        let Some(texture) = textures.get(number) else { return Ok((None, uv)) };
        let images = list(&self.source.root, "images").len();
        let place = format_args!("textures[{number}]");
        // Formats that browsers decode as well as PNG and JPEG.
        let newer = extension(texture, "EXT_texture_webp").or(extension(texture, "EXT_texture_avif"));
        let image = match newer {
            Some(newer) => index(newer, "source", images, place)?,
            None => None,
        };
        let image = match image {
            Some(image) => Some(image),
            None => index(texture, "source", images, place)?,
        };
        match image {
            Some(image) => Ok((self.image(image, warnings)?, uv)),
            None => {
                warnings.name(WarningKind::TextureFormat, &format!("textures[{number}]"));
                Ok((None, uv))
            }
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
        let Some(image) = list(&source.root, "images").get(number) else { return Ok(None) };
        let views = list(&source.root, "bufferViews").len();
        let mut name = text(image, "name").unwrap_or_default().to_owned();
        let decoded;
        let bytes = match (index(image, "bufferView", views, place)?, text(image, "uri")) {
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
