//! Marks on a mesh: creases, corners, holes and knots, from the soup's numbers to those of half-edges.
//!
//! ```text
//!   creases ([a, b], s)   ──>  edge_sharpness[e]      every edge that joins a copy of a with a copy of b
//!   corners (v, s)        ──>  vertex_sharpness[v]    every copy
//!   holes    f            ──>  holes[f]
//!   knots   ([a, b], d)   ──>  knots[2h], [2h + 1]    half-edge h from a to b: the interval at a, and that at b
//! ```
//!
//! An array stays empty while nothing is marked, which is what rules ask first. Cost: linear where there are marks, plus the
//! valence for each.

use crate::mesh::Mesh;
use crate::report::Note;
use crate::soup::{Marks, NONE};
use crate::topology::{Connectivity, Topology, is_boundary};

/// From this sharpness on an edge or vertex is infinitely sharp: it never softens.
pub const INFINITE: f32 = 10.0;

/// The marks of a mesh's own elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Resolved {
    pub edge_sharpness: Vec<f32>,
    pub vertex_sharpness: Vec<f32>,
    pub holes: Vec<bool>,
    pub knots: Vec<f32>,
}

/// Finds what `marks` name. `class` is the class of every position, `vertex_class` that of every vertex, `face_source` the
/// soup's face behind each face.
pub(crate) fn resolve(
    marks: &Marks,
    t: &Topology,
    class: &[u32],
    vertex_class: &[u32],
    face_source: &[u32],
    notes: &mut Vec<Note>,
) -> Resolved {
    let mut out = Resolved::default();
    if marks.is_empty() {
        return out;
    }
    // The copies of a class as a chain: its first vertex, and the next copy of each vertex.
    let mut first = vec![NONE; class.len()];
    let mut next = vec![NONE; vertex_class.len()];
    for (v, &c) in vertex_class.iter().enumerate().rev() {
        next[v] = std::mem::replace(&mut first[c as usize], v as u32);
    }
    let copies = |position: u32| {
        let class = class.get(position as usize).copied().unwrap_or(NONE);
        let start = first.get(class as usize).copied().unwrap_or(NONE);
        std::iter::successors((start != NONE).then_some(start), |&v| Some(next[v as usize]).filter(|&n| n != NONE))
    };
    // Every half-edge between copies of the two, and whether it runs from the first to the second.
    let between = |[a, b]: [u32; 2], mark: &mut dyn FnMut(u32, bool)| {
        let target = class.get(b as usize).copied().unwrap_or(NONE);
        for v in copies(a) {
            t.turn(v, |h| {
                if vertex_class[t.origin(t.next(h)) as usize] == target {
                    mark(h, true);
                }
                if vertex_class[t.origin(t.prev(h)) as usize] == target {
                    mark(t.prev(h), false);
                }
            });
        }
    };
    let mut lost: (u64, [u32; 2]) = (0, [0; 2]);
    let mut lose = |found: bool, what: [u32; 2]| {
        if !found {
            lost = if lost.0 == 0 { (1, what) } else { (lost.0 + 1, lost.1) };
        }
    };
    for &(ends, sharpness) in &marks.creases {
        let mut found = false;
        between(ends, &mut |h, _| {
            fill(&mut out.edge_sharpness, t.edges() as usize, 0.0)[t.edge(h) as usize] = sharpness.max(0.0);
            found = true;
        });
        lose(found, ends);
    }
    for &(v, sharpness) in &marks.corners {
        let mut found = false;
        for v in copies(v) {
            fill(&mut out.vertex_sharpness, t.vertices() as usize, 0.0)[v as usize] = sharpness.max(0.0);
            found = true;
        }
        lose(found, [v; 2]);
    }
    for &(ends, interval) in &marks.knots {
        let mut found = false;
        between(ends, &mut |h, forward| {
            let knots = fill(&mut out.knots, 2 * t.half_edges() as usize, 1.0);
            knots[2 * h as usize + usize::from(!forward)] = interval.max(0.0);
            found = true;
        });
        lose(found, ends);
    }
    if !marks.holes.is_empty() {
        let mut holes = vec![false; face_source.len()];
        let last = face_source.iter().max().map_or(0, |&f| f as usize);
        let mut face_of = vec![NONE; last + 1];
        face_source.iter().zip(0..).for_each(|(&f, face)| face_of[f as usize] = face);
        for &f in &marks.holes {
            let hole = face_of.get(f as usize).and_then(|&face| holes.get_mut(face as usize));
            lose(hole.is_some(), [f, NONE]);
            if let Some(hole) = hole {
                *hole = true;
            }
        }
        if holes.contains(&true) {
            out.holes = holes;
        }
    }
    if !out.edge_sharpness.is_empty() {
        tie(t, (&first, &next), &mut out);
    }
    // All zero is the same as none.
    for sharpness in [&mut out.edge_sharpness, &mut out.vertex_sharpness] {
        if sharpness.iter().all(|&s| s == 0.0) {
            sharpness.clear();
        }
    }
    if out.knots.iter().all(|&d| d == 1.0) {
        out.knots.clear();
    }
    if lost.0 > 0 {
        notes.push(Note::LostMarks { count: lost.0, first: lost.1 });
    }
    out
}

/// Keeps copies of a vertex together where a crease that lasts ends at one of them. All lie on an edge that was cut apart,
/// which is infinitely sharp, and only one of them sees the crease: so all become corners. (What does not last:
/// [`crate::copies`].)
fn tie(t: &Topology, (first, next): (&[u32], &[u32]), marks: &mut Resolved) {
    for &start in first.iter().filter(|&&v| v != NONE && next[v as usize] != NONE) {
        let copies = || std::iter::successors(Some(start), |&v| Some(next[v as usize]).filter(|&n| n != NONE));
        let mut lasts = false;
        for v in copies() {
            let sharp = |h: u32| marks.edge_sharpness[t.edge(h) as usize] >= INFINITE && !is_boundary(t.twin(h));
            t.turn(v, |h| lasts |= sharp(h));
        }
        if lasts {
            let all = fill(&mut marks.vertex_sharpness, t.vertices() as usize, 0.0);
            copies().for_each(|v| all[v as usize] = INFINITE);
        }
    }
}

impl Mesh {
    /// The edge between two positions of the soup, whichever of their copies it joins. Cost: linear.
    pub fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        let class = |p: u32| self.weld_class.get(p as usize).copied();
        let (a, b, t) = (class(a)?, class(b)?, &self.topology);
        let half_edge = (0..t.half_edges()).find(|&h| {
            let at = |h: u32| self.vertex_source[t.origin(h) as usize];
            let (from, to) = (at(h), at(t.next(h)));
            (from, to) == (a, b) || (from, to) == (b, a)
        });
        half_edge.map(|h| t.edge(h))
    }

    /// The edges whose two faces' normals are more than `degrees` apart, by positions of the soup. Cost: linear.
    pub fn edges_bent_by_more(&self, degrees: f64) -> Vec<[u32; 2]> {
        let t = &self.topology;
        let limit = libm::cos(degrees.to_radians());
        let normals: Vec<[f64; 3]> = (0..t.faces()).map(|f| self.face_normal(f)).collect();
        let bent = |&e: &u32| {
            let h = t.edge_half_edge(e);
            let twin = t.twin(h);
            if is_boundary(twin) {
                return false;
            }
            let (n, m) = (normals[t.face(h) as usize], normals[t.face(twin) as usize]);
            n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < limit - 1e-9
        };
        let ends = |e: u32| {
            let h = t.edge_half_edge(e);
            [t.origin(h), t.origin(t.next(h))].map(|v| self.vertex_source[v as usize])
        };
        (0..t.edges()).filter(bent).map(ends).collect()
    }

    /// The unit normal of a face, by Newell's sum; zeros where it has none.
    fn face_normal(&self, f: u32) -> [f64; 3] {
        let t = &self.topology;
        let mut n = [0.0; 3];
        for h in t.face_half_edges(f) {
            let [p, q] = [h, t.next(h)].map(|h| self.positions[t.origin(h) as usize].map(f64::from));
            for (k, sum) in n.iter_mut().enumerate() {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                *sum += (p[i] - q[i]) * (p[j] + q[j]);
            }
        }
        let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        if length > 0.0 { n.map(|x| x / length) } else { [0.0; 3] }
    }
}

/// `values`, made as long as they have to be first.
fn fill(values: &mut Vec<f32>, length: usize, default: f32) -> &mut Vec<f32> {
    if values.is_empty() {
        values.resize(length, default);
    }
    values
}
