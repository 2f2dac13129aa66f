//! The canvas as a place to present to: format, size in device pixels, and the next texture.
//!
//! The format is always one without sRGB encoding (the last pass encodes), since browsers differ in what they offer
//! first. Sizes are clamped to what the adapter can do; a canvas of no size presents nothing.

use crate::{Error, Gpu};

/// A canvas that is drawn to.
pub struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
}

/// One frame of the canvas: draw to `view`, then hand it to [`Screen::present`].
pub struct ScreenFrame {
    /// What to draw to.
    pub view: wgpu::TextureView,
    /// Its size in device pixels.
    pub size: [u32; 2],
    texture: wgpu::SurfaceTexture,
}

impl Screen {
    /// Takes over a surface of `width` by `height` device pixels.
    ///
    /// # Errors
    /// [`Error::NoFormat`] when the adapter cannot show an 8-bit format on it.
    pub fn new(gpu: &Gpu, surface: wgpu::Surface<'static>, width: u32, height: u32) -> Result<Screen, Error> {
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let format = capabilities
            .formats
            .iter()
            .copied()
            .find(|f| matches!(f, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm))
            .ok_or(Error::NoFormat)?;
        let mut config =
            surface.get_default_config(&gpu.adapter, width.max(1), height.max(1)).ok_or(Error::NoFormat)?;
        config.format = format;
        config.usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let mut screen = Screen { surface, config };
        screen.resize(gpu, width, height);
        Ok(screen)
    }

    /// The format for [`crate::Renderer::new`].
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Size in device pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Sets the size in device pixels, clamped to 1 and the largest texture.
    pub fn resize(&mut self, gpu: &Gpu, width: u32, height: u32) {
        let most = gpu.max_side();
        self.config.width = width.clamp(1, most);
        self.config.height = height.clamp(1, most);
        self.surface.configure(&gpu.device, &self.config);
    }

    /// The next frame. None when there is nothing to draw to now (hidden, or just lost): try again at the next change.
    pub fn acquire(&mut self, gpu: &Gpu) -> Option<ScreenFrame> {
        // A surface that went out of date is configured once more; what fails twice is left for the next time.
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                wgpu::CurrentSurfaceTexture::Success(texture) | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                    let view = texture.texture.create_view(&Default::default());
                    let size = [texture.texture.width(), texture.texture.height()];
                    return Some(ScreenFrame { view, size, texture });
                }
                wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                    self.surface.configure(&gpu.device, &self.config);
                }
                _ => return None,
            }
        }
        None
    }

    /// Shows a frame that was drawn.
    pub fn present(&self, gpu: &Gpu, frame: ScreenFrame) {
        gpu.queue.present(frame.texture);
    }
}
