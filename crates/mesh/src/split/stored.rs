//! Splits whose faces are not all alike: they say which faces there are, and the half-edges are stored in full.
//!
//! ```text
//!   dual (Doo-Sabin)                        sqrt3 (Kobbelt)
//!    .-------------.                                  w
//!    |  .-------.  |  f-face: inside a face         / | \       a triangle for every half-edge h = (v, w):
//!    |  |   f   |  |  e-face: across an edge      c   |   c'    v, the other face's centre, its own face's centre;
//!    |  '-------'  |  v-face: around a vertex       \ | /       every edge turns to join two centres
//!    '------e------'                                  v
//!   child vertex of corner h: h             child vertices: old [0, V) | faces [V, V + F)
//! ```
//!
//! Dual on a boundary: there are no e-faces along it, and a v-face only around vertices of three or more faces, whose last
//! side lies on the new boundary: without it a notch would open there. The image of a boundary vertex in its first and
//! last face is a point of the curve's corner cutting. A vertex of one face has one image, or two if corners are to be
//! rounded; then its face gains a side.
//!
//! Sqrt3 on a boundary: edges there cannot turn. In every second step (`trisect`) they are cut in three instead: the face
//! of a boundary edge gets two points on it, the first in place of its centre. Every such face has one boundary edge then,
//! because the step before made it so.
//!
//! ```text
//!            apex              P1 = V + f            triangle of the boundary half-edge b: P1, P2, apex
//!           /    \             P2 = V + F + rank     the half-edge after b sees P2 as its face's centre, others P1
//!          / \  / \
//!         b0-P1-P2-b1
//! ```
//!
//! Sqrt3 on a crease (Kobbelt's feature lines): two rims that lie on each other. Its edges are not turned, and cut in three
//! where rims are. Both faces have a point of their own there: P2 of one is P1 of the other, and no vertex more than else.
//!
//! Others have files of their own. Cost: linear. Twins are arithmetic.

use crate::apart::Apart;
use crate::connect::UNMATCHED;
use crate::crease::Creases;
use crate::topology::{Connectivity, Topology, boundary_rank, is_boundary};

/// What a child face was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceKind {
    /// A face.
    Face,
    /// An edge.
    Edge,
    /// A vertex.
    Vertex,
}

/// The faces of a child level.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cut {
    pub offsets: Vec<u32>,
    pub corners: Vec<u32>,
    /// For each face the parent's face that it belongs to.
    pub source: Vec<u32>,
    /// What each face was made from; empty where all are alike.
    pub kinds: Vec<FaceKind>,
}

impl Cut {
    pub(super) fn with_room(faces: usize, corners: usize, kinds: bool) -> Cut {
        let mut offsets = Vec::with_capacity(faces + 1);
        offsets.push(0);
        let kinds = Vec::with_capacity(if kinds { faces } else { 0 });
        Cut { offsets, corners: Vec::with_capacity(corners), source: Vec::with_capacity(faces), kinds }
    }

    /// Ends the face whose corners have just been pushed.
    pub(super) fn close(&mut self, source: u32, kind: Option<FaceKind>) {
        self.offsets.push(self.corners.len() as u32);
        self.source.push(source);
        self.kinds.extend(kind);
    }

    /// The half-edges of these faces, `vertices` in all.
    pub fn connect(self, parent: &Topology, split: super::Split, vertices: u32, creases: Option<&Creases>) -> Topology {
        let mate = match (split.simplest(parent, creases), creases) {
            (super::Split::Sqrt3 { trisect }, Some(creases)) => {
                let apart = Apart::turned(parent, creases);
                let mut mate = mates(&apart, trisect);
                for h in (0..parent.half_edges()).filter(|&h| is_crease(&apart, parent, h)) {
                    let t = parent.twin(h);
                    mate[3 * h as usize] = 3 * t;
                    if trisect {
                        // The third at the origin of h.
                        let [own, other] = [3 * parent.twin(parent.prev(h)), 3 * parent.next(t) + 2];
                        (mate[own as usize], mate[other as usize]) = (other, own);
                    }
                }
                mate
            }
            (super::Split::Sqrt3 { trisect }, None) => mates(parent, trisect),
            (super::Split::Mixed, _) => super::mixed::mates(parent),
            (super::Split::MidEdge { cut, .. }, _) => super::mid_edge::mates(parent, cut, &split.lone(parent)),
            (super::Split::Poke, _) => super::poke::mates(parent),
            (super::Split::NWay { n, triangles }, _) => super::n_way::mates(parent, n, triangles),
            _ => self.dual_mates(parent, &split.lone(parent)),
        };
        Topology::manifold(self.offsets, self.corners, vertices, mate)
    }
}

impl Cut {
    /// The twins of [`dual`]'s faces, from their corners alone, which are half-edges of the parent.
    ///
    /// ```text
    ///     | v-face |           the e-face of h and its twin t has the corners n(h) h n(t) t: its sides 0 and 2 lie along
    ///   - g ------ h_i -       the sides h and t of two f-faces, side 1 along the v-face where h begins and 3 where t does.
    ///     | e-face |           So a v-face's side to corner g lies along the side that follows, in its e-face, the one
    ///   - . ------ . ---       along g.
    ///     | f-face |
    /// ```
    fn dual_mates(&self, parent: &Topology, lone: &[u32]) -> Vec<u32> {
        let mut mate = vec![UNMATCHED; self.corners.len()];
        // The f-face's side along half-edge h: behind the second image where h leaves a rounded corner.
        let along = |h: u32| if lone.is_empty() { h } else { h + lone.partition_point(|&l| l <= h) as u32 };
        let first_edge = parent.half_edges() + lone.len() as u32;
        let edges = parent.edges() - parent.boundary_half_edges();
        let first_vertex = first_edge + 4 * edges;
        let join = |mate: &mut Vec<u32>, a: u32, b: u32| (mate[a as usize], mate[b as usize]) = (b, a);
        for side in (first_edge..first_vertex).step_by(4) {
            let corner = &self.corners[side as usize..side as usize + 4];
            join(&mut mate, side, along(corner[1]));
            join(&mut mate, side + 2, along(corner[3]));
        }
        for f in (parent.faces() + edges) as usize..self.offsets.len() - 1 {
            let (from, to) = (self.offsets[f], self.offsets[f + 1]);
            for side in from..to {
                let g = self.corners[if side + 1 == to { from } else { side + 1 } as usize];
                let across = mate[along(g) as usize];
                // The last side of a boundary vertex's v-face lies on the new boundary.
                if across != UNMATCHED {
                    join(&mut mate, side, across + 1);
                }
            }
        }
        // Around an inner vertex of two faces there is no v-face: its e-faces meet.
        for side in (first_edge + 1..first_vertex).step_by(2) {
            if mate[side as usize] == UNMATCHED {
                let corner = if (side - first_edge) & 3 == 3 { side - 3 } else { side + 1 };
                let across = mate[along(self.corners[corner as usize]) as usize];
                if across != UNMATCHED {
                    join(&mut mate, side, across + 1);
                }
            }
        }
        mate
    }
}

/// The half-edges that leave boundary vertices of one face, in order: where dual gives two images if corners are rounded.
pub(crate) fn lone_corners(c: &impl Connectivity) -> Vec<u32> {
    if c.boundary_half_edges() == 0 {
        return Vec::new();
    }
    (0..c.half_edges()).filter(|&h| is_boundary(c.twin(h)) && is_boundary(c.twin(c.prev(h)))).collect()
}

/// The faces of the dual split; `rounded` lists the corners with two images.
pub(crate) fn dual(c: &Topology, rounded: &[u32]) -> Cut {
    let (h, faces) = (c.half_edges(), c.faces() + c.edges() + c.vertices());
    let mut cut = Cut::with_room(faces as usize, 4 * h as usize, true);
    let mut second = rounded.iter().zip(h..).peekable();
    for f in 0..c.faces() {
        for h in c.face_half_edges(f) {
            cut.corners.push(h);
            cut.corners.extend(second.next_if(|s| *s.0 == h).map(|s| s.1));
        }
        cut.close(f, Some(FaceKind::Face));
    }
    for e in 0..c.edges() {
        let h = c.edge_half_edge(e);
        let t = c.twin(h);
        if !is_boundary(t) {
            cut.corners.extend([c.next(h), h, c.next(t), t]);
            cut.close(c.face(h), Some(FaceKind::Edge));
        }
    }
    for v in 0..c.vertices() {
        let from = cut.corners.len();
        c.turn(v, |h| cut.corners.push(h));
        if cut.corners.len() - from >= 3 {
            cut.close(c.face(c.vertex_half_edge(v)), Some(FaceKind::Vertex));
        } else {
            cut.corners.truncate(from);
        }
    }
    cut
}

/// The knot intervals of [`dual`]'s half-edges, from those of the parent's. At the image of a corner they are the corner's
/// own: toward the next vertex of its face and straight away from it, toward the one before and straight away from that.
pub(crate) fn dual_knots(c: &Topology, knots: &[f32], rounded: &[u32]) -> Vec<f32> {
    if knots.is_empty() {
        return Vec::new();
    }
    // At the image of corner h along its face, and across.
    let on = |h: u32| knots[2 * h as usize];
    let back = |h: u32| knots[2 * c.prev(h) as usize + 1];
    let mut out = Vec::with_capacity(8 * c.half_edges() as usize);
    let mut second = rounded.iter().peekable();
    for h in 0..c.half_edges() {
        if second.next_if(|s| **s == h).is_some() {
            out.extend([on(h), back(h)]); // between the two images of a corner
        }
        out.extend([on(h), back(c.next(h))]);
    }
    for e in 0..c.edges() {
        let h = c.edge_half_edge(e);
        let t = c.twin(h);
        if !is_boundary(t) {
            let (hn, tn) = (c.next(h), c.next(t));
            out.extend([back(hn), on(h), back(h), on(tn), back(tn), on(t), back(t), on(hn)]);
        }
    }
    for v in 0..c.vertices() {
        let (from, mut first, mut faces) = (out.len(), None, 0);
        c.turn(v, |h| {
            // Behind the corner before there is this one.
            if faces > 0 {
                out.push(back(h));
            }
            out.push(on(h));
            first = first.or(Some(h));
            faces += 1;
        });
        out.extend(first.map(back));
        if faces < 3 {
            out.truncate(from);
        }
    }
    out
}

/// Whether `h` lies on a crease of `whole`, of which `c` is what is seen.
fn is_crease(c: &impl Connectivity, whole: &Topology, h: u32) -> bool {
    is_boundary(c.twin(h)) && !is_boundary(whole.twin(h))
}

/// The half-edges of the children of half-edge `h` on a crease, after the sqrt3 split: it, or its thirds.
pub(crate) fn sqrt3_thirds(c: &impl Connectivity, h: u32, trisect: bool) -> Vec<u32> {
    if trisect { vec![3 * c.twin(c.prev(h)), 3 * h, 3 * c.next(h) + 2] } else { vec![3 * h] }
}

/// The triangles of the sqrt3 split, one a half-edge and in their order. `c` is `whole`, or that seen cut along its creases.
pub(crate) fn sqrt3(c: &impl Connectivity, whole: &Topology, trisect: bool) -> Cut {
    let (old, faces, triangles) = (c.vertices(), c.faces(), c.half_edges());
    // What half-edge h takes for the centre of its face.
    let centre = |h: u32| match c.twin(c.prev(h)) {
        t if trisect && is_boundary(t) => match whole.twin(c.prev(h)) {
            t if is_boundary(t) => old + faces + boundary_rank(t),
            t => old + c.face(t),
        },
        _ => old + c.face(h),
    };
    let mut corners = Vec::with_capacity(3 * triangles as usize);
    for f in 0..faces {
        for h in c.face_half_edges(f) {
            let (v, t) = (c.origin(h), c.twin(h));
            corners.extend_from_slice(&match (is_boundary(t), trisect) {
                (false, false) => [v, old + c.face(t), old + f],
                (false, true) => [v, centre(t), centre(h)],
                (true, false) => [v, c.origin(c.next(h)), old + f],
                (true, true) => [centre(h), centre(c.next(h)), c.origin(c.prev(h))],
            });
        }
    }
    let offsets = (0..=triangles).map(|h| 3 * h).collect();
    Cut { offsets, corners, source: (0..triangles).map(|h| h / 3).collect(), kinds: Vec::new() }
}

/// The twins of [`sqrt3`]'s triangles.
fn mates(c: &impl Connectivity, trisect: bool) -> Vec<u32> {
    let mut mate = Vec::with_capacity(3 * c.half_edges() as usize);
    for h in (0..c.faces()).flat_map(|f| c.face_half_edges(f)) {
        let (n, p, t) = (c.next(h), c.prev(h), c.twin(h));
        let (before, after) = (c.twin(p), c.twin(n));
        let mut m = [UNMATCHED; 3];
        match (is_boundary(t), trisect) {
            (false, true) => {
                if is_boundary(c.twin(c.prev(t))) {
                    m[0] = 3 * c.prev(t) + 1;
                } else if !is_boundary(c.twin(c.next(t))) {
                    m[0] = 3 * c.next(t) + 2;
                }
                m[1] = 3 * t + 1;
                if is_boundary(after) {
                    m[2] = 3 * n + 2;
                } else if !is_boundary(before) {
                    m[2] = 3 * before;
                }
            }
            (true, true) => {
                m[1] = 3 * after;
                m[2] = 3 * p + 2;
            }
            (inner, false) => {
                if !inner {
                    (m[0], m[1]) = (3 * c.next(t) + 2, 3 * t + 1);
                } else {
                    m[1] = 3 * n + 2;
                }
                m[2] = if is_boundary(before) { 3 * p + 1 } else { 3 * before };
            }
        }
        mate.extend_from_slice(&m);
    }
    mate
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::split::Split;
    use crate::{Mesh, SHAPES, Soup, Weld, connect};

    /// Twins by arithmetic are those that matching sides finds, and passes over a manifold those of the general assembly.
    #[test]
    fn half_edges_are_those_that_the_faces_alone_give() {
        // Two quads back to back: every vertex is an inner one of two faces.
        let pillow = Soup::from_faces(vec![[0.0; 3]; 4], &[[0, 1, 2, 3], [3, 2, 1, 0]]);
        let soups = SHAPES.iter().map(|shape| (shape.build)()).chain([pillow]);
        for soup in soups {
            let Ok((mesh, _)) = Mesh::build(&soup, Weld::Off) else { panic!("a shape is no mesh") };
            let mut splits = vec![Split::Dual { rounded: false }, Split::Dual { rounded: true }, Split::Mixed];
            if mesh.is_triangles() {
                splits.extend([Split::Sqrt3 { trisect: false }, Split::Sqrt3 { trisect: true }]);
            }
            for split in splits {
                let mut level = mesh.topology.clone();
                for step in 0..3 {
                    let split = split.at(step);
                    let (cut, vertices) = (split.cut(&level, None), split.children(&level));
                    let mut corners = cut.corners.clone();
                    let matched = connect::connect(&cut.offsets, &mut corners, &mut Vec::new(), vertices as usize);
                    let (expected, _) =
                        Topology::assemble(cut.offsets.clone(), &corners, vertices as usize, &matched.mate);
                    level = cut.connect(&level, split, vertices, None);
                    assert_eq!(level, expected, "{split:?}, step {step}");
                }
            }
        }
    }
}
