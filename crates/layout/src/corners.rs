//! The corner layout: every triangle has three vertices of its own, so each can carry what belongs to the corner.
//!
//! ```text
//!        2            bit c   of flags: the edge opposite corner c is an edge of the polygon (not a diagonal)
//!       / \           bit c+3 of flags: that edge is (part of) an edge of the level before
//!      /   \          bits 6 and 7: the polygon's kind, see [`SurfaceData::kind_of`]
//!     0-----1         the corner number is vertex_index % 3, so barycentrics need no memory
//! ```
//!
//! A corner takes 24 bytes (position, smooth normal, face normal, flags), and 12 more in a second buffer when there are
//! texture coordinates or colours. The face normal is Newell's over the whole polygon, so flat shading shows a bent quad
//! or n-gon as one facet. An edge is the parent level's when one end is an old vertex and the other an edge point, which
//! the ranges of the vertex order tell.

use bytemuck::{Pod, Zeroable};

use crate::{Error, Faces, SurfaceData, pack};

/// Cuts a polygon into triangles of local corner numbers: `(points, polygon's vertex indices, out)`.
///
/// `out` comes in empty; up to n-2 triangles are taken from it. The diagonals follow from its answers.
pub type Triangulate = fn(&[[f32; 3]], &[u32], &mut Vec<[u32; 3]>);

/// The simplest [`Triangulate`]: a fan around the first corner. Right for convex polygons only.
pub fn fan(_points: &[[f32; 3]], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    for i in 2..polygon.len() as u32 {
        out.push([0, i - 1, i]);
    }
}

/// One corner as the vertex shader reads it: 24 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Corner {
    /// Position.
    pub position: [f32; 3],
    /// Smooth normal, octahedral.
    pub normal: [i16; 2],
    /// Normal of the whole polygon, octahedral.
    pub face: [i16; 2],
    /// Edge and kind bits, see the module.
    pub flags: u32,
}

/// What textured or coloured corners carry besides: 12 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Extra {
    /// Texture coordinates, v upwards as in OBJ.
    pub uv: [f32; 2],
    /// sRGB colour.
    pub color: [u8; 4],
}

/// Turns faces into corners one by one, keeping scratch memory between them.
#[derive(Default)]
pub struct Builder {
    /// Corners so far; the caller drains them.
    pub corners: Vec<Corner>,
    /// Extras so far, as many as corners when the data has texture coordinates or colours; else empty.
    pub extras: Vec<Extra>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    /// Appends the triangles of face `f`. Faces of fewer than three corners give none.
    ///
    /// # Errors
    /// [`Error::Index`] when a corner points outside of its slice.
    pub fn push(&mut self, data: &SurfaceData<'_>, f: usize) -> Result<(), Error> {
        let (first, polygon) = data.faces.face(f);
        let n = polygon.len();
        if n < 3 {
            return Ok(());
        }
        for (i, &v) in polygon.iter().enumerate() {
            if v as usize >= data.points.len() {
                return Err(Error::Index { corner: (first + i) as u64, index: v, vertices: data.points.len() as u64 });
            }
        }
        self.triangles.clear();
        match (n, data.faces, data.parents) {
            (3, ..) => self.triangles.push([0, 1, 2]),
            // Split as the shared layout does it, so that both give one picture.
            (4, Faces::Quads(_), Some(_)) => self.triangles.extend([[0, 1, 2], [0, 2, 3]]),
            _ => (data.triangulate)(data.points, polygon, &mut self.triangles),
        }
        let face = pack::normal(newell(data.points, polygon));
        let kind = data.kind_of.map_or(0, |kind| kind(f) & 3) << 6;
        for t in self.triangles.iter().take(n - 2) {
            let [Some(&a), Some(&b), Some(&c)] = t.map(|l| polygon.get(l as usize)) else { continue };
            let (local, global) = (*t, [a, b, c]);
            let flags = edge_flags(local, global, n as u32, data.parents) | kind;
            for (l, v) in local.into_iter().zip(global) {
                let v = v as usize;
                let normal = data.normals.get(v).map_or(face, |&m| pack::normal(m));
                self.corners.push(Corner { position: data.points[v], normal, face, flags });
                if data.has_extras() {
                    let corner = first + l as usize;
                    let uv = match data.uv {
                        None => [0.0; 2],
                        Some((values, corners)) => {
                            let at = corners.get(corner).copied().unwrap_or(u32::MAX);
                            *values.get(at as usize).ok_or(Error::Index {
                                corner: corner as u64,
                                index: at,
                                vertices: values.len() as u64,
                            })?
                        }
                    };
                    let color = data.colors.get(v).map_or([255; 4], |&c| pack::color(c));
                    self.extras.push(Extra { uv, color });
                }
            }
        }
        Ok(())
    }
}

/// Newell's normal (twice the area vector), summed relative to the first corner to keep far-away models exact.
fn newell(points: &[[f32; 3]], polygon: &[u32]) -> [f32; 3] {
    let o = points[polygon[0] as usize];
    let at = |i: usize| {
        let p = points[polygon[i] as usize];
        [p[0] - o[0], p[1] - o[1], p[2] - o[2]]
    };
    let mut sum = [0.0f32; 3];
    let mut a = at(1);
    for i in 2..polygon.len() {
        let b = at(i);
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
        a = b;
    }
    sum
}

/// The six edge bits of one triangle of a polygon of `n` corners.
pub fn edge_flags(local: [u32; 3], global: [u32; 3], n: u32, parents: Option<[u32; 2]>) -> u32 {
    let mut flags = 0;
    for c in 0..3 {
        let (i, j) = ((c + 1) % 3, (c + 2) % 3);
        let (a, b) = (local[i], local[j]);
        if (a + 1) % n != b && (b + 1) % n != a {
            continue;
        }
        flags |= 1 << c;
        let (low, high) = (global[i].min(global[j]), global[i].max(global[j]));
        if parents.is_none_or(|[old, faces]| low < old && high >= faces) {
            flags |= 8 << c;
        }
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SurfaceData;

    const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];

    #[test]
    fn a_quad_has_four_real_edges_and_a_hidden_diagonal() {
        let quads = [0, 1, 2, 3];
        let data = SurfaceData::new(&SQUARE, &[], Faces::Quads(&quads));
        let mut b = Builder::default();
        b.push(&data, 0).unwrap();
        let p: Vec<_> = b.corners.iter().map(|c| c.position).collect();
        assert_eq!(p, [SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[0], SQUARE[2], SQUARE[3]]);
        // (0,1,2): the edge opposite corner 1 is 2-0, the diagonal. (0,2,3): opposite corner 2 is 0-2.
        assert_eq!(b.corners[0].flags, 0b101_101);
        assert_eq!(b.corners[3].flags, 0b011_011);
        assert_eq!(pack::unpack_normal(b.corners[0].face), [0.0, 0.0, 1.0]);
        assert_eq!(b.corners[0].normal, b.corners[0].face);
        assert!(b.extras.is_empty());
    }

    #[test]
    fn parent_edges_follow_the_vertex_order() {
        // Vertex 0 is old, 1 the face point, 2 and 3 edge points.
        let points = [SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]];
        let quads = [0, 2, 1, 3];
        let mut data = SurfaceData::new(&points, &[], Faces::Quads(&quads));
        data.parents = Some([1, 2]);
        let mut b = Builder::default();
        b.push(&data, 0).unwrap();
        // Triangle (old, edge, face): opposite 2 is old-edge = parent, opposite 0 is edge-face = new.
        assert_eq!(b.corners[0].flags, 0b100_101);
        // Triangle (old, face, edge): opposite 1 is edge-old = parent, opposite 0 face-edge = new.
        assert_eq!(b.corners[3].flags, 0b010_011);
        // A triangle split: old 0, edge points 1 and 2.
        let tri = [0, 1, 2];
        let mut data = SurfaceData::new(&points, &[], Faces::Triangles(&tri));
        data.parents = Some([1, 1]);
        b = Builder::default();
        b.push(&data, 0).unwrap();
        assert_eq!(b.corners[0].flags, 0b110_111);
    }

    #[test]
    fn polygons_carry_uv_colour_and_their_own_normal() {
        let points = [SQUARE[0], SQUARE[1], SQUARE[2], [1.0, 3.0, 0.0], SQUARE[3]];
        let (offsets, corners) = ([0, 5], [0, 1, 2, 3, 4]);
        let colors = [[1.0, 0.0, 0.0, 1.0]; 5];
        let (values, at) = ([[0.25, 0.5], [1.0, 0.0]], [0, 1, 0, 1, 0]);
        let mut data =
            SurfaceData::new(&points, &[[0.0, 0.0, -1.0]; 5], Faces::Polygons { offsets: &offsets, corners: &corners });
        data.colors = &colors;
        data.uv = Some((&values, &at));
        let mut b = Builder::default();
        b.push(&data, 0).unwrap();
        assert_eq!(b.corners.len(), 9);
        let flags: Vec<_> = b.corners.iter().step_by(3).map(|c| c.flags & 7).collect();
        assert_eq!(flags, [0b101, 0b001, 0b011]);
        assert_eq!(b.extras[1], Extra { uv: [1.0, 0.0], color: [255, 0, 0, 255] });
        assert_eq!(b.extras[8].uv, [0.25, 0.5]);
        assert_eq!(pack::unpack_normal(b.corners[4].face), [0.0, 0.0, 1.0]);
        assert_eq!(pack::unpack_normal(b.corners[4].normal), [0.0, 0.0, -1.0]);
        let bad = [0, 1, 9];
        let data = SurfaceData::new(&points, &[], Faces::Triangles(&bad));
        assert_eq!(b.push(&data, 0), Err(Error::Index { corner: 2, index: 9, vertices: 5 }));
    }
}
