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

use super::grid::{Cell, LANES};

/// A value of each of eight patches, or eight of one.
pub(super) type Eight = [u32; LANES];

/// A way to tell patches apart.
pub(super) trait Turn: Copy {
    /// Column i of a square as its row i.
    fn square(self, rows: &[Eight; LANES]) -> [Eight; LANES];

    /// The points at eight places, patch by patch: coordinates, three rows of eight.
    #[inline(always)]
    fn points(self, cells: &[Cell], places: &[u16; LANES]) -> [[Eight; 3]; LANES] {
        let mut rows = [[0; LANES]; 3 * LANES];
        for (rows, &place) in rows.as_chunks_mut::<3>().0.iter_mut().zip(places) {
            *rows = bytemuck::cast(cells[usize::from(place)].0);
        }
        let mut out = [[[0; LANES]; 3]; LANES];
        for (third, rows) in rows.as_chunks::<LANES>().0.iter().enumerate() {
            let turned = self.square(rows);
            for (out, turned) in out.iter_mut().zip(turned) {
                out[third] = turned;
            }
        }
        out
    }

    /// The ids at eight places, patch by patch.
    #[inline(always)]
    fn ids(self, ids: &[Eight], places: &[u16; LANES]) -> [Eight; LANES] {
        let mut rows = [[0; LANES]; LANES];
        for (row, &place) in rows.iter_mut().zip(places) {
            *row = ids[usize::from(place)];
        }
        self.square(&rows)
    }
}

/// One by one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Turn for Plain {
    #[inline(always)]
    fn square(self, rows: &[Eight; LANES]) -> [Eight; LANES] {
        let mut out = [[0; LANES]; LANES];
        for (i, out) in out.iter_mut().enumerate() {
            for (x, row) in out.iter_mut().zip(rows) {
                *x = row[i];
            }
        }
        out
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use wide::Wide;

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::{Eight, LANES, Turn};
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
        fn square(self, rows: &[Eight; LANES]) -> [Eight; LANES] {
            // SAFETY: a `Wide` is made by `new` alone, which looks whether the processor has what this is compiled for.
            unsafe { square(rows) }
        }
    }

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
}
