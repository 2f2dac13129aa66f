// Halves a texture: each texel is the bilinear sample in the middle of its four.

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;

struct Place {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
};

@vertex
fn vs_mip(@builtin(vertex_index) index: u32) -> Place {
    let c = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0;
    var out: Place;
    out.position = vec4(c * 2.0 - 1.0, 0.0, 1.0);
    out.uv = vec2(c.x, 1.0 - c.y);
    return out;
}

@fragment
fn fs_mip(in: Place) -> @location(0) vec4<f32> {
    return textureSampleLevel(source, bilinear, in.uv, 0.0);
}
