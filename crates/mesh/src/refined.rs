//! A level of a mesh as drawing and files want it: points, faces, and what lies on them.
//!
//! ```text
//!   faces.corners()   v v v v | v v v v | ...      one vertex a corner, faces one after the other
//!   uv.corners        t t t t | t t t t | ...      one texture coordinate a corner, in the same order
//! ```
//!
//! Half-edges are gone by now; what is asked of a face's past (which face of the file it came from) is arithmetic on its
//! number. Limit: normals are those of the faces around a vertex, unless the plan takes the points to the limit.

use crate::mesh::Mesh;
use crate::split::{FaceKind, Split};
use crate::topology::{Connectivity, Counts};
use std::sync::Arc;

/// The faces of a level.
#[derive(Clone, Debug, PartialEq)]
pub enum Faces {
    /// Any polygons: face f has corners `offsets[f] .. offsets[f + 1]`.
    Polygons {
        /// Where each face begins, and the end.
        offsets: Vec<u32>,
        /// A vertex a corner.
        corners: Vec<u32>,
    },
    /// Three corners a face.
    Triangles(Vec<u32>),
    /// Four corners a face.
    Quads(Vec<u32>),
}

impl Faces {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Faces::Polygons { offsets, .. } => offsets.len().saturating_sub(1),
            Faces::Triangles(c) => c.len() / 3,
            Faces::Quads(c) => c.len() / 4,
        }
    }

    /// The corners of all faces in a row.
    pub fn corners(&self) -> &[u32] {
        match self {
            Faces::Polygons { corners, .. } | Faces::Triangles(corners) | Faces::Quads(corners) => corners,
        }
    }

    /// The corners of face `f`, as a range of [`Faces::corners`]. Panics if `f` is out of range.
    pub fn range(&self, f: usize) -> std::ops::Range<usize> {
        match self {
            Faces::Polygons { offsets, .. } => offsets[f] as usize..offsets[f + 1] as usize,
            Faces::Triangles(_) => 3 * f..3 * f + 3,
            Faces::Quads(_) => 4 * f..4 * f + 4,
        }
    }

    /// The corners of face `f`. Panics if `f` is out of range.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners()[self.range(f)]
    }
}

/// Texture coordinates of a level: values, and one of them for each corner in the order of [`Faces::corners`].
#[derive(Clone, Debug, PartialEq)]
pub struct UvValues {
    /// (u, v), v up.
    pub values: Vec<[f32; 2]>,
    /// The value of each corner.
    pub corners: Vec<u32>,
}

/// A level of a mesh, as drawing and files want it.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Which level.
    pub level: u32,
    /// Its counts, faces that are not shown among them.
    pub counts: Counts,
    /// How many faces are not shown: children of holes, and of faces at a rim that is left out. They are not in `faces`.
    pub hidden: u64,
    /// One point a vertex, in the recursive order (old | faces | edges).
    pub points: Vec<[f32; 3]>,
    /// The faces.
    pub faces: Faces,
    /// Texture coordinates, if the mesh has any.
    pub uv: Option<UvValues>,
    /// Linear RGBA, one a vertex; empty if the mesh has none.
    pub colors: Vec<[f32; 4]>,
    /// After a quad split: vertices below the first are the parent's, up to the second face points, then edge points.
    /// Every quad's corners are then old vertex, edge point, face point, edge point.
    pub parent_ranges: Option<[u32; 2]>,
    /// Vertices below this were the parent level's (all of them at level 0).
    pub vertex_parents: u32,
    /// Unit normals that are known already: of the limit surface where the points are there, else what a shaded job made.
    pub known_normals: Option<Vec<[f32; 3]>>,
    /// What each face was made from, after a dual split; else empty.
    pub kinds: Vec<FaceKind>,
    /// The mesh's face behind each face; empty where that is arithmetic.
    pub(crate) source: Vec<u32>,
    pub(crate) split: Split,
    pub(crate) mesh: Arc<Mesh>,
}

impl Refined {
    /// A level whose points and faces are not here but on the GPU: counts alone.
    pub fn elsewhere(mesh: Arc<Mesh>, level: u32, counts: Counts) -> Refined {
        Refined {
            level,
            counts,
            hidden: 0,
            points: Vec::new(),
            faces: Faces::Quads(Vec::new()),
            uv: None,
            colors: Vec::new(),
            parent_ranges: None,
            vertex_parents: 0,
            known_normals: None,
            kinds: Vec::new(),
            source: Vec::new(),
            split: Split::Quad,
            mesh,
        }
    }

    /// The soup's face that face `f` of this level came from. Cost: the level.
    pub fn face_source(&self, f: u32) -> u32 {
        if let Some(&source) = self.source.get(f as usize) {
            return self.mesh.face_source[source as usize];
        }
        let base = &self.mesh.topology;
        let mut f = f;
        let mut corners = u64::from(base.half_edges()) << (2 * self.level);
        for level in (1..=self.level).rev() {
            corners >>= 2; // of the level above
            f = match self.split {
                Split::Quad if level == 1 => base.face(f),
                Split::Quad => f >> 2,
                Split::Triangle if u64::from(f) < corners => f / 3,
                Split::Triangle => f - corners as u32,
                _ => f,
            };
        }
        self.mesh.face_source[f as usize]
    }

    /// What is known of the level before by a vertex's number alone: where face points begin, and edge points; none where nothing
    /// tells corners apart, and all edges count as its.
    pub fn parents(&self) -> Option<[u32; 2]> {
        match (self.parent_ranges, self.level) {
            (Some(ranges), _) => Some(ranges),
            (None, 0) => None,
            // Quads of another split.
            (None, _) if matches!(self.faces, Faces::Quads(_)) => None,
            (None, _) => Some([self.vertex_parents; 2]),
        }
    }

    /// The mesh that was refined.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Smooth unit normals: those of the limit where the points are there, else the area-weighted sum of the normals of the faces around each vertex (quads by their
    /// diagonals, polygons by Newell's sum); (0, 0, 0) where that vanishes. Cost: about 10 ns a face.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        self.known_normals.clone().unwrap_or_else(|| normals(&self.points, &self.faces))
    }
}

/// Fills in the faces' normals where `limit` has none.
pub(crate) fn complete(mut limit: Vec<[f32; 3]>, points: &[[f32; 3]], faces: &Faces) -> Vec<[f32; 3]> {
    if limit.contains(&[0.0; 3]) {
        let faces = normals(points, faces);
        limit.iter_mut().zip(faces).filter(|(n, _)| **n == [0.0; 3]).for_each(|(n, face)| *n = face);
    }
    limit
}

fn normals(points: &[[f32; 3]], faces: &Faces) -> Vec<[f32; 3]> {
    let sub = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let mut sums = vec![[0.0f32; 3]; points.len()];
    let mut add = |corners: &[u32], n: [f32; 3]| {
        for &v in corners {
            let s = &mut sums[v as usize];
            *s = [s[0] + n[0], s[1] + n[1], s[2] + n[2]];
        }
    };
    let p = |v: u32| points[v as usize];
    match faces {
        Faces::Quads(corners) => {
            for q in corners.chunks_exact(4) {
                add(q, cross(sub(p(q[2]), p(q[0])), sub(p(q[3]), p(q[1]))));
            }
        }
        Faces::Triangles(corners) => {
            for t in corners.chunks_exact(3) {
                add(t, cross(sub(p(t[1]), p(t[0])), sub(p(t[2]), p(t[0]))));
            }
        }
        Faces::Polygons { .. } => {
            for f in 0..faces.count() {
                let corners = faces.face(f);
                let origin = p(corners[0]);
                let mut n = [0.0; 3];
                for w in corners[1..].windows(2) {
                    let c = cross(sub(p(w[0]), origin), sub(p(w[1]), origin));
                    n = [n[0] + c[0], n[1] + c[1], n[2] + c[2]];
                }
                add(corners, n);
            }
        }
    }
    sums.iter_mut().for_each(|n| *n = unit(*n));
    sums
}

/// A vector of length one; zero if that cannot be told.
#[inline]
pub(crate) fn unit(n: [f32; 3]) -> [f32; 3] {
    // Scale by the largest component first: tiny faces have normals whose squares vanish.
    let largest = n[0].abs().max(n[1].abs()).max(n[2].abs());
    if largest > 0.0 && largest.is_finite() {
        let m = n.map(|x| x / largest);
        let length = (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]).sqrt();
        m.map(|x| x / length)
    } else {
        [0.0; 3]
    }
}
