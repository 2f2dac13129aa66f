//! Limn itself, natively: each of its ways to a level is one entry of [`PATHS`].

use super::{Absent, Engine, GENERAL, Job, LIMN, REFINE, Run, SHADED};
use crate::{clock, memory};
use limn_kernel::trial::{level, same::Surface, surface};
use limn_mesh::{Boundary, Mesh, Plan, Refined, Soup, Weld, scheme};
use std::hint::black_box;
use std::sync::Arc;

/// What a path leaves behind.
pub trait Made {
    /// Its points and faces.
    fn surface(&self) -> Surface;
}

impl Made for Refined {
    fn surface(&self) -> Surface {
        surface(self)
    }
}

/// A way from a mesh to a level.
#[derive(Clone, Copy)]
pub struct Path {
    id: &'static str,
    name: &'static str,
    /// Whether the clock starts with indexed faces, and not with a built mesh.
    builds: bool,
    /// Whether it stores normals.
    shaded: bool,
    make: Make,
}

/// Makes a level of a mesh; none where the path does not carry the plan.
type Make = fn(&Arc<Mesh>, &Plan) -> Result<Option<Box<dyn Made>>, String>;

/// All of them. The first is what the others are compared with: patches where they carry the plan, else level by level.
pub const PATHS: [Path; 4] = [
    Path { id: LIMN, name: "Limn", builds: true, shaded: false, make: usual },
    Path { id: SHADED, name: "Limn + normals", builds: true, shaded: true, make: with_normals },
    Path { id: REFINE, name: "Limn, mesh built", builds: false, shaded: false, make: usual },
    Path { id: GENERAL, name: "Limn, general path", builds: true, shaded: false, make: general },
];

fn usual(mesh: &Arc<Mesh>, plan: &Plan) -> Result<Option<Box<dyn Made>>, String> {
    Ok(Some(Box::new(level(mesh, plan, false)?)))
}

fn with_normals(mesh: &Arc<Mesh>, plan: &Plan) -> Result<Option<Box<dyn Made>>, String> {
    Ok(Some(Box::new(level(mesh, plan, true)?)))
}

fn general(mesh: &Arc<Mesh>, plan: &Plan) -> Result<Option<Box<dyn Made>>, String> {
    Ok(Some(Box::new(level_by_level(mesh, plan)?)))
}

fn level_by_level(mesh: &Arc<Mesh>, plan: &Plan) -> Result<Refined, String> {
    let job = limn_mesh::Job::new(Arc::clone(mesh), plan.clone(), u64::MAX).map_err(|e| e.to_string())?;
    Ok(job.level_by_level().finish())
}

fn build(soup: &Soup) -> Result<Arc<Mesh>, String> {
    Mesh::build(soup, Weld::Off).map(|(mesh, _)| Arc::new(mesh)).map_err(|e| e.to_string())
}

/// The level by the general path, which everything is held against; with `first` the scheme's first parameter is set to that.
///
/// # Errors
/// One sentence.
pub fn refined(job: &Job<'_>, first: Option<f64>) -> Result<Refined, String> {
    let mut plan = plan(job)?;
    if let Some(value) = first {
        plan.params.set(&plan.scheme.info, 0, value);
    }
    level_by_level(&build(job.soup)?, &plan)
}

fn plan(job: &Job<'_>) -> Result<Plan, String> {
    let entry = scheme(job.id).ok_or_else(|| format!("{} is not in the registry", job.id))?;
    Ok(Plan::new(entry, Boundary::default(), job.level))
}

impl Engine for Path {
    fn id(&self) -> &str {
        self.id
    }

    fn name(&self) -> &str {
        self.name
    }

    fn clock(&self) -> &'static str {
        clock::CLOCK
    }

    fn shaded(&self) -> bool {
        self.shaded
    }

    fn prepare<'a>(&'a mut self, job: &'a Job<'a>) -> Result<Box<dyn Run + 'a>, Absent> {
        if job.level == 0 && !self.builds {
            return Err(Absent::Scheme);
        }
        let plan = plan(job).map_err(Absent::Failed)?;
        let mesh = build(job.soup).map_err(Absent::Failed)?;
        // Once untimed: whether the path carries the plan.
        match (self.make)(&mesh, &plan) {
            Ok(Some(_)) => Ok(Box::new(Trial { path: *self, mesh, plan, soup: job.soup })),
            Ok(None) => Err(Absent::Scheme),
            Err(why) => Err(Absent::Failed(why)),
        }
    }
}

struct Trial<'a> {
    path: Path,
    mesh: Arc<Mesh>,
    plan: Plan,
    soup: &'a Soup,
}

impl Trial<'_> {
    fn once(&self) -> Result<Box<dyn Made>, String> {
        let fresh = if self.path.builds { Some(build(self.soup)?) } else { None };
        let made = (self.path.make)(fresh.as_ref().unwrap_or(&self.mesh), &self.plan)?;
        made.ok_or_else(|| "the path does not carry the plan".to_owned())
    }
}

impl Run for Trial<'_> {
    fn time(&mut self, repeats: u32) -> Result<f64, String> {
        let mut said = Ok(());
        let time = clock::seconds(|| {
            for _ in 0..repeats {
                match self.once() {
                    Ok(made) => drop(black_box(made)),
                    Err(why) => said = Err(why),
                }
            }
        });
        said.map(|()| time)
    }

    fn surface(&mut self) -> Result<Surface, String> {
        self.once().map(|made| made.surface())
    }

    fn peak(&mut self) -> Result<Option<u64>, String> {
        let mut said = Ok(());
        let bytes = memory::peak(|| said = self.once().map(drop));
        said.map(|()| Some(bytes))
    }
}
