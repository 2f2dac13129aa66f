//! An axis-aligned box, which is all that the camera needs to know of a model.

use glam::Vec3;

/// An axis-aligned box. Always finite, with `min <= max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lowest coordinates.
    pub min: Vec3,
    /// The highest coordinates.
    pub max: Vec3,
}

impl Default for Bounds {
    /// The box from -1 to 1, which an empty document shows.
    fn default() -> Self {
        Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }
    }
}

impl Bounds {
    /// The box of the points, one pass. Points with a coordinate that is not finite are left out; `None` if none is left.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f32; 3]>) -> Option<Bounds> {
        let mut found: Option<Bounds> = None;
        for point in points {
            let p = Vec3::from(*point);
            if p.is_finite() {
                found = Some(match found {
                    None => Bounds { min: p, max: p },
                    Some(b) => Bounds { min: b.min.min(p), max: b.max.max(p) },
                });
            }
        }
        found
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        // Halved before the sum, so that coordinates near f32::MAX do not overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// The length of the space diagonal, 0 for a single point.
    pub fn diagonal(&self) -> f32 {
        // In f64, where the squares of any f32 fit.
        ((self.max.as_dvec3() - self.min.as_dvec3()).length() as f32).min(f32::MAX)
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        let (a, b) = (self.min, self.max);
        [
            a,
            Vec3::new(b.x, a.y, a.z),
            Vec3::new(a.x, b.y, a.z),
            Vec3::new(b.x, b.y, a.z),
            Vec3::new(a.x, a.y, b.z),
            Vec3::new(b.x, a.y, b.z),
            Vec3::new(a.x, b.y, b.z),
            b,
        ]
    }

    /// The diagonal, or 1 where the box is a point: a length that one can divide by.
    pub(crate) fn size(&self) -> f32 {
        let d = self.diagonal();
        if d > 0.0 && d.is_finite() { d } else { 1.0 }
    }
}
