//! Eight patches, told apart: from one patch a lane to one patch after the other.
//!
//! ```text
//!   cells of 8 places    x x x x x x x x          patch 0   x y z x y z ..   of the 8 places
//!                        y y y y y y y y   ──>    patch 1   x y z x y z ..
//!                        z z z z z z z z ..       ..
//! ```
//!
//! That is a 24x8 matrix turned round (of vertex ids 8x8), square by square, by exchanges of halves, quarters and neighbours.
//! Nothing is computed, so all ways give the same bits: in vectors of eight where the processor has them, of four on the web, and
//! one by one elsewhere. Compilers do not find this themselves.
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

    /// Fetches where `count` values from `at` on will be written soon. Without an instruction for that by reading: reads wait for memory
    /// side by side, stores one after the other.
    #[inline(always)]
    fn expect<T: bytemuck::Pod>(self, out: &[T], at: usize, count: usize) {
        let words: &[u32] = bytemuck::cast_slice(&out[at..at + count]);
        for line in words.chunks(LINE / size_of::<u32>()) {
            std::hint::black_box(line[0]);
        }
    }
}

/// Bytes that a processor fetches at once.
const LINE: usize = 64;

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
    use super::{Cell, Eight, LANES, LINE, Point, Run, Turn};
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
        fn expect<T: bytemuck::Pod>(self, out: &[T], at: usize, count: usize) {
            for line in out[at..at + count].chunks(LINE / size_of::<T>()) {
                // SAFETY: nothing is read; every processor of this kind has the instruction.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) };
            }
        }
    }

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

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(super) use fours::Fours;

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod fours {
    use super::{Cell, Eight, Plain, Point, Run, Turn};
    use std::arch::wasm32::*;

    /// In vectors of four, which is what the web has. Values go from one place to another without an array between, which would
    /// be a call.
    #[derive(Clone, Copy, Debug)]
    pub(in super::super) struct Fours;

    /// Values of a vector.
    const FOUR: usize = 4;

    impl Turn for Fours {
        #[inline(always)]
        fn points(self, run: &Run<'_>, cells: &[Cell], out: &mut [Point]) {
            if run.per < FOUR {
                return Plain.points(run, cells, out);
            }
            let out: &mut [u32] = bytemuck::cast_slice_mut(out);
            for (from, [a, b, c, d]) in fours(run) {
                let [a, b, c, d] =
                    [a, b, c, d].map(|place| bytemuck::cast_ref::<_, [Eight; 3]>(&cells[usize::from(place)].0));
                for (half, patches) in run.patches.chunks(FOUR).enumerate() {
                    let at = |row: &Eight| load(row, half);
                    let first = square([at(&a[0]), at(&a[1]), at(&a[2]), at(&b[0])]);
                    let second = square([at(&b[1]), at(&b[2]), at(&c[0]), at(&c[1])]);
                    let third = square([at(&c[2]), at(&d[0]), at(&d[1]), at(&d[2])]);
                    for lane in 0..FOUR {
                        let Some(&q) = patches.get(lane) else { break };
                        let begin = 3 * ((q - run.first) as usize * run.per + from);
                        let out = &mut out[begin..begin + 3 * FOUR];
                        store(first[lane], out, 0);
                        store(second[lane], out, 1);
                        store(third[lane], out, 2);
                    }
                }
            }
        }

        #[inline(always)]
        fn ids(self, run: &Run<'_>, ids: &[Eight], out: &mut [u32]) {
            if run.per < FOUR {
                return Plain.ids(run, ids, out);
            }
            for (from, places) in fours(run) {
                let [a, b, c, d] = places.map(|place| &ids[usize::from(place)]);
                for (half, patches) in run.patches.chunks(FOUR).enumerate() {
                    let turned = square([load(a, half), load(b, half), load(c, half), load(d, half)]);
                    for (four, &q) in turned.into_iter().zip(patches) {
                        let begin = (q - run.first) as usize * run.per + from;
                        store(four, &mut out[begin..begin + FOUR], 0);
                    }
                }
            }
        }
    }

    /// The places of a run, four by four, and where in the run these begin: the last four may have been in the four before.
    #[inline(always)]
    fn fours<'a>(run: &Run<'a>) -> impl Iterator<Item = (usize, [u16; FOUR])> + 'a {
        let (places, per) = (run.places, run.per);
        (0..per).step_by(FOUR).filter_map(move |from| {
            let from = from.min(per - FOUR);
            Some((from, *places[from..].first_chunk()?))
        })
    }

    /// The first or second half of eight.
    #[inline(always)]
    fn load(row: &Eight, half: usize) -> v128 {
        let four = &row[FOUR * half..FOUR * half + FOUR];
        // SAFETY: four values are there; any alignment will do.
        unsafe { v128_load(four.as_ptr().cast()) }
    }

    /// Writes four, so many vectors behind the begin of `out`.
    #[inline(always)]
    fn store(value: v128, out: &mut [u32], vectors: usize) {
        let four = &mut out[FOUR * vectors..FOUR * vectors + FOUR];
        // SAFETY: there is room for four values; any alignment will do.
        unsafe { v128_store(four.as_mut_ptr().cast(), value) };
    }

    /// Column i of a square as its row i.
    #[inline(always)]
    fn square([a, b, c, d]: [v128; FOUR]) -> [v128; FOUR] {
        let (low, high) = (u32x4_shuffle::<0, 4, 1, 5>(a, b), u32x4_shuffle::<2, 6, 3, 7>(a, b));
        let (low_of_two, high_of_two) = (u32x4_shuffle::<0, 4, 1, 5>(c, d), u32x4_shuffle::<2, 6, 3, 7>(c, d));
        [
            u64x2_shuffle::<0, 2>(low, low_of_two),
            u64x2_shuffle::<1, 3>(low, low_of_two),
            u64x2_shuffle::<0, 2>(high, high_of_two),
            u64x2_shuffle::<1, 3>(high, high_of_two),
        ]
    }
}
