//! Quads and triangles in one mesh against the plainest program that can be written from the papers, and against the schemes
//! that the rule has to become where all faces are alike.

mod common;

use common::polygons::{Point, Polygons, compare, mean, mix, polygons};
use common::{build, gallery};
use limn_mesh::refine::{evaluate, refine};
use limn_mesh::scheme::Tags;
use limn_mesh::sink::{Cursor, Source};
use limn_mesh::split::Level;
use limn_mesh::{Boundary, Connectivity, FaceShape, Plan, RefineError, Run, Soup, Split, scheme};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};

/// Stam and Loop 2003 in the form of Schaefer and Warren 2004: a linear split, then every vertex goes to the mean of its
/// faces' centroids, weighted by the angles that the faces would have (of a triangle the vertex counts 1/4, the others 3/8).
fn quad_triangle(p: &Polygons, boundary: Boundary) -> Polygons {
    let a = p.around();
    let mut out = Polygons { points: p.points.clone(), faces: Vec::new() };
    let mut edge = BTreeMap::new();
    for (&(v, w), faces) in &a.edges {
        edge.insert((v, w), out.points.len());
        out.points.push(mean([&p.points[v], &p.points[w]]));
        assert!(faces.len() <= 2);
    }
    let mut centre = BTreeMap::new();
    for (f, face) in p.faces.iter().enumerate() {
        let n = face.len();
        let e = |i: usize| edge[&(face[i % n].min(face[(i + 1) % n]), face[i % n].max(face[(i + 1) % n]))];
        if n == 3 {
            out.faces.push((0..3).map(e).collect());
        } else {
            centre.insert(f, out.points.len());
            out.points.push(mean(face.iter().map(|&v| &p.points[v])));
        }
        for (i, &v) in face.iter().enumerate() {
            let mut child = vec![v, e(i)];
            child.extend(centre.get(&f));
            child.push(e(i + n - 1));
            out.faces.push(child);
        }
    }
    let around = out.around();
    let linear = out.points.clone();
    for (v, point) in out.points.iter_mut().enumerate() {
        if let [x, y] = around.rim[v][..] {
            // Cubic B-spline of the boundary, by averages of averages.
            let corner = boundary == Boundary::EdgeAndCorner && around.faces[v].len() == 1;
            if v < p.points.len() && !corner {
                let mids = [x, y].map(|w| mean([&linear[v], &linear[w]]));
                *point = mean(&mids);
            }
            continue;
        }
        let (mut sum, mut angles, mut quads, mut triangles) = ([0.0; 3], 0.0, 0.0, 0.0);
        for &f in &around.faces[v] {
            let others: Vec<&Point> = out.faces[f].iter().filter(|&&w| w != v).map(|&w| &linear[w]).collect();
            let (middle, angle) = if others.len() == 2 {
                triangles += 1.0;
                (mix(&[(0.25, linear[v]), (0.75, mean(others))]), FRAC_PI_3)
            } else {
                quads += 1.0;
                (mix(&[(0.25, linear[v]), (0.75, mean(others))]), FRAC_PI_2)
            };
            sum = mix(&[(1.0, sum), (angle, middle)]);
            angles += angle;
        }
        let w = if quads == 0.0 {
            let c = 3.0 / 8.0 + (TAU / triangles).cos() / 4.0;
            5.0 / 3.0 - 8.0 / 3.0 * c * c
        } else {
            12.0 / (3.0 * quads + 2.0 * triangles)
        };
        *point = mix(&[(1.0 - w, linear[v]), (w / angles, sum)]);
    }
    // Beside faces of more than four corners Catmull and Clark have edge points of their own.
    for (&(v, w), faces) in a.edges.iter().filter(|(_, f)| f.len() == 2 && f.iter().any(|&f| p.faces[f].len() > 4)) {
        let half = |f: &usize| match centre.get(f) {
            Some(&c) => mean([&p.points[v], &p.points[w], &linear[c], &linear[c]]),
            None => {
                let c = p.faces[*f].iter().find(|&&x| x != v && x != w).unwrap();
                mix(&[(0.375, p.points[v]), (0.375, p.points[w]), (0.25, p.points[*c])])
            }
        };
        out.points[edge[&(v, w)]] = mean(&[half(&faces[0]), half(&faces[1])]);
    }
    out
}

/// Every `nth` face of a model cut into triangles.
fn partly_cut(soup: &Soup, nth: usize) -> Soup {
    let mut out = Soup { positions: soup.positions.clone(), ..Soup::default() };
    for f in 0..soup.face_count() {
        let face = soup.face(f);
        if f % nth == 0 {
            (1..face.len() - 1).for_each(|i| out.push_face(&[face[0], face[i], face[i + 1]]));
        } else {
            out.push_face(face);
        }
    }
    out
}

#[test]
fn quad_triangle_equals_its_papers() {
    let mut mixed = 0;
    for (name, whole) in gallery() {
        for soup in [whole.clone(), partly_cut(&whole, 2), partly_cut(&whole, 3)] {
            let mesh = build(&soup);
            if mesh.positions.len() != soup.positions.len() || soup.face_count() > 400 {
                continue; // split vertices: tests/conformance.rs
            }
            mixed += u32::from(mesh.face_shape() == FaceShape::Polygons);
            for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                compare(&name, &mesh, "quad-triangle", boundary, polygons(&soup), |p| quad_triangle(p, boundary));
            }
        }
    }
    assert!(mixed > 20, "{mixed}");
}

/// The mixed split and its rules on faces that are all alike, which a plan gives to the other schemes: the same points under
/// the same numbers.
#[test]
fn the_rule_is_loop_on_triangles_and_catmull_clark_on_other_faces() {
    let mut seen = [0, 0];
    for (name, soup) in gallery() {
        let mesh = build(&soup);
        let t = &mesh.topology;
        let triangles = mesh.is_triangles();
        if !triangles && (0..t.faces()).any(|f| t.face_half_edges(f).len() == 3) {
            continue;
        }
        let positions: Vec<Point> = mesh.positions.iter().map(|p| p.map(f64::from)).collect();
        for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
            let other = scheme(if triangles { "loop" } else { "catmull-clark" }).unwrap();
            let expected = evaluate(&mesh, &Plan::new(other, boundary, 1), &positions, |_| ()).unwrap();
            let plan = Plan::new(scheme("quad-triangle").unwrap(), boundary, 1);
            let pointed: Vec<u32> = (0..t.faces()).filter(|_| !triangles).collect();
            let tags = Tags { sharp: &mesh.sharp, lone: &pointed, ..Tags::new(plan.rules, [0.0; 3]) };
            let mut new = vec![[f64::NAN; 3]; expected.len()];
            let mut take = |child: u32, row: &[(Source, f64)], _| {
                let at = |s: &Source| match *s {
                    Source::Vertex(v) => positions[v as usize],
                    Source::Child(_) => panic!("rules of the mixed split read vertices"),
                };
                new[child as usize] = mix(&row.iter().map(|(s, w)| (*w, at(s))).collect::<Vec<_>>());
            };
            let all = (&Level::Base(t), Split::Mixed, tags);
            assert!(plan.scheme.rows(all, &mut take, &mut Cursor::default(), &mut { usize::MAX }));
            for (p, q) in new.iter().zip(&expected) {
                assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-12), "{name}: {p:?} and {q:?}");
            }
        }
        seen[usize::from(triangles)] += 1;
    }
    assert!(seen[0] > 10 && seen[1] > 10, "{seen:?}");
}

/// Texture coordinates follow faces of both kinds: a face's are the linear image of its corners when it stands alone.
#[test]
fn texture_coordinates_follow() {
    let mut soup = partly_cut(&(limn_mesh::shape("torus").unwrap().build)(), 2);
    // One square of texture a face: every edge is a seam.
    soup.uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    soup.uv_corners = (0..soup.face_count()).flat_map(|f| 0..soup.face(f).len() as u32).collect();
    let mesh = build(&soup);
    let refined =
        refine(&mesh, &Plan::new(scheme("quad-triangle").unwrap(), Boundary::default(), 2), u64::MAX).unwrap();
    let uv = refined.uv.as_ref().unwrap();
    assert_eq!(uv.corners.len(), refined.faces.corners().len());
    let mut at = 0;
    let mut area = 0.0;
    for f in 0..refined.faces.count() {
        let n = refined.faces.face(f).len();
        let corner = |i: usize| uv.values[uv.corners[at + i % n] as usize].map(f64::from);
        let twice: f64 = (0..n).map(|i| corner(i)[0] * corner(i + 1)[1] - corner(i)[1] * corner(i + 1)[0]).sum();
        assert!(twice > 0.0, "face {f} is turned over");
        area += twice / 2.0;
        at += n;
    }
    let faces = (0..soup.face_count()).map(|f| if soup.face(f).len() == 3 { 0.5 } else { 1.0 }).sum::<f64>();
    assert!((area - faces).abs() < 1e-3 * faces, "{area} of {faces}");
}

#[test]
fn at_once_after_a_dual_scheme_it_is_refused_with_a_way_out() {
    let mesh = build(&(limn_mesh::shape("cube").unwrap().build)());
    let run = |id, from| Run { from, scheme: scheme(id).unwrap(), params: Default::default() };
    let mut plan = Plan::new(scheme("doo-sabin").unwrap(), Boundary::default(), 3);
    plan.later = vec![run("quad-triangle", 1)];
    let error = refine(&mesh, &plan, u64::MAX).unwrap_err();
    assert_eq!(error, RefineError::Uncounted { scheme: "Quad/Triangle", level: 1 });
    plan.later = vec![run("linear", 1), run("quad-triangle", 2)];
    assert!(refine(&mesh, &plan, u64::MAX).is_ok());
}
