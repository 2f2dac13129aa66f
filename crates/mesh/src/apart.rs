//! Creases as cuts: a level looked at as if it were cut along its sharp edges, so that what a scheme does at a rim it does on
//! either side of a crease.
//!
//! ```text
//!       \ | /                    \ | /
//!     ---(v)---  sharp         ---.v.---  two turns around v, each from one crease to the next; twins across are a boundary;
//!       / | \                    / | \    v is still one vertex, and takes what the rim's curve says, alike from both sides
//!
//!   sharp edges at v    0 smooth    1 dart    2 crease    3 and more corner          a sharp vertex is a corner
//! ```
//!
//! So D. Zorin, P. Schroeder and W. Sweldens have it for the modified Butterfly ("Interpolating subdivision for meshes with
//! arbitrary topology", 1996; Zorin & Schroeder, "Subdivision for modeling and animation", 2000, chapter 4: edges that are tagged
//! follow the rules of a boundary from both sides), and Kobbelt for his feature lines ("sqrt(3)-subdivision", 2000). As long as
//! edges are infinitely sharp and form closed curves the pieces of the surface are those of the mesh cut in pieces.
//! A corner ends the curves that meet in it, a boundary vertex where a crease arrives is one. A dart is turned around as if
//! its edge were smooth, as in Loop's and Catmull's schemes; its edge's point is the crease's, whose curve goes straight on there
//! (a choice of this house).
//!
//! *Semi-sharp* (T. DeRose, M. Kass, T. Truong, "Subdivision surfaces in character animation", 1998: sharp rules as long as s is
//! at least 1, then a linear blend). A rule may see many edges, so with s(t) = what is cut where sharpness counts from more than t,
//!
//! ```text
//!   point  =  integral over t in (0, 1) of the rule on s(t)      one edge:  s sharp + (1 - s) smooth
//! ```
//!
//! which is a sum over the fractions that the rule meets, continuous in all of them, and does not depend on numbers. Where rules
//! read points of the same step (Kobbelt's faces) they read blended ones.
//!
//! Cost: a rule that meets fractions runs again for each, twice. Limit: splits that turn edges can only take infinite ones.

use crate::crease::Creases;
use crate::marks::INFINITE;
use crate::scheme::{Creasing, Scheme, Tags};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{BOUNDARY, Connectivity, is_boundary};
use std::cell::Cell;
use std::ops::Range;

/// A level with cuts.
#[derive(Debug)]
pub(crate) struct Apart<'a, C> {
    whole: &'a C,
    creases: &'a Creases,
    /// What is sharper than this is cut.
    over: Cell<f32>,
    /// The least sharpness below 1 that was found to be cut; 1 if none was.
    met: Cell<f32>,
    /// Whether edges are turned where they are not cut. Then none is cut at an inner vertex of two faces, which has nothing
    /// to be turned into.
    turns: bool,
}

impl<'a, C: Connectivity> Apart<'a, C> {
    /// Cut wherever it is infinitely sharp.
    fn new(whole: &'a C, creases: &'a Creases, turns: bool) -> Apart<'a, C> {
        Apart { whole, creases, over: Cell::new(INFINITE.next_down()), met: Cell::new(1.0), turns }
    }

    /// The same, as splits see it that turn all other edges.
    pub fn turned(whole: &'a C, creases: &'a Creases) -> Apart<'a, C> {
        Apart::new(whole, creases, true)
    }

    /// Whether what is so sharp is cut.
    #[inline(always)]
    fn cuts(&self, s: f32) -> bool {
        let sharp = s > self.over.get();
        if sharp && s < self.met.get() {
            self.met.set(s);
        }
        sharp
    }

    /// Whether the edge of `h`, not on a boundary, is cut.
    #[inline(always)]
    pub fn is_cut(&self, h: u32) -> bool {
        self.cuts(self.creases.edge(self.whole.edge(h))) && !(self.turns && self.is_beside_digon(h))
    }

    /// Whether an end of `h` is an inner vertex of two faces.
    #[inline(never)]
    fn is_beside_digon(&self, h: u32) -> bool {
        let c = self.whole;
        [h, c.next(h)].into_iter().any(|h| {
            let mut faces = 0;
            c.turn(c.origin(h), |_| faces += 1).is_none() && faces == 2
        })
    }

    /// Whether `v` is the end of one sharp edge.
    pub fn is_dart(&self, v: u32) -> bool {
        self.sharp_edges(v) == 1
    }

    /// Where the turns around `v` start, one for each part that cuts leave of its neighbourhood.
    pub fn starts(&self, v: u32) -> impl Iterator<Item = u32> {
        let first = self.vertex_half_edge(v);
        std::iter::successors(Some(first), move |&start| {
            let after = self.whole.twin(self.turn_from(start, |_| {})?);
            (!is_boundary(after) && after != first).then_some(after)
        })
    }

    /// How many sharp edges `v` has, its boundary edges among them; none if all are of a boundary.
    #[inline(always)]
    fn sharp_edges(&self, v: u32) -> u32 {
        if self.creases.is_on_crease(v) { self.count(v) } else { 0 }
    }

    #[inline(never)]
    fn count(&self, v: u32) -> u32 {
        let mut count = 0;
        let arriving = self.whole.turn(v, |h| count += u32::from(is_boundary(self.whole.twin(h)) || self.is_cut(h)));
        count + u32::from(arriving.is_some())
    }
}

impl<C: Connectivity> Connectivity for Apart<'_, C> {
    #[inline(always)]
    fn vertices(&self) -> u32 {
        self.whole.vertices()
    }
    #[inline(always)]
    fn edges(&self) -> u32 {
        self.whole.edges()
    }
    #[inline(always)]
    fn faces(&self) -> u32 {
        self.whole.faces()
    }
    #[inline(always)]
    fn half_edges(&self) -> u32 {
        self.whole.half_edges()
    }
    #[inline(always)]
    fn boundary_half_edges(&self) -> u32 {
        self.whole.boundary_half_edges()
    }
    #[inline(always)]
    fn boundary_half_edge(&self, rank: u32) -> u32 {
        self.whole.boundary_half_edge(rank)
    }
    #[inline(always)]
    fn face_half_edges(&self, f: u32) -> Range<u32> {
        self.whole.face_half_edges(f)
    }
    #[inline(always)]
    fn face(&self, h: u32) -> u32 {
        self.whole.face(h)
    }
    #[inline(always)]
    fn next(&self, h: u32) -> u32 {
        self.whole.next(h)
    }
    #[inline(always)]
    fn prev(&self, h: u32) -> u32 {
        self.whole.prev(h)
    }
    /// Across a cut: a boundary of no rank.
    #[inline(always)]
    fn twin(&self, h: u32) -> u32 {
        let twin = self.whole.twin(h);
        if !is_boundary(twin) && self.is_cut(h) { BOUNDARY } else { twin }
    }
    #[inline(always)]
    fn origin(&self, h: u32) -> u32 {
        self.whole.origin(h)
    }
    #[inline(always)]
    fn edge(&self, h: u32) -> u32 {
        self.whole.edge(h)
    }
    #[inline(always)]
    fn vertex_half_edge(&self, v: u32) -> u32 {
        let start = self.whole.vertex_half_edge(v);
        if self.creases.is_on_crease(v) { self.first_spoke(start) } else { start }
    }
    #[inline(always)]
    fn edge_half_edge(&self, e: u32) -> u32 {
        self.whole.edge_half_edge(e)
    }
    #[inline(never)]
    fn first_spoke(&self, h: u32) -> u32 {
        let v = self.whole.origin(h);
        match self.sharp_edges(v) {
            0 => self.whole.vertex_half_edge(v),
            // Anywhere but at the dart's own edge, which looks like a boundary.
            1 if self.is_cut(h) => self.whole.twin(self.whole.prev(h)),
            1 => h,
            _ => {
                let mut spoke = h;
                while !is_boundary(self.twin(spoke)) {
                    spoke = self.whole.next(self.whole.twin(spoke));
                }
                spoke
            }
        }
    }
    fn is_rim(&self, h: u32) -> bool {
        self.whole.is_rim(h) || (!is_boundary(self.whole.twin(h)) && self.is_cut(h))
    }
    fn is_tip(&self, v: u32) -> bool {
        self.whole.is_tip(v)
    }
    #[inline(never)]
    fn is_pinned(&self, v: u32) -> bool {
        self.cuts(self.creases.vertex(v)) || self.sharp_edges(v) > 2
    }
    #[inline(always)]
    fn turn_from(&self, start: u32, mut visit: impl FnMut(u32)) -> Option<u32> {
        let parted = self.sharp_edges(self.whole.origin(start)) > 1;
        let mut h = start;
        loop {
            visit(h);
            let arriving = self.whole.prev(h);
            h = self.whole.twin(arriving);
            if is_boundary(h) || (parted && self.is_cut(arriving)) {
                return Some(arriving);
            }
            if h == start {
                return None;
            }
        }
    }
}

/// A sink whose rows are mean over everything that counts as sharp.
struct Blended<'b, C, K> {
    level: &'b Apart<'b, C>,
    sink: &'b mut K,
}

impl<C: Connectivity, K: Sink> Sink for Blended<'_, C, K> {
    type Row<'r> = K::Row<'r>;

    fn pass(&mut self, first: u32, count: u32, rule: impl for<'r> Fn(u32, &mut Self::Row<'r>)) {
        let level = self.level;
        // Up to which sharpness the rule stays the same, from one on.
        let state = |over: f32, i: u32, row: &mut Self::Row<'_>| {
            level.over.set(over);
            level.met.set(1.0);
            rule(i, row);
            level.met.get()
        };
        self.sink.pass(first, count, |i, row| {
            let mut ends = vec![];
            let mut over = state(0.0, i, row);
            if over == 1.0 {
                return;
            }
            // Once to find out, and once more with what each counts.
            while over < 1.0 {
                ends.push(over);
                over = state(over, i, row);
            }
            row.scale(0.0);
            ends.push(1.0);
            let share = |k: usize| f64::from(ends[k]) - if k == 0 { 0.0 } else { f64::from(ends[k - 1]) };
            for k in 0..ends.len() {
                state(if k == 0 { 0.0 } else { ends[k - 1] }, i, row);
                row.scale(share(k) / ends.get(k + 1).map_or(1.0, |_| share(k + 1)));
            }
        });
    }
}

/// States the rules of `S` on `c` cut along its creases; false if there are none, or they mean nothing to it.
#[inline(always)]
pub(crate) fn rules<S: Scheme, C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) -> bool {
    let (Some(creases), true) = (tags.creases, S::CREASES.is_apart()) else { return false };
    let turns = S::CREASES == Creasing::ApartForEver;
    let first_regular = if turns { u32::MAX } else { tags.first_regular };
    let (level, tags) = (Apart::new(c, creases, turns), Tags { creases: None, first_regular, ..tags });
    match S::CREASES {
        Creasing::Apart => S::rules(&level, split, tags, &mut Blended { level: &level, sink }),
        _ => S::rules(&level, split, tags, sink),
    }
    true
}
