// What a triangle split's last level needs to be drawn: normals beside the points, and corners. Its half-edges are never built.
//
//          v                triangle of half-edge h: v, e(h), e(p); of face f: the three edge points
//        / h  \             around v      the triangles of its spokes
//      e(h) - e(p)          around e(h)   those of h, n(h) and the face, and the same on the other side
//      /  \ f /  \
//     n --- . ----- p

fn on_edge(h: u32) -> u32 {
    return at.first_edge + edge(h);
}

fn around(v: vec3<u32>) -> vec3<f32> {
    let p = vertices[v.x].p;
    return cross(vertices[v.y].p - p, vertices[v.z].p - p);
}

fn outer(h: u32) -> vec3<u32> {
    return vec3(origin(h), on_edge(h), on_edge(prev(h)));
}

fn inner(f: u32) -> vec3<u32> {
    return vec3(on_edge(3u * f + 2u), on_edge(3u * f), on_edge(3u * f + 1u));
}

fn beside(h: u32) -> vec3<f32> {
    return around(outer(h)) + around(outer(next(h))) + around(inner(h / 3u));
}

@compute @workgroup_size(256)
fn normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    if i >= at.faces {
        let v = i - at.faces;
        let from_h = start(v);
        var sum = vec3(0.0);
        var h = from_h;
        loop {
            sum += around(outer(h));
            h = twin(prev(h));
            if is_boundary(h) || h == from_h {
                break;
            }
        }
        vertices[v].n = octahedral(sum);
        return;
    }
    for (var h = 3u * i; h < 3u * i + 3u; h++) {
        if owns(h) {
            var sum = beside(h);
            let t = twin(h);
            if !is_boundary(t) {
                sum += beside(t);
            }
            vertices[on_edge(h)].n = octahedral(sum);
        }
    }
}

// One invocation a child face: those at corners, then those in the middle.
@compute @workgroup_size(256)
fn faces(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    // All sides are edges; those that lead to an old vertex are halves of the parent's.
    var v: vec3<u32>;
    var flags = 7u;
    if i < at.half_edges {
        v = outer(i);
        flags = 0x37u;
    } else {
        v = inner(i - at.half_edges);
    }
    let face = octahedral(around(v));
    let to = 3u * (i - at.first);
    place(to, v.x, face, flags);
    place(to + 1u, v.y, face, flags);
    place(to + 2u, v.z, face, flags);
}
