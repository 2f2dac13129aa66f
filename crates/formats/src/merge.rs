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

use limn_mesh::order;

use crate::{Export, ExportFaces, Origin};

/// The first vertex of level 0 at each position of the file; `u32::MAX` where there is none.
fn first(origin: &Origin<'_>) -> Vec<u32> {
    let mut first = vec![u32::MAX; origin.positions as usize];
    for (v, &source) in (0u32..origin.sources.len() as u32).zip(origin.sources).rev() {
        if let Some(slot) = first.get_mut(source as usize) {
            *slot = v;
        }
    }
    first
}

/// Vertices of level 0 in the order of the file that they came from, copies behind; empty if they lie so.
fn file_order(origin: &Origin<'_>) -> Vec<u32> {
    if origin.in_order {
        return Vec::new();
    }
    let first = first(origin);
    let is_copy = |(v, source): &(u32, &u32)| first.get(**source as usize) != Some(v);
    let copies = (0u32..).zip(origin.sources).filter(is_copy).map(|(v, _)| v);
    first.iter().copied().filter(|v| *v != u32::MAX).chain(copies).collect()
}

/// For every vertex of the level the vertex that it is a copy of (the lowest, itself if it is none); `None` if no vertex
/// has copies.
fn copies(export: &Export<'_>, origin: &Origin<'_>) -> Option<Vec<u32>> {
    let lowest = first(origin);
    let mut same: Vec<u32> = (0..export.points.len() as u32).collect();
    let mut any = false;
    for (v, &source) in (0u32..).zip(origin.sources) {
        let Some(&first) = lowest.get(source as usize) else { continue };
        any |= first != v;
        join(export, &mut same, v, first);
    }
    if !any {
        return None;
    }
    let next = boundary(export);
    let steps = 1usize.checked_shl(origin.level)?;
    let source = |v: u32| origin.sources.get(v as usize).copied();
    // Chains that have been walked, by the positions of the file at their ends, lower first.
    let mut ends: Vec<(u64, u32)> = Vec::new();
    let mut chains: Vec<Vec<u32>> = Vec::new();
    for start in 0..origin.sources.len() as u32 {
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
            chain(first).zip(chain(other)).for_each(|(&to, &v)| join(export, &mut same, v, to));
        }
    }
    Some(same)
}

/// Makes `v` a copy of what `first` is a copy of, if they are in the same place.
fn join(export: &Export<'_>, same: &mut [u32], v: u32, first: u32) {
    let bits = |v: u32| export.points.get(v as usize).map(|p| p.map(f32::to_bits));
    let (Some(&a), Some(&b)) = (same.get(v as usize), same.get(first as usize)) else { return };
    if bits(v) == bits(first)
        && let Some(slot) = same.get_mut(a.max(b) as usize)
    {
        *slot = a.min(b);
    }
}

/// The next vertex along the boundary for every vertex of the level; `u32::MAX` for vertices inside.
fn boundary(export: &Export<'_>) -> Vec<u32> {
    let faces = &export.faces;
    let corners = faces.corners();
    // Each edge with its lower vertex first, and which way round the face has it.
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(corners.len());
    for f in 0..faces.count() {
        let face = faces.face(f);
        let ends = face.iter().skip(1).chain(face.first());
        edges.extend(face.iter().zip(ends).map(|(&a, &b)| (order::key(a.min(b), a.max(b)), u32::from(a < b))));
    }
    order::sort(&mut edges);
    let mut next = vec![u32::MAX; export.points.len()];
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

/// A level whose copies of split vertices are one again, and whose first vertices are those of the file.
pub(crate) struct Merged {
    points: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    colors: Vec<[f32; 4]>,
    corners: Vec<u32>,
}

impl Merged {
    /// None where everything is as it is written already. Its corners are checked before.
    pub(crate) fn of(export: &Export<'_>) -> Option<Merged> {
        let origin = export.origin.as_ref()?;
        let (same, first) = (copies(export, origin), file_order(origin));
        if same.is_none() && first.is_empty() {
            return None;
        }
        let all = export.points.len() as u32;
        let same = same.unwrap_or_else(|| (0..all).collect());
        let is_kept = |&v: &u32| same.get(v as usize) == Some(&v);
        let rest = first.len() as u32..all;
        let kept: Vec<u32> = first.into_iter().chain(rest).filter(is_kept).collect();
        let mut number = vec![0; same.len()];
        for (&v, i) in kept.iter().zip(0..) {
            if let Some(slot) = number.get_mut(v as usize) {
                *slot = i;
            }
        }
        let of = |c: &u32| same.get(*c as usize).and_then(|&v| number.get(v as usize)).copied().unwrap_or_default();
        Some(Merged {
            points: keep(&kept, export.points),
            // Copies keep normals of their own while they are drawn; in a file the first one's has to do.
            normals: export.normals.map(|normals| keep(&kept, normals)),
            colors: keep(&kept, export.colors),
            corners: export.faces.corners().iter().map(of).collect(),
        })
    }

    /// The export with these in place of its own.
    pub(crate) fn export<'a>(&'a self, export: &Export<'a>) -> Export<'a> {
        let corners = &self.corners[..];
        let faces = match export.faces {
            ExportFaces::Polygons { offsets, .. } => ExportFaces::Polygons { offsets, corners },
            ExportFaces::Triangles(_) => ExportFaces::Triangles(corners),
            ExportFaces::Quads(_) => ExportFaces::Quads(corners),
        };
        let (points, normals, colors) = (&self.points[..], self.normals.as_deref(), &self.colors[..]);
        Export { points, normals, colors, faces, origin: None, ..*export }
    }
}

fn keep<T: Copy>(kept: &[u32], values: &[T]) -> Vec<T> {
    kept.iter().filter_map(|&v| values.get(v as usize).copied()).collect()
}
