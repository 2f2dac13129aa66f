//! Positions against what OpenSubdiv, CGAL and OpenMesh computed (tests/oracles: source, options and mesh in each file).

mod common;

use common::distance;
use limn_mesh::refine::evaluate;
use limn_mesh::{Boundary, Mesh, Plan, Soup, Weld, refine, scheme};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

fn triples(v: &Value) -> Vec<[f64; 3]> {
    v.as_array().unwrap().iter().map(|p| std::array::from_fn(|k| p[k].as_f64().unwrap())).collect()
}

/// By how much each level of a case is off, in f64 and f32; infinite if it has not as many points.
fn differences(oracle: &Value) -> Vec<(u32, f64, f64)> {
    let positions = triples(&oracle["mesh"]["positions"]);
    let faces: Vec<Vec<u32>> = serde_json::from_value(oracle["mesh"]["faces"].clone()).unwrap();
    let soup = Soup::from_faces(positions.iter().map(|p| p.map(|x| x as f32)).collect(), &faces);
    let mesh = Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0);
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
    // Every library was given the positions rounded to f32.
    let rounded: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let of_level = |theirs: &Value| {
        let level = theirs["level"].as_u64().unwrap() as u32;
        let plan = Plan::new(scheme(id).unwrap(), boundary, level);
        let exact = evaluate(&mesh, &plan, &rounded, |_| ()).unwrap();
        let theirs = triples(&theirs["positions"]);
        if exact.len() != theirs.len() {
            return (level, f64::INFINITY, f64::INFINITY);
        }
        let fast = refine(&mesh, &plan, u64::MAX).unwrap();
        let fast: Vec<_> = fast.points.iter().map(|p| p.map(f64::from)).collect();
        (level, distance(&exact, &theirs), distance(&fast, &theirs))
    };
    oracle["levels"].as_array().unwrap().iter().map(of_level).collect()
}

fn check(json: &str) {
    let oracle: Value = serde_json::from_str(json).unwrap();
    for (level, exact, fast) in differences(&oracle) {
        assert!(exact < 1e-9, "{}: level {level} is off by {exact} in f64", oracle["source"]);
        assert!(fast < 1e-6, "{}: level {level} is off by {fast} in f32", oracle["source"]);
    }
}

/// Any number of cases: `LIMN_ORACLE_CASES=FOLDER cargo test --test oracles -- --ignored --nocapture` prints the largest
/// differences by category.
#[test]
#[ignore = "reads the folder that LIMN_ORACLE_CASES names"]
fn cases_of_a_folder() {
    let folder = std::env::var("LIMN_ORACLE_CASES").expect("LIMN_ORACLE_CASES names a folder");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    let mut by_category: BTreeMap<String, (usize, f64, f64)> = BTreeMap::new();
    let mut wrong = Vec::new();
    for path in &paths {
        let oracle: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let category = by_category.entry(oracle["category"].as_str().unwrap().to_owned()).or_default();
        category.0 += 1;
        for (level, exact, fast) in differences(&oracle) {
            (category.1, category.2) = (category.1.max(exact), category.2.max(fast));
            if exact > 1e-9 || fast > 4e-6 {
                wrong.push(format!("{}: level {level} is off by {exact:.2e}", path.display()));
                break;
            }
        }
    }
    for (category, (cases, exact, fast)) in &by_category {
        println!("{category}: {cases} cases, {exact:.1e} in f64, {fast:.1e} in f32");
    }
    assert!(wrong.is_empty(), "{} of {} cases disagree:\n{}", wrong.len(), paths.len(), wrong.join("\n"));
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
    cgal_random_catmark cgal_random_loop cgal_random_sqrt3 cgal_random_doosabin
    openmesh_random_butterfly openmesh_random_sqrt3interp openmesh_random_sqrt3
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
