//! Eight patches, told apart: from one patch a lane to one patch after the other.
//!
//! ```text
//!   cells of 8 places    x x x x x x x x          patch 0   x y z x y z ..   of the 8 places
//!                        y y y y y y y y   ──>    patch 1   x y z x y z ..
//!                        z z z z z z z z ..       ..
//! ```
//!
//! That is a 24x8 matrix turned round (of vertex ids 8x8), square by square, by exchanges of halves, quarters and neighbours.
//! Nothing is computed, so all ways give the same bits: in vectors of eight where the processor has them, and one by one
//! elsewhere. Compilers do not find this themselves.
//!
//! Cost: about a shuffle a point; one by one three loads and three stores.

use super::Point;
use super::grid::{Cell, LANES};

/// A value of each of eight patches, or eight of one.
pub(super) type Eight = [u32; LANES];

/// What a run of ids is filled with.
pub(super) struct Run<'a> {
    /// The places that it takes from every patch, and how many of these count: at least eight are there.
    pub places: &'a [u16],
    pub per: usize,
    /// The patches, a lane each, and the first that the part of a buffer has room for.
    pub patches: &'a [u32],
    pub first: u32,
}

/// A way to tell patches apart.
pub(super) trait Turn: Copy {
    /// Writes the points that a run takes from patches.
    fn points(self, run: &Run<'_>, cells: &[Cell], out: &mut [Point]);

    /// Writes the ids that a run takes from patches.
    fn ids(self, run: &Run<'_>, ids: &[Eight], out: &mut [u32]);

    /// Says that `count` values from `at` on will be written soon.
    #[inline(always)]
    fn expect<T>(self, _out: &[T], _at: usize, _count: usize) {}
}

/// One by one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Turn for Plain {
    #[inline(always)]
    fn points(self, run: &Run<'_>, cells: &[Cell], out: &mut [Point]) {
        for (lane, &q) in run.patches.iter().enumerate() {
            let out = &mut out[(q - run.first) as usize * run.per..][..run.per];
            for (out, &place) in out.iter_mut().zip(run.places) {
                *out = cells[usize::from(place)].point(lane);
            }
        }
    }

    #[inline(always)]
    fn ids(self, run: &Run<'_>, ids: &[Eight], out: &mut [u32]) {
        for (lane, &q) in run.patches.iter().enumerate() {
            let out = &mut out[(q - run.first) as usize * run.per..][..run.per];
            for (out, &place) in out.iter_mut().zip(run.places) {
                *out = ids[usize::from(place)][lane];
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use wide::Wide;

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::{Cell, Eight, LANES, Point, Run, Turn};
    use std::arch::x86_64::*;

    /// Says that the processor has vectors of eight (AVX2).
    #[derive(Clone, Copy, Debug)]
    pub(in super::super) struct Wide(());

    impl Wide {
        /// If it has.
        pub(in super::super) fn new() -> Option<Wide> {
            std::is_x86_feature_detected!("avx2").then_some(Wide(()))
        }
    }

    impl Turn for Wide {
        #[inline(always)]
        fn points(self, run: &Run<'_>, cells: &[Cell], out: &mut [Point]) {
            // SAFETY: a `Wide` is made by `new` alone, which looks whether the processor has what this is compiled for.
            unsafe { points(run, cells, out) }
        }

        #[inline(always)]
        fn ids(self, run: &Run<'_>, ids: &[Eight], out: &mut [u32]) {
            // SAFETY: as above.
            unsafe { turned_ids(run, ids, out) }
        }

        #[inline(always)]
        fn expect<T>(self, out: &[T], at: usize, count: usize) {
            for line in out[at..at + count].chunks(LINE / size_of::<T>()) {
                // SAFETY: nothing is read; every processor of this kind has the instruction.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) };
            }
        }
    }

    /// Bytes that a processor fetches at once.
    const LINE: usize = 64;

    #[target_feature(enable = "avx2")]
    fn points(run: &Run<'_>, cells: &[Cell], out: &mut [Point]) {
        for (from, places) in eights(run) {
            let mut rows = [[0; LANES]; 3 * LANES];
            for (rows, &place) in rows.as_chunks_mut::<3>().0.iter_mut().zip(places) {
                *rows = bytemuck::cast(cells[usize::from(place)].0);
            }
            let mut turned = [[[0; LANES]; 3]; LANES];
            for (third, rows) in rows.as_chunks::<LANES>().0.iter().enumerate() {
                for (turned, row) in turned.iter_mut().zip(square(rows)) {
                    turned[third] = row;
                }
            }
            for (points, &q) in turned.iter().zip(run.patches) {
                let points: &[Point; LANES] = bytemuck::cast_ref(points);
                put(points, out, (q - run.first) as usize * run.per + from, run.per);
            }
        }
    }

    #[target_feature(enable = "avx2")]
    fn turned_ids(run: &Run<'_>, ids: &[Eight], out: &mut [u32]) {
        for (from, places) in eights(run) {
            let mut rows = [[0; LANES]; LANES];
            for (row, &place) in rows.iter_mut().zip(places) {
                *row = ids[usize::from(place)];
            }
            for (row, &q) in square(&rows).iter().zip(run.patches) {
                put(row, out, (q - run.first) as usize * run.per + from, run.per);
            }
        }
    }

    /// Column i of a square as its row i.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn square(rows: &[Eight; LANES]) -> [Eight; LANES] {
        let r: [__m256i; LANES] = bytemuck::cast(*rows);
        let mut pairs = r;
        for i in [0, 2, 4, 6] {
            pairs[i] = _mm256_unpacklo_epi32(r[i], r[i + 1]);
            pairs[i + 1] = _mm256_unpackhi_epi32(r[i], r[i + 1]);
        }
        // Of columns 0 to 3 in the lower halves, of 4 to 7 in the upper ones.
        let mut fours = pairs;
        for i in [0, 4] {
            fours[i] = _mm256_unpacklo_epi64(pairs[i], pairs[i + 2]);
            fours[i + 1] = _mm256_unpackhi_epi64(pairs[i], pairs[i + 2]);
            fours[i + 2] = _mm256_unpacklo_epi64(pairs[i + 1], pairs[i + 3]);
            fours[i + 3] = _mm256_unpackhi_epi64(pairs[i + 1], pairs[i + 3]);
        }
        let mut out = r;
        for i in 0..4 {
            out[i] = _mm256_permute2x128_si256::<0x20>(fours[i], fours[i + 4]);
            out[i + 4] = _mm256_permute2x128_si256::<0x31>(fours[i], fours[i + 4]);
        }
        bytemuck::cast(out)
    }

    /// The places of a run, eight by eight, and where in the run these begin: the last eight may have been in
    /// the eight before.
    #[inline(always)]
    fn eights<'a>(run: &Run<'a>) -> impl Iterator<Item = (usize, &'a [u16; LANES])> {
        let (places, per) = (run.places, run.per);
        let last = per.saturating_sub(LANES);
        (0..per).step_by(LANES).filter_map(move |from| {
            let from = from.min(last);
            Some((from, places[from..].first_chunk()?))
        })
    }

    /// Copies eight, or as many as a run has if these are fewer.
    #[inline(always)]
    fn put<T: Copy>(eight: &[T; LANES], out: &mut [T], at: usize, per: usize) {
        if per >= LANES {
            // One length that is known is a few moves, and not a call.
            out[at..at + LANES].copy_from_slice(eight);
            return;
        }
        let (four, rest) = out[at..at + per].split_at_mut(per & 4);
        let (two, one) = rest.split_at_mut(per & 2);
        if let (Some(four), Some(from)) = (four.first_chunk_mut::<4>(), eight.first_chunk()) {
            *four = *from;
        }
        if let (Some(two), Some(from)) = (two.first_chunk_mut::<2>(), eight[per & 4..].first_chunk()) {
            *two = *from;
        }
        if let Some(one) = one.first_mut() {
            *one = eight[per & 6];
        }
    }
}
