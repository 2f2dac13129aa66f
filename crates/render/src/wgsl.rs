//! Shader text as it ships: without comments and indentation, stripped while compiling.
//!
//! A quarter of the shaders' text is for people: 1.6 of 5.2 KB once compressed. Lines stay lines, so that the compiler's line
//! numbers are those of the file.

/// The text of a WGSL file, stripped.
macro_rules! wgsl {
    ($path:literal) => {{
        const TEXT: &[u8] = include_str!($path).as_bytes();
        const STRIPPED: ([u8; TEXT.len()], usize) = $crate::wgsl::strip(TEXT);
        const SHORT: [u8; STRIPPED.1] = $crate::wgsl::first(&STRIPPED.0);
        const OUT: &str = match std::str::from_utf8(&SHORT) {
            Ok(text) => text,
            Err(_) => panic!("a shader is UTF-8"),
        };
        OUT
    }};
}
pub(crate) use wgsl;

/// The text without what follows `//` and without spaces at the start of lines, and how long it is.
pub(crate) const fn strip<const N: usize>(text: &[u8]) -> ([u8; N], usize) {
    let mut out = [0; N];
    let (mut from, mut to) = (0, 0);
    let (mut fresh, mut comment) = (true, false);
    while from < text.len() {
        let c = text[from];
        if c == b'\n' {
            (fresh, comment) = (true, false);
        } else {
            comment |= c == b'/' && from + 1 < text.len() && text[from + 1] == b'/';
            fresh &= c == b' ';
        }
        if c == b'\n' || !(fresh || comment) {
            out[to] = c;
            to += 1;
        }
        from += 1;
    }
    (out, to)
}

/// The first `M` bytes.
pub(crate) const fn first<const M: usize>(bytes: &[u8]) -> [u8; M] {
    let mut out = [0; M];
    let mut i = 0;
    while i < M {
        out[i] = bytes[i];
        i += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn comments_and_indentation_go_and_lines_stay() {
        let text = b"// idea\n\nfn f() -> f32 { // why\n    return 1.0 / 2.0; // half\n}\n";
        let (out, length) = super::strip::<64>(text);
        assert_eq!(&out[..length], b"\n\nfn f() -> f32 { \nreturn 1.0 / 2.0; \n}\n");
    }
}
