// The triangle split's half-edges: four for each, by arithmetic (Vanhoey & Dupuy 2022; the kernel's `split/triangle.rs`).
//
//   child     3h           3h+1      3h+2         3H+h
//   twin      3 n(t) + 2   3H + h    3 t(p)       3h + 1      on a boundary !2r | | !(2r(p) + 1), r the rank
//   origin    v            V+e       V+e(p)       V+e(p)
//
// One invocation a half-edge, then one a vertex for where its turn starts.

@group(1) @binding(0) var<storage, read_write> child_half_edges: array<u32>;
@group(1) @binding(1) var<storage, read_write> child_starts: array<u32>;
@group(1) @binding(2) var<storage, read_write> child_sharpness: array<f32>;

@compute @workgroup_size(256)
fn split(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    if h >= at.half_edges {
        let v = h - at.half_edges;
        child_starts[v] = 3u * start(v);
        return;
    }
    let middle = 3u * at.half_edges;
    let all = 4u * at.half_edges;
    let n = next(h);
    let p = prev(h);
    let t = twin(h);
    let tp = twin(p);
    let e = at.first_edge + edge(h);
    let before = at.first_edge + edge(p);
    child_half_edges[3u * h] = select(3u * next(t) + 2u, ~(2u * ~t), is_boundary(t));
    child_half_edges[3u * h + 1u] = middle + h;
    child_half_edges[3u * h + 2u] = select(3u * tp, ~(2u * ~tp + 1u), is_boundary(tp));
    child_half_edges[middle + h] = 3u * h + 1u;
    child_half_edges[all + 3u * h] = origin(h);
    child_half_edges[all + 3u * h + 1u] = e;
    child_half_edges[all + 3u * h + 2u] = before;
    child_half_edges[all + middle + h] = before;
    if owns(h) {
        child_starts[e] = select(3u * h + 1u, 3u * n + 2u, is_boundary(t));
    }
    if CREASED {
        let v = origin(h);
        child_sharpness[3u * h] = half(v, sharpness[h]);
        child_sharpness[3u * h + 1u] = 0.0;
        child_sharpness[3u * h + 2u] = half(v, sharpness[p]);
        child_sharpness[middle + h] = 0.0;
    }
}
