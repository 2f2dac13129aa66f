//! Small encodings: unit normals in four bytes, colours in four bytes.
//!
//! A normal is projected onto the octahedron |x|+|y|+|z| = 1, whose lower half is folded outwards so that the whole
//! sphere becomes the square [-1, 1]², and stored as two signed 16-bit fractions (Meyer et al. 2010, "On floating-point
//! normal vectors"; Cigolle et al. 2014). The largest error is about 0.004 degrees. Colours are stored in sRGB, because 8
//! linear bits would show bands in the dark.
//!
//! ```text
//!        +y            the four corners of the square are -z,
//!     -z  |  -z        its middle is +z
//!   -x -- +z -- +x
//!     -z  |  -z
//!        -y
//! ```

/// Packs a direction of any length above 0; zero and NaN become +z. Cost: about 4 ns, most of it the two divisions.
pub fn normal(n: [f32; 3]) -> [i16; 2] {
    normals(&[n])[0]
}

/// Packs several directions as [`normal`] does, one a lane of a vector where the machine has them: nothing branches.
#[inline(always)]
pub fn normals<const N: usize>(normals: &[[f32; 3]; N]) -> [[i16; 2]; N] {
    let along = |k: usize| -> [f32; N] { std::array::from_fn(|i| normals[i][k]) };
    let (xs, ys, zs) = (along(0), along(1), along(2));
    let mut out = [[0; N]; 2];
    for i in 0..N {
        let (x, y, z) = (xs[i], ys[i], zs[i]);
        let sum = x.abs() + y.abs() + z.abs();
        // Never beyond 1: no part is larger than the rounded sum.
        let (x, y) = (x / sum, y / sum);
        let folded = [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)];
        let [x, y] = if z < 0.0 { folded } else { [x, y] };
        let known = sum > 0.0 && sum < f32::INFINITY;
        out[0][i] = if known { snorm(x) } else { 0 };
        out[1][i] = if known { snorm(y) } else { 0 };
    }
    std::array::from_fn(|i| [out[0][i] as i16, out[1][i] as i16])
}

/// The nearest of 32767ths, halves away from zero. That is what `round` does, which is no machine instruction on the web: a
/// bit less than a half is added, as a half itself would lift the number below 0.5 to 1.
#[inline(always)]
fn snorm(v: f32) -> i32 {
    let v = v * 32767.0;
    (v + (0.5f32 - f32::EPSILON / 4.0).copysign(v)) as i32
}

/// The unit normal that [`normal`] packed; the shaders do the same.
pub fn unpack_normal(p: [i16; 2]) -> [f32; 3] {
    let snorm = |v: i16| (f32::from(v) / 32767.0).max(-1.0);
    let (mut x, mut y) = (snorm(p[0]), snorm(p[1]));
    let z = 1.0 - x.abs() - y.abs();
    let t = (-z).max(0.0);
    x -= t.copysign(x);
    y -= t.copysign(y);
    let len = (x * x + y * y + z * z).sqrt();
    [x / len, y / len, z / len]
}

/// One channel from linear light to sRGB, both 0..=1.
pub fn encode(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// One channel from sRGB to linear light, both 0..=1.
pub fn decode(srgb: f32) -> f32 {
    let c = srgb.clamp(0.0, 1.0);
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Linear RGBA to four sRGB bytes (alpha stays linear).
pub fn color(linear: [f32; 4]) -> [u8; 4] {
    let byte = |v: f32| (v * 255.0).round() as u8;
    [byte(encode(linear[0])), byte(encode(linear[1])), byte(encode(linear[2])), byte(linear[3].clamp(0.0, 1.0))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_survive_packing() {
        let mut worst = 1.0f32;
        for i in 0..2000 {
            let z = (i as f32 + 0.5) / 1000.0 - 1.0;
            let a = i as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let n = [r * a.cos(), r * a.sin(), z];
            let m = unpack_normal(normal(n));
            worst = worst.min(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
        }
        assert!(worst > 1.0 - 1e-6, "{worst}");
        for axis in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
            assert_eq!(unpack_normal(normal(axis)), axis);
        }
        assert_eq!(unpack_normal(normal([0.0; 3])), [0.0, 0.0, 1.0]);
        assert_eq!(unpack_normal(normal([f32::NAN, 0.0, 1.0])), [0.0, 0.0, 1.0]);
    }

    /// The definition, step by step.
    fn defined(n: [f32; 3]) -> [i16; 2] {
        let sum = n[0].abs() + n[1].abs() + n[2].abs();
        if !(sum > 0.0 && sum.is_finite()) {
            return [0, 0];
        }
        let (mut x, mut y) = (n[0] / sum, n[1] / sum);
        if n[2] < 0.0 {
            let (ox, oy) = (x, y);
            x = (1.0 - oy.abs()) * 1.0f32.copysign(ox);
            y = (1.0 - ox.abs()) * 1.0f32.copysign(oy);
        }
        let snorm = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16;
        [snorm(x), snorm(y)]
    }

    #[test]
    fn packing_keeps_to_its_definition() {
        // Every half between two steps, and the numbers around it, where rounding turns.
        for half in 0..32767 {
            let middle = (half as f32 + 0.5) / 32767.0;
            for bits in middle.to_bits() - 3..=middle.to_bits() + 3 {
                for v in [f32::from_bits(bits), -f32::from_bits(bits)] {
                    assert_eq!(snorm(v), (v * 32767.0).round() as i32, "{v}");
                }
            }
        }
        for bits in [0.0f32, 0.5 / 32767.0, 1.0].map(f32::to_bits) {
            for bits in bits.saturating_sub(4)..=bits {
                let v = f32::from_bits(bits);
                assert_eq!([snorm(v), snorm(-v)], [(v * 32767.0).round() as i32, (-v * 32767.0).round() as i32]);
            }
        }
        // Directions of all lengths, and what is none.
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state
        };
        for _ in 0..200_000 {
            let any = [(); 3].map(|()| f32::from_bits(next()));
            let near = [(); 3].map(|()| (next() >> 8) as f32 / 8_388_608.0 - 1.0);
            let four = [any, near, [near[0], 0.0, -0.0], [near[0], near[1], f32::from_bits(next() & 0x807f_ffff)]];
            assert_eq!(normals(&four), four.map(defined), "{four:?}");
            assert_eq!(four.map(normal), four.map(defined), "{four:?}");
        }
    }

    #[test]
    fn srgb_is_its_own_inverse_and_hits_known_values() {
        assert!((decode(0.5) - 0.214_041).abs() < 1e-5);
        assert!((encode(0.18) - 0.461_356).abs() < 1e-5);
        for i in 0..=255u32 {
            let s = i as f32 / 255.0;
            assert_eq!((encode(decode(s)) * 255.0).round() as u32, i);
        }
        assert_eq!(color([1.0, 0.0, 0.215_861, 0.5]), [255, 0, 128, 128]);
    }
}
