// Colours as the draw reads them: four bytes of sRGB a vertex, alpha as it is (see `pack.rs`), from linear values.

@group(1) @binding(0) var<storage, read> values: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> packed: array<u32>;

@compute @workgroup_size(256)
fn colors(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let v = element(id, groups);
    if v >= at.end {
        return;
    }
    packed[v] = srgb(values[v]);
}
