//! Where the engine's camera is, where it goes, and what it looks at through which window.
//!
//! ```text
//!   go ─> tween ─> frame ... frame ─> there          finish_tween: at once, before anything that needs the camera at rest
//! ```
//!
//! Cost: constant.

use super::{Engine, Tween};
use crate::gestures::Viewport;
use glam::Vec2;
use limn_document::Bounds;
use limn_document::camera::Camera;

impl Engine {
    /// Where the camera is or is on its way to.
    pub(super) fn aim(&self) -> Camera {
        self.tween.as_ref().map_or(self.document.view().camera, |t| t.to)
    }

    /// Moves the camera there, smoothly unless motion is unwelcome.
    pub(super) fn go(&mut self, to: Camera) {
        let to = to.quantised();
        let from = self.document.view().camera;
        if self.calm || self.shown.is_none() || from.projection != to.projection || from.up != to.up {
            self.tween = None;
            self.document.view_mut().camera = to;
        } else {
            self.tween = Some(Tween { from, to, start: self.clock.now() });
        }
        self.dirty.picture = true;
        self.dirty.state = true;
    }

    /// Puts the camera where it was going.
    pub(super) fn finish_tween(&mut self) {
        if let Some(tween) = self.tween.take() {
            self.document.view_mut().camera = tween.to;
            self.dirty.picture = true;
            self.dirty.camera = true;
        }
    }

    /// The box of what is to be seen: the model, or the unit box.
    pub(super) fn bounds(&self) -> Bounds {
        self.document.bounds()
    }

    pub(super) fn measure(&mut self, width: u32, height: u32, pixel_ratio: f32, insets: &[f32]) {
        self.pixel_ratio = if pixel_ratio.is_finite() { pixel_ratio.clamp(0.25, 8.0) } else { 1.0 };
        let inset = |i: usize| insets.get(i).copied().unwrap_or(0.0);
        let size = Vec2::new(width as f32, height as f32) / self.pixel_ratio;
        self.finish_tween();
        self.making_room = None;
        self.take_viewport(Viewport::new(size, [inset(0), inset(1), inset(2), inset(3)]));
    }

    pub(super) fn take_viewport(&mut self, viewport: Viewport) {
        self.viewport = viewport;
        self.divide();
    }
}
