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

/// Packs a direction of any length above 0; zero and NaN become +z.
pub fn normal(n: [f32; 3]) -> [i16; 2] {
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
