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

use crate::report::Note;
use crate::soup::{Marks, NONE};
use crate::topology::{Connectivity, Topology};

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
        let mut hole = vec![false; face_source.iter().max().map_or(0, |&f| f as usize + 1)];
        marks.holes.iter().for_each(|&f| hole.get_mut(f as usize).into_iter().for_each(|h| *h = true));
        let holes: Vec<bool> = face_source.iter().map(|&f| hole[f as usize]).collect();
        if holes.contains(&true) {
            out.holes = holes;
        }
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

/// `values`, made as long as they have to be first.
fn fill(values: &mut Vec<f32>, length: usize, default: f32) -> &mut Vec<f32> {
    if values.is_empty() {
        values.resize(length, default);
    }
    values
}
