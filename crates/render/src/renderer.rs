//! The renderer: what is on the GPU, and the recording of a frame.
//!
//! A frame is one multisampled pass in a fixed order (surface, ground, hidden lines, lines, points), resolved, and then
//! the final pass to the caller's view. Several panes are drawn one after the other in that one pass, each cut to its part of
//! the view; their cameras say where in it a pane's picture lies. Nothing here decides when to draw. The CPU's share depends on the number
//! of parts and buffers, never on the number of faces.

use crate::ground::{GROUND_VERTICES, Placement, Shadow};
use crate::image::Pixels;
use crate::material::{Material, Materials, TextureData};
use crate::overlay::Instances;
use crate::pane::{Pane, ShadowKey};
use crate::pipelines::{Kind, Pipelines, Vertices};
use crate::style::{Edges, Frame};
use crate::surface::{Bounds, Layout, Surface, SurfaceData};
use crate::target::Target;
use crate::uniform::{Content, globals};
use crate::{Error, Gpu, Upload};

/// What one pane's draws are.
struct Draws {
    kinds: Vec<Kind>,
    ground: bool,
    cage: bool,
    /// Points of their own, or the vertices of shared quads.
    points: Option<Kind>,
}

/// Draws one model, or several versions of it in panes: surfaces and points, and one cage.
pub struct Renderer {
    gpu: Gpu,
    format: wgpu::TextureFormat,
    pipelines: Pipelines,
    materials: Materials,
    sampler: wgpu::Sampler,
    target: Option<Target>,
    panes: Vec<Pane>,
    cage: Instances,
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
        let panes = vec![Pane::new(&gpu, &pipelines)];
        Renderer { gpu, format, pipelines, materials, sampler, target: None, panes, cage: Instances::default() }
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

    /// Shows a surface from now on, or none; the one before is freed, and so are the points set for it.
    pub fn show(&mut self, surface: Option<Surface>) {
        self.show_in(0, surface);
    }

    /// As [`Renderer::show`] for any pane; panes come with their first surface.
    pub fn show_in(&mut self, pane: usize, surface: Option<Surface>) {
        while self.panes.len() <= pane {
            self.panes.push(Pane::new(&self.gpu, &self.pipelines));
        }
        if let Some(pane) = self.panes.get_mut(pane) {
            pane.surface = surface;
            pane.points = Instances::default();
            pane.version += 1;
        }
    }

    /// Lets two panes that there are change places.
    pub fn swap(&mut self, a: usize, b: usize) {
        if a.max(b) < self.panes.len() {
            self.panes.swap(a, b);
        }
    }

    /// Frees the panes from the `count`th on; the first stays.
    pub fn keep_panes(&mut self, count: usize) {
        self.panes.truncate(count.max(1));
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

    /// The surface that is shown in the first pane.
    pub fn surface(&self) -> Option<&Surface> {
        self.surface_in(0)
    }

    /// The surface that is shown in a pane.
    pub fn surface_in(&self, pane: usize) -> Option<&Surface> {
        self.panes.get(pane)?.surface.as_ref()
    }

    /// The cage: points and edges of level 0. Empty slices remove it. `marks` may say by how much wider some edges are than
    /// others, and shown in another colour: 1 for twice as wide. An edge from a vertex to itself is a dot.
    ///
    /// # Errors
    /// [`limn_layout::Error::Index`] for an edge past the end of the points.
    pub fn set_cage(&mut self, points: &[[f32; 3]], edges: &[[u32; 2]], marks: &[f32]) -> Result<(), Error> {
        self.cage = Instances::lines(&self.gpu, points, edges, marks)?;
        Ok(())
    }

    /// Points to be shown with [`crate::Style::points`]. Empty: the vertices of shared quads are shown, at no cost.
    pub fn set_points(&mut self, points: &[[f32; 3]]) -> Result<(), Error> {
        self.set_points_in(0, points)
    }

    /// Whether a pane has points of its own.
    pub fn has_points(&self, pane: usize) -> bool {
        self.panes.get(pane).is_some_and(|p| !p.points.chunks.is_empty())
    }

    /// As [`Renderer::set_points`] for a pane that there is.
    ///
    /// # Errors
    /// As [`Renderer::set_points`].
    pub fn set_points_in(&mut self, pane: usize, points: &[[f32; 3]]) -> Result<(), Error> {
        if let Some(pane) = self.panes.get_mut(pane) {
            pane.points = Instances::points(&self.gpu, points)?;
        }
        Ok(())
    }

    /// The materials that parts refer to.
    pub fn set_materials(&mut self, materials: &[Material]) {
        self.materials.set_materials(&self.gpu, &self.pipelines, materials);
    }

    /// The textures that materials refer to.
    ///
    /// # Errors
    /// [`Error::TextureSize`] and [`limn_layout::Error::Mismatch`].
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
        self.draw_panes(view, size, &[(frame, [0, 0, size[0], size[1]])])
    }

    /// Draws one frame a pane, each cut to its part of the view: left, top, width and height in device pixels. The camera's
    /// projection is that of the whole view. Background and size are the first frame's.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_panes(
        &mut self,
        view: &wgpu::TextureView,
        size: [u32; 2],
        frames: &[(&Frame<'_>, [u32; 4])],
    ) -> Result<(), Error> {
        let target = match self.target.take() {
            Some(target) if target.size == size => target,
            _ => self.new_target(size)?,
        };
        let encoder = self.record(view, &target, frames, self.format, false);
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
        self.image_panes(&[(frame, [0, 0, width, height])], width, height)
    }

    /// As [`Renderer::image`] of several panes: [`Renderer::draw_panes`].
    ///
    /// # Errors
    /// As [`Renderer::image`].
    pub fn image_panes(
        &mut self,
        frames: &[(&Frame<'_>, [u32; 4])],
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
        let encoder = self.record(&view, &target, frames, format, true)?;
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
        frames: &[(&Frame<'_>, [u32; 4])],
        format: wgpu::TextureFormat,
        straight: bool,
    ) -> Result<wgpu::CommandEncoder, Error> {
        if let Some(reason) = self.gpu.lost() {
            return Err(Error::Lost(reason));
        }
        self.pipelines.prepare(&self.gpu, Kind::Final(format));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let mut draws = Vec::with_capacity(frames.len());
        let mut panes = std::mem::take(&mut self.panes);
        for (pane, (frame, _)) in panes.iter_mut().zip(frames) {
            draws.push(self.prepare(pane, &mut encoder, frame, target.size, straight));
        }
        self.panes = panes;
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
        for ((pane, draws), (frame, [x, y, width, height])) in self.panes.iter().zip(&draws).zip(frames) {
            if frames.len() > 1 {
                let [w, h] = target.size;
                let (x, y) = (*x.min(&w), *y.min(&h));
                pass.set_scissor_rect(x, y, (*width).min(w - x), (*height).min(h - y));
            }
            self.draw_pane(&mut pass, pane, draws, frame);
        }
        // WebGL2 resolves samples by a blit, which the last pane's scissor would cut.
        if frames.len() > 1 {
            pass.set_scissor_rect(0, 0, target.size[0], target.size[1]);
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
            pass.set_bind_group(0, self.panes.first().map(|p| &p.uniform_group), &[]);
            pass.set_bind_group(1, &target.group, &[]);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        Ok(encoder)
    }

    /// Makes ready what a pane's frame needs: pipelines, its uniforms, its shadow.
    fn prepare(
        &mut self,
        pane: &mut Pane,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        size: [u32; 2],
        straight: bool,
    ) -> Draws {
        let style = &frame.style;
        let wire = style.edges == Edges::Wire;
        let vertices = pane.surface.as_ref().filter(|_| style.surface).map(|s| match &s.layout {
            Layout::Shared { colors: None, .. } => Vertices::Shared,
            Layout::Shared { colors: Some(_), .. } => Vertices::SharedColor,
            Layout::Corners { extras: false } => Vertices::Corner,
            Layout::Corners { extras: true } => Vertices::CornerExtra,
        });
        pane.plan(frame.hidden_groups);
        let ground = pane.ground(frame, wire || vertices.is_none());
        // The vertices of shared quads serve as points where no others were given.
        let shared = matches!(pane.surface.as_ref().map(|s| &s.layout), Some(Layout::Shared { .. }));
        let points = match (style.points, pane.points.chunks.is_empty(), shared) {
            (true, false, _) => Some(Kind::Point(12)),
            (true, true, true) => Some(Kind::Point(16)),
            _ => None,
        };
        let cage = style.cage && !self.cage.chunks.is_empty();
        let kinds = match (vertices, wire) {
            (Some(v), false) => vec![Kind::Surface(v)],
            (Some(v), true) => vec![Kind::Depth(v), Kind::WireHidden(v), Kind::Wire(v)],
            (None, _) => Vec::new(),
        };
        let lines: &[Kind] = if cage { &[Kind::LineHidden, Kind::Line] } else { &[] };
        for &kind in kinds.iter().chain(lines).chain(&points) {
            self.pipelines.prepare(&self.gpu, kind);
        }
        let surface = pane.surface.as_ref();
        let content = Content {
            kinds: match surface.map(|s| &s.layout) {
                Some(Layout::Shared { kinds, .. }) => *kinds,
                _ => [0; 2],
            },
            has_colors: surface.is_some_and(|s| s.has_colors),
            has_uv: surface.is_some_and(|s| s.has_uv),
            ground,
        };
        let value = globals(frame, size, &content, straight);
        self.gpu.queue.write_buffer(&pane.uniform, 0, bytemuck::bytes_of(&value));
        if let Some(placement) = &content.ground {
            self.update_shadow(pane, encoder, placement, frame.hidden_groups);
        }
        Draws { kinds, ground: content.ground.is_some(), cage, points }
    }

    fn draw_pane(&self, pass: &mut wgpu::RenderPass<'_>, pane: &Pane, draws: &Draws, frame: &Frame<'_>) {
        pass.set_bind_group(0, &pane.uniform_group, &[]);
        for &kind in &draws.kinds {
            if let Some(pipeline) = self.pipelines.get(kind) {
                pass.set_pipeline(pipeline);
                self.draw_surface(pass, pane, true);
            }
        }
        if let (true, Some(shadow), Some(pipeline)) = (draws.ground, &pane.shadow, self.pipelines.get(Kind::Ground)) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, shadow.group(), &[]);
            pass.draw(0..GROUND_VERTICES, 0..1);
        }
        let overlays = [
            (draws.cage && frame.style.hidden > 0.0, Kind::LineHidden, &self.cage),
            (draws.cage, Kind::Line, &self.cage),
            (draws.points == Some(Kind::Point(12)), Kind::Point(12), &pane.points),
        ];
        for (shown, kind, instances) in overlays {
            let Some(pipeline) = self.pipelines.get(kind).filter(|_| shown) else { continue };
            pass.set_pipeline(pipeline);
            for (buffer, count) in &instances.chunks {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..4, 0..*count);
            }
        }
        if let (Some(kind @ Kind::Point(16)), Some(Layout::Shared { vertices, count, .. })) =
            (draws.points, pane.surface.as_ref().map(|s| &s.layout))
            && let Some(pipeline) = self.pipelines.get(kind)
        {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.draw(0..4, 0..*count);
        }
    }

    fn update_shadow(
        &mut self,
        pane: &mut Pane,
        encoder: &mut wgpu::CommandEncoder,
        placement: &Placement,
        hidden: &[bool],
    ) {
        let key = ShadowKey { version: pane.version, hidden: hidden.to_vec(), placement: *placement };
        if pane.shadow_of.as_ref() == Some(&key) {
            return;
        }
        let stride = match pane.surface.as_ref().map(|s| &s.layout) {
            Some(Layout::Shared { .. }) => 16,
            Some(Layout::Corners { .. }) => 24,
            None => return,
        };
        for kind in [Kind::Cast(stride), Kind::Blur, Kind::Ground] {
            self.pipelines.prepare(&self.gpu, kind);
        }
        let shadow = pane.shadow.take().unwrap_or_else(|| Shadow::new(&self.gpu, &self.pipelines, &self.sampler));
        shadow.update(&self.gpu, &self.pipelines, encoder, placement, |pass| {
            if let Some(pipeline) = self.pipelines.get(Kind::Cast(stride)) {
                pass.set_pipeline(pipeline);
                self.draw_surface(pass, pane, false);
            }
        });
        pane.shadow = Some(shadow);
        pane.shadow_of = Some(key);
    }

    /// Records all stretches with the pipeline that is set. Positions are all that is bound without materials.
    fn draw_surface(&self, pass: &mut wgpu::RenderPass<'_>, pane: &Pane, materials: bool) {
        let Some(surface) = &pane.surface else { return };
        let mut chunk = usize::MAX;
        let mut material = None;
        for s in &pane.stretches {
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

    /// Box around the surface that is shown.
    pub fn bounds(&self) -> Option<Bounds> {
        self.surface().map(Surface::bounds).filter(|b| !b.is_empty())
    }
}
