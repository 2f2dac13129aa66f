//! The contact shadow: soft darkness on the ground below the model.
//!
//! ```text
//!        model           Seen from below, without perspective, into a small map. A pixel holds how near the model is
//!       /     \          to the ground there, twice: falling off fast (touching) and slowly (hovering). The nearest
//!    __.........__       part counts. Two blurs, narrow and wide, make the penumbra.
//! ```
//!
//! The map is made only when the model, what is hidden of it, or the ground changes: one more draw of the model into
//! 256 x 256 pixels. A frame pays for one quad. The shadow is seen from above only.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use crate::Gpu;
use crate::pipelines::{Kind, Pipelines, SHADOW_MAP};
use crate::surface::{Bounds, buffer};
use crate::target::texture_group;

const SIDE: u32 = 256;

/// The ground is a grid of 24 by 24 cells (ground.wgsl says why).
pub(crate) const GROUND_VERTICES: u32 = 24 * 24 * 6;

/// Where the map lies in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub center: Vec3,
    /// Half sides of the map.
    pub x: Vec3,
    pub y: Vec3,
    pub up: Vec3,
}

impl Placement {
    /// A map under the box, or under `height` along `up` where that is given. None for an empty box.
    pub fn new(bounds: Bounds, up: Vec3, height: Option<f32>) -> Option<Placement> {
        if bounds.is_empty() {
            return None;
        }
        let (min, max) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
        let up = up.normalize_or(Vec3::Y);
        let middle = 0.5 * (min + max);
        let half = 0.5 * (max - min);
        // Half the box's extent along a direction.
        let reach = |d: Vec3| d.abs().dot(half);
        let size = half.length();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let x = up.any_orthonormal_vector();
        let y = up.cross(x);
        let side = 1.25 * reach(x).max(reach(y)) + 0.45 * size;
        // A little lower than the lowest point, so that flat bottoms do not flicker.
        let height = height.unwrap_or(middle.dot(up) - reach(up) - 0.004 * size);
        Some(Placement { center: middle + up * (height - middle.dot(up)), x: x * side, y: y * side, up })
    }

    fn matrix(&self) -> Mat4 {
        let side = self.x.length();
        let rows = [self.x / (side * side), self.y / (side * side), self.up / side];
        Mat4::from_cols(
            Vec3::new(rows[0].x, rows[1].x, rows[2].x).extend(0.0),
            Vec3::new(rows[0].y, rows[1].y, rows[2].y).extend(0.0),
            Vec3::new(rows[0].z, rows[1].z, rows[2].z).extend(0.0),
            Vec3::new(-rows[0].dot(self.center), -rows[1].dot(self.center), -rows[2].dot(self.center)).extend(1.0),
        )
    }
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ShadowUniform {
    to_map: [[f32; 4]; 4],
    step: [f32; 4],
}

/// The map and what makes it.
pub(crate) struct Shadow {
    views: [wgpu::TextureView; 2],
    /// For reading either map; the finished shadow is in the first.
    groups: [wgpu::BindGroup; 2],
    uniforms: wgpu::Buffer,
    slots: [wgpu::BindGroup; 3],
    stride: u64,
}

impl Shadow {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, sampler: &wgpu::Sampler) -> Shadow {
        let stride = u64::from(gpu.device.limits().min_uniform_buffer_offset_alignment).max(80);
        let uniforms = buffer(gpu, "shadow", 3 * stride, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
        let slots = [0, 1, 2].map(|i| {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("shadow"),
                layout: &pipelines.uniform,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &uniforms,
                        offset: i * stride,
                        size: wgpu::BufferSize::new(size_of::<ShadowUniform>() as u64),
                    }),
                }],
            })
        });
        let views = [0, 1].map(|_| {
            gpu.device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some("shadow map"),
                    size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: SHADOW_MAP,
                    usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                })
                .create_view(&Default::default())
        });
        let groups = [0, 1].map(|i| texture_group(gpu, pipelines, &views[i], sampler));
        Shadow { views, groups, uniforms, slots, stride }
    }

    /// The finished map for the ground's draw.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.groups[0]
    }

    /// Makes the map anew: `draw` records the model with [`Kind::Cast`] of its vertex stride.
    pub fn update(
        &self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        encoder: &mut wgpu::CommandEncoder,
        placement: &Placement,
        draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let texel = 1.0 / SIDE as f32;
        let to_map = placement.matrix().to_cols_array_2d();
        for (slot, step) in [[0.0; 2], [texel, 0.0], [0.0, texel]].into_iter().enumerate() {
            let value = ShadowUniform { to_map, step: [step[0], step[1], 3.5, 13.0] };
            gpu.queue.write_buffer(&self.uniforms, slot as u64 * self.stride, bytemuck::bytes_of(&value));
        }
        let mut pass = begin(encoder, &self.views[0]);
        pass.set_bind_group(0, &self.slots[0], &[]);
        draw(&mut pass);
        drop(pass);
        for (to, slot) in [(1, 1), (0, 2)] {
            let mut pass = begin(encoder, &self.views[to]);
            if let Some(pipeline) = pipelines.get(Kind::Blur) {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &self.slots[slot], &[]);
                pass.set_bind_group(1, &self.groups[1 - to], &[]);
                pass.draw(0..3, 0..1);
            }
        }
    }
}

fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, view: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadow"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: 1.0 }),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_covers_the_footprint_for_either_up() {
        let bounds = Bounds { min: [-1.0, 2.0, -3.0], max: [3.0, 4.0, 5.0] };
        for up in [Vec3::Y, Vec3::Z] {
            let p = Placement::new(bounds, up, None).unwrap();
            let m = p.matrix();
            for i in 0..8 {
                let pick = |b: usize| if i >> b & 1 == 0 { bounds.min[b] } else { bounds.max[b] };
                let q = m.transform_point3(Vec3::new(pick(0), pick(1), pick(2)));
                assert!(q.x.abs() < 0.85 && q.y.abs() < 0.85 && q.z > 0.0, "{q}");
            }
            let lowest = Vec3::from(bounds.min).dot(up);
            assert!(p.center.dot(up) < lowest && p.center.dot(up) > lowest - 0.1);
        }
        assert_eq!(Placement::new(Bounds::EMPTY, Vec3::Y, None), None);
        assert!((Placement::new(bounds, Vec3::Y, Some(-7.0)).unwrap().center.y + 7.0).abs() < 1e-5);
    }
}
