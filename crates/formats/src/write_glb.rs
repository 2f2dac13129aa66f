//! Writing binary glTF 2.0.
//!
//! ```text
//!   accessors  positions, normals, texture coordinates, colours: one set, shared by all primitives
//!   meshes     one a group, named; one primitive a material
//!   indices    every polygon a fan; with FB_ngon_encoding a new first vertex starts a new polygon
//! ```
//!
//! A point with several texture coordinates becomes several vertices; the first keeps the point's number, the others come
//! after all points. A polygon's fan starts at its first corner, unless the polygon before it starts there too or the fan
//! would fold over (a concave polygon): then at the next corner that is neither, so files read back give the same polygons,
//! sometimes turned. Source: glTF 2.0 specification and the FB_ngon_encoding extension. Cost: about 60 ns a face.
//! Limit: a concave polygon that no single fan covers folds over in viewers, though it reads back whole.

use std::{collections::BTreeMap, fmt::Write};

use limn_mesh::soup::NONE;

use crate::export::{Export, ExportFaces, WriteError};
use crate::merge::Merged;

/// At most so many corners of one polygon are tried as the start of its fan, and so many copies of a vertex compared.
const TRIES: usize = 64;

/// Writes a `.glb` file.
///
/// Pictures are embedded where glTF can hold them (PNG, JPEG, and WebP by extension); others are left out, as are pictures
/// of a model without texture coordinates. Faces with fewer than three corners are left out.
///
/// # Errors
/// [`WriteError::Inconsistent`] if an index is out of range, a point is not finite, or there is no face;
/// [`WriteError::TooLarge`] past 4 GB.
pub fn write_glb(export: &Export<'_>) -> Result<Vec<u8>, WriteError> {
    export.check()?;
    let merged = Merged::of(export);
    let export = &merged.as_ref().map_or(*export, |merged| merged.export(export));
    let vertices = Vertices::new(export);
    let parts = parts(export, &vertices);
    if parts.is_empty() {
        return Err(WriteError::Inconsistent { what: "it has no faces" });
    }
    let polygons = (0..export.faces.count()).any(|f| export.faces.range(f).len() > 3);
    let mut glb = Glb::default();
    let attributes = glb.attributes(export, &vertices)?;
    let mut meshes: BTreeMap<u32, String> = BTreeMap::new();
    for ((group, material), indices) in &parts {
        let accessor = glb.indices(indices, vertices.source.len());
        let primitives = meshes.entry(*group).or_default();
        if !primitives.is_empty() {
            primitives.push(',');
        }
        let _ = write!(primitives, "{{\"attributes\":{{{attributes}}},\"indices\":{accessor}");
        if *material != NONE {
            let _ = write!(primitives, ",\"material\":{material}");
        }
        if polygons {
            primitives.push_str(",\"extensions\":{\"FB_ngon_encoding\":{}}");
        }
        primitives.push('}');
    }
    glb.finish(export, &meshes, polygons)
}

/// The vertices of the file: points, split where texture coordinates differ.
struct Vertices {
    /// The point of each vertex; the first ones are the points themselves.
    source: Vec<u32>,
    /// The texture coordinate of each vertex or [`NONE`]; empty if the export has none.
    uv: Vec<u32>,
    /// The vertex of each corner; empty if it is the corner's point.
    corners: Vec<u32>,
}

impl Vertices {
    fn new(export: &Export<'_>) -> Self {
        /// No face has used the vertex yet.
        const UNSET: u32 = NONE - 1;
        let points = export.points.len();
        let mut vertices = Vertices { source: (0..points as u32).collect(), uv: Vec::new(), corners: Vec::new() };
        let Some((values, uv_corners)) = export.uv else { return vertices };
        vertices.uv = vec![UNSET; points];
        // The next copy of a vertex.
        let mut next = vec![NONE; points];
        let value = |uv: u32| values.get(uv as usize).map(|v| v.map(f32::to_bits));
        for (&point, &uv) in export.faces.corners().iter().zip(uv_corners) {
            let mut vertex = point;
            for tries in 0.. {
                let Some(slot) = vertices.uv.get_mut(vertex as usize) else { break };
                if *slot == UNSET {
                    *slot = uv;
                }
                if *slot == uv || (*slot != NONE && uv != NONE && value(*slot) == value(uv)) {
                    break;
                }
                let following = next.get(vertex as usize).copied().unwrap_or(NONE);
                if following != NONE && tries < TRIES {
                    vertex = following;
                    continue;
                }
                let copy = vertices.source.len() as u32;
                vertices.source.push(point);
                vertices.uv.push(uv);
                next.push(following);
                if let Some(link) = next.get_mut(vertex as usize) {
                    *link = copy;
                }
                vertex = copy;
                break;
            }
            vertices.corners.push(vertex);
        }
        vertices.uv.iter_mut().filter(|uv| **uv == UNSET).for_each(|uv| *uv = NONE);
        vertices
    }
}

/// The triangles of every group and material.
fn parts(export: &Export<'_>, vertices: &Vertices) -> BTreeMap<(u32, u32), Vec<u32>> {
    let corners = if vertices.corners.is_empty() { export.faces.corners() } else { &vertices.corners };
    let mut parts: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    let mut starts: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let plain = export.face_groups.is_empty() && export.face_materials.is_empty();
    let triangles = matches!(export.faces, ExportFaces::Triangles(_));
    if plain && triangles {
        if !corners.is_empty() {
            parts.insert((0, NONE), corners.to_vec());
        }
        return parts;
    }
    for f in 0..export.faces.count() {
        let face = corners.get(export.faces.range(f)).unwrap_or_default();
        if face.len() < 3 {
            continue;
        }
        let key = (export.group(f).unwrap_or(0), export.material(f).unwrap_or(NONE));
        let start = fan_start(export.points, &vertices.source, face, starts.get(&key).copied());
        let at = |i: usize| face.get((start + i) % face.len()).copied().unwrap_or(0);
        starts.insert(key, at(0));
        let out = parts.entry(key).or_default();
        for i in 1..face.len() - 1 {
            out.extend([at(0), at(i), at(i + 1)]);
        }
    }
    parts
}

/// The corner that a polygon's fan starts at: the first whose vertex is not `taken` and whose fan does not fold over; if
/// all fold over, the first that is not taken.
fn fan_start(points: &[[f32; 3]], source: &[u32], face: &[u32], taken: Option<u32>) -> usize {
    let free = |i: &usize| face.get(*i).copied() != taken;
    let first = (0..face.len()).find(free).unwrap_or(0);
    if face.len() == 3 {
        return first;
    }
    let at = |i: usize| -> [f64; 3] {
        let vertex = face.get(i % face.len()).and_then(|v| source.get(*v as usize));
        vertex.and_then(|p| points.get(*p as usize)).map_or([0.0; 3], |p| p.map(f64::from))
    };
    // Newell's normal; a polygon that has none is not worth a search.
    let normal = (0..face.len()).fold([0.0; 3], |sum, i| add(sum, cross(at(i), at(i + 1))));
    let flat = |s: &usize| {
        (1..face.len() - 1).all(|i| {
            let (a, b) = (sub(at(s + i), at(*s)), sub(at(s + i + 1), at(*s)));
            dot(cross(a, b), normal) > 0.0
        })
    };
    (0..face.len().min(TRIES)).filter(free).find(flat).unwrap_or(first)
}

fn add([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + x, b + y, c + z]
}

fn sub([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a - x, b - y, c - z]
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

/// The binary part and the lists of the JSON that grow with it.
#[derive(Default)]
struct Glb {
    binary: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Glb {
    /// Closes a buffer view that began at `start`; gives back its number.
    fn view(&mut self, start: usize, target: Option<u32>) -> usize {
        let length = self.binary.len() - start;
        let target = target.map_or(String::new(), |t| format!(",\"target\":{t}"));
        self.views.push(format!("{{\"buffer\":0,\"byteOffset\":{start},\"byteLength\":{length}{target}}}"));
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: impl Iterator<Item = [f32; N]>, extra: &str) -> usize {
        let start = self.binary.len();
        let mut count = 0usize;
        for value in values {
            value.iter().for_each(|c| self.binary.extend_from_slice(&c.to_le_bytes()));
            count += 1;
        }
        let view = self.view(start, Some(34962));
        self.accessors.push(format!(
            "{{\"bufferView\":{view},\"componentType\":5126,\"count\":{count},\"type\":\"VEC{N}\"{extra}}}"
        ));
        self.accessors.len() - 1
    }

    /// Writes the vertices; gives back the attributes of every primitive.
    fn attributes(&mut self, export: &Export<'_>, vertices: &Vertices) -> Result<String, WriteError> {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for point in export.points {
            if !point.iter().all(|c| c.is_finite()) {
                return Err(WriteError::Inconsistent { what: "a point is not a finite number" });
            }
            for ((low, high), c) in low.iter_mut().zip(&mut high).zip(point) {
                (*low, *high) = (low.min(*c), high.max(*c));
            }
        }
        // As f64, so that the text is the value itself and not the shortest for f32.
        let bound = |v: [f32; 3]| v.map(|c| f64::from(c).to_string()).join(",");
        let bounds = format!(",\"min\":[{}],\"max\":[{}]", bound(low), bound(high));
        let each = |list: &'_ [[f32; 3]]| -> Vec<[f32; 3]> {
            vertices.source.iter().map(|p| list.get(*p as usize).copied().unwrap_or_default()).collect()
        };
        let mut text = format!("\"POSITION\":{}", self.floats(each(export.points).into_iter(), &bounds));
        if let Some(normals) = export.normals {
            // A normal must have unit length; a vertex without any direction gets one.
            let unit = each(normals).into_iter().map(|n| {
                let length = dot(n.map(f64::from), n.map(f64::from)).sqrt();
                if length > 0.0 && length.is_finite() {
                    n.map(|c| (f64::from(c) / length) as f32)
                } else {
                    [0.0, 0.0, 1.0]
                }
            });
            let _ = write!(text, ",\"NORMAL\":{}", self.floats(unit, ""));
        }
        if let Some((values, _)) = export.uv {
            let flipped = vertices.uv.iter().map(|uv| {
                let [u, v] = values.get(*uv as usize).copied().unwrap_or_default();
                [u, 1.0 - v]
            });
            let _ = write!(text, ",\"TEXCOORD_0\":{}", self.floats(flipped, ""));
        }
        if !export.colors.is_empty() {
            let colors = vertices.source.iter().map(|p| export.colors.get(*p as usize).copied().unwrap_or([1.0; 4]));
            let _ = write!(text, ",\"COLOR_0\":{}", self.floats(colors, ""));
        }
        Ok(text)
    }

    fn indices(&mut self, indices: &[u32], vertices: usize) -> usize {
        let start = self.binary.len();
        // The largest 16-bit number is kept for restarting strips.
        let small = vertices <= 65535;
        if small {
            self.binary.extend(indices.iter().flat_map(|i| (*i as u16).to_le_bytes()));
        } else {
            self.binary.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
        }
        let view = self.view(start, Some(34963));
        let (kind, count) = (if small { 5123 } else { 5125 }, indices.len());
        self.accessors
            .push(format!("{{\"bufferView\":{view},\"componentType\":{kind},\"count\":{count},\"type\":\"SCALAR\"}}"));
        self.accessors.len() - 1
    }

    /// The materials, textures and images of the JSON, and whether WebP is among them.
    fn materials(&mut self, export: &Export<'_>) -> (String, bool) {
        let (mut images, mut textures, mut materials) = (Vec::new(), Vec::new(), Vec::new());
        let mut webp = false;
        // The texture of each picture.
        let mut numbers = vec![None; export.images.len()];
        for (image, number) in export.images.iter().zip(&mut numbers) {
            let is_webp = image.mime == "image/webp";
            if export.uv.is_none() || !(is_webp || matches!(image.mime.as_str(), "image/png" | "image/jpeg")) {
                continue;
            }
            let start = self.binary.len();
            self.binary.extend_from_slice(&image.bytes);
            let view = self.view(start, None);
            let source = images.len();
            images.push(format!(
                "{{\"name\":{},\"mimeType\":\"{}\",\"bufferView\":{view}}}",
                quoted(&image.name),
                image.mime
            ));
            *number = Some(textures.len());
            webp |= is_webp;
            textures.push(if is_webp {
                format!("{{\"extensions\":{{\"EXT_texture_webp\":{{\"source\":{source}}}}}}}")
            } else {
                format!("{{\"source\":{source}}}")
            });
        }
        for material in export.materials {
            let [r, g, b, a] = material.base_color;
            let texture = material.texture.and_then(|t| numbers.get(t as usize).copied().flatten());
            let texture = texture.map_or(String::new(), |t| format!(",\"baseColorTexture\":{{\"index\":{t}}}"));
            let alpha = if a < 1.0 { ",\"alphaMode\":\"BLEND\"" } else { "" };
            materials.push(format!(
                "{{\"name\":{},\"pbrMetallicRoughness\":{{\"baseColorFactor\":[{r},{g},{b},{a}],\"metallicFactor\":0,\
                 \"roughnessFactor\":0.8{texture}}},\"doubleSided\":{}{alpha}}}",
                quoted(&material.name),
                material.double_sided
            ));
        }
        let mut json = String::new();
        for (key, list) in [("materials", materials), ("textures", textures), ("images", images)] {
            if !list.is_empty() {
                let _ = write!(json, ",\"{key}\":[{}]", list.join(","));
            }
        }
        (json, webp)
    }

    fn finish(
        mut self,
        export: &Export<'_>,
        meshes: &BTreeMap<u32, String>,
        polygons: bool,
    ) -> Result<Vec<u8>, WriteError> {
        let name = quoted(if export.name.is_empty() { "model" } else { export.name });
        let (materials, webp) = self.materials(export);
        let mut extensions = Vec::new();
        if polygons {
            extensions.push("\"FB_ngon_encoding\"");
        }
        if webp {
            extensions.push("\"EXT_texture_webp\"");
        }
        let mut json = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Limn\"}".to_owned();
        if !extensions.is_empty() {
            let _ = write!(json, ",\"extensionsUsed\":[{}]", extensions.join(","));
        }
        let (mut mesh_list, mut nodes) = (Vec::new(), Vec::new());
        for (number, (group, primitives)) in meshes.iter().enumerate() {
            let group = export.group_names.get(*group as usize).map(|g| quoted(g));
            let label = group.filter(|_| !export.face_groups.is_empty()).unwrap_or_else(|| name.clone());
            mesh_list.push(format!("{{\"name\":{label},\"primitives\":[{primitives}]}}"));
            nodes.push(format!("{{\"name\":{label},\"mesh\":{number}}}"));
        }
        let roots: Vec<String> = (0..nodes.len()).map(|n| n.to_string()).collect();
        let _ = write!(
            json,
            ",\"scene\":0,\"scenes\":[{{\"nodes\":[{}]}}],\"nodes\":[{}],\"meshes\":[{}]{materials},\"accessors\":[{}],\
             \"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
            roots.join(","),
            nodes.join(","),
            mesh_list.join(","),
            self.accessors.join(","),
            self.views.join(","),
            self.binary.len()
        );
        let mut json = json.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + json.len() as u64 + 8 + self.binary.len() as u64;
        let Ok(length) = u32::try_from(total) else { return Err(WriteError::TooLarge { bytes: total }) };
        let mut out = Vec::with_capacity(total as usize);
        out.extend_from_slice(b"glTF");
        out.extend_from_slice(&2u32.to_le_bytes());
        out.extend_from_slice(&length.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.binary)] {
            out.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
            out.extend_from_slice(kind);
            out.extend_from_slice(chunk);
        }
        Ok(out)
    }
}

/// A JSON string.
fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c < ' ' => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
