// The triangle split's points: linear (SCHEME 0), Loop (1), Butterfly (2) and modified Butterfly (3).
//
// One invocation a face for the points of the edges that it owns, then one a vertex; a gather, one dispatch a level. The rules
// are those of the kernel's `loop.rs`, `butterfly.rs` and `modified_butterfly.rs`, with their papers.
//
//        c                 edge points: Loop 3/8 a + 3/8 b + 1/8 c + 1/8 d
//       / \                Butterfly 1/2 a + 1/2 b + 2w (c + d) - w (the four wings beyond)
//      a - b               modified: beside vertices of other valences their own rings
//       \ /
//        d
//
// Constants before this file: SIDES = 3, BASE, CREASED, SCHEME. a: Butterfly's w. b: 1 for Warren's weights of Loop.

@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> new_points: array<vec4<f32>>;

fn beyond(h: u32) -> vec4<f32> {
    let t = twin(h);
    if is_boundary(t) {
        return old[origin(h)] + old[target_of(h)] - old[origin(prev(h))];
    }
    return old[origin(prev(t))];
}

fn eight_points(h: u32, w: f32) -> vec4<f32> {
    let t = twin(h);
    let wings = beyond(next(h)) + beyond(prev(h)) + beyond(next(t)) + beyond(prev(t));
    return 0.5 * (old[origin(h)] + old[origin(t)]) + 2.0 * w * (old[origin(prev(h))] + old[origin(prev(t))]) - w * wings;
}

// The four-point curve along the rim; at a corner it goes straight on.
fn four_points(h: u32, w: f32) -> vec4<f32> {
    let n = next(h);
    let a = old[origin(h)];
    let b = old[origin(n)];
    var before = 2.0 * a - b;
    if !stays(origin(h)) {
        before = old[origin(arriving(h))];
    }
    var after = 2.0 * b - a;
    if !stays(origin(n)) {
        after = old[target_of(start(origin(n)))];
    }
    return (0.5 + w) * (a + b) - w * (before + after);
}

// A vertex seen along one of its edges: where its turn starts, how many faces it has, and which spoke the edge is.
struct Ring {
    first: u32,
    faces: u32,
    place: u32,
    rim: bool,
};

fn ring(h: u32) -> Ring {
    var out = Ring(start(origin(h)), 0u, 0u, false);
    var spoke = out.first;
    loop {
        if spoke == h {
            out.place = out.faces;
        }
        out.faces += 1u;
        spoke = twin(prev(spoke));
        if is_boundary(spoke) {
            out.rim = true;
            break;
        }
        if spoke == out.first {
            break;
        }
    }
    return out;
}

fn regular(r: Ring) -> bool {
    return r.faces == select(6u, 3u, r.rim);
}

// The next of a row of angles: (cos, sin) turned by (cos, sin).
fn turned(a: vec2<f32>, by: vec2<f32>) -> vec2<f32> {
    return vec2(a.x * by.x - a.y * by.y, a.x * by.y + a.y * by.x);
}

// Zorin's crease rule at a boundary vertex.
fn rim_rule(r: Ring, v: u32) -> vec4<f32> {
    let k = f32(r.faces);
    let theta = angles[2u * r.faces];
    var mine = vec2(1.0, 0.0);
    for (var j = 0u; j < r.place; j++) {
        mine = turned(mine, theta);
    }
    let double = 2.0 * mine.x * mine.y;
    let cos2 = 2.0 * theta.x * theta.x - 1.0;
    let end = 0.25 * mine.x - 2.0 * theta.x * theta.y * double / (4.0 * k * (theta.x - cos2));
    var sum = (1.0 - theta.y * mine.y / (k * (1.0 - theta.x))) * old[v];
    var there = vec2(1.0, 0.0);
    var h = r.first;
    loop {
        let inner = (mine.y * there.y + double * there.x * there.y) / k;
        sum += select(inner, end, h == r.first) * old[target_of(h)];
        there = turned(there, theta);
        h = twin(prev(h));
        if is_boundary(h) || h == r.first {
            break;
        }
    }
    return sum - end * old[origin(arriving(r.first))];
}

fn ring_weight(n: u32, j: u32, there: vec2<f32>) -> f32 {
    switch n {
        case 2u: {
            return select(-0.125, 0.375, j == 0u);
        }
        case 3u: {
            return select(-1.0 / 12.0, 5.0 / 12.0, j == 0u);
        }
        case 4u: {
            return select(select(0.0, -0.125, j == 2u), 0.375, j == 0u);
        }
        default: {
            return (0.25 + there.x + 0.5 * (2.0 * there.x * there.x - 1.0)) / f32(n);
        }
    }
}

fn ring_rule(r: Ring, h: u32) -> vec4<f32> {
    let v = origin(h);
    if r.rim {
        return rim_rule(r, v);
    }
    var sum = 0.75 * old[v];
    let theta = angles[r.faces];
    var there = vec2(1.0, 0.0);
    var spoke = h;
    for (var j = 0u; j < r.faces; j++) {
        sum += ring_weight(r.faces, j, there) * old[target_of(spoke)];
        there = turned(there, theta);
        spoke = twin(prev(spoke));
    }
    return sum;
}

fn modified(h: u32) -> vec4<f32> {
    let a = ring(h);
    let b = ring(twin(h));
    let even = regular(a);
    if even && regular(b) {
        return eight_points(h, 0.0625);
    }
    if even {
        return ring_rule(b, twin(h));
    }
    if regular(b) {
        return ring_rule(a, h);
    }
    return 0.5 * (ring_rule(a, h) + ring_rule(b, twin(h)));
}

fn edge_point(h: u32) -> vec4<f32> {
    let ends = old[origin(h)] + old[target_of(h)];
    if SCHEME == 0u {
        return 0.5 * ends;
    }
    let t = twin(h);
    if SCHEME == 1u {
        let sharp = edge_share(h);
        if sharp == 1.0 {
            return 0.5 * ends;
        }
        return mix(0.375 * ends + 0.125 * (old[origin(prev(h))] + old[origin(prev(t))]), 0.5 * ends, sharp);
    }
    if SCHEME == 2u {
        if is_boundary(t) {
            return four_points(h, at.a);
        }
        return eight_points(h, at.a);
    }
    if is_boundary(t) {
        return four_points(h, 0.0625);
    }
    return modified(h);
}

fn loop_weight(n: u32) -> f32 {
    if n == 3u {
        return 0.1875;
    }
    if at.b == 1.0 {
        return 0.375 / f32(n);
    }
    let c = 0.375 + 0.25 * angles[n].x;
    return (0.625 - c * c) / f32(n);
}

fn smooth_point(v: u32) -> vec4<f32> {
    let from_h = start(v);
    var sum = vec4(0.0);
    var n = 0u;
    var h = from_h;
    loop {
        sum += old[target_of(h)];
        n += 1u;
        h = twin(prev(h));
        if is_boundary(h) || h == from_h {
            break;
        }
    }
    let beta = loop_weight(n);
    return beta * sum + (1.0 - f32(n) * beta) * old[v];
}

fn vertex_point(v: u32) -> vec4<f32> {
    if SCHEME != 1u {
        return old[v];
    }
    if CREASED {
        let p = parts(v);
        var sum = (p.share.z + 0.75 * p.share.y) * old[v] + 0.125 * p.share.y * (old[p.ends.x] + old[p.ends.y]);
        if p.share.x > 0.0 {
            sum += p.share.x * smooth_point(v);
        }
        return sum;
    }
    if stays(v) {
        return old[v];
    }
    let h = start(v);
    if is_boundary(twin(h)) {
        return 0.125 * (old[target_of(h)] + old[origin(arriving(h))]) + 0.75 * old[v];
    }
    return smooth_point(v);
}

@compute @workgroup_size(256)
fn points(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    if i >= at.faces {
        let v = i - at.faces;
        new_points[v] = vertex_point(v);
        return;
    }
    for (var h = 3u * i; h < 3u * i + 3u; h++) {
        if owns(h) {
            new_points[at.first_edge + edge(h)] = edge_point(h);
        }
    }
}
