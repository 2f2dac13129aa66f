//! The neighbourhood of a place on a level, as a mesh of its own with a numbering of its own.
//!
//! ```text
//!       8 --- 7 --- 6        from the place outwards, ring by ring and always counter-clockwise: two neighbourhoods that
//!      / \   / \   / \       look alike are numbered alike, so the numbers that were found for one hold for the other
//!     9 -- 2 --- 1 --- 5
//!      \ / |  0  | /  ..
//! ```
//!
//! Around the outermost ring the patch ends as if the mesh did. What is read off a patch must keep a ring away from there.
//! Cost: about 50 ns a face. Memory: 4 bytes for each vertex and face of the level, once.

use crate::connect::UNMATCHED;
use crate::scheme::Tags;
use crate::topology::{Connectivity, Topology, is_boundary};

/// What stays in place when a level is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Vertex(u32),
    /// The middle of a half-edge's edge (dual schemes).
    Edge(u32),
    /// The middle of a face (dual schemes).
    Face(u32),
}

/// A neighbourhood. Vertices of the level that touch the patch with several separate fans occur more than once, later.
#[derive(Debug, Default)]
pub(super) struct Patch {
    pub topology: Topology,
    /// The level's vertex behind each.
    pub vertices: Vec<u32>,
    /// How many edges away from the anchor each is, as the patch was grown.
    pub rings: Vec<u32>,
    /// Whether each stays where it is.
    pub sharp: Vec<bool>,
    /// Knot intervals, as of a mesh; empty if all are 1.
    pub knots: Vec<f32>,
    /// Faces, sharp vertices and knots in one list: equal for neighbourhoods that look alike.
    pub key: Vec<u32>,
}

/// Which vertices and faces of a level are in a patch. All zeros between patches.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    vertex: Vec<u32>,
    face: Vec<u32>,
}

/// A patch while it grows.
struct Growing<'a, C> {
    c: &'a C,
    stamps: &'a mut Stamps,
    /// The half-edge by which each vertex was first met, which leaves it.
    first: Vec<u32>,
    rings: Vec<u32>,
    offsets: Vec<u32>,
    /// For each corner the half-edge, and the patch's vertex.
    half_edges: Vec<u32>,
    corners: Vec<u32>,
}

impl<C: Connectivity> Growing<'_, C> {
    /// Adds the face of `h`, listed from there on, if it is not in yet.
    fn face(&mut self, h: u32, ring: u32) {
        let slot = &mut self.stamps.face[self.c.face(h) as usize];
        if *slot != 0 {
            return;
        }
        *slot = self.half_edges.len() as u32 + 1;
        let mut g = h;
        loop {
            let stamp = &mut self.stamps.vertex[self.c.origin(g) as usize];
            if *stamp == 0 {
                self.first.push(g);
                self.rings.push(ring);
                *stamp = self.first.len() as u32;
            }
            self.corners.push(*stamp - 1);
            self.half_edges.push(g);
            g = self.c.next(g);
            if g == h {
                break;
            }
        }
        self.offsets.push(self.corners.len() as u32);
    }

    /// Adds every face around the vertex that `h` leaves: from `h` on counter-clockwise, then what a boundary hides.
    fn around(&mut self, h: u32, ring: u32) {
        let mut g = h;
        loop {
            self.face(g, ring);
            g = self.c.twin(self.c.prev(g));
            if g == h {
                return;
            }
            if is_boundary(g) {
                break;
            }
        }
        g = self.c.twin(h);
        while !is_boundary(g) {
            g = self.c.next(g);
            self.face(g, ring);
            g = self.c.twin(g);
        }
    }
}

impl Patch {
    /// Cuts out what is within `rings` rings of faces around `anchor`. `sharp` says which vertices of the level stay,
    /// `knots` are its intervals.
    pub fn cut<C: Connectivity>(
        c: &C,
        anchor: Anchor,
        rings: u32,
        (sharp, knots): (impl Fn(u32) -> bool, &[f32]),
        stamps: &mut Stamps,
    ) -> Patch {
        stamps.vertex.resize(stamps.vertex.len().max(c.vertices() as usize), 0);
        stamps.face.resize(stamps.face.len().max(c.faces() as usize), 0);
        let mut grow = Growing {
            c,
            stamps,
            first: Vec::new(),
            rings: Vec::new(),
            offsets: vec![0],
            half_edges: Vec::new(),
            corners: Vec::new(),
        };
        match anchor {
            Anchor::Vertex(v) => grow.around(c.vertex_half_edge(v), 1),
            Anchor::Edge(h) => grow.face(h, 1),
            Anchor::Face(f) => grow.face(c.face_half_edges(f).start, 0),
        }
        // The place itself is its own ring.
        let own = match anchor {
            Anchor::Vertex(_) => 1,
            Anchor::Edge(_) => 2,
            Anchor::Face(_) => grow.rings.len(),
        };
        grow.rings[..own].fill(0);
        let mut v = 0;
        while v < grow.first.len() && grow.rings[v] < rings {
            grow.around(grow.first[v], grow.rings[v] + 1);
            v += 1;
        }
        let Growing { first, rings: ring, offsets, half_edges, corners, .. } = grow;

        let vertices: Vec<u32> = first.iter().map(|&h| c.origin(h)).collect();
        let sharp: Vec<bool> = vertices.iter().map(|&v| sharp(v)).collect();
        let mut mate = vec![UNMATCHED; half_edges.len()];
        for (h, &g) in half_edges.iter().enumerate() {
            let t = c.twin(g);
            if is_boundary(t) {
                continue;
            }
            let face = stamps.face[c.face(t) as usize];
            if face != 0 {
                // Where the twin stands in its face, as the face was listed.
                let run = &half_edges[face as usize - 1..];
                mate[h] = face - 1 + run.iter().position(|&x| x == t).unwrap_or(0) as u32;
            }
        }
        let mut key = key(anchor, &offsets, &corners, &sharp, &ring, rings);
        let mut own_knots = Vec::new();
        if !knots.is_empty() {
            own_knots.extend(half_edges.iter().flat_map(|&g| [knots[2 * g as usize], knots[2 * g as usize + 1]]));
            key.extend(own_knots.iter().map(|d| d.to_bits()));
        }
        for &g in &half_edges {
            stamps.face[c.face(g) as usize] = 0;
        }
        for &v in &vertices {
            stamps.vertex[v as usize] = 0;
        }
        let (topology, class) = Topology::assemble(offsets, &corners, vertices.len(), &mate);
        let back = |c: &u32| *c as usize;
        Patch {
            topology,
            rings: class.iter().map(|c| ring[back(c)]).collect(),
            sharp: class.iter().map(|c| sharp[back(c)]).collect(),
            vertices: class.iter().map(|c| vertices[back(c)]).collect(),
            knots: own_knots,
            key,
        }
    }

    /// The rules' tags for this patch.
    pub fn tags<'a>(&'a self, tags: Tags<'a>, lone: &'a [u32]) -> Tags<'a> {
        Tags { sharp: &self.sharp, knots: &self.knots, lone, ..tags }
    }
}

/// The kind of anchor, faces, and sharp vertices within `rings`.
fn key(anchor: Anchor, offsets: &[u32], corners: &[u32], sharp: &[bool], ring: &[u32], rings: u32) -> Vec<u32> {
    let kind = match anchor {
        Anchor::Vertex(_) => 0,
        Anchor::Edge(_) => 1,
        Anchor::Face(_) => 2,
    };
    let mut key = Vec::with_capacity(2 + offsets.len() + corners.len());
    key.extend([kind, offsets.len() as u32]);
    key.extend(offsets.windows(2).map(|w| w[1] - w[0]));
    key.extend(corners);
    key.extend((0..sharp.len() as u32).filter(|&v| sharp[v as usize] && ring[v as usize] < rings));
    key
}
