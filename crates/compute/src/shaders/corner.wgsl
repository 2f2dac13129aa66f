// Points and normals of the last level, and corners made of them.

@group(1) @binding(0) var<storage, read_write> vertices: array<Vertex>;
@group(1) @binding(1) var<storage, read_write> corners: array<Corner>;

fn place(to: u32, v: u32, face: u32, flags: u32) {
    let p = vertices[v].p;
    corners[to] = Corner(p.x, p.y, p.z, vertices[v].n, face, flags);
}
