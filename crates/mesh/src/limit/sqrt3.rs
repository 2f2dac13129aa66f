//! Sqrt3's limit masks.
//!
//! Inside, a step takes the mean m of the n neighbours to v/3 + 2m/3 and v to (1 - a) v + a m, so
//!
//! ```text
//!   inside, n edges   (v + 3 a m) / (1 + 3 a)         tangents: cos and sin of 2 pi i / n         Kobbelt 2000, section 3
//!   curve             (1, 4, 1) / 6, the cubic B-spline's        tangents: (1, -1) along it, and across it
//!   corner            itself
//! ```
//!
//! Across a curve with k faces beside it, two steps (the second cuts the curve's edges in three) take the inner neighbours
//! e_i to 5/9 v + (e_(i-1) + 2 e_i + e_(i+1)) / 9, which keeps sin(i theta), theta = pi / k, with the eigenvalue
//! (2 + 2 cos theta) / 9. The rows of v and of the curve's neighbours give their weights: with Z = cot(theta / 2) the sum
//! of the sines, x = -Z / (3 + 6 cos theta) for v and y = -(x + Z) / 2 for both ends. At k = 1 the second difference.
//!
//! Before a step that cuts the boundary, faces there are about to change; masks are those of the children then, taken back
//! by the rows of that step.

use super::{Kind, Mask, Ring};
use crate::apart::Apart;
use crate::scheme::{Tags, along_curve};
use crate::topology::{Connectivity, is_boundary};

/// Weights of a neighbour for the limit point and both tangents.
type Weights = [f64; 3];

/// How much of a vertex of valence `n` goes to its neighbours' mean.
fn share(ring: &Ring, n: usize) -> f64 {
    (4.0 - 2.0 * ring.root(1, n)[0]) / 9.0
}

/// The mask of `v` on a level with creases: the point of one part of its neighbourhood, the tangents of all. At a dart, which sees
/// another ring in every step, nothing is known: it stays.
pub(super) fn parts<C: Connectivity>(
    c: &Apart<'_, C>,
    ring: &mut Ring,
    trisect: bool,
    v: u32,
    tags: Tags<'_>,
    all: &mut Mask,
) {
    if c.is_dart(v) {
        return all.keep(v);
    }
    let mut one = Mask::default();
    for (i, start) in (0..).zip(c.starts(v)) {
        one.clear();
        ring.read(c, start, None);
        let kind = ring.kind(tags.is_sharp(c, v));
        mask(c, ring, (kind, trisect), v, tags, &mut one);
        if let (Kind::Curve(a, b), false) = (kind, trisect) {
            // Curves move when they are cut, their darts before.
            for end in [a, b].map(|i| ring.neighbours[i as usize]).into_iter().filter(|&u| c.is_dart(u)) {
                move_dart(c, ring, end, &mut one);
            }
        }
        if i == 0 {
            all.point.append(&mut one.point);
        }
        if one.sectors == 0 {
            all.tangents.clear();
            all.sectors = 0;
            return;
        }
        all.tangents.extend(one.tangents.iter().map(|&(v, w, _)| (v, w, i)));
        all.sectors = i + 1;
    }
}

/// Puts where the dart `u` goes in the next step for where it is.
fn move_dart(c: &impl Connectivity, ring: &Ring, u: u32, mask: &mut Mask) {
    let mut around = Vec::new();
    c.turn(u, |h| around.push(c.origin(c.next(h))));
    let a = share(ring, around.len());
    let part = a / around.len() as f64;
    let own: f64 = mask.point.iter().filter(|p| p.0 == u).map(|p| p.1).sum();
    let tangent = mask.tangents.iter().filter(|t| t.0 == u).fold([0.0; 2], |s, t| [s[0] + t.1[0], s[1] + t.1[1]]);
    mask.point.push((u, -a * own));
    mask.point.extend(around.iter().map(|&w| (w, part * own)));
    mask.tangents.push((u, tangent.map(|x| -a * x), 0));
    mask.tangents.extend(around.iter().map(|&w| (w, tangent.map(|x| part * x), 0)));
}

/// The mask of `v`. `trisect` says whether the next step cuts boundary edges.
pub(super) fn mask<C: Connectivity>(
    c: &C,
    ring: &Ring,
    (kind, trisect): (Kind, bool),
    v: u32,
    tags: Tags<'_>,
    mask: &mut Mask,
) {
    // The children that will be v's neighbours, each as what it is made of.
    let mut children: Vec<Vec<(u32, f64)>> = Vec::new();
    let changes = trisect && (ring.arriving.is_some() || ring.spokes.iter().any(|&h| is_boundary(c.twin(c.next(h)))));
    if !changes {
        children.extend(ring.neighbours.iter().map(|&e| vec![(e, 1.0)]));
    } else {
        let last = ring.spokes.len() - 1;
        for (i, &h) in ring.spokes.iter().enumerate() {
            if is_boundary(c.twin(h)) && i == 0 {
                children.push(third(c, h, false, tags));
            } else if ring.arriving.is_some() && i == last {
                // Both ends of the curve are pushed for themselves.
            } else if is_boundary(c.twin(c.next(h))) {
                children.push(third(c, c.next(h), false, tags));
                children.push(third(c, c.next(h), true, tags));
            } else {
                let [a, b] = [c.origin(c.next(h)), c.origin(c.prev(h))];
                children.push([v, a, b].map(|v| (v, 1.0 / 3.0)).to_vec());
            }
        }
        children.extend(ring.arriving.map(|h| third(c, h, true, tags)));
    }
    let mut own = [0.0; 3];
    let mut weights: Vec<Weights> = Vec::with_capacity(children.len());
    let k = children.len().max(2) - 1;
    match kind {
        Kind::Smooth => {
            let n = children.len() as f64;
            let a = share(ring, children.len());
            own[0] = 1.0 / (1.0 + 3.0 * a);
            let point = 3.0 * a / (1.0 + 3.0 * a) / n;
            for i in 0..children.len() {
                let [cos, sin] = ring.root(i, children.len());
                weights.push([point, cos, sin]);
            }
            if changes {
                // v's child, by the valence before the step; its neighbours take a share each.
                let b = share(ring, ring.neighbours.len());
                for &e in &ring.neighbours {
                    mask.point.push((e, own[0] * b / ring.neighbours.len() as f64));
                }
                own[0] *= 1.0 - b;
            }
        }
        Kind::Curve(a, b) => {
            let at = |i: u32| ring.neighbours[i as usize];
            mask.point.extend([(at(a), 1.0 / 6.0), (at(b), 1.0 / 6.0), (v, 4.0 / 6.0)]);
            let [cos, s] = ring.root(1, 2 * k);
            let z = if k == 1 { 0.0 } else { (1.0 + cos) / s };
            let x = if k == 1 { -2.0 } else { -z / (3.0 + 6.0 * cos) };
            let y = -0.5 * (x + z);
            for i in 0..=k {
                let end = i == 0 || i == k;
                let along = f64::from(i == 0) - f64::from(i == k);
                weights.push([0.0, along, if end { y } else { ring.root(i, 2 * k)[1] }]);
            }
            own[2] = x;
            if changes {
                // v' = (4 a + 19 v + 4 b) / 27.
                mask.tangents.extend([at(a), at(b)].map(|e| (e, [0.0, x * 4.0 / 27.0], 0)));
                own[2] = x * 19.0 / 27.0;
            }
        }
        Kind::Corner => {
            mask.point.push((v, 1.0));
            if ring.arriving.is_none() || k > 2 {
                return;
            }
            weights.resize(k + 1, [0.0; 3]);
            (weights[0][1], weights[k][2]) = (1.0, 1.0);
            (own[1], own[2]) = (-1.0, -1.0);
        }
    }
    mask.sectors = 1;
    for (child, [point, a, b]) in children.iter().zip(&weights) {
        for &(v, w) in child {
            if *point != 0.0 {
                mask.point.push((v, point * w));
            }
            mask.tangents.push((v, [a * w, b * w], 0));
        }
    }
    if own[0] != 0.0 {
        mask.point.push((v, own[0]));
    }
    mask.tangents.push((v, [own[1], own[2]], 0));
}

/// The first or second point that cuts boundary half-edge `h` in three: the rule of [`crate::scheme::Sqrt3`].
fn third<C: Connectivity>(c: &C, h: u32, second: bool, tags: Tags<'_>) -> Vec<(u32, f64)> {
    let (a, b) = (c.origin(h), c.origin(c.next(h)));
    let (near, far) = if second { (b, a) } else { (a, b) };
    match along_curve(c, h, tags)[usize::from(second)] {
        None => vec![(near, 18.0 / 27.0), (far, 9.0 / 27.0)],
        Some(beyond) => vec![(near, 16.0 / 27.0), (far, 10.0 / 27.0), (beyond, 1.0 / 27.0)],
    }
}
