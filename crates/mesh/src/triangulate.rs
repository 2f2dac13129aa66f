//! Polygons into triangles: any degree, planar or not, concave ones properly.
//!
//! A quad is cut along its shorter diagonal, unless that one runs outside; a larger polygon by *ear clipping*, always taking
//! the ear with the shortest diagonal. Which corner is an ear is decided in the plane across the polygon's Newell normal, so
//! polygons that are a little bent (all of them are, in f32) give the same answer from every side.
//!
//! ```text
//!      3 ───── 2          2                 An ear is a convex corner whose triangle holds no other
//!      │     / │        / │ \               corner. Corner 2 of the arrow head is one, and so is 0's
//!      │   /   │      /   1   \             neighbour; corner 1 is reflex and never is.
//!      │ /     │    /   /   \   \
//!      0 ───── 1   3 ─            0
//! ```
//!
//! Only reflex corners can lie in an ear, so only those are searched: they are kept sorted by one coordinate, and an ear that
//! one of them blocks waits until that one has gone. Convex polygons cost O(n log n), usual ones a little more, the worst
//! O(n²). Broken input (repeated or collinear corners, polygons that touch or cross themselves, NaN) lowers what counts as an
//! ear step by step, so that n corners always give n − 2 triangles.
//!
//! G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82 (1975); M. E. Newell's normal as in I. E. Sutherland,
//! R. F. Sproull and R. A. Schumacker, "A characterization of ten hidden-surface algorithms", Computing Surveys 6 (1974).

use crate::order;
use crate::soup::Soup;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Corners whose sine is below this count as straight: about what f32 coordinates can tell.
const STRAIGHT: f64 = 1e-6;

/// How often the rules may be tightened again after they had to be relaxed. Bounds the work on wholly degenerate polygons.
const RELAPSES: u32 = 16;

/// How many corners may be looked at in search of blockers, at least; past this and 1,024 for each corner nothing blocks.
/// About a second. No polygon that does not cross itself all over comes near.
const PATIENCE: u64 = 1 << 28;

/// The end of a list of waiting corners.
const END: u32 = u32::MAX;

/// Cuts one polygon into `n - 2` triangles of local corner numbers `0..n`, turning the same way as the polygon.
///
/// * `positions` are looked up by the entries of `polygon`; an entry out of range counts as the origin.
/// * `out` is cleared first. It stays empty when the polygon has fewer than three corners.
///
/// Quads take the shorter diagonal, ties the one at corner 0, and concave quads the diagonal inside. Larger polygons lose the
/// ear with the shortest diagonal first, ties the one with the lowest corner number. Cost: O(n log n) for convex polygons,
/// O(n²) at worst (10,000 corners stay well under a second).
///
/// ```
/// use limn_mesh::triangulate::triangulate;
/// let arrow = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]];
/// let mut triangles = Vec::new();
/// triangulate(&arrow, &[0, 1, 2, 3], &mut triangles);
/// assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
/// ```
pub fn triangulate(positions: &[[f32; 3]], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    out.clear();
    match polygon.len() {
        0..=2 => {}
        3 => out.push([0, 1, 2]),
        4 => {
            let points: [[f64; 3]; 4] = std::array::from_fn(|i| lookup(positions, polygon[i]));
            out.extend(split_quad(&points));
        }
        _ => {
            let points: Vec<[f64; 3]> = polygon.iter().map(|&p| lookup(positions, p)).collect();
            Clipper::new(&points).run(out);
        }
    }
}

/// Cuts every face of more than three corners into triangles and says how many faces were cut.
///
/// Texture coordinates stay with their corners, groups and materials with their faces, colours with their positions. Faces of
/// fewer than three corners are copied as they are. Triangles come in the order of the faces they were cut from.
///
/// ```
/// use limn_mesh::{shapes, triangulate::triangulate_soup};
/// let cube = (shapes::shape("cube").unwrap().build)();
/// let (triangles, split) = triangulate_soup(&cube);
/// assert_eq!((triangles.face_count(), split), (12, 6));
/// ```
pub fn triangulate_soup(soup: &Soup) -> (Soup, usize) {
    let mut result = soup.vertices_only();
    let mut triangles = Vec::new();
    let mut split = 0;
    let is_hole = soup.is_hole();
    for f in 0..soup.face_count() {
        let range = soup.face_range(f);
        let corners = soup.corners.get(range.clone()).unwrap_or(&[]);
        let uvs = soup.uv_corners.get(range).unwrap_or(&[]);
        let mut pieces = 1;
        let first = result.face_count() as u32;
        if corners.len() > 3 {
            split += 1;
            triangulate(&soup.positions, corners, &mut triangles);
            pieces = triangles.len();
            for t in &triangles {
                result.push_face(&t.map(|c| corners[c as usize]));
                if uvs.len() == corners.len() {
                    result.uv_corners.extend(t.map(|c| uvs[c as usize]));
                }
            }
        } else {
            result.push_face(corners);
            result.uv_corners.extend_from_slice(uvs);
        }
        if is_hole.get(f) == Some(&true) {
            result.marks.holes.extend(first..first + pieces as u32);
        }
        if let Some(&group) = soup.face_groups.get(f) {
            result.face_groups.extend(std::iter::repeat_n(group, pieces));
        }
        if let Some(&material) = soup.face_materials.get(f) {
            result.face_materials.extend(std::iter::repeat_n(material, pieces));
        }
    }
    (result, split)
}

fn lookup(positions: &[[f32; 3]], index: u32) -> [f64; 3] {
    positions.get(index as usize).copied().unwrap_or_default().map(f64::from)
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn distance2(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = sub(a, b);
    dot(d, d)
}

fn size2(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    x * x + y * y
}

/// Twice the polygon's area vector, summed from its first corner so that a far-away polygon loses no digits.
fn newell(points: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for pair in points[1..].windows(2) {
        let c = cross(sub(pair[0], points[0]), sub(pair[1], points[0]));
        sum = [sum[0] + c[0], sum[1] + c[1], sum[2] + c[2]];
    }
    sum
}

/// The two triangles of a quad.
fn split_quad(p: &[[f64; 3]; 4]) -> [[u32; 3]; 2] {
    let normal = newell(p);
    // A triangle is good when it has some area, on the quad's own side.
    let floor = STRAIGHT * dot(normal, normal);
    let good = |a: usize, b: usize, c: usize| dot(cross(sub(p[b], p[a]), sub(p[c], p[a])), normal) > floor;
    let even = good(0, 1, 2) && good(0, 2, 3);
    let odd = good(0, 1, 3) && good(1, 2, 3);
    let take_even = if even == odd { distance2(p[0], p[2]) <= distance2(p[1], p[3]) } else { even };
    if take_even { [[0, 1, 2], [0, 2, 3]] } else { [[0, 1, 3], [1, 2, 3]] }
}

/// What counts as an ear; each step admits more.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    /// A clearly convex corner with nothing in or on its triangle.
    Strict,
    /// A corner that is not reflex with nothing inside its triangle.
    Loose,
    /// Anything: the polygon has no ear left (it crosses itself, or is not a number).
    Any,
}

/// An ear to try: squared length of its diagonal (bits of a non-negative f64 sort as it does), the diagonal's lower corner,
/// then the tip and its neighbours at the time, which tell a stale entry.
type Candidate = Reverse<(u64, u32, u32, u32, u32)>;

/// One run of ear clipping over a polygon of at least four corners.
struct Clipper<'a> {
    points: &'a [[f64; 3]],
    /// The points in the plane, anticlockwise.
    flat: Vec<[f64; 2]>,
    prev: Vec<u32>,
    next: Vec<u32>,
    alive: Vec<bool>,
    /// Corners that may lie in an ear: reflex and straight ones.
    blocks: Vec<bool>,
    /// Those corners sorted by `flat[..][0]`.
    sorted: Vec<u32>,
    /// For each corner the head of its list of ears that it blocks, in `waiting`.
    waiters: Vec<u32>,
    /// (tip, next in the list).
    waiting: Vec<(u32, u32)>,
    heap: BinaryHeap<Candidate>,
    /// Whether a corner is on the heap with the neighbours that it has now.
    offered: Vec<bool>,
    /// How many corners may still be looked at.
    patience: u64,
    rule: Rule,
}

impl<'a> Clipper<'a> {
    fn new(points: &'a [[f64; 3]]) -> Self {
        let n = points.len();
        let flat = flatten(points);
        let mut clipper = Clipper {
            points,
            flat,
            prev: (0..n as u32).map(|i| if i == 0 { n as u32 - 1 } else { i - 1 }).collect(),
            next: (0..n as u32).map(|i| if i + 1 == n as u32 { 0 } else { i + 1 }).collect(),
            alive: vec![true; n],
            blocks: vec![false; n],
            sorted: Vec::new(),
            waiters: vec![END; n],
            waiting: Vec::new(),
            heap: BinaryHeap::with_capacity(n + n / 2),
            offered: vec![false; n],
            patience: PATIENCE + 1024 * n as u64,
            rule: Rule::Strict,
        };
        let mut sorted = Vec::new();
        for i in 0..n as u32 {
            if !clipper.is_convex(i) {
                clipper.blocks[i as usize] = true;
                sorted.push((order::float_key(clipper.flat[i as usize][0]), i));
            }
        }
        order::sort(&mut sorted);
        clipper.sorted = sorted.into_iter().map(|(_, i)| i).collect();
        clipper
    }

    fn run(mut self, out: &mut Vec<[u32; 3]>) {
        let n = self.points.len();
        out.reserve(n - 2);
        (0..n as u32).for_each(|i| self.offer(i));
        let mut relapses = 0;
        let mut left = n;
        while left > 3 {
            let Some(Reverse((_, _, tip, a, c))) = self.heap.pop() else {
                // No ear under this rule: relax it and look at every corner again.
                self.rule = if self.rule == Rule::Strict { Rule::Loose } else { Rule::Any };
                (0..n as u32)
                    .filter(|&i| self.alive[i as usize])
                    .collect::<Vec<_>>()
                    .into_iter()
                    .for_each(|i| self.offer(i));
                continue;
            };
            let t = tip as usize;
            if !self.alive[t] || self.prev[t] != a || self.next[t] != c {
                continue;
            }
            self.offered[t] = false;
            if !self.fits(tip) {
                continue;
            }
            if let Some(blocker) = self.blocker(tip) {
                self.waiting.push((tip, self.waiters[blocker as usize]));
                self.waiters[blocker as usize] = self.waiting.len() as u32 - 1;
                continue;
            }
            out.push([a, tip, c]);
            left -= 1;
            self.alive[t] = false;
            self.next[a as usize] = c;
            self.prev[c as usize] = a;
            if self.rule > Rule::Strict && relapses < RELAPSES {
                relapses += 1;
                self.rule = Rule::Strict;
            }
            self.release(tip);
            for i in [a, c] {
                self.offered[i as usize] = false;
                if self.blocks[i as usize] && self.is_convex(i) {
                    self.release(i);
                }
                self.offer(i);
            }
        }
        // Three are left: find one of them.
        if let Some(b) = self.alive.iter().position(|&alive| alive) {
            let (a, c) = (self.prev[b], self.next[b]);
            out.push([b as u32, c, a]);
        }
    }

    /// Twice the signed area of a triangle in the plane.
    fn area(&self, a: u32, b: u32, c: u32) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| self.flat[i as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// True if the corner turns left by more than rounding could make it.
    fn is_convex(&self, i: u32) -> bool {
        let (a, c) = (self.prev[i as usize], self.next[i as usize]);
        let [p, q, r] = [a, i, c].map(|i| self.flat[i as usize]);
        self.area(a, i, c) > STRAIGHT * (size2(p, q) * size2(q, r)).sqrt()
    }

    /// True if the rule lets the angle at `i` be an ear's.
    fn fits(&self, i: u32) -> bool {
        match self.rule {
            Rule::Strict => self.is_convex(i),
            Rule::Loose => self.area(self.prev[i as usize], i, self.next[i as usize]) >= 0.0,
            Rule::Any => true,
        }
    }

    /// Puts corner `i` on the heap if it fits the rule.
    fn offer(&mut self, i: u32) {
        if !self.offered[i as usize] && self.fits(i) {
            self.offered[i as usize] = true;
            let (a, c) = (self.prev[i as usize], self.next[i as usize]);
            let length = distance2(self.points[a as usize], self.points[c as usize]);
            self.heap.push(Reverse((length.to_bits(), a.min(c), i, a, c)));
        }
    }

    /// The first corner that lies in the ear at `tip`, if any does.
    fn blocker(&mut self, tip: u32) -> Option<u32> {
        if self.rule == Rule::Any || self.patience == 0 {
            return None;
        }
        let (a, c) = (self.prev[tip as usize], self.next[tip as usize]);
        let [pa, pb, pc] = [a, tip, c].map(|i| self.flat[i as usize]);
        let low = [pa[0].min(pb[0]).min(pc[0]), pa[1].min(pb[1]).min(pc[1])];
        let high = [pa[0].max(pb[0]).max(pc[0]), pa[1].max(pb[1]).max(pc[1])];
        // On the border counts as inside at first, so that no triangle or remainder comes out flat.
        let epsilon = 1e-9 * size2(low, high);
        let floor = if self.rule == Rule::Strict { -epsilon } else { epsilon };
        let from = self.sorted.partition_point(|&i| self.flat[i as usize][0] < low[0]);
        for &i in &self.sorted[from..] {
            let p = self.flat[i as usize];
            if p[0] > high[0] {
                break;
            }
            self.patience = self.patience.saturating_sub(1);
            if p[1] < low[1] || p[1] > high[1] || !self.blocks[i as usize] || i == a || i == c || i == tip {
                continue;
            }
            // Where a polygon touches itself, several corners share a place; they do not block each other.
            if p == pa || p == pb || p == pc {
                continue;
            }
            if self.area(a, tip, i) >= floor && self.area(tip, c, i) >= floor && self.area(c, a, i) >= floor {
                return Some(i);
            }
        }
        None
    }

    /// Corner `i` no longer blocks: the ears that waited for it are offered again.
    fn release(&mut self, i: u32) {
        self.blocks[i as usize] = false;
        let mut entry = std::mem::replace(&mut self.waiters[i as usize], END);
        while let Some(&(tip, next)) = self.waiting.get(entry as usize) {
            if self.alive[tip as usize] {
                self.offer(tip);
            }
            entry = next;
        }
    }
}

/// The points along the Newell normal onto a coordinate plane, anticlockwise there.
///
/// The coordinate across which the normal points most is dropped, after sliding each point along the normal into its zero
/// plane; polygons in a coordinate plane keep their coordinates exactly.
fn flatten(points: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let mut low = points[0];
    let mut high = points[0];
    for p in points {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let extent = sub(high, low);
    let mut normal = newell(points);
    // A polygon without an area vector (a line, a figure of eight) is looked at across its thinnest side.
    let length = dot(normal, normal).sqrt();
    if length.is_nan() || length <= 1e-14 * dot(extent, extent) {
        normal = [0.0; 3];
        normal[smallest(extent)] = 1.0;
    }
    let k = smallest(normal.map(|x| -x.abs()));
    let (i, j) = if normal[k] > 0.0 { ((k + 1) % 3, (k + 2) % 3) } else { ((k + 2) % 3, (k + 1) % 3) };
    let slope = [normal[i] / normal[k], normal[j] / normal[k]];
    points
        .iter()
        .map(|p| {
            let d = sub(*p, points[0]);
            [d[i] - d[k] * slope[0], d[j] - d[k] * slope[1]]
        })
        .collect()
}

/// The place of the smallest of three values, the first one on ties.
fn smallest(v: [f64; 3]) -> usize {
    let mut best = 0;
    for k in 1..3 {
        if v[k] < v[best] {
            best = k;
        }
    }
    best
}
