//! Reading glTF 2.0: `.gltf` with its siblings or `data:` URIs, and `.glb`.
//!
//! ```text
//!   container ─► document ─► scene: nodes, transforms ─► primitives ─► accessors ─► soup
//! ```
//!
//! The surfaces of all nodes of the scene are put one after another: primitives in the order of the nodes, each with the
//! positions of its accessor moved by its node's transform. Primitives that share their accessors and transform share their
//! positions too. A node is a group, and a part that is welded by itself. Faces of a mirrored node are turned round, so that they keep facing outwards.
//! glTF only knows triangles; where the FB_ngon_encoding extension is present they are read as the polygons they came from.
//!
//! The document is read with the `gltf` crate's typed structures, element by element (`document.rs`). The container and the
//! accessors are our own: version 1.4.1 of the crate refuses containers with chunks that it does not know and panics on a
//! length under 12; its accessor readers panic on quantised positions, empty accessors and huge counts, and give nothing for
//! an accessor without a buffer view. Every offset, stride and count is the file's word only.
//!
//! Source: glTF 2.0 specification, Khronos 2021. Limit: what needs a decoder (Draco, meshopt) is refused by name.

mod accessor;
mod container;
mod document;
mod material;
mod polygons;
mod scene;
mod transform;

use limn_mesh::{
    Weld,
    soup::{NONE, Soup},
};
use std::collections::{BTreeMap, BTreeSet};

use self::{
    container::Source,
    document::{Document, bad, extension, list, shown},
};
use crate::{
    Files, Limits, Model, ReadError, Warning,
    error::{WarningKind, Warnings, short},
    model::model_name,
};

/// Extensions that are read, or that change nothing of the shape.
const KNOWN: [&str; 13] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_lights_punctual",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_manifold",
    "FB_ngon_encoding",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// What required extensions begin with if a shape can be read without them.
const HARMLESS: [&str; 7] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_animation_pointer",
    "KHR_techniques_webgl",
];

/// Reads a glTF file of either kind.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    files: &dyn Files,
    limits: &Limits,
) -> Result<(Model, Vec<Warning>), ReadError> {
    let source = Source::open(file, bytes, files, limits)?;
    check_version(&source)?;
    check_required(&source)?;
    let mut warnings = Warnings::default();
    count_unused(&source, &mut warnings);
    let mut builder = scene::Builder::new(&source, warnings);
    builder.scene()?;
    builder.finish()
}

/// The files that a glTF file refers to; empty if it does not parse.
pub(crate) fn references(bytes: &[u8]) -> Vec<String> {
    let Ok(source) = Source::open("", bytes, &(), &Limits::default()) else { return Vec::new() };
    let Document { buffers, images, .. } = &source.document;
    let uris = buffers.good().filter_map(|b| b.uri.as_deref()).chain(images.good().filter_map(|i| i.uri.as_deref()));
    uris.filter(|uri| !uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:"))).map(str::to_owned).collect()
}

/// Whether these bytes are meant as glTF: the binary mark, or a JSON object.
pub(crate) fn is_gltf(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    bytes.starts_with(b"glTF") || text.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{')
}

fn check_version(source: &Source<'_>) -> Result<(), ReadError> {
    let asset = source.document.rest.get("asset");
    let version = asset.and_then(|a| a.get("version"));
    // Some glTF 1.0 writers gave a number.
    let version = version.map(|v| v.as_str().map_or_else(|| shown(v), str::to_owned));
    // In glTF 1.0 the lists were maps.
    let old = ["meshes", "nodes", "accessors"]
        .iter()
        .any(|key| source.document.rest.get(*key).is_some_and(|v| v.is_object()));
    let refuse = |version: String| Err(ReadError::Version { file: source.file.to_owned(), version: short(&version) });
    match version.filter(|v| !v.is_empty()) {
        _ if old => refuse("1.0".to_owned()),
        None => {
            Err(bad(format_args!("asset"), format!("{} does not state a glTF version, so it is not glTF", source.file)))
        }
        Some(version) => {
            let needed = asset.and_then(|a| a.get("minVersion")).and_then(|v| v.as_str()).unwrap_or("2.0");
            match version.split('.').next() {
                Some("2") if needed == "2.0" => Ok(()),
                Some("2") => refuse(needed.to_owned()),
                _ => refuse(version),
            }
        }
    }
}

fn check_required(source: &Source<'_>) -> Result<(), ReadError> {
    for name in list(&source.document.rest, "extensionsRequired").iter().filter_map(|v| v.as_str()) {
        let advice = match name {
            "KHR_draco_mesh_compression" => "export the model without Draco compression",
            "EXT_meshopt_compression" | "KHR_meshopt_compression" => "export the model without meshopt compression",
            _ if KNOWN.contains(&name) || HARMLESS.iter().any(|h| name.starts_with(h)) => continue,
            _ => "export the model without it",
        };
        return Err(ReadError::Extension { name: short(name), advice });
    }
    Ok(())
}

/// Warns of what is in the file and has no place in Limn.
fn count_unused(source: &Source<'_>, warnings: &mut Warnings) {
    let root = &source.document.rest;
    let mut count = |kind, number: usize| warnings.add(kind, number as u64, || None);
    count(WarningKind::Skins, list(root, "skins").len());
    count(WarningKind::Animations, list(root, "animations").len());
    count(WarningKind::Cameras, list(root, "cameras").len());
    count(WarningKind::Lights, extension(root, "KHR_lights_punctual").map_or(0, |l| list(l, "lights").len()));
    let used: BTreeSet<&str> = list(root, "extensionsUsed").iter().filter_map(|v| v.as_str()).collect();
    for name in used {
        if !KNOWN.contains(&name) {
            warnings.name(WarningKind::Extensions, name);
        }
    }
}
