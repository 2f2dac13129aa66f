// The quad split's half-edges: four for each, by arithmetic (Dupuy & Vanhoey 2021, table 1; the kernel's `split/quad.rs`).
//
//   child     4h           4h+1     4h+2     4h+3
//   twin      4 n(t) + 3   4n + 2   4p + 1   4 t(p)         on a boundary !2r | | | !(2r(p) + 1), r the rank
//   origin    v            V+F+e    V+f      V+F+e(p)
//
// One invocation a half-edge, then one a vertex for where its turn starts. Four words at a time, so that writes are whole lines.

@group(1) @binding(0) var<storage, read_write> child_half_edges: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read_write> child_starts: array<u32>;
@group(1) @binding(2) var<storage, read_write> child_sharpness: array<vec4<f32>>;

@compute @workgroup_size(256)
fn split(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    if h >= at.half_edges {
        let v = h - at.half_edges;
        child_starts[v] = 4u * start(v);
        return;
    }
    let n = next(h);
    let p = prev(h);
    let t = twin(h);
    let tp = twin(p);
    let e = at.first_edge + edge(h);
    let f = face(h);
    var twins = vec4(~(2u * ~t), 4u * n + 2u, 4u * p + 1u, ~(2u * ~tp + 1u));
    if !is_boundary(t) {
        twins.x = 4u * next(t) + 3u;
    }
    if !is_boundary(tp) {
        twins.w = 4u * tp;
    }
    child_half_edges[h] = twins;
    child_half_edges[at.half_edges + h] = vec4(origin(h), e, at.first_face + f, at.first_edge + edge(p));
    if owns(h) {
        child_starts[e] = select(4u * h + 1u, 4u * n + 3u, is_boundary(t));
    }
    if h == first_of(f) {
        child_starts[at.first_face + f] = 4u * h + 2u;
    }
    if CREASED {
        let v = origin(h);
        child_sharpness[h] = vec4(half(v, sharpness[h]), 0.0, 0.0, half(v, sharpness[p]));
    }
}
