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
use crate::scheme::{Boundary, Entry, Tags};
use crate::sink::{Cursor, Source};
use crate::split::{Level, QuadLevel, Split, TriangleLevel};
use crate::topology::{Connectivity, Counts, Topology};
use std::sync::Arc;

/// What to refine by, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The scheme.
    pub scheme: &'static Entry,
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
    let gb = |b: u64| b as f64 / 1e9;
    if p.counts.corners >= LARGEST && p.bytes <= budget {
        return format!("would make {} faces, more than 32-bit numbers can connect", grouped(p.counts.faces));
    }
    format!(
        "would make {} faces and take {:.1} GB, and the budget is {:.1} GB",
        grouped(p.counts.faces),
        gb(p.bytes),
        gb(budget)
    )
}

/// A count with commas, as people read it.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            out.push(',');
        }
        out.push(d);
    }
    out
}

/// One more than the corners that fit 32-bit half-edges.
const LARGEST: u64 = 1 << 31;

impl Plan {
    /// The split that the plan uses on `mesh`.
    ///
    /// # Errors
    /// [`RefineError::NeedsTriangles`].
    pub fn split(&self, mesh: &Mesh) -> Result<Split, RefineError> {
        self.scheme.info.split(mesh.is_triangles()).ok_or_else(|| {
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
    for _ in 0..level {
        before = c;
        c = split.counts(c)?;
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
        let stored = if level > 1 { 8 * u128::from(b.1) + 4 * u128::from(b.0) } else { 0 };
        let parent = if level > 0 { value * u128::from(b.0) } else { 0 };
        value * u128::from(c.0) + 4 * u128::from(c.1) + parent + stored
    };
    let mut bytes = track(counts, before, 12 + wide);
    if let Some(uv) = &mesh.uv {
        let (c, b) = counts_at(split, uv.topology.counts(), level)?;
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

/// The faces of a level.
#[derive(Clone, Debug, PartialEq)]
pub enum Faces {
    /// Any polygons: face f has corners `offsets[f] .. offsets[f + 1]`.
    Polygons {
        /// Where each face begins, and the end.
        offsets: Vec<u32>,
        /// A vertex a corner.
        corners: Vec<u32>,
    },
    /// Three corners a face.
    Triangles(Vec<u32>),
    /// Four corners a face.
    Quads(Vec<u32>),
}

impl Faces {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Faces::Polygons { offsets, .. } => offsets.len().saturating_sub(1),
            Faces::Triangles(c) => c.len() / 3,
            Faces::Quads(c) => c.len() / 4,
        }
    }

    /// The corners of all faces in a row.
    pub fn corners(&self) -> &[u32] {
        match self {
            Faces::Polygons { corners, .. } | Faces::Triangles(corners) | Faces::Quads(corners) => corners,
        }
    }

    /// The corners of face `f`, as a range of [`Faces::corners`]. Panics if `f` is out of range.
    pub fn range(&self, f: usize) -> std::ops::Range<usize> {
        match self {
            Faces::Polygons { offsets, .. } => offsets[f] as usize..offsets[f + 1] as usize,
            Faces::Triangles(_) => 3 * f..3 * f + 3,
            Faces::Quads(_) => 4 * f..4 * f + 4,
        }
    }

    /// The corners of face `f`. Panics if `f` is out of range.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners()[self.range(f)]
    }
}

/// Texture coordinates of a level: values, and one of them for each corner in the order of [`Faces::corners`].
#[derive(Clone, Debug, PartialEq)]
pub struct UvValues {
    /// (u, v), v up.
    pub values: Vec<[f32; 2]>,
    /// The value of each corner.
    pub corners: Vec<u32>,
}

/// A level of a mesh, as drawing and files want it.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Which level.
    pub level: u32,
    /// Its counts.
    pub counts: Counts,
    /// One point a vertex, in the recursive order (old | faces | edges).
    pub points: Vec<[f32; 3]>,
    /// The faces.
    pub faces: Faces,
    /// Texture coordinates, if the mesh has any.
    pub uv: Option<UvValues>,
    /// Linear RGBA, one a vertex; empty if the mesh has none.
    pub colors: Vec<[f32; 4]>,
    /// After a quad split: vertices below the first are the parent's, up to the second face points, then edge points.
    /// Every quad's corners are then old vertex, edge point, face point, edge point.
    pub parent_ranges: Option<[u32; 2]>,
    /// Vertices below this were the parent level's (all of them at level 0).
    pub vertex_parents: u32,
    split: Split,
    mesh: Arc<Mesh>,
}

impl Refined {
    /// The soup's face that face `f` of this level came from. Cost: the level.
    pub fn face_source(&self, f: u32) -> u32 {
        let base = &self.mesh.topology;
        let mut f = f;
        let mut corners = u64::from(base.half_edges()) << (2 * self.level);
        for level in (1..=self.level).rev() {
            corners >>= 2; // of the level above
            f = match self.split {
                Split::Quad if level == 1 => base.face(f),
                Split::Quad => f >> 2,
                Split::Triangle if u64::from(f) < corners => f / 3,
                Split::Triangle => f - corners as u32,
            };
        }
        self.mesh.face_source[f as usize]
    }

    /// The mesh that was refined.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Smooth unit normals: the area-weighted sum of the normals of the faces around each vertex (quads by their
    /// diagonals, polygons by Newell's sum); (0, 0, 0) where that vanishes. Cost: about 10 ns a face.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        normals(&self.points, &self.faces)
    }
}

fn normals(points: &[[f32; 3]], faces: &Faces) -> Vec<[f32; 3]> {
    let sub = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let mut sums = vec![[0.0f32; 3]; points.len()];
    let mut add = |corners: &[u32], n: [f32; 3]| {
        for &v in corners {
            let s = &mut sums[v as usize];
            *s = [s[0] + n[0], s[1] + n[1], s[2] + n[2]];
        }
    };
    let p = |v: u32| points[v as usize];
    match faces {
        Faces::Quads(corners) => {
            for q in corners.chunks_exact(4) {
                add(q, cross(sub(p(q[2]), p(q[0])), sub(p(q[3]), p(q[1]))));
            }
        }
        Faces::Triangles(corners) => {
            for t in corners.chunks_exact(3) {
                add(t, cross(sub(p(t[1]), p(t[0])), sub(p(t[2]), p(t[0]))));
            }
        }
        Faces::Polygons { .. } => {
            for f in 0..faces.count() {
                let corners = faces.face(f);
                let origin = p(corners[0]);
                let mut n = [0.0; 3];
                for w in corners[1..].windows(2) {
                    let c = cross(sub(p(w[0]), origin), sub(p(w[1]), origin));
                    n = [n[0] + c[0], n[1] + c[1], n[2] + c[2]];
                }
                add(corners, n);
            }
        }
    }
    for n in &mut sums {
        // Scale by the largest component first: tiny faces have normals whose squares vanish.
        let largest = n[0].abs().max(n[1].abs()).max(n[2].abs());
        if largest > 0.0 && largest.is_finite() {
            let m = n.map(|x| x / largest);
            let length = (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]).sqrt();
            *n = m.map(|x| x / length);
        } else {
            *n = [0.0; 3];
        }
    }
    sums
}

/// Half-edges of a level between the first and the last.
#[derive(Debug)]
enum Owned {
    Quads(QuadLevel),
    Triangles(TriangleLevel),
}

/// Runs a statement with the connectivity behind a level, whatever its type.
macro_rules! on {
    ($level:expr, $c:ident => $body:expr) => {
        match $level {
            Level::Base($c) => $body,
            Level::Quads($c) => $body,
            Level::Triangles($c) => $body,
        }
    };
}

impl Owned {
    fn below(parent: &Level<'_>, split: Split) -> Owned {
        on!(parent, c => match split {
            Split::Quad => Owned::Quads(QuadLevel::below(*c)),
            Split::Triangle => Owned::Triangles(TriangleLevel::below(*c)),
        })
    }

    fn view(&self) -> Level<'_> {
        match self {
            Owned::Quads(q) => Level::Quads(q),
            Owned::Triangles(t) => Level::Triangles(t),
        }
    }

    /// Fills up to `quota` faces, then vertices; true when complete.
    fn fill(&mut self, parent: &Level<'_>, at: &mut u32, quota: &mut usize) -> bool {
        on!(parent, c => {
            let (faces, all) = (c.faces(), c.faces() + c.vertices());
            let end = at.saturating_add((*quota).min(1 << 30) as u32).min(all);
            let (from, to) = ((*at).min(faces), end.min(faces));
            let (old_from, old_to) = ((*at).max(faces) - faces, end.max(faces) - faces);
            match self {
                Owned::Quads(q) => {
                    q.fill(*c, from, to);
                    q.fill_vertices(*c, old_from, old_to);
                }
                Owned::Triangles(t) => {
                    t.fill(*c, from, to);
                    t.fill_vertices(*c, old_from, old_to);
                }
            }
            *quota -= (end - *at) as usize;
            *at = end;
            end == all
        })
    }
}

/// A mesh's half-edges, or its texture coordinates', on their way through the levels.
#[derive(Debug)]
struct Track {
    uv: bool,
    level: u32,
    /// Half-edges of `level`; none at level 0, where the mesh has them.
    half_edges: Option<Owned>,
    next: Option<Owned>,
    /// Positions of `level` (none at level 0, or for texture coordinates), and of the next as far as they are made.
    points: Option<Vec<[f32; 3]>>,
    new_points: Vec<[f32; 3]>,
    /// The same for colours or texture coordinates.
    wide: Vec<[f32; 4]>,
    new_wide: Vec<[f32; 4]>,
    stage: Stage,
    corners: Vec<u32>,
    before: Counts,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Points(Cursor),
    Wide(Cursor),
    HalfEdges(u32),
    Corners(u32),
    Done,
}

impl Track {
    fn new(mesh: &Mesh, uv: bool, levels: u32) -> Track {
        let wide = match (&mesh.uv, uv) {
            (Some(channel), true) => channel.values.iter().map(|v| [v[0], v[1], 0.0, 0.0]).collect(),
            (None, true) => Vec::new(),
            (_, false) => mesh.colors.clone(),
        };
        let idle = levels == 0 || (uv && mesh.uv.is_none());
        let mut track = Track {
            uv,
            level: 0,
            half_edges: None,
            next: None,
            points: None,
            new_points: Vec::new(),
            wide,
            new_wide: Vec::new(),
            stage: Stage::Done,
            corners: Vec::new(),
            before: Counts::default(),
        };
        if !idle {
            track.stage = track.first_stage();
        }
        track
    }

    fn first_stage(&self) -> Stage {
        if self.uv { Stage::Wide(Cursor::default()) } else { Stage::Points(Cursor::default()) }
    }

    fn base<'m>(&self, mesh: &'m Mesh) -> &'m Topology {
        match (&mesh.uv, self.uv) {
            (Some(channel), true) => &channel.topology,
            _ => &mesh.topology,
        }
    }

    /// Works off up to `quota` rows.
    fn step(&mut self, mesh: &Mesh, plan: &Plan, split: Split, quota: &mut usize) {
        let base = self.base(mesh);
        while *quota > 0 && self.stage != Stage::Done {
            let level = self.half_edges.as_ref().map_or(Level::Base(base), Owned::view);
            let tags = if self.uv {
                Tags { boundary: Boundary::EdgeAndCorner, sharp: &[] }
            } else {
                Tags { boundary: plan.boundary, sharp: &mesh.sharp }
            };
            let children = on!(&level, c => split.children(*c)) as usize;
            match &mut self.stage {
                Stage::Points(cursor) => {
                    zeroed(&mut self.new_points, children);
                    let old = self.points.as_deref().unwrap_or(&mesh.positions);
                    if plan.scheme.eval((&level, split, tags), old, &mut self.new_points, cursor, quota) {
                        self.stage = Stage::Wide(Cursor::default());
                    }
                }
                Stage::Wide(_) if self.wide.is_empty() => self.stage = self.after_values(plan),
                Stage::Wide(cursor) => {
                    zeroed(&mut self.new_wide, children);
                    let (old, new) = (&self.wide, &mut self.new_wide);
                    let mut take = |child: u32, row: &[(Source, f64)]| {
                        let sum = weigh(row, |s| match s {
                            Source::Old(v) => old[v as usize].map(f64::from),
                            Source::New(v) => new[v as usize].map(f64::from),
                        });
                        new[child as usize] = sum.map(|x| x as f32);
                    };
                    if plan.scheme.rows((&level, split, tags), &mut take, cursor, quota) {
                        self.stage = self.after_values(plan);
                    }
                }
                Stage::HalfEdges(at) => {
                    let next = self.next.get_or_insert_with(|| Owned::below(&level, split));
                    if next.fill(&level, at, quota) {
                        self.half_edges = self.next.take();
                        self.advance();
                        self.stage = self.first_stage();
                    }
                }
                Stage::Corners(at) => {
                    on!(&level, c => {
                        zeroed(&mut self.corners, 4 * c.half_edges() as usize);
                        let end = at.saturating_add((*quota).min(1 << 30) as u32).min(c.faces());
                        split.corners(*c, *at, end, &mut self.corners);
                        *quota -= (end - *at) as usize;
                        *at = end;
                        if end == c.faces() {
                            self.before = c.counts();
                            self.stage = Stage::Done;
                        }
                    });
                    if self.stage == Stage::Done {
                        self.advance();
                        self.half_edges = None;
                    }
                }
                Stage::Done => {}
            }
        }
    }

    fn after_values(&self, plan: &Plan) -> Stage {
        if self.level + 1 == plan.level { Stage::Corners(0) } else { Stage::HalfEdges(0) }
    }

    fn advance(&mut self) {
        self.level += 1;
        if !self.uv {
            self.points = Some(std::mem::take(&mut self.new_points));
        }
        self.wide = std::mem::take(&mut self.new_wide);
    }
}

/// Makes `buffer` of that length, if it is not yet. Asking for zeroed memory beats writing zeros: fresh pages have them.
fn zeroed<T: Clone + bytemuck::Zeroable>(buffer: &mut Vec<T>, length: usize) {
    if buffer.len() != length {
        *buffer = bytemuck::zeroed_vec(length);
    }
}

fn weigh<const N: usize>(row: &[(Source, f64)], value: impl Fn(Source) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for &(source, w) in row {
        let v = value(source);
        for k in 0..N {
            sum[k] += w * v[k];
        }
    }
    sum
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
        let tracks =
            [(Some(mesh.counts()), !mesh.colors.is_empty()), (mesh.uv.as_ref().map(|u| u.topology.counts()), true)];
        for (i, (counts, wide)) in tracks.into_iter().enumerate() {
            let Some(mut c) = counts else { continue };
            for level in 1..=plan.level {
                let Some(next) = split.counts(c) else { break };
                let values = u64::from(i == 0) + u64::from(wide);
                total += values * next.vertices + c.faces + if level < plan.level { c.vertices } else { 0 };
                c = next;
            }
        }
        let (geometry, uv) = (Track::new(&mesh, false, plan.level), Track::new(&mesh, true, plan.level));
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
                counts: t.counts(),
                points: self.mesh.positions.clone(),
                faces,
                uv,
                colors: self.mesh.colors.clone(),
                parent_ranges: None,
                vertex_parents: t.vertices(),
                split: self.split,
                mesh: self.mesh,
            };
        }
        let before = self.geometry.before;
        let (v, f) = (before.vertices as u32, before.faces as u32);
        Refined {
            level,
            counts: self.split.counts(before).unwrap_or_default(),
            points: self.geometry.points.unwrap_or_default(),
            faces: match self.split {
                Split::Quad => Faces::Quads(self.geometry.corners),
                Split::Triangle => Faces::Triangles(self.geometry.corners),
            },
            uv: self.mesh.uv.is_some().then(|| UvValues {
                values: self.uv.wide.iter().map(|v| [v[0], v[1]]).collect(),
                corners: self.uv.corners,
            }),
            colors: self.geometry.wide,
            parent_ranges: (self.split == Split::Quad).then_some([v, v + f]),
            vertex_parents: v,
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
    let tags = Tags { boundary: plan.boundary, sharp: &mesh.sharp };
    let mut old = values.to_vec();
    let mut owned: Option<Owned> = None;
    for step in 0..plan.level {
        let level = owned.as_ref().map_or(Level::Base(&mesh.topology), Owned::view);
        inspect(&level);
        let mut new = vec![[0.0; N]; on!(&level, c => split.children(*c)) as usize];
        let mut take = |child: u32, row: &[(Source, f64)]| {
            new[child as usize] = weigh(row, |s| match s {
                Source::Old(v) => old[v as usize],
                Source::New(v) => new[v as usize],
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
