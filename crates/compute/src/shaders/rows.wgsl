// Any scheme's points from sparse rows: what `limn-mesh` records of its rules, one dispatch a pass.
//
//   offsets   where the entries of each row begin, and the end
//   entries   source, weight:   a vertex of the level before, or CHILD | a child of an earlier pass
//
// Before this file stands `moved`: what a row's point is moved by.
// One invocation a row: the same sum in the same order as the kernel's, from single numbers.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<vec2<u32>>;
@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> new_points: array<vec4<f32>>;

const CHILD = 0x80000000u;

@compute @workgroup_size(256)
fn points(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    var sum = vec4(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        let entry = entries[k];
        let w = bitcast<f32>(entry.y);
        if (entry.x & CHILD) != 0u {
            sum += w * new_points[entry.x & ~CHILD];
        } else {
            sum += w * old[entry.x];
        }
    }
    new_points[at.first_face + i] = sum + moved(i);
}
