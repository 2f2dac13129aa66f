//! What lies under the pointer: a point for the double-click pivot, and the cage's edge, vertex or face for a mark.
//!
//! Every face is tried, as a fan of triangles around its first corner (Möller and Trumbore 1997, "Fast, minimum storage
//! ray-triangle intersection"). That costs about 5 ns a triangle and needs no acceleration structure to be built or kept:
//! some 15 ms for three million triangles, once a double click. Limit: a fan bends concave polygons, which moves a pivot by
//! less than the polygon.

use glam::Vec3;
use limn_document::camera::Ray;
use limn_mesh::{Connectivity, Mesh, Refined};
use std::ops::Range;

/// The nearest point of the surface on the ray, both sides of a face counting; none if it passes by.
pub fn pick(refined: &Refined, ray: &Ray, visible: impl Fn(u32) -> bool) -> Option<Vec3> {
    let mut nearest = f32::INFINITY;
    let at = |v: u32| refined.points.get(v as usize).map_or(Vec3::NAN, |p| Vec3::from(*p));
    for f in 0..refined.faces.count() {
        let [first, rest @ ..] = refined.faces.face(f) else { continue };
        let a = at(*first);
        for pair in rest.windows(2) {
            let &[b, c] = pair else { continue };
            if let Some(t) = hit(ray, a, at(b), at(c)).filter(|t| *t < nearest)
                && visible(f as u32)
            {
                nearest = t;
            }
        }
    }
    nearest.is_finite().then(|| ray.origin + ray.direction * nearest)
}

/// The command that marks what a ray meets of the model's polygons: the nearest edge (`crease`, `knot`) or corner (`corner`)
/// of the first face that it meets, or that face (`hole`). `amount` is the command's last argument. None if it meets none.
pub fn mark(mesh: &Mesh, ray: &Ray, what: &str, amount: &str) -> Option<String> {
    let t = &mesh.topology;
    let at = |h: u32| mesh.positions.get(t.origin(h) as usize).map_or(Vec3::NAN, |p| Vec3::from(*p));
    let mut nearest = (f32::INFINITY, 0);
    for f in 0..t.faces() {
        let Range { start, end } = t.face_half_edges(f);
        for h in start + 1..end.saturating_sub(1) {
            if let Some(far) = hit(ray, at(start), at(h), at(h + 1)).filter(|far| *far < nearest.0) {
                nearest = (far, f);
            }
        }
    }
    let (far, face) = nearest;
    if !far.is_finite() {
        return None;
    }
    let point = ray.origin + ray.direction * far;
    let number = |h: u32| mesh.vertex_source.get(t.origin(h) as usize);
    let best =
        |distance: &dyn Fn(u32) -> f32| t.face_half_edges(face).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let edge = || {
        best(&|h| {
            let (a, b) = (at(h), at(t.next(h)));
            let along = (b - a) * ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            (point - a - along).length_squared()
        })
    };
    match what {
        "crease" | "knot" => {
            let h = edge()?;
            let sign = if what == "knot" { '=' } else { '-' };
            Some(format!("{what} {}{sign}{} {amount}", number(h)?, number(t.next(h))?))
        }
        "corner" => Some(format!("corner {} {amount}", number(best(&|h| (point - at(h)).length_squared())?)?)),
        "hole" => Some(format!("hole {}", mesh.face_source.get(face as usize)?)),
        _ => None,
    }
}

/// How far along the ray the triangle is; none if it is missed or behind.
fn hit(ray: &Ray, a: Vec3, b: Vec3, c: Vec3) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let inverse = 1.0 / determinant;
    let s = ray.origin - a;
    let u = s.dot(p) * inverse;
    let q = s.cross(ab);
    let v = ray.direction.dot(q) * inverse;
    let t = ac.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use limn_mesh::{Boundary, Plan, Weld, refine, scheme, shapes};
    use std::sync::Arc;

    #[test]
    fn marks_are_of_what_is_nearest() {
        let mut document = limn_document::Document::new(1 << 30);
        document.run("open builtin:cube").unwrap();
        // A scheme of triangles has edges that the model has not.
        document.run("scheme loop").unwrap();
        let mesh = document.polygons().unwrap().clone();
        let top = mesh.stats().bounds[1][2];
        let marked = |x: f32, y: f32, what: &str| {
            let ray = Ray { origin: Vec3::new(x * top, y * top, 9.0), direction: Vec3::NEG_Z };
            mark(&mesh, &ray, what, "2.5")
        };
        let at = |v: &str| Vec3::from(mesh.positions[v.parse::<usize>().unwrap()]) / top;
        for (what, sign) in [("crease", '-'), ("knot", '=')] {
            let command = marked(0.9, 0.1, what).unwrap();
            let ends = command.split(' ').nth(1).unwrap().split_once(sign).unwrap();
            let [a, b] = [at(ends.0), at(ends.1)];
            assert!((a + b - Vec3::new(2.0, 0.0, 2.0)).length() < 1e-5, "{command}: the edge at the right");
            document.run(&command).unwrap();
        }
        let command = marked(-0.6, 0.7, "corner").unwrap();
        assert_eq!(at(command.split(' ').nth(1).unwrap()), Vec3::new(-1.0, 1.0, 1.0), "{command}");
        document.run(&command).unwrap();
        document.run(&marked(0.1, 0.1, "hole").unwrap()).unwrap();
        assert!(document.polygons().unwrap().holes.iter().any(|h| *h));
        assert_eq!(marked(1.1, 0.0, "crease"), None);
        assert_eq!(marked(0.1, 0.0, "dent"), None);
    }

    #[test]
    fn the_nearest_face_is_hit() {
        let cube = (shapes::shape("cube").unwrap().build)();
        let (mesh, _) = Mesh::build(&cube, Weld::Off).unwrap();
        let top = mesh.stats().bounds[1][2];
        let plan = Plan::new(scheme("linear").unwrap(), Boundary::default(), 1);
        let refined = refine(&Arc::new(mesh), &plan, 1 << 20).unwrap();
        let ray = Ray { origin: Vec3::new(0.1, 0.2, 9.0), direction: Vec3::NEG_Z };
        let found = pick(&refined, &ray, |_| true).unwrap();
        assert!((found - Vec3::new(0.1, 0.2, top)).length() < 1e-5, "{found}");
        // With the nearest face hidden the far side is hit, from within.
        let far = pick(&refined, &ray, |f| {
            refined.faces.face(f as usize).iter().any(|&v| refined.points[v as usize][2] < top)
        });
        assert!((far.unwrap() - Vec3::new(0.1, 0.2, -top)).length() < 1e-5, "{far:?}");
        let away = Ray { direction: Vec3::Z, ..ray };
        assert_eq!(pick(&refined, &away, |_| true), None);
    }
}
