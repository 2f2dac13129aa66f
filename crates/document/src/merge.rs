//! Putting back together what building a mesh took apart, on the way into a file.
//!
//! A mesh is manifold: edges with more than two faces are cut, and vertices where fans meet are split. The copies stay in one
//! place at every level, and a file should hold them once, as the model had them. Positions alone do not tell copies from
//! vertices that merely touch, so this goes by origin:
//!
//! ```text
//!   level 0   u ─────────── v     copies of an edge have the same two positions of the file behind them ...
//!   level 2   u ─ · ─ · ─ · ─ v   ... and at any level their boundaries run from u to v in as many steps: matched one by one
//! ```
//!
//! Vertices of level 0 keep their numbers at every level, which is what makes the walk find u and v. Cost: sorting the
//! level's edges; nothing where no vertex was split.

use std::collections::BTreeMap;

use limn_mesh::Refined;

/// For every vertex of the level the vertex that it is a copy of (the lowest, itself if it is none); `None` if no vertex
/// has copies.
pub(crate) fn copies(refined: &Refined) -> Option<Vec<u32>> {
    let mesh = refined.mesh();
    let mut lowest: BTreeMap<u32, u32> = BTreeMap::new();
    let mut same: Vec<u32> = (0..refined.points.len() as u32).collect();
    let mut any = false;
    for (v, &source) in mesh.vertex_source.iter().enumerate() {
        let first = *lowest.entry(source).or_insert(v as u32);
        any |= first != v as u32;
        join(refined, &mut same, v as u32, first);
    }
    if !any {
        return None;
    }
    let next = boundary(refined);
    let steps = 1usize.checked_shl(refined.level)?;
    let source = |v: u32| mesh.vertex_source.get(v as usize).copied();
    // Chains that have been walked, by the positions of the file at their ends, lower first.
    let mut chains: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    for start in 0..mesh.vertex_source.len() as u32 {
        let mut chain = vec![start];
        let mut at = start;
        for _ in 0..steps {
            let Some(v) = next.get(at as usize).copied().filter(|v| *v != u32::MAX) else { break };
            chain.push(v);
            at = v;
        }
        let (Some(a), Some(b)) = (source(start), source(at)) else { continue };
        if chain.len() != steps + 1 || a == b {
            continue;
        }
        if a > b {
            chain.reverse();
        }
        match chains.get(&(a.min(b), a.max(b))) {
            Some(first) => first.iter().zip(&chain).for_each(|(&to, &v)| join(refined, &mut same, v, to)),
            None => _ = chains.insert((a.min(b), a.max(b)), chain),
        }
    }
    Some(same)
}

/// Makes `v` a copy of what `first` is a copy of, if they are in the same place.
fn join(refined: &Refined, same: &mut [u32], v: u32, first: u32) {
    let bits = |v: u32| refined.points.get(v as usize).map(|p| p.map(f32::to_bits));
    let (Some(&a), Some(&b)) = (same.get(v as usize), same.get(first as usize)) else { return };
    if bits(v) == bits(first)
        && let Some(slot) = same.get_mut(a.max(b) as usize)
    {
        *slot = a.min(b);
    }
}

/// The next vertex along the boundary for every vertex of the level; `u32::MAX` for vertices inside.
fn boundary(refined: &Refined) -> Vec<u32> {
    let faces = &refined.faces;
    let corners = faces.corners();
    // Each edge with its lower vertex first, and which way round the face has it.
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(corners.len());
    for f in 0..faces.count() {
        let face = corners.get(faces.range(f)).unwrap_or_default();
        let ends = face.iter().skip(1).chain(face.first());
        edges.extend(face.iter().zip(ends).map(|(&a, &b)| (a.min(b), a.max(b), a < b)));
    }
    edges.sort_unstable();
    let mut next = vec![u32::MAX; refined.points.len()];
    for pair in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if let [(low, high, rising)] = *pair {
            let (from, to) = if rising { (low, high) } else { (high, low) };
            if let Some(slot) = next.get_mut(from as usize) {
                *slot = to;
            }
        }
    }
    next
}
