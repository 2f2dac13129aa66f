//! How many of everything a split makes, in closed form.
//!
//! Faces and corners come first; edges are half the corners and the rim together, since every edge has two sides but those of
//! the rim. Cost: constant. Limit: 64 bits.

use super::{Split, Triangles};
use crate::topology::{CHAINS, Counts};

impl Split {
    /// The counts one level further, or none if they do not fit 64 bits.
    pub fn counts(self, c: Counts) -> Option<Counts> {
        let [one, two, three, more] = c.rim;
        let new = match self {
            Split::Quad => Counts {
                vertices: c.vertices.checked_add(c.edges)?.checked_add(c.faces)?,
                edges: c.edges.checked_mul(2)?.checked_add(c.corners)?,
                faces: c.corners,
                corners: c.corners.checked_mul(4)?,
                boundary: c.boundary.checked_mul(2)?,
                triangles: [0; 2],
                rim: [one, two.checked_add(c.boundary)?, three, more],
                tips: 0,
                digons: c.digons,
                chains: lonely(c.digons),
            },
            Split::Triangle => Counts {
                vertices: c.vertices.checked_add(c.edges)?,
                edges: c.edges.checked_mul(2)?.checked_add(c.corners)?,
                faces: c.faces.checked_mul(4)?,
                corners: c.corners.checked_mul(4)?,
                boundary: c.boundary.checked_mul(2)?,
                triangles: [c.faces.checked_mul(4)?, c.boundary.checked_mul(2)?],
                rim: [one, two, three.checked_add(c.boundary)?, more],
                tips: one,
                digons: c.digons,
                chains: lonely(c.digons),
            },
            Split::Mixed => {
                let [triangles, sides] = c.triangles;
                let pointed = c.faces.checked_sub(triangles)?;
                Counts {
                    vertices: c.vertices.checked_add(c.edges)?.checked_add(pointed)?,
                    edges: c.edges.checked_mul(2)?.checked_add(c.corners)?,
                    faces: c.corners.checked_add(triangles)?,
                    corners: c.corners.checked_mul(4)?,
                    boundary: c.boundary.checked_mul(2)?,
                    triangles: [triangles.checked_mul(4)?, sides.checked_mul(2)?],
                    rim: [one, two.checked_add(c.boundary.checked_sub(sides)?)?, three.checked_add(sides)?, more],
                    tips: c.tips,
                    digons: c.digons,
                    chains: lonely(c.digons),
                }
            }
            Split::Dual { rounded } => {
                let inner = c.edges.checked_sub(c.boundary)?;
                let extra = if rounded { one } else { 0 };
                // Vertices without a v-face: on a boundary with one or two faces, inside with two.
                let bare = one.checked_add(two)?.checked_add(c.digons)?;
                let boundary = c.boundary.checked_mul(2)?.checked_sub(one)?.checked_add(extra)?;
                let spared = one.checked_add(two.checked_add(c.digons)?.checked_mul(2)?)?;
                let corners = c
                    .corners
                    .checked_mul(2)?
                    .checked_add(inner.checked_mul(4)?)?
                    .checked_add(extra)?
                    .checked_sub(spared)?;
                Counts {
                    vertices: c.corners.checked_add(extra)?,
                    edges: corners.checked_add(boundary)? / 2,
                    faces: c.faces.checked_add(inner)?.checked_add(c.vertices)?.checked_sub(bare)?,
                    corners,
                    boundary,
                    // Not followed: triangles come of vertices too.
                    triangles: [0; 2],
                    rim: [one.checked_add(extra)?, two.checked_mul(2)?, three.checked_add(more)?.checked_mul(2)?, 0],
                    // A rounded corner adds a side to its face.
                    tips: if rounded { 0 } else { c.tips },
                    ..Counts::default()
                }
            }
            Split::Sqrt3 { trisect } => {
                let boundary = if trisect { c.boundary.checked_mul(3)? } else { c.boundary };
                let corners = c.corners.checked_mul(3)?;
                let new = if trisect { c.boundary } else { 0 };
                Counts {
                    vertices: c.vertices.checked_add(c.faces)?.checked_add(new)?,
                    edges: corners.checked_add(boundary)? / 2,
                    faces: c.corners,
                    corners,
                    boundary,
                    triangles: [c.corners, boundary],
                    // A boundary vertex gains a face where edges turn and loses it where they are cut, which comes next:
                    // only between the two are three and more told apart.
                    rim: if trisect {
                        [two, three, more.checked_add(new.checked_mul(2)?)?, 0]
                    } else {
                        [0, one, two, three.checked_add(more)?]
                    },
                    tips: if trisect { two } else { 0 },
                    digons: c.digons,
                    chains: lonely(c.digons),
                }
            }
            Split::MidEdge { cut, corners } => {
                // Vertices of two faces inside have no face; between two of them lies the midpoint that is the next such.
                let [ending, chains @ ..] = c.chains;
                let mut shorter = [0; CHAINS];
                shorter.iter_mut().zip(chains).for_each(|(to, from)| *to = from);
                let kept = if !cut {
                    c.boundary
                } else if corners {
                    c.tips
                } else {
                    0
                };
                let bare = if cut { c.digons.checked_add(one)? } else { c.digons };
                // Corners of v-faces: one a corner, and on a rim one more, or two where it is kept.
                let on_rim = if cut { c.boundary.checked_sub(one)? } else { c.boundary.checked_mul(2)? };
                let spared = c.digons.checked_mul(2)?.checked_add(if cut { one } else { 0 })?;
                let f_corners = if cut { c.corners.checked_add(kept)? } else { c.corners };
                let corners = f_corners.checked_add(c.corners)?.checked_add(on_rim)?.checked_sub(spared)?;
                let boundary = c.boundary.checked_add(kept)?;
                Counts {
                    vertices: c.edges.checked_add(kept)?,
                    edges: corners.checked_add(boundary)? / 2,
                    faces: c.faces.checked_add(c.vertices)?.checked_sub(bare)?,
                    corners,
                    boundary,
                    triangles: [0; 2],
                    rim: if cut { [kept, c.boundary, 0, 0] } else { [kept, 0, c.boundary, 0] },
                    tips: if cut { 0 } else { one },
                    digons: c.digons.checked_sub(ending.into())?,
                    chains: shorter,
                }
            }
            Split::Poke => Counts {
                vertices: c.vertices.checked_add(c.faces)?,
                edges: c.edges.checked_add(c.corners)?,
                faces: c.corners,
                corners: c.corners.checked_mul(3)?,
                boundary: c.boundary,
                triangles: [c.corners, c.boundary],
                rim: [0, one, 0, two.checked_add(three)?.checked_add(more)?],
                ..Counts::default()
            },
            Split::NWay { n, triangles } => {
                let n = u64::from(n);
                let [triangles, sides] = match triangles {
                    Triangles::All => [c.faces, c.boundary],
                    Triangles::Some => c.triangles,
                    Triangles::None => [0; 2],
                };
                let (half, rows, odd) = (n / 2, (n - 1) / 2, n % 2);
                let polygons = c.faces.checked_sub(triangles)?;
                let corners = c.corners.checked_sub(triangles.checked_mul(3)?)?;
                let in_triangles = triangles.checked_mul((n - 1) * (n - 2) / 2)?;
                let middles = if odd == 0 { polygons } else { 0 };
                let quads = corners.checked_mul(half * half + odd * half)?;
                let small = triangles.checked_mul(n * n)?;
                let new_corners = small.checked_mul(3)?.checked_add(quads.checked_mul(4)?)?;
                let new_corners = new_corners.checked_add(odd * corners)?;
                let boundary = c.boundary.checked_mul(n)?;
                Counts {
                    vertices: c
                        .vertices
                        .checked_add(c.edges.checked_mul(n - 1)?)?
                        .checked_add(in_triangles)?
                        .checked_add(middles)?
                        .checked_add(corners.checked_mul(half * rows)?)?,
                    edges: new_corners.checked_add(boundary)? / 2,
                    faces: small.checked_add(quads)?.checked_add(odd * polygons)?,
                    corners: new_corners,
                    boundary,
                    triangles: [small, sides.checked_mul(n)?],
                    rim: [
                        one,
                        two.checked_add(c.boundary.checked_sub(sides)?.checked_mul(n - 1)?)?,
                        three.checked_add(sides.checked_mul(n - 1)?)?,
                        more,
                    ],
                    tips: if sides == 0 { 0 } else { c.tips },
                    digons: c.digons,
                    chains: lonely(c.digons),
                }
            }
        };
        Some(new)
    }
}

/// So many inner vertices of two faces, no two of them neighbours.
fn lonely(digons: u64) -> [u32; CHAINS] {
    let mut chains = [0; CHAINS];
    // No level that can be made has more.
    chains[0] = digons.min(u32::MAX.into()) as u32;
    chains
}
