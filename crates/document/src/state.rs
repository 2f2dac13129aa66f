//! One state of a document: what undo brings back, and what all else follows from.
//!
//! Cloning is cheap: the model, its edits and the built meshes are shared. A new state is put together beside the present
//! one and settled (the scheme's mesh chosen, the level checked against the budget) before it is taken.

use std::sync::Arc;

use limn_formats::Model;
use limn_formats::parcel::Notice;
use limn_mesh::{
    Accepts, Boundary, Entry, Fairing, Job, Mesh, Params, Plan, RefineError, Rules, Run, Weld, predict, scheme,
};

use crate::build::{Base, BuildError, Built, Edit, Remark};
use crate::command::Command;
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
    /// Schemes of later steps.
    pub later: Vec<Run>,
    pub rules: Rules,
    pub fairings: Vec<Fairing>,
    pub limit: bool,
    pub level: u32,
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

    /// Chooses the mesh that the scheme takes and checks the level against the budget.
    pub fn settle(&mut self, budget: u64) -> Result<(), CommandError> {
        self.built = match self.settings.scheme.info.accepts {
            Accepts::Triangles => self.base.triangles(&self.model)?,
            Accepts::Polygons | Accepts::Both => self.base.polygons.clone(),
        };
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
        }));
        commands.push(parameters::command(&self.plan()));
        commands.extend((s.rules.boundary != Boundary::default()).then_some(Command::Boundary(s.rules.boundary)));
        commands.extend(s.limit.then_some(Command::Limit(true)));
        commands.push(Command::Level(i32::try_from(s.level).unwrap_or(i32::MAX)));
        commands
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
