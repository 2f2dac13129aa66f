//! What is drawn of the GPU's buffers is what is drawn of uploaded ones.

use super::*;
use limn_mesh::FaceVarying;

/// How a program comes about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Kernels,
    Rows,
}

/// A level of a mesh with everything that goes with it.
struct Case<'a> {
    mesh: &'a Arc<Mesh>,
    plan: &'a Plan,
    /// Of the file's faces.
    parts: &'a [u32],
}

const PARTS: [Part; 2] = [Part { material: 0, group: 0 }, Part { material: 1, group: 0 }];

impl Check {
    /// Whether both the points and the picture of a case are the CPU's.
    fn case(&mut self, case: &Case<'_>, way: Way, what: &str) {
        let Case { mesh, plan, parts } = case;
        let refined = refine(mesh, plan, BUDGET).unwrap();
        let limits = limits(self.gpu());
        let program = match way {
            Way::Kernels => program(mesh, plan, parts, limits),
            Way::Rows => by_rows(mesh, plan, parts, limits),
        };
        let program = program.unwrap().unwrap_or_else(|| panic!("{what}: no {way:?}"));
        let mut refiner = Refiner::new(self.renderer.gpu(), &mut self.compute, &program).unwrap();
        refiner.set_points(self.gpu(), 0, &mesh.positions).unwrap();
        refiner.refine(self.gpu());
        self.same(&refiner, &refined, what);
        let uploaded = self.uploaded(case, &refined, way);
        let mut surface = refiner.surface(uploaded.bounds(), None).unwrap();
        surface.settle(uploaded.bounds(), &PARTS, program.runs.as_flattened());
        self.same_picture(uploaded, surface, what);
    }

    /// The surface of the CPU's level.
    fn uploaded(&self, case: &Case<'_>, refined: &Refined, way: Way) -> Surface {
        let normals = refined.normals();
        let mut data = SurfaceData::new(&refined.points, &normals, tables::faces(refined));
        (data.parents, data.colors) = (refined.parents(), &refined.colors);
        data.uv = refined.uv.as_ref().map(|uv| (&uv.values[..], &uv.corners[..]));
        data.force_corners = !refined.colors.is_empty();
        let part_of = |f: usize| case.parts.get(refined.face_source(f as u32) as usize).copied().unwrap_or(0);
        data.parts = &PARTS;
        data.part_of = if case.parts.is_empty() { None } else { Some(&part_of) };
        let kind_of = |f: usize| refined.kinds.get(f).map_or(0, |k| *k as u32 + 1);
        data.kind_of = (!refined.kinds.is_empty()).then_some(&kind_of);
        if way == Way::Rows {
            // Kernels know fans alone.
            data.triangulate = limn_mesh::triangulate;
        }
        let mut upload = self.renderer.upload(&data).unwrap();
        while !upload.step(self.gpu(), &data, 1000).unwrap() {}
        upload.finish()
    }

    /// A chequered picture, another one when turned, and two materials.
    fn paint(&mut self) {
        let paint = |[r, g, b]: [f32; 3]| Material { base_color: [r, g, b, 1.0], texture: Some(0) };
        let texel = |i: u8| {
            if (i + i / 8).is_multiple_of(2) { [255, 30 * (i % 8), 255, 255] } else { [90, 160, 25 * (i / 8), 255] }
        };
        let rgba: Vec<u8> = (0..64).flat_map(texel).collect();
        self.renderer.set_textures(&[TextureData { width: 8, height: 8, rgba: &rgba }]).unwrap();
        self.renderer.set_materials(&[paint([0.9, 0.6, 0.3]), paint([0.4, 0.9, 0.5])]);
    }
}

/// Faces, edges, both layouts.
#[test]
fn pictures_of_both_are_one() {
    let Some(mut check) = Check::new() else { return };
    let sheet = sheet(4);
    for (id, level, soup, way) in [
        ("catmull-clark", 2, sheet.clone(), Way::Kernels),
        ("loop", 2, triangles(&sheet), Way::Kernels),
        ("doo-sabin", 1, sheet.clone(), Way::Rows),
        ("kobbelt", 2, named("cube"), Way::Rows),
        ("sqrt3", 2, triangles(&sheet), Way::Rows),
        ("sqrt3", 3, triangles(&named("cube")), Way::Kernels),
        ("doo-sabin", 2, prism(7, false), Way::Kernels),
    ] {
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, level);
        check.case(&Case { mesh: &build(&soup), plan: &plan, parts: &[] }, way, id);
    }
}

/// Gives the sheet texture coordinates: a chart for each half, and every fifth face a chart of its own.
fn textured(soup: &mut Soup) {
    for f in 0..soup.face_count() {
        for &v in soup.face(f).to_vec().iter() {
            let [x, y, _] = soup.positions[v as usize];
            let chart = if f % 5 == 3 { f as f32 } else { f32::from(u8::from(f > soup.face_count() / 2)) };
            soup.uv_corners.push(soup.uvs.len() as u32);
            // Bent, so that a curve is none of its chords.
            let [a, b] = [v * 7 % 5, v * 3 % 4].map(|n| n as f32 * 0.06);
            soup.uvs.push([0.25 * x + chart * 0.1 + a, 0.25 * y - chart * 0.05 + b]);
        }
    }
}

/// The mesh of a soup, coloured.
fn coloured(soup: &Soup) -> Arc<Mesh> {
    let mut mesh = Mesh::clone(&build(soup));
    mesh.colors = mesh.positions.iter().map(|p| [0.2 * p[0], 0.2 * p[1], p[2], 1.0]).collect();
    Arc::new(mesh)
}

/// Texture coordinates across seams, colours, and parts of several materials.
#[test]
fn what_corners_carry_and_parts() {
    let Some(mut check) = Check::new() else { return };
    check.paint();
    for (id, cut) in [("catmull-clark", false), ("loop", true), ("linear", false), ("modified-butterfly", true)] {
        for (with_uv, with_colors, with_parts) in
            [(true, false, false), (false, true, false), (true, true, true), (false, false, true)]
        {
            let mut soup = if cut { triangles(&sheet(4)) } else { sheet(4) };
            if with_uv {
                textured(&mut soup);
            }
            let mesh = if with_colors { coloured(&soup) } else { build(&soup) };
            let parts: Vec<u32> = (0..soup.face_count()).map(|f| u32::from(with_parts && f % 3 == 1)).collect();
            let parts = if with_parts { &parts[..] } else { &[] };
            for level in [1, 2, 3] {
                let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, level);
                let what = format!("{id}-{level}-{with_uv}-{with_colors}-{with_parts}");
                check.case(&Case { mesh: &mesh, plan: &plan, parts }, Way::Kernels, &what);
                if level == 2 {
                    check.case(&Case { mesh: &mesh, plan: &plan, parts }, Way::Rows, &format!("{what}, rows"));
                }
            }
        }
    }
}

/// What every scheme carries goes by rows.
#[test]
fn every_scheme_carries_everything() {
    let Some(mut check) = Check::new() else { return };
    check.paint();
    for entry in SCHEMES {
        let mut plan = Plan::new(entry, Boundary::EdgeAndCorner, 2);
        let mut soup = sheet(4);
        if plan.split(&build(&soup)).is_err() {
            soup = triangles(&soup);
        }
        textured(&mut soup);
        let parts: Vec<u32> = (0..soup.face_count()).map(|f| u32::from(f % 3 == 1)).collect();
        let mesh = coloured(&soup);
        check.case(&Case { mesh: &mesh, plan: &plan, parts: &parts }, Way::Rows, entry.info.id);
        // Faces that are not shown: holes, and where the rim is left out.
        plan.rules.boundary = Boundary::None;
        soup.marks.holes.push(3);
        let what = format!("{}-without-rim", entry.info.id);
        check.case(&Case { mesh: &build(&soup), plan: &plan, parts: &[] }, Way::Rows, &what);
    }
}

/// Texture coordinates by all rules, with creases: kernels wherever their own half-edges see what matters.
#[test]
fn seams_that_stay_straight_and_creases_beside_them() {
    let Some(mut check) = Check::new() else { return };
    check.paint();
    let rules = [
        FaceVarying::None,
        FaceVarying::CornersOnly,
        FaceVarying::CornersPlus1,
        FaceVarying::CornersPlus2,
        FaceVarying::Boundaries,
        FaceVarying::All,
    ];
    let mut by_kernels = 0;
    for (id, cut) in [("catmull-clark", false), ("loop", true), ("butterfly", true), ("modified-butterfly", true)] {
        // Smooth, with creases for ever, and with semi-sharp ones, of which some meet seams.
        for sharp in [None, Some(10.0), Some(1.4)] {
            if sharp.is_some() && id.ends_with("butterfly") {
                continue;
            }
            let mut soup = if cut { triangles(&sheet(4)) } else { sheet(4) };
            textured(&mut soup);
            if let Some(sharp) = sharp {
                for f in [1, 4, 5, 7] {
                    let face = soup.face(f).to_vec();
                    soup.marks.creases.push(([face[1], face[2]], sharp));
                }
            }
            let mesh = build(&soup);
            for rule in rules {
                let mut plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 3);
                plan.rules.face_varying = rule;
                let case = Case { mesh: &mesh, plan: &plan, parts: &[] };
                let what = format!("{id}-{rule:?}-{}", sharp.unwrap_or_default());
                if program(&mesh, &plan, &[], limits(check.gpu())).unwrap().is_some() {
                    check.case(&case, Way::Kernels, &what);
                    by_kernels += 1;
                } else {
                    assert!(sharp == Some(1.4) && rule != FaceVarying::All, "{what}");
                    check.case(&case, Way::Rows, &what);
                }
            }
        }
    }
    // All but semi-sharp creases at ends of seams.
    assert_eq!(by_kernels, 4 * 6 + 2 * 6 + 2);
}

/// Colours take the rules that points take, and are drawn with them where faces share vertices.
#[test]
fn colours_go_the_same_way() {
    let Some(mut check) = Check::new() else { return };
    for id in ["catmull-clark", "loop", "linear"] {
        let soup = if id == "loop" { triangles(&sheet(4)) } else { sheet(4) };
        let mut mesh = Mesh::clone(&build(&soup));
        let shade = |p: &[f32; 3]| [0.2 * p[0], 0.2 * p[1], p[2], 0.5 + 0.1 * p[0]];
        mesh.colors = mesh.positions.iter().map(shade).collect();
        let mesh = Arc::new(mesh);
        let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, 2);
        let refined = refine(&mesh, &plan, BUDGET).unwrap();
        let (gpu, compute) = (check.renderer.gpu(), &mut check.compute);
        let rules = rules(&mesh, &plan).unwrap();
        let [points, colors] =
            [Values::Points, Values::Colors].map(|what| tables::by_kernels(gpu, compute, &mesh, &rules, 2, what));
        let read: Vec<_> = tables::read_words(gpu, &colors).into_iter().map(|w| w.map(f32::from_bits)).collect();
        assert_eq!(read.len(), refined.colors.len());
        let off = read.iter().zip(&refined.colors).flat_map(|(a, b)| (0..4).map(|k| (a[k] - b[k]).abs()));
        let worst = off.fold(0.0, |a, b| if b <= a { a } else { b });
        assert!(worst <= 1e-5, "{id}: colours are off by {worst:e}");
        if refined.parent_ranges.is_none() {
            let error = points.surface(Bounds { min: [0.0; 3], max: [1.0; 3] }, Some(&colors)).err().unwrap();
            assert!(error.to_string().starts_with("colours of vertices that quads share"), "{error}");
            continue;
        }
        let normals = refined.normals();
        let mut data = SurfaceData::new(&refined.points, &normals, tables::faces(&refined));
        (data.parents, data.colors) = (refined.parent_ranges, &refined.colors);
        let mut upload = check.renderer.upload(&data).unwrap();
        while !upload.step(check.gpu(), &data, 1000).unwrap() {}
        let uploaded = upload.finish();
        let surface = points.surface(uploaded.bounds(), Some(&colors)).unwrap();
        check.same_picture(uploaded, surface, id);
    }
}
