// A linear colour as four bytes of sRGB, alpha as it is (see `pack.rs`).

fn srgb(linear: vec4<f32>) -> u32 {
    let c = clamp(linear, vec4(0.0), vec4(1.0));
    let curve = 1.055 * pow(c.rgb, vec3(1.0 / 2.4)) - 0.055;
    return pack4x8unorm(vec4(select(curve, c.rgb * 12.92, c.rgb <= vec3(0.0031308)), c.a));
}
