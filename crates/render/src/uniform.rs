//! The frame's uniform buffer as the shaders read it (`Globals` in common.wgsl), filled from camera and style.
//!
//! The matrix has the camera's translation taken out: shaders subtract the eye first. Widths become half widths in device
//! pixels, colours linear light (except the background's, which is mixed as encoded).

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Mat4, Vec3};

use crate::ground::Placement;
use crate::style::{Background, Edges, Frame, Shading};
use crate::{light, pack};

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Globals {
    pub view_proj: [[f32; 4]; 4],
    pub eye: [f32; 4],
    pub toward: [f32; 4],
    pub viewport: [f32; 4],
    pub sh: light::Irradiance,
    pub boxes: [light::SoftBox; 3],
    pub base: [f32; 4],
    pub back: [f32; 4],
    pub edge_old: [f32; 4],
    pub edge_new: [f32; 4],
    pub cage: [f32; 4],
    pub point: [f32; 4],
    pub top: [f32; 4],
    pub bottom: [f32; 4],
    pub widths: [f32; 4],
    pub ground: [f32; 4],
    pub ground_x: [f32; 4],
    pub ground_y: [f32; 4],
    pub bits: [u32; 4],
    pub hidden: [f32; 4],
    pub kinds: [[f32; 4]; 3],
}

const FLAT: u32 = 1;
const LIT: u32 = 2;
const TWO_SIDED: u32 = 4;
const TEXTURES: u32 = 8;
const COLORS: u32 = 16;
const MATERIALS: u32 = 32;
const TRANSPARENT: u32 = 64;
const STRAIGHT: u32 = 128;
const KINDS: u32 = 256;

/// What of the data the switches depend on.
pub(crate) struct Content {
    pub kinds: [u32; 2],
    pub has_colors: bool,
    pub has_uv: bool,
    pub ground: Option<Placement>,
}

/// The camera taken apart.
pub(crate) struct Viewer {
    pub eye: Vec3,
    /// Eye to world.
    pub rotation: Mat3,
    pub perspective: bool,
}

impl Viewer {
    pub fn new(view: &Mat4, proj: &Mat4) -> Viewer {
        let rotation = Mat3::from_mat4(*view).transpose();
        let eye = rotation * -view.w_axis.truncate();
        Viewer { eye, rotation, perspective: proj.w_axis.w == 0.0 }
    }
}

pub(crate) fn linear([r, g, b]: [f32; 3], a: f32) -> [f32; 4] {
    [pack::decode(r), pack::decode(g), pack::decode(b), a]
}

pub(crate) fn globals(frame: &Frame<'_>, size: [u32; 2], content: &Content, straight: bool) -> Globals {
    let style = &frame.style;
    let camera = &frame.camera;
    let viewer = Viewer::new(&camera.view, &camera.proj);
    let view_proj = camera.proj * Mat4::from_mat3(viewer.rotation.transpose());
    let toward = viewer.rotation * Vec3::Z;
    let (w, h) = (size[0].max(1) as f32, size[1].max(1) as f32);
    // One pixel at distance 1 (perspective) or anywhere (orthographic).
    let pixel = 2.0 / (camera.proj.y_axis.y.abs().max(1e-20) * h);
    let (sh, boxes) = light::studio(viewer.rotation, camera.up);
    let rgb4 = |c: [f32; 4], a: f32| linear([c[0], c[1], c[2]], c[3] * a);
    let wire = style.edges == Edges::Wire;
    let edge = if wire { style.wire } else { style.edge };
    let (old, new, wide, thin) = match style.edges {
        Edges::Off => (0.0, 0.0, 1.0, 1.0),
        Edges::On | Edges::Wire => (1.0, 1.0, 1.0, 1.0),
        Edges::Bold => (1.0, 0.42, 1.5, 0.8),
    };
    let half = |css: f32| 0.5 * css * frame.pixel_ratio;
    let mut bits = 0;
    let mut set = |on: bool, bit: u32| bits |= if on { bit } else { 0 };
    set(style.shading == Shading::Flat, FLAT);
    set(style.lit, LIT);
    set(style.two_sided, TWO_SIDED);
    set(style.textures && content.has_uv, TEXTURES);
    set(style.colors && content.has_colors, COLORS);
    set(style.materials, MATERIALS);
    set(style.kinds.is_some(), KINDS);
    let (top, bottom) = match style.background {
        Background::Solid(c) => (c, c),
        Background::Gradient(a, b) => (a, b),
        Background::Transparent => {
            set(true, TRANSPARENT);
            set(straight, STRAIGHT);
            ([0.0; 3], [0.0; 3])
        }
    };
    let (ground, ground_x, ground_y) = match &content.ground {
        Some(p) => {
            let strength = style.ground.map_or(0.0, |s| s.strength.clamp(0.0, 1.0));
            let center = (p.center - viewer.eye).extend(strength);
            (center.into(), p.x.extend(0.0).into(), p.y.extend(0.0).into())
        }
        None => Default::default(),
    };
    Globals {
        view_proj: view_proj.to_cols_array_2d(),
        eye: viewer.eye.extend(if viewer.perspective { 1.0 } else { 0.0 }).into(),
        toward: toward.extend(pixel).into(),
        viewport: [w, h, 1.0 / w, 1.0 / h],
        sh,
        boxes,
        base: linear(style.base, 1.0),
        back: linear(style.back, 1.0),
        edge_old: rgb4(edge, old),
        edge_new: rgb4(edge, new),
        cage: rgb4(style.cage_color, 1.0),
        point: rgb4(style.point, 1.0),
        top: [top[0], top[1], top[2], 1.0],
        bottom: [bottom[0], bottom[1], bottom[2], 1.0],
        widths: [
            half(style.edge_width * wide),
            half(style.edge_width * thin),
            half(style.cage_width),
            half(style.point_size),
        ],
        ground,
        ground_x,
        ground_y,
        bits: [bits, content.kinds[0], content.kinds[1], 0],
        hidden: [style.hidden.clamp(0.0, 1.0), 0.0, 0.0, 0.0],
        kinds: style.kinds.unwrap_or_default().map(|c| linear(c, 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_is_found_in_the_view_matrix() {
        let rotation = Mat3::from_rotation_y(0.7) * Mat3::from_rotation_x(-0.4);
        let eye = Vec3::new(3.0, -2.0, 5.0);
        let view = Mat4::from_mat3(rotation.transpose()) * Mat4::from_translation(-eye);
        let viewer = Viewer::new(&view, &Mat4::IDENTITY);
        assert!((viewer.eye - eye).length() < 1e-5);
        assert!((viewer.rotation * Vec3::Z - rotation * Vec3::Z).length() < 1e-6);
        assert!(!viewer.perspective);
    }
}
