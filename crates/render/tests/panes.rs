//! Several surfaces in one picture, and faces by kind.

mod common;

use common::{Picture, Quads, cube, frame, orthographic, renderer};
use glam::{Mat4, Vec3};
use limn_render::{Background, Faces, Frame, Renderer, Style, SurfaceData};

/// Black on white, unlit: what is drawn is told from what is not.
fn plain(base: [f32; 3]) -> Style {
    Style { lit: false, base, background: Background::Solid([1.0; 3]), ground: None, ..Style::light() }
}

/// From the front, in the left or right half of a picture twice as wide as high.
fn half(right: bool, style: Style) -> Frame<'static> {
    let mut frame = frame(orthographic([0.0, 0.0, 5.0], [0.0; 3], 1.0, 2.0, 3.0), style);
    let side = Mat4::from_translation(Vec3::X * if right { 0.5 } else { -0.5 });
    frame.camera.proj = side * Mat4::from_scale(Vec3::new(0.5, 1.0, 1.0)) * frame.camera.proj;
    frame
}

fn show(renderer: &mut Renderer, pane: usize, quads: &Quads) {
    let normals = quads.normals();
    let mut data = SurfaceData::new(&quads.points, &normals, Faces::Quads(&quads.quads));
    data.parents = quads.parents;
    let mut upload = renderer.upload(&data).unwrap();
    while !upload.step(renderer.gpu(), &data, 1 << 16).unwrap() {}
    renderer.show_in(pane, Some(upload.finish()));
}

fn shoot(renderer: &mut Renderer, frames: &[(&Frame<'_>, [u32; 4])]) -> Picture {
    let rgba = pollster::block_on(renderer.image_panes(frames, 128, 64).unwrap()).unwrap();
    assert_eq!(renderer.gpu().take_errors(), [] as [String; 0]);
    Picture { width: 128, height: 64, rgba }
}

fn count(picture: &Picture, from: u32, to: u32, what: impl Fn([u8; 4]) -> bool) -> usize {
    (0..64).flat_map(|y| (from..to).map(move |x| (x, y))).filter(|&(x, y)| what(picture.at(x, y))).count()
}

const RED: fn([u8; 4]) -> bool = |p| p[0] > 200 && p[1] < 60;
const BLUE: fn([u8; 4]) -> bool = |p| p[2] > 200 && p[0] < 60;

#[test]
fn each_pane_draws_its_own_surface_in_its_own_part() {
    let Some(mut renderer) = renderer() else { return };
    show(&mut renderer, 0, &cube());
    show(&mut renderer, 1, &cube().levels(2));
    let (left, right) = (half(false, plain([1.0, 0.0, 0.0])), half(true, plain([0.0, 0.0, 1.0])));
    let parts = [[0, 0, 64, 64], [64, 0, 64, 64]];
    let picture = shoot(&mut renderer, &[(&left, parts[0]), (&right, parts[1])]);
    // The cube is half as wide as its pane; Catmull-Clark's is smaller.
    assert_eq!(count(&picture, 0, 64, RED), 32 * 32);
    let smooth = count(&picture, 64, 128, BLUE);
    assert!(smooth > 300 && smooth < 32 * 32 - 100, "{smooth}");
    assert_eq!(count(&picture, 0, 64, BLUE) + count(&picture, 64, 128, RED), 0);
    // Nothing is drawn past a pane's edge.
    let picture = shoot(&mut renderer, &[(&left, [0, 0, 32, 64]), (&right, parts[1])]);
    assert_eq!(count(&picture, 0, 32, RED), 16 * 32);
    assert_eq!(count(&picture, 32, 64, RED), 0);
    // They change places, and the second goes.
    renderer.swap(0, 1);
    let picture = shoot(&mut renderer, &[(&left, parts[0]), (&right, parts[1])]);
    assert_eq!((count(&picture, 0, 64, RED), count(&picture, 64, 128, BLUE)), (smooth, 32 * 32));
    renderer.keep_panes(1);
    let picture = shoot(&mut renderer, &[(&left, parts[0]), (&right, parts[1])]);
    assert_eq!((count(&picture, 0, 64, RED), count(&picture, 64, 128, BLUE)), (smooth, 0));
    renderer.swap(0, 7);
    assert!(renderer.surface_in(1).is_none() && renderer.surface().is_some());
}

#[test]
fn points_go_with_their_pane_and_their_surface() {
    let Some(mut renderer) = renderer() else { return };
    show(&mut renderer, 0, &cube());
    show(&mut renderer, 1, &cube());
    renderer.set_points_in(1, &[[0.0, 0.0, 1.5]]).unwrap();
    assert!(renderer.has_points(1) && !renderer.has_points(0));
    let style = Style { points: true, point: [0.0, 1.0, 0.0, 1.0], point_size: 8.0, ..plain([1.0, 0.0, 0.0]) };
    let (left, right) = (half(false, style.clone()), half(true, style));
    let frames = [(&left, [0, 0, 64, 64]), (&right, [64, 0, 64, 64])];
    let green = |p: [u8; 4]| p[1] > 200 && p[0] < 60;
    let picture = shoot(&mut renderer, &frames);
    assert!(count(&picture, 92, 100, green) > 20 && count(&picture, 0, 64, green) == 0);
    show(&mut renderer, 1, &cube());
    assert!(!renderer.has_points(1), "another surface has other points");
}

#[test]
fn faces_are_coloured_by_their_kind() {
    let Some(mut renderer) = renderer() else { return };
    let cube = cube();
    let normals = cube.normals();
    // The face in front is an edge's, all others have no kind.
    let front = |f: usize| cube.quads[4 * f..4 * f + 4].iter().all(|&v| cube.points[v as usize][2] > 0.0);
    let kind = |f: usize| if front(f) { 2 } else { 0 };
    let mut data = SurfaceData::new(&cube.points, &normals, Faces::Quads(&cube.quads));
    data.kind_of = Some(&kind);
    renderer.set_surface(&data).unwrap();
    let kinds = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let style = Style { kinds: Some(kinds), ..plain([1.0, 0.0, 0.0]) };
    let whole = [0, 0, 128, 64];
    let picture = shoot(&mut renderer, &[(&half(false, style.clone()), whole)]);
    assert_eq!((count(&picture, 0, 64, BLUE), count(&picture, 0, 64, RED)), (32 * 32, 0));
    // From behind there is none; without the switch there is none anywhere.
    let mut behind = half(false, style);
    behind.camera.view *= Mat4::from_rotation_y(std::f32::consts::PI);
    assert_eq!(count(&shoot(&mut renderer, &[(&behind, whole)]), 0, 64, RED), 32 * 32);
    assert_eq!(count(&shoot(&mut renderer, &[(&half(false, plain([1.0, 0.0, 0.0])), whole)]), 0, 64, RED), 32 * 32);
}
