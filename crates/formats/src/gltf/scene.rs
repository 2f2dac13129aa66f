//! Walking the scene and building the soup.
//!
//! Nodes are visited depth first, children in order. A node that is reached twice is an error: the scene would not be a
//! tree and could go round in circles. Instances (a mesh used by several nodes, or the EXT_mesh_gpu_instancing extension)
//! become copies, each counted against the memory budget before it is made.

use super::{
    accessor::Accessor,
    document::{Node, Primitive, whole},
    material::{Materials, UvUse},
    polygons::{Mode, polygons},
    transform::Transform,
    *,
};
use gltf::json::{
    Index,
    mesh::{Mode as Kind, Semantic},
    validation::Checked,
};

/// Identifies positions already built: transform, position, colour and texture accessors, and the picture's transform.
type BaseKey = ([[u64; 3]; 4], usize, Option<usize>, Option<(usize, [u64; 5])>);

/// Where a primitive's vertices and texture coordinates begin.
#[derive(Clone, Copy)]
struct Base {
    position: u32,
    uv: Option<u32>,
}

pub(super) struct Builder<'s> {
    source: &'s Source<'s>,
    warnings: Warnings,
    materials: Materials<'s>,
    soup: Soup,
    groups: Vec<String>,
    bases: BTreeMap<BaseKey, Base>,
    /// Vertices with a colour.
    colored: usize,
    /// Whether some triangles did not come as polygons.
    triangulated: bool,
    meshes_shown: BTreeSet<usize>,
    /// Meshes placed so far; each is a part that is welded by itself.
    parts: u32,
}

impl<'s> Builder<'s> {
    pub fn new(source: &'s Source<'s>, warnings: Warnings) -> Self {
        Builder {
            source,
            warnings,
            materials: Materials::new(source),
            soup: Soup { offsets: vec![0], ..Soup::default() },
            groups: Vec::new(),
            bases: BTreeMap::new(),
            colored: 0,
            triangulated: false,
            meshes_shown: BTreeSet::new(),
            parts: 0,
        }
    }

    /// Builds all that the scene shows: the file's scene, else its first, else all root nodes, else all meshes.
    pub fn scene(&mut self) -> Result<(), ReadError> {
        let source = self.source;
        let Document { nodes, meshes, scenes, .. } = &source.document;
        let roots = match source.document.scene()? {
            Some(scene) => self.children(&scenes.get(scene)?.nodes, "nodes", format_args!("scenes[{scene}]"))?,
            None => {
                let mut is_child = vec![false; nodes.len()];
                for n in 0..nodes.len() {
                    let list = nodes.get(n)?.json.children.as_deref().unwrap_or_default();
                    for child in self.children(list, "children", format_args!("nodes[{n}]"))? {
                        if let Some(flag) = is_child.get_mut(child) {
                            *flag = true;
                        }
                    }
                }
                (0..nodes.len()).filter(|n| is_child.get(*n) == Some(&false)).collect()
            }
        };
        if nodes.len() == 0 {
            for mesh in 0..meshes.len() {
                self.mesh(mesh, &[Transform::IDENTITY], None)?;
            }
        }
        let mut visited = vec![false; nodes.len()];
        let mut stack: Vec<(usize, Transform)> = roots.into_iter().rev().map(|n| (n, Transform::IDENTITY)).collect();
        while let Some((n, parent)) = stack.pop() {
            let place = format_args!("nodes[{n}]");
            if visited.get(n) != Some(&false) {
                return Err(bad(place, "it is reached twice, but the nodes of a scene must form a tree"));
            }
            if let Some(flag) = visited.get_mut(n) {
                *flag = true;
            }
            let node = nodes.get(n)?;
            let global = parent.after(&node.local);
            if let Some(mesh) = node.json.mesh {
                let mesh = meshes.check(mesh.value(), "mesh", place)?;
                // A skin's joints place its mesh, not the node.
                let global = if node.json.skin.is_some() { Transform::IDENTITY } else { global };
                let instances = self.instances(node, n, &global)?;
                self.mesh(mesh, &instances, node.json.name.as_deref())?;
            }
            let children = self.children(node.json.children.as_deref().unwrap_or_default(), "children", place)?;
            stack.extend(children.into_iter().rev().map(|c| (c, global)));
        }
        let hidden = meshes.len() - self.meshes_shown.len();
        self.warnings.add(WarningKind::OtherScenes, hidden as u64, || None);
        Ok(())
    }

    /// A list of node numbers.
    fn children<T>(
        &self,
        list: &[Index<T>],
        key: &str,
        place: std::fmt::Arguments<'_>,
    ) -> Result<Vec<usize>, ReadError> {
        let count = self.source.document.nodes.len();
        list.iter()
            .map(|child| match child.value() {
                number if number < count => Ok(number),
                number => Err(bad(place, format!("its {key} name node {number}, but the file has only {count}"))),
            })
            .collect()
    }

    /// The transforms of a node's instances; one if it has no instancing extension.
    fn instances(&mut self, node: &Node, n: usize, global: &Transform) -> Result<Vec<Transform>, ReadError> {
        let Some(attributes) = &node.instances else { return Ok(vec![*global]) };
        let place = format_args!("nodes[{n}]");
        let mut count = None;
        let mut get = |key: &str, rest: [f32; 4]| -> Result<Vec<[f32; 4]>, ReadError> {
            let Some(number) = attributes.get(key) else { return Ok(vec![rest]) };
            let number = whole(number).and_then(|n| usize::try_from(n).ok());
            let number = number.ok_or_else(|| bad(place, format!("its {key} is not a whole number")))?;
            let number = self.source.document.accessors.check(number, key, place)?;
            let accessor = Accessor::new(self.source, number)?;
            if *count.get_or_insert(accessor.count) != accessor.count {
                return Err(bad(place, "its instances have unequal numbers of attributes"));
            }
            self.source.budget.borrow_mut().spend("The instances", accessor.count as u64, 16 + 96)?;
            let mut out = Vec::new();
            accessor.floats(0.0, &mut out)?;
            Ok(out)
        };
        let translations = get("TRANSLATION", [0.0; 4])?;
        let rotations = get("ROTATION", [0.0, 0.0, 0.0, 1.0])?;
        let scales = get("SCALE", [1.0; 4])?;
        let at = |list: &[[f32; 4]], i: usize| list.get(i).or(list.first()).copied().unwrap_or_default().map(f64::from);
        let transforms = (0..count.unwrap_or(1)).map(|i| {
            let ([x, y, z, _], [sx, sy, sz, _]) = (at(&translations, i), at(&scales, i));
            global.after(&Transform::from_parts([x, y, z], at(&rotations, i), [sx, sy, sz]))
        });
        Ok(transforms.collect())
    }

    fn mesh(&mut self, number: usize, instances: &[Transform], name: Option<&str>) -> Result<(), ReadError> {
        self.meshes_shown.insert(number);
        let source = self.source;
        let mesh = source.document.meshes.get(number)?;
        let group = self.groups.len() as u32;
        let faces = self.soup.face_count();
        for transform in instances {
            self.parts += 1;
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                let place = format_args!("meshes[{number}].primitives[{p}]");
                let primitive = primitive.as_ref().map_err(|problem| bad(place, problem))?;
                self.primitive(primitive, place, transform)?;
            }
        }
        if self.soup.face_count() > faces {
            let name = name.or(mesh.name.as_deref()).filter(|n| !n.is_empty());
            self.groups.push(name.map_or_else(|| format!("mesh {number}"), str::to_owned));
            self.soup.face_groups.resize(self.soup.face_count(), group);
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        place: std::fmt::Arguments<'_>,
        transform: &Transform,
    ) -> Result<(), ReadError> {
        let json = &primitive.json;
        let mode = match json.mode {
            Checked::Valid(Kind::Points | Kind::Lines | Kind::LineLoop | Kind::LineStrip) => {
                self.warnings.add(WarningKind::PointOrLinePrimitives, 1, || Some(format!("first {place}")));
                return Ok(());
            }
            Checked::Valid(Kind::Triangles) if primitive.polygons => Mode::Polygons,
            Checked::Valid(Kind::Triangles) => Mode::List,
            Checked::Valid(Kind::TriangleStrip) => Mode::Strip,
            Checked::Valid(Kind::TriangleFan) => Mode::Fan,
            Checked::Invalid => return Err(bad(place, "its mode is none that glTF has")),
        };
        let source = self.source;
        let Document { accessors, materials, .. } = &source.document;
        let Some(positions) = json.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.warnings.add(WarningKind::NoPositions, 1, || Some(format!("first {place}")));
            return Ok(());
        };
        let positions = accessors.check(positions.value(), "POSITION", place)?;
        if primitive.draco && accessors.get(positions)?.buffer_view.is_none() {
            let name = "KHR_draco_mesh_compression".to_owned();
            return Err(ReadError::Extension { name, advice: "export the model without Draco compression" });
        }
        let (material, uv_use) = match json.material {
            Some(number) => {
                let number = materials.check(number.value(), "material", place)?;
                self.materials.get(number, &mut self.warnings)?
            }
            None => (NONE, UvUse { set: 0, transform: None }),
        };
        let indices = match json.indices {
            Some(number) => {
                let number = accessors.check(number.value(), "indices", place)?;
                let accessor = Accessor::new(source, number)?;
                // The list itself, and the corners with their texture coordinates made of it.
                source.budget.borrow_mut().spend("The model", accessor.count as u64, 4)?;
                Some((number, accessor.integers()?))
            }
            None => None,
        };
        let texture = format!("TEXCOORD_{}", uv_use.set);
        self.count_attributes(primitive, &texture);
        let (base, count) = self.vertices(primitive, (positions, &texture, uv_use), transform, place)?;
        let indices = match indices {
            Some((number, indices)) => {
                if let Some(at) = indices.iter().position(|i| *i as usize >= count) {
                    let vertex = indices.get(at).copied().unwrap_or(0);
                    let problem = format!("element {at} names vertex {vertex}, but {place} has only {count}");
                    return Err(bad(format_args!("accessors[{number}]"), problem));
                }
                indices
            }
            None => {
                source.budget.borrow_mut().spend("The model", count as u64, 4)?;
                (0..count as u32).collect()
            }
        };
        self.faces(&indices, mode, transform.mirrors(), base, material, place)
    }

    fn faces(
        &mut self,
        indices: &[u32],
        mode: Mode,
        mirrored: bool,
        base: Base,
        material: u32,
        place: std::fmt::Arguments<'_>,
    ) -> Result<(), ReadError> {
        // A corner, its texture coordinate, and a third each of an offset, a group and a material; strips give thrice.
        let corners = indices.len() as u64 * if matches!(mode, Mode::Strip | Mode::Fan) { 3 } else { 1 };
        self.source.budget.borrow_mut().spend("The model", corners, 12)?;
        if self.soup.corners.len() as u64 + corners >= u64::from(NONE) {
            return Err(bad(place, "the model has more corners than 32 bits can number"));
        }
        let soup = &mut self.soup;
        let faces_before = soup.face_count();
        if base.uv.is_some() || !soup.uv_corners.is_empty() {
            soup.uv_corners.resize(soup.corners.len(), NONE);
        }
        let with_uvs = base.uv.is_some() || !soup.uv_corners.is_empty();
        let mut face = |polygon: &[u32]| {
            let mut corner = |c: &u32| {
                soup.corners.push(base.position + c);
                if with_uvs {
                    soup.uv_corners.push(base.uv.map_or(NONE, |uv| uv + c));
                }
            };
            match polygon {
                // The first corner stays first.
                [first, rest @ ..] if mirrored => {
                    corner(first);
                    rest.iter().rev().for_each(corner);
                }
                _ => polygon.iter().for_each(corner),
            }
            soup.offsets.push(soup.corners.len() as u32);
        };
        let (leftover, broken) = polygons(mode, indices, &mut face);
        if material != NONE || !soup.face_materials.is_empty() {
            soup.face_materials.resize(faces_before, NONE);
            soup.face_materials.resize(soup.face_count(), material);
        }
        self.triangulated |= mode != Mode::Polygons && soup.face_count() > faces_before;
        if leftover {
            self.warnings.add(WarningKind::LeftoverIndices, 1, || Some(format!("first {place}")));
        }
        if broken {
            self.warnings.add(WarningKind::PolygonEncoding, 1, || Some(format!("first {place}")));
        }
        Ok(())
    }

    fn count_attributes(&mut self, primitive: &Primitive, texture: &str) {
        self.warnings.add(WarningKind::MorphTargets, primitive.targets as u64, || None);
        for key in &primitive.names {
            let skin = key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_");
            if !skin && !matches!(key.as_str(), "POSITION" | "NORMAL" | "COLOR_0") && key != texture {
                self.warnings.add(WarningKind::Attributes, 1, || Some(format!("such as {}", short(key))));
            }
        }
    }

    /// The base of a primitive's vertices, and how many there are; builds them unless they are there already.
    fn vertices(
        &mut self,
        primitive: &Primitive,
        (positions, texture, uv_use): (usize, &str, UvUse),
        transform: &Transform,
        place: std::fmt::Arguments<'_>,
    ) -> Result<(Base, usize), ReadError> {
        let source = self.source;
        let attributes = &primitive.json.attributes;
        let accessor = Accessor::new(source, positions)?;
        let count = accessor.count;
        if accessor.width != 3 {
            return Err(bad(format_args!("accessors[{positions}]"), "positions must have three components"));
        }
        let mut optional = |semantic, key: &str, widths: std::ops::RangeInclusive<usize>| {
            let broken = primitive.broken.iter().find(|(name, _)| name == key);
            let (shown, found) = match (attributes.get(&Checked::Valid(semantic)), broken) {
                // A colour or texture coordinate that cannot be read is no reason to refuse the shape; a missing file is.
                (Some(number), _) => match Accessor::new(source, number.value()) {
                    Err(error @ (ReadError::MissingFile { .. } | ReadError::TooBig { .. })) => return Err(error),
                    found => (number.to_string(), found.ok().map(|a| (number.value(), a))),
                },
                (None, Some((_, shown))) => (shown.clone(), None),
                (None, None) => return Ok(None),
            };
            let found = found.filter(|(_, a)| a.count == count && widths.contains(&a.width));
            if found.is_none() {
                let place = || Some(format!("first {key} {shown} of {place}"));
                self.warnings.add(WarningKind::AttributeBroken, 1, place);
            }
            Ok(found)
        };
        let uv = optional(Semantic::TexCoords(uv_use.set), texture, 2..=2)?;
        let color = optional(Semantic::Colors(0), "COLOR_0", 3..=4)?;
        let turn = uv_use.transform.map_or([0; 5], |([a, b], r, [c, d])| [a, b, r, c, d].map(f64::to_bits));
        let key = (transform.key(), positions, color.as_ref().map(|c| c.0), uv.as_ref().map(|u| (u.0, turn)));
        if let Some(base) = self.bases.get(&key) {
            return Ok((*base, count));
        }
        let size = 16 + if uv.is_some() { 8 } else { 0 } + if color.is_some() { 16 } else { 0 };
        source.budget.borrow_mut().spend("The model", count as u64, size)?;
        let start = self.soup.positions.len();
        if start as u64 + count as u64 >= u64::from(NONE)
            || self.soup.uvs.len() as u64 + count as u64 >= u64::from(NONE)
        {
            return Err(bad(place, "the model has more vertices than 32 bits can number"));
        }
        self.positions(&accessor, positions, transform)?;
        self.soup.parts.resize(self.soup.positions.len(), self.parts - 1);
        if let Some((number, accessor)) = &color {
            self.colors(accessor, *number, start)?;
        }
        let uv_start = self.soup.uvs.len() as u32;
        if let Some((_, accessor)) = &uv {
            self.texture_coordinates(accessor, uv_use)?;
        }
        if primitive.names.iter().any(|name| name == "NORMAL") {
            self.warnings.add(WarningKind::Normals, count as u64, || None);
        }
        let base = Base { position: start as u32, uv: uv.map(|_| uv_start) };
        self.bases.insert(key, base);
        Ok((base, count))
    }

    fn positions(&mut self, accessor: &Accessor<'_>, number: usize, transform: &Transform) -> Result<(), ReadError> {
        let start = self.soup.positions.len();
        accessor.floats(0.0, &mut self.soup.positions)?;
        let identity = *transform == Transform::IDENTITY;
        for (i, position) in self.soup.positions.iter_mut().skip(start).enumerate() {
            let finite = position.iter().all(|c| c.is_finite());
            if finite && !identity {
                *position = transform.point(position.map(f64::from)).map(|c| c as f32);
            }
            if !position.iter().all(|c| c.is_finite()) {
                let why = if finite {
                    "leaves the range of numbers when its node moves it"
                } else {
                    "is not a finite number"
                };
                return Err(bad(format_args!("accessors[{number}]"), format!("the position of element {i} {why}")));
            }
        }
        Ok(())
    }

    fn colors(&mut self, accessor: &Accessor<'_>, number: usize, start: usize) -> Result<(), ReadError> {
        if self.soup.colors.is_empty() {
            self.source.budget.borrow_mut().spend("The model", start as u64, 16)?;
        }
        self.soup.colors.resize(start, [1.0; 4]);
        accessor.floats(1.0, &mut self.soup.colors)?;
        self.colored += accessor.count;
        let mut clamped = 0;
        for color in self.soup.colors.iter_mut().skip(start) {
            let within = color.map(|c| if c.is_nan() { 1.0 } else { c.clamp(0.0, 1.0) });
            clamped += u64::from(within != *color);
            *color = within;
        }
        self.warnings.add(WarningKind::ColorRange, clamped, || Some(format!("first in accessors[{number}]")));
        Ok(())
    }

    fn texture_coordinates(&mut self, accessor: &Accessor<'_>, uv_use: UvUse) -> Result<(), ReadError> {
        let start = self.soup.uvs.len();
        accessor.floats(0.0, &mut self.soup.uvs)?;
        let mut bad = 0;
        let (sin, cos) = uv_use.transform.map_or((0.0, 1.0), |(_, r, _)| (libm::sin(r), libm::cos(r)));
        for uv in self.soup.uvs.iter_mut().skip(start) {
            if !uv.iter().all(|c| c.is_finite()) {
                *uv = [0.0; 2];
                bad += 1;
            }
            let mut moved = uv.map(f64::from);
            if let Some(([ox, oy], _, [sx, sy])) = uv_use.transform {
                let [u, v] = moved;
                let (u, v) = (u * sx, v * sy);
                moved = [cos * u + sin * v + ox, cos * v - sin * u + oy];
            }
            let [u, v] = moved;
            // glTF counts v down from the top of the picture.
            *uv = [u as f32, (1.0 - v) as f32];
        }
        self.warnings.add(WarningKind::UvNotFinite, bad, || None);
        Ok(())
    }

    pub fn finish(mut self) -> Result<(Model, Vec<Warning>), ReadError> {
        let file = self.source.file;
        if self.soup.face_count() == 0 {
            let meshes = self.source.document.meshes.len();
            let found = match (meshes, self.meshes_shown.len()) {
                (0, _) => "it has no meshes".to_owned(),
                (_, 0) => "no node of its scene shows a mesh".to_owned(),
                _ => "its meshes have no triangles".to_owned(),
            };
            return Err(ReadError::NoFaces { file: file.to_owned(), found });
        }
        let vertices = self.soup.positions.len();
        if !self.soup.colors.is_empty() {
            self.source.budget.borrow_mut().spend("The model", (vertices - self.soup.colors.len()) as u64, 16)?;
            self.soup.colors.resize(vertices, [1.0; 4]);
            let missing = vertices.saturating_sub(self.colored);
            self.warnings.add(WarningKind::ColorMissing, missing as u64, || None);
        }
        if !self.soup.face_materials.is_empty() {
            self.soup.face_materials.resize(self.soup.face_count(), NONE);
        }
        if self.soup.parts.first() == self.soup.parts.last() {
            self.soup.parts.clear();
        }
        // One group says nothing.
        if self.groups.len() < 2 {
            self.groups.clear();
            self.soup.face_groups.clear();
        }
        let model = Model {
            name: model_name(file),
            soup: self.soup,
            groups: self.groups,
            materials: self.materials.out,
            images: self.materials.pictures,
            triangulated: self.triangulated,
            weld: Weld::Exact,
        };
        Ok((model, self.warnings.finish()))
    }
}
