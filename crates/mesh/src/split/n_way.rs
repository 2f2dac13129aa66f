//! The n-way split: every edge in n parts, triangles in n^2 triangles, other polygons in quads.
//!
//! ```text
//!   triangle, n = 3          corner of a polygon, n = 4         n = 5: strips between the corners, and a k-gon in the middle
//!
//!       C                    p---.---M---                       .   .  | |  .   .
//!      / \                   |   |   |  M: the middle           .---.--.-.--.---.
//!     .---.    y up C        .---o---s---                       | j |  |s|  |   |
//!    / \ / \                 | j |   |  s: on the spoke         .---.--.-.--.---.
//!   .---o---.  x along h     v---.---.---                       h i    strip
//!  / \ / \ / \                  i along h
//! A---.---.---B
//!
//!   child vertices: old [0, V) | edges, n - 1 each | triangles' inner points | polygons' middles (n even) | corners' points
//! ```
//!
//! Child half-edges lie face by face; in a polygon corner by corner: its grid of quads, then (n odd) the strip along its
//! half-edge; the middle last. All twins are arithmetic in them. Cost: linear.

use super::FaceShape;
use super::stored::Cut;
use crate::connect::UNMATCHED;
use crate::topology::{Connectivity, Topology, is_boundary};

/// Which faces are cut as triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Triangles {
    /// All are triangles.
    All,
    /// Those that are.
    Some,
    /// None: all are quads.
    None,
}

impl Triangles {
    /// For faces of this shape.
    pub fn of(shape: FaceShape) -> Triangles {
        match shape {
            FaceShape::Triangles => Triangles::All,
            FaceShape::Quads => Triangles::None,
            FaceShape::Polygons => Triangles::Some,
        }
    }
}

/// Triangles, then other faces, then corners of those: where they are not all alike.
pub(super) fn list(c: &impl Connectivity) -> Vec<u32> {
    let is_triangle = |f: &u32| c.face_half_edges(*f).len() == 3;
    let mut list: Vec<u32> = (0..c.faces()).filter(is_triangle).collect();
    list.extend((0..c.faces()).filter(|f| !is_triangle(f)));
    list.extend((0..c.half_edges()).filter(|&h| !is_triangle(&c.face(h))));
    list
}

/// The numbers of a level's new vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid<'a> {
    n: u32,
    faces: u32,
    list: &'a [u32],
    /// The first vertex on edges, in triangles, in the middle of polygons, and of their corners.
    pub first_edge: u32,
    pub first_inner: u32,
    pub first_middle: u32,
    pub first_corner: u32,
    /// How many triangles there are, middles of polygons, and corners of those.
    pub triangles: u32,
    pub middles: u32,
    pub corners: u32,
    /// Points in a triangle, and of a corner.
    pub a_triangle: u32,
    pub a_corner: u32,
    /// The second factor of a corner's points.
    pub rows: u32,
}

impl<'a> Grid<'a> {
    /// `list` is [`list`]'s where it is needed.
    pub fn of(c: &impl Connectivity, n: u32, triangles: Triangles, list: &'a [u32]) -> Grid<'a> {
        let (triangles, corners) = match triangles {
            Triangles::All => (c.faces(), 0),
            Triangles::None => (0, c.half_edges()),
            // The list has all faces once, and the corners.
            Triangles::Some => {
                let corners = list.len() as u32 - c.faces();
                ((c.half_edges() - corners) / 3, corners)
            }
        };
        let (a_triangle, rows) = ((n - 1) * (n - 2) / 2, (n - 1) / 2);
        let first_inner = c.vertices() + (n - 1) * c.edges();
        let first_middle = first_inner + triangles * a_triangle;
        let middles = if n.is_multiple_of(2) { c.faces() - triangles } else { 0 };
        Grid {
            n,
            faces: c.faces(),
            list,
            first_edge: c.vertices(),
            first_inner,
            first_middle,
            first_corner: first_middle + middles,
            triangles,
            middles,
            corners,
            a_triangle,
            a_corner: n / 2 * rows,
            rows,
        }
    }

    pub fn vertices(&self) -> u32 {
        self.first_corner + self.corners * self.a_corner
    }

    /// The face of a triangle's rank, of another polygon's, and the half-edge of the rank of one of their corners.
    pub fn triangle(&self, rank: u32) -> u32 {
        if self.list.is_empty() { rank } else { self.list[rank as usize] }
    }

    pub fn polygon(&self, rank: u32) -> u32 {
        if self.list.is_empty() { rank } else { self.list[(self.triangles + rank) as usize] }
    }

    pub fn corner(&self, rank: u32) -> u32 {
        if self.list.is_empty() { rank } else { self.list[(self.faces + rank) as usize] }
    }

    /// Where point `i` of a triangle lies: x along its first half-edge, y away from it, both at least 1.
    pub fn place(&self, mut i: u32) -> (u32, u32) {
        let mut y = 1;
        while i >= self.n - 1 - y {
            i -= self.n - 1 - y;
            y += 1;
        }
        (i + 1, y)
    }

    fn inner(&self, rank: u32, x: u32, y: u32) -> u32 {
        let before = (y - 1) * (self.n - 1) - y * (y - 1) / 2;
        self.first_inner + rank * self.a_triangle + before + x - 1
    }

    /// The vertex `i` of n parts along `h`.
    fn along(&self, c: &impl Connectivity, h: u32, i: u32) -> u32 {
        if i == 0 {
            return c.origin(h);
        }
        if i == self.n {
            return c.origin(c.next(h));
        }
        let e = c.edge(h);
        let i = if c.edge_half_edge(e) == h { i } else { self.n - i };
        self.first_edge + e * (self.n - 1) + i - 1
    }

    /// The vertex of a triangle of rank `rank` whose first half-edge is `h`.
    fn in_triangle(&self, c: &impl Connectivity, (rank, h): (u32, u32), x: u32, y: u32) -> u32 {
        match (x, y) {
            (x, 0) => self.along(c, h, x),
            (0, y) => self.along(c, c.prev(h), self.n - y),
            (x, y) if x + y == self.n => self.along(c, c.next(h), y),
            _ => self.inner(rank, x, y),
        }
    }

    /// The vertex of a polygon at corner `h`, `i` along it and `j` along the half-edge before; the first corner of the polygon
    /// has rank `first.0` and is half-edge `first.1`, the polygon has rank `polygon`.
    fn at_corner(&self, c: &impl Connectivity, polygon: u32, first: (u32, u32), h: u32, i: u32, j: u32) -> u32 {
        let point = |h: u32, i: u32, j: u32| {
            let rank = first.0 + h - first.1;
            self.first_corner + rank * self.a_corner + (i - 1) * self.rows + j - 1
        };
        match (i, j) {
            (i, 0) => self.along(c, h, i),
            (0, j) => self.along(c, c.prev(h), self.n - j),
            _ if 2 * i == self.n && 2 * j == self.n => self.first_middle + polygon,
            // On the spoke of the half-edge before, which is that corner's last column.
            (i, j) if 2 * j == self.n => point(c.prev(h), j, i),
            _ => point(h, i, j),
        }
    }
}

/// The child faces.
pub(super) fn faces(c: &Topology, n: u32, triangles: Triangles, list: &[u32]) -> Cut {
    let grid = Grid::of(c, n, triangles, list);
    let (half, odd) = (n / 2, n % 2 == 1);
    let room = c.half_edges() as usize * (n * n) as usize;
    let least = if triangles == Triangles::None { 4 } else { 3 };
    let mut out = Cut::with_room(room / least + c.faces() as usize, room + c.half_edges() as usize, false);
    let (mut triangle, mut polygon, mut corner) = (0, 0, 0);
    for f in 0..c.faces() {
        let corners = c.face_half_edges(f);
        let h = corners.start;
        if is_cut_as_triangle(c, f, triangles) {
            let at = |x, y| grid.in_triangle(c, (triangle, h), x, y);
            for y in 0..n {
                for x in 0..n - y {
                    out.corners.extend([at(x, y), at(x + 1, y), at(x, y + 1)]);
                    out.close(f, None);
                    if x + y + 1 < n {
                        out.corners.extend([at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
                        out.close(f, None);
                    }
                }
            }
            triangle += 1;
            continue;
        }
        let at = |h, i, j| grid.at_corner(c, polygon, (corner, corners.start), h, i, j);
        for h in corners.clone() {
            for i in 0..half {
                for j in 0..half {
                    out.corners.extend([at(h, i, j), at(h, i + 1, j), at(h, i + 1, j + 1), at(h, i, j + 1)]);
                    out.close(f, None);
                }
            }
            if odd {
                let x = c.next(h);
                for j in 0..half {
                    out.corners.extend([at(h, half, j), at(x, j, half), at(x, j + 1, half), at(h, half, j + 1)]);
                    out.close(f, None);
                }
            }
        }
        if odd {
            out.corners.extend(corners.clone().map(|h| at(h, half, half)));
            out.close(f, None);
        }
        polygon += 1;
        corner += corners.len() as u32;
    }
    out
}

fn is_cut_as_triangle(c: &impl Connectivity, f: u32, triangles: Triangles) -> bool {
    match triangles {
        Triangles::All => true,
        Triangles::Some => c.face_half_edges(f).len() == 3,
        Triangles::None => false,
    }
}

/// Where child half-edges are.
pub(crate) struct Places<'a, C> {
    c: &'a C,
    n: u32,
    triangles: Triangles,
    /// The first child half-edge of each face.
    start: Vec<u32>,
    /// How many there are.
    all: u32,
}

impl<'a, C: Connectivity> Places<'a, C> {
    pub fn new(c: &'a C, n: u32, triangles: Triangles) -> Places<'a, C> {
        let mut p = Places { c, n, triangles, start: Vec::with_capacity(c.faces() as usize), all: 0 };
        for f in 0..c.faces() {
            p.start.push(p.all);
            let k = c.face_half_edges(f).len() as u32;
            p.all += match is_cut_as_triangle(c, f, triangles) {
                true => 3 * n * n,
                false => 4 * k * p.a_corner() + if n % 2 == 1 { k } else { 0 },
            };
        }
        p
    }

    /// Quads of a polygon's corner: its grid, and the strip where n is odd.
    fn a_corner(&self) -> u32 {
        let half = self.n / 2;
        half * half + if self.n % 2 == 1 { half } else { 0 }
    }

    /// Half-edge `side` of the quad in column `i` and row `j` of corner `h`.
    fn quad(&self, h: u32, i: u32, j: u32, side: u32) -> u32 {
        self.of_corner(h, i * (self.n / 2) + j, side)
    }

    /// The same of the strip behind it, `j` away from the polygon's edge.
    fn strip(&self, h: u32, j: u32, side: u32) -> u32 {
        let half = self.n / 2;
        self.of_corner(h, half * half + j, side)
    }

    fn of_corner(&self, h: u32, quad: u32, side: u32) -> u32 {
        let f = self.c.face(h);
        let corner = h - self.c.face_half_edges(f).start;
        self.start[f as usize] + 4 * (corner * self.a_corner() + quad) + side
    }

    /// The middle's half-edge at corner `h`.
    fn middle(&self, h: u32) -> u32 {
        let f = self.c.face(h);
        let corners = self.c.face_half_edges(f);
        self.start[f as usize] + 4 * corners.len() as u32 * self.a_corner() + h - corners.start
    }

    /// Half-edge `side` of the triangle in row `y`: of those that stand (`down` 0) or hang (1), number `x`.
    fn triangle(&self, f: u32, x: u32, y: u32, down: u32, side: u32) -> u32 {
        let row = self.n * self.n - (self.n - y) * (self.n - y);
        self.start[f as usize] + 3 * (row + 2 * x + down) + side
    }

    /// The child half-edge on part `s` of half-edge `h`, counted from its origin.
    pub fn slot(&self, h: u32, s: u32) -> u32 {
        let (c, n, half) = (self.c, self.n, self.n / 2);
        let f = c.face(h);
        if is_cut_as_triangle(c, f, self.triangles) {
            return match h - c.face_half_edges(f).start {
                0 => self.triangle(f, s, 0, 0, 0),
                1 => self.triangle(f, n - 1 - s, s, 0, 1),
                _ => self.triangle(f, 0, n - 1 - s, 0, 2),
            };
        }
        if s < half {
            self.quad(h, s, 0, 0)
        } else if n % 2 == 1 && s == half {
            self.strip(h, 0, 0)
        } else {
            self.quad(c.next(h), 0, n - 1 - s, 3)
        }
    }

    /// What lies across part `s` of half-edge `h`.
    fn across(&self, h: u32, s: u32) -> u32 {
        let t = self.c.twin(h);
        if is_boundary(t) { UNMATCHED } else { self.slot(t, self.n - 1 - s) }
    }
}

/// Their twins.
pub(super) fn mates(c: &Topology, n: u32, triangles: Triangles) -> Vec<u32> {
    let (half, odd) = (n / 2, n % 2 == 1);
    let p = Places::new(c, n, triangles);
    let mut mate = Vec::with_capacity(p.all as usize);
    for f in 0..c.faces() {
        let corners = c.face_half_edges(f);
        let h = corners.start;
        if is_cut_as_triangle(c, f, triangles) {
            for y in 0..n {
                for x in 0..n - y {
                    let last = x + y + 1 == n;
                    mate.extend([
                        if y == 0 { p.across(h, x) } else { p.triangle(f, x, y - 1, 1, 1) },
                        if last { p.across(h + 1, y) } else { p.triangle(f, x, y, 1, 2) },
                        if x == 0 { p.across(h + 2, n - 1 - y) } else { p.triangle(f, x - 1, y, 1, 0) },
                    ]);
                    if !last {
                        mate.extend([
                            p.triangle(f, x + 1, y, 0, 2),
                            p.triangle(f, x, y + 1, 0, 0),
                            p.triangle(f, x, y, 0, 1),
                        ]);
                    }
                }
            }
            continue;
        }
        for h in corners.clone() {
            let (next, prev) = (c.next(h), c.prev(h));
            for i in 0..half {
                for j in 0..half {
                    let (right, top) = (i + 1 == half, j + 1 == half);
                    mate.extend([
                        if j == 0 { p.across(h, i) } else { p.quad(h, i, j - 1, 2) },
                        match (right, odd) {
                            (false, _) => p.quad(h, i + 1, j, 3),
                            (true, false) => p.quad(next, j, half - 1, 2),
                            (true, true) => p.strip(h, j, 3),
                        },
                        match (top, odd) {
                            (false, _) => p.quad(h, i, j + 1, 0),
                            (true, false) => p.quad(prev, half - 1, i, 1),
                            (true, true) => p.strip(prev, i, 1),
                        },
                        if i == 0 { p.across(prev, n - 1 - j) } else { p.quad(h, i - 1, j, 1) },
                    ]);
                }
            }
            if odd {
                for j in 0..half {
                    mate.extend([
                        if j == 0 { p.across(h, half) } else { p.strip(h, j - 1, 2) },
                        p.quad(next, j, half - 1, 2),
                        if j + 1 == half { p.middle(h) } else { p.strip(h, j + 1, 0) },
                        p.quad(h, half - 1, j, 1),
                    ]);
                }
            }
        }
        if odd {
            mate.extend(corners.map(|h| p.strip(h, half - 1, 2)));
        }
    }
    mate
}
