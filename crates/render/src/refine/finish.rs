//! What a refined level is drawn from: the layouts of [`crate::surface`], their pieces made by kernels.
//!
//! ```text
//!   quads       vertices 16 bytes | indices in pieces, 24 bytes a quad         shared quads, made once
//!   triangles   vertices 16 bytes | corners in pieces, 72 bytes a triangle     corners hold points, made each time
//! ```
//!
//! A piece is a buffer of its own, so that no binding grows with the level. Limit: one material; faces are not hidden.

use super::{Buffers, Rows};
use crate::Error;
use crate::surface::{Bounds, Chunk, Faces, Layout, Part, Run, Surface};
use std::ops::Range;

/// Largest piece: as for what is uploaded.
const PIECE_BYTES: u64 = 96 << 20;

/// How a level is drawn.
pub(crate) enum Drawn {
    /// Shared quads: where face and edge points begin, and indices.
    Quads { kinds: [u32; 2], pieces: Vec<Piece> },
    /// Corners.
    Corners { pieces: Vec<Piece> },
}

/// Faces and what they are drawn from.
pub(crate) struct Piece {
    faces: Range<u32>,
    buffer: wgpu::Buffer,
}

impl Drawn {
    /// Room for what a kernel makes of `faces` faces.
    pub fn fused(buffers: &mut Buffers<'_>, triangles: bool, kinds: [u32; 2], faces: u64) -> Result<Drawn, Error> {
        let (bytes, usage) = if triangles {
            (72, wgpu::BufferUsages::VERTEX)
        } else {
            (24, wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST)
        };
        let most = (PIECE_BYTES.min(buffers.limit()) / bytes).max(1);
        let mut pieces = Vec::new();
        let mut first = 0;
        while first < faces {
            let end = (first + most).min(faces);
            let what = if triangles { "corners" } else { "indices" };
            let buffer = buffers.make(what, bytes * (end - first), usage)?;
            pieces.push(Piece { faces: first as u32..end as u32, buffer });
            first = end;
        }
        Ok(if triangles { Drawn::Corners { pieces } } else { Drawn::Quads { kinds, pieces } })
    }

    /// What the listed faces of `rows` are drawn from: shared quads with their indices, or room for the corners of triangles.
    pub fn listed(buffers: &mut Buffers<'_>, rows: &Rows<'_>) -> Result<Drawn, Error> {
        let (Faces::Quads(quads), Some(kinds)) = (rows.faces, rows.parents) else {
            let faces = rows.faces;
            let triangles = faces.corners().len() as u64 - (2 * faces.count() as u64).min(faces.corners().len() as u64);
            return Drawn::fused(buffers, true, [0; 2], triangles);
        };
        let drawn = Drawn::fused(buffers, false, kinds, quads.len() as u64 / 4)?;
        for (range, buffer) in drawn.pieces() {
            let mine = quads.chunks_exact(4).skip(range.start as usize).take(range.len());
            let indices: Vec<[u32; 6]> = mine.map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]]).collect();
            buffers.gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&indices));
        }
        Ok(drawn)
    }

    /// The faces of each piece, and its buffer.
    pub fn pieces(&self) -> impl Iterator<Item = (Range<u32>, &wgpu::Buffer)> {
        let (Drawn::Quads { pieces, .. } | Drawn::Corners { pieces }) = self;
        pieces.iter().map(|p| (p.faces.clone(), &p.buffer))
    }

    /// A surface of these buffers.
    pub fn surface(
        &self,
        vertices: &wgpu::Buffer,
        count: u32,
        bounds: Bounds,
        colors: Option<&wgpu::Buffer>,
    ) -> Surface {
        let (layout, elements) = match self {
            Drawn::Quads { kinds, .. } => {
                (Layout::Shared { vertices: vertices.clone(), count, colors: colors.cloned(), kinds: *kinds }, 6)
            }
            Drawn::Corners { .. } => (Layout::Corners { extras: false }, 3),
        };
        let chunk = |(faces, buffer): (Range<u32>, &wgpu::Buffer)| {
            let count = faces.len() as u64 * elements;
            let first = u64::from(faces.start) * elements;
            Chunk { buffer: buffer.clone(), extra: None, first, count, capacity: count }
        };
        let chunks: Vec<Chunk> = self.pieces().map(chunk).collect();
        let all = chunks.iter().map(|c| c.count).sum();
        Surface {
            layout,
            chunks,
            runs: vec![Run { part: 0, first: 0, count: all }],
            parts: vec![Part { material: u32::MAX, group: 0 }],
            has_uv: false,
            has_colors: colors.is_some(),
            bounds,
        }
    }
}
