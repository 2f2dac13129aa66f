//! Schemes side by side: up to three beside the present one, on the same model, level and rules.
//!
//! ```text
//!   scheme loop            ┌ loop ────┐┌ butterfly ┐      compare butterfly sqrt3
//!   level 3                │ level 3  ││ level 3   │ ...
//!                          └──────────┘└───────────┘
//! ```
//!
//! The present scheme is the first pane, and all that acts on one surface acts on it. Another pane never refuses a command:
//! one that the memory left by those before it does not hold, or whose scheme cannot take the model, says why instead.
//! Choosing a pane's scheme makes the two change places. Cost: a prediction a pane.

use std::sync::Arc;

use limn_mesh::{Mesh, Plan, Run, predict};

use crate::command::SchemeWords;
use crate::document::Document;
use crate::error::CommandError;
use crate::parameters;
use crate::state::check;

/// The most schemes beside the present one.
pub const MOST_BESIDE: usize = 3;

/// One scheme of several that are shown.
#[derive(Clone, Debug)]
pub struct Pane {
    /// What it takes: the model's polygons, or its triangles.
    pub mesh: Arc<Mesh>,
    /// How it refines them.
    pub plan: Plan,
    /// The bytes that those before it leave.
    pub budget: u64,
    /// Whether the model's faces were cut for this scheme and not for the present one.
    pub triangulated: bool,
    /// One sentence if it cannot be shown.
    pub refused: Option<String>,
}

/// Reads what `compare` names, all of it different, and different from the present scheme.
pub(crate) fn list(panes: &[SchemeWords], present: Option<Run>) -> Result<Vec<Run>, CommandError> {
    if panes.len() > MOST_BESIDE {
        return Err(CommandError::TooManyPanes(panes.len()));
    }
    let mut runs: Vec<Run> = Vec::with_capacity(panes.len());
    for SchemeWords { id, parameters } in panes {
        let run = parameters::scheme(id, parameters)?;
        if Some(run) == present || runs.contains(&run) {
            return Err(CommandError::SamePane(id.clone()));
        }
        runs.push(run);
    }
    Ok(runs)
}

impl Document {
    /// Schemes shown beside the present one; none as a rule.
    pub fn beside(&self) -> &[Run] {
        self.state.as_ref().map_or(&[], |s| &s.settings.beside)
    }

    /// What is shown: the present scheme, then those beside it. Empty without a model. Cost: constant, but for the first
    /// time that a model's faces are cut into triangles.
    pub fn panes(&self) -> Vec<Pane> {
        let Some(state) = &self.state else { return Vec::new() };
        let mut left = self.budget;
        let mut pane = |plan: Plan| {
            let takes = state.takes(&plan);
            let refused = match &takes {
                Ok(built) => check(&built.mesh, &plan, left).err().map(|e| e.to_string()),
                Err(error) => Some(error.to_string()),
            };
            let built = takes.unwrap_or_else(|_| state.built.clone());
            let budget = left;
            if refused.is_none() {
                let bytes = predict(&built.mesh, &plan).ok().flatten().map_or(0, |p| p.bytes);
                left = left.saturating_sub(bytes);
            }
            let triangulated = built.mesh.is_triangles() && !state.built.mesh.is_triangles();
            Pane { mesh: built.mesh.clone(), plan, budget, triangulated, refused }
        };
        let first = state.plan();
        let others = state.settings.beside.iter().map(|run| Plan {
            scheme: run.scheme,
            params: run.params,
            later: Vec::new(),
            ..first.clone()
        });
        std::iter::once(first.clone()).chain(others).map(&mut pane).collect()
    }

    /// The command that makes these the schemes beside the present one.
    pub fn compare_command(runs: &[Run]) -> String {
        crate::Command::Compare(runs.iter().map(parameters::words).collect()).to_string()
    }
}
