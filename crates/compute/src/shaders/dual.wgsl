// Doo-Sabin's points on closed meshes (D. Doo, M. Sabin 1978), and the midpoint variant: the image of every corner, of weights
//
//   w0 = 1/4 + 5/(4k)      wj = (3 + 2 cos(2 pi j / k)) / (4k)        midpoint: the mean of corner, edge midpoints and centroid
//
// in a face of k corners. One invocation a half-edge, whose number is its image's. SCHEME: 0 Doo-Sabin, 1 midpoint.

@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> new_points: array<vec4<f32>>;

@compute @workgroup_size(256)
fn points(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = element(id, groups);
    if h >= at.end {
        return;
    }
    let f = face(h);
    let from_h = first_of(f);
    let end = end_of(f);
    let k = f32(end - from_h);
    let own = old[origin(h)];
    if SCHEME == 1u {
        var all = vec4(0.0);
        for (var x = from_h; x < end; x++) {
            all += old[origin(x)];
        }
        new_points[h] = 0.5 * own + 0.125 * (old[target_of(h)] + old[origin(prev(h))]) + (0.25 / k) * all;
        return;
    }
    let step = angles[end - from_h];
    var there = step;
    var sum = (0.25 + 1.25 / k) * own;
    for (var x = next(h); x != h; x = next(x)) {
        sum += ((3.0 + 2.0 * there.x) / (4.0 * k)) * old[origin(x)];
        there = vec2(there.x * step.x - there.y * step.y, there.x * step.y + there.y * step.x);
    }
    new_points[h] = sum;
}
