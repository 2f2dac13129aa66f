//! What the GPU refines is what the CPU refines, vertex by vertex: every scheme and level, on closed, open, mixed and creased
//! meshes, through kernels made for a scheme and through rows.

#[path = "../common/mod.rs"]
mod common;
mod drawn;
mod patches;
#[path = "../common/tables.rs"]
mod tables;

use common::renderer;
use limn_compute::{Cage, Limits, Rules, Scheme, Tables, Values, by_rows, fused, program, rules};
use limn_mesh::{
    Accepts, Boundary, Decay, Fairing, Mesh, Params, Plan, Refined, Run, SCHEMES, Soup, TriangleRule, Weld, bounds,
    refine, scheme, shape, triangulate_soup,
};
use limn_render::refine::{Compute, Refiner, limits};
use limn_render::{Bounds, Edges, Gpu, Material, Part, Renderer, Style, Surface, SurfaceData, TextureData};
use std::sync::Arc;

const BUDGET: u64 = 1 << 30;

fn build(soup: &Soup) -> Arc<Mesh> {
    Arc::new(Mesh::build(soup, Weld::Off).unwrap().0)
}

fn named(name: &str) -> Soup {
    (shape(name).unwrap().build)()
}

/// A prism over an n-gon, with or without its roof.
fn prism(n: u32, open: bool) -> Soup {
    let ring = (0..n).map(|i| std::f32::consts::TAU * i as f32 / n as f32);
    let positions = ring.flat_map(|a| [0.0, 1.5].map(|z| [a.cos(), 1.3 * a.sin(), z + 0.1 * a])).collect();
    let side = |i: u32| vec![2 * i, 2 * ((i + 1) % n), 2 * ((i + 1) % n) + 1, 2 * i + 1];
    let mut faces: Vec<Vec<u32>> = (0..n).map(side).collect();
    faces.push((0..n).rev().map(|i| 2 * i).collect());
    if !open {
        faces.push((0..n).map(|i| 2 * i + 1).collect());
    }
    Soup::from_faces(positions, &faces)
}

/// A wavy grid of n by n quads, some cut in triangles.
fn sheet(n: u32) -> Soup {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let wave = |i: u32, j: u32| [i as f32, j as f32, ((i * 7 + j * 3) % 5) as f32 * 0.2];
    let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| wave(i, j))).collect();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        match (i + 2 * j) % 5 {
            0 => faces.extend([vec![a, b, c], vec![a, c, d]]),
            4 if i == 1 => {} // a hole
            _ => faces.push(vec![a, b, c, d]),
        }
    }
    Soup::from_faces(positions, &faces)
}

/// `soup` with sharp edges along its first faces, of all kinds, and two sharp corners.
fn creased(mut soup: Soup) -> Soup {
    let sharp = [10.0, 0.4, 1.0, 1.7, 2.5, 3.2, 10.0, 0.9];
    let faces = soup.face_count().min(6);
    for f in 0..faces {
        let face = soup.face(f).to_vec();
        for (k, i) in (0..face.len()).zip((f..).step_by(3)) {
            if (k + f) % 2 == 0 {
                soup.marks.creases.push(([face[k], face[(k + 1) % face.len()]], sharp[i % sharp.len()]));
            }
        }
    }
    let last = soup.face(soup.face_count() - 1).to_vec();
    soup.marks.corners = vec![(last[0], 10.0), (last[1], 1.4)];
    soup
}

fn triangles(soup: &Soup) -> Soup {
    triangulate_soup(soup).0
}

/// Meshes of every kind, as polygons.
fn polygons() -> Vec<(String, Soup)> {
    let mut all = vec![
        ("cube".to_owned(), named("cube")),
        ("prism over 7".to_owned(), prism(7, false)),
        ("open prism over 5".to_owned(), prism(5, true)),
        ("sheet".to_owned(), sheet(4)),
        ("one pentagon".to_owned(), Soup::from_faces(prism(5, false).positions, &[[0u32, 2, 4, 6, 8]])),
    ];
    let marked: Vec<_> = all.iter().map(|(name, soup)| (format!("creased {name}"), creased(soup.clone()))).collect();
    all.extend(marked);
    all
}

/// The largest distance as a share of the box, and the largest distance of normals.
fn compare(ours: &[([f32; 3], [f32; 3])], theirs: &Refined) -> (f64, f64) {
    assert_eq!(ours.len(), theirs.points.len());
    let [low, high] = bounds(&theirs.points);
    let size = (0..3).map(|k| f64::from(high[k] - low[k])).fold(0.0, f64::max);
    let distance =
        |p: [f32; 3], q: [f32; 3]| (0..3).map(|k| (f64::from(p[k]) - f64::from(q[k])).powi(2)).sum::<f64>().sqrt();
    let points = ours.iter().zip(&theirs.points).map(|(a, &b)| distance(a.0, b));
    let normals = theirs.normals();
    // Where faces fold back on each other there is no normal to compare.
    let turned = ours.iter().zip(&normals).filter(|(_, n)| **n != [0.0; 3]).map(|(a, &b)| distance(a.1, b));
    // NaN must not pass.
    let most = |a: f64, b: f64| if b <= a { a } else { b };
    (points.fold(0.0, most) / size, turned.fold(0.0, most))
}

struct Check {
    renderer: Renderer,
    compute: Compute,
    compared: usize,
}

impl Check {
    fn new() -> Option<Check> {
        Some(Check { renderer: renderer()?, compute: Compute::default(), compared: 0 })
    }

    fn gpu(&self) -> &Gpu {
        self.renderer.gpu()
    }

    /// Whether what `refiner` made is `refined`.
    fn same(&mut self, refiner: &Refiner, refined: &Refined, what: &str) {
        let read = tables::read(self.gpu(), refiner);
        assert_eq!(self.gpu().take_errors(), [] as [String; 0], "{what}");
        let (points, normals) = compare(&read, refined);
        assert!(points <= 1e-5, "{what}: points are off by {points:e} of the box");
        assert!(normals <= 1e-3, "{what}: normals are off by {normals:e}");
        // The box that the adapter found is that of its own points.
        let [low, high] = bounds(&read.iter().map(|v| v.0).collect::<Vec<_>>());
        assert_eq!(tables::read_bounds(self.gpu(), refiner), Some([low, high]), "{what}");
        self.compared += 1;
    }

    /// Whether both are drawn alike, but for single pixels.
    fn same_picture(&mut self, uploaded: Surface, made: Surface, id: &str) {
        assert_eq!(made.bytes(), uploaded.bytes(), "{id}");
        let camera = common::perspective([9.0, -6.0, 7.0], [2.0, 2.0, 0.3], 1.0, 6.0);
        let style = Style { edges: Edges::Bold, ..Style::light() };
        let pictures = [uploaded, made].map(|surface| {
            self.renderer.show(Some(surface));
            common::shoot(&mut self.renderer, &common::frame(camera, style.clone()), 256, 256)
        });
        let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 8;
        let different = pictures[0].rgba.iter().zip(&pictures[1].rgba).filter(|p| differs(*p)).count();
        pictures[1].save(&format!("refined-{id}"));
        let drawn = pictures[0].rgba.chunks(4).filter(|p| *p != &pictures[0].rgba[..4]).count();
        assert!(drawn > 3000, "{id}: {drawn} pixels are drawn");
        assert!(different < 200, "{id}: {different} bytes differ");
    }

    /// Refines both ways, where there are two.
    fn plan(&mut self, mesh: &Arc<Mesh>, plan: &Plan, what: &str, rows_too: bool) {
        let Ok(refined) = refine(mesh, plan, BUDGET) else { return };
        let rules = rules(mesh, plan);
        if let Some(rules) = &rules {
            let refiner =
                tables::by_kernels(self.renderer.gpu(), &mut self.compute, mesh, rules, plan.level, Values::Points);
            self.same(&refiner, &refined, &format!("{what}, kernels"));
        }
        if rules.is_none() || rows_too {
            let refiner = tables::by_rows(self.renderer.gpu(), &mut self.compute, mesh, plan, &refined);
            self.same(&refiner, &refined, &format!("{what}, rows"));
        }
    }
}

#[test]
fn every_scheme_on_every_kind_of_mesh() {
    let Some(mut check) = Check::new() else { return };
    for (name, soup) in polygons() {
        for entry in SCHEMES {
            for level in 1..=4 {
                let mut mesh = build(&soup);
                let mut plan = Plan::new(entry, Boundary::EdgeAndCorner, level);
                if plan.split(&mesh).is_err() {
                    mesh = build(&triangles(&soup));
                }
                // Growth by nine or more a step has said what it can at level 3.
                let faces = refine(&mesh, &plan.to(level - 1), BUDGET).unwrap().counts.faces;
                if faces > 4000 {
                    continue;
                }
                check.plan(&mesh, &plan, &format!("{}, {name}, level {level}", entry.info.id), level == 2);
                plan.rules.boundary = Boundary::EdgeOnly;
                check.plan(&mesh, &plan, &format!("{}, {name}, level {level}, rounded", entry.info.id), false);
            }
        }
    }
    assert!(check.compared > 18 * 10 * 5, "{}", check.compared);
}

#[test]
fn options_of_rules_and_parameters() {
    let Some(mut check) = Check::new() else { return };
    for (name, soup) in polygons() {
        let quads = build(&soup);
        let cut = build(&triangles(&soup));
        for level in [1, 3] {
            for (mesh, id) in [(&quads, "catmull-clark"), (&cut, "loop"), (&cut, "catmull-clark")] {
                let mut plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeOnly, level);
                plan.rules.decay = Decay::Chaikin;
                plan.rules.triangle = TriangleRule::Smooth;
                plan.params.set(&plan.scheme.info, 0, 1.0);
                check.plan(mesh, &plan, &format!("{id} of {name} with other rules, level {level}"), true);
            }
            let mut plan = Plan::new(scheme("butterfly").unwrap(), Boundary::EdgeAndCorner, level);
            assert!(plan.params.set(&plan.scheme.info, 0, 0.03));
            check.plan(&cut, &plan, &format!("butterfly of {name}, tighter, level {level}"), false);
        }
        // One scheme after the other, with fairing between them.
        let mut plan = Plan::new(scheme("doo-sabin").unwrap(), Boundary::EdgeAndCorner, 3);
        plan.later.push(Run { from: 1, scheme: scheme("catmull-clark").unwrap(), params: Params::default() });
        plan.fairings.push(Fairing { at: 1, iterations: 2 });
        check.plan(&quads, &plan, &format!("a mixed plan of {name}"), false);
        // The limit, after fairing too.
        for entry in SCHEMES {
            let mut plan = Plan::new(entry, Boundary::EdgeAndCorner, 2);
            plan.limit = true;
            let mesh = if plan.split(&quads).is_ok() { &quads } else { &cut };
            check.plan(mesh, &plan, &format!("{} of {name} in the limit", entry.info.id), false);
        }
        let mut plan = Plan::new(scheme("catmull-clark").unwrap(), Boundary::EdgeAndCorner, 1);
        (plan.limit, plan.fairings) = (true, vec![Fairing { at: 1, iterations: 1 }]);
        check.plan(&quads, &plan, &format!("{name}, faired, in the limit"), false);
    }
    // Copies of vertices that are tied stay together: three sheets along one edge.
    let book = Soup::from_faces(
        vec![
            [0.0; 3],
            [0.0, 1.0, 0.2],
            [1.0, 0.0, 0.1],
            [1.0, 1.0, 0.4],
            [-1.0, 0.1, 0.0],
            [-1.0, 1.2, 0.0],
            [0.1, 0.0, 1.0],
            [0.0, 1.3, 1.0],
        ],
        &[[0u32, 1, 3, 2], [0, 1, 5, 4], [0, 1, 7, 6]],
    );
    for entry in SCHEMES.iter().filter(|e| e.info.accepts == Accepts::Polygons) {
        let plan = Plan::new(entry, Boundary::EdgeAndCorner, 2);
        check.plan(&build(&book), &plan, &format!("{} of a book", entry.info.id), false);
    }
}

/// Vertices of every valence, inside and on a rim: weights by angles.
#[test]
fn every_valence() {
    let Some(mut check) = Check::new() else { return };
    for n in [3, 4, 5, 6, 7, 9, 12, 40] {
        let cone = |faces: u32| {
            let around = (0..n).map(|i| std::f32::consts::TAU * i as f32 / n as f32);
            let rim = around.map(|a| [a.cos(), a.sin() + 0.2 * a.cos(), 0.3 * a.cos()]);
            let positions = [[0.1, 0.0, 1.0]].into_iter().chain(rim).collect();
            let list: Vec<[u32; 3]> = (0..faces).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
            build(&Soup::from_faces(positions, &list))
        };
        for (mesh, what) in [(cone(n), "cone"), (cone(n - 1), "open cone"), (cone(n / 2), "half a cone")] {
            for id in ["loop", "modified-butterfly", "butterfly", "catmull-clark", "sqrt3", "doo-sabin"] {
                let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 2);
                check.plan(&mesh, &plan, &format!("{id} of a {what} of {n}"), false);
            }
        }
    }
}

/// Adapters end at 65,535 groups in one dimension: levels beyond take two, here from the third group on.
#[test]
fn more_groups_than_one_dimension_takes() {
    let Some(mut check) = Check::new() else { return };
    for id in ["catmull-clark", "loop", "doo-sabin", "sqrt3"] {
        let soup = named("cube");
        let mesh = build(&if id == "loop" || id == "sqrt3" { triangles(&soup) } else { soup });
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 5);
        let few = Limits { groups: 2, ..limits(check.gpu()) };
        let program = program(&mesh, &plan, &[], few).unwrap().unwrap();
        assert!(program.each.iter().any(|d| d.grid[1] > 2), "{id}");
        let mut refiner = Refiner::new(check.renderer.gpu(), &mut check.compute, &program).unwrap();
        refiner.set_points(check.gpu(), 0, &mesh.positions).unwrap();
        refiner.refine(check.gpu());
        check.same(&refiner, &refine(&mesh, &plan, BUDGET).unwrap(), id);
    }
}

/// New positions in the same buffers; half-edges are not made again.
#[test]
fn a_cage_that_moves() {
    let Some(mut check) = Check::new() else { return };
    let mesh = build(&named("cube"));
    // A fractal's constants are lengths of the cage's edges.
    for id in ["catmull-clark", "doo-sabin", "mid-edge", "fractal"] {
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 3);
        let refined = refine(&mesh, &plan, BUDGET).unwrap();
        let mut refiner = match rules(&mesh, &plan) {
            Some(rules) => {
                tables::by_kernels(check.renderer.gpu(), &mut check.compute, &mesh, &rules, 3, Values::Points)
            }
            None => tables::by_rows(check.renderer.gpu(), &mut check.compute, &mesh, &plan, &refined),
        };
        check.same(&refiner, &refined, id);
        let mut moved = Mesh::clone(&mesh);
        moved.positions[5] = [2.5, -0.5, 1.5];
        refiner.set_points(check.gpu(), 5, &moved.positions[5..6]).unwrap();
        refiner.refine(check.gpu());
        let refined = refine(&Arc::new(moved), &plan, BUDGET).unwrap();
        check.same(&refiner, &refined, &format!("{id}, moved"));
        let error = refiner.set_points(check.gpu(), 7, &mesh.positions[..2]).unwrap_err();
        assert_eq!(error, limn_layout::Error::Mismatch { what: "cage points", found: 9, expected: 8 }.into());
    }
}

/// The list in the documentation of `program`: each of these has rows, and its neighbour on the list's other side has kernels.
#[test]
fn what_has_no_kernels_has_rows() {
    let Some(check) = Check::new() else { return };
    let limits = limits(check.gpu());
    let [cube, sheet] = [named("cube"), sheet(4)];
    let [cut, cut_sheet] = [&cube, &sheet].map(triangles);
    let holed = |mut soup: Soup| {
        soup.marks.holes.push(1);
        soup
    };
    let parted = |n: usize| (0..n as u32).map(|f| f % 2).collect::<Vec<u32>>();
    let plain = |_: &mut Plan| ();
    type Case<'a> = (&'a str, Soup, &'a [u32], &'a dyn Fn(&mut Plan), bool);
    let cases: [Case<'_>; 18] = [
        ("kobbelt", cube.clone(), &[], &plain, false),
        ("doo-sabin", cube.clone(), &[], &plain, true),
        ("doo-sabin", cube.clone(), &parted(6), &plain, false),
        ("doo-sabin", sheet.clone(), &[], &plain, false),
        ("sqrt3", cut.clone(), &[], &plain, true),
        ("sqrt3", cut_sheet.clone(), &[], &plain, false),
        ("sqrt3", creased(cut.clone()), &[], &plain, false),
        ("loop", creased(cut_sheet.clone()), &[], &plain, true),
        ("butterfly", creased(cut_sheet.clone()), &[], &plain, false),
        ("modified-butterfly", cut_sheet.clone(), &[], &plain, true),
        ("modified-butterfly", creased(cut_sheet), &[], &plain, false),
        ("catmull-clark", cube.clone(), &parted(6), &plain, true),
        ("catmull-clark", cube.clone(), &[], &|plan| plan.limit = true, false),
        ("catmull-clark", cube.clone(), &[], &|plan| plan.fairings.push(Fairing { at: 1, iterations: 1 }), false),
        (
            "catmull-clark",
            cube.clone(),
            &[],
            &|plan| plan.later.push(Run { from: 1, scheme: scheme("linear").unwrap(), params: Params::default() }),
            false,
        ),
        ("catmull-clark", holed(cube), &[], &plain, false),
        ("catmull-clark", sheet.clone(), &[], &|plan| plan.rules.boundary = Boundary::None, false),
        ("catmull-clark", sheet, &[], &|plan| plan.rules.boundary = Boundary::EdgeOnly, true),
    ];
    for (id, soup, parts, tweak, kernels) in cases {
        let mesh = build(&soup);
        let mut plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 2);
        tweak(&mut plan);
        assert_eq!(program(&mesh, &plan, parts, limits).unwrap().is_some(), kernels, "{id}");
        assert!(by_rows(&mesh, &plan, parts, limits).unwrap().is_some(), "{id}");
        // The cage itself, and more than rows are made for.
        assert_eq!(program(&mesh, &plan.to(0), parts, limits).unwrap(), None);
        assert_eq!([0, 11].map(|level| by_rows(&mesh, &plan.to(level), parts, limits).unwrap()), [None, None]);
    }
    // A sheet of triangles for a scheme of triangles, or a sentence.
    let loops = Plan::new(scheme("loop").unwrap(), Boundary::EdgeAndCorner, 2);
    let error = by_rows(&build(&named("cube")), &loops, &[], limits).unwrap_err();
    assert!(error.to_string().contains("triangulate first"), "{error}");
}

/// Tables that would hang a kernel, or that no buffer holds, come back as a sentence.
#[test]
fn bad_tables_and_large_levels_are_refused() {
    let Some(check) = Check::new() else { return };
    let mesh = build(&named("cube"));
    let rules = Rules { scheme: Scheme::CatmullClark { triangle: 0.25 }, corners: true, chaikin: false };
    let good = Tables::of(&mesh);
    let gpu = check.renderer.gpu();
    let refused = |cage: &Cage<'_>, rules: &Rules, level| {
        let program = fused(cage, rules, level, Values::Points, limits(gpu));
        program.err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert_eq!(refused(&good.cage(&mesh), &rules, 2), "");
    let half_edge =
        "half-edge 0 of the mesh does not fit its neighbours, so it cannot be refined on the graphics adapter";
    let mut twin = good.cage(&mesh).twin.to_vec();
    twin[0] = 5;
    assert_eq!(refused(&Cage { twin: &twin, ..good.cage(&mesh) }, &rules, 2), half_edge);
    let start = [9; 8];
    let of = refused(&Cage { start: &start, ..good.cage(&mesh) }, &rules, 2);
    assert!(of.starts_with("vertex 0 of the mesh"), "{of}");
    let triangles = Rules { scheme: Scheme::Loop { warren: false }, ..rules };
    assert!(refused(&good.cage(&mesh), &triangles, 2).starts_with("face 0 of the mesh"));
    assert_eq!(refused(&good.cage(&mesh), &rules, 0), "levels: 0 were given where 1 are needed");
    let large = refused(&good.cage(&mesh), &rules, 18);
    assert!(large.contains("need") && large.contains("but this graphics adapter takes"), "{large}");
    // 6 * 4^14 + 2 points.
    let large = refused(&good.cage(&mesh), &rules, 14);
    assert!(large.starts_with("the vertices need 25769803808 bytes in one buffer"), "{large}");
    assert_eq!(gpu.take_errors(), [] as [String; 0]);
}
