//! The places of the dual split's faces.
//!
//! ```text
//!   a corner's image beside a seam that its chart gives away lies on the seam; beside two, or inside a fan around a vertex
//!   whose v-face is another's, at the vertex; else where the rules have it
//! ```

use super::{Charts, Place};
use crate::soup::NONE;
use crate::topology::{Connectivity, is_boundary};

/// Where the image of a corner is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Image {
    /// Where the rules have it.
    Own,
    /// On the side that leaves the corner, or on the one that arrives there.
    Leaving,
    Arriving,
    /// At the vertex.
    Vertex,
}

impl Charts<'_> {
    fn image(&self, h: u32, homes: &[u32]) -> Image {
        let (g, p) = (self.g, self.g.prev(h));
        let home = homes[g.origin(h) as usize];
        let stays = home == NONE || home == self.u.origin(h);
        let rim = |h| is_boundary(g.twin(h));
        match (self.is_foreign(h), self.is_foreign(p)) {
            (false, false) if stays => Image::Own,
            (true, false) if !rim(p) && (stays || home == self.u.origin(g.next(g.twin(h)))) => Image::Leaving,
            (false, true) if !rim(h) && (stays || home == self.u.origin(g.twin(p))) => Image::Arriving,
            _ => Image::Vertex,
        }
    }

    /// The places of the corners of all faces, in the order of the split's.
    pub(super) fn dual(&self, lone: &[u32]) -> Vec<Place> {
        let (g, u) = (self.g, self.u);
        let homes = self.homes(|spokes, _| spokes >= 3);
        let images: Vec<Image> = (0..g.half_edges()).map(|h| self.image(h, &homes)).collect();
        let own = |h: u32| match images[h as usize] {
            Image::Own => Place::Image(h),
            Image::Leaving => Place::Along(u.origin(h), u.origin(g.next(h))),
            Image::Arriving => Place::Along(u.origin(h), u.origin(g.prev(h))),
            Image::Vertex => Place::Point(u.origin(h)),
        };
        let mut places = Vec::with_capacity(4 * g.half_edges() as usize);
        let mut second = lone.iter().zip(g.half_edges()..).peekable();
        for h in 0..g.half_edges() {
            places.push(own(h));
            places.extend(second.next_if(|s| *s.0 == h).map(|s| Place::Image(s.1)));
        }
        for e in 0..g.edges() {
            let h = g.edge_half_edge(e);
            let t = g.twin(h);
            if is_boundary(t) {
                continue;
            }
            // The far side's images, on this side's seam.
            let across = |o: u32| {
                let ([a, b], s) = (self.ends(o), g.twin(o));
                let place = |h: u32, seam, [near, far]: [u32; 2]| match images[h as usize] == seam {
                    true => Place::Along(near, far),
                    false => Place::Point(near),
                };
                [place(g.next(s), Image::Arriving, [a, b]), place(s, Image::Leaving, [b, a])]
            };
            let here = |h: u32| [own(g.next(h)), own(h)];
            let (near, far) = match (self.is_foreign(h), self.is_foreign(t)) {
                (true, _) => (across(t), here(t)),
                (_, true) => (here(h), across(h)),
                _ => (here(h), here(t)),
            };
            places.extend(near.into_iter().chain(far));
        }
        for v in (0..g.vertices()).filter(|v| homes[*v as usize] != NONE) {
            let home = homes[v as usize];
            g.turn(v, |h| {
                places.push(match images[h as usize] {
                    _ if u.origin(h) == home => own(h),
                    Image::Leaving => Place::Along(home, u.origin(g.twin(h))),
                    Image::Arriving => Place::Along(home, u.origin(g.next(g.twin(g.prev(h))))),
                    _ => Place::Point(home),
                });
            });
        }
        places
    }
}
