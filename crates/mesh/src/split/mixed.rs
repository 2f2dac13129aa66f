//! The mixed split: triangles in four triangles, every other face of n corners in n quads around a new face point.
//!
//! ```text
//!          v                     p ---- . ---- .        child vertices: old [0, V) | faces that are no triangles | edges
//!        /   \                   |      |      |        children of a face that begins at half-edge s: from 4 s on,
//!      e ----- e(p)              e(p)-- f ---- .          triangle   3 at each corner (v, e, e(p)), then the inner one
//!     /  \   /   \               |      |      |          other      4 at each corner (v, e, f, e(p))
//!    n --- . ----- p             v ---- e ---- n
//! ```
//!
//! On meshes of quads alone, and of triangles alone, vertices have the numbers of the quad and the triangle split. Faces
//! are not all alike, so levels are stored in full; twins are arithmetic. Cost: linear.

use super::stored::Cut;
use crate::connect::UNMATCHED;
use crate::topology::{Connectivity, Topology, is_boundary};

/// The faces that get a point: all but triangles.
pub(super) fn pointed_faces(c: &impl Connectivity) -> Vec<u32> {
    (0..c.faces()).filter(|&f| c.face_half_edges(f).len() != 3).collect()
}

/// The faces of the mixed split; `pointed` lists those that are no triangles.
pub(super) fn cut(c: &Topology, pointed: &[u32]) -> Cut {
    let mut cut = Cut::with_room(c.half_edges() as usize + c.faces() as usize, 4 * c.half_edges() as usize, false);
    let first_edge = c.vertices() + pointed.len() as u32;
    let mut points = (c.vertices()..).take(pointed.len());
    for f in 0..c.faces() {
        let corners = c.face_half_edges(f);
        let edge = |h: u32| first_edge + c.edge(h);
        if corners.len() == 3 {
            for h in corners.clone() {
                cut.corners.extend([c.origin(h), edge(h), edge(c.prev(h))]);
                cut.close(f, None);
            }
            cut.corners.extend(corners.map(edge));
            cut.close(f, None);
        } else if let Some(point) = points.next() {
            for h in corners {
                cut.corners.extend([c.origin(h), edge(h), point, edge(c.prev(h))]);
                cut.close(f, None);
            }
        }
    }
    cut
}

/// The child of half-edge `h` at its corner, and the one that arrives at the next vertex.
pub(crate) fn halves(c: &impl Connectivity, h: u32) -> [u32; 2] {
    let face = c.face_half_edges(c.face(h));
    match face.len() {
        3 => [3 * h + face.start, 3 * c.next(h) + face.start + 2],
        _ => [4 * h, 4 * c.next(h) + 3],
    }
}

/// The twins of [`cut`]'s faces.
pub(super) fn mates(c: &Topology) -> Vec<u32> {
    let is_triangle = |h: u32| c.face_half_edges(c.face(h)).len() == 3;
    // The children on both halves of side h, from v and to the next vertex.
    let corner = |h: u32| halves(c, h)[0];
    let to_next = |h: u32| halves(c, h)[1];
    let mut mate = vec![UNMATCHED; 4 * c.half_edges() as usize];
    let mut join = |a: u32, b: u32| (mate[a as usize], mate[b as usize]) = (b, a);
    for h in 0..c.half_edges() {
        let t = c.twin(h);
        if !is_boundary(t) {
            join(corner(h), to_next(t));
        }
        if is_triangle(h) {
            // Side (e, e(p)) of the corner against side (e(p), e) of the inner triangle.
            let start = c.face_half_edges(c.face(h)).start;
            join(corner(h) + 1, 4 * start + 9 + (c.prev(h) - start));
        } else {
            join(corner(h) + 1, corner(c.next(h)) + 2);
        }
    }
    mate
}
