//! A refinement as plain data: which buffers there are, what is in them at first, and which kernels run on them in which order.
//!
//! ```text
//!   buffers   0 marks  1 angles  2 half-edges ..   bytes, role, contents
//!   once      kernel, numbers, [2 3 0 ..] [5]      what depends on connectivity alone
//!   each      kernel, numbers, [2 3 0 ..] [4 6]    what runs again when the cage has moved
//! ```
//!
//! Whoever has a device makes the buffers and dispatches in order, all in one compute pass: `limn_render::refine` by wgpu,
//! `web/compute.js` in the browser. Buffers that are drawn have a role of their own: who draws makes them. Cost: what the contents take.

use crate::kernels::{Access, GROUP, Kernel, Level};
use crate::{Drawn, Error};

/// What an adapter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the largest buffer that can be bound whole.
    pub buffer: u64,
    /// Workgroups in one dimension of a dispatch.
    pub groups: u32,
}

/// The number of a buffer in its program.
pub type Id = u32;

/// What a buffer is for, besides being bound by kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Read alone; it has contents.
    Table,
    /// Written by one dispatch and read by others.
    Work,
    /// Level 0's values: 16 bytes a vertex, written from outside.
    Cage,
    /// The last level's values, 16 bytes each: a vertex buffer, can be copied from.
    Vertices,
    /// Drawn: indices of triangles.
    Indices,
    /// Drawn: corners, a vertex buffer.
    Corners,
    /// Drawn: what corners carry, a vertex buffer.
    Extras,
    /// Drawn: colours, a vertex buffer; can be copied from.
    Colors,
    /// [`crate::bounds`] of the points: cleared before a run, can be copied from.
    Bounds,
}

/// A buffer that has to be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer {
    /// What it holds, for people.
    pub what: &'static str,
    /// What it is for.
    pub role: Role,
    /// Its size; 16 at least, because an empty buffer cannot be bound.
    pub bytes: u64,
    /// What it holds at first.
    pub contents: Vec<u8>,
}

/// A kernel, ready for a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Shader {
    /// The name of its entry point.
    pub entry: &'static str,
    /// Its text.
    pub source: String,
    /// How the buffers of both groups are bound, by rising numbers.
    pub access: [&'static [Access]; 2],
}

/// A run of a kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Dispatch {
    /// The number of its shader.
    pub shader: u32,
    /// What is bound before everything else.
    pub numbers: [u32; 16],
    /// What is bound behind the numbers in group 0, and in group 1.
    pub bound: [Vec<Id>; 2],
    /// Workgroups in both dimensions.
    pub grid: [u32; 2],
}

/// A mesh and a plan for the GPU. See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// All buffers, by their numbers.
    pub buffers: Vec<Buffer>,
    /// All kernels, by their numbers.
    pub shaders: Vec<Shader>,
    /// Dispatches that depend on connectivity alone.
    pub once: Vec<Dispatch>,
    /// Those that depend on the cage's values, after the others.
    pub each: Vec<Dispatch>,
    /// Where the cage's values go, and how many there are.
    pub cage: Id,
    /// Vertices of the cage.
    pub cage_vertices: u32,
    /// The last level's vertices: position and octahedral normal in the order of `limn-mesh`; of colours four numbers.
    pub vertices: Id,
    /// How many there are.
    pub count: u32,
    /// What the level is drawn from.
    pub drawn: Drawn,
    /// Colours as the draw reads them.
    pub packed: Option<Id>,
    /// Six numbers that [`crate::bounds`] reads; none of colours.
    pub bounds: Option<Id>,
    /// Parts of the model in the order of drawn elements (indices or corners): the part, and how many. Empty where there is one.
    pub runs: Vec<[u32; 2]>,
}

impl Program {
    /// What `limn_render::Surface::reserve` makes drawn buffers of: vertices, where face and edge points begin (of corners what
    /// they carry, 1 for texture coordinates and 2 for colours, and 0), and the end of each piece.
    pub fn shape(&self) -> Vec<u32> {
        let kinds = match self.drawn {
            Drawn::Quads { kinds, .. } => kinds,
            Drawn::Corners { carries: [uv, colors], .. } => [u32::from(uv) | u32::from(colors) << 1, 0],
        };
        let ends = self.drawn.pieces().iter().map(|piece| piece.faces.end);
        [self.count, kinds[0], kinds[1]].into_iter().chain(ends).collect()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().map(|b| b.bytes).sum()
    }
}

/// A program under way. Buffers are refused before one is listed.
pub(crate) struct Builder {
    limits: Limits,
    pub buffers: Vec<Buffer>,
    kernels: Vec<Kernel>,
}

impl Builder {
    pub fn new(limits: Limits) -> Self {
        Builder { limits, buffers: Vec::new(), kernels: Vec::new() }
    }

    /// The largest buffer.
    pub fn limit(&self) -> u64 {
        self.limits.buffer
    }

    /// Refuses what cannot be bound.
    pub fn admit(&self, what: &'static str, bytes: u64) -> Result<(), Error> {
        let limit = self.limit();
        if bytes > limit { Err(Error::TooLarge { what, bytes, limit }) } else { Ok(()) }
    }

    pub fn make(&mut self, what: &'static str, bytes: u64, role: Role) -> Result<Id, Error> {
        self.admit(what, bytes)?;
        self.buffers.push(Buffer { what, role, bytes: bytes.max(16), contents: Vec::new() });
        Ok(self.buffers.len() as Id - 1)
    }

    /// A buffer of what the CPU has.
    pub fn filled<T: bytemuck::Pod>(&mut self, what: &'static str, parts: &[&[T]]) -> Result<Id, Error> {
        let bytes = parts.iter().map(|p| size_of_val(*p) as u64).sum();
        let id = self.make(what, bytes, Role::Table)?;
        if let Some(buffer) = self.buffers.last_mut() {
            buffer.contents.reserve_exact(bytes as usize);
            parts.iter().for_each(|part| buffer.contents.extend_from_slice(bytemuck::cast_slice(part)));
        }
        Ok(id)
    }

    /// A dispatch of `kernel` on elements `numbers.first .. numbers.end`; none if there is nothing to do.
    pub fn step(&mut self, kernel: Kernel, numbers: &Level, read: &[Id], work: &[Id]) -> Option<Dispatch> {
        let elements = numbers.end.saturating_sub(numbers.first);
        let grid = if kernel == Kernel::Bounds {
            // Each takes many elements.
            [elements.div_ceil(GROUP).min(256), 1]
        } else {
            grid(elements.div_ceil(kernel.group()), self.limits.groups)
        };
        if elements == 0 {
            return None;
        }
        let known = self.kernels.iter().position(|k| *k == kernel);
        let shader = known.unwrap_or_else(|| {
            self.kernels.push(kernel);
            self.kernels.len() - 1
        });
        let bound = [read.to_vec(), work.to_vec()];
        Some(Dispatch { shader: shader as u32, numbers: bytemuck::cast(*numbers), bound, grid })
    }

    /// The kernels of all dispatches.
    pub fn shaders(&self) -> Vec<Shader> {
        let shader = |k: &Kernel| Shader { entry: k.entry(), source: k.source(), access: k.access() };
        self.kernels.iter().map(shader).collect()
    }

    /// The box of `count` points.
    pub fn bounds(&mut self, vertices: Id, count: u32, each: &mut Vec<Dispatch>) -> Result<Id, Error> {
        let id = self.make("the box", 24, Role::Bounds)?;
        each.extend(self.step(Kernel::Bounds, &Level { end: count, ..Level::default() }, &[], &[vertices, id]));
        Ok(id)
    }
}

/// So many workgroups in rows, where one dimension does not take them.
fn grid(groups: u32, most: u32) -> [u32; 2] {
    let rows = groups.div_ceil(most.max(1)).max(1);
    [groups.div_ceil(rows), rows]
}

/// The box in the six numbers of [`Program::bounds`]: lowest and highest coordinates; none if no point is finite.
pub fn bounds(words: [u32; 6]) -> Option<[[f32; 3]; 2]> {
    let float = |o: u32| f32::from_bits(if o >> 31 == 1 { o & 0x7fff_ffff } else { !o });
    let [a, b, c, d, e, f] = words;
    (d > 0).then(|| [[a, b, c].map(|o| float(!o)), [d, e, f].map(float)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dispatches_past_one_dimension_take_two() {
        assert_eq!(grid(1, 65_535), [1, 1]);
        assert_eq!(grid(65_535, 65_535), [65_535, 1]);
        assert_eq!(grid(65_536, 65_535), [32_768, 2]);
        assert_eq!(grid(131_071, 65_535), [43_691, 3]);
    }

    #[test]
    fn a_box_comes_back_from_numbers_that_only_grow() {
        assert_eq!(bounds([0; 6]), None);
        let ordered = |x: f32| if x.to_bits() >> 31 == 1 { !x.to_bits() } else { x.to_bits() | 1 << 31 };
        let mut words = [0u32; 6];
        for p in [[-1.5f32, 2.0, -0.0], [3.0, -7.25, 1e-30]] {
            for k in 0..3 {
                words[k] = words[k].max(!ordered(p[k]));
                words[k + 3] = words[k + 3].max(ordered(p[k]));
            }
        }
        assert_eq!(bounds(words), Some([[-1.5, -7.25, -0.0], [3.0, 2.0, 1e-30]]));
    }
}
