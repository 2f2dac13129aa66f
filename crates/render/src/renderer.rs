//! The renderer: what is on the GPU, and the recording of a frame.
//!
//! A frame is one multisampled pass in a fixed order (surface, ground, hidden lines, lines, points), resolved, and then
//! the final pass to the caller's view. Nothing here decides when to draw. The CPU's share depends on the number
//! of parts and buffers, never on the number of faces.

use crate::ground::{GROUND_VERTICES, Placement, Shadow};
use crate::image::Pixels;
use crate::material::{Material, Materials, TextureData};
use crate::overlay::Instances;
use crate::pipelines::{Kind, Pipelines, Vertices};
use crate::style::{Edges, Frame};
use crate::surface::{Bounds, Layout, Run, Surface, SurfaceData, buffer};
use crate::target::Target;
use crate::uniform::{Content, Globals, Viewer, globals};
use crate::{Error, Gpu, Upload};

/// One draw of the surface: a stretch of a chunk with one material.
struct Stretch {
    chunk: usize,
    first: u32,
    count: u32,
    material: u32,
}

/// What the shadow map was made of.
#[derive(PartialEq)]
struct ShadowKey {
    version: u64,
    hidden: Vec<bool>,
    placement: Placement,
}

/// Draws one model: its surface, cage and points.
pub struct Renderer {
    gpu: Gpu,
    format: wgpu::TextureFormat,
    pipelines: Pipelines,
    materials: Materials,
    sampler: wgpu::Sampler,
    uniform: wgpu::Buffer,
    uniform_group: wgpu::BindGroup,
    target: Option<Target>,
    surface: Option<Surface>,
    /// Counts surfaces, so that what was made of an older one is known.
    version: u64,
    stretches: Vec<Stretch>,
    /// The version and the hidden groups that `stretches` was made of.
    stretches_of: (u64, Vec<bool>),
    cage: Instances,
    points: Instances,
    shadow: Option<Shadow>,
    shadow_of: Option<ShadowKey>,
}

impl Renderer {
    /// A renderer that draws to views of `format` (8-bit, without sRGB encoding; [`crate::Screen::format`]).
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat) -> Renderer {
        let pipelines = Pipelines::new(&gpu);
        let materials = Materials::new(&gpu, &pipelines);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("bilinear"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let uniform = buffer(
            &gpu,
            "globals",
            size_of::<Globals>() as u64,
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        );
        let uniform_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("globals"),
            layout: &pipelines.uniform,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        Renderer {
            gpu,
            format,
            pipelines,
            materials,
            sampler,
            uniform,
            uniform_group,
            target: None,
            surface: None,
            version: 0,
            stretches: Vec::new(),
            stretches_of: (0, Vec::new()),
            cage: Instances::default(),
            points: Instances::default(),
            shadow: None,
            shadow_of: None,
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Starts an upload that is stepped with [`Upload::step`] and ends in [`Renderer::show`].
    ///
    /// # Errors
    /// As [`Upload::new`].
    pub fn upload(&self, data: &SurfaceData<'_>) -> Result<Upload, Error> {
        Upload::new(&self.gpu, data)
    }

    /// Shows a surface from now on, or none; the one before is freed.
    pub fn show(&mut self, surface: Option<Surface>) {
        self.surface = surface;
        self.version += 1;
    }

    /// Uploads and shows a surface in one go.
    ///
    /// # Errors
    /// As [`Upload::new`] and [`Upload::step`]; the surface before stays then.
    pub fn set_surface(&mut self, data: &SurfaceData<'_>) -> Result<(), Error> {
        let mut upload = self.upload(data)?;
        while !upload.step(&self.gpu, data, 1 << 16)? {}
        self.show(Some(upload.finish()));
        Ok(())
    }

    /// The surface that is shown.
    pub fn surface(&self) -> Option<&Surface> {
        self.surface.as_ref()
    }

    /// The cage: points and edges of level 0. Empty slices remove it.
    ///
    /// # Errors
    /// [`Error::Index`] for an edge past the end of the points.
    pub fn set_cage(&mut self, points: &[[f32; 3]], edges: &[[u32; 2]]) -> Result<(), Error> {
        self.cage = Instances::lines(&self.gpu, points, edges)?;
        Ok(())
    }

    /// Points to be shown with [`crate::Style::points`]. Empty: the vertices of shared quads are shown, at no cost.
    pub fn set_points(&mut self, points: &[[f32; 3]]) -> Result<(), Error> {
        self.points = Instances::points(&self.gpu, points)?;
        Ok(())
    }

    /// The materials that parts refer to.
    pub fn set_materials(&mut self, materials: &[Material]) {
        self.materials.set_materials(&self.gpu, &self.pipelines, materials);
    }

    /// The textures that materials refer to.
    ///
    /// # Errors
    /// [`Error::TextureSize`] and [`Error::Mismatch`].
    pub fn set_textures(&mut self, textures: &[TextureData<'_>]) -> Result<(), Error> {
        self.materials.set_textures(&self.gpu, &mut self.pipelines, textures)
    }

    /// Sets one texture from an `ImageBitmap` or the like (decode with `colorSpaceConversion: "none"` and
    /// `premultiplyAlpha: "none"`).
    ///
    /// # Errors
    /// [`Error::TextureSize`].
    #[cfg(target_arch = "wasm32")]
    pub fn set_texture_external(&mut self, index: usize, source: wgpu::ExternalImageSource) -> Result<(), Error> {
        self.materials.set_external(&self.gpu, &mut self.pipelines, index, source)
    }

    /// Draws a frame to a view of `size` device pixels and submits it; presenting is the caller's.
    ///
    /// # Errors
    /// [`Error::ImageSize`] past the largest texture, [`Error::Lost`] after the device went.
    pub fn draw(&mut self, view: &wgpu::TextureView, size: [u32; 2], frame: &Frame<'_>) -> Result<(), Error> {
        let target = match self.target.take() {
            Some(target) if target.size == size => target,
            _ => self.new_target(size)?,
        };
        let encoder = self.record(view, &target, frame, self.format, false);
        self.target = Some(target);
        self.gpu.queue.submit([encoder?.finish()]);
        Ok(())
    }

    /// Draws a picture of its own size and gives its pixels: RGBA, 8 bits, top row first, straight alpha where the
    /// background is transparent. The future holds no borrow; the frame is drawn before this returns.
    ///
    /// # Errors
    /// [`Error::ImageSize`] past the largest texture, [`Error::Lost`]; the future may give [`Error::Readback`].
    pub fn image(
        &mut self,
        frame: &Frame<'_>,
        width: u32,
        height: u32,
    ) -> Result<impl Future<Output = Result<Vec<u8>, Error>> + use<>, Error> {
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let target = self.new_target([width, height])?;
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let encoder = self.record(&view, &target, frame, format, true)?;
        Ok(Pixels::read(&self.gpu, &texture, encoder))
    }

    fn new_target(&self, size: [u32; 2]) -> Result<Target, Error> {
        let limit = self.gpu.max_side();
        if size.iter().any(|&s| s == 0 || s > limit) {
            return Err(Error::ImageSize { width: size[0], height: size[1], limit });
        }
        Ok(Target::new(&self.gpu, &self.pipelines, &self.sampler, size))
    }

    fn record(
        &mut self,
        view: &wgpu::TextureView,
        target: &Target,
        frame: &Frame<'_>,
        format: wgpu::TextureFormat,
        straight: bool,
    ) -> Result<wgpu::CommandEncoder, Error> {
        if let Some(reason) = self.gpu.lost() {
            return Err(Error::Lost(reason));
        }
        let style = &frame.style;
        let wire = style.edges == Edges::Wire;
        let vertices = self.surface.as_ref().filter(|_| style.surface).map(|s| match &s.layout {
            Layout::Shared { colors: None, .. } => Vertices::Shared,
            Layout::Shared { colors: Some(_), .. } => Vertices::SharedColor,
            Layout::Corners { extras: false } => Vertices::Corner,
            Layout::Corners { extras: true } => Vertices::CornerExtra,
        });
        self.plan(frame.hidden_groups);

        let ground = self.ground(frame, wire || vertices.is_none());
        // The vertices of shared quads serve as points where no others were given.
        let own_points = !self.points.chunks.is_empty();
        let shared_points = match self.surface.as_ref().map(|s| &s.layout) {
            Some(Layout::Shared { vertices, count, .. }) if !own_points => Some((vertices.clone(), *count)),
            _ => None,
        };
        let kinds: &[Kind] = match (vertices, wire) {
            (Some(v), false) => &[Kind::Surface(v)],
            (Some(v), true) => &[Kind::Depth(v), Kind::WireHidden(v), Kind::Wire(v)],
            (None, _) => &[],
        };
        for &kind in kinds {
            self.pipelines.prepare(&self.gpu, kind);
        }
        let cage = style.cage && !self.cage.chunks.is_empty();
        if cage {
            self.pipelines.prepare(&self.gpu, Kind::LineHidden);
            self.pipelines.prepare(&self.gpu, Kind::Line);
        }
        let point_stride = if own_points { 12 } else { 16 };
        if style.points {
            self.pipelines.prepare(&self.gpu, Kind::Point(point_stride));
        }
        self.pipelines.prepare(&self.gpu, Kind::Final(format));

        let content = Content {
            kinds: match self.surface.as_ref().map(|s| &s.layout) {
                Some(Layout::Shared { kinds, .. }) => *kinds,
                _ => [0; 2],
            },
            has_colors: self.surface.as_ref().is_some_and(|s| s.has_colors),
            has_uv: self.surface.as_ref().is_some_and(|s| s.has_uv),
            ground,
        };
        let value = globals(frame, target.size, &content, straight);
        self.gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&value));

        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        if let Some(placement) = &content.ground {
            self.update_shadow(&mut encoder, placement, frame.hidden_groups);
        }
        let single = self.gpu.samples == 1;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("model"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: if single { &target.resolved } else { &target.color },
                depth_slice: None,
                resolve_target: (!single).then_some(&target.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: if single { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.uniform_group, &[]);
        for &kind in kinds {
            if let Some(pipeline) = self.pipelines.get(kind) {
                pass.set_pipeline(pipeline);
                self.draw_surface(&mut pass, true);
            }
        }
        if let (Some(_), Some(shadow), Some(pipeline)) =
            (&content.ground, &self.shadow, self.pipelines.get(Kind::Ground))
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, shadow.group(), &[]);
            pass.draw(0..GROUND_VERTICES, 0..1);
        }
        let overlays = [
            (cage && style.hidden > 0.0, Kind::LineHidden, &self.cage),
            (cage, Kind::Line, &self.cage),
            (style.points && own_points, Kind::Point(12), &self.points),
        ];
        for (shown, kind, instances) in overlays {
            let Some(pipeline) = self.pipelines.get(kind).filter(|_| shown) else { continue };
            pass.set_pipeline(pipeline);
            for (buffer, count) in &instances.chunks {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..4, 0..*count);
            }
        }
        if let (true, Some((buffer, count)), Some(pipeline)) =
            (style.points, &shared_points, self.pipelines.get(Kind::Point(16)))
        {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..*count);
        }
        drop(pass);

        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("final"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        if let Some(pipeline) = self.pipelines.get(Kind::Final(format)) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.uniform_group, &[]);
            pass.set_bind_group(1, &target.group, &[]);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        Ok(encoder)
    }

    /// Where the ground lies in this frame, if it is to be seen.
    fn ground(&self, frame: &Frame<'_>, without: bool) -> Option<Placement> {
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

    fn update_shadow(&mut self, encoder: &mut wgpu::CommandEncoder, placement: &Placement, hidden: &[bool]) {
        let key = ShadowKey { version: self.version, hidden: hidden.to_vec(), placement: *placement };
        if self.shadow_of.as_ref() == Some(&key) {
            return;
        }
        let stride = match self.surface.as_ref().map(|s| &s.layout) {
            Some(Layout::Shared { .. }) => 16,
            Some(Layout::Corners { .. }) => 24,
            None => return,
        };
        for kind in [Kind::Cast(stride), Kind::Blur, Kind::Ground] {
            self.pipelines.prepare(&self.gpu, kind);
        }
        let shadow = self.shadow.take().unwrap_or_else(|| Shadow::new(&self.gpu, &self.pipelines, &self.sampler));
        shadow.update(&self.gpu, &self.pipelines, encoder, placement, |pass| {
            if let Some(pipeline) = self.pipelines.get(Kind::Cast(stride)) {
                pass.set_pipeline(pipeline);
                self.draw_surface(pass, false);
            }
        });
        self.shadow = Some(shadow);
        self.shadow_of = Some(key);
    }

    /// Records all stretches with the pipeline that is set. Positions are all that is bound without materials.
    fn draw_surface(&self, pass: &mut wgpu::RenderPass<'_>, materials: bool) {
        let Some(surface) = &self.surface else { return };
        let mut chunk = usize::MAX;
        let mut material = None;
        for s in &self.stretches {
            let Some(from) = surface.chunks.get(s.chunk) else { continue };
            if chunk != s.chunk {
                chunk = s.chunk;
                match &surface.layout {
                    Layout::Shared { vertices, colors, .. } => {
                        pass.set_vertex_buffer(0, vertices.slice(..));
                        if let Some(colors) = colors.as_ref().filter(|_| materials) {
                            pass.set_vertex_buffer(1, colors.slice(..));
                        }
                        pass.set_index_buffer(from.buffer.slice(..), wgpu::IndexFormat::Uint32);
                    }
                    Layout::Corners { .. } => {
                        pass.set_vertex_buffer(0, from.buffer.slice(..));
                        if let Some(extra) = from.extra.as_ref().filter(|_| materials) {
                            pass.set_vertex_buffer(1, extra.slice(..));
                        }
                    }
                }
            }
            if materials && material != Some(s.material) {
                material = Some(s.material);
                let Some(group) = self.materials.group(s.material) else { continue };
                pass.set_bind_group(1, group, &[]);
            }
            match surface.layout {
                Layout::Shared { .. } => pass.draw_indexed(s.first..s.first + s.count, 0, 0..1),
                Layout::Corners { .. } => pass.draw(s.first..s.first + s.count, 0..1),
            }
        }
    }

    /// Works out the stretches to draw, unless they are still right.
    fn plan(&mut self, hidden: &[bool]) {
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

    /// Box around the surface that is shown.
    pub fn bounds(&self) -> Option<Bounds> {
        self.surface.as_ref().map(Surface::bounds).filter(|b| !b.is_empty())
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
