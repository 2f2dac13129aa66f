// By how much constants are larger than when they were recorded: a fractal's are so many mean lengths of the cage's edges, and the cage
// has moved. One workgroup. a: the mean length that they were recorded with.

@group(0) @binding(1) var<storage, read> edges: array<vec2<u32>>;
@group(1) @binding(0) var<storage, read> cage: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> scale: array<f32>;

var<workgroup> sums: array<f32, GROUP>;

@compute @workgroup_size(256)
fn measure(@builtin(local_invocation_index) local: u32) {
    var sum = 0.0;
    for (var e = local; e < at.rest; e += GROUP) {
        sum += distance(cage[edges[e].x].xyz, cage[edges[e].y].xyz);
    }
    sums[local] = sum;
    for (var half = GROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            sums[local] += sums[local + half];
        }
    }
    if local == 0u {
        scale[0] = select(0.0, sums[0] / (f32(at.rest) * at.a), at.a > 0.0);
    }
}
