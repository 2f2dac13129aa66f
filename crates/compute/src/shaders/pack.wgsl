// Vertices and corners as the draw reads them: 16 and 24 bytes, normals octahedral (see `pack.rs` and `corners.rs`).

struct Vertex {
    p: vec3<f32>,
    n: u32,
};

struct Corner {
    x: f32,
    y: f32,
    z: f32,
    normal: u32,
    face: u32,
    flags: u32,
};

fn octahedral(sum: vec3<f32>) -> u32 {
    // By the largest component first: tiny faces have normals whose squares vanish.
    let largest = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));
    if !(largest > 0.0 && largest < 3.4e38) {
        return 0u;
    }
    let m = sum / largest;
    let n = m / (abs(m.x) + abs(m.y) + abs(m.z));
    let fold = vec2((1.0 - abs(n.y)) * select(-1.0, 1.0, n.x >= 0.0), (1.0 - abs(n.x)) * select(-1.0, 1.0, n.y >= 0.0));
    return pack2x16snorm(select(n.xy, fold, n.z < 0.0));
}
