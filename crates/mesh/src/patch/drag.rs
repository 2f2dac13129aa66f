//! A surface that follows its cage: moving a vertex evaluates again only what depends on it.
//!
//! ```text
//!   vertex ──> rows of level 1 that read it ──> patches whose ring has one of those points ──> their runs of ids
//! ```
//!
//! All of it is found by walking over half-edges from the vertex, never by a look at the whole mesh, and is evaluated by the
//! same statements in the same order, so that a surface that was dragged is, bit for bit, the one that is made anew.
//!
//! Cost: that of the patches that are touched (64 around a regular vertex of quads) and of some tens of rows. Memory: level 1
//! with its half-edges and what patches keep, beside the level itself. Limit: where patches start at level 1, up to level 6.

use super::{Out, Patches, Point, Progress};
use crate::crease::Creases;
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::plan::{Plan, Step};
use crate::refine::{RefineError, admit, sharp_at};
use crate::sink::Cursor;
use crate::split::{Level, on};
use crate::topology::Connectivity;
use std::ops::Range;
use std::sync::Arc;

/// A level of a mesh that can be dragged.
#[derive(Debug)]
pub struct Drag {
    mesh: Arc<Mesh>,
    plan: Plan,
    step: Step,
    steps: Vec<Step>,
    /// Of level 1.
    half_edges: Owned,
    creases: [Option<Creases>; 2],
    /// Points of levels 0 and 1.
    cage: Vec<Point>,
    first: Vec<Point>,
    patches: Patches,
    points: Vec<Point>,
    normals: Vec<Point>,
    corners: Vec<u32>,
    /// The last time that an element was met, by level 1's vertices and faces.
    met: [Vec<u32>; 2],
    time: u32,
}

/// What a move changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moved {
    /// The ids whose points and normals may be others now: rising, disjoint.
    pub vertices: Vec<Range<u32>>,
    /// How many patches were evaluated again.
    pub patches: usize,
}

impl Drag {
    /// Makes a level that can be dragged; none where patches do not make all of it from level 1 on.
    ///
    /// # Errors
    /// [`RefineError`], before anything is allocated.
    pub fn new(mesh: Arc<Mesh>, plan: &Plan, budget: u64) -> Result<Option<Drag>, RefineError> {
        let steps = admit(&mesh, plan, budget)?;
        let (Some(1), Some(&step)) = (super::start(&mesh, plan, &steps), steps.first()) else { return Ok(None) };
        // Colours are not held here.
        if step.split != steps[1].split || step.stored || !mesh.colors.is_empty() {
            return Ok(None);
        }
        let base = Level::Base(&mesh.topology);
        let below = Creases::of(&mesh, &mesh.topology, plan.rules.face_varying);
        let mut half_edges = Owned::below(&base, step.split, below.as_ref());
        let mut at = 0;
        while !half_edges.fill(&base, &mut at, &mut { usize::MAX }) {}
        let finer = below.as_ref().and_then(|c| c.below(&base, step.split, &half_edges.view(), plan.rules.decay));
        let Some(counts) = step.split.counts(mesh.counts()) else { return Ok(None) };
        let Some(patches) = Patches::new(steps[1], plan.rules, plan.level - 1, counts) else { return Ok(None) };
        let [last, _] = patches.counts();
        let (vertices, faces) = (counts.vertices as usize, counts.faces as usize);
        let mut drag = Drag {
            cage: mesh.positions.clone(),
            first: vec![[0.0; 3]; vertices],
            points: bytemuck::zeroed_vec(last.vertices as usize),
            normals: bytemuck::zeroed_vec(last.vertices as usize),
            corners: bytemuck::zeroed_vec(last.corners as usize),
            met: [vec![0; vertices], vec![0; faces]],
            time: 0,
            plan: plan.clone(),
            creases: [below, finer],
            mesh,
            step,
            steps,
            half_edges,
            patches,
        };
        drag.rows(&mut Cursor::default(), usize::MAX);
        Ok(drag.evaluate().then_some(drag))
    }

    /// One point a vertex of the level.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// Unit normals, one a vertex.
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// The corners of the level's faces, 3 or 4 each.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Where the vertices of the mesh are now.
    pub fn cage(&self) -> &[[f32; 3]] {
        &self.cage
    }

    /// Moves vertices of the mesh, by their ids there, and everything that depends on them. Panics at an id that does not exist.
    pub fn move_vertices(&mut self, moves: &[(u32, [f32; 3])]) -> Moved {
        self.time += 1;
        let mut changed = Vec::new();
        for &(v, to) in moves {
            self.cage[v as usize] = to;
            self.find_rows(v, &mut changed);
        }
        // By passes: edge points read face points.
        changed.sort_unstable();
        for (pass, row) in changed.iter().map(|&(pass, row, _)| (pass, row)) {
            self.rows(&mut Cursor::at(pass, row), 1);
        }
        let mut touched = Vec::new();
        let (met, time) = (&mut self.met[1], self.time);
        on!(&self.half_edges.view(), c => changed.iter().for_each(|&(_, _, v)| patches_at(*c, v, met, time, &mut touched)));
        touched.sort_unstable();
        let mut vertices = Vec::new();
        self.work(|patches, level, tags, first, out| {
            // Faces stay as they are.
            out.corners = &mut [];
            patches.again(level, &tags, first, out, &touched, &mut vertices);
        });
        Moved { vertices: join(vertices), patches: touched.len() }
    }

    /// Evaluates rows of level 1.
    fn rows(&mut self, cursor: &mut Cursor, mut count: usize) {
        let sharp = sharp_at(&self.steps, 0, &self.mesh, &[]);
        let tags = self.plan.tags(&self.step, 0, sharp, self.creases[0].as_ref());
        let level = Level::Base(&self.mesh.topology);
        let at = (&level, self.step.split, tags);
        self.step.scheme.eval(at, &self.cage, &mut self.first, cursor, &mut count);
    }

    /// Appends the rows of level 1 that read vertex `v` of the mesh, each once, as pass, row and child: those of everything in the
    /// faces around it.
    fn find_rows(&mut self, v: u32, out: &mut Vec<(u32, u32, u32)>) {
        let (t, split, time) = (&self.mesh.topology, self.step.split, self.time);
        let quads = split == crate::Split::Quad;
        let (faces, edges) = (split.first_face_point(t), split.first_edge_point(t));
        let met = &mut self.met[0];
        let mut add = |pass: u32, row: u32, child: u32| {
            if std::mem::replace(&mut met[child as usize], time) != time {
                out.push((pass, row, child));
            }
        };
        t.turn(v, |spoke| {
            let f = t.face(spoke);
            if quads {
                add(0, f, faces + f);
            }
            for h in t.face_half_edges(f) {
                add(u32::from(quads), t.edge(h), edges + t.edge(h));
                add(u32::from(quads) + 1, t.origin(h), t.origin(h));
            }
        });
    }

    /// Evaluates patches again: all, the first time.
    fn evaluate(&mut self) -> bool {
        let mut quota = usize::MAX;
        loop {
            match self.work(|patches, level, tags, first, out| patches.work(level, &tags, first, out, &mut quota)) {
                Progress::More => quota = usize::MAX,
                progress => return progress == Progress::Done,
            }
        }
    }

    fn work<T>(
        &mut self,
        with: impl FnOnce(&mut Patches, &Level<'_>, crate::scheme::Tags<'_>, &[Point], &mut Out<'_>) -> T,
    ) -> T {
        let sharp = sharp_at(&self.steps, 1, &self.mesh, &[]);
        let tags = self.plan.tags(&self.steps[1], 1, sharp, self.creases[1].as_ref());
        let mut out = Out { points: &mut self.points, normals: &mut self.normals, corners: &mut self.corners };
        with(&mut self.patches, &self.half_edges.view(), tags, &self.first, &mut out)
    }
}

/// Appends the patches whose ring has vertex `v`, each once: those that share a vertex with a face at `v`.
fn patches_at<C: Connectivity>(c: &C, v: u32, met: &mut [u32], time: u32, out: &mut Vec<u32>) {
    c.turn(v, |spoke| {
        for h in c.face_half_edges(c.face(spoke)) {
            c.turn(c.origin(h), |spoke| {
                let patch = c.face(spoke);
                if std::mem::replace(&mut met[patch as usize], time) != time {
                    out.push(patch);
                }
            });
        }
    });
}

/// The same ids in rising, disjoint ranges.
fn join(mut ranges: Vec<Range<u32>>) -> Vec<Range<u32>> {
    ranges.sort_unstable_by_key(|range| range.start);
    let mut out: Vec<Range<u32>> = Vec::new();
    for range in ranges {
        match out.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => out.push(range),
        }
    }
    out
}
