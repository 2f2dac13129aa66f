// The quad split's points: Catmull-Clark (E. Catmull, J. Clark 1978) and linear.
//
// One invocation a face, which makes its point and those of the edges that it owns; then one a vertex. Everything is a gather
// from the level before, face points of neighbours included: one dispatch a level, and nothing is written twice.
//
//   e --- d        a vertex of valence n with edges e and far corners d of quads:
//   |     |        v' = (n - 2) / n v + (sum of e + sum of face points) / n^2,   a face point (v + e + e' + d) / 4
//   v --- e'
//
// Constants before this file: SIDES, BASE, CREASED, and SCHEME: 1 Catmull-Clark, 0 linear. a: what a triangle's point weighs in its edges.

@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> new_points: array<vec4<f32>>;

fn centroid(f: u32) -> vec4<f32> {
    let from_h = first_of(f);
    if SIDES == 4u {
        return 0.25 * (old[origin(from_h)] + old[origin(from_h + 1u)] + old[origin(from_h + 2u)] + old[origin(from_h + 3u)]);
    }
    let end = end_of(f);
    var sum = vec4(0.0);
    for (var h = from_h; h < end; h++) {
        sum += old[origin(h)];
    }
    return sum / f32(end - from_h);
}

fn face_weight(f: u32) -> f32 {
    if SIDES == 4u {
        return 0.25;
    }
    return select(0.25, at.a, end_of(f) - first_of(f) == 3u);
}

fn edge_point(h: u32, f: u32, centre: vec4<f32>) -> vec4<f32> {
    let ends = old[origin(h)] + old[target_of(h)];
    if SCHEME == 0u {
        return 0.5 * ends;
    }
    let sharp = edge_share(h);
    if sharp == 1.0 {
        return 0.5 * ends;
    }
    let g = face(twin(h));
    let w = 0.5 * (face_weight(f) + face_weight(g));
    let smooth_ = (0.5 - w) * ends + w * (centre + centroid(g));
    return mix(smooth_, 0.5 * ends, sharp);
}

fn smooth_point(v: u32) -> vec4<f32> {
    let own = old[v];
    let from_h = start(v);
    var sum = vec4(0.0);
    var n = 0.0;
    var h = from_h;
    loop {
        if SIDES == 4u {
            let k = next(h);
            sum += 1.5 * old[origin(k)] + 0.25 * old[target_of(k)] + 0.25 * own;
        } else {
            sum += old[target_of(h)] + centroid(face(h));
        }
        n += 1.0;
        h = twin(prev(h));
        if is_boundary(h) || h == from_h {
            break;
        }
    }
    return sum / (n * n) + own * ((n - 2.0) / n);
}

fn vertex_point(v: u32) -> vec4<f32> {
    if SCHEME == 0u {
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
    let centre = centroid(i);
    new_points[at.first_face + i] = centre;
    let end = end_of(i);
    for (var h = first_of(i); h < end; h++) {
        if owns(h) {
            new_points[at.first_edge + edge(h)] = edge_point(h, i, centre);
        }
    }
}
