//! Shorthand for keys and clicks: words that depend on what is chosen now, made into commands of the grammar.
//!
//! ```text
//!   toggle edges   ->  view edges=on        step 1   ->  level 3
//!   turn 15 0      ->  the camera, as a drag would      zoom 0.8  ->  the same, as a wheel would
//!   mark crease 2 310 205   ->  crease 4-5 2: the edge under that place of the canvas
//! ```

use glam::Vec2;
use limn_document::Document;
use limn_document::camera::{Projection, UpAxis};
use limn_document::numbers::single;
use limn_document::view::{Edges, Shading};

/// The first words that are shorthand.
pub const WORDS: [&str; 5] = ["toggle", "step", "turn", "zoom", "mark"];

/// What shorthand stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Short<'a> {
    /// A command.
    Command(String),
    /// A turn of the camera, in degrees to the right and up.
    Turn(Vec2),
    /// A factor for the camera's distance.
    Zoom(f32),
    /// A mark on what lies under a place on the canvas, in CSS pixels.
    Mark {
        /// The command: `crease`, `corner`, `hole` or `knot`.
        what: &'a str,
        /// Its last argument; `hole` has none.
        amount: &'a str,
        /// The place.
        at: Vec2,
    },
}

/// What `text` stands for; none if it is no shorthand.
pub fn expand<'a>(text: &'a str, document: &Document) -> Option<Short<'a>> {
    let mut words = text.split_whitespace();
    let (first, second, third) = (words.next()?, words.next()?, words.next());
    match first {
        "toggle" => {
            let view = document.view();
            let on = |on: bool| if on { "off" } else { "on" };
            let value = match second {
                "edges" => on(view.edges != Edges::Off),
                "points" => on(view.points),
                "cage" => on(view.cage),
                "two-sided" => on(view.two_sided),
                "textures" => on(view.textures),
                "colors" => on(view.colors),
                "kinds" => on(view.kinds),
                "shading" => match view.shading {
                    Shading::Smooth => "flat",
                    Shading::Flat => "smooth",
                },
                "projection" => match view.camera.projection {
                    Projection::Perspective => "orthographic",
                    Projection::Orthographic => "perspective",
                },
                "up" => match view.camera.up {
                    UpAxis::Y => "z",
                    UpAxis::Z => "y",
                },
                _ => return None,
            };
            Some(Short::Command(format!("view {second}={value}")))
        }
        "step" => {
            let level = i64::from(document.plan()?.level) + second.parse::<i64>().ok()?;
            Some(Short::Command(format!("level {}", level.clamp(0, i64::from(document.highest_level())))))
        }
        "turn" => Some(Short::Turn(Vec2::new(single(second)?, single(third?)?))),
        "zoom" => Some(Short::Zoom(single(second).filter(|f| *f > 0.0)?)),
        "mark" => {
            let mut place = || words.next().and_then(single);
            Some(Short::Mark { what: second, amount: third?, at: Vec2::new(place()?, place()?) })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toggles_say_the_other_and_steps_stay_in_range() {
        let mut document = Document::new(1 << 30);
        document.run("open builtin:cube").unwrap();
        let command = |d: &Document, text: &str| match expand(text, d) {
            Some(Short::Command(c)) => c,
            other => panic!("{other:?}"),
        };
        assert_eq!(command(&document, "toggle edges"), "view edges=on");
        document.run("view edges=bold shading=flat").unwrap();
        assert_eq!(command(&document, "toggle edges"), "view edges=off");
        assert_eq!(command(&document, "toggle shading"), "view shading=smooth");
        assert_eq!(command(&document, "step 1"), "level 1");
        assert_eq!(command(&document, "step -1"), "level 0");
        assert_eq!(command(&document, "step 99"), format!("level {}", document.highest_level()));
        assert_eq!(expand("turn 15 -15", &document), Some(Short::Turn(Vec2::new(15.0, -15.0))));
        assert_eq!(expand("zoom 0.8", &document), Some(Short::Zoom(0.8)));
        assert_eq!(
            expand("mark crease 2.5 10 20", &document),
            Some(Short::Mark { what: "crease", amount: "2.5", at: Vec2::new(10.0, 20.0) })
        );
        for text in
            ["level 3", "mark crease 2 1", "mark", "toggle nothing", "zoom -1", "zoom", "turn 1", "turn inf 0", ""]
        {
            assert_eq!(expand(text, &document), None, "{text}");
        }
    }
}
