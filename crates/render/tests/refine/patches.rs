//! The patch kernel: its points are the CPU's, its normals and faces those of the fused gather, on every kind of cage.

use super::{BUDGET, build, creased, named, polygons, prism, sheet, tables, triangles};
use crate::common::renderer;
use limn_compute::program::{Program, Role};
use limn_compute::{Drawn, Limits, Path, program_by};
use limn_mesh::{Boundary, Decay, Mesh, Plan, Soup, bounds, refine, scheme};
use limn_render::refine::{Compute, Refiner, limits};
use limn_render::{Gpu, pack};
use std::sync::Arc;

/// Runs a program on buffers that can all be read, the vertices full of what is no number, and gives one of them.
fn run(gpu: &Gpu, compute: &mut Compute, mesh: &Mesh, program: &Program, id: u32) -> Vec<u32> {
    let mut program = program.clone();
    for buffer in &mut program.buffers {
        if matches!(buffer.role, Role::Vertices | Role::Indices | Role::Corners) {
            buffer.role = Role::Colors;
            buffer.contents = vec![0xff; buffer.bytes as usize];
        }
    }
    program.vertices = id;
    program.count = (program.buffers[id as usize].bytes / 16) as u32;
    let mut refiner = Refiner::new(gpu, compute, &program).unwrap();
    refiner.set_points(gpu, 0, &mesh.positions).unwrap();
    refiner.refine(gpu);
    let words = tables::read_words(gpu, &refiner).into_flattened();
    assert_eq!(gpu.take_errors(), [] as [String; 0]);
    words
}

fn point(words: &[u32]) -> [f32; 3] {
    [0, 1, 2].map(|k| f32::from_bits(words[k]))
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2)).sum::<f64>().sqrt()
}

/// The angle between two normals in four bytes each; 0 where the second is none.
fn angle(a: u32, b: u32) -> f64 {
    let unpack = |n: u32| pack::unpack_normal([n as u16, (n >> 16) as u16].map(|n| n as i16));
    if b == 0 { 0.0 } else { 2.0 * (distance(unpack(a), unpack(b)) / 2.0).asin() }
}

/// The worst of all that was compared: points as shares of the box, angles of normals.
#[derive(Default)]
struct Worst {
    compute: Compute,
    compared: usize,
    points: f64,
    normals: f64,
}

/// NaN must not pass.
fn most(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

impl Worst {
    /// Compares both ways to a level; false if patches have no part in it.
    fn check(&mut self, gpu: &Gpu, mesh: &Arc<Mesh>, plan: &Plan, limits: Limits, what: &str) -> bool {
        let by = |path| program_by(mesh, plan, &[], limits, Some(path)).unwrap().unwrap();
        let (patches, fused) = (by(Path::Patches), by(Path::Fused));
        if !patches.shaders.iter().any(|shader| shader.entry == "patches") {
            return false;
        }
        let refined = refine(mesh, plan, BUDGET).unwrap();
        let [low, high] = bounds(&refined.points);
        let size = (0..3).map(|k| f64::from(high[k] - low[k])).fold(0.0, f64::max);
        let mut vertices = |program: &Program| run(gpu, &mut self.compute, mesh, program, program.vertices);
        let [ours, theirs] = [vertices(&patches), vertices(&fused)];
        assert_eq!(ours.len(), 4 * refined.points.len(), "{what}");
        let mut worst = [0.0; 2];
        for (v, ((ours, theirs), &exact)) in
            ours.chunks_exact(4).zip(theirs.chunks_exact(4)).zip(&refined.points).enumerate()
        {
            let off = [distance(point(ours), exact) / size, angle(ours[3], theirs[3])];
            assert!(off[0] <= 1e-5, "{what}: vertex {v} is {:?}, not {exact:?}", point(ours));
            assert!(off[1] <= 0.02, "{what}: the normal of vertex {v} is off by {}", off[1]);
            worst = [0, 1].map(|k| most(worst[k], off[k]));
        }
        self.points = most(self.points, worst[0]);
        self.normals = most(self.normals, worst[1]);
        assert_eq!(patches.shape(), fused.shape(), "{what}");
        for (ours, theirs) in patches.drawn.pieces().iter().zip(fused.drawn.pieces()) {
            let ours = run(gpu, &mut self.compute, mesh, &patches, ours.buffer);
            let theirs = run(gpu, &mut self.compute, mesh, &fused, theirs.buffer);
            if let Drawn::Quads { .. } = patches.drawn {
                assert_eq!(ours, theirs, "{what}: the indices differ");
                continue;
            }
            for (corner, (a, b)) in ours.chunks_exact(6).zip(theirs.chunks_exact(6)).enumerate() {
                let off = distance(point(a), point(b)) / size;
                assert!(off <= 1e-5 && a[5] == b[5], "{what}: corner {corner} is {a:?}, not {b:?}");
                assert!(angle(a[3], b[3]) <= 0.02, "{what}: the normal of corner {corner} is off");
            }
        }
        self.compared += 1;
        true
    }
}

/// Closed, open and mixed cages of all valences, sharp and semi-sharp, as deep as patches are cut and deeper.
#[test]
fn patches_make_what_the_cpu_makes() {
    let Some(renderer) = renderer() else { return };
    let gpu = renderer.gpu();
    let mut worst = Worst::default();
    for (name, soup) in polygons() {
        let (quads, cut) = (build(&soup), build(&triangles(&soup)));
        for (mesh, id) in [(&quads, "catmull-clark"), (&quads, "linear"), (&cut, "loop"), (&cut, "linear")] {
            for level in 3..=6 {
                let rule = if level % 2 == 0 { Boundary::EdgeOnly } else { Boundary::EdgeAndCorner };
                let plan = Plan::new(scheme(id).unwrap(), rule, level);
                worst.check(gpu, mesh, &plan, limits(gpu), &format!("{id} of {name}, level {level}"));
            }
        }
    }
    assert!(worst.compared >= 120, "{}", worst.compared);
    println!(
        "{} levels: points off by {:.1e} of the box, normals by {:.1e} radians",
        worst.compared, worst.points, worst.normals
    );
}

/// An edge that is sharp for ever beside one that is for two steps, and a sharp corner: few kinds of rings, so that tables pay.
fn sharpened(mut soup: Soup) -> Soup {
    let face = soup.face(1).to_vec();
    soup.marks.creases = vec![([face[0], face[1]], 10.0), ([face[1], face[2]], 2.5)];
    soup.marks.corners = vec![(face[0], 10.0)];
    soup
}

/// What must go by patches does: else the test above may have compared nothing of a kind.
#[test]
fn patches_take_creases_and_deep_levels() {
    let Some(renderer) = renderer() else { return };
    let gpu = renderer.gpu();
    let mut worst = Worst::default();
    let cube = named("cube");
    let few = Limits { groups: 2, ..limits(gpu) };
    for (id, soup, level) in [
        ("catmull-clark", sharpened(sheet(8)), 3),
        ("catmull-clark", sharpened(prism(7, false)), 5),
        ("loop", triangles(&sharpened(sheet(8))), 4),
        // These start at level 2.
        ("catmull-clark", cube.clone(), 7),
        ("loop", triangles(&cube), 7),
    ] {
        let mesh = build(&soup);
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, level);
        assert!(worst.check(gpu, &mesh, &plan, few, &format!("{id}, level {level}")), "{id}, level {level}");
    }
    // What softens by its neighbours depends on more than rings, and a pole's rings are too large.
    let mut plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeAndCorner, 3);
    plan.rules.decay = Decay::Chaikin;
    let rim: Vec<u32> = (0..70).map(|i| 2 * i).collect();
    let pole = build(&Soup::from_faces(prism(70, false).positions, &[rim]));
    for (mesh, what) in [(build(&creased(prism(7, false))), "Chaikin"), (pole, "a pole")] {
        assert!(!worst.check(gpu, &mesh, &plan, few, what), "{what}");
    }
}

/// New positions run what depends on them alone.
#[test]
fn patches_of_a_cage_that_moves() {
    let Some(renderer) = renderer() else { return };
    let (gpu, mut compute) = (renderer.gpu(), Compute::default());
    let mesh = build(&sheet(4));
    let plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeAndCorner, 4);
    let program = program_by(&mesh, &plan, &[], limits(gpu), Some(Path::Patches)).unwrap().unwrap();
    let entries = |list: &[limn_compute::program::Dispatch]| -> Vec<&str> {
        list.iter().map(|dispatch| program.shaders[dispatch.shader as usize].entry).collect()
    };
    assert_eq!(entries(&program.each), ["points", "patches", "normals", "bounds"]);
    assert_eq!(entries(&program.once), ["split", "faces"]);
    let mut refiner = Refiner::new(gpu, &mut compute, &program).unwrap();
    let mut moved = Mesh::clone(&mesh);
    for step in 0..2 {
        moved.positions[7] = [2.5, -0.5, 1.5 + step as f32];
        refiner.set_points(gpu, 0, &moved.positions).unwrap();
        refiner.refine(gpu);
        let refined = refine(&Arc::new(moved.clone()), &plan, BUDGET).unwrap();
        let read = tables::read(gpu, &refiner);
        let off = read.iter().zip(&refined.points).map(|(ours, p)| distance(ours.0, *p));
        let worst = off.fold(0.0, most);
        assert!(worst <= 5e-5, "moved {step} times: off by {worst}");
        let points: Vec<[f32; 3]> = read.iter().map(|v| v.0).collect();
        assert_eq!(tables::read_bounds(gpu, &refiner), Some(bounds(&points)));
    }
}
