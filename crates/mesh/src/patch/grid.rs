//! The arithmetic on a patch's grid: points from its ring, sums of normals, unit normals.
//!
//! Coordinates lie in planes (all x, all y, all z), so that every loop is the same operation on neighbours in memory and
//! compilers turn it into vector instructions, whatever the machine has. Sums run in the same order on all of them, without
//! fused multiply-add: native and wasm give the same bits.
//!
//! ```text
//!   regular quads    A P A^T   rows first: 4 rows of m + 1 points, then m + 1 rows of those      8 products a point
//!   all others       T P       a table of the ring (`class.rs`)                                16 and more
//! ```
//!
//! Rows are cut into chunks of [`LANES`] whose last one runs into the next row, which is written after it.
//!
//! Cost: linear; 16 products a point and more for tables, about the points' time again for normals.

// Loops over lanes name the lane: that is what makes vector instructions of them.
#![allow(clippy::needless_range_loop)]

use super::class::Table;

/// Values that are worked on at once: eight on the web and natively, four by four or eight at once as the machine can.
pub(super) const LANES: usize = 8;
/// Steps along a side that room is made for.
pub(super) const MOST_STEPS: usize = 32;
/// Room for a row, its last chunk included.
const ROW: usize = MOST_STEPS + 1 + LANES;

type Chunk = [f32; LANES];

/// Three planes: a grid, and behind it (at a multiple of [`LANES`]) a strip of m + 1 points for each side, the row of points
/// across it. Of triangles a strip has m points. Where nothing is across it is the side itself.
#[derive(Clone, Debug)]
pub(super) struct Planes {
    values: [Vec<f32>; 3],
}

/// Where the strips begin, behind a grid of so many points.
pub(super) fn strips(points: usize) -> usize {
    points.next_multiple_of(LANES)
}

impl Planes {
    /// Room for grids of `m` steps, strips, and chunks that begin at the last point.
    pub(super) fn new(m: usize) -> Planes {
        let room = strips((m + 1) * (m + 1)) + 4 * (m + 1) + 3 * LANES;
        Planes { values: [(); 3].map(|()| vec![0.0; room]) }
    }

    /// The point at a place.
    #[inline(always)]
    pub(super) fn point(&self, place: u16) -> [f32; 3] {
        let ([x, y, z], place) = (&self.values, usize::from(place));
        [x[place], y[place], z[place]]
    }

    /// Copies the points at `places`.
    #[inline(always)]
    pub(super) fn copy(&self, places: &[u16], out: &mut [[f32; 3]]) {
        let [x, y, z] = &self.values;
        // One length, so that one look at a place is enough.
        let (y, z) = (&y[..x.len()], &z[..x.len()]);
        for (out, &place) in out.iter_mut().zip(places) {
            let place = usize::from(place);
            *out = [x[place], y[place], z[place]];
        }
    }
}

/// The weights of a uniform cubic B-spline's control points in the points of one of its spans, cut `depth` times: column b,
/// point i at `[b][i]`.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    columns: [Vec<f32>; 4],
    /// Those of the points before the span and behind it.
    beyond: [[f32; 4]; 2],
}

impl Spline {
    /// Lane and Riesenfeld's cubic rule (1/8, 3/4, 1/8 at points, 1/2, 1/2 between), again and again. Exact: the weights
    /// are fractions of powers of 8.
    pub(super) fn new(depth: u32) -> Spline {
        let mut columns = [(); 4].map(|()| vec![0.0; ROW + LANES]);
        let mut beyond = [[0.0; 4]; 2];
        for (b, column) in columns.iter_mut().enumerate() {
            let mut points = [0.0f32; 4].to_vec();
            points[b] = 1.0;
            for _ in 0..depth {
                // From the point before the span to the one behind it.
                let n = points.len();
                points = (1..2 * n - 2)
                    .map(|i| match (i / 2, i % 2) {
                        (k, 0) => (points[k - 1] + 6.0 * points[k] + points[k + 1]) / 8.0,
                        (k, _) => (points[k] + points[k + 1]) / 2.0,
                    })
                    .collect();
            }
            let inner = &points[1..points.len() - 1];
            column[..inner.len()].copy_from_slice(inner);
            [beyond[0][b], beyond[1][b]] = [points[0], points[points.len() - 1]];
        }
        Spline { columns, beyond }
    }

    /// The grid of a regular quad patch, and its strips if it is `shaded`: `controls` as [`super::ring::Ring`] lists them.
    #[inline(always)]
    pub(super) fn evaluate(&self, m: usize, controls: &[[f32; 3]; 16], shaded: bool, out: &mut Planes) {
        // The ring as rows, from below left.
        const ROWS: [[usize; 4]; 4] = [[5, 6, 7, 8], [4, 0, 1, 9], [15, 3, 2, 10], [14, 13, 12, 11]];
        let w = m + 1;
        let chunks = w.div_ceil(LANES);
        // Written out: closures over arrays are calls here.
        let [c0, c1, c2, c3] = &self.columns;
        let columns = [c0.as_chunks::<LANES>().0, c1.as_chunks().0, c2.as_chunks().0, c3.as_chunks().0];
        let of = |row: &[usize; 4], k: usize| {
            [controls[row[0]][k], controls[row[1]][k], controls[row[2]][k], controls[row[3]][k]]
        };
        let mut rows = [[[[0.0f32; LANES]; ROW / LANES]; 4]; 3];
        for k in 0..3 {
            for a in 0..4 {
                let p = of(&ROWS[a], k);
                for i in 0..chunks {
                    let mut sum = [0.0; LANES];
                    for l in 0..LANES {
                        sum[l] = columns[0][i][l] * p[0]
                            + columns[1][i][l] * p[1]
                            + columns[2][i][l] * p[2]
                            + columns[3][i][l] * p[3];
                    }
                    rows[k][a][i] = sum;
                }
            }
        }
        for (plane, rows) in out.values.iter_mut().zip(&rows) {
            for j in 0..w {
                let a = [c0[j], c1[j], c2[j], c3[j]];
                let row = &mut plane[j * w..j * w + chunks * LANES];
                for (i, out) in row.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                    let mut sum = [0.0; LANES];
                    for l in 0..LANES {
                        sum[l] =
                            a[0] * rows[0][i][l] + a[1] * rows[1][i][l] + a[2] * rows[2][i][l] + a[3] * rows[3][i][l];
                    }
                    *out = sum;
                }
            }
            if !shaded {
                continue;
            }
            let first = strips(w * w);
            for (side, a) in [(0, self.beyond[0]), (2, self.beyond[1])] {
                let mut strip = [0.0; ROW / LANES * LANES];
                for (i, out) in strip.as_chunks_mut::<LANES>().0.iter_mut().enumerate().take(chunks) {
                    for l in 0..LANES {
                        out[l] =
                            a[0] * rows[0][i][l] + a[1] * rows[1][i][l] + a[2] * rows[2][i][l] + a[3] * rows[3][i][l];
                    }
                }
                lay(&strip[..w], side == 2, &mut plane[first + side * w..][..w]);
            }
        }
        if !shaded {
            return;
        }
        // Across the two other sides: columns instead of rows.
        for (k, plane) in out.values.iter_mut().enumerate() {
            let first = strips(w * w);
            for (side, b) in [(3, self.beyond[0]), (1, self.beyond[1])] {
                let mut q = [0.0; 4];
                for (q, row) in q.iter_mut().zip(&ROWS) {
                    let p = of(row, k);
                    *q = b[0] * p[0] + b[1] * p[1] + b[2] * p[2] + b[3] * p[3];
                }
                let mut strip = [0.0; ROW / LANES * LANES];
                for (j, out) in strip.as_chunks_mut::<LANES>().0.iter_mut().enumerate().take(chunks) {
                    for l in 0..LANES {
                        out[l] = columns[0][j][l] * q[0]
                            + columns[1][j][l] * q[1]
                            + columns[2][j][l] * q[2]
                            + columns[3][j][l] * q[3];
                    }
                }
                lay(&strip[..w], side == 3, &mut plane[first + side * w..][..w]);
            }
        }
    }
}

/// Copies a strip in the direction of its side.
#[inline(always)]
fn lay(strip: &[f32], back: bool, out: &mut [f32]) {
    if back {
        out.iter_mut().zip(strip.iter().rev()).for_each(|(out, x)| *out = *x);
    } else {
        out.copy_from_slice(strip);
    }
}

impl Table {
    /// The grid of a patch with that ring, the first so many of its points and strips: `controls` are the active ones.
    #[inline(always)]
    pub(super) fn evaluate(&self, controls: &[[f32; 3]], count: usize, out: &mut Planes) {
        let [x, y, z] = &mut out.values;
        let planes = x.as_chunks_mut().0.iter_mut().zip(y.as_chunks_mut().0).zip(z.as_chunks_mut().0);
        let blocks = self.weights.chunks_exact(controls.len() * LANES);
        for (block, ((x, y), z)) in blocks.zip(planes).take(count.div_ceil(LANES)) {
            let mut sums = [[0.0f32; LANES]; 3];
            for (weights, p) in block.as_chunks::<LANES>().0.iter().zip(controls) {
                for l in 0..LANES {
                    sums[0][l] += weights[l] * p[0];
                    sums[1][l] += weights[l] * p[1];
                    sums[2][l] += weights[l] * p[2];
                }
            }
            [*x, *y, *z] = sums;
        }
    }
}

#[inline(always)]
fn chunk(plane: &[f32], at: usize) -> Chunk {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&plane[at..at + LANES]);
    out
}

/// Room for rows of normals, kept from patch to patch: only what is read is written anew.
#[derive(Debug)]
pub(super) struct Rows {
    /// Of the faces between this row of points and the next, with a zero before and behind: of quads; of triangles those that
    /// point up, and down. Across a side: what its faces give to the point before and to that behind.
    faces: [[[f32; ROW + LANES]; 3]; 2],
    across: [[[f32; ROW + LANES]; 3]; 2],
    /// What the row before left for this one, and the points of a side.
    left: [[f32; ROW + LANES]; 3],
}

impl Rows {
    pub(super) fn new() -> Rows {
        let zero = [[0.0; ROW + LANES]; 3];
        Rows { faces: [zero; 2], across: [zero; 2], left: zero }
    }
}

/// Adds the normals of the patch's own faces up at every point of its grid: areas are their lengths (twice).
#[inline(always)]
pub(super) fn sum_normals(sides: usize, m: usize, points: &Planes, rows: &mut Rows, out: &mut Planes) {
    let Rows { faces, left, .. } = rows;
    left.iter_mut().for_each(|left| left[..m + 1 + LANES].fill(0.0));
    let mut start = 0;
    for j in 0..=m {
        let quads = sides == 4;
        let length = if quads { m + 1 } else { m + 1 - j };
        if j == m {
            for (plane, left) in out.values.iter_mut().zip(&*left) {
                plane[start..start + length].copy_from_slice(&left[..length]);
                // No odd vectors behind.
                plane[start + length..start + length + LANES].fill(1.0);
            }
            return;
        }
        face_row(quads, points, start, length, faces);
        let [up, down] = &*faces;
        for k in 0..3 {
            for i in (0..length).step_by(LANES) {
                // Faces before and behind the point, of this row; index 0 of `up` is before the first point.
                let (before, behind) = (chunk(&up[k], i), chunk(&up[k], i + 1));
                let (lower, dip) = (chunk(&left[k], i), chunk(&down[k], i));
                let mut sum = [0.0; LANES];
                let mut leave = [0.0; LANES];
                if quads {
                    for l in 0..LANES {
                        leave[l] = before[l] + behind[l];
                        sum[l] = lower[l] + leave[l];
                    }
                } else {
                    // Above a point: the faces that stand on it. Of the row above: those whose tip or edge it is.
                    let next_dip = chunk(&down[k], i + 1);
                    for l in 0..LANES {
                        sum[l] = lower[l] + (before[l] + behind[l] + dip[l]);
                        leave[l] = behind[l] + (dip[l] + next_dip[l]);
                    }
                }
                out.values[k][start + i..start + i + LANES].copy_from_slice(&sum);
                left[k][i..i + LANES].copy_from_slice(&leave);
            }
        }
        start += length;
    }
}

/// The normals of the faces between a row of points and the next. Index i + 1 holds the face at point i; the others are 0.
#[inline(always)]
fn face_row(quads: bool, points: &Planes, start: usize, length: usize, out: &mut [[[f32; ROW + LANES]; 3]; 2]) {
    let [x, y, z] = &points.values;
    let (faces, above) = (length - 1, start + length);
    for i in (0..faces).step_by(LANES) {
        let at = |p: usize| [chunk(x, p), chunk(y, p), chunk(z, p)];
        let (a, b, d) = (at(start + i), at(start + i + 1), at(above + i));
        let (up, down) = if quads {
            let c = at(above + i + 1);
            (cross(&minus(&c, &a), &minus(&d, &b)), None)
        } else {
            // The last chunk reads into the row after the next, or behind the grid; what it makes of that is cut off.
            let c = at(above + i + 1);
            (cross(&minus(&b, &a), &minus(&d, &a)), Some(cross(&minus(&c, &b), &minus(&d, &b))))
        };
        for k in 0..3 {
            out[0][k][i + 1..i + 1 + LANES].copy_from_slice(&up[k]);
            if let Some(down) = &down {
                out[1][k][i + 1..i + 1 + LANES].copy_from_slice(&down[k]);
            }
        }
    }
    for k in 0..3 {
        out[0][k][faces + 1..faces + 1 + LANES].fill(0.0);
        // One face that points down less.
        let down = faces.saturating_sub(1);
        out[1][k][down + 1..down + 1 + LANES].fill(0.0);
    }
}

/// Adds the normals of the faces across the sides of a patch with `points` points to the sums at its border: `border` is as
/// in [`super::layout::Layout`]. Corners, where other faces meet, are left out.
#[inline(always)]
pub(super) fn add_across(
    (sides, m, points): (usize, usize, usize),
    border: &[u16],
    from: &Planes,
    rows: &mut Rows,
    out: &mut Planes,
) {
    let w = m + 1;
    let Rows { across: give, left: line, .. } = rows;
    for side in 0..sides {
        let own = &border[side * m..(side + 1) * m];
        let end = border[(side + 1) % sides * m];
        for (line, plane) in line.iter_mut().zip(&from.values) {
            line.iter_mut().zip(own).for_each(|(x, &place)| *x = plane[usize::from(place)]);
            line[m] = plane[usize::from(end)];
        }
        let [x, y, z] = &from.values;
        let strip = strips(points) + side * w;
        for i in (0..m).step_by(LANES) {
            let on = |p: usize| [chunk(&line[0], p), chunk(&line[1], p), chunk(&line[2], p)];
            let over = |p: usize| [chunk(x, strip + p), chunk(y, strip + p), chunk(z, strip + p)];
            let (a, b, c, d) = (on(i), on(i + 1), over(i), over(i + 1));
            let [before, behind] = if sides == 4 {
                [cross(&minus(&c, &b), &minus(&d, &a)); 2]
            } else {
                // The face on step i, and the one that stands on its second end.
                let face = cross(&minus(&a, &b), &minus(&c, &b));
                let next = cross(&minus(&c, &b), &minus(&d, &b));
                let mut both = face;
                for k in 0..3 {
                    for l in 0..LANES {
                        both[k][l] += next[k][l];
                    }
                }
                [face, both]
            };
            for k in 0..3 {
                give[0][k][i..i + LANES].copy_from_slice(&before[k]);
                give[1][k][i + 1..i + 1 + LANES].copy_from_slice(&behind[k]);
            }
        }
        for (k, plane) in out.values.iter_mut().enumerate() {
            for (p, &place) in own.iter().enumerate().skip(1) {
                plane[usize::from(place)] += give[0][k][p] + give[1][k][p];
            }
        }
    }
}

#[inline(always)]
fn minus(a: &[Chunk; 3], b: &[Chunk; 3]) -> [Chunk; 3] {
    let mut out = *a;
    for k in 0..3 {
        for l in 0..LANES {
            out[k][l] -= b[k][l];
        }
    }
    out
}

#[inline(always)]
fn cross(a: &[Chunk; 3], b: &[Chunk; 3]) -> [Chunk; 3] {
    let mut out = [[0.0; LANES]; 3];
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        for l in 0..LANES {
            out[k][l] = a[i][l] * b[j][l] - a[j][l] * b[i][l];
        }
    }
    out
}

/// Makes unit vectors of the first `count`.
#[inline(always)]
pub(super) fn normalise(planes: &mut Planes, count: usize) {
    let [x, y, z] = &mut planes.values;
    let all = x.as_chunks_mut().0.iter_mut().zip(y.as_chunks_mut().0).zip(z.as_chunks_mut().0);
    for ((x, y), z) in all.take(count.div_ceil(LANES)) {
        [*x, *y, *z] = units([*x, *y, *z]);
    }
}

/// The unit vectors of some.
#[inline(always)]
fn units(v: [Chunk; 3]) -> [Chunk; 3] {
    let (mut squares, mut plain) = ([0.0; LANES], true);
    for l in 0..LANES {
        squares[l] = v[0][l] * v[0][l] + v[1][l] * v[1][l] + v[2][l] * v[2][l];
    }
    for s in squares {
        plain &= s > 1e-30 && s < 1e30;
    }
    if !plain {
        return odd_units(v);
    }
    let mut inverse = [0.0; LANES];
    for l in 0..LANES {
        inverse[l] = 1.0 / squares[l].sqrt();
    }
    let mut out = v;
    for plane in &mut out {
        for l in 0..LANES {
            plane[l] *= inverse[l];
        }
    }
    out
}

/// The same where squares leave what numbers can hold.
#[cold]
fn odd_units(mut v: [Chunk; 3]) -> [Chunk; 3] {
    for l in 0..LANES {
        let unit = crate::refined::unit([v[0][l], v[1][l], v[2][l]]);
        (0..3).for_each(|k| v[k][l] = unit[k]);
    }
    v
}
