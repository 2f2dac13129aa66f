//! Models and exports as plain bytes, for a reader and a writer that live in a module of their own.
//!
//! A page should not have to load every file format before it draws its first picture. So the readers and writers can be
//! compiled apart and loaded when a file arrives, and what passes between the two modules is one buffer:
//!
//! ```text
//!   file bytes ── read, pack ──> | name | stamp | model or message |  ── unpack ──> Parcel
//!   level      ── pack_export ─> | arrays, names, pictures |          ── unpack_export, write_obj / write_glb ──> files
//! ```
//!
//! The bytes are [`limn_mesh::pack`]'s, and like there the layout is private to one build: it is never stored. Unpacking
//! checks every length and never panics. Cost: one copy each way.

use limn_mesh::pack::{Damaged, Read, Reader, Writer};
use limn_mesh::{Marks, Soup, Weld};

use crate::{Export, ExportFaces, Image, Material, Model, Origin};

/// A sentence about a model, and whether a page may fold it away.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    /// Whether it is ordinary.
    pub minor: bool,
}

impl From<&crate::Warning> for Notice {
    fn from(warning: &crate::Warning) -> Self {
        Notice { text: warning.to_string(), minor: warning.is_minor() }
    }
}

/// What reading a file came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Parcel {
    /// The file that was read.
    pub name: String,
    /// Its length in bytes.
    pub size: u64,
    /// A hash of its bytes, the reader's choice.
    pub hash: u64,
    /// The model and what there is to say about it, or why there is none.
    pub result: Result<(Model, Vec<Notice>), String>,
}

impl Parcel {
    /// The parcel as bytes.
    pub fn pack(&self) -> Vec<u8> {
        let mut out = Writer::default();
        out.text(&self.name);
        out.array(&[self.size, self.hash]);
        match &self.result {
            Ok((model, notices)) => {
                out.number(1);
                put_model(&mut out, model);
                out.list(notices, |out, n| {
                    out.text(&n.text);
                    out.number(n.minor.into());
                });
            }
            Err(message) => {
                out.number(0);
                out.text(message);
            }
        }
        out.finish()
    }

    /// The parcel that these bytes are.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn unpack(bytes: &[u8]) -> Result<Parcel, Damaged> {
        let mut from = Reader::new(bytes);
        let name = from.text()?;
        let [size, hash] = from.exactly::<u64, 2>()?;
        let result = match from.number()? {
            1 => {
                let model = model(&mut from)?;
                let notices = from.list(|f| Ok(Notice { text: f.text()?, minor: f.number()? == 1 }))?;
                Ok((model, notices))
            }
            _ => Err(from.text()?),
        };
        Ok(Parcel { name, size, hash, result })
    }
}

/// An export that owns its arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packed {
    name: String,
    points: Vec<[f32; 3]>,
    /// Whether there is an origin, level, positions and order; and its sources.
    origin: [u32; 4],
    sources: Vec<u32>,
    offsets: Vec<u32>,
    corners: Vec<u32>,
    degree: u32,
    normals: Option<Vec<[f32; 3]>>,
    uv: Option<(Vec<[f32; 2]>, Vec<u32>)>,
    colors: Vec<[f32; 4]>,
    face_groups: Vec<u32>,
    group_names: Vec<String>,
    face_materials: Vec<u32>,
    materials: Vec<Material>,
    images: Vec<Image>,
}

/// An export as bytes.
pub fn pack_export(export: &Export<'_>) -> Vec<u8> {
    let mut out = Writer::default();
    out.text(export.name);
    out.array(export.points);
    let origin = export.origin.as_ref();
    out.array(&origin.map_or([0; 4], |o| [1, o.level, o.positions, o.in_order.into()]));
    out.array(origin.map_or(&[][..], |o| o.sources));
    let (degree, offsets) = match export.faces {
        ExportFaces::Polygons { offsets, .. } => (0, offsets),
        ExportFaces::Triangles(_) => (3, &[][..]),
        ExportFaces::Quads(_) => (4, &[][..]),
    };
    out.number(degree);
    out.array(offsets);
    out.array(export.faces.corners());
    out.number(export.normals.is_some().into());
    out.array(export.normals.unwrap_or_default());
    out.number(export.uv.is_some().into());
    let (values, corners) = export.uv.unwrap_or_default();
    out.array(values);
    out.array(corners);
    out.array(export.colors);
    out.array(export.face_groups);
    out.list(export.group_names, |out, name| out.text(name));
    out.array(export.face_materials);
    out.list(export.materials, put_material);
    out.list(export.images, put_image);
    out.finish()
}

/// The export that these bytes are.
///
/// # Errors
/// [`Damaged`].
pub fn unpack_export(bytes: &[u8]) -> Result<Packed, Damaged> {
    let mut from = Reader::new(bytes);
    Ok(Packed {
        name: from.text()?,
        points: from.array()?,
        origin: from.exactly()?,
        sources: from.array()?,
        degree: from.number()?,
        offsets: from.array()?,
        corners: from.array()?,
        normals: from.option(Reader::array)?,
        uv: from.option(|f| Ok((f.array()?, f.array()?)))?,
        colors: from.array()?,
        face_groups: from.array()?,
        group_names: from.list(Reader::text)?,
        face_materials: from.array()?,
        materials: from.list(material)?,
        images: from.list(image)?,
    })
}

impl Packed {
    /// The export, for a writer.
    pub fn export(&self) -> Export<'_> {
        Export {
            name: &self.name,
            points: &self.points,
            origin: match self.origin {
                [0, ..] => None,
                [_, level, positions, order] => {
                    Some(Origin { level, sources: &self.sources, positions, in_order: order == 1 })
                }
            },
            faces: match self.degree {
                3 => ExportFaces::Triangles(&self.corners),
                4 => ExportFaces::Quads(&self.corners),
                _ => ExportFaces::Polygons { offsets: &self.offsets, corners: &self.corners },
            },
            normals: self.normals.as_deref(),
            uv: self.uv.as_ref().map(|(values, corners)| (&values[..], &corners[..])),
            colors: &self.colors,
            face_groups: &self.face_groups,
            group_names: &self.group_names,
            face_materials: &self.face_materials,
            materials: &self.materials,
            images: &self.images,
        }
    }
}

fn put_material(out: &mut Writer, m: &Material) {
    out.text(&m.name);
    out.array(&m.base_color);
    out.number(m.texture.map_or(0, |t| t.wrapping_add(1)));
    out.number(m.double_sided.into());
}

fn put_image(out: &mut Writer, i: &Image) {
    out.text(&i.name);
    out.text(&i.mime);
    out.bytes(&i.bytes);
}

fn put_model(out: &mut Writer, m: &Model) {
    out.text(&m.name);
    let s = &m.soup;
    out.array(&s.positions);
    out.array(&s.parts);
    out.array(&s.offsets);
    out.array(&s.corners);
    out.array(&s.uvs);
    out.array(&s.uv_corners);
    out.array(&s.colors);
    out.array(&s.face_groups);
    out.array(&s.face_materials);
    let marks = &s.marks;
    out.list(&marks.creases, |out, (edge, sharpness)| out.array(&[edge[0], edge[1], sharpness.to_bits()]));
    out.list(&marks.corners, |out, (vertex, sharpness)| out.array(&[*vertex, sharpness.to_bits()]));
    out.array(&marks.holes);
    out.list(&marks.knots, |out, (edge, interval)| out.array(&[edge[0], edge[1], interval.to_bits()]));
    out.list(&m.groups, |out, name| out.text(name));
    out.list(&m.materials, put_material);
    out.list(&m.images, put_image);
    out.number(m.triangulated.into());
    let (kind, fraction) = match m.weld {
        Weld::Off => (0, 0.0),
        Weld::Exact => (1, 0.0),
        Weld::Relative(fraction) => (2, fraction),
    };
    out.number(kind);
    out.number(fraction.to_bits());
}

fn material(from: &mut Reader<'_>) -> Read<Material> {
    Ok(Material {
        name: from.text()?,
        base_color: from.exactly()?,
        texture: from.number()?.checked_sub(1),
        double_sided: from.number()? == 1,
    })
}

fn image(from: &mut Reader<'_>) -> Read<Image> {
    Ok(Image { name: from.text()?, mime: from.text()?, bytes: from.bytes()?.to_vec() })
}

fn model(from: &mut Reader<'_>) -> Read<Model> {
    Ok(Model {
        name: from.text()?,
        soup: Soup {
            positions: from.array()?,
            parts: from.array()?,
            offsets: from.array()?,
            corners: from.array()?,
            uvs: from.array()?,
            uv_corners: from.array()?,
            colors: from.array()?,
            face_groups: from.array()?,
            face_materials: from.array()?,
            marks: Marks {
                creases: from.list(|f| f.exactly().map(|[a, b, s]| ([a, b], f32::from_bits(s))))?,
                corners: from.list(|f| f.exactly().map(|[v, s]| (v, f32::from_bits(s))))?,
                holes: from.array()?,
                knots: from.list(|f| f.exactly().map(|[a, b, d]| ([a, b], f32::from_bits(d))))?,
            },
        },
        groups: from.list(Reader::text)?,
        materials: from.list(material)?,
        images: from.list(image)?,
        triangulated: from.number()? == 1,
        weld: match (from.number()?, f32::from_bits(from.number()?)) {
            (0, _) => Weld::Off,
            (1, _) => Weld::Exact,
            (_, fraction) => Weld::Relative(fraction),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, read, write_glb, write_obj};

    fn parcel() -> Parcel {
        let obj =
            b"mtllib m.mtl\no one\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0.5 1 1 1\nvt 0 0\nvt 1 1\n\
            usemtl red\ng left right\nf 1/1 2/2 3/1 4/2\nf 1 2 3\nt crease 2/1/0 0 1 2.5\nt corner 1/1/0 3 4\nl 1 2\n";
        let files = vec![("m.mtl".to_owned(), b"newmtl red\nKd 1 0.5 0\nmap_Kd a.png\n".to_vec())];
        let (mut model, warnings) = read("a.obj", obj, &files, &Limits::default()).unwrap();
        model.images.push(Image { name: "a.png".into(), mime: "image/png".into(), bytes: vec![1, 2, 3, 4, 5] });
        model.weld = Weld::Relative(1e-4);
        (model.soup.marks.holes, model.soup.marks.knots) = (vec![1], vec![([0, 1], 2.5)]);
        let notices = warnings.iter().map(Notice::from).collect::<Vec<_>>();
        assert!(!notices.is_empty() && !model.soup.marks.creases.is_empty() && !model.soup.marks.corners.is_empty());
        Parcel { name: "a.obj".into(), size: 1 << 40, hash: u64::MAX - 1, result: Ok((model, notices)) }
    }

    #[test]
    fn everything_comes_back() {
        let parcel = parcel();
        assert_eq!(Parcel::unpack(&parcel.pack()), Ok(parcel));
        let refused = Parcel { name: "b".into(), size: 0, hash: 0, result: Err("It is empty.".into()) };
        assert_eq!(Parcel::unpack(&refused.pack()), Ok(refused));
    }

    #[test]
    fn exports_are_written_the_same() {
        let (model, _) = parcel().result.unwrap();
        let normals = vec![[0.0, 0.0, 1.0]; 4];
        let export = Export { normals: Some(&normals), ..Export::from_model(&model) };
        let packed = unpack_export(&pack_export(&export)).unwrap();
        assert_eq!(write_obj(&packed.export()), write_obj(&export));
        assert_eq!(write_glb(&packed.export()), write_glb(&export));
        let quads = Export { faces: ExportFaces::Quads(&[0, 1, 2, 3]), points: &normals, ..Export::default() };
        let packed = unpack_export(&pack_export(&quads)).unwrap();
        assert_eq!(write_obj(&packed.export()), write_obj(&quads));
    }

    #[test]
    fn damage_is_noticed_and_never_panics() {
        let whole = parcel().pack();
        for cut in 0..whole.len() {
            assert_eq!(Parcel::unpack(&whole[..cut]), Err(Damaged), "cut at {cut}");
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x81;
            let _ = Parcel::unpack(&bytes);
            let _ = unpack_export(&bytes);
        }
    }
}
