//! The stage of a track that makes the last level of patches, and what becomes of it where they do not fit.
//!
//! ```text
//!   Patches ── done ──> the last level, corners and normals with it       colours: once more, as points of red, green, blue,
//!           └─ unfit ─> Points of this level; patches are tried again     and again of alpha unless it is the same everywhere
//!                       at the next
//! ```
//!
//! Texture coordinates are such colours on half-edges of their own, with corners of their own.

use super::{Track, zeroed};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::patch::{self, Patches};
use crate::plan::{Plan, Step};
use crate::refine::{Kept, sharp_at};
use crate::refined::{Faces, Refined};
use crate::scheme::{Boundary, FaceVarying, Rules, Tags, scheme};
use crate::split::Level;

/// What a track has of patches.
#[derive(Debug, Default)]
pub(crate) struct Patched {
    /// The level from which they make the last one.
    pub(super) from: Option<u32>,
    patches: Option<Box<Patches>>,
    /// Whether normals are wanted of them, and these.
    pub(crate) shaded: bool,
    pub(crate) normals: Vec<[f32; 3]>,
    /// Whether corners are there already.
    listed: bool,
    /// Points of a level that is not needed any more: a buffer to be filled, once the levels before are made.
    spare: Vec<[f32; 3]>,
    channels: Channels,
}

/// Three channels of colours that are evaluated as points are.
#[derive(Debug, Default)]
struct Channels {
    /// How many times patches were worked off: for points, then for these.
    turn: u32,
    old: Vec<[f32; 3]>,
    new: Vec<[f32; 3]>,
}

impl Track {
    /// Takes the buffers of another level, and its corners if they are the `same`.
    pub(crate) fn reuse(&mut self, old: Refined, same: bool) {
        if self.patched.from.is_none() || !self.new_points.is_empty() {
            return;
        }
        self.patched.spare = old.points;
        self.patched.normals = old.known_normals.filter(|_| self.patched.shaded).unwrap_or_default();
        if let Faces::Quads(corners) | Faces::Triangles(corners) = old.faces {
            (self.corners, self.patched.listed) = (corners, same);
        }
    }

    /// Takes no patches.
    pub(crate) fn no_patches(&mut self) {
        self.patched.from = None;
    }

    /// Makes the last level of patches.
    pub(super) fn patch(
        &mut self,
        level: &Level<'_>,
        mesh: &Mesh,
        plan: &Plan,
        steps: &[Step],
        quota: &mut usize,
    ) -> Option<Option<Owned>> {
        let step = steps.get(self.level as usize)?;
        let all_linear = self.uv && plan.rules.face_varying == FaceVarying::All;
        let linear = scheme("linear").filter(|_| all_linear);
        let step = &Step { scheme: linear.unwrap_or(step.scheme), ..*step };
        if self.patched.patches.is_none() {
            self.patched.patches = Patches::new(*step, plan.rules, plan.level - self.level, self.counts).map(Box::new);
            self.new_points = std::mem::take(&mut self.patched.spare);
            if let (Some(patches), true) = (&self.patched.patches, self.uv) {
                let [counts, _] = patches.counts();
                self.paint(counts.vertices as usize);
                fit(&mut self.corners, counts.corners as usize);
            }
        }
        let (sharp, boundary) = match self.uv {
            // Corners are among the pins, and no others.
            true => (Kept { sharp: &self.pins, joined: &[] }, Boundary::EdgeOnly),
            false => (sharp_at(steps, self.level, mesh, &self.corner), plan.rules.boundary),
        };
        let tags = plan.tags(step, self.level, sharp, self.creases.as_ref());
        let tags = Tags { rules: Rules { boundary, ..tags.rules }, ..tags };
        let progress = match &mut self.patched.patches {
            Some(patches) if self.patched.channels.turn > 0 => {
                let Channels { old, new, .. } = &mut self.patched.channels;
                let corners = if self.uv { &mut self.corners[..] } else { &mut [] };
                let out = &mut patch::Out { points: new, normals: &mut [], corners };
                patches.work(level, &tags, old, out, quota)
            }
            Some(patches) => {
                let [counts, _] = patches.counts();
                fit(&mut self.new_points, counts.vertices as usize);
                fit(&mut self.patched.normals, if self.patched.shaded { counts.vertices as usize } else { 0 });
                fit(&mut self.corners, counts.corners as usize);
                let (points, normals) = (&mut self.new_points[..], &mut self.patched.normals[..]);
                let corners = if self.patched.listed { &mut [] } else { &mut self.corners[..] };
                let old = self.points.as_deref().unwrap_or(&mesh.positions);
                patches.work(level, &tags, old, &mut patch::Out { points, normals, corners }, quota)
            }
            None => patch::Progress::Unfit,
        };
        match (progress, self.patched.patches.take()) {
            (patch::Progress::Done, Some(mut patches)) => {
                if self.paint(patches.counts()[0].vertices as usize) {
                    patches.restart();
                    self.patched.patches = Some(patches);
                    return None;
                }
                self.level = plan.level;
                [self.counts, self.before] = patches.counts();
                if !self.uv {
                    self.points = Some(std::mem::take(&mut self.new_points));
                }
                return Some(None);
            }
            (patch::Progress::More, patches) => self.patched.patches = patches,
            _ => {
                // Marks fade, and rings become alike: perhaps from the next level on.
                self.patched.from = Some(self.level + 1).filter(|from| from + 2 <= plan.level);
                (self.new_points, self.patched.normals, self.corners) = Default::default();
                (self.patched.listed, self.patched.channels) = Default::default();
                self.stage = self.first_stage();
            }
        }
        None
    }
}

impl Track {
    /// Takes the channels that patches have made, if any, into the colours or texture coordinates of `vertices`, and lists the next;
    /// false when all are there.
    fn paint(&mut self, vertices: usize) -> bool {
        let Some(alpha) = self.wide.first().map(|color| color[3]) else { return false };
        let Channels { turn, old, new } = &mut self.patched.channels;
        *turn += 1;
        let more = match turn {
            1 => {
                *old = self.wide.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
                *new = bytemuck::zeroed_vec(vertices);
                true
            }
            2 => {
                self.new_wide = new.iter().map(|&[r, g, b]| [r, g, b, alpha]).collect();
                *old = self.wide.iter().map(|color| [color[3], 0.0, 0.0]).collect();
                self.wide.iter().any(|color| color[3] != alpha)
            }
            _ => {
                self.new_wide.iter_mut().zip(new).for_each(|(color, made)| color[3] = made[0]);
                false
            }
        };
        if !more {
            self.wide = std::mem::take(&mut self.new_wide);
            self.patched.channels = Channels::default();
        }
        more
    }
}

/// Makes a buffer that is written all over of that length: what is in it may stay, if there is room, and not much more.
fn fit<T: Clone + bytemuck::Zeroable>(buffer: &mut Vec<T>, length: usize) {
    if length > 0 && (length..=2 * length).contains(&buffer.capacity()) {
        buffer.resize(length, T::zeroed());
    } else {
        // Two at once are never held.
        *buffer = Vec::new();
        zeroed(buffer, length);
    }
}
