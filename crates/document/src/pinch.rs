//! What two fingers and a wheel say, as numbers for the camera.
//!
//! ```text
//!   before  a ---- b          pan: the midpoint's way    scale: |now| / |before|    twist: the angle between
//!   now       a'
//!               \ b'
//! ```

use glam::Vec2;

/// What a two-finger gesture did between two moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinch {
    /// The midpoint between the fingers now, in -1..1 with y up.
    pub center: Vec2,
    /// How far the midpoint moved, in the same units.
    pub pan: Vec2,
    /// How many times farther apart the fingers are: more than 1 comes closer.
    pub scale: f32,
    /// How far the fingers turned on the screen, in degrees, counter-clockwise positive.
    pub twist: f32,
}

impl Pinch {
    /// The gesture from fingers at `before` to the same two at `now`; all in -1..1 with y up, in a viewport of `aspect`.
    /// Fingers closer than a hundredth of the shorter side neither scale nor turn.
    pub fn between(before: [Vec2; 2], now: [Vec2; 2], aspect: f32) -> Pinch {
        let middle = |f: [Vec2; 2]| (f[0] + f[1]) * 0.5;
        let stretch = if aspect >= 1.0 { Vec2::new(aspect, 1.0) } else { Vec2::new(1.0, 1.0 / aspect) };
        let (a, b) = ((before[1] - before[0]) * stretch, (now[1] - now[0]) * stretch);
        let steady = a.length() > 0.02 && b.length() > 0.02;
        Pinch {
            center: middle(now),
            pan: middle(now) - middle(before),
            scale: if steady { b.length() / a.length() } else { 1.0 },
            twist: if steady { a.angle_to(b).to_degrees() } else { 0.0 },
        }
    }
}

/// The factor for [`Camera::dolly`](crate::Camera::dolly) from a wheel's movement in pixels (down is positive and goes away): a notch of 100 is
/// a fifth. One event is worth three notches at most, whatever a device claims.
pub fn wheel_factor(pixels: f32) -> f32 {
    if pixels.is_finite() { 1.001_801_6_f32.powf(pixels.clamp(-300.0, 300.0)) } else { 1.0 }
}
