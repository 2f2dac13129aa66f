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

use limn_mesh::{Mesh, Refined, order};

/// The first vertex of level 0 at each position of the file; `u32::MAX` where there is none.
fn first(mesh: &Mesh) -> Vec<u32> {
    let mut first = vec![u32::MAX; mesh.weld_class.len()];
    for (v, &source) in (0u32..mesh.vertex_source.len() as u32).zip(&mesh.vertex_source).rev() {
        if let Some(slot) = first.get_mut(source as usize) {
            *slot = v;
        }
    }
    first
}

/// Vertices of level 0 in the order of the file that they came from, copies behind; empty if they lie so.
pub(crate) fn file_order(mesh: &Mesh) -> Vec<u32> {
    if mesh.face_source.is_sorted() {
        return Vec::new();
    }
    let first = first(mesh);
    let is_copy = |(v, source): &(u32, &u32)| first.get(**source as usize) != Some(v);
    let copies = (0u32..).zip(&mesh.vertex_source).filter(is_copy).map(|(v, _)| v);
    first.iter().copied().filter(|v| *v != u32::MAX).chain(copies).collect()
}

/// For every vertex of the level the vertex that it is a copy of (the lowest, itself if it is none); `None` if no vertex
/// has copies.
pub(crate) fn copies(refined: &Refined) -> Option<Vec<u32>> {
    let mesh = refined.mesh();
    let lowest = first(mesh);
    let mut same: Vec<u32> = (0..refined.points.len() as u32).collect();
    let mut any = false;
    for (v, &source) in (0u32..).zip(&mesh.vertex_source) {
        let Some(&first) = lowest.get(source as usize) else { continue };
        any |= first != v;
        join(refined, &mut same, v, first);
    }
    if !any {
        return None;
    }
    let next = boundary(refined);
    let steps = 1usize.checked_shl(refined.level)?;
    let source = |v: u32| mesh.vertex_source.get(v as usize).copied();
    // Chains that have been walked, by the positions of the file at their ends, lower first.
    let mut ends: Vec<(u64, u32)> = Vec::new();
    let mut chains: Vec<Vec<u32>> = Vec::new();
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
        ends.push((order::key(a.min(b), a.max(b)), chains.len() as u32));
        chains.push(chain);
    }
    order::sort(&mut ends);
    let chain = |end: &(u64, u32)| chains.get(end.1 as usize).into_iter().flatten();
    for run in ends.chunk_by(|a, b| a.0 == b.0) {
        let Some((first, others)) = run.split_first() else { continue };
        for other in others {
            chain(first).zip(chain(other)).for_each(|(&to, &v)| join(refined, &mut same, v, to));
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
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(corners.len());
    for f in 0..faces.count() {
        let face = corners.get(faces.range(f)).unwrap_or_default();
        let ends = face.iter().skip(1).chain(face.first());
        edges.extend(face.iter().zip(ends).map(|(&a, &b)| (order::key(a.min(b), a.max(b)), u32::from(a < b))));
    }
    order::sort(&mut edges);
    let mut next = vec![u32::MAX; refined.points.len()];
    for pair in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(ends, rising)] = *pair {
            let [low, high] = order::parts(ends);
            let (from, to) = if rising == 1 { (low, high) } else { (high, low) };
            if let Some(slot) = next.get_mut(from as usize) {
                *slot = to;
            }
        }
    }
    next
}
