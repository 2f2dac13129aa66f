//! One array of half-edges on its way through the levels: the mesh's, or its texture coordinates'.
//!
//! ```text
//!   Points ─> Wide ─> HalfEdges ─┐         at every level but the last
//!     ^──────────────────────────┘
//!   Points ─> Wide ─> Corners ─> Done      at the last, which is only shown
//! ```
//!
//! A track works off rows until its quota is used up and goes on from there the next time. Memory: two levels at once.

use crate::mesh::Mesh;
use crate::refine::Plan;
use crate::scheme::{Boundary, Tags};
use crate::sink::{Cursor, Source};
use crate::split::{FaceKind, Level, QuadLevel, Split, TriangleLevel, on};
use crate::topology::{Connectivity, Counts, Topology};

/// Half-edges of a level between the first and the last.
#[derive(Debug)]
pub(crate) enum Owned {
    Quads(QuadLevel),
    Triangles(TriangleLevel),
    Stored(Topology),
}

impl Owned {
    /// The level below, to be filled. A stored one comes whole.
    pub(crate) fn below(parent: &Level<'_>, split: Split) -> Owned {
        match (split, parent) {
            (Split::Quad, _) => Owned::Quads(QuadLevel::below(parent)),
            (Split::Triangle, _) => Owned::Triangles(TriangleLevel::below(parent)),
            (_, Level::Base(t)) => Owned::Stored(split.cut(t).connect(t, split, split.children(*t))),
            _ => unreachable!("stored levels come of stored levels"),
        }
    }

    pub(crate) fn view(&self) -> Level<'_> {
        match self {
            Owned::Quads(q) => Level::Quads(q),
            Owned::Triangles(t) => Level::Triangles(t),
            Owned::Stored(t) => Level::Base(t),
        }
    }

    /// Fills up to `quota` faces, then vertices; true when complete.
    pub(crate) fn fill(&mut self, parent: &Level<'_>, at: &mut u32, quota: &mut usize) -> bool {
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
                Owned::Stored(_) => {}
            }
            *quota -= (end - *at) as usize;
            *at = end;
            end == all
        })
    }
}

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
    /// Corners with two images, of `level`.
    lone: Vec<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    Points(Cursor),
    Wide(Cursor),
    HalfEdges(u32),
    Corners(u32),
    Done,
}

impl Track {
    pub(crate) fn new(mesh: &Mesh, uv: bool, plan: &Plan, split: Split) -> Track {
        let wide = match (&mesh.uv, uv) {
            (Some(channel), true) => channel.values.iter().map(|v| [v[0], v[1], 0.0, 0.0]).collect(),
            (None, true) => Vec::new(),
            (_, false) => mesh.colors.clone(),
        };
        let idle = plan.level == 0 || (uv && (mesh.uv.is_none() || split.stores()));
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
            lone: split.lone(&mesh.topology),
        };
        if !idle {
            track.stage = track.first_stage();
        }
        if let (Split::Sqrt3 { .. }, false) = (split, uv) {
            track.corner = plan.kept(mesh);
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
    pub(crate) fn step(&mut self, mesh: &Mesh, plan: &Plan, split: Split, quota: &mut usize) {
        let base = self.base(mesh);
        while *quota > 0 && self.stage != Stage::Done {
            let level = self.half_edges.as_ref().map_or(Level::Base(base), Owned::view);
            let tags = if self.uv {
                Tags { boundary: Boundary::EdgeAndCorner, ..plan.tags(&[]) }
            } else {
                let sharp = if self.corner.is_empty() { &mesh.sharp } else { &self.corner };
                Tags { lone: &self.lone, ..plan.tags(sharp) }
            };
            let split = split.at(self.level);
            let children = split.counts(self.counts).unwrap_or_default().vertices as usize;
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
                            Source::Vertex(v) => old[v as usize].map(f64::from),
                            Source::Child(v) => new[v as usize].map(f64::from),
                        });
                        new[child as usize] = sum.map(|x| x as f32);
                    };
                    if plan.scheme.rows((&level, split, tags), &mut take, cursor, quota) {
                        self.stage = self.after_values(plan);
                    }
                }
                Stage::HalfEdges(_) if split.stores() => {
                    let Level::Base(t) = level else { unreachable!("stored levels come of stored levels") };
                    let cut = split.cut(t);
                    let stored = cut.connect(t, split, children as u32);
                    self.source = descend(&self.source, cut.source);
                    self.lone = split.lone(&stored);
                    self.half_edges = Some(Owned::Stored(stored));
                    self.advance(split);
                    self.stage = self.first_stage();
                    return; // A whole level is enough for one slice.
                }
                Stage::HalfEdges(at) => {
                    let next = self.next.get_or_insert_with(|| Owned::below(&level, split));
                    if next.fill(&level, at, quota) {
                        self.half_edges = self.next.take();
                        self.advance(split);
                        self.stage = self.first_stage();
                    }
                }
                Stage::Corners(_) if split.stores() => {
                    let Level::Base(t) = level else { unreachable!("stored levels come of stored levels") };
                    let cut = split.cut(t);
                    self.source = descend(&self.source, cut.source);
                    (self.offsets, self.corners, self.kinds) = (cut.offsets, cut.corners, cut.kinds);
                    self.stage = Stage::Done;
                    self.advance(split);
                    self.half_edges = None;
                }
                Stage::Corners(at) => {
                    on!(&level, c => {
                        zeroed(&mut self.corners, 4 * c.half_edges() as usize);
                        let end = at.saturating_add((*quota).min(1 << 30) as u32).min(c.faces());
                        split.corners(*c, *at, end, &mut self.corners);
                        *quota -= (end - *at) as usize;
                        *at = end;
                        if end == c.faces() {
                            self.stage = Stage::Done;
                        }
                    });
                    if self.stage == Stage::Done {
                        self.advance(split);
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

    fn advance(&mut self, split: Split) {
        self.level += 1;
        self.before = self.counts;
        self.counts = split.counts(self.counts).unwrap_or_default();
        if !self.uv {
            self.points = Some(std::mem::take(&mut self.new_points));
        }
        self.wide = std::mem::take(&mut self.new_wide);
    }
}

/// The mesh's faces behind a level's, from those behind its parent's (empty where they are the same).
fn descend(parent: &[u32], mut source: Vec<u32>) -> Vec<u32> {
    if !parent.is_empty() {
        source.iter_mut().for_each(|f| *f = parent[*f as usize]);
    }
    source
}

/// Makes `buffer` of that length, if it is not yet. Asking for zeroed memory beats writing zeros: fresh pages have them.
fn zeroed<T: Clone + bytemuck::Zeroable>(buffer: &mut Vec<T>, length: usize) {
    if buffer.len() != length {
        *buffer = bytemuck::zeroed_vec(length);
    }
}

pub(crate) fn weigh<const N: usize>(row: &[(Source, f64)], value: impl Fn(Source) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for &(source, w) in row {
        let v = value(source);
        for k in 0..N {
            sum[k] += w * v[k];
        }
    }
    sum
}
