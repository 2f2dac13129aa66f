//! A surface's buffers on the GPU, in one of the two layouts of [`limn_layout`].
//!
//! ```text
//!   shared quads   vertices | colours | pieces of indices
//!   corners                             pieces of corners, and of what they carry
//! ```
//!
//! [`crate::Upload`] fills them, or whoever is told to ([`Surface::reserve`]).

use crate::Gpu;
use limn_layout::Run;
use limn_layout::corners::Extra;
pub use limn_layout::{Bounds, Faces, Part, SurfaceData};

/// One buffer of a run of elements: `first` is the number of its first element in the whole.
#[derive(Clone)]
pub(crate) struct Chunk {
    pub buffer: wgpu::Buffer,
    /// Texture coordinates and colours of the same corners.
    pub extra: Option<wgpu::Buffer>,
    pub first: u64,
    pub count: u64,
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
    /// A surface whose buffers somebody else fills before it is drawn, in the layout that [`Upload`](crate::Upload) gives them: compute, or who
    /// packs a level where it was made. `shape` is [`limn_layout::shape`]. The buffers are made in the order of `Surface::filled`, and no others between.
    pub fn reserve(gpu: &Gpu, shape: &[u32]) -> Surface {
        use wgpu::BufferUsages as U;
        let base = if cfg!(feature = "webgl") { U::COPY_DST } else { U::COPY_DST | U::STORAGE };
        Surface::make(shape, &|size, usage| outside(gpu, size, base | usage))
    }

    /// A surface whose buffers are filled by the queue.
    pub(crate) fn packed(gpu: &Gpu, shape: &[u32]) -> Surface {
        Surface::make(shape, &|size, usage| buffer(gpu, "surface", size, usage | wgpu::BufferUsages::COPY_DST))
    }

    fn make(shape: &[u32], buffer: &dyn Fn(u64, wgpu::BufferUsages) -> wgpu::Buffer) -> Surface {
        use wgpu::BufferUsages as U;
        let [count, a, b, ends @ ..] = shape else { return Surface::make(&[0; 3], buffer) };
        let (layout, usage, [elements, bytes]) = if *b > 0 {
            let vertices = buffer(u64::from(*count) * 16, U::VERTEX | U::COPY_SRC);
            let layout = Layout::Shared { vertices, count: *count, colors: None, kinds: [*a, *b] };
            (layout, U::INDEX, [6, 4])
        } else {
            (Layout::Corners { extras: *a > 0 }, U::VERTEX, [3, 24])
        };
        let extras = matches!(layout, Layout::Corners { extras: true });
        let mut first = 0;
        let chunk = |&end: &u32| {
            let count = u64::from(end) * elements - first;
            let extra = |size| extras.then(|| buffer(count * size, usage));
            let chunk =
                Chunk { buffer: buffer(count * bytes, usage), extra: extra(size_of::<Extra>() as u64), first, count };
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

/// A buffer that is filled from outside.
#[cfg(not(all(target_arch = "wasm32", feature = "webgl")))]
fn outside(gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    buffer(gpu, "refined", size, usage)
}

/// A buffer that is filled from outside. wgpu zeroes what it has not seen written before it reads it, on WebGL2 by an upload: it must take this
/// one for written.
#[cfg(all(target_arch = "wasm32", feature = "webgl"))]
fn outside(gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    use wgpu::hal::{self, Device, api::Gles};
    let size = size.max(16);
    let uses = |u: wgpu::BufferUsages, to| if usage.contains(u) { to } else { wgpu::BufferUses::empty() };
    let uses = uses(wgpu::BufferUsages::VERTEX, wgpu::BufferUses::VERTEX)
        | uses(wgpu::BufferUsages::INDEX, wgpu::BufferUses::INDEX)
        | uses(wgpu::BufferUsages::COPY_DST, wgpu::BufferUses::COPY_DST)
        | uses(wgpu::BufferUsages::COPY_SRC, wgpu::BufferUses::COPY_SRC);
    // SAFETY: the device lives as long as `gpu`, and what it makes is handed back to it at once, with the same size and uses. WebGL
    // makes buffers of zeros, so it is initialised.
    unsafe {
        let made = gpu.device.as_hal::<Gles>().and_then(|device| {
            let memory_flags = hal::MemoryFlags::empty();
            device.create_buffer(&hal::BufferDescriptor { label: None, size, usage: uses, memory_flags }).ok()
        });
        let described = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        match made {
            Some(made) => gpu.device.create_buffer_from_hal::<Gles>(made, &described),
            None => gpu.device.create_buffer(&described),
        }
    }
}
