// The dual split's half-edges on closed meshes, by arithmetic (the kernel's `split/stored.rs`); faces are not all alike, so face,
// edge and runs of corners are tables on every level.
//
//     | v-face |           edge face of owner h and its twin t: n(h) h n(t) t. Its sides 0 and 2 lie along the faces' own h and t,
//   - g ------ h -         side 1 along the vertex face where h begins: there, the side that ends in corner h.
//     | e-face |
//   - . ------ . -         edges: half-edge h of a face owns h, sides 1 and 3 of edge e own H + 2e and H + 2e + 1
//
// One invocation a half-edge h: itself, two sides of the edge's face, one of the vertex's.

@group(1) @binding(0) var<storage, read_write> child_half_edges: array<u32>;
@group(1) @binding(1) var<storage, read_write> child_starts: array<u32>;
@group(1) @binding(2) var<storage, read_write> child_sharpness: array<f32>;

fn put(child: u32, twin: u32, origin: u32, face: u32, edge: u32) {
    let all = 4u * at.half_edges;
    child_half_edges[child] = twin;
    child_half_edges[all + child] = origin;
    child_starts[at.half_edges + child] = face;
    child_starts[at.half_edges + all + child] = edge;
}

@compute @workgroup_size(256)
fn split(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let f = face(h);
    let e = edge(h);
    let v = origin(h);
    let t = twin(h);
    let own = h < t;
    let along = side(h);
    let vertex_faces = at.half_edges + 4u * at.owned;
    // The side of the vertex's face from the spoke before to h.
    let place = place_of(h);
    let from_v = vertex_faces + before(v);
    var at_v = from_v + place - 1u;
    if place == 0u {
        var n = 1u;
        for (var spoke = twin(prev(h)); spoke != h; spoke = twin(prev(spoke))) {
            n += 1u;
        }
        at_v = from_v + n - 1u;
        child_starts[9u * at.half_edges + at.faces + at.owned + v] = from_v;
    }
    let across = at.half_edges + 2u * e + select(1u, 0u, own);
    put(h, along, h, f, h);
    put(along, h, next(h), at.faces + e, h);
    put(along + 1u, at_v, h, at.faces + e, across);
    put(at_v, along + 1u, next(t), at.faces + at.owned + v, across);
    child_starts[h] = h;
    if h == first_of(f) {
        child_starts[9u * at.half_edges + f] = h;
    }
    if own {
        child_starts[9u * at.half_edges + at.faces + e] = along;
    }
    if h == 0u {
        child_starts[9u * at.half_edges + at.faces + at.owned + at.vertices] = 4u * at.half_edges;
    }
}
