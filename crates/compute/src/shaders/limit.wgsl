// Normals in the limit: the cross product of two tangents, sums of the points before; on a crease the mean of its sectors'. A vertex
// without tangents, or with parallel ones, keeps the normal that the faces around it gave.
//
//   offsets    where the entries of each vertex begin, and the end
//   entries    source, its weights in both tangents, sector; in order of sectors

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<vec4<u32>>;
@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> vertices: array<Vertex>;

// How far above the rounding of such sums a cross product has to be.
const SURE = 1e-5;

@compute @workgroup_size(256)
fn limit_normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let v = element(id, groups);
    if v >= at.end {
        return;
    }
    let end = offsets[v + 1u];
    var sum = vec3(0.0);
    var sectors = 0.0;
    var k = offsets[v];
    while k < end {
        let sector = entries[k].w;
        // Weights add up to zero: differences lose less than coordinates.
        let origin = old[entries[k].x].xyz;
        var s = vec3(0.0);
        var t = vec3(0.0);
        var weights = vec2(0.0);
        var spread = 0.0;
        while k < end && entries[k].w == sector {
            let e = entries[k];
            let w = vec2(bitcast<f32>(e.y), bitcast<f32>(e.z));
            let x = old[e.x].xyz - origin;
            s += w.x * x;
            t += w.y * x;
            weights += abs(w);
            spread = max(spread, max(abs(x.x), max(abs(x.y), abs(x.z))));
            k++;
        }
        let size = spread * weights;
        // By their sizes first: tangents of tiny faces have products that vanish.
        let n = cross(s / size.x, t / size.y);
        let long = length(n);
        if !(long > SURE) {
            return;
        }
        sum += n / long;
        sectors += 1.0;
    }
    if length(sum) > SURE * sectors {
        vertices[v].n = octahedral(sum);
    }
}
