// Half-edges that are there.

fn twin(h: u32) -> u32 {
    return half_edges[h];
}

fn origin(h: u32) -> u32 {
    return half_edges[at.half_edges + h];
}

fn start(v: u32) -> u32 {
    return starts[v];
}
