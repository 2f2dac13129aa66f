//! Why a refinement is not put together: tables that are wrong, or more than the adapter takes. Nothing was made then.

use limn_mesh::RefineError;

/// An error of this crate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
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
    /// Slices that do not belong together, or an index past their end.
    #[error(transparent)]
    Data(#[from] limn_layout::Error),
    /// Half-edges that do not fit together.
    #[error("{what} {at} of the mesh does not fit its neighbours, so it cannot be refined on the graphics adapter")]
    HalfEdges {
        /// Face, half-edge or vertex.
        what: &'static str,
        /// Its number.
        at: u64,
    },
    /// What the CPU refuses too.
    #[error(transparent)]
    Refine(#[from] RefineError),
}
