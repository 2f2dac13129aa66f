//! Splits: how a level's connectivity comes from the one before, by index arithmetic alone.
//!
//! A split says which children every half-edge has and which vertex each child leaves; with that, twins, edges, faces and
//! the turn around a vertex are closed forms of the parent's (Dupuy & Vanhoey 2021 for quads, Vanhoey & Dupuy 2022 for
//! triangles; edge ids implicit in the manner of Edge-Friend). A child level stores two words a half-edge, twin and origin,
//! and one a vertex.
//!
//! ```text
//!   quad                            triangle
//!    p ---- . ---- .                     v
//!    |      |      |                   / 3h \
//!    e(p)-- f ---- .                 e(h) - e(p)
//!    | 4h   |      |                 /  \3H+h/  \
//!    v ---- e(h) - n                n --- . ----- p
//!
//!   child vertices: old [0, V) | faces [V, V + F) | edges .. (quad)      old [0, V) | edges .. (triangle)
//! ```
//!
//! Ids of vertices are stable prefixes: vertex 17 of level 0 is vertex 17 of every level. Cost: about 3 ns a half-edge.

mod quad;
mod triangle;

pub use quad::QuadLevel;
pub use triangle::TriangleLevel;

use crate::topology::{Connectivity, Counts};

/// The splits there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Every face of n corners becomes n quads around a new face point. Takes any polygons.
    Quad,
    /// Every triangle becomes four. Takes triangles only.
    Triangle,
}

impl Split {
    /// How many corners every child face has.
    pub fn degree(self) -> u32 {
        match self {
            Split::Quad => 4,
            Split::Triangle => 3,
        }
    }

    /// The counts one level further, or none if they do not fit 64 bits.
    pub fn counts(self, c: Counts) -> Option<Counts> {
        let new = match self {
            Split::Quad => Counts {
                vertices: c.vertices.checked_add(c.edges)?.checked_add(c.faces)?,
                edges: c.edges.checked_mul(2)?.checked_add(c.corners)?,
                faces: c.corners,
                corners: c.corners.checked_mul(4)?,
                boundary: c.boundary.checked_mul(2)?,
            },
            Split::Triangle => Counts {
                vertices: c.vertices.checked_add(c.edges)?,
                edges: c.edges.checked_mul(2)?.checked_add(c.corners)?,
                faces: c.faces.checked_mul(4)?,
                corners: c.corners.checked_mul(4)?,
                boundary: c.boundary.checked_mul(2)?,
            },
        };
        Some(new)
    }

    /// The child vertex that takes the place of the parent's `v`.
    #[inline(always)]
    pub fn vertex_point(self, v: u32) -> u32 {
        v
    }

    /// The first of the children born on faces (quad split only).
    #[inline(always)]
    pub fn first_face_point(self, c: &impl Connectivity) -> u32 {
        c.vertices()
    }

    /// The first of the children born on edges.
    #[inline(always)]
    pub fn first_edge_point(self, c: &impl Connectivity) -> u32 {
        match self {
            Split::Quad => c.vertices() + c.faces(),
            Split::Triangle => c.vertices(),
        }
    }

    /// How many child vertices there are.
    pub fn children(self, c: &impl Connectivity) -> u32 {
        self.first_edge_point(c) + c.edges()
    }

    /// The corners of the child faces, for a level that is only shown. Writes the children of parent faces `from..to`
    /// into `out` (all children's corners, `4 * H` long). Cost: about 2 ns a corner.
    pub fn corners(self, c: &impl Connectivity, from: u32, to: u32, out: &mut [u32]) {
        match self {
            Split::Quad => quad::corners(c, from, to, out),
            Split::Triangle => triangle::corners(c, from, to, out),
        }
    }
}

/// One level's half-edges, whichever way they are held.
#[derive(Clone, Debug)]
pub enum Level<'a> {
    /// Level 0: any polygons.
    Base(&'a crate::Topology),
    /// After a quad split.
    Quads(&'a QuadLevel),
    /// After a triangle split.
    Triangles(&'a TriangleLevel),
}

/// Runs `$body` with the connectivity behind a level, compiled for its type.
macro_rules! on {
    ($level:expr, $c:ident => $body:expr) => {
        match $level {
            $crate::split::Level::Base($c) => $body,
            $crate::split::Level::Quads($c) => $body,
            $crate::split::Level::Triangles($c) => $body,
        }
    };
}
pub(crate) use on;

/// The same answers with a branch each: for what need not be fast and should not be compiled three times.
impl Connectivity for Level<'_> {
    #[inline(never)]
    fn vertices(&self) -> u32 {
        on!(self, c => c.vertices())
    }
    #[inline(never)]
    fn edges(&self) -> u32 {
        on!(self, c => c.edges())
    }
    #[inline(never)]
    fn faces(&self) -> u32 {
        on!(self, c => c.faces())
    }
    #[inline(never)]
    fn half_edges(&self) -> u32 {
        on!(self, c => c.half_edges())
    }
    #[inline(never)]
    fn boundary_half_edges(&self) -> u32 {
        on!(self, c => c.boundary_half_edges())
    }
    #[inline(never)]
    fn face_half_edges(&self, f: u32) -> std::ops::Range<u32> {
        on!(self, c => c.face_half_edges(f))
    }
    #[inline(never)]
    fn face(&self, h: u32) -> u32 {
        on!(self, c => c.face(h))
    }
    #[inline(never)]
    fn next(&self, h: u32) -> u32 {
        on!(self, c => c.next(h))
    }
    #[inline(never)]
    fn prev(&self, h: u32) -> u32 {
        on!(self, c => c.prev(h))
    }
    #[inline(never)]
    fn twin(&self, h: u32) -> u32 {
        on!(self, c => c.twin(h))
    }
    #[inline(never)]
    fn origin(&self, h: u32) -> u32 {
        on!(self, c => c.origin(h))
    }
    #[inline(never)]
    fn edge(&self, h: u32) -> u32 {
        on!(self, c => c.edge(h))
    }
    #[inline(never)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        on!(self, c => c.vertex_half_edge(v))
    }
    #[inline(never)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        on!(self, c => c.edge_half_edge(e))
    }
}
