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

mod counts;
#[cfg(feature = "full")]
pub(crate) mod dual;
pub(crate) mod mid_edge;
pub(crate) mod mixed;
pub(crate) mod n_way;
mod poke;
mod quad;
pub(crate) mod stored;
mod triangle;

#[cfg(feature = "full")]
pub use dual::DualLevel;
pub use n_way::Triangles;
pub use quad::QuadLevel;
pub use stored::FaceKind;
pub use triangle::TriangleLevel;

use crate::apart::Apart;
use crate::crease::Creases;
use crate::topology::Connectivity;
#[cfg(feature = "full")]
use crate::topology::Counts;

/// The splits there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Every face of n corners becomes n quads around a new face point. Takes any polygons.
    Quad,
    /// Every triangle becomes four. Takes triangles only.
    Triangle,
    /// Every triangle becomes four, every other face of n corners n quads. Takes any polygons.
    Mixed,
    /// A face for every face, inner edge and vertex; the vertices are corners. Takes any polygons.
    Dual {
        /// Whether a boundary vertex of one face has two images.
        rounded: bool,
    },
    /// Three triangles for every triangle, turned by 30 degrees. Takes triangles only.
    Sqrt3 {
        /// Whether this step cuts boundary edges in three: every second one.
        trisect: bool,
    },
    /// A face for every face and every vertex; the vertices are edges. Takes any polygons.
    MidEdge {
        /// Whether this step cuts boundary vertices off, which the one before kept: every second one.
        cut: bool,
        /// Whether those of one face in that step before are kept for good.
        corners: bool,
    },
    /// Every face of n corners becomes n triangles around a new face point. Takes any polygons.
    Poke,
    /// Every edge in n parts: triangles become n^2 triangles, other faces quads. Takes any polygons.
    NWay {
        /// At least 2.
        n: u32,
        /// Which faces are cut as triangles.
        triangles: Triangles,
    },
}

/// What the faces of a level look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceShape {
    /// All have three corners.
    Triangles,
    /// All have four corners.
    Quads,
    /// Neither.
    Polygons,
}

impl Split {
    /// What the faces look like after this split of faces that look like `before`.
    pub fn face_shape(self, before: FaceShape) -> FaceShape {
        match self {
            Split::Quad => FaceShape::Quads,
            Split::Triangle | Split::Sqrt3 { .. } | Split::Poke => FaceShape::Triangles,
            Split::NWay { .. } => before,
            Split::Mixed | Split::Dual { .. } | Split::MidEdge { .. } => FaceShape::Polygons,
        }
    }

    /// The split of a run's step `step`, counted from 0.
    pub fn at(self, step: u32) -> Split {
        match self {
            Split::Sqrt3 { .. } => Split::Sqrt3 { trisect: step % 2 == 1 },
            Split::MidEdge { corners, .. } => Split::MidEdge { cut: step % 2 == 1, corners },
            other => other,
        }
    }

    /// Whether levels after this split store their half-edges in full, as level 0 does.
    pub fn stores(self) -> bool {
        !matches!(self, Split::Quad | Split::Triangle)
    }

    /// Whether vertices are split, whatever happens on a rim.
    #[cfg(feature = "full")]
    pub(crate) fn is_dual(self) -> bool {
        matches!(self, Split::Dual { .. })
    }

    /// Whether the vertices of a level are the first of the next.
    pub fn keeps_vertices(self) -> bool {
        !matches!(self, Split::Dual { .. } | Split::MidEdge { .. })
    }

    /// Whether child faces lie in their parents: then texture coordinates take the same split, with seams cut; else they need
    /// charts.
    pub fn keeps_corners(self) -> bool {
        !matches!(self, Split::Dual { .. } | Split::Sqrt3 { .. } | Split::MidEdge { .. })
    }

    /// Whether vertices keep their place and valence in this split of a level of triangles, and new ones are regular:
    /// [`crate::scheme::Tags::first_regular`].
    #[cfg(feature = "full")]
    pub(crate) fn makes_regular(self, level: &Counts, creased: bool) -> bool {
        match self {
            Split::Triangle => true,
            Split::Sqrt3 { .. } => level.boundary == 0 && !creased,
            _ => false,
        }
    }

    /// What only some have a child for ([`crate::scheme::Tags::lone`]): of the dual split the corners of `c` with two images,
    /// by their half-edges, children from `half_edges()` on; of the mid-edge split the corners that are kept, by their
    /// half-edges, children from `edges()` on; of the mixed split the faces that are no triangles, children from
    /// `vertices()` on; of the n-way split its list where it needs one. Cost: linear where there can be any.
    pub(crate) fn lone(self, c: &impl Connectivity) -> Vec<u32> {
        match self {
            _ if !crate::FULL => Vec::new(),
            Split::Dual { rounded: true } => stored::lone_corners(c),
            Split::MidEdge { cut: true, corners: true } => mid_edge::tips(c),
            Split::Mixed => mixed::pointed_faces(c),
            Split::NWay { triangles: Triangles::Some, .. } => n_way::list(c),
            _ => Vec::new(),
        }
    }

    /// Appends the faces of `c` behind the faces that the quad or triangle split makes of it.
    pub(crate) fn parents(self, c: &impl Connectivity, out: &mut Vec<u32>) {
        let half_edges = 0..c.half_edges();
        match self {
            Split::Quad => out.extend(half_edges.map(|h| c.face(h))),
            _ => out.extend(half_edges.map(|h| h / 3).chain(0..c.faces())),
        }
    }

    /// The child vertex that takes the place of the parent's `v`.
    #[inline(always)]
    pub fn vertex_point(self, v: u32) -> u32 {
        v
    }

    /// The first of the children born on faces (quad split and poke).
    #[inline(always)]
    pub fn first_face_point(self, c: &impl Connectivity) -> u32 {
        c.vertices()
    }

    /// The first of the children born on edges (quad and triangle split).
    #[inline(always)]
    pub fn first_edge_point(self, c: &impl Connectivity) -> u32 {
        match self {
            Split::Quad => c.vertices() + c.faces(),
            _ => c.vertices(),
        }
    }

    /// How many child vertices there are. Cost: constant, but where a list is needed.
    pub fn children(self, c: &impl Connectivity) -> u32 {
        match self {
            Split::Quad | Split::Triangle => self.first_edge_point(c) + c.edges(),
            Split::Mixed => c.vertices() + self.lone(c).len() as u32 + c.edges(),
            Split::Dual { .. } => c.half_edges() + self.lone(c).len() as u32,
            Split::Sqrt3 { trisect } => c.vertices() + c.faces() + if trisect { c.boundary_half_edges() } else { 0 },
            Split::MidEdge { cut: false, .. } => c.edges() + c.boundary_half_edges(),
            Split::MidEdge { .. } => c.edges() + self.lone(c).len() as u32,
            Split::Poke => c.vertices() + c.faces(),
            Split::NWay { n, triangles } => n_way::Grid::of(c, n, triangles, &self.lone(c)).vertices(),
        }
    }

    /// The corners of the child faces, for a level that is only shown. Appends the children of parent faces `from..to`
    /// to `out`, where those of the faces before are (all have `4 * H` corners). Cost: about 2 ns a corner.
    pub(crate) fn corners(self, c: &impl Connectivity, from: u32, to: u32, out: &mut Vec<u32>) {
        match self {
            Split::Quad if crate::FULL || c.sure_shape() != Some(FaceShape::Triangles) => {
                quad::corners(c, from, to, out)
            }
            Split::Triangle if crate::FULL || c.sure_shape() != Some(FaceShape::Quads) => {
                triangle::corners(c, from, to, out)
            }
            _ => unreachable!("a stored split cuts a whole level at once"),
        }
    }

    /// The knot intervals of the next level, for splits that carry them: the dual one. `lone` is [`Split::lone`] of `c`.
    pub(crate) fn knots(self, c: &Level<'_>, knots: &[f32], lone: &[u32]) -> Vec<f32> {
        match (self, c) {
            (Split::Dual { .. }, Level::Base(t)) if crate::FULL => stored::dual_knots(t, knots, lone),
            _ => Vec::new(),
        }
    }

    /// The same, as simple as `c` lets it be: without a rim there is nothing to cut in three.
    fn simplest(self, c: &crate::Topology, creases: Option<&Creases>) -> Split {
        match self {
            Split::Sqrt3 { trisect } => {
                Split::Sqrt3 { trisect: trisect && (c.boundary_half_edges() > 0 || creases.is_some()) }
            }
            other => other,
        }
    }

    /// The faces of the next level, for splits that store it. `c` is a stored level, `creases` its own.
    pub(crate) fn cut(self, c: &crate::Topology, creases: Option<&Creases>) -> stored::Cut {
        match self.simplest(c, creases) {
            _ if !crate::FULL => unreachable!("no scheme of this build stores levels"),
            Split::Sqrt3 { trisect } => match creases {
                Some(creases) => stored::sqrt3(&Apart::turned(c, creases), c, trisect),
                None => stored::sqrt3(c, c, trisect),
            },
            Split::Mixed => mixed::cut(c, &self.lone(c)),
            Split::MidEdge { cut, .. } => mid_edge::faces(c, cut, &self.lone(c)),
            Split::Poke => poke::faces(c),
            Split::NWay { n, triangles } => n_way::faces(c, n, triangles, &self.lone(c)),
            _ => stored::dual(c, &self.lone(c)),
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
    /// After a second dual split where there is no rim.
    #[cfg(feature = "full")]
    Dual(&'a DualLevel),
}

/// Runs `$body` with the connectivity behind a level, compiled for its type; but for dual levels, which are met by dual steps
/// alone.
macro_rules! on {
    ($level:expr, $c:ident => $body:expr) => {
        match $level {
            $crate::split::Level::Base($c) => $body,
            $crate::split::Level::Quads($c) => $body,
            $crate::split::Level::Triangles($c) => $body,
            #[cfg(feature = "full")]
            $crate::split::Level::Dual(_) => unreachable!("a step says when it needs stored half-edges"),
        }
    };
}
pub(crate) use on;

/// [`on`], dual levels among them.
macro_rules! any {
    ($level:expr, $c:ident => $body:expr) => {
        match $level {
            #[cfg(feature = "full")]
            Level::Dual($c) => $body,
            other => on!(other, $c => $body),
        }
    };
}

/// The same answers with a branch each: for what need not be fast and should not be compiled three times.
impl Connectivity for Level<'_> {
    #[inline(never)]
    fn vertices(&self) -> u32 {
        any!(self, c => c.vertices())
    }
    #[inline(never)]
    fn edges(&self) -> u32 {
        any!(self, c => c.edges())
    }
    #[inline(never)]
    fn faces(&self) -> u32 {
        any!(self, c => c.faces())
    }
    #[inline(never)]
    fn half_edges(&self) -> u32 {
        any!(self, c => c.half_edges())
    }
    #[inline(never)]
    fn boundary_half_edges(&self) -> u32 {
        any!(self, c => c.boundary_half_edges())
    }
    #[inline(never)]
    fn boundary_half_edge(&self, rank: u32) -> u32 {
        any!(self, c => c.boundary_half_edge(rank))
    }
    #[inline(never)]
    fn face_half_edges(&self, f: u32) -> std::ops::Range<u32> {
        any!(self, c => c.face_half_edges(f))
    }
    #[inline(never)]
    fn face(&self, h: u32) -> u32 {
        any!(self, c => c.face(h))
    }
    #[inline(never)]
    fn next(&self, h: u32) -> u32 {
        any!(self, c => c.next(h))
    }
    #[inline(never)]
    fn prev(&self, h: u32) -> u32 {
        any!(self, c => c.prev(h))
    }
    #[inline(never)]
    fn twin(&self, h: u32) -> u32 {
        any!(self, c => c.twin(h))
    }
    #[inline(never)]
    fn origin(&self, h: u32) -> u32 {
        any!(self, c => c.origin(h))
    }
    #[inline(never)]
    fn edge(&self, h: u32) -> u32 {
        any!(self, c => c.edge(h))
    }
    #[inline(never)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        any!(self, c => c.vertex_half_edge(v))
    }
    #[inline(never)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        any!(self, c => c.edge_half_edge(e))
    }
}
