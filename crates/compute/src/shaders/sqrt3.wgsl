// Sqrt3's points on closed triangle meshes (L. Kobbelt 2000): centroids, and old vertices by (1 - a) v + a mean of neighbours,
// a = (4 - 2 cos 2 pi / n) / 9. One invocation a face, then one a vertex.

@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> new_points: array<vec4<f32>>;

@compute @workgroup_size(256)
fn points(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    if i < at.faces {
        let sum = old[origin(3u * i)] + old[origin(3u * i + 1u)] + old[origin(3u * i + 2u)];
        new_points[at.first_face + i] = sum / 3.0;
        return;
    }
    let v = i - at.faces;
    if stays(v) {
        new_points[v] = old[v];
        return;
    }
    let from_h = start(v);
    var sum = vec4(0.0);
    var n = 0u;
    var h = from_h;
    loop {
        sum += old[target_of(h)];
        n += 1u;
        h = twin(prev(h));
        if is_boundary(h) || h == from_h {
            break;
        }
    }
    let a = (4.0 - 2.0 * angles[n].x) / 9.0;
    new_points[v] = (a / f32(n)) * sum + (1.0 - a) * old[v];
}
