//! Drawing with wgpu: one renderer whose picture is the same on WebGPU, WebGL2 and native Vulkan.
//!
//! The idea: the caller hands over plain slices (points, normals, face corners), they are packed into GPU buffers
//! once ([`Upload`]), and from then on a frame costs the CPU a few microseconds however large the model is: one
//! uniform buffer is written and a handful of draws are recorded.
//!
//! ```text
//!   slices --Upload--> Surface ----+
//!   cage edges --------------------+--> multisampled colour + depth --resolve--> final pass --> canvas
//!   points ------------------------+      (linear light, half float)      (background, sRGB, dither)
//!   camera, style --> one uniform -+
//! ```
//!
//! Surfaces come in two layouts, see [`surface`]: shared quads, which use the order of vertices after a quad split to
//! draw true edges without any extra memory, and corners, which carry everything else (triangles, polygons, texture
//! coordinates). Lines of the cage and points are screen-space shapes, one instance each ([`overlay`]).
//!
//! Cost on the GPU: 16 bytes a vertex and 24 bytes a quad for shared quads; 72 bytes a triangle for corners (108 with
//! texture coordinates and colours). Limits: a buffer never exceeds the adapter's `max_buffer_size`; what can be split
//! into several draws is split, and what cannot is refused with the numbers ([`Error::TooLarge`]).

mod error;
mod gpu;
mod ground;
mod image;
mod light;
mod material;
pub mod overlay;
mod pane;
mod pipelines;
#[cfg(feature = "compute")]
pub mod refine;
mod renderer;
mod screen;
mod style;
pub mod surface;
mod target;
mod uniform;
mod upload;
mod wgsl;

pub use limn_layout::{Triangulate, corners, pack};
pub use wgpu;

pub use error::Error;
pub use gpu::{Gpu, Tier};
pub use material::{Material, TextureData};
pub use renderer::Renderer;
pub use screen::{Screen, ScreenFrame};
pub use style::{Background, Camera, Edges, Frame, Ground, Shading, Style};
pub use surface::{Bounds, Faces, Part, Surface, SurfaceData};
pub use upload::Upload;

/// The WGSL modules by name, each as it is handed to the device (the shared parts already joined on).
///
/// For tests and tools that validate them; costs one string per module.
pub fn shaders() -> Vec<(&'static str, String)> {
    pipelines::Module::ALL.iter().map(|m| (m.name(), m.source())).collect()
}

/// Bytes of the frame's uniform buffer, for the test that holds it against the shaders' `Globals`.
pub fn uniform_bytes() -> usize {
    size_of::<uniform::Globals>()
}
