//! The calls that the page's engine makes, in its order: the same bits as without the module.

use std::sync::Arc;

use limn_kernel::{Kernel, Run};
use limn_mesh::{Accepts, Boundary, Mesh, Plan, Refined, SCHEMES, SHAPES, Weld, refine, triangulate_soup};

/// The level, as the engine takes it.
fn taken(run: &mut Run, mesh: Arc<Mesh>) -> Refined {
    let small = run.finish();
    let level = run.level().unwrap();
    Refined::unpack(&small, mesh, level).unwrap()
}

#[test]
fn every_shape_by_every_scheme_in_slices() {
    let mut kernel = Kernel::new();
    for shape in SHAPES {
        for triangles in [false, true] {
            let soup = (shape.build)();
            let soup = if triangles { triangulate_soup(&soup).0 } else { soup };
            let mesh = Arc::new(Mesh::build(&soup, Weld::Off).unwrap().0);
            kernel.mesh(&mesh.pack()).unwrap();
            for scheme in SCHEMES
                .iter()
                .filter(|s| triangles || !matches!(s.info.accepts, Accepts::Triangles | Accepts::TrianglesThenQuads))
            {
                let plan = Plan::new(scheme, Boundary::default(), 2);
                let mut run = kernel.start(&plan.pack(), 1e9).unwrap();
                let mut last = run.progress();
                while !run.step(1000) {
                    assert!((last..=1.0).contains(&run.progress()), "progress does not go back");
                    last = run.progress();
                }
                let found = taken(&mut run, mesh.clone());
                let wanted = refine(&mesh, &plan, 1 << 30).unwrap();
                assert_eq!(found.points, wanted.points, "{} by {}", shape.name, scheme.info.id);
                assert_eq!(found.faces, wanted.faces, "{} by {}", shape.name, scheme.info.id);
                assert_eq!((found.counts, found.kinds), (wanted.counts, wanted.kinds));
            }
        }
    }
}

#[test]
fn what_cannot_be_is_one_sentence() {
    let mut kernel = Kernel::new();
    let plan = |id, level| Plan::new(limn_mesh::scheme(id).unwrap(), Boundary::default(), level).pack();
    assert!(kernel.start(&plan("doo-sabin", 1), 1e9).unwrap_err().contains("no mesh"));
    assert!(kernel.mesh(b"nothing").unwrap_err().contains("damaged"));
    let cube = Mesh::build(&(limn_mesh::shape("cube").unwrap().build)(), Weld::Off).unwrap().0;
    kernel.mesh(&cube.pack()).unwrap();
    assert!(kernel.start(b"", 1e9).unwrap_err().contains("damaged"));
    assert!(kernel.start(&plan("butterfly", 1), 1e9).unwrap_err().contains("triangles only"));
    assert!(kernel.start(&plan("doo-sabin", 9), 1e6).unwrap_err().contains("choose level"));
    // A new mesh does not touch a run that is under way.
    let mut run = kernel.start(&plan("doo-sabin", 1), 1e9).unwrap();
    assert!(kernel.mesh(b"").is_err());
    assert_eq!(taken(&mut run, Arc::new(cube)).counts.faces, 26);
}
