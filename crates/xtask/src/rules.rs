//! The house rules that no compiler knows, as a scan over the text of the tracked files.
//!
//! Each rule is a function from a file to sentences about it. The scan reads lines, not syntax: comments are cut off,
//! and code below `#[cfg(test)]` counts as tests. That is coarse on purpose; what needs real understanding (`unwrap`,
//! `expect`, indexing and `panic!` on input paths) is left to clippy's restriction lints, see `tidy.rs`.

use crate::process;
use crate::{paths, tidy};
use anyhow::Result;
use std::fs;

/// A file over this many lines needs a reason in [`LONG`].
const LINES: usize = 500;

/// Files that may be longer than [`LINES`], and why.
const LONG: &[(&str, &str)] = &[
    ("crates/formats/src/obj.rs", "one pass over the text, whose state every statement shares"),
    ("crates/formats/tests/gltf.rs", "small files written out in place, a test each"),
    ("crates/mesh/tests/limit.rs", "one way to measure a limit, a test for each that claims one"),
    ("crates/mesh/tests/naive_apart.rs", "one reference of cut meshes, and every scheme that is held against it"),
    ("crates/render/tests/pictures.rs", "pictures of one scene, a test each, with the scene's helpers"),
];

/// What must not occur in the code of a folder: a reason and the words.
const BANNED: &[(&str, &str, &[&str])] = &[
    (
        "crates/mesh/src/",
        "the kernel has no I/O, clock, GPU or browser",
        &[
            "std::fs",
            "std::net",
            "std::time",
            "std::env",
            "std::process",
            "std::io",
            "println!",
            "eprintln!",
            "wgpu",
            "web_sys",
            "js_sys",
            "wasm_bindgen",
        ],
    ),
    (
        "crates/mesh/src/",
        "native and wasm give the same bits: take it from libm, and iterate nothing in a hash's order",
        &[
            ".sin()",
            ".cos()",
            ".tan()",
            ".sin_cos()",
            ".asin()",
            ".acos()",
            ".atan()",
            ".atan2(",
            ".exp()",
            ".exp2()",
            ".ln()",
            ".log2()",
            ".log10()",
            ".powf(",
            ".powi(",
            ".cbrt()",
            ".hypot(",
            ".sinh()",
            ".cosh()",
            ".tanh()",
            "HashMap",
            "HashSet",
        ],
    ),
    (
        "crates/document/",
        "the document knows neither GPU nor browser",
        &["wgpu", "web_sys", "web-sys", "js_sys", "wasm_bindgen"],
    ),
    ("crates/formats/", "readers get bytes and give models", &["std::fs", "std::net", "wgpu", "web_sys"]),
    (
        "crates/render/src/",
        "the renderer takes plain buffers",
        &["limn_mesh", "limn_formats", "limn_document", "web_sys::window"],
    ),
];

/// Checks every tracked file and says what is wrong, a sentence each.
pub fn check() -> Result<Vec<String>> {
    let mut wrong = Vec::new();
    let listed =
        process::output(process::program("git").args(["ls-files", "--cached", "--others", "--exclude-standard"]))?;
    let mut long = Vec::new();
    for name in listed.lines() {
        // A binary file, or one that is staged for removal.
        let Ok(text) = fs::read_to_string(paths::root().join(name)) else { continue };
        wrong.extend(private(name, &text));
        wrong.extend(opening(name, &text));
        wrong.extend(banned(name, &text));
        if is_code(name) && text.lines().count() > LINES {
            long.push(name);
            if !LONG.iter().any(|(listed, _)| *listed == name) {
                wrong.push(format!(
                    "{name} has {} lines: split it, or list it in rules.rs with a reason",
                    text.lines().count()
                ));
            }
        }
    }
    let stale = LONG.iter().filter(|(name, _)| !long.contains(name));
    wrong.extend(stale.map(|(name, _)| format!("{name} is listed as long in rules.rs and is not")));
    Ok(wrong)
}

fn is_code(name: &str) -> bool {
    [".rs", ".js", ".mjs", ".ts", ".css", ".wgsl", ".html"].iter().any(|ending| name.ends_with(ending))
}

/// A module opens with a paragraph that says what it is.
fn opening(name: &str, text: &str) -> Option<String> {
    let mark = match name.rsplit_once('.')?.1 {
        "rs" => "//!",
        "js" | "mjs" | "wgsl" => "//",
        "ts" | "css" => "/*",
        _ => return None,
    };
    let mut lines = text.lines().map(str::trim).skip_while(|line| {
        // What a file must begin with by its nature.
        line.is_empty() || line.starts_with("#!") || matches!(*line, "// @ts-check" | "\"use strict\";")
    });
    let paragraph: String = match mark {
        "/*" => lines
            .next()
            .filter(|line| line.starts_with(mark))
            .map(|_| text.chars().take(200).collect())
            .unwrap_or_default(),
        _ => lines
            .take_while(|line| line.starts_with("//"))
            .map(|line| line.trim_start_matches(['/', '!', ' ']))
            .collect(),
    };
    let first = text.lines().map(str::trim).find(|line| line.starts_with("//!"));
    if paragraph.len() < 40 || (mark == "//!" && first.is_none()) {
        return Some(format!("{name} does not open with a paragraph that says what it is"));
    }
    if name.starts_with("web/") && name.ends_with(".js") && !text.contains("// @ts-check") {
        return Some(format!("{name} is not type-checked: add `// @ts-check`"));
    }
    None
}

/// Words that do not belong into a folder.
fn banned(name: &str, text: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    if !["rs", "toml"].contains(&extension) {
        return wrong;
    }
    for (folder, reason, words) in BANNED {
        if !name.starts_with(folder) {
            continue;
        }
        for (number, line) in tidy::code(text, extension == "toml") {
            for word in words.iter().filter(|word| line.contains(**word)) {
                wrong.push(format!("{name}:{number}: `{word}`: {reason}"));
            }
        }
    }
    wrong
}

/// What would tie the project to one machine: the registries it was fetched from, and absolute private paths.
fn private(name: &str, text: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    if name == "package-lock.json" && text.contains("\"resolved\"") {
        wrong.push(format!("{name} names a registry: `npm install` with the project's .npmrc leaves it out"));
    }
    let crates_io = "registry+https://github.com/rust-lang/crates.io-index";
    for (number, line) in (1..).zip(text.lines()) {
        if name == "Cargo.lock" && line.starts_with("source = ") && !line.contains(crates_io) {
            wrong.push(format!("{name}:{number}: a crate that does not come from crates.io"));
        }
        if name == ".npmrc" && line.trim_start().starts_with("registry") {
            wrong.push(format!("{name}:{number}: everyone has a registry of their own"));
        }
        // Spelled in pieces, or this very file would break the rule.
        let registries =
            [concat!("registry.", "npmjs"), concat!("registry.", "yarnpkg"), concat!("static.", "crates.io")];
        if registries.iter().any(|host| line.contains(host)) {
            wrong.push(format!("{name}:{number}: a registry's address"));
        }
        let homes = [concat!("/ho", "me/"), concat!("/Us", "ers/"), concat!("/ro", "ot/"), concat!("C:\\Us", "ers")];
        if homes.iter().any(|home| begins(line, home)) || own_places().iter().any(|place| begins(line, place)) {
            wrong.push(format!("{name}:{number}: an absolute private path"));
        }
    }
    wrong
}

/// The folder of this checkout and the one around it, where that says something.
fn own_places() -> Vec<String> {
    let common = ["/", "/tmp", "/src", "/opt", "/srv", "/build", "/app", "/web", "/crates", "/tests"];
    let around = [Some(paths::root()), paths::root().parent()].into_iter().flatten();
    let around = around.map(|path| path.display().to_string());
    around.filter(|path| !common.contains(&path.as_str())).map(|path| path + "/").collect()
}

/// Whether a line has `path` where a path can begin.
fn begins(line: &str, path: &str) -> bool {
    line.match_indices(path).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && !"._-~*/}$)".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_needs_a_paragraph() {
        let good = "//! What this module does and why, in a whole sentence.\nfn f() {}";
        assert_eq!(opening("crates/a/src/b.rs", good), None);
        assert!(opening("crates/a/src/b.rs", "//! (skeleton)\nfn f() {}").is_some());
        assert!(opening("crates/a/src/b.rs", "// A plain comment that is quite long enough for the rule.\n").is_some());
        assert!(
            opening("crates/a/src/b.rs", "fn f() {}\n//! Too late, as the compiler would say as well, here.").is_some()
        );
        let script = "// @ts-check\n// The page's part that does this and that, in a sentence.\n";
        assert_eq!(opening("web/a.js", script), None);
        assert!(opening("web/a.js", &script[13..]).is_some(), "not type-checked");
    }

    #[test]
    fn words_are_banned_in_code_and_not_in_comments_or_tests() {
        let text = "//! mentions std::fs\nuse std::fs; // std::net\n#[cfg(test)]\nmod tests { use std::time; }\n";
        let wrong = banned("crates/mesh/src/a.rs", text);
        assert_eq!(wrong.len(), 1, "{wrong:?}");
        assert!(wrong[0].starts_with("crates/mesh/src/a.rs:2: `std::fs`"));
        assert!(banned("crates/cli/src/a.rs", text).is_empty());
        assert!(!banned("crates/document/Cargo.toml", "wgpu.workspace = true").is_empty());
        assert!(!banned("crates/mesh/src/a.rs", "let y = x.sin();").is_empty());
    }

    #[test]
    fn private_paths_and_registries_are_found() {
        assert_eq!(private("a.md", concat!("see /ho", "me/ann/limn")).len(), 1);
        assert_eq!(private("a.md", concat!("https://example.org/ho", "me/ann and web/ro", "ot/x")).len(), 0);
        assert_eq!(private("a.md", &format!("in {}/crates", paths::root().display())).len(), 1);
        assert_eq!(private("package-lock.json", "\"resolved\": \"x\"").len(), 1);
        assert_eq!(private("Cargo.lock", "source = \"registry+https://elsewhere\"").len(), 1);
    }
}
