//! The dual split where no rim is: from its second step on every vertex has four faces, and a level stores twin and origin only.
//!
//! ```text
//!     | v-face |        half-edges of a level below one of H, with E = H/2 edges: f-faces [0, H), e-faces [H, 3H) in the order
//!   - g ------ h -      of edges, v-faces [3H, 4H). Corner h of a face is child vertex h, with a half-edge in each of its four
//!     | e-face |        faces, in turn: h itself (f), along the edge before h (e), around the origin of h (v), along the edge
//!   - . ------ . -      of h (e). The v-face around v has corners k0 .. k3, the turn around v: the first is v.
//!     | f-face |
//! ```
//!
//! For half-edge h with next n, prev p, twin t, edge e and origin v of the parent, h the owner of e (else 2 in place of 0):
//!
//! ```text
//!   child     h          H + 4e    H + 4e + 1            H + 4e + 2   H + 4e + 3            3H + 4v + j
//!   twin      H + 4e     h         v-side that ends      t            v-side that ends      behind the e-side along k(j+1)
//!                                  in corner h                        in corner t
//!   origin    h          n         h                     n(t)         t                     k(j)
//!   edge      h          of twin   H + 2e                of twin      H + 2e + 1            of twin
//! ```
//!
//! The faces of the first such level keep their corners, as many as they have, and are the first ones of every level; all
//! others are quads. The same half-edges as [`super::stored`] gives, which makes the first level and all that have a rim.
//! Cost: 2 ns a half-edge, 8 bytes.

use super::stored::{Cut, FaceKind};
use crate::topology::Connectivity;
use std::ops::Range;

/// Half-edges of such a level: 32 bytes a quad.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DualLevel {
    /// Where the faces of any number of corners begin, and where these end.
    offsets: Vec<u32>,
    /// Of their half-edges.
    face: Vec<u32>,
    twin: Vec<u32>,
    origin: Vec<u32>,
}

/// Which spoke of its origin `h` is, counted from the first, on a level of `vertices`, all of four faces.
#[inline(always)]
fn place(vertices: u32, h: u32) -> u32 {
    match h {
        _ if h < vertices => 0,
        _ if h >= 3 * vertices => 2,
        // The sides of an e-face.
        _ => [1, 3][(h - vertices) as usize & 1],
    }
}

/// The half-edges that leave `v` on a level whose vertices all have four faces.
#[inline(always)]
fn spokes(c: &impl Connectivity, v: u32) -> [u32; 4] {
    let along = c.twin(c.prev(v));
    [v, along, c.twin(c.prev(along)), c.next(c.twin(v))]
}

/// Appends the corners of the faces below `c`.
fn corners(c: &impl Connectivity, out: &mut Vec<u32>) {
    out.reserve_exact(4 * c.half_edges() as usize);
    out.extend(0..c.half_edges());
    for h in owners(c) {
        let t = c.twin(h);
        out.extend_from_slice(&[c.next(h), h, c.next(t), t]);
    }
    (0..c.vertices()).for_each(|v| out.extend_from_slice(&spokes(c, v)));
}

/// The half-edges that own edges, in the order of these.
fn owners(c: &impl Connectivity) -> impl Iterator<Item = u32> {
    let (h, v) = (c.half_edges(), c.vertices());
    (0..v).chain((v + 1..h - v).step_by(2))
}

/// For each face below `c` the face that it belongs to, as [`Cut::source`] has it.
pub(crate) fn parents(c: &impl Connectivity) -> Vec<u32> {
    let mut parents = Vec::with_capacity((c.faces() + c.edges() + c.vertices()) as usize);
    parents.extend(0..c.faces());
    parents.extend(owners(c).map(|h| c.face(h)));
    parents.extend((0..c.vertices()).map(|v| c.face(v)));
    parents
}

impl DualLevel {
    /// The level below one that the dual split made of a level without rim and inner vertices of two faces.
    pub(crate) fn below(c: &impl Connectivity) -> DualLevel {
        let (half_edges, vertices) = (c.half_edges(), c.vertices());
        let (first_edge, first_vertex) = (half_edges, 3 * half_edges);
        let mut level = DualLevel { twin: Vec::with_capacity(4 * half_edges as usize), ..DualLevel::default() };
        let odd = c.first_quad();
        level.offsets.extend((0..odd).map(|f| c.face_half_edges(f).start));
        level.offsets.push(if odd < c.faces() { c.face_half_edges(odd).start } else { half_edges });
        level.face.extend((0..level.offsets[odd as usize]).map(|h| c.face(h)));
        corners(c, &mut level.origin);
        // The side of an f-face along h.
        let along = |h: u32| first_edge + 4 * c.edge(h) + if h < c.twin(h) { 0 } else { 2 };
        level.twin.extend((0..half_edges).map(along));
        for h in owners(c) {
            let t = c.twin(h);
            let around = |h: u32, v: u32| first_vertex + 4 * v + (place(vertices, h) + 3) % 4;
            level.twin.extend_from_slice(&[h, around(h, c.origin(h)), t, around(t, c.origin(c.next(h)))]);
        }
        for v in 0..vertices {
            let [k0, k1, k2, k3] = spokes(c, v);
            level.twin.extend_from_slice(&[along(k1) + 1, along(k2) + 1, along(k3) + 1, along(k0) + 1]);
        }
        level
    }

    /// The faces below such a level, for a level that is only shown.
    pub(crate) fn cut(c: &impl Connectivity) -> Cut {
        let (faces, edges, vertices) = (c.faces(), c.edges(), c.vertices());
        let mut cut = Cut { source: parents(c), ..Cut::default() };
        let all = cut.source.len();
        cut.kinds.reserve_exact(all);
        cut.offsets.reserve_exact(all + 1);
        cut.offsets.extend((0..faces).map(|f| c.face_half_edges(f).start));
        cut.offsets.extend((0..=edges + vertices).map(|i| c.half_edges() + 4 * i));
        corners(c, &mut cut.corners);
        for (kind, count) in [(FaceKind::Face, faces), (FaceKind::Edge, edges), (FaceKind::Vertex, vertices)] {
            cut.kinds.resize(cut.kinds.len() + count as usize, kind);
        }
        cut
    }

    /// Gives up which vertices half-edges leave: the faces below ([`DualLevel::cut`]) follow from twins.
    pub(crate) fn shed_origins(&mut self) {
        self.origin = Vec::new();
    }

    /// Where quads begin.
    #[inline(always)]
    fn head(&self) -> u32 {
        self.face.len() as u32
    }
}

impl Connectivity for DualLevel {
    #[inline(always)]
    fn first_quad(&self) -> u32 {
        self.offsets.len() as u32 - 1
    }
    #[inline(always)]
    fn vertices(&self) -> u32 {
        self.half_edges() / 4
    }
    #[inline(always)]
    fn edges(&self) -> u32 {
        self.half_edges() / 2
    }
    #[inline(always)]
    fn faces(&self) -> u32 {
        self.first_quad() + (self.half_edges() - self.head()) / 4
    }
    #[inline(always)]
    fn half_edges(&self) -> u32 {
        self.twin.len() as u32
    }
    #[inline(always)]
    fn boundary_half_edges(&self) -> u32 {
        0
    }
    fn boundary_half_edge(&self, _: u32) -> u32 {
        unreachable!("there is no boundary")
    }
    #[inline(always)]
    fn face_half_edges(&self, f: u32) -> Range<u32> {
        match f.checked_sub(self.first_quad()) {
            Some(quad) => self.head() + 4 * quad..self.head() + 4 * quad + 4,
            None => self.offsets[f as usize]..self.offsets[f as usize + 1],
        }
    }
    #[inline(always)]
    fn face(&self, h: u32) -> u32 {
        match self.face.get(h as usize) {
            Some(&f) => f,
            None => self.first_quad() + (h - self.head()) / 4,
        }
    }
    #[inline(always)]
    fn next(&self, h: u32) -> u32 {
        let face = self.face_half_edges(self.face(h));
        if h + 1 == face.end { face.start } else { h + 1 }
    }
    #[inline(always)]
    fn prev(&self, h: u32) -> u32 {
        let face = self.face_half_edges(self.face(h));
        if h == face.start { face.end - 1 } else { h - 1 }
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
        let parent = self.vertices();
        // Sides 1 and 3 of e-faces and those of f-faces own edges: the lower one of every two.
        let h = h.min(self.twin(h));
        if h < parent { h } else { parent + (h - parent) / 2 }
    }
    #[inline(always)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        v
    }
    #[inline(always)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        let parent = self.vertices();
        if e < parent { e } else { parent + 2 * (e - parent) + 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::split::{Level, Split, stored};
    use crate::topology::{Topology, validate};
    use crate::{Mesh, SHAPES, Weld};

    /// Arithmetic gives the half-edges and faces that the split gives in general.
    #[test]
    fn levels_are_those_of_the_general_split() {
        let split = Split::Dual { rounded: false };
        let mut closed = 0;
        for shape in SHAPES {
            let (mesh, _) = Mesh::build(&(shape.build)(), Weld::Off).unwrap();
            let counts = mesh.counts();
            if counts.boundary > 0 || counts.digons > 0 {
                continue;
            }
            closed += 1;
            let general = |t: &Topology| split.cut(t, None).connect(t, split, split.children(t), None);
            let first = general(&mesh.topology);
            assert_eq!(DualLevel::cut(&first), stored::dual(&first, &[]), "{}", shape.name);
            assert_eq!(parents(&first), stored::dual(&first, &[]).source, "{}", shape.name);
            let (mut level, mut expected) = (DualLevel::below(&first), general(&first));
            for step in 2..4 {
                let what = format!("{}, level {step}", shape.name);
                assert_eq!(Topology::of(&level), expected, "{what}");
                validate(&Level::Dual(&level)).unwrap();
                let around = (0..level.half_edges()).map(|h| (level.next(h), level.prev(h), level.face(h)));
                let theirs = (0..level.half_edges()).map(|h| (expected.next(h), expected.prev(h), expected.face(h)));
                assert!(around.eq(theirs), "{what}");
                assert_eq!(DualLevel::cut(&level), stored::dual(&expected, &[]), "{what}");
                assert_eq!(level.counts(), expected.counts(), "{what}");
                (level, expected) = (DualLevel::below(&level), general(&expected));
            }
        }
        assert!(closed > 5, "only {closed} models have no rim");
    }
}
