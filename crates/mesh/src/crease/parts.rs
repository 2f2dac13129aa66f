//! What holds at a marked vertex or a sharp edge in one step: the parts that its rule is put together of.
//!
//! ```text
//!   survey: sharp edges around v ─> rule before the step ─┐
//!           what the decay leaves ─> rule behind it ──────┴─> shares of: the scheme's own | the crease | the vertex itself
//! ```
//!
//! The rules are those of [`super`]. Cost: one turn around the vertex. Kept out of the loops over all vertices: [`parts`] and
//! [`edge_share`] say what holds, and the loop states it.

use super::{At, Creases, EDGES, FADES, INFINITE, chaikin, less, spokes};
use crate::copies::Place;
use crate::scheme::{Decay, Tags};
use crate::sink::Row;
use crate::topology::Connectivity;

/// The sharp edges at a vertex: how many, the first two by place and the first few by sharpness and by the vertices that
/// they lead to; and how many of them are semi-sharp, with the sum of their sharpness.
pub(super) struct Survey {
    pub(super) count: usize,
    seen: usize,
    places: [u32; 2],
    pub(super) sharp: [(f32, u32); FEW],
    pub(super) semi: u32,
    /// In f64, where the order does not matter: every copy of a vertex has to find the same.
    sum: f64,
}

/// So many sharp edges at a vertex are noted: more are rare, and turned through again.
const FEW: usize = 6;

impl Survey {
    #[inline(always)]
    fn add(&mut self, s: f32, end: u32, place: u32) {
        if let Some(sharp) = self.sharp.get_mut(self.seen) {
            *sharp = (s, end);
        }
        if let Some(at) = self.places.get_mut(self.seen) {
            *at = place;
        }
        self.seen += 1;
        self.count += 1;
        self.sum_up(s);
    }

    #[inline(always)]
    fn sum_up(&mut self, s: f32) {
        if s < INFINITE {
            (self.semi, self.sum) = (self.semi + 1, self.sum + f64::from(s));
        }
    }

    pub(super) fn sum(&self) -> f32 {
        self.sum as f32
    }

    pub(super) fn at(&self) -> At {
        match self.count {
            0 => At::Smooth,
            1 => At::Dart,
            2 => At::Crease(self.places),
            _ => At::Corner,
        }
    }
}

impl Creases {
    /// The edges at `v`, and those that lie beyond a cut: at other copies they count, elsewhere they are summed up alone.
    #[inline(always)]
    pub(super) fn survey<C: Connectivity>(&self, c: &C, v: u32) -> Survey {
        let mut found = Survey { count: 0, seen: 0, places: [0; 2], sharp: [(0.0, v); FEW], semi: 0, sum: 0.0 };
        let mut place = 0;
        let arriving = c.turn(v, |h| {
            let s = self.along(c, h);
            if s > 0.0 {
                found.add(s, c.origin(c.next(h)), place);
            }
            place += 1;
        });
        if let Some(arriving) = arriving {
            found.add(INFINITE, c.origin(arriving), place);
        }
        for &(s, at) in self.beyond(v).into_iter().flat_map(|b| &b.edges) {
            found.count += usize::from(at == Place::Copy);
            found.sum_up(s);
        }
        found
    }
}

/// A vertex's rule in parts that make one together: the scheme's own rule, the crease through it, the vertex itself.
pub(crate) struct Parts {
    /// In that order.
    share: [f64; 3],
    /// The vertices at the crease's ends.
    ends: [u32; 2],
}

/// The part that holds at a vertex of so many sharp edges.
fn part(sharp: bool, edges: usize) -> usize {
    match edges {
        _ if sharp => 2,
        0 | 1 => 0,
        2 => 1,
        _ => 2,
    }
}

/// The rule of a marked vertex, both levels' taken together.
#[inline(never)]
pub(crate) fn parts<C: Connectivity>(c: &C, v: u32, tags: &Tags<'_>) -> Parts {
    let mut parts = Parts { share: [0.0, 0.0, 1.0], ends: [v; 2] };
    let Some(creases) = tags.creases else { return parts };
    if tags.is_sharp(c, v) {
        return parts;
    }
    let own = creases.vertex(v);
    // Where nothing ends and it is clear what holds.
    let flag = creases.flags[v as usize];
    if own <= 0.0 && flag & (EDGES | FADES) == EDGES {
        return parts;
    }
    let beyond = creases.beyond(v);
    let leans = beyond.is_some_and(|b| b.leans);
    let now = creases.survey(c, v);
    let before = part(own > 0.0 || leans, now.count);
    let mut after = before;
    parts.ends = [now.sharp[0].1, now.sharp[1].1];
    if now.semi > 0 || own > 0.0 {
        // What ends within this step, and whether what is leant on goes on.
        let (mut ending, mut count, mut stays) = (0.0, 0u32, false);
        if own > 0.0 && less(own) == 0.0 {
            (ending, count) = (f64::from(own), 1);
        }
        let left = |s: f32| match tags.rules.decay {
            Decay::Chaikin if s < INFINITE => chaikin(s, now.sum(), now.semi),
            _ => less(s),
        };
        let (mut lasting, mut ends) = (0, [v; 2]);
        let mut take = |s: f32, other: u32| {
            if left(s) == 0.0 {
                (ending, count) = (ending + f64::from(s), count + 1);
                return;
            }
            if let Some(end) = ends.get_mut(lasting) {
                *end = other;
            }
            lasting += 1;
        };
        match now.sharp.get(..now.seen) {
            Some(sharp) => sharp.iter().for_each(|&(s, other)| take(s, other)),
            None => spokes(c, v, |h, other| match creases.along(c, h) {
                s if s > 0.0 => take(s, other),
                _ => {}
            }),
        }
        for &(s, at) in beyond.into_iter().flat_map(|b| &b.edges) {
            if left(s) > 0.0 {
                stays = true;
                lasting += usize::from(at == Place::Copy);
            } else if at == Place::Copy || at == Place::Region && leans {
                (ending, count) = (ending + f64::from(s), count + 1);
            }
        }
        after = part(less(own) > 0.0 || leans && stays, lasting);
        if after == 1 && before == 2 {
            parts.ends = ends;
        }
        if after != before {
            let sharp = f64::from((ending as f32 / count as f32).min(1.0));
            parts.share = [0.0; 3];
            parts.share[before] = sharp;
            parts.share[after] = 1.0 - sharp;
            return parts;
        }
    }
    parts.share = [0.0; 3];
    parts.share[after] = 1.0;
    parts
}

impl Parts {
    /// Whether the scheme's own rule has a part.
    pub(crate) fn has_smooth(&self) -> bool {
        self.share[0] > 0.0
    }

    /// States the rule of `v`, behind the scheme's own where that has a part.
    #[inline(always)]
    pub(crate) fn state(self, v: u32, row: &mut impl Row) {
        let Parts { share: [rest, curve, own], ends } = self;
        if rest == 1.0 {
            return;
        }
        if rest > 0.0 {
            row.scale(rest);
        }
        if curve > 0.0 {
            row.vertex(ends[0], 0.125 * curve);
            row.vertex(ends[1], 0.125 * curve);
        }
        row.vertex(v, own + 0.75 * curve);
    }
}

/// By how much the edge of `h`, not on a boundary, is a crease in this step.
#[inline(never)]
pub(crate) fn edge_share<C: Connectivity>(c: &C, h: u32, tags: &Tags<'_>) -> f64 {
    let Some(creases) = tags.creases else { return 0.0 };
    let s = creases.along(c, h);
    let half = |end: u32| creases.half(c, c.origin(end), s, tags.rules.decay);
    // Chaikin's rule can end an edge of more than 1; OpenSubdiv goes beyond the middle then, and so does this.
    if half(h) > 0.0 && half(c.next(h)) > 0.0 { 1.0 } else { f64::from(s) }
}
