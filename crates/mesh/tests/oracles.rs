//! Positions against what OpenSubdiv, CGAL and OpenMesh computed (tests/oracles: source, options and mesh in each file).

mod common;

use common::distance;
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, Mesh, Plan, Soup, Weld, refine, scheme};
use serde_json::Value;
use std::sync::Arc;

fn triples(v: &Value) -> Vec<[f64; 3]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

fn check(json: &str) {
    let oracle: Value = serde_json::from_str(json).unwrap();
    let positions = triples(&oracle["mesh"]["positions"]);
    let faces: Vec<Vec<u32>> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    let (mesh, report) = Mesh::build(&soup, Weld::Off).unwrap();
    assert_eq!(report.notes, []);
    let mesh = Arc::new(mesh);
    // What the libraries call them.
    let id = match oracle["scheme"].as_str().unwrap() {
        "catmark" => "catmull-clark",
        "butterfly" => "modified-butterfly",
        "doosabin" => "doo-sabin",
        "sqrt3interp" => "interpolating-sqrt3",
        other => other,
    };
    // CGAL and OpenMesh round boundary corners as OpenSubdiv's EDGE_ONLY does.
    let corner = oracle["options"]["vtxBoundary"].as_str() == Some("EDGE_AND_CORNER");
    let boundary = if corner { Boundary::EdgeAndCorner } else { Boundary::EdgeOnly };
    for theirs in oracle["levels"].as_array().unwrap() {
        let level = theirs["level"].as_u64().unwrap() as u32;
        let plan = Plan::new(scheme(id).unwrap(), boundary, level);
        // Every library was given the positions rounded to f32.
        let rounded: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        let exact = evaluate(&mesh, &plan, &rounded, |_| ()).unwrap();
        let theirs = triples(&theirs["positions"]);
        let d = distance(&exact, &theirs);
        assert!(d < 1e-9, "{}: level {level} is off by {d} in f64", oracle["source"]);
        let fast = refine(&mesh, &plan, u64::MAX).unwrap();
        let fast: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
        let d = distance(&fast, &theirs);
        assert!(d < 1e-6, "{}: level {level} is off by {d} in f32", oracle["source"]);
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
    osd_cube_catmark osd_tetra_catmark osd_grid3_catmark_edgeonly osd_grid3_catmark_edgecorner
    osd_icosa_loop osd_tetra_loop osd_gridtri3_loop_edgeonly osd_gridtri3_loop_edgecorner
    cgal_cube_catmark cgal_tetra_catmark cgal_tetra_loop cgal_gridtri3_loop openmesh_icosa_loop
    openmesh_icosa_butterfly openmesh_tetra_butterfly
    openmesh_icosa_sqrt3 cgal_tetra_sqrt3 cgal_gridtri3_sqrt3 openmesh_gridtri3_sqrt3 cgal_cube_doosabin cgal_tetra_doosabin
    openmesh_icosa_sqrt3interp openmesh_tetra_sqrt3interp
}

/// The rim's points of interpolating sqrt3, which OpenMesh computes by the paper's rule (its points of triangles with two
/// boundary edges depend on where a face's list begins).
#[test]
fn openmesh_rim_of_interpolating_sqrt3() {
    let oracle: Value =
        serde_json::from_str(include_str!("../../../tests/oracles/openmesh_gridtri3_sqrt3interp.json")).unwrap();
    let faces: Vec<[u32; 3]> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let positions = triples(&oracle["mesh"]["positions"]).iter().map(|p| p.map(|x| x as f32)).collect();
    let (mesh, _) = Mesh::build(&Soup::from_faces(positions, &faces), Weld::Off).unwrap();
    let rounded: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let plan = Plan::new(scheme("interpolating-sqrt3").unwrap(), Boundary::EdgeOnly, 2);
    let theirs = triples(&oracle["levels"][1]["positions"]);
    let refined = refine(&Arc::new(mesh.clone()), &plan, u64::MAX).unwrap();
    let ours = evaluate(&mesh, &plan, &rounded, |_| ()).unwrap();
    // A rim's edge has one face.
    let mut sides: Vec<[u32; 2]> = Vec::new();
    for f in 0..refined.faces.count() {
        let [a, b, c] = refined.faces.face(f) else { panic!("triangles") };
        sides.extend([[a, b], [b, c], [c, a]].map(|[x, y]| [*x.min(y), *x.max(y)]));
    }
    sides.sort_unstable();
    let rim: Vec<u32> = sides.chunk_by(|a, b| a == b).filter(|s| s.len() == 1).flat_map(|s| s[0]).collect();
    assert_eq!(rim.len(), 2 * 36);
    for v in rim {
        let near = |q: &[f64; 3]| (0..3).map(|k| (q[k] - ours[v as usize][k]).powi(2)).sum::<f64>().sqrt();
        let d = theirs.iter().map(near).fold(f64::MAX, f64::min);
        assert!(d < 1e-9, "vertex {v} is off by {d}");
    }
}
