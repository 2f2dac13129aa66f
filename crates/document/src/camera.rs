//! The orbit camera: where the viewer stands, and how pointer, wheel and touch move it.
//!
//! The camera is a turntable. It looks at a `target`, from the direction that `yaw` and `pitch` give, from `distance`
//! away; the up axis of the scene stays vertical on the screen. Its basis is built from the two angles, never by
//! `look_at`, so looking straight down or up is as good a direction as any.
//!
//! ```text
//!            up                      target plane: through the target, facing the viewer
//!             |   . eye              half height = distance * tan(fov / 2)   (shorter side of the viewport)
//!             |  /                   pan, dolly to the pointer and both projections agree on it,
//!             | / pitch              so a switch to orthographic keeps the size of what is looked at
//!   target  --o---------> yaw
//! ```
//!
//! Everything here is a pure function of numbers: no clock, no events. Lengths are in the model's units, angles in
//! degrees, matrices right-handed with a depth of 0 (near) to 1 (far), as wgpu has it. All of it costs a handful of
//! operations. `f32` limits a close-up to about 1e-3 of the model's diagonal, and so do [`Camera::dolly`]'s bounds.

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Mat4, Vec2, Vec3};

use crate::numbers::{decade, decimal, number, single};

pub use crate::bounds::Bounds;
pub use crate::pinch::{Pinch, wheel_factor};

/// How much of the viewport a framed model leaves free on each side, as a fraction.
const MARGIN: f32 = 0.1;
/// The field of view of a new camera across the shorter side of the viewport, in degrees.
pub const DEFAULT_FOV: f32 = 35.0;
/// The narrowest and the widest field of view, in degrees.
pub const FOV_RANGE: (f32, f32) = (5.0, 120.0);

/// How depth becomes size on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// Far things look smaller.
    #[default]
    Perspective,
    /// Parallel lines stay parallel.
    Orthographic,
}

/// The axis of the model that points up on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +Y is up and the front faces +Z (glTF, most OBJ files).
    #[default]
    Y,
    /// +Z is up and the front faces -Y (CAD, 3D printing, Blender).
    Z,
}

/// A direction with a name. Choosing one also frames the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Standard {
    /// The direction a model opens in: a little from the right and from above.
    #[default]
    Home,
    /// From the front.
    Front,
    /// From behind.
    Back,
    /// From the model's left, that is from -X.
    Left,
    /// From the model's right, that is from +X.
    Right,
    /// Straight from above.
    Top,
    /// Straight from below.
    Bottom,
    /// Isometric: all three axes equally foreshortened.
    Iso,
}

impl Standard {
    /// All of them, in the order in which a menu lists them.
    pub const ALL: [Standard; 8] = [
        Standard::Home,
        Standard::Front,
        Standard::Back,
        Standard::Left,
        Standard::Right,
        Standard::Top,
        Standard::Bottom,
        Standard::Iso,
    ];

    /// The word for it in commands.
    pub fn name(self) -> &'static str {
        match self {
            Standard::Home => "home",
            Standard::Front => "front",
            Standard::Back => "back",
            Standard::Left => "left",
            Standard::Right => "right",
            Standard::Top => "top",
            Standard::Bottom => "bottom",
            Standard::Iso => "iso",
        }
    }

    /// The direction with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Standard> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// Yaw and pitch in degrees.
    pub fn angles(self) -> (f32, f32) {
        match self {
            Standard::Home => (35.0, 20.0),
            Standard::Front => (0.0, 0.0),
            Standard::Back => (180.0, 0.0),
            Standard::Left => (-90.0, 0.0),
            Standard::Right => (90.0, 0.0),
            Standard::Top => (0.0, 90.0),
            Standard::Bottom => (0.0, -90.0),
            // atan(1 / sqrt 2): the angle of a cube's diagonal to its base.
            Standard::Iso => (45.0, 35.264_39),
        }
    }
}

/// A half-line into the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; of length 1.
    pub direction: Vec3,
}

/// The viewer's three axes in the model's space; an orthonormal, right-handed basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// To the right on the screen.
    pub right: Vec3,
    /// Up on the screen.
    pub up: Vec3,
    /// Out of the screen, towards the viewer.
    pub back: Vec3,
}

/// Where the viewer stands. See the module's text for what the numbers mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point looked at, and turned about.
    pub target: Vec3,
    /// The turn about the up axis in degrees, in (-180, 180]; 0 looks at the front, 90 from the right.
    pub yaw: f32,
    /// The angle above the horizon in degrees, in -90..=90.
    pub pitch: f32,
    /// From the target to the eye; more than 0.
    pub distance: f32,
    /// The field of view across the shorter side of the viewport, in degrees, within [`FOV_RANGE`].
    pub fov: f32,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// The axis that is up on the screen.
    pub up: UpAxis,
    /// The named view that this still is: framed, and not moved since. Such a camera is framed again when the viewport
    /// changes its shape, and takes one word in a link.
    pub standard: Option<Standard>,
}

impl Default for Camera {
    /// The home view of [`Bounds::default`] in a square viewport.
    fn default() -> Self {
        let (yaw, pitch) = Standard::Home.angles();
        let mut camera = Camera {
            target: Vec3::ZERO,
            yaw,
            pitch,
            distance: 1.0,
            fov: DEFAULT_FOV,
            projection: Projection::Perspective,
            up: UpAxis::Y,
            standard: Some(Standard::Home),
        };
        camera.frame(&Bounds::default(), 1.0);
        camera
    }
}

impl Camera {
    /// The viewer's axes.
    pub fn basis(&self) -> Basis {
        let (sy, cy) = sin_cos(self.yaw);
        let (sp, cp) = sin_cos(self.pitch);
        let right = Vec3::new(cy, 0.0, -sy);
        let back = Vec3::new(sy * cp, sp, cy * cp);
        let up = Vec3::new(-sy * sp, cp, -cy * sp);
        match self.up {
            UpAxis::Y => Basis { right, up, back },
            // A quarter turn about X takes Y to Z and Z to -Y.
            UpAxis::Z => {
                let turn = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
                Basis { right: turn(right), up: turn(up), back: turn(back) }
            }
        }
    }

    /// Where the viewer's eye is. (Orthographic rays start on the plane through it.)
    pub fn eye(&self) -> Vec3 {
        self.target + self.basis().back * self.distance
    }

    /// From the model's space to the viewer's: x right, y up, z towards the viewer.
    pub fn view(&self) -> Mat4 {
        let Basis { up, back, .. } = self.basis();
        look_to_mat4(self.eye(), -back, up)
    }

    /// Half of the target plane's shorter visible side.
    fn half_side(&self) -> f32 {
        let (sin, cos) = sin_cos(self.fov * 0.5);
        self.distance * (sin / cos)
    }

    /// Half the width and half the height of the target plane's visible part. `aspect` is the viewport's width / height.
    pub fn half_extent(&self, aspect: f32) -> Vec2 {
        let half = self.half_side();
        if aspect >= 1.0 { Vec2::new(half * aspect, half) } else { Vec2::new(half, half / aspect) }
    }

    /// The distances of the near and the far plane from the eye that hold all of the box in sight, with 1 % to spare.
    ///
    /// In perspective `near > 0` and `far / near <= 1e4`, which leaves a 24-bit depth buffer enough steps; what lies
    /// nearer is cut off. In orthographic projection `near` may be negative: behind the eye's plane is still in sight.
    pub fn clip_range(&self, bounds: &Bounds) -> (f32, f32) {
        let (eye, back) = (self.eye(), self.basis().back);
        let pad = bounds.size() * 0.01;
        let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in bounds.corners() {
            let depth = (eye - corner).dot(back);
            near = near.min(depth);
            far = far.max(depth);
        }
        let (near, far) = (near - pad, far + pad);
        match self.projection {
            Projection::Orthographic => (near, far),
            Projection::Perspective => {
                // A box wholly behind the viewer still needs a sound matrix.
                let far = if far > 0.0 { far } else { self.distance * 2.0 };
                (near.max(far * 1e-4), far)
            }
        }
    }

    /// From the viewer's space to the clip cube of wgpu: x and y in -1..1, y up, depth 0 at `near` and 1 at `far`.
    pub fn projection_matrix(&self, aspect: f32, near: f32, far: f32) -> Mat4 {
        let half = self.half_extent(aspect);
        match self.projection {
            Projection::Perspective => {
                let half = half * (near / self.distance);
                directx::frustum(-half.x, half.x, -half.y, half.y, near, far)
            }
            Projection::Orthographic => directx::orthographic(-half.x, half.x, -half.y, half.y, near, far),
        }
    }

    /// From the model's space to the clip cube, with near and far from the box.
    pub fn view_projection(&self, aspect: f32, bounds: &Bounds) -> Mat4 {
        let (near, far) = self.clip_range(bounds);
        self.projection_matrix(aspect, near, far) * self.view()
    }

    /// Where a point of the model is on the screen: x and y in -1..1 (y up), and its distance before the eye. `None` if
    /// it is behind a perspective eye.
    pub fn project(&self, point: Vec3, aspect: f32) -> Option<Vec3> {
        let Basis { right, up, back } = self.basis();
        let offset = point - self.eye();
        let depth = -offset.dot(back);
        let scale = match self.projection {
            Projection::Perspective if depth <= 0.0 => return None,
            Projection::Perspective => self.distance / depth,
            Projection::Orthographic => 1.0,
        };
        let on_plane = Vec2::new(offset.dot(right), offset.dot(up)) * scale / self.half_extent(aspect);
        Some(on_plane.extend(depth))
    }

    /// The ray under a pointer. `pointer` is in -1..1 with y up, `aspect` the viewport's width / height.
    pub fn ray(&self, pointer: Vec2, aspect: f32) -> Ray {
        let Basis { back, .. } = self.basis();
        let (eye, on_plane) = (self.eye(), self.on_target_plane(pointer, aspect));
        match self.projection {
            Projection::Perspective => Ray { origin: eye, direction: (on_plane - eye).normalize() },
            Projection::Orthographic => Ray { origin: on_plane + back * self.distance, direction: -back },
        }
    }

    /// The point of the target plane under the pointer.
    fn on_target_plane(&self, pointer: Vec2, aspect: f32) -> Vec3 {
        let Basis { right, up, .. } = self.basis();
        let offset = pointer * self.half_extent(aspect);
        self.target + right * offset.x + up * offset.y
    }

    /// Turns about the target. `delta` is the pointer's movement divided by the viewport's shorter side, y down: a drag
    /// across it is half a turn, and the model follows the pointer.
    pub fn orbit(&mut self, delta: Vec2) {
        self.yaw = wrap_degrees(self.yaw - delta.x * 180.0);
        self.pitch = (self.pitch + delta.y * 180.0).clamp(-90.0, 90.0);
        self.standard = None;
    }

    /// Moves the target within its plane, so that the point under the pointer stays there. `delta` as for [`Self::orbit`].
    pub fn pan(&mut self, delta: Vec2) {
        let Basis { right, up, .. } = self.basis();
        self.target += (up * delta.y - right * delta.x) * (2.0 * self.half_side());
        self.standard = None;
    }

    /// Multiplies the distance by `factor` (less than 1 comes closer) and keeps the point of the target plane under the
    /// pointer where it is. `pointer` as for [`Self::ray`]; zero is the middle.
    ///
    /// The distance stays within 1e-3 and 100 diagonals of the box.
    pub fn dolly(&mut self, factor: f32, pointer: Vec2, aspect: f32, bounds: &Bounds) {
        if !(factor > 0.0 && factor.is_finite()) {
            return;
        }
        let size = bounds.size();
        let distance = (self.distance * factor).max(size * 1e-3).min(size * 100.0);
        // The factor that remains after the clamp, so that running into the stop does not drift sideways.
        let factor = distance / self.distance;
        let anchor = self.on_target_plane(pointer, aspect);
        self.target = anchor + (self.target - anchor) * factor;
        self.distance = distance;
        self.standard = None;
    }

    /// Looks at the middle of the box from the present direction, from where all eight corners are in sight with a tenth
    /// of the viewport free around them. Keeps the name of a standard view.
    pub fn frame(&mut self, bounds: &Bounds, aspect: f32) {
        let Basis { right, up, back } = self.basis();
        let center = bounds.center();
        let unit = Camera { distance: 1.0, ..*self }.half_extent(aspect) * (1.0 - MARGIN);
        let mut distance = 0.0_f32;
        for point in bounds.outline() {
            let p = point - center;
            let across = (p.dot(right).abs() / unit.x).max(p.dot(up).abs() / unit.y);
            let before = match self.projection {
                Projection::Perspective => p.dot(back),
                Projection::Orthographic => 0.0,
            };
            distance = distance.max(across + before);
        }
        self.target = center;
        // A point has no size of its own: show a unit around it. Seen edge on, a flat box must not touch the eye.
        self.distance =
            if bounds.diagonal() > 0.0 { distance.max(bounds.size() * 0.1) } else { 1.0 / unit.min_element() };
    }

    /// Takes a named direction and frames the box.
    pub fn set_standard(&mut self, standard: Standard, bounds: &Bounds, aspect: f32) {
        (self.yaw, self.pitch) = standard.angles();
        self.frame(bounds, aspect);
        self.standard = Some(standard);
    }

    /// Frames again if this is still a named view: for a new model, or a viewport of a new shape.
    pub fn refresh(&mut self, bounds: &Bounds, aspect: f32) {
        if let Some(standard) = self.standard {
            self.set_standard(standard, bounds, aspect);
        }
    }

    /// Keeps the picture when the model was moved or resized from one box to another. A named view frames the new one.
    pub fn follow(&mut self, from: &Bounds, to: &Bounds, aspect: f32) {
        if self.standard.is_some() {
            return self.refresh(to, aspect);
        }
        let factor = to.size() / from.size();
        self.target = to.center() + (self.target - from.center()) * factor;
        self.distance = (self.distance * factor).max(f32::MIN_POSITIVE);
    }

    /// Makes a point of the model the centre of turning, and of the picture. Its size on the screen stays. A point behind
    /// the eye changes nothing.
    pub fn set_pivot(&mut self, point: Vec3) {
        let depth = match self.projection {
            Projection::Perspective => (self.eye() - point).dot(self.basis().back),
            Projection::Orthographic => self.distance,
        };
        if point.is_finite() && depth > 0.0 {
            self.target = point;
            self.distance = depth;
            self.standard = None;
        }
    }

    /// Applies a two-finger gesture: what was under the fingers stays under them. The twist turns the model about its up
    /// axis by as much as that axis points at the viewer: wholly from above, not at all from the side.
    pub fn pinch(&mut self, pinch: &Pinch, aspect: f32, bounds: &Bounds) {
        // The shorter side is 2 units of the pointer's -1..1 range; the longer one is stretched by the aspect.
        let to_side = if aspect >= 1.0 { Vec2::new(0.5 * aspect, 0.5) } else { Vec2::new(0.5, 0.5 / aspect) };
        let delta = pinch.pan * to_side;
        self.pan(Vec2::new(delta.x, -delta.y));
        self.dolly(pinch.scale.recip(), pinch.center, aspect, bounds);
        self.yaw = wrap_degrees(self.yaw - pinch.twist * sin_cos(self.pitch).0);
    }

    /// The camera on the way from `self` (t = 0) to `to` (t = 1): the shorter way round, the distance geometrically so that
    /// a zoom feels even. What cannot be blended (projection, up axis, name) is taken from `to`.
    pub fn blend(&self, to: &Camera, t: f32) -> Camera {
        if t >= 1.0 {
            return *to;
        }
        let t = t.max(0.0);
        Camera {
            target: self.target.lerp(to.target, t),
            yaw: wrap_degrees(self.yaw + wrap_degrees(to.yaw - self.yaw) * t),
            pitch: self.pitch + (to.pitch - self.pitch) * t,
            distance: self.distance * (to.distance / self.distance).powf(t),
            fov: self.fov + (to.fov - self.fov) * t,
            ..*to
        }
    }

    /// The camera as a link holds it: angles to 0.1 degree, the distance to four digits, the target to about a two
    /// thousandth of the distance. That moves the picture by less than a pixel or two, and is short. Twice is the same as
    /// once. A link holds a named view by its name alone: that one stays as it frames the model.
    pub fn quantised(&self) -> Camera {
        if self.standard.is_some() {
            return *self;
        }
        let pose = PoseText::of(self);
        let number = |text: &str, or: f32| single(text).unwrap_or(or);
        Camera {
            yaw: number(&pose.yaw, self.yaw),
            pitch: number(&pose.pitch, self.pitch),
            distance: number(&pose.distance, self.distance),
            target: Vec3::new(
                number(&pose.target[0], self.target.x),
                number(&pose.target[1], self.target.y),
                number(&pose.target[2], self.target.z),
            ),
            fov: number(&decimal(self.fov.into(), 1), self.fov),
            ..*self
        }
    }
}

/// The numbers of a pose, each as short as its precision allows.
struct PoseText {
    yaw: String,
    pitch: String,
    distance: String,
    target: [String; 3],
}

impl PoseText {
    fn of(camera: &Camera) -> PoseText {
        let distance = decimal(camera.distance.into(), 3 - decade(camera.distance.into()));
        // The target's step follows the distance as written, so that writing twice gives the same text.
        let step = 3 - decade(number(&distance).unwrap_or(camera.distance.into()));
        let yaw = decimal(camera.yaw.into(), 1);
        PoseText {
            // -180 and 180 are one direction.
            yaw: if yaw == "-180" { "180".into() } else { yaw },
            pitch: decimal(camera.pitch.into(), 1),
            distance,
            target: camera.target.to_array().map(|v| decimal(v.into(), step)),
        }
    }
}

/// Sine and cosine of an angle in degrees, the same bits on every platform.
fn sin_cos(degrees: f32) -> (f32, f32) {
    let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
    (sin as f32, cos as f32)
}

/// An angle in degrees brought into (-180, 180].
pub fn wrap_degrees(angle: f32) -> f32 {
    // What lies there already keeps its last digit.
    if angle > -180.0 && angle <= 180.0 {
        return angle;
    }
    let wrapped = angle.rem_euclid(360.0);
    if wrapped > 180.0 { wrapped - 360.0 } else { wrapped }
}
