//! The files next to a model: buffers, material files, pictures.
//!
//! People drop a handful of files, and a model names its siblings as some other machine had them: with folders, with other
//! case, with backslashes, percent-encoded. [`find`] tries from the exact name to the bare file name without case, so
//! `.\Images\Wood%20Floor.PNG` finds a dropped `wood floor.png`.

use std::collections::BTreeMap;

/// Files that a model may refer to.
pub trait Files {
    /// The file of exactly this name.
    fn get(&self, name: &str) -> Option<&[u8]>;
    /// The names of all files; [`find`] looks through them when the exact name is not there.
    fn names(&self) -> Vec<String>;
}

/// No files.
impl Files for () {
    fn get(&self, _name: &str) -> Option<&[u8]> {
        None
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}

impl Files for BTreeMap<String, Vec<u8>> {
    fn get(&self, name: &str) -> Option<&[u8]> {
        BTreeMap::get(self, name).map(Vec::as_slice)
    }

    fn names(&self) -> Vec<String> {
        self.keys().cloned().collect()
    }
}

impl Files for [(String, Vec<u8>)] {
    fn get(&self, name: &str) -> Option<&[u8]> {
        self.iter().find(|(n, _)| n == name).map(|(_, bytes)| bytes.as_slice())
    }

    fn names(&self) -> Vec<String> {
        self.iter().map(|(n, _)| n.clone()).collect()
    }
}

impl Files for Vec<(String, Vec<u8>)> {
    fn get(&self, name: &str) -> Option<&[u8]> {
        Files::get(self.as_slice(), name)
    }

    fn names(&self) -> Vec<String> {
        Files::names(self.as_slice())
    }
}

/// Finds the file that a reference means: the exact name, else the same name percent-decoded, with `/` for `\`, without
/// `.` and `..` parts and without (ASCII) case, the one that shares most trailing folders; ties go to the first by name.
///
/// Gives the file's own name with its bytes. Cost: the names of all files once, unless the name is exact.
pub fn find<'a>(files: &'a dyn Files, reference: &str) -> Option<(String, &'a [u8])> {
    if let Some(bytes) = files.get(reference) {
        return Some((reference.to_owned(), bytes));
    }
    let wanted = [parts(reference), parts(&percent_decode(reference))];
    let mut best: Option<(usize, String)> = None;
    for name in files.names() {
        let own = parts(&name);
        let shared = wanted.iter().map(|w| w.iter().rev().zip(own.iter().rev()).take_while(|(a, b)| a == b).count());
        let shared = shared.max().unwrap_or(0);
        let better = match &best {
            Some((most, first)) => shared > *most || (shared == *most && name < *first),
            None => true,
        };
        if shared > 0 && better {
            best = Some((shared, name));
        }
    }
    let (_, name) = best?;
    let bytes = files.get(&name)?;
    Some((name, bytes))
}

/// The lower-case parts of a path, query and fragment kept (they may be part of a dropped name).
fn parts(path: &str) -> Vec<String> {
    path.split(['/', '\\']).filter(|p| !matches!(*p, "" | "." | "..")).map(str::to_ascii_lowercase).collect()
}

/// Decodes `%20` and its kin; what is not a valid escape stays.
pub(crate) fn percent_decode(text: &str) -> String {
    String::from_utf8_lossy(&percent_bytes(text)).into_owned()
}

/// The bytes that a percent-encoded text stands for.
fn percent_bytes(text: &str) -> Vec<u8> {
    let hex = |b: Option<&u8>| b.and_then(|b| char::from(*b).to_digit(16));
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match (byte, hex(bytes.get(at + 1)), hex(bytes.get(at + 2))) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                at += 3;
            }
            _ => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

/// The media type and bytes of a `data:` URI; `None` if it is not one or does not decode.
pub(crate) fn data_uri(uri: &str) -> Option<(&str, Vec<u8>)> {
    let rest = uri.get(5..).filter(|_| uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:")))?;
    let (head, body) = rest.split_once(',')?;
    match head.strip_suffix(";base64") {
        Some(mime) => Some((mime.split(';').next().unwrap_or(mime), base64(body.as_bytes())?)),
        None => Some((head.split(';').next().unwrap_or(head), percent_bytes(body))),
    }
}

/// Decodes base64, both alphabets, padding optional, blanks skipped.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0u32);
    let mut ended = false;
    for &byte in text {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => {
                ended = true;
                continue;
            }
            b' ' | b'\t' | b'\n' | b'\r' => continue,
            _ => return None,
        };
        if ended {
            return None;
        }
        bits = (bits << 6) | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
        }
    }
    // One lone character is six bits of nothing.
    (held < 6).then_some(out)
}

/// The media type of a picture, told from its first bytes; `None` for what browsers do not decode.
pub(crate) fn image_type(bytes: &[u8]) -> Option<&'static str> {
    let at = |from: usize, magic: &[u8]| bytes.get(from..from + magic.len()) == Some(magic);
    if at(0, b"\x89PNG\r\n\x1a\n") {
        Some("image/png")
    } else if at(0, b"\xff\xd8\xff") {
        Some("image/jpeg")
    } else if at(0, b"RIFF") && at(8, b"WEBP") {
        Some("image/webp")
    } else if at(0, b"GIF8") {
        Some("image/gif")
    } else if at(0, b"BM") {
        Some("image/bmp")
    } else if at(4, b"ftypavif") {
        Some("image/avif")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_by_what_people_mean() {
        let files = vec![
            ("a/wood floor.png".to_owned(), vec![1]),
            ("b/wood floor.png".to_owned(), vec![2]),
            ("100%25.bin".to_owned(), vec![3]),
        ];
        let got = |name: &str| find(&files, name).map(|(n, b)| (n, b.to_vec()));
        assert_eq!(got(".\\B\\Wood%20Floor.PNG"), Some(("b/wood floor.png".into(), vec![2])));
        assert_eq!(got("wood floor.png"), Some(("a/wood floor.png".into(), vec![1])));
        assert_eq!(got("C:\\x\\b\\wood floor.png"), Some(("b/wood floor.png".into(), vec![2])));
        assert_eq!(got("100%25.bin"), Some(("100%25.bin".into(), vec![3])));
        assert_eq!(got("stone.png"), None);
        assert_eq!(got(""), None);
    }

    #[test]
    fn decodes_data_uris() {
        assert_eq!(data_uri("data:image/png;base64,AAEC/w=="), Some(("image/png", vec![0, 1, 2, 255])));
        assert_eq!(
            data_uri("data:application/octet-stream;base64,AAEC_w"),
            Some(("application/octet-stream", vec![0, 1, 2, 255]))
        );
        assert_eq!(data_uri("DATA:,a%20b"), Some(("", b"a b".to_vec())));
        assert_eq!(data_uri("data:;base64,A"), None);
        assert_eq!(data_uri("data:;base64,AA=A"), None);
        assert_eq!(data_uri("data:;base64,\u{e9}"), None);
        assert_eq!(data_uri("box.bin"), None);
    }
}
