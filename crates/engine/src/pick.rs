//! What lies under the pointer, for the double-click pivot.
//!
//! Every face is tried, as a fan of triangles around its first corner (Möller and Trumbore 1997, "Fast, minimum storage
//! ray-triangle intersection"). That costs about 5 ns a triangle and needs no acceleration structure to be built or kept:
//! some 15 ms for three million triangles, once a double click. Limit: a fan bends concave polygons, which moves a pivot by
//! less than the polygon.

use glam::Vec3;
use limn_document::camera::Ray;
use limn_mesh::Refined;

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
    use limn_mesh::{Boundary, Mesh, Plan, Weld, refine, scheme, shapes};
    use std::sync::Arc;

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
