//! The creature of the first visit: a small dragon, a closed cage of 1,450 quads with corners of 3 to 6 edges.
//!
//! It is built as a modeller would: a tube of eight-sided rings from the tail's tip to the nose, limbs, crest and horns pulled
//! out of it, one Catmull–Clark step to round it, then eyes, toes and a nose, and last the pose.
//!
//! ```text
//!                        ,-^-.        tube        21 bands of 8, two ends of 3      174
//!                     .-'  o  \       legs        4, each 5 bands of 6              120
//!                   /    .____/       crest       7 faces pulled out, 4 each         28
//!    \    ,^-^-^-^-'    /             horns       2, each 2 bands of 4               16
//!     `-.'            (                           338, refined once:               1352
//!         `-. |-. .--| |              eyes        2, each 2 bands of 8               32
//!            |_|  |_||_|              toes        4 feet, 6 + 4 + 4 each             56
//!                                     nose        a band of 10                       10
//! ```
//!
//! Limbs join the body at corners of 5 and 6 edges, their ends are closed by corners of 3. Units: the creature stands on
//! y = 0, faces +z, and is about 2.2 long.

use super::cage::Cage;
use crate::soup::Soup;
use std::f64::consts::{PI, TAU};

/// Corners of a ring of the tube.
const SIDES: usize = 8;

/// A ring of the tube: height and depth of its middle; half width; how far it reaches up and down.
type Section = [f64; 5];

/// The tube from the tail's tip to the nose. The rings stand across the line through their middles.
const TUBE: [Section; 22] = [
    // Tail.
    [0.76, -1.66, 0.02, 0.02, 0.02],
    [0.60, -1.65, 0.055, 0.055, 0.055],
    [0.45, -1.55, 0.09, 0.085, 0.085],
    [0.36, -1.38, 0.12, 0.115, 0.11],
    [0.34, -1.18, 0.155, 0.145, 0.14],
    [0.39, -0.97, 0.205, 0.185, 0.18],
    [0.48, -0.77, 0.275, 0.235, 0.235],
    // Body.
    [0.57, -0.58, 0.36, 0.30, 0.29],
    [0.62, -0.36, 0.43, 0.36, 0.36],
    [0.63, -0.14, 0.45, 0.38, 0.39],
    [0.65, 0.06, 0.43, 0.37, 0.39],
    [0.70, 0.24, 0.39, 0.33, 0.37],
    [0.79, 0.40, 0.32, 0.28, 0.32],
    // Neck.
    [0.93, 0.52, 0.245, 0.23, 0.25],
    [1.07, 0.58, 0.20, 0.20, 0.20],
    [1.21, 0.60, 0.19, 0.20, 0.17],
    // Head.
    [1.35, 0.63, 0.24, 0.26, 0.18],
    [1.48, 0.73, 0.34, 0.33, 0.26],
    [1.50, 0.91, 0.355, 0.31, 0.29],
    [1.42, 1.07, 0.295, 0.19, 0.235],
    [1.385, 1.19, 0.25, 0.145, 0.19],
    [1.375, 1.29, 0.175, 0.10, 0.13],
];

/// A ring of a leg: its middle, out from the body's middle plane, up and forward; radius across and along; how much higher
/// its outer side is than its middle.
type LegRing = [f64; 6];

/// From hip to sole.
const HIND_LEG: [LegRing; 5] = [
    [0.38, 0.36, -0.35, 0.15, 0.21, 0.09],
    [0.41, 0.26, -0.33, 0.125, 0.155, 0.03],
    [0.41, 0.17, -0.36, 0.10, 0.115, 0.0],
    [0.41, 0.09, -0.33, 0.13, 0.16, 0.0],
    [0.41, 0.0, -0.31, 0.14, 0.18, 0.0],
];

const FORE_LEG: [LegRing; 5] = [
    [0.31, 0.42, 0.24, 0.125, 0.15, 0.08],
    [0.33, 0.29, 0.24, 0.105, 0.12, 0.03],
    [0.33, 0.18, 0.23, 0.09, 0.10, 0.0],
    [0.33, 0.09, 0.25, 0.12, 0.14, 0.0],
    [0.33, 0.0, 0.27, 0.13, 0.16, 0.0],
];

/// Bands of the tube that carry a plate of the crest, and how high it is.
const CREST: [(usize, f64); 7] = [(3, 0.10), (5, 0.14), (7, 0.17), (9, 0.19), (11, 0.17), (13, 0.13), (15, 0.10)];

/// The creature: 1,452 vertices, 2,900 edges, 1,450 quads, closed.
pub fn creature() -> Soup {
    let mut cage = tube();
    let mut feet = Vec::new();
    for (band, leg) in [(7, &HIND_LEG), (10, &FORE_LEG)] {
        for right in [true, false] {
            feet.push(pull_leg(&mut cage, band, leg, right));
        }
    }
    for (band, height) in CREST {
        let face = side_face(band, 7);
        let lift = cage.normal(&[face]).map(|x| x * height);
        cage.pull(&[face], 0.3, [lift[0], lift[1], lift[2] - 0.35 * height]);
    }
    for (side, sign) in [(0, 1.0), (6, -1.0)] {
        let face = side_face(16, side);
        cage.pull(&[face], 0.5, [0.05 * sign, 0.10, -0.08]);
        cage.pull(&[face], 0.4, [0.02 * sign, 0.10, -0.16]);
    }

    let mut cage = cage.refined();
    // Child `c` of face `f` is face `4 f + c`, at its corner `c`.
    for side in [0, 6] {
        let face = side_face(17, side);
        pull_eye(&mut cage, &[4 * face, 4 * face + 1, 4 * face + 2, 4 * face + 3]);
    }
    for foot in feet {
        for toe in [&[4 * (foot + 1) + 2][..], &[4 * (foot + 2) + 3, 4 * (foot + 2) + 2], &[4 * (foot + 3) + 3]] {
            let out = cage.normal(toe);
            cage.pull(toe, 0.7, [0.05 * out[0], -0.01, 0.05 * out[2] + 0.01]);
        }
    }
    // The upper row of the nose's end and the half row below it.
    let nose = side_face(TUBE.len() - 1, 0) + 3;
    let block = [4 * nose, 4 * nose + 1, 4 * nose + 2, 4 * nose + 3, 4 * (nose + 1), 4 * (nose + 1) + 3];
    cage.pull(&block, 0.9, [0.0, 0.012, 0.012]);

    cage.points.iter_mut().for_each(|p| *p = pose(*p));
    cage.into_soup()
}

/// The face of a band of the tube between corners `side` and `side + 1`: 0 to 2 go down the right, 3 is below, 7 above.
fn side_face(band: usize, side: usize) -> usize {
    band * SIDES + side
}

/// The tube with its two ends closed: the tail's by the faces after the bands, the nose's by the three after those.
fn tube() -> Cage {
    let mut cage = Cage::default();
    for (i, &[y, z, width, up, down]) in TUBE.iter().enumerate() {
        let before = TUBE[i.saturating_sub(1)];
        let after = TUBE[(i + 1).min(TUBE.len() - 1)];
        let (dy, dz) = (after[0] - before[0], after[1] - before[1]);
        let length = (dy * dy + dz * dz).sqrt();
        for side in 0..SIDES {
            let (sin, cos) = libm::sincos(TAU * (side as f64 + 0.5) / SIDES as f64);
            let lift = if cos > 0.0 { up * cos } else { down * cos };
            cage.points.push([width * sin, y + lift * dz / length, z - lift * dy / length]);
        }
    }
    let at = |ring: usize, side: usize| (ring * SIDES + side % SIDES) as u32;
    let last = TUBE.len() - 1;
    for band in 0..last {
        for side in 0..SIDES {
            cage.quads.push([at(band, side), at(band + 1, side), at(band + 1, side + 1), at(band, side + 1)]);
        }
    }
    for i in 0..3 {
        cage.quads.push([at(0, i), at(0, i + 1), at(0, 6 - i), at(0, 7 - i)]);
    }
    for i in 0..3 {
        cage.quads.push([at(last, 7 - i), at(last, 6 - i), at(last, i + 1), at(last, i)]);
    }
    cage
}

/// Pulls a leg out of two bands; returns the first of the six faces round the foot.
fn pull_leg(cage: &mut Cage, band: usize, leg: &[LegRing; 5], right: bool) -> usize {
    let (side, sign) = if right { (2, 1.0) } else { (4, -1.0) };
    let faces = [side_face(band, side), side_face(band + 1, side)];
    let mut anchor = (band * SIDES + side) as u32;
    let mut foot = 0;
    for &[x, y, z, across, along, rise] in leg {
        foot = cage.quads.len();
        let ring = cage.extrude(&faces, anchor);
        anchor = ring[0];
        // From behind on the left over the front to behind on the right, seen from below.
        for (i, &v) in ring.iter().enumerate() {
            let (sin, cos) = libm::sincos(PI / 3.0 * (i as f64 - 1.0));
            cage.points[v as usize] = [sign * x + across * cos, y + sign * rise * cos, z + along * sin];
        }
    }
    foot
}

/// Makes a ball in a socket out of a block of two by two faces.
fn pull_eye(cage: &mut Cage, faces: &[usize; 4]) {
    // A little lower and further forward than the block, so that the creature looks ahead.
    let (middle, normal) = (cage.middle(faces), cage.normal(faces));
    let middle = [middle[0], middle[1] - 0.01, middle[2] + 0.015];
    let normal = unit([normal[0], normal[1] - 0.1, normal[2] + 0.15]);
    let anchor = cage.quads[faces[0]][0];
    let mut from = anchor;
    for (radius, height) in [(0.092, 0.004), (0.1, 0.045)] {
        let ring = cage.extrude(faces, from);
        from = ring[0];
        for v in ring {
            cage.points[v as usize] = on_circle(cage.points[v as usize], middle, normal, radius, height);
        }
    }
    // The vertex in the middle of the block is corner 2 of every child.
    let top = cage.quads[faces[0]][2];
    cage.points[top as usize] = [0, 1, 2].map(|k| middle[k] + 0.115 * normal[k]);
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

/// Moves a point to a circle round an axis, `height` along it, keeping its direction from the axis.
fn on_circle(p: [f64; 3], middle: [f64; 3], normal: [f64; 3], radius: f64, height: f64) -> [f64; 3] {
    let d = [0, 1, 2].map(|k| p[k] - middle[k]);
    let along = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
    let out = [0, 1, 2].map(|k| d[k] - along * normal[k]);
    let out = unit(out);
    [0, 1, 2].map(|k| middle[k] + out[k] * radius + normal[k] * height)
}

/// Swings the tail to one side, turns the head to the other, and sets size and place.
fn pose([x, y, z]: [f64; 3]) -> [f64; 3] {
    let ease = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    // The head turns about an upright axis through the neck.
    let turn = -0.35 * ease((y - 1.0) / 0.5) * ease((z - 0.1) / 0.4);
    let (sin, cos) = libm::sincos(turn);
    let (dx, dz) = (x, z - 0.6);
    let (x, z) = if z > 0.1 { (dx * cos + dz * sin, 0.6 + dz * cos - dx * sin) } else { (x, z) };
    let swing = (-0.5 - z).max(0.0);
    let x = x + 0.45 * swing * swing;
    [0.8 * x, 0.8 * y, 0.8 * z + 0.12]
}
