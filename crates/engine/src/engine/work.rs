//! The work behind the picture: is what is shown what is wanted, and if not, making it.

use std::sync::Arc;

use limn_document::compare::Pane;
use limn_document::parameters;
use limn_document::view::Shading;
use limn_mesh::marks::INFINITE;
use limn_mesh::{Connectivity, Job, Mesh, Plan, Refined, predict};
use limn_render::Surface;
use wasm_bindgen::prelude::wasm_bindgen;

use super::{Engine, Known};
use crate::kernel::{Elsewhere, Kernel, Remote};
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
        let Some(mesh) = self.document.mesh().cloned() else { return };
        if self.known.as_ref().is_none_or(|k| !Arc::ptr_eq(&k.mesh, &mesh)) {
            let (facts, parts) = (Facts::of(&self.document, &mesh), Arc::new(Parts::of(&self.document)));
            self.known = Some(Known { mesh: mesh.clone(), facts, parts });
        }
        let Some(parts) = self.known.as_ref().map(|k| k.parts.clone()) else { return };
        self.wants_kernel = false;
        let flat = self.document.view().shading == Shading::Flat;
        let panes: Vec<(Pane, bool)> = (self.document.panes().into_iter())
            .map(|pane| {
                let faces = predict(&pane.mesh, &pane.plan).ok().flatten().map_or(0, |p| p.counts.faces);
                (pane, flat && faces <= MOST_FLAT)
            })
            .collect();
        self.arrange(&panes);
        // What shows or writes points, or faces by what they came from, wants them here.
        let view = self.document.view();
        let all_here = view.points || view.kinds;
        for (i, (pane, corners)) in panes.into_iter().enumerate() {
            let Pane { mesh, plan, budget, refused, .. } = pane;
            let all_here = all_here || i == 0 && self.export.is_some();
            let there = self.made(i).is_some_and(|m| m.is(&mesh, &plan, corners) && !(all_here && m.is_away()));
            if there || i > 0 && (refused.is_some() || self.skipped.iter().any(|s| s.0 == plan)) {
                continue;
            }
            // A parameter's slider asks again before it can be answered. What it asked for first is made and shown, then the
            // last: else nothing would be seen until the hand rests.
            if self.pane == i && self.making.as_ref().is_some_and(|m| m.is_but_for_params(&mesh, &plan, corners)) {
                return;
            }
            let here = plan.is_here(&mesh);
            let making = match self.made(i) {
                Some(made) if made.is(&mesh, &plan, !corners) && !made.is_away() => Ok(Making::again(made, corners)),
                _ if !here && self.kernel.is_none() => {
                    // What is shown stays until the module comes.
                    (self.making, self.pane, self.wants_kernel) = (None, i, true);
                    return;
                }
                _ => {
                    let elsewhere = !(here || corners || all_here);
                    match elsewhere.then(|| self.elsewhere(&mesh, &plan, budget, &parts)).flatten() {
                        Some(making) => Ok(making),
                        None => self
                            .work_on(&mesh, &plan, budget)
                            .map(|work| Making::refine(work, mesh, plan.clone(), corners, parts.clone())),
                    }
                }
            };
            match making {
                Ok(making) => {
                    if self.making.is_none() {
                        self.since = self.clock.now();
                    }
                    (self.making, self.pane) = (Some(making), i);
                    return;
                }
                Err(error) if i == 0 => {
                    self.pane = 0;
                    return self.cannot_show(&error);
                }
                Err(error) => self.skipped.push((plan, error)),
            }
        }
        self.making = None;
        self.progress_over();
        self.overlays();
    }

    /// What refines on the CPU: this module where it can, else the one with every scheme.
    pub(super) fn work_on(&mut self, mesh: &Arc<Mesh>, plan: &Plan, budget: u64) -> Result<Box<dyn Work>, String> {
        match &mut self.kernel {
            Some(kernel) if !plan.is_here(mesh) => kernel.start(mesh, plan, budget),
            _ => match Job::new(mesh.clone(), plan.clone(), budget) {
                Ok(job) => Ok(Box::new(job)),
                Err(error) => Err(error.to_string()),
            },
        }
    }

    /// Lets the GPU refine, or the module with every scheme, into the buffers that are drawn; none if the level has to come here.
    fn elsewhere(&mut self, mesh: &Arc<Mesh>, plan: &Plan, budget: u64, parts: &Arc<Parts>) -> Option<Making> {
        let counts = predict(mesh, plan).ok()??.counts;
        let gpu = self.renderer.gpu();
        let drawing = self.kernel.as_mut()?.draw(mesh, plan, parts.of_faces(), budget, gpu)?;
        let surface = Surface::reserve(gpu, &drawing.shape());
        drawing.run();
        let level = Refined::elsewhere(mesh.clone(), plan.level, counts);
        let filler = Box::new(Elsewhere(drawing));
        Some(Making::wait(filler, surface, level, plan.clone(), parts.clone(), self.clock.now()))
    }

    /// Says that the module with every scheme could not be loaded, and goes back.
    fn cannot_load(&mut self) {
        self.dirty.state = true;
        if self.pane > 0 {
            return self.skip("the scheme could not be loaded; check the connection and choose it again");
        }
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
        if self.pane > 0 {
            return self.skip(why);
        }
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
                    self.renderer.show_in(self.pane, Some(surface));
                    if let Some(slot) = self.pane.checked_sub(1) {
                        if let Some(slot) = self.beside.get_mut(slot) {
                            *slot = Some(made);
                        }
                        return self.sync();
                    }
                    self.times.gpu = making.on_gpu;
                    self.times.refine = making.spent[0];
                    self.times.build = making.spent[1];
                    self.shown = Some(made);
                    self.paint();
                    self.sync();
                    if !self.making_first()
                        && let Some(file) = self.export.take()
                    {
                        self.write(&file);
                    }
                    return;
                }
                Ok(Step::Failed) => return self.sync(),
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
        if self.pane > 0 && (self.making.is_some() || self.wants_kernel) {
            return self.skip("it was stopped; choose a level or a scheme to try again");
        }
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
            let (edges, marks) = lines(&mesh);
            match self.renderer.set_cage(&mesh.positions, &edges, &marks) {
                Ok(()) => self.caged = Some(mesh),
                Err(error) => self.trouble(&error.to_string()),
            }
        }
        for pane in (0..=self.beside.len()).filter(|_| points) {
            let Some(made) = self.made(pane).filter(|_| !self.renderer.has_points(pane)) else { continue };
            let refined = made.refined.clone();
            if let Err(error) = self.renderer.set_points_in(pane, &refined.points) {
                self.trouble(&error.to_string());
            }
        }
    }

    /// A card about drawing that went wrong; the picture stays as good as it is.
    pub(super) fn trouble(&self, error: &str) {
        let title = "Something could not be drawn".to_owned();
        self.card(Card { id: "draw", kind: "error", title, lines: vec![sentence(error)], ..Card::default() });
    }
}

/// Every edge once, by its two vertices, and how wide it is drawn: the wider the sharper. Sharp vertices come behind, as dots.
fn lines(mesh: &Mesh) -> (Vec<[u32; 2]>, Vec<f32>) {
    let t = &mesh.topology;
    let half_edges = (0..t.edges()).map(|e| t.edge_half_edge(e));
    let mut edges: Vec<_> = half_edges.map(|h| [t.origin(h), t.origin(t.next(h))]).collect();
    let width = |sharpness: &f32| (sharpness / INFINITE).min(1.0);
    let mut marks: Vec<f32> = mesh.edge_sharpness.iter().map(width).collect();
    for (sharpness, v) in mesh.vertex_sharpness.iter().zip(0..).filter(|(sharpness, _)| **sharpness > 0.0) {
        marks.resize(edges.len(), 0.0);
        edges.push([v; 2]);
        marks.push(2.0 + width(sharpness));
    }
    (edges, marks)
}
