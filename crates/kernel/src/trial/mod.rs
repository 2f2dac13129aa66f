//! From indexed faces to a level and nothing else: what benchmarks time, here and in other libraries.
//!
//! ```text
//!   cage ──> Trial ── run ──> points and faces of level L ── differs ──> another library's
//!                     ^ timed: Mesh::build and refine,                   (in any numbering)
//!                              with normals if they are asked for
//! ```
//!
//! The page's `?bench` runs it as WebAssembly; `cargo xtask bench` uses the same cages and the same comparison natively, and
//! sends its own inputs to the page. Cost beside refining: none. Limit: what was run last stays until [`Trial::clear`].

pub mod cages;
pub mod same;

use crate::{Drawing, limits};
use limn_mesh::{Boundary, Faces, Job, Mesh, Plan, Refined, SCHEMES, Soup, Weld, scheme};
use same::{Sorted, Surface};
use std::sync::Arc;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// Points and faces of a level, as they are compared.
pub fn surface(refined: &Refined) -> Surface {
    let faces = &refined.faces;
    let counts = match faces {
        Faces::Triangles(_) => vec![3; faces.count()],
        Faces::Quads(_) => vec![4; faces.count()],
        Faces::Polygons { offsets, .. } => offsets.iter().zip(offsets.iter().skip(1)).map(|(a, b)| b - a).collect(),
    };
    Surface { points: refined.points.clone(), counts, corners: faces.corners().to_vec() }
}

/// A level of a mesh, with unit normals at its points if it is `shaded`.
///
/// # Errors
/// One sentence: [`limn_mesh::RefineError`].
pub fn level(mesh: &Arc<Mesh>, plan: &Plan, shaded: bool) -> Result<Refined, String> {
    let job = Job::new(Arc::clone(mesh), plan.clone(), u64::MAX).map_err(|e| e.to_string())?;
    if !shaded {
        return Ok(job.finish());
    }
    let mut made = job.shaded().finish();
    if made.known_normals.is_none() {
        made.known_normals = Some(made.normals());
    }
    Ok(made)
}

/// A cage, and what was made of it.
#[derive(Debug, Default)]
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Trial {
    soup: Soup,
    made: Option<Refined>,
}

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Trial {
    /// The cage of that name and size: [`cages::cage`]. Without faces if there is none.
    pub fn cage(name: &str, n: u32) -> Trial {
        Trial { soup: cages::cage(name, n), made: None }
    }

    /// A cage by three coordinates a vertex, the number of corners of each face, all corners in a row, the two ends of each sharp edge,
    /// and how sharp it is. What is wrong with it [`Trial::run`] says.
    pub fn of(positions: &[f32], counts: &[u32], corners: &[u32], ends: &[u32], sharpness: &[f32]) -> Trial {
        let mut soup = Soup { positions: positions.as_chunks().0.to_vec(), ..Soup::default() };
        let mut rest = corners;
        for &n in counts {
            let (face, others) = rest.split_at(rest.len().min(n as usize));
            soup.push_face(face);
            rest = others;
        }
        soup.marks.creases = ends.as_chunks().0.iter().copied().zip(sharpness.iter().copied()).collect();
        Trial { soup, made: None }
    }

    /// The names of all schemes.
    pub fn schemes() -> Vec<String> {
        SCHEMES.iter().map(|entry| entry.info.id.to_owned()).collect()
    }

    /// Refines to a level, from indexed faces; with unit normals at its points if it is `shaded`.
    ///
    /// # Errors
    /// One sentence: there is no such scheme, or the cage cannot be built, or not be refined by it.
    pub fn run(&mut self, id: &str, steps: u32, shaded: bool) -> Result<(), String> {
        self.made = None;
        let entry = scheme(id).ok_or_else(|| format!("there is no scheme `{id}`"))?;
        let plan = Plan::new(entry, Boundary::default(), steps);
        let (mesh, _) = Mesh::build(&self.soup, Weld::Off).map_err(|e| e.to_string())?;
        self.made = Some(level(&Arc::new(mesh), &plan, shaded)?);
        Ok(())
    }

    /// What a GPU does for the same, from indexed faces: by kernels made for the scheme, or by `rows`. None where the CPU has to.
    ///
    /// # Errors
    /// As [`Trial::run`], and a sentence for a buffer that the adapter does not take.
    pub fn draw(&self, id: &str, level: u32, buffer: f64, groups: u32, rows: bool) -> Result<Option<Drawing>, String> {
        let entry = scheme(id).ok_or_else(|| format!("there is no scheme `{id}`"))?;
        let plan = Plan::new(entry, Boundary::default(), level);
        let (mesh, _) = Mesh::build(&self.soup, Weld::Off).map_err(|e| e.to_string())?;
        let (mesh, limits) = (Arc::new(mesh), limits(buffer, groups));
        let made = match rows {
            true => limn_compute::by_rows(&mesh, &plan, &[], limits),
            false => limn_compute::program(&mesh, &plan, &[], limits),
        };
        Ok(made.map_err(|e| e.to_string())?.map(|program| Drawing::new(program, &mesh.positions)))
    }

    /// How many faces a level will have; 0 if it cannot be made.
    pub fn predicted(&self, id: &str, level: u32) -> u32 {
        let plan = scheme(id).map(|entry| Plan::new(entry, Boundary::default(), level));
        let mesh = Mesh::build(&self.soup, Weld::Off).ok();
        let predicted = mesh.zip(plan).and_then(|((mesh, _), plan)| limn_mesh::predict(&mesh, &plan).ok().flatten());
        predicted.map_or(0, |p| p.counts.faces as u32)
    }

    /// Lets go of what was made.
    pub fn clear(&mut self) {
        self.made = None;
    }

    /// How many faces were made.
    pub fn faces(&self) -> u32 {
        self.made.as_ref().map_or(0, |made| made.faces.count() as u32)
    }

    /// How many vertices were made.
    pub fn vertices(&self) -> u32 {
        self.made.as_ref().map_or(0, |made| made.points.len() as u32)
    }

    /// How many unit normals were made.
    pub fn normals(&self) -> u32 {
        self.made.as_ref().and_then(|made| made.known_normals.as_ref()).map_or(0, |normals| normals.len() as u32)
    }

    /// How many corners the faces have together that were made.
    pub fn corners(&self) -> u32 {
        self.made.as_ref().map_or(0, |made| made.faces.corners().len() as u32)
    }

    /// What was made, or the cage itself: three coordinates a vertex.
    pub fn positions(&self) -> Vec<f32> {
        self.made.as_ref().map_or(&self.soup.positions, |made| &made.points).as_flattened().to_vec()
    }

    /// What was made, or the cage itself: the number of corners of each face.
    pub fn face_counts(&self) -> Vec<u32> {
        self.surface().counts
    }

    /// What was made, or the cage itself: the corners of all faces in a row.
    pub fn face_corners(&self) -> Vec<u32> {
        self.surface().corners
    }

    /// How another library's result differs from what was made, in one sentence; empty if no more than `tolerance`.
    pub fn differs(&self, positions: &[f32], counts: &[u32], corners: &[u32], tolerance: f64) -> String {
        let points = positions.as_chunks().0.to_vec();
        let theirs = Surface { points, counts: counts.to_vec(), corners: corners.to_vec() };
        let both = Sorted::new(&self.surface()).and_then(|ours| Ok((ours, Sorted::new(&theirs)?)));
        both.and_then(|(ours, theirs)| ours.distance(&theirs, tolerance)).err().unwrap_or_default()
    }

    fn surface(&self) -> Surface {
        match &self.made {
            Some(made) => surface(made),
            None => Surface {
                points: self.soup.positions.clone(),
                counts: (0..self.soup.face_count()).map(|f| self.soup.face(f).len() as u32).collect(),
                corners: self.soup.corners.clone(),
            },
        }
    }
}

/// Memory to store into, for what plain stores reach.
#[derive(Debug)]
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub struct Stores(Vec<u64>);

#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
impl Stores {
    /// So many bytes, touched.
    #[cfg_attr(target_arch = "wasm32", wasm_bindgen(constructor))]
    pub fn new(bytes: u32) -> Stores {
        Stores(vec![1; bytes as usize / 8])
    }

    /// Stores a number into all of it, and returns one of them.
    pub fn store(&mut self, number: u32) -> u32 {
        self.0.iter_mut().for_each(|x| *x = u64::from(number));
        std::hint::black_box(&mut self.0).last().map_or(0, |&x| x as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cage_by_its_arrays_is_refined_as_by_its_name() {
        let mut named = Trial::cage("cube", 0);
        let mut by_arrays = Trial::of(&named.positions(), &named.face_counts(), &named.face_corners(), &[], &[]);
        assert_eq!(named.run("catmull-clark", 2, false), Ok(()));
        assert_eq!(by_arrays.run("catmull-clark", 2, false), Ok(()));
        assert_eq!((named.faces(), named.vertices(), named.corners(), named.normals()), (96, 98, 384, 0));
        let [p, n, c] = [by_arrays.positions().len(), by_arrays.face_counts().len(), by_arrays.face_corners().len()];
        assert_eq!((p, n, c), (3 * 98, 96, 384));
        let same = |t: &Trial| named.differs(&t.positions(), &t.face_counts(), &t.face_corners(), 1e-6);
        assert_eq!(same(&by_arrays), "");
        // A crease is taken, and told apart.
        let cube = Trial::cage("cube", 0);
        let mut creased = Trial::of(&cube.positions(), &cube.face_counts(), &cube.face_corners(), &[0, 1], &[10.0]);
        assert_eq!(creased.run("catmull-clark", 2, false), Ok(()));
        assert!(same(&creased).starts_with("a point is"), "{}", same(&creased));
    }

    #[test]
    fn normals_are_made_where_they_are_asked_for_whatever_the_path() {
        // By patches, level by level, and where nothing is done.
        for (id, steps) in [("catmull-clark", 4), ("doo-sabin", 2), ("catmull-clark", 0)] {
            let mut trial = Trial::cage("torus", 8);
            assert_eq!(trial.run(id, steps, true), Ok(()));
            let made = trial.made.as_ref().unwrap();
            let normals = made.known_normals.as_ref().unwrap();
            assert_eq!(normals.len(), made.points.len(), "{id}");
            assert_eq!(trial.normals(), trial.vertices());
            let plain = level(made.mesh(), &Plan::new(scheme(id).unwrap(), Boundary::default(), steps), false).unwrap();
            assert!(plain.known_normals.is_none() && plain.points == made.points);
            let off = normals.iter().zip(plain.normals()).flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs()));
            assert!(off.fold(0.0, f32::max) < 1e-4, "{id}");
        }
    }

    #[test]
    fn what_cannot_be_run_is_one_sentence() {
        let mut trial = Trial::of(&[0.0; 9], &[4], &[0, 1, 2, 7], &[], &[]);
        assert!(trial.run("catmull-clark", 1, false).is_err());
        assert!(trial.run("nothing", 1, false).is_err_and(|why| why.contains("`nothing`")));
        assert_eq!((trial.faces(), Trial::cage("nothing", 3).face_counts().len()), (0, 0));
        assert!(Trial::cage("torus", 8).run("loop", 1, false).is_err(), "Loop takes triangles");
    }

    #[test]
    fn cages_are_closed_and_have_the_sizes_that_they_are_named_for() {
        for (name, n, faces) in [("torus", 8, 64), ("triangles", 8, 128), ("sphere", 5, 200), ("pawn", 0, 304)] {
            let soup = cages::cage(name, n);
            assert_eq!(soup.face_count(), faces, "{name}");
            let (mesh, _) = Mesh::build(&soup, Weld::Off).unwrap();
            let c = mesh.counts();
            assert_eq!(c.edges * 2, c.corners, "{name} is closed");
        }
        // Six of valence 4 and all others of valence 6.
        let sphere = cages::sphere(5);
        let mut valence = vec![0; sphere.positions.len()];
        sphere.corners.iter().for_each(|&v| valence[v as usize] += 1);
        assert_eq!(valence.iter().filter(|&&n| n == 4).count(), 6);
        assert_eq!(valence.iter().filter(|&&n| n == 6).count(), valence.len() - 6);
        assert!(sphere.positions.iter().all(|p| (p.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-6));
        assert!(cages::cage("creature-triangles", 0).offsets.windows(2).all(|w| w[1] - w[0] == 3));
    }
}
