// The ground's quad: nothing but the shadow, black with the map's opacity, fading out towards the map's rim.

@group(1) @binding(0) var shadow: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

struct Place {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
};

@vertex
fn vs_ground(@builtin(vertex_index) index: u32) -> Place {
    let c = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    var out: Place;
    out.at = c;
    out.position = g.view_proj * vec4(g.ground.xyz + c.x * g.ground_x.xyz + c.y * g.ground_y.xyz, 1.0);
    return out;
}

@fragment
fn fs_ground(in: Place) -> @location(0) vec4<f32> {
    let m = textureSample(shadow, bilinear, vec2(0.5 + 0.5 * in.at.x, 0.5 - 0.5 * in.at.y)).rg;
    let rim = 1.0 - smoothstep(0.75, 1.0, length(in.at));
    return vec4(0.0, 0.0, 0.0, g.ground.w * rim * (0.45 * m.r + 0.55 * m.g));
}
