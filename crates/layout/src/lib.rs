//! limn-layout: how a surface lies in the buffers that it is drawn from. Bytes in, bytes out; no device.
//!
//! Whoever makes a level packs it: the engine what it refines itself, the module with every scheme what it does. So the packing is
//! in a crate of its own, and what it makes goes to a [`Sink`], which is the only one who knows buffers.
//!
//! ```text
//!   points |##########|     Packer ── some points or faces a call ──> Sink: bytes for a place in a buffer
//!   faces  |part 0|part 1|                                             wgpu's queue, or the browser's own objects
//! ```
//!
//! There are two layouts. **Shared quads.** After a quad split every quad is (old vertex, edge point, face point, edge point). Cut along the
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
//! 16 bytes a vertex (20 with colour), 24 bytes a quad. **Corners** ([`corners`]) serve everything else: 72 bytes a
//! triangle, 108 with texture coordinates or colours. Both are spread over any number of pieces, cut anywhere between two faces.

pub mod corners;
mod data;
#[cfg(feature = "levels")]
mod level;
pub mod pack;
mod packer;

pub use corners::Triangulate;
pub use data::{Bounds, Faces, Part, SurfaceData};
#[cfg(feature = "levels")]
pub use level::level;
pub use packer::{Packer, Place, Run, Sink, shape};

/// Slices that make no surface.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Slices that do not belong together.
    #[error("{what}: {found} were given where {expected} are needed")]
    Mismatch {
        /// Which slice.
        what: &'static str,
        /// Elements found.
        found: u64,
        /// Elements expected.
        expected: u64,
    },
    /// An index past the end of the points.
    #[error("corner {corner} refers to vertex {index}, but there are {vertices} vertices")]
    Index {
        /// Corner number in the slice.
        corner: u64,
        /// The index found there.
        index: u32,
        /// Number of vertices.
        vertices: u64,
    },
    /// Quads that claim to come from a quad split but are not in its order.
    #[error("face {face} is not an old vertex, an edge point, a face point and an edge point; give no parent ranges")]
    Order {
        /// The face.
        face: u64,
    },
}
