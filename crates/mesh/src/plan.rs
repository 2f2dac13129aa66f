//! What to refine by: a scheme, or one scheme after the other, with rules for rims and marks, and fairing between.
//!
//! ```text
//!   level   0 ────── 1 ────── 2 ────── 3
//!   step        0        1        2           step k makes level k + 1 by the run that holds there
//!   runs    doo-sabin    └ catmull-clark from=1
//!   fair    at=0     before step 0
//! ```
//!
//! A step's split follows from its scheme and from the shape of the faces that are there ([`crate::FaceShape`]), so a plan can be
//! walked, predicted and refused without a mesh being touched. Cost: constant a step.

use crate::FULL;
use crate::crease::Creases;
use crate::fairing::Fairing;
use crate::limit::LimitRule;
use crate::marks::INFINITE;
use crate::mesh::Mesh;
use crate::refine::{Kept, RefineError};
use crate::scheme::{Accepts, Boundary, Entry, Honours, MOST_PARAMS, Params, Rules, Tags};
use crate::split::{Split, Triangles};
use crate::topology::Connectivity;

/// What to refine by, and how far.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The scheme of the first step, and of all others up to the first of `later`.
    pub scheme: &'static Entry,
    /// Its parameters.
    pub params: Params,
    /// Schemes that take over at a later step, by rising `from`, all different and at least 1.
    pub later: Vec<Run>,
    /// What holds for all of them.
    pub rules: Rules,
    /// Fairing at levels, by rising `at`, all different.
    pub fairings: Vec<Fairing>,
    /// Whether the points of the last level are moved to where they go in the limit.
    pub limit: bool,
    /// How many times; 0 is the mesh itself.
    pub level: u32,
}

/// A scheme from a step on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// The first step that it makes, and the level that it begins with.
    pub from: u32,
    /// The scheme.
    pub scheme: &'static Entry,
    /// Its parameters.
    pub params: Params,
}

/// The first level that is made of patches (`patch/`): they start at level 1 and are cut twice at least.
pub(crate) const PATCHED: u32 = 3;

/// One step of a plan on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub scheme: &'static Entry,
    pub params: [f64; MOST_PARAMS],
    pub split: Split,
    /// The mean length of the mesh's edges, for schemes that ask for it.
    pub size: f64,
    /// Whether the level that it begins with must have its half-edges stored in full.
    pub stored: bool,
}

/// How the half-edges of a level are held.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    Full,
    Quads,
    Triangles,
}

impl Mesh {
    /// Which marks there are. Cost: every edge and vertex where there are any, so whoever asks often keeps the answer.
    pub fn marks(&self) -> Honours {
        let both = || self.edge_sharpness.iter().chain(&self.vertex_sharpness);
        Honours {
            semi_sharp: both().any(|&s| s > 0.0 && s < INFINITE),
            creases: self.edge_sharpness.iter().any(|&s| s >= INFINITE),
            corners: self.vertex_sharpness.iter().any(|&s| s >= INFINITE),
        }
    }
}

impl Plan {
    /// A plan of one scheme with its own parameters.
    pub fn new(scheme: &'static Entry, boundary: Boundary, level: u32) -> Plan {
        Plan {
            scheme,
            params: Params::default(),
            later: Vec::new(),
            rules: Rules { boundary, ..Rules::default() },
            fairings: Vec::new(),
            limit: false,
            level,
        }
    }

    /// The same to another level.
    pub fn to(&self, level: u32) -> Plan {
        Plan { level, ..self.clone() }
    }

    /// Whether this build can make the plan on `mesh`: with the feature `full` every plan, without it common ones.
    pub fn is_here(&self, mesh: &Mesh) -> bool {
        FULL || self.is_common(mesh)
    }

    /// Whether the plan is one of those that are chosen most: a common scheme alone, on a mesh without creases, holes, ties,
    /// colours and texture coordinates, as far as it goes level by level; or the mesh itself. A build without the feature `full` has
    /// the code for these. This is the one place to say so of something new.
    pub fn is_common(&self, mesh: &Mesh) -> bool {
        let closed = self.fairings.iter().all(|f| f.at > self.level) && !self.projects();
        let plain = self.scheme.common && self.later.is_empty() && self.level < PATCHED;
        let smooth = mesh.edge_sharpness.is_empty() && mesh.vertex_sharpness.is_empty();
        let bare = mesh.colors.is_empty() && mesh.uv.is_none() && mesh.tied.is_empty();
        let shown = mesh.holes.is_empty() && self.rules.boundary != Boundary::None;
        closed && shown && (self.level == 0 || (plain && smooth && bare))
    }

    /// The run that makes step `step`.
    pub fn run(&self, step: u32) -> Run {
        let first = Run { from: 0, scheme: self.scheme, params: self.params };
        self.later.iter().rev().find(|run| run.from <= step).copied().unwrap_or(first)
    }

    /// The split of the first step on `mesh`.
    ///
    /// # Errors
    /// [`RefineError::NeedsTriangles`].
    pub fn split(&self, mesh: &Mesh) -> Result<Split, RefineError> {
        let one = self.to(1);
        one.walk(mesh).next().map_or(Ok(Split::Quad), |step| step.map(|s| s.split))
    }

    /// The steps on `mesh`, one after the other, up to the first that cannot be made.
    pub(crate) fn walk<'p>(&'p self, mesh: &'p Mesh) -> impl Iterator<Item = Result<Step, RefineError>> + 'p {
        let mut shape = mesh.face_shape();
        let random = self.scheme.info.is_random() || self.later.iter().any(|run| run.scheme.info.is_random());
        let size = if FULL && random { mean_edge(mesh) } else { 0.0 };
        let (mut held, mut uncounted) = (Held::Full, false);
        (0..self.level).map(move |step| {
            let run = self.run(step);
            let info = &run.scheme.info;
            let params = run.params.of(info);
            let split = match info.split(shape, self.rules.boundary, &params) {
                Some(Split::Mixed | Split::NWay { triangles: Triangles::Some, .. }) if uncounted => {
                    return Err(RefineError::Uncounted { scheme: info.name, level: step });
                }
                Some(split) => split.at(step - run.from),
                None if step > 0 => return Err(RefineError::NeedsTrianglesAt { scheme: info.name, level: step }),
                None => {
                    let t = &mesh.topology;
                    let odd = (0..t.faces()).find(|&f| t.face_half_edges(f).len() != 3).unwrap_or(0);
                    return Err(RefineError::NeedsTriangles {
                        scheme: info.name,
                        face: mesh.face_source[odd as usize],
                        corners: t.face_half_edges(odd).len() as u32,
                    });
                }
            };
            let stored =
                split.stores() || (held == Held::Triangles && info.behind(&params).accepts == Accepts::Polygons);
            shape = split.face_shape(shape);
            uncounted = matches!(split, Split::Dual { .. } | Split::MidEdge { .. });
            held = match split {
                Split::Quad => Held::Quads,
                Split::Triangle => Held::Triangles,
                _ => Held::Full,
            };
            Ok(Step { scheme: run.scheme, params, split, size, stored })
        })
    }

    /// The first scheme of the plan to which some of these marks mean nothing, and which do mean something to it; at
    /// level 0 the one that would come first. `marks` are the mesh's: [`Mesh::marks`].
    pub fn ignores(&self, marks: Honours) -> Option<(&'static Entry, Honours)> {
        let ignores = |e: &'static Entry| {
            let honours = e.honours;
            let some = marks.semi_sharp && !honours.semi_sharp
                || marks.creases && !honours.creases
                || marks.corners && !honours.corners;
            some.then_some((e, honours))
        };
        (0..self.level.max(1)).map(|step| self.run(step).scheme).find_map(ignores)
    }

    /// What rules have to know of the plan at a step, and of the sharp vertices.
    pub(crate) fn tags<'a>(&self, step: &Step, at: u32, kept: Kept<'a>, creases: Option<&'a Creases>) -> Tags<'a> {
        let Kept { sharp, joined } = kept;
        Tags { sharp, joined, creases, step: at, size: step.size, ..Tags::new(self.rules, step.params) }
    }

    /// The vertices of level 0 that stay: what the mesh keeps, and corners where the boundary rule says so.
    pub(crate) fn kept(&self, mesh: &Mesh) -> Vec<bool> {
        let t = &mesh.topology;
        let tags = Tags { sharp: &mesh.sharp, joined: &mesh.joined, ..Tags::new(self.rules, [0.0; MOST_PARAMS]) };
        let kept = |v: u32| mesh.vertex_sharpness.get(v as usize).is_some_and(|&s| s >= INFINITE);
        (0..t.vertices()).map(|v| kept(v) || tags.is_sharp(t, v)).collect()
    }

    /// The fairing at `level`, if any.
    pub(crate) fn fairing(&self, level: u32) -> Option<Fairing> {
        self.fairings.iter().find(|f| f.at == level && f.iterations > 0).copied()
    }

    /// Whether something is left to be done with the half-edges of the last level.
    pub(crate) fn closes(&self) -> bool {
        self.fairing(self.level).is_some() || self.projects()
    }

    /// Whether the last level's points are moved.
    pub(crate) fn projects(&self) -> bool {
        let run = self.run(self.level);
        self.limit && run.scheme.behind(&run.params.of(&run.scheme.info)).limit != LimitRule::Itself
    }

    /// The step that would come after the last: its rules say where the last level's points go in the limit.
    ///
    /// # Errors
    /// [`RefineError::NeedsTriangles`] and [`RefineError::NeedsTrianglesAt`].
    pub(crate) fn beyond(&self, mesh: &Mesh) -> Result<Option<Step>, RefineError> {
        let one_more = self.to(self.level.saturating_add(1));
        one_more.walk(mesh).nth(self.level as usize).transpose()
    }
}

/// The mean length of a mesh's edges. Cost: linear.
pub fn mean_edge(mesh: &Mesh) -> f64 {
    let t = &mesh.topology;
    let length = |e: u32| {
        let h = t.edge_half_edge(e);
        let [p, q] = [h, t.next(h)].map(|h| mesh.positions[t.origin(h) as usize].map(f64::from));
        (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>().sqrt()
    };
    (0..t.edges()).map(length).sum::<f64>() / f64::from(t.edges())
}
