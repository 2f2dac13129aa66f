//! The document: every element in the `gltf` crate's typed JSON structures, read one by one.
//!
//! ```text
//!   bytes ─► JSON value ─► for each element: leave out what is not used ─► gltf::json type, or what is wrong with it
//! ```
//!
//! The crate's own way, the whole file into one `Root`, is all or nothing: an animation with the KHR_animation_pointer
//! extension, a scene without nodes or a `3.0` for a `3` refuses the file, without the element's name. Its validation asks
//! for bounds that no reader needs, refuses extensions by its own list, and panics on a POSITION that is out of range. So
//! elements are read one by one, and one that does not read is an error when a surface needs it, not earlier. Two things
//! are read here because the crate's types lose digits: transforms (32 bits there) and numbers past 32 bits (cut off there).
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

/// Properties that Limn does not use in any element that it reads: broken ones are no reason to refuse a shape.
const NOT_USED: [&str; 9] =
    ["extras", "min", "max", "target", "weights", "camera", "sampler", "mimeType", "alphaCutoff"];

/// Properties that refer to an element of another list, or are numbers of the specification.
const NUMBERS: [&str; 13] = [
    "buffer",
    "bufferView",
    "componentType",
    "indices",
    "material",
    "mesh",
    "mode",
    "skin",
    "index",
    "source",
    "texCoord",
    "children",
    "nodes",
];

/// Properties that count bytes or elements.
const SIZES: [&str; 4] = ["byteLength", "byteOffset", "byteStride", "count"];

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
        let list = take(root, name);
        budget.spend("The file's JSON", list.len() as u64, size_of::<Result<T, String>>() as u64)?;
        Ok(Items { name, list: list.into_iter().map(read).collect() })
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

/// A node with its transform relative to its parent.
pub(super) struct Node {
    pub json: json::Node,
    pub local: Transform,
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
}

/// A material's base colour: its metallic-roughness one, else the specular-glossiness extension.
pub(super) struct Material {
    pub json: json::Material,
    /// How many other settings there are.
    pub unused: u64,
}

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
        Ok(Document {
            accessors: Items::take(r, "accessors", budget, typed)?,
            buffers: Items::take(r, "buffers", budget, typed)?,
            views: Items::take(r, "bufferViews", budget, typed)?,
            images: Items::take(r, "images", budget, typed)?,
            materials: Items::take(r, "materials", budget, material)?,
            meshes: Items::take(r, "meshes", budget, |mut mesh| {
                let primitives = take(&mut mesh, "primitives").into_iter().map(primitive).collect();
                Ok(Mesh { name: mesh.get("name").and_then(Value::as_str).map(str::to_owned), primitives })
            })?,
            nodes: Items::take(r, "nodes", budget, node)?,
            scenes: Items::take(r, "scenes", budget, |mut scene| {
                // The crate insists on the list.
                let nodes = take(&mut scene, "nodes");
                typed(Value::Object(Map::from_iter([("nodes".to_owned(), Value::Array(nodes))])))
            })?,
            textures: Items::take(r, "textures", budget, typed)?,
            rest: root,
        })
    }

    /// The scene to show, if there are scenes: the file's, else the first.
    pub fn scene(&self) -> Result<Option<usize>, ReadError> {
        let place = format_args!("The file");
        match self.rest.get("scene") {
            Some(scene) if !scene.is_null() => {
                let number = whole(scene).ok_or_else(|| bad(place, "its scene is not a whole number"))?;
                self.scenes.check(usize::try_from(number).unwrap_or(usize::MAX), "scene", place).map(Some)
            }
            _ => Ok(if self.scenes.len() > 0 { Some(0) } else { None }),
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

/// An element in its type, without what is not used.
fn typed<T: DeserializeOwned>(mut value: Value) -> Result<T, String> {
    if !value.is_object() {
        return Err("it is not a JSON object".to_owned());
    }
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
        "name" | "uri" | "alphaMode" => value.is_string(),
        "normalized" | "doubleSided" => value.is_boolean(),
        "extensions" => value.is_object(),
        key => !value.is_null() && !NOT_USED.contains(&key),
    });
    for (key, value) in map {
        let size = SIZES.contains(&key.as_str());
        match value {
            Value::Array(list) if NUMBERS.contains(&key.as_str()) => {
                list.iter_mut().try_for_each(|value| number(key, value, size))?
            }
            // Elsewhere this is a number.
            Value::Object(_) if key == "indices" => tidy(value)?,
            _ if size || NUMBERS.contains(&key.as_str()) => number(key, value, size)?,
            _ if key == "extensions" => value.get_mut(SPECULAR_GLOSSINESS).map_or(Ok(()), tidy)?,
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
    if let Some(map) = value.as_object_mut() {
        map.retain(|key, _| !matches!(key.as_str(), "matrix" | "translation" | "rotation" | "scale"));
    }
    Ok(Node { json: typed(value)?, local })
}

fn primitive(mut value: Value) -> Result<Primitive, String> {
    let targets = list(&value, "targets").len();
    let (mut names, mut broken) = (Vec::new(), Vec::new());
    if let Some(map) = value.as_object_mut() {
        map.remove("targets");
        let attributes = map.entry("attributes").or_insert(Value::Null);
        let mut good = Map::new();
        for (name, mut value) in attributes.as_object_mut().map(std::mem::take).unwrap_or_default() {
            // The crate takes TEXCOORD_00 and TEXCOORD_+0 for TEXCOORD_0.
            let known = name.rsplit('_').next().is_some_and(|n| n == "0" || !n.starts_with(['0', '+']));
            match number(&name, &mut value, false) {
                Ok(()) if !known => (),
                Ok(()) => _ = good.insert(name.clone(), value),
                Err(problem) if name == "POSITION" => return Err(problem),
                Err(_) => broken.push((name.clone(), shown(&value))),
            }
            names.push(name);
        }
        *attributes = Value::Object(good);
    }
    Ok(Primitive { json: typed(value)?, names, broken, targets })
}

fn material(mut value: Value) -> Result<Material, String> {
    let mut unused = 0;
    /// Keeps some properties and counts what is lost of the looks.
    fn keep(value: Option<&mut Value>, keys: &[&str], unused: &mut u64) -> bool {
        let Some(map) = value.and_then(Value::as_object_mut) else { return false };
        *unused += LOOKS.iter().filter(|key| map.contains_key(**key)).count() as u64;
        map.retain(|key, _| keys.contains(&key.as_str()));
        !map.is_empty()
    }
    keep(Some(&mut value), &["name", "doubleSided", "alphaMode", "pbrMetallicRoughness", "extensions"], &mut unused);
    let metal = value.get_mut("pbrMetallicRoughness");
    let has_base = keep(metal, &["baseColorFactor", "baseColorTexture"], &mut unused);
    if let Some(extensions) = value.get_mut("extensions").and_then(Value::as_object_mut) {
        let materials = extensions.keys().filter(|k| k.starts_with("KHR_materials_") && *k != SPECULAR_GLOSSINESS);
        unused += materials.count() as u64;
        extensions.retain(|key, _| key == SPECULAR_GLOSSINESS && !has_base);
        keep(extensions.get_mut(SPECULAR_GLOSSINESS), &["diffuseFactor", "diffuseTexture"], &mut unused);
    }
    Ok(Material { json: typed(value)?, unused })
}

/// A value for a message. Numbers and texts only: printing any JSON would bring in a whole serialiser.
pub(super) fn shown(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => number.to_string(),
        (_, Some(text)) => format!("\"{}\"", short(text)),
        _ => "(not a number)".to_owned(),
    }
}
