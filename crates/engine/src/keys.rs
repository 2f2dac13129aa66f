//! The keyboard: one table for the page's key handler and its help.
//!
//! A key sends a command, or names an action that only the page can take (a file dialog, the clipboard). Commands here may
//! be shorthand, which [`crate::shorthand`] turns into commands of the grammar from what is chosen now: `toggle edges` into
//! `view edges=on`, `step 1` into `level 3`. No key with Ctrl is taken but undo and redo: the rest are the browser's.

use serde::Serialize;

/// A key, by `KeyboardEvent.key` in lower case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// Which.
    pub key: String,
    /// With Shift. Ignored for signs, whose Shift depends on the keyboard.
    pub shift: bool,
    /// With Ctrl, or Command on a Mac.
    #[serde(rename = "mod")]
    pub modifier: bool,
    /// Its heading in the help.
    pub group: &'static str,
    /// What it does; empty for keys that another one's line in the help speaks for.
    pub label: &'static str,
    /// What it sends; empty if it is the page's.
    pub command: &'static str,
    /// The page's action; empty if it sends a command.
    pub page: &'static str,
}

const fn key(group: &'static str, label: &'static str, command: &'static str) -> Key {
    Key { key: String::new(), shift: false, modifier: false, group, label, command, page: "" }
}

/// Levels 0 to 9.
const LEVELS: [&str; 10] =
    ["level 0", "level 1", "level 2", "level 3", "level 4", "level 5", "level 6", "level 7", "level 8", "level 9"];

/// Every key, in the order of the help.
pub fn keys() -> Vec<Key> {
    let mut all = Vec::new();
    let mut add = |text: &str, key: Key| all.push(Key { key: text.to_owned(), ..key });
    for (i, command) in LEVELS.into_iter().enumerate() {
        add(
            &i.to_string(),
            key("Levels", if i == 0 { "Level 0, the model itself; 1 to 9 likewise" } else { "" }, command),
        );
    }
    add("arrowright", key("Levels", "Next level", "step 1"));
    add("arrowleft", key("Levels", "Level before", "step -1"));
    add("w", key("View", "Edges", "toggle edges"));
    add("c", key("View", "Cage: the model itself, over its surface", "toggle cage"));
    add("v", key("View", "Points", "toggle points"));
    add("s", key("View", "Smooth or flat", "toggle shading"));
    add("p", key("View", "Perspective or orthographic", "toggle projection"));
    add("f", key("View", "Frame the model", "view camera=fit"));
    add("h", key("View", "Home: the first view", "view camera=home"));
    add("x", key("View", "From the right", "view camera=right"));
    add("y", key("View", "From the front", "view camera=front"));
    add("z", key("View", "From the top", "view camera=top"));
    for (text, label, command) in [
        ("arrowleft", "Turn the model; likewise the other arrows", "turn -15 0"),
        ("arrowright", "", "turn 15 0"),
        ("arrowup", "", "turn 0 15"),
        ("arrowdown", "", "turn 0 -15"),
    ] {
        add(text, Key { shift: true, ..key("View", label, command) });
    }
    add("+", key("View", "Closer", "zoom 0.8"));
    add("=", key("View", "", "zoom 0.8"));
    add("-", key("View", "Farther", "zoom 1.25"));
    add("z", Key { modifier: true, ..key("Document", "Undo", "undo") });
    add("z", Key { modifier: true, shift: true, ..key("Document", "Redo", "redo") });
    add("y", Key { modifier: true, ..key("Document", "", "redo") });
    for (text, label, page) in [
        ("o", "Open files", "open"),
        ("l", "Copy link", "copy"),
        ("t", "Dark or light theme", "theme"),
        ("b", "Panel", "panel"),
        ("/", "Console", "console"),
        ("?", "This help", "help"),
        ("escape", "Dismiss a message, close the panel", "escape"),
    ] {
        add(text, Key { page, ..key("Page", label, "") });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things_and_each_does_one() {
        let all = keys();
        for (i, a) in all.iter().enumerate() {
            assert!(a.command.is_empty() != a.page.is_empty(), "{a:?}");
            assert!(!all[..i].iter().any(|b| (&a.key, a.shift, a.modifier) == (&b.key, b.shift, b.modifier)), "{a:?}");
        }
    }

    #[test]
    fn the_browser_keeps_its_shortcuts() {
        let taken: Vec<_> = keys().into_iter().filter(|k| k.modifier).map(|k| k.key).collect();
        assert_eq!(taken, ["z", "z", "y"]);
    }

    #[test]
    fn every_command_is_shorthand_or_grammar() {
        for key in keys().iter().filter(|k| !k.command.is_empty()) {
            let first = key.command.split(' ').next().unwrap();
            let known = crate::shorthand::WORDS.contains(&first) || limn_document::command::spec(first).is_some();
            assert!(known, "{key:?}");
        }
    }
}
