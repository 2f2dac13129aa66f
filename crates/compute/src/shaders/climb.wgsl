// Half-edges of a level that was never built: by climbing to those of `at.step` levels before it, which are there. Every step is
// what `split_quads.wgsl` and `split_triangles.wgsl` would have written, read the other way.
//
//   quads       4h + k      k 0 asks the twin of h, 3 that of p; 1 and 2 lie inside the parent
//   triangles   3h + k      k 0 asks the twin of h, 2 that of p; 1 lies inside, as do the middle's 3H + h
//
// Half of all climbs end at each step. `up` counts levels before the one asked for; at.rest: its boundary half-edges.

fn half_edges_at(up: u32) -> u32 {
    return at.half_edges >> (2u * up);
}

fn vertices_at(up: u32) -> u32 {
    var v = at.vertices;
    for (var u = 1u; u <= up; u++) {
        let h = half_edges_at(u);
        // Its edges, and of quads its faces.
        v -= (h + (at.rest >> u)) / 2u;
        if SIDES == 4u {
            v -= h / 4u;
        }
    }
    return v;
}

fn twin_at(of_h: u32, from_up: u32) -> u32 {
    var h = of_h;
    var up = from_up;
    // Which sides it came along, lowest last, below a leading one: 1 for the parent's side before.
    var path = 1u;
    var t = 0u;
    loop {
        if up == at.step {
            t = half_edges[h];
            break;
        }
        up += 1u;
        var k = h & 3u;
        var parent = h >> 2u;
        if SIDES == 4u {
            if k == 1u {
                t = 4u * next(parent) + 2u;
                break;
            }
            if k == 2u {
                t = 4u * prev(parent) + 1u;
                break;
            }
        } else {
            let all = half_edges_at(up);
            if h >= 3u * all {
                t = 3u * (h - 3u * all) + 1u;
                break;
            }
            k = h % 3u;
            parent = h / 3u;
            if k == 1u {
                t = 3u * all + parent;
                break;
            }
        }
        path = 2u * path + u32(k > 0u);
        h = select(parent, prev(parent), k > 0u);
    }
    for (; path > 1u; path /= 2u) {
        let before = path % 2u;
        if is_boundary(t) {
            t = ~(2u * ~t + before);
        } else if before == 1u {
            t = SIDES * t;
        } else {
            t = SIDES * next(t) + SIDES - 1u;
        }
    }
    return t;
}

fn edge_at(h: u32, up: u32) -> u32 {
    var k = h & 3u;
    var f = h >> 2u;
    var owned = half_edges_at(up) / 2u;
    if SIDES == 3u {
        let middle = 3u * half_edges_at(up + 1u);
        if h >= middle {
            return 2u * (h - middle) + 1u;
        }
        k = h % 3u;
        f = h / 3u;
        owned = 2u * half_edges_at(up + 1u);
    }
    if k < 2u {
        return 2u * f + k;
    }
    let t = twin_at(h, up);
    if is_boundary(t) {
        return owned + (~t >> 1u);
    }
    return select(2u * (t / SIDES), 2u * (t / SIDES) + 1u, SIDES == 4u && k == 2u);
}

fn twin(h: u32) -> u32 {
    return twin_at(h, 0u);
}

fn origin(of_h: u32) -> u32 {
    var h = of_h;
    for (var up = 1u; up <= at.step; up++) {
        let all = half_edges_at(up);
        var k = h & 3u;
        var parent = h >> 2u;
        if SIDES == 3u {
            // The middle's begin where those of the corners that they cut off end.
            k = select(h % 3u, 2u, h >= 3u * all);
            parent = select(h / 3u, h - 3u * all, h >= 3u * all);
        }
        if k == 0u {
            h = parent;
            continue;
        }
        if SIDES == 4u && k == 2u {
            return vertices_at(up) + parent / 4u;
        }
        let first_edge = vertices_at(up) + select(0u, all / 4u, SIDES == 4u);
        return first_edge + edge_at(select(parent, prev(parent), k > 1u), up);
    }
    return half_edges[half_edges_at(at.step) + h];
}

// Of a vertex of the level that is there.
fn start(v: u32) -> u32 {
    var h = starts[v];
    for (var up = 0u; up < at.step; up++) {
        h *= SIDES;
    }
    return h;
}
