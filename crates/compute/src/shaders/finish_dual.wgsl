// What a dual split's last level needs to be drawn: normals beside the points, and corners. Its half-edges are never built.
//
//   image of corner h lies in    the face of h, the faces of edges h and p(h), the face of its vertex
//   triangles                    fans: faces' [0, H - 2F) | edges' two each | vertices'
//
// `first` and `end` say which half-edges are looked at; corners are of triangles step .. marked, which are this buffer's.

fn around(a: u32, b: u32, c: u32) -> vec3<f32> {
    let p = vertices[a].p;
    return cross(vertices[b].p - p, vertices[c].p - p);
}

fn of_face(f: u32) -> vec3<f32> {
    let from_h = first_of(f);
    let end = end_of(f);
    var sum = vec3(0.0);
    for (var h = from_h + 2u; h < end; h++) {
        sum += around(from_h, h - 1u, h);
    }
    return sum;
}

fn of_edge(h: u32) -> vec3<f32> {
    let t = twin(h);
    return cross(vertices[next(t)].p - vertices[next(h)].p, vertices[t].p - vertices[h].p);
}

fn of_vertex(v: u32) -> vec3<f32> {
    let from_h = start(v);
    var last = twin(prev(from_h));
    var h = twin(prev(last));
    var sum = vec3(0.0);
    while h != from_h {
        sum += around(from_h, last, h);
        last = h;
        h = twin(prev(h));
    }
    return sum;
}

@compute @workgroup_size(256)
fn normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    vertices[h].n = octahedral(of_face(face(h)) + of_edge(h) + of_edge(prev(h)) + of_vertex(origin(h)));
}

// Triangle i of all: a fan's, whose polygon's normal is `sum`. The kind of its polygon is in bits 6 and 7.
fn put(i: u32, a: u32, b: u32, c: u32, sum: vec3<f32>, flags: u32) {
    if i < at.step || i >= at.marked {
        return;
    }
    let face = octahedral(sum);
    let to = 3u * (i - at.step);
    place(to, a, face, flags);
    place(to + 1u, b, face, flags);
    place(to + 2u, c, face, flags);
}

// Which sides of a fan's triangle are the polygon's: always the outer one, and those of its first and last.
fn sides(first: bool, last: bool) -> u32 {
    return 1u | select(0u, 4u, first) | select(0u, 2u, last);
}

@compute @workgroup_size(256)
fn faces(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let f = face(h);
    let from_h = first_of(f);
    let place = h - from_h;
    if place >= 2u {
        put(h - 2u - 2u * f, from_h, h - 1u, h, of_face(f), sides(place == 2u, h + 1u == end_of(f)) | 0x40u);
    }
    let t = twin(h);
    let edges = at.half_edges - 2u * at.faces;
    if h < t {
        let i = edges + 2u * edge(h);
        let sum = of_edge(h);
        put(i, next(h), h, next(t), sum, sides(true, false) | 0x80u);
        put(i + 1u, next(h), next(t), t, sum, sides(false, true) | 0x80u);
    }
    let v = origin(h);
    let turn = place_of(h);
    if turn >= 2u {
        let i = edges + 2u * at.owned + before(v) - 2u * v + turn - 2u;
        let last = twin(prev(h)) == start(v);
        put(i, start(v), next(t), h, of_vertex(v), sides(turn == 2u, last) | 0xc0u);
    }
}
