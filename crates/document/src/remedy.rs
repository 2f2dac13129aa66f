//! What would let a refused command work, for a page to offer as a button.
//!
//! ```text
//!   scheme loop from=1   on quads        ->  scheme poke from=1, scheme loop from=2
//!   scheme sqrt3         at level 7      ->  level 6, scheme sqrt3
//! ```
//!
//! The error says why; this names the commands. Whatever is offered has been tried on a copy of the state, so it works.
//! Cost: a prediction for each.

use limn_mesh::{RefineError, Run};

use crate::command::Command;
use crate::document::Document;
use crate::error::CommandError;
use crate::parameters;
use crate::state::find_scheme;

/// Commands that end with the one that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remedy {
    /// What they do, as a button has it: "Poke at level 1, then Loop".
    pub label: String,
    /// To be run one after the other.
    pub commands: Vec<String>,
}

impl Document {
    /// What would let `command` work, which was refused with `error`; none if nothing is known that would.
    pub fn remedy(&self, command: &Command, error: &CommandError) -> Option<Remedy> {
        let CommandError::Refine(error) = error else { return None };
        match error {
            RefineError::TooLarge { fits, .. } => {
                let lower = Command::Level(i32::try_from(*fits).ok()?);
                let label = format!("Use level {fits}");
                match command {
                    Command::Level(_) => self.tried(label, vec![lower]),
                    _ => self.tried(label, vec![lower, command.clone()]),
                }
            }
            RefineError::NeedsTrianglesAt { level, .. } => self.between("poke", *level, command),
            RefineError::Uncounted { level, .. } => self.between("linear", *level, command),
            RefineError::NeedsTriangles { .. } | RefineError::Elsewhere { .. } => None,
        }
    }

    /// One step by `id` at `level`, and the scheme that would have made it one level later.
    fn between(&self, id: &str, level: u32, command: &Command) -> Option<Remedy> {
        let step = Run { from: level, scheme: find_scheme(id).ok()?, params: Default::default() };
        let late = match command {
            Command::Scheme { id, parameters } => {
                let (_, parameters) = parameters::level(parameters, "from").ok()?;
                parameters::scheme(id, &parameters).ok()?
            }
            _ => self.plan()?.run(level),
        };
        let late = Run { from: level.checked_add(1)?, ..late };
        let label = format!("{} at level {level}, then {}", step.scheme.info.name, late.scheme.info.name);
        let mut commands = [step, late].map(|run| parameters::run_command(&run)).to_vec();
        if !matches!(command, Command::Scheme { .. }) {
            commands.push(command.clone());
        }
        self.tried(label, commands)
    }

    /// The remedy, if all of its commands would run.
    fn tried(&self, label: String, commands: Vec<Command>) -> Option<Remedy> {
        let mut trial = self.trial()?;
        commands.iter().try_for_each(|command| trial.apply(command, false).map(drop)).ok()?;
        Some(Remedy { label, commands: commands.iter().map(Command::to_string).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(setup: &str, line: &str) -> (Document, String, Option<Remedy>) {
        let mut document = Document::new(1 << 20);
        setup.lines().for_each(|line| _ = document.run(line).unwrap());
        let before = document.text();
        let error = document.run(line).unwrap_err();
        let remedy = document.remedy(&line.parse().unwrap(), &error);
        assert_eq!(document.text(), before, "nothing has changed");
        (document, error.to_string(), remedy)
    }

    /// Runs the remedy and returns the lines of the document from its scheme on.
    fn mended(mut document: Document, remedy: Option<Remedy>) -> String {
        for command in remedy.unwrap().commands {
            document.run(&command).unwrap();
        }
        document.text().lines().skip_while(|l| !l.starts_with("scheme")).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn a_scheme_of_triangles_after_one_of_quads() {
        for id in ["loop", "sqrt3", "butterfly", "modified-butterfly", "interpolating-sqrt3", "j-spline"] {
            let line = format!("scheme {id} from=1");
            let (document, why, remedy) = refused("open builtin:cube\nlevel 3", &line);
            assert!(why.contains("refines triangles only, and the faces of level 1 are not"), "{why}");
            let name = find_scheme(id).unwrap().info.name;
            assert_eq!(remedy.as_ref().unwrap().label, format!("Poke at level 1, then {name}"));
            assert_eq!(
                mended(document, remedy),
                format!("scheme catmull-clark; scheme poke from=1; scheme {id} from=2; level 3")
            );
        }
    }

    #[test]
    fn parameters_and_a_level_that_reaches_too_far() {
        let (document, _, remedy) = refused("open builtin:cube\nlevel 2", "scheme loop from=1 weights=warren");
        assert!(mended(document, remedy).contains("scheme loop from=2 weights=warren"));
        // The scheme was taken while nothing came of it; the level finds out.
        let (document, _, remedy) = refused("open builtin:cube\nlevel 1\nscheme loop from=2", "level 3");
        assert_eq!(mended(document, remedy), "scheme catmull-clark; scheme poke from=2; scheme loop from=3; level 3");
    }

    #[test]
    fn triangles_that_nobody_counted() {
        let (document, why, remedy) =
            refused("open builtin:cube\nscheme doo-sabin\nlevel 3", "scheme quad-triangle from=1");
        assert!(why.contains("cannot follow a dual scheme at level 1 at once"), "{why}");
        assert!(mended(document, remedy).contains("scheme linear from=1; scheme quad-triangle from=2"));
    }

    #[test]
    fn what_is_too_large_is_offered_lower() {
        let (document, why, remedy) = refused("open builtin:cube\nlevel 4", "level 9");
        assert!(why.contains("the budget is"), "{why}");
        let highest = document.highest_level();
        assert_eq!(remedy.as_ref().unwrap().commands, [format!("level {highest}")]);
        let (document, _, remedy) = refused("open builtin:cube\nlevel 5", "scheme n-way n=16");
        let text = mended(document, remedy);
        assert!(text.starts_with("scheme n-way n=16; level "), "{text}");
    }

    #[test]
    fn other_refusals_have_none() {
        let (_, _, remedy) = refused("open builtin:cube", "scheme loop w=1");
        assert_eq!(remedy, None);
        let (_, _, remedy) = refused("open builtin:cube", "crease 0-99 1");
        assert_eq!(remedy, None);
    }
}
