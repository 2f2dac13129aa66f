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

use limn_formats::{Model, Warning};
use limn_mesh::{
    Accepts, Boundary, Entry, Job, Mesh, Plan, Prediction, RefineError, SCHEMES, SHAPES, Soup, Weld, predict, scheme,
    shape,
};

use crate::build::{Base, BuildError, Built, Edit, Remark};
use crate::camera::Bounds;
use crate::command::{self, Class, Command, ParseError, VERSION};
use crate::history::History;
use crate::link::{self, LinkError};
use crate::source::Source;
use crate::view::{View, ViewSet};

/// How many of the models opened before the present one undo can bring back.
pub const MODELS_KEPT: usize = 3;

/// What the host has to do after a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Nothing changed.
    Nothing,
    /// The picture changed, the surface did not: draw again.
    View,
    /// The plan changed, the mesh did not: refine again.
    Refine,
    /// The mesh changed (the plan may have, too): forget what was derived, refine again.
    Model,
    /// Read this source and answer with [`Document::load`], or with [`Document::cancel_open`] if it cannot be read.
    /// Built-in models never ask.
    Open(Source),
    /// Write the present level to this file.
    Export {
        /// The name that the command gave.
        file: String,
    },
    /// Tell about the present level, see [`Document::info`](crate::info).
    Info {
        /// As a JSON object.
        json: bool,
    },
    /// Show this text.
    Help(String),
}

/// Why a command did nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CommandError {
    /// The text is no command.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// The text is no link.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// No model is open.
    #[error("`{0}` needs a model; open one first, as in `open builtin:cube`")]
    NoModel(&'static str),
    /// There is no such built-in model.
    #[error("there is no built-in model `{name}`; there are {}", shape_names())]
    UnknownShape {
        /// The name asked for.
        name: String,
    },
    /// There is no such scheme.
    #[error("there is no scheme `{id}`; there are {}", scheme_ids())]
    UnknownScheme {
        /// The id asked for.
        id: String,
    },
    /// The scheme does not take this parameter.
    #[error("the scheme {scheme} has no parameter `{key}`; it takes none")]
    UnknownParameter {
        /// The scheme's id.
        scheme: &'static str,
        /// The key given.
        key: String,
    },
    /// A level below the model itself.
    #[error("there is no level {0}: level 0 is the model itself and the lowest")]
    NegativeLevel(i32),
    /// The polygons make no mesh.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The level does not fit the budget.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// Nothing to take back.
    #[error("there is nothing to undo")]
    NothingToUndo,
    /// Nothing to do again.
    #[error("there is nothing to redo")]
    NothingToRedo,
    /// A built-in model has no file.
    #[error("{0} is built in and has no file to read again")]
    NothingToReload(String),
    /// The file read is not the one asked for.
    #[error("this `{name}` is not the file that was opened before: its {differs}; open it as a new model instead")]
    OtherFile {
        /// The file's name.
        name: String,
        /// What is different: "size is 12 bytes, not 10".
        differs: String,
    },
    /// A script in another version of the grammar.
    #[error("version {0} of the commands is not known; this program knows version {VERSION}")]
    Version(i32),
    /// A view command hides a group that the model does not have.
    #[error("the model has no group `{name}`{}", group_names(.groups))]
    UnknownGroup {
        /// The name given.
        name: String,
        /// The first few groups that there are.
        groups: Vec<String>,
    },
}

impl CommandError {
    /// Whether the budget refused the command; the same command works with a higher one.
    pub fn is_budget(&self) -> bool {
        matches!(self, CommandError::Refine(RefineError::TooLarge { .. }))
    }
}

fn shape_names() -> String {
    SHAPES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ")
}

fn scheme_ids() -> String {
    SCHEMES.iter().map(|s| s.info.id).collect::<Vec<_>>().join(", ")
}

fn group_names(groups: &[String]) -> String {
    if groups.is_empty() { "; it has no groups".into() } else { format!("; it has {}", groups.join(", ")) }
}

/// What `settings` of the last-wins kind are set to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    /// None is the model's own.
    weld: Option<Weld>,
    quads: bool,
    scheme: &'static Entry,
    boundary: Boundary,
    level: u32,
}

/// One state of the document, sharing what it has in common with others.
#[derive(Clone, Debug)]
struct State {
    source: Source,
    model: Arc<Model>,
    imported: Arc<[Remark]>,
    edits: Arc<Vec<Edit>>,
    settings: Settings,
    base: Arc<Base>,
    /// What the scheme refines: of `base`.
    built: Arc<Built>,
    /// Something that was changed to make the state possible.
    adapted: Option<Remark>,
}

impl State {
    fn new(source: Source, model: Model, warnings: &[Warning]) -> Result<State, CommandError> {
        let model = Arc::new(model);
        let base = Arc::new(Base::build(&model, false, &[], model.weld)?);
        let scheme = find_scheme(if base.polygons.mesh.is_triangles() { "loop" } else { "catmull-clark" })?;
        let settings = Settings { weld: None, quads: false, scheme, boundary: Boundary::default(), level: 0 };
        let imported = warnings.iter().map(|w| Remark::new(&w.to_string(), w.is_minor())).collect();
        let built = base.polygons.clone();
        Ok(State { source, model, imported, edits: Arc::default(), settings, base, built, adapted: None })
    }

    fn plan(&self) -> Plan {
        Plan { scheme: self.settings.scheme, boundary: self.settings.boundary, level: self.settings.level }
    }

    /// Whether the two lead to the same picture and the same text.
    fn same(&self, other: &State) -> bool {
        self.source == other.source
            && Arc::ptr_eq(&self.model, &other.model)
            && self.edits == other.edits
            && self.settings == other.settings
    }

    /// Runs the pipeline again from the model.
    fn rebuild(&mut self) -> Result<(), BuildError> {
        let weld = self.settings.weld.unwrap_or(self.model.weld);
        self.base = Arc::new(Base::build(&self.model, self.settings.quads, &self.edits, weld)?);
        Ok(())
    }

    /// Chooses the mesh that the scheme takes and checks the level against the budget.
    fn settle(&mut self, budget: u64) -> Result<(), CommandError> {
        self.built = match self.settings.scheme.info.accepts {
            Accepts::Triangles => self.base.triangles(&self.model)?,
            Accepts::Polygons | Accepts::Both => self.base.polygons.clone(),
        };
        check(&self.built.mesh, self.plan(), budget)?;
        Ok(())
    }

    /// The commands that lead here from nothing.
    fn commands(&self) -> Vec<Command> {
        let s = &self.settings;
        let mut commands = vec![Command::Open(self.source.clone())];
        commands.extend(s.weld.map(Command::Weld));
        commands.extend(s.quads.then_some(Command::Quads(true)));
        commands.extend(self.edits.iter().map(|edit| match edit {
            Edit::Triangulate => Command::Triangulate,
            Edit::Center => Command::Center,
            Edit::Scale(factor) => Command::Scale(*factor),
        }));
        commands.push(Command::Scheme { id: s.scheme.info.id.to_owned(), parameters: Vec::new() });
        commands.extend((s.boundary != Boundary::default()).then_some(Command::Boundary(s.boundary)));
        commands.push(Command::Level(i32::try_from(s.level).unwrap_or(i32::MAX)));
        commands
    }
}

fn find_scheme(id: &str) -> Result<&'static Entry, CommandError> {
    scheme(id).ok_or_else(|| CommandError::UnknownScheme { id: id.to_owned() })
}

/// Refuses a plan that does not fit, with numbers. Cost: constant.
fn check(mesh: &Arc<Mesh>, plan: Plan, budget: u64) -> Result<(), RefineError> {
    match predict(mesh, &plan)? {
        // The kernel's own check also counts what 32 bits can number, and words the refusal.
        Some(p) if p.bytes <= budget && p.counts.corners < 1 << 31 => Ok(()),
        _ => Job::new(mesh.clone(), plan, budget).map(drop),
    }
}

/// What is being opened.
#[derive(Clone, Debug)]
struct Pending {
    source: Source,
    reload: bool,
}

/// What [`Document::replay`] came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Replayed {
    /// The end.
    Done,
    /// A source that the host has to read: after [`Document::load`], go on with the rest.
    Waiting {
        /// What to read.
        source: Source,
        /// The commands still to come.
        rest: Vec<Command>,
    },
}

/// A source, the commands given since, and what follows from them. See the module's text.
#[derive(Debug)]
pub struct Document {
    state: Option<State>,
    history: History<State>,
    view: View,
    pending: Option<Pending>,
    budget: u64,
    aspect: f32,
}

impl Document {
    /// A document without a model. `budget` is how many bytes a refined level may take.
    pub fn new(budget: u64) -> Document {
        Document { state: None, history: History::default(), view: View::default(), pending: None, budget, aspect: 1.0 }
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
            | Command::Boundary(_)
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
        self.replace(State::new(source.clone(), model, &[])?);
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
    pub fn load(&mut self, source: Source, model: Model, warnings: &[Warning]) -> Result<Outcome, CommandError> {
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
        let mut state = State::new(source, model, warnings)?;
        let before = self.state.as_ref().filter(|_| reload);
        if let Some(before) = before {
            state.edits = before.edits.clone();
            state.settings = before.settings;
            state.rebuild()?;
            if let Err(error) = state.settle(self.budget) {
                let CommandError::Refine(RefineError::TooLarge { fits, .. }) = error else { return Err(error) };
                state.settings.level = fits;
                state.settle(self.budget)?;
                state.adapted = Some(Remark::new(&format!("{error}; it is shown at level {fits}"), false));
            }
        }
        let view = self.view.clone();
        self.replace(state);
        if reload {
            self.view = view;
            let (bounds, aspect) = (self.bounds(), self.aspect);
            self.view.camera.refresh(&bounds, aspect);
        }
        Ok(Outcome::Model)
    }

    /// Takes a state with another model.
    fn replace(&mut self, state: State) {
        if let Some(before) = self.state.replace(state.clone()) {
            self.history.record(before, &state, "open", false, State::same);
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
        self.view.camera.set_standard(crate::camera::Standard::Home, &bounds, aspect);
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
            return if before.plan() == after.plan() { Outcome::Nothing } else { Outcome::Refine };
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
            Command::Weld(weld) => settings.weld = Some(*weld),
            Command::Quads(on) => {
                settings.quads = *on;
                if *on && settings.scheme.info.accepts == Accepts::Triangles {
                    settings.scheme = find_scheme("catmull-clark")?;
                }
            }
            Command::Triangulate => Arc::make_mut(&mut after.edits).push(Edit::Triangulate),
            Command::Center => Arc::make_mut(&mut after.edits).push(Edit::Center),
            Command::Scale(factor) => Arc::make_mut(&mut after.edits).push(Edit::Scale(*factor)),
            Command::Scheme { id, parameters } => {
                let entry = find_scheme(id)?;
                if let Some((key, _)) = parameters.first() {
                    return Err(CommandError::UnknownParameter { scheme: entry.info.id, key: key.clone() });
                }
                settings.scheme = entry;
            }
            Command::Boundary(boundary) => settings.boundary = *boundary,
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
        self.history.record(before.clone(), &after, command.name(), drag, State::same);
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
        predict(&state.built.mesh, &Plan { level, ..state.plan() }).ok().flatten()
    }

    /// The highest level that fits the budget under the present scheme; 0 without a model.
    pub fn highest_level(&self) -> u32 {
        let fits = |level: &u32| {
            self.state
                .as_ref()
                .is_some_and(|s| check(&s.built.mesh, Plan { level: *level, ..s.plan() }, self.budget).is_ok())
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

    /// What there is to say about the model: from the file, from building the mesh, from what was changed for the scheme.
    pub fn remarks(&self) -> Vec<Remark> {
        let Some(state) = &self.state else { return Vec::new() };
        let mut remarks = state.imported.to_vec();
        remarks.extend(state.adapted.clone());
        let polygons = &state.base.polygons.remarks;
        remarks.extend(polygons.iter().cloned());
        if !Arc::ptr_eq(&state.base.polygons, &state.built) {
            // Building the triangles meets the same trouble again: only what is new is said.
            remarks.extend(state.built.remarks.iter().filter(|r| !polygons.contains(r)).cloned());
        }
        remarks
    }

    /// How many steps can be taken back and done again.
    pub fn undo_depth(&self) -> (usize, usize) {
        self.history.depth()
    }

    /// The fewest commands that lead here from an empty document; empty without a model.
    pub fn commands(&self) -> Vec<Command> {
        let Some(state) = &self.state else { return Vec::new() };
        let mut commands = state.commands();
        let view = self.view.settings();
        if !view.is_empty() {
            commands.push(Command::View(view));
        }
        commands
    }

    /// [`Self::commands`] as a script, a line each behind the grammar's version. What crash recovery keeps.
    pub fn text(&self) -> String {
        let mut text = format!("version {VERSION}\n");
        for command in self.commands() {
            text.push_str(&command.to_string());
            text.push('\n');
        }
        text
    }

    /// [`Self::commands`] as the fragment of an address, with its `#`; empty without a model.
    pub fn link(&self) -> String {
        if self.state.is_none() {
            return String::new();
        }
        link::write(self.commands().iter().map(Command::to_string))
    }

    /// Whether a command changes the document, so that text and link are worth saving after it.
    pub fn changes(command: &Command) -> bool {
        command.class() != Class::Action || matches!(command, Command::Undo | Command::Redo)
    }
}
