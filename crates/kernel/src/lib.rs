//! limn-kernel: refining by every scheme, in a wasm module that is loaded when a plan needs it.
//!
//! The page's engine has the rules of the common schemes only, so a first visit stays light however many schemes there are.
//! The first plan that it has no rules for makes it load this module, which works in the same thread:
//!
//! ```text
//!   engine ── mesh as bytes, once a mesh ──>  Kernel
//!          ── plan as bytes ───────────────>  Kernel::start ──> Run: step, step, ...
//!          <── level as bytes ──────────────  Run::finish, and its arrays one by one: Run::large
//!          ── plan as bytes ───────────────>  Kernel::fill ──> Filling: the level as it is drawn, into the GPU's buffers
//!          ── plan as bytes ───────────────>  Kernel::draw ──> Drawing: what the GPU does, where it can
//! ```
//!
//! A run is stepped by the engine as it steps its own jobs: in slices of a few milliseconds, between which it takes messages
//! and draws. Dropping the run cancels it. Cost beside refining: two copies of the mesh, and one of the level.
//! Limit: this module has 4 GB of its own, and the memory of the largest level stays with it.

mod about;
mod drawing;
mod filling;
#[cfg(feature = "trial")]
pub mod trial;

use std::sync::Arc;

pub use about::about;
pub use drawing::Drawing;
pub use filling::Filling;

use filling::Spare;
use limn_compute::Limits;
use limn_mesh::{Job, Mesh, Plan, Refined};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// A mesh, and what refines it.
#[derive(Debug, Default)]
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Kernel {
    mesh: Option<Arc<Mesh>>,
    spare: Spare,
}

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Kernel {
    /// One without a mesh.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen(constructor))]
    pub fn new() -> Kernel {
        Kernel::default()
    }

    /// Takes a packed mesh in place of the one before.
    ///
    /// # Errors
    /// One sentence, if the bytes are none.
    pub fn mesh(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.mesh = None;
        self.mesh = Some(Arc::new(Mesh::unpack(bytes).map_err(|e| e.to_string())?));
        Ok(())
    }

    /// Begins to refine the mesh by a packed plan, with at most `budget` bytes.
    ///
    /// # Errors
    /// One sentence: [`limn_mesh::RefineError`], or the bytes are no plan, or there is no mesh.
    pub fn start(&self, plan: &[u8], budget: f64) -> Result<Run, String> {
        // Two levels are not held at once.
        self.spare.take();
        let (_, job) = self.job(plan, budget)?;
        Ok(Run { job: Some(job), level: None })
    }

    /// Begins to refine the mesh by a packed plan, with at most `budget` bytes, into buffers of up to `limit` bytes; none if what is drawn of
    /// it has to be packed from the level. `parts` are those of the file's faces, empty if there is one.
    ///
    /// # Errors
    /// As [`Kernel::start`].
    pub fn fill(&self, plan: &[u8], budget: f64, limit: f64, parts: &[u32]) -> Result<Option<Filling>, String> {
        let (mesh, job) = self.job(plan, budget)?;
        Ok(Filling::new(job, &mesh, limit as u64, parts, &self.spare))
    }

    /// What a GPU does for a packed plan, whose buffers take up to so many bytes and whose dispatches so many groups a dimension: by
    /// kernels made for its scheme (`limn_compute::program`, which takes the `parts` of the file's faces), and with `rows` by rows
    /// where there are none (`limn_compute::by_rows`). Rows cost more to make than the level itself costs the CPU: they are for cages that
    /// will move. None where the CPU has to refine.
    ///
    /// # Errors
    /// One sentence: the bytes are no plan, or there is no mesh, or a buffer would be too large.
    pub fn draw(
        &self,
        plan: &[u8],
        buffer: f64,
        groups: u32,
        parts: &[u32],
        rows: bool,
    ) -> Result<Option<Drawing>, String> {
        let mesh = self.mesh.as_ref().ok_or("there is no mesh to refine")?;
        let plan = Plan::unpack(plan).map_err(|e| e.to_string())?;
        let limits = limits(buffer, groups);
        let made = match limn_compute::program(mesh, &plan, parts, limits) {
            Ok(None) if rows => limn_compute::by_rows(mesh, &plan, parts, limits),
            made => made,
        };
        Ok(made.map_err(|e| e.to_string())?.map(|program| Drawing::new(program, &mesh.positions)))
    }
}

impl Kernel {
    fn job(&self, plan: &[u8], budget: f64) -> Result<(Arc<Mesh>, Job), String> {
        let mesh = self.mesh.clone().ok_or("there is no mesh to refine")?;
        let plan = Plan::unpack(plan).map_err(|e| e.to_string())?;
        let job = Job::new(mesh.clone(), plan, budget as u64).map_err(|e| e.to_string())?;
        Ok((mesh, job.shaded()))
    }
}

/// The limits that a browser's adapter has. A size of 4 GB and more cannot be said to shaders, nor be had.
pub(crate) fn limits(buffer: f64, groups: u32) -> Limits {
    Limits { buffer: (buffer as u64).min(u64::from(u32::MAX)), groups }
}

/// A refinement under way. Dropping it cancels.
#[derive(Debug)]
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Run {
    job: Option<Job>,
    level: Option<Refined>,
}

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Run {
    /// Works off about `rows` rows and says whether all is done: [`Job::step`].
    pub fn step(&mut self, rows: usize) -> bool {
        self.job.as_mut().is_none_or(|job| job.step(rows))
    }

    /// How much is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        self.job.as_ref().map_or(1.0, Job::progress)
    }

    /// What is small of the level as bytes, after working off what is left: [`Refined::pack`].
    pub fn finish(&mut self) -> Vec<u8> {
        if let Some(job) = self.job.take() {
            self.level = Some(job.finish());
        }
        self.level.as_ref().map(Refined::pack).unwrap_or_default()
    }
}

impl Run {
    /// The level, once it is finished.
    pub fn level(&self) -> Option<&Refined> {
        self.level.as_ref()
    }
}

#[cfg(target_arch = "wasm32")]
#[wasm_bindgen]
impl Run {
    /// The bytes of a large array of the level, where they lie in this module's memory: to be copied before anything else is
    /// called here, [`Refined::large`].
    pub fn large(&self, i: usize) -> js_sys::Uint8Array {
        let bytes = self.level.as_ref().map_or(&[][..], |level| level.large(i));
        // SAFETY: the caller copies from the view at once, so memory neither moves nor changes while it is used.
        unsafe { js_sys::Uint8Array::view(bytes) }
    }
}
