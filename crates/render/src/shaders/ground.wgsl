// The ground: nothing but the shadow, black with the map's opacity, fading out towards the map's rim. It reaches farther
// than the model, and near and far planes lie close around that: so it is a grid of cells whose vertices are clamped to
// the two planes, rather than one quad that they would cut.

@group(1) @binding(0) var shadow: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

struct Place {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
};

@vertex
fn vs_ground(@builtin(vertex_index) index: u32) -> Place {
    let k = index % 6u;
    let cell = index / 6u;
    let corner = vec2(u32(k == 1u || k == 2u || k == 4u), u32(k == 2u || k >= 4u));
    let c = vec2<f32>(vec2(cell % 24u, cell / 24u) + corner) / 12.0 - 1.0;
    var out: Place;
    out.at = c;
    out.position = g.view_proj * vec4(g.ground.xyz + c.x * g.ground_x.xyz + c.y * g.ground_y.xyz, 1.0);
    out.position.z = clamp(out.position.z, 0.0, max(out.position.w, 0.0));
    return out;
}

@fragment
fn fs_ground(in: Place) -> @location(0) vec4<f32> {
    let m = textureSample(shadow, bilinear, vec2(0.5 + 0.5 * in.at.x, 0.5 - 0.5 * in.at.y)).rg;
    let rim = 1.0 - smoothstep(0.75, 1.0, length(in.at));
    return vec4(0.0, 0.0, 0.0, g.ground.w * rim * (0.45 * m.r + 0.55 * m.g));
}
