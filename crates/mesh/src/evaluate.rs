//! The slow twin of the fast path: a plan through recorded rows, in f64, any number of channels; or the rows themselves, for whoever
//! computes elsewhere.
//!
//! ```text
//!   values ──rows of level 1──> values ──rows of level 2──> ..        evaluate: weighs them      record: hands them out
//! ```
//!
//! Cost: about 200 ns a row. Limit: no budget; whole levels are held.

use crate::crease::Creases;
use crate::fairing;
use crate::limit::{Limit, Projector, limit};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::plan::{Plan, Step};
use crate::refine::{Kept, RefineError, admit, sharp_at};
use crate::scheme::{Entry, Tags};
use crate::sink::{Cursor, Record, Source, weigh};
use crate::split::{Level, Split};
use crate::topology::Connectivity;

/// `values` (one for each vertex of `mesh`) refined in f64 through recorded rows. Also
/// calls `inspect` with every level's half-edges but the last's. Values of three channels are points: constants of rules
/// move them. Cost: about 200 ns a point.
///
/// # Errors
/// [`RefineError`], with no budget.
pub fn evaluate<const N: usize>(
    mesh: &Mesh,
    plan: &Plan,
    values: &[[f64; N]],
    mut inspect: impl FnMut(&Level<'_>),
) -> Result<Vec<[f64; N]>, RefineError> {
    evaluate_creased(mesh, plan, values, |level, _| inspect(level))
}

/// [`evaluate`], where `inspect` also learns how sharp the level is.
///
/// # Errors
/// [`RefineError`], with no budget.
pub fn evaluate_creased<const N: usize>(
    mesh: &Mesh,
    plan: &Plan,
    values: &[[f64; N]],
    inspect: impl FnMut(&Level<'_>, Option<&Creases>),
) -> Result<Vec<[f64; N]>, RefineError> {
    let beyond = if plan.projects() { plan.beyond(mesh)? } else { None };
    run(mesh, plan, values, (inspect, |_| ()), beyond, |scheme, on, points, _| {
        let mut projector = Projector::new(scheme, on);
        *points = (0..points.len() as u32).map(|v| projector.mask(v).point(|v| points[v as usize])).collect();
    })
}

/// Where the points of a plan's last level go in the limit, with normals and tangents, in f64 (whether the plan has them
/// go there or not). Cost: that of [`evaluate`], and about 300 ns a vertex or what its analysis takes.
///
/// # Errors
/// [`RefineError`], with no budget.
pub fn evaluate_limit(mesh: &Mesh, plan: &Plan, points: &[[f64; 3]]) -> Result<Limit, RefineError> {
    let mut found = Limit::default();
    let plan = Plan { limit: false, ..plan.clone() };
    let beyond = plan.beyond(mesh)?;
    run(mesh, &plan, points, (|_, _| (), |_| ()), beyond, |scheme, on, points, _| found = limit(scheme, on, points))?;
    mesh.tie(&admit(mesh, &plan, u64::MAX)?, plan.level, &mut found.points);
    Ok(found)
}

/// A plan written down, one thing after the other.
#[derive(Clone, Copy, Debug)]
pub enum Recorded<'a> {
    /// What follows makes a level of so many vertices of the one before: a step of a scheme, half a step of fairing, or the limit.
    Level(u32),
    /// A vertex of it: its weights, and what its point is moved by. Sources that are children came before.
    Row(u32, &'a [(Source, f64)], [f64; 3]),
    /// The tangents of a vertex in the limit, weights on the points before it: [`crate::limit::Mask::tangents`].
    Tangents(u32, &'a [(u32, [f64; 2], u32)]),
}

/// Hands the rows of `plan` to `take`, in an order in which they can be worked off; copies that are tied are rows of their
/// leader. Cost: about 200 ns a row, and in the limit 300 more or what its analysis takes.
///
/// # Errors
/// [`RefineError`], with no budget.
pub fn record(mesh: &Mesh, plan: &Plan, take: impl FnMut(Recorded<'_>)) -> Result<(), RefineError> {
    let values = vec![[0.0; 0]; mesh.topology.vertices() as usize];
    let beyond = if plan.projects() { plan.beyond(mesh)? } else { None };
    let made = run(mesh, plan, &values, (|_, _| (), take), beyond, |scheme, on, points, note| {
        note(Recorded::Level(points.len() as u32));
        let mut projector = Projector::new(scheme, on);
        for v in 0..points.len() as u32 {
            let mask = projector.mask(v);
            let row: Vec<_> = mask.point.iter().map(|&(v, w)| (Source::Vertex(v), w)).collect();
            note(Recorded::Row(v, &row, [0.0; 3]));
            note(Recorded::Tangents(v, &mask.tangents));
        }
    });
    made.map(drop)
}

/// Says which vertices of a level take the points of others.
fn record_ties(mesh: &Mesh, steps: &[Step], level: u32, vertices: usize, take: &mut impl FnMut(Recorded<'_>)) {
    if mesh.tied.is_empty() {
        return;
    }
    let mut of: Vec<u32> = (0..vertices as u32).collect();
    mesh.tie(steps, level, &mut of);
    for (v, &leader) in (0..).zip(&of).filter(|(v, leader)| v != *leader) {
        take(Recorded::Row(v, &[(Source::Child(leader), 1.0)], [0.0; 3]));
    }
}

/// What [`evaluate`] does; calls `inspect` with every level but the last, `note` with every row, `last` with the scheme of the step `beyond`, the last level as it would find it, and the
/// points there.
fn run<const N: usize>(
    mesh: &Mesh,
    plan: &Plan,
    values: &[[f64; N]],
    (mut inspect, mut note): (impl FnMut(&Level<'_>, Option<&Creases>), impl FnMut(Recorded<'_>)),
    beyond: Option<Step>,
    mut last: impl FnMut(&'static Entry, (&Level<'_>, Split, Tags<'_>), &mut Vec<[f64; N]>, &mut dyn FnMut(Recorded<'_>)),
) -> Result<Vec<[f64; N]>, RefineError> {
    let steps = admit(mesh, plan, u64::MAX)?;
    let kept = plan.kept(mesh);
    let mut old = values.to_vec();
    let mut owned: Option<Owned> = None;
    let mut knots = mesh.knots.clone();
    let mut creases = Creases::of(mesh, &mesh.topology, plan.rules.face_varying);
    for at in 0..=plan.level {
        let level = owned.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
        let sharp = sharp_at(&steps, at, mesh, &kept);
        if let Some(fairing) = plan.fairing(at) {
            let Kept { sharp, joined } = sharp;
            let tags = Tags { sharp, joined, creases: creases.as_ref(), ..Tags::new(plan.rules, Default::default()) };
            for pass in 0..fairing.passes() {
                let mut new = old.clone();
                note(Recorded::Level(new.len() as u32));
                let mut take = |v: u32, row: &[(Source, f64)], _| {
                    note(Recorded::Row(v, row, [0.0; 3]));
                    new[v as usize] = weigh(row, |s| of(&old, &[], s));
                };
                let (mut cursor, mut quota) = (Cursor::default(), usize::MAX);
                fairing::rules(&level, pass, tags, &mut Record::new(&mut take, &mut cursor, &mut quota));
                mesh.tie(&steps, at, &mut new);
                record_ties(mesh, &steps, at, new.len(), &mut note);
                old = new;
            }
        }
        let Some(step) = steps.get(at as usize) else {
            if let Some(step) = &beyond {
                let tags = Tags { knots: &knots, ..plan.tags(step, at, sharp, creases.as_ref()) };
                last(step.scheme, (&level, step.split, tags), &mut old, &mut note);
                mesh.tie(&steps, at, &mut old);
                record_ties(mesh, &steps, at, old.len(), &mut note);
            }
            break;
        };
        inspect(&level, creases.as_ref());
        let split = step.split;
        let lone = split.lone(&level);
        let tags = Tags { lone: &lone, knots: &knots, ..plan.tags(step, at, sharp, creases.as_ref()) };
        let mut new = vec![[0.0; N]; split.children(&level) as usize];
        note(Recorded::Level(new.len() as u32));
        let mut take = |child: u32, row: &[(Source, f64)], offset: [f64; 3]| {
            note(Recorded::Row(child, row, offset));
            let mut sum = weigh(row, |s| of(&old, &new, s));
            if N == 3 {
                sum.iter_mut().zip(offset).for_each(|(x, d)| *x += d);
            }
            new[child as usize] = sum;
        };
        step.scheme.rows((&level, split, tags), &mut take, &mut Cursor::default(), &mut { usize::MAX });
        mesh.tie(&steps, at + 1, &mut new);
        record_ties(mesh, &steps, at + 1, new.len(), &mut note);
        old = new;
        let next = steps.get(at as usize + 1);
        if next.is_some() || plan.closes() || beyond.is_some() {
            let mut below = Owned::below(&level, split, tags.creases);
            let mut at = 0;
            while !below.fill(&level, &mut at, &mut { usize::MAX }) {}
            knots = split.knots(&level, &knots, &lone);
            let below = below.stored_for(next);
            creases = creases.and_then(|c| c.below(&level, split, &below.view(), plan.rules.decay));
            owned = Some(below);
        }
    }
    Ok(old)
}

fn of<const N: usize>(old: &[[f64; N]], new: &[[f64; N]], source: Source) -> [f64; N] {
    match source {
        Source::Vertex(v) => old[v as usize],
        Source::Child(v) => new[v as usize],
    }
}
