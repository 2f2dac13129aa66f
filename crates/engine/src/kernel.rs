//! The module with every scheme, as the engine sees it: objects of `crates/kernel` behind JavaScript.
//!
//! `web/host.js` loads that module when [`Engine::wants_kernel`](crate::Engine::wants_kernel) says so, and hands over a
//! `Kernel`. A mesh is sent once, a plan each time; a [`Run`] is stepped like a job of this module. Whatever goes wrong over
//! there, a trap included, comes back as one sentence: the engine forgets the kernel then, and asks for another one.

use std::sync::Arc;

use limn_mesh::{Large, Mesh, Plan, Refined};
use limn_render::Gpu;
use wasm_bindgen::prelude::*;

use crate::making::{Filler, Work};

#[wasm_bindgen]
extern "C" {
    /// `Kernel` of `crates/kernel`.
    pub type Kernel;
    #[wasm_bindgen(method, catch)]
    fn mesh(this: &Kernel, bytes: &[u8]) -> Result<(), JsValue>;
    #[wasm_bindgen(method, catch)]
    fn start(this: &Kernel, plan: &[u8], budget: f64) -> Result<Run, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn draw(
        this: &Kernel,
        plan: &[u8],
        buffer: f64,
        groups: u32,
        parts: &[u32],
        budget: f64,
    ) -> Result<Option<Drawing>, JsValue>;

    /// A level on its way to buffers: `Picture` of `web/compute.js`, which the GPU refines, or of `web/fill.js`.
    pub type Drawing;
    /// What [`limn_render::Surface::reserve`] makes buffers of.
    #[wasm_bindgen(method)]
    pub fn shape(this: &Drawing) -> Vec<u32>;
    /// What [`limn_render::Surface::settle`] takes.
    #[wasm_bindgen(method)]
    fn runs(this: &Drawing) -> Vec<u32>;
    /// Fills the buffers that were made last.
    #[wasm_bindgen(method)]
    pub fn run(this: &Drawing);
    /// The box of the points; empty while they are made. Behind it the milliseconds of refining and of filling, if the CPU did it.
    #[wasm_bindgen(method, catch)]
    fn bounds(this: &Drawing) -> Result<Vec<f32>, JsValue>;
    /// How much is done, 0 to 1.
    #[wasm_bindgen(method)]
    fn progress(this: &Drawing) -> f32;
    /// Nobody waits for it any more.
    #[wasm_bindgen(method)]
    fn stop(this: &Drawing);

    /// `Run` of `crates/kernel`.
    type Run;
    #[wasm_bindgen(method, catch)]
    fn step(this: &Run, rows: usize) -> Result<bool, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn progress(this: &Run) -> Result<f32, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn finish(this: &Run) -> Result<Vec<u8>, JsValue>;
    #[wasm_bindgen(method)]
    fn large(this: &Run, i: usize) -> js_sys::Uint8Array;
    #[wasm_bindgen(method, catch)]
    fn free(this: &Run) -> Result<(), JsValue>;
}

/// A kernel, and the mesh that it has.
pub struct Remote {
    kernel: Kernel,
    mesh: Option<Arc<Mesh>>,
}

impl Remote {
    /// One that has no mesh yet.
    pub fn new(kernel: Kernel) -> Remote {
        Remote { kernel, mesh: None }
    }

    /// Begins to refine.
    ///
    /// # Errors
    /// One sentence.
    pub fn start(&mut self, mesh: &Arc<Mesh>, plan: &Plan, budget: u64) -> Result<Box<dyn Work>, String> {
        self.take(mesh)?;
        let run = self.kernel.start(&plan.pack(), budget as f64).map_err(sentence)?;
        Ok(Box::new(Away { run: Some(run), mesh: mesh.clone() }))
    }

    /// What makes a plan's level where it is drawn; none if that cannot be, or its buffers do not take it: then the level has to come
    /// here, or says why not.
    pub fn draw(&mut self, mesh: &Arc<Mesh>, plan: &Plan, parts: &[u32], budget: u64, gpu: &Gpu) -> Option<Drawing> {
        self.take(mesh).ok()?;
        let limits = gpu.device.limits();
        let groups = limits.max_compute_workgroups_per_dimension;
        // WebGL2 has no storage buffers, and nobody there who would bind them.
        let storage = if cfg!(feature = "webgl") { u64::MAX } else { limits.max_storage_buffer_binding_size };
        let buffer = limits.max_buffer_size.min(storage);
        self.kernel.draw(&plan.pack(), buffer as f64, groups, parts, budget as f64).ok()?
    }

    fn take(&mut self, mesh: &Arc<Mesh>) -> Result<(), String> {
        if self.mesh.as_ref().is_none_or(|m| !Arc::ptr_eq(m, mesh)) {
            self.mesh = None;
            self.kernel.mesh(&mesh.pack()).map_err(sentence)?;
            self.mesh = Some(mesh.clone());
        }
        Ok(())
    }
}

impl Large for Run {
    fn length(&self, i: usize) -> usize {
        self.large(i).length() as usize
    }

    fn copy_to(&self, i: usize, out: &mut [u8]) {
        self.large(i).copy_to(out);
    }
}

/// A run over there; there until it is dropped.
struct Away {
    run: Option<Run>,
    mesh: Arc<Mesh>,
}

impl Work for Away {
    fn step(&mut self, rows: usize) -> Result<bool, String> {
        self.run.as_ref().map_or(Ok(true), |run| run.step(rows)).map_err(sentence)
    }

    fn progress(&self) -> f32 {
        self.run.as_ref().and_then(|run| run.progress().ok()).unwrap_or(0.0)
    }

    fn finish(self: Box<Self>) -> Result<Refined, String> {
        let Some(run) = &self.run else { return Err(String::new()) };
        let bytes = run.finish().map_err(sentence)?;
        let level = Refined::unpack(&bytes, self.mesh.clone(), run);
        level.map_err(|e| e.to_string())
    }
}

/// A level that is made where it is drawn, until it is there or dropped.
pub struct Elsewhere(pub Drawing);

impl Filler for Elsewhere {
    fn bounds(&self) -> Option<Vec<f32>> {
        self.0.bounds().ok()
    }

    fn runs(&self) -> Vec<u32> {
        self.0.runs()
    }

    fn progress(&self) -> f32 {
        self.0.progress()
    }
}

impl Drop for Elsewhere {
    fn drop(&mut self) {
        self.0.stop();
    }
}

impl Drop for Away {
    fn drop(&mut self) {
        // What a trap left behind cannot be freed; it goes with its module.
        let _ = self.run.take().map(|run| run.free());
    }
}

/// A thrown sentence is one of ours. Anything else is a trap: most likely there was no more memory.
fn sentence(thrown: JsValue) -> String {
    thrown
        .as_string()
        .unwrap_or_else(|| "refining it took more memory than the browser gives; choose a lower level".to_owned())
}
