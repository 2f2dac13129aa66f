//! Indexed half-edges, structure of arrays, and the view of them that every scheme reads.
//!
//! A half-edge is a corner of a face together with the side that leaves it, so half-edge `h` *is* corner `h` of the face
//! list and faces are contiguous runs. The twin is the same side seen from the neighbouring face.
//!
//! ```text
//!        next(h)            h leaves origin(h) and bounds face(h), which lies to its left
//!     <-----------.
//!     |   face    ^ h       twin(h): the neighbour's half-edge, or BOUNDARY | .. = !rank
//!     |           |  | twin(h)          on a boundary; rank numbers the boundary half-edges
//!     `---------->o  v
//!       prev(h)   origin(h)
//! ```
//!
//! Around a vertex one turns counter-clockwise by `h -> twin(prev(h))`. The half-edge stored for a vertex is the one to
//! start at: on a boundary, the outgoing boundary half-edge, from which the turn visits every face.
//!
//! [`Connectivity`] is what a scheme sees. [`Topology`] stores everything (level 0, any polygons); the implicit levels of
//! [`crate::split`] answer most of it by arithmetic. Limit: 2^31 - 1 half-edges a level (the top bit says boundary).

use crate::split::FaceShape;
use std::ops::Range;

pub use crate::validate::{Broken, validate};

/// The bit of a twin that says there is none.
pub const BOUNDARY: u32 = 1 << 31;

/// Whether a value of [`Connectivity::twin`] means that the half-edge lies on a boundary.
#[inline(always)]
pub fn is_boundary(twin: u32) -> bool {
    twin & BOUNDARY != 0
}

/// The rank of a boundary half-edge, from its twin field.
#[inline(always)]
pub fn boundary_rank(twin: u32) -> u32 {
    !twin
}

/// Read access to the half-edges of one level. All ids are dense and 0-based; every answer takes constant time.
pub trait Connectivity {
    /// What all faces look like, where the type alone says so: lets a compiler leave out what cannot be.
    #[inline(always)]
    fn sure_shape(&self) -> Option<FaceShape> {
        None
    }
    /// Faces from here on are quads away from any boundary, as far as the type says so.
    #[inline(always)]
    fn first_quad(&self) -> u32 {
        self.faces()
    }
    /// Number of vertices.
    fn vertices(&self) -> u32;
    /// Number of edges.
    fn edges(&self) -> u32;
    /// Number of faces.
    fn faces(&self) -> u32;
    /// Number of half-edges (corners).
    fn half_edges(&self) -> u32;
    /// Number of half-edges without a twin.
    fn boundary_half_edges(&self) -> u32;
    /// The half-edge of a boundary rank.
    fn boundary_half_edge(&self, rank: u32) -> u32;
    /// The half-edges of face `f`, in order.
    fn face_half_edges(&self, f: u32) -> Range<u32>;
    /// The face left of `h`.
    fn face(&self, h: u32) -> u32;
    /// The following half-edge of the same face.
    fn next(&self, h: u32) -> u32;
    /// The preceding half-edge of the same face.
    fn prev(&self, h: u32) -> u32;
    /// The opposite half-edge, or a value with [`BOUNDARY`] set that holds `!rank`.
    fn twin(&self, h: u32) -> u32;
    /// The vertex that `h` leaves.
    fn origin(&self, h: u32) -> u32;
    /// The edge that `h` is one side of.
    fn edge(&self, h: u32) -> u32;
    /// The half-edge to start turning at (module text).
    fn vertex_half_edge(&self, v: u32) -> u32;
    /// The half-edge that owns edge `e`; the only one on a boundary.
    fn edge_half_edge(&self, e: u32) -> u32;

    /// Where the turn around the origin of `h` that comes by `h` starts. (Every vertex has one turn, but on a mesh that is
    /// looked at as if it were cut.)
    #[inline(always)]
    fn first_spoke(&self, h: u32) -> u32 {
        self.vertex_half_edge(self.origin(h))
    }
    /// Whether `h` lies on the rim: a boundary that counts. Where charts of texture coordinates are refined, their seams are
    /// boundaries whose ranks lie behind.
    #[inline(always)]
    fn is_rim(&self, h: u32) -> bool {
        let twin = self.twin(h);
        is_boundary(twin) && boundary_rank(twin) < self.boundary_half_edges()
    }
    /// Whether `v` lies on a boundary and in one face.
    #[inline(always)]
    fn is_tip(&self, v: u32) -> bool {
        let start = self.vertex_half_edge(v);
        is_boundary(self.twin(start)) && is_boundary(self.twin(self.prev(start)))
    }
    /// Whether marks say that `v` stays where it is, and curves end there: on a mesh that is looked at as if it were cut.
    #[inline(always)]
    fn is_pinned(&self, _v: u32) -> bool {
        false
    }

    /// Calls `visit` with the half-edges that leave `v`, counter-clockwise. Returns the last spoke if `v` lies on a
    /// boundary: the half-edge that *arrives* at `v` along the boundary. Cost: the valence.
    #[inline(always)]
    fn turn(&self, v: u32, visit: impl FnMut(u32)) -> Option<u32> {
        self.turn_from(self.vertex_half_edge(v), visit)
    }

    /// [`Connectivity::turn`] around the vertex that `start` leaves, from there on: all the way round, or to the boundary.
    #[inline(always)]
    fn turn_from(&self, start: u32, mut visit: impl FnMut(u32)) -> Option<u32> {
        let mut h = start;
        loop {
            visit(h);
            let arriving = self.prev(h);
            h = self.twin(arriving);
            if is_boundary(h) {
                return Some(arriving);
            }
            if h == start {
                return None;
            }
        }
    }

    /// Counts of this level. Cost: linear.
    fn counts(&self) -> Counts {
        let (mut rim, mut tips) = ([0; 4], 0);
        for r in 0..self.boundary_half_edges() {
            let (h, mut faces) = (self.boundary_half_edge(r), 0);
            self.turn(self.origin(h), |_| faces += 1);
            rim[faces.min(4) - 1] += 1;
            tips += u64::from(faces == 1 && self.face_half_edges(self.face(h)).len() == 3);
        }
        let is_digon = |v: u32| {
            let h = self.vertex_half_edge(v);
            let t = self.twin(self.prev(h));
            !is_boundary(self.twin(h)) && !is_boundary(t) && self.twin(self.prev(t)) == h
        };
        let is_followed = |spoke: u32| is_digon(self.origin(self.next(spoke)));
        let (mut digons, mut chains) = (0, [0; CHAINS]);
        for v in (0..self.vertices()).filter(|v| is_digon(*v)) {
            digons += 1;
            let h = self.vertex_half_edge(v);
            let other = self.twin(self.prev(h));
            // From one end of a chain to the other: each chain is met twice.
            for (back, mut spoke) in [(h, other), (other, h)] {
                if is_followed(back) {
                    continue;
                }
                let mut length = 1;
                while is_followed(spoke) {
                    length += 1;
                    spoke = self.twin(self.prev(self.twin(spoke)));
                }
                chains[..length.min(CHAINS)].iter_mut().for_each(|n| *n += 1);
            }
        }
        chains.iter_mut().for_each(|n| *n /= 2);
        let is_triangle = |f: u32| self.face_half_edges(f).len() == 3;
        let sides = (0..self.boundary_half_edges()).filter(|&r| is_triangle(self.face(self.boundary_half_edge(r))));
        let triangles = [(0..self.faces()).filter(|&f| is_triangle(f)).count() as u64, sides.count() as u64];
        Counts {
            triangles,
            vertices: self.vertices().into(),
            edges: self.edges().into(),
            faces: self.faces().into(),
            corners: self.half_edges().into(),
            boundary: self.boundary_half_edges().into(),
            rim,
            tips,
            digons,
            chains,
        }
    }
}

/// How many mid-edge steps a chain of inner vertices of two faces is followed for: more than 32-bit levels can have.
pub const CHAINS: usize = 30;

/// How many of everything there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Faces.
    pub faces: u64,
    /// Corners of all faces (half-edges).
    pub corners: u64,
    /// Half-edges on a boundary.
    pub boundary: u64,
    /// Triangles, and their half-edges on a boundary: what the mixed split depends on. Not predicted after dual and
    /// mid-edge splits, where both are 0.
    pub triangles: [u64; 2],
    /// Boundary vertices of one face, of two, of three, and of more; what dual splits make of a rim depends on them. Those of
    /// three and more may all be counted at three.
    pub rim: [u64; 4],
    /// Boundary vertices of one face that is a triangle.
    pub tips: u64,
    /// Inner vertices of two faces.
    pub digons: u64,
    /// Of these, chains from neighbour to neighbour that are longer than 0, 1, 2 ..; closed ones are left out. The mid-edge
    /// split takes one from each.
    pub chains: [u32; CHAINS],
}

impl Counts {
    /// V - E + F.
    pub fn euler(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.faces as i64
    }
}

/// Half-edges of a polygon mesh, every array stored. Manifold by construction: every vertex has one fan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    pub(crate) offsets: Vec<u32>,
    pub(crate) twin: Vec<u32>,
    pub(crate) origin: Vec<u32>,
    pub(crate) edge: Vec<u32>,
    /// None where all faces are triangles: [`faces_of`].
    pub(crate) face: Vec<u32>,
    pub(crate) vertex_half_edge: Vec<u32>,
    pub(crate) edge_half_edge: Vec<u32>,
    pub(crate) boundary: Vec<u32>,
}

impl Topology {
    /// The start of each face in the half-edges, and their number at the end.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The origin of every half-edge: the corners of the faces.
    pub fn origins(&self) -> &[u32] {
        &self.origin
    }

    /// The same half-edges, stored in full. Cost: linear, about 40 bytes a half-edge.
    pub fn of(c: &impl Connectivity) -> Topology {
        let half_edges = 0..c.half_edges();
        let starts = (0..c.faces()).map(|f| c.face_half_edges(f).start);
        let offsets: Vec<u32> = starts.chain([c.half_edges()]).collect();
        Topology {
            face: faces_of(&offsets),
            offsets,
            twin: half_edges.clone().map(|h| c.twin(h)).collect(),
            origin: half_edges.clone().map(|h| c.origin(h)).collect(),
            edge: half_edges.map(|h| c.edge(h)).collect(),
            vertex_half_edge: (0..c.vertices()).map(|v| c.vertex_half_edge(v)).collect(),
            edge_half_edge: (0..c.edges()).map(|e| c.edge_half_edge(e)).collect(),
            boundary: (0..c.boundary_half_edges()).map(|r| c.boundary_half_edge(r)).collect(),
        }
    }

    /// The number of corners that all faces have, if they agree.
    pub fn uniform_degree(&self) -> Option<u32> {
        let first = self.offsets.get(1)?;
        self.offsets.windows(2).all(|w| w[1] - w[0] == *first).then_some(*first)
    }

    /// Assembles half-edges from faces and matched sides. `class[h]` names the vertex before splitting, `mate[h]` the
    /// opposite half-edge or `u32::MAX`. A class whose corners form several fans becomes several vertices: the first fan
    /// keeps the place of the class in order, the others are appended. Returns also the class of every vertex.
    /// Cost: linear, one turn around every vertex.
    pub(crate) fn assemble(offsets: Vec<u32>, class: &[u32], classes: usize, mate: &[u32]) -> (Topology, Vec<u32>) {
        const UNSET: u32 = u32::MAX;
        let half_edges = class.len();
        let face = faces_of(&offsets);
        // The half-edge before or behind, the face's first and last half-edge being neighbours.
        let around = |h: u32, back: bool| -> u32 {
            let face = match face.get(h as usize) {
                Some(&f) => offsets[f as usize]..offsets[f as usize + 1],
                None => h / 3 * 3..h / 3 * 3 + 3,
            };
            match back {
                true if h == face.start => face.end - 1,
                true => h - 1,
                false if h + 1 == face.end => face.start,
                false => h + 1,
            }
        };

        // Classes in use keep their order: that is the file's numbering with isolated vertices left out.
        let mut id = vec![UNSET; classes];
        for &c in class {
            id[c as usize] = 0;
        }
        let mut vertex_class = Vec::new();
        for (c, slot) in id.iter_mut().enumerate().filter(|(_, slot)| **slot == 0) {
            *slot = vertex_class.len() as u32;
            vertex_class.push(c as u32);
        }

        let mut origin = vec![UNSET; half_edges];
        let mut vertex_half_edge = vec![UNSET; vertex_class.len()];
        for seed in 0..half_edges as u32 {
            if origin[seed as usize] != UNSET {
                continue;
            }
            let c = class[seed as usize];
            let mut v = id[c as usize];
            if vertex_half_edge[v as usize] != UNSET {
                v = vertex_class.len() as u32;
                vertex_class.push(c);
                vertex_half_edge.push(UNSET);
            }
            // Counter-clockwise all the way round, or to a boundary and then clockwise to the other: there a turn starts.
            let mut start = seed;
            let mut h = seed;
            loop {
                origin[h as usize] = v;
                h = mate[around(h, true) as usize];
                if h == seed {
                    break;
                }
                if h == UNSET {
                    while mate[start as usize] != UNSET {
                        start = around(mate[start as usize], false);
                        origin[start as usize] = v;
                    }
                    break;
                }
            }
            vertex_half_edge[v as usize] = start;
        }

        let mut twin = vec![0; half_edges];
        let mut edge = vec![0; half_edges];
        let mut edge_half_edge = Vec::with_capacity(half_edges / 2);
        let mut boundary = Vec::new();
        for h in 0..half_edges as u32 {
            let t = mate[h as usize];
            if t == UNSET {
                twin[h as usize] = !(boundary.len() as u32);
                boundary.push(h);
            } else {
                twin[h as usize] = t;
            }
            edge[h as usize] = if t < h {
                edge[t as usize]
            } else {
                edge_half_edge.push(h);
                edge_half_edge.len() as u32 - 1
            };
        }
        let topology = Topology { offsets, twin, origin, edge, face, vertex_half_edge, edge_half_edge, boundary };
        (topology, vertex_class)
    }

    /// The same where every one of `vertices` has corners, and one fan: splits of half-edges make such. `mate` as there, and
    /// equal results, by passes in order over the half-edges. Cost: linear, about a quarter of what [`Topology::assemble`] takes.
    pub(crate) fn manifold(offsets: Vec<u32>, origin: Vec<u32>, vertices: u32, mate: Vec<u32>) -> Topology {
        let face = faces_of(&offsets);
        // Downwards, so that the first half-edge of a vertex is the one that stays.
        let mut vertex_half_edge = vec![0; vertices as usize];
        for (h, &v) in origin.iter().enumerate().rev() {
            vertex_half_edge[v as usize] = h as u32;
        }
        let mut twin = mate;
        let mut edge = vec![0; origin.len()];
        let sides = twin.len() + twin.iter().filter(|&&t| t == u32::MAX).count();
        // Which side of an edge comes first cannot be foreseen: no branch. What is written behind the last edge does not stay.
        let mut edge_half_edge = vec![0; sides / 2 + 1];
        let (mut edges, mut boundary) = (0, Vec::new());
        for h in 0..origin.len() as u32 {
            let t = twin[h as usize];
            edge_half_edge[edges as usize] = h;
            edge[h as usize] = edges;
            edge[h as usize] = edge[t.min(h) as usize];
            edges += u32::from(t > h);
            if t == u32::MAX {
                twin[h as usize] = !(boundary.len() as u32);
                vertex_half_edge[origin[h as usize] as usize] = h;
                boundary.push(h);
            }
        }
        edge_half_edge.truncate(edges as usize);
        Topology { offsets, twin, origin, edge, face, vertex_half_edge, edge_half_edge, boundary }
    }
}

/// The face of every half-edge; none where all are triangles, whose is arithmetic.
fn faces_of(offsets: &[u32]) -> Vec<u32> {
    let runs = offsets.windows(2).map(|w| w[1] - w[0]);
    if runs.clone().all(|n| n == 3) {
        return Vec::new();
    }
    let mut face = Vec::with_capacity(offsets.last().map_or(0, |&n| n as usize));
    for (f, n) in (0..).zip(runs) {
        face.resize(face.len() + n as usize, f);
    }
    face
}

impl Connectivity for Topology {
    #[inline(always)]
    fn vertices(&self) -> u32 {
        self.vertex_half_edge.len() as u32
    }
    #[inline(always)]
    fn edges(&self) -> u32 {
        self.edge_half_edge.len() as u32
    }
    #[inline(always)]
    fn faces(&self) -> u32 {
        self.offsets.len().saturating_sub(1) as u32
    }
    #[inline(always)]
    fn half_edges(&self) -> u32 {
        self.twin.len() as u32
    }
    #[inline(always)]
    fn boundary_half_edges(&self) -> u32 {
        self.boundary.len() as u32
    }
    #[inline(always)]
    fn boundary_half_edge(&self, rank: u32) -> u32 {
        self.boundary[rank as usize]
    }
    #[inline(always)]
    fn face_half_edges(&self, f: u32) -> Range<u32> {
        if self.face.is_empty() {
            return 3 * f..3 * f + 3;
        }
        self.offsets[f as usize]..self.offsets[f as usize + 1]
    }
    #[inline(always)]
    fn face(&self, h: u32) -> u32 {
        if self.face.is_empty() {
            return h / 3;
        }
        self.face[h as usize]
    }
    #[inline(always)]
    fn next(&self, h: u32) -> u32 {
        let f = self.face_half_edges(self.face(h));
        if h + 1 == f.end { f.start } else { h + 1 }
    }
    #[inline(always)]
    fn prev(&self, h: u32) -> u32 {
        let f = self.face_half_edges(self.face(h));
        if h == f.start { f.end - 1 } else { h - 1 }
    }
    #[inline(always)]
    fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }
    #[inline(always)]
    fn origin(&self, h: u32) -> u32 {
        self.origin[h as usize]
    }
    #[inline(always)]
    fn edge(&self, h: u32) -> u32 {
        self.edge[h as usize]
    }
    #[inline(always)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        self.vertex_half_edge[v as usize]
    }
    #[inline(always)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        self.edge_half_edge[e as usize]
    }
}
