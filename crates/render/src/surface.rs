//! From slices to buffers on the GPU: the two layouts of a surface and the resumable upload.
//!
//! **Shared quads.** After a quad split every quad is (old vertex, edge point, face point, edge point). Cut along the
//! diagonal from old vertex to face point, each triangle has one vertex of each kind, and since vertices are stored in
//! ranges, the vertex's index alone says which barycentric it is. True edges, hidden diagonal and parent edges come free:
//!
//! ```text
//!    old ----- edge        old-edge : half of an edge of the level before (bold)
//!     | \       |          edge-face: new (faint)
//!     |   \     |          old-face : the diagonal, never drawn
//!    edge --- face
//! ```
//!
//! 16 bytes a vertex (20 with colour), 24 bytes a quad. **Corners** ([`crate::corners`]) serve everything else: 72 bytes a
//! triangle, 108 with texture coordinates or colours; they can be spread over any number of buffers.
//!
//! An [`Upload`] packs a slice of the work per call, so that a worker can yield between calls. Its memory is one scratch
//! array of the slice's size. Faces of several parts (material and group) are ordered by part with a counting sort.

use bytemuck::{Pod, Zeroable};

use crate::corners::{Builder, Corner, Extra, Triangulate, fan};
use crate::{Error, Gpu, pack};

/// Faces as plain slices of vertex indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Faces<'a> {
    /// Three corners a face.
    Triangles(&'a [u32]),
    /// Four corners a face; after a quad split (old, edge, face, edge).
    Quads(&'a [u32]),
    /// Face f has the corners `offsets[f]..offsets[f + 1]`; one offset more than faces.
    Polygons {
        /// Offsets into `corners`.
        offsets: &'a [u32],
        /// Vertex indices.
        corners: &'a [u32],
    },
}

impl<'a> Faces<'a> {
    /// Number of faces.
    pub fn count(&self) -> usize {
        match self {
            Faces::Triangles(c) => c.len() / 3,
            Faces::Quads(c) => c.len() / 4,
            Faces::Polygons { offsets, .. } => offsets.len().saturating_sub(1),
        }
    }

    /// All corners.
    pub fn corners(&self) -> &'a [u32] {
        match self {
            Faces::Triangles(c) | Faces::Quads(c) | Faces::Polygons { corners: c, .. } => c,
        }
    }

    /// First corner number and vertices of face `f`; empty where the offsets make no sense.
    pub fn face(&self, f: usize) -> (usize, &'a [u32]) {
        let (a, b) = match self {
            Faces::Triangles(_) => (3 * f, 3 * f + 3),
            Faces::Quads(_) => (4 * f, 4 * f + 4),
            Faces::Polygons { offsets, .. } => match (offsets.get(f), offsets.get(f + 1)) {
                (Some(&a), Some(&b)) => (a as usize, b as usize),
                _ => (0, 0),
            },
        };
        (a, self.corners().get(a..b).unwrap_or(&[]))
    }
}

/// Faces that are drawn with one material and hidden or shown together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Index into [`crate::Renderer::set_materials`]; anything past its end is the default material.
    pub material: u32,
    /// Group number for [`crate::Frame::hidden_groups`].
    pub group: u32,
}

/// A surface as the caller has it. Nothing is copied until the [`Upload`] runs.
#[derive(Clone, Copy)]
pub struct SurfaceData<'a> {
    /// Positions.
    pub points: &'a [[f32; 3]],
    /// Unit normals, one a point; empty takes the faces' own.
    pub normals: &'a [[f32; 3]],
    /// The faces.
    pub faces: Faces<'a>,
    /// The vertex order after a split: old vertices are `0..a`, face points `a..b`, edge points `b..` (`a == b` after a
    /// triangle split). None: nothing is known, and all edges count as the parent's.
    pub parents: Option<[u32; 2]>,
    /// Texture coordinates (v upwards), and for each corner of `faces` the index of its own.
    pub uv: Option<(&'a [[f32; 2]], &'a [u32])>,
    /// Linear RGBA, one a point, or empty.
    pub colors: &'a [[f32; 4]],
    /// Parts that faces belong to; empty is one part with the default material in group 0.
    pub parts: &'a [Part],
    /// The part of a face; asked for only when there are several parts.
    pub part_of: Option<&'a dyn Fn(usize) -> u32>,
    /// How polygons of more than three corners are cut.
    pub triangulate: Triangulate,
    /// Takes the corner layout even where shared quads would do: flat shading then shows one normal a quad.
    pub force_corners: bool,
}

impl<'a> SurfaceData<'a> {
    /// A surface of one part without colours, textures or known parents; polygons are cut into fans.
    pub fn new(points: &'a [[f32; 3]], normals: &'a [[f32; 3]], faces: Faces<'a>) -> Self {
        SurfaceData {
            points,
            normals,
            faces,
            parents: None,
            uv: None,
            colors: &[],
            parts: &[],
            part_of: None,
            triangulate: fan,
            force_corners: false,
        }
    }

    /// Whether corners need the second buffer.
    pub(crate) fn has_extras(&self) -> bool {
        self.uv.is_some() || !self.colors.is_empty()
    }

    /// Whether the shared layout is taken: quads after a quad split without texture coordinates.
    pub fn is_shared(&self) -> bool {
        matches!(self.faces, Faces::Quads(_))
            && self.parents.is_some()
            && self.uv.is_none()
            && !self.force_corners
            && self.normals.len() == self.points.len()
    }

    /// Bytes that the buffers on the GPU will take: exact for shared quads, an upper bound for corners.
    pub fn gpu_bytes(&self) -> u64 {
        let (points, faces) = (self.points.len() as u64, self.faces.count() as u64);
        if self.is_shared() {
            points * if self.colors.is_empty() { 16 } else { 20 } + faces * 24
        } else {
            self.triangle_bound() * if self.has_extras() { 108 } else { 72 }
        }
    }

    fn triangle_bound(&self) -> u64 {
        (self.faces.corners().len() as u64).saturating_sub(2 * self.faces.count() as u64)
    }

    fn check(&self) -> Result<(), Error> {
        let expect = |what, found: usize, expected: usize| {
            if found == expected {
                Ok(())
            } else {
                Err(Error::Mismatch { what, found: found as u64, expected: expected as u64 })
            }
        };
        if !self.normals.is_empty() {
            expect("normals", self.normals.len(), self.points.len())?;
        }
        if !self.colors.is_empty() {
            expect("colours", self.colors.len(), self.points.len())?;
        }
        if let Some((_, corners)) = self.uv {
            expect("texture corners", corners.len(), self.faces.corners().len())?;
        }
        // A range check of the polygons' ends: fewer corners than the last offset says would drop faces silently.
        if let Faces::Polygons { offsets, corners } = self.faces {
            expect("polygon corners", corners.len(), offsets.last().map_or(0, |&o| o as usize))?;
        }
        Ok(())
    }
}

/// An axis-aligned box around the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates.
    pub min: [f32; 3],
    /// Highest coordinates.
    pub max: [f32; 3],
}

impl Bounds {
    pub(crate) const EMPTY: Bounds = Bounds { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn add(&mut self, p: [f32; 3]) {
        // min and max let the other operand win over NaN.
        for ((min, max), v) in self.min.iter_mut().zip(&mut self.max).zip(p) {
            *min = min.min(v);
            *max = max.max(v);
        }
    }

    /// Whether there is anything inside.
    pub fn is_empty(&self) -> bool {
        !(0..3).all(|i| self.min[i] <= self.max[i])
    }
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SharedVertex {
    position: [f32; 3],
    normal: [i16; 2],
}

/// A run of elements (indices or corners) that belongs to one part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub part: u32,
    pub first: u64,
    pub count: u64,
}

/// One buffer of a run of elements: `first` is the number of its first element in the whole.
pub(crate) struct Chunk {
    pub buffer: wgpu::Buffer,
    /// Texture coordinates and colours of the same corners.
    pub extra: Option<wgpu::Buffer>,
    pub first: u64,
    pub count: u64,
    capacity: u64,
}

pub(crate) enum Layout {
    /// Vertex buffer, its vertex count, colours; the chunks hold indices.
    Shared { vertices: wgpu::Buffer, count: u32, colors: Option<wgpu::Buffer>, kinds: [u32; 2] },
    /// The chunks hold corners.
    Corners { extras: bool },
}

/// A surface on the GPU.
pub struct Surface {
    pub(crate) layout: Layout,
    pub(crate) chunks: Vec<Chunk>,
    pub(crate) runs: Vec<Run>,
    pub(crate) parts: Vec<Part>,
    pub(crate) has_uv: bool,
    pub(crate) has_colors: bool,
    bounds: Bounds,
}

impl Surface {
    /// Box around all points that were uploaded.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let shared = match &self.layout {
            Layout::Shared { vertices, colors, .. } => vertices.size() + colors.as_ref().map_or(0, |c| c.size()),
            Layout::Corners { .. } => 0,
        };
        shared + self.chunks.iter().map(|c| c.buffer.size() + c.extra.as_ref().map_or(0, |e| e.size())).sum::<u64>()
    }
}

/// Largest piece of a surface that is split: big enough to need few draws, small enough for any allocator.
const CHUNK_BYTES: u64 = 96 << 20;

/// A surface on its way to the GPU. Call [`Upload::step`] until it says true, then [`Upload::finish`].
pub struct Upload {
    surface: Surface,
    order: Option<Vec<u32>>,
    part_ends: Vec<u64>,
    next_point: usize,
    next_face: usize,
    elements: u64,
    chunk_elements: u64,
    builder: Builder,
    vertices: Vec<SharedVertex>,
    colors: Vec<[u8; 4]>,
    indices: Vec<u32>,
}

impl Upload {
    /// Checks lengths and limits, orders faces by part, and makes the shared buffers. Nothing is packed yet.
    ///
    /// # Errors
    /// [`Error::Mismatch`] for slices that do not belong together, [`Error::TooLarge`] when the shared vertices do not
    /// fit one buffer.
    pub fn new(gpu: &Gpu, data: &SurfaceData<'_>) -> Result<Upload, Error> {
        Self::with_chunk(gpu, data, CHUNK_BYTES)
    }

    /// As [`Upload::new`], with the largest size of a piece in bytes (tests split small models with it).
    pub fn with_chunk(gpu: &Gpu, data: &SurfaceData<'_>, chunk: u64) -> Result<Upload, Error> {
        data.check()?;
        let limit = gpu.max_buffer();
        let shared = data.is_shared();
        let layout = match data.parents {
            Some(kinds) if shared => {
                let bytes = data.points.len() as u64 * 16;
                if bytes > limit {
                    return Err(Error::TooLarge { what: "the vertices", bytes, limit });
                }
                let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
                Layout::Shared {
                    vertices: buffer(gpu, "vertices", bytes, usage),
                    count: data.points.len() as u32,
                    colors: (!data.colors.is_empty())
                        .then(|| buffer(gpu, "vertex colours", data.points.len() as u64 * 4, usage)),
                    kinds,
                }
            }
            _ => Layout::Corners { extras: data.has_extras() },
        };
        let parts =
            if data.parts.is_empty() { vec![Part { material: u32::MAX, group: 0 }] } else { data.parts.to_vec() };
        let (order, part_ends) = match data.part_of {
            Some(part_of) if parts.len() > 1 => order_by_part(data.faces.count(), parts.len(), part_of),
            _ => (None, vec![data.faces.count() as u64]),
        };
        // Whole triangles: 3 indices of 4 bytes, or 3 corners of 24.
        let triangle = if shared { 12 } else { 72 };
        Ok(Upload {
            surface: Surface {
                layout,
                chunks: Vec::new(),
                runs: Vec::new(),
                parts,
                has_uv: data.uv.is_some(),
                has_colors: !data.colors.is_empty(),
                bounds: Bounds::EMPTY,
            },
            order,
            part_ends,
            next_point: 0,
            next_face: 0,
            elements: 0,
            chunk_elements: (chunk.min(limit) / triangle).max(2) / 2 * 6,
            builder: Builder::default(),
            vertices: Vec::new(),
            colors: Vec::new(),
            indices: Vec::new(),
        })
    }

    /// Packs and uploads up to `count` points or faces; true when all is there. `data` must be the same at each call.
    ///
    /// About 10 ns a point and 15 ns a face natively.
    ///
    /// # Errors
    /// [`Error::Index`] for an index past the end, [`Error::Order`] when quads are not in the order of a quad split.
    pub fn step(&mut self, gpu: &Gpu, data: &SurfaceData<'_>, count: usize) -> Result<bool, Error> {
        if self.next_point < data.points.len() {
            let end = self.next_point.saturating_add(count).min(data.points.len());
            self.points(gpu, data, end);
            return Ok(false);
        }
        let faces = data.faces.count();
        let end = self.next_face.saturating_add(count).min(faces);
        while self.next_face < end {
            // One part at a time, so that its run is known.
            let part = self.part_ends.partition_point(|&e| e <= self.next_face as u64);
            let part_end = self.part_ends.get(part).map_or(end, |&e| (e as usize).min(end));
            let before = self.elements;
            let range = self.next_face..part_end;
            match self.surface.layout {
                Layout::Shared { count, kinds, .. } => self.quads(gpu, data, range, count, kinds)?,
                Layout::Corners { .. } => self.corners(gpu, data, range)?,
            }
            let count = self.elements - before;
            match self.surface.runs.last_mut() {
                Some(run) if run.part == part as u32 => run.count += count,
                _ => self.surface.runs.push(Run { part: part as u32, first: before, count }),
            }
            self.next_face = part_end;
        }
        Ok(self.next_face >= faces)
    }

    /// Share of the work that is done, 0..=1.
    pub fn progress(&self, data: &SurfaceData<'_>) -> f32 {
        let all = data.points.len() + data.faces.count();
        if all == 0 { 1.0 } else { (self.next_point + self.next_face) as f32 / all as f32 }
    }

    /// The surface; whole only after [`Upload::step`] said true.
    pub fn finish(self) -> Surface {
        self.surface
    }

    fn points(&mut self, gpu: &Gpu, data: &SurfaceData<'_>, end: usize) {
        let range = self.next_point..end;
        for &p in data.points.get(range.clone()).unwrap_or(&[]) {
            self.surface.bounds.add(p);
        }
        if let Layout::Shared { vertices, colors, .. } = &self.surface.layout {
            self.vertices.clear();
            self.vertices.extend(
                (data.points.iter().zip(data.normals).skip(range.start).take(range.len()))
                    .map(|(&position, &n)| SharedVertex { position, normal: pack::normal(n) }),
            );
            gpu.queue.write_buffer(vertices, range.start as u64 * 16, bytemuck::cast_slice(&self.vertices));
            if let Some(colors) = colors {
                self.colors.clear();
                self.colors.extend(data.colors.iter().skip(range.start).take(range.len()).map(|&c| pack::color(c)));
                gpu.queue.write_buffer(colors, range.start as u64 * 4, bytemuck::cast_slice(&self.colors));
            }
        }
        self.next_point = end;
    }

    fn face(&self, i: usize) -> usize {
        self.order.as_ref().and_then(|o| o.get(i)).map_or(i, |&f| f as usize)
    }

    fn quads(
        &mut self,
        gpu: &Gpu,
        data: &SurfaceData<'_>,
        range: std::ops::Range<usize>,
        count: u32,
        [old, faces]: [u32; 2],
    ) -> Result<(), Error> {
        self.indices.clear();
        for i in range {
            let f = self.face(i);
            let (first, &[a, b, c, d]) = data.faces.face(f) else { continue };
            let ordered = a < old && c >= old && c < faces && b >= faces && d >= faces && b < count && d < count;
            if !ordered {
                if let Some((i, &index)) = [a, b, c, d].iter().enumerate().find(|(_, v)| **v >= count) {
                    return Err(Error::Index { corner: (first + i) as u64, index, vertices: u64::from(count) });
                }
                return Err(Error::Order { face: f as u64 });
            }
            self.indices.extend([a, b, c, a, c, d]);
        }
        let upper = data.faces.count() as u64 * 6;
        let mut rest = std::mem::take(&mut self.indices);
        let mut done = 0;
        while done < rest.len() {
            let (at, room) = self.room(gpu, upper);
            let n = room.min((rest.len() - done) as u64) as usize;
            if let (Some(chunk), Some(part)) = (self.surface.chunks.last_mut(), rest.get(done..done + n)) {
                gpu.queue.write_buffer(&chunk.buffer, at * 4, bytemuck::cast_slice(part));
                chunk.count += n as u64;
            }
            self.elements += n as u64;
            done += n;
        }
        rest.clear();
        self.indices = rest;
        Ok(())
    }

    fn corners(&mut self, gpu: &Gpu, data: &SurfaceData<'_>, range: std::ops::Range<usize>) -> Result<(), Error> {
        self.builder.corners.clear();
        self.builder.extras.clear();
        for i in range {
            let f = self.face(i);
            self.builder.push(data, f)?;
        }
        let upper = data.triangle_bound() * 3;
        let builder = std::mem::take(&mut self.builder);
        let mut done = 0;
        while done < builder.corners.len() {
            let (at, room) = self.room(gpu, upper);
            let n = room.min((builder.corners.len() - done) as u64) as usize;
            if let (Some(chunk), Some(part)) = (self.surface.chunks.last_mut(), builder.corners.get(done..done + n)) {
                gpu.queue.write_buffer(&chunk.buffer, at * 24, bytemuck::cast_slice(part));
                if let (Some(extra), Some(part)) = (&chunk.extra, builder.extras.get(done..done + n)) {
                    gpu.queue.write_buffer(extra, at * size_of::<Extra>() as u64, bytemuck::cast_slice(part));
                }
                chunk.count += n as u64;
            }
            self.elements += n as u64;
            done += n;
        }
        self.builder = builder;
        Ok(())
    }

    /// Where the next element goes in the last chunk and how many fit there; opens a new chunk when it is full.
    /// `upper` bounds the elements of the whole surface, so that the last chunk is no larger than it must be.
    fn room(&mut self, gpu: &Gpu, upper: u64) -> (u64, u64) {
        let full = self.surface.chunks.last().is_none_or(|c| c.count >= c.capacity);
        if full {
            let capacity = self.chunk_elements.min(upper.saturating_sub(self.elements)).max(6);
            let (usage, bytes, extras) = match self.surface.layout {
                Layout::Shared { .. } => (wgpu::BufferUsages::INDEX, 4, false),
                Layout::Corners { extras } => (wgpu::BufferUsages::VERTEX, size_of::<Corner>() as u64, extras),
            };
            let usage = usage | wgpu::BufferUsages::COPY_DST;
            self.surface.chunks.push(Chunk {
                buffer: buffer(gpu, "surface", capacity * bytes, usage),
                extra: extras.then(|| buffer(gpu, "texture coordinates", capacity * size_of::<Extra>() as u64, usage)),
                first: self.elements,
                count: 0,
                capacity,
            });
        }
        self.surface.chunks.last().map_or((0, 0), |c| (c.count, c.capacity - c.count))
    }
}

/// A buffer of at least 16 bytes (an empty one cannot be bound).
pub(crate) fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage,
        mapped_at_creation: false,
    })
}

/// Faces in the order of their parts (stable), and the end of each part in it. Unknown parts count as the last.
fn order_by_part(faces: usize, parts: usize, part_of: &dyn Fn(usize) -> u32) -> (Option<Vec<u32>>, Vec<u64>) {
    let part = |f: usize| (part_of(f) as usize).min(parts - 1);
    let mut ends = vec![0u64; parts];
    for f in 0..faces {
        ends[part(f)] += 1;
    }
    let mut sum = 0;
    for e in &mut ends {
        sum += *e;
        *e = sum;
    }
    let mut next: Vec<u64> = std::iter::once(0).chain(ends.iter().copied()).take(parts).collect();
    let mut order = vec![0u32; faces];
    for f in 0..faces {
        let at = &mut next[part(f)];
        order[*at as usize] = f as u32;
        *at += 1;
    }
    (Some(order), ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_ordered_by_part() {
        let parts = [2u32, 0, 1, 0, 2, 9];
        let (order, ends) = order_by_part(6, 3, &|f| parts[f]);
        assert_eq!(order.unwrap(), [1, 3, 2, 0, 4, 5]);
        assert_eq!(ends, [2, 3, 6]);
    }

    #[test]
    fn bytes_are_told_before_anything_is_made() {
        let points = [[0.0; 3]; 9];
        let quads = [0u32; 16];
        let mut data = SurfaceData::new(&points, &points, Faces::Quads(&quads));
        assert_eq!(data.gpu_bytes(), 8 * 72);
        data.parents = Some([4, 5]);
        assert!(data.is_shared());
        assert_eq!(data.gpu_bytes(), 9 * 16 + 4 * 24);
        data.force_corners = true;
        assert_eq!(data.gpu_bytes(), 8 * 72);
    }

    #[test]
    fn slices_must_belong_together() {
        let points = [[0.0; 3]; 3];
        let mut data = SurfaceData::new(&points, &points[..2], Faces::Triangles(&[0, 1, 2]));
        assert_eq!(data.check(), Err(Error::Mismatch { what: "normals", found: 2, expected: 3 }));
        data.normals = &[];
        data.faces = Faces::Polygons { offsets: &[0, 4], corners: &[0, 1, 2] };
        assert_eq!(data.check(), Err(Error::Mismatch { what: "polygon corners", found: 3, expected: 4 }));
        assert_eq!(data.faces.face(0).1, &[] as &[u32]);
    }
}
