//! The triangle split: four triangles each, one at every corner and one in the middle.
//!
//! For a half-edge h with next n, prev p, twin t and edge e of the parent, H half-edges in all (Vanhoey & Dupuy 2022):
//!
//! ```text
//!   child     3h           3h+1      3h+2         3H+h
//!   twin      3 n(t) + 2   3H + h    3 t(p)       3h + 1      on a boundary !2r | | !(2r(p) + 1), r the parent's rank
//!   origin    v            V+e       V+e(p)       V+e(p)
//!   edge      2h           2h + 1    of twin, or 2H + r       2h + 1
//! ```

use crate::topology::{Connectivity, boundary_rank, is_boundary};
use std::ops::Range;

/// Half-edges of a level of triangles: twin and origin stored, everything else arithmetic. 24 bytes a triangle, 4 a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleLevel {
    twin: Vec<u32>,
    origin: Vec<u32>,
    vertex_half_edge: Vec<u32>,
    /// The half-edge of each boundary rank.
    boundary: Vec<u32>,
    edges: u32,
    /// Half-edges of the parent: three times this is where the middle triangles begin.
    parent: u32,
}

impl TriangleLevel {
    /// A level of the right size below `parent`, whose faces must all be triangles; to be filled.
    pub fn below(parent: &impl Connectivity) -> Self {
        debug_assert_eq!(parent.half_edges(), 3 * parent.faces());
        let half_edges = parent.half_edges() as usize * 4;
        TriangleLevel {
            twin: Vec::with_capacity(half_edges),
            origin: Vec::with_capacity(half_edges),
            vertex_half_edge: vec![0; super::Split::Triangle.children(parent) as usize],
            boundary: vec![0; parent.boundary_half_edges() as usize * 2],
            edges: 2 * parent.edges() + parent.half_edges(),
            parent: parent.half_edges(),
        }
    }

    /// Appends the children of the parent's faces `from..to`, where those of the faces before are; behind the last face the
    /// triangles in the middle.
    pub fn fill(&mut self, parent: &impl Connectivity, from: u32, to: u32) {
        corners(parent, from, to, &mut self.origin);
        let first_edge = super::Split::Triangle.first_edge_point(parent) as usize;
        let middle = 3 * self.parent;
        for f in from..to {
            let face = parent.face_half_edges(f);
            let mut twin_p = parent.twin(face.end - 1);
            for h in face.clone() {
                let n = if h + 1 == face.end { face.start } else { h + 1 };
                let t = parent.twin(h);
                let mut child = [0, middle + h, 0];
                if is_boundary(t) {
                    let r = boundary_rank(t);
                    child[0] = !(2 * r);
                    self.boundary[2 * r as usize] = 3 * h;
                    self.vertex_half_edge[first_edge + parent.edge(h) as usize] = 3 * n + 2;
                } else {
                    child[0] = 3 * parent.next(t) + 2;
                    if h < t {
                        self.vertex_half_edge[first_edge + parent.edge(h) as usize] = 3 * h + 1;
                    }
                }
                if is_boundary(twin_p) {
                    let r = boundary_rank(twin_p);
                    child[2] = !(2 * r + 1);
                    self.boundary[2 * r as usize + 1] = 3 * h + 2;
                } else {
                    child[2] = 3 * twin_p;
                }
                self.twin.extend_from_slice(&child);
                twin_p = t;
            }
        }
        if from < to && to == parent.faces() {
            self.twin.extend((0..parent.half_edges()).map(|h| 3 * h + 1));
        }
    }

    /// Fills what old vertices `from..to` start their turn with.
    pub fn fill_vertices(&mut self, parent: &impl Connectivity, from: u32, to: u32) {
        for v in from..to {
            self.vertex_half_edge[v as usize] = 3 * parent.vertex_half_edge(v);
        }
    }

    /// The corners of the triangles, three each.
    pub fn origins(&self) -> &[u32] {
        &self.origin
    }
}

/// See [`super::Split::corners`].
#[inline(always)]
pub(super) fn corners(parent: &impl Connectivity, from: u32, to: u32, out: &mut Vec<u32>) {
    let edge_point = super::Split::Triangle.first_edge_point(parent);
    for f in from..to {
        let face = parent.face_half_edges(f);
        let mut before = edge_point + parent.edge(face.end - 1);
        for h in face {
            let after = edge_point + parent.edge(h);
            out.extend_from_slice(&[parent.origin(h), after, before]);
            before = after;
        }
    }
    if from < to && to == parent.faces() {
        // A middle triangle's corner h lies where the triangle at h has its last.
        (0..parent.half_edges() as usize).for_each(|h| out.push(out[3 * h + 2]));
    }
}

impl Connectivity for TriangleLevel {
    #[inline(always)]
    fn sure_shape(&self) -> Option<super::FaceShape> {
        Some(super::FaceShape::Triangles)
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
        (self.twin.len() / 3) as u32
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
        3 * f..3 * f + 3
    }
    #[inline(always)]
    fn face(&self, h: u32) -> u32 {
        h / 3
    }
    #[inline(always)]
    fn next(&self, h: u32) -> u32 {
        // Without a branch, which would be guessed wrong every third time.
        h + 1 - 3 * u32::from(h % 3 == 2)
    }
    #[inline(always)]
    fn prev(&self, h: u32) -> u32 {
        h + 3 * u32::from(h.is_multiple_of(3)) - 1
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
        let middle = 3 * self.parent;
        if h >= middle {
            return 2 * (h - middle) + 1;
        }
        match h % 3 {
            0 => 2 * (h / 3),
            1 => 2 * (h / 3) + 1,
            _ => match self.twin(h) {
                t if is_boundary(t) => 2 * self.parent + (boundary_rank(t) >> 1),
                t => 2 * (t / 3),
            },
        }
    }
    #[inline(always)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        self.vertex_half_edge[v as usize]
    }
    #[inline(always)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        let owned = 2 * self.parent;
        if e < owned { 3 * (e >> 1) + (e & 1) } else { self.boundary[2 * (e - owned) as usize + 1] }
    }
}
