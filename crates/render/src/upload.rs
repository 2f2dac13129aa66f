//! The resumable upload: slices in, buffers on the GPU out, a bounded piece of work per call.
//!
//! A worker can yield between calls. The memory besides is one scratch array of a call's size. Faces of several parts
//! (material and group) are ordered by part with a counting sort, so that a part is one run of elements. Buffers are
//! pieces of at most 96 MiB, or of the adapter's limit where that is lower.
//!
//! ```text
//!   points  |####################|                 packed first (shared layout), box taken
//!   faces   |part 0|part 1  |part 2   |            then faces, part by part
//!   pieces  |  buffer 0  |  buffer 1  | ...        cut anywhere between two triangles
//! ```

use bytemuck::{Pod, Zeroable};

use crate::corners::{Builder, Corner, Extra};
use crate::surface::{Bounds, Chunk, Layout, Part, Run, Surface, SurfaceData, buffer};
use crate::{Error, Gpu, pack};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SharedVertex {
    position: [f32; 3],
    normal: [i16; 2],
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
    indices: Vec<[u32; 6]>,
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
    /// About 6 ns a point and 2 ns a face natively, on memory that has been touched; two to three times that on the web.
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
        let points = data.points.get(range.clone()).unwrap_or(&[]);
        // Kept out of `self` while it is added to, so that it stays in registers.
        let mut bounds = self.surface.bounds;
        points.iter().for_each(|&p| bounds.add(p));
        self.surface.bounds = bounds;
        if let Layout::Shared { vertices, colors, .. } = &self.surface.layout {
            self.vertices.clear();
            let normals = data.normals.get(range.clone()).unwrap_or(&[]);
            let pairs = points.iter().zip(normals);
            self.vertices.extend(pairs.map(|(&position, &n)| SharedVertex { position, normal: pack::normal(n) }));
            gpu.queue.write_buffer(vertices, range.start as u64 * 16, bytemuck::cast_slice(&self.vertices));
            if let Some(colors) = colors {
                self.colors.clear();
                let linear = data.colors.get(range.clone()).unwrap_or(&[]);
                self.colors.extend(linear.iter().map(|&c| pack::color(c)));
                gpu.queue.write_buffer(colors, range.start as u64 * 4, bytemuck::cast_slice(&self.colors));
            }
        }
        self.next_point = end;
    }

    fn quads(
        &mut self,
        gpu: &Gpu,
        data: &SurfaceData<'_>,
        range: std::ops::Range<usize>,
        count: u32,
        [old, faces]: [u32; 2],
    ) -> Result<(), Error> {
        let mut indices = std::mem::take(&mut self.indices);
        indices.clear();
        indices.reserve(range.len());
        let quads = data.faces.corners().as_chunks::<4>().0;
        let order = self.order.as_deref();
        for i in range {
            let f = order.and_then(|order| order.get(i)).map_or(i, |&f| f as usize);
            let Some(&[a, b, c, d]) = quads.get(f) else { continue };
            let ordered = a < old && c >= old && c < faces && b >= faces && d >= faces && b < count && d < count;
            if !ordered {
                if let Some((i, &index)) = [a, b, c, d].iter().enumerate().find(|(_, v)| **v >= count) {
                    return Err(Error::Index { corner: (4 * f + i) as u64, index, vertices: u64::from(count) });
                }
                return Err(Error::Order { face: f as u64 });
            }
            indices.push([a, b, c, a, c, d]);
        }
        self.spill(gpu, data.faces.count() as u64 * 6, (bytemuck::cast_slice(&indices), 4), &[]);
        self.indices = indices;
        Ok(())
    }

    fn corners(&mut self, gpu: &Gpu, data: &SurfaceData<'_>, range: std::ops::Range<usize>) -> Result<(), Error> {
        let mut builder = std::mem::take(&mut self.builder);
        builder.corners.clear();
        builder.extras.clear();
        for i in range {
            let f = self.order.as_ref().and_then(|o| o.get(i)).map_or(i, |&f| f as usize);
            builder.push(data, f)?;
        }
        let elements = (bytemuck::cast_slice(&builder.corners), size_of::<Corner>());
        self.spill(gpu, data.triangle_bound() * 3, elements, bytemuck::cast_slice(&builder.extras));
        self.builder = builder;
        Ok(())
    }

    /// Writes elements of so many bytes each to the last piece and to new ones, and what belongs to them beside.
    fn spill(&mut self, gpu: &Gpu, upper: u64, (bytes, size): (&[u8], usize), extras: &[u8]) {
        const EXTRA: usize = size_of::<Extra>();
        let (mut done, count) = (0, bytes.len() / size);
        while done < count {
            let (at, room) = self.room(gpu, upper);
            let end = count.min(done + room as usize);
            if let (Some(chunk), Some(part)) = (self.surface.chunks.last_mut(), bytes.get(done * size..end * size)) {
                gpu.queue.write_buffer(&chunk.buffer, at * size as u64, part);
                if let (Some(extra), Some(part)) = (&chunk.extra, extras.get(done * EXTRA..end * EXTRA)) {
                    gpu.queue.write_buffer(extra, at * EXTRA as u64, part);
                }
                chunk.count += (end - done) as u64;
            }
            self.elements += (end - done) as u64;
            done = end;
        }
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
}
