//! Lines of the cage and points: one instance each, expanded to pixels in the vertex shader.
//!
//! ```text
//!   a *==========* b      28 bytes an edge: both ends, and how it is marked. Four vertices of a strip, as wide as the
//!                         line and one pixel more for its soft rim, with round ends so that lines join.
//!   (o)                   12 bytes a point.
//! ```
//!
//! The cage is drawn twice: where the surface hides it, faintly (depth test Greater), and then where it does not. Both
//! are pulled towards the viewer by a few pixels' worth of depth, so that a cage that lies in the surface shows cleanly.

use crate::surface::buffer;
use crate::{Error, Gpu};

/// Instances over as many buffers as the adapter's limit asks for.
#[derive(Default)]
pub(crate) struct Instances {
    pub chunks: Vec<(wgpu::Buffer, u32)>,
}

/// Instances that are packed at a time.
const SLICE: usize = 1 << 16;

impl Instances {
    /// Packs `count` instances of N bytes each, asking `at` for one after the other.
    fn fill<const N: usize>(
        gpu: &Gpu,
        count: usize,
        mut at: impl FnMut(usize) -> Result<[u8; N], Error>,
    ) -> Result<Instances, Error> {
        let most = (gpu.max_buffer().min(96 << 20) / N as u64) as usize / SLICE * SLICE;
        let mut out = Instances::default();
        let mut scratch = Vec::with_capacity(SLICE.min(count) * N);
        let mut first = 0;
        while first < count {
            let n = most.min(count - first);
            let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
            let made = buffer(gpu, "instances", (n * N) as u64, usage);
            for start in (0..n).step_by(SLICE) {
                scratch.clear();
                for i in start..(start + SLICE).min(n) {
                    scratch.extend_from_slice(&at(first + i)?);
                }
                gpu.queue.write_buffer(&made, (start * N) as u64, &scratch);
            }
            out.chunks.push((made, n as u32));
            first += n;
        }
        Ok(out)
    }

    pub fn lines(gpu: &Gpu, points: &[[f32; 3]], edges: &[[u32; 2]], marks: &[f32]) -> Result<Instances, Error> {
        Self::fill(gpu, edges.len(), |i| {
            let mut line = [0.0f32; 7];
            for (end, &v) in edges.get(i).unwrap_or(&[0; 2]).iter().enumerate() {
                let point = points.get(v as usize).ok_or(limn_layout::Error::Index {
                    corner: (2 * i + end) as u64,
                    index: v,
                    vertices: points.len() as u64,
                })?;
                line[3 * end..3 * end + 3].copy_from_slice(point);
            }
            line[6] = marks.get(i).copied().unwrap_or_default();
            Ok(bytemuck::cast::<_, [u8; 28]>(line))
        })
    }

    pub fn points(gpu: &Gpu, points: &[[f32; 3]]) -> Result<Instances, Error> {
        Self::fill(gpu, points.len(), |i| {
            Ok(bytemuck::cast::<[f32; 3], [u8; 12]>(points.get(i).copied().unwrap_or_default()))
        })
    }
}

/// The edges of polygons, each once, lower vertex first: for [`crate::Renderer::set_cage`] when no topology is at hand.
///
/// Sorts, so the cost is n log n; boundary and non-manifold edges come once as well.
pub fn edges(faces: crate::Faces<'_>) -> Vec<[u32; 2]> {
    let mut out = Vec::with_capacity(faces.corners().len());
    for f in 0..faces.count() {
        let (_, polygon) = faces.face(f);
        let Some(&last) = polygon.last() else { continue };
        let mut a = last;
        for &b in polygon {
            if a != b {
                out.push([a.min(b), a.max(b)]);
            }
            a = b;
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn each_edge_comes_once() {
        let e = super::edges(crate::Faces::Polygons { offsets: &[0, 4, 7], corners: &[0, 1, 2, 3, 2, 1, 4] });
        assert_eq!(e, [[0, 1], [0, 3], [1, 2], [1, 4], [2, 3], [2, 4]]);
    }
}
