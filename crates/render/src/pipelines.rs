//! Shader modules and pipelines, made when first needed: compiling is most of the time to the first picture.
//!
//! Bind groups: 0 is the frame's uniform; 1 is a material (uniform, texture, sampler) or one texture with its sampler.
//! All draw with premultiplied alpha; what differs is vertex layout, entry points and depth.

use crate::Gpu;
use crate::wgsl::wgsl;

/// A WGSL module: its own file with the shared ones before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Module {
    Surface,
    Overlay,
    Ground,
    Final,
    Shadow,
    Mip,
}

impl Module {
    pub const ALL: [Module; 6] =
        [Module::Surface, Module::Overlay, Module::Ground, Module::Final, Module::Shadow, Module::Mip];

    pub fn name(self) -> &'static str {
        match self {
            Module::Surface => "surface",
            Module::Overlay => "overlay",
            Module::Ground => "ground",
            Module::Final => "final",
            Module::Shadow => "shadow",
            Module::Mip => "mip",
        }
    }

    pub fn source(self) -> String {
        let common = wgsl!("shaders/common.wgsl");
        let (common, own) = match self {
            Module::Surface => (common, wgsl!("shaders/surface.wgsl")),
            Module::Overlay => (common, wgsl!("shaders/overlay.wgsl")),
            Module::Ground => (common, wgsl!("shaders/ground.wgsl")),
            Module::Final => (common, wgsl!("shaders/final.wgsl")),
            Module::Shadow => ("", wgsl!("shaders/shadow.wgsl")),
            Module::Mip => ("", wgsl!("shaders/mip.wgsl")),
        };
        format!("{common}{own}")
    }
}

/// How the vertices of a draw are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Vertices {
    Shared,
    SharedColor,
    Corner,
    CornerExtra,
}

/// Everything that is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Surface(Vertices),
    /// Depth alone: what a wireframe hides.
    Depth(Vertices),
    Wire(Vertices),
    WireHidden(Vertices),
    Line,
    LineHidden,
    /// Points with this distance in bytes between them.
    Point(u64),
    Ground,
    Final(wgpu::TextureFormat),
    /// Into the shadow map, with this distance in bytes between vertices.
    Cast(u64),
    Blur,
    Mip,
}

pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub(crate) const SHADOW_MAP: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub(crate) const TEXTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

pub(crate) struct Pipelines {
    pub uniform: wgpu::BindGroupLayout,
    pub material: wgpu::BindGroupLayout,
    pub texture: wgpu::BindGroupLayout,
    modules: Vec<(Module, wgpu::ShaderModule)>,
    made: Vec<(Kind, wgpu::RenderPipeline)>,
}

impl Pipelines {
    pub fn new(gpu: &Gpu) -> Pipelines {
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let sampler = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            count: None,
        };
        let make = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        Pipelines {
            uniform: make("uniform", &[uniform]),
            material: make("material", &[uniform, texture(1), sampler(2)]),
            texture: make("texture", &[texture(0), sampler(1)]),
            modules: Vec::new(),
            made: Vec::new(),
        }
    }

    /// Makes a pipeline unless it is there already.
    pub fn prepare(&mut self, gpu: &Gpu, kind: Kind) {
        if self.made.iter().any(|(k, _)| *k == kind) {
            return;
        }
        let module = match kind {
            Kind::Surface(_) | Kind::Depth(_) | Kind::Wire(_) | Kind::WireHidden(_) => Module::Surface,
            Kind::Line | Kind::LineHidden | Kind::Point(_) => Module::Overlay,
            Kind::Ground => Module::Ground,
            Kind::Final(_) => Module::Final,
            Kind::Cast(_) | Kind::Blur => Module::Shadow,
            Kind::Mip => Module::Mip,
        };
        if !self.modules.iter().any(|(m, _)| *m == module) {
            let shader = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(module.name()),
                source: wgpu::ShaderSource::Wgsl(module.source().into()),
            });
            self.modules.push((module, shader));
        }
        if let Some((_, shader)) = self.modules.iter().find(|(m, _)| *m == module) {
            let pipeline = self.make(gpu, kind, shader);
            self.made.push((kind, pipeline));
        }
    }

    /// A pipeline that was prepared; none otherwise, and then nothing is drawn.
    pub fn get(&self, kind: Kind) -> Option<&wgpu::RenderPipeline> {
        self.made.iter().find(|(k, _)| *k == kind).map(|(_, p)| p)
    }

    fn make(&self, gpu: &Gpu, kind: Kind, shader: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
        use wgpu::CompareFunction::{Greater, LessEqual};
        use wgpu::VertexFormat::{Float32, Float32x2, Float32x3, Snorm16x2, Uint32, Unorm8x4};
        let attribute = |shader_location, format, offset| wgpu::VertexAttribute { format, offset, shader_location };
        let position = [attribute(0, Float32x3, 0)];
        let shared = [attribute(0, Float32x3, 0), attribute(1, Snorm16x2, 12)];
        let corner = [
            attribute(0, Float32x3, 0),
            attribute(1, Snorm16x2, 12),
            attribute(2, Snorm16x2, 16),
            attribute(3, Uint32, 20),
        ];
        let color = [attribute(5, Unorm8x4, 0)];
        let extra = [attribute(4, Float32x2, 0), attribute(5, Unorm8x4, 8)];
        let line = [attribute(0, Float32x3, 0), attribute(1, Float32x3, 12), attribute(2, Float32, 24)];
        let layout = |attributes, array_stride| {
            Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
        };
        let each = |attributes, array_stride| {
            Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Instance, attributes })
        };
        let (vertex, buffers) = match kind {
            Kind::Surface(v) | Kind::Depth(v) | Kind::Wire(v) | Kind::WireHidden(v) => match v {
                Vertices::Shared => ("vs_shared", vec![layout(&shared, 16)]),
                Vertices::SharedColor => ("vs_shared_color", vec![layout(&shared, 16), layout(&color, 4)]),
                Vertices::Corner => ("vs_corner", vec![layout(&corner, 24)]),
                Vertices::CornerExtra => ("vs_corner_extra", vec![layout(&corner, 24), layout(&extra, 12)]),
            },
            Kind::Line | Kind::LineHidden => ("vs_line", vec![each(&line, 28)]),
            Kind::Point(stride) => ("vs_point", vec![each(&position, stride)]),
            Kind::Cast(stride) => ("vs_cast", vec![layout(&position, stride)]),
            Kind::Ground => ("vs_ground", vec![]),
            Kind::Final(_) => ("vs_final", vec![]),
            Kind::Blur => ("vs_blur", vec![]),
            Kind::Mip => ("vs_mip", vec![]),
        };
        // Fragment entry, and how depth is compared and written.
        let (fragment, depth) = match kind {
            Kind::Surface(_) => ("fs_shaded", Some((LessEqual, true))),
            Kind::Depth(_) => ("fs_nothing", Some((LessEqual, true))),
            Kind::Wire(_) => ("fs_wire", Some((LessEqual, false))),
            Kind::WireHidden(_) => ("fs_wire_hidden", Some((Greater, false))),
            Kind::Line => ("fs_line", Some((LessEqual, false))),
            Kind::LineHidden => ("fs_line_hidden", Some((Greater, false))),
            Kind::Point(_) => ("fs_point", Some((LessEqual, true))),
            Kind::Ground => ("fs_ground", Some((LessEqual, false))),
            Kind::Final(_) => ("fs_final", None),
            Kind::Cast(_) => ("fs_cast", None),
            Kind::Blur => ("fs_blur", None),
            Kind::Mip => ("fs_mip", None),
        };
        let max = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let (format, blend, write_mask) = match kind {
            Kind::Final(format) => (format, None, wgpu::ColorWrites::ALL),
            // The nearest part of the model counts.
            Kind::Cast(_) => (SHADOW_MAP, Some(wgpu::BlendState { color: max, alpha: max }), wgpu::ColorWrites::ALL),
            Kind::Blur => (SHADOW_MAP, None, wgpu::ColorWrites::ALL),
            Kind::Mip => (TEXTURE, None, wgpu::ColorWrites::ALL),
            Kind::Depth(_) => (gpu.color_format, None, wgpu::ColorWrites::empty()),
            _ => (gpu.color_format, Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING), wgpu::ColorWrites::ALL),
        };
        let groups: &[Option<&wgpu::BindGroupLayout>] = match kind {
            Kind::Surface(_) | Kind::Depth(_) | Kind::Wire(_) | Kind::WireHidden(_) => {
                &[Some(&self.uniform), Some(&self.material)]
            }
            Kind::Line | Kind::LineHidden | Kind::Point(_) | Kind::Cast(_) => &[Some(&self.uniform)],
            Kind::Ground | Kind::Final(_) | Kind::Blur => &[Some(&self.uniform), Some(&self.texture)],
            Kind::Mip => &[Some(&self.texture)],
        };
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(fragment),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        let strip = matches!(kind, Kind::Line | Kind::LineHidden | Kind::Point(_));
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: if strip {
                    wgpu::PrimitiveTopology::TriangleStrip
                } else {
                    wgpu::PrimitiveTopology::TriangleList
                },
                ..Default::default()
            },
            depth_stencil: depth.map(|(compare, write)| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: if depth.is_some() { gpu.samples } else { 1 },
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: shader,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
