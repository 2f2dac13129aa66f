//! The quad split: n quads a face, each with the corners old vertex, edge point, face point, edge point.
//!
//! For a half-edge h with next n, prev p, twin t, edge e and face f of the parent (Dupuy & Vanhoey 2021, table 1):
//!
//! ```text
//!   child     4h           4h+1     4h+2     4h+3
//!   twin      4 n(t) + 3   4n + 2   4p + 1   4 t(p)         on a boundary !2r | | | !(2r(p) + 1), r the parent's rank
//!   origin    v            V+F+e    V+f      V+F+e(p)
//!   edge      2q           2q + 1   of twin  of twin, or 2Q + r      q the quad, Q quads in all
//! ```

use crate::topology::{BOUNDARY, Connectivity, boundary_rank, is_boundary};
use std::ops::Range;

/// Half-edges of a level of quads: twin and origin stored, everything else arithmetic. 32 bytes a quad and 4 a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadLevel {
    twin: Vec<u32>,
    origin: Vec<u32>,
    vertex_half_edge: Vec<u32>,
    /// The half-edge of each boundary rank.
    boundary: Vec<u32>,
    edges: u32,
}

impl QuadLevel {
    /// A level of the right size below `parent`, to be filled.
    pub fn below(parent: &impl Connectivity) -> Self {
        let half_edges = parent.half_edges() as usize * 4;
        QuadLevel {
            twin: Vec::with_capacity(half_edges),
            origin: Vec::with_capacity(half_edges),
            vertex_half_edge: vec![0; super::Split::Quad.children(parent) as usize],
            boundary: vec![0; parent.boundary_half_edges() as usize * 2],
            edges: 2 * parent.edges() + parent.half_edges(),
        }
    }

    /// Appends the children of the parent's faces `from..to`, where those of the faces before are.
    pub fn fill(&mut self, parent: &impl Connectivity, from: u32, to: u32) {
        corners(parent, from, to, &mut self.origin);
        let first_edge = super::Split::Quad.first_edge_point(parent) as usize;
        for f in from..to {
            let face = parent.face_half_edges(f);
            let mut p = face.end - 1;
            let mut twin_p = parent.twin(p);
            for h in face.clone() {
                let n = if h + 1 == face.end { face.start } else { h + 1 };
                let t = parent.twin(h);
                let mut child = [0, 4 * n + 2, 4 * p + 1, 0];
                if is_boundary(t) {
                    let r = boundary_rank(t);
                    child[0] = !(2 * r);
                    self.boundary[2 * r as usize] = 4 * h;
                } else {
                    child[0] = 4 * parent.next(t) + 3;
                }
                if is_boundary(twin_p) {
                    let r = boundary_rank(twin_p);
                    child[3] = !(2 * r + 1);
                    self.boundary[2 * r as usize + 1] = 4 * h + 3;
                } else {
                    child[3] = 4 * twin_p;
                }
                self.twin.extend_from_slice(&child);
                // A boundary's outgoing half-edge at the edge point is the second half of the edge.
                if is_boundary(t) {
                    self.vertex_half_edge[first_edge + parent.edge(h) as usize] = 4 * n + 3;
                } else if h < t {
                    self.vertex_half_edge[first_edge + parent.edge(h) as usize] = 4 * h + 1;
                }
                p = h;
                twin_p = t;
            }
            self.vertex_half_edge[(parent.vertices() + f) as usize] = 4 * face.start + 2;
        }
    }

    /// Fills what old vertices `from..to` start their turn with.
    pub fn fill_vertices(&mut self, parent: &impl Connectivity, from: u32, to: u32) {
        for v in from..to {
            self.vertex_half_edge[v as usize] = 4 * parent.vertex_half_edge(v);
        }
    }

    /// The corners of the quads, four each.
    pub fn origins(&self) -> &[u32] {
        &self.origin
    }
}

/// See [`super::Split::corners`].
#[inline(always)]
pub(super) fn corners(parent: &impl Connectivity, from: u32, to: u32, out: &mut Vec<u32>) {
    let face_point = super::Split::Quad.first_face_point(parent);
    let edge_point = super::Split::Quad.first_edge_point(parent);
    for f in from..to {
        let face = parent.face_half_edges(f);
        let mut before = edge_point + parent.edge(face.end - 1);
        for h in face {
            let after = edge_point + parent.edge(h);
            out.extend_from_slice(&[parent.origin(h), after, face_point + f, before]);
            before = after;
        }
    }
}

impl Connectivity for QuadLevel {
    #[inline(always)]
    fn sure_shape(&self) -> Option<super::FaceShape> {
        Some(super::FaceShape::Quads)
    }
    #[inline(always)]
    fn vertices(&self) -> u32 {
        self.vertex_half_edge.len() as u32
    }
    #[inline(always)]
    fn edges(&self) -> u32 {
        self.edges
    }
    #[inline(always)]
    fn faces(&self) -> u32 {
        (self.twin.len() / 4) as u32
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
        4 * f..4 * f + 4
    }
    #[inline(always)]
    fn face(&self, h: u32) -> u32 {
        h >> 2
    }
    #[inline(always)]
    fn next(&self, h: u32) -> u32 {
        (h & !3) | ((h + 1) & 3)
    }
    #[inline(always)]
    fn prev(&self, h: u32) -> u32 {
        (h & !3) | (h.wrapping_sub(1) & 3)
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
        let q = h >> 2;
        match h & 3 {
            0 => 2 * q,
            1 => 2 * q + 1,
            2 => 2 * (self.twin(h) >> 2) + 1,
            _ => match self.twin(h) {
                t if t & BOUNDARY != 0 => 2 * self.faces() + (boundary_rank(t) >> 1),
                t => 2 * (t >> 2),
            },
        }
    }
    #[inline(always)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        self.vertex_half_edge[v as usize]
    }
    #[inline(always)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        let owned = 2 * self.faces();
        if e < owned { 4 * (e >> 1) + (e & 1) } else { self.boundary[2 * (e - owned) as usize + 1] }
    }
}
