//! The renderer's own picture: multisampled colour and depth, and the resolved colour that the last pass reads.
//!
//! Multisampled textures are attachments only (WebGL2 allows nothing else), and neither they nor the depth are kept after
//! the pass, which spares tiled graphics chips the traffic. Memory: 4 (8 + 4) + 8 bytes a pixel.

use crate::Gpu;
use crate::pipelines::{DEPTH, Pipelines};

pub(crate) struct Target {
    pub size: [u32; 2],
    pub color: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    pub resolved: wgpu::TextureView,
    pub group: wgpu::BindGroup,
}

impl Target {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, sampler: &wgpu::Sampler, size: [u32; 2]) -> Target {
        let make = |label, format, samples, usage| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let resolved = make("resolved", gpu.color_format, 1, attachment | wgpu::TextureUsages::TEXTURE_BINDING);
        Target {
            size,
            color: make("colour", gpu.color_format, gpu.samples, attachment),
            depth: make("depth", DEPTH, gpu.samples, attachment),
            group: texture_group(gpu, pipelines, &resolved, sampler),
            resolved,
        }
    }
}

/// The bind group of one texture with its sampler.
pub(crate) fn texture_group(
    gpu: &Gpu,
    pipelines: &Pipelines,
    view: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("texture"),
        layout: &pipelines.texture,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}
