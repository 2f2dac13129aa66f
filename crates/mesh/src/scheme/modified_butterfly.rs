//! Modified Butterfly (D. Zorin, P. Schroeder, W. Sweldens, "Interpolating subdivision for meshes with arbitrary topology",
//! 1996): the butterfly with rules of its own wherever the valence is not six.
//!
//! An edge between regular vertices takes the eight points of [`super::Butterfly`] with w = 1/16. Beside an extraordinary
//! vertex of valence k it takes that vertex and its ring; between two of them, the mean of both answers.
//!
//! ```text
//!       s1                  interior, k edges:   s_j = (1/4 + cos 2 pi j / k + cos(4 pi j / k) / 2) / k,  k >= 5
//!    s2    \   s0                                5/12, -1/12, -1/12 (k = 3)    3/8, 0, -1/8, 0 (k = 4)
//!      `--- v ---x--- .      boundary, k faces:   Zorin's crease rule (Zorin & Schroeder, "Subdivision for modeling and
//!          / \                                   animation", 2000, section 4.3), theta = pi / k, edge i of 0..=k
//!       s3     s4
//! ```
//!
//! Beyond a boundary, wings are reflections, which at a regular boundary vertex (three faces) keeps linear functions
//! linear; the boundary is the four-point curve. Tagged edges follow the boundary's rules from both sides, as in the notes, and
//! vertices beside a crease those beside a boundary ([`crate::apart`]). C1 everywhere. Cost: about 13 ns an output face, more beside
//! extraordinary vertices; after the first step only the mesh's own vertices can be such ([`Tags::first_regular`]).

use super::butterfly::{eight_points, four_points};
use super::{Accepts, Creasing, Family, Info, Scheme, Tags};
use crate::sink::{Row, Sink};
use crate::split::Split;
use crate::topology::{Connectivity, is_boundary};
use std::f64::consts::PI;

/// See the module.
#[derive(Debug)]
pub struct ModifiedButterfly;

/// Dyn, Levin and Gregory's tension.
const W: f64 = 1.0 / 16.0;

impl Scheme for ModifiedButterfly {
    const INFO: Info = Info {
        id: "modified-butterfly",
        name: "Modified Butterfly",
        group: "interpolating",
        summary: "Smooths triangles through their own vertices, evenly at every valence.",
        source: "Zorin, Schröder & Sweldens 1996",
        accepts: Accepts::Triangles,
        family: Family::Primal,
        interpolating: true,
        params: &[],
    };

    const CREASES: Creasing = Creasing::Apart;

    #[inline(always)]
    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        sink.pass(split.first_edge_point(c), c.edges(), |e, row| {
            let h = c.edge_half_edge(e);
            let twin = c.twin(h);
            if is_boundary(twin) {
                return row.apart(|row| four_points(c, h, W, tags, row));
            }
            let is_irregular = |h: u32| c.origin(h) < tags.first_regular && Ring::of(c, h).is_irregular();
            match (is_irregular(h), is_irregular(twin)) {
                (false, false) => eight_points(c, h, W, row),
                (true, false) => row.apart(|row| Ring::of(c, h).rule(c, 1.0, row)),
                (false, true) => row.apart(|row| Ring::of(c, twin).rule(c, 1.0, row)),
                (true, true) => row.apart(|row| {
                    Ring::of(c, h).rule(c, 0.5, row);
                    Ring::of(c, twin).rule(c, 0.5, row);
                }),
            }
        });
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
    }
}

/// A vertex seen along one of its edges.
struct Ring {
    vertex: u32,
    /// The edge's half-edge that leaves it.
    along: u32,
    /// Where the turn starts.
    first: u32,
    faces: u32,
    boundary: bool,
    /// How many spokes come before `along` in the turn.
    place: u32,
}

impl Ring {
    /// Around the origin of `h`. Cost: the valence.
    #[inline(never)]
    fn of<C: Connectivity>(c: &C, h: u32) -> Ring {
        let vertex = c.origin(h);
        let first = c.first_spoke(h);
        let (mut faces, mut place) = (0, 0);
        let arriving = c.turn_from(first, |spoke| {
            if spoke == h {
                place = faces;
            }
            faces += 1;
        });
        Ring { vertex, along: h, first, faces, boundary: arriving.is_some(), place }
    }

    /// Whether it has a rule of its own.
    fn is_irregular(&self) -> bool {
        self.faces != if self.boundary { 3 } else { 6 }
    }

    /// Adds the vertex's own rule for the edge point, `share` times.
    #[inline(never)]
    fn rule<C: Connectivity>(&self, c: &C, share: f64, row: &mut impl Row) {
        let k = f64::from(self.faces);
        if self.boundary {
            let theta = PI / k;
            let i = f64::from(self.place) * theta;
            let end = 0.25 * libm::cos(i)
                - libm::sin(2.0 * theta) * libm::sin(2.0 * i) / (4.0 * k * (libm::cos(theta) - libm::cos(2.0 * theta)));
            let own = 1.0 - libm::sin(theta) * libm::sin(i) / (k * (1.0 - libm::cos(theta)));
            row.vertex(self.vertex, share * own);
            let mut j = 0.0;
            let arriving = c.turn_from(self.first, |spoke| {
                let at = j * theta;
                let inner = (libm::sin(i) * libm::sin(at) + 0.5 * libm::sin(2.0 * i) * libm::sin(2.0 * at)) / k;
                row.vertex(c.origin(c.next(spoke)), share * if j == 0.0 { end } else { inner });
                j += 1.0;
            });
            if let Some(arriving) = arriving {
                row.vertex(c.origin(arriving), -share * end);
            }
            return;
        }
        row.vertex(self.vertex, share * 0.75);
        let mut j = 0;
        c.turn_from(self.along, |spoke| {
            let at = 2.0 * PI * f64::from(j) / k;
            let weight = match (self.faces, j) {
                // The parabola through three points in a row, as at four with the other two left out.
                (2, 0) => 0.375,
                (2, _) => -0.125,
                (3, 0) => 5.0 / 12.0,
                (3, _) => -1.0 / 12.0,
                (4, 0) => 0.375,
                (4, 2) => -0.125,
                (4, _) => 0.0,
                _ => (0.25 + libm::cos(at) + 0.5 * libm::cos(2.0 * at)) / k,
            };
            row.vertex(c.origin(c.next(spoke)), share * weight);
            j += 1;
        });
    }
}
