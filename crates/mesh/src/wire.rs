//! Meshes, plans and levels as bytes, for a kernel that lives in a module of its own.
//!
//! A page should not have to load the rules of every scheme before it draws its first picture. A build without the feature
//! `full` has the common ones; the others are in a second module, which is loaded when a plan needs it ([`Plan::is_here`]):
//!
//! ```text
//!   page's module                      module with every scheme
//!   mesh.pack()  ── once a mesh ──>    Mesh::unpack
//!   plan.pack()  ── each time   ──>    Plan::unpack, Job::new, step ...
//!   Refined::unpack  <───────────      refined.pack(), and refined.large(i), each copied once
//! ```
//!
//! The bytes are [`crate::pack`]'s. Unpacking checks lengths and numbers of kinds; that indices are in range it takes on
//! trust. Every structure is taken apart by name, so a field that is added does not compile until it is sent as well.
//! Cost: one copy each way, of a mesh two more.

use crate::fairing::Fairing;
use crate::mesh::{Mesh, UvChannel};
use crate::pack::{Damaged, Read, Reader, Writer};
use crate::plan::{Plan, Run};
use crate::refined::{Faces, Refined, UvValues};
use crate::scheme::{Boundary, Decay, FaceVarying, MOST_PARAMS, Params, Rules, TriangleRule, scheme};
use crate::split::{FaceKind, FaceShape, Split, Triangles};
use crate::topology::{Counts, Topology};
use bytemuck::Pod;
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

/// Where the arrays of a level stand in the list of those that pass by themselves: [`Refined::large`].
mod large {
    pub const POINTS: usize = 0;
    pub const OFFSETS: usize = 1;
    pub const CORNERS: usize = 2;
    pub const UV_VALUES: usize = 3;
    pub const UV_CORNERS: usize = 4;
    pub const COLORS: usize = 5;
    pub const NORMALS: usize = 6;
    pub const SOURCE: usize = 7;
}

/// The arrays of a level, as bytes, wherever they are.
pub trait Large {
    /// How many bytes one has.
    fn length(&self, i: usize) -> usize;

    /// Copies it; there is room for as many.
    fn copy_to(&self, i: usize, out: &mut [u8]);
}

impl Large for Refined {
    fn length(&self, i: usize) -> usize {
        self.large(i).len()
    }

    fn copy_to(&self, i: usize, out: &mut [u8]) {
        out.copy_from_slice(self.large(i));
    }
}

/// A copy of an array.
fn taken<T: Pod>(arrays: &impl Large, i: usize) -> Vec<T> {
    let mut values = bytemuck::zeroed_vec(arrays.length(i) / size_of::<T>());
    arrays.copy_to(i, bytemuck::cast_slice_mut(&mut values));
    values
}

impl Refined {
    /// The level as bytes, without the mesh and the arrays that grow with it: they are taken by themselves ([`Large`]).
    pub fn pack(&self) -> Vec<u8> {
        let Refined {
            level,
            counts,
            hidden,
            points: _,
            faces,
            uv,
            colors: _,
            parent_ranges,
            vertex_parents,
            known_normals,
            kinds,
            source: _,
            split,
            mesh: _,
        } = self;
        let mut out = Writer::default();
        out.number(*level);
        put_counts(&mut out, counts);
        out.array(&[*hidden]);
        out.number(match faces {
            Faces::Polygons { .. } => 0,
            Faces::Triangles(_) => 3,
            Faces::Quads(_) => 4,
        });
        out.number(uv.is_some().into());
        out.number(parent_ranges.is_some().into());
        out.array(&parent_ranges.unwrap_or_default());
        out.number(*vertex_parents);
        out.number(known_normals.is_some().into());
        out.bytes(&kinds.iter().map(|&kind| kind as u8).collect::<Vec<_>>());
        put_split(&mut out, *split);
        out.finish()
    }

    /// The bytes of an array that grows with the level; none for numbers that there are not.
    pub fn large(&self, i: usize) -> &[u8] {
        use bytemuck::cast_slice as bytes;
        match (i, &self.faces, &self.uv) {
            (large::POINTS, ..) => bytes(&self.points),
            (large::OFFSETS, Faces::Polygons { offsets, .. }, _) => bytes(offsets),
            (large::CORNERS, faces, _) => bytes(faces.corners()),
            (large::UV_VALUES, _, Some(uv)) => bytes(&uv.values),
            (large::UV_CORNERS, _, Some(uv)) => bytes(&uv.corners),
            (large::COLORS, ..) => bytes(&self.colors),
            (large::NORMALS, ..) => bytes(self.known_normals.as_deref().unwrap_or_default()),
            (large::SOURCE, ..) => bytes(&self.source),
            _ => &[],
        }
    }

    /// The level of `mesh` that these bytes are, and its arrays. Cost: one copy.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn unpack(bytes: &[u8], mesh: Arc<Mesh>, arrays: &impl Large) -> Read<Refined> {
        let mut from = Reader::new(bytes);
        let level = from.number()?;
        let counts = counts(&mut from)?;
        let [hidden] = from.exactly()?;
        let degree = from.number()?;
        let has_uv = from.number()? == 1;
        let parent_ranges = from.option(Reader::exactly)?;
        let vertex_parents = from.number()?;
        let has_normals = from.number()? == 1;
        let kind =
            |&b: &u8| [FaceKind::Face, FaceKind::Edge, FaceKind::Vertex].get(usize::from(b)).copied().ok_or(Damaged);
        let kinds = from.bytes()?.iter().map(kind).collect::<Read<_>>()?;
        let split = split(&mut from)?;
        let (offsets, corners) = (taken(arrays, large::OFFSETS), taken(arrays, large::CORNERS));
        let (values, uv_corners) = (taken(arrays, large::UV_VALUES), taken(arrays, large::UV_CORNERS));
        let (points, normals) = (taken(arrays, large::POINTS), taken(arrays, large::NORMALS));
        let (colors, source) = (taken(arrays, large::COLORS), taken(arrays, large::SOURCE));
        Ok(Refined {
            level,
            counts,
            hidden,
            points,
            faces: match degree {
                0 => Faces::Polygons { offsets, corners },
                3 => Faces::Triangles(corners),
                _ => Faces::Quads(corners),
            },
            uv: has_uv.then_some(UvValues { values, corners: uv_corners }),
            colors,
            parent_ranges,
            vertex_parents,
            known_normals: has_normals.then_some(normals),
            kinds,
            source,
            split,
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
