//! Patches as tables: evaluated here plainly, they give the points that refinement gives, every id at most once.

mod common;

use common::{build, gallery};
use limn_mesh::*;

/// The corners of a level that has one kind of faces.
fn corners(refined: &Refined) -> &[u32] {
    match &refined.faces {
        Faces::Triangles(corners) | Faces::Quads(corners) => corners,
        Faces::Polygons { .. } => panic!("a split of quads or triangles"),
    }
}

/// The values of a patch's plate, cell by cell.
fn plate(tables: &PatchTables, ring: &PatchRing, start: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let side = (1 << tables.depth) + 3;
    let mut plate = vec![[f64::NAN; 3]; side * side];
    let controls = &tables.controls[ring.first as usize..][..ring.count as usize];
    let point = |k: usize| start[controls[k] as usize].map(f64::from);
    match ring.table {
        None => {
            for (j, b) in tables.spline.iter().enumerate() {
                for (i, a) in tables.spline.iter().enumerate() {
                    let weight = |k: usize| f64::from(a[k % 4]) * f64::from(b[k / 4]);
                    plate[j * side + i] = [0, 1, 2].map(|x| (0..16).map(|k| weight(k) * point(k)[x]).sum());
                }
            }
        }
        Some(table) => {
            let table = &tables.tables[table as usize];
            assert_eq!(table.controls, ring.count);
            for (i, &cell) in tables.cells.iter().enumerate() {
                let weight = |k: usize| f64::from(table.weights[k * tables.cells.len() + i]);
                plate[usize::from(cell)] =
                    [0, 1, 2].map(|x| (0..ring.count as usize).map(|k| weight(k) * point(k)[x]).sum());
            }
        }
    }
    plate
}

/// Evaluates a plan by its tables and holds it against refinement; false if it has none.
fn check(soup: &Soup, id: &str, level: u32, what: &str) -> bool {
    let mesh = build(soup);
    let plan = Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, level);
    let Some(tables) = PatchTables::of(&mesh, &plan) else { return false };
    let [start, next, last] =
        [tables.start, tables.start + 1, level].map(|level| refine(&mesh, &plan.to(level), u64::MAX).unwrap());
    let [low, high] = bounds(&last.points);
    let size = (0..3).map(|k| f64::from(high[k] - low[k])).fold(0.0, f64::max);
    let (m, sides) = (1usize << tables.depth, tables.sides as usize);
    assert_eq!(tables.counts, last.counts, "{what}");
    assert_eq!(tables.patches.len() as u64, start.counts.faces, "{what}");
    let mut met = vec![false; last.points.len()];
    for (q, ring) in tables.patches.iter().enumerate() {
        let plate = plate(&tables, ring, &start.points);
        let mut same = |id: u32, cell: usize, once: bool| {
            let (ours, theirs) = (plate[cell], last.points[id as usize]);
            let off = (0..3).map(|k| (ours[k] - f64::from(theirs[k])).abs()).fold(0.0, f64::max);
            assert!(off <= 1e-6 * size, "{what}: vertex {id} of patch {q} is {ours:?}, not {theirs:?}");
            let before = std::mem::replace(&mut met[id as usize], true);
            assert!(!(once && before), "{what}: vertex {id} is owned by two");
        };
        for (i, &[cell, run]) in (0..).zip(&tables.owned) {
            let [first, per] = tables.runs[usize::from(run)];
            let id = first.wrapping_add(i).wrapping_add(per.wrapping_mul(q as u32));
            same(id, cell.into(), true);
        }
        // Corners and middles of sides: the first corner of a child, and its second.
        for side in 0..sides {
            same(corners(&start)[sides * q + side], tables.border[side * m][0] as usize, false);
            let child =
                if sides == 4 { &corners(&next)[4 * (4 * q + side)..] } else { &corners(&next)[3 * (3 * q + side)..] };
            same(child[1], tables.border[side * m + m / 2][0] as usize, false);
        }
    }
    if mesh.topology.boundary_half_edges() == 0 {
        assert_eq!(met.iter().position(|met| !met), None, "{what}");
    }
    true
}

#[test]
fn tables_give_the_points_of_refinement() {
    let mut checked = 0;
    for (name, soup) in gallery() {
        let (triangles, _) = triangulate_soup(&soup);
        for (soup, id) in [(&soup, "catmull-clark"), (&soup, "linear"), (&triangles, "loop"), (&triangles, "linear")] {
            checked += u32::from(check(soup, id, 3, &format!("{name}, {id}")));
        }
    }
    assert!(checked > 100, "{checked}");
    let cube = (shape("cube").unwrap().build)();
    let mouse = triangulate_soup(&(shape("mouse").unwrap().build)()).0;
    for level in 4..=7 {
        assert!(check(&cube, "catmull-clark", level, "cube"));
        assert!(level > 5 || check(&mouse, "loop", level, "mouse"));
    }
}

#[test]
fn what_does_not_go_by_patches_has_no_tables() {
    let mesh = build(&(shape("cube").unwrap().build)());
    let of = |id: &str, level| PatchTables::of(&mesh, &Plan::new(scheme(id).unwrap(), Boundary::EdgeAndCorner, level));
    assert!(of("catmull-clark", 2).is_none());
    assert!(of("doo-sabin", 4).is_none());
    assert!(of("loop", 4).is_none());
    assert!(of("catmull-clark", 3).is_some());
}
