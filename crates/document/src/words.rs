//! Words: how a command line falls into pieces, and how a piece is written so that it comes back whole.
//!
//! Words stand between spaces or tabs. A double quote begins and ends a stretch in which spaces are ordinary; within it
//! `\"`, `\\`, `\n`, `\r` and `\t` stand for one character each. Elsewhere a backslash is a backslash, so that Windows paths
//! need no care. A word that begins with an unquoted `#` begins a comment up to the end of the line.
//!
//! ```text
//!   export "my model.obj"   # for the printer
//!   ------ --------------   (comment)
//! ```
//!
//! [`quote`] is the inverse: for any text, `split(&quote(text))` is that one word.

/// Why a line does not fall into words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WordError {
    /// A quote that does not end.
    #[error("the quote that opens at character {0} is never closed; add a closing \"")]
    Unclosed(usize),
    /// A backslash in quotes before a character for which nothing is agreed.
    #[error("\\{0} within quotes means nothing; write \\\\ for a backslash")]
    Escape(char),
}

/// The words of one line. Cost: linear.
///
/// # Errors
/// A quote that is not closed, or an unknown escape in one.
pub fn split(line: &str) -> Result<Vec<String>, WordError> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut chars = line.chars().enumerate();
    while let Some((at, c)) = chars.next() {
        match c {
            '#' if word.is_none() => break,
            '"' => quoted(&mut chars, at + 1, word.get_or_insert_default())?,
            c if c.is_whitespace() => words.extend(word.take()),
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    Ok(words)
}

/// Reads up to the closing quote into `word`. `opened` is the 1-based place of the opening one.
fn quoted(chars: &mut impl Iterator<Item = (usize, char)>, opened: usize, word: &mut String) -> Result<(), WordError> {
    loop {
        match chars.next().map(|(_, c)| c) {
            None => return Err(WordError::Unclosed(opened)),
            Some('"') => return Ok(()),
            Some('\\') => word.push(match chars.next().map(|(_, c)| c) {
                None => return Err(WordError::Unclosed(opened)),
                Some('n') => '\n',
                Some('r') => '\r',
                Some('t') => '\t',
                Some(c @ ('"' | '\\')) => c,
                Some(c) => return Err(WordError::Escape(c)),
            }),
            Some(c) => word.push(c),
        }
    }
}

/// `word` as a line writes it: bare where that is clear, else in quotes.
pub fn quote(word: &str) -> String {
    let plain = !word.is_empty() && !word.starts_with('#') && !word.chars().any(|c| c == '"' || c.is_whitespace());
    if plain {
        return word.to_owned();
    }
    let mut text = String::with_capacity(word.len() + 2);
    text.push('"');
    for c in word.chars() {
        match c {
            '"' => text.push_str("\\\""),
            '\\' => text.push_str("\\\\"),
            '\n' => text.push_str("\\n"),
            '\r' => text.push_str("\\r"),
            '\t' => text.push_str("\\t"),
            c => text.push(c),
        }
    }
    text.push('"');
    text
}

/// At most 60 characters, for messages.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// A message as a sentence: with a full stop, and with a capital unless it begins with a name (`cut.glb`, `accessors[0]`).
pub fn sentence(text: &str) -> String {
    let first = text.split_whitespace().next().unwrap_or_default();
    let is_name = first.contains(['[']) || first.trim_end_matches(['.', ':', ',']).contains(['.']);
    let mut chars = text.chars();
    let mut out: String = match chars.next() {
        Some(c) if !is_name => std::iter::once(c.to_ascii_uppercase()).chain(chars).collect(),
        _ => text.to_owned(),
    };
    if !out.ends_with(['.', '!', '?']) {
        out.push('.');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quotes_comments_and_backslashes() {
        assert_eq!(split(r#"  export "my model.obj"  # x "y"#).unwrap(), ["export", "my model.obj"]);
        assert_eq!(split(r#"open C:\a\b.obj a#b"#).unwrap(), ["open", r"C:\a\b.obj", "a#b"]);
        assert_eq!(split(r#"hide="a b",c "" "\"\\\n""#).unwrap(), ["hide=a b,c", "", "\"\\\n"]);
        assert_eq!(split("# all comment").unwrap(), Vec::<String>::new());
        assert_eq!(split("a \"b"), Err(WordError::Unclosed(3)));
        assert_eq!(split("\"\\q\""), Err(WordError::Escape('q')));
    }

    proptest! {
        #[test]
        fn quoting_is_undone_by_splitting(words in proptest::collection::vec(any::<String>(), 0..4)) {
            let line = words.iter().map(|w| quote(w)).collect::<Vec<_>>().join(" ");
            prop_assert!(!line.contains('\n'));
            prop_assert_eq!(split(&line).unwrap(), words);
        }
    }

    #[test]
    fn names_keep_their_letters_in_sentences() {
        assert_eq!(sentence("line 3 is odd"), "Line 3 is odd.");
        assert_eq!(sentence("cut.glb is damaged."), "cut.glb is damaged.");
        assert_eq!(sentence("accessors[0]: it is short"), "accessors[0]: it is short.");
        assert_eq!(sentence("done. It is"), "Done. It is.");
    }
}
