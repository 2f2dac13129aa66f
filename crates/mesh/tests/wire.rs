//! What passes between the page's two kernels comes back as it was, and damage never panics.

mod common;

use common::{build, gallery};
use limn_mesh::pack::Damaged;
use limn_mesh::scheme::{Decay, FaceVarying, Rules, TriangleRule};
use limn_mesh::{
    Accepts, Boundary, Fairing, LimitRule, Marks, Mesh, Params, Plan, Refined, Run, SCHEMES, Soup, refine, scheme,
    triangulate_soup,
};
use std::sync::Arc;

/// The soup with marks, a colour a position, and texture coordinates with a seam around every third face.
fn dressed(mut soup: Soup) -> Soup {
    let count = soup.positions.len();
    soup.colors = (0..count).map(|i| [i as f32, 0.5, 1.0 / (1.0 + i as f32), 1.0]).collect();
    soup.uvs = (0..2 * count).map(|i| [i as f32 * 0.25, i as f32 * 0.125]).collect();
    soup.uv_corners = (0..soup.face_count())
        .flat_map(|f| soup.face(f).iter().map(move |&v| if f % 3 == 0 { v + count as u32 } else { v }))
        .collect();
    let [a, b, c] = [soup.face(0)[0], soup.face(0)[1], soup.face(0)[2]];
    soup.marks = Marks {
        creases: vec![([a, b], 2.5), ([b, c], 12.0)],
        corners: vec![(c, 1.5)],
        holes: vec![soup.face_count() as u32 - 1],
        knots: vec![([b, a], 0.5)],
    };
    soup
}

fn same(a: &Refined, b: &Refined, what: &str) {
    assert_eq!(
        (a.level, a.counts, a.vertex_parents, a.parent_ranges),
        (b.level, b.counts, b.vertex_parents, b.parent_ranges),
        "{what}"
    );
    assert_eq!(a.points, b.points, "{what}");
    assert_eq!(a.faces, b.faces, "{what}");
    assert_eq!(a.uv, b.uv, "{what}");
    assert_eq!(a.colors, b.colors, "{what}");
    assert_eq!(a.kinds, b.kinds, "{what}");
    assert_eq!(a.known_normals, b.known_normals, "{what}");
    let sources = |r: &Refined| (0..r.faces.count() as u32).map(|f| r.face_source(f)).collect::<Vec<_>>();
    assert_eq!(sources(a), sources(b), "{what}");
    assert_eq!(a.normals(), b.normals(), "{what}");
}

#[test]
fn meshes_plans_and_levels_come_back() {
    for (name, soup) in gallery() {
        for (dress, triangles) in [(false, false), (true, false), (false, true), (true, true)] {
            let soup = if triangles { triangulate_soup(&soup).0 } else { soup.clone() };
            let mesh = build(&if dress { dressed(soup) } else { soup });
            let copy = Mesh::unpack(&mesh.pack()).unwrap();
            assert_eq!(copy, *mesh, "{name}");
            let copy = Arc::new(copy);
            for scheme in SCHEMES
                .iter()
                .filter(|s| triangles || !matches!(s.info.accepts, Accepts::Triangles | Accepts::TrianglesThenQuads))
            {
                for (level, boundary) in
                    [(0, Boundary::EdgeOnly), (1, Boundary::EdgeAndCorner), (2, Boundary::EdgeOnly)]
                {
                    // An analysis of a vertex takes longer than its refinement.
                    let limit = level == 1 && scheme.limit != LimitRule::Analysis;
                    let plan = Plan { limit, ..Plan::new(scheme, boundary, level) };
                    let sent = Plan::unpack(&plan.pack()).unwrap();
                    assert_eq!(sent, plan);
                    let what = format!("{name}, {}, level {level}", scheme.info.id);
                    let there = refine(&copy, &sent, 1 << 30).unwrap();
                    let back = Refined::unpack(&there.pack(), mesh.clone(), &there).unwrap();
                    same(&back, &there, &what);
                    assert!(Arc::ptr_eq(back.mesh(), &mesh));
                    same(&back, &refine(&mesh, &plan, 1 << 30).unwrap(), &what);
                }
            }
        }
    }
}

#[test]
fn parameters_are_sent_as_they_were_set() {
    for scheme in SCHEMES {
        for (at, param) in scheme.info.params.iter().enumerate() {
            let mut plan = Plan::new(scheme, Boundary::default(), 3);
            for share in [0.0, 0.3, 1.0] {
                let value = match param.domain {
                    limn_mesh::Domain::Number { low, high, .. } => low + share * (high - low),
                    limn_mesh::Domain::Whole { low, high, .. } => {
                        (f64::from(low) + share * f64::from(high - low)).round()
                    }
                    limn_mesh::Domain::Choice(words) => (share * (words.len() - 1) as f64).round(),
                };
                assert!(plan.params.set(&scheme.info, at, value), "{} {}", scheme.info.id, param.key);
                assert_eq!(Plan::unpack(&plan.pack()).unwrap(), plan, "{} {}", scheme.info.id, param.key);
            }
        }
    }
}

#[test]
fn everything_that_a_plan_holds_is_sent() {
    let run = |from, id| Run { from, scheme: scheme(id).unwrap(), params: Params::default() };
    let mut plan = Plan::new(scheme("sqrt3").unwrap(), Boundary::EdgeOnly, 4);
    plan.later = vec![run(1, "loop"), run(3, "doo-sabin")];
    let weights = &plan.later[0].scheme.info;
    assert!(plan.later[0].params.set(weights, 0, 1.0));
    plan.fairings = vec![Fairing { at: 0, iterations: 3 }, Fairing { at: 4, iterations: 1 }];
    for face_varying in [
        FaceVarying::None,
        FaceVarying::CornersOnly,
        FaceVarying::CornersPlus1,
        FaceVarying::CornersPlus2,
        FaceVarying::Boundaries,
        FaceVarying::All,
    ] {
        plan.rules = Rules { face_varying, ..plan.rules };
        assert_eq!(Plan::unpack(&plan.pack()).unwrap(), plan);
    }
    plan.rules.decay = Decay::Chaikin;
    assert_eq!(Plan::unpack(&plan.pack()).unwrap(), plan);
    plan.rules.triangle = TriangleRule::Smooth;
    assert_eq!(Plan::unpack(&plan.pack()).unwrap(), plan);
    plan.limit = true;
    assert_eq!(Plan::unpack(&plan.pack()).unwrap(), plan);
}

#[test]
fn what_the_first_module_can_make() {
    let soup = triangulate_soup(&common::prism(5)).0;
    let (plain, creased) = (build(&soup), build(&dressed(soup)));
    let mut colored = (*creased).clone();
    (colored.edge_sharpness, colored.vertex_sharpness, colored.uv) = Default::default();
    let mut textured = (*creased).clone();
    (textured.edge_sharpness, textured.vertex_sharpness, textured.colors) = Default::default();
    let mut holed = colored.clone();
    holed.colors.clear();
    assert!(holed.holes.contains(&true));
    let mut knotted = holed.clone();
    knotted.holes.clear();
    let mut whole = (*creased).clone();
    whole.holes.clear();
    for scheme in SCHEMES {
        let plan = Plan::new(scheme, Boundary::default(), 2);
        let common = ["catmull-clark", "loop"].contains(&scheme.info.id);
        assert_eq!(plan.is_common(&plain), common, "{}", scheme.info.id);
        assert_eq!(plan.is_common(&knotted), common, "{}: knots are no matter", scheme.info.id);
        for mesh in [&*creased, &colored, &textured, &holed, &whole] {
            assert!(!plan.is_common(mesh), "{}", scheme.info.id);
        }
        assert!(plan.to(0).is_common(&whole), "level 0 is the mesh itself");
        assert!(!plan.to(0).is_common(&holed), "but for its holes");
        assert!(!Plan::new(scheme, Boundary::None, 0).is_common(&plain));
        let fair = |at| Plan { fairings: vec![Fairing { at, iterations: 1 }], ..plan.clone() };
        assert!(!fair(2).is_common(&plain) && !fair(0).to(0).is_common(&plain));
        assert_eq!(fair(3).is_common(&plain), common, "what comes after the last level is not made");
        let moves = scheme.limit != LimitRule::Itself;
        assert_eq!(Plan { limit: true, ..plan.clone() }.is_common(&plain), common && !moves);
        assert!(!plan.to(3).is_common(&plain), "deep levels are made of patches");
        let later = vec![Run { from: 1, scheme, params: Params::default() }];
        assert!(!Plan { later, ..plan.clone() }.is_common(&plain));
        assert!(plan.is_here(&creased), "tests have everything");
    }
}

#[test]
fn damage_never_panics() {
    let mesh = build(&dressed(common::prism(3)));
    let plan = Plan::new(&SCHEMES[0], Boundary::default(), 1);
    let refined = refine(&mesh, &plan, 1 << 20).unwrap();
    let unpack = |bytes: &[u8]| {
        [
            Mesh::unpack(bytes).is_err(),
            Plan::unpack(bytes).is_err(),
            Refined::unpack(bytes, mesh.clone(), &refined).is_err(),
        ]
    };
    for (kind, whole) in [mesh.pack(), plan.pack(), refined.pack()].iter().enumerate() {
        assert!(!unpack(whole)[kind]);
        for cut in 0..whole.len() {
            assert!(unpack(&whole[..cut])[kind], "cut at {cut}");
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x81;
            unpack(&bytes);
        }
    }
    assert_eq!(Plan::unpack(&[]), Err(Damaged));
}
