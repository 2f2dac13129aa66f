//! Points of eight patches, told apart: from one patch a lane to one patch after the other.
//!
//! ```text
//!   cells of 8 places    x x x x x x x x          patch 0   x y z x y z ..   of the 8 places
//!                        y y y y y y y y   ──>    patch 1   x y z x y z ..
//!                        z z z z z z z z ..       ..
//! ```
//!
//! That is a 24x8 matrix turned round, as three of 8x8, each by exchanges of halves, quarters and neighbours. Nothing is
//! computed, so all ways give the same bits: in vectors of eight where the processor has them, of four on the web, and one by
//! one elsewhere. Compilers do not find this themselves.
//!
//! Cost: about a shuffle a point; one by one three loads and three stores.

use super::grid::{Cell, LANES};

/// Eight points, coordinate by coordinate.
pub(super) type Eight = [f32; 3 * LANES];

/// A way to tell patches apart.
pub(super) trait Turn: Copy {
    /// The points at eight places, patch by patch.
    fn turn(self, cells: &[Cell], places: &[u16; LANES]) -> [Eight; LANES];
}

/// One by one, or as the web can.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Turn for Plain {
    #[inline(always)]
    fn turn(self, cells: &[Cell], places: &[u16; LANES]) -> [Eight; LANES] {
        let mut out = [[0.0; 3 * LANES]; LANES];
        for (i, &place) in places.iter().enumerate() {
            for (k, values) in cells[usize::from(place)].0.iter().enumerate() {
                for (out, value) in out.iter_mut().zip(values) {
                    out[3 * i + k] = *value;
                }
            }
        }
        out
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use wide::Wide;

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::{Cell, Eight, LANES, Turn};
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
        fn turn(self, cells: &[Cell], places: &[u16; LANES]) -> [Eight; LANES] {
            // SAFETY: a `Wide` is made by `new` alone, which looks whether the processor has what this is compiled for.
            unsafe { turn(cells, places) }
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn turn(cells: &[Cell], places: &[u16; LANES]) -> [Eight; LANES] {
        let mut rows = [_mm256_setzero_ps(); 3 * LANES];
        for (row, &place) in rows.as_chunks_mut::<3>().0.iter_mut().zip(places) {
            let cell = &cells[usize::from(place)].0;
            *row = [bytemuck::cast(cell[0]), bytemuck::cast(cell[1]), bytemuck::cast(cell[2])];
        }
        let mut out = [[[0.0f32; LANES]; 3]; LANES];
        for (third, r) in rows.as_chunks::<LANES>().0.iter().enumerate() {
            let mut pairs = *r;
            for i in [0, 2, 4, 6] {
                pairs[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
                pairs[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
            }
            // Four patches' four points: of patches 0 to 3 in the lower halves, of 4 to 7 in the upper ones.
            let mut fours = pairs;
            for i in [0, 4] {
                fours[i] = _mm256_shuffle_ps::<0x44>(pairs[i], pairs[i + 2]);
                fours[i + 1] = _mm256_shuffle_ps::<0xee>(pairs[i], pairs[i + 2]);
                fours[i + 2] = _mm256_shuffle_ps::<0x44>(pairs[i + 1], pairs[i + 3]);
                fours[i + 3] = _mm256_shuffle_ps::<0xee>(pairs[i + 1], pairs[i + 3]);
            }
            for i in 0..4 {
                out[i][third] = bytemuck::cast(_mm256_permute2f128_ps::<0x20>(fours[i], fours[i + 4]));
                out[i + 4][third] = bytemuck::cast(_mm256_permute2f128_ps::<0x31>(fours[i], fours[i + 4]));
            }
        }
        bytemuck::cast(out)
    }
}
