// What a quad split's last level needs to be drawn: normals beside the points, and indices. Its half-edges are never built:
// which quads lie around a child vertex follows from the level before.
//
//    p ---- . ---- .       quad of half-edge h: v, e(h), f, e(p); its normal the cross product of the diagonals
//    |      |      |       around v      the quads of its spokes
//    e(p)-- f ---- .       around f      the quads of its half-edges
//    |  h   | n(h) |       around e(h)   those of h and n(h), and on the other side of t and n(t)
//    v ---- e(h) - n

@group(1) @binding(1) var<storage, read_write> indices: array<vec2<u32>>;

fn point(v: u32) -> vec3<f32> {
    return vertices[v].p;
}

fn quad(h: u32) -> vec3<f32> {
    let one = point(at.first_face + face(h)) - point(origin(h));
    return cross(one, point(at.first_edge + edge(prev(h))) - point(at.first_edge + edge(h)));
}

@compute @workgroup_size(256)
fn normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    var sum = vec3(0.0);
    if i >= at.faces {
        let v = i - at.faces;
        let from_h = start(v);
        var h = from_h;
        loop {
            sum += quad(h);
            h = twin(prev(h));
            if is_boundary(h) || h == from_h {
                break;
            }
        }
        vertices[v].n = octahedral(sum);
        return;
    }
    let from_h = first_of(i);
    let end = end_of(i);
    let first = quad(from_h);
    var here = first;
    for (var h = from_h; h < end; h++) {
        sum += here;
        var there = first;
        if h + 1u < end {
            there = quad(h + 1u);
        }
        if owns(h) {
            var side = here + there;
            let t = twin(h);
            if !is_boundary(t) {
                side += quad(t) + quad(next(t));
            }
            vertices[at.first_edge + edge(h)].n = octahedral(side);
        }
        here = there;
    }
    vertices[at.first_face + i].n = octahedral(sum);
}

// Two triangles a quad, cut from old vertex to face point. One invocation a half-edge.
@compute @workgroup_size(256)
fn faces(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let v = origin(h);
    let e = at.first_edge + edge(h);
    let f = at.first_face + face(h);
    let to = 3u * (h - at.first);
    indices[to] = vec2(v, e);
    indices[to + 1u] = vec2(f, v);
    indices[to + 2u] = vec2(f, at.first_edge + edge(prev(h)));
}

// The same two triangles with corners of their own, which carry more than points. Old vertex to edge point is half of an edge of the
// level before; the diagonal is none.
@compute @workgroup_size(256)
fn quad_corners(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let v = origin(h);
    let f = at.first_face + face(h);
    let normal = octahedral(quad(h));
    let to = 6u * (h - at.first);
    place(to, v, normal, 0x25u);
    place(to + 1u, at.first_edge + edge(h), normal, 0x25u);
    place(to + 2u, f, normal, 0x25u);
    place(to + 3u, v, normal, 0x13u);
    place(to + 4u, f, normal, 0x13u);
    place(to + 5u, at.first_edge + edge(prev(h)), normal, 0x13u);
}
