//! A pane: one surface, and everything that is drawn of it alone.
//!
//! Panes are whole pictures of the model that share the target: each has its own uniforms (the camera's matrix says where in
//! the view it lies) and its own shadow. Memory beside the surface: about half a megabyte, most of it the shadow's two maps.

use crate::Gpu;
use crate::ground::{Placement, Shadow};
use crate::overlay::Instances;
use crate::pipelines::Pipelines;
use crate::style::Frame;
use crate::surface::{Surface, buffer};
use crate::uniform::{Globals, Viewer};
use limn_layout::Run;

/// One draw of the surface: a stretch of a chunk with one material.
pub(crate) struct Stretch {
    pub chunk: usize,
    pub first: u32,
    pub count: u32,
    pub material: u32,
}

/// What the shadow map was made of.
#[derive(PartialEq)]
pub(crate) struct ShadowKey {
    pub version: u64,
    pub hidden: Vec<bool>,
    pub placement: Placement,
}

/// One surface, and what is drawn of it alone.
pub(crate) struct Pane {
    pub uniform: wgpu::Buffer,
    pub uniform_group: wgpu::BindGroup,
    pub surface: Option<Surface>,
    /// Counts surfaces, so that what was made of an older one is known.
    pub version: u64,
    pub stretches: Vec<Stretch>,
    /// The version and the hidden groups that `stretches` was made of.
    pub stretches_of: (u64, Vec<bool>),
    pub points: Instances,
    pub shadow: Option<Shadow>,
    pub shadow_of: Option<ShadowKey>,
}

impl Pane {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Pane {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let uniform = buffer(gpu, "globals", size_of::<Globals>() as u64, usage);
        let uniform_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &pipelines.uniform,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        Pane {
            uniform,
            uniform_group,
            surface: None,
            version: 0,
            stretches: Vec::new(),
            stretches_of: (0, Vec::new()),
            points: Instances::default(),
            shadow: None,
            shadow_of: None,
        }
    }

    /// Where the ground lies in this frame, if it is to be seen.
    pub fn ground(&self, frame: &Frame<'_>, without: bool) -> Option<Placement> {
        let ground = frame.style.ground.filter(|g| g.strength > 0.0 && !without)?;
        let placement = Placement::new(self.surface.as_ref()?.bounds(), frame.camera.up, ground.height)?;
        let viewer = Viewer::new(&frame.camera.view, &frame.camera.proj);
        let above = if viewer.perspective {
            (viewer.eye - placement.center).dot(placement.up)
        } else {
            viewer.rotation.z_axis.dot(placement.up)
        };
        (above > 0.0).then_some(placement)
    }

    /// Works out the stretches to draw, unless they are still right.
    pub fn plan(&mut self, hidden: &[bool]) {
        if self.stretches_of.0 == self.version && self.stretches_of.1 == hidden {
            return;
        }
        self.stretches_of = (self.version, hidden.to_vec());
        self.stretches.clear();
        let Some(surface) = &self.surface else { return };
        let runs = visible(surface, hidden);
        for (i, chunk) in surface.chunks.iter().enumerate() {
            for &(material, first, end) in &runs {
                let (a, b) = (first.max(chunk.first), end.min(chunk.first + chunk.count));
                if a < b {
                    self.stretches.push(Stretch {
                        chunk: i,
                        first: (a - chunk.first) as u32,
                        count: (b - a) as u32,
                        material,
                    });
                }
            }
        }
    }
}

/// Material, first and end of the runs that are shown, neighbours of one material joined.
fn visible(surface: &Surface, hidden: &[bool]) -> Vec<(u32, u64, u64)> {
    let mut out: Vec<(u32, u64, u64)> = Vec::new();
    for &Run { part, first, count } in &surface.runs {
        let Some(part) = surface.parts.get(part as usize) else { continue };
        if hidden.get(part.group as usize).copied().unwrap_or(false) {
            continue;
        }
        match out.last_mut() {
            Some(last) if last.0 == part.material && last.2 == first => last.2 = first + count,
            _ => out.push((part.material, first, first + count)),
        }
    }
    out
}
