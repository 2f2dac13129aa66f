//! limn-mesh: the kernel of Limn. Meshes, subdivision schemes, and refinement to a level.
//!
//! Everything follows from one idea: **a scheme is a split plus weights**. A [`split`] makes the children's connectivity by
//! index arithmetic; a [`scheme`](mod@scheme) says which points with which weights make every new point. The statement is written once
//! and runs as a fast evaluator or records sparse rows ([`sink`]).
//!
//! ```text
//!   Soup ──build──> Mesh ──predict──> Prediction
//!  (file)            │
//!                    └──Job::step ... ──> Refined  (points, faces, colours, texture coordinates of one level)
//! ```
//!
//! ```
//! use limn_mesh::{Boundary, Mesh, Plan, Weld, refine, scheme, shapes};
//! use std::sync::Arc;
//!
//! let cube = (shapes::shape("cube").unwrap().build)();
//! let (mesh, _report) = Mesh::build(&cube, Weld::Off)?;
//! let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::default(), 3);
//! let refined = refine(&Arc::new(mesh), &plan, 1 << 30)?;
//! assert_eq!(refined.counts.faces, 6 * 4 * 4 * 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! No I/O, clock, GPU or browser in here. Native and wasm give the same bits: sums run in a fixed order, no fused
//! multiply-add, transcendental functions from `libm`, no hash map is iterated.

mod apart;
mod charts;
mod connect;
mod copies;
pub mod crease;
mod evaluate;
mod face_varying;
pub mod fairing;
mod holes;
pub mod limit;
pub mod marks;
pub mod mesh;
pub mod order;
mod owned;
pub mod pack;
pub mod pair;
#[cfg(feature = "full")]
mod patch;
pub mod plan;
pub mod refine;
pub mod refined;
pub mod report;
mod scattered;
pub mod scheme;
pub mod shapes;
pub mod sink;
pub mod soup;
pub mod split;
pub mod stencil;
pub mod topology;
mod track;
pub mod triangulate;
mod validate;
mod weld;
mod wire;

/// Whether this build has everything: the feature `full`. What stands behind it is not compiled into the page's first module,
/// and [`Plan::is_here`] says which plans need it.
pub(crate) const FULL: bool = cfg!(feature = "full");

pub use crease::Creases;
pub use fairing::Fairing;
pub use limit::{Limit, LimitRule, limit};
pub use mesh::{Mesh, Stats, TopologyError};
#[cfg(feature = "full")]
pub use patch::{Drag, Moved, PatchRing, PatchTable, PatchTables};
pub use plan::{Plan, Run};
pub use refine::{Job, Prediction, RefineError, grouped, memory, predict, refine};
pub use refined::{Faces, Refined, UvValues};
pub use report::{Note, Report};
pub use scheme::{
    Accepts, Boundary, Creasing, Decay, Domain, Entry, FaceVarying, Family, Honours, Info, Param, Params, Rules,
    SCHEMES, TriangleRule, scheme,
};
pub use shapes::{SHAPES, Shape, shape};
pub use soup::{Marks, NONE, Soup};
pub use split::{FaceKind, FaceShape, Split};
pub use topology::{Connectivity, Counts, Topology};
pub use triangulate::{triangulate, triangulate_soup};
pub use weld::{Weld, bounds};
pub use wire::Large;
