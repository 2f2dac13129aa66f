// The sqrt3 split's half-edges on closed meshes: three for each, by arithmetic (the kernel's `split/stored.rs`).
//
//   child     3h           3h+1     3h+2           triangle of half-edge h: v, the other face's centre, its own face's centre
//   twin      3 n(t) + 2   3t + 1   3 t(p)
//   origin    v            V+f(t)   V+f
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
    let t = twin(h);
    let f = face(h);
    child_half_edges[3u * h] = 3u * next(t) + 2u;
    child_half_edges[3u * h + 1u] = 3u * t + 1u;
    child_half_edges[3u * h + 2u] = 3u * twin(prev(h));
    let origins = 3u * (at.half_edges + h);
    child_half_edges[origins] = origin(h);
    child_half_edges[origins + 1u] = at.first_face + face(t);
    child_half_edges[origins + 2u] = at.first_face + f;
    if h == 3u * f {
        child_starts[at.first_face + f] = 3u * h + 2u;
    }
}
