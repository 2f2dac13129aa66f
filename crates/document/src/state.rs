//! One state of a document: what undo brings back, and what all else follows from.
//!
//! Cloning is cheap: the model, its edits and the built meshes are shared. A new state is put together beside the present
//! one and settled (the scheme's mesh chosen, the level checked against the budget) before it is taken.

use std::sync::Arc;

use limn_formats::Model;
use limn_formats::parcel::Notice;
use limn_mesh::{Accepts, Entry, Fairing, Job, Mesh, Params, Plan, RefineError, Rules, Run, Weld, predict, scheme};

use crate::build::{Base, BuildError, Built, Edit, Remark};
use crate::command::{Command, CreaseWhere};
use crate::error::CommandError;
use crate::parameters;
use crate::source::Source;

/// What `settings` of the last-wins kind are set to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Settings {
    /// None is the model's own.
    pub weld: Option<Weld>,
    pub quads: bool,
    pub scheme: &'static Entry,
    pub params: Params,
    /// Schemes shown beside it, all different.
    pub beside: Vec<Run>,
    /// Schemes of later steps.
    pub later: Vec<Run>,
    pub rules: Rules,
    pub fairings: Vec<Fairing>,
    pub limit: bool,
    pub level: u32,
}

impl Settings {
    /// The faces that the scheme takes, with its parameters.
    pub fn accepts(&self) -> Accepts {
        let info = &self.scheme.info;
        info.behind(&self.params.of(info)).accepts
    }
}

/// One state of the document, sharing what it has in common with others.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub source: Source,
    pub model: Arc<Model>,
    pub imported: Arc<[Remark]>,
    pub edits: Arc<Vec<Edit>>,
    pub settings: Settings,
    pub base: Arc<Base>,
    /// What the scheme refines: of `base`.
    pub built: Arc<Built>,
    /// Something that was changed to make the state possible.
    pub adapted: Option<Remark>,
}

impl State {
    pub fn new(source: Source, model: Model, notices: &[Notice]) -> Result<State, CommandError> {
        let model = Arc::new(model);
        let base = Arc::new(Base::build(&model, false, &[], model.weld)?);
        let scheme = find_scheme(if base.polygons.mesh.is_triangles() { "loop" } else { "catmull-clark" })?;
        let settings = Settings {
            weld: None,
            quads: false,
            scheme,
            params: Params::default(),
            beside: Vec::new(),
            later: Vec::new(),
            rules: Rules::default(),
            fairings: Vec::new(),
            limit: false,
            level: 0,
        };
        let imported = notices.iter().map(|n| Remark::new(&n.text, n.minor)).collect();
        let built = base.polygons.clone();
        Ok(State { source, model, imported, edits: Arc::default(), settings, base, built, adapted: None })
    }

    pub fn plan(&self) -> Plan {
        let Settings { scheme, params, later, rules, fairings, limit, level, .. } = self.settings.clone();
        Plan { scheme, params, later, rules, fairings, limit, level }
    }

    /// Whether the two lead to the same picture and the same text.
    pub fn same(&self, other: &State) -> bool {
        self.source == other.source
            && Arc::ptr_eq(&self.model, &other.model)
            && self.edits == other.edits
            && self.settings == other.settings
    }

    /// Runs the pipeline again from the model.
    pub fn rebuild(&mut self) -> Result<(), BuildError> {
        let weld = self.settings.weld.unwrap_or(self.model.weld);
        self.base = Arc::new(Base::build(&self.model, self.settings.quads, &self.edits, weld)?);
        Ok(())
    }

    /// The mesh that a plan's first scheme takes.
    pub fn takes(&self, plan: &Plan) -> Result<Arc<Built>, BuildError> {
        let info = &plan.scheme.info;
        match info.behind(&plan.params.of(info)).accepts {
            Accepts::Triangles | Accepts::TrianglesThenQuads => self.base.triangles(&self.model),
            Accepts::Polygons | Accepts::Both => Ok(self.base.polygons.clone()),
        }
    }

    /// Chooses the mesh that the scheme takes and checks the level against the budget.
    pub fn settle(&mut self, budget: u64) -> Result<(), CommandError> {
        self.built = self.takes(&self.plan())?;
        check(&self.built.mesh, &self.plan(), budget)?;
        Ok(())
    }

    /// The commands that lead here from nothing.
    pub fn commands(&self) -> Vec<Command> {
        let s = &self.settings;
        let mut commands = vec![Command::Open(self.source.clone())];
        commands.extend(s.weld.map(Command::Weld));
        commands.extend(s.quads.then_some(Command::Quads(true)));
        commands.extend(self.edits.iter().map(|edit| match edit {
            Edit::Triangulate => Command::Triangulate,
            Edit::Center => Command::Center,
            Edit::Scale(factor) => Command::Scale(*factor),
            Edit::Crease(place, sharpness) => Command::Crease { place: place.clone(), sharpness: *sharpness },
            Edit::Corner(vertex, sharpness) => Command::Corner { vertex: *vertex, sharpness: *sharpness },
            Edit::Hole(face) => Command::Hole(*face),
            Edit::Knot(ends, both, interval) => Command::Knot { ends: *ends, both: *both, interval: *interval },
        }));
        let plan = self.plan();
        commands.push(parameters::command(&plan));
        commands.extend(s.later.iter().map(parameters::run_command));
        commands.extend(s.fairings.iter().map(|f| Command::Fair {
            iterations: f.iterations as i32,
            parameters: if f.at > 0 { vec![("at".to_owned(), f.at.to_string())] } else { Vec::new() },
        }));
        let (rules, default) = (s.rules, Rules::default());
        commands.extend((rules.boundary != default.boundary).then_some(Command::Boundary(rules.boundary)));
        commands.extend((rules.decay != default.decay).then_some(Command::CreaseDecay(rules.decay)));
        commands.extend((rules.triangle != default.triangle).then_some(Command::TriangleRule(rules.triangle)));
        commands
            .extend((rules.face_varying != default.face_varying).then_some(Command::FaceVarying(rules.face_varying)));
        commands.extend(s.limit.then_some(Command::Limit(true)));
        // What passes through the present scheme's parameters shows nothing else than that does.
        let same = |pane: &&Run| s.later.is_empty() && **pane == plan.run(0);
        let beside: Vec<_> = s.beside.iter().filter(|pane| !same(pane)).map(parameters::words).collect();
        if !beside.is_empty() {
            commands.push(Command::Compare(beside));
        }
        commands.push(Command::Level(i32::try_from(s.level).unwrap_or(i32::MAX)));
        commands
    }
}

impl Settings {
    /// Lets a scheme take over: all steps from its first on are its own. The scheme that is there already is given other
    /// parameters, and what comes after it stays.
    pub fn set_scheme(&mut self, run: Run) {
        let same = |from: u32, scheme: &Entry| from == run.from && *scheme == *run.scheme;
        if run.from == 0 {
            if !same(0, self.scheme) {
                self.later.clear();
            }
            (self.scheme, self.params) = (run.scheme, run.params);
        } else if let Some(there) = self.later.iter_mut().find(|r| same(r.from, r.scheme)) {
            there.params = run.params;
        } else {
            self.later.retain(|r| r.from < run.from);
            self.later.push(run);
        }
        // A scheme does not take over from itself.
        let mut before = (self.scheme, self.params);
        self.later.retain(|r| std::mem::replace(&mut before, (r.scheme, r.params)) != (r.scheme, r.params));
    }

    /// Fairs a level so, in place of how it was faired.
    pub fn set_fairing(&mut self, fairing: Fairing) {
        self.fairings.retain(|f| f.at != fairing.at);
        if fairing.iterations > 0 {
            let at = self.fairings.partition_point(|f| f.at < fairing.at);
            self.fairings.insert(at, fairing);
        }
    }
}

/// What a command names has to be there.
impl State {
    pub fn check_vertex(&self, index: u32) -> Result<(), CommandError> {
        let count = self.base.polygons.soup(&self.model).positions.len();
        if (index as usize) < count { Ok(()) } else { Err(CommandError::NoElement { what: "vertex", index, count }) }
    }

    pub fn check_face(&self, index: u32) -> Result<(), CommandError> {
        let count = self.base.polygons.soup(&self.model).face_count();
        if (index as usize) < count { Ok(()) } else { Err(CommandError::NoElement { what: "face", index, count }) }
    }

    pub fn check_crease(&self, place: &CreaseWhere) -> Result<(), CommandError> {
        let CreaseWhere::Chain(vertices) = place else { return Ok(()) };
        for two in vertices.windows(2) {
            let &[a, b] = two else { continue };
            self.check_vertex(a)?;
            self.check_vertex(b)?;
            if self.base.polygons.mesh.edge_between(a, b).is_none() {
                return Err(CommandError::NoEdge(a, b));
            }
        }
        Ok(())
    }
}

pub(crate) fn find_scheme(id: &str) -> Result<&'static Entry, CommandError> {
    scheme(id).ok_or_else(|| CommandError::UnknownScheme { id: id.to_owned() })
}

/// Refuses a plan that does not fit, with numbers. Cost: constant.
pub(crate) fn check(mesh: &Arc<Mesh>, plan: &Plan, budget: u64) -> Result<(), RefineError> {
    match predict(mesh, plan)? {
        // The kernel's own check also counts what 32 bits can number, and words the refusal.
        Some(p) if p.bytes <= budget && p.counts.corners < 1 << 31 => Ok(()),
        _ => Job::new(mesh.clone(), plan.clone(), budget).map(drop),
    }
}
