//! The arithmetic on patches' grids: points from rings, sums of normals, unit normals.
//!
//! Eight patches at once, one a lane: a cell holds a point of each. Whatever is done to one is done to all, so every
//! operation is one on eight neighbours in memory, which compilers turn into vector instructions, whatever the machine has
//! and however short rows are. Lanes never meet, and sums run in the same order everywhere, without fused multiply-add: a
//! patch's bits are the same natively and in wasm, and whichever patches it is evaluated with.
//!
//! ```text
//!   regular quads    A P A^T   rows first: 4 rows of m + 1 points, then m + 1 rows of those      8 products a point
//!   all others       T P       a table of the ring (`class.rs`)                                16 and more
//! ```
//!
//! Cost: linear; 16 products a point and more for tables, about the points' time again for normals.

use super::class::Table;

/// Patches that are worked on at once: eight, four by four or eight at once as the machine can; one by one in WebAssembly
/// without vectors, where eight numbers are as much work as eight times one and have no place but memory. Lanes do not meet, so
/// the bits are the same.
#[cfg(not(all(target_family = "wasm", not(target_feature = "simd128"))))]
pub(super) const LANES: usize = 8;
#[cfg(all(target_family = "wasm", not(target_feature = "simd128")))]
pub(super) const LANES: usize = 1;
/// Points whose weights lie together in a table.
pub(super) const BLOCK: usize = 8;
/// Steps along a side that a patch has at most.
pub(super) const MOST_STEPS: usize = 32;

/// A point of each of eight patches.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[cfg_attr(not(all(target_family = "wasm", not(target_feature = "simd128"))), repr(align(32)))]
pub(super) struct Cell(pub [[f32; LANES]; 3]);

impl Cell {
    pub(super) const ZERO: Cell = Cell([[0.0; LANES]; 3]);

    /// The point in a lane.
    #[inline(always)]
    pub(super) fn point(&self, lane: usize) -> [f32; 3] {
        let [x, y, z] = &self.0;
        [x[lane], y[lane], z[lane]]
    }

    /// Sets the point in a lane.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, point: [f32; 3]) {
        let [x, y, z] = &mut self.0;
        [x[lane], y[lane], z[lane]] = point;
    }
}

/// Eight values, written out: what begins as zeros and is filled lane by lane is a block of memory to compilers, and on
/// the web every copy of a block is a call.
macro_rules! eight {
    ($l:ident => $value:expr) => {
        [
            {
                const $l: usize = 0;
                $value
            },
            {
                const $l: usize = 1;
                $value
            },
            {
                const $l: usize = 2;
                $value
            },
            {
                const $l: usize = 3;
                $value
            },
            {
                const $l: usize = 4;
                $value
            },
            {
                const $l: usize = 5;
                $value
            },
            {
                const $l: usize = 6;
                $value
            },
            {
                const $l: usize = 7;
                $value
            },
        ]
    };
}

/// A value for each lane.
#[cfg(all(target_family = "wasm", not(target_feature = "simd128")))]
macro_rules! lanes {
    ($l:ident => $value:expr) => {
        [{
            const $l: usize = 0;
            $value
        }]
    };
}
#[cfg(not(all(target_family = "wasm", not(target_feature = "simd128"))))]
pub(super) use eight as lanes;
#[cfg(all(target_family = "wasm", not(target_feature = "simd128")))]
pub(super) use lanes;

/// A value for each coordinate and lane.
macro_rules! cell {
    ($k:ident, $l:ident => $value:expr) => {
        Cell([
            { const $k: usize = 0; lanes!($l => $value) },
            { const $k: usize = 1; lanes!($l => $value) },
            { const $k: usize = 2; lanes!($l => $value) },
        ])
    };
}
pub(super) use cell;

/// Room for the grids of eight patches of `m` steps: points, and behind them a strip of m + 1 for each side, the row of
/// points across it. Of triangles a strip has m points. Where nothing is across it is the side itself.
pub(super) fn room(m: usize) -> Vec<Cell> {
    vec![Cell::ZERO; (m + 1) * (m + 1) + 4 * (m + 1) + LANES]
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
        let mut columns: [Vec<f32>; 4] = Default::default();
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
            *column = points[1..points.len() - 1].to_vec();
            [beyond[0][b], beyond[1][b]] = [points[0], points[points.len() - 1]];
        }
        Spline { columns, beyond }
    }

    /// The four weights at every position along a span, from the point before it to the one behind it.
    pub(super) fn along(&self) -> Vec<[f32; 4]> {
        let [a, b, c, d] = &self.columns;
        let inside = a.iter().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| [*a, *b, *c, *d]);
        [self.beyond[0]].into_iter().chain(inside).chain([self.beyond[1]]).collect()
    }

    /// The grids of regular quad patches, and their strips if they are `shaded`: `controls` as [`super::ring::Ring`] lists them.
    #[inline(always)]
    pub(super) fn evaluate(&self, m: usize, controls: &[Cell], shaded: bool, rows: &mut Vec<Cell>, out: &mut [Cell]) {
        // The ring as rows, from below left.
        const ROWS: [[usize; 4]; 4] = [[5, 6, 7, 8], [4, 0, 1, 9], [15, 3, 2, 10], [14, 13, 12, 11]];
        let w = m + 1;
        let [c0, c1, c2, c3] = &self.columns;
        // Written out here and below: closures over arrays are calls, and calls do not have this function's vectors.
        let columns = [&c0[..w], &c1[..w], &c2[..w], &c3[..w]];
        rows.clear();
        for [a, b, c, d] in &ROWS {
            let p = [&controls[*a], &controls[*b], &controls[*c], &controls[*d]];
            for (((a, b), c), d) in columns[0].iter().zip(columns[1]).zip(columns[2]).zip(columns[3]) {
                rows.push(blend([*a, *b, *c, *d], p));
            }
        }
        let (below, above) = rows.split_at(2 * w);
        let ((r0, r1), (r2, r3)) = (below.split_at(w), above.split_at(w));
        let rows = [r0, r1, r2, r3];
        for (j, out) in out[..w * w].chunks_exact_mut(w).enumerate() {
            line([columns[0][j], columns[1][j], columns[2][j], columns[3][j]], rows, out);
        }
        if !shaded {
            return;
        }
        let strips = &mut out[w * w..][..4 * w];
        line(self.beyond[0], rows, &mut strips[..w]);
        line(self.beyond[1], rows, &mut strips[2 * w..3 * w]);
        strips[2 * w..3 * w].reverse();
        // Across the two other sides: columns instead of rows.
        for (side, beyond) in [(3, self.beyond[0]), (1, self.beyond[1])] {
            let mut q = [Cell::ZERO; 4];
            for (q, [a, b, c, d]) in q.iter_mut().zip(&ROWS) {
                *q = blend(beyond, [&controls[*a], &controls[*b], &controls[*c], &controls[*d]]);
            }
            let q = [&q[0], &q[1], &q[2], &q[3]];
            let strip = &mut strips[side * w..(side + 1) * w];
            for (j, out) in strip.iter_mut().enumerate() {
                *out = blend([columns[0][j], columns[1][j], columns[2][j], columns[3][j]], q);
            }
            if side == 3 {
                strip.reverse();
            }
        }
    }
}

/// Four rows times their weights: as one long row of numbers.
#[inline(always)]
fn line(a: [f32; 4], [r0, r1, r2, r3]: [&[Cell]; 4], out: &mut [Cell]) {
    let out: &mut [f32] = bytemuck::cast_slice_mut(out);
    let n = out.len();
    let (r0, r1): (&[f32], &[f32]) = (&bytemuck::cast_slice(r0)[..n], &bytemuck::cast_slice(r1)[..n]);
    let (r2, r3): (&[f32], &[f32]) = (&bytemuck::cast_slice(r2)[..n], &bytemuck::cast_slice(r3)[..n]);
    for i in 0..n {
        out[i] = a[0] * r0[i] + a[1] * r1[i] + a[2] * r2[i] + a[3] * r3[i];
    }
}

/// Four points times their weights.
#[inline(always)]
fn blend(a: [f32; 4], [p0, p1, p2, p3]: [&Cell; 4]) -> Cell {
    let (p0, p1, p2, p3) = (&p0.0, &p1.0, &p2.0, &p3.0);
    cell!(K, L => a[0] * p0[K][L] + a[1] * p1[K][L] + a[2] * p2[K][L] + a[3] * p3[K][L])
}

impl Table {
    /// The grids of patches with that ring, the first points and strips of them: `controls` are the active ones.
    #[inline(always)]
    pub(super) fn evaluate(&self, controls: &[Cell], out: &mut [Cell]) {
        let blocks = self.weights.chunks_exact(controls.len() * BLOCK);
        for (block, out) in blocks.zip(out.chunks_mut(BLOCK)) {
            // Two points at once: each control point is read half as often.
            for (i, out) in out.chunks_mut(2).enumerate() {
                let weights = block.as_chunks::<BLOCK>().0;
                let ([weights, more @ ..], [p, others @ ..]) = (weights, controls) else { return };
                let [a, b] = weights.as_chunks::<2>().0[i];
                let (mut first, mut second) = (cell!(K, L => a * p.0[K][L]), cell!(K, L => b * p.0[K][L]));
                for (weights, p) in more.iter().zip(others) {
                    let [a, b] = weights.as_chunks::<2>().0[i];
                    first = cell!(K, L => first.0[K][L] + a * p.0[K][L]);
                    second = cell!(K, L => second.0[K][L] + b * p.0[K][L]);
                }
                if let [out, rest @ ..] = out {
                    *out = first;
                    if let [out, ..] = rest {
                        *out = second;
                    }
                }
            }
        }
    }

    /// The same of one patch, into its lane: where there are too few with that ring.
    #[inline(always)]
    pub(super) fn evaluate_one(&self, controls: &[[f32; 3]], lane: usize, out: &mut [Cell]) {
        let blocks = self.weights.chunks_exact(controls.len() * BLOCK);
        for (block, out) in blocks.zip(out.chunks_mut(BLOCK)) {
            let weights = block.as_chunks::<BLOCK>().0;
            let ([weights, more @ ..], [p, others @ ..]) = (weights, controls) else { return };
            let [mut x, mut y, mut z] = p.map(|p| eight!(L => weights[L] * p));
            for (weights, p) in more.iter().zip(others) {
                x = eight!(L => x[L] + weights[L] * p[0]);
                y = eight!(L => y[L] + weights[L] * p[1]);
                z = eight!(L => z[L] + weights[L] * p[2]);
            }
            for (l, out) in out.iter_mut().enumerate() {
                out.set(lane, [x[l], y[l], z[l]]);
            }
        }
    }
}

/// Room for rows of normals. Values stay where they are written: see [`lanes`].
#[derive(Debug)]
pub(super) struct Rows {
    /// Of faces, with a zero before the first: of quads; of triangles those that stand on the row, and those between them. Along
    /// a side what its steps give to the point before them, and behind.
    faces: [Vec<Cell>; 2],
    /// What the row before leaves for this one.
    left: Vec<Cell>,
}

impl Rows {
    pub(super) fn new(m: usize) -> Rows {
        let row = || vec![Cell::ZERO; m + 3];
        Rows { faces: [row(), row()], left: row() }
    }
}

/// The normals of patches at every point of their grids, but at their corners: there the sum of what their own faces give, whose
/// areas are their lengths (twice). `border` is as in [`super::layout::Layout`], and `points` is how many there are before the
/// strips.
#[inline(always)]
pub(super) fn shade(
    (sides, m, points): (usize, usize, usize),
    border: &[u16],
    from: &[Cell],
    rows: &mut Rows,
    out: &mut [Cell],
) {
    let Rows { faces: [up, down], left } = rows;
    left.fill(Cell::ZERO);
    (up[0], down[0]) = (Cell::ZERO, Cell::ZERO);
    let mut start = 0;
    for j in 0..m {
        let length = if sides == 4 { m + 1 } else { m + 1 - j };
        let (row, above) = from[start..].split_at(length);
        let sums = &mut out[start..start + length];
        if sides == 4 {
            add_quads(row, &above[..length], up, left, sums);
        } else {
            add_triangles(row, &above[..length - 1], (up, down), left, sums);
        }
        if j > 0 {
            // Nothing comes from across.
            for sum in &mut sums[1..length - 1] {
                *sum = unit(sum);
            }
        }
        start += length;
    }
    let length = if sides == 4 { m + 1 } else { 1 };
    out[start..start + length].copy_from_slice(&left[..length]);
    for side in 0..sides {
        let own = &border[side * m..(side + 1) * m];
        let end = border[(side + 1) % sides * m];
        let strip = &from[points + side * (m + 1)..][..m + 1];
        for p in 0..m {
            let a = &from[usize::from(own[p])];
            let b = &from[usize::from(*own.get(p + 1).unwrap_or(&end))];
            let (c, d) = (&strip[p], &strip[p + 1]);
            if sides == 4 {
                up[p] = cross(&minus(c, b), &minus(d, a));
            } else {
                // The face on step p, and with it the one that stands on its second end.
                up[p] = cross(&minus(a, b), &minus(c, b));
                down[p] = plus(&up[p], &cross(&minus(c, b), &minus(d, b)));
            }
        }
        let behind = if sides == 4 { &*up } else { &*down };
        for p in 1..m {
            let sum = &mut out[usize::from(own[p])];
            *sum = unit(&plus(sum, &plus(&up[p], &behind[p - 1])));
        }
    }
}

/// Adds up the normals of the quads between a row of points and the next: at the row's, and what they leave for the next.
#[inline(always)]
fn add_quads(row: &[Cell], above: &[Cell], faces: &mut [Cell], left: &mut [Cell], sums: &mut [Cell]) {
    let m = row.len() - 1;
    let (above, left, sums, faces) = (&above[..m + 1], &mut left[..m + 1], &mut sums[..m + 1], &mut faces[..m + 2]);
    for i in 0..m {
        faces[i + 1] = cross(&minus(&above[i + 1], &row[i]), &minus(&above[i], &row[i + 1]));
    }
    faces[m + 1] = Cell::ZERO;
    for i in 0..m + 1 {
        sums[i] = plus(&left[i], &plus(&faces[i], &faces[i + 1]));
        left[i] = plus(&faces[i], &faces[i + 1]);
    }
}

/// The same of triangles, whose next row is one shorter: those that stand on the row, and those between them.
#[inline(always)]
fn add_triangles(
    row: &[Cell],
    above: &[Cell],
    (up, down): (&mut [Cell], &mut [Cell]),
    left: &mut [Cell],
    sums: &mut [Cell],
) {
    let m = row.len() - 1;
    let (above, left, sums) = (&above[..m], &mut left[..m + 1], &mut sums[..m + 1]);
    let (up, down) = (&mut up[..m + 2], &mut down[..m + 2]);
    for i in 0..m {
        up[i + 1] = cross(&minus(&row[i + 1], &row[i]), &minus(&above[i], &row[i]));
    }
    for i in 0..m - 1 {
        down[i + 1] = cross(&minus(&above[i + 1], &row[i + 1]), &minus(&above[i], &row[i + 1]));
    }
    (up[m + 1], down[m], down[m + 1]) = (Cell::ZERO, Cell::ZERO, Cell::ZERO);
    for i in 0..m + 1 {
        sums[i] = plus(&left[i], &plus(&plus(&up[i], &up[i + 1]), &down[i]));
        left[i] = plus(&up[i + 1], &plus(&down[i], &down[i + 1]));
    }
}

#[inline(always)]
fn plus(a: &Cell, b: &Cell) -> Cell {
    cell!(K, L => a.0[K][L] + b.0[K][L])
}

#[inline(always)]
fn minus(a: &Cell, b: &Cell) -> Cell {
    cell!(K, L => a.0[K][L] - b.0[K][L])
}

#[inline(always)]
fn cross(a: &Cell, b: &Cell) -> Cell {
    cell!(K, L => {
        let (i, j) = ((K + 1) % 3, (K + 2) % 3);
        a.0[i][L] * b.0[j][L] - a.0[j][L] * b.0[i][L]
    })
}

/// Unit vectors.
#[inline(always)]
fn unit(v: &Cell) -> Cell {
    let [x, y, z] = &v.0;
    let squares = lanes!(L => x[L] * x[L] + y[L] * y[L] + z[L] * z[L]);
    let mut plain = true;
    for s in squares {
        plain &= s > 1e-30 && s < 1e30;
    }
    if !plain {
        return odd_unit(v);
    }
    let inverse = lanes!(L => 1.0 / squares[L].sqrt());
    cell!(K, L => v.0[K][L] * inverse[L])
}

/// Unit vectors where some squares leave what numbers can hold: another way there, and only there, for lanes do not meet.
#[cold]
fn odd_unit(v: &Cell) -> Cell {
    let mut out = *v;
    for l in 0..LANES {
        let [x, y, z] = v.point(l);
        let square = x * x + y * y + z * z;
        let plain = square > 1e-30 && square < 1e30;
        let inverse = 1.0 / square.sqrt();
        let unit = if plain { [x * inverse, y * inverse, z * inverse] } else { crate::refined::unit([x, y, z]) };
        out.set(l, unit);
    }
    out
}
