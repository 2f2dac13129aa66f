// Shared by every drawing module: the frame's one uniform buffer. Positions are taken relative to the eye before any
// matrix sees them, which keeps close-ups of far-away models steady.

struct Globals {
    view_proj: mat4x4<f32>,      // eye-relative world to clip
    eye: vec4<f32>,              // position; w: 1 perspective, 0 orthographic
    toward: vec4<f32>,           // orthographic: unit direction to the viewer; w: one pixel in world units (at distance 1)
    viewport: vec4<f32>,         // width, height, 1 / width, 1 / height, in device pixels
    sh: array<vec4<f32>, 9>,     // irradiance / pi as spherical harmonics
    boxes: array<vec4<f32>, 12>, // three soft boxes: direction, right / half width, up / half height, radiance
    base: vec4<f32>,             // linear colours from here on
    back: vec4<f32>,
    edge_old: vec4<f32>,
    edge_new: vec4<f32>,
    cage: vec4<f32>,
    point: vec4<f32>,
    top: vec4<f32>,
    bottom: vec4<f32>,
    widths: vec4<f32>,           // half widths of old and new edges and the cage, radius of points, in device pixels
    ground: vec4<f32>,           // centre of the map relative to the eye; w: strength
    ground_x: vec4<f32>,         // the map's half sides as world vectors
    ground_y: vec4<f32>,
    bits: vec4<u32>,             // switches, end of old vertices, end of face points, unused
    hidden: vec4<f32>,           // opacity of hidden lines
    kinds: array<vec4<f32>, 3>,  // colours of faces by kind
};

const FLAT: u32 = 1u;
const LIT: u32 = 2u;
const TWO_SIDED: u32 = 4u;
const TEXTURES: u32 = 8u;
const COLORS: u32 = 16u;
const MATERIALS: u32 = 32u;
const TRANSPARENT: u32 = 64u;
const STRAIGHT: u32 = 128u;
const KINDS: u32 = 256u;

@group(0) @binding(0) var<uniform> g: Globals;

fn is_on(bit: u32) -> bool {
    return (g.bits.x & bit) != 0u;
}
