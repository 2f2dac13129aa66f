//! The document: a source, the commands given since, and the mesh that follows from them.
//!
//! ```text
//!   open SOURCE ── host reads the bytes ──► load(model)      state = source + edits + settings     (shared snapshots)
//!   scheme, level, weld, center ...  ───────────────────►    built mesh, plan                      (derived)
//!   view ...                         ───────────────────►    view                                  (not undone)
//!   text(), link()                   ◄── the fewest commands that lead here
//! ```
//!
//! A command either succeeds or changes nothing: a new state is put together beside the present one, checked (mesh, scheme,
//! predicted bytes against the budget) and only then taken. Replaying [`Document::text`] into a new document gives the same
//! state; tests hold undo and redo to that. Nothing here refines: [`Outcome`] tells the host what to do next, and
//! [`Document::plan`] and [`Document::mesh`] are what it does it with.
//!
//! Only what a command concerns is computed again: `level`, `scheme` and `boundary` keep the mesh, edits and `weld` build a
//! new one from the model as read, in time linear in its corners.

use std::sync::Arc;

use limn_formats::Model;
use limn_formats::parcel::Notice;
use limn_mesh::{Accepts, Mesh, Params, Plan, Prediction, RefineError, Run, Soup, Weld, predict, shape};

use crate::build::{Edit, Remark};
use crate::camera::{Bounds, Standard};
use crate::command::{self, Class, Command, CreaseWhere, VERSION};
use crate::error::CommandError;
use crate::history::History;
use crate::link::{self, LinkError};
use crate::outcome::{Outcome, Replayed};
use crate::source::Source;
use crate::state::{State, check, find_scheme};
use crate::view::{View, ViewSet};
use crate::{compare, parameters};

/// How many of the models opened before the present one undo can bring back.
pub const MODELS_KEPT: usize = 3;

/// What is being opened.
#[derive(Clone, Debug)]
struct Pending {
    source: Source,
    reload: bool,
}

/// A source, the commands given since, and what follows from them. See the module's text.
#[derive(Debug)]
pub struct Document {
    pub(crate) state: Option<State>,
    history: History<State>,
    view: View,
    pending: Option<Pending>,
    pub(crate) budget: u64,
    aspect: f32,
}

impl Document {
    /// A document without a model. `budget` is how many bytes a refined level may take.
    pub fn new(budget: u64) -> Document {
        Document { state: None, history: History::default(), view: View::default(), pending: None, budget, aspect: 1.0 }
    }

    /// Another document with the same model and settings, to try commands on; none without a model. Models are shared.
    pub(crate) fn trial(&self) -> Option<Document> {
        let state = Some(self.state.clone()?);
        Some(Document { state, aspect: self.aspect, ..Document::new(self.budget) })
    }

    /// How many bytes a refined level may take.
    pub fn budget(&self) -> u64 {
        self.budget
    }

    /// Changes the budget. The present level stays, even if it would be refused now.
    pub fn set_budget(&mut self, bytes: u64) {
        self.budget = bytes;
    }

    /// Tells the shape of the viewport, width / height. Named cameras frame the model anew.
    pub fn set_aspect(&mut self, aspect: f32) {
        if aspect.is_finite() && aspect > 0.0 {
            self.aspect = aspect;
            let bounds = self.bounds();
            self.view.camera.refresh(&bounds, aspect);
        }
    }

    /// The viewport's width / height.
    pub fn aspect(&self) -> f32 {
        self.aspect
    }

    /// Runs one command line.
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn run(&mut self, line: &str) -> Result<Outcome, CommandError> {
        let command = line.parse()?;
        self.apply(&command, false)
    }

    /// Runs one command line of a drag that may go on: all of a setting's values in one drag are one undo entry, which
    /// [`Self::run`] of the same setting ends.
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn drag(&mut self, line: &str) -> Result<Outcome, CommandError> {
        let command = line.parse()?;
        self.apply(&command, true)
    }

    /// Runs a command. `drag` as for [`Self::drag`].
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn apply(&mut self, command: &Command, drag: bool) -> Result<Outcome, CommandError> {
        match command {
            Command::Open(source) => self.open(source),
            Command::View(sets) => self.set_view(sets),
            Command::Undo => self.step(|history, state| history.undo(state), CommandError::NothingToUndo),
            Command::Redo => self.step(|history, state| history.redo(state), CommandError::NothingToRedo),
            Command::Reload => self.reload(),
            Command::Version(n) if u32::try_from(*n) == Ok(VERSION) => Ok(Outcome::Nothing),
            Command::Version(n) => Err(CommandError::Version(*n)),
            Command::Help(name) => Ok(Outcome::Help(command::help(*name))),
            Command::Info { json } => self.with_model("info").map(|_| Outcome::Info { json: *json }),
            Command::Export { file } => self.with_model("export").map(|_| Outcome::Export { file: file.clone() }),
            Command::Weld(_)
            | Command::Quads(_)
            | Command::Triangulate
            | Command::Center
            | Command::Scale(_)
            | Command::Scheme { .. }
            | Command::Fair { .. }
            | Command::Crease { .. }
            | Command::Corner { .. }
            | Command::Hole(_)
            | Command::Knot { .. }
            | Command::CreaseDecay(_)
            | Command::TriangleRule(_)
            | Command::FaceVarying(_)
            | Command::Compare(_)
            | Command::Boundary(_)
            | Command::Limit(_)
            | Command::Level(_) => self.change(command, drag),
        }
    }

    fn with_model(&self, command: &'static str) -> Result<&State, CommandError> {
        self.state.as_ref().ok_or(CommandError::NoModel(command))
    }

    fn open(&mut self, source: &Source) -> Result<Outcome, CommandError> {
        let Source::Builtin(name) = source else {
            self.pending = Some(Pending { source: source.clone(), reload: false });
            return Ok(Outcome::Open(source.clone()));
        };
        let shape = shape(name).ok_or_else(|| CommandError::UnknownShape { name: name.clone() })?;
        let model = Model { name: name.clone(), soup: (shape.build)(), ..Model::default() };
        self.replace(State::new(source.clone(), model, &[])?, false);
        self.pending = None;
        Ok(Outcome::Model)
    }

    fn reload(&mut self) -> Result<Outcome, CommandError> {
        let source = self.with_model("reload")?.source.clone();
        if let Source::Builtin(name) = &source {
            return Err(CommandError::NothingToReload(name.clone()));
        }
        self.pending = Some(Pending { source: source.clone(), reload: true });
        Ok(Outcome::Open(source))
    }

    /// The source that [`Outcome::Open`] asked for and [`Self::load`] has not answered yet.
    pub fn pending(&self) -> Option<&Source> {
        self.pending.as_ref().map(|p| &p.source)
    }

    /// Forgets the source asked for: it cannot be read. The model that was there stays.
    pub fn cancel_open(&mut self) {
        self.pending = None;
    }

    /// Takes the model that the host read from `source`: of the name asked for, with the stamp of the bytes as they are.
    ///
    /// It replaces the present model and everything done to it, and undo brings that back. After `reload` everything done is
    /// done again to the new bytes; a level that no longer fits the budget is lowered, and a remark says so.
    ///
    /// # Errors
    /// A file other than the one that a link or script asks for (by size or hash), or polygons that make no mesh. The
    /// present model stays, and in the first case the document still waits.
    pub fn load(&mut self, source: Source, model: Model, notices: &[Notice]) -> Result<Outcome, CommandError> {
        let reload = match &self.pending {
            Some(Pending { source: asked, reload: false }) => {
                if let (Some(a), Some(b)) = (asked.stamp(), source.stamp()) {
                    let differs = if a.size != b.size {
                        Some(format!("size is {} bytes, not {}", b.size, a.size))
                    } else {
                        (a.hash != b.hash).then(|| "content has changed".to_owned())
                    };
                    if let Some(differs) = differs {
                        return Err(CommandError::OtherFile { name: source.name().to_owned(), differs });
                    }
                }
                false
            }
            Some(Pending { reload, .. }) => *reload,
            None => false,
        };
        self.pending = None;
        let mut state = State::new(source, model, notices)?;
        let before = self.state.as_ref().filter(|_| reload);
        if let Some(before) = before {
            state.edits = before.edits.clone();
            state.settings = before.settings.clone();
            state.rebuild()?;
            if let Err(error) = state.settle(self.budget) {
                let CommandError::Refine(RefineError::TooLarge { fits, .. }) = error else { return Err(error) };
                state.settings.level = fits;
                state.settle(self.budget)?;
                state.adapted = Some(Remark::new(&format!("{error}; it is shown at level {fits}"), false));
            }
        }
        let view = self.view.clone();
        self.replace(state, reload);
        if reload {
            self.view = view;
            let (bounds, aspect) = (self.bounds(), self.aspect);
            self.view.camera.refresh(&bounds, aspect);
        }
        Ok(Outcome::Model)
    }

    /// Takes a state with another model, or with the same one read again.
    fn replace(&mut self, state: State, reload: bool) {
        if let Some(before) = self.state.replace(state.clone()) {
            let step = if reload { "reload".to_owned() } else { format!("open {}", state.source.name()) };
            self.history.record(before, &state, "open", step, false, State::same);
            self.trim();
        }
        self.reset_view();
    }

    /// Lets go of models that are too far back.
    fn trim(&mut self) {
        let mut seen: Vec<*const Model> = Vec::new();
        self.history.forget_up_to(|state| {
            let model = Arc::as_ptr(&state.model);
            if seen.last() != Some(&model) {
                seen.push(model);
            }
            seen.len() > MODELS_KEPT
        });
    }

    /// Shows another model from the home direction, all groups shown. What else the person chose stays.
    fn reset_view(&mut self) {
        let (bounds, aspect) = (self.bounds(), self.aspect);
        self.view.hidden.clear();
        self.view.camera.set_standard(Standard::Home, &bounds, aspect);
    }

    fn set_view(&mut self, sets: &[ViewSet]) -> Result<Outcome, CommandError> {
        let groups = self.state.as_ref().map_or(&[][..], |s| &s.model.groups);
        for set in sets {
            if let ViewSet::Hide(names) = set
                && let Some(name) = names.iter().find(|name| !groups.contains(name))
            {
                let groups = groups.iter().take(12).cloned().collect();
                return Err(CommandError::UnknownGroup { name: name.clone(), groups });
            }
        }
        let (bounds, aspect) = (self.bounds(), self.aspect);
        let before = self.view.clone();
        sets.iter().for_each(|set| self.view.set(set, &bounds, aspect));
        Ok(if before == self.view { Outcome::Nothing } else { Outcome::View })
    }

    fn step(
        &mut self,
        step: impl FnOnce(&mut History<State>, &State) -> Option<State>,
        nothing: CommandError,
    ) -> Result<Outcome, CommandError> {
        let Some(before) = self.state.clone() else { return Err(nothing) };
        let after = step(&mut self.history, &before).ok_or(nothing)?;
        self.state = Some(after.clone());
        if !Arc::ptr_eq(&before.model, &after.model) {
            self.reset_view();
        }
        Ok(self.compare(&before, &after))
    }

    /// What going from one state to another means for the host. A camera follows a model that was moved or resized.
    fn compare(&mut self, before: &State, after: &State) -> Outcome {
        if Arc::ptr_eq(&before.built, &after.built) {
            let same = before.plan() == after.plan() && before.settings.beside == after.settings.beside;
            return if same { Outcome::Nothing } else { Outcome::Refine };
        }
        if before.built.bounds != after.built.bounds {
            let (bounds, aspect) = (after.built.bounds, self.aspect);
            self.view.camera.follow(&before.built.bounds, &bounds, aspect);
        }
        Outcome::Model
    }

    /// Runs a command that makes a new state of the same model.
    fn change(&mut self, command: &Command, drag: bool) -> Result<Outcome, CommandError> {
        let before = self.with_model(command.name())?.clone();
        let mut after = State { adapted: None, ..before.clone() };
        let settings = &mut after.settings;
        match command {
            // What the format has anyway needs no word in the text.
            Command::Weld(weld) => settings.weld = Some(*weld).filter(|w| *w != before.model.weld),
            Command::Quads(on) => {
                settings.quads = *on;
                if *on && matches!(settings.accepts(), Accepts::Triangles | Accepts::TrianglesThenQuads) {
                    settings.scheme = find_scheme("catmull-clark")?;
                    settings.params = Params::default();
                    settings.later.clear();
                }
            }
            Command::Triangulate => Arc::make_mut(&mut after.edits).push(Edit::Triangulate),
            Command::Center => Arc::make_mut(&mut after.edits).push(Edit::Center),
            Command::Scale(factor) => Arc::make_mut(&mut after.edits).push(Edit::Scale(*factor)),
            Command::Scheme { id, parameters } => {
                let (from, parameters) = parameters::level(parameters, "from")?;
                let entry = find_scheme(id)?;
                let run = Run { from, scheme: entry, params: parameters::read(&entry.info, &parameters)? };
                let present = before.plan().run(0);
                // A slider on its way past another pane's value leaves that alone.
                if let Some(pane) = settings.beside.iter_mut().find(|pane| **pane == run && !drag) {
                    *pane = present;
                }
                settings.set_scheme(run);
            }
            Command::Fair { iterations, parameters } => {
                settings.set_fairing(parameters::fairing(*iterations, parameters)?)
            }
            Command::Crease { place, sharpness } => {
                before.check_crease(place)?;
                Arc::make_mut(&mut after.edits).push(Edit::Crease(place.clone(), *sharpness));
            }
            Command::Corner { vertex, sharpness } => {
                before.check_vertex(*vertex)?;
                Arc::make_mut(&mut after.edits).push(Edit::Corner(*vertex, *sharpness));
            }
            Command::Hole(face) => {
                before.check_face(*face)?;
                Arc::make_mut(&mut after.edits).push(Edit::Hole(*face));
            }
            Command::Knot { ends, both, interval } => {
                before.check_crease(&CreaseWhere::Chain(ends.to_vec()))?;
                Arc::make_mut(&mut after.edits).push(Edit::Knot(*ends, *both, *interval));
            }
            Command::Compare(panes) => {
                let present = before.settings.later.is_empty().then(|| before.plan().run(0));
                settings.beside = compare::list(panes, present)?;
            }
            Command::Boundary(boundary) => settings.rules.boundary = *boundary,
            Command::Limit(on) => settings.limit = *on,
            Command::CreaseDecay(decay) => settings.rules.decay = *decay,
            Command::TriangleRule(rule) => settings.rules.triangle = *rule,
            Command::FaceVarying(rule) => settings.rules.face_varying = *rule,
            Command::Level(n) => {
                settings.level = u32::try_from(*n).map_err(|_| CommandError::NegativeLevel(*n))?;
            }
            _ => return Ok(Outcome::Nothing),
        }
        let rebuild = before.edits != after.edits
            || before.settings.quads != after.settings.quads
            || before.settings.weld.unwrap_or(before.model.weld) != after.settings.weld.unwrap_or(after.model.weld);
        if rebuild {
            after.rebuild()?;
        }
        after.settle(self.budget)?;
        // Dragging one scheme's parameter is not what dragging another's is. Ids are no commands' names.
        let name = match command {
            Command::Scheme { .. } => after.settings.scheme.info.id,
            _ => command.name(),
        };
        self.history.record(before.clone(), &after, name, command.to_string(), drag, State::same);
        self.state = Some(after.clone());
        Ok(self.compare(&before, &after))
    }

    /// Runs commands one after the other, into a new document as a rule, up to the end or a source that the host has to
    /// read. At the end there is nothing to undo: what is replayed has been done.
    ///
    /// # Errors
    /// The first command that fails; those before it have been run.
    pub fn replay(&mut self, commands: &[Command]) -> Result<Replayed, CommandError> {
        for (i, command) in commands.iter().enumerate() {
            if let Outcome::Open(source) = self.apply(command, false)? {
                let rest = commands.get(i + 1..).unwrap_or_default().to_vec();
                return Ok(Replayed::Waiting { source, rest });
            }
        }
        self.history = History::default();
        Ok(Replayed::Done)
    }

    /// The commands of a link's fragment, for [`Self::replay`] into a new document.
    ///
    /// # Errors
    /// [`LinkError`] names the part that cannot be read.
    pub fn from_link(fragment: &str) -> Result<Vec<Command>, LinkError> {
        link::read(fragment)
    }

    /// The mesh that is refined, if a model is open: triangulated if the scheme needs that.
    pub fn mesh(&self) -> Option<&Arc<Mesh>> {
        self.state.as_ref().map(|s| &s.built.mesh)
    }

    /// Whether some of its edges or vertices are semi-sharp.
    pub fn has_semi_sharp(&self) -> bool {
        self.state.as_ref().is_some_and(|s| s.built.marks.semi_sharp)
    }

    /// The model's own polygons, whatever the scheme makes of them first: marks are of them.
    pub fn polygons(&self) -> Option<&Arc<Mesh>> {
        self.state.as_ref().map(|s| &s.base.polygons.mesh)
    }

    /// The polygons that the mesh was built from; `mesh().face_source` counts its faces. Groups and materials are there.
    pub fn soup(&self) -> Option<&Soup> {
        self.state.as_ref().map(|s| s.built.soup(&s.model))
    }

    /// The model as read: names of groups, materials, pictures.
    pub fn model(&self) -> Option<&Arc<Model>> {
        self.state.as_ref().map(|s| &s.model)
    }

    /// Where the model came from.
    pub fn source(&self) -> Option<&Source> {
        self.state.as_ref().map(|s| &s.source)
    }

    /// Scheme, boundary rule and level, if a model is open.
    pub fn plan(&self) -> Option<Plan> {
        self.state.as_ref().map(State::plan)
    }

    /// Whether triangles are paired to quads, and how positions are welded.
    pub fn reading(&self) -> Option<(bool, Weld)> {
        self.state.as_ref().map(|s| (s.settings.quads, s.settings.weld.unwrap_or(s.model.weld)))
    }

    /// What `level` would take under the present scheme: for the slider's ticks. `None` without a model, or if the counts
    /// leave 64 bits. Cost: constant.
    pub fn predict(&self, level: u32) -> Option<Prediction> {
        let state = self.state.as_ref()?;
        predict(&state.built.mesh, &state.plan().to(level)).ok().flatten()
    }

    /// The highest level that fits the budget under the present scheme; 0 without a model.
    pub fn highest_level(&self) -> u32 {
        let fits = |level: &u32| {
            self.state.as_ref().is_some_and(|s| check(&s.built.mesh, &s.plan().to(*level), self.budget).is_ok())
        };
        (1..=32).take_while(fits).last().unwrap_or(0)
    }

    /// How the model is shown.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The view to change in place, for gestures.
    pub fn view_mut(&mut self) -> &mut View {
        &mut self.view
    }

    /// The box of level 0, which the camera frames; the unit box without a model.
    pub fn bounds(&self) -> Bounds {
        self.state.as_ref().map_or_else(Bounds::default, |s| s.built.bounds)
    }

    /// How many steps can be taken back and done again.
    pub fn undo_depth(&self) -> (usize, usize) {
        self.history.depth()
    }

    /// What `undo` would take back and `redo` would do again, in a few words such as `level 3` or `open cow.obj`.
    pub fn undo_steps(&self) -> (Option<&str>, Option<&str>) {
        self.history.steps()
    }

    /// Whether a command changes the document, so that text and link are worth saving after it.
    pub fn changes(command: &Command) -> bool {
        command.class() != Class::Action || matches!(command, Command::Undo | Command::Redo)
    }
}
