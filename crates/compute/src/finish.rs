//! What a refined level is drawn from: the layouts of `limn_render::surface`, their pieces made by kernels.
//!
//! ```text
//!   quads       vertices 16 bytes | indices in pieces, 24 bytes a quad         shared quads, made once
//!   triangles   vertices 16 bytes | corners in pieces, 72 bytes a triangle     corners hold points, made each time
//! ```
//!
//! Quads have corners as well where those carry texture coordinates or colours, which lie in a buffer beside (12 bytes a corner). A piece is a
//! buffer of its own, so that no binding grows with the level. Limit: faces are not hidden.

use crate::Error;
use crate::program::{Builder, Id, Role};
use std::ops::Range;

/// Largest piece: as for what is uploaded.
const PIECE_BYTES: u64 = 96 << 20;

/// How a level is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Drawn {
    /// Shared quads: where face and edge points begin, and indices.
    Quads {
        /// Where face points begin, and edge points.
        kinds: [u32; 2],
        /// Six indices a quad.
        pieces: Vec<Piece>,
    },
    /// Corners.
    Corners {
        /// Three corners a triangle.
        pieces: Vec<Piece>,
        /// Whether corners carry texture coordinates, and colours.
        carries: [bool; 2],
    },
}

/// Faces and what they are drawn from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Faces, of corners triangles.
    pub faces: Range<u32>,
    /// The buffer of their indices or corners.
    pub buffer: Id,
    /// What corners carry: texture coordinates and a colour, 12 bytes each.
    pub extra: Option<Id>,
}

impl Drawn {
    /// Room for what a kernel makes of `faces` faces.
    pub(crate) fn fused(
        builder: &mut Builder,
        triangles: bool,
        kinds: [u32; 2],
        faces: u64,
        carries: [bool; 2],
    ) -> Result<Drawn, Error> {
        let (bytes, role) = if triangles { (72, Role::Corners) } else { (24, Role::Indices) };
        // Even, so that no quad is parted.
        let most = (PIECE_BYTES.min(builder.limit()) / bytes / 2).max(1) * 2;
        let mut pieces = Vec::new();
        let mut first = 0;
        while first < faces {
            let end = (first + most).min(faces);
            let what = if triangles { "corners" } else { "indices" };
            let buffer = builder.make(what, bytes * (end - first), role)?;
            let extra = match carries.contains(&true) {
                true => Some(builder.make("texture coordinates", 36 * (end - first), Role::Extras)?),
                false => None,
            };
            pieces.push(Piece { faces: first as u32..end as u32, buffer, extra });
            first = end;
        }
        Ok(if triangles { Drawn::Corners { pieces, carries } } else { Drawn::Quads { kinds, pieces } })
    }

    /// The faces of each piece, and its buffer.
    pub fn pieces(&self) -> &[Piece] {
        let (Drawn::Quads { pieces, .. } | Drawn::Corners { pieces, .. }) = self;
        pieces
    }
}
