//! The document: every element in the `gltf` crate's typed JSON structures, read one by one.
//!
//! ```text
//!   bytes ─► JSON value ─► for each element: leave out what is not used ─► gltf::json type, or what is wrong with it
//! ```
//!
//! The crate's own way, the whole file into one `Root`, is all or nothing: an animation with the KHR_animation_pointer
//! extension, a scene without nodes or a `3.0` for a `3` refuses the file, without the element's name. Its validation asks
//! for bounds that no reader needs, refuses extensions by its own list, and panics on a POSITION that is out of range. So
//! elements are read one by one, and one that does not read is an error when a surface needs it, not earlier.
//!
//! Some things are taken out of an element before the crate sees it: transforms, which it rounds to 32 bits; what Limn uses
//! of extensions, which end up in what they extend; and numbers past 32 bits, of which it would take the low half.
//!
//! Cost: one pass over the JSON and one over its value. Source: glTF 2.0 specification, Khronos 2021.

use std::fmt::Arguments;

use gltf::json::{self, Value, deserialize};
use serde::de::DeserializeOwned;
use serde_json::Map;

use super::transform::Transform;
use crate::{
    ReadError,
    error::{Budget, short},
};

/// Properties that Limn does not use in any element that it reads: broken ones are no reason to refuse a shape. What it uses
/// of extensions is taken out before.
const NOT_USED: [&str; 10] =
    ["extras", "extensions", "min", "max", "target", "weights", "camera", "sampler", "mimeType", "alphaCutoff"];

/// Properties that refer to an element of another list, or are numbers of the specification.
const NUMBERS: [&str; 10] =
    ["buffer", "bufferView", "byteStride", "componentType", "index", "indices", "material", "mesh", "mode", "source"];

/// Properties that count bytes or elements.
const SIZES: [&str; 3] = ["byteLength", "byteOffset", "count"];

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Properties that change how a surface looks and that Limn does not show. The metallic and roughness factors are not
/// counted: every material has them, written or not.
const LOOKS: [&str; 5] =
    ["normalTexture", "occlusionTexture", "emissiveTexture", "emissiveFactor", "metallicRoughnessTexture"];

/// An error about an element of the file.
pub(super) fn bad(place: Arguments<'_>, problem: impl Into<String>) -> ReadError {
    ReadError::Element { place: place.to_string(), problem: problem.into() }
}

/// The elements of a list, each with what is wrong with it if it does not read.
pub(super) struct Items<T> {
    name: &'static str,
    list: Vec<Result<T, String>>,
}

impl<T> Items<T> {
    fn take(
        root: &mut Value,
        name: &'static str,
        budget: &mut Budget,
        read: impl Fn(Value) -> Result<T, String>,
    ) -> Result<Self, ReadError> {
        let list = take_objects(root, name);
        budget.spend("The file's JSON", list.len() as u64, size_of::<Result<T, String>>() as u64)?;
        Ok(Items { name, list: list.map(read).collect() })
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// An element by its number.
    pub fn get(&self, number: usize) -> Result<&T, ReadError> {
        let place = format_args!("{}[{number}]", self.name);
        match self.list.get(number) {
            Some(Ok(item)) => Ok(item),
            Some(Err(problem)) => Err(bad(place, problem)),
            None => Err(bad(place, format!("the file has only {}", self.list.len()))),
        }
    }

    /// The elements that read.
    pub fn good(&self) -> impl Iterator<Item = &T> {
        self.list.iter().flatten()
    }

    /// Checks a number by which another element refers to one of these.
    pub fn check(&self, number: usize, key: &str, place: Arguments<'_>) -> Result<usize, ReadError> {
        match self.list.len() {
            len if number < len => Ok(number),
            len => Err(bad(place, format!("its {key} is {number}, but the file has only {len}"))),
        }
    }
}

pub(super) struct Node {
    pub json: json::Node,
    /// Relative to the parent.
    pub local: Transform,
    /// The attributes of the EXT_mesh_gpu_instancing extension.
    pub instances: Option<Value>,
}

pub(super) struct Mesh {
    pub name: Option<String>,
    pub primitives: Vec<Result<Primitive, String>>,
}

/// A primitive without its morph targets and with the attributes that refer to something.
pub(super) struct Primitive {
    pub json: json::mesh::Primitive,
    /// The names of all attributes, as the file has them; the crate keeps only those that it knows.
    pub names: Vec<String>,
    /// Attributes that are not numbers, for a message.
    pub broken: Vec<(String, String)>,
    pub targets: usize,
    /// Whether it has the FB_ngon_encoding extension.
    pub polygons: bool,
    /// Whether it has the KHR_draco_mesh_compression extension.
    pub draco: bool,
}

/// A material. Where the specular-glossiness extension stands in for a base colour, it has been put in its place.
pub(super) struct Material {
    pub json: json::Material,
    /// What the KHR_texture_transform extension does to the base colour's picture.
    pub transform: Option<UvTransform>,
    /// How many settings there are other than the base colour.
    pub unused: u64,
}

/// Offset, rotation in radians, scale.
pub(super) type UvTransform = ([f64; 2], f64, [f64; 2]);

/// What Limn reads of a document.
pub(super) struct Document {
    pub accessors: Items<json::Accessor>,
    pub buffers: Items<json::Buffer>,
    pub views: Items<json::buffer::View>,
    pub images: Items<json::Image>,
    pub materials: Items<Material>,
    pub meshes: Items<Mesh>,
    pub nodes: Items<Node>,
    pub scenes: Items<json::Scene>,
    pub textures: Items<json::Texture>,
    /// The rest: extensions, and lists that are only counted.
    pub rest: Value,
}

impl Document {
    /// Sorts a parsed file's elements.
    pub fn new(mut root: Value, budget: &mut Budget) -> Result<Self, ReadError> {
        let r = &mut root;
        let primitives: usize = list(r, "meshes").iter().map(|mesh| list(mesh, "primitives").len()).sum();
        budget.spend("The file's JSON", primitives as u64, size_of::<Result<Primitive, String>>() as u64)?;
        Ok(Document {
            accessors: Items::take(r, "accessors", budget, typed)?,
            buffers: Items::take(r, "buffers", budget, typed)?,
            views: Items::take(r, "bufferViews", budget, typed)?,
            images: Items::take(r, "images", budget, typed)?,
            materials: Items::take(r, "materials", budget, material)?,
            meshes: Items::take(r, "meshes", budget, |mut mesh| {
                let primitives = take_objects(&mut mesh, "primitives").map(primitive).collect();
                Ok(Mesh { name: mesh.get("name").and_then(Value::as_str).map(str::to_owned), primitives })
            })?,
            nodes: Items::take(r, "nodes", budget, node)?,
            scenes: Items::take(r, "scenes", budget, |mut scene| {
                // The crate insists on the list.
                let nodes = take(&mut scene, "nodes");
                typed(Value::Object(Map::from_iter([("nodes".to_owned(), Value::Array(nodes))])))
            })?,
            textures: Items::take(r, "textures", budget, texture)?,
            rest: root,
        })
    }

    /// The scene to show, if there are scenes: the file's, else the first.
    pub fn scene(&self) -> Result<Option<usize>, ReadError> {
        let place = format_args!("The file");
        match self.rest.get("scene") {
            Some(scene) => {
                let number = whole(scene).ok_or_else(|| bad(place, "its scene is not a whole number"))?;
                self.scenes.check(usize::try_from(number).unwrap_or(usize::MAX), "scene", place).map(Some)
            }
            None => Ok((self.scenes.len() > 0).then_some(0)),
        }
    }
}

/// An array property; empty if it is missing.
pub(super) fn list<'v>(value: &'v Value, key: &str) -> &'v [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// An extension of an object.
pub(super) fn extension<'v>(value: &'v Value, name: &str) -> Option<&'v Value> {
    value.get("extensions")?.get(name)
}

/// Takes a list out of an object; empty if it is missing.
fn take(value: &mut Value, key: &str) -> Vec<Value> {
    value.get_mut(key).and_then(Value::as_array_mut).map(std::mem::take).unwrap_or_default()
}

/// A list of objects; other values in it stand for objects without properties.
fn take_objects(value: &mut Value, key: &str) -> impl ExactSizeIterator<Item = Value> {
    let object = |value: Value| if value.is_object() { value } else { Value::Object(Map::new()) };
    take(value, key).into_iter().map(object)
}

/// An element in its type, without what is not used.
fn typed<T: DeserializeOwned>(mut value: Value) -> Result<T, String> {
    tidy(&mut value)?;
    deserialize::from_value(value).map_err(|error| {
        let text = error.to_string();
        match text.strip_prefix("missing field ") {
            Some(field) => format!("it has no {}", field.trim_matches('`')),
            None => format!("it does not read: {}", short(&text)),
        }
    })
}

/// Leaves out what is not used, or is of a type that means nothing; prints numbers as the crate wants them.
fn tidy(value: &mut Value) -> Result<(), String> {
    let map = match value {
        Value::Object(map) => map,
        Value::Array(list) => return list.iter_mut().try_for_each(tidy),
        _ => return Ok(()),
    };
    map.retain(|key, value| match key.as_str() {
        "name" | "uri" | "alphaMode" | "type" => value.is_string(),
        "normalized" | "doubleSided" => value.is_boolean(),
        "children" => value.is_array(),
        // Without them there is still a shape, and some writers say -1 for none.
        "skin" | "texCoord" => number(key, value, false).is_ok(),
        key => !NOT_USED.contains(&key),
    });
    for (key, value) in map {
        let size = SIZES.contains(&key.as_str());
        match value {
            Value::Array(list) if matches!(key.as_str(), "children" | "nodes") => {
                list.iter_mut().try_for_each(|value| number(key, value, size))?
            }
            // In the sparse part of an accessor; elsewhere this is a number.
            Value::Object(map) if key == "indices" && map.contains_key("componentType") => tidy(value)?,
            _ if size || NUMBERS.contains(&key.as_str()) => number(key, value, size)?,
            _ => tidy(value)?,
        }
    }
    Ok(())
}

/// Checks a whole number. The crate takes none that is printed as 3.0, and of large ones the low 32 bits.
fn number(key: &str, value: &mut Value, size: bool) -> Result<(), String> {
    match whole(value) {
        Some(n) if size || n < u64::from(u32::MAX) => *value = n.into(),
        Some(n) => return Err(format!("its {key} is {n}, which is more than 32 bits can number")),
        None if matches!(key, "children" | "nodes") => {
            return Err(format!("its {key} name node {}, which is not a whole number", shown(value)));
        }
        None => return Err(format!("its {key} is not a whole number")),
    }
    Ok(())
}

/// A whole number, not negative. Some writers print 3.0.
pub(super) fn whole(value: &Value) -> Option<u64> {
    let float = || value.as_f64().filter(|f| *f >= 0.0 && *f < 9e15 && f.trunc() == *f).map(|f| f as u64);
    value.as_u64().or_else(float)
}

/// A property of exactly `N` numbers; `None` if it is missing.
pub(super) fn numbers<const N: usize>(value: &Value, key: &str) -> Result<Option<[f64; N]>, String> {
    let Some(list) = value.get(key) else { return Ok(None) };
    let given = list.as_array().map_or(&[][..], Vec::as_slice);
    let mut out = [0.0; N];
    let mut good = given.len() == N;
    for (slot, number) in out.iter_mut().zip(given) {
        match number.as_f64() {
            Some(number) => *slot = number,
            None => good = false,
        }
    }
    if good { Ok(Some(out)) } else { Err(format!("its {key} is not a list of {N} numbers")) }
}

fn node(mut value: Value) -> Result<Node, String> {
    let local = Transform::of_node(&value)?;
    let instances = extension(&value, "EXT_mesh_gpu_instancing").and_then(|e| e.get("attributes")).cloned();
    if let Some(map) = value.as_object_mut() {
        map.retain(|key, _| !matches!(key.as_str(), "matrix" | "translation" | "rotation" | "scale"));
    }
    Ok(Node { json: typed(value)?, local, instances })
}

fn primitive(mut value: Value) -> Result<Primitive, String> {
    let targets = list(&value, "targets").len();
    let polygons = extension(&value, "FB_ngon_encoding").is_some();
    let draco = extension(&value, "KHR_draco_mesh_compression").is_some();
    let (mut names, mut broken) = (Vec::new(), Vec::new());
    if let Some(map) = value.as_object_mut() {
        map.remove("targets");
        let no_faces = map.get("mode").and_then(whole).is_some_and(|mode| mode < 4);
        let attributes = map.entry("attributes").or_insert(Value::Null);
        let mut good = Map::new();
        for (name, mut value) in attributes.as_object_mut().map(std::mem::take).unwrap_or_default() {
            // The crate takes TEXCOORD_00 and TEXCOORD_+0 for TEXCOORD_0.
            let known = name.rsplit('_').next().is_some_and(|n| n == "0" || !n.starts_with(['0', '+']));
            match number(&name, &mut value, false) {
                Ok(()) if !known => (),
                Ok(()) => _ = good.insert(name.clone(), value),
                Err(problem) if name == "POSITION" && !no_faces => return Err(problem),
                Err(_) => broken.push((name.clone(), shown(&value))),
            }
            names.push(name);
        }
        let positions = good.contains_key("POSITION");
        *attributes = Value::Object(good);
        // What it has else does not matter where there are no faces to be read.
        if !positions || no_faces {
            map.retain(|key, _| matches!(key.as_str(), "mode" | "attributes"));
        }
    }
    Ok(Primitive { json: typed(value)?, names, broken, targets, polygons, draco })
}

fn texture(mut value: Value) -> Result<json::Texture, String> {
    // Formats that browsers decode as well as PNG and JPEG.
    let newer = extension(&value, "EXT_texture_webp").or(extension(&value, "EXT_texture_avif"));
    if let (Some(source), Some(map)) = (newer.and_then(|e| e.get("source")).cloned(), value.as_object_mut()) {
        map.insert("source".to_owned(), source);
    }
    typed(value)
}

fn material(mut value: Value) -> Result<Material, String> {
    let metal = value.get("pbrMetallicRoughness");
    let looks = |value: &Value| LOOKS.iter().filter(|key| value.get(**key).is_some()).count();
    let extensions = value
        .get("extensions")
        .and_then(Value::as_object)
        .map_or(0, |e| e.keys().filter(|k| k.starts_with("KHR_materials_") && *k != SPECULAR_GLOSSINESS).count());
    let unused = (looks(&value) + metal.map_or(0, looks) + extensions) as u64;

    let base = |of: Option<&Value>, color: &str, picture: &str| -> Result<_, String> {
        let Some(of) = of else { return Ok((None, None)) };
        let color = numbers::<4>(of, color)?.map(Value::from_iter);
        match of.get(picture) {
            Some(picture) if picture.get("index").is_none() => Err("its picture names no texture".to_owned()),
            picture => Ok((color, picture.cloned())),
        }
    };
    let (color, mut picture) = match base(metal, "baseColorFactor", "baseColorTexture")? {
        (None, None) => base(extension(&value, SPECULAR_GLOSSINESS), "diffuseFactor", "diffuseTexture")?,
        base => base,
    };
    let transform = picture.as_mut().map_or(Ok(None), uv_transform)?;
    if let Some(map) = value.as_object_mut() {
        map.retain(|key, _| matches!(key.as_str(), "name" | "doubleSided" | "alphaMode"));
        let base = [("baseColorFactor", color), ("baseColorTexture", picture)];
        let base = base.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?)));
        map.insert("pbrMetallicRoughness".to_owned(), Value::Object(base.collect()));
    }
    Ok(Material { json: typed(value)?, transform, unused })
}

/// How a picture is moved, if it is; the extension may name other coordinates, too.
fn uv_transform(picture: &mut Value) -> Result<Option<UvTransform>, String> {
    let Some(t) = extension(picture, "KHR_texture_transform") else { return Ok(None) };
    let offset = numbers(t, "offset")?.unwrap_or([0.0; 2]);
    let scale = numbers(t, "scale")?.unwrap_or([1.0; 2]);
    let rotation = t.get("rotation").and_then(Value::as_f64).unwrap_or(0.0);
    let transform = (offset, rotation, scale);
    if let (Some(set), Some(map)) = (t.get("texCoord").cloned(), picture.as_object_mut()) {
        map.insert("texCoord".to_owned(), set);
    }
    Ok(Some(transform).filter(|t| *t != ([0.0; 2], 0.0, [1.0; 2])))
}

/// A value for a message. Numbers and texts only: printing any JSON would bring in a whole serialiser.
pub(super) fn shown(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => number.to_string(),
        (_, Some(text)) => format!("\"{}\"", short(text)),
        _ => "(not a number)".to_owned(),
    }
}
