//! A chess pawn, turned on a lathe: a profile of 19 rings of 8 corners between two poles. Every other ring is turned by half a
//! side, so that the triangles are even and the silhouette has no seam.
//!
//! ```text
//!       .-o-.        19 * 8 + 2 = 154 vertices
//!      (     )       3 * 19 * 8 = 456 edges
//!       `) (´        2 * 19 * 8 = 304 triangles
//!      <═══ ═══>
//!        / \
//!      _/   \_
//!     (_______)
//! ```
//!
//! The same counts as the pawn in L. Olsen's study of Doo–Sabin subdivision and its reverse (2004).

use crate::soup::Soup;
use std::f64::consts::TAU;

/// Corners of a ring.
const SIDES: u32 = 8;

/// Radius and height of each ring, from the foot up.
const PROFILE: [[f64; 2]; 19] = [
    [0.40, -1.00],
    [0.56, -0.98],
    [0.58, -0.86],
    [0.54, -0.77],
    [0.46, -0.72],
    [0.46, -0.66],
    [0.38, -0.58],
    [0.27, -0.42],
    [0.20, -0.20],
    [0.17, 0.02],
    [0.18, 0.17],
    [0.35, 0.22],
    [0.36, 0.29],
    [0.19, 0.34],
    [0.26, 0.44],
    [0.35, 0.58],
    [0.37, 0.70],
    [0.31, 0.85],
    [0.17, 0.96],
];

/// The pawn: 154 vertices, 304 triangles, closed.
pub fn pawn() -> Soup {
    let mut soup = Soup { positions: vec![[0.0, -1.0, 0.0]], ..Soup::default() };
    for (ring, [radius, height]) in PROFILE.into_iter().enumerate() {
        // Every other ring is turned by half a side.
        let turn = (ring % 2) as f64 / 2.0;
        for side in 0..SIDES {
            let (sin, cos) = libm::sincos(TAU * (f64::from(side) + turn) / f64::from(SIDES));
            soup.positions.push([radius * sin, height, radius * cos].map(|x| x as f32));
        }
    }
    soup.positions.push([0.0, 1.0, 0.0]);

    let rings = PROFILE.len() as u32;
    let at = |ring: u32, side: u32| 1 + ring * SIDES + side % SIDES;
    for side in 0..SIDES {
        soup.push_face(&[0, at(0, side + 1), at(0, side)]);
    }
    for ring in 1..rings {
        for side in 0..SIDES {
            let [a, b] = [at(ring - 1, side), at(ring - 1, side + 1)];
            let [d, c] = [at(ring, side), at(ring, side + 1)];
            if ring % 2 == 1 {
                soup.push_face(&[a, b, d]);
                soup.push_face(&[d, b, c]);
            } else {
                soup.push_face(&[a, b, c]);
                soup.push_face(&[a, c, d]);
            }
        }
    }
    for side in 0..SIDES {
        soup.push_face(&[at(rings - 1, side), at(rings - 1, side + 1), at(rings, 0)]);
    }
    soup
}
