//! Creases: how sharp the edges and vertices of a level are, and what that makes of its points.
//!
//! As OpenSubdiv defines them (T. DeRose, M. Kass, T. Truong, "Subdivision surfaces in character animation", 1998, and its
//! `Sdc::Crease`). An edge's sharpness s says for how many levels it is a crease; from 10 on, and on a boundary, for ever.
//!
//! ```text
//!   sharp edges at v    0 smooth    1 dart    2 crease    3 and more corner          a sharp vertex is a corner
//!
//!        a                 smooth, dart   the scheme's own rule
//!        | s > 0           crease         3/4 v + 1/8 (a + b)
//!        v                 corner         v
//!        | s > 0           edge point     the middle of a sharp edge, else the scheme's own
//!        b
//! ```
//!
//! *Decay.* Both halves of an edge lose 1. By Chaikin's rule the half at v first becomes 3/4 s + 1/4 of the mean of the other
//! semi-sharp edges at v.
//!
//! *Transition.* Where edges end within a step (and with them the rule at v changes), v takes both rules: the sharp one by
//! the mean sharpness of what ends, at most 1, and the softer one by the rest. An edge point does so by its edge's s.
//!
//! *Cuts.* Where a vertex was cut apart (edges of three faces; seams of texture coordinates) all its copies go by all of its
//! edges: `copies.rs`.
//!
//! Memory: 4 bytes an edge and 1 a vertex of a level; levels without marks have none of it. Cost: linear in the sharp edges
//! (times their ends' valences) beside memory that is zero. The poke, which cuts no edge, leaves them as they are. Schemes that
//! take a crease as a rim have their points from `apart.rs`. Limit: splits that turn edges keep infinite sharpness
//! only, and splits that cut vertices apart none.

mod parts;

pub(crate) use parts::{Parts, edge_share, parts};

use crate::FULL;
use crate::apart::Apart;
use crate::copies::{self, Beyond, Place};
use crate::marks::INFINITE;
use crate::mesh::Mesh;
use crate::scheme::{Decay, FaceVarying, Tags};
use crate::split::{Level, Split, mixed, n_way, stored};
use crate::topology::{Connectivity, Topology, is_boundary};

/// How sharp a level is. Edges by their ids; boundary edges are not in it, because they always are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Creases {
    /// One an edge, 0 smooth.
    edges: Vec<f32>,
    /// The edges that are sharp.
    sharp: Vec<u32>,
    /// One a vertex: see the constants below.
    flags: Vec<u8>,
    /// Of the first vertices; later ones are smooth.
    vertices: Vec<f32>,
    /// Sharp edges at other copies of vertices, by rising vertices.
    beyond: Vec<Beyond>,
}

/// The bits of a flag that count sharp edges, at most 3. One of them on a boundary counts as 3: with its two edges it makes
/// a corner.
const EDGES: u8 = 3;
/// A sharp vertex.
const SHARP: u8 = 4;
/// An infinitely sharp vertex.
const KEPT: u8 = 8;
/// A vertex that stays for as long as another: [`Beyond::leans`].
const LEANS: u8 = 16;
/// A vertex where semi-sharp edges end, beyond a cut perhaps.
const FADES: u8 = 32;

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// No sharp edge.
    Smooth,
    /// One.
    Dart,
    /// Two: these, counted as [`spokes`] visits them, the lower first.
    Crease([u32; 2]),
    /// Three or more, or the vertex itself is sharp.
    Corner,
}

/// The children of half-edge `h` that lie on it, at its origin and at its target: twice the same if it is not cut. None of
/// splits that leave edges, or cut them otherwise.
pub(crate) fn halves(parent: &Level<'_>, split: Split, h: u32) -> Option<[u32; 2]> {
    match split {
        Split::Quad => Some([4 * h, 4 * parent.next(h) + 3]),
        Split::Triangle => Some([3 * h, 3 * parent.next(h) + 2]),
        Split::Mixed => Some(mixed::halves(parent, h)),
        Split::Poke => Some([3 * h; 2]),
        Split::Sqrt3 { .. } | Split::Dual { .. } | Split::MidEdge { .. } | Split::NWay { .. } => None,
    }
}

/// The decay of a sharpness by one.
fn less(s: f32) -> f32 {
    if s >= INFINITE { s } else { (s - 1.0).max(0.0) }
}

impl Creases {
    /// The marks of `mesh` on `t`, its own half-edges or those of its texture coordinates (with their rule); none if nothing
    /// is sharp. Cost: linear where something is.
    pub(crate) fn of(mesh: &Mesh, t: &Topology, rule: FaceVarying) -> Option<Creases> {
        if !FULL || mesh.edge_sharpness.is_empty() && mesh.vertex_sharpness.is_empty() {
            return None;
        }
        let own = &mesh.topology;
        let mut out = Creases::with_room(t);
        if !mesh.edge_sharpness.is_empty() {
            for e in 0..t.edges() {
                let h = t.edge_half_edge(e);
                if !is_boundary(t.twin(h)) {
                    out.sharpen(t, h, mesh.edge_sharpness[own.edge(h) as usize]);
                }
            }
            out.meet_boundary(t);
        }
        if !mesh.vertex_sharpness.is_empty() {
            let of = |v: u32| mesh.vertex_sharpness[own.origin(t.vertex_half_edge(v)) as usize];
            out.stay((0..t.vertices()).map(of).collect());
        }
        out.listen(copies::of(mesh, t, rule));
        out.some()
    }

    /// The sharpness of every half-edge and vertex of `t`, and what lies beyond, as these say; none if nothing is sharp.
    /// Cost: linear.
    pub(crate) fn marked_by(
        t: &Topology,
        edge: impl Fn(u32) -> f32,
        vertex: impl Fn(u32) -> f32,
        beyond: Vec<Beyond>,
    ) -> Option<Creases> {
        let mut out = Creases::with_room(t);
        for e in 0..t.edges() {
            let h = t.edge_half_edge(e);
            if !is_boundary(t.twin(h)) {
                out.sharpen(t, h, edge(h));
            }
        }
        out.meet_boundary(t);
        out.stay((0..t.vertices()).map(vertex).collect());
        out.listen(beyond);
        out.some()
    }

    fn with_room(c: &impl Connectivity) -> Creases {
        Creases { edges: vec![0.0; c.edges() as usize], flags: vec![0; c.vertices() as usize], ..Creases::default() }
    }

    /// Notes the sharpness of the edge of `h`, which is not on a boundary.
    fn sharpen(&mut self, c: &impl Connectivity, h: u32, s: f32) {
        if s <= 0.0 {
            return;
        }
        let e = c.edge(h);
        self.edges[e as usize] = s;
        self.sharp.push(e);
        for v in [c.origin(h), c.origin(c.next(h))] {
            let flag = &mut self.flags[v as usize];
            *flag += u8::from(*flag & EDGES < EDGES);
            *flag |= if s < INFINITE { FADES } else { 0 };
        }
    }

    /// Notes where sharp edges meet the boundary. Cost: its length.
    fn meet_boundary(&mut self, c: &impl Connectivity) {
        for r in 0..if self.sharp.is_empty() { 0 } else { c.boundary_half_edges() } {
            let flag = &mut self.flags[c.origin(c.boundary_half_edge(r)) as usize];
            *flag |= if *flag & EDGES > 0 { EDGES } else { 0 };
        }
    }

    /// Notes the sharpness of the first vertices.
    fn stay(&mut self, vertices: Vec<f32>) {
        for (flag, &s) in self.flags.iter_mut().zip(&vertices) {
            *flag |= if s > 0.0 { SHARP } else { 0 } | if s >= INFINITE { KEPT } else { 0 };
        }
        self.vertices = if vertices.iter().any(|&s| s > 0.0) { vertices } else { Vec::new() };
    }

    /// Notes what lies beyond cuts.
    fn listen(&mut self, beyond: Vec<Beyond>) {
        for b in &beyond {
            let flag = &mut self.flags[b.vertex as usize];
            *flag |= FADES
                | if b.leans { LEANS } else { 0 }
                | if b.edges.iter().any(|x| x.1 == Place::Copy) { EDGES } else { 0 };
        }
        self.beyond = beyond;
    }

    fn some(self) -> Option<Creases> {
        (!self.sharp.is_empty() || !self.vertices.is_empty() || !self.beyond.is_empty()).then_some(self)
    }

    /// The sharp edges at other copies of `v`.
    pub(crate) fn beyond(&self, v: u32) -> Option<&Beyond> {
        let found = self.beyond.binary_search_by_key(&v, |b| b.vertex);
        found.ok().map(|i| &self.beyond[i])
    }

    /// What is left one level further. `child` is `parent` after `split`. None if nothing is.
    pub fn below(&self, parent: &Level<'_>, split: Split, child: &Level<'_>, decay: Decay) -> Option<Creases> {
        if !FULL || !split.keeps_vertices() {
            return None;
        }
        let mut out = Creases::with_room(child);
        let left =
            |b: &Beyond| b.below(|s| if split == Split::Poke { s } else { self.half(parent, b.vertex, s, decay) });
        out.listen(self.beyond.iter().filter_map(left).collect());
        if let Split::Sqrt3 { trisect } = split {
            let apart = Apart::turned(parent, self);
            for &e in &self.sharp {
                let h = parent.edge_half_edge(e);
                if apart.is_cut(h) {
                    let thirds = stored::sqrt3_thirds(parent, h, trisect);
                    thirds.into_iter().for_each(|third| out.sharpen(child, third, self.edges[e as usize]));
                }
            }
            out.meet_boundary(child);
            out.stay(self.vertices.iter().map(|&s| if s >= INFINITE { s } else { 0.0 }).collect());
            return out.some();
        }
        if let Split::NWay { n, triangles } = split {
            let places = n_way::Places::new(parent, n, triangles);
            for &e in &self.sharp {
                let (h, s) = (parent.edge_half_edge(e), self.edges[e as usize]);
                for part in 0..n {
                    // Between the ends the crease meets no other.
                    let left = match part {
                        0 => self.half(parent, parent.origin(h), s, decay),
                        _ if part + 1 == n => self.half(parent, parent.origin(parent.next(h)), s, decay),
                        _ => less(s),
                    };
                    out.sharpen(child, places.slot(h, part), left);
                }
            }
            out.meet_boundary(child);
            out.stay(self.vertices.iter().map(|&s| less(s)).collect());
            return out.some();
        }
        for &e in &self.sharp {
            let h = parent.edge_half_edge(e);
            let s = self.edges[e as usize];
            let Some(halves) = halves(parent, split, h) else { break };
            if split == Split::Poke {
                out.sharpen(child, halves[0], s);
                continue;
            }
            for (half, end) in halves.into_iter().zip([h, parent.next(h)]) {
                out.sharpen(child, half, self.half(parent, parent.origin(end), s, decay));
            }
        }
        out.meet_boundary(child);
        out.stay(self.vertices.iter().map(|&s| if split == Split::Poke { s } else { less(s) }).collect());
        out.some()
    }

    /// The sharpness of edge `e`, which is not on a boundary.
    #[inline(always)]
    pub fn edge(&self, e: u32) -> f32 {
        self.edges[e as usize]
    }

    /// The sharpness of the edge of `h`, [`INFINITE`] on a boundary.
    #[inline(always)]
    pub fn along(&self, c: &impl Connectivity, h: u32) -> f32 {
        if is_boundary(c.twin(h)) { INFINITE } else { self.edges[c.edge(h) as usize] }
    }

    /// The sharpness of vertex `v`, without what the boundary rule makes of it.
    pub fn vertex(&self, v: u32) -> f32 {
        self.vertices.get(v as usize).copied().unwrap_or(0.0)
    }

    /// Whether rules for vertices without marks do not hold for `v`.
    #[inline(always)]
    pub(crate) fn marked(&self, v: u32) -> bool {
        self.flags[v as usize] & !FADES > 1
    }

    /// Whether `v` is sharp, or an end of a sharp edge.
    #[cfg(feature = "full")]
    #[inline(always)]
    pub(crate) fn is_marked(&self, v: u32) -> bool {
        self.flags[v as usize] != 0
    }

    /// Whether what becomes of an edge inside a ring of faces can be told from that ring's edges.
    #[cfg(feature = "full")]
    pub(crate) fn is_local(&self, decay: Decay) -> bool {
        let fades = || self.sharp.iter().any(|&e| self.edges[e as usize] < INFINITE);
        self.beyond.is_empty() && (decay == Decay::Uniform || !fades())
    }

    /// Whether `v` is an end of a sharp edge.
    #[inline(always)]
    pub(crate) fn is_on_crease(&self, v: u32) -> bool {
        self.flags[v as usize] & EDGES != 0
    }

    /// Whether `v` itself is infinitely sharp.
    #[inline(always)]
    pub(crate) fn keeps(&self, v: u32) -> bool {
        self.flags[v as usize] & KEPT != 0
    }

    /// The sharpness at `v` of the child of an edge of sharpness `s`.
    #[inline(always)]
    fn half(&self, c: &impl Connectivity, v: u32, s: f32, decay: Decay) -> f32 {
        if decay == Decay::Uniform || s >= INFINITE { less(s) } else { self.chaikin_half(c, v, s) }
    }

    #[inline(never)]
    fn chaikin_half(&self, c: &impl Connectivity, v: u32, s: f32) -> f32 {
        let all = self.survey(c, v);
        chaikin(s, all.sum(), all.semi)
    }
}

/// Chaikin's decay of `s`, one of `count` semi-sharp edges whose sharpness is `sum` together.
fn chaikin(s: f32, sum: f32, count: u32) -> f32 {
    let mixed = if count > 1 { 0.75 * s + 0.25 * ((sum - s) / (count - 1) as f32) } else { s };
    (mixed - 1.0).max(0.0)
}

/// Visits a half-edge of every edge at `v`, in the order of the turn, with the vertex at the other end.
#[inline(always)]
pub fn spokes<C: Connectivity>(c: &C, v: u32, mut visit: impl FnMut(u32, u32)) {
    if let Some(arriving) = c.turn(v, |h| visit(h, c.origin(c.next(h)))) {
        visit(arriving, c.origin(arriving));
    }
}

/// What `v` is on this level, boundary and vertices that are kept included. Cost: the valence.
pub fn at<C: Connectivity>(c: &C, v: u32, tags: &Tags<'_>) -> At {
    match tags.creases {
        _ if tags.is_sharp(c, v) => At::Corner,
        Some(creases) if creases.vertex(v) > 0.0 => At::Corner,
        Some(creases) if creases.flags[v as usize] != 0 => creases.survey(c, v).at(),
        _ if is_boundary(c.twin(c.vertex_half_edge(v))) => {
            let mut faces = 0;
            c.turn(v, |_| faces += 1);
            At::Crease([0, faces])
        }
        _ => At::Smooth,
    }
}

/// The two vertices at the ends of the crease through the marked vertex `v`; none if it is a corner.
#[inline(never)]
pub(crate) fn ends<C: Connectivity>(c: &C, v: u32, tags: &Tags<'_>) -> Option<[u32; 2]> {
    let creases = tags.creases.filter(|creases| creases.vertex(v) <= 0.0)?;
    let found = creases.survey(c, v);
    (found.count == 2).then_some([found.sharp[0].1, found.sharp[1].1])
}
