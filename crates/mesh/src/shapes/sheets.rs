//! Surfaces made from a rectangle of quads by joining its sides or leaving them open: a ring, a saddle, a Möbius strip.
//!
//! ```text
//!   grid   ┌─┬─┬─┐     torus  ┌>┬>┬>┐     moebius ┌─┬─┬─┐
//!          ├─┼─┼─┤            ∧ ┼ ┼ ∧             ∧ ┼ ┼ ∨
//!          └─┴─┴─┘            └>┴>┴>┘             └─┴─┴─┘
//! ```

use crate::soup::Soup;
use std::f64::consts::TAU;

/// A ring about the y axis, 16 quads round and 8 about: radii 0.7 and 0.3.
pub fn torus() -> Soup {
    const ROUND: u32 = 16;
    const ABOUT: u32 = 8;
    let mut soup = Soup::default();
    for i in 0..ROUND {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(ROUND));
        for j in 0..ABOUT {
            let (up, out) = libm::sincos(TAU * f64::from(j) / f64::from(ABOUT));
            let radius = 0.7 + 0.3 * out;
            soup.positions.push([radius * sin, 0.3 * up, radius * cos].map(|x| x as f32));
        }
    }
    for i in 0..ROUND {
        for j in 0..ABOUT {
            let at = |i: u32, j: u32| i % ROUND * ABOUT + j % ABOUT;
            soup.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    soup
}

/// An open sheet of 8 by 8 quads over the square from -1 to 1: the monkey saddle y = (x³ - 3xz²) / 4, seen from above.
pub fn grid() -> Soup {
    const SIDE: u32 = 8;
    let mut soup = Soup::default();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let [x, z] = [column, row].map(|i| i as f32 * 0.25 - 1.0);
            soup.positions.push([x, (x * x * x - 3.0 * x * z * z) * 0.25, z]);
        }
    }
    for row in 0..SIDE {
        for column in 0..SIDE {
            let v = row * (SIDE + 1) + column;
            soup.push_face(&[v, v + SIDE + 1, v + SIDE + 2, v + 1]);
        }
    }
    soup
}

/// A strip of 16 quads that closes with half a twist: one side, one boundary loop.
///
/// No choice of directions fits throughout: the last quad and the first run along the edge that they share in the same
/// direction, all others in opposite ones.
pub fn moebius() -> Soup {
    const QUADS: u32 = 16;
    let mut soup = Soup::default();
    for i in 0..QUADS {
        let angle = TAU * f64::from(i) / f64::from(QUADS);
        let (sin, cos) = libm::sincos(angle);
        let (up, out) = libm::sincos(angle / 2.0);
        for half in [-0.25, 0.25] {
            let radius = 0.75 + half * out;
            soup.positions.push([radius * sin, half * up, radius * cos].map(|x| x as f32));
        }
    }
    for i in 0..QUADS {
        let (a, b) = (2 * i, 2 * i + 1);
        // After half a twist the lower rim meets the upper one.
        let (c, d) = if i + 1 < QUADS { (2 * i + 3, 2 * i + 2) } else { (0, 1) };
        soup.push_face(&[a, d, c, b]);
    }
    soup
}
