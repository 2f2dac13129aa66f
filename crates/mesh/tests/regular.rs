//! What regular and closed levels let the engine leave out, against rows in f64, which know nothing of it: dual splits by
//! arithmetic, quads at once, rings added up triangle by triangle, valences that are not counted.

mod common;

use common::{build, gallery};
use limn_mesh::refine::evaluate;
use limn_mesh::*;

/// Holds the points of every level against rows, and what slices make against what is made in one go.
fn check(soup: &Soup, plan: &Plan, what: &str) {
    let mesh = build(soup);
    let positions: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
    let job = || Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
    let fast = job().finish();
    let exact = evaluate(&mesh, plan, &positions, |_| ()).unwrap();
    let [low, high] = bounds(&mesh.positions);
    let size = (0..3).map(|k| f64::from(high[k] - low[k])).fold(0.0, f64::max);
    assert_eq!(fast.points.len(), exact.len(), "{what}");
    for (v, (p, q)) in fast.points.iter().zip(&exact).enumerate() {
        for k in 0..3 {
            assert!((f64::from(p[k]) - q[k]).abs() <= 2e-6 * size, "{what}: vertex {v} is {p:?}, not {q:?}");
        }
    }
    let mut sliced = job();
    while !sliced.step(101) {
        assert!(sliced.progress() <= 1.0, "{what}");
    }
    let sliced = sliced.finish();
    assert_eq!((&sliced.points, &sliced.faces), (&fast.points, &fast.faces), "{what}");
}

fn plan(id: &str, level: u32) -> Plan {
    Plan::new(scheme(id).unwrap(), Boundary::default(), level)
}

#[test]
fn dual_schemes_agree() {
    for (name, soup) in gallery() {
        for id in ["doo-sabin", "doo-sabin-midpoint", "nurss"] {
            check(&soup, &plan(id, 4), &format!("{name}, {id}"));
        }
    }
}

#[test]
fn triangle_schemes_agree() {
    for (name, soup) in gallery() {
        let (mut soup, _) = triangulate_soup(&soup);
        for (id, level) in [("sqrt3", 5), ("modified-butterfly", 3)] {
            check(&soup, &plan(id, level), &format!("{name}, {id}"));
        }
        let face = soup.face(0).to_vec();
        soup.marks.creases = vec![([face[0], face[1]], 10.0), ([face[1], face[2]], 1.3)];
        for (id, level) in [("sqrt3", 5), ("modified-butterfly", 3)] {
            check(&soup, &plan(id, level), &format!("{name} with creases, {id}"));
        }
    }
}

/// One scheme after the other: what one knows of its levels must be true of the other's.
#[test]
fn changes_of_scheme_agree() {
    let with = |first: &str, later: &[(&str, u32)], level: u32| {
        let mut plan = plan(first, level);
        let run = |&(id, from): &(&str, u32)| Run { scheme: scheme(id).unwrap(), params: Params::default(), from };
        plan.later = later.iter().map(run).collect();
        plan
    };
    for (name, soup) in gallery() {
        for plan in [
            with("doo-sabin", &[("catmull-clark", 2)], 4),
            with("doo-sabin", &[("catmull-clark", 3)], 4),
            with("linear", &[("doo-sabin", 1), ("linear", 3)], 4),
            with("doo-sabin", &[("poke", 2), ("doo-sabin", 3)], 4),
        ] {
            check(&soup, &plan, &format!("{name}, {plan:?}"));
        }
        let (soup, _) = triangulate_soup(&soup);
        for plan in [
            with("sqrt3", &[("modified-butterfly", 2), ("sqrt3", 3)], 5),
            with("sqrt3", &[("modified-butterfly", 3)], 4),
            with("modified-butterfly", &[("sqrt3", 1), ("loop", 3)], 4),
            with("sqrt3", &[("doo-sabin", 2)], 4),
        ] {
            check(&soup, &plan, &format!("{name}, {plan:?}"));
        }
    }
}

/// What is left to be done with the last level finds it as it would be without arithmetic.
#[test]
fn limits_and_fairings_of_dual_levels_agree() {
    let creature = (shape("creature").unwrap().build)();
    let mut plan = plan("doo-sabin", 3);
    plan.fairings = [2, 3].map(|at| Fairing { at, iterations: 1 }).into();
    check(&creature, &plan, "faired");
    let limit = Plan { limit: true, fairings: Vec::new(), ..plan };
    check(&creature, &limit, "in the limit");
}
