// Normals of a level whose faces are listed, after rows: a normal a face, then the sum of those around each vertex.
//
//   faces    the corners of face f are corners[offsets[f]] .. corners[offsets[f + 1]]
//   around   spokes[turns[v]] .. spokes[turns[v + 1]] are the faces at vertex v
//
// Quads by their diagonals, other polygons by the sum over triangles from the first corner: as the kernel has it.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> corners: array<u32>;
@group(0) @binding(3) var<storage, read> turns: array<u32>;
@group(0) @binding(4) var<storage, read> spokes: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>; // three vertices, face, bits of edges
@group(1) @binding(0) var<storage, read_write> vertices: array<Vertex>;
@group(1) @binding(1) var<storage, read_write> face_normals: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> out: array<Corner>;

fn point(c: u32) -> vec3<f32> {
    return vertices[corners[c]].p;
}

@compute @workgroup_size(256)
fn faces(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let f = element(id, groups);
    if f >= at.end {
        return;
    }
    let c = offsets[f];
    let end = offsets[f + 1u];
    var sum = vec3(0.0);
    if end - c == 4u {
        sum = cross(point(c + 2u) - point(c), point(c + 3u) - point(c + 1u));
    } else if end > c {
        let first = point(c);
        for (var k = c + 2u; k < end; k++) {
            sum += cross(point(k - 1u) - first, point(k) - first);
        }
    }
    face_normals[f] = vec4(sum, 0.0);
}

@compute @workgroup_size(256)
fn normals(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let v = element(id, groups);
    if v >= at.end {
        return;
    }
    var sum = vec3(0.0);
    for (var k = turns[v]; k < turns[v + 1u]; k++) {
        sum += face_normals[spokes[k]].xyz;
    }
    vertices[v].n = octahedral(sum);
}

@compute @workgroup_size(256)
fn listed_corners(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = element(id, groups);
    if i >= at.end {
        return;
    }
    let face = octahedral(face_normals[triangles[5u * i + 3u]].xyz);
    for (var k = 0u; k < 3u; k++) {
        let v = triangles[5u * i + k];
        let p = vertices[v].p;
        out[3u * i + k] = Corner(p.x, p.y, p.z, vertices[v].n, face, triangles[5u * i + 4u]);
    }
}
