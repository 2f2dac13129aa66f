//! limn-compute: refinement on the GPU as plain data. Cage points in, points and normals where the draw reads them, nothing in
//! between on the CPU.
//!
//! ```text
//!                 once                                         for every new position of the cage
//!   tables ──► half-edges 1 ──► half-edges 2 ..         points ──► level 1 ──► level 2 .. ──► normals
//!              (by arithmetic)                   └──► indices       one dispatch each, all of them in one compute pass
//! ```
//!
//! Nothing here has a device: a [`Program`] says which buffers there are and what runs on them, and who has one runs it ([`mod@program`]).
//! Three ways make the points. *The fused gather* (`fused.rs`): hand-written rules that find a level's neighbours through `twin`
//! and `origin` alone, so a level costs one dispatch and no atomics; half-edges of the next level are arithmetic (Dupuy & Vanhoey
//! 2021; Vanhoey & Dupuy 2022), and those of the last are never built. Colours go the same way ([`Values`]). *Patches* (`patch.rs`): from
//! level 5 on ([`path`]) the last levels of Catmull-Clark, Loop and linear at once, from the rings of the faces of level 1, with no level
//! between. *Rows* (`rows.rs`): any plan's weights as sparse rows, one dispatch a pass; they cost the CPU more to make than the level
//! itself, and pay where the cage moves. All number child vertices as `limn-mesh` does, so what was made here and there can be compared,
//! drawn and exported alike.
//!
//! Cost on the GPU, Catmull-Clark, bytes a face of the last level: 16 written for points, 4 for normals and, once, 24 for
//! indices; about 16 read of the level before. Memory besides: a quarter, a sixteenth .. of 16 for points and 36 for half-edges.
//! Limits: a level's points, and half-edges of the one before, must fit one binding ([`Error::TooLarge`] says by how much they
//! do not); indices and corners are made in pieces. [`program()`] says what has no kernels. The GPU's sums differ from the CPU's by
//! their rounding: at most 3e-7 of the box in Chromium's software WebGPU (`tests/browser/compute.test.mjs` prints it).

mod cage;
mod error;
mod finish;
mod fused;
mod kernels;
mod listed;
mod patch;
mod plan;
pub mod program;
mod rows;
#[path = "../../render/src/wgsl.rs"]
mod wgsl;

pub use cage::Cage;
pub use error::Error;
pub use finish::{Drawn, Piece};
pub use fused::fused;
pub use kernels::Access;
pub use patch::patched;
pub use plan::{Path, Tables, path, program, program_by, recorded, rules};
pub use program::{Limits, Program, bounds};
pub use rows::{Pass, RowLevel, Rows, Tangents, by_rows, rows};

use kernels::{Kernel, Level};
use program::{Builder, Dispatch, Id, Role};

/// A scheme that has kernels of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// Catmull-Clark on any polygons.
    CatmullClark {
        /// What the centroid of a triangle weighs in the points of its edges: 1/4, or 0.47 by OpenSubdiv's smooth rule.
        triangle: f32,
    },
    /// The quad split of any polygons without moving the surface.
    Quads,
    /// The triangle split of triangles without moving the surface.
    Triangles,
    /// Loop on triangles.
    Loop {
        /// Warren's weights.
        warren: bool,
    },
    /// Butterfly on triangles.
    Butterfly {
        /// The tension.
        w: f32,
    },
    /// Modified Butterfly on triangles.
    ModifiedButterfly,
    /// Sqrt3 on closed meshes of triangles. On a rim every second step numbers vertices by ranks that are no arithmetic: rows.
    Sqrt3,
    /// Doo-Sabin on closed meshes of any polygons, three and more around every vertex.
    DooSabin {
        /// Doo's midpoint weights.
        midpoint: bool,
    },
}

/// What holds beside the scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// The scheme.
    pub scheme: Scheme,
    /// Whether boundary vertices of one face stay.
    pub corners: bool,
    /// Whether creases soften by Chaikin's rule.
    pub chaikin: bool,
}

/// What is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Points, with normals and faces to be drawn.
    Points,
    /// Linear colours, by the same rules, for the surface that points make.
    Colors,
}

/// The text of every kernel with a name, each as it is handed to the device. For tests that validate them.
pub fn shaders() -> Vec<(String, String)> {
    kernels::sources()
}

/// A program that gives colours: `values` of the last level, and the same as the draw reads them.
fn colors(
    mut builder: Builder,
    (cage, cage_vertices): (Id, u32),
    (once, mut each): (Vec<Dispatch>, Vec<Dispatch>),
    (values, count): (Id, u32),
) -> Result<Program, Error> {
    let packed = builder.make("colours", 4 * u64::from(count), Role::Colors)?;
    let numbers = Level { end: count, ..Level::default() };
    each.extend(builder.step(Kernel::Colors, &numbers, &[], &[values, packed]));
    let (drawn, packed) = (Drawn::Corners { pieces: Vec::new(), carries: [false; 2] }, Some(packed));
    let (shaders, buffers) = (builder.shaders(), builder.buffers);
    Ok(Program {
        buffers,
        shaders,
        once,
        each,
        cage,
        cage_vertices,
        vertices: values,
        count,
        drawn,
        packed,
        bounds: None,
        runs: Vec::new(),
    })
}
