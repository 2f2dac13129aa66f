//! Creases, corners, boundary options and the smooth rule of triangles against what OpenSubdiv computed (tests/oracles):
//! positions, and the sharpness of every edge of every level.

mod common;

use common::distance;
use limn_mesh::refine::evaluate_creased;
use limn_mesh::{Boundary, Connectivity, Decay, Mesh, Plan, Soup, TriangleRule, Weld, refine, scheme};
use serde_json::Value;
use std::sync::Arc;

fn triples(v: &Value) -> Vec<[f64; 3]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

/// The number of the point nearest to each of `points` among `of`.
fn nearest(points: &[[f64; 3]], of: &[[f64; 3]]) -> Vec<u32> {
    let d = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
    let best = |p: &[f64; 3]| (0..of.len()).min_by(|&a, &b| d(p, &of[a]).total_cmp(&d(p, &of[b]))).unwrap() as u32;
    points.iter().map(best).collect()
}

fn check(json: &str) {
    let oracle: Value = serde_json::from_str(json).unwrap();
    let positions = triples(&oracle["mesh"]["positions"]);
    let faces: Vec<Vec<u32>> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let mut soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    let creases: Vec<(u32, u32, f32)> = serde_json::from_value(oracle["creases"].clone()).unwrap();
    soup.marks.creases = creases.into_iter().map(|(a, b, s)| ([a, b], s)).collect();
    soup.marks.corners = serde_json::from_value(oracle["corners"].clone()).unwrap();
    let (mesh, report) = Mesh::build(&soup, Weld::Off).unwrap();
    assert_eq!(report.notes, []);
    let mesh = Arc::new(mesh);
    let option = |key: &str| oracle["options"][key].as_str().unwrap();
    let id = if oracle["scheme"] == "catmark" { "catmull-clark" } else { "loop" };
    let boundary = match option("vtxBoundary") {
        "NONE" => Boundary::None,
        "EDGE_ONLY" => Boundary::EdgeOnly,
        _ => Boundary::EdgeAndCorner,
    };
    let mut plan = Plan::new(scheme(id).unwrap(), boundary, 0);
    plan.rules.decay = if option("creasing") == "CHAIKIN" { Decay::Chaikin } else { Decay::Uniform };
    plan.rules.triangle =
        if option("triangleSubdivision") == "SMOOTH" { TriangleRule::Smooth } else { TriangleRule::CatmullClark };

    let rounded: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    for theirs in oracle["levels"].as_array().unwrap() {
        let level = theirs["level"].as_u64().unwrap() as u32;
        let points = triples(&theirs["positions"]);
        // One level further, so that this one has half-edges.
        let mut depth = 0;
        let mut sharp = Vec::new();
        evaluate_creased(&mesh, &plan.to(level + 1), &rounded, |at, creases| {
            if depth == level {
                for e in 0..at.edges() {
                    let h = at.edge_half_edge(e);
                    let (a, b) = (at.origin(h), at.origin(at.next(h)));
                    let rim = if at.twin(h) >> 31 == 1 { 10.0 } else { 0.0 };
                    let s = creases.map_or(rim, |c| c.along(at, h));
                    if s > 0.0 {
                        sharp.push(([a.min(b), a.max(b)], s));
                    }
                }
            }
            depth += 1;
        })
        .unwrap();
        let exact = evaluate_creased(&mesh, &plan.to(level), &rounded, |_, _| ()).unwrap();
        let d = distance(&exact, &points);
        assert!(d < 2e-8, "level {level} is off by {d} in f64");
        let fast = refine(&mesh, &plan.to(level), u64::MAX).unwrap();
        let fast: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
        let d = distance(&fast, &points);
        assert!(d < 1e-6, "level {level} is off by {d} in f32");

        let ours = nearest(&points, &exact);
        let expected: Vec<(usize, usize, f32)> = serde_json::from_value(theirs["edgeSharpness"].clone()).unwrap();
        let mut expected: Vec<([u32; 2], f32)> =
            expected.into_iter().map(|(a, b, s)| ([ours[a].min(ours[b]), ours[a].max(ours[b])], s)).collect();
        expected.sort_by_key(|x| x.0);
        sharp.sort_by_key(|x| x.0);
        assert_eq!(sharp.len(), expected.len(), "level {level}");
        for (a, b) in sharp.iter().zip(&expected) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-6, "level {level}: {a:?} is to be {b:?}");
        }
    }
}

macro_rules! oracles {
    ($($name:ident)*) => { $(
        #[test]
        fn $name() {
            check(include_str!(concat!("../../../tests/oracles/", stringify!($name), ".json")));
        }
    )* };
}

oracles! {
    osd_cube_catmark_corner osd_cube_catmark_cornersemi osd_cube_catmark_crease_chaikin osd_cube_catmark_crease_uniform
    osd_grid3_catmark_edgecorner_corner osd_grid3_catmark_edgecorner_cornersemi
    osd_grid3_catmark_edgecorner_crease_chaikin osd_grid3_catmark_edgecorner_crease_uniform
    osd_grid3_catmark_edgeonly_corner osd_grid3_catmark_edgeonly_cornersemi
    osd_grid3_catmark_edgeonly_crease_chaikin osd_grid3_catmark_edgeonly_crease_uniform osd_grid3_catmark_none
    osd_gridtri3_loop_edgecorner_corner osd_gridtri3_loop_edgecorner_cornersemi
    osd_gridtri3_loop_edgecorner_crease_chaikin osd_gridtri3_loop_edgecorner_crease_uniform
    osd_gridtri3_loop_edgeonly_corner osd_gridtri3_loop_edgeonly_cornersemi
    osd_gridtri3_loop_edgeonly_crease_chaikin osd_gridtri3_loop_edgeonly_crease_uniform
    osd_icosa_loop_corner osd_icosa_loop_cornersemi osd_icosa_loop_crease_chaikin osd_icosa_loop_crease_uniform
    osd_tetra_catmark_corner osd_tetra_catmark_cornersemi osd_tetra_catmark_crease_chaikin
    osd_tetra_catmark_crease_uniform osd_tetra_catmark_trismooth
    osd_tetra_loop_corner osd_tetra_loop_cornersemi osd_tetra_loop_crease_chaikin osd_tetra_loop_crease_uniform
}
