//! What the page tells of a scheme: facts from the registry, and its rules as pictures, as one text of JSON.
//!
//! ```json
//! {"name":"Loop","group":"approximating","summary":"...","source":"...","takes":"triangles","rim":"...","keeps":false,
//!  "params":[{"name":"Weights","summary":"...","range":"loop or warren"}],
//!  "valences":[3,4,5,6,7,8],"dual":false,
//!  "stencils":[{"title":"Edge point","target":[0.5,0],"points":[[0,0]],"faces":[[0,1,2]],"weights":[[0,0.375,"3/8"]]}]}
//! ```
//!
//! The writer is a few lines: a JSON library would be larger than all that it writes.

use std::fmt::Write;

use limn_mesh::stencil::{Stencil, VALENCES, boundary, fraction, stencils};
use limn_mesh::{Accepts, Domain, Family, Params, scheme};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// Tells of the scheme with this id; its parameters have these values in the order of the registry, and their defaults after
/// the last. The irregular pictures are of `valence`. Empty if there is no such scheme.
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub fn about(id: &str, values: &[f64], valence: u32) -> String {
    let Some(entry) = scheme(id) else { return String::new() };
    let info = &entry.info;
    let mut params = Params::default();
    for (at, value) in values.iter().enumerate() {
        params.set(info, at, *value);
    }
    let takes = match info.accepts {
        Accepts::Polygons | Accepts::Both => "any polygons",
        Accepts::Triangles => "triangles; other faces are cut first",
        Accepts::TrianglesThenQuads => "triangles, which become quads; other faces are cut first",
    };
    let mut out = String::from("{\"name\":");
    for (text, next) in [
        (info.name, ",\"group\":"),
        (info.group, ",\"summary\":"),
        (info.summary, ",\"source\":"),
        (info.source, ",\"takes\":"),
        (takes, ",\"rim\":"),
        (boundary(entry, params), ",\"keeps\":"),
    ] {
        string(text, &mut out);
        out.push_str(next);
    }
    // Writing to a string cannot fail.
    let _ = write!(out, "{},\"params\":", info.interpolating);
    list(info.params, &mut out, |param, out| {
        out.push_str("{\"name\":");
        string(param.name, out);
        out.push_str(",\"summary\":");
        string(param.summary, out);
        out.push_str(",\"range\":");
        let range = match &param.domain {
            Domain::Number { low, high, default } => format!("{low} to {high}, {default} unless set"),
            Domain::Whole { low, high, default } => format!("{low} to {high}, {default} unless set"),
            Domain::Choice(words) => words.join(" or "),
        };
        string(&range, out);
        out.push('}');
    });
    out.push_str(",\"valences\":");
    list(&VALENCES.collect::<Vec<_>>(), &mut out, |v, out| _ = write!(out, "{v}"));
    let _ = write!(out, ",\"dual\":{},\"stencils\":", info.family == Family::Dual);
    list(&stencils(entry, params, valence), &mut out, picture);
    out.push('}');
    out
}

fn picture(stencil: &Stencil, out: &mut String) {
    out.push_str("{\"title\":");
    string(&stencil.title, out);
    let point = |[x, y]: &[f64; 2], out: &mut String| _ = write!(out, "[{x:.4},{y:.4}]");
    out.push_str(",\"target\":");
    point(&stencil.target, out);
    out.push_str(",\"points\":");
    list(&stencil.points, out, point);
    out.push_str(",\"faces\":");
    list(&stencil.faces, out, |face, out| list(face, out, |v, out| _ = write!(out, "{v}")));
    out.push_str(",\"weights\":");
    list(&stencil.weights, out, |(v, weight), out| {
        let _ = write!(out, "[{v},{weight:.6},");
        string(&fraction(*weight), out);
        out.push(']');
    });
    out.push('}');
}

fn list<T>(items: &[T], out: &mut String, mut write: impl FnMut(&T, &mut String)) {
    out.push('[');
    for (i, item) in items.iter().enumerate() {
        if i > 0 {
            out.push(',');
        }
        write(item, out);
    }
    out.push(']');
}

/// Appends `text` in quotes. What the registry holds has no control characters.
fn string(text: &str, out: &mut String) {
    out.push('"');
    for c in text.chars() {
        if matches!(c, '"' | '\\') {
            out.push('\\');
        }
        out.push(c);
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use limn_mesh::SCHEMES;

    #[test]
    fn one_object_a_scheme() {
        for entry in SCHEMES {
            let text = about(entry.info.id, &[], 5);
            assert!(text.starts_with("{\"name\":\"") && text.ends_with("]}"), "{text}");
            let count = |c: char| text.chars().filter(|x| *x == c).count();
            assert_eq!((count('['), count('{')), (count(']'), count('}')));
            assert!(!text.contains("NaN") && !text.contains("inf,"), "{text}");
            assert!(!text.chars().any(char::is_control), "{text}");
        }
        assert_eq!(about("nothing", &[], 5), "");
        let text = about("loop", &[1.0], 3);
        assert!(
            text.contains("\"takes\":\"triangles; other faces are cut first\",\"rim\":\"a cubic B-spline"),
            "{text}"
        );
        assert!(text.contains("\"range\":\"loop or warren\""), "{text}");
        // Without tension the wings go; rims keep theirs.
        let (usual, flat) = (about("butterfly", &[], 6), about("butterfly", &[0.0], 6));
        assert!(usual.contains("\"1/8\"") && flat.contains("\"1/2\"") && !flat.contains("\"1/8\""), "{flat}");
    }
}
