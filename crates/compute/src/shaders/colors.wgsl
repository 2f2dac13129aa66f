// Colours as the draw reads them: four bytes of sRGB a vertex, alpha as it is (see `pack.rs`), from linear values.

@group(1) @binding(0) var<storage, read> values: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> packed: array<u32>;

@compute @workgroup_size(256)
fn colors(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let v = element(id, groups);
    if v >= at.end {
        return;
    }
    let c = clamp(values[v], vec4(0.0), vec4(1.0));
    let curve = 1.055 * pow(c.rgb, vec3(1.0 / 2.4)) - 0.055;
    packed[v] = pack4x8unorm(vec4(select(curve, c.rgb * 12.92, c.rgb <= vec3(0.0031308)), c.a));
}
