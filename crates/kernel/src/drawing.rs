//! A plan for the GPU, as `web/compute.js` takes it: `limn_compute::Program` behind JavaScript.
//!
//! ```text
//!   Kernel::draw ──> Drawing ── plan ──────> buffers, shaders, dispatches as one object
//!                            ── contents ──> what a buffer holds at first, once
//! ```
//!
//! Cost: linear in the cage; two copies of its tables pass.

use limn_compute::Program;
#[cfg(target_arch = "wasm32")]
use {
    limn_compute::Access,
    limn_compute::program::{Buffer, Dispatch, Role, Shader},
    serde::Serialize,
    wasm_bindgen::prelude::{JsValue, wasm_bindgen},
};

/// What the GPU does for a plan, and the cage's points.
#[derive(Debug)]
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Drawing {
    program: Program,
    points: Vec<f32>,
}

impl Drawing {
    /// A program for a cage with these points.
    pub(crate) fn new(program: Program, positions: &[[f32; 3]]) -> Drawing {
        Drawing { program, points: positions.iter().flat_map(|&[x, y, z]| [x, y, z, 0.0]).collect() }
    }

    /// What is to be run.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Drawing {
    /// What drawn buffers are made of: `limn_render::Surface::reserve`.
    pub fn shape(&self) -> Vec<u32> {
        self.program.shape()
    }

    /// The runs of parts that `limn_render::Surface::settle` takes.
    pub fn runs(&self) -> Vec<u32> {
        self.program.runs.as_flattened().to_vec()
    }

    /// The cage's points, four numbers each.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }

    /// What a buffer holds at first; it is handed over, and gone from here.
    pub fn contents(&mut self, id: usize) -> Vec<u8> {
        self.program.buffers.get_mut(id).map(|b| std::mem::take(&mut b.contents)).unwrap_or_default()
    }
}

/// The numbers of [`Program`], by the same names. `role` is a name of [`Role`] in lower case.
#[cfg(target_arch = "wasm32")]
#[derive(Serialize)]
struct Listed<'a> {
    buffers: Vec<ListedBuffer>,
    shaders: Vec<ListedShader>,
    once: Vec<ListedDispatch<'a>>,
    each: Vec<ListedDispatch<'a>>,
    cage: u32,
    vertices: u32,
    count: u32,
    bounds: Option<u32>,
}

#[cfg(target_arch = "wasm32")]
#[derive(Serialize)]
struct ListedBuffer {
    role: &'static str,
    bytes: u32,
    filled: bool,
    /// Whether who draws makes it.
    drawn: bool,
}

/// `access`: 0 the numbers, 1 read, 2 written.
#[cfg(target_arch = "wasm32")]
#[derive(Serialize)]
struct ListedShader {
    entry: &'static str,
    source: String,
    access: [Vec<u8>; 2],
}

#[cfg(target_arch = "wasm32")]
#[derive(Serialize)]
struct ListedDispatch<'a> {
    shader: u32,
    numbers: &'a [u32; 16],
    bound: &'a [Vec<u32>; 2],
    grid: [u32; 2],
}

#[cfg(target_arch = "wasm32")]
#[wasm_bindgen]
impl Drawing {
    /// Everything but contents, as an object: `Plan` of `web/compute.js`.
    ///
    /// # Errors
    /// Never for a program of this build.
    pub fn plan(&self) -> Result<JsValue, JsValue> {
        let p = &self.program;
        let shared = p.shape().get(2).is_some_and(|&b| b > 0);
        let buffer = |b: &Buffer| ListedBuffer {
            role: match b.role {
                Role::Table => "table",
                Role::Work => "work",
                Role::Cage => "cage",
                Role::Vertices => "vertices",
                Role::Indices => "indices",
                Role::Corners => "corners",
                Role::Extras => "extras",
                Role::Colors => "colors",
                Role::Bounds => "bounds",
            },
            bytes: b.bytes as u32,
            filled: !b.contents.is_empty(),
            drawn: matches!(b.role, Role::Indices | Role::Corners | Role::Extras)
                || (b.role == Role::Vertices && shared),
        };
        let access = |a: &Access| match a {
            Access::Uniform => 0,
            Access::Read => 1,
            Access::Write => 2,
        };
        fn dispatch(d: &Dispatch) -> ListedDispatch<'_> {
            ListedDispatch { shader: d.shader, numbers: &d.numbers, bound: &d.bound, grid: d.grid }
        }
        let shader = |s: &Shader| ListedShader {
            entry: s.entry,
            source: s.source.clone(),
            access: s.access.map(|group| group.iter().map(access).collect()),
        };
        let listed = Listed {
            buffers: p.buffers.iter().map(buffer).collect(),
            shaders: p.shaders.iter().map(shader).collect(),
            once: p.once.iter().map(dispatch).collect(),
            each: p.each.iter().map(dispatch).collect(),
            cage: p.cage,
            vertices: p.vertices,
            count: p.count,
            bounds: p.bounds,
        };
        serde_wasm_bindgen::to_value(&listed).map_err(JsValue::from)
    }
}
