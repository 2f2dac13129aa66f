// The last pass: the resolved picture over its background, encoded to sRGB bytes with a little ordered noise, which
// breaks the bands of gradients and never moves a plain colour (it stays below half a step).

@group(1) @binding(0) var resolved: texture_2d<f32>;

@vertex
fn vs_final(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the screen.
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn encode(c: vec3<f32>) -> vec3<f32> {
    let x = clamp(c, vec3(0.0), vec3(1.0));
    return select(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, x * 12.92, x <= vec3(0.0031308));
}

@fragment
fn fs_final(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let c = textureLoad(resolved, pixel, 0);
    // Interleaved gradient noise (Jimenez 2014).
    let noise = fract(52.9829189 * fract(dot(floor(position.xy), vec2(0.06711056, 0.00583715)))) - 0.5;
    let dither = noise * (0.8 / 255.0);
    if is_on(TRANSPARENT) {
        let straight = encode(c.rgb / max(c.a, 1e-4));
        if is_on(STRAIGHT) {
            return vec4(straight + dither, c.a);
        }
        return vec4(straight * c.a, c.a);
    }
    let t = position.y * g.viewport.w;
    // The gradient runs between encoded colours, as in a style sheet.
    let behind = mix(g.top.rgb, g.bottom.rgb, t);
    if c.a <= 0.0 {
        return vec4(behind + dither, 1.0);
    }
    let linear = pow(max((behind + 0.055) / 1.055, vec3(0.0)), vec3(2.4));
    let low = behind / 12.92;
    let under = select(linear, low, behind <= vec3(0.04045));
    return vec4(encode(c.rgb + under * (1.0 - c.a)) + dither, 1.0);
}
