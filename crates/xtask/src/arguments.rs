//! The few options that xtask takes.
//!
//! A command asks for each option it knows (`flag`, `value`) and ends with `finish`, which refuses what is left over.
//! That is all that is needed here; a full argument parser would double the time that the first `cargo xtask` compiles.

use anyhow::{Result, bail};

/// What stands behind `cargo xtask`, consumed piece by piece.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// Takes the words behind the program's name.
    pub fn new(words: impl Iterator<Item = String>) -> Self {
        Self(words.collect())
    }

    /// Takes the first word if it is no option.
    pub fn positional(&mut self) -> Option<String> {
        match self.0.first() {
            Some(word) if !word.starts_with("--") || word == "--help" => Some(self.0.remove(0)),
            _ => None,
        }
    }

    /// Whether `--name` was given.
    pub fn flag(&mut self, name: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|word| word != name);
        self.0.len() < before
    }

    /// The value of `--name VALUE` or `--name=VALUE`.
    pub fn value(&mut self, name: &str) -> Result<Option<String>> {
        let Some(at) = self.0.iter().position(|word| word == name || word.starts_with(&format!("{name}="))) else {
            return Ok(None);
        };
        let word = self.0.remove(at);
        if let Some((_, value)) = word.split_once('=') {
            return Ok(Some(value.to_owned()));
        }
        if at >= self.0.len() {
            bail!("{name} needs a value");
        }
        Ok(Some(self.0.remove(at)))
    }

    /// Refuses whatever no one asked for.
    pub fn finish(self) -> Result<()> {
        match self.0.first() {
            None => Ok(()),
            Some(word) => bail!("`{word}` is not an option of this command; `cargo xtask help` lists them"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(text: &str) -> Arguments {
        Arguments::new(text.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn options_are_taken_in_both_spellings_and_in_any_order() {
        let mut a = arguments("serve --port 81 --release --only=webgl");
        assert_eq!(a.positional().as_deref(), Some("serve"));
        assert!(a.flag("--release"));
        assert!(!a.flag("--release"));
        assert_eq!(a.value("--only").unwrap().as_deref(), Some("webgl"));
        assert_eq!(a.value("--port").unwrap().as_deref(), Some("81"));
        a.finish().unwrap();
    }

    #[test]
    fn what_nobody_asked_for_is_refused() {
        assert!(arguments("--relaese").finish().unwrap_err().to_string().contains("--relaese"));
        assert!(arguments("--port").value("--port").is_err());
    }
}
