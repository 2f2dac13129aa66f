//! The other crates for subdivision in Rust: from indexed faces to the points and faces of a level.
//!
//! Each gets its own input type made beforehand, off the clock. Both keep more than Limn does (opensubdiv-rs every level with
//! its edges, subdiv-kernels every level's stencils); that is what they cost to someone who wants the refined mesh.
//!
//! opensubdiv-rs has Catmull-Clark, Loop and bilinear quads (our linear, on quads); subdiv-kernels has Catmull-Clark, Loop,
//! sqrt3 and Doo-Sabin. Neither has a Butterfly.

use crate::same::Surface;
use limn_mesh::Soup;
use opensubdiv_rs::{far, sdc};
use std::num::NonZeroU8;

/// What a mesh is to the peers.
pub struct Input<'a> {
    soup: &'a Soup,
    creases: &'a [([u32; 2], f32)],
    counts: Vec<usize>,
}

/// One crate.
#[derive(Clone, Copy, PartialEq)]
pub enum Peer {
    /// A port of OpenSubdiv.
    OpenSubdiv,
    /// Stencil tables.
    Kernels,
}

/// How a crate's scheme differs from Limn's of the same name.
pub enum Differs {
    /// Limn has its weights too: its first parameter set to this.
    Weights(f64),
    /// Another rule, in one sentence.
    Rule(&'static str),
}

/// What a run left behind, still in the crate's own form.
pub enum Output {
    /// Every level, and the points of the last.
    OpenSubdiv(Box<far::TopologyRefiner>, Vec<[f32; 3]>),
    /// Every level's stencils, and the points of the last.
    Kernels(Box<subdiv_kernels::RefinementResult>, Vec<[f32; 3]>),
}

impl<'a> Input<'a> {
    /// Takes a soup, and sharp edges by their ends.
    pub fn new(soup: &'a Soup, creases: &'a [([u32; 2], f32)]) -> Self {
        Input { soup, creases, counts: (0..soup.face_count()).map(|f| soup.face(f).len()).collect() }
    }
}

impl Peer {
    /// All of them, in the order of the table.
    pub const ALL: [Peer; 2] = [Peer::OpenSubdiv, Peer::Kernels];

    /// The crate's name.
    pub fn name(self) -> &'static str {
        match self {
            Peer::OpenSubdiv => "opensubdiv-rs",
            Peer::Kernels => "subdiv-kernels",
        }
    }

    /// Whether its scheme `id` is another than Limn's.
    pub fn differs(self, id: &str) -> Option<Differs> {
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

    /// A run of scheme `id`, ready to start; none if the crate does not have it, or cannot take the mesh.
    pub fn prepare<'a>(self, input: &'a Input<'a>, id: &str, level: u32) -> Option<Box<dyn FnOnce() -> Output + 'a>> {
        match self {
            Peer::OpenSubdiv => {
                let scheme = match id {
                    "catmull-clark" => sdc::SchemeType::Catmark,
                    "loop" => sdc::SchemeType::Loop,
                    "linear" if input.counts.iter().all(|&n| n == 4) => sdc::SchemeType::Bilinear,
                    _ => return None,
                };
                let (ends, sharpness): (Vec<_>, Vec<_>) = input.creases.iter().copied().unzip();
                Some(Box::new(move || open_subdiv(input, scheme, level as usize, &ends, &sharpness)))
            }
            Peer::Kernels => {
                let scheme = match id {
                    "catmull-clark" => subdiv_kernels::Scheme::CatmullClark,
                    "loop" => subdiv_kernels::Scheme::Loop,
                    "sqrt3" => subdiv_kernels::Scheme::Sqrt3,
                    "doo-sabin" => subdiv_kernels::Scheme::DooSabin,
                    _ => return None,
                };
                // Edges that are not listed are found by the crate, and smooth.
                let mesh = subdiv_kernels::topology::Mesh {
                    vertex_count: input.soup.positions.len() as u32,
                    face_vertex_counts: input.counts.iter().map(|&n| n as u32).collect(),
                    face_vertex_indices: input.soup.corners.clone(),
                    edge_vertices: input.creases.iter().map(|c| c.0).collect(),
                    edge_creases: input.creases.iter().map(|c| c.1).collect(),
                    vertex_corners: vec![0.0; input.soup.positions.len()],
                };
                let levels = NonZeroU8::new(level as u8)?;
                Some(Box::new(move || kernels(input, mesh, scheme, levels)))
            }
        }
    }
}

fn open_subdiv(
    input: &Input<'_>,
    scheme: sdc::SchemeType,
    level: usize,
    ends: &[[u32; 2]],
    sharpness: &[f32],
) -> Output {
    let soup = input.soup;
    let descriptor =
        far::TopologyDescriptor::new(soup.positions.len(), &input.counts, &soup.corners).with_creases(ends, sharpness);
    let mut refiner = far::TopologyRefinerFactory::create(descriptor, scheme, sdc::Options::default())
        .unwrap_or_else(|e| panic!("opensubdiv-rs: {e:?}"));
    refiner.refine_uniform(far::UniformOptions::new(level));
    let primvar = far::PrimvarRefiner::new(&refiner);
    let mut points = vec![[0.0; 3]; refiner.level(1).num_vertices()];
    primvar.interpolate(1, &soup.positions, &mut points);
    for k in 2..=level {
        let mut finer = vec![[0.0; 3]; refiner.level(k).num_vertices()];
        primvar.interpolate(k, &points, &mut finer);
        points = finer;
    }
    Output::OpenSubdiv(Box::new(refiner), points)
}

fn kernels(
    input: &Input<'_>,
    mesh: subdiv_kernels::topology::Mesh,
    scheme: subdiv_kernels::Scheme,
    levels: NonZeroU8,
) -> Output {
    let refined = subdiv_kernels::Refiner::new(mesh, scheme, subdiv_kernels::SchemeOptions::default())
        .and_then(|refiner| refiner.refine_uniform(&levels.into()))
        .unwrap_or_else(|e| panic!("subdiv-kernels: {e}"));
    let points = refined.interpolate(&input.soup.positions);
    Output::Kernels(Box::new(refined), points)
}

impl Output {
    /// The refined mesh.
    pub fn surface(self) -> Surface {
        match self {
            Output::OpenSubdiv(refiner, points) => {
                let level = refiner.level(refiner.max_level());
                let faces = || (0..level.num_faces()).map(|f| level.face_vertices(f));
                Surface {
                    counts: faces().map(|f| f.len() as u32).collect(),
                    corners: faces().flatten().copied().collect(),
                    points,
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
