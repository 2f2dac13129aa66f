//! Sharp edges around a vertex that its half-edges do not see, because the vertex was cut apart.
//!
//! Rules of creases ask for all edges at a vertex. Where three faces meet on an edge each sheet has a copy of its own, and
//! where a seam ends a region of texture coordinates so has each region:
//!
//! ```text
//!          | 1.5                  the copy on the left sees its own edges; in its list stand
//!     _____v_____                   a copy of the mesh          1.5, 2.5: they count for its rule, and for Chaikin's decay
//!    /     |2.5   \                 a region beside a seam      1.5, 2.5: for Chaikin's decay alone, unless it leans
//!   left        right
//! ```
//!
//! By two of OpenSubdiv's rules of face-varying interpolation (corners+1 and corners+2) a region without a sharp edge *leans*
//! on the only other one: it stays a corner for as long as the other does, and softens by the other's share (its
//! `Vtr::FVarLevel`, "dependent sharpness"). Where the other ends and the seam itself is still sharp, it stays for one step more.
//!
//! Edges made on a cut have no sharp neighbours there, so only vertices of level 0 have a list. Cost: the valence of such
//! vertices where something is semi-sharp, a binary search a question.

use crate::marks::INFINITE;
use crate::mesh::Mesh;
use crate::scheme::FaceVarying;
use crate::topology::{Connectivity, Topology, is_boundary};

/// Where a semi-sharp edge lies, seen from a vertex that does not see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// At another copy of the mesh's vertex.
    Copy,
    /// Inside another region of texture coordinates.
    Region,
    /// On a seam.
    Seam,
}

/// The semi-sharp edges at the other copies of a vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Beyond {
    /// The vertex.
    pub vertex: u32,
    /// How sharp each is, and where.
    pub edges: Vec<(f32, Place)>,
    /// Whether it stays for as long as an edge in the other region is sharp.
    pub leans: bool,
}

impl Beyond {
    /// The list one level further, where edges are as sharp as `left` says of what they are; none if that is nothing.
    pub fn below(&self, left: impl Fn(f32) -> f32) -> Option<Beyond> {
        let edges: Vec<_> = self.edges.iter().map(|&(s, at)| (left(s), at)).filter(|x| x.0 > 0.0).collect();
        let leans = self.leans && edges.iter().any(|x| x.1 == Place::Region);
        (!edges.is_empty()).then_some(Beyond { vertex: self.vertex, edges, leans })
    }
}

/// A sharp edge at one of the copies: its sharpness, the mesh's vertex there, and the vertex that sees it (none on a seam).
type Seen = (f32, u32, Option<u32>);

/// The lists of all vertices of `t`, the mesh's own half-edges or those of its texture coordinates, by rising vertices.
pub(crate) fn of(mesh: &Mesh, t: &Topology, rule: FaceVarying) -> Vec<Beyond> {
    let own = &mesh.topology;
    if mesh.edge_sharpness.is_empty() {
        return Vec::new();
    }
    // Vertices by the position that they are copies of.
    let source = |v: u32| mesh.vertex_source[own.origin(t.vertex_half_edge(v)) as usize];
    let mut start = vec![0u32; mesh.weld_class.len() + 1];
    (0..t.vertices()).for_each(|v| start[source(v) as usize + 1] += 1);
    (0..mesh.weld_class.len()).for_each(|p| start[p + 1] += start[p]);
    let mut fill = start.clone();
    let mut copies = vec![0u32; t.vertices() as usize];
    for v in 0..t.vertices() {
        let at = &mut fill[source(v) as usize];
        copies[*at as usize] = v;
        *at += 1;
    }
    let is_semi = |s: f32| s > 0.0 && s < INFINITE;
    let corner = |v: u32| own.origin(t.vertex_half_edge(v));
    let mut lists = Vec::new();
    for range in start.windows(2) {
        let copies = &copies[range[0] as usize..range[1] as usize];
        // One alone sees everything, but for the seam that ends at it.
        let seam = |v: u32| is_boundary(t.twin(t.vertex_half_edge(v))) && !is_boundary(own.twin(t.vertex_half_edge(v)));
        if copies.len() < 2 && !copies.iter().any(|&v| seam(v)) {
            continue;
        }
        let mut seen: Vec<Seen> = Vec::new();
        let mut around: Vec<u32> = copies.iter().map(|&v| corner(v)).collect();
        around.sort_unstable();
        around.dedup();
        for &w in &around {
            own.turn(w, |h| {
                let s = mesh.edge_sharpness[own.edge(h) as usize];
                if is_semi(s) && !is_boundary(own.twin(h)) {
                    seen.push((s, w, Some(t.origin(h)).filter(|_| !is_boundary(t.twin(h)))));
                }
            });
        }
        for &v in copies {
            let place = |&(s, w, by): &Seen| match by {
                _ if w != corner(v) => (s, Place::Copy),
                Some(_) => (s, Place::Region),
                None => (s, Place::Seam),
            };
            let edges: Vec<_> = seen.iter().filter(|x| x.2 != Some(v)).map(place).collect();
            if edges.is_empty() {
                continue;
            }
            let regions = copies.iter().filter(|&&u| corner(u) == corner(v)).count();
            let leans = matches!(rule, FaceVarying::CornersPlus1 | FaceVarying::CornersPlus2)
                && regions == 2
                && mesh.vertex_sharpness.get(corner(v) as usize).is_none_or(|&s| s <= 0.0)
                && seen.iter().all(|x| x.2 != Some(v))
                && edges.iter().any(|x| x.1 == Place::Region);
            lists.push(Beyond { vertex: v, edges, leans });
        }
    }
    lists.sort_unstable_by_key(|b| b.vertex);
    lists
}
