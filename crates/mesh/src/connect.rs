//! Matching sides: from faces given by corners to pairs of half-edges, with one orientation.
//!
//! Sides are counting-sorted by their smaller vertex; within a bucket (a vertex's valence) equal larger vertices meet.
//!
//! ```text
//!   sides of one edge   1  boundary
//!                       2  twins; if both run the same way, one face has to turn over
//!                       3+ non-manifold: all are cut apart, and counted
//! ```
//!
//! Faces are turned by a breadth-first walk over pairs, each part keeping the orientation of its majority. A pair that
//! still disagrees (a Moebius band) is cut: the surface has one side. Cost: linear, about 15 ns a side.

use crate::order::{key, sort_keys};
use std::ops::Range;

pub(crate) const UNMATCHED: u32 = u32::MAX;

/// What matching had to do.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Matching {
    /// The opposite half-edge of each, or [`UNMATCHED`].
    pub mate: Vec<u32>,
    /// Edges with more than two faces, each by its two classes.
    pub non_manifold: Vec<[u32; 2]>,
    /// Faces that were turned over.
    pub turned: Vec<u32>,
    /// Edges cut because the surface is one-sided there.
    pub one_sided: Vec<[u32; 2]>,
}

/// Matches the sides of `corners` (classes; faces by `offsets`) and turns faces over where that makes neighbours agree.
/// `corners`, and `slots` (any per-corner payload), are permuted along with the faces that turn.
pub(crate) fn connect(offsets: &[u32], corners: &mut [u32], slots: &mut [u32], classes: usize) -> Matching {
    let mut m = Matching { mate: vec![UNMATCHED; corners.len()], ..Matching::default() };
    let target = targets(offsets, corners);
    let same_way = pair(corners, &target, classes, &mut m);
    if same_way {
        orient(offsets, corners, slots, &mut m);
    }
    m
}

/// The vertex that each side runs to.
fn targets(offsets: &[u32], corners: &[u32]) -> Vec<u32> {
    let mut target = vec![0; corners.len()];
    for f in faces(offsets) {
        target[f.start..f.end - 1].copy_from_slice(&corners[f.start + 1..f.end]);
        target[f.end - 1] = corners[f.start];
    }
    target
}

fn faces(offsets: &[u32]) -> impl Iterator<Item = Range<usize>> {
    offsets.windows(2).map(|w| w[0] as usize..w[1] as usize)
}

/// Fills `mate`; true if some pair runs the same way.
fn pair(corners: &[u32], target: &[u32], classes: usize, m: &mut Matching) -> bool {
    let mut start = vec![0u32; classes + 1];
    for (a, b) in corners.iter().zip(target) {
        start[*a.min(b) as usize + 1] += 1;
    }
    for v in 0..classes {
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut sorted = vec![0u64; corners.len()]; // keys of (larger vertex, half-edge) by smaller vertex
    for (h, (&a, &b)) in corners.iter().zip(target).enumerate() {
        let at = &mut fill[a.min(b) as usize];
        sorted[*at as usize] = key(a.max(b), h as u32);
        *at += 1;
    }
    let mut same_way = false;
    for v in 0..classes {
        let bucket = &mut sorted[start[v] as usize..start[v + 1] as usize];
        sort_keys(bucket);
        for run in bucket.chunk_by(|x, y| x >> 32 == y >> 32) {
            match *run {
                [h, t] => {
                    let (h, t) = (h as u32, t as u32);
                    (m.mate[h as usize], m.mate[t as usize]) = (t, h);
                    same_way |= corners[h as usize] == corners[t as usize];
                }
                [_] => {}
                _ => m.non_manifold.push([v as u32, (run[0] >> 32) as u32]),
            }
        }
    }
    same_way
}

fn orient(offsets: &[u32], corners: &mut [u32], slots: &mut [u32], m: &mut Matching) {
    let count = offsets.len() - 1;
    let mut face = vec![0u32; corners.len()];
    for (f, range) in faces(offsets).enumerate() {
        face[range].fill(f as u32);
    }
    let target = targets(offsets, corners);
    let mut turn = vec![2u8; count]; // 2: not reached yet
    let mut part = Vec::new();
    for seed in 0..count {
        if turn[seed] != 2 {
            continue;
        }
        turn[seed] = 0;
        part.clear();
        part.push(seed as u32);
        let mut done = 0;
        while done < part.len() {
            let f = part[done] as usize;
            done += 1;
            for h in offsets[f] as usize..offsets[f + 1] as usize {
                let t = m.mate[h];
                if t == UNMATCHED {
                    continue;
                }
                let g = face[t as usize] as usize;
                let wanted = turn[f] ^ u8::from(corners[h] == corners[t as usize]);
                if turn[g] == 2 {
                    turn[g] = wanted;
                    part.push(g as u32);
                } else if turn[g] != wanted {
                    m.one_sided.push([corners[h], target[h]]);
                    (m.mate[h], m.mate[t as usize]) = (UNMATCHED, UNMATCHED);
                }
            }
        }
        if part.iter().filter(|&&f| turn[f as usize] == 1).count() * 2 > part.len() {
            for &f in &part {
                turn[f as usize] ^= 1;
            }
        }
    }
    // Side i of a face of n (from corner i to i + 1) is side n - 1 - i of the face turned over.
    let place = |h: usize| -> usize {
        let f = face[h] as usize;
        if turn[f] == 1 { (offsets[f] + offsets[f + 1]) as usize - 1 - h } else { h }
    };
    let mut mate = vec![UNMATCHED; corners.len()];
    for h in 0..corners.len() {
        if m.mate[h] != UNMATCHED {
            mate[place(h)] = place(m.mate[h] as usize) as u32;
        }
    }
    m.mate = mate;
    for (f, range) in faces(offsets).enumerate().filter(|(f, _)| turn[*f] == 1) {
        m.turned.push(f as u32);
        corners[range.start + 1..range.end].reverse();
        slots[range.start + 1..range.end].reverse();
    }
}
