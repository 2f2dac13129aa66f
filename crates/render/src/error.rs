//! What can go wrong between the caller's slices and a picture: one enum for the whole crate.
//!
//! Every message says what, with the numbers, and what to do. Errors that the GPU reports later (validation, memory)
//! are not returned from here: [`crate::Gpu::take_errors`] hands them out.

/// An error of the renderer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No adapter answered.
    #[error("no graphics adapter was found for {tier} ({reason}); update the browser or the graphics driver")]
    NoAdapter {
        /// The tier that was asked for.
        tier: &'static str,
        /// What the platform said.
        reason: String,
    },
    /// The adapter refused to give a device.
    #[error("the graphics adapter gave no device: {0}")]
    NoDevice(String),
    /// The surface cannot be shown by this adapter.
    #[error("the canvas offers no 8-bit colour format that this adapter can draw to")]
    NoFormat,
    /// A buffer that cannot be split is larger than the adapter allows.
    #[error("{what} need {bytes} bytes in one buffer, but this graphics adapter takes {limit}; choose a lower level")]
    TooLarge {
        /// What does not fit, in the plural.
        what: &'static str,
        /// The bytes needed.
        bytes: u64,
        /// The adapter's limit in bytes.
        limit: u64,
    },
    /// An image is larger than the largest texture.
    #[error(
        "a picture of {width} by {height} pixels was asked for, but this graphics adapter takes at most {limit} a side"
    )]
    ImageSize {
        /// Width asked for, in pixels.
        width: u32,
        /// Height asked for, in pixels.
        height: u32,
        /// Largest side in pixels.
        limit: u32,
    },
    /// A texture is larger than the largest texture, or empty.
    #[error(
        "texture {index} has {width} by {height} pixels, but this graphics adapter takes 1 to {limit} a side; scale it down"
    )]
    TextureSize {
        /// Number of the texture.
        index: usize,
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
        /// Largest side in pixels.
        limit: u32,
    },
    /// Slices that make no surface.
    #[error(transparent)]
    Data(#[from] limn_layout::Error),
    /// Reading a picture back failed.
    #[error("the picture could not be read back from the graphics adapter: {0}")]
    Readback(String),
    /// The device was lost and everything on it must be built again.
    #[error("the graphics device was lost ({0}); it has to be opened again")]
    Lost(String),
}

/// So many of something where there have to be others.
pub(crate) fn mismatch(what: &'static str, found: u64, expected: u64) -> Error {
    limn_layout::Error::Mismatch { what, found, expected }.into()
}
