//! What refines: one interface for Limn and everything that it is held against.
//!
//! ```text
//!   Job: cage, scheme, level ── Engine::prepare ──> Run ── time(n) ──> seconds, input conversion off the clock
//!                                                       ── surface ──> points and faces, to be held against Limn's
//!                                                       ── peak ─────> bytes
//! ```
//!
//! A further path of Limn is an entry in `limn::PATHS`; a further browser engine is an entry in `web/bench-worker.js`, and
//! comes here by itself ([`remote`]).

mod limn;
mod peers;
pub mod remote;

pub use limn::refined;

use limn_kernel::trial::same::Surface;
use limn_mesh::Soup;

/// What is refined, by which scheme and how far.
pub struct Job<'a> {
    /// The scheme's id in Limn's registry.
    pub id: &'a str,
    /// How many times; 0 is connecting the faces.
    pub level: u32,
    /// The cage, with its creases.
    pub soup: &'a Soup,
    /// How many corners each of its faces has.
    pub counts: Vec<u32>,
}

impl<'a> Job<'a> {
    /// A job on a cage.
    pub fn new(id: &'a str, level: u32, soup: &'a Soup) -> Self {
        let counts = (0..soup.face_count()).map(|f| soup.face(f).len() as u32).collect();
        Job { id, level, soup, counts }
    }
}

/// How an engine's scheme differs from Limn's of the same name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Differs {
    /// Limn has its weights too: its first parameter set to this.
    Weights(f64),
    /// Another rule, in one sentence.
    Rule(&'static str),
}

/// Why an engine does not run a job.
#[derive(Debug)]
pub enum Absent {
    /// It has no such scheme, or not for such faces: nothing is said.
    Scheme,
    /// Something went wrong, in one sentence.
    Failed(String),
}

/// Something that refines.
pub trait Engine {
    /// A word for it, which its rows bear.
    fn id(&self) -> &str;
    /// What people call it.
    fn name(&self) -> &str;
    /// The clock of its times: `thread` or `wall`.
    fn clock(&self) -> &'static str;
    /// Seconds that a sample lasts at least, by how fine the clock is.
    fn sample(&self) -> f64 {
        0.002
    }
    /// Bytes a second of plain stores where it runs, if that is not this program.
    fn bandwidth(&self) -> Option<f64> {
        None
    }
    /// Whether it stores unit normals too, beside points and corners.
    fn shaded(&self) -> bool {
        false
    }
    /// Whether its scheme `id` is another than Limn's.
    fn differs(&self, _id: &str) -> Option<Differs> {
        None
    }
    /// Why its results may be others on some jobs without that being a failure of the benchmark: what it does, in words that follow
    /// its name.
    fn excuse(&self) -> Option<&str> {
        None
    }
    /// A job, ready to be run again and again.
    ///
    /// # Errors
    /// Why it is not run.
    fn prepare<'a>(&'a mut self, job: &'a Job<'a>) -> Result<Box<dyn Run + 'a>, Absent>;
}

/// A job that an engine has taken.
pub trait Run {
    /// Seconds that so many runs take, from indexed faces to points and faces, and normals if the engine stores them.
    fn time(&mut self, repeats: u32) -> Result<f64, String>;
    /// What it makes.
    fn surface(&mut self) -> Result<Surface, String>;
    /// The most bytes that a run holds beyond its input; none where that cannot be told.
    fn peak(&mut self) -> Result<Option<u64>, String>;
}

/// The engine that the others' times are compared with: Limn from indexed faces, as everyone calls it.
pub const LIMN: &str = "limn";
/// The part of it that begins with a built mesh.
pub const REFINE: &str = "limn-refine";

/// The first with unit normals: what a picture needs.
pub const SHADED: &str = "limn-shaded";
/// Limn from indexed faces, every level from the one before: what all surfaces are held against.
pub const GENERAL: &str = "limn-general";

/// The engines of this program.
pub fn natives() -> Vec<Box<dyn Engine>> {
    let mut all: Vec<Box<dyn Engine>> = Vec::new();
    all.extend(limn::PATHS.iter().map(|path| Box::new(*path) as Box<dyn Engine>));
    all.extend(peers::Peer::ALL.map(|peer| Box::new(peer) as Box<dyn Engine>));
    all
}
