//! A level straight into the buffers that it is drawn from: refined and packed here, and written by whoever has the buffers.
//!
//! ```text
//!   Kernel::fill ──> Filling ── shape ──> buffers are made
//!                            ── step ───> refines;  packs some points or faces, Target::write takes the bytes where they lie
//!                            ── bounds, runs
//! ```
//!
//! So the only copy of a level is the one into the GPU's buffers: the engine gets counts and a box. What is wanted on the CPU
//! afterwards (files, the overlay of points, picking) is made anew by `Kernel::start`, as where the GPU refines. The level's memory is kept for the
//! next one: fresh pages cost more than what is written to them.
//!
//! Cost: one pass over the level (40 bytes a quad) in pieces that fit the caches. Limit: no hidden faces, no colours of shared quads.

use std::cell::RefCell;
use std::rc::Rc;

#[cfg(any(target_arch = "wasm32", test))]
use limn_layout::Place;
use limn_layout::{Packer, Part, Sink, level, shape};
use limn_mesh::{Boundary, Connectivity, Job, Mesh, Refined};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// Bytes of a piece, at most: as for what the engine packs.
const PIECE_BYTES: u64 = 96 << 20;

/// Points or faces that are packed between two looks at the clock.
const ROWS: usize = 32 << 10;

/// A level that is not needed any more.
pub(crate) type Spare = Rc<RefCell<Option<Refined>>>;

/// A level on its way into buffers. Dropping it cancels.
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Filling {
    job: Option<Job>,
    shape: Vec<u32>,
    piece: u64,
    /// Which part each of the file's faces is of, and so many parts.
    part_of: Vec<u32>,
    parts: Vec<Part>,
    packing: Option<(Refined, Vec<[f32; 3]>, Packer)>,
    spare: Spare,
}

impl Filling {
    /// Prepares; none if the level has to be packed elsewhere. No buffer takes more than `limit` bytes.
    pub(crate) fn new(job: Job, mesh: &Mesh, limit: u64, part_of: &[u32], spare: &Spare) -> Option<Filling> {
        let whole = mesh.topology.boundary_half_edges() == 0 || job.plan().rules.boundary != Boundary::None;
        let counts = job.last_counts();
        let kinds = job.parent_ranges().filter(|_| mesh.uv.is_none());
        let fits = kinds.is_none() || counts.vertices * 16 <= limit && mesh.colors.is_empty();
        if !whole || !mesh.holes.is_empty() || !fits || job.plan().level == 0 {
            return None;
        }
        let carries = u32::from(mesh.uv.is_some()) | u32::from(!mesh.colors.is_empty()) << 1;
        let faces = if kinds.is_some() { counts.faces } else { counts.corners.checked_sub(2 * counts.faces)? };
        let piece = PIECE_BYTES.min(limit);
        let parts = part_of.iter().max().map_or(0, |&most| most as usize + 1);
        let job = match spare.take() {
            Some(old) => job.reusing(old),
            None => job,
        };
        Some(Filling {
            shape: shape(counts.vertices as u32, kinds, carries, faces, piece),
            job: Some(job),
            piece,
            part_of: part_of.to_vec(),
            parts: vec![Part { material: 0, group: 0 }; parts],
            packing: None,
            spare: spare.clone(),
        })
    }

    /// Works off about `rows` rows of refinement, or some of packing, and says whether all is done. What is packed goes to `out`.
    ///
    /// # Errors
    /// One sentence, if the level is not what was predicted: a mistake.
    pub fn advance(&mut self, rows: usize, out: &mut impl Sink) -> Result<bool, String> {
        let corners = self.shape.get(2) == Some(&0);
        let parts = (&self.parts[..], &self.part_of[..]);
        if let Some(job) = &mut self.job
            && !job.step(rows)
        {
            return Ok(false);
        }
        if let Some(job) = self.job.take() {
            let refined = job.finish();
            let normals = if refined.known_normals.is_some() { Vec::new() } else { refined.normals() };
            let known = refined.known_normals.as_deref().unwrap_or(&normals);
            let packer = level(&refined, known, parts, corners, |data| Packer::new(data, self.piece));
            let packer = packer.map_err(|e| e.to_string())?;
            if packer.shape() != self.shape {
                return Err("the level is not what was predicted".to_owned());
            }
            self.packing = Some((refined, normals, packer));
            return Ok(false);
        }
        let Some((refined, normals, packer)) = &mut self.packing else { return Ok(true) };
        let known = refined.known_normals.as_deref().unwrap_or(normals);
        level(refined, known, parts, corners, |data| packer.step(data, ROWS, out)).map_err(|e| e.to_string())
    }
}

impl Drop for Filling {
    fn drop(&mut self) {
        if let Some((refined, ..)) = self.packing.take() {
            self.spare.replace(Some(refined));
        }
    }
}

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Filling {
    /// What the buffers are: [`limn_layout::shape`].
    pub fn shape(&self) -> Vec<u32> {
        self.shape.clone()
    }

    /// Whether it is refined, and being packed.
    pub fn packs(&self) -> bool {
        self.job.is_none()
    }

    /// How much is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        match (&self.job, &self.packing) {
            (Some(job), _) => job.progress() * 0.66,
            (None, Some((.., packer))) => 0.66 + 0.34 * packer.progress(),
            (None, None) => 1.0,
        }
    }

    /// The box of the points, lowest coordinates first.
    pub fn bounds(&self) -> Vec<f32> {
        let bounds = self.packing.as_ref().map_or(limn_layout::Bounds::EMPTY, |(.., packer)| packer.bounds);
        [bounds.min, bounds.max].concat()
    }

    /// The parts in the order of what is drawn, and how many elements (indices or corners) each has.
    pub fn runs(&self) -> Vec<u32> {
        let runs = self.packing.iter().flat_map(|(.., packer)| &packer.runs);
        runs.flat_map(|run| [run.part, run.count as u32]).collect()
    }
}

/// The number of a buffer, in the order in which `limn_render::Surface::reserve` makes them.
#[cfg(any(target_arch = "wasm32", test))]
fn number(place: Place, shape: &[u32]) -> Option<usize> {
    match (place, shape) {
        (Place::Vertices, _) => Some(0),
        (Place::Piece(i), [_, _, b, ..]) if *b > 0 => Some(1 + i),
        (Place::Piece(i), [_, 0, ..]) => Some(i),
        (Place::Piece(i), _) => Some(2 * i),
        (Place::Extra(i), _) => Some(2 * i + 1),
        (Place::Colors, _) => None,
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::{Filling, number};
    use limn_layout::{Place, Sink};
    use wasm_bindgen::prelude::wasm_bindgen;

    #[wasm_bindgen]
    extern "C" {
        /// Who has the buffers: `Target` of `web/fill.js`.
        pub type Target;
        /// Takes bytes of a buffer from `offset` on, out of this module's memory.
        #[wasm_bindgen(method)]
        fn write(this: &Target, buffer: u32, offset: f64, bytes: &[u8]);
    }

    struct Out<'a>(&'a Target, &'a [u32]);

    impl Sink for Out<'_> {
        fn write(&mut self, place: Place, offset: u64, bytes: &[u8]) {
            if let Some(buffer) = number(place, self.1) {
                self.0.write(buffer as u32, offset as f64, bytes);
            }
        }
    }

    #[wasm_bindgen]
    impl Filling {
        /// Works off about `rows` rows and says whether all is done: [`Filling::advance`].
        ///
        /// # Errors
        /// One sentence.
        pub fn step(&mut self, rows: usize, target: &Target) -> Result<bool, String> {
            let shape = self.shape();
            self.advance(rows, &mut Out(target, &shape))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_are_numbered_as_they_are_made() {
        let numbers = |shape: &[u32]| [Place::Vertices, Place::Piece(1), Place::Extra(1)].map(|p| number(p, shape));
        assert_eq!(numbers(&[9, 4, 5, 2, 4])[..2], [Some(0), Some(2)]);
        assert_eq!(numbers(&[9, 0, 0, 2, 4])[1], Some(1));
        assert_eq!(numbers(&[9, 3, 0, 2, 4])[1..], [Some(2), Some(3)]);
    }
}
