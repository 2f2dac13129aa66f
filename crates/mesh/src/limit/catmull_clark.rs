//! Catmull-Clark's limit masks.
//!
//! Between quads, with neighbours e and the far corners f of the faces:
//!
//! ```text
//!   inside, n edges   (n^2 v + 4 sum e + sum f) / (n (n + 5))                Halstead, Kass & DeRose 1993
//!     tangents        e_i: A cos(2 pi i / n)    f_i: cos(2 pi i / n) + cos(2 pi (i + 1) / n)    and the same with sin
//!                     A = 1 + cos(2 pi / n) + cos(pi / n) sqrt(2 (9 + cos(2 pi / n)))
//!   curve             (1, 4, 1) / 6           tangents: (1, -1) along it, and across k faces, theta = pi / k:
//!                     e_i: A sin(i theta)     f_i: sin(i theta) + sin((i + 1) theta)
//!                     v: x = -8 lambda Z / (4 lambda - 1)     both ends: -(x + (A + 2) Z) / 2
//!   corner            itself
//! ```
//!
//! Across, lambda is the greater root of 16 lambda^2 - (10 + 2 cos theta) lambda + 1 = 0, A = 16 lambda - 4 as inside, and Z =
//! cot(theta / 2) the sum of the sines: the left eigenvector that starts with these sines, its other weights from the rows
//! of the vertex and from their sum, which is zero. (At two faces -4; -1, 4, -1; 1, 1. The weights of H. Biermann, A. Levin,
//! D. Zorin, "Piecewise smooth subdivision surfaces with normal control", 2000, belong to rules that depend on the valence.)
//! Beside a single face the curve's second difference takes its place: the surface bends into the curve's own plane there.
//!
//! Where a face is no quad, these are the weights of the children v', e', f' (which quads surround), and the rules of one
//! refinement take them back to the vertices that there are.

use super::{Kind, Mask, Ring};
use crate::topology::Connectivity;

/// Weights of a vertex, its edges' and its faces' points, for the limit point and both tangents.
type Weights = [f64; 3];

/// The mask of `v`.
pub(super) fn mask(c: &impl Connectivity, ring: &Ring, kind: Kind, v: u32, mask: &mut Mask) {
    let at = |i: u32| ring.neighbours[i as usize];
    match kind {
        Kind::Smooth => {
            let valence = ring.neighbours.len();
            let n = valence as f64;
            let total = n * (n + 5.0);
            let cos = ring.root(1, valence)[0];
            // cos(pi / n), by the half angle: it is not negative.
            let a = 1.0 + cos + ((1.0 + cos) / 2.0).max(0.0).sqrt() * (2.0 * (9.0 + cos)).sqrt();
            let edge = |i: usize| {
                let [c, s] = ring.root(i, valence);
                [4.0 / total, a * c, a * s]
            };
            let face = |i: usize| {
                let ([c, s], [d, t]) = (ring.root(i, valence), ring.root(i + 1, valence));
                [1.0 / total, c + d, s + t]
            };
            let sector = Sector { first: 0, faces: ring.spokes.len(), curve: false, number: 0 };
            let own = [n / (n + 5.0), 0.0, 0.0];
            let back = [1.0 / (n * n), (n - 2.0) / n];
            mask.sectors = 1;
            weigh(c, ring, &sector, (v, own, back), (edge, face), mask);
        }
        Kind::Curve(a, b) => {
            mask.point.extend([(at(a), 1.0 / 6.0), (at(b), 1.0 / 6.0), (v, 4.0 / 6.0)]);
            for number in 0..ring.sectors() {
                let (first, faces) = ring.sector(number);
                let [c1, s] = ring.root(1, 2 * faces);
                let lambda = (5.0 + c1 + ((c1 + 9.0) * (c1 + 1.0)).max(0.0).sqrt()) / 16.0;
                let (z, a) = ((1.0 + c1) / s, 16.0 * lambda - 4.0);
                let x = -8.0 * lambda * z / (4.0 * lambda - 1.0);
                let own = if faces == 1 { -2.0 } else { x };
                let end = if faces == 1 { 1.0 } else { -0.5 * (x + (a + 2.0) * z) };
                let inner = |i: usize| if faces == 1 { 0.0 } else { ring.root(i, 2 * faces)[1] };
                let edge = |i: usize| match i {
                    0 => [0.0, 1.0, end],
                    i if i == faces => [0.0, -1.0, end],
                    i => [0.0, 0.0, a * inner(i)],
                };
                let face = |i: usize| [0.0, 0.0, inner(i) + inner(i + 1)];
                let sector = Sector { first, faces, curve: true, number };
                mask.sectors = number + 1;
                weigh(c, ring, &sector, (v, [0.0, 0.0, own], [0.125, 0.75]), (edge, face), mask);
            }
        }
        Kind::Corner => {
            mask.point.push((v, 1.0));
            ring.corner_tangents(v, mask);
        }
    }
}

/// A run of faces around a vertex: all of them, or those beside a curve.
struct Sector {
    first: usize,
    faces: usize,
    curve: bool,
    number: u32,
}

/// Adds the mask with the weights `own` of the vertex and those of edges and faces by their number in the sector. `back`
/// says how the vertex's child comes about: the weight of every neighbour and face, or on a curve of its two neighbours
/// only; and of the vertex.
fn weigh(
    c: &impl Connectivity,
    ring: &Ring,
    sector: &Sector,
    (v, own, back): (u32, Weights, [f64; 2]),
    (edge, face): (impl Fn(usize) -> Weights, impl Fn(usize) -> Weights),
    mask: &mut Mask,
) {
    let place = |j: usize| (sector.first + j) % ring.neighbours.len();
    let h = |j: usize| ring.spokes[(sector.first + j) % ring.spokes.len()];
    let quads = (0..sector.faces).all(|j| c.face_half_edges(c.face(h(j))).len() == 4);
    let mut add = |v: u32, [point, a, b]: Weights| {
        if point != 0.0 {
            mask.point.push((v, point));
        }
        if a != 0.0 || b != 0.0 {
            mask.tangents.push((v, [a, b], sector.number));
        }
    };
    // A full turn ends where it began.
    let spokes = sector.faces + usize::from(sector.curve);
    let mut centre = own;
    if !quads {
        // v' = back[1] v + ..., e' = (v + e + f + f') / 4, on a crease (v + e) / 2.
        centre = own.map(|w| w * back[1]);
    }
    for j in 0..spokes {
        let mut w = edge(j);
        if !quads {
            let end = sector.curve && (j == 0 || j == sector.faces);
            let share = if end { 0.5 } else { 0.25 };
            for k in 0..3 {
                centre[k] += share * w[k];
                w[k] = share * w[k] + if end || !sector.curve { back[0] * own[k] } else { 0.0 };
            }
        }
        add(ring.neighbours[place(j)], w);
    }
    for j in 0..sector.faces {
        let (mut w, corners) = (face(j), c.face_half_edges(c.face(h(j))));
        if quads {
            add(c.origin(c.next(c.next(h(j)))), w);
            continue;
        }
        // The two inner edges of the face take a quarter of its point each.
        for (edge_at, inner) in [(j, !sector.curve || j > 0), (j + 1, !sector.curve || j + 1 < sector.faces)] {
            if inner {
                let at = if sector.curve { edge_at } else { edge_at % sector.faces };
                let e = edge(at);
                (0..3).for_each(|k| w[k] += 0.25 * e[k]);
            }
        }
        let n = corners.len() as f64;
        for k in 0..3 {
            w[k] = (w[k] + if sector.curve { 0.0 } else { back[0] * own[k] }) / n;
        }
        corners.for_each(|h| add(c.origin(h), w));
    }
    add(v, centre);
}
