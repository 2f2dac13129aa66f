//! Where the points of a patch lie in the numbering that every level has: the closed-form map between a patch's grid and
//! vertex ids.
//!
//! A patch is a face of the level that patches start at, cut `depth` times; its points form a grid of m = 2^depth steps a
//! side. What it *owns* in the recursive numbering is a handful of runs of consecutive ids, whatever the patch:
//!
//! ```text
//!   step j -> j + 1 of patch q     quads                                       triangles (families of 3^a faces)
//!     face points                  V_j + 4^j q + r                             -
//!     edge points                  V_j + F_j + 2 (4^j q + r) + 0 or 1          V_j + 6 (B + 3^a q + r) + 0 .. 5
//!   corner and middle of a side    the start level's vertex and edge           the same
//! ```
//!
//! Along a side every second point of a step is the neighbour's: an edge belongs to the face that has its first half.
//! Every point is stored once, so there is nothing that could crack.
//!
//! Cost: linear in a patch's points, once a depth. Limit: depths up to 7 (16-bit grid indices).

use super::grid::LANES;
use crate::split::Split;
use crate::topology::{Connectivity, Counts, boundary_rank, is_boundary};

/// No id.
const NONE: u32 = u32::MAX;

/// Consecutive ids of a patch: those of patch q begin at `base + per * q`.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub base: u32,
    pub per: u32,
    /// Where its places begin in [`Layout::places`] (of points) or [`Layout::faces`] (of faces).
    pub first: usize,
}

/// The ids of the points along a side of a patch, as linear functions: point p is `base[p] + own[p] q + other[p] o`, with q
/// the patch and o the patch across, or the rank on a boundary. The corner and the middle are not in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Seam {
    pub base: Vec<u32>,
    /// 0 where the point belongs to the other.
    pub own: Vec<u32>,
    pub other: Vec<u32>,
}

impl Seam {
    /// Writes the ids of all `m` points.
    #[inline(always)]
    pub(super) fn ids(&self, q: u32, other: u32, out: &mut [u32]) {
        for (((id, base), own), theirs) in out.iter_mut().zip(&self.base).zip(&self.own).zip(&self.other) {
            *id = base.wrapping_add(own.wrapping_mul(q)).wrapping_add(theirs.wrapping_mul(other));
        }
    }
}

/// The map for one split, depth and start level.
#[derive(Debug)]
pub(super) struct Layout {
    /// Sides of a patch: 3 or 4.
    pub sides: usize,
    /// How often a patch is cut.
    pub depth: u32,
    /// Steps along a side.
    pub m: usize,
    /// Points of the grid.
    pub points: usize,
    /// Runs of points by rising ids, and the place in the grid of each of their points: of each run at least eight, the last
    /// place again and again.
    pub runs: Vec<Run>,
    pub places: Vec<u16>,
    /// Runs of faces by rising ids, and the place in the grid of each corner of theirs, at least eight as well.
    pub face_runs: Vec<Run>,
    pub faces: Vec<u16>,
    /// The id of the point at each place, as `[0] + [1] q`, where a patch owns it alone.
    pub ids: Vec<[u32; 2]>,
    /// The place of border point (side, position), `m` a side; position 0 is the side's first corner.
    pub border: Vec<u16>,
    /// Of every side, next to each side that may lie across, and to none.
    seams: Vec<Seam>,
    /// Counts of the last level, of the one before it.
    pub counts: [Counts; 2],
    /// Where edge points of the first step begin.
    pub first_edge: u32,
}

/// A face inside a patch, by the places of its corners in steps along the patch's axes.
#[derive(Clone, Copy, Debug)]
struct Frame([[u16; 2]; 4]);

/// Faces of a depth that are consecutive: face r of patch q is `base + per * q + r`.
#[derive(Clone, Debug)]
struct Family {
    base: u32,
    per: u32,
    frames: Vec<Frame>,
}

fn middle(points: &[[u16; 2]]) -> [u16; 2] {
    let n = points.len() as u16;
    [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<u16>() / n)
}

/// The place of a point in a grid of `m` steps: rows of m + 1, in a triangle each one shorter than the row before.
pub(super) fn place(sides: usize, m: usize, [i, j]: [u16; 2]) -> u16 {
    let (i, j) = (usize::from(i), usize::from(j));
    (if sides == 4 { j * (m + 1) + i } else { j * (m + 1) - j * (j.max(1) - 1) / 2 + i }) as u16
}

impl Layout {
    /// The map of faces of a level with `counts` that `split` cuts `depth` times; none if ids leave 32 bits.
    pub(super) fn new(split: Split, depth: u32, counts: Counts) -> Option<Layout> {
        let sides = if split == Split::Quad { 4 } else { 3 };
        let m = 1usize << depth;
        let mut levels = vec![counts];
        for _ in 0..depth {
            levels.push(split.counts(*levels.last()?)?);
        }
        if levels.last()?.corners >= 1 << 31 {
            return None;
        }
        let quads = sides == 4;
        let points = if quads { (m + 1) * (m + 1) } else { (m + 1) * (m + 2) / 2 };
        let e = m as u16;
        let whole = if quads { [[0, 0], [e, 0], [e, e], [0, e]] } else { [[0, 0], [e, 0], [0, e], [0, 0]] };
        let mut layout = Layout {
            sides,
            depth,
            m,
            points,
            runs: Vec::new(),
            places: Vec::new(),
            face_runs: Vec::new(),
            faces: Vec::new(),
            ids: Vec::new(),
            border: Vec::new(),
            seams: Vec::new(),
            counts: [levels[depth as usize], levels[depth as usize - 1]],
            first_edge: (counts.vertices + if quads { counts.faces } else { 0 }) as u32,
        };
        let mut families = vec![Family { base: 0, per: 1, frames: vec![Frame(whole)] }];
        for j in 0..depth {
            let Counts { vertices, faces, .. } = levels[j as usize];
            let (v, f) = (vertices as u32, faces as u32);
            if quads {
                for family in &families {
                    layout.add(v + family.base, family.per, &family.frames, |frame, out| out.push(middle(&frame.0)));
                    if j > 0 {
                        layout.add(v + f + 2 * family.base, 2 * family.per, &family.frames, |frame, out| {
                            out.extend([0, 1].map(|k| middle(&frame.0[k..k + 2])));
                        });
                    }
                }
            }
            let finer = families.iter().flat_map(|family| family.children(quads, f)).collect();
            if !quads && j + 1 < depth {
                // Edges of the next level belong to this level's half-edges: the first half of each, and the cut beside it.
                let v = levels[j as usize + 1].vertices as u32;
                for family in &families {
                    layout.add(v + 6 * family.base, 6 * family.per, &family.frames, |frame, out| {
                        let p = &frame.0;
                        let mid = |i: usize| middle(&[p[i % 3], p[(i + 1) % 3]]);
                        let first = |i: usize| [middle(&[p[i], mid(i)]), middle(&[mid(i), mid(i + 2)])];
                        out.extend((0..3).flat_map(first));
                    });
                }
            }
            families = finer;
        }
        layout.runs.sort_by_key(|run| run.base);
        layout.find_border(&levels, &whole);
        layout.list_faces(families);
        Some(layout)
    }

    fn place(&self, at: [u16; 2]) -> u16 {
        place(self.sides, self.m, at)
    }

    fn add(&mut self, base: u32, per: u32, frames: &[Frame], list: impl Fn(&Frame, &mut Vec<[u16; 2]>)) {
        let mut points = Vec::with_capacity(per as usize);
        frames.iter().for_each(|frame| list(frame, &mut points));
        debug_assert_eq!(points.len(), per as usize);
        self.runs.push(Run { base, per, first: self.places.len() });
        let places = points.iter().map(|&p| self.place(p)).collect();
        self.places.extend(in_eights(places));
    }

    /// The places of the points of a run.
    pub(super) fn places_of(&self, run: &Run) -> &[u16] {
        &self.places[run.first..run.first + run.per as usize]
    }

    /// What every place's id is, where the patch owns it.
    fn owned(&self) -> Vec<[u32; 2]> {
        let mut own = vec![[NONE, 0]; self.points];
        for run in &self.runs {
            for (offset, &place) in (0..).zip(self.places_of(run)) {
                own[usize::from(place)] = [run.base + offset, run.per];
            }
        }
        own
    }

    fn find_border(&mut self, levels: &[Counts], whole: &[[u16; 2]; 4]) {
        let (owned, sides, m) = (self.owned(), self.sides, self.m);
        for side in 0..sides {
            let (a, b) = (whole[side], whole[(side + 1) % sides]);
            for p in 0..m {
                let at = [0, 1].map(|k| ((usize::from(a[k]) * (m - p) + usize::from(b[k]) * p) / m) as u16);
                self.border.push(self.place(at));
            }
        }
        let own = |side: usize, p: usize| owned[usize::from(self.border[side * m + p])];
        // Nobody's: born in the middle of edge `half` of the 2^step that the side is cut into, the second half of another
        // (which is why it is nobody's), so that its rank is rank * 2^step + half and its edge half that behind the others.
        let rim = |p: usize| {
            let zeros = p.trailing_zeros();
            let (step, half) = (self.depth - 1 - zeros, (p >> (zeros + 1)) as u32);
            let Counts { vertices, faces, .. } = levels[step as usize];
            let base = match sides {
                4 => vertices + 3 * faces,
                _ => vertices + 6 * levels[step as usize - 1].faces,
            };
            [base as u32 + half / 2, 1 << (step - 1)]
        };
        let mut seams = Vec::new();
        for side in 0..sides {
            for across in 0..=sides {
                let mut seam = Seam { base: vec![0; m], own: vec![0; m], other: vec![0; m] };
                for p in (1..m).filter(|&p| p != m / 2) {
                    let [base, per] = own(side, p);
                    if base != NONE {
                        (seam.base[p], seam.own[p]) = (base, per);
                    } else if across < sides {
                        // The other's if these two can lie next to each other; else it does not matter.
                        [seam.base[p], seam.other[p]] = own(across, m - p);
                    } else {
                        [seam.base[p], seam.other[p]] = rim(p);
                    }
                }
                seams.push(seam);
            }
        }
        self.seams = seams;
    }

    /// The seam of half-edge `h` of the start level with what lies across, and which patch or rank that is.
    #[inline(always)]
    pub(super) fn seam<C: Connectivity>(&self, c: &C, h: u32) -> (&Seam, u32) {
        let sides = self.sides as u32;
        let twin = c.twin(h);
        let (across, other) =
            if is_boundary(twin) { (sides, boundary_rank(twin)) } else { (twin % sides, twin / sides) };
        (&self.seams[(h % sides * (sides + 1) + across) as usize], other)
    }

    /// The seam of a side on a boundary.
    pub(super) fn rim(&self, side: usize) -> &Seam {
        &self.seams[side * (self.sides + 1) + self.sides]
    }

    fn list_faces(&mut self, mut families: Vec<Family>) {
        families.sort_by_key(|family| family.base);
        self.ids = self.owned();
        for family in families {
            self.face_runs.push(Run { base: family.base, per: family.per, first: self.faces.len() });
            let corners = family.frames.iter().flat_map(|frame| &frame.0[..self.sides]);
            let places = corners.map(|&p| self.place(p)).collect();
            self.faces.extend(in_eights(places));
        }
    }
}

/// Repeats the last place until there are eight.
fn in_eights(mut places: Vec<u16>) -> Vec<u16> {
    let last = places.last().copied().unwrap_or_default();
    places.resize(places.len().max(LANES), last);
    places
}

impl Family {
    /// The faces that these become, where the level has `faces` faces.
    fn children(&self, quads: bool, faces: u32) -> Vec<Family> {
        if quads {
            let frames = self.frames.iter().flat_map(|Frame(p)| {
                let centre = middle(p);
                let mid = |i: usize| middle(&[p[i % 4], p[(i + 1) % 4]]);
                (0..4).map(|k| Frame([p[k], mid(k), centre, mid(k + 3)])).collect::<Vec<_>>()
            });
            return vec![Family { base: 4 * self.base, per: 4 * self.per, frames: frames.collect() }];
        }
        let corners = self.frames.iter().flat_map(|Frame(p)| {
            let mid = |i: usize| middle(&[p[i % 3], p[(i + 1) % 3]]);
            (0..3).map(|k| Frame([p[k], mid(k), mid(k + 2), [0; 2]])).collect::<Vec<_>>()
        });
        let middles = self.frames.iter().map(|Frame(p)| {
            let mid = |i: usize| middle(&[p[i % 3], p[(i + 1) % 3]]);
            Frame([mid(2), mid(0), mid(1), [0; 2]])
        });
        vec![
            Family { base: 3 * self.base, per: 3 * self.per, frames: corners.collect() },
            Family { base: 3 * faces + self.base, per: self.per, frames: middles.collect() },
        ]
    }
}
