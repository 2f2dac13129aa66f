// What corners carry besides points: texture coordinates, refined on half-edges with seams cut, or colours, refined on the points' own.
// Corners come in the order in which points' corners do.

@group(1) @binding(0) var<storage, read> values: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> carried: array<u32>; // u | v | colour

fn put(corner: u32, v: u32) {
    let to = 3u * corner;
    if SCHEME == 1u {
        carried[to + 2u] = srgb(values[v]);
        return;
    }
    carried[to] = bitcast<u32>(values[v].x);
    carried[to + 1u] = bitcast<u32>(values[v].y);
    carried[to + 2u] = 0xffffffffu;
}

fn on_edge(h: u32) -> u32 {
    return at.first_edge + edge(h);
}

@compute @workgroup_size(256)
fn extras(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    if QUADS {
        let to = 6u * (i - at.first);
        let f = at.first_face + face(i);
        put(to, origin(i));
        put(to + 1u, on_edge(i));
        put(to + 2u, f);
        put(to + 3u, origin(i));
        put(to + 4u, f);
        put(to + 5u, on_edge(prev(i)));
        return;
    }
    // Triangles at corners, then those in the middle.
    let to = 3u * (i - at.first);
    if i < at.half_edges {
        put(to, origin(i));
        put(to + 1u, on_edge(i));
        put(to + 2u, on_edge(prev(i)));
    } else {
        let h = 3u * (i - at.half_edges);
        put(to, on_edge(h + 2u));
        put(to + 1u, on_edge(h));
        put(to + 2u, on_edge(h + 1u));
    }
}
