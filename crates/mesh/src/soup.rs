//! Raw polygons, as a file gives them, before anything is known about how they connect.
//!
//! A [`Soup`] is four flat arrays: nothing in it is checked, so a reader can fill it without knowing about topology, and
//! [`crate::Mesh::build`] is the one place where bad indices, repeated corners and non-manifold edges are found.
//!
//! ```text
//!   offsets  0 ──── 4 ─── 7        face f has corners offsets[f] .. offsets[f + 1]
//!   corners  0 1 2 3 3 2 4         each corner names a position ...
//!   uv_corners 0 1 2 3 3 2 NONE    ... and, where the file says so, a texture coordinate of its own
//! ```

/// Marks a corner without a texture coordinate, or a face without a material.
pub const NONE: u32 = u32::MAX;

/// Polygons with positions, and whatever else a file says about them. All indices are 0-based.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Vertex positions in file order.
    pub positions: Vec<[f32; 3]>,
    /// The part of each position: welding joins positions of one part only, so that objects which touch stay apart. Empty
    /// if all are of one.
    pub parts: Vec<u32>,
    /// Where each face's corners begin in `corners`; one longer than the number of faces (empty means no faces).
    pub offsets: Vec<u32>,
    /// The position index of each corner.
    pub corners: Vec<u32>,
    /// Texture coordinates (v up, as OBJ has it); empty if there are none.
    pub uvs: Vec<[f32; 2]>,
    /// The texture coordinate of each corner, or [`NONE`]; empty if there are none, else as long as `corners`.
    pub uv_corners: Vec<u32>,
    /// Linear RGBA in 0..=1 for each position; empty if there are none.
    pub colors: Vec<[f32; 4]>,
    /// The group of each face; empty if all are in one.
    pub face_groups: Vec<u32>,
    /// The material of each face, or [`NONE`]; empty if no face has one.
    pub face_materials: Vec<u32>,
    /// What schemes have to know beside the shape.
    pub marks: Marks,
}

/// Creases, corners, holes and knots, by positions and faces of the soup. Of several for one place the last counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    /// Edges by their ends, with their sharpness: 0 is smooth, 10 and more infinitely sharp.
    pub creases: Vec<([u32; 2], f32)>,
    /// Vertices with their sharpness.
    pub corners: Vec<(u32, f32)>,
    /// Faces that are refined and not shown.
    pub holes: Vec<u32>,
    /// Knot intervals at the first vertex toward the second, greater than or equal to 0; 1 where there is none.
    pub knots: Vec<([u32; 2], f32)>,
}

impl Marks {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.creases.is_empty() && self.corners.is_empty() && self.holes.is_empty() && self.knots.is_empty()
    }
}

impl Soup {
    /// A soup of positions and faces alone.
    pub fn from_faces<F: AsRef<[u32]>>(positions: Vec<[f32; 3]>, faces: &[F]) -> Self {
        let mut soup = Soup { positions, ..Self::default() };
        for face in faces {
            soup.push_face(face.as_ref());
        }
        soup
    }

    /// The same vertices and texture coordinates, and no faces: where a new set of faces begins.
    pub fn vertices_only(&self) -> Self {
        Soup {
            positions: self.positions.clone(),
            parts: self.parts.clone(),
            uvs: self.uvs.clone(),
            colors: self.colors.clone(),
            marks: Marks { holes: Vec::new(), ..self.marks.clone() },
            ..Self::default()
        }
    }

    /// Appends a face given by its position indices.
    pub fn push_face(&mut self, corners: &[u32]) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.corners.extend_from_slice(corners);
        self.offsets.push(self.corners.len() as u32);
    }

    /// Whether each face is a hole; empty if none is.
    pub fn is_hole(&self) -> Vec<bool> {
        if self.marks.holes.is_empty() {
            return Vec::new();
        }
        let mut is_hole = vec![false; self.face_count()];
        for &f in &self.marks.holes {
            is_hole.get_mut(f as usize).into_iter().for_each(|hole| *hole = true);
        }
        is_hole
    }

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The corner range of face `f` in `corners` and `uv_corners`. Panics if `f` is out of range.
    pub fn face_range(&self, f: usize) -> std::ops::Range<usize> {
        self.offsets[f] as usize..self.offsets[f + 1] as usize
    }

    /// The position indices of face `f`. Panics if `f` is out of range.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.face_range(f)]
    }
}
