//! Any scheme's masks, from what its own rules do around a vertex.
//!
//! A neighbourhood is cut out and refined, the scheme's rows are recorded, and the same neighbourhood of the child is cut
//! out of that. As soon as parent and child look alike (the next extraordinary vertex is out of sight then) the rows
//! between them are the local subdivision matrix S, whose left eigenvectors are the mask. (At rims of sqrt3 splits, which are
//! cut in every second step, those of two steps.) The rows of the steps before take it back to the vertices that there are.
//!
//! ```text
//!   patch 0 ── rows ──> patch 1 ── rows ──> patch 2 = patch 3       l S = l,   mask = l R1 R0
//!   (level)     R0       (child)    R1         └── S ──┘
//! ```
//!
//! In a dual scheme a vertex becomes a face of its images; what stays is the middle of that face, or on a boundary the
//! middle of the edge between the first image and the last.
//!
//! Neighbourhoods that look alike share one analysis. How many rings of faces a scheme looks at is found out: with one more
//! the answer must be the same. Cost: some 500 us for a new kind of neighbourhood, about 2 us for the next of that
//! kind. Limit: at a sharp vertex inside and at eigenvalues in Jordan blocks (a smooth corner of one quad) there is no tangent plane.
//! Where a scheme is not smooth inside (the first butterfly at extraordinary valences) the plane is that of its greatest
//! eigenvalues, which need not be the one that people see. At rims whose rules do not know their number of faces (J-splines from
//! three on, the first butterfly from four, interpolating sqrt3 from six) the greatest eigenvalue across may belong to a wave, to
//! and fro: there is no plane.

use super::Mask;
use super::eigen::{self, Rows, back};
use super::patch::{Anchor, Patch, Seen};
use crate::marks::INFINITE;
use crate::owned::Owned;
use crate::scheme::{Entry, Tags};
use crate::sink::{Cursor, Source};
use crate::split::{Level, Split, on};
use crate::topology::{Connectivity, is_boundary};
use std::f64::consts::PI;

/// How many refinements a neighbourhood may take until it looks like its parent.
const DEPTH: u32 = 8;
/// The same where creases have to fade first, a level for each unit of sharpness.
const FADING: u32 = DEPTH + INFINITE as u32;
/// How many rings a neighbourhood may have.
const WIDEST: u32 = 8;

/// Masks by kinds of neighbourhoods.
#[derive(Debug)]
pub(super) struct Analysis {
    level: Seen,
    child: Seen,
    rings: u32,
    /// By hashes in order; those of one hash one after the other.
    kinds: Vec<(u64, Kind)>,
    /// How many analyses there were.
    pub made: u64,
}

/// A kind of neighbourhood: its mask over the vertices that were seen. No weights if nothing was found.
#[derive(Debug)]
struct Kind {
    key: Vec<u32>,
    point: Vec<f64>,
    tangents: Option<[Vec<f64>; 2]>,
}

/// What a scheme does on a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    pub scheme: &'static Entry,
    pub split: Split,
    pub tags: Tags<'a>,
}

impl Analysis {
    pub fn new(split: Split) -> Analysis {
        // Few schemes look farther than two rings.
        let rings = if split.keeps_vertices() { 2 } else { 1 };
        Analysis { level: Seen::default(), child: Seen::default(), rings, kinds: Vec::new(), made: 0 }
    }

    /// Fills in the mask of `v`.
    pub fn mask(&mut self, level: &Level<'_>, setting: Setting<'_>, v: u32, mask: &mut Mask) {
        self.look(level, setting, v, self.rings);
        let hash = hash(&self.level.key);
        let at = self.kinds.partition_point(|k| k.0 < hash);
        let same = self.kinds[at..].iter().take_while(|k| k.0 == hash);
        let i = match same.into_iter().position(|k| k.1.key == self.level.key) {
            Some(i) => at + i,
            None => {
                let rings = self.rings;
                let kind = self.find(level, setting, v);
                if rings != self.rings {
                    // Everything is looked at more widely now.
                    return self.mask(level, setting, v, mask);
                }
                self.kinds.insert(at, (hash, kind));
                at
            }
        };
        let kind = &self.kinds[i].1;
        if kind.point.is_empty() {
            return mask.keep(v);
        }
        for (local, &v) in self.level.vertices.iter().enumerate() {
            if kind.point[local] != 0.0 {
                mask.point.push((v, kind.point[local]));
            }
            if let Some([a, b]) = &kind.tangents
                && (a[local] != 0.0 || b[local] != 0.0)
            {
                mask.tangents.push((v, [a[local], b[local]], 0));
            }
        }
        mask.sectors = u32::from(kind.tangents.is_some());
    }

    fn look(&mut self, level: &Level<'_>, setting: Setting<'_>, v: u32, rings: u32) {
        on!(level, c => {
            let sharp = |v: u32| setting.tags.is_sharp(*c, v);
            self.level.read(*c, Anchor::Vertex(v), rings, (sharp, setting.tags.knots, setting.tags.creases));
        });
    }

    /// Analyses the neighbourhood of `v`, with one ring more as a check: where that changes anything the scheme looks
    /// farther, and everything starts again with that ring.
    fn find(&mut self, level: &Level<'_>, setting: Setting<'_>, v: u32) -> Kind {
        let key = self.level.key.clone();
        self.made += 1;
        let narrow = analyse(&self.level.patch(level, setting.split), self.rings, setting, &mut self.child);
        let mut wide = Found::Nothing;
        if self.rings < WIDEST {
            self.look(level, setting, v, self.rings + 1);
            wide = analyse(&self.level.patch(level, setting.split), self.rings + 1, setting, &mut self.child);
            self.look(level, setting, v, self.rings);
        }
        match (narrow, wide) {
            (Found::Kind(a), Found::Kind(b)) if a.agrees(&b) => return a,
            (Found::Nothing, _) | (_, Found::Nothing) => {}
            _ => {
                self.rings += 1;
                self.kinds.clear();
            }
        }
        Kind { key, point: Vec::new(), tangents: None }
    }
}

/// Fowler, Noll and Vo's hash.
fn hash(key: &[u32]) -> u64 {
    key.iter().fold(0xcbf2_9ce4_8422_2325, |h, &x| (h ^ u64::from(x)).wrapping_mul(0x100_0000_01b3))
}

enum Found {
    Kind(Kind),
    /// The scheme looks farther than the patch reaches.
    Wider,
    Nothing,
}

impl Kind {
    /// Whether a wider neighbourhood, whose vertices begin with the same, gives the same point and the same plane.
    fn agrees(&self, wide: &Kind) -> bool {
        let padded = |l: &Vec<f64>| l.iter().copied().chain(std::iter::repeat(0.0)).take(wide.point.len()).collect();
        let point: Vec<f64> = padded(&self.point);
        let plane = match (&self.tangents, &wide.tangents) {
            (Some(a), Some(b)) => eigen::same_plane([padded(&a[0]), padded(&a[1])], b.clone()),
            (a, b) => a.is_none() && b.is_none(),
        };
        plane && point.iter().zip(&wide.point).all(|(a, b)| (a - b).abs() < 1e-9)
    }
}

/// The mask over the vertices of `first`, and what it was made of.
fn analyse(first: &Patch, rings: u32, setting: Setting<'_>, seen: &mut Seen) -> Found {
    let (mut anchor, mut split, mut period) = (Anchor::Vertex(0), setting.split, 1);
    if let Split::Sqrt3 { .. } = split {
        let creased = |v: u32| first.creases.as_ref().is_some_and(|c| c.is_on_crease(v));
        let rim = |v: u32| creased(v) || is_boundary(first.topology.twin(first.topology.vertex_half_edge(v)));
        if (0..first.topology.vertices()).any(|v| first.rings[v as usize] < rings && rim(v)) {
            period = 2;
        } else {
            split = Split::Sqrt3 { trisect: false };
        }
    }
    let mut patches: Vec<Patch> = Vec::new();
    let mut steps: Vec<Rows> = Vec::new();
    let mut stationary = false;
    for _ in 0..if first.creases.is_some() { FADING } else { DEPTH } {
        let at = |k: usize| k.checked_sub(1).map_or(first, |k| &patches[k]);
        let patch = at(steps.len());
        let Some((next, child, rows)) = refine(patch, anchor, rings, Setting { split, ..setting }, seen) else {
            return Found::Nothing;
        };
        steps.push(rows);
        let alike = steps.len().checked_sub(period).is_some_and(|k| child.key == at(k).key);
        patches.push(child);
        anchor = next;
        if let (2, Split::Sqrt3 { trisect }) = (period, split) {
            split = Split::Sqrt3 { trisect: !trisect };
        }
        stationary = alike;
        if alike {
            break;
        }
    }
    let (Some(patch), Some(mut s)) = (patches.last(), steps.pop()) else { return Found::Nothing };
    if stationary && period == 2 {
        let Some(one) = steps.pop() else { return Found::Nothing };
        let size = steps.len().checked_sub(1).map_or(first, |k| &patches[k]).vertices.len();
        s = s.iter().map(|row| through(row, &one, size)).collect();
    }
    let (point, tangents) = if stationary {
        match eigenvectors(patch, anchor, &s, rings, setting.scheme.info.interpolating) {
            Some((Some(point), tangents)) => (point, tangents),
            Some((None, _)) => return Found::Nothing,
            None => return Found::Wider,
        }
    } else {
        // Faces around it grow without end (rounded corners), but its own points may not depend on them.
        let own = patch.rings.iter().take_while(|r| **r == 0).count();
        let Some(mut point) = s.get(..own).and_then(|s| alone(s, own)) else { return Found::Nothing };
        let size = if steps.is_empty() { first.vertices.len() } else { patches[steps.len() - 1].vertices.len() };
        point.resize(size, 0.0);
        (point, None)
    };
    // Back to the first patch.
    let down = |mut weights: Vec<f64>| {
        for (i, rows) in steps.iter().enumerate().rev() {
            let size = if i == 0 { first.vertices.len() } else { patches[i - 1].vertices.len() };
            weights = back(rows, &weights, size);
        }
        // Vertices that the patch has twice count together.
        let mut seen = vec![0.0; first.class.iter().max().map_or(0, |c| *c as usize + 1)];
        first.class.iter().zip(&weights).for_each(|(&c, w)| seen[c as usize] += w);
        seen
    };
    Found::Kind(Kind { key: first.key.clone(), point: down(point), tangents: tangents.map(|t| t.map(down)) })
}

/// A row over vertices that `rows` make of `size` others, as one over those.
fn through(row: &[(u32, f64)], rows: &Rows, size: usize) -> Vec<(u32, f64)> {
    let mut weights = vec![0.0; rows.len()];
    row.iter().for_each(|&(v, w)| weights[v as usize] += w);
    (0..).zip(back(rows, &weights, size)).filter(|(_, w)| *w != 0.0).collect()
}

/// The limit point over the first `own` vertices, if they depend on each other only.
fn alone(rows: &[Vec<(u32, f64)>], own: usize) -> Option<Vec<f64>> {
    let closed = rows.iter().flatten().all(|(v, _)| (*v as usize) < own);
    if closed { eigen::point(&rows.to_vec(), vec![1.0 / own as f64; own]) } else { None }
}

/// One refinement of a patch: where its anchor goes, the child's patch, and the rows of its vertices over the patch's.
fn refine(
    patch: &Patch,
    anchor: Anchor,
    rings: u32,
    setting: Setting<'_>,
    seen: &mut Seen,
) -> Option<(Anchor, Patch, Rows)> {
    let t = &patch.topology;
    let level = Level::Base(t);
    let lone = setting.split.lone(t);
    let tags = patch.tags(setting.tags, &lone);
    let mut child = Owned::below(&level, setting.split, tags.creases);
    let mut at = 0;
    while !child.fill(&level, &mut at, &mut { usize::MAX }) {}
    let child = child.view();

    let mut rows: Rows = vec![Vec::new(); child.vertices() as usize];
    let mut sum = vec![0.0; t.vertices() as usize];
    let mut used: Vec<u32> = Vec::new();
    let mut take = |c: u32, row: &[(Source, f64)], _: [f64; 3]| {
        let mut add = |v: u32, w: f64| {
            if sum[v as usize] == 0.0 {
                used.push(v);
            }
            sum[v as usize] += w;
        };
        for &(source, w) in row {
            match source {
                Source::Vertex(v) => add(v, w),
                Source::Child(c) => rows[c as usize].iter().for_each(|&(v, x)| add(v, w * x)),
            }
        }
        // A vertex whose weight was zero in between is named twice; the second time nothing is left of it.
        rows[c as usize] =
            used.drain(..).map(|v| (v, std::mem::take(&mut sum[v as usize]))).filter(|x| x.1 != 0.0).collect();
    };
    setting.scheme.rows((&level, setting.split, tags), &mut take, &mut Cursor::default(), &mut { usize::MAX });

    let next = descend(patch, anchor, (setting.split, &lone), &child)?;
    // Old vertices keep their numbers, or there are none.
    let keeps = setting.split.keeps_vertices();
    let sharp = |v: u32| keeps && patch.sharp.get(v as usize).is_some_and(|s| *s);
    let knots = setting.split.knots(&level, &patch.knots, &lone);
    let marks = patch.creases.as_ref();
    let marks = marks.and_then(|m| m.below(&level, setting.split, &child, setting.tags.rules.decay));
    seen.read(&child, next, rings, (sharp, &knots, marks.as_ref()));
    let cut = seen.patch(&child, setting.split);
    let rows = cut.vertices.iter().map(|&v| rows[v as usize].clone()).collect();
    // In its own numbering the anchor comes first.
    let own = match next {
        Anchor::Vertex(_) => Anchor::Vertex(0),
        Anchor::Edge(_) => Anchor::Edge(0),
        Anchor::Face(_) => Anchor::Face(0),
    };
    Some((own, cut, rows))
}

/// Where the anchor of a patch is in its child.
fn descend(patch: &Patch, anchor: Anchor, (split, lone): (Split, &[u32]), child: &impl Connectivity) -> Option<Anchor> {
    let t = &patch.topology;
    if split.keeps_vertices() {
        return Some(anchor);
    }
    // The half-edge of the child from vertex a to vertex b.
    let between = |a: u32, b: u32| {
        let mut found = None;
        child.turn(a, |h| {
            if child.origin(child.next(h)) == b {
                found = Some(h);
            }
        });
        found
    };
    match anchor {
        Anchor::Face(f) => Some(Anchor::Face(f)),
        Anchor::Edge(h) if is_boundary(t.twin(h)) => {
            // From the image behind a corner alone to the one before the next.
            let second = lone.binary_search(&h).map_or(h, |i| t.half_edges() + i as u32);
            between(second, t.next(h)).map(Anchor::Edge)
        }
        Anchor::Edge(h) => {
            // The face of the edge: its sides are those of four images.
            let h = between(t.next(h), h)?;
            Some(Anchor::Face(child.face(h)))
        }
        Anchor::Vertex(v) => {
            let mut images = Vec::new();
            t.turn(v, |h| images.push(h));
            // A child is a corner's image, or the second of a corner alone.
            let corner = |x: u32| x.checked_sub(t.half_edges()).map_or(x, |i| lone[i as usize]);
            let own = |x: u32| t.origin(corner(x)) == v;
            let rim = is_boundary(t.twin(t.vertex_half_edge(v)));
            let mut found = None;
            let &first = images.first()?;
            child.turn(first, |h| {
                let f = child.face(h);
                if rim {
                    // The edge between the first image and the last.
                    let on_rim = child.face_half_edges(f).find(|&g| {
                        is_boundary(child.twin(g)) && own(child.origin(g)) && own(child.origin(child.next(g)))
                    });
                    found = found.or(on_rim.map(Anchor::Edge));
                } else if child.face_half_edges(f).all(|g| own(child.origin(g))) {
                    found = Some(Anchor::Face(f));
                }
            });
            match (found, images.len()) {
                (None, 1) => Some(Anchor::Vertex(first)),
                (None, 2) => between(first, images[1]).or(between(images[1], first)).map(Anchor::Edge),
                (found, _) => found,
            }
        }
    }
}

/// The eigenvectors of `s` at the anchor of `patch`, over its vertices; none if they need more than the patch has.
type Eigenvectors = (Option<Vec<f64>>, Option<[Vec<f64>; 2]>);

fn eigenvectors(patch: &Patch, anchor: Anchor, s: &Rows, rings: u32, interpolating: bool) -> Option<Eigenvectors> {
    let t = &patch.topology;
    // Where to start: the anchor's own vertices, those around it in order, and whether it lies on a boundary.
    let (mut own, mut around, mut rim) = (Vec::new(), Vec::new(), false);
    match anchor {
        Anchor::Vertex(v) => {
            own.push(v);
            let arriving = t.turn(v, |h| around.push(t.origin(t.next(h))));
            rim = arriving.is_some();
            around.extend(arriving.map(|h| t.origin(h)));
        }
        Anchor::Edge(h) => {
            rim = true;
            own.extend([t.origin(t.next(h)), t.origin(h)]);
            // From the edge's end around the face to its beginning.
            let mut g = t.next(h);
            while g != h {
                around.push(t.origin(g));
                g = t.next(g);
            }
            around.push(t.origin(h));
        }
        Anchor::Face(f) => {
            own.extend(t.face_half_edges(f).map(|h| t.origin(h)));
            around.clone_from(&own);
        }
    }
    // Everything that their rows read, and the rows of that, and so on.
    let mut index = vec![u32::MAX; patch.vertices.len()];
    let mut members: Vec<u32> = Vec::new();
    for &v in own.iter().chain(&around) {
        if index[v as usize] == u32::MAX {
            index[v as usize] = members.len() as u32;
            members.push(v);
        }
    }
    let mut done = 0;
    while done < members.len() {
        let v = members[done] as usize;
        if patch.rings[v] > rings {
            return None;
        }
        for &(u, _) in &s[v] {
            if index[u as usize] == u32::MAX {
                index[u as usize] = members.len() as u32;
                members.push(u);
            }
        }
        done += 1;
    }
    let small: Rows =
        members.iter().map(|&v| s[v as usize].iter().map(|&(u, w)| (index[u as usize], w)).collect()).collect();
    let spread = |small: &[f64]| {
        let mut all = vec![0.0; patch.vertices.len()];
        members.iter().zip(small).for_each(|(&v, &w)| all[v as usize] = w);
        all
    };
    let mut start = vec![0.0; members.len()];
    for &v in &own {
        start[index[v as usize] as usize] = 1.0 / own.len() as f64;
    }
    // A crease that lasts has a plane on either side; a corner between smooth edges none.
    let mut lasting = 0;
    if let (Anchor::Vertex(v), Some(creases)) = (anchor, &patch.creases) {
        t.turn(v, |h| lasting += u32::from(!is_boundary(t.twin(h)) && creases.along(t, h) > 0.0));
    }
    let creased = lasting > u32::from(!rim);
    let kept = creased || (matches!(anchor, Anchor::Vertex(_)) && patch.sharp[own[0] as usize]);
    let point = if interpolating { Some(start) } else { eigen::point(&small, start) };
    let Some(point) = point else { return Some((None, None)) };
    let faces = around.len() - usize::from(rim);
    if kept && (creased || !(rim && faces == 1)) {
        return Some((Some(spread(&point)), None));
    }
    let mut pattern = [vec![0.0; members.len()], vec![0.0; members.len()]];
    for (i, &v) in around.iter().enumerate() {
        let angle = if rim { PI / faces as f64 } else { 2.0 * PI / faces as f64 } * i as f64;
        let v = index[v as usize] as usize;
        pattern[0][v] += if rim { f64::from(i == 0) - f64::from(i == faces) } else { libm::cos(angle) };
        pattern[1][v] += if rim && (i == 0 || i == faces) { 0.0 } else { libm::sin(angle) };
    }
    if rim && faces == 1 {
        // Nothing lies between: what the two ends are away from the middle.
        pattern[1].clone_from(&start_of(&around, &index, members.len()));
    }
    for l in &mut pattern {
        let sum: f64 = l.iter().sum();
        l.iter_mut().zip(&point).for_each(|(x, p)| *x -= sum * p);
    }
    let across = pattern[1].clone();
    let mut plane = eigen::plane(&small, &point, pattern, rim);
    if let (true, Anchor::Vertex(_), Some([along, _])) = (rim && faces > 1, anchor, &plane) {
        let inner: Vec<usize> = around[1..faces].iter().map(|&v| index[v as usize] as usize).collect();
        if !eigen::goes_one_way(&small, [&point, along], &across, index[own[0] as usize] as usize, &inner) {
            plane = None;
        }
    }
    Some((Some(spread(&point)), plane.map(|p| p.map(|l| spread(&l)))))
}

/// One for each of these.
fn start_of(vertices: &[u32], index: &[u32], size: usize) -> Vec<f64> {
    let mut l = vec![0.0; size];
    vertices.iter().for_each(|&v| l[index[v as usize] as usize] = 1.0);
    l
}
