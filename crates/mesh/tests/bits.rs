//! The same bits everywhere: a line for every built-in model, scheme and boundary rule with a hash of all refined
//! points and normals. `cargo xtask test` runs this natively and as WebAssembly and compares the lines, so a sum in
//! another order, a fused multiplication or a system's own `sin` shows up. The hash is FNV-1a, 64 bits, over the
//! little-endian bits of the coordinates in their canonical order.

use limn_mesh::{Boundary, Mesh, Plan, SCHEMES, SHAPES, Weld, refine, triangulate_soup};
use std::sync::Arc;

fn fnv<'a>(values: impl Iterator<Item = &'a f32>) -> u64 {
    let bytes = values.flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn hashes_of_refined_models() {
    let mut seen = std::collections::BTreeSet::new();
    for shape in SHAPES {
        let soup = (shape.build)();
        let (triangles, _) = triangulate_soup(&soup);
        for entry in SCHEMES {
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                let plan = Plan::new(entry, boundary, 3);
                // Schemes on triangles get the triangulated model, as they do on the page.
                let refined = [&soup, &triangles].into_iter().find_map(|soup| {
                    let (mesh, _) = Mesh::build(soup, Weld::Off).ok()?;
                    refine(&Arc::new(mesh), &plan, u64::MAX).ok()
                });
                let refined =
                    refined.unwrap_or_else(|| panic!("{} does not refine under {}", shape.name, entry.info.id));
                assert!(refined.points.iter().flatten().all(|x| x.is_finite()), "{} {}", shape.name, entry.info.id);
                let points = fnv(refined.points.iter().flatten());
                let normals = fnv(refined.normals().iter().flatten());
                println!("bits {} {} {boundary:?} {points:016x} {normals:016x}", shape.name, entry.info.id);
                seen.insert(points);
            }
        }
    }
    // Every model and scheme has a picture of its own (closed models have the same one under both boundary rules), but for
    // schemes that are another one on quads or triangles alone, or without knots.
    let alike = SCHEMES.iter().filter(|e| ["quad-triangle", "nurss"].contains(&e.info.id)).count();
    assert!(seen.len() >= SHAPES.len() * (SCHEMES.len() - alike), "only {} different results", seen.len());
}
