//! The one validator: every invariant that [`Connectivity`] promises, on any level.
//!
//! Tests run it on every level of everything; nothing else does. Cost: linear.

use crate::topology::{Connectivity, boundary_rank, is_boundary};

/// An invariant of the half-edges that does not hold, with the element where it was seen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{rule} fails at {element} {id}")]
pub struct Broken {
    /// The invariant.
    pub rule: &'static str,
    /// "half-edge", "vertex", "edge", "face" or "rank".
    pub element: &'static str,
    /// Which one.
    pub id: u32,
}

/// Checks every invariant that [`Connectivity`] promises, on any level. Cost: linear.
///
/// # Errors
/// The first invariant that fails.
pub fn validate(c: &impl Connectivity) -> Result<(), Broken> {
    let check = |ok: bool, rule, element, id| if ok { Ok(()) } else { Err(Broken { rule, element, id }) };
    let mut ranks = vec![false; c.boundary_half_edges() as usize];
    let mut sides = vec![0u32; c.edges() as usize];
    let mut corners = vec![0u32; c.vertices() as usize];
    for h in 0..c.half_edges() {
        check(c.next(c.prev(h)) == h && c.prev(c.next(h)) == h, "next and prev are inverse", "half-edge", h)?;
        check(c.face_half_edges(c.face(h)).contains(&h), "a half-edge lies in its face", "half-edge", h)?;
        check(c.face(c.next(h)) == c.face(h), "next stays in the face", "half-edge", h)?;
        check(c.origin(h) < c.vertices(), "origin is a vertex", "half-edge", h)?;
        check(c.edge(h) < c.edges(), "edge is an edge", "half-edge", h)?;
        check(c.origin(h) != c.origin(c.next(h)), "a half-edge joins two vertices", "half-edge", h)?;
        sides[c.edge(h) as usize] += 1;
        corners[c.origin(h) as usize] += 1;
        let t = c.twin(h);
        if is_boundary(t) {
            let r = boundary_rank(t);
            check(r < c.boundary_half_edges(), "rank is in range", "half-edge", h)?;
            check(!ranks[r as usize], "ranks are distinct", "rank", r)?;
            check(c.boundary_half_edge(r) == h, "a rank names its half-edge", "rank", r)?;
            ranks[r as usize] = true;
            check(c.edge_half_edge(c.edge(h)) == h, "a boundary half-edge owns its edge", "half-edge", h)?;
        } else {
            check(t < c.half_edges() && t != h && c.twin(t) == h, "twin is an involution", "half-edge", h)?;
            check(c.edge(t) == c.edge(h), "twins share their edge", "half-edge", h)?;
            check(c.origin(t) == c.origin(c.next(h)), "twins run in opposite directions", "half-edge", h)?;
        }
    }
    check(ranks.iter().all(|&seen| seen), "every rank is taken", "rank", 0)?;
    let mut first = 0;
    for f in 0..c.faces() {
        let r = c.face_half_edges(f);
        check(r.start == first && r.len() >= 3, "faces are contiguous and have three corners", "face", f)?;
        first = r.end;
    }
    check(first == c.half_edges(), "faces cover the half-edges", "face", c.faces())?;
    for e in 0..c.edges() {
        let h = c.edge_half_edge(e);
        check(h < c.half_edges() && c.edge(h) == e, "an edge's half-edge is its own", "edge", e)?;
        let expected = if is_boundary(c.twin(h)) { 1 } else { 2 };
        check(sides[e as usize] == expected, "an edge has its two sides, one on a boundary", "edge", e)?;
    }
    for v in 0..c.vertices() {
        let start = c.vertex_half_edge(v);
        check(start < c.half_edges() && c.origin(start) == v, "a vertex's half-edge leaves it", "vertex", v)?;
        let (mut seen, mut own, limit) = (0u32, true, corners[v as usize]);
        let mut h = start;
        loop {
            seen += 1;
            own &= c.origin(h) == v;
            h = c.twin(c.prev(h));
            if is_boundary(h) {
                own &= is_boundary(c.twin(start));
                break;
            }
            if h == start || seen > limit {
                break;
            }
        }
        check(own && seen == limit, "a vertex has one fan, and its turn visits all of it", "vertex", v)?;
    }
    Ok(())
}
