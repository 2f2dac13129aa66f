// Half-edges of a level that are there, as `split_quads.wgsl` and the other splits wrote them or as tables of level 0 came: one
// load each.

fn twin(h: u32) -> u32 {
    return half_edges[h];
}

fn origin(h: u32) -> u32 {
    return half_edges[at.half_edges + h];
}

fn start(v: u32) -> u32 {
    return starts[v];
}
