// Lines and points as screen-space shapes, one instance each, four vertices in a strip. Positions are divided by w here
// (after the line is cut at the near plane), so that distances in pixels interpolate linearly on every backend.

struct Shape {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,      // pixels along and across, from the start of the line or the middle of the point
    @location(1) length: f32,        // of the line, in pixels
    @location(2) @interpolate(flat) half_width: f32,
};

// Clip position, pulled towards the viewer by some pixels' worth of depth while staying at its pixel.
fn nudged(position: vec3<f32>, pixels: f32) -> vec4<f32> {
    let rel = position - g.eye.xyz;
    let by = pixels * g.toward.w;
    if g.eye.w > 0.5 {
        return g.view_proj * vec4(rel * max(1.0 - by, 0.5), 1.0);
    }
    return g.view_proj * vec4(rel + g.toward.xyz * by, 1.0);
}

@vertex
fn vs_line(
    @builtin(vertex_index) index: u32,
    @location(0) a: vec3<f32>,
    @location(1) b: vec3<f32>,
    @location(2) mark: f32,
) -> Shape {
    let half_width = g.widths.z * (1.0 + mark);
    var p = nudged(a, 2.0 + half_width);
    var q = nudged(b, 2.0 + half_width);
    var out: Shape;
    // Behind the near plane altogether: a point outside of the clip volume.
    if p.z < 0.0 && q.z < 0.0 {
        out.position = vec4(0.0, 0.0, -1.0, 1.0);
        return out;
    }
    if p.z < 0.0 {
        p = mix(p, q, p.z / (p.z - q.z));
    }
    if q.z < 0.0 {
        q = mix(q, p, q.z / (q.z - p.z));
    }
    let s = p.xyz / p.w;
    let t = q.xyz / q.w;
    let to_pixels = 0.5 * g.viewport.xy;
    let d = (t.xy - s.xy) * to_pixels;
    let length = length(d);
    let along = select(vec2(1.0, 0.0), d / max(length, 1e-6), length > 1e-6);
    let reach = half_width + 1.0;
    let end = f32(index & 1u);
    let side = f32(index >> 1u) * 2.0 - 1.0;
    let shift = along * ((2.0 * end - 1.0) * reach) + vec2(-along.y, along.x) * (side * reach);
    let here = mix(s, t, end);
    out.position = vec4(here.xy + shift / to_pixels, clamp(here.z, 0.0, 1.0), 1.0);
    out.at = vec2(length * end + (2.0 * end - 1.0) * reach, side * reach);
    out.length = length;
    out.half_width = half_width;
    return out;
}

fn line_cover(in: Shape) -> f32 {
    let beyond = in.at.x - clamp(in.at.x, 0.0, in.length);
    let distance = length(vec2(beyond, in.at.y));
    return 1.0 - smoothstep(in.half_width - 0.5, in.half_width + 0.5, distance);
}

// What is marked is wider, and has red and blue swapped.
fn line_color(in: Shape) -> vec4<f32> {
    return vec4(select(g.cage.rgb, g.cage.bgr, in.half_width > g.widths.z), 1.0) * (g.cage.a * line_cover(in));
}

@fragment
fn fs_line(in: Shape) -> @location(0) vec4<f32> {
    return line_color(in);
}

@fragment
fn fs_line_hidden(in: Shape) -> @location(0) vec4<f32> {
    return line_color(in) * g.hidden.x;
}

@vertex
fn vs_point(@builtin(vertex_index) index: u32, @location(0) center: vec3<f32>) -> Shape {
    let radius = g.widths.w;
    let p = nudged(center, 2.0 + radius);
    var out: Shape;
    if p.z < 0.0 {
        out.position = vec4(0.0, 0.0, -1.0, 1.0);
        return out;
    }
    let c = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    out.at = c * (radius + 1.0);
    out.position = vec4(p.xy / p.w + out.at * 2.0 * g.viewport.zw, p.z / p.w, 1.0);
    return out;
}

@fragment
fn fs_point(in: Shape) -> @location(0) vec4<f32> {
    let radius = g.widths.w;
    let cover = 1.0 - smoothstep(radius - 0.5, radius + 0.5, length(in.at));
    if cover <= 0.0 {
        discard;
    }
    return vec4(g.point.rgb, 1.0) * (g.point.a * cover);
}
