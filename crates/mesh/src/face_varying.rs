//! Which texture coordinates stay where they are: OpenSubdiv's six rules of face-varying interpolation.
//!
//! Around a vertex the faces fall into *regions*, one a value; a region may be more than one fan of faces. A value whose
//! surroundings are those of its vertex follows the vertex's own rule, creases and boundary and all. Any other is the end of
//! a region, and either the smooth boundary curve of its region passes through it (3/4 and twice 1/8) or it is pinned.
//!
//! ```text
//!         a | b        a value each side: a curve               a | b      three regions:
//!       ----v----      (b above), or a corner where             --v--      pinned from corners+1 on
//!         a | a        one face has it: pinned (b, left)        c   c
//!
//!   rule        pinned, beside what the vertex's own sharpness pins and values of more than one fan
//!   none        nothing
//!   corners     values of one face
//!   corners+1   and all at a vertex of three or more values, or with a value of more than one fan
//!   corners+2   and both of two values where either has one face (a concave corner); and ends of seams (darts)
//!   boundaries  every value on a seam or a boundary, at every level: seams stay straight lines
//!   all         everything is linear
//! ```
//!
//! What is pinned at level 0 is pinned for ever, and edges of seams bring curves only. So the rules are one flag for each
//! value of level 0, and what refines them is the scheme itself, on half-edges with seams cut ([`crate::mesh::UvChannel`]).
//! Semi-sharp edges inside a region make its value a corner for as long as they last, by corners+1 and corners+2 that of
//! the other of two regions too: [`crate::copies`]. Edges of three faces are no boundaries where their faces agree; where one
//! does not, everything at its ends stays.
//!
//! Source: OpenSubdiv 3.5's documentation ("Subdivision surfaces", face-varying interpolation rules) and the behaviour of
//! its `Vtr::FVarLevel`. Cost: the valence, at vertices on seams and boundaries. Limit: OpenSubdiv tells values by index,
//! this by what they are; where two values take turns around a vertex (a b a b) OpenSubdiv counts three or four, by the face
//! that it begins with.

#[cfg(feature = "full")]
use crate::copies;
use crate::crease::halves;
use crate::marks::INFINITE;
use crate::mesh::{Mesh, UvChannel};
use crate::order::key;
use crate::scheme::{Boundary, FaceVarying, Rules};
use crate::split::{Level, Split};
use crate::topology::{Connectivity, Topology, is_boundary};

/// What is sharp at level 0.
pub(crate) struct Sharp<'a> {
    /// Vertices that stay; shorter than the vertices where the rest does not.
    pub kept: &'a [bool],
    /// One a vertex, or empty.
    pub vertices: &'a [f32],
    /// One an edge, or empty.
    pub edges: &'a [f32],
}

/// A fan of faces around a vertex with one value.
#[derive(Clone, Copy)]
struct Fan {
    /// Its vertex among the texture coordinates.
    value: u32,
    faces: u32,
    /// Whether an infinitely sharp edge runs through it.
    creased: bool,
}

#[cfg(feature = "full")]
impl Mesh {
    /// The texture coordinates that stay where they are, at every level unless the rule is `boundaries`; empty if there are none.
    pub fn pinned_uv(&self, rules: &Rules) -> Vec<bool> {
        self.uv.as_ref().map_or_else(Vec::new, |uv| pins(self, uv, rules).0)
    }

    /// Whether some texture coordinate has to know edges that its own half-edges do not see: semi-sharp ones at an end of a seam.
    pub fn has_creases_beyond_seams(&self, rules: &Rules) -> bool {
        self.uv.as_ref().is_some_and(|uv| !copies::of(self, &uv.topology, rules.face_varying).is_empty())
    }
}

/// The values of `mesh` that stay where they are, and the half-edges of `uv` that are no boundary of a region though they
/// were cut from other faces: where three faces meet on an edge and agree on its values. Cost: linear.
pub(crate) fn pins(mesh: &Mesh, uv: &UvChannel, rules: &Rules) -> (Vec<bool>, Vec<u32>) {
    let sharp = Sharp { kept: &mesh.sharp, vertices: &mesh.vertex_sharpness, edges: &mesh.edge_sharpness };
    let value = |u: u32| uv.values[u as usize];
    let same = |a: u32, b: u32| a == b || value(a).map(|x| x + 0.0) == value(b).map(|x| x + 0.0);
    let mut pins = pinned(&mesh.topology, &uv.topology, sharp, rules, same);
    let loose = if mesh.sharp.is_empty() { Vec::new() } else { heal(mesh, &uv.topology, rules, same, &mut pins) };
    (pins, loose)
}

/// Mends what cuts between copies of a vertex have done to `pins`: they are no boundaries of regions, unless the faces there
/// disagree; then, and where any other seam comes to such a vertex, all of its values stay. Gives the sides of cuts that no
/// seam runs along.
fn heal(mesh: &Mesh, uv: &Topology, rules: &Rules, same: impl Fn(u32, u32) -> bool, pins: &mut [bool]) -> Vec<u32> {
    let t = &mesh.topology;
    let source = |h: u32| mesh.vertex_source[t.origin(h) as usize];
    // Where each boundary side runs, from the lower position to the higher, and its values there.
    let side = |h: u32| {
        let ends = [h, t.next(h)];
        let [a, b] = if source(ends[0]) < source(ends[1]) { ends } else { [ends[1], ends[0]] };
        (key(source(a), source(b)), [uv.origin(a), uv.origin(b)])
    };
    let mut sides: Vec<(u64, u32)> =
        (0..t.boundary_half_edges()).map(|r| t.boundary_half_edge(r)).map(|h| (side(h).0, h)).collect();
    sides.sort_unstable();
    let (mut loose, mut torn) = (Vec::new(), vec![false; mesh.weld_class.len()]);
    let mut tear = |h: u32| [h, t.next(h)].map(source).into_iter().for_each(|p| torn[p as usize] = true);
    for cut in sides.chunk_by(|a, b| a.0 == b.0).filter(|cut| cut.len() > 1) {
        let first = side(cut[0].1).1;
        if cut.iter().map(|x| side(x.1).1).all(|v| same(v[0], first[0]) && same(v[1], first[1])) {
            loose.extend(cut.iter().map(|x| x.1));
        } else {
            tear(cut[0].1);
        }
    }
    loose.sort_unstable();
    for r in 0..uv.boundary_half_edges() {
        let h = uv.boundary_half_edge(r);
        if !is_boundary(t.twin(h)) {
            tear(h);
        }
    }
    let mut copies = vec![0u8; mesh.weld_class.len()];
    mesh.vertex_source.iter().for_each(|&p| copies[p as usize] = copies[p as usize].saturating_add(1));
    for u in 0..uv.vertices() {
        let start = uv.vertex_half_edge(u);
        let (v, position) = (t.origin(start), source(start) as usize);
        if copies[position] < 2 || rules.face_varying == FaceVarying::All {
            continue;
        }
        let kept = mesh.sharp[v as usize] || mesh.vertex_sharpness.get(v as usize).is_some_and(|&s| s >= INFINITE);
        pins[u as usize] = kept || torn[position];
    }
    loose
}

/// The vertices of `uv` that stay: half-edges `t` with seams cut; `same` says whether two of its vertices are one value.
pub(crate) fn pinned(
    t: &Topology,
    uv: &Topology,
    sharp: Sharp<'_>,
    rules: &Rules,
    same: impl Fn(u32, u32) -> bool,
) -> Vec<bool> {
    let mut pins = vec![false; uv.vertices() as usize];
    let straight = matches!(rules.face_varying, FaceVarying::Boundaries | FaceVarying::All);
    let corners = rules.face_varying != FaceVarying::None;
    // Which vertices have a seam.
    let mut torn = vec![false; t.vertices() as usize];
    for r in 0..uv.boundary_half_edges() {
        let h = uv.boundary_half_edge(r);
        if !is_boundary(t.twin(h)) {
            torn[t.origin(h) as usize] = true;
            torn[t.origin(t.next(h)) as usize] = true;
        }
    }
    let mut fans: Vec<Fan> = Vec::new();
    for v in 0..t.vertices() {
        let kept = sharp.kept.get(v as usize).is_some_and(|&k| k)
            || sharp.vertices.get(v as usize).is_some_and(|&s| s >= INFINITE);
        let start = t.vertex_half_edge(v);
        let rim = is_boundary(t.twin(start));
        if !torn[v as usize] {
            let lone = || is_boundary(t.twin(t.prev(start)));
            pins[uv.origin(start) as usize] =
                kept || rim && (straight || (corners || rules.boundary == Boundary::EdgeAndCorner) && lone());
            continue;
        }
        around(t, uv, v, sharp.edges, &mut fans);
        // Whether a value is of more than one fan, or as good as.
        let apart = |f: &Fan| f.creased || fans.iter().any(|g| g.value != f.value && same(f.value, g.value));
        let is_new = |i: usize| !fans[..i].iter().any(|g| same(fans[i].value, g.value));
        let values = (0..fans.len()).filter(|&i| is_new(i)).count();
        let all = kept
            || match rules.face_varying {
                FaceVarying::None | FaceVarying::CornersOnly => false,
                FaceVarying::CornersPlus1 => values > 2 || values == 2 && fans.iter().any(apart),
                FaceVarying::CornersPlus2 => match values {
                    1 => !rim,
                    2 => fans.iter().any(|f| f.faces == 1 || apart(f)),
                    _ => true,
                },
                FaceVarying::Boundaries | FaceVarying::All => true,
            };
        for fan in &fans {
            pins[fan.value as usize] = all || apart(fan) || corners && fan.faces == 1;
        }
    }
    pins
}

/// The fans around `v`, in the order of the turn.
fn around(t: &Topology, uv: &Topology, v: u32, edges: &[f32], fans: &mut Vec<Fan>) {
    fans.clear();
    t.turn(v, |h| {
        let value = uv.origin(h);
        // The edges inside a fan are those that are no boundary of it.
        let creased = !is_boundary(uv.twin(h)) && edges.get(t.edge(h) as usize).is_some_and(|&s| s >= INFINITE);
        match fans.iter_mut().find(|f| f.value == value) {
            Some(fan) => (fan.faces, fan.creased) = (fan.faces + 1, fan.creased || creased),
            None => fans.push(Fan { value, faces: 1, creased }),
        }
    });
}

/// Adds all of the boundary of `uv` to what stays there, but for `loose` half-edges.
pub(crate) fn pin_boundary(uv: &impl Connectivity, loose: &[u32], pins: &mut Vec<bool>) {
    pins.resize(uv.vertices() as usize, false);
    for h in (0..uv.boundary_half_edges()).map(|r| uv.boundary_half_edge(r)) {
        if loose.binary_search(&h).is_err() {
            pins[uv.origin(h) as usize] = true;
        }
    }
}

/// The children of `loose` half-edges of `level`, which `split` halves.
pub(crate) fn below(loose: &[u32], level: &Level<'_>, split: Split) -> Vec<u32> {
    if !crate::FULL {
        return Vec::new();
    }
    let mut children: Vec<u32> = loose.iter().filter_map(|&h| halves(level, split, h)).flatten().collect();
    children.sort_unstable();
    children
}
