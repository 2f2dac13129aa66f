//! The built-in models, made by code: `builtin:cube`, `builtin:creature` and so on.
//!
//! They are cages, meant to be subdivided: small ones that show what a scheme does to a corner, an edge or a boundary, and a few
//! that look like something. Every model is about two units in size, has y up and faces +z; closed ones have their faces
//! turn anticlockwise seen from outside. Coordinates that are not plain fractions come from `libm` in f64, so that every
//! platform gets the same bits.
//!
//! ```text
//!   solids    cube pyramid tetrahedron octahedron icosahedron dodecahedron t-shape
//!   sheets    torus grid moebius
//!   pawn  mouse  creature
//! ```

mod cage;
mod creature;
mod mouse;
mod pawn;
mod sheets;
mod solids;

use crate::soup::Soup;

/// A built-in model.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// What it is called in commands and links: lower case, words joined by `-`.
    pub name: &'static str,
    /// One line for menus and help.
    pub summary: &'static str,
    /// Makes the cage. The creature takes a few milliseconds, the others microseconds.
    pub build: fn() -> Soup,
}

/// All built-in models, in the order of menus.
pub static SHAPES: &[Shape] = &[
    Shape { name: "creature", summary: "A small dragon: 1,450 quads", build: creature::creature },
    Shape { name: "pawn", summary: "A turned chess piece: 304 triangles", build: pawn::pawn },
    Shape { name: "mouse", summary: "A computer mouse: 53 quads and a hexagon", build: mouse::mouse },
    Shape { name: "t-shape", summary: "Four cubes as a T: 18 quads", build: solids::t_shape },
    Shape { name: "torus", summary: "A ring: 128 quads, every corner regular", build: sheets::torus },
    Shape { name: "moebius", summary: "A one-sided strip: 16 quads", build: sheets::moebius },
    Shape { name: "grid", summary: "An open saddle: 64 quads", build: sheets::grid },
    Shape { name: "cube", summary: "6 squares", build: solids::cube },
    Shape { name: "pyramid", summary: "A square pyramid: 6 triangles, two of them the base", build: solids::pyramid },
    Shape { name: "tetrahedron", summary: "4 triangles", build: solids::tetrahedron },
    Shape { name: "octahedron", summary: "8 triangles", build: solids::octahedron },
    Shape { name: "icosahedron", summary: "20 triangles", build: solids::icosahedron },
    Shape { name: "dodecahedron", summary: "12 pentagons", build: solids::dodecahedron },
];

/// The built-in model of that name.
pub fn shape(name: &str) -> Option<&'static Shape> {
    SHAPES.iter().find(|shape| shape.name == name)
}
