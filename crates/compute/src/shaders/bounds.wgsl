// The box of all points: six numbers that only grow, from 0. A float becomes a number that is ordered as it is; lowest
// coordinates are kept as the complements of such numbers. Points that are no numbers do not count.

@group(1) @binding(0) var<storage, read> vertices: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read_write> box: array<atomic<u32>, 6>;

var<workgroup> mine: array<atomic<u32>, 6>;

fn ordered(bits: u32) -> u32 {
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

@compute @workgroup_size(256)
fn bounds(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    // Every invocation takes many, so that few groups meet in memory.
    var low = vec3(0u);
    var high = vec3(0u);
    for (var v = element(id, groups); v < at.end; v += groups.x * groups.y * GROUP) {
        let p = vertices[v].xyz;
        if all((p & vec3(0x7fffffffu)) <= vec3(0x7f800000u)) {
            let o = vec3(ordered(p.x), ordered(p.y), ordered(p.z));
            low = max(low, ~o);
            high = max(high, o);
        }
    }
    for (var k = 0u; k < 3u; k++) {
        atomicMax(&mine[k], low[k]);
        atomicMax(&mine[k + 3u], high[k]);
    }
    workgroupBarrier();
    if local < 6u {
        atomicMax(&box[local], atomicLoad(&mine[local]));
    }
}
