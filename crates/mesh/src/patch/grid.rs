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
//! Cost: about 0.5 ns a point for regular quads, 1 to 2 for tables, 2 for normals.

use super::class::Table;

/// Values that are worked on at once: eight on the web and natively, four by four or eight at once as the machine can.
pub(super) const LANES: usize = 8;
/// Steps along a side that room is made for.
pub(super) const MOST_STEPS: usize = 32;
/// Room for a row, its last chunk included.
const ROW: usize = MOST_STEPS + 1 + LANES;

type Chunk = [f32; LANES];

/// Three planes of a grid.
#[derive(Clone, Debug)]
pub(super) struct Planes {
    values: [Vec<f32>; 3],
}

impl Planes {
    /// Room for the points of a grid of `m` steps, and for chunks that begin at its last point.
    pub(super) fn new(m: usize) -> Planes {
        Planes { values: [(); 3].map(|()| vec![0.0; (m + 1) * (m + 1) + 2 * LANES]) }
    }

    /// The point at a place.
    #[inline(always)]
    pub(super) fn point(&self, place: u16) -> [f32; 3] {
        self.values.each_ref().map(|plane| plane[usize::from(place)])
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
}

impl Spline {
    /// Lane and Riesenfeld's cubic rule (1/8, 3/4, 1/8 at points, 1/2, 1/2 between), again and again. Exact: the weights
    /// are fractions of powers of 8.
    pub(super) fn new(depth: u32) -> Spline {
        let mut columns = [(); 4].map(|()| vec![0.0; ROW + LANES]);
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
        }
        Spline { columns }
    }

    /// The grid of a regular quad patch: `controls` as [`super::ring::Ring`] lists them.
    #[inline(always)]
    pub(super) fn evaluate(&self, m: usize, controls: &[[f32; 3]; 16], out: &mut Planes) {
        // The ring as rows, from below left.
        const ROWS: [[usize; 4]; 4] = [[5, 6, 7, 8], [4, 0, 1, 9], [15, 3, 2, 10], [14, 13, 12, 11]];
        let w = m + 1;
        let chunks = w.div_ceil(LANES);
        let columns = self.columns.each_ref().map(|c| c.as_chunks::<LANES>().0);
        let mut rows = [[[[0.0f32; LANES]; ROW / LANES]; 4]; 3];
        for k in 0..3 {
            for a in 0..4 {
                let p = ROWS[a].map(|c| controls[c][k]);
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
                let a = self.columns.each_ref().map(|c| c[j]);
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
        }
    }
}

impl Table {
    /// The grid of a patch with that ring: `controls` are the active ones.
    #[inline(always)]
    pub(super) fn evaluate(&self, controls: &[[f32; 3]], out: &mut Planes) {
        let [x, y, z] = &mut out.values;
        let planes = x.as_chunks_mut().0.iter_mut().zip(y.as_chunks_mut().0).zip(z.as_chunks_mut().0);
        let blocks = self.weights.chunks_exact(controls.len() * LANES);
        for (block, ((x, y), z)) in blocks.zip(planes) {
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

/// Rows of face normals, with a zero before and behind.
struct Rows {
    /// Of the faces between this row of points and the next: of quads; of triangles those that point up, and down.
    faces: [[[f32; ROW + LANES]; 3]; 2],
    /// What the row before left for this one.
    left: [[f32; ROW + LANES]; 3],
}

/// Adds the normals of the patch's own faces up at every point of its grid: areas are their lengths (twice).
#[inline(always)]
pub(super) fn sum_normals(sides: usize, m: usize, points: &Planes, out: &mut Planes) {
    let zero = [[0.0; ROW + LANES]; 3];
    let mut rows = Rows { faces: [zero; 2], left: zero };
    let mut start = 0;
    for j in 0..=m {
        let quads = sides == 4;
        let length = if quads { m + 1 } else { m + 1 - j };
        if j < m {
            face_row(quads, points, start, length, &mut rows.faces);
        } else {
            rows.faces = [zero; 2];
        }
        let Rows { faces: [up, down], left } = &mut rows;
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
    let chunks = count.div_ceil(LANES);
    let all = x.as_chunks_mut::<LANES>().0.iter_mut().zip(y.as_chunks_mut::<LANES>().0);
    for ((x, y), z) in all.zip(z.as_chunks_mut::<LANES>().0).take(chunks) {
        let mut squares = [0.0; LANES];
        let mut plain = true;
        for l in 0..LANES {
            squares[l] = x[l] * x[l] + y[l] * y[l] + z[l] * z[l];
            plain &= squares[l] > 1e-30 && squares[l] < 1e30;
        }
        if plain {
            for l in 0..LANES {
                let inverse = 1.0 / squares[l].sqrt();
                x[l] *= inverse;
                y[l] *= inverse;
                z[l] *= inverse;
            }
        } else {
            for l in 0..LANES {
                [x[l], y[l], z[l]] = crate::refined::unit([x[l], y[l], z[l]]);
            }
        }
    }
}
