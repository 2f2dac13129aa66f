//! The resumable packing: slices in, bytes for buffers out, a bounded piece of work per call.
//!
//! A worker can yield between calls. The memory besides is one scratch array of a call's size. Faces of several parts
//! (material and group) are ordered by part with a counting sort, so that a part is one run of elements.
//!
//! ```text
//!   points  |####################|                 packed first (shared layout), box taken
//!   faces   |part 0|part 1  |part 2   |            then faces, part by part
//!   pieces  |  buffer 0  |  buffer 1  | ...        cut anywhere between two faces
//! ```

use std::ops::Range;

use bytemuck::{Pod, Zeroable, cast_slice};

use crate::corners::{Builder, Corner, Extra};
use crate::data::{Bounds, SurfaceData};
use crate::{Error, pack};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SharedVertex {
    position: [f32; 3],
    normal: [i16; 2],
}

/// Vertices that are packed at once: where speed counts for more than size.
const LANES: usize = if cfg!(feature = "wide") { 8 } else { 1 };

/// A run of elements (indices or corners) that belongs to one part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// The part.
    pub part: u32,
    /// Its first element.
    pub first: u64,
    /// How many.
    pub count: u64,
}

/// One of a surface's buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Vertices that quads share: position and octahedral normal.
    Vertices,
    /// Their colours.
    Colors,
    /// A piece of the faces: indices of quads, or corners.
    Piece(usize),
    /// What the corners of a piece carry.
    Extra(usize),
}

/// Who has the buffers.
pub trait Sink {
    /// Takes bytes that belong there, from `offset` on.
    fn write(&mut self, place: Place, offset: u64, bytes: &[u8]);
}

/// What a surface's buffers are: its number of vertices; of shared quads the vertices where face points and edge points begin, of corners
/// what they carry (1 texture coordinates, 2 colours) and 0; and the quad, of corners the triangle, at which each piece ends. `faces` counts
/// quads or triangles; no piece takes more than so many bytes.
pub fn shape(count: u32, kinds: Option<[u32; 2]>, carries: u32, faces: u64, bytes: u64) -> Vec<u32> {
    // Even, so that no quad of two triangles is parted.
    let each = if kinds.is_some() { 24 } else { 72 };
    let most = (bytes / each / 2).max(1) * 2;
    let [a, b] = kinds.unwrap_or([carries, 0]);
    let ends = (1..=faces.div_ceil(most)).map(|i| (i * most).min(faces) as u32);
    [count, a, b].into_iter().chain(ends).collect()
}

/// A surface on its way to buffers. Call [`Packer::step`] until it says true.
pub struct Packer {
    shape: Vec<u32>,
    order: Option<Vec<u32>>,
    part_ends: Vec<u64>,
    next_point: usize,
    next_face: usize,
    /// Points and faces.
    all: usize,
    elements: u64,
    piece: usize,
    builder: Builder,
    vertices: Vec<SharedVertex>,
    colors: Vec<[u8; 4]>,
    indices: Vec<[u32; 6]>,
    /// The parts of all elements so far.
    pub runs: Vec<Run>,
    /// The box of all points so far.
    pub bounds: Bounds,
}

impl Packer {
    /// Checks lengths and orders faces by part, in pieces of at most so many bytes. Nothing is packed yet.
    ///
    /// # Errors
    /// [`Error::Mismatch`] for slices that do not belong together.
    pub fn new(data: &SurfaceData<'_>, bytes: u64) -> Result<Packer, Error> {
        data.check()?;
        let kinds = data.parents.filter(|kinds| kinds[1] > 0 && data.is_shared());
        let carries = u32::from(data.uv.is_some()) | u32::from(!data.colors.is_empty()) << 1;
        let faces = if kinds.is_some() { data.faces.count() as u64 } else { data.triangle_bound() };
        let (order, part_ends) = match data.part_of {
            Some(part_of) if data.parts.len() > 1 => order_by_part(data.faces.count(), data.parts.len(), part_of),
            _ => (None, vec![data.faces.count() as u64]),
        };
        Ok(Packer {
            shape: shape(data.points.len() as u32, kinds, carries, faces, bytes),
            order,
            part_ends,
            next_point: 0,
            next_face: 0,
            all: data.points.len() + data.faces.count(),
            elements: 0,
            piece: 0,
            builder: Builder::default(),
            vertices: Vec::new(),
            colors: Vec::new(),
            indices: Vec::new(),
            runs: Vec::new(),
            bounds: Bounds::EMPTY,
        })
    }

    /// What buffers there have to be: [`shape`].
    pub fn shape(&self) -> &[u32] {
        &self.shape
    }

    /// Packs up to `count` points or faces; true when all is done. `data` must be the same at each call.
    ///
    /// About 6 ns a point and 2 ns a face natively, on memory that has been touched; two to three times that on the web.
    ///
    /// # Errors
    /// [`Error::Index`] for an index past the end, [`Error::Order`] when quads are not in the order of a quad split.
    pub fn step(&mut self, data: &SurfaceData<'_>, count: usize, out: &mut impl Sink) -> Result<bool, Error> {
        if self.next_point < data.points.len() {
            let end = self.next_point.saturating_add(count).min(data.points.len());
            self.points(data, end, out);
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
            match self.shape[..] {
                [count, a, b, ..] if b > 0 => self.quads(data, range, count, [a, b], out)?,
                _ => self.corners(data, range, out)?,
            }
            let count = self.elements - before;
            match self.runs.last_mut() {
                Some(run) if run.part == part as u32 => run.count += count,
                _ => self.runs.push(Run { part: part as u32, first: before, count }),
            }
            self.next_face = part_end;
        }
        Ok(self.next_face >= faces)
    }

    /// Share of the work that is done, 0..=1.
    pub fn progress(&self) -> f32 {
        if self.all == 0 { 1.0 } else { (self.next_point + self.next_face) as f32 / self.all as f32 }
    }

    fn points(&mut self, data: &SurfaceData<'_>, end: usize, out: &mut impl Sink) {
        let range = self.next_point..end;
        let points = data.points.get(range.clone()).unwrap_or(&[]);
        self.bounds.add_all(points);
        if self.shape.get(2).is_some_and(|&b| b > 0) {
            let normals = data.normals.get(range.clone()).unwrap_or(&[]);
            self.vertices.resize(points.len(), SharedVertex::zeroed());
            // In groups, so that a vector packs several.
            let (groups, rest) = self.vertices.as_chunks_mut::<LANES>();
            let (own, own_rest) = points.as_chunks::<LANES>();
            let (bent, bent_rest) = normals.as_chunks::<LANES>();
            for ((out, points), normals) in groups.iter_mut().zip(own).zip(bent) {
                let packed = pack::normals(normals);
                for i in 0..LANES {
                    out[i] = SharedVertex { position: points[i], normal: packed[i] };
                }
            }
            for ((out, &position), &n) in rest.iter_mut().zip(own_rest).zip(bent_rest) {
                *out = SharedVertex { position, normal: pack::normal(n) };
            }
            out.write(Place::Vertices, range.start as u64 * 16, cast_slice(&self.vertices));
            if !data.colors.is_empty() {
                self.colors.clear();
                let linear = data.colors.get(range.clone()).unwrap_or(&[]);
                self.colors.extend(linear.iter().map(|&c| pack::color(c)));
                out.write(Place::Colors, range.start as u64 * 4, cast_slice(&self.colors));
            }
        }
        self.next_point = end;
    }

    fn quads(
        &mut self,
        data: &SurfaceData<'_>,
        range: Range<usize>,
        count: u32,
        [old, faces]: [u32; 2],
        out: &mut impl Sink,
    ) -> Result<(), Error> {
        let (mut indices, mut gathered) = (std::mem::take(&mut self.indices), Vec::new());
        let (start, quads) = (range.start, data.faces.corners().as_chunks::<4>().0);
        let own = match &self.order {
            Some(order) => {
                let listed = order.get(range).unwrap_or(&[]);
                gathered.extend(listed.iter().filter_map(|&f| quads.get(f as usize)));
                &gathered
            }
            None => quads.get(range).unwrap_or(&[]),
        };
        // Corners have to be old, edge, face and edge point: each in its range.
        let first = [0, faces, old, faces];
        let edges = count.saturating_sub(faces);
        let wide = [old, edges, faces.saturating_sub(old), edges];
        let mut wrong = [false; 4];
        indices.clear();
        indices.extend(own.iter().map(|&quad| {
            for k in 0..4 {
                wrong[k] |= quad[k].wrapping_sub(first[k]) >= wide[k];
            }
            let [a, b, c, d] = quad;
            [a, b, c, a, c, d]
        }));
        if wrong.contains(&true) {
            // Which one is looked for now.
            let is_wrong = |quad: &[u32; 4]| (0..4).any(|k| quad[k].wrapping_sub(first[k]) >= wide[k]);
            let i = own.iter().position(is_wrong).unwrap_or_default();
            let face = self.order.as_ref().and_then(|o| o.get(start + i)).map_or((start + i) as u64, |&f| f.into());
            let past = own.get(i).and_then(|quad| (0..).zip(quad).find(|(_, v)| **v >= count));
            return Err(match past {
                Some((i, &index)) => Error::Index { corner: 4 * face + i, index, vertices: u64::from(count) },
                None => Error::Order { face },
            });
        }
        self.spill(6, (cast_slice(&indices), 4), &[], out);
        self.indices = indices;
        Ok(())
    }

    fn corners(&mut self, data: &SurfaceData<'_>, range: Range<usize>, out: &mut impl Sink) -> Result<(), Error> {
        let mut builder = std::mem::take(&mut self.builder);
        builder.corners.clear();
        builder.extras.clear();
        for i in range {
            let f = self.order.as_ref().and_then(|o| o.get(i)).map_or(i, |&f| f as usize);
            builder.push(data, f)?;
        }
        let elements = (cast_slice(&builder.corners), size_of::<Corner>());
        self.spill(3, elements, cast_slice(&builder.extras), out);
        self.builder = builder;
        Ok(())
    }

    /// Hands over elements of so many bytes each, `per` of them a quad or triangle of the shape, and what belongs to them beside.
    fn spill(&mut self, per: u64, (bytes, size): (&[u8], usize), extras: &[u8], out: &mut impl Sink) {
        const EXTRA: usize = size_of::<Extra>();
        let (mut done, count) = (0, bytes.len() / size);
        while done < count {
            let first =
                self.piece.checked_sub(1).and_then(|i| self.shape.get(3 + i)).map_or(0, |&e| u64::from(e) * per);
            let last = self.shape.get(3 + self.piece).map_or(u64::MAX, |&e| u64::from(e) * per);
            let room = last.saturating_sub(self.elements) as usize;
            if room == 0 {
                self.piece += 1;
                continue;
            }
            let (at, end) = (self.elements - first, count.min(done.saturating_add(room)));
            if let Some(part) = bytes.get(done * size..end * size) {
                out.write(Place::Piece(self.piece), at * size as u64, part);
            }
            if let Some(part) = extras.get(done * EXTRA..end * EXTRA).filter(|part| !part.is_empty()) {
                out.write(Place::Extra(self.piece), at * EXTRA as u64, part);
            }
            self.elements += (end - done) as u64;
            done = end;
        }
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

    #[test]
    fn pieces_end_between_two_faces() {
        assert_eq!(shape(9, Some([4, 5]), 0, 4, 24 * 2), [9, 4, 5, 2, 4]);
        assert_eq!(shape(9, Some([4, 5]), 0, 5, 24 * 2 + 23), [9, 4, 5, 2, 4, 5]);
        assert_eq!(shape(7, None, 3, 5, 72 * 3), [7, 3, 0, 2, 4, 5]);
        assert_eq!(shape(7, None, 0, 5, 1), [7, 0, 0, 2, 4, 5]);
        assert_eq!(shape(0, None, 0, 0, 100), [0, 0, 0]);
    }
}
