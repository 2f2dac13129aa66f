//! Level 0 as plain tables: half-edges of any polygons, with what is marked on them.
//!
//! ```text
//!   offsets   0 4 7 ..     face f has the half-edges offsets[f] .. offsets[f + 1], one a corner, counter-clockwise
//!   origin    the vertex that a half-edge leaves        twin    the other side, or !rank on a boundary
//!   edge      its edge, numbered as lower half-edges come   start   of a vertex: on a boundary the outgoing boundary half-edge
//! ```
//!
//! These are the numbers of `limn-mesh`, so what the GPU makes of them has its numbers too. Checked before anything is made: a
//! kernel that turns around a vertex by wrong twins would not end. Cost of the check: linear, about 5 ns a half-edge.

use super::kernels::Split;
use crate::Error;

/// Half-edges of level 0. See the module.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cage<'a> {
    /// Where the half-edges of each face begin, and their number at the end.
    pub offsets: &'a [u32],
    /// The opposite half-edge; on a boundary `!rank`, ranks counting boundary half-edges.
    pub twin: &'a [u32],
    /// The vertex that each half-edge leaves.
    pub origin: &'a [u32],
    /// Its edge.
    pub edge: &'a [u32],
    /// The half-edge to start turning at, one a vertex.
    pub start: &'a [u32],
    /// Vertices that stay where they are; may be shorter than the vertices.
    pub stays: &'a [bool],
    /// Boundary vertices of one face that are no corners all the same; may be shorter.
    pub joined: &'a [bool],
    /// How sharp the edge of each half-edge is, 0 smooth, from 10 on for ever; empty if none is.
    pub sharpness: &'a [f32],
    /// How sharp each vertex is; may be shorter.
    pub vertex_sharpness: &'a [f32],
}

/// How many of everything a level has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    pub half_edges: u64,
    pub vertices: u64,
    pub faces: u64,
    pub edges: u64,
}

impl Size {
    /// One level further. Saturates.
    pub fn split(self, split: Split) -> Size {
        let Size { half_edges, vertices, faces, edges } = self;
        match split {
            Split::Quad => Size {
                half_edges: half_edges.saturating_mul(4),
                vertices: vertices.saturating_add(edges).saturating_add(faces),
                faces: half_edges,
                edges: edges.saturating_mul(2).saturating_add(half_edges),
            },
            Split::Triangle => Size {
                half_edges: half_edges.saturating_mul(4),
                vertices: vertices.saturating_add(edges),
                faces: faces.saturating_mul(4),
                edges: edges.saturating_mul(2).saturating_add(half_edges),
            },
            Split::Sqrt3 => Size {
                half_edges: half_edges.saturating_mul(3),
                vertices: vertices.saturating_add(faces),
                faces: half_edges,
                edges: edges.saturating_mul(3),
            },
            Split::Dual => Size {
                half_edges: half_edges.saturating_mul(4),
                vertices: half_edges,
                faces: faces.saturating_add(edges).saturating_add(vertices),
                edges: half_edges.saturating_mul(2),
            },
        }
    }
}

const BOUNDARY: u32 = 1 << 31;

impl Cage<'_> {
    pub(crate) fn size(&self) -> Size {
        let boundary = self.twin.iter().filter(|&&t| t >= BOUNDARY).count() as u64;
        let half_edges = self.twin.len() as u64;
        Size {
            half_edges,
            vertices: self.start.len() as u64,
            faces: self.offsets.len().saturating_sub(1) as u64,
            edges: (half_edges + boundary) / 2,
        }
    }

    /// Whether any edge or vertex has marks that only the rules of creases know.
    pub(crate) fn is_creased(&self) -> bool {
        self.sharpness.iter().chain(self.vertex_sharpness).any(|&s| s > 0.0)
    }

    /// Words a vertex: whether it stays (1), is joined (2), and how sharp it is. Empty where nothing is marked.
    pub(crate) fn marks(&self) -> Vec<[u32; 2]> {
        let any =
            self.stays.contains(&true) || self.joined.contains(&true) || self.vertex_sharpness.iter().any(|&s| s > 0.0);
        let of = |v: usize| {
            let sharp = self.vertex_sharpness.get(v).copied().unwrap_or(0.0);
            let stays = self.stays.get(v) == Some(&true) || sharp >= 10.0;
            [u32::from(stays) | u32::from(self.joined.get(v) == Some(&true)) << 1, sharp.to_bits()]
        };
        if any { (0..self.start.len()).map(of).collect() } else { Vec::new() }
    }

    /// How many faces are around each vertex.
    fn around(&self) -> Vec<u32> {
        let mut faces = vec![0u32; self.start.len()];
        for &v in self.origin {
            if let Some(n) = faces.get_mut(v as usize) {
                *n += 1;
            }
        }
        faces
    }

    /// How many half-edges leave the vertices before each.
    pub(crate) fn turns(&self) -> Vec<u32> {
        let before = |sum: &mut u32, n: u32| {
            *sum += n;
            Some(*sum - n)
        };
        self.around().into_iter().scan(0, before).collect()
    }

    /// The most edges at a vertex, or sides of a face.
    pub(crate) fn valence(&self) -> u32 {
        let faces = self.around();
        let sides = self.offsets.windows(2).map(|w| w[1].saturating_sub(w[0]));
        faces.iter().map(|n| n + 1).chain(sides).max().unwrap_or(0)
    }

    /// That all tables belong together.
    pub(crate) fn check(&self, split: Split) -> Result<(), Error> {
        let (half_edges, triangles) = (self.twin.len(), split.is_of_triangles());
        let expect = |what, found: usize, expected: usize| {
            if found == expected {
                Ok(())
            } else {
                Err(limn_layout::Error::Mismatch { what, found: found as u64, expected: expected as u64 })
            }
        };
        expect("origins of half-edges", self.origin.len(), half_edges)?;
        expect("edges of half-edges", self.edge.len(), half_edges)?;
        if !self.sharpness.is_empty() {
            expect("sharpness of half-edges", self.sharpness.len(), half_edges)?;
        }
        expect("half-edges of the faces", self.offsets.last().map_or(0, |&n| n as usize), half_edges)?;
        let broken = |what: &'static str, at: usize| Err(Error::HalfEdges { what, at: at as u64 });
        let least = |w: &[u32]| w[0].saturating_add(if triangles { 3 } else { 2 });
        if self.offsets.first().is_some_and(|&o| o != 0) {
            return broken("face", 0);
        }
        if let Some(f) = self.offsets.windows(2).position(|w| w[1] < least(w) || triangles && w[1] > least(w)) {
            return broken("face", f);
        }
        let edges = self.size().edges;
        for (h, ((&t, &v), &e)) in self.twin.iter().zip(self.origin).zip(self.edge).enumerate() {
            let good = t >= BOUNDARY && !split.is_of_closed()
                || (t as usize != h && self.twin.get(t as usize) == Some(&(h as u32)));
            if !good || v as usize >= self.start.len() || u64::from(e) >= edges {
                return broken("half-edge", h);
            }
        }
        // Around such a vertex the dual split makes no face.
        let few = |n: &u32| *n < 3;
        if let (Split::Dual, Some(v)) = (split, self.around().iter().position(few)) {
            return broken("vertex", v);
        }
        let wrong = |(v, &h): (usize, &u32)| self.origin.get(h as usize) != Some(&(v as u32));
        match self.start.iter().enumerate().position(wrong) {
            Some(v) => broken("vertex", v),
            None => Ok(()),
        }
    }
}
