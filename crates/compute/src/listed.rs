//! What is drawn of a level whose faces are listed, because no arithmetic gives them: normals, indices or corners, what corners carry.
//!
//! ```text
//!   faces ──► a normal each ──► summed around vertices ──► triangles: corners with both
//!                                                           \ texture coordinates and colours, made once on the CPU
//! ```
//!
//! Texture coordinates and colours do not move with the cage, so they come from the level that the CPU made, by whatever rules. Triangles
//! lie in the order of their parts, so that a part is one run. Cost: linear in the level.

use crate::Error;
use crate::finish::{Drawn, Piece};
use crate::kernels::{Kernel, Level};
use crate::program::{Builder, Dispatch, Id};
use limn_layout::Error as Data;
use limn_layout::corners::edge_flags;
use limn_mesh::{Faces, Refined, triangulate};

/// The faces around every vertex: where each run begins and ends, and the faces.
fn around(faces: &Faces, vertices: u32) -> Result<(Vec<u32>, Vec<u32>), Error> {
    let mut turns = vec![0u32; vertices as usize + 2];
    for (corner, &v) in (0..).zip(faces.corners()) {
        match turns.get_mut(v as usize + 2) {
            Some(n) if v < vertices => *n += 1,
            _ => return Err(Data::Index { corner, index: v, vertices: vertices.into() }.into()),
        }
    }
    for v in 2..turns.len() {
        turns[v] += turns[v - 1];
    }
    let mut spokes = vec![0u32; faces.corners().len()];
    for f in 0..faces.count() {
        for &v in faces.face(f) {
            // Where the next of v goes; in the end every run's start has moved to its end.
            let at = &mut turns[v as usize + 1];
            if let Some(slot) = spokes.get_mut(*at as usize) {
                *slot = f as u32;
            }
            *at += 1;
        }
    }
    turns.truncate(vertices as usize + 1);
    Ok((turns, spokes))
}

/// Faces in the order in which they are drawn, and runs of parts among them.
fn in_order(level: &Refined, parts: &[u32]) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut order: Vec<u32> = (0..level.faces.count() as u32).collect();
    let mut runs: Vec<[u32; 2]> = Vec::new();
    if parts.is_empty() {
        return (order, runs);
    }
    let part = |f: u32| parts.get(level.face_source(f) as usize).copied().unwrap_or(0);
    order.sort_by_cached_key(|&f| part(f));
    for &f in &order {
        match runs.last_mut() {
            Some(last) if last[0] == part(f) => last[1] += 1,
            _ => runs.push([part(f), 1]),
        }
    }
    (order, runs)
}

/// The triangles of a level.
#[derive(Default)]
struct Triangles {
    /// Three vertices, the face, and the bits of its edges.
    table: Vec<[u32; 5]>,
    /// The places of its corners in [`Faces::corners`].
    corners: Vec<[u32; 3]>,
    /// Runs of parts, by triangles.
    runs: Vec<[u32; 2]>,
}

impl Triangles {
    /// Polygons are cut as where the CPU draws them: by its points.
    fn of(level: &Refined, order: &[u32], face_runs: &[[u32; 2]]) -> Triangles {
        let mut all = Triangles::default();
        let (parents, mut cut) = (level.parents(), Vec::new());
        let is_split = matches!(level.faces, Faces::Quads(_)) && parents.is_some();
        let mut ends = face_runs.iter().scan(0, |sum, run| {
            *sum += run[1] as usize;
            Some((*sum, run[0]))
        });
        let mut run = ends.next();
        for (i, &f) in (1..).zip(order) {
            let range = level.faces.range(f as usize);
            let polygon = level.faces.face(f as usize);
            let n = polygon.len();
            cut.clear();
            match n {
                4 if is_split => cut.extend([[0, 1, 2], [0, 2, 3]]),
                _ => triangulate(&level.points, polygon, &mut cut),
            }
            let kind = level.kinds.get(f as usize).map_or(0, |&kind| kind as u32 + 1) << 6;
            for local in cut.iter().take(n.saturating_sub(2)) {
                let [Some(&a), Some(&b), Some(&c)] = local.map(|l| polygon.get(l as usize)) else { continue };
                let flags = edge_flags(*local, [a, b, c], n as u32, parents) | kind;
                all.table.push([a, b, c, f, flags]);
                all.corners.push(local.map(|l| range.start as u32 + l));
            }
            if let Some((_, part)) = run.filter(|&(end, _)| end == i) {
                let before: u32 = all.runs.iter().map(|run| run[1]).sum();
                all.runs.push([part, all.table.len() as u32 - before]);
                run = ends.next();
            }
        }
        all
    }

    /// Texture coordinates and a colour for each corner of a triangle: 9 words.
    fn extras(&self, level: &Refined, range: std::ops::Range<usize>) -> Vec<u32> {
        let mut words = Vec::with_capacity(9 * range.len());
        let (table, corners) = (self.table.get(range.clone()), self.corners.get(range));
        for (&[a, b, c, ..], corners) in table.unwrap_or(&[]).iter().zip(corners.unwrap_or(&[])) {
            for (v, corner) in [a, b, c].into_iter().zip(corners) {
                let value = |uv: &limn_mesh::UvValues| {
                    let at = uv.corners.get(*corner as usize)?;
                    uv.values.get(*at as usize).copied()
                };
                let [u, v_up] = level.uv.as_ref().and_then(value).unwrap_or_default();
                let color = level.colors.get(v as usize).map_or([255; 4], |&c| limn_layout::pack::color(c));
                words.extend([u.to_bits(), v_up.to_bits(), u32::from_le_bytes(color)]);
            }
        }
        words
    }
}

/// The last dispatches of a program, from `count` vertices to what is drawn of the faces of `level`; and its runs of parts. `limit`: the tangents
/// of vertices, and the points that they are of.
pub(crate) fn drawn(
    builder: &mut Builder,
    (level, parts): (&Refined, &[u32]),
    (points, count): (Id, u32),
    limit: Option<([Id; 2], Id)>,
    each: &mut Vec<Dispatch>,
) -> Result<(Drawn, Vec<[u32; 2]>), Error> {
    let all = &level.faces;
    let (turns, spokes) = around(all, count)?;
    let faces = all.count() as u32;
    let offsets: Vec<u32> = match all {
        Faces::Triangles(_) => (0..=faces).map(|f| 3 * f).collect(),
        Faces::Quads(_) => (0..=faces).map(|f| 4 * f).collect(),
        Faces::Polygons { offsets, .. } => offsets.to_vec(),
    };
    let read = [
        builder.filled("faces", &[&offsets])?,
        builder.filled("corners", &[all.corners()])?,
        builder.filled("turns", &[&turns])?,
        builder.filled("spokes", &[&spokes])?,
    ];
    let normals = builder.make("normals", 16 * u64::from(faces), crate::program::Role::Work)?;
    for (kernel, end) in [(Kernel::ListedFaces, faces), (Kernel::ListedNormals, count)] {
        each.extend(builder.step(kernel, &Level { end, ..Level::default() }, &read, &[points, normals]));
    }
    if let Some((tangents, before)) = limit {
        let numbers = Level { end: count, ..Level::default() };
        each.extend(builder.step(Kernel::LimitNormals, &numbers, &tangents, &[before, points]));
    }
    let (order, runs) = in_order(level, parts);
    let fill = |builder: &mut Builder, id: Id, words: Vec<u32>| {
        if let Some(buffer) = builder.buffers.get_mut(id as usize) {
            buffer.contents = bytemuck::cast_slice(&words).to_vec();
        }
    };
    let carries = [level.uv.is_some(), !level.colors.is_empty()];
    let of_piece = |piece: &Piece| piece.faces.start as usize..piece.faces.end as usize;
    if let (Faces::Quads(quads), Some(kinds), [false, false]) = (all, level.parents(), carries) {
        let drawn = Drawn::fused(builder, false, kinds, order.len() as u64, carries)?;
        for piece in drawn.pieces() {
            let mine = order.get(of_piece(piece)).unwrap_or(&[]);
            let quad = |&f: &u32| quads.get(4 * f as usize..4 * f as usize + 4);
            let indices = mine.iter().filter_map(quad).flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]]);
            fill(builder, piece.buffer, indices.collect());
        }
        return Ok((drawn, runs.into_iter().map(|[part, quads]| [part, 6 * quads]).collect()));
    }
    let triangles = Triangles::of(level, &order, &runs);
    let drawn = Drawn::fused(builder, true, [0; 2], triangles.table.len() as u64, carries)?;
    for piece in drawn.pieces() {
        let mine = triangles.table.get(of_piece(piece)).unwrap_or(&[]);
        let table = builder.filled("triangles", &[mine])?;
        let [a, b, c, d] = read;
        let numbers = Level { end: mine.len() as u32, ..Level::default() };
        let work = [points, normals, piece.buffer];
        each.extend(builder.step(Kernel::ListedCorners, &numbers, &[a, b, c, d, table], &work));
        if let Some(extra) = piece.extra {
            fill(builder, extra, triangles.extras(level, of_piece(piece)));
        }
    }
    Ok((drawn, triangles.runs.iter().map(|&[part, n]| [part, 3 * n]).collect()))
}
