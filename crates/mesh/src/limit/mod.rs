//! The limit: where a level's vertices end up after infinitely many refinements, and the surface's tangents there.
//!
//! Refining does the same thing over and over in a neighbourhood of a vertex, a matrix S on the points of its ring. Its
//! left eigenvector for the eigenvalue 1 gives the point that the vertex goes to, those for the next two eigenvalues the
//! tangents: weights on points that there are already, a [`Mask`].
//!
//! ```text
//!        4      1                          p∞ = sum of weights x points / sum of weights
//!    1 --.-- 4 --.                         normal = tangent x tangent, counter-clockwise faces outwards
//!        |       |
//!    4 - v n^2 - 4      Catmull-Clark: n^2, 4 and 1, over n (n + 5)
//!        |       |
//!    1 --.-- 4 --.
//! ```
//!
//! [`Projector`] finds the mask of any vertex: in closed form for Catmull-Clark, Loop, sqrt3 and mid-edge with their boundaries
//! and corners and for Doo-Sabin inside, by eigen-analysis of the scheme's own rows everywhere else. An interpolating scheme's vertices stay; a dual
//! scheme's, which cut themselves off at every step, go where the mean of their images does.
//!
//! Sources: M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using Catmull-Clark surfaces" (1993); C. Loop
//! (1987); D. Zorin, P. Schroeder, "Subdivision for modeling and animation" (2000, chapter 3) for the analysis.
//! Cost: 200 to 300 ns a vertex in closed form, refinement included. Limit: tangents span the tangent plane and are not derivatives of any
//! parameters. Constants that a rule adds (a fractal's) are left out: the limit is that of the smooth scheme from there on.

mod analysis;
mod catmull_clark;
mod doo_sabin;
mod eigen;
#[path = "loop.rs"]
mod loop_;
mod mid_edge;
mod patch;
mod sqrt3;

use analysis::{Analysis, Setting};

use crate::apart::Apart;
use crate::crease::Creases;
use crate::marks::INFINITE;
use crate::plan::Step;
use crate::scheme::{Entry, Tags, TriangleRule};
use crate::split::{Level, Split};
use crate::topology::Connectivity;

/// How the limit of a scheme's vertices is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitRule {
    /// Catmull-Clark's masks.
    CatmullClark,
    /// Loop's masks.
    Loop,
    /// Sqrt3's masks.
    Sqrt3,
    /// Mid-edge's masks.
    MidEdge,
    /// Doo-Sabin's masks, or those of its midpoint variant.
    DooSabin {
        /// Which.
        midpoint: bool,
    },
    /// By eigen-analysis of what the scheme does around a vertex.
    Analysis,
    /// Vertices are where they are, and there are no tangents: the surface is that of the mesh.
    Itself,
}

/// The weights that give one vertex's limit: of its point, and of two tangents for each sector (a part of its
/// neighbourhood between creases; one where there are none). A vertex of the level may occur more than once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mask {
    /// Vertices and their weights, which add up to one.
    pub point: Vec<(u32, f64)>,
    /// Vertices, their weights in both tangents, which add up to zero, and the sector, in order of sectors.
    pub tangents: Vec<(u32, [f64; 2], u32)>,
    /// How many sectors there are; 0 if there is no tangent plane.
    pub sectors: u32,
}

impl Mask {
    fn clear(&mut self) {
        self.point.clear();
        self.tangents.clear();
        self.sectors = 0;
    }

    /// The vertex stays, and nothing is said about tangents.
    fn keep(&mut self, v: u32) {
        self.clear();
        self.point.push((v, 1.0));
    }

    /// The limit point, or that of any other values of the vertices. The sum runs in the order of the mask.
    pub fn point<const N: usize>(&self, at: impl Fn(u32) -> [f64; N]) -> [f64; N] {
        let mut sum = [0.0; N];
        for &(v, w) in &self.point {
            sum.iter_mut().zip(at(v)).for_each(|(s, x)| *s += w * x);
        }
        sum
    }

    /// Two tangents of a sector: a basis of the plane, turning as the faces do.
    pub fn tangents(&self, sector: u32, at: impl Fn(u32) -> [f64; 3]) -> [[f64; 3]; 2] {
        let mut t = [[0.0; 3]; 2];
        for &(v, w, s) in &self.tangents {
            if s == sector {
                let p = at(v);
                for k in 0..3 {
                    t[0][k] += w[0] * p[k];
                    t[1][k] += w[1] * p[k];
                }
            }
        }
        t
    }

    /// The unit normal, on a crease the mean of its sides'; none where tangents are missing, parallel or zero.
    pub fn normal(&self, at: impl Fn(u32) -> [f64; 3]) -> Option<[f64; 3]> {
        let mut sum = [0.0; 3];
        let mut rest = &self.tangents[..];
        while let Some(&(first, _, sector)) = rest.first() {
            // The tangents, and how large their cross product could be: to tell it from rounding.
            let from = at(first);
            let (mut t, mut weights, mut spread) = ([[0.0; 3]; 2], [0.0; 2], 0.0f64);
            while let Some((&(v, w, _), more)) = rest.split_first().filter(|(one, _)| one.2 == sector) {
                let p = at(v);
                for k in 0..3 {
                    // Weights sum to zero: differences lose less than coordinates.
                    let x = p[k] - from[k];
                    t[0][k] += w[0] * x;
                    t[1][k] += w[1] * x;
                    spread = spread.max(x.abs());
                }
                weights = [weights[0] + w[0].abs(), weights[1] + w[1].abs()];
                rest = more;
            }
            let n = unit(cross(t[0], t[1]), spread * weights[0] * (spread * weights[1]))?;
            sum = [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]];
        }
        unit(sum, f64::from(self.sectors))
    }
}

/// `v` at length one; none if it is no more than rounding in sums of this size.
fn unit(v: [f64; 3], size: f64) -> Option<[f64; 3]> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (length > 1e-9 * size && length.is_normal()).then(|| v.map(|x| x / length))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The faces around a vertex as they are turned through.
#[derive(Debug, Default)]
struct Ring {
    /// The half-edges that leave the vertex; one a face.
    spokes: Vec<u32>,
    /// The half-edge that arrives along the boundary, behind the last face.
    arriving: Option<u32>,
    /// The neighbours: one a face, and on a boundary one more.
    neighbours: Vec<u32>,
    /// The neighbours across creases and boundaries, by their places in `neighbours`.
    creases: Vec<u32>,
    /// Whether rules here change from level to level, or are none of the closed forms: sharpness that fades, a dart.
    fading: bool,
    /// cos and sin of 2 pi i / n, by n and i, as far as they were needed.
    roots: Vec<Vec<[f64; 2]>>,
}

/// Tables are kept up to this valence.
const MOST_ROOTS: usize = 64;

impl Ring {
    /// Turns around the vertex that `start` leaves, from there on. Cost: the valence.
    fn read(&mut self, c: &impl Connectivity, start: u32, marks: Option<&Creases>) {
        let Ring { spokes, neighbours, creases, fading, .. } = self;
        spokes.clear();
        neighbours.clear();
        creases.clear();
        self.arriving = c.turn_from(start, |h| {
            spokes.push(h);
            neighbours.push(c.origin(c.next(h)));
        });
        if let Some(arriving) = self.arriving {
            neighbours.push(c.origin(arriving));
        }
        *fading = false;
        if let Some(marks) = marks {
            let s = marks.vertex(c.origin(start));
            *fading = s > 0.0 && s < INFINITE || marks.beyond(c.origin(start)).is_some();
            for (i, &h) in spokes.iter().enumerate() {
                let s = marks.along(c, h);
                creases.extend((s >= INFINITE).then_some(i as u32));
                *fading |= s > 0.0 && s < INFINITE;
            }
        } else if self.arriving.is_some() {
            creases.push(0);
        }
        creases.extend(self.arriving.map(|_| spokes.len() as u32));
        // The points of a crease that ends here are not those of the smooth rule.
        *fading |= creases.len() == 1;
        let n = if self.arriving.is_some() { 2 * self.spokes.len() } else { self.spokes.len() };
        if n >= self.roots.len() && n <= MOST_ROOTS {
            self.roots.resize(n + 1, Vec::new());
        }
        if let Some(table) = self.roots.get_mut(n).filter(|t| t.is_empty()) {
            table.extend((0..n).map(|i| root(i, n)));
        }
    }

    /// cos and sin of 2 pi i / n.
    #[inline(always)]
    fn root(&self, i: usize, n: usize) -> [f64; 2] {
        let i = if i >= n { i % n } else { i };
        match self.roots.get(n).and_then(|t| t.get(i)) {
            Some(root) => *root,
            None => root(i, n),
        }
    }

    /// The place of the neighbour after place `i`.
    fn after(&self, i: usize) -> usize {
        if i + 1 == self.neighbours.len() { 0 } else { i + 1 }
    }

    /// How many sectors creases and boundaries part the faces into; a boundary has nothing behind its last crease.
    fn sectors(&self) -> u32 {
        self.creases.len() as u32 - u32::from(self.arriving.is_some())
    }

    /// The place of a sector's first neighbour, and the number of its faces.
    fn sector(&self, sector: u32) -> (usize, usize) {
        let from = self.creases[sector as usize] as usize;
        let to =
            self.creases.get(sector as usize + 1).map_or(self.creases[0] as usize + self.spokes.len(), |c| *c as usize);
        (from, to - from)
    }

    /// The tangents at a corner: towards the creases on both sides of each sector. With more than two faces between them
    /// the surface has no tangent plane there, and nothing is said.
    fn corner_tangents(&self, v: u32, mask: &mut Mask) {
        if self.creases.is_empty() || (0..self.sectors()).any(|s| self.sector(s).1 > 2) {
            return;
        }
        for sector in 0..self.sectors() {
            let (first, faces) = self.sector(sector);
            let last = (first + faces) % self.neighbours.len();
            mask.tangents.push((self.neighbours[first], [1.0, 0.0], sector));
            mask.tangents.push((self.neighbours[last], [0.0, 1.0], sector));
            mask.tangents.push((v, [-1.0, -1.0], sector));
        }
        mask.sectors = self.sectors();
    }

    fn kind(&self, sharp: bool) -> Kind {
        match self.creases[..] {
            _ if sharp => Kind::Corner,
            [] | [_] => Kind::Smooth,
            [a, b] => Kind::Curve(a, b),
            _ => Kind::Corner,
        }
    }
}

fn root(i: usize, n: usize) -> [f64; 2] {
    let angle = 2.0 * std::f64::consts::PI * i as f64 / n as f64;
    [libm::cos(angle), libm::sin(angle)]
}

/// What rules a vertex follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Smooth,
    /// On a crease or boundary, with the places of its two neighbours along it.
    Curve(u32, u32),
    Corner,
}

/// Finds the masks of a level's vertices. What it had to analyse it keeps for the next vertex of the same kind.
#[derive(Debug)]
pub struct Projector<'a> {
    rule: LimitRule,
    scheme: &'static Entry,
    level: &'a Level<'a>,
    split: Split,
    tags: Tags<'a>,
    ring: Ring,
    analysis: Analysis,
    mask: Mask,
}

impl<'a> Projector<'a> {
    /// For the vertices of `level`, which `scheme` would refine by `split` with `tags`.
    pub fn new(scheme: &'static Entry, (level, split, tags): (&'a Level<'a>, Split, Tags<'a>)) -> Projector<'a> {
        // A wrapper's constants are left out, so what is left is the scheme behind it.
        let behind = scheme.behind(&tags.params);
        let params = if behind == scheme { tags.params } else { Default::default() };
        let (scheme, tags) = (behind, Tags { params, ..tags });
        let (ring, mask) = (Ring::default(), Mask::default());
        Projector { rule: scheme.limit, scheme, level, split, tags, ring, analysis: Analysis::new(split), mask }
    }

    /// The same by eigen-analysis, even where closed forms are known: slower, and the proof of them.
    pub fn by_analysis(scheme: &'static Entry, on: (&'a Level<'a>, Split, Tags<'a>)) -> Projector<'a> {
        Projector { rule: LimitRule::Analysis, ..Projector::new(scheme, on) }
    }

    /// The mask of vertex `v`. Cost: the valence, or what [`LimitRule::Analysis`] takes.
    pub fn mask(&mut self, v: u32) -> &Mask {
        let (c, tags, mask) = (self.level, self.tags, &mut self.mask);
        mask.clear();
        match self.rule {
            LimitRule::Sqrt3 => {
                let trisect = self.split == (Split::Sqrt3 { trisect: true });
                match tags.creases {
                    Some(creases) => {
                        let tags = Tags { creases: None, ..tags };
                        sqrt3::parts(&Apart::turned(c, creases), &mut self.ring, trisect, v, tags, mask);
                    }
                    None => {
                        self.ring.read(c, c.vertex_half_edge(v), None);
                        let kind = self.ring.kind(tags.is_sharp(c, v));
                        sqrt3::mask(c, &self.ring, (kind, trisect), v, tags, mask);
                    }
                }
            }
            LimitRule::CatmullClark | LimitRule::Loop => {
                self.ring.read(c, c.vertex_half_edge(v), tags.creases);
                let kind = self.ring.kind(tags.is_sharp(c, v));
                // The closed forms know marks that last, and one rule for triangles.
                let odd = |h: &u32| c.face_half_edges(c.face(*h)).len() != 4;
                let smooth = self.rule == LimitRule::CatmullClark && tags.rules.triangle == TriangleRule::Smooth;
                if self.ring.fading || (smooth && self.ring.spokes.iter().any(odd)) {
                    let setting = Setting { scheme: self.scheme, split: self.split, tags };
                    self.analysis.mask(c, setting, v, mask);
                    return &self.mask;
                }
                match self.rule {
                    LimitRule::Loop => loop_::mask(&self.ring, kind, v, tags, mask),
                    _ => catmull_clark::mask(c, &self.ring, kind, v, mask),
                }
            }
            LimitRule::MidEdge => {
                self.ring.read(c, c.vertex_half_edge(v), None);
                mid_edge::mask(c, &self.ring, self.split, v, mask);
            }
            LimitRule::DooSabin { midpoint } => {
                self.ring.read(c, c.vertex_half_edge(v), None);
                if self.ring.arriving.is_none() && self.ring.spokes.len() > 2 {
                    doo_sabin::mask(c, &self.ring, midpoint, mask);
                } else {
                    let setting = Setting { scheme: self.scheme, split: self.split, tags };
                    self.analysis.mask(c, setting, v, mask);
                }
            }
            LimitRule::Analysis => {
                let setting = Setting { scheme: self.scheme, split: self.split, tags };
                self.analysis.mask(c, setting, v, mask);
            }
            LimitRule::Itself => mask.keep(v),
        }
        &self.mask
    }
}

/// A level's vertices in the limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limit {
    /// Where they end up.
    pub points: Vec<[f64; 3]>,
    /// Unit normals, outwards where faces run counter-clockwise; none where there is no tangent plane.
    pub normals: Vec<Option<[f64; 3]>>,
    /// Two tangents, of the first sector on a crease; zero where there is no tangent plane.
    pub tangents: Vec<[[f64; 3]; 2]>,
}

/// Points on their way to the limit, in slices.
#[derive(Debug)]
pub(crate) struct Projection {
    /// The step that would come next: its rules are those of the limit.
    step: Step,
    analysis: Analysis,
    /// Unit normals, as far as they are found; zero where there is no tangent plane.
    pub normals: Vec<[f32; 3]>,
    /// Whether a new kind of neighbourhood was met just now: time to see whether anybody waits.
    pub paused: bool,
}

impl Projection {
    pub fn new(step: Step) -> Projection {
        Projection { step, analysis: Analysis::new(step.split), normals: Vec::new(), paused: false }
    }

    /// The step that would come next.
    pub fn step(&self) -> &Step {
        &self.step
    }

    /// How many rows' time a vertex takes.
    pub fn cost(scheme: &Entry) -> u32 {
        // Rims may be analysed.
        if matches!(scheme.limit, LimitRule::Analysis | LimitRule::DooSabin { .. }) { 24 } else { 4 }
    }

    /// Works off up to `quota` rows of `at ..`, or up to the next new kind of neighbourhood, from `old` to `new` points; true
    /// when all are done.
    pub fn work(
        &mut self,
        (level, tags): (&Level<'_>, Tags<'_>),
        old: &[[f32; 3]],
        new: &mut [[f32; 3]],
        at: &mut u64,
        quota: &mut usize,
    ) -> bool {
        let cost = u64::from(Projection::cost(self.step.scheme));
        let all = cost * old.len() as u64;
        let mut end = all.min(at.saturating_add(*quota as u64));
        let (from, to) = (at.div_ceil(cost) as u32, end.div_ceil(cost) as u32);
        let mut projector = Projector::new(self.step.scheme, (level, self.step.split, tags));
        std::mem::swap(&mut projector.analysis, &mut self.analysis);
        self.normals.reserve_exact(old.len() - self.normals.len());
        let p = |v: u32| old[v as usize].map(f64::from);
        let made = projector.analysis.made;
        self.paused = false;
        for v in from..to {
            let mask = projector.mask(v);
            new[v as usize] = mask.point(p).map(|x| x as f32);
            self.normals.push(mask.normal(p).unwrap_or_default().map(|x| x as f32));
            if projector.analysis.made > made {
                self.paused = true;
                end = end.min(cost * (u64::from(v) + 1));
                break;
            }
        }
        std::mem::swap(&mut projector.analysis, &mut self.analysis);
        *quota -= (end - *at) as usize;
        *at = end;
        end == all
    }
}

/// Projects all vertices of `level`, at `points`, to the limit of `scheme`. Cost: about 200 ns a vertex.
pub fn limit(scheme: &'static Entry, on: (&Level<'_>, Split, Tags<'_>), points: &[[f64; 3]]) -> Limit {
    let mut projector = Projector::new(scheme, on);
    let mut limit = Limit::default();
    let at = |v: u32| points[v as usize];
    for v in 0..points.len() as u32 {
        let mask = projector.mask(v);
        limit.points.push(mask.point(at));
        limit.normals.push(mask.normal(at));
        limit.tangents.push(mask.tangents(0, at));
    }
    limit
}
