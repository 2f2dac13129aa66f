// The half-edges of the level that is refined, as all rules see them.
//
// Two constants stand before this file. SIDES: what all faces have, 3 or 4, or 0 for any polygons. BASE: whether this is
// level 0, whose edges, faces and runs of corners are tables; later levels answer by arithmetic.
//
//   half_edges   twin | origin                               one word a half-edge each
//   starts       vertex -> half-edge | (level 0) face | edge | first half-edge of each face, and the end

@group(0) @binding(1) var<storage, read> half_edges: array<u32>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> marks: array<vec2<u32>>; // bits, sharpness
@group(0) @binding(4) var<storage, read> sharpness: array<f32>;   // by half-edges
@group(0) @binding(5) var<storage, read> angles: array<vec2<f32>>; // cosine and sine of 2 pi / n

fn is_boundary(twin: u32) -> bool {
    return (twin & 0x80000000u) != 0u;
}

fn twin(h: u32) -> u32 {
    return half_edges[h];
}

fn origin(h: u32) -> u32 {
    return half_edges[at.half_edges + h];
}

fn start(v: u32) -> u32 {
    return starts[v];
}

fn face(h: u32) -> u32 {
    if SIDES == 4u {
        return h >> 2u;
    }
    if SIDES == 3u {
        return h / 3u;
    }
    return starts[at.vertices + h];
}

fn first_of(f: u32) -> u32 {
    if SIDES != 0u {
        return SIDES * f;
    }
    return starts[at.vertices + 2u * at.half_edges + f];
}

fn end_of(f: u32) -> u32 {
    return first_of(f + 1u);
}

fn next(h: u32) -> u32 {
    if SIDES == 4u {
        return (h & 0xfffffffcu) | ((h + 1u) & 3u);
    }
    if SIDES == 3u {
        return select(h + 1u, h - 2u, h % 3u == 2u);
    }
    let f = face(h);
    return select(h + 1u, first_of(f), h + 1u == end_of(f));
}

fn prev(h: u32) -> u32 {
    if SIDES == 4u {
        return (h & 0xfffffffcu) | ((h + 3u) & 3u);
    }
    if SIDES == 3u {
        return select(h - 1u, h + 2u, h % 3u == 0u);
    }
    let f = face(h);
    return select(h - 1u, end_of(f) - 1u, h == first_of(f));
}

fn target_of(h: u32) -> u32 {
    return origin(next(h));
}

// The edge of h. After a split every inner edge has one side that is the first or second of its face, or a middle triangle's.
fn edge(h: u32) -> u32 {
    if BASE {
        return starts[at.vertices + at.half_edges + h];
    }
    if SIDES == 4u {
        let q = h >> 2u;
        let k = h & 3u;
        if k < 2u {
            return 2u * q + k;
        }
        let t = twin(h);
        if k == 2u {
            return 2u * (t >> 2u) + 1u;
        }
        return select(2u * (t >> 2u), at.owned + (~t >> 1u), is_boundary(t));
    }
    if h >= at.middle {
        return 2u * (h - at.middle) + 1u;
    }
    let k = h % 3u;
    if k < 2u {
        return 2u * (h / 3u) + k;
    }
    let t = twin(h);
    return select(2u * (t / 3u), at.owned + (~t >> 1u), is_boundary(t));
}

// Whether h is the side that makes its edge's point.
fn owns(h: u32) -> bool {
    if BASE {
        return h < twin(h);
    }
    if SIDES == 4u {
        let k = h & 3u;
        return k < 2u || (k == 3u && is_boundary(twin(h)));
    }
    return h < at.middle && (h % 3u < 2u || is_boundary(twin(h)));
}

// Whether v stays where it is, whatever its edges: its own mark, or a corner of the rim.
fn stays(v: u32) -> bool {
    var rounded = at.corners == 0u;
    if v < at.marked {
        if (marks[v].x & 1u) != 0u {
            return true;
        }
        rounded = rounded || (marks[v].x & 2u) != 0u;
    }
    if rounded {
        return false;
    }
    let h = start(v);
    return is_boundary(twin(h)) && is_boundary(twin(prev(h)));
}

// The half-edge that arrives at a boundary vertex along the rim, by a turn from the one that leaves it there.
fn arriving(from_h: u32) -> u32 {
    var back = prev(from_h);
    loop {
        let h = twin(back);
        if is_boundary(h) || h == from_h {
            break;
        }
        back = prev(h);
    }
    return back;
}
