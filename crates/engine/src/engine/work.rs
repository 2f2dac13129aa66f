//! The work behind the picture: is what is shown what is wanted, and if not, making it.

use std::sync::Arc;

use limn_document::parameters;
use limn_document::view::Shading;
use limn_mesh::{Connectivity, Job, Mesh};
use wasm_bindgen::prelude::wasm_bindgen;

use super::{Engine, Known};
use crate::kernel::{Kernel, Remote};
use crate::making::{MOST_FLAT, Making, Parts, Step, Work};
use crate::protocol::{Card, Message};
use crate::report::Facts;
use limn_document::words::sentence;

/// Work shorter than this, in milliseconds, is not talked about.
const QUIET: f64 = 200.0;
/// The pause between two progress messages.
const PAUSE: f64 = 80.0;

#[wasm_bindgen]
impl Engine {
    /// Whether something waits for the module with every scheme; `take_kernel` answers.
    pub fn wants_kernel(&self) -> bool {
        self.wants_kernel
    }

    /// The surroundings loaded the module with every scheme; none if it could not be.
    pub fn take_kernel(&mut self, kernel: Option<Kernel>) {
        self.kernel = kernel.map(Remote::new);
        if self.kernel.is_some() {
            self.no_card("kernel");
        }
        // It may have been cancelled, or another scheme chosen meanwhile.
        match (std::mem::take(&mut self.wants_kernel), &self.kernel) {
            (true, Some(_)) => self.sync(),
            (true, None) => self.cannot_load(),
            (false, _) => {}
        }
    }
}

impl Engine {
    /// Starts or drops work until what is being made, or else what is shown, is what the document wants.
    pub(super) fn sync(&mut self) {
        self.dirty.picture = true;
        self.dirty.state = true;
        let (Some(mesh), Some(plan)) = (self.document.mesh().cloned(), self.document.plan()) else { return };
        if self.known.as_ref().is_none_or(|k| !Arc::ptr_eq(&k.mesh, &mesh)) {
            let (facts, parts) = (Facts::of(&mesh), Arc::new(Parts::of(&self.document)));
            self.known = Some(Known { mesh: mesh.clone(), facts, parts });
        }
        let Some(known) = &self.known else { return };
        self.wants_kernel = false;
        let faces = self.document.predict(plan.level).map_or(0, |p| p.counts.faces);
        let corners = self.document.view().shading == Shading::Flat && faces <= MOST_FLAT;
        let shown = self.shown.as_ref().filter(|m| m.is(&mesh, &plan, corners));
        if shown.is_some() {
            self.making = None;
            self.progress_over();
            self.overlays();
            return;
        }
        // A parameter's slider asks again before it can be answered. What it asked for first is made and shown, then the
        // last: else nothing would be seen until the hand rests.
        if self.making.as_ref().is_some_and(|m| m.is_but_for_params(&mesh, &plan, corners)) {
            return;
        }
        let making = match &self.shown {
            Some(made) if made.is(&mesh, &plan, !corners) => Ok(Making::again(made, corners)),
            _ => {
                if !plan.is_here(&mesh) && self.kernel.is_none() {
                    // What is shown stays until the module comes.
                    self.making = None;
                    self.wants_kernel = true;
                    return;
                }
                let budget = self.document.budget();
                let work: Result<Box<dyn Work>, String> = match &mut self.kernel {
                    Some(kernel) if !plan.is_here(&mesh) => kernel.start(&mesh, &plan, budget),
                    _ => Job::new(mesh.clone(), plan.clone(), budget)
                        .map(|job| Box::new(job) as Box<dyn Work>)
                        .map_err(|e| e.to_string()),
                };
                work.map(|work| Making::refine(work, mesh, plan, corners, known.parts.clone()))
            }
        };
        match making {
            Ok(making) => {
                if self.making.is_none() {
                    self.since = self.clock.now();
                }
                self.making = Some(making);
            }
            Err(error) => self.cannot_show(&error),
        }
    }

    /// Says that the module with every scheme could not be loaded, and goes back.
    fn cannot_load(&mut self) {
        self.dirty.state = true;
        let scheme = self.document.plan().map_or("", |p| p.scheme.info.name);
        let title = "A part of Limn could not be loaded".to_owned();
        let lines = vec![format!("{scheme} needs it. Check the connection and choose it again.")];
        self.card(Card { id: "kernel", kind: "error", title, lines, ..Card::default() });
        self.go_back();
    }

    fn cannot_show(&mut self, why: &str) {
        self.making = None;
        // If it was the other module that failed, it is of no more use.
        self.kernel = None;
        self.progress_over();
        let title = "This level cannot be shown".to_owned();
        self.card(Card { id: "draw", kind: "error", title, lines: vec![sentence(why)], ..Card::default() });
        self.go_back();
    }

    /// Works until `deadline`.
    pub(super) fn advance(&mut self, deadline: f64) {
        let Some(mut making) = self.making.take() else { return };
        let clock = self.clock.clone();
        loop {
            match making.step(&self.renderer, || clock.now(), deadline) {
                Ok(Step::Done(made, surface)) => {
                    self.times.refine = making.spent[0];
                    self.times.build = making.spent[1];
                    self.renderer.show(Some(surface));
                    self.shown = Some(made);
                    self.paint();
                    self.dirty.picture = true;
                    self.dirty.state = true;
                    if self.document.plan() != self.shown.as_ref().map(|m| m.plan.clone()) {
                        return self.sync();
                    }
                    self.overlays();
                    self.progress_over();
                    if let Some(file) = self.export.take() {
                        self.write(&file);
                    }
                    return;
                }
                Ok(Step::More) if clock.now() < deadline => {}
                Ok(Step::More) => break,
                Err(error) => return self.cannot_show(&error),
            }
        }
        let now = clock.now();
        if now - self.since > QUIET && self.told.is_none_or(|t| now - t > PAUSE) {
            self.told = Some(now);
            let what = format!("Refining to level {}", making.level());
            self.post.send(&Message::Progress { what, done: making.progress(), cancel: true });
            self.dirty.state = true;
        }
        self.making = Some(making);
    }

    /// Takes the progress line away.
    pub(super) fn progress_over(&mut self) {
        if self.told.take().is_some() {
            self.post.send(&Message::Progress { what: String::new(), done: 0.0, cancel: false });
        }
    }

    /// Drops the work that is going on and makes the document what is shown again.
    pub(super) fn stop_making(&mut self) {
        self.export = None;
        if self.making.take().is_some() | std::mem::take(&mut self.wants_kernel) {
            self.go_back();
        }
    }

    /// Goes back to the scheme and level that are shown; where they belong to another model, to that model.
    fn go_back(&mut self) {
        let Some(shown) = self.shown.clone() else {
            // Nothing was ever shown: the model itself is the least there is.
            let _ = self.document.run("level 0");
            return self.sync();
        };
        let fits = |engine: &Engine| {
            engine.document.mesh().is_some_and(|m| Arc::ptr_eq(m, shown.refined.mesh()))
                && engine.document.plan().is_some_and(|p| p == shown.plan)
        };
        // The step that led away is taken back, so that Undo does not lead there again.
        let view = self.document.view().clone();
        if self.document.run("undo").is_ok() {
            if fits(self) {
                return self.sync();
            }
            let _ = self.document.run("redo");
            *self.document.view_mut() = view;
        }
        let rule = match shown.plan.rules.boundary {
            limn_mesh::Boundary::None => "none",
            limn_mesh::Boundary::EdgeOnly => "edge-only",
            limn_mesh::Boundary::EdgeAndCorner => "edge-and-corner",
        };
        // The level comes down first: the other settings could not be paid for at the one that was too much.
        let level = format!("level {}", shown.plan.level);
        let limit = format!("limit {}", if shown.plan.limit { "on" } else { "off" });
        let scheme = parameters::command(&shown.plan).to_string();
        for command in [level.clone(), scheme, format!("boundary {rule}"), limit, level] {
            let _ = self.document.run(&command);
        }
        if !fits(self) {
            while !fits(self) && self.document.run("undo").is_ok() {}
        }
        if !fits(self) {
            let _ = self.document.run("level 0");
        }
        self.sync();
    }

    /// Brings cage and points to the GPU where the view shows them.
    fn overlays(&mut self) {
        let view = self.document.view();
        let (cage, points) = (view.cage, view.points);
        if let (true, Some(mesh)) = (cage, self.document.mesh().cloned())
            && self.caged.as_ref().is_none_or(|c| !Arc::ptr_eq(c, &mesh))
        {
            match self.renderer.set_cage(&mesh.positions, &edges(&mesh)) {
                Ok(()) => self.caged = Some(mesh),
                Err(error) => self.trouble(&error.to_string()),
            }
        }
        if let (true, Some(made)) = (points, &self.shown)
            && self.dotted.as_ref().is_none_or(|d| !Arc::ptr_eq(d, &made.refined))
        {
            let refined = made.refined.clone();
            match self.renderer.set_points(&refined.points) {
                Ok(()) => self.dotted = Some(refined),
                Err(error) => self.trouble(&error.to_string()),
            }
        }
    }

    /// A card about drawing that went wrong; the picture stays as good as it is.
    pub(super) fn trouble(&self, error: &str) {
        let title = "Something could not be drawn".to_owned();
        self.card(Card { id: "draw", kind: "error", title, lines: vec![sentence(error)], ..Card::default() });
    }
}

/// Every edge once, by its two vertices.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let t = &mesh.topology;
    (0..t.edges())
        .map(|e| {
            let h = t.edge_half_edge(e);
            [t.origin(h), t.origin(t.next(h))]
        })
        .collect()
}
