// The surface in its two layouts, its light, and its edges.
//
// Edges are distances: each barycentric coordinate over the length of its screen gradient is the distance to the
// opposite edge in pixels. Lines fade where faces are only a few lines wide, so that dense meshes turn into the surface
// and not into ink.

struct Material {
    base: vec4<f32>,
    has: vec4<u32>, // x: not the default material, y: has a texture
};

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var base_sampler: sampler;

struct Surface {
    @invariant @builtin(position) position: vec4<f32>,
    @location(0) rel: vec3<f32>,                     // from the eye
    // At the centroid: extrapolated to the middle of a pixel that the face only grazes, it would turn away.
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) bary: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) color: vec3<f32>,
    @location(5) @interpolate(flat, either) flags: u32, // edges, kind, and bit 8: `face` holds the polygon's normal
    @location(6) face: vec3<f32>,
};

fn unpack_normal(p: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - abs(p.x) - abs(p.y);
    let t = max(-z, 0.0);
    return normalize(vec3(p.x - select(-t, t, p.x >= 0.0), p.y - select(-t, t, p.y >= 0.0), z));
}

fn decode(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

fn place(position: vec3<f32>) -> Surface {
    var out: Surface;
    out.rel = position - g.eye.xyz;
    out.position = g.view_proj * vec4(out.rel, 1.0);
    out.color = vec3(1.0);
    return out;
}

// Shared quads: the vertex's range tells its barycentric.
fn shared_quad(position: vec3<f32>, normal: vec2<f32>, index: u32) -> Surface {
    var out = place(position);
    out.normal = unpack_normal(normal);
    if index < g.bits.y {
        out.bary = vec3(1.0, 0.0, 0.0);
    } else if index < g.bits.z {
        out.bary = vec3(0.0, 0.0, 1.0);
    } else {
        out.bary = vec3(0.0, 1.0, 0.0);
    }
    out.flags = 0x25u; // opposite old: new edge; opposite edge point: diagonal; opposite face point: parent edge
    return out;
}

@vertex
fn vs_shared(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
) -> Surface {
    return shared_quad(position, normal, index);
}

@vertex
fn vs_shared_color(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
    @location(5) color: vec4<f32>,
) -> Surface {
    var out = shared_quad(position, normal, index);
    out.color = decode(color.rgb);
    return out;
}

fn corner(position: vec3<f32>, normal: vec2<f32>, face: vec2<f32>, flags: u32, index: u32) -> Surface {
    var out = place(position);
    out.normal = unpack_normal(normal);
    out.face = unpack_normal(face);
    let c = index % 3u;
    out.bary = vec3(f32(c == 0u), f32(c == 1u), f32(c == 2u));
    out.flags = flags | 256u;
    return out;
}

@vertex
fn vs_corner(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
    @location(2) face: vec2<f32>,
    @location(3) flags: u32,
) -> Surface {
    return corner(position, normal, face, flags, index);
}

@vertex
fn vs_corner_extra(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
    @location(2) face: vec2<f32>,
    @location(3) flags: u32,
    @location(4) uv: vec2<f32>,
    @location(5) color: vec4<f32>,
) -> Surface {
    var out = corner(position, normal, face, flags, index);
    out.uv = uv;
    out.color = decode(color.rgb);
    return out;
}

// Irradiance over pi in direction n.
fn irradiance(n: vec3<f32>) -> vec3<f32> {
    let e = g.sh[0].rgb
        + g.sh[1].rgb * n.y + g.sh[2].rgb * n.z + g.sh[3].rgb * n.x
        + g.sh[4].rgb * (n.x * n.y) + g.sh[5].rgb * (n.y * n.z) + g.sh[6].rgb * (3.0 * n.z * n.z - 1.0)
        + g.sh[7].rgb * (n.x * n.z) + g.sh[8].rgb * (n.x * n.x - n.y * n.y);
    return max(e, vec3(0.0));
}

// What a slightly rough mirror sees of one soft box in direction r.
fn soft_box(i: u32, r: vec3<f32>) -> vec3<f32> {
    let d = g.boxes[i];
    let across = g.boxes[i + 1u];
    let up = g.boxes[i + 2u];
    let light = g.boxes[i + 3u];
    let t = dot(r, d.xyz);
    let p = r / max(t, 0.05);
    let s = light.w; // softness
    let x = 1.0 - smoothstep(1.0 - s, 1.0 + s, abs(dot(p, across.xyz)));
    let y = 1.0 - smoothstep(1.0 - s, 1.0 + s, abs(dot(p, up.xyz)));
    return light.rgb * (x * y * smoothstep(0.05, 0.3, t));
}

// The Khronos PBR neutral tone mapper: colours below 0.8 stay what they are, highlights roll off without turning hue.
fn neutral(c: vec3<f32>) -> vec3<f32> {
    let x = min(c.r, min(c.g, c.b));
    let offset = select(0.04, x - 6.25 * x * x, x < 0.08);
    let color = c - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < 0.76 {
        return color;
    }
    let d = 0.24;
    let new_peak = 1.0 - d * d / (peak + d - 0.76);
    let k = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3(new_peak), k);
}

fn shade(n: vec3<f32>, v: vec3<f32>, base: vec3<f32>) -> vec3<f32> {
    let facing = clamp(dot(n, v), 0.0, 1.0);
    let r = reflect(-v, n);
    let fresnel = 0.04 + 0.30 * pow(1.0 - facing, 5.0);
    let diffuse = base * irradiance(n);
    let mirror = soft_box(0u, r) + soft_box(4u, r) + soft_box(8u, r) + 0.6 * irradiance(r);
    return neutral(diffuse + fresnel * mirror);
}

// Opacity of old and new edges at this pixel. `grad` is the pixel length of each barycentric's gradient.
fn edges(bary: vec3<f32>, grad: vec3<f32>, flags: u32) -> vec2<f32> {
    var cover = vec2(0.0);
    for (var c = 0u; c < 3u; c++) {
        let real = (flags & (1u << c)) != 0u;
        let old = (flags & (8u << c)) != 0u;
        let half_width = select(g.widths.y, g.widths.x, old);
        let slope = max(grad[c], 1e-20);
        let distance = max(bary[c], 0.0) / slope;
        let lines_apart = select(0.5, 1.0, old) / (slope * half_width); // face height in line widths, twice for old ones
        let a = (1.0 - smoothstep(half_width - 0.5, half_width + 0.5, distance)) * smoothstep(0.7, 3.5, lines_apart);
        if real && old {
            cover.x = max(cover.x, a);
        } else if real {
            cover.y = max(cover.y, a);
        }
    }
    return cover * vec2(g.edge_old.a, g.edge_new.a);
}

fn gradients(bary: vec3<f32>) -> vec3<f32> {
    let dx = dpdx(bary);
    let dy = dpdy(bary);
    return sqrt(dx * dx + dy * dy);
}

@fragment
fn fs_shaded(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    // Everything with derivatives comes first: control flow is uniform only here.
    let across = cross(dpdx(in.rel), dpdy(in.rel));
    let grad = gradients(in.bary);
    let texel = textureSample(base_texture, base_sampler, vec2(in.uv.x, 1.0 - in.uv.y)).rgb;

    let has_material = is_on(MATERIALS) && material.has.x != 0u;
    var base = select(g.base.rgb, material.base.rgb, has_material);
    if is_on(COLORS) {
        base = in.color * select(vec3(1.0), base, has_material);
    }
    if is_on(TEXTURES) && material.has.y != 0u {
        base = texel * base;
    }
    let kind = (in.flags >> 6u) & 3u;
    if is_on(KINDS) && kind > 0u {
        base = g.kinds[kind - 1u].rgb;
    }
    if !front && !is_on(TWO_SIDED) {
        base = g.back.rgb;
    }
    var color = base;
    if is_on(LIT) {
        let v = select(g.toward.xyz, normalize(-in.rel), g.eye.w > 0.5);
        var n = in.normal;
        if is_on(FLAT) {
            // The polygon's own normal, or that of the triangle, turned to the viewer.
            n = in.face;
            if (in.flags & 256u) == 0u {
                n = across * select(-1.0, 1.0, (dot(across, v) >= 0.0) == front);
            }
        }
        n = n * inverseSqrt(max(dot(n, n), 1e-30));
        n = select(-n, n, front);
        // A vertex normal that looks away from the viewer is bent back to the outline.
        let away = min(dot(n, v), 0.0);
        n = normalize(n - away * v);
        color = shade(n, v, base);
    }
    let e = edges(in.bary, grad, in.flags);
    color = mix(color, g.edge_new.rgb, e.y);
    color = mix(color, g.edge_old.rgb, e.x);
    return vec4(color, 1.0);
}

@fragment
fn fs_nothing() -> @location(0) vec4<f32> {
    return vec4(0.0);
}

fn wire(in: Surface, opacity: f32) -> vec4<f32> {
    let e = edges(in.bary, gradients(in.bary), in.flags) * opacity;
    let below = vec4(g.edge_new.rgb, 1.0) * e.y;
    return vec4(g.edge_old.rgb, 1.0) * e.x + below * (1.0 - e.x);
}

@fragment
fn fs_wire(in: Surface) -> @location(0) vec4<f32> {
    return wire(in, 1.0);
}

@fragment
fn fs_wire_hidden(in: Surface) -> @location(0) vec4<f32> {
    return wire(in, g.hidden.x);
}
