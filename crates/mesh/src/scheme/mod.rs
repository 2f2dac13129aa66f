//! Schemes: a split plus weights, and the one list that everything else reads.
//!
//! A scheme states which points with which weights make every new point, once, over any [`Connectivity`] and to any
//! [`Sink`]. From that one statement come the points at full speed, the sparse rows, the tests and the page's menu.
//!
//! ```text
//!   impl Scheme for CatmullClark { INFO, rules }        one file
//!   entry::<CatmullClark>()                             one line in SCHEMES
//! ```
//!
//! Limit: rules look at one level at a time; what they need from further up must be carried by tags.

mod butterfly;
mod catmull_clark;
mod doo_sabin;
mod fractal;
mod interpolating_sqrt3;
mod j_spline;
mod kobbelt;
mod linear;
#[path = "loop.rs"]
mod loop_;
mod mid_edge;
mod modified_butterfly;
mod n_way;
mod nurss;
mod params;
mod poke;
mod quad_triangle;
mod rules;
mod sqrt3;
mod tags;
mod tri_to_quad;

pub use butterfly::Butterfly;
pub use catmull_clark::CatmullClark;
pub use doo_sabin::{DooSabin, Midpoint};
pub use interpolating_sqrt3::InterpolatingSqrt3;
pub use j_spline::JSpline;
pub use kobbelt::Kobbelt;
pub use linear::Linear;
pub use loop_::Loop;
pub use mid_edge::MidEdge;
pub use modified_butterfly::ModifiedButterfly;
pub use n_way::NWay;
pub use nurss::Nurss;
pub use params::{Domain, MOST_PARAMS, Param, Params};
pub use poke::Poke;
pub use quad_triangle::QuadTriangle;
pub use rules::{Boundary, Decay, FaceVarying, Reach, Rules, TriangleRule};
pub use sqrt3::Sqrt3;
pub use tags::Tags;
pub use tri_to_quad::TriToQuad;

pub(crate) use doo_sabin::weight as doo_sabin_weight;
pub(crate) use loop_::weight as loop_weight;

use crate::FULL;
use crate::apart;
use crate::crease::{self, Parts};
use crate::limit::LimitRule;
use crate::sink::{Cursor, Eval, Record, Row, Sink, TakeRow};
use crate::split::{FaceShape, Level, Split, Triangles};
use crate::topology::{Connectivity, is_boundary};

/// Every scheme, in the order of the menu.
pub static SCHEMES: &[Entry] = &[
    entry::<CatmullClark>(),
    entry::<Loop>(),
    quad_triangle::quad_triangle(),
    entry::<TriToQuad>(),
    entry::<Sqrt3>(),
    entry::<JSpline>(),
    entry::<Butterfly>(),
    entry::<ModifiedButterfly>(),
    entry::<InterpolatingSqrt3>(),
    entry::<Kobbelt>(),
    entry::<DooSabin>(),
    entry::<Midpoint>(),
    entry::<Nurss>(),
    entry::<MidEdge>(),
    entry::<Linear>(),
    entry::<Poke>(),
    fractal::fractal(),
    entry::<NWay>(),
];

/// The scheme with this id.
pub fn scheme(id: &str) -> Option<&'static Entry> {
    SCHEMES.iter().find(|e| e.info.id == id)
}

/// What a scheme is called and promises.
#[derive(Debug, PartialEq)]
pub struct Info {
    /// The permanent id: commands and links store it.
    pub id: &'static str,
    /// The name that people see.
    pub name: &'static str,
    /// What it does: "approximating", "interpolating", "dual" or "linear".
    pub group: &'static str,
    /// One sentence for the menu.
    pub summary: &'static str,
    /// Where the rules come from.
    pub source: &'static str,
    /// The faces it takes.
    pub accepts: Accepts,
    /// What it does to the connectivity.
    pub family: Family,
    /// Whether the vertices of a level keep their positions in the next.
    pub interpolating: bool,
    /// What can be set, in the order of [`Params`].
    pub params: &'static [Param],
}

/// Which faces a scheme can refine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepts {
    /// Any polygons; always the quad split.
    Polygons,
    /// Triangles only; other faces have to be triangulated first.
    Triangles,
    /// Triangles, which become quads, and quads from then on; other faces have to be triangulated first.
    TrianglesThenQuads,
    /// Any polygons; the triangle split where all faces are triangles, else the quad split (or, of that family, the mixed).
    Both,
}

/// What a scheme does to the connectivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Splits faces: the quad split, or the triangle split.
    Primal,
    /// Splits triangles in four and other faces in quads.
    Mixed,
    /// What the scheme does that it wraps.
    Fractal,
    /// Splits vertices: a face for every face, edge and vertex.
    Dual,
    /// Splits triangles in three and turns their edges.
    Sqrt3,
    /// Joins the midpoints of edges: a face for every face and vertex.
    MidEdge,
    /// Splits faces into triangles around their middle.
    Poke,
    /// The quad split, of triangles too.
    Quads,
    /// Splits edges in any number of parts, and faces in grids.
    NWay,
}

impl Info {
    /// The split that this scheme uses on a mesh with such faces; none if it cannot take them.
    pub fn split(&self, shape: FaceShape, boundary: Boundary, params: &[f64; MOST_PARAMS]) -> Option<Split> {
        if self.family == Family::Fractal {
            return self.behind(params).split(shape, boundary, &[0.0; MOST_PARAMS]);
        }
        match (self.accepts, shape == FaceShape::Triangles) {
            (Accepts::Triangles, false) => None,
            (Accepts::TrianglesThenQuads, _) if shape == FaceShape::Polygons => None,
            _ if self.family == Family::Dual => Some(Split::Dual { rounded: boundary != Boundary::EdgeAndCorner }),
            _ if self.family == Family::Mixed && shape == FaceShape::Polygons => Some(Split::Mixed),
            _ if self.family == Family::Sqrt3 => Some(Split::Sqrt3 { trisect: false }),
            _ if self.family == Family::MidEdge => {
                Some(Split::MidEdge { cut: false, corners: boundary == Boundary::EdgeAndCorner })
            }
            _ if self.family == Family::Poke => Some(Split::Poke),
            _ if self.family == Family::NWay => {
                Some(Split::NWay { n: params[0] as u32, triangles: Triangles::of(shape) })
            }
            (Accepts::Polygons | Accepts::TrianglesThenQuads, _) | (Accepts::Both, false) => Some(Split::Quad),
            (Accepts::Triangles, true) | (Accepts::Both, true) => Some(Split::Triangle),
        }
    }

    /// Whether rules move points at random: such a scheme promises neither affine invariance, nor the same surface under
    /// other numbers, nor symmetry.
    pub fn is_random(&self) -> bool {
        self.family == Family::Fractal
    }

    /// The scheme that does the work: the one that it wraps, for a wrapper with these parameters; else itself.
    pub fn behind(&self, params: &[f64; MOST_PARAMS]) -> &Info {
        match self.family {
            Family::Fractal => &fractal::wrapped(params).info,
            _ => self,
        }
    }
}

/// A subdivision scheme.
pub trait Scheme: 'static {
    /// Its entry in the registry.
    const INFO: Info;
    /// Whether it is chosen often enough to be compiled for every connectivity and sink, twice the code, and into builds
    /// without the feature `full`.
    const COMMON: bool = false;

    /// How it takes sharp edges and vertices.
    const CREASES: Creasing = Creasing::None;

    /// How the limit of its vertices is found.
    const LIMIT: LimitRule = LimitRule::Analysis;

    /// What the points inside a face depend on, however often it is cut: the faces around it alone, or more.
    const REACH: Reach = Reach::Far;

    /// States all rules of one refinement of `c` by `split`: passes in order, later ones may read earlier children.
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K);
}

type EvalFn = fn(&Level<'_>, Split, Tags<'_>, &mut Eval<'_>);
type RecordFn = fn(&Level<'_>, Split, Tags<'_>, &mut Record<'_>);

/// How a scheme takes sharp edges and vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Creasing {
    /// Not at all.
    None,
    /// Its rules ask [`crate::crease`], or it smooths nothing anyway.
    Rules,
    /// As the rim of a mesh that is cut there (`apart.rs`), semi-sharp ones as far as they are sharp.
    Apart,
    /// The same, but only what is infinitely sharp.
    ApartForEver,
}

impl Creasing {
    /// Whether rules of rims are taken for creases.
    pub(crate) const fn is_apart(self) -> bool {
        FULL && matches!(self, Creasing::Apart | Creasing::ApartForEver)
    }
}

/// Which marks of a mesh mean something to a scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Honours {
    /// Infinitely sharp edges.
    pub creases: bool,
    /// Semi-sharp edges and vertices.
    pub semi_sharp: bool,
    /// Infinitely sharp vertices: they stay where they are.
    pub corners: bool,
}

impl Honours {
    /// Everything.
    const ALL: Honours = Honours { creases: true, semi_sharp: true, corners: true };
}

/// A scheme in the registry: its facts, and its rules compiled for every sink.
#[derive(Debug)]
pub struct Entry {
    /// Facts.
    pub info: Info,
    /// How the limit of its vertices is found.
    pub limit: LimitRule,
    /// [`Scheme::COMMON`].
    pub common: bool,
    /// [`Scheme::REACH`].
    #[cfg_attr(not(feature = "full"), expect(dead_code))]
    pub(crate) reach: Reach,
    /// Which marks mean something to it.
    pub honours: Honours,
    eval: EvalFn,
    record: RecordFn,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Entry) -> bool {
        self.info.id == other.info.id
    }
}

/// Compiles a scheme into an entry: for every connectivity that it can meet, at full speed, and once for recording. A build
/// without the feature `full` has no rules of rare schemes, and no rows: nothing refers to them, so nothing is compiled.
const fn entry<S: Scheme>() -> Entry {
    // Where there is nothing, `Plan::is_here` says no, and whoever refines asks it first.
    let eval: EvalFn =
        if S::COMMON || FULL { eval::<S> } else { |_, _, _, _| unreachable!("this build has not these rules") };
    let record: RecordFn = if FULL { record::<S> } else { |_, _, _, _| unreachable!("this build records no rows") };
    let corners = !matches!(S::INFO.family, Family::Dual | Family::MidEdge);
    let honours = Honours {
        creases: !matches!(S::CREASES, Creasing::None),
        semi_sharp: matches!(S::CREASES, Creasing::Rules | Creasing::Apart),
        corners,
    };
    // Papers are told about by the build that has their rules.
    let info = Info { source: if FULL { S::INFO.source } else { "" }, ..S::INFO };
    Entry { info, common: S::COMMON, reach: S::REACH, honours, limit: S::LIMIT, eval, record }
}

/// Which kinds of levels a scheme can meet follows from what it takes and makes; the others are not compiled.
fn eval<S: Scheme>(level: &Level<'_>, split: Split, tags: Tags<'_>, sink: &mut Eval<'_>) {
    // What a scheme's own split stores is met in full only.
    let implicit = matches!(S::INFO.family, Family::Primal | Family::Mixed | Family::Quads);
    match (level, S::INFO.accepts) {
        (Level::Base(c), _) => rules::<S, _, _>(*c, split, tags, sink),
        (Level::Quads(c), accepts) if implicit && accepts != Accepts::Triangles => {
            rules::<S, _, _>(*c, split, tags, sink)
        }
        (Level::Triangles(c), accepts) if implicit && accepts != Accepts::Polygons => {
            rules::<S, _, _>(*c, split, tags, sink)
        }
        #[cfg(feature = "full")]
        (Level::Dual(c), _) if matches!(S::INFO.family, Family::Dual) => rules::<S, _, _>(*c, split, tags, sink),
        _ => unreachable!("a step says when it needs stored half-edges"),
    }
}

fn record<S: Scheme>(level: &Level<'_>, split: Split, tags: Tags<'_>, sink: &mut Record<'_>) {
    match (level, S::INFO.family) {
        (level, Family::Primal | Family::Mixed | Family::Quads) => rules::<S, _, _>(level, split, tags, sink),
        (Level::Base(c), _) => rules::<S, _, _>(*c, split, tags, sink),
        _ => unreachable!("a step says when it needs stored half-edges"),
    }
}

/// States the rules on `c`, or on `c` cut along its creases.
#[inline(always)]
fn rules<S: Scheme, C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
    if !FULL || !apart::rules::<S, C, K>(c, split, tags, sink) {
        S::rules(c, split, tags, sink);
    }
}

impl Entry {
    /// [`Info::behind`].
    pub(crate) fn behind(&'static self, params: &[f64; MOST_PARAMS]) -> &'static Entry {
        if self.info.family == Family::Fractal { fractal::wrapped(params) } else { self }
    }

    /// Computes up to `quota` children's points from `cursor` on; true when all are done.
    pub fn eval(
        &self,
        (level, split, tags): (&Level<'_>, Split, Tags<'_>),
        old: &[[f32; 3]],
        new: &mut [[f32; 3]],
        cursor: &mut Cursor,
        quota: &mut usize,
    ) -> bool {
        let mut sink = Eval::new(old, new, cursor, quota);
        (self.eval)(level, split, tags, &mut sink);
        sink.done()
    }

    /// Hands up to `quota` children's rows to `take`; true when all are done.
    pub fn rows(
        &self,
        (level, split, tags): (&Level<'_>, Split, Tags<'_>),
        take: &mut TakeRow<'_>,
        cursor: &mut Cursor,
        quota: &mut usize,
    ) -> bool {
        let mut sink = Record::new(take, cursor, quota);
        (self.record)(level, split, tags, &mut sink);
        sink.done()
    }
}

/// The pass that puts every face point at its face's centroid.
#[inline(always)]
fn face_centroids<C: Connectivity, K: Sink>(c: &C, split: Split, sink: &mut K) {
    sink.pass(split.first_face_point(c), c.faces(), |f, row| {
        let corners = c.face_half_edges(f);
        let n = corners.len() as f64;
        for h in corners {
            row.vertex(c.origin(h), 1.0);
        }
        row.scale(1.0 / n);
    });
}

/// States the rule of `v` if it is sharp, or lies on a boundary; says whether it does.
///
/// A boundary is the uniform cubic B-spline of its curve, in Catmull-Clark and Loop alike: 3/4 of the vertex, 1/8 of each
/// neighbour along it. Neighbours first: their sum does not depend on the side, so copies of a split vertex stay equal.
/// Cost: the valence on a boundary, one step elsewhere.
#[inline(always)]
fn kept_or_curve<C: Connectivity>(c: &C, v: u32, tags: &Tags<'_>, row: &mut impl Row) -> bool {
    if tags.is_sharp(c, v) {
        row.vertex(v, 1.0);
        return true;
    }
    let start = c.vertex_half_edge(v);
    if !is_boundary(c.twin(start)) {
        return false;
    }
    if let Some(arriving) = c.turn(v, |_| {}) {
        row.vertex(c.origin(c.next(start)), 0.125);
        row.vertex(c.origin(arriving), 0.125);
        row.vertex(v, 0.75);
    }
    true
}

/// The neighbours of boundary half-edge `h` along its curve, the vertex before its origin and the one behind its target; none
/// where the curve ends: at what is sharp, and at a dart.
#[inline(never)]
pub(crate) fn along_curve<C: Connectivity>(c: &C, h: u32, tags: Tags<'_>) -> [Option<u32>; 2] {
    let (a, n) = (c.origin(h), c.next(h));
    let before = || c.turn_from(h, |_| {}).map(|arriving| c.origin(arriving));
    let after = || {
        let spoke = c.first_spoke(n);
        is_boundary(c.twin(spoke)).then(|| c.origin(c.next(spoke)))
    };
    [if tags.is_sharp(c, a) { None } else { before() }, if tags.is_sharp(c, c.origin(n)) { None } else { after() }]
}

/// States the rule of `v` with its marks; `smooth` states the scheme's own, of inner vertices.
#[inline(always)]
fn vertex_point<C: Connectivity, R: Row>(c: &C, v: u32, tags: &Tags<'_>, row: &mut R, smooth: impl Fn(&mut R)) {
    // What holds is found out of line, without the row, and `smooth` has one place: it is compiled into the loop, and the sum
    // stays in registers.
    let marked = match tags.creases {
        Some(creases) if FULL && creases.marked(v) => Some(crease::parts(c, v, tags)),
        _ => None,
    };
    if marked.is_none() && kept_or_curve(c, v, tags, row) {
        return;
    }
    if marked.as_ref().is_none_or(Parts::has_smooth) {
        smooth(row);
    }
    if let Some(parts) = marked {
        parts.state(v, row);
    }
}

/// States the point of edge `e`, of half-edge `h`: in the middle on a boundary, on a crease as far as it is sharp; `smooth`
/// states the scheme's own.
#[inline(always)]
fn edge_point<C: Connectivity, R: Row>(
    c: &C,
    (e, h): (u32, u32),
    tags: &Tags<'_>,
    row: &mut R,
    smooth: impl Fn(&mut R),
) {
    // One place for `smooth` here as well.
    let sharp = if is_boundary(c.twin(h)) {
        1.0
    } else if FULL && tags.creases.is_some_and(|creases| creases.edge(e) > 0.0) {
        crease::edge_share(c, h, tags)
    } else {
        0.0
    };
    if sharp != 1.0 {
        smooth(row);
    }
    if sharp != 0.0 {
        if sharp != 1.0 {
            row.scale(1.0 - sharp);
        }
        row.vertex(c.origin(h), 0.5 * sharp);
        row.vertex(c.origin(c.next(h)), 0.5 * sharp);
    }
}
