//! Doo-Sabin's limit masks inside, and those of its midpoint variant.
//!
//! A vertex of n faces becomes a face of their n images, and from then on that face shrinks by itself about its centroid. What
//! lasts longest are cos and sin of 2 pi i / n: 1/2 of them are left after a step (1/4 + cos^2 (pi / n) / 2 in the midpoint
//! variant), less of all else.
//!
//! ```text
//!   . _____ .
//!   |\     /|        point      mean of the images           each image by its weights on its face's corners
//!   | x---x |        tangents   cos and sin of 2 pi i / n over the images
//!   | | v | |
//!   | x---x |
//!   '-------'
//! ```
//!
//! Source: D. Doo, M. Sabin (1978), who found the eigenvalues. Cost: the corners of the faces around. Limit: vertices inside, of three
//! faces and more; others have no face of their own, and go by analysis.

use super::{Mask, Ring};
use crate::scheme::doo_sabin_weight;
use crate::topology::Connectivity;

/// The mask of a vertex inside that has three faces or more.
pub(super) fn mask(c: &impl Connectivity, ring: &Ring, midpoint: bool, mask: &mut Mask) {
    let n = ring.spokes.len();
    for (i, &spoke) in ring.spokes.iter().enumerate() {
        let [cos, sin] = ring.root(i, n);
        let corners = c.face_half_edges(c.face(spoke));
        let k = corners.len();
        for (j, h) in (spoke..corners.end).chain(corners.start..spoke).enumerate() {
            let (v, w) = (c.origin(h), doo_sabin_weight(midpoint, k, j));
            mask.point.push((v, w / n as f64));
            mask.tangents.push((v, [w * cos, w * sin], 0));
        }
    }
    mask.sectors = 1;
}
