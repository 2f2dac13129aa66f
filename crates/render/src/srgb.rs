//! Colours as they are drawn: shared with `limn-compute`, whose rows bring along what corners carry.

/// One channel from linear light to sRGB, both 0..=1.
pub fn encode(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// Linear RGBA to four sRGB bytes (alpha stays linear).
pub fn color(linear: [f32; 4]) -> [u8; 4] {
    let byte = |v: f32| (v * 255.0).round() as u8;
    [byte(encode(linear[0])), byte(encode(linear[1])), byte(encode(linear[2])), byte(linear[3].clamp(0.0, 1.0))]
}
