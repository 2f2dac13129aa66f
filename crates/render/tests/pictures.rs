//! Pixels, on whichever Vulkan adapter there is (a software one in CI). Mostly unlit and orthographic, so that the
//! expected values can be worked out by hand. `LIMN_GPU=require` fails where no adapter is found.

mod common;

use common::{Picture, Quads, cube, frame, orthographic, perspective, renderer, shoot, torus};
use glam::Vec3;
use limn_layout::Error as Data;
use limn_render::{
    Background, Edges, Error, Faces, Frame, Ground, Material, Part, Renderer, Shading, Style, SurfaceData, TextureData,
    Upload,
};

const WHITE: [f32; 3] = [1.0; 3];

/// No light, no ground, red surface, white background.
fn plain() -> Style {
    Style {
        lit: false,
        ground: None,
        base: [1.0, 0.0, 0.0],
        background: Background::Solid(WHITE),
        edge: [0.0, 0.0, 0.0, 1.0],
        edge_width: 2.0,
        ..Style::light()
    }
}

/// From +z at the origin; the view is 4 units high, so 16 pixels a unit at 64 pixels.
fn front(style: Style) -> Frame<'static> {
    frame(orthographic([0.0, 0.0, 10.0], [0.0; 3], 1.0, 2.0, 9.0), style)
}

/// The square [-1, 1]² in z = 0, one quad split once: 9 vertices in the order old, face, edges.
fn square() -> Quads {
    let points = vec![
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
    ];
    let quads = vec![0, 5, 4, 8, 1, 6, 4, 5, 2, 7, 4, 6, 3, 8, 4, 7];
    Quads { points, quads, parents: Some([4, 5]) }
}

fn set(r: &mut Renderer, m: &Quads, force_corners: bool) {
    let normals = m.normals();
    let mut data = SurfaceData::new(&m.points, &normals, Faces::Quads(&m.quads));
    data.parents = m.parents;
    data.force_corners = force_corners;
    assert_eq!(data.is_shared(), !force_corners && m.parents.is_some());
    r.set_surface(&data).unwrap();
}

fn near(a: [u8; 4], b: [u8; 4], by: u8) -> bool {
    a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) <= by)
}

fn assert_near(a: [u8; 4], b: [u8; 4], by: u8) {
    assert!(near(a, b, by), "{a:?} is not within {by} of {b:?}");
}

/// Pixels that differ by more than `by`.
fn differing(a: &Picture, b: &Picture, by: u8) -> usize {
    a.rgba.chunks(4).zip(b.rgba.chunks(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > by)).count()
}

#[test]
fn colours_arrive_as_given() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &square(), false);
    for (base, behind) in [([0.8, 0.5, 0.2], [0.1, 0.6, 0.9]), ([0.04, 0.99, 0.0], [0.02, 0.5, 1.0])] {
        let style = Style { base, background: Background::Solid(behind), ..plain() };
        let p = shoot(&mut r, &front(style), 64, 64);
        let bytes = |c: [f32; 3]| [c[0], c[1], c[2], 1.0].map(|v| (v * 255.0f32).round() as u8);
        assert_near(p.at(32, 32), bytes(base), 1);
        assert_near(p.at(20, 44), bytes(base), 1);
        assert_near(p.at(3, 3), bytes(behind), 1);
        assert_near(p.at(60, 32), bytes(behind), 1);
    }
    let style = Style { background: Background::Gradient([0.0; 3], WHITE), surface: false, ..plain() };
    let p = shoot(&mut r, &front(style), 64, 64);
    for y in 0..64u32 {
        let expected = ((y as f32 + 0.5) / 64.0 * 255.0).round() as u8;
        assert_near(p.at(7, y), [expected, expected, expected, 255], 1);
    }
}

#[test]
fn sizes_are_exact_in_both_projections() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &square(), false);
    let p = shoot(&mut r, &front(plain()), 64, 64);
    // 2 of 4 units: pixels 16 to 47.
    for (x, inside) in [(15, false), (16, true), (47, true), (48, false)] {
        assert_eq!(p.at(x, 32)[1] == 0, inside, "column {x}");
        assert_eq!(p.at(32, x)[1] == 0, inside, "row {x}");
    }
    // In perspective, 30 degrees at distance 10 show 2 * 10 tan 15 = 5.359 units: the square takes 23.9 of 64 pixels.
    let camera = perspective([0.0, 0.0, 10.0], [0.0; 3], 1.0, 5.0);
    let p = shoot(&mut r, &frame(camera, plain()), 64, 64);
    let row: u32 = (0..64).map(|x| u32::from(255 - p.at(x, 32)[1])).sum();
    assert!((row as f32 / 255.0 - 23.88).abs() < 0.6, "{row}");
}

#[test]
fn true_edges_are_drawn_and_diagonals_are_not() {
    let Some(mut r) = renderer() else { return };
    for corners in [false, true] {
        set(&mut r, &square(), corners);
        let p = shoot(&mut r, &front(Style { edges: Edges::On, ..plain() }), 64, 64);
        // The rim, half a line wide inside the square, and the cross in the middle.
        for (x, y) in [(16, 25), (47, 40), (25, 16), (40, 47), (31, 20), (32, 44), (20, 31), (44, 32)] {
            assert_near(p.at(x, y), [0, 0, 0, 255], 4);
        }
        // Along both diagonals of all four quads, away from the lines.
        for d in [20, 22, 25, 27, 36, 38, 41, 43] {
            assert_near(p.at(d, d), [255, 0, 0, 255], 2);
            assert_near(p.at(d, 63 - d), [255, 0, 0, 255], 2);
        }
    }
    // A quad of no known parents hides its diagonal as well, and so does a concave pentagon its two.
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-0.5, 0.0, 0.0]];
    let normals = [[0.0, 0.0, 1.0]; 5];
    let (offsets, corners) = ([0, 5], [4, 0, 1, 2, 3]);
    let data = SurfaceData::new(&points, &normals, Faces::Polygons { offsets: &offsets, corners: &corners });
    r.set_surface(&data).unwrap();
    let p = shoot(&mut r, &front(Style { edges: Edges::On, ..plain() }), 64, 64);
    assert_near(p.at(17, 32), [255, 255, 255, 255], 2);
    // The fan from (-0.5, 0) has diagonals to (1, -1) and (1, 1); (0.25, 0.5) lies on one.
    for (x, y) in [(35, 23), (35, 40), (40, 32)] {
        assert_near(p.at(x, y), [255, 0, 0, 255], 2);
    }
    assert_near(p.at(32, 16), [0, 0, 0, 255], 4);
}

#[test]
fn parent_edges_are_bold_and_new_ones_faint() {
    let Some(mut r) = renderer() else { return };
    for corners in [false, true] {
        set(&mut r, &square(), corners);
        let style = Style { edges: Edges::Bold, edge_width: 4.0, ..plain() };
        let p = shoot(&mut r, &front(style), 64, 64);
        // Bold: 6 pixels wide, half of them inside. New: 3.2 pixels wide and 42% black over red, mixed in linear light.
        assert_near(p.at(17, 25), [0, 0, 0, 255], 4);
        assert_near(p.at(25, 45), [0, 0, 0, 255], 4);
        let faint = p.at(32, 24);
        let expected = (limn_render::pack::encode(0.58) * 255.0).round() as u8;
        assert_near(faint, [expected, 0, 0, 255], 3);
        assert_near(p.at(35, 24), [255, 0, 0, 255], 2);
    }
}

#[test]
fn lines_keep_their_width_in_css_pixels() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &square(), false);
    let ink = |r: &mut Renderer, ratio: f32, size: u32| {
        let mut f = front(Style { edges: Edges::On, ..plain() });
        f.pixel_ratio = ratio;
        let p = shoot(r, &f, size, size);
        let y = size * 3 / 8;
        (size * 3 / 8..size * 5 / 8).map(|x| 1.0 - f32::from(p.at(x, y)[0]) / 255.0).sum::<f32>()
    };
    let one = ink(&mut r, 1.0, 64);
    let two = ink(&mut r, 2.0, 128);
    assert!((1.5..2.6).contains(&one), "{one}");
    assert!((two / one - 2.0).abs() < 0.35, "{one} {two}");
}

#[test]
fn both_layouts_give_one_picture() {
    let Some(mut r) = renderer() else { return };
    let m = cube().levels(3);
    let camera = perspective([4.0, 3.0, 5.0], [0.0; 3], 1.0, 3.0);
    for edges in [Edges::Off, Edges::Bold, Edges::Wire] {
        let f = frame(camera, Style { edges, ..Style::light() });
        set(&mut r, &m, false);
        let a = shoot(&mut r, &f, 256, 256);
        set(&mut r, &m, true);
        let b = shoot(&mut r, &f, 256, 256);
        let n = differing(&a, &b, 2);
        assert!(n < 40, "{edges:?}: {n}");
    }
}

#[test]
fn flat_shading_has_one_colour_a_face() {
    let Some(mut r) = renderer() else { return };
    // A quad bent along its diagonal: exact flat shading shows one facet, the shared layout two.
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.6], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.6]];
    let normals = [[0.0, 0.0, 1.0], [0.7, 0.0, 0.7], [0.0, 0.7, 0.7], [-0.7, 0.0, 0.7]];
    let quads = [0, 1, 2, 3];
    r.set_surface(&SurfaceData::new(&points, &normals, Faces::Quads(&quads))).unwrap();
    let lit = |shading| Style { shading, lit: true, base: [0.7; 3], ..plain() };
    let flat = shoot(&mut r, &front(lit(Shading::Flat)), 64, 64);
    let smooth = shoot(&mut r, &front(lit(Shading::Smooth)), 64, 64);
    assert_near(flat.at(38, 26), flat.at(26, 38), 2);
    assert_near(flat.at(24, 24), flat.at(40, 40), 2);
    assert!(!near(smooth.at(20, 44), smooth.at(44, 20), 8));
    assert!(differing(&flat, &smooth, 4) > 300);
    // From derivatives: within a triangle one colour, and the same on a plane as from data.
    let m = square();
    set(&mut r, &m, false);
    let a = shoot(&mut r, &front(lit(Shading::Flat)), 64, 64);
    set(&mut r, &m, true);
    let b = shoot(&mut r, &front(lit(Shading::Flat)), 64, 64);
    assert_eq!(differing(&a, &b, 1), 0);
    assert!(a.at(20, 20)[0] > 120 && a.at(20, 20)[0] < 255);
}

#[test]
fn light_comes_from_above_left_and_back_faces_are_lit_or_tinted() {
    let Some(mut r) = renderer() else { return };
    let m = cube().levels(4);
    set(&mut r, &m, false);
    let style = Style { lit: true, base: [0.7; 3], ..plain() };
    let p = shoot(&mut r, &front(style.clone()), 64, 64);
    let (bright, dark) = (p.at(27, 25)[1], p.at(38, 40)[1]);
    assert!(bright > dark + 25, "{bright} {dark}");
    // A square seen from behind.
    let mut m = square();
    for q in m.quads.chunks_mut(4) {
        q.swap(1, 3);
    }
    set(&mut r, &m, false);
    let both = shoot(&mut r, &front(style.clone()), 64, 64).at(24, 24);
    assert!(
        both[0] > 120
            && near(
                both,
                [both[0]; 3].map(|v| v).into_iter().chain([255]).collect::<Vec<_>>()[..].try_into().unwrap(),
                12
            )
    );
    let tinted = shoot(&mut r, &front(Style { two_sided: false, back: [0.0, 0.0, 1.0], ..style }), 64, 64).at(24, 24);
    assert!(tinted[2] > 120 && tinted[0] < 90, "{tinted:?}");
}

#[test]
fn the_cage_shows_fully_in_front_and_faintly_behind() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &square(), false);
    let points = [[-1.8, 0.5, 1.0], [1.8, 0.5, 1.0], [-1.8, -0.5, -1.0], [1.8, -0.5, -1.0]];
    r.set_cage(&points, &[[0, 1], [2, 3]], &[]).unwrap();
    let style = Style { cage: true, cage_color: [0.0, 0.0, 1.0, 1.0], cage_width: 4.0, hidden: 0.3, ..plain() };
    let p = shoot(&mut r, &front(style.clone()), 64, 64);
    for x in [6, 20, 40, 57] {
        assert_near(p.at(x, 24), [0, 0, 255, 255], 3);
        assert_near(p.at(x, 23), [0, 0, 255, 255], 3);
    }
    for x in [6, 57] {
        assert_near(p.at(x, 40), [0, 0, 255, 255], 3);
    }
    // Hidden: 30% blue over red, in linear light.
    let e = |v: f32| (limn_render::pack::encode(v) * 255.0).round() as u8;
    for x in [20, 40] {
        assert_near(p.at(x, 40), [e(0.7), 0, e(0.3), 255], 3);
    }
    // Off, and a cage that lies in the surface.
    let p = shoot(&mut r, &front(Style { cage: false, ..style.clone() }), 64, 64);
    assert_near(p.at(20, 24), [255, 0, 0, 255], 2);
    r.set_cage(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[[0, 1]], &[]).unwrap();
    let p = shoot(&mut r, &front(style.clone()), 64, 64);
    assert!((17..47).all(|x| near(p.at(x, 32), [0, 0, 255, 255], 3)));
    // Marked: twice as wide and red; and a dot four times as wide, hidden in its upper half by nothing.
    let ends = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    r.set_cage(&ends, &[[0, 1], [2, 2]], &[1.0, 3.0]).unwrap();
    let on_white = front(Style { surface: false, ..style });
    let p = shoot(&mut r, &on_white, 64, 64);
    for (y, seen) in [(27, false), (29, true), (32, true), (34, true), (37, false)] {
        assert_eq!(near(p.at(32, y), [255, 0, 0, 255], 3), seen, "{y}: {:?}", p.at(32, y));
    }
    for (at, seen) in [([32, 16], true), ([26, 16], true), ([38, 16], true), ([32, 10], true), ([41, 16], false)] {
        assert_eq!(near(p.at(at[0], at[1]), [255, 0, 0, 255], 3), seen, "{at:?}: {:?}", p.at(at[0], at[1]));
    }
    assert_eq!(
        r.set_cage(&points, &[[0, 1], [2, 7]], &[]),
        Err(Data::Index { corner: 3, index: 7, vertices: 4 }.into())
    );
}

#[test]
fn lines_that_pass_the_eye_are_cut_at_the_near_plane() {
    let Some(mut r) = renderer() else { return };
    // From far ahead to far behind, to the right of the eye: seen from the middle to the right rim.
    r.set_cage(&[[0.5, 0.0, 0.0], [0.5, 0.0, 40.0]], &[[0, 1]], &[]).unwrap();
    let camera = perspective([0.0, 0.0, 10.0], [0.0; 3], 1.0, 11.0);
    let style = Style { cage: true, cage_color: [0.0, 0.0, 0.0, 1.0], cage_width: 3.0, ..plain() };
    let p = shoot(&mut r, &frame(camera, style), 64, 64);
    // At z = 0: 0.5 / (10 tan 15) = 0.187 of half the width.
    assert_near(p.at(34, 32), [255, 255, 255, 255], 2);
    for x in 40..64 {
        assert_near(p.at(x, 32), [0, 0, 0, 255], 3);
    }
    assert!((0..30).all(|x| p.at(x, 32)[0] == 255));
}

#[test]
fn wire_shows_only_lines_and_hidden_ones_faintly() {
    let Some(mut r) = renderer() else { return };
    // Two squares, the far one shifted by a quarter.
    let mut m = square();
    let far: Vec<_> = m.points.iter().map(|p| [p[0] * 0.5 + 0.25, p[1] * 0.5 + 0.25, -1.0]).collect();
    let both: Vec<[f32; 3]> = [&m.points[..], &far].concat();
    m.quads.extend(square().quads.iter().map(|v| v + 9));
    let normals = vec![[0.0, 0.0, 1.0]; both.len()];
    r.set_surface(&SurfaceData::new(&both, &normals, Faces::Quads(&m.quads))).unwrap();
    let style = Style { edges: Edges::Wire, wire: [0.0, 0.0, 0.0, 1.0], hidden: 0.5, ..plain() };
    let p = shoot(&mut r, &front(style.clone()), 64, 64);
    assert_near(p.at(22, 42), [255, 255, 255, 255], 1);
    assert_near(p.at(32, 44), [0, 0, 0, 255], 4);
    // The far square's left rim at x = -0.25, y = 0.5 is behind: 50% black over white.
    let e = (limn_render::pack::encode(0.5) * 255.0).round() as u8;
    assert_near(p.at(28, 24), [e, e, e, 255], 4);
    let p = shoot(&mut r, &front(Style { hidden: 0.0, ..style }), 64, 64);
    assert_near(p.at(28, 24), [255, 255, 255, 255], 2);
}

#[test]
fn points_are_round_and_as_large_as_asked() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &square(), false);
    let style = Style { points: true, point: [0.0, 0.0, 1.0, 1.0], point_size: 8.0, ..plain() };
    // Without points of their own the shared vertices serve.
    let p = shoot(&mut r, &front(style.clone()), 64, 64);
    let blue = |p: &Picture| p.rgba.chunks(4).filter(|c| c[2] > 200 && c[0] < 60).count();
    assert_near(p.at(32, 32), [0, 0, 255, 255], 2);
    assert_near(p.at(16, 16), [0, 0, 255, 255], 2);
    // Nine discs of pi 4² = 50 pixels each.
    assert!((9 * 38..9 * 58).contains(&blue(&p)), "{}", blue(&p));
    assert!(!near(p.at(28, 28), [0, 0, 255, 255], 40), "the corners of the disc are not filled");
    r.set_points(&[[0.0, 0.5, 0.5], [0.0, -0.5, -0.5]]).unwrap();
    let p = shoot(&mut r, &front(style), 64, 64);
    assert_near(p.at(32, 24), [0, 0, 255, 255], 2);
    assert_near(p.at(32, 40), [255, 0, 0, 255], 2);
    assert!((38..58).contains(&blue(&p)), "{}", blue(&p));
}

#[test]
fn transparent_pictures_have_straight_alpha_and_soft_edges() {
    let Some(mut r) = renderer() else { return };
    let mut m = square();
    for p in &mut m.points {
        let q = glam::Quat::from_rotation_z(0.3) * Vec3::from(*p);
        *p = q.into();
    }
    set(&mut r, &m, false);
    let style = Style { background: Background::Transparent, base: [0.8, 0.5, 0.2], ..plain() };
    let p = shoot(&mut r, &front(style), 64, 64);
    assert_eq!(p.at(2, 2)[3], 0);
    assert_near(p.at(32, 32), [204, 128, 51, 255], 1);
    // Four samples: quarter steps of alpha along the rim, the colour unchanged.
    let mut steps = [0; 5];
    for c in p.rgba.chunks(4) {
        let step = (f32::from(c[3]) / 63.75).round();
        assert!((f32::from(c[3]) - step * 63.75).abs() < 3.0, "{c:?}");
        steps[step as usize] += 1;
        if c[3] > 0 {
            assert_near([c[0], c[1], c[2], 255], [204, 128, 51, 255], 3);
        }
    }
    // How the three kinds of rim pixels share depends on the adapter's sample pattern.
    assert!(steps[1] > 20 && steps[3] > 20 && steps[1] + steps[2] + steps[3] > 80, "{steps:?}");
    // The area is that of the square: 1024 pixels.
    let area = steps.iter().enumerate().map(|(i, n)| i * n).sum::<usize>() as f32 / 4.0;
    assert!((area - 1024.0).abs() < 12.0, "{area}");
}

#[test]
fn textures_colours_and_materials_meet_at_the_right_corners() {
    let Some(mut r) = renderer() else { return };
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let normals = [[0.0, 0.0, 1.0]; 4];
    let quads = [0, 1, 2, 3];
    let values = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut data = SurfaceData::new(&points, &normals, Faces::Quads(&quads));
    data.uv = Some((&values, &quads));
    let parts = [Part { material: 0, group: 0 }];
    data.parts = &parts;
    r.set_surface(&data).unwrap();
    // 2 x 2: top row red, green; bottom row blue, grey.
    let mut rgba = Vec::new();
    for y in 0..64 {
        for x in 0..64 {
            rgba.extend(match (y < 32, x < 32) {
                (true, true) => [255, 0, 0, 255],
                (true, false) => [0, 255, 0, 255],
                (false, true) => [0, 0, 255, 255],
                (false, false) => [128, 128, 128, 255],
            });
        }
    }
    r.set_textures(&[TextureData { width: 64, height: 64, rgba: &rgba }]).unwrap();
    r.set_materials(&[Material { base_color: [1.0; 4], texture: Some(0) }]);
    let p = shoot(&mut r, &front(plain()), 64, 64);
    assert_near(p.at(22, 22), [255, 0, 0, 255], 2);
    assert_near(p.at(42, 22), [0, 255, 0, 255], 2);
    assert_near(p.at(22, 42), [0, 0, 255, 255], 2);
    assert_near(p.at(42, 42), [128, 128, 128, 255], 2);
    let p = shoot(&mut r, &front(Style { textures: false, ..plain() }), 64, 64);
    assert_near(p.at(22, 22), [255, 255, 255, 255], 2);
    // Two repeats a pixel: the smallest of the halved copies is the mean of all four, in linear light.
    let many = values.map(|v| v.map(|c| c * 64.0));
    data.uv = Some((&many, &quads));
    r.set_surface(&data).unwrap();
    let p = shoot(&mut r, &front(plain()), 64, 64);
    let mean = 0.25 + 0.25 * limn_render::pack::decode(128.0 / 255.0);
    let mean = (limn_render::pack::encode(mean) * 255.0).round() as u8;
    assert_near(p.at(30, 35), [mean, mean, mean, 255], 3);

    // Colours: a corner each in both layouts; a material multiplies.
    let m = square();
    let n = m.normals();
    let mut colors = [[0.0, 0.0, 1.0, 1.0]; 9];
    for v in [0, 5, 4, 8] {
        colors[v] = [0.0, 0.215_861, 0.0, 1.0];
    }
    for corners in [false, true] {
        let mut data = SurfaceData::new(&m.points, &n, Faces::Quads(&m.quads));
        data.parents = m.parents;
        data.colors = &colors;
        data.force_corners = corners;
        r.set_surface(&data).unwrap();
        let p = shoot(&mut r, &front(plain()), 64, 64);
        assert_near(p.at(24, 40), [0, 128, 0, 255], 2);
        assert_near(p.at(46, 17), [0, 39, 244, 255], 8);
        let p = shoot(&mut r, &front(Style { colors: false, ..plain() }), 64, 64);
        assert_near(p.at(24, 40), [255, 0, 0, 255], 2);
    }
}

#[test]
fn parts_have_their_materials_and_groups_are_hidden() {
    let Some(mut r) = renderer() else { return };
    r.set_materials(&[
        Material { base_color: [0.0, 1.0, 0.0, 1.0], texture: None },
        Material { base_color: [0.0, 0.0, 1.0, 1.0], texture: None },
    ]);
    let m = square();
    let n = m.normals();
    let parts = [Part { material: 1, group: 0 }, Part { material: 0, group: 1 }, Part { material: 9, group: 2 }];
    // Faces in turn: bottom left, bottom right, top right, top left.
    let of = |f: usize| [1, 0, 2, 1][f];
    for corners in [false, true] {
        let mut data = SurfaceData::new(&m.points, &n, Faces::Quads(&m.quads));
        data.parents = m.parents;
        data.force_corners = corners;
        data.parts = &parts;
        data.part_of = Some(&of);
        // Pieces of one quad each: a run of several pieces must come out whole.
        let mut upload = Upload::with_chunk(r.gpu(), &data, 24).unwrap();
        while !upload.step(r.gpu(), &data, 1).unwrap() {
            assert!(upload.progress() < 1.0);
        }
        assert_eq!(upload.progress(), 1.0);
        r.show(Some(upload.finish()));
        let mut f = front(plain());
        let at = |p: &Picture| [(24, 40), (40, 40), (40, 24), (24, 24)].map(|(x, y)| p.at(x, y));
        let (red, green, blue, white) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]);
        for (c, e) in at(&shoot(&mut r, &f, 64, 64)).into_iter().zip([green, blue, red, green]) {
            assert_near(c, e, 2);
        }
        f.hidden_groups = &[false, true];
        for (c, e) in at(&shoot(&mut r, &f, 64, 64)).into_iter().zip([white, blue, red, white]) {
            assert_near(c, e, 2);
        }
        f.style.materials = false;
        f.hidden_groups = &[];
        assert!(at(&shoot(&mut r, &f, 64, 64)).into_iter().all(|c| near(c, red, 2)));
    }
}

#[test]
fn many_pieces_give_the_picture_of_one() {
    let Some(mut r) = renderer() else { return };
    let m = torus(40, 20, 0.42).levels(3);
    assert_eq!(m.quads.len() / 4, 51_200);
    let n = m.normals();
    let f = frame(perspective([2.5, 2.0, 3.0], [0.0; 3], 1.0, 3.0), Style { edges: Edges::On, ..Style::dark() });
    let mut pictures = Vec::new();
    for corners in [false, true] {
        for chunk in [1 << 26, 100_000] {
            let mut data = SurfaceData::new(&m.points, &n, Faces::Quads(&m.quads));
            data.parents = m.parents;
            data.force_corners = corners;
            let mut upload = Upload::with_chunk(r.gpu(), &data, chunk).unwrap();
            while !upload.step(r.gpu(), &data, 3000).unwrap() {}
            let surface = upload.finish();
            assert!(surface.bytes() >= data.gpu_bytes() && surface.bytes() < data.gpu_bytes() + 200_000);
            r.show(Some(surface));
            pictures.push(shoot(&mut r, &f, 300, 300));
        }
    }
    assert_eq!(differing(&pictures[0], &pictures[1], 0), 0);
    assert_eq!(differing(&pictures[2], &pictures[3], 0), 0);
    assert!(differing(&pictures[0], &pictures[2], 3) < 90);
    let b = r.bounds().unwrap();
    assert!((b.max[0] - 1.42).abs() < 0.02 && (b.max[1] - 0.42).abs() < 0.02, "{b:?}");
}

#[test]
fn the_ground_carries_a_shadow_seen_from_above_only() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &cube().levels(2), false);
    let style = Style { ground: Some(Ground { height: Some(-1.2), strength: 0.8 }), ..plain() };
    let above = frame(perspective([0.0, 8.0, 8.0], [0.0, -1.2, 0.0], 1.0, 8.0), style.clone());
    let p = shoot(&mut r, &above, 128, 128);
    // In front of the model the ground is darker than the white background, less and less so towards the rim.
    let end = (0..128).rev().find(|&y| p.at(64, y)[1] == 0).unwrap();
    let ground: Vec<u8> = (end + 2..128).map(|y| p.at(64, y)[2]).collect();
    assert!(ground[0] < 225 && ground[ground.len() - 1] > 250, "{ground:?}");
    assert!(ground.windows(2).all(|w| w[1] >= w[0].saturating_sub(1)), "{ground:?}");
    // From below, and with everything hidden, there is none.
    let below = frame(perspective([0.0, -8.0, 8.0], [0.0; 3], 1.0, 8.0), style.clone());
    let p = shoot(&mut r, &below, 128, 128);
    assert!(p.rgba.chunks(4).all(|c| c[0] >= 254), "red and white have full red, a shadow has not");
    let mut hidden = above.clone();
    hidden.hidden_groups = &[true];
    let p = shoot(&mut r, &hidden, 128, 128);
    assert!(p.rgba.chunks(4).all(|c| c[..3] == [255; 3]));
}

#[test]
fn up_can_be_z() {
    let Some(mut r) = renderer() else { return };
    set(&mut r, &cube().levels(3), false);
    let shot = |r: &mut Renderer, up: Vec3| {
        let mut camera = orthographic([0.0, 0.0, 10.0], [0.0; 3], 1.0, 2.0, 9.0);
        camera.up = up;
        shoot(r, &frame(camera, Style { lit: true, base: [0.5; 3], ..plain() }), 64, 64).at(32, 32)[0]
    };
    // Lit by the sky when it is behind the viewer, by the ground when that is.
    let (toward, away) = (shot(&mut r, Vec3::Z), shot(&mut r, Vec3::NEG_Z));
    assert!(toward > away + 4, "{toward} {away}");
}

#[test]
fn what_does_not_fit_is_refused_with_the_numbers() {
    let Some(mut r) = renderer() else { return };
    let most = r.gpu().max_side();
    let error = r.image(&front(plain()), most + 1, 4).err();
    assert_eq!(error, Some(Error::ImageSize { width: most + 1, height: 4, limit: most }));
    assert!(r.image(&front(plain()), 0, 4).is_err());
    let m = square();
    let n = m.normals();
    let mut quads = m.quads.clone();
    quads[6] = 40;
    let mut data = SurfaceData::new(&m.points, &n, Faces::Quads(&quads));
    data.parents = m.parents;
    assert_eq!(r.set_surface(&data), Err(Data::Index { corner: 6, index: 40, vertices: 9 }.into()));
    quads[6] = 3;
    let mut data = SurfaceData::new(&m.points, &n, Faces::Quads(&quads));
    data.parents = m.parents;
    assert!(matches!(r.set_surface(&data), Err(Error::Data(Data::Order { face: 1 }))));
    assert_eq!(
        r.set_textures(&[TextureData { width: 2, height: 2, rgba: &[0; 12] }]),
        Err(Data::Mismatch { what: "bytes of a texture", found: 12, expected: 16 }.into())
    );
    assert!(matches!(
        r.set_textures(&[TextureData { width: 0, height: 2, rgba: &[] }]),
        Err(Error::TextureSize { index: 0, .. })
    ));
    // Nothing at all is a picture too.
    r.set_surface(&SurfaceData::new(&[], &[], Faces::Triangles(&[]))).unwrap();
    assert_eq!(r.bounds(), None);
    let p = shoot(&mut r, &frame(front(plain()).camera, Style::light()), 16, 16);
    assert!(p.at(8, 8)[0] > 200);
    assert_eq!(r.gpu().lost(), None);
}

#[test]
fn dense_meshes_fade_into_the_surface_instead_of_ink() {
    let Some(mut r) = renderer() else { return };
    let m = cube().levels(6);
    set(&mut r, &m, false);
    let f = front(Style { edges: Edges::On, edge_width: 1.0, base: WHITE, ..plain() });
    let p = shoot(&mut r, &f, 64, 64);
    let c = p.at(32, 32);
    assert!(c[0] > 150, "{c:?}");
}
