//! The camera's mathematics, by positions on the screen.

use glam::{Vec2, Vec3, vec2, vec3};
use limn_document::camera::{Bounds, Camera, Pinch, Projection, Standard, UpAxis, wheel_factor, wrap_degrees};
use limn_document::view::View;
use proptest::prelude::*;

const WIDE: f32 = 1.6;

fn unit() -> Bounds {
    Bounds::new(vec3(-1.0, -2.0, -3.0), vec3(1.0, 2.0, 3.0))
}

fn close(a: Vec3, b: Vec3, eps: f32) -> bool {
    (a - b).abs().max_element() <= eps
}

/// Where a point falls through the matrices: x, y in -1..1 and depth in 0..1.
fn through_matrices(camera: &Camera, p: Vec3, aspect: f32, bounds: &Bounds) -> Vec3 {
    camera.view_projection(aspect, bounds).project_point3(p)
}

#[test]
fn standard_views_look_where_they_say() {
    for (standard, eye, right) in [
        (Standard::Front, Vec3::Z, Vec3::X),
        (Standard::Back, -Vec3::Z, -Vec3::X),
        (Standard::Right, Vec3::X, -Vec3::Z),
        (Standard::Left, -Vec3::X, Vec3::Z),
        (Standard::Top, Vec3::Y, Vec3::X),
        (Standard::Bottom, -Vec3::Y, Vec3::X),
        (Standard::Iso, Vec3::ONE.normalize(), vec3(1.0, 0.0, -1.0).normalize()),
    ] {
        let mut camera = Camera::default();
        camera.set_standard(standard, &unit(), WIDE);
        let basis = camera.basis();
        assert!(close(basis.back, eye, 1e-6), "{standard:?} {:?}", basis.back);
        assert!(close(basis.right, right, 1e-6), "{standard:?} {:?}", basis.right);
        assert!(close(basis.right.cross(basis.up), basis.back, 1e-6));
        assert_eq!(Standard::from_name(standard.name()), Some(standard));
        // Z up: the front faces -Y, up is Z; the top looks along -Z.
        camera.up = UpAxis::Z;
        let turned = |v: Vec3| vec3(v.x, -v.z, v.y);
        assert!(close(camera.basis().back, turned(eye), 1e-6));
        assert!(close(camera.basis().right, turned(right), 1e-6));
    }
    assert_eq!(Standard::from_name("sideways"), None);
}

#[test]
fn matrices_and_project_agree_and_depth_runs_from_0_to_1() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for aspect in [0.5, 1.0, WIDE] {
            let mut camera = Camera { projection, ..Camera::default() };
            camera.set_standard(Standard::Home, &unit(), aspect);
            let (near, far) = camera.clip_range(&unit());
            assert!(near < far);
            for corner in unit().corners() {
                let seen = through_matrices(&camera, corner, aspect, &unit());
                let told = camera.project(corner, aspect).unwrap();
                assert!((seen.truncate() - told.truncate()).length() < 1e-5, "{seen} {told}");
                assert!((0.0..=1.0).contains(&seen.z), "{seen}");
                assert!((near..=far).contains(&told.z));
            }
            let at = |depth: f32| camera.eye() - camera.basis().back * depth;
            assert!(through_matrices(&camera, at(near), aspect, &unit()).z.abs() < 1e-4);
            assert!((through_matrices(&camera, at(far), aspect, &unit()).z - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn framing_touches_the_margin_and_no_more() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for aspect in [0.4, 1.0, 2.5] {
            for standard in Standard::ALL {
                let mut camera = Camera { projection, ..Camera::default() };
                camera.set_standard(standard, &unit(), aspect);
                let reach = unit().corners().map(|c| {
                    let p = camera.project(c, aspect).unwrap();
                    p.x.abs().max(p.y.abs())
                });
                let most = reach.into_iter().fold(0.0, f32::max);
                assert!((most - 0.9).abs() < 1e-4, "{projection:?} {aspect} {standard:?}: {most}");
                assert_eq!(camera.target, Vec3::ZERO);
                assert_eq!(camera.standard, Some(standard));
            }
        }
    }
}

#[test]
fn both_projections_show_the_target_plane_alike() {
    let mut camera = Camera::default();
    camera.orbit(vec2(0.1, 0.2));
    let basis = camera.basis();
    let p = camera.target + basis.right * 0.3 - basis.up * 0.2;
    let perspective = camera.project(p, WIDE).unwrap();
    camera.projection = Projection::Orthographic;
    assert!(close(perspective, camera.project(p, WIDE).unwrap(), 1e-6));
}

#[test]
fn a_drag_to_the_right_turns_the_front_to_the_right() {
    let mut camera = Camera::default();
    camera.set_standard(Standard::Front, &unit(), 1.0);
    let nose = vec3(0.0, 0.0, 3.0);
    camera.orbit(vec2(0.1, 0.0));
    assert!(camera.project(nose, 1.0).unwrap().x > 0.1);
    assert_eq!((camera.yaw, camera.standard), (-18.0, None));
    camera.orbit(vec2(-0.1, 0.1));
    let seen = camera.project(nose, 1.0).unwrap();
    assert!(seen.x.abs() < 1e-5 && seen.y < -0.1, "a drag down looks from above: {seen}");
    camera.orbit(vec2(0.0, 9.0));
    assert_eq!(camera.pitch, 90.0);
    camera.orbit(vec2(1.5, 0.0));
    assert_eq!(camera.yaw, 90.0);
}

#[test]
fn a_pivot_comes_to_the_middle_at_the_same_size() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut camera = Camera { projection, ..Camera::default() };
        camera.set_standard(Standard::Iso, &unit(), WIDE);
        let (p, beside) = (vec3(1.0, 2.0, 3.0), camera.basis().right * 0.01);
        let width = |c: &Camera| (c.project(p + beside, WIDE).unwrap() - c.project(p, WIDE).unwrap()).x;
        let before = width(&camera);
        camera.set_pivot(p);
        assert!(camera.project(p, WIDE).unwrap().truncate().length() < 1e-6);
        assert!((width(&camera) / before - 1.0).abs() < 1e-3);
        let here = camera;
        camera.set_pivot(vec3(f32::NAN, 0.0, 0.0));
        assert_eq!(camera, here);
    }
}

#[test]
fn dolly_stops_without_drifting() {
    let mut camera = Camera::default();
    camera.set_standard(Standard::Front, &unit(), 1.0);
    for _ in 0..200 {
        camera.dolly(0.5, vec2(0.7, 0.3), 1.0, &unit());
    }
    let diagonal = unit().diagonal();
    assert!((camera.distance - diagonal * 1e-3).abs() < 1e-6);
    let here = camera;
    camera.dolly(0.5, vec2(-0.9, 0.9), 1.0, &unit());
    assert_eq!(camera, here);
    camera.dolly(f32::NAN, Vec2::ZERO, 1.0, &unit());
    camera.dolly(-1.0, Vec2::ZERO, 1.0, &unit());
    assert_eq!(camera, here);
    camera.dolly(1e30, Vec2::ZERO, 1.0, &unit());
    assert!((camera.distance / (diagonal * 100.0) - 1.0).abs() < 1e-6);
    assert!(wheel_factor(100.0) > 1.0 && (wheel_factor(100.0) * wheel_factor(-100.0) - 1.0).abs() < 1e-6);
    assert_eq!(wheel_factor(f32::NAN), 1.0);
}

#[test]
fn fingers_keep_what_is_under_them() {
    for aspect in [0.5, WIDE] {
        let mut camera = Camera::default();
        camera.set_standard(Standard::Top, &unit(), aspect);
        let before = [vec2(-0.2, 0.1), vec2(0.3, 0.2)];
        let now = [vec2(-0.4, 0.0), vec2(0.3, 0.5)];
        let points = before.map(|f| {
            let ray = camera.ray(f, aspect);
            // Where it meets the target plane y = 0.
            ray.origin - ray.direction * (ray.origin.y / ray.direction.y)
        });
        camera.pinch(&Pinch::between(before, now, aspect), aspect, &unit());
        let seen = points.map(|p| camera.project(p, aspect).unwrap().truncate());
        // The twist turns about the target, not between the fingers: the distance and the angle between them are kept.
        let stretch = if aspect >= 1.0 { vec2(aspect, 1.0) } else { vec2(1.0, 1.0 / aspect) };
        let (got, want) = ((seen[1] - seen[0]) * stretch, (now[1] - now[0]) * stretch);
        assert!((got - want).length() < 1e-3, "{got} {want}");
    }
    let still = Pinch::between([Vec2::ZERO; 2], [Vec2::ONE; 2], 1.0);
    assert_eq!((still.scale, still.twist, still.pan), (1.0, 0.0, Vec2::ONE));
    let quarter = Pinch::between([vec2(-0.5, 0.0), vec2(0.5, 0.0)], [vec2(0.0, -1.0), vec2(0.0, 1.0)], 1.0);
    assert!((quarter.twist - 90.0).abs() < 1e-4 && (quarter.scale - 2.0).abs() < 1e-6);
}

#[test]
fn a_point_a_line_and_huge_numbers_give_sound_cameras() {
    for bounds in [
        Bounds::new(Vec3::ONE, Vec3::ONE),
        Bounds::new(Vec3::ZERO, vec3(0.0, 0.0, 5.0)),
        Bounds::new(Vec3::splat(-1e30), Vec3::splat(1e30)),
        Bounds::new(Vec3::splat(1e-30), Vec3::splat(2e-30)),
    ] {
        for standard in Standard::ALL {
            let mut camera = Camera::default();
            camera.set_standard(standard, &bounds, WIDE);
            assert!(camera.distance > 0.0 && camera.distance.is_finite(), "{bounds:?}");
            let (near, far) = camera.clip_range(&bounds);
            assert!(near > 0.0 && far > near && far.is_finite(), "{bounds:?} {near} {far}");
        }
    }
    assert_eq!(Bounds::of(&[[f32::NAN; 3]]), None);
    assert_eq!(Bounds::of(&[[1.0, 2.0, 3.0], [f32::INFINITY; 3], [0.0, 5.0, 3.0]]).unwrap().max, vec3(1.0, 5.0, 3.0));
}

#[test]
fn a_camera_follows_a_model_that_is_moved_and_scaled() {
    let mut camera = Camera::default();
    camera.set_standard(Standard::Home, &unit(), WIDE);
    camera.orbit(vec2(0.1, 0.1));
    let p = vec3(0.5, 1.5, -2.0);
    let before = camera.project(p, WIDE).unwrap();
    let moved = Bounds::new(unit().min * 3.0 + 7.0, unit().max * 3.0 + 7.0);
    camera.follow(&unit(), &moved, WIDE);
    let after = camera.project(p * 3.0 + 7.0, WIDE).unwrap();
    assert!((before - after).truncate().length() < 1e-5);
}

#[test]
fn blending_takes_the_short_way_and_ends_exactly() {
    let a = Camera { yaw: 170.0, distance: 1.0, standard: None, ..Camera::default() };
    let b = Camera { yaw: -170.0, distance: 4.0, ..a };
    let half = a.blend(&b, 0.5);
    assert_eq!(half.yaw, 180.0);
    assert!((half.distance - 2.0).abs() < 1e-6);
    assert_eq!(a.blend(&b, 1.0), b);
    assert_eq!((wrap_degrees(-180.0), wrap_degrees(540.0), wrap_degrees(-190.0)), (180.0, 180.0, 170.0));
}

#[test]
fn poses_in_links_are_short() {
    let mut view = View::default();
    assert!(view.settings().is_empty());
    view.camera.standard = None;
    (view.camera.yaw, view.camera.pitch, view.camera.distance) = (33.333_332, -0.04, 4.567_891);
    view.camera.target = vec3(0.123_456, -1e-9, 100.0);
    let text: Vec<String> = view.settings().iter().map(ToString::to_string).collect();
    assert_eq!(text, ["camera=33.3,0,4.568,0.123,0,100"]);
    view.camera.distance = 45_678.9;
    view.camera.target = vec3(123_456.0, -4.0, 6.0);
    let text: Vec<String> = view.settings().iter().map(ToString::to_string).collect();
    assert_eq!(text, ["camera=33.3,0,45680,123460,0,10"]);
}

#[test]
fn rounding_leaves_a_named_view_as_it_frames_the_model() {
    // A link says "home": whoever follows it frames the model anew, and must see what the sender sees at rest.
    let bounds = Bounds::new(vec3(-0.123_456, -0.3, -0.7), vec3(0.234_567, 0.9, 0.8));
    let mut camera = Camera::default();
    camera.set_standard(Standard::Home, &bounds, 1.37);
    assert_eq!(camera.quantised(), camera);
    camera.standard = None;
    assert_ne!(camera.quantised(), camera);
}

fn camera() -> impl Strategy<Value = Camera> {
    let number = || prop_oneof![-10.0_f32..10.0, -1e6_f32..1e6];
    (-180.0_f32..180.0, -90.0_f32..=90.0, prop_oneof![0.01_f32..100.0, 1e-9_f32..1e9], number(), number(), number())
        .prop_map(|(yaw, pitch, distance, x, y, z)| Camera {
            yaw,
            pitch,
            distance,
            target: vec3(x, y, z),
            standard: None,
            ..Camera::default()
        })
}

proptest! {
    #[test]
    fn rounding_twice_is_rounding_once(camera in camera()) {
        let once = camera.quantised();
        prop_assert_eq!(once.quantised(), once);
        prop_assert!((once.distance / camera.distance - 1.0).abs() < 1e-3);
        prop_assert!((once.target - camera.target).abs().max_element() <= camera.distance * 1e-3 + camera.target.abs().max_element() * 1e-6);
        // The view command brings exactly the rounded camera.
        let view = View { camera, ..View::default() };
        let mut back = View::default();
        for set in view.settings() {
            let text = set.to_string();
            let (key, value) = text.split_once('=').unwrap();
            back.set(&limn_document::ViewSet::parse(key, value).unwrap(), &unit(), WIDE);
        }
        prop_assert_eq!(back.camera, once);
    }

    #[test]
    fn a_ray_goes_through_what_it_points_at(camera in camera(), x in -1.0_f32..1.0, y in -1.0_f32..1.0, ortho: bool) {
        let projection = if ortho { Projection::Orthographic } else { Projection::Perspective };
        let camera = Camera { projection, target: Vec3::ZERO, ..camera };
        let ray = camera.ray(vec2(x, y), WIDE);
        prop_assert!((ray.direction.length() - 1.0).abs() < 1e-5);
        for t in [0.5, 1.0, 3.0] {
            let seen = camera.project(ray.origin + ray.direction * (t * camera.distance), WIDE).unwrap();
            prop_assert!((seen.truncate() - vec2(x, y)).length() < 1e-3, "{} {} {}", seen, x, y);
        }
    }

    #[test]
    fn pan_and_dolly_keep_the_point_under_the_pointer(
        camera in camera(), x in -1.0_f32..1.0, y in -1.0_f32..1.0, dx in -0.5_f32..0.5, dy in -0.5_f32..0.5, factor in 0.5_f32..2.0,
    ) {
        let mut camera = Camera { target: Vec3::ZERO, distance: 5.0, ..camera };
        let ray = camera.ray(vec2(x, y), WIDE);
        // Where it meets the target plane.
        let back = camera.basis().back;
        let p = ray.origin - ray.direction * (ray.origin.dot(back) / ray.direction.dot(back));
        // A movement over the shorter side is 2 units of the pointer's range, y the other way round.
        camera.pan(vec2(dx, dy));
        let seen = camera.project(p, WIDE).unwrap().truncate();
        prop_assert!((seen - vec2(x + 2.0 * dx / WIDE, y - 2.0 * dy)).length() < 1e-3, "{}", seen);
        camera.dolly(factor, seen, WIDE, &unit());
        prop_assert!((camera.project(p, WIDE).unwrap().truncate() - seen).length() < 1e-3);
        prop_assert!((camera.distance - 5.0 * factor).abs() < 1e-5);
    }
}
