//! N-way: every edge in n equal parts and every face in a grid, whatever n is. Folklore; n = 2 on triangles and quads is the
//! linear scheme.
//!
//! ```text
//!       .            .---.---.---.       n = 3   triangles  n^2 triangles
//!      / \           |   |   |   |               quads      n^2 quads
//!     . - .          .---.---.---.               others     quads: a grid at each corner, and where n is odd strips between
//!    / \ / \         |   |   |   |                          the grids and a face of as many corners in the middle
//!   . - . - .        .---.---.---.
//! ```
//!
//! A face of k > 3 corners is the k bilinear patches of its quad split, one a corner: (corner, edge's middle, centroid, edge's
//! middle). Points of the grid lie on them at multiples of 2/n, so a quad is one bilinear patch at multiples of 1/n, a planar
//! polygon stays in its plane, and edges are cut alike from both sides.
//!
//! Cost: linear, as the other stored splits. Limit: it never smooths; n is at most 16.

use super::{Accepts, Creasing, Domain, Family, Info, Param, Scheme, Tags};
use crate::limit::LimitRule;
use crate::sink::{Row, Sink};
use crate::split::{Split, n_way::Grid};
use crate::topology::Connectivity;

/// See the module.
#[derive(Debug)]
pub struct NWay;

impl Scheme for NWay {
    const INFO: Info = Info {
        id: "n-way",
        name: "N-way",
        group: "linear",
        summary: "Cuts every edge in n equal parts and every face in a grid, and keeps the shape.",
        source: "folklore",
        accepts: Accepts::Polygons,
        family: Family::NWay,
        interpolating: true,
        params: &[Param {
            key: "n",
            name: "Parts",
            summary: "How many parts each edge is cut in, a level.",
            domain: Domain::Whole { low: 2, high: 16, default: 3 },
        }],
    };

    const CREASES: Creasing = Creasing::Rules;
    const LIMIT: LimitRule = LimitRule::Itself;

    fn rules<C: Connectivity, K: Sink>(c: &C, split: Split, tags: Tags<'_>, sink: &mut K) {
        let Split::NWay { n, triangles } = split else { return };
        let grid = Grid::of(c, n, triangles, tags.lone);
        let size = f64::from(n);
        sink.pass(0, c.vertices(), |v, row| row.vertex(v, 1.0));
        sink.pass(grid.first_edge, c.edges() * (n - 1), |i, row| {
            let (h, j) = (c.edge_half_edge(i / (n - 1)), f64::from(i % (n - 1) + 1));
            row.vertex(c.origin(h), (size - j) / size);
            row.vertex(c.origin(c.next(h)), j / size);
        });
        sink.pass(grid.first_inner, grid.triangles * grid.a_triangle, |i, row| {
            let h = c.face_half_edges(grid.triangle(i / grid.a_triangle)).start;
            let (x, y) = grid.place(i % grid.a_triangle);
            let (x, y) = (f64::from(x), f64::from(y));
            row.vertex(c.origin(h), (size - x - y) / size);
            row.vertex(c.origin(c.next(h)), x / size);
            row.vertex(c.origin(c.prev(h)), y / size);
        });
        sink.pass(grid.first_middle, grid.middles, |i, row| {
            let corners = c.face_half_edges(grid.polygon(i));
            let k = corners.len() as f64;
            corners.for_each(|h| row.vertex(c.origin(h), 1.0));
            row.scale(1.0 / k);
        });
        sink.pass(grid.first_corner, grid.corners * grid.a_corner, |i, row| {
            let (h, local) = (grid.corner(i / grid.a_corner), i % grid.a_corner);
            let (s, t) = (local / grid.rows + 1, local % grid.rows + 1);
            let (s, t) = (2.0 * f64::from(s) / size, 2.0 * f64::from(t) / size);
            let corners = c.face_half_edges(c.face(h));
            let k = corners.len() as f64;
            corners.for_each(|h| row.vertex(c.origin(h), s * t / k));
            let (along, back) = (s * (1.0 - t) / 2.0, t * (1.0 - s) / 2.0);
            row.vertex(c.origin(c.next(h)), along);
            row.vertex(c.origin(c.prev(h)), back);
            row.vertex(c.origin(h), (1.0 - s) * (1.0 - t) + along + back);
        });
    }
}
