//! The fused gather: points of a level in one dispatch, by rules that find their neighbours through `twin` and `origin`.
//!
//! ```text
//!   level k      half-edges: twin | origin       starts: a half-edge a vertex       sharpness: one a half-edge, if anything is
//!     points ──► level k + 1                     one invocation a face (its point, the edges that it owns), one a vertex
//!     split  ──► half-edges of k + 1             one invocation a half-edge, one a vertex; not for the last level
//! ```
//!
//! Level 0 is any polygons by tables ([`Cage`]); later levels are quads or triangles whose next, face and edge are arithmetic. Only the
//! dual split's faces are not all alike: its levels write such tables for themselves.
//! Memory: 32 bytes a half-edge of the last level but one, 16 a vertex. Limit: what one binding takes.

use super::cage::Size;
use super::finish::Drawn;
use super::kernels::{Finish, Kernel, Level, Split, Variant};
use super::program::{Builder, Dispatch, Id, Limits, Program, Role};
use super::{Cage, Error, Rules, Scheme, Values, colors};

impl Scheme {
    pub(crate) fn split(self) -> Split {
        match self {
            Scheme::CatmullClark { .. } | Scheme::Quads => Split::Quad,
            Scheme::Sqrt3 => Split::Sqrt3,
            Scheme::DooSabin { .. } => Split::Dual,
            _ => Split::Triangle,
        }
    }

    fn number(self) -> u32 {
        match self {
            Scheme::Quads | Scheme::Triangles | Scheme::Sqrt3 => 0,
            Scheme::CatmullClark { .. } | Scheme::Loop { .. } => 1,
            Scheme::DooSabin { midpoint } => midpoint.into(),
            Scheme::Butterfly { .. } => 2,
            Scheme::ModifiedButterfly => 3,
        }
    }

    /// Its parameters, as its kernel calls them.
    fn numbers(self) -> [f32; 2] {
        match self {
            Scheme::CatmullClark { triangle } => [triangle, 0.0],
            Scheme::Loop { warren } => [0.0, f32::from(u8::from(warren))],
            Scheme::Butterfly { w } => [w, 0.0],
            _ => [0.0; 2],
        }
    }

    /// Whether its rules know creases; those of the others do not, or take them another way, by rows.
    fn softens(self) -> bool {
        matches!(self, Scheme::CatmullClark { .. } | Scheme::Loop { .. })
    }
}

/// The numbers of level `k`, whose size and the one before are given.
pub(crate) fn level(rules: &Rules, marked: u32, k: u32, size: Size, before: Size) -> Level {
    let split = rules.scheme.split();
    let [a, b] = rules.scheme.numbers();
    let [vertices, faces, half_edges] = [size.vertices, size.faces, size.half_edges].map(|n| n as u32);
    let face_points = if split == Split::Triangle { 0 } else { faces };
    Level {
        half_edges,
        vertices,
        faces,
        first_face: vertices,
        first_edge: vertices + face_points,
        owned: match split {
            Split::Quad => 2 * faces,
            Split::Triangle => 2 * before.half_edges as u32,
            Split::Sqrt3 => 0,
            Split::Dual => size.edges as u32,
        },
        middle: if k == 0 || split != Split::Triangle { u32::MAX } else { 3 * before.half_edges as u32 },
        step: k,
        corners: rules.corners.into(),
        chaikin: rules.chaikin.into(),
        marked,
        a,
        b,
        ..Level::default()
    }
}

/// A level's half-edges on the GPU.
struct HalfEdges {
    half_edges: Id,
    starts: Id,
    sharpness: Option<Id>,
}

/// The program that refines `cage` to `to`, at least 1, by a scheme with kernels of its own. Cost: linear in the cage.
///
/// # Errors
/// [`Error::Data`], [`Error::HalfEdges`] for tables that do not belong together; [`Error::TooLarge`] where a buffer would leave
/// the adapter's limits.
pub fn fused(cage: &Cage<'_>, rules: &Rules, to: u32, values: Values, limits: Limits) -> Result<Program, Error> {
    let mut builder = Builder::new(limits);
    let (mut once, mut each): (Vec<Dispatch>, Vec<Dispatch>) = Default::default();
    let vertices = cage.start.len() as u32;
    let id = builder.make("cage", 16 * u64::from(vertices), Role::Cage)?;
    let chain = Chain::new(&mut builder, (cage, id), rules, to, Role::Vertices, (&mut once, &mut each))?;
    match values {
        Values::Colors => colors(builder, (id, vertices), (once, each), (chain.values, chain.count)),
        Values::Points => drawn(builder, (id, vertices), &chain, [None, None], (once, each)),
    }
}

/// Values that corners carry: on half-edges of their own, or the points'.
pub(crate) struct Beside<'a> {
    pub cage: Cage<'a>,
    pub rules: Rules,
    /// One a vertex of the cage.
    pub values: Vec<[f32; 4]>,
}

/// The program for points with texture coordinates and colours beside them, in this order. Dual splits and the square root have none.
pub(crate) fn beside(
    (cage, rules): (&Cage<'_>, &Rules),
    sides: [Option<&Beside<'_>>; 2],
    to: u32,
    limits: Limits,
) -> Result<Program, Error> {
    let mut builder = Builder::new(limits);
    let (mut once, mut each): (Vec<Dispatch>, Vec<Dispatch>) = Default::default();
    let vertices = cage.start.len() as u32;
    let id = builder.make("cage", 16 * u64::from(vertices), Role::Cage)?;
    let chain = Chain::new(&mut builder, (cage, id), rules, to, Role::Vertices, (&mut once, &mut each))?;
    let mut extras = [None, None];
    for (extra, beside) in extras.iter_mut().zip(sides) {
        let Some(beside) = beside else { continue };
        let id = builder.filled("values", &[&beside.values])?;
        // They do not move with the cage.
        let mut then = Vec::new();
        let (cage, rules) = (&beside.cage, &beside.rules);
        *extra = Some(Chain::new(&mut builder, (cage, id), rules, to, Role::Work, (&mut once, &mut then))?);
        once.extend(then);
    }
    drawn(builder, (id, vertices), &chain, extras, (once, each))
}

/// The levels of some values, and what is known of the last but one.
pub(crate) struct Chain {
    pub split: Split,
    /// Whether the last but one is level 0.
    pub base: bool,
    pub read: [Id; 5],
    pub numbers: Level,
    pub next: Size,
    pub values: Id,
    pub count: u32,
    /// Where patches made the values: how many vertices the level has that they start at. The half-edges are that level's.
    pub climbs: Option<u32>,
}

impl Chain {
    /// Lists everything up to the last level's values. `values` are those of the cage, `role` is that of the last ones.
    fn new(
        builder: &mut Builder,
        (cage, values): (&Cage<'_>, Id),
        rules: &Rules,
        to: u32,
        role: Role,
        lists: (&mut Vec<Dispatch>, &mut Vec<Dispatch>),
    ) -> Result<Chain, Error> {
        Chain::walk(builder, (cage, values), rules, (to, false), role, lists)
    }

    /// The same, and with `further` the half-edges of the last level as well, from which others go on.
    pub(crate) fn walk(
        builder: &mut Builder,
        (cage, values): (&Cage<'_>, Id),
        rules: &Rules,
        (to, further): (u32, bool),
        role: Role,
        (once, each): (&mut Vec<Dispatch>, &mut Vec<Dispatch>),
    ) -> Result<Chain, Error> {
        let scheme = rules.scheme;
        let split = scheme.split();
        cage.check(split)?;
        if to == 0 {
            return Err(limn_layout::Error::Mismatch { what: "levels", found: 0, expected: 1 }.into());
        }
        let mut sizes = vec![cage.size()];
        for k in 0..to as usize {
            let next = sizes.get(k).map_or(Size::default(), |s| s.split(split));
            sizes.push(next);
        }
        let sizes_before = sizes.iter().rev().skip(1);
        let last = sizes.last().copied().unwrap_or_default();
        // Ids are 31 bits, whatever memory there is.
        let ids = sizes_before.clone().map(|s| s.half_edges).max().unwrap_or(0);
        if ids >= 1 << 31 {
            return Err(Error::TooLarge { what: "the half-edges", bytes: ids.saturating_mul(8), limit: 8 << 31 });
        }
        builder.admit("the vertices", last.vertices.saturating_mul(16))?;
        for size in sizes_before {
            builder.admit("the half-edges", size.half_edges.saturating_mul(8))?;
        }

        let creased = cage.is_creased() && scheme.softens();
        let all_marks = cage.marks();
        let marked = all_marks.len() as u32;
        let marks = builder.filled("marks", &[&all_marks])?;
        let turn = |n: u32| std::f64::consts::TAU / f64::from(n.max(1));
        let all_angles: Vec<[f32; 2]> =
            (0..2 * cage.valence().max(8) + 1).map(|n| [turn(n).cos() as f32, turn(n).sin() as f32]).collect();
        let angles = builder.filled("angles", &[&all_angles])?;
        // Bound where a level has no such thing to read, and none to write.
        let nothing = builder.make("nothing", 16, Role::Work)?;
        let nowhere = builder.make("nowhere", 16, Role::Work)?;

        let faces: Vec<u32> =
            (0..).zip(cage.offsets.windows(2)).flat_map(|(f, w)| (w[0]..w[1]).map(move |_| f)).collect();
        let turns = if split == Split::Dual { cage.turns() } else { Vec::new() };
        let mut held = HalfEdges {
            half_edges: builder.filled("half-edges", &[cage.twin, cage.origin])?,
            starts: builder.filled("starts", &[cage.start, &faces, cage.edge, cage.offsets, &turns])?,
            sharpness: match (creased, cage.sharpness.is_empty()) {
                (false, _) => None,
                (true, false) => Some(builder.filled("sharpness", &[cage.sharpness])?),
                (true, true) => Some(builder.filled("sharpness", &[&vec![0.0f32; cage.twin.len()]])?),
            },
        };
        drop(faces);
        let mut points = values;
        for k in 0..to {
            let at = k as usize;
            let (size, next) = (sizes[at], sizes[at + 1]);
            let before = if k == 0 { Size::default() } else { sizes[at - 1] };
            let numbers = level(rules, marked, k, size, before);
            let variant = |scheme, creased| Variant { split, base: k == 0 && split != Split::Sqrt3, creased, scheme };
            let read = [held.half_edges, held.starts, marks, held.sharpness.unwrap_or(nothing), angles];
            let role = if k + 1 == to { role } else { Role::Work };
            let new = builder.make("the vertices", 16 * next.vertices, role)?;
            // The dual split's children are of half-edges.
            let elements = if split == Split::Dual { numbers.half_edges } else { numbers.faces + numbers.vertices };
            let all = Level { end: elements, ..numbers };
            let kernel = Kernel::Points(variant(scheme.number(), creased));
            each.extend(builder.step(kernel, &all, &read, &[points, new]));
            points = new;
            if k + 1 == to && !further {
                let (base, count) = (variant(0, false).base, next.vertices as u32);
                return Ok(Chain { split, base, read, numbers, next, values: points, count, climbs: None });
            }
            let tables = if split == Split::Dual { 2 * next.half_edges + next.faces + 1 } else { 0 };
            let child = HalfEdges {
                half_edges: builder.make("the half-edges", 8 * next.half_edges, Role::Work)?,
                starts: builder.make("starts", 4 * (next.vertices + tables), Role::Work)?,
                sharpness: match creased {
                    true => Some(builder.make("sharpness", 4 * next.half_edges, Role::Work)?),
                    false => None,
                },
            };
            let made = [child.half_edges, child.starts, child.sharpness.unwrap_or(nowhere)];
            let old = if split == Split::Dual { 0 } else { numbers.vertices };
            let all = Level { end: numbers.half_edges + old, ..numbers };
            once.extend(builder.step(Kernel::Split(variant(0, creased)), &all, &read, &made));
            held = child;
        }
        let before = sizes.iter().rev().nth(1).copied().unwrap_or_default();
        let read = [held.half_edges, held.starts, marks, held.sharpness.unwrap_or(nothing), angles];
        let (numbers, count) = (level(rules, marked, to, last, before), last.vertices as u32);
        let next = last.split(split);
        Ok(Chain { split, base: false, read, numbers, next, values: points, count, climbs: None })
    }
}

/// The end of a program: normals, faces, what corners carry, the box.
pub(crate) fn drawn(
    mut builder: Builder,
    (cage, cage_vertices): (Id, u32),
    chain: &Chain,
    extras: [Option<Chain>; 2],
    (mut once, mut each): (Vec<Dispatch>, Vec<Dispatch>),
) -> Result<Program, Error> {
    let &Chain { split, base, read, numbers, next, values: points, count, climbs } = chain;
    let variant = Variant { split, base, creased: false, scheme: 0 };
    let finish = |what: Finish| if climbs.is_some() { Kernel::Climbing(what, variant) } else { what.kernel(variant) };
    // The dual split's children are of half-edges.
    let elements = if split == Split::Dual { numbers.half_edges } else { numbers.faces + numbers.vertices };
    let all = Level { end: elements, ..numbers };
    let bare = match climbs {
        Some(vertices) => Level { first: numbers.faces, end: numbers.faces + vertices, ..numbers },
        None => all,
    };
    each.extend(builder.step(finish(Finish::Normals), &bare, &read, &[points]));
    let carries = extras.each_ref().map(Option::is_some);
    let corners = split != Split::Quad || carries.contains(&true);
    // Triangles: of the dual split those of its polygons, two a quad.
    let faces = match split {
        Split::Dual => next.half_edges - 2 * next.faces,
        Split::Quad if corners => 2 * next.faces,
        _ => next.faces,
    };
    let kinds = [numbers.first_face, numbers.first_edge];
    let drawn = Drawn::fused(&mut builder, corners, kinds, faces, carries)?;
    for piece in drawn.pieces() {
        let range = &piece.faces;
        let (kernel, share) = match split {
            Split::Quad if corners => (finish(Finish::QuadCorners), 2),
            _ => (finish(Finish::Faces), 1),
        };
        let mine = |numbers: Level| Level { first: range.start / share, end: range.end / share, ..numbers };
        let of_piece = match split {
            Split::Dual => Level { step: range.start, marked: range.end, ..all },
            _ => mine(numbers),
        };
        let step = builder.step(kernel, &of_piece, &read, &[points, piece.buffer]);
        // Indices stay; corners hold points.
        if corners { &mut each } else { &mut once }.extend(step);
        for (chain, color) in extras.iter().zip([false, true]) {
            let (Some(chain), Some(extra)) = (chain, piece.extra) else { continue };
            let kernel = Kernel::Extras(Variant { split, base: chain.base, creased: false, scheme: color.into() });
            once.extend(builder.step(kernel, &mine(chain.numbers), &chain.read, &[chain.values, extra]));
        }
    }
    let bounds = Some(builder.bounds(points, count, &mut each)?);
    let (shaders, buffers, packed, runs) = (builder.shaders(), builder.buffers, None, Vec::new());
    let vertices = points;
    Ok(Program { buffers, shaders, once, each, cage, cage_vertices, vertices, count, drawn, packed, bounds, runs })
}
