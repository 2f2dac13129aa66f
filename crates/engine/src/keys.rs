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
    pub key: &'static str,
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

/// A key that sends a command.
const fn sends(key: &'static str, group: &'static str, label: &'static str, command: &'static str) -> Key {
    Key { key, shift: false, modifier: false, group, label, command, page: "" }
}

/// A key that asks the page.
const fn asks(key: &'static str, label: &'static str, page: &'static str) -> Key {
    Key { page, ..sends(key, "Page", label, "") }
}

const fn shift(key: Key) -> Key {
    Key { shift: true, ..key }
}

const fn ctrl(key: Key) -> Key {
    Key { modifier: true, ..key }
}

/// Every key, in the order of the help.
pub static KEYS: &[Key] = &[
    sends("0", "Levels", "Level 0, the model itself; 1 to 9 likewise", "level 0"),
    sends("1", "Levels", "", "level 1"),
    sends("2", "Levels", "", "level 2"),
    sends("3", "Levels", "", "level 3"),
    sends("4", "Levels", "", "level 4"),
    sends("5", "Levels", "", "level 5"),
    sends("6", "Levels", "", "level 6"),
    sends("7", "Levels", "", "level 7"),
    sends("8", "Levels", "", "level 8"),
    sends("9", "Levels", "", "level 9"),
    sends("arrowright", "Levels", "Next level", "step 1"),
    sends("arrowleft", "Levels", "Level before", "step -1"),
    sends("w", "View", "Edges", "toggle edges"),
    sends("c", "View", "Cage: the model itself, over its surface", "toggle cage"),
    sends("v", "View", "Points", "toggle points"),
    sends("s", "View", "Smooth or flat", "toggle shading"),
    sends("p", "View", "Perspective or orthographic", "toggle projection"),
    sends("f", "View", "Frame the model", "view camera=fit"),
    sends("h", "View", "Home: the first view", "view camera=home"),
    sends("x", "View", "From the right", "view camera=right"),
    sends("y", "View", "From the front", "view camera=front"),
    sends("z", "View", "From the top", "view camera=top"),
    shift(sends("arrowleft", "View", "Turn the model; likewise the other arrows", "turn -15 0")),
    shift(sends("arrowright", "View", "", "turn 15 0")),
    shift(sends("arrowup", "View", "", "turn 0 15")),
    shift(sends("arrowdown", "View", "", "turn 0 -15")),
    sends("+", "View", "Closer", "zoom 0.8"),
    sends("=", "View", "", "zoom 0.8"),
    sends("-", "View", "Farther", "zoom 1.25"),
    ctrl(sends("z", "Document", "Undo", "undo")),
    ctrl(shift(sends("z", "Document", "Redo", "redo"))),
    ctrl(sends("y", "Document", "", "redo")),
    asks("o", "Open files", "open"),
    asks("l", "Copy link", "copy"),
    asks("t", "Dark or light theme", "theme"),
    asks("b", "Panel", "panel"),
    asks("/", "Console", "console"),
    asks("?", "This help", "help"),
    asks("escape", "Dismiss a message, close the panel", "escape"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things_and_each_does_one() {
        for (i, a) in KEYS.iter().enumerate() {
            assert!(a.command.is_empty() != a.page.is_empty(), "{a:?}");
            assert!(!KEYS[..i].iter().any(|b| (a.key, a.shift, a.modifier) == (b.key, b.shift, b.modifier)), "{a:?}");
        }
    }

    #[test]
    fn the_browser_keeps_its_shortcuts() {
        let taken: Vec<_> = KEYS.iter().filter(|k| k.modifier).map(|k| k.key).collect();
        assert_eq!(taken, ["z", "z", "y"]);
    }

    #[test]
    fn every_command_is_shorthand_or_grammar() {
        for key in KEYS.iter().filter(|k| !k.command.is_empty()) {
            let first = key.command.split(' ').next().unwrap();
            let known = crate::shorthand::WORDS.contains(&first) || limn_document::command::spec(first).is_some();
            assert!(known, "{key:?}");
        }
    }
}
