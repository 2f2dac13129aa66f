//! Charts beside creases, for the split that turns edges: it does not turn those, and a crease is a rim from both sides
//! ([`crate::apart`]). So half-edges and charts are cut there, and what holds at rims holds on either side.
//!
//! ```text
//!     \ A /        \ A /
//!   ---(v)---    ---.v.---    v has two vertices in the cut half-edges, and in the chart; both go to the same place, and where
//!     / A \        / A \      they do the children's half-edges are joined again
//! ```
//!
//! A dart has one, with a slit: its curve ends there. It and the faces around it are what the scheme makes of them where
//! nothing is cut. Cost: linear.

use super::{Channel, Charts};
use crate::apart::Apart;
use crate::connect::UNMATCHED;
use crate::crease::Creases;
use crate::split::Split;
use crate::topology::{Connectivity, Topology, is_boundary};

/// A level and its charts, cut along creases.
pub(super) struct Creased {
    pub g: Topology,
    pub channel: Channel,
    /// The vertex of the charts that each was before.
    pub source: Vec<u32>,
    /// Which of them are darts.
    pub darts: Vec<u32>,
}

impl Creased {
    /// Cuts `g` and its charts.
    pub fn new(g: &Topology, old: &Channel, creases: &Creases) -> Creased {
        let apart = Apart::turned(g, creases);
        let cut = |t: &Topology| {
            let mate = |h: u32| Some(t.twin(h)).filter(|&t| !is_boundary(t) && !apart.is_cut(h)).unwrap_or(UNMATCHED);
            let mates: Vec<u32> = (0..t.half_edges()).map(mate).collect();
            Topology::assemble(t.offsets().to_vec(), t.origins(), t.vertices() as usize, &mates)
        };
        let ((whole, _), (topology, source)) = (cut(g), cut(&old.topology));
        let at = |v: u32| g.origin(topology.vertex_half_edge(v));
        let all = 0..topology.vertices();
        let darts = all.clone().filter(|&v| apart.is_dart(at(v))).collect();
        let kept = |v: u32| old.pins.get(source[v as usize] as usize).is_some_and(|&pinned| pinned);
        let pins = all.map(|v| kept(v) || apart.is_pinned(at(v)) || apart.is_dart(at(v))).collect();
        let values = source.iter().map(|&v| old.values[v as usize]).collect();
        Creased { g: whole, channel: Channel { topology, values, pins }, source, darts }
    }

    /// Takes what belongs to darts from the images of the `whole` level, which has `first` vertices.
    pub fn mend(&self, charts: &Charts<'_>, split: Split, whole: &[[f32; 4]], first: u32, images: &mut [[f32; 4]]) {
        let t = &self.channel.topology;
        for &v in &self.darts {
            images[v as usize] = whole[self.source[v as usize] as usize];
            t.turn(v, |h| {
                if charts.rim_of(h, split == Split::Sqrt3 { trisect: true }).is_none() {
                    images[(t.vertices() + t.face(h)) as usize] = whole[(first + t.face(h)) as usize];
                }
            });
        }
    }
}
