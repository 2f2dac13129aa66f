//! From slices to buffers on the GPU: the two layouts of a surface.
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
//! [`crate::Upload`] makes the buffers.

use crate::corners::{Extra, Triangulate, fan};
use crate::{Error, Gpu};

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

/// A surface as the caller has it. Nothing is copied until the [`crate::Upload`] runs.
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
    /// What kind a face is, 1 to 3, for [`crate::Style::kinds`]; 0 is none. Corners only.
    pub kind_of: Option<&'a dyn Fn(usize) -> u32>,
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
            kind_of: None,
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

    pub(crate) fn triangle_bound(&self) -> u64 {
        (self.faces.corners().len() as u64).saturating_sub(2 * self.faces.count() as u64)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
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

    pub(crate) fn add(&mut self, p: [f32; 3]) {
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

/// A run of elements (indices or corners) that belongs to one part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Run {
    pub part: u32,
    pub first: u64,
    pub count: u64,
}

/// One buffer of a run of elements: `first` is the number of its first element in the whole.
#[derive(Clone)]
pub(crate) struct Chunk {
    pub buffer: wgpu::Buffer,
    /// Texture coordinates and colours of the same corners.
    pub extra: Option<wgpu::Buffer>,
    pub first: u64,
    pub count: u64,
    pub capacity: u64,
}

#[derive(Clone)]
pub(crate) enum Layout {
    /// Vertex buffer, its vertex count, colours; the chunks hold indices.
    Shared { vertices: wgpu::Buffer, count: u32, colors: Option<wgpu::Buffer>, kinds: [u32; 2] },
    /// The chunks hold corners.
    Corners { extras: bool },
}

/// A surface on the GPU. Copies share their buffers.
#[derive(Clone)]
pub struct Surface {
    pub(crate) layout: Layout,
    pub(crate) chunks: Vec<Chunk>,
    pub(crate) runs: Vec<Run>,
    pub(crate) parts: Vec<Part>,
    pub(crate) has_uv: bool,
    pub(crate) has_colors: bool,
    pub(crate) bounds: Bounds,
}

impl Surface {
    /// A surface whose buffers are filled by compute, in the layout that [`Upload`](crate::Upload) gives them. `shape` is the number of
    /// vertices, the vertices where face points and edge points begin (of corners what they carry, 1 for texture coordinates and 2 for colours, and 0), and the
    /// quad, of corners the triangle, at which each buffer ends. The buffers are labelled `refined`, and made in this order: vertices that faces share, then those of faces.
    pub fn reserve(gpu: &Gpu, shape: &[u32]) -> Surface {
        let base = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let [count, a, b, ends @ ..] = shape else { return Surface::reserve(gpu, &[0; 3]) };
        let (layout, usage, [elements, bytes]) = if *b > 0 {
            let vertices = buffer(
                gpu,
                "refined",
                u64::from(*count) * 16,
                base | wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_SRC,
            );
            let layout = Layout::Shared { vertices, count: *count, colors: None, kinds: [*a, *b] };
            (layout, base | wgpu::BufferUsages::INDEX, [6, 4])
        } else {
            (Layout::Corners { extras: *a > 0 }, base | wgpu::BufferUsages::VERTEX, [3, 24])
        };
        let extras = matches!(layout, Layout::Corners { extras: true });
        let mut first = 0;
        let chunk = |&end: &u32| {
            let count = u64::from(end) * elements - first;
            let buffer = buffer(gpu, "refined", count * bytes, usage);
            let extra =
                extras.then(|| crate::surface::buffer(gpu, "refined", count * size_of::<Extra>() as u64, usage));
            let chunk = Chunk { buffer, extra, first, count, capacity: count };
            first += count;
            chunk
        };
        let chunks = ends.iter().map(chunk).collect();
        let (runs, parts) =
            (vec![Run { part: 0, first: 0, count: first }], vec![Part { material: u32::MAX, group: 0 }]);
        Surface {
            layout,
            chunks,
            runs,
            parts,
            has_uv: extras && a & 1 > 0,
            has_colors: extras && a & 2 > 0,
            bounds: Bounds::EMPTY,
        }
    }

    /// The buffers that compute fills: vertices that faces share, then those of faces.
    #[cfg(feature = "compute")]
    pub(crate) fn filled(&self) -> Vec<wgpu::Buffer> {
        let vertices = match &self.layout {
            Layout::Shared { vertices, .. } => Some(vertices),
            Layout::Corners { .. } => None,
        };
        let of_faces = self.chunks.iter().flat_map(|c| [Some(&c.buffer), c.extra.as_ref()]);
        std::iter::once(vertices).chain(of_faces).flatten().cloned().collect()
    }

    /// What holds of the buffers that compute filled: the box of the points, and where there are several parts their runs: pairs of a
    /// part and a number of elements (indices or corners).
    pub fn settle(&mut self, bounds: Bounds, parts: &[Part], runs: &[u32]) {
        self.bounds = bounds;
        if !parts.is_empty() {
            self.parts = parts.to_vec();
        }
        let mut first = 0;
        let run = |&[part, count]: &[u32; 2]| {
            let run = Run { part, first, count: count.into() };
            first += run.count;
            run
        };
        if !runs.is_empty() {
            self.runs = runs.as_chunks().0.iter().map(run).collect();
        }
    }

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

/// A buffer of at least 16 bytes (an empty one cannot be bound).
pub(crate) fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
