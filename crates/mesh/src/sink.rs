//! Where a scheme's weights go: the same statement computes points at full speed or is written down as sparse rows.
//!
//! A scheme states its rules once, to a [`Sink`]: pass by pass, and in each pass one [`Row`] of weights for every new point.
//! [`Eval`] multiplies and adds at once (f32 triples, monomorphised, nothing stored); [`Record`] hands every row to a
//! closure (colours, texture coordinates, f64, tests; later the GPU's tables and the reverse).
//!
//! ```text
//!   scheme.rules ──> sink.pass(first child, count, |origin, row| row.vertex(v, w) ...)
//!                       ├── Eval    sum += w * point
//!                       └── Record  [(Vertex v, w), (Child c, w) ...]
//! ```
//!
//! Both stop after a quota of rows and resume where they stopped ([`Cursor`]), which is what lets a long refinement yield.

/// One new point's weights. They add up to one.
pub trait Row {
    /// Adds `weight` times vertex `v` of the level being refined.
    fn vertex(&mut self, v: u32, weight: f64);
    /// Adds `weight` times the sum of two vertices: the same bits whichever comes first.
    fn pair(&mut self, a: u32, b: u32, weight: f64);
    /// Adds `weight` times child `c`, which an *earlier pass* gave.
    fn child(&mut self, c: u32, weight: f64);
    /// Multiplies everything added so far.
    fn scale(&mut self, factor: f64);
    /// Moves a point by `offset`, whatever the weights; what is no point (colours, texture coordinates) stays. The last
    /// thing that a rule says.
    fn constant(&mut self, offset: [f64; 3]);
    /// Lets `state` state the row, or go on with it, out of line: on a copy, so that a sum whose address nobody else has
    /// stays in registers.
    fn apart(&mut self, state: impl FnOnce(&mut Self))
    where
        Self: Sized,
    {
        state(self);
    }
}

/// Takes rows, pass by pass.
pub trait Sink {
    /// The rows it hands out.
    type Row<'r>: Row;
    /// States the rules of children `first .. first + count`: `rule(i, row)` fills the row of child `first + i`.
    fn pass(&mut self, first: u32, count: u32, rule: impl for<'r> Fn(u32, &mut Self::Row<'r>));
    /// A pass that states the rules of four children of every quad, from `first` on: of the corner k places on one has
    /// `weights[k]`. What `quad` gives are the corners of one of so many.
    #[inline(always)]
    fn quads(&mut self, first: u32, quads: u32, quad: impl Fn(u32) -> [u32; 4], weights: [f64; 4]) {
        self.pass(first, 4 * quads, |i, row| {
            let mut corners = quad(i / 4);
            corners.rotate_left((i % 4) as usize);
            corners.iter().zip(weights).for_each(|(&v, weight)| row.vertex(v, weight));
        });
    }
    /// Adds up the neighbours of every vertex in the child of its number, for a later pass to take from there: triangle by
    /// triangle, which reads memory in order, where turning around vertices waits for it at every step. False where rows have
    /// to say which neighbours. Only for vertices inside; what `triangle` gives are the corners of one of so many.
    #[inline(always)]
    fn rings(&mut self, _vertices: u32, _triangles: u32, _triangle: impl Fn(u32) -> [u32; 3]) -> bool {
        false
    }
}

/// Where a run over all passes stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    pass: u32,
    row: u32,
}

#[cfg(feature = "full")]
impl Cursor {
    /// Before a row of a pass.
    pub(crate) fn at(pass: u32, row: u32) -> Cursor {
        Cursor { pass, row }
    }
}

/// Decides which rows of which pass to run now.
#[derive(Debug)]
struct Slice<'a> {
    cursor: &'a mut Cursor,
    quota: &'a mut usize,
    seen: u32,
}

impl Slice<'_> {
    /// The rows to run of a pass of `count`, and moves the cursor past them.
    fn take(&mut self, count: u32) -> std::ops::Range<u32> {
        let pass = self.seen;
        self.seen += 1;
        if pass != self.cursor.pass {
            return 0..0;
        }
        let from = self.cursor.row;
        let to = from + (count - from).min((*self.quota).min(u32::MAX as usize) as u32);
        *self.quota -= (to - from) as usize;
        *self.cursor = if to == count { Cursor { pass: pass + 1, row: 0 } } else { Cursor { pass, row: to } };
        from..to
    }

    fn done(&self) -> bool {
        self.cursor.pass == self.seen
    }
}

/// Computes points as the rules are stated. Sums run in the order of the statement.
#[derive(Debug)]
pub struct Eval<'a> {
    old: &'a [[f32; 3]],
    new: &'a mut [[f32; 3]],
    slice: Slice<'a>,
}

impl<'a> Eval<'a> {
    /// Reads `old`, writes `new` (all children), runs at most `quota` rows from `cursor` on.
    pub fn new(old: &'a [[f32; 3]], new: &'a mut [[f32; 3]], cursor: &'a mut Cursor, quota: &'a mut usize) -> Self {
        Eval { old, new, slice: Slice { cursor, quota, seen: 0 } }
    }

    /// Whether every pass that was stated is complete.
    pub fn done(&self) -> bool {
        self.slice.done()
    }
}

/// A running sum.
#[derive(Debug)]
pub struct Sum<'r> {
    old: &'r [[f32; 3]],
    new: &'r [[f32; 3]],
    sum: [f32; 3],
}

impl Row for Sum<'_> {
    #[inline(always)]
    fn apart(&mut self, state: impl FnOnce(&mut Self)) {
        let mut copy = Sum { old: self.old, new: self.new, sum: self.sum };
        state(&mut copy);
        self.sum = copy.sum;
    }
    #[inline(always)]
    fn vertex(&mut self, v: u32, weight: f64) {
        let (p, w) = (self.old[v as usize], weight as f32);
        self.sum = [self.sum[0] + w * p[0], self.sum[1] + w * p[1], self.sum[2] + w * p[2]];
    }
    #[inline(always)]
    fn pair(&mut self, a: u32, b: u32, weight: f64) {
        let (p, q, w) = (self.old[a as usize], self.old[b as usize], weight as f32);
        for k in 0..3 {
            self.sum[k] += w * (p[k] + q[k]);
        }
    }
    #[inline(always)]
    fn child(&mut self, c: u32, weight: f64) {
        let (p, w) = (self.new[c as usize], weight as f32);
        self.sum = [self.sum[0] + w * p[0], self.sum[1] + w * p[1], self.sum[2] + w * p[2]];
    }
    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        self.sum = self.sum.map(|x| x * factor as f32);
    }
    #[inline(always)]
    fn constant(&mut self, offset: [f64; 3]) {
        for (sum, x) in self.sum.iter_mut().zip(offset) {
            *sum += x as f32;
        }
    }
}

impl Sink for Eval<'_> {
    type Row<'r> = Sum<'r>;
    #[inline(always)]
    fn pass(&mut self, first: u32, count: u32, rule: impl for<'r> Fn(u32, &mut Sum<'r>)) {
        for i in self.slice.take(count) {
            let mut row = Sum { old: self.old, new: self.new, sum: [0.0; 3] };
            rule(i, &mut row);
            let sum = row.sum;
            self.new[(first + i) as usize] = sum;
        }
    }
    /// The same sums, of points that are fetched once a quad.
    #[inline(always)]
    fn quads(&mut self, first: u32, quads: u32, quad: impl Fn(u32) -> [u32; 4], weights: [f64; 4]) {
        let [w0, w1, w2, w3] = weights.map(|weight| weight as f32);
        let one = |a: f32, b: f32, c: f32, d: f32| 0.0 + w0 * a + w1 * b + w2 * c + w3 * d;
        let sum = |a: [f32; 3], b: [f32; 3], c: [f32; 3], d: [f32; 3]| {
            [one(a[0], b[0], c[0], d[0]), one(a[1], b[1], c[1], d[1]), one(a[2], b[2], c[2], d[2])]
        };
        let quads = self.slice.take(quads);
        *self.slice.quota = self.slice.quota.saturating_sub(3 * quads.len());
        for i in quads {
            let [a, b, c, d] = quad(i);
            let (a, b) = (self.old[a as usize], self.old[b as usize]);
            let (c, d) = (self.old[c as usize], self.old[d as usize]);
            let child = (first + 4 * i) as usize;
            let new = [sum(a, b, c, d), sum(b, c, d, a), sum(c, d, a, b), sum(d, a, b, c)];
            self.new[child..child + 4].copy_from_slice(&new);
        }
    }
    #[inline(always)]
    fn rings(&mut self, vertices: u32, triangles: u32, triangle: impl Fn(u32) -> [u32; 3]) -> bool {
        let triangles = self.slice.take(triangles);
        if triangles.start == 0 && !triangles.is_empty() {
            self.new[..vertices as usize].fill([0.0; 3]);
        }
        for [a, b, c] in triangles.map(triangle) {
            for (v, neighbour) in [(a, b), (b, c), (c, a)] {
                let (sum, p) = (&mut self.new[v as usize], self.old[neighbour as usize]);
                *sum = [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]];
            }
        }
        true
    }
}

/// What a weight multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A vertex of the level being refined.
    Vertex(u32),
    /// A child of an earlier pass.
    Child(u32),
}

/// Is given a child, its weights, and what its point is moved by.
pub type TakeRow<'a> = dyn FnMut(u32, &[(Source, f64)], [f64; 3]) + 'a;

/// Hands every row to a closure as it is stated.
pub struct Record<'a> {
    take: &'a mut TakeRow<'a>,
    row: Entries,
    slice: Slice<'a>,
}

impl<'a> Record<'a> {
    /// Calls `take(child, weights, offset)` for at most `quota` rows from `cursor` on.
    pub fn new(take: &'a mut TakeRow<'a>, cursor: &'a mut Cursor, quota: &'a mut usize) -> Self {
        Record { take, row: Entries::default(), slice: Slice { cursor, quota, seen: 0 } }
    }

    /// Whether every pass that was stated is complete.
    pub fn done(&self) -> bool {
        self.slice.done()
    }
}

/// The weights of one row, written down.
#[derive(Clone, Debug, Default)]
pub struct Entries {
    weights: Vec<(Source, f64)>,
    offset: [f64; 3],
}

impl Entries {
    fn clear(&mut self) {
        self.weights.clear();
        self.offset = [0.0; 3];
    }
}

impl Row for Entries {
    fn vertex(&mut self, v: u32, weight: f64) {
        self.weights.push((Source::Vertex(v), weight));
    }
    fn pair(&mut self, a: u32, b: u32, weight: f64) {
        self.weights.extend([(Source::Vertex(a), weight), (Source::Vertex(b), weight)]);
    }
    fn child(&mut self, c: u32, weight: f64) {
        self.weights.push((Source::Child(c), weight));
    }
    fn scale(&mut self, factor: f64) {
        match factor {
            0.0 => self.weights.clear(),
            _ => self.weights.iter_mut().for_each(|(_, w)| *w *= factor),
        }
    }
    fn constant(&mut self, offset: [f64; 3]) {
        self.offset = offset;
    }
}

impl Sink for Record<'_> {
    type Row<'r> = Entries;
    fn pass(&mut self, first: u32, count: u32, rule: impl for<'r> Fn(u32, &mut Entries)) {
        for i in self.slice.take(count) {
            self.row.clear();
            rule(i, &mut self.row);
            (self.take)(first + i, &self.row.weights, self.row.offset);
        }
    }
}

/// What a row makes of values that `value` gives.
pub(crate) fn weigh<const N: usize>(row: &[(Source, f64)], value: impl Fn(Source) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for &(source, w) in row {
        let v = value(source);
        for k in 0..N {
            sum[k] += w * v[k];
        }
    }
    sum
}
