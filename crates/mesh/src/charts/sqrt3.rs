//! The places of the sqrt3 split's triangles.
//!
//! ```text
//!        c             c, the centre of the side that has the seam v w; both triangles across are its own, [v m c] and
//!      / | \           [w c m], with the seam's middle m for the other centre, which is at m in its own chart too
//!    v --m-- w
//!      \ | /           a triangle that gives away two edges has its centre where they meet
//!        .
//! ```

use super::{Charts, Place};
use crate::topology::{Connectivity, boundary_rank, is_boundary};

impl Charts<'_> {
    /// The rim's half-edge of a face that is cut there.
    pub(super) fn rim_of(&self, h: u32, trisect: bool) -> Option<u32> {
        self.g.face_half_edges(self.g.face(h)).find(|&b| trisect && is_boundary(self.g.twin(b)))
    }

    /// What the face of `h` has for its centre beside `h`, in its own chart.
    fn centre(&self, h: u32, trisect: bool) -> Place {
        let (g, u) = (self.g, self.u);
        let first = u.vertices();
        if let Some(b) = self.rim_of(h, trisect) {
            // The second of the rim's points, or the first. A seam beside it has its end in common with it.
            let (n, p) = (g.next(b), g.prev(b));
            return match h == n {
                true if self.is_foreign(n) => Place::Point(u.origin(n)),
                true => Place::Image(first + g.faces() + boundary_rank(g.twin(b))),
                false if self.is_foreign(p) => Place::Point(u.origin(b)),
                false => Place::Image(first + g.face(h)),
            };
        }
        let mut sides = g.face_half_edges(g.face(h)).filter(|&x| self.is_foreign(x));
        match (sides.next(), sides.next(), sides.next()) {
            (Some(x), None, _) => {
                let [a, b] = self.ends(x);
                Place::Middle(a, b)
            }
            // Where the two meet.
            (Some(x), Some(y), None) => Place::Point(u.origin(if y == g.next(x) { y } else { x })),
            _ => Place::Image(first + g.face(h)),
        }
    }

    /// The centre beside the twin of `h`, which owns their seam, in the chart of `h`.
    fn centre_across(&self, h: u32, trisect: bool) -> Place {
        let (t, [a, b]) = (self.g.twin(h), self.ends(h));
        match self.rim_of(t, trisect) {
            Some(rim) if t == self.g.next(rim) => Place::Point(b),
            Some(_) => Place::Point(a),
            None => match (self.is_foreign(self.g.next(t)), self.is_foreign(self.g.prev(t))) {
                (true, false) => Place::Point(a),
                (false, true) => Place::Point(b),
                _ => Place::Middle(a, b),
            },
        }
    }

    /// The places of the corners of all triangles, in the order of the split's.
    pub(super) fn sqrt3(&self, trisect: bool) -> Vec<Place> {
        let (g, u) = (self.g, self.u);
        let vertex = |h: u32| Place::Image(u.origin(h));
        let centre = |h: u32| self.centre(h, trisect);
        let triangle = |h: u32| {
            let t = g.twin(h);
            match (is_boundary(t), trisect) {
                (true, false) => [vertex(h), vertex(g.next(h)), centre(h)],
                (true, true) => [centre(h), centre(g.next(h)), vertex(g.prev(h))],
                _ if self.is_foreign(h) => [vertex(g.next(t)), centre(t), self.centre_across(t, trisect)],
                _ if self.is_foreign(t) => [vertex(h), self.centre_across(h, trisect), centre(h)],
                _ => [vertex(h), centre(t), centre(h)],
            }
        };
        (0..g.half_edges()).flat_map(triangle).collect()
    }
}
