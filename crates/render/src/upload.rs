//! The resumable upload: slices in, buffers on the GPU out, a bounded piece of work per call.
//!
//! Packing is [`limn_layout::Packer`]'s; here its bytes go to wgpu's queue. Buffers are pieces of at most 96 MiB, or of the adapter's
//! limit where that is lower.

use limn_layout::{Packer, Place, Sink};

use crate::surface::{Layout, Surface, SurfaceData, buffer};
use crate::{Error, Gpu};

/// Largest piece of a surface that is split: big enough to need few draws, small enough for any allocator.
const CHUNK_BYTES: u64 = 96 << 20;

/// A surface on its way to the GPU. Call [`Upload::step`] until it says true, then [`Upload::finish`].
pub struct Upload {
    surface: Surface,
    packer: Packer,
}

impl Upload {
    /// Checks lengths and limits, orders faces by part, and makes the buffers. Nothing is packed yet.
    ///
    /// # Errors
    /// [`Error::Data`] for slices that do not belong together, [`Error::TooLarge`] when the shared vertices do not
    /// fit one buffer.
    pub fn new(gpu: &Gpu, data: &SurfaceData<'_>) -> Result<Upload, Error> {
        Self::with_chunk(gpu, data, CHUNK_BYTES)
    }

    /// As [`Upload::new`], with the largest size of a piece in bytes (tests split small models with it).
    pub fn with_chunk(gpu: &Gpu, data: &SurfaceData<'_>, chunk: u64) -> Result<Upload, Error> {
        let limit = gpu.max_buffer();
        let bytes = data.points.len() as u64 * 16;
        if bytes > limit && data.is_shared() {
            return Err(Error::TooLarge { what: "the vertices", bytes, limit });
        }
        let packer = Packer::new(data, chunk.min(limit))?;
        let mut surface = Surface::packed(gpu, packer.shape());
        if let (Layout::Shared { colors, .. }, false) = (&mut surface.layout, data.colors.is_empty()) {
            let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
            *colors = Some(buffer(gpu, "vertex colours", data.points.len() as u64 * 4, usage));
            surface.has_colors = true;
        }
        if !data.parts.is_empty() {
            surface.parts = data.parts.to_vec();
        }
        Ok(Upload { surface, packer })
    }

    /// Packs and uploads up to `count` points or faces; true when all is there. `data` must be the same at each call.
    ///
    /// # Errors
    /// As [`Packer::step`].
    pub fn step(&mut self, gpu: &Gpu, data: &SurfaceData<'_>, count: usize) -> Result<bool, Error> {
        Ok(self.packer.step(data, count, &mut Queue { gpu, surface: &self.surface })?)
    }

    /// Share of the work that is done, 0..=1.
    pub fn progress(&self) -> f32 {
        self.packer.progress()
    }

    /// The surface; whole only after [`Upload::step`] said true.
    pub fn finish(self) -> Surface {
        let Upload { mut surface, packer } = self;
        (surface.bounds, surface.runs) = (packer.bounds, packer.runs);
        surface
    }
}

/// Writes to a surface's buffers.
struct Queue<'a> {
    gpu: &'a Gpu,
    surface: &'a Surface,
}

impl Sink for Queue<'_> {
    fn write(&mut self, place: Place, offset: u64, bytes: &[u8]) {
        let chunk = |i: usize| self.surface.chunks.get(i);
        let buffer = match (place, &self.surface.layout) {
            (Place::Vertices, Layout::Shared { vertices, .. }) => Some(vertices),
            (Place::Colors, Layout::Shared { colors, .. }) => colors.as_ref(),
            (Place::Piece(i), _) => chunk(i).map(|c| &c.buffer),
            (Place::Extra(i), _) => chunk(i).and_then(|c| c.extra.as_ref()),
            _ => None,
        };
        if let Some(buffer) = buffer {
            self.gpu.queue.write_buffer(buffer, offset, bytes);
        }
    }
}
