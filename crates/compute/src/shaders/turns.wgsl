// Where the faces around vertices of a dual split begin, on closed meshes: at level 0 a table behind the others, later every
// vertex has four faces.
//
//   half-edges of the next level    faces' [0, H) | edges' four each [H, H + 4E) | vertices' one a spoke
//   its faces                       [0, F) | [F, F + E) | [F + E, F + E + V)          at.owned: edges

fn before(v: u32) -> u32 {
    if FIRST {
        return starts[at.vertices + 2u * at.half_edges + at.faces + 1u + v];
    }
    return 4u * v;
}

// The side of the edge's face that lies along h.
fn side(h: u32) -> u32 {
    return at.half_edges + 4u * edge(h) + select(2u, 0u, h < twin(h));
}

// How many spokes come before h in the turn around its origin.
fn place_of(h: u32) -> u32 {
    var n = 0u;
    for (var spoke = start(origin(h)); spoke != h; spoke = twin(prev(spoke))) {
        n += 1u;
    }
    return n;
}
