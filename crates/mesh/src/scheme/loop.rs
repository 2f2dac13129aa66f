//! Loop (C. Loop, "Smooth subdivision surfaces based on triangles", 1987).
//!
//! An edge point is 3/8 of each end and 1/8 of each opposite vertex; a vertex of valence n goes to
//! (1 - n beta) v + beta (sum of neighbours), beta = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n. The boundary is the uniform
//! cubic B-spline of its curve.
//!
//! ```text
//!         c 1/8                    beta   beta
//!        /  \                         \  /
//!   a 3/8 -- b 3/8            beta --- v --- beta       beta = 1/16 at valence 6, 3/16 at 3
//!        \  /                         /  \
//!         d 1/8                    beta   beta
//! ```
//!
//! Warren's weights (J. Warren, "Subdivision methods for geometric design", 1995) are simpler, beta = 3 / (8 n), and as
//! smooth; they differ at valences 4, 5 and from 7 on.
//!
//! Cost: about 12 ns an output face (half a vertex each). Limit of smoothness: C2 but at extraordinary vertices, C1 there.

use super::{Accepts, Creasing, Domain, Family, Info, Param, Reach, Scheme, Tags, edge_point, vertex_point};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct Loop;

/// Loop's weight of one neighbour at valence `n`.
#[inline]
pub(crate) fn beta(n: u32) -> f64 {
    match n {
        3 => 3.0 / 16.0,
        6 => 1.0 / 16.0,
        _ => {
            let c = 0.375 + 0.25 * libm::cos(2.0 * std::f64::consts::PI / f64::from(n));
            (0.625 - c * c) / f64::from(n)
        }
    }
}

/// The weight of one neighbour at valence `n`, by the parameters.
#[inline(always)]
pub(crate) fn weight(n: u32, tags: Tags<'_>) -> f64 {
    let warren = tags.params[0] == 1.0;
    if warren && n > 3 { 0.375 / f64::from(n) } else { beta(n) }
}

impl Scheme for Loop {
    const INFO: Info = Info {
        id: "loop",
        name: "Loop",
        group: "approximating",
        summary: "Smooths triangle meshes; the standard for scans and games.",
        source: "Loop 1987",
        accepts: Accepts::Triangles,
        family: Family::Primal,
        interpolating: false,
        params: &[Param {
            key: "weights",
            name: "Weights",
            summary: "How far vertices of other valences than six move: as Loop or as Warren has it.",
            domain: Domain::Choice(&["loop", "warren"]),
        }],
    };

    const COMMON: bool = true;
    const CREASES: Creasing = Creasing::Rules;
    const LIMIT: LimitRule = LimitRule::Loop;
    const REACH: Reach = Reach::Ring;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            edge_point(c, (e, h), &tags, row, |row| {
                row.vertex(c.origin(h), 0.375);
                row.vertex(c.origin(c.next(h)), 0.375);
                row.vertex(c.origin(c.prev(h)), 0.125);
                row.vertex(c.origin(c.prev(c.twin(h))), 0.125);
            });
        });
        sink.pass(0, c.vertices(), |v, row| {
            vertex_point(c, v, &tags, row, |row| {
                let mut n = 0u32;
                c.turn(v, |h| {
                    row.vertex(c.origin(c.next(h)), 1.0);
                    n += 1;
                });
                let beta = weight(n, tags);
                row.scale(beta);
                row.vertex(v, 1.0 - f64::from(n) * beta);
            });
        });
    }
}
