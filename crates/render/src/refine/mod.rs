//! Refinement on the GPU: cage points in, points and normals where the draw reads them, nothing in between on the CPU.
//!
//! ```text
//!                 once                                         for every new position of the cage
//!   tables ──► half-edges 1 ──► half-edges 2 ..         points ──► level 1 ──► level 2 .. ──► normals
//!              (by arithmetic)                   └──► indices       one dispatch each, all of them in one compute pass
//! ```
//!
//! Two ways make the points. *The fused gather* (`fused.rs`): hand-written rules that find a level's neighbours through `twin`
//! and `origin` alone, so a level costs one dispatch and no atomics; half-edges of the next level are arithmetic (Dupuy & Vanhoey
//! 2021; Vanhoey & Dupuy 2022), and those of the last are never built. Colours go the same way ([`Values`]). *Rows* (`rows.rs`): every other scheme's weights as sparse
//! rows, one dispatch a pass. Both number child vertices as `limn-mesh` does, so what was made here and there can be compared, drawn
//! and exported alike.
//!
//! Cost on the GPU, Catmull-Clark, bytes a face of the last level: 16 written for points, 4 for normals and, once, 24 for
//! indices; about 16 read of the level before. Memory besides: a quarter, a sixteenth .. of 16 for points and 36 for half-edges.
//! Limits: a level's points, and half-edges of the one before, must fit one binding ([`Error::TooLarge`] says by how much they
//! do not); indices and corners are made in pieces. One material, no texture coordinates, no hidden faces. The GPU's sums differ from the
//! CPU's by their rounding: at most 3e-7 of the box on 418 levels in Chromium's software WebGPU.

mod cage;
mod finish;
mod fused;
mod kernels;
mod rows;

pub use cage::Cage;
pub use rows::{Pass, RowLevel, Rows};

use crate::surface::{Bounds, Surface};
use crate::{Error, Gpu};
use finish::Drawn;
use kernels::{Kernel, Kernels, Level, Step, whole};

/// A scheme that has kernels of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// Catmull-Clark on any polygons.
    CatmullClark {
        /// What the centroid of a triangle weighs in the points of its edges: 1/4, or 0.47 by OpenSubdiv's smooth rule.
        triangle: f32,
    },
    /// The quad split of any polygons without moving the surface.
    Quads,
    /// The triangle split of triangles without moving the surface.
    Triangles,
    /// Loop on triangles.
    Loop {
        /// Warren's weights.
        warren: bool,
    },
    /// Butterfly on triangles.
    Butterfly {
        /// The tension.
        w: f32,
    },
    /// Modified Butterfly on triangles.
    ModifiedButterfly,
    /// Sqrt3 on closed meshes of triangles. On a rim every second step numbers vertices by ranks that are no arithmetic: rows.
    Sqrt3,
    /// Doo-Sabin on closed meshes of any polygons, three and more around every vertex.
    DooSabin {
        /// Doo's midpoint weights.
        midpoint: bool,
    },
}

/// What holds beside the scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// The scheme.
    pub scheme: Scheme,
    /// Whether boundary vertices of one face stay.
    pub corners: bool,
    /// Whether creases soften by Chaikin's rule.
    pub chaikin: bool,
}

/// What is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Points, with normals and faces to be drawn.
    Points,
    /// Linear colours, by the same rules, for the surface that points make.
    Colors,
}

/// The kernels that were compiled so far; one for all refiners of a device.
#[derive(Default)]
pub struct Compute {
    kernels: Kernels,
}

/// A mesh, a plan, and the buffers that it fills. Make one with [`Refiner::fused`] or [`Refiner::rows`].
pub struct Refiner {
    cage: wgpu::Buffer,
    cage_vertices: u32,
    /// Dispatches that depend on connectivity alone; none once they have run.
    once: Vec<Step>,
    each: Vec<Step>,
    vertices: wgpu::Buffer,
    count: u32,
    drawn: Drawn,
    /// Colours as the draw reads them.
    packed: Option<wgpu::Buffer>,
    bytes: u64,
}

impl Refiner {
    /// Puts `points` into the cage from vertex `first` on. What is refined changes with the next [`Refiner::refine`].
    ///
    /// Cost: 16 bytes a point to the GPU.
    ///
    /// # Errors
    /// [`Error::Mismatch`] for more points than there are vertices.
    pub fn set_points(&self, gpu: &Gpu, first: u32, points: &[[f32; 3]]) -> Result<(), Error> {
        let padded: Vec<[f32; 4]> = points.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        self.set_values(gpu, first, &padded)
    }

    /// The same of values of four numbers: linear RGBA.
    ///
    /// # Errors
    /// [`Error::Mismatch`] for more values than there are vertices.
    pub fn set_values(&self, gpu: &Gpu, first: u32, values: &[[f32; 4]]) -> Result<(), Error> {
        let end = u64::from(first) + values.len() as u64;
        if end > u64::from(self.cage_vertices) {
            return Err(Error::Mismatch { what: "cage points", found: end, expected: self.cage_vertices.into() });
        }
        gpu.queue.write_buffer(&self.cage, u64::from(first) * 16, bytemuck::cast_slice(values));
        Ok(())
    }

    /// Records and submits everything in one compute pass. Nothing is waited for. Cost on the CPU: some 20 microseconds.
    pub fn refine(&mut self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("refine") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for step in self.once.drain(..) {
                step.record(&mut pass);
            }
            for step in &self.each {
                step.record(&mut pass);
            }
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// The surface that is filled: the same buffers, so that it changes with every [`Refiner::refine`]. `bounds` is the box that the
    /// caller knows around the points (the GPU's are not read back), `colors` a refiner of [`Values::Colors`] beside this one.
    ///
    /// # Errors
    /// [`Error::Mismatch`] where there are colours and faces do not share vertices, or the colours are of others.
    pub fn surface(&self, bounds: Bounds, colors: Option<&Refiner>) -> Result<Surface, Error> {
        let packed = match (colors, &self.drawn) {
            (None, _) => None,
            (Some(r), Drawn::Quads { .. }) if r.count == self.count && r.packed.is_some() => r.packed.as_ref(),
            (Some(r), _) => {
                let (found, expected) = (r.count.into(), self.count.into());
                return Err(Error::Mismatch { what: "colours of vertices that quads share", found, expected });
            }
        };
        Ok(self.drawn.surface(&self.vertices, self.count, bounds, packed))
    }

    /// The vertices: 16 bytes each, position and octahedral normal, in the order of `limn-mesh`; of colours four numbers. They can be
    /// copied from.
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Refiner {
    /// A refiner that gives colours: `values` of the last level, and the same as the draw reads them.
    fn colors(
        mut buffers: Buffers<'_>,
        kernels: &mut Kernels,
        (cage, cage_vertices): (wgpu::Buffer, u32),
        (once, mut each): (Vec<Step>, Vec<Step>),
        (values, count): (wgpu::Buffer, u32),
    ) -> Result<Refiner, Error> {
        let packed =
            buffers.make("colours", 4 * u64::from(count), wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_SRC)?;
        let numbers = Level { end: count, ..Level::default() };
        each.extend(kernels.step(buffers.gpu, Kernel::Colors, &numbers, &[], &[whole(&values), whole(&packed)]));
        let drawn = Drawn::Corners { pieces: Vec::new() };
        let bytes = buffers.bytes;
        Ok(Refiner { cage, cage_vertices, once, each, vertices: values, count, drawn, packed: Some(packed), bytes })
    }
}

/// The text of every kernel with a name, each as it is handed to the device. For tests that validate them.
pub fn shaders() -> Vec<(String, String)> {
    kernels::sources()
}

/// Buffers of a refinement, refused before one is made.
pub(crate) struct Buffers<'g> {
    gpu: &'g Gpu,
    bytes: u64,
}

impl<'g> Buffers<'g> {
    fn new(gpu: &'g Gpu) -> Self {
        Buffers { gpu, bytes: 0 }
    }

    /// The largest that can be bound whole.
    fn limit(&self) -> u64 {
        let limits = self.gpu.device.limits();
        limits.max_buffer_size.min(limits.max_storage_buffer_binding_size)
    }

    /// Refuses what cannot be bound.
    fn admit(&self, what: &'static str, bytes: u64) -> Result<(), Error> {
        let limit = self.limit();
        if bytes > limit { Err(Error::TooLarge { what, bytes, limit }) } else { Ok(()) }
    }

    fn make(&mut self, what: &'static str, bytes: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, Error> {
        self.admit(what, bytes)?;
        self.bytes += bytes.max(16);
        Ok(crate::surface::buffer(self.gpu, what, bytes, usage | wgpu::BufferUsages::STORAGE))
    }

    /// A buffer of what the CPU has.
    fn filled<T: bytemuck::Pod>(&mut self, what: &'static str, parts: &[&[T]]) -> Result<wgpu::Buffer, Error> {
        let bytes = parts.iter().map(|p| size_of_val(*p) as u64).sum();
        let buffer = self.make(what, bytes, wgpu::BufferUsages::COPY_DST)?;
        let mut at = 0;
        for part in parts {
            self.gpu.queue.write_buffer(&buffer, at, bytemuck::cast_slice(part));
            at += size_of_val(*part) as u64;
        }
        Ok(buffer)
    }
}
