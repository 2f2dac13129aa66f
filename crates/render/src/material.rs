//! Materials and base-colour textures.
//!
//! Textures are sRGB with a full chain of halved copies made on the GPU. A material is 32 bytes of uniform, a texture and
//! a sampler in one bind group; slot 0 is the default material (the style's base colour, a white pixel).

use bytemuck::{Pod, Zeroable};

use crate::error::mismatch;
use crate::pipelines::{Kind, Pipelines, TEXTURE};
use crate::target::texture_group;
use crate::{Error, Gpu};

/// What a part of the surface is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Linear RGBA; alpha is ignored, surfaces are opaque.
    pub base_color: [f32; 4],
    /// Index into [`crate::Renderer::set_textures`].
    pub texture: Option<u32>,
}

/// A decoded picture: sRGB bytes, red first, top row first, without gaps.
#[derive(Debug, Clone, Copy)]
pub struct TextureData<'a> {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// `4 * width * height` bytes.
    pub rgba: &'a [u8],
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct MaterialUniform {
    base: [f32; 4],
    has: [u32; 4],
}

pub(crate) struct Materials {
    white: wgpu::TextureView,
    sampler: wgpu::Sampler,
    textures: Vec<Option<wgpu::Texture>>,
    list: Vec<Material>,
    groups: Vec<wgpu::BindGroup>,
}

impl Materials {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Materials {
        let anisotropic =
            gpu.adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::ANISOTROPIC_FILTERING);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("base colour"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: if anisotropic { 8 } else { 1 },
            ..Default::default()
        });
        let white = texture(gpu, 1, 1, 1);
        write(gpu, &white, TextureData { width: 1, height: 1, rgba: &[255; 4] });
        let mut materials = Materials {
            white: white.create_view(&Default::default()),
            sampler,
            textures: Vec::new(),
            list: Vec::new(),
            groups: Vec::new(),
        };
        materials.rebuild(gpu, pipelines);
        materials
    }

    /// The bind group of a material; the default one for numbers past the end.
    pub fn group(&self, material: u32) -> Option<&wgpu::BindGroup> {
        let slot = (material as usize).checked_add(1).filter(|&s| s < self.groups.len()).unwrap_or(0);
        self.groups.get(slot)
    }

    pub fn set_materials(&mut self, gpu: &Gpu, pipelines: &Pipelines, list: &[Material]) {
        self.list = list.to_vec();
        self.rebuild(gpu, pipelines);
    }

    pub fn set_textures(
        &mut self,
        gpu: &Gpu,
        pipelines: &mut Pipelines,
        list: &[TextureData<'_>],
    ) -> Result<(), Error> {
        self.textures.clear();
        for (i, data) in list.iter().enumerate() {
            let made = make(gpu, i, data.width, data.height)?;
            let bytes = u64::from(data.width) * u64::from(data.height) * 4;
            if data.rgba.len() as u64 != bytes {
                let found = data.rgba.len() as u64;
                return Err(mismatch("bytes of a texture", found, bytes));
            }
            write(gpu, &made, *data);
            halve(gpu, pipelines, &made);
            self.textures.push(Some(made));
        }
        self.rebuild(gpu, pipelines);
        Ok(())
    }

    /// A texture straight from the browser's decoder, without a detour through this module's memory.
    #[cfg(target_arch = "wasm32")]
    pub fn set_external(
        &mut self,
        gpu: &Gpu,
        pipelines: &mut Pipelines,
        index: usize,
        source: wgpu::ExternalImageSource,
    ) -> Result<(), Error> {
        let (width, height) = (source.width(), source.height());
        let made = make(gpu, index, width, height)?;
        gpu.queue.copy_external_image_to_texture(
            &wgpu::CopyExternalImageSourceInfo { source, origin: wgpu::Origin2d::ZERO, flip_y: false },
            wgpu::CopyExternalImageDestInfo {
                texture: &made,
                mip_level: 0,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
                color_space: wgpu::PredefinedColorSpace::Srgb,
                premultiplied_alpha: false,
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        halve(gpu, pipelines, &made);
        if self.textures.len() <= index {
            self.textures.resize(index + 1, None);
        }
        if let Some(slot) = self.textures.get_mut(index) {
            *slot = Some(made);
        }
        self.rebuild(gpu, pipelines);
        Ok(())
    }

    fn rebuild(&mut self, gpu: &Gpu, pipelines: &Pipelines) {
        let stride = u64::from(gpu.device.limits().min_uniform_buffer_offset_alignment).max(32);
        let count = self.list.len() as u64 + 1;
        let uniforms = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("materials"),
            size: stride * count,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.groups.clear();
        for slot in 0..count {
            let material = (slot as usize).checked_sub(1).and_then(|i| self.list.get(i));
            let texture = material.and_then(|m| m.texture).and_then(|t| self.textures.get(t as usize)?.as_ref());
            let value = MaterialUniform {
                base: material.map_or([1.0; 4], |m| m.base_color),
                has: [u32::from(material.is_some()), u32::from(texture.is_some()), 0, 0],
            };
            gpu.queue.write_buffer(&uniforms, slot * stride, bytemuck::bytes_of(&value));
            let own = texture.map(|t| t.create_view(&Default::default()));
            self.groups.push(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("material"),
                layout: &pipelines.material,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                            buffer: &uniforms,
                            offset: slot * stride,
                            size: wgpu::BufferSize::new(size_of::<MaterialUniform>() as u64),
                        }),
                    },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::TextureView(own.as_ref().unwrap_or(&self.white)),
                    },
                    wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&self.sampler) },
                ],
            }));
        }
    }
}

fn make(gpu: &Gpu, index: usize, width: u32, height: u32) -> Result<wgpu::Texture, Error> {
    let limit = gpu.max_side();
    if width == 0 || height == 0 || width > limit || height > limit {
        return Err(Error::TextureSize { index, width, height, limit });
    }
    Ok(texture(gpu, width, height, 32 - width.max(height).leading_zeros()))
}

fn texture(gpu: &Gpu, width: u32, height: u32, levels: u32) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("base colour"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TEXTURE,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, data: TextureData<'_>) {
    gpu.queue.write_texture(
        texture.as_image_copy(),
        data.rgba,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * data.width), rows_per_image: None },
        wgpu::Extent3d { width: data.width, height: data.height, depth_or_array_layers: 1 },
    );
}

/// Fills the chain of halved copies, each from the one before.
fn halve(gpu: &Gpu, pipelines: &mut Pipelines, texture: &wgpu::Texture) {
    pipelines.prepare(gpu, Kind::Mip);
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("halving"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let level = |base_mip_level| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level,
            mip_level_count: Some(1),
            ..Default::default()
        })
    };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for i in 1..texture.mip_level_count() {
        let group = texture_group(gpu, pipelines, &level(i - 1), &sampler);
        let view = level(i);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("halve"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        if let Some(pipeline) = pipelines.get(Kind::Mip) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
    gpu.queue.submit([encoder.finish()]);
}
