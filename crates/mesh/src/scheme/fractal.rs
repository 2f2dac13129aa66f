//! Fractal displacement over another scheme (A. Fournier, D. Fussell, L. Carpenter, "Computer rendering of stochastic
//! models", 1982): every new point is moved by a random vector, half as far at every level.
//!
//! ```text
//!   p' = what the scheme says + amount L 2^-level r        L the mean length of the mesh's edges
//!        for points of inner edges and faces               r anywhere in the unit ball, from (seed, level, vertex)
//! ```
//!
//! Halving is the paper's midpoint displacement with exponent H = 1: Brownian motion without a parameter for roughness. The
//! vectors have no preferred direction: displacement along normals would make the rule depend on the points in a way that
//! no row of weights can say. They come from a hash of whole numbers, so the same seed is the same surface, bit for bit,
//! everywhere. Old vertices are not displaced again; what the scheme reads of new points is displaced already, so
//! Catmull-Clark's edge points follow their faces'.
//!
//! Creases are followed as far as the scheme follows them, and displaced. The boundary stays the scheme's own curve:
//! neighbours along it fit, and so do the sheets at a cut edge. Colours and texture coordinates are not displaced. Not affine
//! invariant, and other numbers of vertices give another surface. Cost: the scheme's, and one hash a new point.

use super::{
    Accepts, CatmullClark, Domain, Entry, Family, Honours, Info, Linear, Loop, Param, Reach, Scheme, Tags, entry,
};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::{Level, Split};
use crate::topology::{Connectivity, is_boundary};

/// The schemes that it wraps, in the order of its first parameter.
pub(super) static OVER: [Entry; 3] = [entry::<Linear>(), entry::<Loop>(), entry::<CatmullClark>()];

const INFO: Info = Info {
    id: "fractal",
    name: "Fractal",
    group: "approximating",
    summary: "Another scheme with every new point moved at random, half as far at every level.",
    source: "Fournier, Fussell & Carpenter 1982",
    accepts: Accepts::Both,
    family: Family::Fractal,
    interpolating: false,
    params: &[
        Param {
            key: "over",
            name: "Over",
            summary: "The scheme that is displaced.",
            domain: Domain::Choice(&["linear", "loop", "catmull-clark"]),
        },
        Param {
            key: "seed",
            name: "Seed",
            summary: "Which surface: the same number gives the same one.",
            domain: Domain::Whole { low: 0, high: 65_535, default: 1 },
        },
        Param {
            key: "amount",
            name: "Amount",
            summary: "How far new points move at the first level, in lengths of the mesh's edges.",
            domain: Domain::Number { low: 0.0, high: 1.0, default: 0.2 },
        },
    ],
};

/// What a wrapper with these parameters wraps.
pub(super) fn wrapped(params: &[f64; super::MOST_PARAMS]) -> &'static Entry {
    OVER.get(params[0] as usize).unwrap_or(&OVER[0])
}

/// The entry.
pub(super) const fn fractal() -> Entry {
    if !crate::FULL {
        return Entry {
            info: INFO,
            common: false,
            reach: Reach::Far,
            limit: LimitRule::Analysis,
            honours: Honours::ALL,
            eval: |_, _, _, _| (),
            record: |_, _, _, _| (),
        };
    }
    Entry {
        info: INFO,
        common: false,
        reach: Reach::Far,
        limit: LimitRule::Analysis,
        honours: Honours::ALL,
        eval: |level, split, tags, sink| rules(level, split, tags, sink),
        record: |level, split, tags, sink| rules(level, split, tags, sink),
    }
}

fn rules<K: Sink>(level: &Level<'_>, split: Split, tags: Tags<'_>, sink: &mut K) {
    let [over, seed, amount] = tags.params;
    let reach = libm::scalbn(amount * tags.size, -(tags.step.min(1000) as i32));
    let key = mixed(mixed(seed.to_bits()) ^ u64::from(tags.step));
    let mut sink = Displaced { level, split, reach, key, sink };
    let tags = Tags { params: [0.0; 3], ..tags };
    match over {
        1.0 => Loop::rules(level, split, tags, &mut sink),
        2.0 => CatmullClark::rules(level, split, tags, &mut sink),
        _ => Linear::rules(level, split, tags, &mut sink),
    }
}

/// Moves what passes through.
struct Displaced<'d, 'l, K> {
    level: &'d Level<'l>,
    split: Split,
    reach: f64,
    key: u64,
    sink: &'d mut K,
}

impl<K: Sink> Sink for Displaced<'_, '_, K> {
    type Row<'r> = K::Row<'r>;

    fn pass(&mut self, first: u32, count: u32, rule: impl for<'r> Fn(u32, &mut Self::Row<'r>)) {
        let (c, reach, key) = (self.level, self.reach, self.key);
        let (old, edges) = (c.vertices(), self.split.first_edge_point(c));
        self.sink.pass(first, count, |i, row| {
            rule(i, row);
            let child = first + i;
            let rim = child >= edges && is_boundary(c.twin(c.edge_half_edge(child - edges)));
            if child >= old && !rim && reach != 0.0 {
                row.constant(in_ball(key, child).map(|x| reach * x));
            }
        });
    }
}

/// S. Vigna's splitmix64: every bit of the result depends on every bit of `x`.
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A point of the unit ball, all places alike: the first of points in the cube around it that lies inside.
fn in_ball(key: u64, vertex: u32) -> [f64; 3] {
    let mut state = mixed(key ^ (u64::from(vertex) << 32));
    loop {
        // 21 bits a coordinate, the middles of equal parts of -1 .. 1.
        let p =
            [0, 21, 42].map(|shift| ((state >> shift) & 0x1f_ffff) as f64 / 1_048_576.0 - (1.0 - 0.5 / 1_048_576.0));
        if p[0] * p[0] + p[1] * p[1] + p[2] * p[2] <= 1.0 {
            return p;
        }
        state = mixed(state);
    }
}
