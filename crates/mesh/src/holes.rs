//! Holes: faces that are refined by the usual rules and not shown.
//!
//! ```text
//!   level 0    f0  f1  f2  f3        source of f2: none, for it is a hole
//!   level 1    . . | . . | - - | . .  none of its children is listed; their vertices stay, for ids may not change
//! ```
//!
//! Level by level every face knows the mesh's face behind it, or [`NONE`] if that is hidden: the children of what is hidden
//! are. A face that a split makes of an edge or a vertex is hidden where any of the faces around it is. Cost: linear,
//! and only where there are holes.

use crate::FULL;
use crate::marks::INFINITE;
use crate::mesh::Mesh;
use crate::order::{key, sort_keys};
use crate::refined::{Faces, Refined};
use crate::scheme::Boundary;
use crate::soup::NONE;
use crate::split::stored::Cut;
use crate::split::{FaceKind, Split};
use crate::topology::{Connectivity, Topology, is_boundary};

/// The mesh's face behind each face of level 0, [`NONE`] for its holes and, if the boundary rule is [`Boundary::None`], for
/// faces that touch the rim; but for rims whose edges are marked as infinitely sharp. Empty if all faces are shown.
pub(crate) fn sources(mesh: &Mesh, boundary: Boundary) -> Vec<u32> {
    if !FULL {
        return Vec::new();
    }
    let t = &mesh.topology;
    let mut hidden = mesh.holes.clone();
    if boundary == Boundary::None && t.boundary_half_edges() > 0 {
        hidden.resize(t.faces() as usize, false);
        // By positions, which copies of a vertex share. Edges that were cut apart are no rim: they are there twice or more.
        let sides = |h: u32| {
            let [a, b] = [h, t.next(h)].map(|h| mesh.vertex_source[t.origin(h) as usize]);
            key(a.min(b), a.max(b))
        };
        let mut all: Vec<u64> = (0..t.boundary_half_edges()).map(|r| sides(t.boundary_half_edge(r))).collect();
        sort_keys(&mut all);
        let mut touches = vec![false; mesh.weld_class.len()];
        for h in (0..t.boundary_half_edges()).map(|r| t.boundary_half_edge(r)) {
            let first = all.partition_point(|&k| k < sides(h));
            let cut = all.get(first + 1) == Some(&sides(h));
            let sharp = mesh.edge_sharpness.get(t.edge(h) as usize).is_some_and(|&s| s >= INFINITE);
            if !cut && !sharp {
                for end in [h, t.next(h)] {
                    touches[mesh.vertex_source[t.origin(end) as usize] as usize] = true;
                }
            }
        }
        for h in 0..t.half_edges() {
            hidden[t.face(h) as usize] |= touches[mesh.vertex_source[t.origin(h) as usize] as usize];
        }
    }
    if !hidden.contains(&true) {
        return Vec::new();
    }
    hidden.iter().zip(0..).map(|(&hidden, f)| if hidden { NONE } else { f }).collect()
}

/// The mesh's face behind each of a level's faces, from `parents` and what is behind those (empty if that is the same).
pub(crate) fn descend(before: &[u32], mut parents: Vec<u32>) -> Vec<u32> {
    if !before.is_empty() {
        parents.iter_mut().for_each(|f| *f = before[*f as usize]);
    }
    parents
}

/// Hides what lies across an edge or around a vertex of a hidden face. `before` is what is behind the faces of `parent`,
/// `source` what is behind those of `cut`, which `split` makes of them.
pub(crate) fn hide_between(parent: &Topology, split: Split, before: &[u32], cut: &Cut, source: &mut [u32]) {
    if !FULL || !before.contains(&NONE) || cut.kinds.is_empty() {
        return;
    }
    let hidden = |h: u32| before[parent.face(h) as usize] == NONE;
    // The image of a corner tells its face, that of an edge both of its faces; kept corners have neighbours that do.
    let hides = |&v: &u32| match split {
        Split::MidEdge { .. } if v < parent.edges() => {
            let h = parent.edge_half_edge(v);
            hidden(h) || !is_boundary(parent.twin(h)) && hidden(parent.twin(h))
        }
        Split::Dual { .. } if v < parent.half_edges() => hidden(v),
        _ => false,
    };
    for (i, face) in source.iter_mut().enumerate().filter(|(i, _)| cut.kinds[*i] != FaceKind::Face) {
        if cut.corners[cut.offsets[i] as usize..cut.offsets[i + 1] as usize].iter().any(hides) {
            *face = NONE;
        }
    }
}

/// Leaves hidden faces out of a level.
pub(crate) fn leave_out(level: &mut Refined) {
    let source = &level.source;
    if !FULL || !source.contains(&NONE) {
        return;
    }
    let keep = |values: &mut Vec<u32>, faces: &Faces| {
        let mut kept = 0;
        for (f, _) in source.iter().enumerate().filter(|(_, s)| **s != NONE) {
            let range = faces.range(f);
            let length = range.len();
            values.copy_within(range, kept);
            kept += length;
        }
        values.truncate(kept);
    };
    if let Some(uv) = &mut level.uv {
        keep(&mut uv.corners, &level.faces);
    }
    let mut corners = level.faces.corners().to_vec();
    keep(&mut corners, &level.faces);
    level.faces = match &level.faces {
        Faces::Triangles(_) => Faces::Triangles(corners),
        Faces::Quads(_) => Faces::Quads(corners),
        faces @ Faces::Polygons { .. } => {
            let mut offsets = vec![0];
            for (f, _) in source.iter().enumerate().filter(|(_, s)| **s != NONE) {
                offsets.push(offsets[offsets.len() - 1] + faces.range(f).len() as u32);
            }
            Faces::Polygons { offsets, corners }
        }
    };
    let mut shown = source.iter().map(|&s| s != NONE);
    level.kinds.retain(|_| shown.next().unwrap_or(true));
    level.hidden = source.iter().filter(|&&s| s == NONE).count() as u64;
    level.source.retain(|&s| s != NONE);
}
