//! What fingers and mice mean: raw events in, camera moves out.
//!
//! The page sends what happened since the last frame as rows of [`STRIDE`] numbers; positions are CSS pixels from the
//! canvas's upper left corner.
//!
//! ```text
//!   kind           0 down  1 move  2 up  3 cancel  4 wheel
//!   pointer        a small number for each finger or mouse
//!   x, y           where
//!   a, b           button and buttons; for a wheel its deltas in pixels
//!   modifiers      1 shift, 2 ctrl, 4 alt, 8 meta, 16 touch
//!   time           milliseconds
//! ```
//!
//! One pointer turns the model; with Shift or another button it moves it; with Ctrl it zooms. Two move, zoom and twist. A
//! wheel zooms to the pointer; trackpads send a pinch as a wheel with Ctrl, and a wheel that began sideways moves. A double
//! click or tap asks for a new pivot. Unknown numbers are ignored: a batch can do nothing worse than move the camera.

use glam::Vec2;
use limn_document::camera::{Bounds, Camera, Pinch, wheel_factor};

/// Numbers an event has.
pub const STRIDE: usize = 8;

const SHIFT: u32 = 1;
const CTRL: u32 = 2;
const META: u32 = 8;

/// Two clicks this near in milliseconds and CSS pixels are a double click.
const DOUBLE: (f32, f32) = (400.0, 12.0);
/// Two wheel events farther apart than this, in milliseconds, belong to two gestures.
const WHEEL_PAUSE: f32 = 160.0;

/// The part of the canvas that the page leaves free: cameras look at its middle, and the rest of the canvas shows more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// The canvas in CSS pixels.
    pub size: Vec2,
    /// The free part's upper left corner.
    pub min: Vec2,
    /// The free part's lower right corner.
    pub max: Vec2,
}

impl Viewport {
    /// A canvas of `size` with furniture of these widths at its top, right, bottom and left. Furniture that leaves less
    /// than a third of a side is ignored there.
    pub fn new(size: Vec2, [top, right, bottom, left]: [f32; 4]) -> Viewport {
        let size = size.max(Vec2::ONE);
        let room = |low: f32, high: f32, side: f32| {
            let sound = low >= 0.0 && high >= 0.0 && side - low - high >= side / 3.0;
            if sound { (low, side - high) } else { (0.0, side) }
        };
        let ((x0, x1), (y0, y1)) = (room(left, right, size.x), room(top, bottom, size.y));
        Viewport { size, min: Vec2::new(x0, y0), max: Vec2::new(x1, y1) }
    }

    /// The viewport on the way from `self` (t = 0) to `to` (t = 1).
    pub fn blend(&self, to: &Viewport, t: f32) -> Viewport {
        Viewport { size: to.size, min: self.min.lerp(to.min, t), max: self.max.lerp(to.max, t) }
    }

    /// Width by height of the free part.
    pub fn aspect(&self) -> f32 {
        let s = self.max - self.min;
        s.x / s.y
    }

    /// From canvas pixels to -1..1 over the free part, y up. May leave that range.
    pub fn pointer(&self, at: Vec2) -> Vec2 {
        let p = (at - self.min) / (self.max - self.min) * 2.0 - 1.0;
        Vec2::new(p.x, -p.y)
    }

    /// Takes clip coordinates of the free part to those of the whole canvas, as scale and offset of x and y.
    pub fn to_canvas(&self) -> (Vec2, Vec2) {
        let scale = (self.max - self.min) / self.size;
        let middle = (self.min + self.max) / self.size - 1.0;
        (scale, Vec2::new(middle.x, -middle.y))
    }

    /// Parts of the free part, all of one size, for `count` pictures in a row, in a column, or two by two, each less `below` at
    /// its foot for words. The way they are split leaves each the most room.
    pub fn split(&self, count: usize, below: f32) -> Vec<Viewport> {
        if count < 2 {
            return vec![*self];
        }
        let free = self.max - self.min;
        let size = |columns: usize| free / Vec2::new(columns as f32, (count / columns) as f32);
        let room = |columns: &usize| (size(*columns) - Vec2::new(0.0, below)).min_element();
        let ways = [1, 2, count].into_iter().filter(|columns| count.is_multiple_of(*columns));
        let columns = ways.max_by(|a, b| room(a).total_cmp(&room(b))).unwrap_or(1);
        let size = size(columns);
        let part = |i: usize| {
            let min = self.min + size * Vec2::new((i % columns) as f32, (i / columns) as f32);
            let max = min + size - Vec2::new(0.0, below.min(size.y * 0.4));
            Viewport { size: self.size, min, max }
        };
        (0..count).map(part).collect()
    }

    fn shorter(&self) -> f32 {
        (self.max - self.min).min_element()
    }
}

/// The viewport that a place on the canvas belongs to: words under a picture are its own.
pub fn pane(views: &[Viewport], at: Vec2) -> usize {
    let far = |v: &Viewport| (at - at.clamp(v.min, v.max)).length_squared();
    let near = views.iter().enumerate().min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
    near.map_or(0, |n| n.0)
}

/// What a batch came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effect {
    /// The camera moved.
    pub moved: bool,
    /// A double click: which viewport, and the pointer in -1..1 over its free part.
    pub pivot: Option<(usize, Vec2)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Pointer {
    id: i32,
    at: Vec2,
    button: i32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Wheel {
    Zoom,
    Pan,
}

/// The pointers that are down, and what the last click and wheel were.
#[derive(Debug, Default)]
pub struct Gestures {
    down: Vec<Pointer>,
    last_click: Option<(f32, Vec2)>,
    /// The viewport in which the pointers went down.
    pane: usize,
    wheel: Option<(Wheel, f32)>,
}

impl Gestures {
    /// Whether a pointer is down.
    pub fn held(&self) -> bool {
        !self.down.is_empty()
    }

    /// Applies a batch to the camera that all `views` share. What begins in one of them goes on there.
    pub fn apply(&mut self, batch: &[f32], views: &[Viewport], camera: &mut Camera, bounds: &Bounds) -> Effect {
        let mut effect = Effect::default();
        for &[kind, pointer, x, y, a, b, modifiers, time] in batch.as_chunks::<STRIDE>().0 {
            let (id, at, modifiers) = (pointer as i32, Vec2::new(x, y), modifiers as u32);
            if !at.is_finite() {
                continue;
            }
            if self.down.is_empty() && matches!(kind as i32, 0 | 4) {
                self.pane = pane(views, at);
            }
            let Some(view) = views.get(self.pane).or(views.first()) else { return effect };
            match kind as i32 {
                0 => {
                    self.down.retain(|p| p.id != id);
                    self.down.push(Pointer { id, at, button: a as i32 });
                    if a as i32 == 0 && self.down.len() == 1 {
                        let double =
                            self.last_click.is_some_and(|(t, p)| time - t < DOUBLE.0 && p.distance(at) < DOUBLE.1);
                        if double {
                            effect.pivot = Some((self.pane, view.pointer(at)));
                        }
                        self.last_click = (!double).then_some((time, at));
                    } else {
                        self.last_click = None;
                    }
                }
                1 => effect.moved |= self.drag(id, at, modifiers, view, camera, bounds),
                2 | 3 => self.down.retain(|p| p.id != id),
                4 => effect.moved |= self.turn(at, Vec2::new(a, b), modifiers, time, view, camera, bounds),
                _ => {}
            }
        }
        effect
    }

    fn drag(
        &mut self,
        id: i32,
        at: Vec2,
        modifiers: u32,
        view: &Viewport,
        camera: &mut Camera,
        bounds: &Bounds,
    ) -> bool {
        let before = self.down.clone();
        let Some(moved) = self.down.iter_mut().find(|p| p.id == id) else { return false };
        let delta = (at - std::mem::replace(&mut moved.at, at)) / view.shorter();
        if delta == Vec2::ZERO {
            return false;
        }
        match (before.as_slice(), self.down.as_slice()) {
            ([p], _) => {
                if p.button != 0 || modifiers & SHIFT != 0 {
                    camera.pan(delta);
                } else if modifiers & (CTRL | META) != 0 {
                    camera.dolly(wheel_factor(delta.y * 800.0), Vec2::ZERO, view.aspect(), bounds);
                } else {
                    camera.orbit(delta);
                }
            }
            ([p0, p1, ..], [q0, q1, ..]) => {
                let pair = |a: &Pointer, b: &Pointer| [view.pointer(a.at), view.pointer(b.at)];
                camera.pinch(&Pinch::between(pair(p0, p1), pair(q0, q1), view.aspect()), view.aspect(), bounds);
            }
            _ => return false,
        }
        true
    }

    #[allow(clippy::too_many_arguments)]
    fn turn(
        &mut self,
        at: Vec2,
        delta: Vec2,
        modifiers: u32,
        time: f32,
        view: &Viewport,
        camera: &mut Camera,
        bounds: &Bounds,
    ) -> bool {
        if !delta.is_finite() || delta == Vec2::ZERO {
            return false;
        }
        let going = self.wheel.filter(|(_, last)| time - last < WHEEL_PAUSE).map(|(mode, _)| mode);
        // What a gesture began as, it stays: a swipe upwards drifts sideways too.
        let mode = match going {
            _ if modifiers & CTRL != 0 => Wheel::Zoom,
            Some(mode) => mode,
            None if delta.x.abs() > delta.y.abs() || modifiers & SHIFT != 0 => Wheel::Pan,
            None => Wheel::Zoom,
        };
        self.wheel = Some((mode, time));
        match mode {
            Wheel::Pan => camera.pan(-delta / view.shorter()),
            Wheel::Zoom => {
                // A trackpad's pinch comes in small steps.
                let pixels = if modifiers & CTRL != 0 { delta.y * 5.0 } else { delta.y };
                camera.dolly(wheel_factor(pixels), view.pointer(at), view.aspect(), bounds);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> Viewport {
        Viewport::new(Vec2::new(800.0, 600.0), [50.0, 0.0, 150.0, 0.0])
    }

    fn run(batch: &[[f32; STRIDE]]) -> (Camera, Camera, Effect) {
        let bounds = Bounds::default();
        let mut camera = Camera::default();
        camera.frame(&bounds, view().aspect());
        let before = camera;
        let effect = Gestures::default().apply(batch.as_flattened(), &[view()], &mut camera, &bounds);
        (before, camera, effect)
    }

    #[test]
    fn the_free_part_is_the_camera_s_viewport() {
        let v = view();
        assert_eq!(v.aspect(), 2.0);
        assert_eq!(v.pointer(Vec2::new(400.0, 250.0)), Vec2::ZERO);
        assert_eq!(v.pointer(Vec2::new(800.0, 50.0)), Vec2::ONE);
        let (scale, offset) = v.to_canvas();
        assert!((offset - Vec2::new(0.0, 1.0 / 6.0)).length() < 1e-6, "{offset}");
        assert!((scale - Vec2::new(1.0, 2.0 / 3.0)).length() < 1e-6, "{scale}");
        // Furniture that covers nearly all of a side does not count.
        assert_eq!(Viewport::new(Vec2::splat(300.0), [0.0, 0.0, 250.0, 0.0]).max.y, 300.0);
    }

    #[test]
    fn a_drag_turns_and_with_shift_moves() {
        let drag =
            |modifiers: f32| [[0., 0., 400., 250., 0., 1., modifiers, 0.], [1., 0., 440., 250., 0., 1., modifiers, 9.]];
        let (before, after, effect) = run(&drag(0.0));
        assert!(effect.moved);
        // A tenth of the shorter side is a tenth of half a turn.
        assert!((after.yaw - (before.yaw - 18.0)).abs() < 1e-3, "{} {}", before.yaw, after.yaw);
        assert_eq!(after.target, before.target);
        let (before, after, _) = run(&drag(1.0));
        assert_eq!(after.yaw, before.yaw);
        let moved = after.project(before.target, 2.0).unwrap().truncate();
        assert!((moved - Vec2::new(0.1, 0.0)).length() < 1e-4, "{moved}");
    }

    #[test]
    fn a_wheel_zooms_to_the_pointer() {
        let (before, after, effect) = run(&[[4., -1., 800., 250., 0., -100., 0., 0.]]);
        assert!(effect.moved && after.distance < before.distance);
        let right = before.ray(Vec2::X, 2.0);
        let hit = right.origin + right.direction * (before.distance / right.direction.dot(-before.basis().back));
        let now = after.project(hit, 2.0).unwrap().truncate();
        assert!((now - Vec2::X).length() < 1e-3, "{now}");
    }

    #[test]
    fn a_wheel_that_began_upwards_does_not_drift() {
        let one = [4., -1., 400., 250., 0., -10., 0., 0.];
        let (_, straight, _) = run(&[one, [4., -1., 400., 250., 0., -10., 0., 20.]]);
        let (_, drifting, _) = run(&[one, [4., -1., 400., 250., 30., -10., 0., 20.]]);
        assert_eq!(straight, drifting);
        let (before, later, _) = run(&[one, [4., -1., 400., 250., 30., -10., 0., 900.]]);
        assert!((later.target - before.target).length() > 1e-3);
    }

    #[test]
    fn two_fingers_zoom() {
        let (before, after, effect) = run(&[
            [0., 0., 350., 250., 0., 1., 16., 0.],
            [0., 1., 450., 250., 0., 1., 16., 1.],
            [1., 0., 300., 250., 0., 1., 16., 2.],
            [1., 1., 500., 250., 0., 1., 16., 3.],
        ]);
        assert!(effect.moved && effect.pivot.is_none());
        assert!((after.distance - before.distance / 2.0).abs() < 1e-3 * before.distance);
    }

    #[test]
    fn a_double_click_asks_for_a_pivot_once() {
        let click = |t: f32, x: f32| [[0., 0., x, 250., 0., 1., 0., t], [2., 0., x, 250., 0., 0., 0., t + 50.]];
        let double = [click(0.0, 600.0), click(200.0, 602.0)].concat();
        assert_eq!(run(&double).2.pivot, Some((0, view().pointer(Vec2::new(602.0, 250.0)))));
        assert_eq!(run(&[click(0.0, 600.0), click(900.0, 600.0)].concat()).2.pivot, None);
        assert_eq!(run(&[click(0.0, 600.0), click(200.0, 500.0)].concat()).2.pivot, None);
    }

    #[test]
    fn pictures_side_by_side_share_the_free_part() {
        let wide = Viewport::new(Vec2::new(900.0, 600.0), [50.0, 0.0, 150.0, 0.0]);
        let boxes = |v: &Viewport, n: usize| v.split(n, 40.0).iter().map(|p| (p.min, p.max)).collect::<Vec<_>>();
        let at = |x0: f32, y0: f32, x1: f32, y1: f32| (Vec2::new(x0, y0), Vec2::new(x1, y1));
        assert_eq!(wide.split(1, 40.0), [wide]);
        assert_eq!(boxes(&wide, 2), [at(0., 50., 450., 410.), at(450., 50., 900., 410.)]);
        assert_eq!(boxes(&wide, 3)[2], at(600., 50., 900., 410.));
        // Four in a row where there is little height, two by two where there is.
        assert_eq!(boxes(&wide, 4)[1..3], [at(225., 50., 450., 410.), at(450., 50., 675., 410.)]);
        let square = Viewport::new(Vec2::new(800.0, 800.0), [0.0; 4]);
        assert_eq!(boxes(&square, 4)[1..3], [at(400., 0., 800., 360.), at(0., 400., 400., 760.)]);
        let tall = Viewport::new(Vec2::new(400.0, 800.0), [0.0; 4]);
        assert_eq!(boxes(&tall, 2), [at(0., 0., 400., 360.), at(0., 400., 400., 760.)]);
        assert_eq!(boxes(&tall, 3).len(), 3);
    }

    #[test]
    fn a_gesture_belongs_to_the_picture_that_it_began_in() {
        let bounds = Bounds::default();
        let views = view().split(2, 0.0);
        let mut start = Camera::default();
        start.frame(&bounds, views[0].aspect());
        let run = |batch: &[[f32; STRIDE]]| {
            let (mut camera, mut gestures) = (start, Gestures::default());
            let effect = gestures.apply(batch.as_flattened(), &views, &mut camera, &bounds);
            (camera, effect)
        };
        // The same place in either picture does the same.
        let wheel = |x: f32| run(&[[4., -1., x, 100., 0., -100., 0., 0.]]).0;
        assert_eq!(wheel(100.0), wheel(500.0));
        assert_ne!(wheel(100.0), wheel(300.0));
        let pinch = |x: f32| {
            run(&[
                [0., 0., x, 250., 0., 1., 16., 0.],
                [0., 1., x + 300., 250., 0., 1., 16., 1.],
                [1., 1., x + 400., 250., 0., 1., 16., 3.],
            ])
            .0
        };
        // The second finger may be over the other picture.
        assert_eq!(pinch(50.0), pinch(450.0));
        let click = |t: f32, x: f32| [[0., 0., x, 250., 0., 1., 0., t], [2., 0., x, 250., 0., 0., 0., t + 50.]];
        let (_, effect) = run(&[click(0.0, 500.0), click(200.0, 500.0)].concat());
        assert_eq!(effect.pivot, Some((1, views[0].pointer(Vec2::new(100.0, 250.0)))));
    }

    #[test]
    fn nonsense_does_nothing() {
        let (before, after, effect) = run(&[
            [9., 0., 1., 1., 1., 1., 1., 1.],
            [1., 7., 1., 1., 1., 1., 1., 1.],
            [0., 0., f32::NAN, 1., 0., 1., 0., 0.],
            [4., -1., 400., 250., f32::NAN, f32::INFINITY, 0., 0.],
        ]);
        assert_eq!((before, Effect::default()), (after, effect));
    }
}
