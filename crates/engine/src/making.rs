//! Making a surface: from a mesh and a plan to buffers on the GPU, a slice at a time.
//!
//! ```text
//!   Making ── step ──► Refine (points, faces) ── step ──► Build (normals, buffers) ──► Made
//! ```
//!
//! Who refines is a [`Work`]: a job of this module, or a run of the one with every scheme. Where that module, or the GPU, fills the
//! buffers itself, a [`Filler`] is waited for, and the level that is [`Made`] has no points here.
//!
//! Nothing of what is shown changes until a step gives [`Made`]; dropping a [`Making`] is all that cancelling takes. Flat
//! shading of small models takes the corner layout, which has one normal a polygon: that changes buffers only, so
//! [`Making::again`] starts from the points that are there.

use std::sync::Arc;

use limn_document::Document;
use limn_mesh::{Job, Mesh, NONE, Plan, Refined, order};
use limn_render::{Bounds, Error, Part, Renderer, Surface, SurfaceData, Upload};

/// Rows of refinement, or elements of an upload, between two looks at the clock: about half a millisecond.
const ROWS: usize = 16 << 10;

/// Corner layout for flat shading up to this many faces: it takes six times the memory.
pub const MOST_FLAT: u64 = 400_000;

/// Materials and groups of a model's faces, as the renderer wants them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    list: Vec<Part>,
    /// The part of each face of the document's soup; empty if there is one part.
    of_face: Vec<u32>,
}

impl Parts {
    /// The parts of the document's polygons.
    pub fn of(document: &Document) -> Parts {
        let Some(soup) = document.soup() else { return Parts::default() };
        if soup.face_groups.is_empty() && soup.face_materials.is_empty() {
            return Parts::default();
        }
        // Known pairs of material and group, sorted, and their numbers.
        let mut known: (Vec<u64>, Vec<u32>) = Default::default();
        let mut parts = Parts::default();
        for f in 0..soup.face_count() {
            let material = soup.face_materials.get(f).copied().unwrap_or(NONE);
            let group = soup.face_groups.get(f).copied().unwrap_or(0);
            let key = order::key(material, group);
            let at = known.0.binary_search(&key).unwrap_or_else(|at| {
                known.0.insert(at, key);
                known.1.insert(at, parts.list.len() as u32);
                parts.list.push(Part { material, group });
                at
            });
            parts.of_face.extend(known.1.get(at));
        }
        parts
    }

    /// The part of each face of the soup; empty if there is one.
    pub fn of_faces(&self) -> &[u32] {
        if self.list.len() < 2 { &[] } else { &self.of_face }
    }

    /// The group of a face of the soup.
    pub fn group(&self, face: u32) -> u32 {
        let part = self.of_face.get(face as usize).copied().unwrap_or(0);
        self.list.get(part as usize).map_or(0, |p| p.group)
    }
}

/// A level with everything that was made of it on the CPU.
#[derive(Clone)]
pub struct Made {
    /// The level.
    pub refined: Arc<Refined>,
    /// How it was made.
    pub plan: Plan,
    /// Whether it has the corner layout for flat shading's sake.
    pub corners: bool,
    /// Normals that did not come with the level.
    normals: Arc<Vec<[f32; 3]>>,
    /// The model's parts.
    pub parts: Arc<Parts>,
}

impl Made {
    /// Whether the level's points are on the GPU alone, whoever refined it.
    pub fn is_away(&self) -> bool {
        self.refined.points.is_empty()
    }

    /// Whether this is `plan` of `mesh` in that layout.
    pub fn is(&self, mesh: &Arc<Mesh>, plan: &Plan, corners: bool) -> bool {
        Arc::ptr_eq(self.refined.mesh(), mesh) && self.plan == *plan && self.corners == corners
    }

    /// Bytes on the CPU.
    pub fn bytes(&self) -> u64 {
        let r = &self.refined;
        let floats = r.points.len() * 3 + self.normals().len() * 3 + r.colors.len() * 4;
        let uv = r.uv.as_ref().map_or(0, |uv| uv.values.len() * 2 + uv.corners.len());
        4 * (floats + uv + r.faces.corners().len()) as u64
    }

    fn normals(&self) -> &[[f32; 3]] {
        self.refined.known_normals.as_deref().unwrap_or(&self.normals)
    }

    /// Calls `with` with the surface as the renderer takes it.
    fn data<T>(&self, with: impl FnOnce(&SurfaceData<'_>) -> T) -> T {
        limn_layout::level(&self.refined, self.normals(), (&self.parts.list, &self.parts.of_face), self.corners, with)
    }
}

/// Refining under way, here or in another module.
pub trait Work {
    /// Works off about `rows` rows and says whether all is done.
    ///
    /// # Errors
    /// One sentence, if the other module failed.
    fn step(&mut self, rows: usize) -> Result<bool, String>;
    /// How much is done, 0 to 1.
    fn progress(&self) -> f32;
    /// The level, once all is done.
    ///
    /// # Errors
    /// One sentence, if the other module failed.
    fn finish(self: Box<Self>) -> Result<Refined, String>;
}

/// Who makes a level in a surface's own buffers, at its own pace.
pub trait Filler {
    /// The box of the points, lowest coordinates first; empty while it is at work. Behind it the milliseconds of refining and of filling, if
    /// the CPU did it. None: it failed, and the level has to come here.
    fn bounds(&self) -> Option<Vec<f32>>;
    /// The runs of parts.
    fn runs(&self) -> Vec<u32>;
    /// How much is done, 0 to 1.
    fn progress(&self) -> f32;
}

impl Work for Job {
    fn step(&mut self, rows: usize) -> Result<bool, String> {
        Ok(Job::step(self, rows))
    }

    fn progress(&self) -> f32 {
        Job::progress(self)
    }

    fn finish(self: Box<Self>) -> Result<Refined, String> {
        Ok(Job::finish(*self))
    }
}

enum Stage {
    Refine(Box<dyn Work>),
    /// Since when.
    Wait(Box<dyn Filler>, Surface, Made, f64),
    Build(Made, Option<Box<Upload>>),
    Over,
}

/// A surface that is being made.
pub struct Making {
    mesh: Arc<Mesh>,
    plan: Plan,
    corners: bool,
    parts: Arc<Parts>,
    stage: Stage,
    /// Milliseconds spent on refining, and on normals and buffers.
    pub spent: [f64; 2],
    /// Whether the GPU refined it.
    pub on_gpu: bool,
}

/// What a step came to.
#[allow(clippy::large_enum_variant)] // One lives at a time.
pub enum Step {
    /// There is more to do.
    More,
    /// The GPU failed: the CPU has to do it.
    Failed,
    /// The surface is there.
    Done(Made, Surface),
}

impl Making {
    /// Begins with refining: `work` makes `plan` of `mesh`.
    pub fn refine(work: Box<dyn Work>, mesh: Arc<Mesh>, plan: Plan, corners: bool, parts: Arc<Parts>) -> Making {
        Making { mesh, plan, corners, parts, stage: Stage::Refine(work), spent: [0.0; 2], on_gpu: false }
    }

    /// Begins to wait for who fills `surface` since `now`.
    pub fn wait(
        filler: Box<dyn Filler>,
        surface: Surface,
        refined: Refined,
        plan: Plan,
        parts: Arc<Parts>,
        now: f64,
    ) -> Making {
        let (mesh, normals) = (refined.mesh().clone(), Arc::default());
        let made =
            Made { refined: Arc::new(refined), plan: plan.clone(), corners: false, normals, parts: parts.clone() };
        let stage = Stage::Wait(filler, surface, made, now);
        Making { mesh, plan, corners: false, parts, stage, spent: [0.0; 2], on_gpu: false }
    }

    /// Whether there is nothing to do before the buffers are filled.
    pub fn waits(&self) -> bool {
        matches!(&self.stage, Stage::Wait(filler, ..) if filler.bounds().is_some_and(|b| b.is_empty()))
    }

    /// Begins with the points of `made`, for the other layout.
    pub fn again(made: &Made, corners: bool) -> Making {
        let made = Made { corners, ..made.clone() };
        Making {
            mesh: made.refined.mesh().clone(),
            plan: made.plan.clone(),
            corners,
            parts: made.parts.clone(),
            stage: Stage::Build(made, None),
            spent: [0.0; 2],
            on_gpu: false,
        }
    }

    /// Whether this makes `plan` of `mesh` in that layout.
    pub fn is(&self, mesh: &Arc<Mesh>, plan: &Plan, corners: bool) -> bool {
        Arc::ptr_eq(&self.mesh, mesh) && self.plan == *plan && self.corners == corners
    }

    /// Whether this differs from `plan` of `mesh` in the scheme's parameters at most.
    pub fn is_but_for_params(&self, mesh: &Arc<Mesh>, plan: &Plan, corners: bool) -> bool {
        self.is(mesh, &Plan { params: self.plan.params, ..plan.clone() }, corners)
    }

    /// The level that is being made.
    pub fn level(&self) -> u32 {
        self.plan.level
    }

    /// The share that is done, 0..=1; two thirds are for refining.
    pub fn progress(&self) -> f32 {
        match &self.stage {
            Stage::Wait(filler, ..) => filler.progress(),
            Stage::Refine(work) => work.progress() * 0.66,
            Stage::Build(_, None) => 0.66,
            Stage::Build(_, Some(upload)) => 0.7 + 0.3 * upload.progress(),
            Stage::Over => 1.0,
        }
    }

    /// Works until `deadline` (milliseconds on `clock`) or the end. One thing cannot be cut: the normals, about 10 ns a face.
    ///
    /// # Errors
    /// What the renderer says about the buffers, or the other module about refining: one sentence.
    pub fn step(&mut self, renderer: &Renderer, clock: impl Fn() -> f64, deadline: f64) -> Result<Step, String> {
        let start = clock();
        let stage = std::mem::replace(&mut self.stage, Stage::Over);
        let (next, kind) = match stage {
            Stage::Wait(filler, mut surface, made, since) => match filler.bounds().as_deref() {
                Some(&[a, b, c, d, e, f, ref spent @ ..]) => {
                    self.on_gpu = spent.is_empty();
                    self.spent = match *spent {
                        [refine, fill, ..] => [refine.into(), fill.into()],
                        _ => [start - since, 0.0],
                    };
                    surface.settle(Bounds { min: [a, b, c], max: [d, e, f] }, &made.parts.list, &filler.runs());
                    return Ok(Step::Done(made, surface));
                }
                Some(_) => (Stage::Wait(filler, surface, made, since), 1),
                None => return Ok(Step::Failed),
            },
            Stage::Refine(mut work) => {
                let done = loop {
                    if work.step(ROWS)? {
                        break true;
                    }
                    if clock() >= deadline {
                        break false;
                    }
                };
                let next = if done {
                    let refined = Arc::new(work.finish()?);
                    let made = Made {
                        refined,
                        plan: self.plan.clone(),
                        corners: self.corners,
                        normals: Arc::default(),
                        parts: self.parts.clone(),
                    };
                    Stage::Build(made, None)
                } else {
                    Stage::Refine(work)
                };
                (next, 0)
            }
            Stage::Build(mut made, None) => {
                if made.normals().is_empty() {
                    made.normals = Arc::new(made.refined.normals());
                }
                let upload = made.data(|data| renderer.upload(data)).map_err(|e| e.to_string())?;
                (Stage::Build(made, Some(Box::new(upload))), 1)
            }
            Stage::Build(made, Some(mut upload)) => {
                let done = made.data(|data| {
                    loop {
                        if upload.step(renderer.gpu(), data, ROWS)? {
                            return Ok(true);
                        }
                        if clock() >= deadline {
                            return Ok(false);
                        }
                    }
                });
                let done = done.map_err(|e: Error| e.to_string())?;
                // Hands over what was written: left to pile up, it would hold up the next frame for seconds.
                renderer.gpu().queue.submit(std::iter::empty());
                if done {
                    self.spent[1] += clock() - start;
                    return Ok(Step::Done(made, upload.finish()));
                }
                (Stage::Build(made, Some(upload)), 1)
            }
            Stage::Over => (Stage::Over, 1),
        };
        self.stage = next;
        if let Some(spent) = self.spent.get_mut(kind) {
            *spent += clock() - start;
        }
        Ok(Step::More)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use limn_formats::Model;
    use limn_mesh::{Soup, refine};

    /// Two quads side by side, of two groups and one material between them.
    fn two_groups() -> Document {
        let points = (0..6).map(|i| [(i / 2) as f32, (i % 2) as f32, 0.0]).collect();
        let mut soup = Soup::from_faces(points, &[[0u32, 2, 3, 1], [2, 4, 5, 3]]);
        soup.face_groups = vec![1, 0];
        soup.face_materials = vec![NONE, 0];
        let model = Model { soup, groups: vec!["a".into(), "b".into()], ..Model::default() };
        let mut document = Document::new(1 << 20);
        let source = limn_document::Source::File { name: "two.obj".into(), stamp: None };
        document.load(source, model, &[]).unwrap();
        document
    }

    #[test]
    fn parts_follow_groups_and_materials() {
        let document = two_groups();
        let parts = Parts::of(&document);
        assert_eq!(parts.list, [Part { material: NONE, group: 1 }, Part { material: 0, group: 0 }]);
        assert_eq!(parts.of_face, [0, 1]);
        assert_eq!((parts.group(0), parts.group(1)), (1, 0));
        assert_eq!(Parts::of(&Document::new(1)), Parts::default());
    }

    #[test]
    fn every_scheme_s_levels_can_be_drawn() {
        for entry in limn_mesh::SCHEMES {
            for (name, level) in [("cube", 1), ("cube", 2), ("pawn", 1), ("grid", 1)] {
                let mut document = Document::new(1 << 28);
                if document.run(&format!("open builtin:{name}")).is_err() {
                    continue;
                }
                document.run(&format!("scheme {}", entry.info.id)).unwrap();
                document.run(&format!("level {level}")).unwrap();
                let (mesh, plan) = (document.mesh().unwrap(), document.plan().unwrap());
                let refined = Arc::new(refine(mesh, &plan, 1 << 28).unwrap());
                let (normals, parts) = (Arc::new(refined.normals()), Arc::new(Parts::of(&document)));
                let made = Made { refined: refined.clone(), plan, corners: false, normals, parts };
                made.data(|data| {
                    let Some([faces, edges]) = data.parents.filter(|_| data.is_shared()) else { return };
                    for f in 0..refined.faces.count() {
                        let &[v, e, c, d] = refined.faces.face(f) else { panic!("shared faces are quads") };
                        let born = |v: u32| (v >= faces) as u32 + (v >= edges) as u32;
                        assert_eq!([v, e, c, d].map(born), [0, 2, 1, 2], "{}, {name}: face {f}", entry.info.id);
                    }
                });
            }
        }
    }

    #[test]
    fn a_level_s_faces_keep_the_part_of_their_ancestor() {
        let mut document = two_groups();
        document.run("level 2").unwrap();
        let (mesh, plan) = (document.mesh().unwrap(), document.plan().unwrap());
        let refined = Arc::new(refine(mesh, &plan, 1 << 20).unwrap());
        let normals = Arc::new(refined.normals());
        let parts = Arc::new(Parts::of(&document));
        let made = Made { refined: refined.clone(), plan: plan.clone(), corners: false, normals, parts };
        made.data(|data| {
            let part_of = data.part_of.unwrap();
            for f in 0..refined.faces.count() {
                let middle: f32 =
                    refined.faces.face(f).iter().map(|&v| refined.points[v as usize][0]).sum::<f32>() / 4.0;
                assert_eq!(part_of(f), u32::from(middle > 1.0), "face {f} at {middle}");
            }
            assert!(data.is_shared());
            assert_eq!(data.parents, refined.parent_ranges);
        });
        assert!(made.is(mesh, &plan, false) && !made.is(mesh, &plan.to(1), false));
        assert_eq!(made.bytes(), 4 * (refined.points.len() * 6 + refined.faces.corners().len()) as u64);
    }
}
