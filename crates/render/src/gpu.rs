//! Opening a device on one of three tiers, and knowing when it is gone.
//!
//! The caller makes the instance ([`Gpu::instance`]) and the surface (from an `OffscreenCanvas` in a worker), the
//! renderer asks for adapter and device. Tests pass no surface and draw headless. What differs between tiers is kept
//! here and in [`crate::Screen`]; everything else in the crate asks only for limits and formats.
//!
//! Limits: on WebGL2 a device starts from `downlevel_webgl2_defaults` (no compute, no storage buffers, vertex stride
//! at most 255), so nothing in this crate may use more.

use std::sync::{Arc, Mutex, PoisonError};

use crate::Error;

/// Which graphics interface is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// The browser's WebGPU.
    WebGpu,
    /// The browser's WebGL2.
    WebGl2,
    /// Vulkan on the machine itself: tests and tools.
    Native,
}

impl Tier {
    /// Name for people: `WebGPU`, `WebGL2` or `Vulkan`.
    pub fn name(self) -> &'static str {
        match self {
            Tier::WebGpu => "WebGPU",
            Tier::WebGl2 => "WebGL2",
            Tier::Native => "Vulkan",
        }
    }
}

/// What the callbacks of the device leave behind for [`Gpu::lost`] and [`Gpu::take_errors`].
#[derive(Default)]
struct Events {
    lost: Option<String>,
    errors: Vec<String>,
}

/// An open device with its queue, and what the renderer has to know about it.
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The adapter that the device came from.
    pub adapter: wgpu::Adapter,
    /// The tier that was asked for.
    pub tier: Tier,
    /// Format of the multisampled colour target: half floats, or 8-bit sRGB where those cannot be multisampled.
    pub(crate) color_format: wgpu::TextureFormat,
    /// Samples a pixel: 4, or 1 where the adapter cannot.
    pub(crate) samples: u32,
    events: Arc<Mutex<Events>>,
}

impl Gpu {
    /// The instance to make surfaces from. On WebGL2 fences count as passed at once: reading back blocks
    /// in the driver anyway, and a worker cannot wait for a fence there.
    pub fn instance(tier: Tier) -> wgpu::Instance {
        let mut desc = wgpu::InstanceDescriptor::new_without_display_handle();
        desc.backends = match tier {
            Tier::WebGpu => wgpu::Backends::BROWSER_WEBGPU,
            Tier::WebGl2 => wgpu::Backends::GL,
            Tier::Native => wgpu::Backends::VULKAN,
        };
        if tier == Tier::WebGl2 {
            desc.backend_options.gl.fence_behavior = wgpu::GlFenceBehavior::AutoFinish;
        }
        wgpu::Instance::new(desc)
    }

    /// Opens a device. `surface` is needed on WebGL2 (there is no adapter without a canvas) and may be none elsewhere.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] and [`Error::NoDevice`], with what the platform said.
    pub async fn new(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>, tier: Tier) -> Result<Gpu, Error> {
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: surface,
                ..Default::default()
            })
            .await
            .map_err(|e| Error::NoAdapter { tier: tier.name(), reason: e.to_string() })?;
        let available = adapter.limits();
        let required_limits = match tier {
            Tier::WebGl2 => wgpu::Limits {
                max_buffer_size: available.max_buffer_size,
                ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(available)
            },
            // The defaults everywhere, but as large textures and buffers as there are.
            _ => wgpu::Limits {
                max_buffer_size: available.max_buffer_size,
                #[cfg(any(feature = "compute", feature = "webgpu"))]
                max_storage_buffer_binding_size: available.max_storage_buffer_binding_size,
                ..wgpu::Limits::default().using_resolution(available)
            },
        };
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("limn"),
                required_features: wgpu::Features::empty(),
                required_limits,
                ..Default::default()
            })
            .await
            .map_err(|e| Error::NoDevice(e.to_string()))?;

        let events: Arc<Mutex<Events>> = Arc::default();
        let sink = events.clone();
        device.set_device_lost_callback(move |reason, message| {
            let mut events = sink.lock().unwrap_or_else(PoisonError::into_inner);
            events.lost = Some(if message.is_empty() { format!("{reason:?}") } else { message });
        });
        let sink = events.clone();
        // Without a handler wgpu panics, and a worker that has trapped cannot say why.
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut events = sink.lock().unwrap_or_else(PoisonError::into_inner);
            // A broken frame would repeat itself for ever: the first few tell the story.
            if events.errors.len() < 16 {
                events.errors.push(error.to_string());
            }
        }));

        let half = adapter.get_texture_format_features(wgpu::TextureFormat::Rgba16Float).flags;
        let need = wgpu::TextureFormatFeatureFlags::MULTISAMPLE_X4
            | wgpu::TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE
            | wgpu::TextureFormatFeatureFlags::BLENDABLE;
        let (color_format, samples) = if half.contains(need) {
            (wgpu::TextureFormat::Rgba16Float, 4)
        } else {
            (wgpu::TextureFormat::Rgba8UnormSrgb, 4)
        };
        Ok(Gpu { device, queue, adapter, tier, color_format, samples, events })
    }

    /// One short phrase for a status line: tier and adapter, for example `WebGPU (NVIDIA ...)`.
    pub fn describe(&self) -> String {
        let info = self.adapter.get_info();
        let name = info.name.trim();
        if name.is_empty() { self.tier.name().to_owned() } else { format!("{} ({name})", self.tier.name()) }
    }

    /// Why the device is gone, once it is: build everything again from the retained inputs then.
    ///
    /// On WebGL2 the browser tells the canvas instead (`webglcontextlost`); the caller listens for that one.
    pub fn lost(&self) -> Option<String> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner).lost.clone()
    }

    /// Errors that the device reported since the last call (validation, out of memory); at most 16 are kept.
    pub fn take_errors(&self) -> Vec<String> {
        std::mem::take(&mut self.events.lock().unwrap_or_else(PoisonError::into_inner).errors)
    }

    /// The longest side that a texture, and so a canvas or a picture, can have, in pixels.
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// The largest buffer in bytes.
    pub fn max_buffer(&self) -> u64 {
        self.device.limits().max_buffer_size
    }
}
