// The contact shadow: the model seen from below becomes a small map of how near it is to the ground (red: touching,
// green: near), which is blurred, red a little and green a lot.

struct Shadow {
    to_map: mat4x4<f32>, // world to the map's clip space; z is the height over the ground in map half sides
    step: vec4<f32>,     // blur: one texel along the direction; z, w: widths of red and green in texels
};

@group(0) @binding(0) var<uniform> s: Shadow;
@group(1) @binding(0) var source: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

struct Cast {
    @builtin(position) position: vec4<f32>,
    @location(0) height: f32,
};

@vertex
fn vs_cast(@location(0) position: vec3<f32>) -> Cast {
    let p = s.to_map * vec4(position, 1.0);
    var out: Cast;
    out.height = p.z;
    out.position = vec4(p.xy, 0.5, 1.0);
    return out;
}

@fragment
fn fs_cast(in: Cast) -> @location(0) vec4<f32> {
    let h = max(in.height, 0.0);
    return vec4(exp2(-h * 14.0), exp2(-h * 2.6), 0.0, 1.0);
}

struct Place {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
};

@vertex
fn vs_blur(@builtin(vertex_index) index: u32) -> Place {
    let c = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0;
    var out: Place;
    out.position = vec4(c * 2.0 - 1.0, 0.0, 1.0);
    out.uv = vec2(c.x, 1.0 - c.y);
    return out;
}

@fragment
fn fs_blur(in: Place) -> @location(0) vec4<f32> {
    var sum = vec2(0.0);
    var weight = vec2(0.0);
    for (var i = -24; i <= 24; i++) {
        let x = f32(i) / s.step.zw;
        let w = exp2(-x * x);
        sum += w * textureSampleLevel(source, bilinear, in.uv + s.step.xy * f32(i), 0.0).rg;
        weight += w;
    }
    return vec4(sum / weight, 0.0, 1.0);
}
