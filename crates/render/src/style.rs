//! What a frame looks like: camera, style and size. Plain values that the caller sets anew for each frame.
//!
//! Colours are given as sRGB triples in 0..=1, the way a style sheet has them; the renderer does its sums in linear
//! light. Widths are CSS pixels; `pixel_ratio` turns them into device pixels.

use glam::{Mat4, Vec3};

/// Where the viewer is.
///
/// `view` takes world to eye space (right-handed, looking along -z) and must be a rotation with a translation;
/// `proj` takes eye space to clip space with depth 0 at the near plane and 1 at the far plane. A projection whose last
/// row is (0, 0, 0, 1) is taken for an orthographic one. Keep near and far close around the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World to eye.
    pub view: Mat4,
    /// Eye to clip, depth 0..=1.
    pub proj: Mat4,
    /// The world's up direction (unit): the light of the sky comes from there, the ground lies below.
    pub up: Vec3,
}

/// How normals are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// Interpolated vertex normals.
    #[default]
    Smooth,
    /// One normal a face. Exact for polygons in the corner layout; in the shared layout the two triangles of a bent
    /// quad have one each.
    Flat,
}

/// Which edges of the surface are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edges {
    /// None.
    #[default]
    Off,
    /// All alike.
    On,
    /// Edges of the level before bold, new ones faint.
    Bold,
    /// Only edges: the surface hides what is behind it but is not painted; hidden edges show faintly.
    Wire,
}

/// What is behind the model. Colours are sRGB, 0..=1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// One colour.
    Solid([f32; 3]),
    /// From top to bottom.
    Gradient([f32; 3], [f32; 3]),
    /// Nothing: a picture gets straight alpha, a canvas premultiplied alpha.
    Transparent,
}

/// A ground to stand on: a plane that only catches a soft contact shadow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Height of the plane along [`Camera::up`], in world units; none puts it under the lowest point.
    pub height: Option<f32>,
    /// Darkness of the shadow, 0..=1.
    pub strength: f32,
}

/// How the model is drawn. `Style::light()` and `Style::dark()` are complete looks to start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// Smooth or flat.
    pub shading: Shading,
    /// Edges of the surface.
    pub edges: Edges,
    /// Whether the surface itself is shown; the cage and points do not depend on it.
    pub surface: bool,
    /// Whether points are shown (those of [`crate::Renderer::set_points`], or the vertices of shared quads).
    pub points: bool,
    /// Whether the cage is shown.
    pub cage: bool,
    /// Whether back faces are lit like front faces; otherwise they take [`Style::back`].
    pub two_sided: bool,
    /// Whether base-colour textures are used.
    pub textures: bool,
    /// Whether vertex colours are used.
    pub colors: bool,
    /// Whether the materials' own colours are used; otherwise [`Style::base`] stands for all.
    pub materials: bool,
    /// sRGB colours of faces by their kind (see [`crate::SurfaceData::kind_of`]), in place of all other colours; none ignores kinds.
    pub kinds: Option<[[f32; 3]; 3]>,
    /// Whether there is light at all. Without it colours appear as they are: for flat pictures and tests.
    pub lit: bool,
    /// sRGB colour of surfaces without a material.
    pub base: [f32; 3],
    /// sRGB colour of back faces when lighting is one-sided.
    pub back: [f32; 3],
    /// sRGB colour and opacity of edges.
    pub edge: [f32; 4],
    /// sRGB colour and opacity of edges where only they are shown ([`Edges::Wire`]), against the background.
    pub wire: [f32; 4],
    /// Width of edges in CSS pixels.
    pub edge_width: f32,
    /// sRGB colour and opacity of the cage's lines. What is marked has red and blue swapped.
    pub cage_color: [f32; 4],
    /// Width of the cage's lines in CSS pixels.
    pub cage_width: f32,
    /// sRGB colour and opacity of points.
    pub point: [f32; 4],
    /// Diameter of points in CSS pixels.
    pub point_size: f32,
    /// Opacity of what is hidden (cage, wire) relative to what is not, 0..=1.
    pub hidden: f32,
    /// What is behind the model.
    pub background: Background,
    /// The contact shadow, if any.
    pub ground: Option<Ground>,
}

impl Style {
    /// The studio on a light page.
    pub fn light() -> Style {
        Style {
            shading: Shading::Smooth,
            edges: Edges::Off,
            surface: true,
            points: false,
            cage: false,
            two_sided: true,
            textures: true,
            colors: true,
            materials: true,
            kinds: None,
            lit: true,
            base: [0.80, 0.79, 0.77],
            back: [0.78, 0.50, 0.42],
            edge: [0.10, 0.11, 0.14, 0.82],
            wire: [0.13, 0.15, 0.19, 1.0],
            edge_width: 1.0,
            cage_color: [0.05, 0.36, 0.78, 1.0],
            cage_width: 1.6,
            point: [0.07, 0.28, 0.62, 1.0],
            point_size: 5.0,
            hidden: 0.22,
            background: Background::Gradient([0.965, 0.968, 0.975], [0.875, 0.882, 0.895]),
            ground: Some(Ground { height: None, strength: 0.5 }),
        }
    }

    /// The studio on a dark page.
    pub fn dark() -> Style {
        Style {
            base: [0.76, 0.765, 0.78],
            back: [0.66, 0.40, 0.33],
            edge: [0.03, 0.035, 0.05, 0.85],
            wire: [0.80, 0.83, 0.88, 1.0],
            cage_color: [0.45, 0.74, 1.0, 1.0],
            point: [0.62, 0.83, 1.0, 1.0],
            background: Background::Gradient([0.135, 0.145, 0.165], [0.062, 0.068, 0.08]),
            ground: Some(Ground { height: None, strength: 0.6 }),
            ..Style::light()
        }
    }
}

/// One frame: everything but the data on the GPU.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame<'a> {
    /// Where from.
    pub camera: Camera,
    /// How.
    pub style: Style,
    /// Device pixels to a CSS pixel, above 0.
    pub pixel_ratio: f32,
    /// Which groups are hidden, by group number; groups past the end are shown.
    pub hidden_groups: &'a [bool],
}
