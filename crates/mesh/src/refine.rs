//! To a level: counts and bytes first, then a job that can pause, report progress and be dropped.
//!
//! ```text
//!   predict ──> within the budget? ──> Job: points | colours | next level's half-edges ... | corners of the last ──> Refined
//! ```
//!
//! Half-edges are built for every level but the last, which is only shown: its corners come straight from its parent's.
//! Positions run through the fast sink; colours and texture coordinates through recorded rows in f64 (texture coordinates
//! on half-edges of their own, see [`crate::mesh::UvChannel`]). Where patches make the last levels all of them are points to
//! these (`patch/`). [`evaluate`] is the slow twin: any number of f64 channels.
//!
//! Cost: about 20 ns an output quad, 12 a triangle, a third of it in the levels before the last. Memory: [`Prediction`].
//! Limit: 2^31 - 1 corners in the last level, whatever the budget.

use crate::FULL;
use crate::charts;
pub use crate::evaluate::{Recorded, evaluate, evaluate_creased, evaluate_limit, record};
use crate::holes;
use crate::limit::Projection;
use crate::mesh::Mesh;
use crate::plan::{Plan, Step};
use crate::refined::{Faces, Refined, UvValues, complete};
pub use crate::report::{grouped, memory};
use crate::scheme::Boundary;
use crate::split::{Split, Triangles};
use crate::topology::{Connectivity, Counts};
use crate::track::{Stage, Track};
use std::sync::Arc;

/// What a plan will make, in closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prediction {
    /// Counts of the level.
    pub counts: Counts,
    /// Bytes that refining holds at its peak: the result, the parent level and its points. Saturates.
    pub bytes: u64,
}

/// Why a plan is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RefineError {
    /// The result does not fit.
    #[error("level {level} {}; choose level {fits} or lower", too_large(.predicted.as_deref(), *.budget))]
    TooLarge {
        /// The level asked for.
        level: u32,
        /// What it would make; none if the counts leave 64 bits.
        predicted: Option<Box<Prediction>>,
        /// The bytes there are.
        budget: u64,
        /// The highest level that fits.
        fits: u32,
    },
    /// The scheme takes triangles only.
    #[error("{scheme} refines triangles only, and face {face} has {corners} corners; triangulate first")]
    NeedsTriangles {
        /// The scheme's name.
        scheme: &'static str,
        /// The first other face.
        face: u32,
        /// How many corners it has.
        corners: u32,
    },
    /// The same at a later level, where another scheme made the faces.
    #[error(
        "{scheme} refines triangles only, and the faces of level {level} are not; put `scheme poke from={level}` between"
    )]
    NeedsTrianglesAt {
        /// The scheme's name.
        scheme: &'static str,
        /// The level.
        level: u32,
    },
    /// The scheme treats triangles in their own way right after a dual split, whose triangles are not counted beforehand.
    #[error("{scheme} cannot follow a dual scheme at level {level} at once; put `scheme linear from={level}` between")]
    Uncounted {
        /// The scheme's name.
        scheme: &'static str,
        /// The level.
        level: u32,
    },
    /// The plan needs rules that this build has not: [`Plan::is_here`].
    #[error("{scheme} needs a part of Limn that is not loaded; choose it again")]
    Elsewhere {
        /// The scheme's name.
        scheme: &'static str,
    },
}

fn too_large(p: Option<&Prediction>, budget: u64) -> String {
    let Some(p) = p else { return "would make more than 2^64 faces".to_owned() };
    if p.counts.corners >= LARGEST && p.bytes <= budget {
        return format!("would make {} faces, more than 32-bit numbers can connect", grouped(p.counts.faces));
    }
    format!(
        "would make {} faces and take {}, and the budget is {}",
        grouped(p.counts.faces),
        memory(p.bytes),
        memory(budget)
    )
}

/// One more than the corners that fit 32-bit half-edges.
const LARGEST: u64 = 1 << 31;

/// Predicts what `plan` makes of `mesh`, faces that are hidden included; none if it leaves 64 bits. Cost: constant (a level takes at most 32 steps).
///
/// # Errors
/// [`RefineError::NeedsTriangles`] and [`RefineError::NeedsTrianglesAt`].
pub fn predict(mesh: &Mesh, plan: &Plan) -> Result<Option<Prediction>, RefineError> {
    let mut counts = [(mesh.counts(), mesh.counts()), (Counts::default(), Counts::default())];
    if let Some(uv) = &mesh.uv {
        counts[1] = (uv.counts, uv.counts);
    }
    let (mut last, mut tracked, mut charted) = (None, false, false);
    for step in plan.walk(mesh) {
        let step = step?;
        let [own, uv] = counts;
        let Some(next) = step.split.counts(own.0) else { return Ok(None) };
        let Some(next_uv) = charts::counts(&step, uv.0, next) else { return Ok(None) };
        counts = [(next, own.0), (next_uv, uv.0)];
        charted |= !step.split.keeps_corners();
        tracked |= last.is_some_and(|l: Step| !same_way(&l, &step));
        last = Some(step);
    }
    let wide = if mesh.colors.is_empty() { 0 } else { 16 };
    let stores = last.is_some_and(|s| s.split.stores());
    // Result: points, corners. Peak beside it: the parent's points and, from level 1 on, its stored half-edges.
    let track = |(c, b): (Counts, Counts), value: u128| {
        let (c, b) = ((c.vertices, c.corners), (b.vertices, b.corners));
        let knots = if mesh.knots.is_empty() { 0 } else { 2 };
        let words = if last.is_some_and(|s| s.stored) { 5 + knots } else { 2 };
        let stored = if plan.level > 1 { 4 * words * u128::from(b.1) + 4 * u128::from(b.0) } else { 0 };
        let parent = if plan.level > 0 { value * u128::from(b.0) } else { 0 };
        let closing =
            if plan.closes() { value * u128::from(c.0) + 8 * u128::from(c.1) + 4 * u128::from(c.0) } else { 0 };
        let closing = closing + if plan.projects() { 12 * u128::from(c.0) } else { 0 };
        value * u128::from(c.0) + 4 * u128::from(c.1) + parent + stored + closing
    };
    // How sharp the parent's edges and vertices are, and the result's if something is left to be done with it.
    let marked = if mesh.edge_sharpness.is_empty() && mesh.vertex_sharpness.is_empty() {
        0
    } else {
        let of = |c: Counts| 4 * u128::from(c.edges) + u128::from(c.vertices);
        of(counts[0].1) + if plan.closes() { of(counts[0].0) } else { 0 }
    };
    let mut bytes = track(counts[0], 12 + wide) + marked;
    // Faces may be listed with where they begin and where they came from.
    bytes += u128::from(counts[0].0.faces)
        * if stores {
            8
        } else if tracked || !mesh.holes.is_empty() || plan.rules.boundary == Boundary::None {
            4
        } else {
            0
        };
    if mesh.uv.is_some() {
        bytes += track(counts[1], 16);
        if charted {
            // Where corners are, and the mesh's own half-edges once more.
            bytes += 40 * (u128::from(counts[0].0.corners) + u128::from(counts[0].1.corners));
        }
    }
    Ok(Some(Prediction { counts: counts[0].0, bytes: bytes.min(u128::from(u64::MAX)) as u64 }))
}

/// Whether the faces' past is arithmetic over both steps, as it is for one.
fn same_way(a: &Step, b: &Step) -> bool {
    a.split == b.split || a.split.stores() && b.split.stores()
}

/// The steps of a plan that fits the budget.
pub(crate) fn admit(mesh: &Mesh, plan: &Plan, budget: u64) -> Result<Vec<Step>, RefineError> {
    let fits = |p: &Option<Prediction>| p.is_some_and(|p| p.bytes <= budget && p.counts.corners < LARGEST);
    let predicted = predict(mesh, plan)?;
    if plan.level == 0 || fits(&predicted) {
        if !plan.is_here(mesh) {
            return Err(RefineError::Elsewhere { scheme: plan.scheme.info.name });
        }
        return plan.walk(mesh).collect();
    }
    let reachable = |level: &u32| predict(mesh, &plan.to(*level)).is_ok_and(|p| fits(&p));
    let highest = (1..plan.level).take_while(reachable).last().unwrap_or(0);
    Err(RefineError::TooLarge { level: plan.level, predicted: predicted.map(Box::new), budget, fits: highest })
}

/// A refinement under way. Drop it to cancel.
#[derive(Debug)]
pub struct Job {
    mesh: Arc<Mesh>,
    plan: Plan,
    steps: Vec<Step>,
    geometry: Track,
    uv: Track,
    rows: u64,
    total: u64,
}

impl Job {
    /// Checks the plan against `budget` bytes and prepares. Cost: constant.
    ///
    /// # Errors
    /// [`RefineError`], before anything is allocated.
    pub fn new(mesh: Arc<Mesh>, plan: Plan, budget: u64) -> Result<Job, RefineError> {
        let steps = admit(&mesh, &plan, budget)?;
        let limit = if FULL && plan.projects() { plan.beyond(&mesh)? } else { None };
        let mut total = 0;
        let tracks = [(Some(mesh.counts()), !mesh.colors.is_empty()), (mesh.uv.as_ref().map(|u| u.counts), true)];
        for (i, (counts, wide)) in tracks.into_iter().enumerate() {
            let Some(mut c) = counts else { continue };
            let mut own = mesh.counts();
            let faired = |level: u32, c: &Counts| {
                let passes = if i == 0 { plan.fairing(level).map_or(0, |f| f.passes()) } else { 0 };
                u64::from(passes) * c.vertices
            };
            for (level, step) in (1..).zip(&steps) {
                total += faired(level - 1, &c);
                let Some(next_own) = step.split.counts(own) else { break };
                let Some(next) = (if i == 0 { Some(next_own) } else { charts::counts(step, c, next_own) }) else {
                    break;
                };
                own = next_own;
                let values = u64::from(i == 0) + u64::from(wide);
                total += values * next.vertices;
                if FULL && i == 0 && matches!(step.split, Split::Sqrt3 { .. }) {
                    total += c.faces; // Sums around vertices.
                }
                if !step.split.stores() {
                    total += c.faces;
                    if level < plan.level || (i == 0 && plan.closes()) {
                        total += c.vertices;
                    }
                    if level == plan.level && i == 0 && plan.closes() {
                        total += c.faces;
                    }
                }
                c = next;
            }
            total += faired(plan.level, &c);
            if let (0, Some(step)) = (i, &limit) {
                total += u64::from(Projection::cost(step.scheme)) * c.vertices;
            }
        }
        let geometry = Track::new(&mesh, false, &plan, &steps, limit);
        let uv = Track::new(&mesh, true, &plan, &steps, None);
        Ok(Job { mesh, plan, steps, geometry, uv, rows: 0, total: total.max(1) })
    }

    /// Makes normals along with the points where that is cheaper than afterwards: [`Refined::known_normals`].
    #[cfg(feature = "full")]
    pub fn shaded(mut self) -> Job {
        self.geometry.patched.shaded = true;
        self
    }

    /// Fills the buffers of a level that is not needed any more, where patches make the last levels and there is room: memory
    /// that was touched before costs half as much. If it was made of the same half-edges by the same splits, its corners stay
    /// as they are.
    #[cfg(feature = "full")]
    pub fn reusing(mut self, old: Refined) -> Job {
        let same = old.counts == self.last_counts() && old.level == self.plan.level && old.hidden == 0;
        let same = same && self.steps.last().is_some_and(|s| s.split == old.split);
        let same = same && self.mesh.topology == old.mesh.topology;
        self.geometry.reuse(old, same);
        self
    }

    /// Counts of the last level.
    #[cfg(feature = "full")]
    pub fn last_counts(&self) -> Counts {
        self.counts_after(self.steps.len())
    }

    #[cfg(feature = "full")]
    fn counts_after(&self, steps: usize) -> Counts {
        let all = self.steps.iter().take(steps).try_fold(self.mesh.counts(), |counts, step| step.split.counts(counts));
        all.unwrap_or_default()
    }

    /// [`Refined::parent_ranges`] of the level that is made.
    #[cfg(feature = "full")]
    pub fn parent_ranges(&self) -> Option<[u32; 2]> {
        let before = self.counts_after(self.steps.len().checked_sub(1)?);
        let [v, f] = [before.vertices as u32, before.faces as u32];
        (self.steps.last()?.split == Split::Quad).then_some([v, v + f])
    }

    /// Makes every level from the one before, where patches would make the last ones at once (`patch/`): the slow twin of these.
    #[cfg(feature = "full")]
    pub fn level_by_level(mut self) -> Job {
        self.geometry.no_patches();
        self.uv.no_patches();
        self
    }

    /// Works off about `rows` rows (one new point, or one face's half-edges; some 50 ns each) and says whether all is done.
    pub fn step(&mut self, rows: usize) -> bool {
        let mut quota = rows;
        self.geometry.step(&self.mesh, &self.plan, &self.steps, &mut quota);
        self.uv.step(&self.mesh, &self.plan, &self.steps, &mut quota);
        self.rows += (rows - quota) as u64;
        self.is_done()
    }

    fn is_done(&self) -> bool {
        self.geometry.stage == Stage::Done && self.uv.stage == Stage::Done
    }

    /// How much is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        // Texture coordinates may take less than was allowed for.
        if self.is_done() { 1.0 } else { (self.rows as f64 / self.total as f64).min(1.0) as f32 }
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The result, after working off what is left.
    pub fn finish(mut self) -> Refined {
        while !self.step(usize::MAX) {}
        let normals = self.geometry.limit.take().map(|l| l.normals);
        #[cfg(feature = "full")]
        let shading = std::mem::take(&mut self.geometry.patched.normals);
        let mut refined = self.gather();
        refined.known_normals = normals.filter(|_| FULL).map(|n| complete(n, &refined.points, &refined.faces));
        #[cfg(feature = "full")]
        if !shading.is_empty() {
            refined.known_normals = Some(shading);
        }
        refined
    }

    /// The result as the tracks have it.
    fn gather(self) -> Refined {
        let t = &self.mesh.topology;
        let level = self.plan.level;
        if level == 0 {
            let corners = t.origins().to_vec();
            let faces = match t.uniform_degree() {
                Some(3) => Faces::Triangles(corners),
                Some(4) => Faces::Quads(corners),
                _ => Faces::Polygons { offsets: t.offsets().to_vec(), corners },
            };
            let uv = self
                .mesh
                .uv
                .as_ref()
                .map(|u| UvValues { values: u.values.clone(), corners: u.topology.origins().to_vec() });
            let mut refined = Refined {
                level,
                counts: self.mesh.counts(),
                hidden: 0,
                points: self.geometry.points.unwrap_or_else(|| self.mesh.positions.clone()),
                faces,
                uv,
                colors: self.mesh.colors.clone(),
                parent_ranges: None,
                vertex_parents: t.vertices(),
                source: self.geometry.source,
                kinds: Vec::new(),
                known_normals: None,
                split: Split::Quad,
                mesh: self.mesh,
            };
            holes::leave_out(&mut refined);
            return refined;
        }
        let split = self.steps.last().map_or(Split::Quad, |s| s.split);
        let before = self.geometry.before;
        let (v, f) = (before.vertices as u32, before.faces as u32);
        let mut refined = Refined {
            level,
            counts: self.geometry.counts,
            hidden: 0,
            points: self.geometry.points.unwrap_or_default(),
            faces: match split {
                Split::Quad => Faces::Quads(self.geometry.corners),
                Split::Triangle | Split::Sqrt3 { .. } | Split::Poke => Faces::Triangles(self.geometry.corners),
                Split::NWay { triangles: Triangles::All, .. } => Faces::Triangles(self.geometry.corners),
                Split::NWay { triangles: Triangles::None, .. } => Faces::Quads(self.geometry.corners),
                Split::Mixed | Split::Dual { .. } | Split::MidEdge { .. } | Split::NWay { .. } => {
                    Faces::Polygons { offsets: self.geometry.offsets, corners: self.geometry.corners }
                }
            },
            uv: self.mesh.uv.is_some().then(|| UvValues {
                values: self.uv.wide.iter().map(|v| [v[0], v[1]]).collect(),
                corners: self.uv.corners,
            }),
            colors: self.geometry.wide,
            parent_ranges: (split == Split::Quad).then_some([v, v + f]),
            // Every edge of a stored level is one of its own.
            vertex_parents: if split.stores() { u32::MAX } else { v },
            source: self.geometry.source,
            kinds: self.geometry.kinds,
            known_normals: None,
            split,
            mesh: self.mesh,
        };
        holes::leave_out(&mut refined);
        refined
    }
}

/// Refines in one go.
///
/// # Errors
/// [`RefineError`], before anything is allocated.
pub fn refine(mesh: &Arc<Mesh>, plan: &Plan, budget: u64) -> Result<Refined, RefineError> {
    Ok(Job::new(mesh.clone(), plan.clone(), budget)?.finish())
}

/// Vertices of a level that stay, and those of one face that do not.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Kept<'a> {
    pub sharp: &'a [bool],
    pub joined: &'a [bool],
}

/// The vertices of `level` that stay, as far as ids tell: the mesh's own; with its corners after a turn of edges, which hides
/// them; none where vertices have been cut apart.
pub(crate) fn sharp_at<'a>(steps: &[Step], level: u32, mesh: &'a Mesh, kept: &'a [bool]) -> Kept<'a> {
    let before = &steps[..(level as usize).min(steps.len())];
    if before.iter().any(|s| !s.split.keeps_vertices()) {
        Kept::default()
    } else {
        let turned = before.iter().any(|s| matches!(s.split, Split::Sqrt3 { .. }));
        Kept { sharp: if turned { kept } else { &mesh.sharp }, joined: &mesh.joined }
    }
}
