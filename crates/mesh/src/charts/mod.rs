//! Texture coordinates through splits whose faces leave their parents: dual, sqrt3 and mid-edge.
//!
//! Such a split makes faces across a seam, and every face must lie in one *chart*. So the seam moves: a face across it goes to
//! one side, and what it has on the other takes the seam's own points.
//!
//! ```text
//!      chart A  |  chart B           A . . . a1------b1 . . . B       the face a1 a2 b2 b1 goes to A:
//!      . a1 . . | . . b1 .                    |      |                in A, b1 and b2 are points of the seam v w;
//!               |                             |  A   |  seam          in B, they are the same points of the seam
//!      . a2 . . | . . b2 .           A . . . a2------b2 . . . B       as B has it
//! ```
//!
//! A child vertex that touches faces of two charts lies on the seam in both, at the same place: textures that fit along a seam go on
//! fitting. Away from seams the scheme's own rows hold, on the corners that the vertex's own chart has. The sides are chosen by
//! walking along a seam, so that it stays one curve; the next level's goes to the other side, and it does not drift.
//!
//! ```text
//!   child vertex             at home                  on a seam                  where two seams or more, or a foreign v-face, meet
//!   corner (dual)            its image                3/4, 1/4 along it          the vertex's coordinate
//!   centre (sqrt3)           its row                  the middle                 its row; faces across take the middle
//!   edge (mid-edge)          the middle               the middle                 the vertex's coordinate
//!   vertex (sqrt3)           its row                  3/4, 1/8, 1/8, or pinned   the same
//! ```
//!
//! Every place is a mix of coordinates of one chart: nothing bleeds. Equal places of one vertex have equal bits: no cracks.
//! Cost: linear, in one call a level. Limit: beside a seam a texture is stretched over
//! half a face of the other side; a triangle whose three edges are seams, all given away, shows a third less of its texture.
//! From the second step on mid-edge, whose faces meet in points, may pinch a chart apart there; then textures
//! do not fit along the pinch, though every face still lies in its chart.

mod creased;
mod dual;
mod mid_edge;
mod sqrt3;

use self::creased::Creased;
use crate::crease::Creases;
use crate::face_varying::{self, Sharp};
use crate::plan::Step;
use crate::scheme::{Boundary, FaceVarying, Rules, Tags};
use crate::sink::{Cursor, Source, weigh};
use crate::soup::NONE;
use crate::split::{Level, Split};
use crate::topology::{Connectivity, Counts, Topology, boundary_rank, is_boundary};

/// Texture coordinates of a level: half-edges with seams cut, a value a vertex, and which of them stay.
#[derive(Debug)]
pub(crate) struct Channel {
    pub topology: Topology,
    pub values: Vec<[f32; 4]>,
    pub pins: Vec<bool>,
}

/// Where a corner of a child face is in its chart; numbers are vertices of the texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// A child of the scheme's rules.
    Image(u32),
    /// A coordinate as it is.
    Point(u32),
    /// 3/4 of the first and 1/4 of the second.
    Along(u32, u32),
    /// Half of each.
    Middle(u32, u32),
}

/// A level's half-edges `g`, the same with seams cut `u`, and which side of a seam the faces across it are given to.
struct Charts<'a> {
    g: &'a Topology,
    u: &'a Topology,
    /// One a half-edge: whether it lies on a seam, and what is across is its own chart's.
    owns: Vec<bool>,
    /// How many seams meet at each vertex of `g`, at most 255.
    seams: Vec<u8>,
}

impl<'a> Charts<'a> {
    fn new(g: &'a Topology, u: &'a Topology) -> Self {
        let (owns, seams) = (vec![false; g.half_edges() as usize], vec![0; g.vertices() as usize]);
        let mut charts = Charts { g, u, owns, seams };
        for &h in &u.boundary {
            if charts.is_seam(h) {
                let n: &mut u8 = &mut charts.seams[g.origin(h) as usize];
                *n = n.saturating_add(1);
            }
        }
        for &h in &u.boundary {
            if charts.is_seam(h) && !charts.is_given(h) {
                charts.give(h);
            }
        }
        (0..g.faces()).for_each(|f| charts.relieve(f));
        charts
    }

    fn is_seam(&self, h: u32) -> bool {
        is_boundary(self.u.twin(h)) && !is_boundary(self.g.twin(h))
    }

    fn is_given(&self, h: u32) -> bool {
        self.owns[h as usize] || self.owns[self.g.twin(h) as usize]
    }

    /// Whether what lies across `h` is of another chart than the face of `h`.
    fn is_foreign(&self, h: u32) -> bool {
        self.is_seam(h) && !self.owns[h as usize]
    }

    /// Gives the seam of `h`, and as much of it as goes on from both ends, to one side: to the one with more faces that have two
    /// edges on it, as such a face has no good place for a centre that it gives away; else to that of `h`.
    fn give(&mut self, h: u32) {
        let g = self.g;
        let mut curve = vec![h];
        let mut at = h;
        while let Some(next) = self.goes_on(at, true).filter(|&next| next != h) {
            curve.push(next);
            at = next;
        }
        // Once round, or else what comes before.
        at = if self.goes_on(at, true).is_some() { NONE } else { h };
        while at != NONE {
            at = self.goes_on(at, false).unwrap_or(NONE);
            curve.extend(Some(at).filter(|&h| h != NONE));
        }
        let bends = |h: u32| usize::from(self.goes_on(h, true) == Some(g.next(h)));
        let here: usize = curve.iter().map(|&h| bends(h)).sum();
        let there: usize = curve.iter().map(|&h| bends(g.twin(h))).sum();
        for h in curve {
            self.owns[if there > here { g.twin(h) } else { h } as usize] = true;
        }
    }

    /// Lets a triangle that gives all three edges away keep one, if others can make room for that: along the shortest path of
    /// edges that are seams of their own to a triangle that gives away one or none.
    fn relieve(&mut self, f: u32) {
        let g = self.g;
        let given = |this: &Self, f: u32| g.face_half_edges(f).filter(|&h| this.is_foreign(h)).count();
        if g.face_half_edges(f).len() != 3 || given(self, f) < 3 {
            return;
        }
        let alone = |this: &Self, h: u32| this.goes_on(h, true).or(this.goes_on(h, false)).is_none();
        // Each face reached, by the half-edge that it was reached across, and the place of the one before.
        let mut reached: Vec<(u32, u32, usize)> = vec![(f, NONE, 0)];
        let mut done = 0;
        while let Some(&(at, _, _)) = reached.get(done).filter(|_| reached.len() < 1000) {
            for h in g.face_half_edges(at).filter(|&h| self.is_foreign(h) && alone(self, h)) {
                let other = g.face(g.twin(h));
                if reached.iter().all(|r| r.0 != other) {
                    reached.push((other, h, done));
                }
            }
            done += 1;
        }
        let Some(mut end) = reached.iter().position(|r| given(self, r.0) < 2) else { return };
        while end > 0 {
            let (_, h, before) = reached[end];
            (self.owns[h as usize], self.owns[g.twin(h) as usize]) = (true, false);
            end = before;
        }
    }

    /// The next half-edge of a seam on the same side, or the one before; none where the seam ends or others meet it.
    fn goes_on(&self, h: u32, forward: bool) -> Option<u32> {
        let g = self.g;
        let v = g.origin(if forward { g.next(h) } else { h });
        if self.seams[v as usize] != 2 || is_boundary(g.twin(g.vertex_half_edge(v))) {
            return None;
        }
        let mut at = if forward { g.next(h) } else { g.prev(h) };
        while !is_boundary(self.u.twin(at)) {
            at = if forward { g.next(g.twin(at)) } else { g.prev(g.twin(at)) };
        }
        Some(at)
    }

    /// The vertex of the texture coordinates that `h` leaves, and the one that it runs to.
    fn ends(&self, h: u32) -> [u32; 2] {
        [self.u.origin(h), self.u.origin(self.g.next(h))]
    }

    /// The fan around `v` that the face in the place of `v` is given to: the one with the most seams, then with the most
    /// faces. By its vertex of the texture coordinates.
    fn home(&self, v: u32) -> u32 {
        let (g, start) = (self.g, self.g.vertex_half_edge(v));
        if self.seams[v as usize] == 0 {
            return self.u.origin(start);
        }
        let mut fans: Vec<[u32; 3]> = Vec::new();
        g.turn(v, |h| {
            let fan = self.u.origin(h);
            let seams = u32::from(self.owns[h as usize]) + u32::from(self.owns[g.prev(h) as usize]);
            match fans.iter_mut().find(|f| f[2] == fan) {
                Some(f) => (f[0], f[1]) = (f[0] + seams, f[1] + 1),
                None => fans.push([seams, 1, fan]),
            }
        });
        let mut best = [0; 3];
        for fan in fans {
            if fan[..2] > best[..2] {
                best = fan;
            }
        }
        best[2]
    }

    /// The homes of all vertices that `has_face` (of the spokes and of whether they lie on a boundary), [`NONE`] elsewhere.
    fn homes(&self, has_face: impl Fn(u32, bool) -> bool) -> Vec<u32> {
        let of = |v| {
            let mut spokes = 0;
            let arriving = self.g.turn(v, |_| spokes += 1);
            if has_face(spokes, arriving.is_some()) { self.home(v) } else { NONE }
        };
        (0..self.g.vertices()).map(of).collect()
    }

    /// What the scheme's rules see: the vertices of `u`; seams are boundaries ranked behind the rim, or `joined`, where rules
    /// read no face but their own.
    fn seen(&self, joined: bool) -> Topology {
        let (g, u) = (self.g, self.u);
        let mut seen = u.clone();
        seen.boundary.clone_from(&g.boundary);
        for (h, twin) in seen.twin.iter_mut().enumerate() {
            *twin = match self.is_seam(h as u32) && !joined {
                true => !(g.boundary_half_edges() + boundary_rank(*twin)),
                false => g.twin(h as u32),
            };
        }
        seen
    }
}

/// The counts of texture coordinates after a step that takes the mesh to `mesh`: at most, where faces leave their parents.
pub(crate) fn counts(step: &Step, uv: Counts, mesh: Counts) -> Option<Counts> {
    if step.split.keeps_corners() || uv == Counts::default() {
        return step.split.counts(uv);
    }
    Some(Counts { vertices: mesh.corners, edges: mesh.corners, boundary: mesh.corners, ..mesh })
}

/// Takes texture coordinates through `step`, whose split leaves faces: `g` are the level's half-edges, `old` its channel,
/// `creases` how sharp the two are. Says also how many rows that were.
pub(crate) fn carry(
    g: &Topology,
    old: &Channel,
    (knots, [creases, own]): (&[f32], [Option<&Creases>; 2]),
    (step, at): (&Step, u32),
    rules: Rules,
) -> (Channel, usize) {
    let split = step.split;
    let creases = creases.filter(|_| matches!(split, Split::Sqrt3 { .. }) && step.scheme.honours.creases);
    let creased = creases.map(|creases| Creased::new(g, old, creases));
    let (seen, channel) = creased.as_ref().map_or((g, old), |c| (&c.g, &c.channel));
    let charts = Charts::new(seen, &channel.topology);
    let lone = split.lone(g);
    let places = match split {
        Split::Sqrt3 { trisect } => charts.sqrt3(trisect),
        Split::MidEdge { cut, .. } => charts.mid_edge(cut, &lone),
        _ => charts.dual(&lone),
    };
    // In the dual split the rim's corners are cut or kept as the mesh's are; else they are among the pins.
    let boundary = if split.keeps_vertices() { Boundary::EdgeOnly } else { rules.boundary };
    let rules_seen = Rules { boundary, ..rules };
    let tags = Tags { lone: &lone, knots, step: at, ..Tags::new(rules_seen, step.params) };
    let mut images = charts.images(channel, step, tags);
    if let Some(creased) = creased.as_ref().filter(|c| !c.darts.is_empty()) {
        let whole = Charts::new(g, &old.topology).images(old, step, Tags { creases: own, ..tags });
        creased.mend(&charts, split, &whole[..], old.topology.vertices(), &mut images);
    }

    let value = |v: u32| channel.values[v as usize].map(f64::from);
    let mix = |a: u32, b: u32, w: f64| {
        let (a, b) = (value(a), value(b));
        std::array::from_fn(|k| (w * a[k] + (1.0 - w) * b[k]) as f32)
    };
    let find = |place: Place| match place {
        Place::Image(c) => images[c as usize],
        Place::Point(c) => channel.values[c as usize],
        Place::Along(a, b) => mix(a, b, 0.75),
        Place::Middle(a, b) => mix(a, b, 0.5),
    };
    // The children's half-edges, cut where a side has other places on its other face. What a crease cut is one again.
    let cut = split.cut(g, creases);
    debug_assert_eq!(places.len(), cut.corners.len());
    let child = cut.connect(g, split, split.children(g), creases);
    let same = |a: u32, b: u32| {
        let (a, b) = (places[a as usize], places[b as usize]);
        a == b || creases.is_some() && find(a) == find(b)
    };
    let joined = |h: u32, t: u32| same(h, child.next(t)) && same(child.next(h), t);
    let mate = |h: u32| Some(child.twin(h)).filter(|&t| !is_boundary(t) && joined(h, t)).unwrap_or(NONE);
    let mates: Vec<u32> = (0..child.half_edges()).map(mate).collect();
    let vertices = child.vertices() as usize;
    let (topology, _) = Topology::assemble(child.offsets().to_vec(), child.origins(), vertices, &mates);
    let place = |v: u32| places[topology.vertex_half_edge(v) as usize];
    let values: Vec<[f32; 4]> = (0..topology.vertices()).map(|v| find(place(v))).collect();
    let pins = if split.keeps_vertices() {
        let before = |c: u32| creased.as_ref().map_or(c, |cut| cut.source.get(c as usize).copied().unwrap_or(NONE));
        let stays = |v| matches!(place(v), Place::Image(c) if old.pins.get(before(c) as usize).is_some_and(|&p| p));
        (0..topology.vertices()).map(stays).collect()
    } else {
        // Vertices are new: what stays is told by the regions that meet there.
        let same = |a: u32, b: u32| values[a as usize] == values[b as usize];
        face_varying::pinned(&child, &topology, Sharp { kept: &[], vertices: &[], edges: &[] }, &rules, same)
    };
    let rows = images.len() + places.len();
    (Channel { topology, values, pins }, rows)
}

impl Charts<'_> {
    /// What the scheme's rows make of every child.
    fn images(&self, old: &Channel, step: &Step, tags: Tags<'_>) -> Vec<[f32; 4]> {
        let (split, children) = (step.split, self.children(step.split, tags.lone));
        let mut images = vec![[0.0f32; 4]; children as usize];
        let mut take = |child: u32, row: &[(Source, f64)], _| {
            let sum = weigh(row, |s| match s {
                Source::Vertex(v) => old.values[v as usize].map(f64::from),
                Source::Child(v) => images[v as usize].map(f64::from),
            });
            images[child as usize] = sum.map(|x| x as f32);
        };
        let seen = self.seen(matches!(split, Split::Dual { .. }));
        let tags = Tags { sharp: &old.pins, ..tags };
        step.scheme.rows((&Level::Base(&seen), split, tags), &mut take, &mut Cursor::default(), &mut { usize::MAX });
        if let Split::Sqrt3 { trisect } = split {
            let linear = tags.rules.face_varying == FaceVarying::All;
            self.straighten(old, trisect, linear, linear || step.scheme.info.interpolating, &mut images);
        }
        images
    }

    /// How many children rows can name.
    fn children(&self, split: Split, lone: &[u32]) -> u32 {
        let (g, u) = (self.g, self.u);
        match split {
            Split::Sqrt3 { trisect } => u.vertices() + g.faces() + if trisect { g.boundary_half_edges() } else { 0 },
            Split::MidEdge { .. } => split.children(u).max(u.edges() + lone.len() as u32),
            _ => g.half_edges() + lone.len() as u32,
        }
    }

    /// Puts the vertices of the sqrt3 split that lie on seams on a smooth curve, the rule of which halves edges (of an
    /// `interpolating` scheme they stay); with `linear` rules all stay, and centres are centroids.
    fn straighten(&self, old: &Channel, trisect: bool, linear: bool, interpolating: bool, images: &mut [[f32; 4]]) {
        let (g, u) = (self.g, self.u);
        let value = |v: u32| old.values[v as usize].map(f64::from);
        for v in 0..u.vertices() {
            let start = u.vertex_half_edge(v);
            let inside = !is_boundary(g.twin(g.vertex_half_edge(g.origin(start))));
            let pinned = old.pins.get(v as usize).is_some_and(|&p| p);
            if interpolating || (inside && pinned) {
                images[v as usize] = old.values[v as usize];
            } else if let Some(arriving) = u.turn(v, |_| {}).filter(|_| inside) {
                let (own, next, last) = (value(v), value(u.origin(u.next(start))), value(u.origin(arriving)));
                images[v as usize] = std::array::from_fn(|k| (0.75 * own[k] + 0.125 * (next[k] + last[k])) as f32);
            }
        }
        for f in (0..g.faces()).filter(|_| linear) {
            let corners = g.face_half_edges(f);
            if self.rim_of(corners.start, trisect).is_none() {
                let mut sum = [0.0; 4];
                for h in corners {
                    let own = value(u.origin(h));
                    (0..4).for_each(|k| sum[k] += own[k] / 3.0);
                }
                images[(u.vertices() + f) as usize] = sum.map(|x| x as f32);
            }
        }
    }
}
