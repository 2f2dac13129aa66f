//! Runs what `limn-compute` puts together, by wgpu: for tests, tools and benchmarks. In the browser `web/compute.js` does the same
//! with the browser's own objects.
//!
//! ```text
//!   Program ──► buffers, pipelines ──► once, then for every new position of the cage: one compute pass ──► Surface
//! ```
//!
//! What is drawn lies in the surface's own buffers ([`Surface::reserve`]). Cost on the CPU: some 20 microseconds a run.

use limn_compute::program::{Buffer, Dispatch, Limits, Program, Role, Shader};
use limn_compute::{Access, Drawn};

use crate::error::mismatch;
use crate::surface::{Bounds, Layout, Surface, buffer};
use crate::{Error, Gpu};

/// The pipelines that were made so far; one for all refiners of a device.
#[derive(Default)]
pub struct Compute {
    made: Vec<(Shader, wgpu::ComputePipeline, [wgpu::BindGroupLayout; 2])>,
}

/// One dispatch, ready to be recorded again and again.
struct Step {
    pipeline: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
    grid: [u32; 2],
}

/// A program, and the buffers that it fills.
pub struct Refiner {
    cage: wgpu::Buffer,
    cage_vertices: u32,
    /// Dispatches that depend on connectivity alone; none once they have run.
    once: Vec<Step>,
    each: Vec<Step>,
    vertices: wgpu::Buffer,
    count: u32,
    surface: Surface,
    runs: Vec<[u32; 2]>,
    /// Colours as the draw reads them.
    packed: Option<wgpu::Buffer>,
    bounds: Option<wgpu::Buffer>,
    bytes: u64,
}

/// What programs for this device may take.
pub fn limits(gpu: &Gpu) -> Limits {
    let limits = gpu.device.limits();
    Limits {
        buffer: limits.max_buffer_size.min(limits.max_storage_buffer_binding_size),
        groups: limits.max_compute_workgroups_per_dimension,
    }
}

impl Refiner {
    /// Makes what the program needs, and compiles what was not yet. Nothing runs yet; the cage has no points yet.
    ///
    /// # Errors
    /// [`limn_layout::Error::Mismatch`] for a program that refers to what it has not.
    pub fn new(gpu: &Gpu, compute: &mut Compute, program: &Program) -> Result<Refiner, Error> {
        let surface = Surface::reserve(gpu, &program.shape());
        let mut drawn = surface.filled().into_iter();
        let made: Vec<wgpu::Buffer> = program
            .buffers
            .iter()
            .map(|b| match b.role {
                Role::Vertices if !matches!(program.drawn, Drawn::Quads { .. }) => make(gpu, b),
                Role::Vertices | Role::Indices | Role::Corners | Role::Extras => {
                    drawn.next().unwrap_or_else(|| make(gpu, b))
                }
                _ => make(gpu, b),
            })
            .collect();
        let limit = made.len() as u64;
        let at = |id: u32| {
            let error = mismatch("buffers of a program", id.into(), limit);
            made.get(id as usize).ok_or(error)
        };
        for (id, b) in (0..).zip(&program.buffers).filter(|(_, b)| !b.contents.is_empty()) {
            gpu.queue.write_buffer(at(id)?, 0, &b.contents);
        }
        let mut steps = |dispatches: &[Dispatch]| -> Result<Vec<Step>, Error> {
            let step = |dispatch: &Dispatch| {
                let found = dispatch.shader.into();
                let expected = program.shaders.len() as u64;
                let shader = program.shaders.get(dispatch.shader as usize);
                let shader = shader.ok_or(mismatch("shaders of a program", found, expected))?;
                let bound = dispatch.bound.each_ref().map(|ids| ids.iter().map(|&id| at(id)).collect());
                let [read, work]: [Result<Vec<&wgpu::Buffer>, Error>; 2] = bound;
                Ok(compute.step(gpu, shader, dispatch, &read?, &work?))
            };
            dispatches.iter().map(step).collect()
        };
        Ok(Refiner {
            cage: at(program.cage)?.clone(),
            cage_vertices: program.cage_vertices,
            once: steps(&program.once)?,
            each: steps(&program.each)?,
            vertices: at(program.vertices)?.clone(),
            count: program.count,
            packed: program.packed.map(&at).transpose()?.cloned(),
            bounds: program.bounds.map(&at).transpose()?.cloned(),
            surface,
            runs: program.runs.clone(),
            bytes: program.bytes(),
        })
    }

    /// Puts `points` into the cage from vertex `first` on. What is refined changes with the next [`Refiner::refine`].
    ///
    /// Cost: 16 bytes a point to the GPU.
    ///
    /// # Errors
    /// [`limn_layout::Error::Mismatch`] for more points than there are vertices.
    pub fn set_points(&self, gpu: &Gpu, first: u32, points: &[[f32; 3]]) -> Result<(), Error> {
        let padded: Vec<[f32; 4]> = points.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        self.set_values(gpu, first, &padded)
    }

    /// The same of values of four numbers: linear RGBA.
    ///
    /// # Errors
    /// [`limn_layout::Error::Mismatch`] for more values than there are vertices.
    pub fn set_values(&self, gpu: &Gpu, first: u32, values: &[[f32; 4]]) -> Result<(), Error> {
        let end = u64::from(first) + values.len() as u64;
        if end > u64::from(self.cage_vertices) {
            return Err(mismatch("cage points", end, self.cage_vertices.into()));
        }
        gpu.queue.write_buffer(&self.cage, u64::from(first) * 16, bytemuck::cast_slice(values));
        Ok(())
    }

    /// Records and submits everything in one compute pass. Nothing is waited for.
    pub fn refine(&mut self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("refine") });
        if let Some(bounds) = &self.bounds {
            encoder.clear_buffer(bounds, 0, None);
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for Step { pipeline, groups, grid } in self.once.drain(..).collect::<Vec<_>>().iter().chain(&self.each) {
                pass.set_pipeline(pipeline);
                for (at, group) in (0..).zip(groups) {
                    pass.set_bind_group(at, group, &[]);
                }
                pass.dispatch_workgroups(grid[0], grid[1], 1);
            }
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// The surface that is filled: the same buffers, so that it changes with every [`Refiner::refine`]. `bounds` is the box around
    /// the points, `colors` a refiner of colours beside this one.
    ///
    /// # Errors
    /// [`limn_layout::Error::Mismatch`] where there are colours and faces do not share vertices, or the colours are of others.
    pub fn surface(&self, bounds: Bounds, colors: Option<&Refiner>) -> Result<Surface, Error> {
        let mut surface = self.surface.clone();
        surface.settle(bounds, &[], self.runs.as_flattened());
        if let Some(r) = colors {
            match &mut surface.layout {
                Layout::Shared { colors, .. } if r.count == self.count && r.packed.is_some() => {
                    colors.clone_from(&r.packed);
                    surface.has_colors = true;
                }
                _ => {
                    let (found, expected) = (r.count.into(), self.count.into());
                    return Err(mismatch("colours of vertices that quads share", found, expected));
                }
            }
        }
        Ok(surface)
    }

    /// The vertices: 16 bytes each, position and octahedral normal, in the order of `limn-mesh`; of colours four numbers. They can be
    /// copied from.
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// The six numbers that `limn_compute::bounds` reads. They can be copied from.
    pub fn bounds(&self) -> Option<&wgpu::Buffer> {
        self.bounds.as_ref()
    }

    /// How many vertices there are.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// A buffer for its role.
fn make(gpu: &Gpu, b: &Buffer) -> wgpu::Buffer {
    use wgpu::BufferUsages as U;
    let usage = match b.role {
        Role::Work => U::empty(),
        Role::Table | Role::Cage => U::COPY_DST,
        Role::Vertices | Role::Colors => U::VERTEX | U::COPY_SRC,
        Role::Indices => U::INDEX,
        Role::Corners | Role::Extras => U::VERTEX,
        Role::Bounds => U::COPY_SRC | U::COPY_DST,
    };
    buffer(gpu, b.what, b.bytes, usage | U::STORAGE | if b.contents.is_empty() { U::empty() } else { U::COPY_DST })
}

impl Compute {
    fn step(
        &mut self,
        gpu: &Gpu,
        shader: &Shader,
        dispatch: &Dispatch,
        read: &[&wgpu::Buffer],
        work: &[&wgpu::Buffer],
    ) -> Step {
        let at = self.made.iter().position(|(s, ..)| s == shader).unwrap_or_else(|| {
            self.made.push(compile(gpu, shader));
            self.made.len() - 1
        });
        let (_, pipeline, layouts) = &self.made[at];
        let uniform = buffer(gpu, "numbers", 64, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
        gpu.queue.write_buffer(&uniform, 0, bytemuck::bytes_of(&dispatch.numbers));
        let group = |layout: &wgpu::BindGroupLayout, bound: &mut dyn Iterator<Item = &wgpu::Buffer>| {
            let entries: Vec<_> = (0..)
                .zip(bound)
                .map(|(binding, b)| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let groups = [
            group(&layouts[0], &mut std::iter::once(&uniform).chain(read.iter().copied())),
            group(&layouts[1], &mut work.iter().copied()),
        ];
        Step { pipeline: pipeline.clone(), groups, grid: dispatch.grid }
    }
}

fn compile(gpu: &Gpu, shader: &Shader) -> (Shader, wgpu::ComputePipeline, [wgpu::BindGroupLayout; 2]) {
    let label = Some(shader.entry);
    let layouts = shader.access.map(|access| {
        let entry = |(binding, access): (u32, &Access)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match access {
                    Access::Uniform => wgpu::BufferBindingType::Uniform,
                    _ => wgpu::BufferBindingType::Storage { read_only: *access == Access::Read },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = (0..).zip(access).map(entry).collect();
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries })
    });
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &layouts.each_ref().map(Some),
        immediate_size: 0,
    });
    let source = wgpu::ShaderSource::Wgsl(shader.source.as_str().into());
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&layout),
        module: &module,
        entry_point: label,
        compilation_options: Default::default(),
        cache: None,
    });
    (shader.clone(), pipeline, layouts)
}
