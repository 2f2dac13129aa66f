//! To a level: counts and bytes first, then a job that can pause, report progress and be dropped.
//!
//! ```text
//!   predict ──> within the budget? ──> Job: points | colours | next level's half-edges ... | corners of the last ──> Refined
//! ```
//!
//! Half-edges are built for every level but the last, which is only shown: its corners come straight from its parent's.
//! Positions run through the fast sink; colours and texture coordinates through recorded rows in f64 (texture coordinates
//! on half-edges of their own, see [`crate::mesh::UvChannel`]). [`evaluate`] is the slow twin: any number of f64 channels.
//!
//! Cost: about 20 ns an output quad, 12 a triangle, a third of it in the levels before the last. Memory: [`Prediction`].
//! Limit: 2^31 - 1 corners in the last level, whatever the budget.

use crate::mesh::Mesh;
use crate::refined::{Faces, Refined, UvValues};
use crate::scheme::{Boundary, Entry, Params, Tags};
use crate::sink::{Cursor, Source};
use crate::split::{Level, Split};
use crate::topology::{Connectivity, Counts};
use crate::track::{Owned, Stage, Track, weigh};
use std::sync::Arc;

/// What to refine by, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The scheme.
    pub scheme: &'static Entry,
    /// Its parameters.
    pub params: Params,
    /// The boundary rule.
    pub boundary: Boundary,
    /// How many times; 0 is the mesh itself.
    pub level: u32,
}

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
    #[error("level {level} {}; choose level {fits} or lower", too_large(*.predicted, *.budget))]
    TooLarge {
        /// The level asked for.
        level: u32,
        /// What it would make; none if the counts leave 64 bits.
        predicted: Option<Prediction>,
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
}

fn too_large(p: Option<Prediction>, budget: u64) -> String {
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

/// An amount of memory, as people read it: "52 kB", "1.4 MB", "18 MB", "1.5 GB".
pub fn memory(bytes: u64) -> String {
    let tenths = |unit: u64| bytes.saturating_add(unit / 20) / (unit / 10);
    match bytes {
        1_000_000_000.. => format!("{}.{} GB", tenths(1_000_000_000) / 10, tenths(1_000_000_000) % 10),
        10_000_000.. => format!("{} MB", bytes.saturating_add(500_000) / 1_000_000),
        100_000.. => format!("{}.{} MB", tenths(1_000_000) / 10, tenths(1_000_000) % 10),
        _ => format!("{} kB", bytes.div_ceil(1_000)),
    }
}

/// A count with commas, as people read it.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(d);
    }
    out
}

/// One more than the corners that fit 32-bit half-edges.
const LARGEST: u64 = 1 << 31;

impl Plan {
    /// A plan with the scheme's own parameters.
    pub fn new(scheme: &'static Entry, boundary: Boundary, level: u32) -> Plan {
        Plan { scheme, params: Params::default(), boundary, level }
    }

    /// What rules have to know of the plan, and of the sharp vertices.
    pub(crate) fn tags<'a>(&self, sharp: &'a [bool]) -> Tags<'a> {
        Tags { boundary: self.boundary, sharp, lone: &[], params: self.params.of(&self.scheme.info) }
    }

    /// The vertices of level 0 that stay: what the mesh keeps, and corners where the boundary rule says so.
    pub(crate) fn kept(&self, mesh: &Mesh) -> Vec<bool> {
        let (t, tags) = (&mesh.topology, self.tags(&mesh.sharp));
        (0..t.vertices()).map(|v| tags.is_sharp(t, v)).collect()
    }

    /// The split that the plan uses on `mesh`.
    ///
    /// # Errors
    /// [`RefineError::NeedsTriangles`].
    pub fn split(&self, mesh: &Mesh) -> Result<Split, RefineError> {
        self.scheme.info.split(mesh.is_triangles(), self.boundary).ok_or_else(|| {
            let t = &mesh.topology;
            let odd = (0..t.faces()).find(|&f| t.face_half_edges(f).len() != 3).unwrap_or(0);
            RefineError::NeedsTriangles {
                scheme: self.scheme.info.name,
                face: mesh.face_source[odd as usize],
                corners: t.face_half_edges(odd).len() as u32,
            }
        })
    }
}

/// Counts after `level` steps of `split`, and those one step before.
fn counts_at(split: Split, mut c: Counts, level: u32) -> Option<(Counts, Counts)> {
    let mut before = c;
    for step in 0..level {
        before = c;
        c = split.at(step).counts(c)?;
    }
    Some((c, before))
}

/// Predicts what `plan` makes of `mesh`; none if it leaves 64 bits. Cost: constant (the level is at most 32 steps).
///
/// # Errors
/// [`RefineError::NeedsTriangles`].
pub fn predict(mesh: &Mesh, plan: &Plan) -> Result<Option<Prediction>, RefineError> {
    Ok(prediction(mesh, plan.split(mesh)?, plan.level))
}

fn prediction(mesh: &Mesh, split: Split, level: u32) -> Option<Prediction> {
    let (counts, before) = counts_at(split, mesh.counts(), level)?;
    let wide = if mesh.colors.is_empty() { 0 } else { 16 };
    // Result: points, corners. Peak beside it: the parent's points and, from level 1 on, its stored half-edges.
    let track = |c: Counts, b: Counts, value: u128| {
        let (c, b) = ((c.vertices, c.corners), (b.vertices, b.corners));
        let words = if split.stores() { 5 } else { 2 };
        let stored = if level > 1 { 4 * words * u128::from(b.1) + 4 * u128::from(b.0) } else { 0 };
        let parent = if level > 0 { value * u128::from(b.0) } else { 0 };
        value * u128::from(c.0) + 4 * u128::from(c.1) + parent + stored
    };
    let mut bytes = track(counts, before, 12 + wide);
    if split.stores() {
        // Faces are listed with where they begin and where they came from.
        bytes += 8 * u128::from(counts.faces);
    } else if let Some(uv) = &mesh.uv {
        let (c, b) = counts_at(split, uv.counts, level)?;
        bytes += track(c, b, 16);
    }
    Some(Prediction { counts, bytes: bytes.min(u128::from(u64::MAX)) as u64 })
}

fn admit(mesh: &Mesh, plan: &Plan, budget: u64) -> Result<Split, RefineError> {
    let split = plan.split(mesh)?;
    let fits = |level| prediction(mesh, split, level).filter(|p| p.bytes <= budget && p.counts.corners < LARGEST);
    if plan.level == 0 || fits(plan.level).is_some() {
        return Ok(split);
    }
    let highest = (1..plan.level).take_while(|&l| fits(l).is_some()).last().unwrap_or(0);
    Err(RefineError::TooLarge {
        level: plan.level,
        predicted: prediction(mesh, split, plan.level),
        budget,
        fits: highest,
    })
}

/// A refinement under way. Drop it to cancel.
#[derive(Debug)]
pub struct Job {
    mesh: Arc<Mesh>,
    plan: Plan,
    split: Split,
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
        let split = admit(&mesh, &plan, budget)?;
        let mut total = 0;
        let uv = mesh.uv.as_ref().filter(|_| !split.stores());
        let tracks = [(Some(mesh.counts()), !mesh.colors.is_empty()), (uv.map(|u| u.counts), true)];
        for (i, (counts, wide)) in tracks.into_iter().enumerate() {
            let Some(mut c) = counts else { continue };
            for level in 1..=plan.level {
                let Some(next) = split.at(level - 1).counts(c) else { break };
                let values = u64::from(i == 0) + u64::from(wide);
                total += values * next.vertices;
                if !split.stores() {
                    total += c.faces + if level < plan.level { c.vertices } else { 0 };
                }
                c = next;
            }
        }
        let (geometry, uv) = (Track::new(&mesh, false, &plan, split), Track::new(&mesh, true, &plan, split));
        Ok(Job { mesh, plan, split, geometry, uv, rows: 0, total: total.max(1) })
    }

    /// Works off about `rows` rows (one new point, or one face's half-edges; some 50 ns each) and says whether all is done.
    pub fn step(&mut self, rows: usize) -> bool {
        let mut quota = rows;
        self.geometry.step(&self.mesh, &self.plan, self.split, &mut quota);
        self.uv.step(&self.mesh, &self.plan, self.split, &mut quota);
        self.rows += (rows - quota) as u64;
        self.geometry.stage == Stage::Done && self.uv.stage == Stage::Done
    }

    /// How much is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        (self.rows as f64 / self.total as f64).min(1.0) as f32
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The result, after working off what is left.
    pub fn finish(mut self) -> Refined {
        while !self.step(usize::MAX) {}
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
            return Refined {
                level,
                counts: self.mesh.counts(),
                points: self.mesh.positions.clone(),
                faces,
                uv,
                colors: self.mesh.colors.clone(),
                parent_ranges: None,
                vertex_parents: t.vertices(),
                source: Vec::new(),
                kinds: Vec::new(),
                split: self.split,
                mesh: self.mesh,
            };
        }
        let before = self.geometry.before;
        let (v, f) = (before.vertices as u32, before.faces as u32);
        Refined {
            level,
            counts: self.geometry.counts,
            points: self.geometry.points.unwrap_or_default(),
            faces: match self.split {
                Split::Quad => Faces::Quads(self.geometry.corners),
                Split::Triangle | Split::Sqrt3 { .. } => Faces::Triangles(self.geometry.corners),
                Split::Dual { .. } => {
                    Faces::Polygons { offsets: self.geometry.offsets, corners: self.geometry.corners }
                }
            },
            uv: (self.mesh.uv.is_some() && !self.split.stores()).then(|| UvValues {
                values: self.uv.wide.iter().map(|v| [v[0], v[1]]).collect(),
                corners: self.uv.corners,
            }),
            colors: self.geometry.wide,
            parent_ranges: (self.split == Split::Quad).then_some([v, v + f]),
            // Every edge of a stored level is one of its own.
            vertex_parents: if self.split.stores() { u32::MAX } else { v },
            source: self.geometry.source,
            kinds: self.geometry.kinds,
            split: self.split,
            mesh: self.mesh,
        }
    }
}

/// Refines in one go.
///
/// # Errors
/// [`RefineError`], before anything is allocated.
pub fn refine(mesh: &Arc<Mesh>, plan: Plan, budget: u64) -> Result<Refined, RefineError> {
    Ok(Job::new(mesh.clone(), plan, budget)?.finish())
}

/// The slow twin of the fast path: `values` (one for each vertex of `mesh`) refined in f64 through recorded rows. Also
/// calls `inspect` with every level's half-edges but the last's. Cost: about 200 ns a point.
///
/// # Errors
/// [`RefineError`], with no budget.
pub fn evaluate<const N: usize>(
    mesh: &Mesh,
    plan: Plan,
    values: &[[f64; N]],
    mut inspect: impl FnMut(&Level<'_>),
) -> Result<Vec<[f64; N]>, RefineError> {
    let split = admit(mesh, &plan, u64::MAX)?;
    let kept = if matches!(split, Split::Sqrt3 { .. }) { plan.kept(mesh) } else { Vec::new() };
    let mut old = values.to_vec();
    let mut owned: Option<Owned> = None;
    for step in 0..plan.level {
        let level = owned.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
        inspect(&level);
        let split = split.at(step);
        let lone = split.lone(&level);
        let sharp = if kept.is_empty() { &mesh.sharp } else { &kept };
        let tags = Tags { lone: &lone, ..plan.tags(sharp) };
        let mut new = vec![[0.0; N]; split.children(&level) as usize];
        let mut take = |child: u32, row: &[(Source, f64)]| {
            new[child as usize] = weigh(row, |s| match s {
                Source::Vertex(v) => old[v as usize],
                Source::Child(v) => new[v as usize],
            });
        };
        plan.scheme.rows((&level, split, tags), &mut take, &mut Cursor::default(), &mut { usize::MAX });
        old = new;
        if step + 1 < plan.level {
            let mut next = Owned::below(&level, split);
            let mut at = 0;
            while !next.fill(&level, &mut at, &mut { usize::MAX }) {}
            owned = Some(next);
        }
    }
    Ok(old)
}
