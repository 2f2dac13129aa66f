// Creases and sharp vertices, as `crease.rs` and its `parts.rs` of the kernel state them (DeRose, Kass & Truong 1998, with
// OpenSubdiv's transitions): what counts at a vertex before the step, what is left behind it, and a blend where they differ.
//
// One constant stands before this file. CREASED: whether anything is sharp but rims and single vertices.

const FOR_EVER = 10.0;

fn less(s: f32) -> f32 {
    return select(max(s - 1.0, 0.0), s, s >= FOR_EVER);
}

fn along(h: u32) -> f32 {
    if is_boundary(twin(h)) {
        return FOR_EVER;
    }
    if CREASED {
        return sharpness[h];
    }
    return 0.0;
}

// The sharp edges at a vertex: how many, where the first two lead, and of the semi-sharp ones how many and their sum.
struct Survey {
    count: u32,
    semi: u32,
    sum: f32,
    ends: vec2<u32>,
};

fn add(all: ptr<function, Survey>, s: f32, end: u32) {
    if s <= 0.0 {
        return;
    }
    if (*all).count < 2u {
        (*all).ends[(*all).count] = end;
    }
    (*all).count += 1u;
    if s < FOR_EVER {
        (*all).semi += 1u;
        (*all).sum += s;
    }
}

fn survey(v: u32) -> Survey {
    var all = Survey(0u, 0u, 0.0, vec2(v, v));
    let from_h = start(v);
    var h = from_h;
    loop {
        add(&all, along(h), target_of(h));
        let back = prev(h);
        h = twin(back);
        if is_boundary(h) {
            add(&all, FOR_EVER, origin(back));
            break;
        }
        if h == from_h {
            break;
        }
    }
    return all;
}

// What is left of s, one of these.
fn left_of(s: f32, all: Survey) -> f32 {
    if at.chaikin == 0u || s >= FOR_EVER {
        return less(s);
    }
    var mixed = s;
    if all.semi > 1u {
        mixed = 0.75 * s + 0.25 * ((all.sum - s) / f32(all.semi - 1u));
    }
    return max(mixed - 1.0, 0.0);
}

// What is left of s at v.
fn half(v: u32, s: f32) -> f32 {
    if at.chaikin == 0u || s >= FOR_EVER || s <= 0.0 {
        return less(s);
    }
    return left_of(s, survey(v));
}

// A vertex's rule in shares that make one: the scheme's own, the curve through it to these ends, the vertex itself.
struct Parts {
    share: vec3<f32>,
    ends: vec2<u32>,
};

fn part(sharp: bool, edges: u32) -> u32 {
    return select(select(2u, 1u, edges == 2u), 0u, edges < 2u) | select(0u, 2u, sharp);
}

fn share_of(part: u32) -> vec3<f32> {
    // A sharp vertex of two edges is 3 by the bits: it stays.
    return vec3(f32(part == 0u), f32(part == 1u), f32(part >= 2u));
}

fn own_sharpness(v: u32) -> f32 {
    if v >= at.marked {
        return 0.0;
    }
    let s = bitcast<f32>(marks[v].y);
    return select(max(s - f32(at.step), 0.0), s, s >= FOR_EVER);
}

fn parts(v: u32) -> Parts {
    if stays(v) {
        return Parts(share_of(2u), vec2(v, v));
    }
    let own = own_sharpness(v);
    let all = survey(v);
    let before = part(own > 0.0, all.count);
    var ends = all.ends;
    if all.semi == 0u && own <= 0.0 {
        return Parts(share_of(before), ends);
    }
    var ending = 0.0;
    var count = 0u;
    if own > 0.0 && less(own) == 0.0 {
        ending = own;
        count = 1u;
    }
    var lasting = 0u;
    var last_ends = vec2(v, v);
    let from_h = start(v);
    var h = from_h;
    loop {
        let s = along(h);
        if s > 0.0 {
            if left_of(s, all) == 0.0 {
                ending += s;
                count += 1u;
            } else {
                if lasting < 2u {
                    last_ends[lasting] = target_of(h);
                }
                lasting += 1u;
            }
        }
        let back = prev(h);
        h = twin(back);
        if is_boundary(h) {
            if lasting < 2u {
                last_ends[lasting] = origin(back);
            }
            lasting += 1u;
            break;
        }
        if h == from_h {
            break;
        }
    }
    let after = part(less(own) > 0.0, lasting);
    let old = share_of(before);
    let new_ = share_of(after);
    if after == 1u && old.z > 0.0 {
        ends = last_ends;
    }
    let sharp = min(ending / f32(max(count, 1u)), 1.0);
    return Parts(select(new_, mix(new_, old, sharp), any(old != new_)), ends);
}

// By how much the edge of h is a crease in this step.
fn edge_share(h: u32) -> f32 {
    if is_boundary(twin(h)) {
        return 1.0;
    }
    if CREASED {
        let s = sharpness[h];
        if s > 0.0 {
            return select(s, 1.0, half(origin(h), s) > 0.0 && half(target_of(h), s) > 0.0);
        }
    }
    return 0.0;
}
