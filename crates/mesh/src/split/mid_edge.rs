//! The mid-edge split: the midpoints of edges, joined around every face and every vertex.
//!
//! ```text
//!    .-----o-----.        A(h): e(prev h) -> e(h), in the place of the face; half-edge h of the child as long as no corner is kept
//!    |   / f \   |        B(h): e(h) -> e(prev h), its twin, in the place of the vertex
//!    | /       \ |
//!    o     A(h)  o        child vertices: edges [0, E) | kept boundary vertices
//!    | \   B(h)/ |
//!    |   \ f / v |
//!    '-----o-----'
//! ```
//!
//! An open mesh would lose its rim. Two steps make it right: the first keeps boundary vertices as corners of their v-faces, the
//! second (`cut`) does not, and its new rim runs through the midpoints of the rim's halved edges: Chaikin's points. A corner to be kept is seen in the second step as a boundary vertex of one triangle: there the first
//! step left it. Vertices of two faces inside have no v-face: the two f-faces meet there.
//!
//! Cost: linear, twins by arithmetic. Source: J. Peters, U. Reif 1997; the rim is ours (see [`crate::scheme::MidEdge`]).

use super::stored::{Cut, FaceKind};
use crate::connect::UNMATCHED;
use crate::topology::{Connectivity, Topology, is_boundary};

/// The half-edges that leave boundary vertices of one triangle, in order: the corners that a `cut` keeps.
pub(super) fn tips(c: &impl Connectivity) -> Vec<u32> {
    let open = |h: u32| is_boundary(c.twin(h));
    let tip = |h: &u32| open(*h) && open(c.prev(*h)) && c.face_half_edges(c.face(*h)).len() == 3;
    (0..c.half_edges()).filter(tip).collect()
}

/// Whether `v` has a v-face, of so many spokes and arriving there; on a boundary that is kept every vertex has one.
pub(crate) fn has_face(spokes: u32, boundary: bool, cut: bool) -> bool {
    match boundary {
        true => !cut || spokes >= 2,
        false => spokes >= 3,
    }
}

/// The faces; `kept` are the corners that a `cut` keeps.
pub(super) fn faces(c: &Topology, cut: bool, kept: &[u32]) -> Cut {
    let mut out = Cut::with_room(
        c.faces() as usize + c.vertices() as usize,
        2 * (c.half_edges() + c.boundary_half_edges()) as usize,
        true,
    );
    let mut corner = kept.iter().zip(c.edges()..).peekable();
    for f in 0..c.faces() {
        for h in c.face_half_edges(f) {
            out.corners.push(c.edge(c.prev(h)));
            out.corners.extend(corner.next_if(|k| *k.0 == h).map(|k| k.1));
        }
        out.close(f, Some(FaceKind::Face));
    }
    for v in 0..c.vertices() {
        let (from, mut spokes) = (out.corners.len(), 0);
        let arriving = c.turn(v, |h| {
            spokes += 1;
            out.corners.push(c.edge(h));
        });
        if !has_face(spokes, arriving.is_some(), cut) {
            out.corners.truncate(from);
            continue;
        }
        let start = c.vertex_half_edge(v);
        if let Some(arriving) = arriving {
            out.corners.push(c.edge(arriving));
            if !cut {
                out.corners.push(c.edges() + crate::topology::boundary_rank(c.twin(start)));
            }
        }
        out.close(c.face(start), Some(FaceKind::Vertex));
    }
    out
}

/// Their twins.
pub(super) fn mates(c: &Topology, cut: bool, kept: &[u32]) -> Vec<u32> {
    let half_edges = c.half_edges() as usize;
    let mut mate = vec![UNMATCHED; half_edges + kept.len()];
    // Where A(h) is: one further behind every kept corner, whose own two sides are on the rim.
    let mut a: Vec<u32> = (0..c.half_edges()).collect();
    for (i, &h) in kept.iter().enumerate() {
        let next = kept.get(i + 1).map_or(half_edges, |n| *n as usize + 1);
        a[h as usize + 1..next].iter_mut().for_each(|x| *x += i as u32 + 1);
    }
    for v in 0..c.vertices() {
        let mut spokes = 0;
        let arriving = c.turn(v, |_| spokes += 1);
        if !has_face(spokes, arriving.is_some(), cut) {
            if arriving.is_none() {
                let h = c.vertex_half_edge(v);
                let [x, y] = [h, c.twin(c.prev(h))].map(|h| a[h as usize]);
                (mate[x as usize], mate[y as usize]) = (y, x);
            }
            continue;
        }
        c.turn(v, |h| {
            mate[a[h as usize] as usize] = mate.len() as u32;
            mate.push(a[h as usize]);
        });
        let rim = if arriving.is_none() {
            0
        } else if cut {
            1
        } else {
            2
        };
        mate.extend(std::iter::repeat_n(UNMATCHED, rim));
    }
    mate
}
