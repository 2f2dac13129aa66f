//! Loop's limit masks, for Loop's weights and Warren's.
//!
//! ```text
//!   inside, n edges     1 - n x, and x for each neighbour; x = 1 / (3 / (8 beta) + n)
//!                       tangents: cos and sin of 2 pi i / n
//!   curve               (1, 4, 1) / 6                       tangents: (1, -1) along it, and across it
//!   corner              itself
//! ```
//!
//! Across a curve with k faces beside it, theta = pi / k: the left eigenvector whose weights at the inner neighbours are
//! sin(i theta), with the eigenvalue 3/8 + cos(theta)/4. The rules of the vertex and of the curve's neighbours leave two
//! equations for their weights x and y,
//!
//! ```text
//!   3/4 x + y + 3/8 Z = lambda x        x/8 + y/2 + sin(theta)/8 = lambda y        Z = sum of sines = cot(theta / 2)
//!   x = -(1 + cos theta) / (2 sin(theta) (cos(theta) + 1/2))                        y = -(x + Z) / 2
//! ```
//!
//! which at three faces is (-2; -1, 2, 2, -1), as in H. Hoppe et al., "Piecewise smooth surface reconstruction" (1994).
//! Their weights for other valences belong to crease rules that depend on the valence.

use super::{Kind, Mask, Ring};
use crate::scheme::{Tags, loop_weight};

/// The mask of `v`.
pub(super) fn mask(ring: &Ring, kind: Kind, v: u32, tags: Tags<'_>, mask: &mut Mask) {
    let at = |i: u32| ring.neighbours[i as usize];
    match kind {
        Kind::Smooth => {
            let valence = ring.neighbours.len();
            let n = valence as f64;
            let x = 1.0 / (0.375 / loop_weight(valence as u32, tags) + n);
            mask.sectors = 1;
            for (i, &e) in ring.neighbours.iter().enumerate() {
                mask.point.push((e, x));
                mask.tangents.push((e, ring.root(i, valence), 0));
            }
            mask.point.push((v, 1.0 - n * x));
        }
        Kind::Curve(a, b) => {
            mask.point.extend([(at(a), 1.0 / 6.0), (at(b), 1.0 / 6.0), (v, 4.0 / 6.0)]);
            for sector in 0..ring.sectors() {
                across(ring, sector, v, mask);
            }
        }
        Kind::Corner => {
            mask.point.push((v, 1.0));
            ring.corner_tangents(v, mask);
        }
    }
}

/// Adds the tangents of a sector beside a curve.
fn across(ring: &Ring, sector: u32, v: u32, mask: &mut Mask) {
    let (first, faces) = ring.sector(sector);
    let [c, s] = ring.root(1, 2 * faces);
    let (own, end) = if faces == 1 {
        (-2.0, 1.0)
    } else {
        let own = -(1.0 + c) / (2.0 * s * (c + 0.5));
        (own, -0.5 * (own + (1.0 + c) / s))
    };
    mask.sectors = sector + 1;
    let mut i = first;
    for j in 0..=faces {
        let along = f64::from(j == 0) - f64::from(j == faces);
        let across = if j == 0 || j == faces { end } else { ring.root(j, 2 * faces)[1] };
        mask.tangents.push((ring.neighbours[i], [along, across], sector));
        i = ring.after(i);
    }
    mask.tangents.push((v, [0.0, own], sector));
}
