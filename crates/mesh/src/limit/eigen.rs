//! Left eigenvectors of a local subdivision matrix: the greatest, and the plane of the next two.
//!
//! The matrix S takes the points of a neighbourhood to those one level further; its rows sum to one. Going backwards,
//! weights l turn into l S. Over and over, weights that sum to one become the limit point's, and weights that sum to zero
//! the tangents':
//!
//! ```text
//!   l S S S ...   ->   l1 with l1 S = l1        (sum 1)
//!   a, b  S ...   ->   the plane that S shrinks least, after each step made orthonormal again   (sum 0)
//! ```
//!
//! Where the neighbourhood looks the same from all sides, the iteration started with cos and sin stays in that frequency and
//! converges fast. Cost: some fifty products with a sparse matrix. Limit: eigenvalues of nearly the same size (a valence of
//! hundreds, next to another scheme's rules) take too long, and then there is no answer.

/// A sparse matrix by rows.
pub(super) type Rows = Vec<Vec<(u32, f64)>>;

/// The most steps. What has not converged by then counts as having no tangent plane.
const STEPS: usize = 4000;

/// `weights` S, over all rows.
pub(super) fn back(rows: &Rows, weights: &[f64], size: usize) -> Vec<f64> {
    let mut out = vec![0.0; size];
    for (row, &w) in rows.iter().zip(weights) {
        if w != 0.0 {
            for &(v, x) in row {
                out[v as usize] += w * x;
            }
        }
    }
    out
}

/// The left eigenvector of the eigenvalue 1 that `start` (sum 1) goes to.
pub(super) fn point(s: &Rows, start: Vec<f64>) -> Option<Vec<f64>> {
    let mut l = start;
    let mut best = f64::INFINITY;
    for _ in 0..STEPS {
        let mut next = back(s, &l, l.len());
        let sum: f64 = next.iter().sum();
        next.iter_mut().for_each(|x| *x /= sum);
        let change: f64 = l.iter().zip(&next).map(|(a, b)| (a - b).abs()).sum();
        l = next;
        // Down to rounding, where it stops getting better.
        if change < 1e-15 || (change < 1e-13 && change >= best) {
            return Some(l);
        }
        best = change;
    }
    None
}

/// Two orthonormal left vectors of the plane that `start` (two vectors of sum 0) goes to; `point` is
/// the limit point's vector. With `first`, the first vector
/// is found on its own and is an eigenvector: the tangent along a boundary, which the rules for the inside do not change.
pub(super) fn plane(s: &Rows, point: &[f64], start: [Vec<f64>; 2], first: bool) -> Option<[Vec<f64>; 2]> {
    let step = |l: &[f64], against: Option<&Vec<f64>>| tidy(back(s, l, l.len()), point, against);
    let [mut a, mut b] = start;
    if first {
        a = converge(|a| step(a, None), a)?;
        b = converge(|b| step(b, Some(&a)), b)?;
        return Some([a, b]);
    }
    a = tidy(a, point, None)?;
    b = tidy(b, point, Some(&a))?;
    for _ in 0..STEPS {
        let c = step(&a, None)?;
        let d = step(&b, Some(&c))?;
        let change = outside(&c, [&a, &b]).max(outside(&d, [&a, &b]));
        (a, b) = (c, d);
        if change < 1e-14 {
            return Some([a, b]);
        }
    }
    None
}

/// Whether the surface goes one way across a boundary: what S makes of the shape `start` in the end, after the parts of
/// the limit point and of the tangent `along` are taken out, has `inner` vertices all on the same side of `own`. Both are
/// left eigenvectors, so a shape without a part of them stays without.
pub(super) fn goes_one_way(s: &Rows, [point, along]: [&[f64]; 2], start: &[f64], own: usize, inner: &[usize]) -> bool {
    // Not quite even: an uneven shape that lasts longer has to show, one that lasts as long has not.
    let mut shape: Vec<f64> = start.iter().enumerate().map(|(i, x)| x * (1.0 + 1e-6 * (i % 3) as f64)).collect();
    for _ in 0..STEPS {
        let mut next: Vec<f64> = s.iter().map(|row| row.iter().map(|&(v, w)| w * shape[v as usize]).sum()).collect();
        let part = dot(&next, point);
        next.iter_mut().for_each(|x| *x -= part);
        let part = dot(&next, along) / dot(along, along);
        next.iter_mut().zip(along).for_each(|(x, a)| *x -= part * a);
        let length = dot(&next, &next).sqrt();
        if !length.is_normal() {
            return true;
        }
        next.iter_mut().for_each(|x| *x /= length);
        let change = shape.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        shape = next;
        if change < 1e-10 {
            break;
        }
    }
    let side = |v: &usize| shape[*v] - shape[own];
    inner.iter().all(|v| side(v) > 0.0) || inner.iter().all(|v| side(v) < 0.0)
}

/// Repeats `step` until the direction stands still.
fn converge(step: impl Fn(&Vec<f64>) -> Option<Vec<f64>>, start: Vec<f64>) -> Option<Vec<f64>> {
    let mut l = start;
    for _ in 0..STEPS {
        let next = step(&l)?;
        let change = l.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        l = next;
        if change < 1e-14 {
            return Some(l);
        }
    }
    None
}

/// `l` with sum 0, at right angles to `against`, at length one.
fn tidy(mut l: Vec<f64>, point: &[f64], against: Option<&Vec<f64>>) -> Option<Vec<f64>> {
    let before = dot(&l, &l).sqrt();
    // Rounding lets a part of the limit point in, which grows.
    let sum: f64 = l.iter().sum();
    l.iter_mut().zip(point).for_each(|(x, p)| *x -= sum * p);
    if let Some(a) = against {
        let along = dot(&l, a);
        l.iter_mut().zip(a).for_each(|(x, y)| *x -= along * y);
    }
    let length = dot(&l, &l).sqrt();
    if length <= 1e-12 * before || !length.is_normal() {
        return None;
    }
    l.iter_mut().for_each(|x| *x /= length);
    Some(l)
}

/// How much of `l` is left outside of the plane of two orthonormal vectors.
fn outside(l: &[f64], plane: [&Vec<f64>; 2]) -> f64 {
    let along = plane.map(|p| dot(l, p));
    l.iter().enumerate().map(|(i, x)| (x - along[0] * plane[0][i] - along[1] * plane[1][i]).abs()).fold(0.0, f64::max)
}

/// Whether two pairs of vectors span the same plane.
pub(super) fn same_plane(a: [Vec<f64>; 2], b: [Vec<f64>; 2]) -> bool {
    let basis = |[x, y]: [Vec<f64>; 2]| {
        let x = one(x)?;
        let along = dot(&y, &x);
        let y = one(y.iter().zip(&x).map(|(y, x)| y - along * x).collect())?;
        Some([x, y])
    };
    match (basis(a), basis(b)) {
        (Some([x, y]), Some([p, q])) => outside(&p, [&x, &y]).max(outside(&q, [&x, &y])) < 1e-9,
        _ => false,
    }
}

/// `l` at length one.
fn one(mut l: Vec<f64>) -> Option<Vec<f64>> {
    let length = dot(&l, &l).sqrt();
    l.iter_mut().for_each(|x| *x /= length);
    length.is_normal().then_some(l)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
