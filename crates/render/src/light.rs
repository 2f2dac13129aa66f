//! The studio: a few lamps, seen by matt surfaces as spherical harmonics and by glossy ones as soft boxes.
//!
//! Each lamp's cosine lobe is cut off after the second order (Ramamoorthi and Hanrahan 2001, "An efficient
//! representation for irradiance environment maps"): a lamp of strength I from direction d gives
//! `I (1/4 + cos/2 + 15/32 (cos² - 1/3))`, which stays positive all around (1.06 in front, 0.06 behind) and has no hard
//! terminator. Key, fill and rim hang on the camera, so shapes read well from everywhere; sky and ground
//! stand in the world.
//!
//! ```text
//!              sky
//!      key             rim        the camera looks at o from below this page;
//!          \          /           key and fill stand beside it, the rim lamp
//!             o                   behind the model
//!          /     \ fill
//! ```
//!
//! Cost: a hundred multiplications a frame.

use glam::{Mat3, Vec3};

/// Nine coefficients of `E(n)/pi` for 1, y, z, x, xy, yz, 3z²-1, xz, x²-y².
pub(crate) type Irradiance = [[f32; 4]; 9];

/// One soft box: direction, right over half width, up over half height (w of each unused), radiance and softness.
pub(crate) type SoftBox = [[f32; 4]; 4];

fn add(e: &mut Irradiance, d: Vec3, color: Vec3) {
    let q = 15.0 / 32.0;
    let terms = [
        0.25,
        0.5 * d.y,
        0.5 * d.z,
        0.5 * d.x,
        q * 2.0 * d.x * d.y,
        q * 2.0 * d.y * d.z,
        q * 0.5 * (d.z * d.z - 1.0 / 3.0),
        q * 2.0 * d.x * d.z,
        q * 0.5 * (d.x * d.x - d.y * d.y),
    ];
    for (c, t) in e.iter_mut().zip(terms) {
        for i in 0..3 {
            c[i] += t * color[i];
        }
    }
}

/// The lamps for a camera whose eye-to-world rotation is `eye`, in a world where `up` is up.
pub(crate) fn studio(eye: Mat3, up: Vec3) -> (Irradiance, [SoftBox; 3]) {
    let mut e = Irradiance::default();
    // The whole room, so that no side is black.
    e[0] = [0.145, 0.15, 0.16, 0.0];
    let up = up.normalize_or(Vec3::Y);
    add(&mut e, up, Vec3::new(0.30, 0.315, 0.34));
    add(&mut e, -up, Vec3::new(0.21, 0.205, 0.20));
    let key = eye * Vec3::new(-0.52, 0.60, 0.61).normalize();
    let fill = eye * Vec3::new(0.86, 0.05, 0.50).normalize();
    let rim = eye * Vec3::new(0.35, 0.45, -0.82).normalize();
    add(&mut e, key, Vec3::new(0.74, 0.72, 0.69));
    add(&mut e, fill, Vec3::new(0.150, 0.165, 0.19));
    add(&mut e, rim, Vec3::new(0.22, 0.225, 0.235));
    let boxes = [
        soft_box(key, eye * Vec3::Y, 0.46, 0.58, Vec3::new(3.6, 3.5, 3.35), 0.95),
        soft_box(fill, eye * Vec3::Y, 0.22, 0.95, Vec3::new(1.3, 1.4, 1.5), 0.95),
        soft_box(rim, eye * Vec3::X, 0.35, 0.90, Vec3::new(2.4, 2.5, 2.6), 0.90),
    ];
    (e, boxes)
}

/// `half_width` and `half_height` are tangents of half angles.
fn soft_box(d: Vec3, up: Vec3, half_width: f32, half_height: f32, radiance: Vec3, softness: f32) -> SoftBox {
    let right = up.cross(d).normalize_or(Vec3::X);
    let up = d.cross(right);
    [
        d.extend(0.0).into(),
        (right / half_width).extend(0.0).into(),
        (up / half_height).extend(0.0).into(),
        radiance.extend(softness).into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eval(e: &Irradiance, n: Vec3) -> f32 {
        let b = [1.0, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.x * n.z, n.x * n.x - n.y * n.y];
        e.iter().zip(b).map(|(c, b)| c[0] * b).sum()
    }

    #[test]
    fn one_lamp_is_the_clamped_cosine_within_its_order() {
        let d = Vec3::new(0.3, -0.5, 0.8).normalize();
        let mut e = Irradiance::default();
        add(&mut e, d, Vec3::ONE);
        let side = d.cross(Vec3::X).normalize();
        assert!((eval(&e, d) - 1.0625).abs() < 1e-5);
        assert!((eval(&e, side) - (0.25 - 15.0 / 96.0)).abs() < 1e-5);
        assert!((eval(&e, -d) - 0.0625).abs() < 1e-5);
        // Half way: cos 60 degrees = 0.5 against 0.25 + 0.25 + 15/32 (1/4 - 1/3).
        let half = 0.5 * d + 0.75f32.sqrt() * side;
        assert!((eval(&e, half) - (0.5 - 15.0 / 384.0)).abs() < 1e-5);
    }

    #[test]
    fn the_studio_is_bright_in_front_and_never_black() {
        let (e, boxes) = studio(Mat3::IDENTITY, Vec3::Y);
        let front = eval(&e, Vec3::new(-0.52, 0.60, 0.61).normalize());
        assert!((0.9..1.25).contains(&front), "{front}");
        for n in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!(eval(&e, n) > 0.15, "{n} {}", eval(&e, n));
        }
        for b in boxes {
            let [d, r, u] = [b[0], b[1], b[2]].map(|v| Vec3::new(v[0], v[1], v[2]));
            assert!(d.dot(r).abs() < 1e-5 && d.dot(u).abs() < 1e-5 && (d.length() - 1.0).abs() < 1e-5);
        }
    }
}
