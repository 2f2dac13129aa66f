//! What a patch depends on: the faces around its corners, as a list of control points and a key that says how they meet.
//!
//! ```text
//!    b2 -- c2 -- .            corners first, then around each corner counter-clockwise what no other corner lists:
//!    |     |     |            the ends of its spokes c1, c2 .. and, of quads, the far corners b2 .. between them
//!    c1 -- v0 -- v1
//!    |     | patch            regular: 4 + 4 * 3 = 16 points around a quad, 3 + 3 * 3 = 12 around a triangle
//!    .  -- v3 -- v2           one inner corner of valence n: 2n + 8, and n + 6
//! ```
//!
//! Equal keys mean equal rules, so whatever is a linear function of the ring is the same function for all patches of a key.
//! The ring is unfolded: a vertex that it meets twice is listed twice.
//!
//! Cost: about a walk over twins a corner. Limit: patches at an inner vertex of two faces or one of over 256, and triangles with two corners of
//! valence three, have no ring.

use crate::scheme::Tags;
use crate::topology::{Connectivity, is_boundary};

/// Faces at a corner that a ring may have: a table of more would not pay, and keys have room for so many.
const MOST_SPOKES: usize = 256;

/// How the faces around a corner lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fan {
    /// So many, all the way round.
    Inner(usize),
    /// On a boundary: so many behind the patch, counter-clockwise, and so many before it.
    Rim(usize, usize),
}

/// A corner of a patch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Corner {
    pub fan: Fan,
    /// Whether the vertex stays where it is.
    pub kept: bool,
    /// How sharp the vertex is, and its inner spokes: counter-clockwise from the patch's side, all the way round or to the
    /// boundary, then clockwise. Empty if nothing is sharp.
    pub sharpness: Vec<f32>,
}

/// A ring that is being read, with room that is used again.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    /// The control points.
    pub controls: Vec<u32>,
    /// How they meet; empty for the regular ring without marks.
    pub key: Vec<u32>,
    spokes: Vec<u32>,
}

impl Ring {
    /// Reads the ring of face `q` of a level whose faces all have `sides` corners; false if it has none.
    #[inline(always)]
    pub(super) fn read<C: Connectivity>(&mut self, c: &C, sides: usize, q: u32, tags: &Tags<'_>) -> bool {
        self.key.clear();
        let first = sides as u32 * q;
        let marked = |v: u32| {
            tags.sharp.get(v as usize).is_some_and(|&sharp| sharp) || tags.creases.is_some_and(|c| c.is_marked(v))
        };
        let plain = !(first..first + sides as u32).any(|h| marked(c.origin(h)));
        plain && self.read_inner(c, sides, q) || self.read_any(c, sides, q, tags)
    }

    /// Reads a ring without boundaries and marks, which is most of them.
    #[inline(always)]
    fn read_inner<C: Connectivity>(&mut self, c: &C, sides: usize, q: u32) -> bool {
        let first = sides as u32 * q;
        let quads = sides == 4;
        // Around a corner two spokes of quads, three of triangles end at what other corners list.
        let (regular, others) = if quads { (4, 2) } else { (6, 3) };
        self.key.clear();
        self.controls.clear();
        self.controls.extend((first..first + sides as u32).map(|h| c.origin(h)));
        let mut plain = true;
        let mut across = c.twin(first + sides as u32 - 1);
        for h in first..first + sides as u32 {
            let side = c.twin(h);
            if is_boundary(across) || is_boundary(side) {
                return false;
            }
            // The last spoke, and the first that is not listed.
            let mut last = c.next(side);
            if across == last {
                return false;
            }
            if !quads {
                let before = c.twin(last);
                if is_boundary(before) {
                    return false;
                }
                last = c.next(before);
            }
            let mut listed = 0;
            let mut spoke = across;
            while spoke != last {
                let arriving = c.prev(spoke);
                if quads && listed > 0 {
                    self.controls.push(c.origin(c.prev(arriving)));
                }
                self.controls.push(c.origin(arriving));
                spoke = c.twin(arriving);
                listed += 1;
                if is_boundary(spoke) || listed + others > MOST_SPOKES {
                    return false;
                }
            }
            let n = listed + others;
            plain &= n == regular;
            self.key.push((n as u32) << 2);
            across = side;
        }
        if plain {
            self.key.clear();
        }
        // What has no ring is for the other way to say.
        sides == 4 || self.key.iter().filter(|&&word| word == 3 << 2).count() < 2
    }

    /// Reads any ring.
    #[inline(never)]
    fn read_any<C: Connectivity>(&mut self, c: &C, sides: usize, q: u32, tags: &Tags<'_>) -> bool {
        let first = sides as u32 * q;
        let regular = Fan::Inner(if sides == 4 { 4 } else { 6 });
        let mut plain = true;
        let mut threes = 0;
        self.key.clear();
        self.controls.clear();
        self.controls.extend((first..first + sides as u32).map(|h| c.origin(h)));
        for h in first..first + sides as u32 {
            let v = c.origin(h);
            self.spokes.clear();
            let end = c.turn_from(h, |spoke| self.spokes.push(spoke));
            let behind = self.spokes.len() - 1;
            let fan = match end {
                None => Fan::Inner(behind + 1),
                Some(_) => {
                    // Clockwise from the patch to where the boundary begins.
                    let mut twin = c.twin(h);
                    while !is_boundary(twin) {
                        let spoke = c.next(twin);
                        self.spokes.push(spoke);
                        twin = c.twin(spoke);
                    }
                    Fan::Rim(behind, self.spokes.len() - 1 - behind)
                }
            };
            if fan == Fan::Inner(2) || self.spokes.len() > MOST_SPOKES {
                return false;
            }
            threes += usize::from(sides == 3 && fan == Fan::Inner(3));
            let kept = tags.is_sharp(c, v);
            let creases = tags.creases.filter(|creases| creases.is_marked(v));
            plain &= fan == regular && !kept && creases.is_none();
            self.key.push(match fan {
                Fan::Inner(n) => (n as u32) << 2,
                Fan::Rim(behind, before) => 1 << 31 | (behind as u32) << 16 | (before as u32) << 2,
            });
            if let Some(last) = self.key.last_mut() {
                *last |= u32::from(kept) << 1 | u32::from(creases.is_some());
            }
            if let Some(creases) = creases {
                self.key.push(creases.vertex(v).to_bits());
                self.key.extend(self.spokes.iter().map(|&spoke| creases.along(c, spoke).to_bits()));
            }
            // Ends of spokes, and far corners between them. Spoke 0 is the patch's own side, spoke 1 across the one before.
            let end_of = |spoke: u32| c.origin(c.prev(spoke));
            let far = |spoke: u32| c.origin(c.prev(c.prev(spoke)));
            let (listed, before) = match (fan, sides) {
                (Fan::Inner(n), 4) => (n - 2, 0),
                (Fan::Inner(n), _) => (n - 3, 0),
                (Fan::Rim(behind, before), _) => (behind, before),
            };
            for (i, &spoke) in self.spokes[1..1 + listed].iter().enumerate() {
                if sides == 4 && i > 0 {
                    self.controls.push(far(spoke));
                }
                self.controls.push(end_of(spoke));
            }
            for (i, &spoke) in self.spokes[1 + behind..1 + behind + before].iter().enumerate() {
                // Faces before the patch are met by the spoke that they begin with.
                if sides == 4 {
                    if i > 0 {
                        self.controls.push(c.origin(c.next(c.next(spoke))));
                    }
                    self.controls.push(c.origin(c.next(spoke)));
                } else if i > 0 {
                    self.controls.push(c.origin(c.next(spoke)));
                }
            }
        }
        if plain {
            self.key.clear();
        }
        threes < 2
    }
}

/// The corners that a key tells of.
pub(super) fn corners(key: &[u32], sides: usize) -> Vec<Corner> {
    if key.is_empty() {
        let fan = Fan::Inner(if sides == 4 { 4 } else { 6 });
        return vec![Corner { fan, kept: false, sharpness: Vec::new() }; sides];
    }
    let mut words = key.iter().copied();
    let mut out = Vec::new();
    while let Some(word) = words.next() {
        let fan = match word >> 31 {
            0 => Fan::Inner((word >> 2) as usize),
            _ => Fan::Rim((word >> 16 & 0x7fff) as usize, (word >> 2 & 0x3fff) as usize),
        };
        let sharp = match fan {
            _ if word & 1 == 0 => 0,
            Fan::Inner(n) => n + 1,
            // The first spoke behind a rim's patch and all others; the boundary itself has no twin and counts as one.
            Fan::Rim(behind, before) => 2 + behind + before,
        };
        let sharpness = words.by_ref().take(sharp).map(f32::from_bits).collect();
        out.push(Corner { fan, kept: word & 2 != 0, sharpness });
    }
    out
}

/// The faces of an unfolded ring, the patch first, by numbers of control points; and how many there are.
pub(super) fn faces(corners: &[Corner]) -> (Vec<Vec<u32>>, u32) {
    let sides = corners.len();
    let mut next = sides as u32;
    // Of every corner: the ends of the spokes behind the patch (with far corners), and of those before it.
    let mut behind: Vec<Vec<[u32; 2]>> = Vec::new();
    let mut before: Vec<Vec<[u32; 2]>> = Vec::new();
    let mut take = || {
        next += 1;
        next - 1
    };
    const NONE: u32 = u32::MAX;
    for corner in corners {
        let (listed, first) = match (corner.fan, sides) {
            (Fan::Inner(n), 4) => (n - 2, 0),
            (Fan::Inner(n), _) => (n - 3, 0),
            (Fan::Rim(behind, before), _) => (behind, before),
        };
        let mut list = |i: usize| {
            let far = if sides == 4 && i > 0 { take() } else { NONE };
            [far, take()]
        };
        behind.push((0..listed).map(&mut list).collect());
        let own = if sides == 4 { 0 } else { 1 };
        // The first spoke before a triangle's patch ends where the next corner's first one does.
        let mut arm: Vec<[u32; 2]> = (own..first).map(&mut list).collect();
        if own == 1 && first > 0 {
            arm.insert(0, [NONE, NONE]);
        }
        before.push(arm);
    }
    let mut out = vec![(0..sides as u32).collect::<Vec<u32>>()];
    let inner = |i: usize| matches!(corners[i].fan, Fan::Inner(_));
    let has_side = |i: usize| match corners[i].fan {
        Fan::Inner(_) => true,
        Fan::Rim(_, before) => before > 0,
    };
    // What the spoke across side i - 1 ends at, seen from corner i; of triangles the tip of the face there.
    let first_behind = |i: usize| match behind[i].first() {
        Some(end) => end[1],
        // Valence three: the tips across both sides are one.
        None => behind[(i + 1) % sides].first().map_or(NONE, |end| end[1]),
    };
    for i in 0..sides {
        let (v, after) = (i as u32, (i + 1) % sides);
        if has_side(i) {
            let theirs = first_behind(after);
            out.push(if sides == 4 {
                let mine = if inner(i) { behind[i].last().map_or(NONE, |end| end[1]) } else { before[i][0][1] };
                vec![after as u32, v, mine, theirs]
            } else {
                vec![after as u32, v, theirs]
            });
        }
    }
    for i in 0..sides {
        let (v, after) = (i as u32, (i + 1) % sides);
        let mut last = first_behind(i);
        let mut fans: Vec<[u32; 2]> = behind[i].iter().skip(1).copied().collect();
        if sides == 3 && inner(i) && !behind[i].is_empty() {
            fans.push([NONE, first_behind(after)]);
        }
        for [far, end] in fans {
            out.push(if sides == 4 { vec![v, last, far, end] } else { vec![v, last, end] });
            last = end;
        }
        if let Fan::Rim(..) = corners[i].fan {
            let mut last = match before[i].first() {
                Some(end) if sides == 4 => end[1],
                _ => first_behind(after),
            };
            for &[far, end] in before[i].iter().skip(1) {
                out.push(if sides == 4 { vec![v, end, far, last] } else { vec![v, end, last] });
                last = end;
            }
        }
    }
    (out, next)
}

/// How sharp the inner edges of an unfolded ring are, by their ends, from what its corners say.
pub(super) fn spokes(corners: &[Corner], c: &impl Connectivity, creases: &mut impl FnMut(u32, f32)) {
    for (h, corner) in (0..).zip(corners).filter(|(_, corner)| !corner.sharpness.is_empty()) {
        let mut said = corner.sharpness[1..].iter();
        let end = c.turn_from(h, |spoke| {
            if let Some(&s) = said.next() {
                creases(spoke, s);
            }
        });
        if end.is_some() {
            let mut twin = c.twin(h);
            while !is_boundary(twin) {
                let spoke = c.next(twin);
                if let Some(&s) = said.next() {
                    creases(spoke, s);
                }
                twin = c.twin(spoke);
            }
        }
    }
}

/// Whether what creases say of a level stays within rings: nothing lies beyond cuts, and no edge's decay depends on what
/// meets it at its other end.
pub(super) fn is_local(tags: &Tags<'_>) -> bool {
    tags.creases.is_none_or(|creases| creases.is_local(tags.rules.decay))
}
