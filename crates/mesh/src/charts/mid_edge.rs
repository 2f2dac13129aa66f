//! The places of the mid-edge split's faces.
//!
//! ```text
//!   a midpoint on a seam is one in both charts. What moves is inside a fan around a vertex whose v-face is another's:
//!
//!        A   |   B          the v-face of v is A's, with the middles of the seam and of A's edges;
//!      --o-- v --x--        the middle x of B's edge lies at v, in both charts
//!            |
//! ```
//!
//! An edge both of whose ends have foreign v-faces keeps its middle: its texture does not fit there.

use super::{Charts, Place};
use crate::soup::NONE;
use crate::split::mid_edge::has_face;
use crate::topology::{Connectivity, is_boundary};

impl Charts<'_> {
    /// Whether the v-face at the origin of `h` is in no chart beside the edge of `h`.
    fn is_apart(&self, h: u32, homes: &[u32]) -> bool {
        let (g, t) = (self.g, self.g.twin(h));
        let home = homes[g.origin(h) as usize];
        home != NONE && home != self.u.origin(h) && (is_boundary(t) || home != self.u.origin(g.next(t)))
    }

    /// The middle of the edge of `h` in the chart of `h`.
    fn middle(&self, h: u32, homes: &[u32]) -> Place {
        let (g, t) = (self.g, self.g.twin(h));
        // On a boundary there is no half-edge that leaves the other end: the turn's last spoke arrives there.
        let far = match is_boundary(t) {
            true => {
                let home = homes[g.origin(g.next(h)) as usize];
                home != NONE && home != self.u.origin(g.next(h))
            }
            false => self.is_apart(t, homes),
        };
        match (self.is_apart(h, homes), far) {
            (true, false) => Place::Point(self.u.origin(h)),
            (false, true) => Place::Point(self.u.origin(g.next(h))),
            _ => Place::Image(self.u.edge(h)),
        }
    }

    /// The places of the corners of all faces, in the order of the split's.
    pub(super) fn mid_edge(&self, cut: bool, kept: &[u32]) -> Vec<Place> {
        let (g, u) = (self.g, self.u);
        let homes = self.homes(|spokes, boundary| has_face(spokes, boundary, cut));
        let mut places = Vec::with_capacity(2 * g.half_edges() as usize);
        let mut corner = kept.iter().peekable();
        for h in 0..g.half_edges() {
            places.push(self.middle(g.prev(h), &homes));
            places.extend(corner.next_if(|k| **k == h).map(|_| Place::Point(u.origin(h))));
        }
        for v in (0..g.vertices()).filter(|v| homes[*v as usize] != NONE) {
            let home = homes[v as usize];
            let arriving = g.turn(v, |h| {
                let t = g.twin(h);
                places.push(if u.origin(h) == home {
                    self.middle(h, &homes)
                } else if !is_boundary(t) && u.origin(g.next(t)) == home {
                    self.middle(t, &homes)
                } else {
                    Place::Point(home)
                });
            });
            if let Some(arriving) = arriving {
                let own = u.origin(g.next(arriving)) == home;
                places.push(if own { self.middle(arriving, &homes) } else { Place::Point(home) });
                if !cut {
                    places.push(Place::Point(home));
                }
            }
        }
        places
    }
}
