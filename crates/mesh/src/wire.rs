//! Meshes, plans and levels as bytes, for a kernel that lives in a module of its own.
//!
//! A page should not have to load the rules of every scheme before it draws its first picture. A build without the feature
//! `full` has the common ones; the others are in a second module, which is loaded when a plan needs it ([`Plan::is_here`]):
//!
//! ```text
//!   page's module                      module with every scheme
//!   mesh.pack()  ── once a mesh ──>    Mesh::unpack
//!   plan.pack()  ── each time   ──>    Plan::unpack, Job::new, step ...
//!   Refined::unpack  <───────────      refined.pack()
//! ```
//!
//! The bytes are [`crate::pack`]'s. Unpacking checks lengths and numbers of kinds; that indices are in range it takes on
//! trust. Every structure is taken apart by name, so a field that is added does not compile until it is sent as well.
//! Cost: one copy each way.

use crate::fairing::Fairing;
use crate::mesh::{Mesh, UvChannel};
use crate::pack::{Damaged, Read, Reader, Writer};
use crate::plan::{Plan, Run};
use crate::refined::{Faces, Refined, UvValues};
use crate::scheme::{Boundary, Decay, FaceVarying, MOST_PARAMS, Params, Rules, TriangleRule, scheme};
use crate::split::{FaceKind, FaceShape, Split, Triangles};
use crate::topology::{Counts, Topology};
use std::sync::Arc;

impl Mesh {
    /// The mesh as bytes.
    pub fn pack(&self) -> Vec<u8> {
        let Mesh {
            topology,
            positions,
            colors,
            uv,
            sharp,
            joined,
            tied,
            edge_sharpness,
            vertex_sharpness,
            holes,
            knots,
            vertex_source,
            face_source,
            weld_class,
            one_sided,
            counts,
            shape,
        } = self;
        let mut out = Writer::default();
        put_topology(&mut out, topology);
        out.array(positions);
        out.array(colors);
        out.number(uv.is_some().into());
        if let Some(UvChannel { topology, values, counts }) = uv {
            put_topology(&mut out, topology);
            out.array(values);
            put_counts(&mut out, counts);
        }
        out.flags(sharp);
        out.flags(joined);
        out.array(tied);
        for array in [edge_sharpness, vertex_sharpness, knots] {
            out.array(array);
        }
        out.flags(holes);
        for array in [vertex_source, face_source, weld_class] {
            out.array(array);
        }
        out.number((*one_sided).into());
        put_counts(&mut out, counts);
        out.number(*shape as u32);
        out.finish()
    }

    /// The mesh that these bytes are.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn unpack(bytes: &[u8]) -> Read<Mesh> {
        let mut from = Reader::new(bytes);
        Ok(Mesh {
            topology: topology(&mut from)?,
            positions: from.array()?,
            colors: from.array()?,
            uv: match from.number()? {
                0 => None,
                _ => Some(UvChannel {
                    topology: topology(&mut from)?,
                    values: from.array()?,
                    counts: counts(&mut from)?,
                }),
            },
            sharp: from.flags()?,
            joined: from.flags()?,
            tied: from.array()?,
            edge_sharpness: from.array()?,
            vertex_sharpness: from.array()?,
            knots: from.array()?,
            holes: from.flags()?,
            vertex_source: from.array()?,
            face_source: from.array()?,
            weld_class: from.array()?,
            one_sided: from.number()? == 1,
            counts: counts(&mut from)?,
            shape: one_of(&mut from, &[FaceShape::Triangles, FaceShape::Quads, FaceShape::Polygons])?,
        })
    }
}

impl Plan {
    /// The plan as bytes.
    pub fn pack(&self) -> Vec<u8> {
        let Plan { scheme, params, later, rules, fairings, limit, level } = self;
        let Rules { boundary, decay, triangle, face_varying } = *rules;
        let mut out = Writer::default();
        put_run(&mut out, &Run { from: 0, scheme, params: *params });
        out.list(later, put_run);
        for kind in [boundary as u32, decay as u32, triangle as u32, face_varying as u32] {
            out.number(kind);
        }
        out.list(fairings, |out, Fairing { at, iterations }| out.array(&[*at, *iterations]));
        out.number((*limit).into());
        out.number(*level);
        out.finish()
    }

    /// The plan that these bytes are.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn unpack(bytes: &[u8]) -> Read<Plan> {
        use FaceVarying as F;
        let mut from = Reader::new(bytes);
        let first = run(&mut from)?;
        let sets = [F::None, F::CornersOnly, F::CornersPlus1, F::CornersPlus2, F::Boundaries, F::All];
        Ok(Plan {
            scheme: first.scheme,
            params: first.params,
            later: from.list(run)?,
            rules: Rules {
                boundary: one_of(&mut from, &[Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner])?,
                decay: one_of(&mut from, &[Decay::Uniform, Decay::Chaikin])?,
                triangle: one_of(&mut from, &[TriangleRule::CatmullClark, TriangleRule::Smooth])?,
                face_varying: one_of(&mut from, &sets)?,
            },
            fairings: from.list(|f| f.exactly().map(|[at, iterations]| Fairing { at, iterations }))?,
            limit: from.number()? == 1,
            level: from.number()?,
        })
    }
}

impl Refined {
    /// The level as bytes, without the mesh. Memory: what has been written is let go at once.
    pub fn pack(self) -> Vec<u8> {
        let Refined {
            level,
            counts,
            hidden,
            points,
            faces,
            uv,
            colors,
            parent_ranges,
            vertex_parents,
            known_normals,
            kinds,
            source,
            split,
            mesh: _,
        } = self;
        let mut out = Writer::default();
        out.number(level);
        put_counts(&mut out, &counts);
        out.array(&[hidden]);
        out.array(&points);
        drop(points);
        let (degree, offsets, corners) = match faces {
            Faces::Polygons { offsets, corners } => (0, offsets, corners),
            Faces::Triangles(corners) => (3, Vec::new(), corners),
            Faces::Quads(corners) => (4, Vec::new(), corners),
        };
        out.number(degree);
        out.array(&offsets);
        out.array(&corners);
        drop((offsets, corners));
        out.number(uv.is_some().into());
        if let Some(UvValues { values, corners }) = uv {
            out.array(&values);
            out.array(&corners);
        }
        out.array(&colors);
        out.number(parent_ranges.is_some().into());
        out.array(&parent_ranges.unwrap_or_default());
        out.number(vertex_parents);
        out.number(known_normals.is_some().into());
        out.array(&known_normals.unwrap_or_default());
        out.bytes(&kinds.iter().map(|&kind| kind as u8).collect::<Vec<_>>());
        out.array(&source);
        put_split(&mut out, split);
        out.finish()
    }

    /// The level of `mesh` that these bytes are.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn unpack(bytes: &[u8], mesh: Arc<Mesh>) -> Read<Refined> {
        let mut from = Reader::new(bytes);
        Ok(Refined {
            level: from.number()?,
            counts: counts(&mut from)?,
            hidden: from.exactly::<u64, 1>()?[0],
            points: from.array()?,
            faces: match (from.number()?, from.array()?, from.array()?) {
                (0, offsets, corners) => Faces::Polygons { offsets, corners },
                (3, _, corners) => Faces::Triangles(corners),
                (_, _, corners) => Faces::Quads(corners),
            },
            uv: match from.number()? {
                0 => None,
                _ => Some(UvValues { values: from.array()?, corners: from.array()? }),
            },
            colors: from.array()?,
            parent_ranges: from.option(Reader::exactly)?,
            vertex_parents: from.number()?,
            known_normals: from.option(Reader::array)?,
            kinds: from
                .bytes()?
                .iter()
                .map(|&b| {
                    [FaceKind::Face, FaceKind::Edge, FaceKind::Vertex].get(usize::from(b)).copied().ok_or(Damaged)
                })
                .collect::<Read<_>>()?,
            source: from.array()?,
            split: split(&mut from)?,
            mesh,
        })
    }
}

/// One of these, by its place among them.
fn one_of<T: Copy>(from: &mut Reader<'_>, all: &[T]) -> Read<T> {
    all.get(from.number()? as usize).copied().ok_or(Damaged)
}

fn put_run(out: &mut Writer, run: &Run) {
    let Run { from, scheme, params } = run;
    out.number(*from);
    out.text(scheme.info.id);
    // What was not set is no number, which no parameter can be.
    out.array(&std::array::from_fn::<f64, MOST_PARAMS, _>(|at| params.get(at).unwrap_or(f64::NAN)));
}

fn run(from: &mut Reader<'_>) -> Read<Run> {
    let (begin, id) = (from.number()?, from.text()?);
    let scheme = scheme(&id).ok_or(Damaged)?;
    let mut params = Params::default();
    for (at, value) in (0..).zip(from.exactly::<f64, MOST_PARAMS>()?) {
        params.set(&scheme.info, at, value);
    }
    Ok(Run { from: begin, scheme, params })
}

fn put_counts(out: &mut Writer, c: &Counts) {
    let Counts {
        vertices,
        edges,
        faces,
        corners,
        boundary,
        triangles: [three_sided, sides],
        rim: [one, two, three, more],
        tips,
        digons,
        chains,
    } = *c;
    out.array(&[vertices, edges, faces, corners, boundary, three_sided, sides, one, two, three, more, tips, digons]);
    out.array(&chains);
}

fn put_topology(out: &mut Writer, t: &Topology) {
    let Topology { offsets, twin, origin, edge, face, vertex_half_edge, edge_half_edge, boundary } = t;
    for array in [offsets, twin, origin, edge, face, vertex_half_edge, edge_half_edge, boundary] {
        out.array(array);
    }
}

fn put_split(out: &mut Writer, split: Split) {
    let (kind, more) = match split {
        Split::Quad => (0, 0),
        Split::Triangle => (1, 0),
        Split::Dual { rounded } => (2, u32::from(rounded)),
        Split::Sqrt3 { trisect } => (3, u32::from(trisect)),
        Split::Mixed => (4, 0),
        Split::MidEdge { cut, corners } => (5, u32::from(cut) + 2 * u32::from(corners)),
        Split::Poke => (6, 0),
        Split::NWay { n, triangles } => (7 + triangles as u32, n),
    };
    out.array(&[kind, more]);
}

fn counts(from: &mut Reader<'_>) -> Read<Counts> {
    let [vertices, edges, faces, corners, boundary, three_sided, sides, one, two, three, more, tips, digons] =
        from.exactly()?;
    let chains = from.exactly()?;
    Ok(Counts {
        vertices,
        edges,
        faces,
        corners,
        boundary,
        triangles: [three_sided, sides],
        rim: [one, two, three, more],
        tips,
        digons,
        chains,
    })
}

fn topology(from: &mut Reader<'_>) -> Read<Topology> {
    Ok(Topology {
        offsets: from.array()?,
        twin: from.array()?,
        origin: from.array()?,
        edge: from.array()?,
        face: from.array()?,
        vertex_half_edge: from.array()?,
        edge_half_edge: from.array()?,
        boundary: from.array()?,
    })
}

fn split(from: &mut Reader<'_>) -> Read<Split> {
    let [kind, more] = from.exactly::<u32, 2>()?;
    match kind {
        0 => Ok(Split::Quad),
        1 => Ok(Split::Triangle),
        2 => Ok(Split::Dual { rounded: more == 1 }),
        3 => Ok(Split::Sqrt3 { trisect: more == 1 }),
        4 => Ok(Split::Mixed),
        5 => Ok(Split::MidEdge { cut: more & 1 == 1, corners: more & 2 == 2 }),
        6 => Ok(Split::Poke),
        7 => Ok(Split::NWay { n: more, triangles: Triangles::All }),
        8 => Ok(Split::NWay { n: more, triangles: Triangles::Some }),
        9 => Ok(Split::NWay { n: more, triangles: Triangles::None }),
        _ => Err(Damaged),
    }
}
