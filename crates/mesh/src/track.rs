//! One array of half-edges on its way through the levels: the mesh's, or its texture coordinates'.
//!
//! ```text
//!   Fair ─> Points ─> Wide ─> HalfEdges ─┐                     at every level but the last
//!     ^──────────────────────────────────┘
//!   Fair ─> Points ─> Wide ─> Corners ─> Done                  at the last, which is only shown,
//!                                └────> HalfEdges ─> Fair ─> Limit ─> Done    unless something is to be done with it
//! ```
//!
//! A track works off rows until its quota is used up and goes on from there the next time. Memory: two levels at once. What
//! [`Plan::is_here`] leaves to builds with everything stands behind `FULL` here.

mod charted;
// Types of fields and calls are left out where there is nothing: even an empty box has code that drops it.
#[cfg(feature = "full")]
mod dual;
#[cfg(feature = "full")]
mod patched;

#[cfg(feature = "full")]
pub(crate) use patched::Patched;

use crate::FULL;
use crate::crease::Creases;
use crate::face_varying;
use crate::fairing;
use crate::holes;
use crate::limit::Projection;
use crate::mesh::Mesh;
use crate::owned::Owned;
#[cfg(feature = "full")]
use crate::patch;
use crate::plan::{Plan, Step};
use crate::refine::{Kept, sharp_at};
use crate::scheme::{Boundary, FaceVarying, Rules, Tags, scheme};
use crate::sink::{Cursor, Eval, Source, weigh};
use crate::split::stored::Cut;
use crate::split::{FaceKind, Level, Split, on};
use crate::topology::{Connectivity, Counts, Topology};

/// A mesh's half-edges, or its texture coordinates', on their way through the levels.
#[derive(Debug)]
pub(crate) struct Track {
    uv: bool,
    level: u32,
    /// Half-edges of `level`; none at level 0, where the mesh has them.
    half_edges: Option<Owned>,
    next: Option<Owned>,
    /// Positions of `level` (none at level 0, or for texture coordinates), and of the next as far as they are made.
    pub(crate) points: Option<Vec<[f32; 3]>>,
    new_points: Vec<[f32; 3]>,
    /// The same for colours or texture coordinates.
    pub(crate) wide: Vec<[f32; 4]>,
    new_wide: Vec<[f32; 4]>,
    pub(crate) stage: Stage,
    pub(crate) corners: Vec<u32>,
    /// Where the last level's faces begin, what they were made from, and the mesh's face behind each face of `level`; of
    /// stored levels.
    pub(crate) offsets: Vec<u32>,
    pub(crate) kinds: Vec<FaceKind>,
    pub(crate) source: Vec<u32>,
    /// Of `level`, and of the one before it.
    pub(crate) counts: Counts,
    pub(crate) before: Counts,
    /// Vertices of level 0 that stay, corners among them, where later levels cannot tell.
    corner: Vec<bool>,
    /// Texture coordinates of `level` that stay.
    pins: Vec<bool>,
    /// Of texture coordinates, boundary half-edges of `level` that are no boundaries of regions.
    loose: Vec<u32>,
    /// How sharp `level` is.
    creases: Option<Creases>,
    /// Of texture coordinates that have to know how faces meet on seams: the mesh's own half-edges of `level`; none at level 0.
    beside: Option<Owned>,
    /// How sharp these are.
    beside_creases: Option<Creases>,
    charted: bool,
    /// Corners with two images, of `level`.
    lone: Vec<u32>,
    /// Knot intervals of `level`, but at level 0, where the mesh has them.
    knots: Vec<f32>,
    /// Whether faces list what they came from, because arithmetic does not tell.
    listed: bool,
    /// If the last level goes to the limit.
    pub(crate) limit: Option<Projection>,
    /// What patches make.
    #[cfg(feature = "full")]
    pub(crate) patched: Patched,
    /// [`Tags::first_regular`] of `level`.
    #[cfg(feature = "full")]
    first_regular: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    Fair(u32, Cursor),
    Points(Cursor),
    #[cfg(feature = "full")]
    Patches,
    Wide(Cursor),
    HalfEdges(u32),
    Corners(u32),
    Limit(u64),
    Done,
}

impl Track {
    pub(crate) fn new(mesh: &Mesh, uv: bool, plan: &Plan, steps: &[Step], limit: Option<Step>) -> Track {
        let wide = match (&mesh.uv, uv) {
            (Some(channel), true) => channel.values.iter().map(|v| [v[0], v[1], 0.0, 0.0]).collect(),
            (None, true) => Vec::new(),
            (_, false) => mesh.colors.clone(),
        };
        let idle = if uv { !FULL || plan.level == 0 || mesh.uv.is_none() } else { plan.level == 0 && !plan.closes() };
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
            offsets: Vec::new(),
            kinds: Vec::new(),
            source: Vec::new(),
            counts: match (&mesh.uv, uv) {
                (Some(channel), true) => channel.counts,
                _ => mesh.counts(),
            },
            before: Counts::default(),
            corner: Vec::new(),
            pins: Vec::new(),
            loose: Vec::new(),
            creases: None,
            beside: None,
            beside_creases: None,
            charted: FULL && uv && steps.iter().any(|s| !s.split.keeps_corners()),
            lone: Vec::new(),
            limit: limit.filter(|_| FULL).map(Projection::new),
            knots: Vec::new(),
            #[cfg(feature = "full")]
            patched: Patched::default(),
            #[cfg(feature = "full")]
            first_regular: mesh.topology.vertices(),
            listed: steps.windows(2).any(|two| two[0].split.at(0) != two[1].split.at(0)),
        };
        if FULL && let (Some(channel), true, false) = (&mesh.uv, uv, idle) {
            (track.pins, track.loose) = face_varying::pins(mesh, channel, &plan.rules);
        }
        if !uv {
            track.source = holes::sources(mesh, plan.rules.boundary);
            track.listed |= !track.source.is_empty();
            #[cfg(feature = "full")]
            if !track.listed {
                track.patched.from = patch::start(mesh, plan, steps);
            }
        }
        // What is pinned on the way is not known to patches.
        #[cfg(feature = "full")]
        if uv && !idle && !track.charted && !track.listed && plan.rules.face_varying != FaceVarying::Boundaries {
            track.patched.from = patch::start(mesh, plan, steps);
        }
        if !idle {
            track.creases = Creases::of(mesh, track.base(mesh), plan.rules.face_varying);
            if FULL && track.charted {
                track.beside_creases = Creases::of(mesh, &mesh.topology, plan.rules.face_varying);
            }
            track.begin(&Level::Base(track.base(mesh)), plan, steps);
        }
        if FULL && !uv && steps.iter().any(|s| matches!(s.split, Split::Sqrt3 { .. })) {
            track.corner = plan.kept(mesh);
        }
        track
    }

    /// Begins with a level.
    fn begin(&mut self, level: &Level<'_>, plan: &Plan, steps: &[Step]) {
        let step = steps.get(self.level as usize);
        self.lone = step.map_or_else(Vec::new, |s| s.split.lone(level));
        if FULL && self.uv && plan.rules.face_varying == FaceVarying::Boundaries {
            face_varying::pin_boundary(level, &self.loose, &mut self.pins);
        }
        self.stage = match step {
            Some(_) if self.uv => self.first_stage(),
            _ if self.uv => Stage::Done,
            _ if FULL && plan.fairing(self.level).is_some() => Stage::Fair(0, Cursor::default()),
            Some(_) => self.first_stage(),
            None => self.last_stage(),
        };
    }

    /// How the next level, or all that are left, are made.
    fn first_stage(&self) -> Stage {
        #[cfg(feature = "full")]
        if self.patched.from == Some(self.level) {
            return Stage::Patches;
        }
        if self.uv { Stage::Wide(Cursor::default()) } else { Stage::Points(Cursor::default()) }
    }

    /// What is left to be done with the last level.
    fn last_stage(&self) -> Stage {
        if self.limit.is_some() { Stage::Limit(0) } else { Stage::Done }
    }

    fn base<'m>(&self, mesh: &'m Mesh) -> &'m Topology {
        match (&mesh.uv, self.uv) {
            (Some(channel), true) => &channel.topology,
            _ => &mesh.topology,
        }
    }

    /// Works off up to `quota` rows.
    pub(crate) fn step(&mut self, mesh: &Mesh, plan: &Plan, steps: &[Step], quota: &mut usize) {
        let base = self.base(mesh);
        while *quota > 0 && self.stage != Stage::Done {
            let mut held = self.half_edges.take();
            if FULL && self.only_lists(plan) {
                // The most memory is held now: the faces of the last level come to what has made its points.
                self.points = None;
                held.iter_mut().for_each(|held| held.shed(steps[self.level as usize].split));
            }
            let level = held.as_ref().map_or(Level::Base(base), Owned::view);
            let next = self.work(&level, mesh, plan, steps, quota);
            match next {
                Some(next) => {
                    let split = steps[self.level as usize - 1].split;
                    // Charts bring their own.
                    if !self.uv || split.keeps_corners() {
                        self.creases =
                            self.creases.take().zip(next.as_ref()).and_then(|(creases, next)| {
                                creases.below(&level, split, &next.view(), plan.rules.decay)
                            });
                    }
                    self.loose = face_varying::below(&self.loose, &level, split);
                    self.half_edges = next;
                    let level = self.half_edges.take();
                    self.begin(&level.as_ref().map_or(Level::Base(base), Owned::view), plan, steps);
                    self.half_edges = level;
                    if steps[self.level as usize - 1].split.stores() {
                        return; // A whole level is enough for one slice.
                    }
                }
                None => self.half_edges = held,
            }
            if self.limit.as_ref().is_some_and(|l| l.paused) {
                return;
            }
        }
        if self.stage == Stage::Done {
            (self.half_edges, self.beside) = (None, None);
        }
    }

    /// Whether nothing is left to be done but to list the last level's faces.
    fn only_lists(&self, plan: &Plan) -> bool {
        self.stage == Stage::Corners(0) && !self.uv && !plan.closes() && self.creases.is_none()
    }

    /// Works on a level; gives the half-edges of the next when it has come to that.
    fn work(
        &mut self,
        level: &Level<'_>,
        mesh: &Mesh,
        plan: &Plan,
        steps: &[Step],
        quota: &mut usize,
    ) -> Option<Option<Owned>> {
        let sharp = match self.uv {
            true => Kept { sharp: &self.pins, joined: &[] },
            false => sharp_at(steps, self.level, mesh, &self.corner),
        };
        if FULL && let Stage::Fair(pass, cursor) = &mut self.stage {
            let old = self.points.get_or_insert_with(|| mesh.positions.clone());
            zeroed(&mut self.new_points, old.len());
            let creases = self.creases.as_ref();
            let tags =
                Tags { sharp: sharp.sharp, joined: sharp.joined, creases, ..Tags::new(plan.rules, Default::default()) };
            let mut sink = Eval::new(old, &mut self.new_points, cursor, quota);
            fairing::rules(level, *pass, tags, &mut sink);
            if sink.done() {
                mesh.tie(steps, self.level, &mut self.new_points);
                std::mem::swap(old, &mut self.new_points);
                (*pass, *cursor) = (*pass + 1, Cursor::default());
                if *pass == plan.fairing(self.level).map_or(0, |f| f.passes()) {
                    let over = self.level as usize == steps.len();
                    self.stage = if over { self.last_stage() } else { self.first_stage() };
                }
            }
            return None;
        }
        if FULL && let (Stage::Limit(at), Some(limit)) = (&mut self.stage, &mut self.limit) {
            let old = self.points.get_or_insert_with(|| mesh.positions.clone());
            zeroed(&mut self.new_points, old.len());
            let knots = if self.level == 0 { &mesh.knots } else { &self.knots };
            let tags = Tags { knots, ..plan.tags(limit.step(), self.level, sharp, self.creases.as_ref()) };
            if limit.work((level, tags), old, &mut self.new_points, at, quota) {
                mesh.tie(steps, self.level, &mut self.new_points);
                std::mem::swap(old, &mut self.new_points);
                self.stage = Stage::Done;
            }
            return None;
        }
        let at = steps.get(self.level as usize)?;
        let (split, following) = (at.split, steps.get(self.level as usize + 1));
        #[cfg(feature = "full")]
        if self.stage == Stage::Patches {
            return self.patch(level, mesh, plan, steps, quota);
        }
        if FULL && self.uv && !split.keeps_corners() {
            return Some(self.chart(level, mesh, plan, (at, following), quota));
        }
        let tags = plan.tags(at, self.level, sharp, self.creases.as_ref());
        let tags = if self.uv {
            // Corners are among the pins, and no others.
            Tags { rules: Rules { boundary: Boundary::EdgeOnly, ..tags.rules }, lone: &self.lone, ..tags }
        } else {
            let knots = if self.level == 0 { &mesh.knots } else { &self.knots };
            #[cfg(feature = "full")]
            let tags = Tags { first_regular: self.first_regular, ..tags };
            Tags { lone: &self.lone, knots, ..tags }
        };
        let children = split.counts(self.counts).unwrap_or_default().vertices as usize;
        let last = following.is_none();
        let closes = last && !self.uv && plan.closes();
        #[cfg(feature = "full")]
        if matches!(self.stage, Stage::HalfEdges(_) | Stage::Corners(_)) && self.is_arithmetic(mesh, steps) {
            return Some(self.dual(level, steps, closes));
        }
        match &mut self.stage {
            Stage::Points(cursor) => {
                zeroed(&mut self.new_points, children);
                let old = self.points.as_deref().unwrap_or(&mesh.positions);
                if at.scheme.eval((level, split, tags), old, &mut self.new_points, cursor, quota) {
                    mesh.tie(steps, self.level + 1, &mut self.new_points);
                    self.stage = Stage::Wide(Cursor::default());
                }
            }
            Stage::Wide(cursor) => {
                let mut done = !FULL || self.wide.is_empty();
                if !done {
                    zeroed(&mut self.new_wide, children);
                    let (old, new) = (&self.wide, &mut self.new_wide);
                    let mut take = |child: u32, row: &[(Source, f64)], _| {
                        let sum = weigh(row, |s| match s {
                            Source::Vertex(v) => old[v as usize].map(f64::from),
                            Source::Child(v) => new[v as usize].map(f64::from),
                        });
                        new[child as usize] = sum.map(|x| x as f32);
                    };
                    let linear = scheme("linear").filter(|_| self.uv && plan.rules.face_varying == FaceVarying::All);
                    let scheme = linear.filter(|_| !split.stores()).unwrap_or(at.scheme);
                    done = scheme.rows((level, split, tags), &mut take, cursor, quota);
                }
                if done {
                    if FULL && !self.uv && !self.new_wide.is_empty() {
                        mesh.tie(steps, self.level + 1, &mut self.new_wide);
                    }
                    self.stage = if last { Stage::Corners(0) } else { Stage::HalfEdges(0) };
                }
            }
            Stage::Corners(_) if FULL && split.stores() => {
                let Level::Base(t) = level else { unreachable!("a step says when it needs stored half-edges") };
                let mut cut = split.cut(t, tags.creases);
                self.source = self.behind(t, split, &mut cut);
                let half_edges =
                    closes.then(|| Owned::Stored(cut.clone().connect(t, split, children as u32, tags.creases)));
                (self.offsets, self.corners, self.kinds) = (cut.offsets, cut.corners, cut.kinds);
                if closes {
                    self.knots = split.knots(level, tags.knots, &self.lone);
                }
                self.advance(split);
                return Some(half_edges);
            }
            Stage::Corners(at) => {
                on!(level, c => {
                    room(&mut self.corners, 4 * c.half_edges() as usize);
                    let end = at.saturating_add((*quota).min(1 << 30) as u32).min(c.faces());
                    split.corners(*c, *at, end, &mut self.corners);
                    *quota -= (end - *at) as usize;
                    *at = end;
                    if end == c.faces() {
                        self.stage = Stage::HalfEdges(0);
                    }
                });
                if self.stage == Stage::HalfEdges(0) && !closes {
                    self.list(level, split);
                    self.advance(split);
                    return Some(None);
                }
            }
            Stage::HalfEdges(_) if FULL && split.stores() => {
                let Level::Base(t) = level else { unreachable!("a step says when it needs stored half-edges") };
                let mut cut = split.cut(t, tags.creases);
                self.source = self.behind(t, split, &mut cut);
                let stored = cut.connect(t, split, children as u32, tags.creases);
                self.knots = split.knots(level, tags.knots, &self.lone);
                self.follow(mesh, plan, split, following);
                self.advance(split);
                return Some(Some(Owned::Stored(stored)));
            }
            Stage::HalfEdges(at) => {
                let next = self.next.get_or_insert_with(|| Owned::below(level, split, None));
                if next.fill(level, at, quota) {
                    let next = self.next.take().map(|n| n.stored_for(following));
                    self.knots.clear();
                    self.follow(mesh, plan, split, following);
                    self.list(level, split);
                    self.advance(split);
                    return Some(next);
                }
            }
            _ => {}
        }
        None
    }

    /// What is behind the faces that a stored level is cut into.
    fn behind(&self, t: &Topology, split: Split, cut: &mut Cut) -> Vec<u32> {
        let mut source = holes::descend(&self.source, std::mem::take(&mut cut.source));
        holes::hide_between(t, split, &self.source, cut, &mut source);
        source
    }

    /// Lists what the faces of the next level came from, if that is wanted, of a split that does not say so itself.
    fn list(&mut self, level: &Level<'_>, split: Split) {
        if FULL && self.listed && !self.uv {
            let mut parents = Vec::new();
            split.parents(level, &mut parents);
            self.source = holes::descend(&self.source, parents);
        }
    }

    fn advance(&mut self, split: Split) {
        #[cfg(feature = "full")]
        if !split.makes_regular(&self.counts, self.creases.is_some()) {
            self.first_regular = u32::MAX;
        }
        self.level += 1;
        self.before = self.counts;
        self.counts = split.counts(self.counts).unwrap_or_default();
        if !self.uv {
            self.points = Some(std::mem::take(&mut self.new_points));
        }
        self.wide = std::mem::take(&mut self.new_wide);
    }
}

/// Makes room for that many in `buffer`.
fn room<T>(buffer: &mut Vec<T>, length: usize) {
    buffer.reserve_exact(length - buffer.len());
}

/// Makes `buffer` of that length, if it is not yet. Asking for zeroed memory beats writing zeros: fresh pages have them.
fn zeroed<T: Clone + bytemuck::Zeroable>(buffer: &mut Vec<T>, length: usize) {
    if buffer.len() != length {
        *buffer = bytemuck::zeroed_vec(length);
    }
}
