//! From polygons to the mesh that schemes refine: [`Mesh::build`] checks, welds, orients, splits and says what it did.
//!
//! ```text
//!   soup -> weld -> drop degenerate faces -> match and orient -> split vertices with several fans -> Mesh + Report
//! ```
//!
//! Nothing that a polygon soup can hold is refused but indices that do not exist, coordinates that are not finite numbers,
//! and no face at all. An edge with more than two faces is cut apart into boundaries; the copies of its vertices refine by
//! the boundary curve rule, which reads the same two neighbours on every sheet, so they stay equal to the last bit; so does
//! one that is a sheet's only face there (`joined`). A whole fan that touches inside a cut goes with the cut (`tied`). Where
//! that does not hold (ends of the cut, fans that meet in a point only) the copies are tagged sharp: every scheme keeps
//! them. That is OpenSubdiv's rule. Cost: linear in corners, 13 ns each in order. Invariants: [`crate::topology`].

use crate::FULL;
use crate::connect::{self, Matching};
use crate::marks;
use crate::plan::Step;
use crate::report::{Note, Report};
use crate::scattered;
use crate::soup::{NONE, Soup};
use crate::split::FaceShape;
use crate::topology::{Connectivity, Counts, Topology, is_boundary};
use crate::weld::{Weld, bounds, weld};

/// A topology with what lives on it. Immutable; shared behind an `Arc`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Half-edges; corner `h` of the faces kept is half-edge `h`.
    pub topology: Topology,
    /// One position a vertex.
    pub positions: Vec<[f32; 3]>,
    /// Linear RGBA, one a vertex; empty if the soup has none.
    pub colors: Vec<[f32; 4]>,
    /// Texture coordinates, if the soup has any.
    pub uv: Option<UvChannel>,
    /// Vertices that every scheme keeps where they are; empty if there are none.
    pub sharp: Vec<bool>,
    /// Vertices of one face that are no corners, whatever the boundary rule: both edges were cut from other faces, and the
    /// other copies follow the curve. Empty if there are none.
    pub joined: Vec<bool>,
    /// Copies inside a cut that have no boundary, each with the copy whose place it takes at every level.
    pub tied: Vec<[u32; 2]>,
    /// The sharpness of each edge, 0 smooth, from [`crate::marks::INFINITE`] on for ever; empty if all are smooth.
    pub edge_sharpness: Vec<f32>,
    /// The sharpness of each vertex; empty if all are smooth.
    pub vertex_sharpness: Vec<f32>,
    /// Faces that are refined and not shown; empty if there are none.
    pub holes: Vec<bool>,
    /// Knot intervals of half-edge `h`: at its origin toward its target in `2h`, at its target toward its origin in
    /// `2h + 1`; empty if all are 1.
    pub knots: Vec<f32>,
    /// The lowest position index of each vertex's class. Copies made by splitting share it. It rises up to them, unless
    /// the soup's faces lie in no order (`scattered.rs`).
    pub vertex_source: Vec<u32>,
    /// The soup's face behind each face; it rises, with the same exception.
    pub face_source: Vec<u32>,
    /// The lowest position index of the class of *every* position in the soup.
    pub weld_class: Vec<u32>,
    /// Whether some part has one side only (it was cut to be oriented).
    pub one_sided: bool,
    pub(crate) counts: Counts,
    pub(crate) shape: FaceShape,
}

/// Texture coordinates as a second vertex array on the same half-edges: where two faces disagree about an edge, the twin
/// is cut (a seam), so any scheme refines them by its own boundary rules.
#[derive(Clone, Debug, PartialEq)]
pub struct UvChannel {
    /// The same half-edges with seams cut; its vertices are texture coordinates.
    pub topology: Topology,
    /// One (u, v) for each of them, v up.
    pub values: Vec<[f32; 2]>,
    /// Counts of the half-edges.
    pub counts: Counts,
}

/// Why polygons are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TopologyError {
    /// There is nothing to draw.
    #[error("the model has no faces{}; drop a model with polygons", all_dropped(*.dropped))]
    NoFaces {
        /// Faces that were there but had fewer than three different corners.
        dropped: u64,
    },
    /// A corner names a position that does not exist.
    #[error("face {face} uses vertex {index}, but there are only {vertices} vertices (numbered from 0)")]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index.
        index: u32,
        /// How many positions there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The position's index.
        vertex: usize,
    },
    /// Arrays of the soup that do not fit together.
    #[error("the model's {what} do not match its faces")]
    Inconsistent {
        /// Which array.
        what: &'static str,
    },
    /// More than 2^31 - 1 corners or positions.
    #[error("the model has {corners} corners; at most 2,147,483,647 can be connected")]
    TooLarge {
        /// How many there are.
        corners: usize,
    },
}

fn all_dropped(n: u64) -> String {
    if n == 0 { String::new() } else { format!(" (all {n} have fewer than three different corners)") }
}

/// Facts about the shape that refinement does not change, and the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// Closed curves of boundary edges.
    pub boundary_loops: u64,
    /// Connected parts (through shared edges).
    pub components: u64,
    /// Sum of the genera of all parts, boundaries capped; none if a part has one side only.
    pub genus: Option<u64>,
    /// Smallest and largest coordinates of the vertices.
    pub bounds: [[f32; 3]; 2],
}

impl Mesh {
    /// Connects `soup`.
    ///
    /// # Errors
    /// [`TopologyError`]; the checks come before anything is built.
    pub fn build(soup: &Soup, how: Weld) -> Result<(Mesh, Report), TopologyError> {
        check(soup)?;
        let weld_class = weld(&soup.positions, &soup.parts, how);
        let mut notes = Vec::new();
        let welded = weld_class.iter().enumerate().filter(|(i, c)| *i as u32 != **c).count() as u64;
        note(&mut notes, welded, || Note::Welded { count: welded });
        let order = scattered::order(soup, &weld_class);
        let mut faces = Faces::clean(soup, &weld_class, order.as_deref());
        let isolated = isolated(soup, &weld_class);
        note(&mut notes, isolated.0, || Note::Isolated { count: isolated.0, first: isolated.1 });
        let Faces { degenerate, repaired, .. } = faces;
        note(&mut notes, degenerate.0, || Note::Degenerate { count: degenerate.0, first: degenerate.1 });
        note(&mut notes, repaired.0, || Note::Repaired { count: repaired.0, first: repaired.1 });
        if faces.source.is_empty() {
            return Err(TopologyError::NoFaces { dropped: degenerate.0 });
        }

        let positions = soup.positions.len();
        let class = order.map(|_| scattered::renumber(&mut faces.corners, positions));
        let mut m = connect::connect(&faces.offsets, &mut faces.corners, &mut faces.slots, positions);
        let (topology, mut vertex_source) =
            Topology::assemble(faces.offsets.clone(), &faces.corners, positions, &m.mate);
        if let Some(class) = class {
            for numbers in [&mut vertex_source[..], m.non_manifold.as_flattened_mut(), m.one_sided.as_flattened_mut()] {
                numbers.iter_mut().for_each(|v| *v = class[*v as usize]);
            }
        }
        let Ties { sharp, joined, tied, split } = tie(&topology, &vertex_source, soup.positions.len());
        report(&mut notes, &m, &faces, split);
        let marks::Resolved { edge_sharpness, vertex_sharpness, holes, knots } =
            marks::resolve(&soup.marks, &topology, &weld_class, &vertex_source, &faces.source, &mut notes);

        let positions = vertex_source.iter().map(|&s| soup.positions[s as usize]).collect();
        let colored = vertex_source.iter().filter(|_| !soup.colors.is_empty());
        let colors = colored.map(|&s| soup.colors[s as usize]).collect();
        let uv = (!soup.uvs.is_empty()).then(|| seams(soup, &topology, &faces, &m.mate));
        let one_sided = !m.one_sided.is_empty();
        let counts = topology.counts();
        let shape = match topology.uniform_degree() {
            Some(3) => FaceShape::Triangles,
            Some(4) => FaceShape::Quads,
            _ => FaceShape::Polygons,
        };
        let mesh = Mesh {
            topology,
            positions,
            colors,
            uv,
            sharp,
            joined,
            tied,
            edge_sharpness,
            vertex_sharpness,
            holes,
            knots,
            vertex_source,
            face_source: faces.source,
            weld_class,
            one_sided,
            counts,
            shape,
        };
        Ok((mesh, Report { notes }))
    }

    /// Puts what is tied in its place on a level, as long as all `steps` up to there keep vertices.
    pub(crate) fn tie<T: Copy>(&self, steps: &[Step], level: u32, values: &mut [T]) {
        if FULL && steps.iter().take(level as usize).all(|s| s.split.keeps_vertices()) {
            self.tied.iter().for_each(|&[v, leader]| values[v as usize] = values[leader as usize]);
        }
    }

    /// Counts of level 0.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Whether every face is a triangle.
    pub fn is_triangles(&self) -> bool {
        self.shape == FaceShape::Triangles
    }

    /// What its faces look like.
    pub fn face_shape(&self) -> FaceShape {
        self.shape
    }

    /// Facts about the shape. Cost: linear.
    pub fn stats(&self) -> Stats {
        let t = &self.topology;
        // Parts, by walking over twins.
        let mut part = vec![NONE; t.faces() as usize];
        let mut stack = Vec::new();
        let mut components = 0;
        for seed in 0..t.faces() {
            if part[seed as usize] != NONE {
                continue;
            }
            part[seed as usize] = components;
            stack.push(seed);
            while let Some(f) = stack.pop() {
                for h in t.face_half_edges(f) {
                    let twin = t.twin(h);
                    if !is_boundary(twin) && part[t.face(twin) as usize] == NONE {
                        part[t.face(twin) as usize] = components;
                        stack.push(t.face(twin));
                    }
                }
            }
            components += 1;
        }
        let mut boundary_loops = 0u64;
        let mut seen = vec![false; t.boundary.len()];
        for h in 0..t.half_edges() {
            let mut h = h;
            let mut fresh = false;
            while is_boundary(t.twin(h)) && !std::mem::replace(&mut seen[!t.twin(h) as usize], true) {
                fresh = true;
                // The next boundary side starts where this one ends.
                h = t.vertex_half_edge(t.origin(t.next(h)));
            }
            boundary_loops += u64::from(fresh);
        }
        // Sum over parts of 2 - 2g - b = chi.
        let twice = 2 * i64::from(components) - boundary_loops as i64 - self.counts.euler();
        let genus = (!self.one_sided).then_some((twice / 2) as u64);
        Stats { boundary_loops, components: components.into(), genus, bounds: bounds(&self.positions) }
    }
}

fn note(notes: &mut Vec<Note>, count: u64, make: impl FnOnce() -> Note) {
    if count > 0 {
        notes.push(make());
    }
}

fn check(soup: &Soup) -> Result<(), TopologyError> {
    let corners = soup.corners.len();
    if corners.max(soup.positions.len()) > (u32::MAX >> 1) as usize {
        return Err(TopologyError::TooLarge { corners });
    }
    let ends_well = soup.offsets.first().is_none_or(|&o| o == 0)
        && soup.offsets.last().map_or(0, |&o| o as usize) == corners
        && soup.offsets.is_sorted();
    let fits = |len: usize, want: usize| len == 0 || len == want;
    for (ok, what) in [
        (ends_well, "face offsets"),
        (fits(soup.parts.len(), soup.positions.len()), "parts"),
        (fits(soup.colors.len(), soup.positions.len()), "vertex colours"),
        (fits(soup.uv_corners.len(), corners), "texture coordinates"),
        (fits(soup.face_groups.len(), soup.face_count()), "groups"),
        (fits(soup.face_materials.len(), soup.face_count()), "materials"),
        (soup.uv_corners.iter().all(|&i| i == NONE || (i as usize) < soup.uvs.len()), "texture coordinate indices"),
    ] {
        if !ok {
            return Err(TopologyError::Inconsistent { what });
        }
    }
    if let Some(vertex) = soup.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(TopologyError::NotFinite { vertex });
    }
    let vertices = soup.positions.len();
    if let Some(c) = soup.corners.iter().position(|&v| v as usize >= vertices) {
        let face = soup.offsets.partition_point(|&o| o as usize <= c) - 1;
        return Err(TopologyError::IndexOutOfRange { face, index: soup.corners[c], vertices });
    }
    Ok(())
}

fn isolated(soup: &Soup, class: &[u32]) -> (u64, u32) {
    let mut used = vec![false; soup.positions.len()];
    for &v in &soup.corners {
        used[class[v as usize] as usize] = true;
    }
    let mut unused = class.iter().enumerate().filter(|(_, c)| !used[**c as usize]).map(|(i, _)| i as u32);
    let first = unused.next();
    first.map_or((0, 0), |f| (1 + unused.count() as u64, f))
}

/// The faces that are kept, by classes; `slots` says which corner of the soup each corner is.
struct Faces {
    offsets: Vec<u32>,
    corners: Vec<u32>,
    slots: Vec<u32>,
    source: Vec<u32>,
    degenerate: (u64, u32),
    repaired: (u64, u32),
}

impl Faces {
    fn clean(soup: &Soup, class: &[u32], order: Option<&[u32]>) -> Faces {
        let n = soup.corners.len();
        let mut out = Faces {
            offsets: Vec::with_capacity(soup.face_count() + 1),
            corners: Vec::with_capacity(n),
            slots: Vec::with_capacity(n),
            source: Vec::with_capacity(soup.face_count()),
            degenerate: (0, 0),
            repaired: (0, 0),
        };
        out.offsets.push(0);
        let first = |&f: &u32| soup.corners.get(soup.offsets[f as usize] as usize).map(|&v| class[v as usize]);
        for f in 0..soup.face_count() {
            // Faces in no order lie anywhere: some are fetched before the first of them is waited for.
            if let Some(order) = order.filter(|_| FULL && f.is_multiple_of(32)) {
                order[f..].iter().take(32).for_each(|f| _ = std::hint::black_box(first(f)));
            }
            let f = order.map_or(f, |order| order[f] as usize);
            let start = out.corners.len();
            for c in soup.face_range(f) {
                let v = class[soup.corners[c] as usize];
                out.push(start, v, c as u32);
            }
            // The same two rules across the end of the loop.
            loop {
                let len = out.corners.len() - start;
                if len >= 2 && out.corners[start] == out.corners[start + len - 1] {
                    out.pop();
                } else if len >= 3 && out.corners[start + 1] == out.corners[start + len - 1] {
                    // A spike at the first corner: a b .. b.
                    out.corners.remove(start);
                    out.slots.remove(start);
                } else if len >= 3 && out.corners[start] == out.corners[start + len - 2] {
                    out.pop(); // a spike at the last corner
                } else {
                    break;
                }
            }
            let kept = out.corners.len() - start;
            if kept < 3 {
                out.corners.truncate(start);
                out.slots.truncate(start);
                count(&mut out.degenerate, f);
                continue;
            }
            if kept < soup.face_range(f).len() {
                count(&mut out.repaired, f);
            }
            out.offsets.push(out.corners.len() as u32);
            out.source.push(f as u32);
        }
        out
    }

    /// Appends a corner, unless it repeats the last one or turns back on the one before (a spike).
    fn push(&mut self, start: usize, v: u32, slot: u32) {
        let len = self.corners.len();
        if len > start && self.corners[len - 1] == v {
            return;
        }
        if len >= start + 2 && self.corners[len - 2] == v {
            self.pop();
            return;
        }
        self.corners.push(v);
        self.slots.push(slot);
    }

    fn pop(&mut self) {
        self.corners.pop();
        self.slots.pop();
    }
}

fn count(tally: &mut (u64, u32), f: usize) {
    tally.1 = if tally.0 == 0 { f as u32 } else { tally.1.min(f as u32) };
    tally.0 += 1;
}

/// What keeps copies of split vertices together: those that must be sharp, may not be corners, and take the place of others;
/// and how many positions were split.
#[derive(Default)]
struct Ties {
    sharp: Vec<bool>,
    joined: Vec<bool>,
    tied: Vec<[u32; 2]>,
    split: (u64, u32),
}

fn tie(t: &Topology, source: &[u32], positions: usize) -> Ties {
    let mut copies = vec![0u8; positions];
    for &s in source {
        copies[s as usize] = copies[s as usize].saturating_add(1);
    }
    let split = copies.iter().filter(|&&c| c > 1).count() as u64;
    if split == 0 {
        return Ties::default();
    }
    let first = copies.iter().position(|&c| c > 1).unwrap_or(0) as u32;
    // A copy's boundary neighbours, smaller source first; NONE twice where there are none.
    let mut seen: Vec<Option<[u32; 2]>> = vec![None; positions];
    let mut apart = vec![false; positions];
    let mut lone = vec![false; source.len()];
    // The copies with a boundary, up to three, and the last of them; and those without.
    let (mut sheets, mut last, mut closed) = (vec![0u8; positions], vec![NONE; positions], Vec::new());
    for (v, &s) in source.iter().enumerate().filter(|(_, s)| copies[**s as usize] > 1) {
        let mut faces = 0;
        let mut pair = [NONE; 2];
        if let Some(last) = t.turn(v as u32, |_| faces += 1) {
            let a = source[t.origin(t.next(t.vertex_half_edge(v as u32))) as usize];
            let b = source[t.origin(last) as usize];
            pair = [a.min(b), a.max(b)];
            lone[v] = faces == 1;
        }
        if pair == [NONE; 2] {
            closed.push(v as u32);
            continue;
        }
        let known = *seen[s as usize].get_or_insert(pair);
        apart[s as usize] |= known != pair;
        sheets[s as usize] = (sheets[s as usize] + 1).min(3);
        last[s as usize] = v as u32;
    }
    // On a rim, or without any, they meet in a point only.
    closed.iter().map(|&v| source[v as usize] as usize).for_each(|s| apart[s] |= sheets[s] < 3);
    let leader = |&v: &u32| [v, last[source[v as usize] as usize]];
    let tied = closed.iter().map(leader).filter(|t| !apart[source[t[0] as usize] as usize]).collect();
    lone.iter_mut().zip(source).for_each(|(lone, &s)| *lone &= !apart[s as usize]);
    let joined = if lone.contains(&true) { lone } else { Vec::new() };
    let sharp = source.iter().map(|&s| apart[s as usize]).collect();
    Ties { sharp, joined, tied, split: (split, first) }
}

fn report(notes: &mut Vec<Note>, m: &Matching, faces: &Faces, split: (u64, u32)) {
    if let Some(first) = m.turned.iter().map(|&f| faces.source[f as usize]).min() {
        notes.push(Note::Turned { count: m.turned.len() as u64, first });
    }
    if let Some(first) = m.non_manifold.iter().map(|&[a, b]| [a.min(b), a.max(b)]).min() {
        notes.push(Note::NonManifoldEdges { count: m.non_manifold.len() as u64, first });
    }
    if let Some(&first) = m.one_sided.first() {
        notes.push(Note::OneSided { count: m.one_sided.len() as u64, first });
    }
    // Splits along cut edges are already told by the edges.
    if m.non_manifold.is_empty() && m.one_sided.is_empty() {
        note(notes, split.0, || Note::NonManifoldVertices { count: split.0, first: split.1 });
    }
}

/// The texture coordinates as a second vertex array: equal values around a vertex are one, differing ones cut the edge.
fn seams(soup: &Soup, t: &Topology, faces: &Faces, mate: &[u32]) -> UvChannel {
    let corner_uv = |h: usize| soup.uv_corners.get(faces.slots[h] as usize).copied().unwrap_or(NONE);
    let value = |h: usize| soup.uvs.get(corner_uv(h) as usize).copied().unwrap_or([0.0; 2]);
    let same = |a: usize, b: usize| {
        (corner_uv(a) == NONE) == (corner_uv(b) == NONE) && value(a).map(|x| x + 0.0) == value(b).map(|x| x + 0.0)
    };
    let mut cut = mate.to_vec();
    for h in 0..t.half_edges() {
        let twin = t.twin(h);
        if !is_boundary(twin) {
            let (h, twin) = (h as usize, twin as usize);
            let (hn, tn) = (t.next(h as u32) as usize, t.next(twin as u32) as usize);
            if !(same(h, tn) && same(hn, twin)) {
                (cut[h], cut[twin]) = (connect::UNMATCHED, connect::UNMATCHED);
            }
        }
    }
    // Fans of the cut half-edges are the texture vertices; all fans of one vertex begin as one class.
    let (topology, _) = Topology::assemble(faces.offsets.clone(), t.origins(), t.vertices() as usize, &cut);
    let values = topology.vertex_half_edge.iter().map(|&h| value(h as usize)).collect();
    let counts = topology.counts();
    UvChannel { topology, values, counts }
}
