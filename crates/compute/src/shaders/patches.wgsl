// The last levels at once: a team of invocations takes a face of the level that patches start at and makes all its descendants.
//
//   ring ── 16 control points, A P A^T ──┐
//        └─ any others, rows of a table ─┴─> plate ── points and normals ──> runs of ids
//
// A plate is the patch's grid with one row of points around it, in workgroup memory: cell (j + 1) W + i + 1. Columns of a regular
// patch are four numbers in registers, from which each invocation makes some of its rows. What a patch owns are runs of
// consecutive ids, the same for all but for where they begin; the corners and middles of its sides belong to whoever owns that vertex
// or edge, and what is nobody's on a boundary is its own. Every point is written once, with its normal, but for vertices of the
// level patches start at: their normals need all patches around, and are made after (`climb.wgsl`).
//
// Constants before this file: SIDES, M steps a side, W = M + 3, FOURS of a table's values, TEAM invocations a patch, TEAMS patches
// a group, GROUP_SIZE, CONTROLS points and PLATES numbers of workgroup memory. Lists: where each of them begins, then cells, owned, runs,
// border, controls.

struct Patch {
    first: u32,   // control points
    count: u32,
    weights: u32, // where its table begins, control by control; 0 for the spline, whose columns stand there
    points: u32,  // to be written: what it owns, corners and middles of sides, on a boundary what is nobody's
};

@group(0) @binding(3) var<storage, read> rings: array<Patch>;
@group(0) @binding(4) var<storage, read> lists: array<u32>;
@group(0) @binding(5) var<storage, read> weights: array<vec4<f32>>;
@group(1) @binding(0) var<storage, read> old: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> vertices: array<Vertex>;

var<workgroup> controls: array<vec4<f32>, CONTROLS>;
var<workgroup> plates: array<f32, PLATES>;

fn point(cell: u32) -> vec3<f32> {
    return vec3(plates[3u * cell], plates[3u * cell + 1u], plates[3u * cell + 2u]);
}

fn put(cell: u32, p: vec3<f32>) {
    plates[3u * cell] = p.x;
    plates[3u * cell + 1u] = p.y;
    plates[3u * cell + 2u] = p.z;
}

fn across(row: u32, a: vec4<f32>) -> vec3<f32> {
    return (a.x * controls[row] + a.y * controls[row + 1u] + a.z * controls[row + 2u] + a.w * controls[row + 3u]).xyz;
}

fn spline(plate: u32, ring: u32, t: u32) {
    let part = t / W;
    let rows = (W + TEAM / W - 1u) / (TEAM / W);
    let i = t % W;
    let a = weights[i];
    let p = across(ring, a);
    let q = across(ring + 4u, a);
    let r = across(ring + 8u, a);
    let s = across(ring + 12u, a);
    for (var j = part * rows; j < min(part * rows + rows, W); j++) {
        let b = weights[j];
        put(plate + j * W + i, b.x * p + b.y * q + b.z * r + b.w * s);
    }
}

// Four values at once: each control point is read a quarter as often.
fn tabled(plate: u32, ring: u32, t: u32, mine: Patch) {
    for (var i = t; i < FOURS; i += TEAM) {
        var x = vec4(0.0);
        var y = vec4(0.0);
        var z = vec4(0.0);
        for (var k = 0u; k < mine.count; k++) {
            let w = weights[mine.weights + k * FOURS + i];
            let p = controls[ring + k];
            x += w * p.x;
            y += w * p.y;
            z += w * p.z;
        }
        let cells = lists[0] + 4u * i;
        for (var k = 0u; k < 4u; k++) {
            put(plate + lists[cells + k], vec3(x[k], y[k], z[k]));
        }
    }
}

// The sum of the normals of the faces around a point, as long as their areas twice.
fn normal(cell: u32) -> vec3<f32> {
    let p = point(cell);
    let e = point(cell + 1u) - p;
    let n = point(cell + W) - p;
    let w = point(cell - 1u) - p;
    let s = point(cell - W) - p;
    let nw = point(cell + W - 1u) - p;
    let se = point(cell - W + 1u) - p;
    if SIDES == 3u {
        return cross(e, n) + cross(n, nw) + cross(nw, w) + cross(w, s) + cross(s, se) + cross(se, e);
    }
    let ne = point(cell + W + 1u) - p;
    let sw = point(cell - W - 1u) - p;
    return cross(ne, n - e) + cross(nw, w - n) + cross(sw, s - w) + cross(se, e - s);
}

const NOBODY = 0xffffffffu;

// The id of point i among those that a patch of the border may have to write: the corner of a side, its middle, or on a boundary
// any other.
fn border_id(q: u32, border: u32) -> u32 {
    let h = SIDES * q + (lists[border] >> 16u);
    let base = lists[border + 1u];
    let per = lists[border + 2u];
    if per > 0u {
        let t = twin(h);
        return select(NOBODY, base + per * ~t, is_boundary(t));
    }
    if base == 0u {
        let v = origin(h);
        return select(NOBODY, v, start(v) == h);
    }
    return select(NOBODY, at.first_edge + edge(h), owns(h));
}

@compute @workgroup_size(GROUP_SIZE)
fn patches(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let team = local / TEAM;
    let t = local % TEAM;
    let q = at.first + (group.x + group.y * groups.x) * TEAMS + team;
    let there = q < at.end;
    let plate = team * W * W;
    let ring = team * (CONTROLS / TEAMS);
    var mine = Patch(0u, 0u, 0u, 0u);
    if there {
        mine = rings[q];
    }
    for (var k = t; k < mine.count; k += TEAM) {
        controls[ring + k] = old[lists[lists[4] + mine.first + k]];
    }
    workgroupBarrier();
    if there {
        if mine.weights > 0u {
            tabled(plate, ring, t, mine);
        } else if t < TEAM / W * W {
            spline(plate, ring, t);
        }
    }
    workgroupBarrier();
    if !there {
        return;
    }
    let owned = lists[2] - lists[1];
    for (var i = t; i < mine.points; i += TEAM) {
        let inside = i < owned;
        let entry = select(lists[3] + 3u * (i - owned), lists[1] + i, inside);
        let cell = plate + (lists[entry] & 0xffffu);
        var id = 0u;
        if inside {
            let run = lists[2] + 2u * (lists[entry] >> 16u);
            id = lists[run] + i + lists[run + 1u] * q;
        } else {
            id = border_id(q, entry);
        }
        if id != NOBODY {
            vertices[id] = Vertex(point(cell), octahedral(normal(cell)));
        }
    }
}
