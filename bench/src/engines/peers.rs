//! The other crates for subdivision in Rust: from indexed faces to the points and faces of a level.
//!
//! Each gets its own input type made beforehand, off the clock. Both keep more than Limn does (opensubdiv-rs every level with
//! its edges, subdiv-kernels every level's stencils); that is what they cost to someone who wants the refined mesh.
//!
//! opensubdiv-rs has Catmull-Clark, Loop and bilinear quads (our linear, on quads); subdiv-kernels has Catmull-Clark, Loop,
//! sqrt3 and Doo-Sabin. Neither has a Butterfly.

use super::{Absent, Differs, Engine, Job, Run};
use crate::{clock, memory};
use limn_kernel::trial::same::Surface;
use opensubdiv_rs::{far, sdc};
use std::hint::black_box;
use std::num::NonZeroU8;

/// One crate.
#[derive(Clone, Copy, PartialEq)]
pub enum Peer {
    /// A port of OpenSubdiv.
    OpenSubdiv,
    /// Stencil tables.
    Kernels,
}

impl Peer {
    /// All of them, in the order of the table.
    pub const ALL: [Peer; 2] = [Peer::OpenSubdiv, Peer::Kernels];
}

/// What a run left behind, still in the crate's own form.
enum Output {
    /// Every level, and the points of the last.
    OpenSubdiv(Box<far::TopologyRefiner>, Vec<[f32; 3]>),
    /// Every level's stencils, and the points of the last.
    Kernels(Box<subdiv_kernels::RefinementResult>, Vec<[f32; 3]>),
}

/// What a crate takes, made beforehand.
enum Input<'a> {
    OpenSubdiv {
        scheme: sdc::SchemeType,
        counts: Vec<usize>,
        ends: Vec<[u32; 2]>,
        sharpness: Vec<f32>,
    },
    Kernels {
        scheme: subdiv_kernels::Scheme,
        mesh: Box<dyn Fn() -> subdiv_kernels::topology::Mesh + 'a>,
        levels: NonZeroU8,
    },
}

impl Engine for Peer {
    fn id(&self) -> &str {
        self.name()
    }

    fn name(&self) -> &str {
        match self {
            Peer::OpenSubdiv => "opensubdiv-rs",
            Peer::Kernels => "subdiv-kernels",
        }
    }

    fn clock(&self) -> &'static str {
        clock::CLOCK
    }

    fn differs(&self, id: &str) -> Option<Differs> {
        match (self, id) {
            // Warren's.
            (Peer::Kernels, "loop") => Some(Differs::Weights(1.0)),
            (Peer::Kernels, "sqrt3") => Some(Differs::Rule(
                "sqrt3 moves a vertex towards the mean of the centroids around it, not of its neighbours as Kobbelt's \
                 does; the faces are the same, the surface is not",
            )),
            _ => None,
        }
    }

    fn prepare<'a>(&'a mut self, job: &'a Job<'a>) -> Result<Box<dyn Run + 'a>, Absent> {
        let creases = &job.soup.marks.creases;
        let input = match self {
            Peer::OpenSubdiv => {
                let scheme = match job.id {
                    "catmull-clark" => sdc::SchemeType::Catmark,
                    "loop" => sdc::SchemeType::Loop,
                    "linear" if job.counts.iter().all(|&n| n == 4) => sdc::SchemeType::Bilinear,
                    _ => return Err(Absent::Scheme),
                };
                let (ends, sharpness) = creases.iter().copied().unzip();
                Input::OpenSubdiv { scheme, counts: job.counts.iter().map(|&n| n as usize).collect(), ends, sharpness }
            }
            Peer::Kernels => {
                let scheme = match job.id {
                    "catmull-clark" => subdiv_kernels::Scheme::CatmullClark,
                    "loop" => subdiv_kernels::Scheme::Loop,
                    "sqrt3" => subdiv_kernels::Scheme::Sqrt3,
                    "doo-sabin" => subdiv_kernels::Scheme::DooSabin,
                    _ => return Err(Absent::Scheme),
                };
                let levels = NonZeroU8::new(job.level as u8).ok_or(Absent::Scheme)?;
                // Edges that are not listed are found by the crate, and smooth.
                let mesh = move || subdiv_kernels::topology::Mesh {
                    vertex_count: job.soup.positions.len() as u32,
                    face_vertex_counts: job.counts.clone(),
                    face_vertex_indices: job.soup.corners.clone(),
                    edge_vertices: creases.iter().map(|c| c.0).collect(),
                    edge_creases: creases.iter().map(|c| c.1).collect(),
                    vertex_corners: vec![0.0; job.soup.positions.len()],
                };
                Input::Kernels { scheme, mesh: Box::new(mesh), levels }
            }
        };
        Ok(Box::new(Trial { job, input }))
    }
}

struct Trial<'a> {
    job: &'a Job<'a>,
    input: Input<'a>,
}

impl Trial<'_> {
    /// A run, ready to start.
    fn ready(&self) -> Box<dyn FnOnce() -> Result<Output, String> + '_> {
        match &self.input {
            Input::OpenSubdiv { scheme, counts, ends, sharpness } => {
                Box::new(|| open_subdiv(self.job, *scheme, counts, ends, sharpness))
            }
            Input::Kernels { scheme, mesh, levels } => {
                // The crate takes its mesh and keeps it.
                let mesh = mesh();
                Box::new(|| kernels(self.job, mesh, *scheme, *levels))
            }
        }
    }
}

impl Run for Trial<'_> {
    fn time(&mut self, repeats: u32) -> Result<f64, String> {
        let mut sum = 0.0;
        for _ in 0..repeats {
            let ready = self.ready();
            let mut said = Ok(());
            sum += clock::seconds(|| said = black_box(ready()).map(drop));
            said?;
        }
        Ok(sum)
    }

    fn surface(&mut self) -> Result<Surface, String> {
        self.ready()().map(|output| output.surface(self.job))
    }

    fn peak(&mut self) -> Result<Option<u64>, String> {
        let ready = self.ready();
        let mut said = Ok(());
        let bytes = memory::peak(|| said = ready().map(drop));
        said.map(|()| Some(bytes))
    }
}

fn open_subdiv(
    job: &Job<'_>,
    scheme: sdc::SchemeType,
    counts: &[usize],
    ends: &[[u32; 2]],
    sharpness: &[f32],
) -> Result<Output, String> {
    let soup = job.soup;
    let descriptor =
        far::TopologyDescriptor::new(soup.positions.len(), counts, &soup.corners).with_creases(ends, sharpness);
    let mut refiner = far::TopologyRefinerFactory::create(descriptor, scheme, sdc::Options::default())
        .map_err(|e| format!("it does not take the mesh: {e:?}"))?;
    refiner.refine_uniform(far::UniformOptions::new(job.level as usize));
    let primvar = far::PrimvarRefiner::new(&refiner);
    let mut points = Vec::new();
    for k in 1..=job.level as usize {
        let mut finer = vec![[0.0; 3]; refiner.level(k).num_vertices()];
        primvar.interpolate(k, if k == 1 { &soup.positions } else { &points }, &mut finer);
        points = finer;
    }
    Ok(Output::OpenSubdiv(Box::new(refiner), points))
}

fn kernels(
    job: &Job<'_>,
    mesh: subdiv_kernels::topology::Mesh,
    scheme: subdiv_kernels::Scheme,
    levels: NonZeroU8,
) -> Result<Output, String> {
    let refined = subdiv_kernels::Refiner::new(mesh, scheme, subdiv_kernels::SchemeOptions::default())
        .and_then(|refiner| refiner.refine_uniform(&levels.into()))
        .map_err(|e| format!("it does not take the mesh: {e}"))?;
    let points = refined.interpolate(&job.soup.positions);
    Ok(Output::Kernels(Box::new(refined), points))
}

impl Output {
    /// The refined mesh.
    fn surface(self, job: &Job<'_>) -> Surface {
        match self {
            Output::OpenSubdiv(refiner, points) => {
                let level = refiner.level(refiner.max_level());
                let faces = || (0..level.num_faces()).map(|f| level.face_vertices(f));
                Surface {
                    counts: faces().map(|f| f.len() as u32).collect(),
                    corners: faces().flatten().copied().collect(),
                    points: if job.level == 0 { job.soup.positions.clone() } else { points },
                }
            }
            Output::Kernels(refined, points) => Surface {
                counts: refined.topology.face_vertex_counts.clone(),
                corners: refined.topology.face_vertex_indices.clone(),
                points,
            },
        }
    }
}
