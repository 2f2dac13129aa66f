//! A surface as its caller has it: plain slices, and what they mean.

use crate::Error;
use crate::corners::{Triangulate, fan};

/// Faces as plain slices of vertex indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Faces<'a> {
    /// Three corners a face.
    Triangles(&'a [u32]),
    /// Four corners a face; after a quad split (old, edge, face, edge).
    Quads(&'a [u32]),
    /// Face f has the corners `offsets[f]..offsets[f + 1]`; one offset more than faces.
    Polygons {
        /// Offsets into `corners`.
        offsets: &'a [u32],
        /// Vertex indices.
        corners: &'a [u32],
    },
}

impl<'a> Faces<'a> {
    /// Number of faces.
    pub fn count(&self) -> usize {
        match self {
            Faces::Triangles(c) => c.len() / 3,
            Faces::Quads(c) => c.len() / 4,
            Faces::Polygons { offsets, .. } => offsets.len().saturating_sub(1),
        }
    }

    /// All corners.
    pub fn corners(&self) -> &'a [u32] {
        match self {
            Faces::Triangles(c) | Faces::Quads(c) | Faces::Polygons { corners: c, .. } => c,
        }
    }

    /// First corner number and vertices of face `f`; empty where the offsets make no sense.
    pub fn face(&self, f: usize) -> (usize, &'a [u32]) {
        let (a, b) = match self {
            Faces::Triangles(_) => (3 * f, 3 * f + 3),
            Faces::Quads(_) => (4 * f, 4 * f + 4),
            Faces::Polygons { offsets, .. } => match (offsets.get(f), offsets.get(f + 1)) {
                (Some(&a), Some(&b)) => (a as usize, b as usize),
                _ => (0, 0),
            },
        };
        (a, self.corners().get(a..b).unwrap_or(&[]))
    }
}

/// Faces that are drawn with one material and hidden or shown together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Index into the renderer's materials; anything past its end is the default material.
    pub material: u32,
    /// Group number, for hiding.
    pub group: u32,
}

/// A surface as the caller has it. Nothing is copied until a [`crate::Packer`] runs.
#[derive(Clone, Copy)]
pub struct SurfaceData<'a> {
    /// Positions.
    pub points: &'a [[f32; 3]],
    /// Unit normals, one a point; empty takes the faces' own.
    pub normals: &'a [[f32; 3]],
    /// The faces.
    pub faces: Faces<'a>,
    /// The vertex order after a split: old vertices are `0..a`, face points `a..b`, edge points `b..` (`a == b` after a
    /// triangle split). None: nothing is known, and all edges count as the parent's.
    pub parents: Option<[u32; 2]>,
    /// Texture coordinates (v upwards), and for each corner of `faces` the index of its own.
    pub uv: Option<(&'a [[f32; 2]], &'a [u32])>,
    /// Linear RGBA, one a point, or empty.
    pub colors: &'a [[f32; 4]],
    /// Parts that faces belong to; empty is one part with the default material in group 0.
    pub parts: &'a [Part],
    /// The part of a face; asked for only when there are several parts.
    pub part_of: Option<&'a dyn Fn(usize) -> u32>,
    /// What kind a face is, 1 to 3, to be coloured by; 0 is none. Corners only.
    pub kind_of: Option<&'a dyn Fn(usize) -> u32>,
    /// How polygons of more than three corners are cut.
    pub triangulate: Triangulate,
    /// Takes the corner layout even where shared quads would do: flat shading then shows one normal a quad.
    pub force_corners: bool,
}

impl<'a> SurfaceData<'a> {
    /// A surface of one part without colours, textures or known parents; polygons are cut into fans.
    pub fn new(points: &'a [[f32; 3]], normals: &'a [[f32; 3]], faces: Faces<'a>) -> Self {
        SurfaceData {
            points,
            normals,
            faces,
            parents: None,
            uv: None,
            colors: &[],
            parts: &[],
            part_of: None,
            kind_of: None,
            triangulate: fan,
            force_corners: false,
        }
    }

    /// Whether corners need the second buffer.
    pub(crate) fn has_extras(&self) -> bool {
        self.uv.is_some() || !self.colors.is_empty()
    }

    /// Whether the shared layout is taken: quads after a quad split without texture coordinates.
    pub fn is_shared(&self) -> bool {
        matches!(self.faces, Faces::Quads(_))
            && self.parents.is_some()
            && self.uv.is_none()
            && !self.force_corners
            && self.normals.len() == self.points.len()
    }

    /// Bytes that the buffers on the GPU will take: exact for shared quads, an upper bound for corners.
    pub fn gpu_bytes(&self) -> u64 {
        let (points, faces) = (self.points.len() as u64, self.faces.count() as u64);
        if self.is_shared() {
            points * if self.colors.is_empty() { 16 } else { 20 } + faces * 24
        } else {
            self.triangle_bound() * if self.has_extras() { 108 } else { 72 }
        }
    }

    /// How many triangles the faces are cut into, at most.
    pub fn triangle_bound(&self) -> u64 {
        (self.faces.corners().len() as u64).saturating_sub(2 * self.faces.count() as u64)
    }

    /// Whether the slices belong together.
    ///
    /// # Errors
    /// [`Error::Mismatch`].
    pub fn check(&self) -> Result<(), Error> {
        let expect = |what, found: usize, expected: usize| {
            if found == expected {
                Ok(())
            } else {
                Err(Error::Mismatch { what, found: found as u64, expected: expected as u64 })
            }
        };
        if !self.normals.is_empty() {
            expect("normals", self.normals.len(), self.points.len())?;
        }
        if !self.colors.is_empty() {
            expect("colours", self.colors.len(), self.points.len())?;
        }
        if let Some((_, corners)) = self.uv {
            expect("texture corners", corners.len(), self.faces.corners().len())?;
        }
        // A range check of the polygons' ends: fewer corners than the last offset says would drop faces silently.
        if let Faces::Polygons { offsets, corners } = self.faces {
            expect("polygon corners", corners.len(), offsets.last().map_or(0, |&o| o as usize))?;
        }
        Ok(())
    }
}

/// An axis-aligned box around the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates.
    pub min: [f32; 3],
    /// Highest coordinates.
    pub max: [f32; 3],
}

impl Bounds {
    /// Nothing.
    pub const EMPTY: Bounds = Bounds { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// Grows to hold points; numbers that are none count for nothing.
    pub fn add_all(&mut self, points: &[[f32; 3]]) {
        #[cfg(feature = "wide")]
        let points = self.add_groups(points);
        for p in points {
            // min and max let the other operand win over NaN.
            for ((min, max), &v) in self.min.iter_mut().zip(&mut self.max).zip(p) {
                (*min, *max) = (min.min(v), max.max(v));
            }
        }
    }

    /// Four points are three vectors of four, in which every coordinate stays in its lane. Gives what is left over.
    #[cfg(feature = "wide")]
    fn add_groups<'a>(&mut self, points: &'a [[f32; 3]]) -> &'a [[f32; 3]] {
        let (groups, rest) = points.as_chunks::<4>();
        let (mut low, mut high) = ([f32::INFINITY; 12], [f32::NEG_INFINITY; 12]);
        for group in groups {
            for (i, &v) in group.as_flattened().iter().enumerate() {
                // Comparing with NaN is false.
                low[i] = if v < low[i] { v } else { low[i] };
                high[i] = if v > high[i] { v } else { high[i] };
            }
        }
        for i in 0..12 {
            self.min[i % 3] = self.min[i % 3].min(low[i]);
            self.max[i % 3] = self.max[i % 3].max(high[i]);
        }
        rest
    }

    /// Whether there is anything inside.
    pub fn is_empty(&self) -> bool {
        !(0..3).all(|i| self.min[i] <= self.max[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_told_before_anything_is_made() {
        let points = [[0.0; 3]; 9];
        let quads = [0u32; 16];
        let mut data = SurfaceData::new(&points, &points, Faces::Quads(&quads));
        assert_eq!(data.gpu_bytes(), 8 * 72);
        data.parents = Some([4, 5]);
        assert!(data.is_shared());
        assert_eq!(data.gpu_bytes(), 9 * 16 + 4 * 24);
        data.force_corners = true;
        assert_eq!(data.gpu_bytes(), 8 * 72);
    }

    #[test]
    fn boxes_hold_every_point_and_no_nan() {
        for n in 0..13 {
            let mut points: Vec<[f32; 3]> = (0..n).map(|i| [i as f32, -(i as f32), 2.0]).collect();
            points.push([f32::NAN, 5.0, 0.5]);
            let mut bounds = Bounds::EMPTY;
            bounds.add_all(&points);
            let last = n as f32 - 1.0;
            let expected = if n == 0 {
                [[f32::INFINITY, 5.0, 0.5], [f32::NEG_INFINITY, 5.0, 0.5]]
            } else {
                [[0.0, -last, 0.5], [last, 5.0, 2.0]]
            };
            assert_eq!([bounds.min, bounds.max], expected, "{n}");
        }
    }

    #[test]
    fn slices_must_belong_together() {
        let points = [[0.0; 3]; 3];
        let mut data = SurfaceData::new(&points, &points[..2], Faces::Triangles(&[0, 1, 2]));
        assert_eq!(data.check(), Err(Error::Mismatch { what: "normals", found: 2, expected: 3 }));
        data.normals = &[];
        data.faces = Faces::Polygons { offsets: &[0, 4], corners: &[0, 1, 2] };
        assert_eq!(data.check(), Err(Error::Mismatch { what: "polygon corners", found: 3, expected: 4 }));
        assert_eq!(data.faces.face(0).1, &[] as &[u32]);
    }
}
