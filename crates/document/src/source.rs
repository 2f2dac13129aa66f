//! Where a model comes from: a built-in shape, a file that a person dropped, or an address.
//!
//! A dropped file cannot be reached by its name from anywhere else, so a document only remembers what it takes to know it
//! again: the name, the size and a hash of its bytes, as in `file:chair.obj,18231,8f0e2a6b51c3d97e`. Whoever gets the link
//! is asked to drop that file. The hash is 64-bit FNV-1a (Fowler, Noll, Vo; <http://www.isthe.com/chongo/tech/comp/fnv/>)
//! in sixteen hexadecimal digits: it tells files apart, it protects against nobody. It takes about a nanosecond a byte.

use std::fmt;

/// What is known about a file's bytes: enough to know the same file again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Its length in bytes.
    pub size: u64,
    /// FNV-1a over all bytes.
    pub hash: u64,
}

impl Stamp {
    /// The stamp of these bytes. Cost: linear, about 1 ns a byte.
    pub fn of(bytes: &[u8]) -> Stamp {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for &byte in bytes {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
        Stamp { size: bytes.len() as u64, hash }
    }
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// `builtin:NAME`, one of [`limn_mesh::shapes::SHAPES`].
    Builtin(String),
    /// `file:NAME,SIZE,HASH`, or `file:NAME` for any file of that name.
    File {
        /// The file's name; a path where the host has paths.
        name: String,
        /// What its bytes were when it was opened.
        stamp: Option<Stamp>,
    },
    /// An `http:` or `https:` address.
    Url(String),
}

impl Source {
    /// Reads a source as [`Display`](fmt::Display) writes it. `None` if the text has none of the three forms.
    pub fn parse(text: &str) -> Option<Source> {
        if let Some(name) = text.strip_prefix("builtin:") {
            return (!name.is_empty()).then(|| Source::Builtin(name.to_owned()));
        }
        if text.starts_with("http://") || text.starts_with("https://") {
            return Some(Source::Url(text.to_owned()));
        }
        let rest = text.strip_prefix("file:")?;
        // Names may hold commas, so the stamp is looked for from the end.
        if let Some((name, stamp)) = split_stamp(rest) {
            return (!name.is_empty()).then(|| Source::File { name: name.to_owned(), stamp: Some(stamp) });
        }
        (!rest.is_empty()).then(|| Source::File { name: rest.to_owned(), stamp: None })
    }

    /// The model's name as a person would say it: the shape's, or the last part of the path without its query.
    pub fn name(&self) -> &str {
        match self {
            Source::Builtin(name) => name,
            Source::File { name, .. } => name.rsplit(['/', '\\']).next().unwrap_or(name),
            Source::Url(url) => {
                let path = url.split(['?', '#']).next().unwrap_or(url);
                path.rsplit('/').find(|part| !part.is_empty()).unwrap_or(path)
            }
        }
    }

    /// The stamp, of a file that has one.
    pub fn stamp(&self) -> Option<Stamp> {
        match self {
            Source::File { stamp, .. } => *stamp,
            _ => None,
        }
    }
}

/// `NAME,SIZE,HASH` taken apart; `None` if the end is no size and sixteen hexadecimal digits.
fn split_stamp(text: &str) -> Option<(&str, Stamp)> {
    let mut parts = text.rsplitn(3, ',');
    let (hash, size, name) = (parts.next()?, parts.next()?, parts.next()?);
    let canonical = hash.len() == 16 && hash.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
    let digits = size.bytes().all(|b| b.is_ascii_digit()) && (size == "0" || !size.starts_with('0'));
    if !canonical || !digits {
        return None;
    }
    Some((name, Stamp { size: size.parse().ok()?, hash: u64::from_str_radix(hash, 16).ok()? }))
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Builtin(name) => write!(f, "builtin:{name}"),
            Source::File { name, stamp: Some(s) } => write!(f, "file:{name},{},{:016x}", s.size, s.hash),
            Source::File { name, stamp: None } => write!(f, "file:{name}"),
            Source::Url(url) => f.write_str(url),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_fnv_1a() {
        // Test vectors from the authors' page.
        assert_eq!(Stamp::of(b"").hash, 0xcbf29ce484222325);
        assert_eq!(Stamp::of(b"a").hash, 0xaf63dc4c8601ec8c);
        assert_eq!(Stamp::of(b"foobar"), Stamp { size: 6, hash: 0x85944171f73967e8 });
    }

    #[test]
    fn forms() {
        for text in ["builtin:cube", "file:a, b.obj,12,00000000000000ff", "file:a,b.obj", "https://x.org/a.glb?v=1"] {
            assert_eq!(Source::parse(text).unwrap().to_string(), text);
        }
        let file = Source::parse("file:dir/a, b.obj,12,00000000000000ff").unwrap();
        assert_eq!((file.name(), file.stamp()), ("a, b.obj", Some(Stamp { size: 12, hash: 255 })));
        assert_eq!(Source::parse("https://x.org/m/a.glb?v=1/2").unwrap().name(), "a.glb");
        for text in ["cube", "builtin:", "file:", "file:,1,00000000000000ff", "ftp://x"] {
            assert_eq!(Source::parse(text), None, "{text}");
        }
    }
}
