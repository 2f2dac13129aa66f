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
//! Cost: linear in corners. Memory: 4 bytes for each vertex and face of the
//! level, once.

use crate::connect::UNMATCHED;
use crate::copies::Beyond;
use crate::crease::Creases;
use crate::scheme::Tags;
use crate::split::Split;
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

/// A neighbourhood as it is read off a level: enough to recognise it. The buffers are used again.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// The level's vertices, from the anchor outwards.
    pub vertices: Vec<u32>,
    /// How many edges away from the anchor each is, as the patch was grown.
    rings: Vec<u32>,
    /// Whether each stays where it is.
    sharp: Vec<bool>,
    /// Knot intervals, as of a mesh; empty if all are 1.
    knots: Vec<f32>,
    /// How sharp each corner's half-edge is, and each vertex; empty if nothing is.
    edge_sharpness: Vec<f32>,
    vertex_sharpness: Vec<f32>,
    /// What the vertices' other copies see, by their places in the list.
    beyond: Vec<Beyond>,
    /// Faces, sharp vertices, knots and sharpness in one list: equal for neighbourhoods that look alike.
    pub key: Vec<u32>,
    /// The half-edge by which each vertex was first met, which leaves it.
    first: Vec<u32>,
    offsets: Vec<u32>,
    /// For each corner the half-edge, and the patch's vertex.
    half_edges: Vec<u32>,
    corners: Vec<u32>,
    /// All zeros between two neighbourhoods: for the level's vertices and faces, where they are in the lists, plus one.
    vertex_at: Vec<u32>,
    face_at: Vec<u32>,
}

impl Seen {
    /// Reads what is within `rings` rings of faces around `anchor`. `sharp` says which vertices of the level stay, `knots`
    /// are its intervals.
    #[inline(always)]
    pub fn read<C: Connectivity>(
        &mut self,
        c: &C,
        anchor: Anchor,
        rings: u32,
        (sharp, knots, creases): (impl Fn(u32) -> bool, &[f32], Option<&Creases>),
    ) {
        self.vertex_at.resize(self.vertex_at.len().max(c.vertices() as usize), 0);
        self.face_at.resize(self.face_at.len().max(c.faces() as usize), 0);
        for list in [
            &mut self.vertices,
            &mut self.rings,
            &mut self.key,
            &mut self.first,
            &mut self.offsets,
            &mut self.half_edges,
            &mut self.corners,
        ] {
            list.clear();
        }
        self.offsets.push(0);
        match anchor {
            Anchor::Vertex(v) => self.around(c, c.vertex_half_edge(v), 1),
            Anchor::Edge(h) => self.face(c, h, 1),
            Anchor::Face(f) => self.face(c, c.face_half_edges(f).start, 0),
        }
        // The place itself is its own ring.
        let own = match anchor {
            Anchor::Vertex(_) => 1,
            Anchor::Edge(_) => 2,
            Anchor::Face(_) => self.rings.len(),
        };
        self.rings[..own].fill(0);
        let mut v = 0;
        while v < self.first.len() && self.rings[v] < rings {
            self.around(c, self.first[v], self.rings[v] + 1);
            v += 1;
        }
        for &g in &self.half_edges {
            self.face_at[c.face(g) as usize] = 0;
        }
        for &v in &self.vertices {
            self.vertex_at[v as usize] = 0;
        }
        self.sharp.clear();
        self.sharp.extend(self.vertices.iter().map(|&v| sharp(v)));
        self.write_key(anchor, rings);
        self.knots.clear();
        if !knots.is_empty() {
            let pairs = self.half_edges.iter().flat_map(|&g| [knots[2 * g as usize], knots[2 * g as usize + 1]]);
            self.knots.extend(pairs);
            self.key.extend(self.knots.iter().map(|d| d.to_bits()));
        }
        self.edge_sharpness.clear();
        self.vertex_sharpness.clear();
        self.beyond.clear();
        if let Some(creases) = creases {
            // A boundary is one without being marked.
            let along = |&h: &u32| if is_boundary(c.twin(h)) { 0.0 } else { creases.along(c, h) };
            self.edge_sharpness.extend(self.half_edges.iter().map(along));
            self.vertex_sharpness.extend(self.vertices.iter().map(|&v| creases.vertex(v)));
            for list in [&mut self.edge_sharpness, &mut self.vertex_sharpness] {
                if list.iter().all(|s| *s == 0.0) {
                    list.clear();
                }
                self.key.extend(list.iter().map(|s| s.to_bits()));
            }
            for (&v, local) in self.vertices.iter().zip(0..) {
                let Some(beyond) = creases.beyond(v) else { continue };
                self.key.push(local);
                self.key.extend(beyond.edges.iter().map(|(s, _)| s.to_bits()));
                self.beyond.push(Beyond { vertex: local, ..beyond.clone() });
            }
        }
    }

    /// Adds the face of `h`, listed from there on, if it is not in yet.
    #[inline(always)]
    fn face<C: Connectivity>(&mut self, c: &C, h: u32, ring: u32) {
        let slot = &mut self.face_at[c.face(h) as usize];
        if *slot != 0 {
            return;
        }
        *slot = 1;
        let mut g = h;
        loop {
            let v = c.origin(g);
            let place = &mut self.vertex_at[v as usize];
            if *place == 0 {
                self.first.push(g);
                self.vertices.push(v);
                self.rings.push(ring);
                *place = self.vertices.len() as u32;
            }
            self.corners.push(*place - 1);
            self.half_edges.push(g);
            g = c.next(g);
            if g == h {
                break;
            }
        }
        self.offsets.push(self.corners.len() as u32);
    }

    /// Adds every face around the vertex that `h` leaves: from `h` on counter-clockwise, then what a boundary hides.
    #[inline(always)]
    fn around<C: Connectivity>(&mut self, c: &C, h: u32, ring: u32) {
        let mut g = h;
        loop {
            self.face(c, g, ring);
            g = c.twin(c.prev(g));
            if g == h {
                return;
            }
            if is_boundary(g) {
                break;
            }
        }
        g = c.twin(h);
        while !is_boundary(g) {
            g = c.next(g);
            self.face(c, g, ring);
            g = c.twin(g);
        }
    }

    /// The kind of anchor, faces, and sharp vertices within `rings`.
    fn write_key(&mut self, anchor: Anchor, rings: u32) {
        let kind = match anchor {
            Anchor::Vertex(_) => 0,
            Anchor::Edge(_) => 1,
            Anchor::Face(_) => 2,
        };
        let Seen { key, offsets, corners, sharp, rings: ring, .. } = self;
        key.extend([kind, offsets.len() as u32]);
        key.extend(offsets.windows(2).map(|w| w[1] - w[0]));
        key.extend(&corners[..]);
        key.extend((0..sharp.len() as u32).filter(|&v| sharp[v as usize] && ring[v as usize] < rings));
    }

    /// The neighbourhood as a mesh of its own, for `split`.
    pub fn patch(&mut self, c: &impl Connectivity, split: Split) -> Patch {
        // Where each face begins in the lists, again.
        for (h, &g) in self.half_edges.iter().enumerate().rev() {
            self.face_at[c.face(g) as usize] = h as u32 + 1;
        }
        let mut mate = vec![UNMATCHED; self.half_edges.len()];
        for (h, &g) in self.half_edges.iter().enumerate() {
            let t = c.twin(g);
            let start = if is_boundary(t) { 0 } else { self.face_at[c.face(t) as usize] };
            if start != 0 {
                let run = &self.half_edges[start as usize - 1..];
                mate[h] = start - 1 + run.iter().position(|&x| x == t).unwrap_or(0) as u32;
            }
        }
        for &g in &self.half_edges {
            self.face_at[c.face(g) as usize] = 0;
        }
        let (mut offsets, mut corners) = (self.offsets.clone(), self.corners.clone());
        if let Split::Sqrt3 { .. } = split {
            let ends = |h: usize| mate[h] == UNMATCHED && !is_boundary(c.twin(self.half_edges[h]));
            let ends: Vec<u32> = (0..).zip(&self.half_edges).map(|x| x.0).filter(|&h| ends(h as usize)).collect();
            close(&ends, &mut offsets, &mut corners, &mut mate);
        }
        let (topology, class) = Topology::assemble(offsets, &corners, self.vertices.len(), &mate);
        let back = |c: &u32| *c as usize;
        let marked = !self.edge_sharpness.is_empty() || !self.vertex_sharpness.is_empty() || !self.beyond.is_empty();
        let edge = |h: u32| self.edge_sharpness.get(h as usize).copied().unwrap_or(0.0);
        let vertex = |v: u32| self.vertex_sharpness.get(back(&class[v as usize])).copied().unwrap_or(0.0);
        // Vertices that the patch has twice have it twice.
        let listed = |(v, c): (u32, &u32)| {
            let found = self.beyond.binary_search_by_key(c, |b| b.vertex).ok()?;
            Some(Beyond { vertex: v, ..self.beyond[found].clone() })
        };
        let beyond = (0..).zip(&class).filter_map(listed).collect();
        let creases = if marked { Creases::marked_by(&topology, edge, vertex, beyond) } else { None };
        Patch {
            creases,
            topology,
            rings: class.iter().map(|c| self.rings[back(c)]).collect(),
            sharp: class.iter().map(|c| self.sharp[back(c)]).collect(),
            joined: class.iter().map(|c| !self.sharp[back(c)]).collect(),
            vertices: class.iter().map(|c| self.vertices[back(c)]).collect(),
            class,
            knots: self.knots.clone(),
            key: self.key.clone(),
        }
    }
}

/// Puts a triangle on each of the triangles' sides where a patch `ends`, those of a row to one point: a split that cuts rims would
/// take such sides for one, of which a triangle can have no more than one. The point counts as a copy of one of the row's.
fn close(ends: &[u32], offsets: &mut Vec<u32>, corners: &mut Vec<u32>, mate: &mut Vec<u32>) {
    let next = |h: u32| if h % 3 == 2 { h - 2 } else { h + 1 };
    let first = corners.len() as u32;
    for (&h, i) in ends.iter().zip(0..) {
        let (a, b) = (corners[h as usize], corners[next(h) as usize]);
        corners.extend([b, a, a]);
        mate.extend([h, UNMATCHED, UNMATCHED]);
        mate[h as usize] = first + 3 * i;
        offsets.push(corners.len() as u32);
    }
    for &h in ends {
        // The side that goes on where this one ends: round the patch's faces there.
        let mut on = next(h);
        while mate[on as usize] < first {
            on = next(mate[on as usize]);
        }
        if mate[on as usize] != UNMATCHED {
            let (one, other) = (mate[h as usize] + 2, mate[on as usize] + 1);
            (mate[one as usize], mate[other as usize]) = (other, one);
        }
    }
}

/// A neighbourhood as a mesh. Vertices of the level that touch it with several separate fans occur more than once, later.
#[derive(Debug, Default)]
pub(super) struct Patch {
    pub topology: Topology,
    /// The level's vertex behind each.
    pub vertices: Vec<u32>,
    /// Its place among [`Seen::vertices`].
    pub class: Vec<u32>,
    /// How many edges away from the anchor each is.
    pub rings: Vec<u32>,
    /// Whether each stays where it is.
    pub sharp: Vec<bool>,
    /// Whether each is no corner, though one face of the patch alone has it: the others, as the level has said which are.
    pub joined: Vec<bool>,
    /// Knot intervals, as of a mesh; empty if all are 1.
    pub knots: Vec<f32>,
    /// How sharp its edges and vertices are.
    pub creases: Option<Creases>,
    /// As [`Seen::key`].
    pub key: Vec<u32>,
}

impl Patch {
    /// The rules' tags for this patch.
    pub fn tags<'a>(&'a self, tags: Tags<'a>, lone: &'a [u32]) -> Tags<'a> {
        Tags {
            sharp: &self.sharp,
            joined: &self.joined,
            knots: &self.knots,
            creases: self.creases.as_ref(),
            lone,
            ..tags
        }
    }
}
