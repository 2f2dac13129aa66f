// What a sqrt3 split's last level needs to be drawn: normals beside the points, and corners. Its half-edges are never built.
//
//        w              triangle of half-edge h = (v, w): v, c', c
//      / | \            around v   the triangles of its spokes
//    c   |   c'         around c   those of the face's half-edges and of their twins
//      \ | /
//        v

fn triangle(h: u32) -> vec3<u32> {
    return vec3(origin(h), at.first_face + face(twin(h)), at.first_face + face(h));
}

fn around(h: u32) -> vec3<f32> {
    let v = triangle(h);
    let p = vertices[v.x].p;
    return cross(vertices[v.y].p - p, vertices[v.z].p - p);
}

@compute @workgroup_size(256)
fn normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    var sum = vec3(0.0);
    if i < at.faces {
        for (var h = 3u * i; h < 3u * i + 3u; h++) {
            sum += around(h) + around(twin(h));
        }
        vertices[at.first_face + i].n = octahedral(sum);
        return;
    }
    let v = i - at.faces;
    let from_h = start(v);
    var h = from_h;
    loop {
        sum += around(h);
        h = twin(prev(h));
        if is_boundary(h) || h == from_h {
            break;
        }
    }
    vertices[v].n = octahedral(sum);
}

// One invocation a half-edge, which is a child face.
@compute @workgroup_size(256)
fn faces(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let v = triangle(h);
    let face = octahedral(around(h));
    let to = 3u * (h - at.first);
    // All sides are edges, none the parent's.
    place(to, v.x, face, 7u);
    place(to + 1u, v.y, face, 7u);
    place(to + 2u, v.z, face, 7u);
}
