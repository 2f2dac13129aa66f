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
    fn turn(self, cells: [&Cell; LANES]) -> [Eight; LANES];
}

/// One by one, or as the web can.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Turn for Plain {
    #[inline(always)]
    fn turn(self, cells: [&Cell; LANES]) -> [Eight; LANES] {
        let mut out = [[0.0; 3 * LANES]; LANES];
        for (i, cell) in cells.iter().enumerate() {
            for (k, values) in cell.0.iter().enumerate() {
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
        fn turn(self, cells: [&Cell; LANES]) -> [Eight; LANES] {
            // SAFETY: a `Wide` is made by `new` alone, which looks whether the processor has what this is compiled for.
            unsafe { turn(cells) }
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn turn(cells: [&Cell; LANES]) -> [Eight; LANES] {
        let row = |r: usize| -> __m256 { bytemuck::cast(cells[r / 3].0[r % 3]) };
        let mut out = [[[0.0f32; LANES]; 3]; LANES];
        for third in 0..3 {
            let r = |i: usize| row(third * LANES + i);
            let low = |i: usize| _mm256_unpacklo_ps(r(i), r(i + 1));
            let high = |i: usize| _mm256_unpackhi_ps(r(i), r(i + 1));
            let a = [low(0), high(0), low(2), high(2), low(4), high(4), low(6), high(6)];
            let front = |i: usize| _mm256_shuffle_ps::<0x44>(a[i], a[i + 2]);
            let back = |i: usize| _mm256_shuffle_ps::<0xee>(a[i], a[i + 2]);
            let b = [front(0), back(0), front(1), back(1), front(4), back(4), front(5), back(5)];
            for i in 0..4 {
                out[i][third] = bytemuck::cast(_mm256_permute2f128_ps::<0x20>(b[i], b[i + 4]));
                out[i + 4][third] = bytemuck::cast(_mm256_permute2f128_ps::<0x31>(b[i], b[i + 4]));
            }
        }
        bytemuck::cast(out)
    }
}
