//! Stencils against the masks that the papers print.

use limn_mesh::stencil::{Stencil, boundary, fraction, stencils};
use limn_mesh::{Params, SCHEMES, scheme};

fn of(id: &str, valence: u32) -> Vec<Stencil> {
    stencils(scheme(id).unwrap(), Params::default(), valence)
}

/// Weights in falling order, as they are written.
fn written(list: &[Stencil], title: &str) -> String {
    let found = list.iter().find(|s| s.title == title);
    let stencil = found.unwrap_or_else(|| panic!("{title} of {:?}", list.iter().map(|s| &s.title).collect::<Vec<_>>()));
    let mut weights: Vec<f64> = stencil.weights.iter().map(|w| w.1).collect();
    weights.sort_by(|a, b| b.total_cmp(a));
    weights.into_iter().map(fraction).collect::<Vec<_>>().join(" ")
}

fn titles(list: &[Stencil]) -> Vec<&str> {
    list.iter().map(|s| s.title.as_str()).collect()
}

#[test]
fn loop_s_masks() {
    let list = of("loop", 3);
    assert_eq!(
        titles(&list),
        ["Vertex point", "Edge point", "Vertex point, valence 3", "Vertex point, boundary", "Edge point, boundary"]
    );
    assert_eq!(written(&list, "Vertex point"), "5/8 1/16 1/16 1/16 1/16 1/16 1/16");
    assert_eq!(written(&list, "Edge point"), "3/8 3/8 1/8 1/8");
    assert_eq!(written(&list, "Vertex point, valence 3"), "7/16 3/16 3/16 3/16");
    assert_eq!(written(&list, "Vertex point, boundary"), "3/4 1/8 1/8");
    assert_eq!(written(&list, "Edge point, boundary"), "1/2 1/2");
    // The target of a vertex rule is the vertex; the heaviest point is there.
    let vertex = &list[0];
    let heavy = vertex.weights.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    assert_eq!(vertex.points[heavy.0 as usize], vertex.target.map(|x| x.round()));
    assert_eq!((vertex.points.len(), vertex.faces.len()), (7, 6), "one ring");
    // Valence 5 is no fraction: 1/5 (5/8 - (3/8 + cos(72°)/4)²) = 0.0840.
    assert!(written(&of("loop", 5), "Vertex point, valence 5").ends_with("0.084 0.084 0.084 0.084 0.084"));
}

#[test]
fn catmull_clark_s_masks() {
    let list = of("catmull-clark", 5);
    assert_eq!(written(&list, "Face point"), "1/4 1/4 1/4 1/4");
    assert_eq!(written(&list, "Edge point"), "3/8 3/8 1/16 1/16 1/16 1/16");
    assert_eq!(written(&list, "Vertex point"), "9/16 3/32 3/32 3/32 3/32 1/64 1/64 1/64 1/64");
    // 1 - 7/(4n), 3/(2n²), 1/(4n²).
    let five = written(&list, "Vertex point, valence 5");
    assert_eq!(five, "13/20 3/50 3/50 3/50 3/50 3/50 1/100 1/100 1/100 1/100 1/100");
    assert_eq!(written(&list, "Vertex point, boundary"), "3/4 1/8 1/8");
    assert_eq!(written(&list, "Edge point, boundary"), "1/2 1/2");
    assert!(!titles(&of("catmull-clark", 4)).contains(&"Vertex point, valence 4"), "four is regular");
}

#[test]
fn doo_sabin_s_masks() {
    let list = of("doo-sabin", 3);
    assert_eq!(
        titles(&list),
        ["Corner of a face", "Corner of a face, face of 3 corners", "Corner of a face, boundary"]
    );
    assert_eq!(written(&list, "Corner of a face"), "9/16 3/16 3/16 1/16");
    // 1/4 + 5/(4k) and (3 + 2 cos(2 pi j / k)) / (4k).
    assert_eq!(written(&list, "Corner of a face, face of 3 corners"), "2/3 1/6 1/6");
    assert_eq!(written(&list, "Corner of a face, boundary"), "3/4 1/4");
    assert_eq!(written(&of("doo-sabin", 6), "Corner of a face, face of 6 corners"), "11/24 1/6 1/6 1/12 1/12 1/24");
    assert_eq!(written(&of("doo-sabin-midpoint", 3), "Corner of a face, face of 3 corners"), "7/12 5/24 5/24");
}

#[test]
fn butterfly_follows_its_parameter() {
    let list = of("butterfly", 6);
    assert_eq!(written(&list, "Edge point"), "1/2 1/2 1/8 1/8 −1/16 −1/16 −1/16 −1/16");
    assert_eq!(written(&list, "Vertex point"), "1");
    let entry = scheme("butterfly").unwrap();
    let mut params = Params::default();
    assert!(params.set(&entry.info, 0, 0.0));
    assert_eq!(written(&stencils(entry, params, 6), "Edge point"), "1/2 1/2");
}

#[test]
fn every_scheme_has_rules_and_their_weights_add_up() {
    for entry in SCHEMES {
        for valence in 0..10 {
            let list = stencils(entry, Params::default(), valence);
            assert!(!list.is_empty(), "{}", entry.info.id);
            for s in &list {
                let what = format!("{} {valence} {}", entry.info.id, s.title);
                let sum: f64 = s.weights.iter().map(|w| w.1).sum();
                assert!((sum - 1.0).abs() < 1e-9, "{what}: {sum}");
                assert!(s.faces.iter().flatten().all(|v| (*v as usize) < s.points.len()), "{what}");
                let at = s.weights.iter().fold([0.0; 2], |at, &(v, w)| {
                    let p = s.points[v as usize];
                    [at[0] + w * p[0], at[1] + w * p[1]]
                });
                assert!((at[0] - s.target[0]).hypot(at[1] - s.target[1]) < 1e-9, "{what}");
            }
        }
    }
}

#[test]
fn rims_are_told_from_their_weights() {
    let of = |id: &str| boundary(scheme(id).unwrap(), Params::default());
    assert_eq!(of("loop"), "a cubic B-spline of the rim's vertices alone");
    assert_eq!(of("catmull-clark"), of("loop"));
    assert_eq!(of("doo-sabin"), "Chaikin's curve, a quadratic B-spline of the rim's vertices alone");
    assert_eq!(of("butterfly"), "the four-point curve, which passes through the rim's vertices");
    assert_eq!(of("linear"), "kept: straight edges stay straight");
}

#[test]
fn fractions() {
    for (value, text) in [
        (0.375, "3/8"),
        (-0.0625, "−1/16"),
        (1.0, "1"),
        (0.0, "0"),
        (81.0 / 256.0, "81/256"),
        (1.0 / 3.0, "1/3"),
        (0.084_032_4, "0.084"),
    ] {
        assert_eq!(fraction(value), text);
    }
}
