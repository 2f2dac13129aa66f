//! Short names between the glue and the module.
//!
//! wasm-bindgen names every function that the module imports by what it does and a hash of where it comes from,
//! `__wbg_createBindGroup_dbd0b6dd8a1e7a8a`, once in the module and once in the glue. There are hundreds, hashes do not
//! compress, and nobody reads them in what ships. So import number 42 becomes `i2a` in both: some 9 kB less of a first
//! visit after compression. Comments and indentation of scripts and styles go as well, 6 kB.
//!
//! The module is changed in its import section alone: a list of (module, name, kind, type), all lengths and numbers in
//! LEB128 (WebAssembly core specification, 5.5.5).

use anyhow::{Context, Result, bail};

/// Returns module and glue with short import names.
pub fn shorten(wasm: &[u8], glue: &str) -> Result<(Vec<u8>, String)> {
    let mut out = wasm.get(..8).context("this is no WebAssembly")?.to_vec();
    let mut names = Vec::new();
    let mut at = 8;
    while at < wasm.len() {
        let id = wasm[at];
        let (length, start) = leb(wasm, at + 1)?;
        let end = start.checked_add(length).filter(|&end| end <= wasm.len()).context("a section is cut short")?;
        let imports = if id == 2 { Some(imports(&wasm[start..end], &mut names)?) } else { None };
        let body = imports.as_deref().unwrap_or(&wasm[start..end]);
        out.push(id);
        push(&mut out, body.len());
        out.extend_from_slice(body);
        at = end;
    }
    Ok((out, words(glue, &names)))
}

/// The import section with short names; `names` gets the old ones, in order.
fn imports(section: &[u8], names: &mut Vec<String>) -> Result<Vec<u8>> {
    let (count, mut at) = leb(section, 0)?;
    let mut out = Vec::new();
    push(&mut out, count);
    for number in 0..count {
        let (module, next) = text(section, at)?;
        let (name, next) = text(section, next)?;
        if section.get(next) != Some(&0) {
            bail!("the module imports something that is no function: {name}");
        }
        let (_, end) = leb(section, next + 1)?;
        let short = short(number);
        for part in [module, &short] {
            push(&mut out, part.len());
            out.extend_from_slice(part.as_bytes());
        }
        out.extend_from_slice(&section[next..end]);
        names.push(name.to_owned());
        at = end;
    }
    Ok(out)
}

fn short(number: usize) -> String {
    format!("i{number:x}")
}

/// The glue with the same names.
fn words(glue: &str, names: &[String]) -> String {
    let short: std::collections::BTreeMap<_, _> =
        names.iter().enumerate().map(|(number, name)| (name.as_str(), short(number))).collect();
    let mut out = String::with_capacity(glue.len());
    let mut rest = glue;
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
    while let Some(begin) = rest.find(is_word) {
        let length = rest[begin..].find(|c| !is_word(c)).unwrap_or(rest.len() - begin);
        let word = &rest[begin..begin + length];
        out.push_str(&rest[..begin]);
        out.push_str(short.get(word).map_or(word, String::as_str));
        rest = &rest[begin + length..];
    }
    out + rest
}

fn text(bytes: &[u8], at: usize) -> Result<(&str, usize)> {
    let (length, start) = leb(bytes, at)?;
    let slice = start.checked_add(length).and_then(|end| bytes.get(start..end)).context("a name is cut short")?;
    Ok((std::str::from_utf8(slice)?, start + length))
}

/// An unsigned LEB128 number and where it ends.
fn leb(bytes: &[u8], mut at: usize) -> Result<(usize, usize)> {
    let mut value = 0_usize;
    for shift in (0..35).step_by(7) {
        let byte = *bytes.get(at).context("a number is cut short")?;
        at += 1;
        value |= usize::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok((value, at));
        }
    }
    bail!("a number is too long")
}

fn push(out: &mut Vec<u8>, mut value: usize) {
    while value >= 0x80 {
        out.push((value as u8 & 0x7f) | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn module_and_glue_get_the_same_short_names() {
        // (import "./m.js" "__wbg_draw_0123" (func (type 0))), and a custom section that stays.
        let mut section = vec![1, 6];
        section.extend_from_slice(b"./m.js");
        section.push(15);
        section.extend_from_slice(b"__wbg_draw_0123");
        section.extend_from_slice(&[0, 0]);
        let mut wasm = b"\0asm\x01\0\0\0".to_vec();
        wasm.extend_from_slice(&[2, section.len() as u8]);
        wasm.extend_from_slice(&section);
        wasm.extend_from_slice(&[0, 3, 1, b'x', 7]);
        let glue = "const a = { __wbg_draw_0123: f, __wbg_draw_01234: g };";
        let (module, glue) = shorten(&wasm, glue).unwrap();
        assert_eq!(module[8..], *b"\x02\x0d\x01\x06./m.js\x02i0\0\0\0\x03\x01x\x07");
        assert_eq!(glue, "const a = { i0: f, __wbg_draw_01234: g };");
    }

    #[test]
    fn numbers_of_several_bytes_come_back() {
        for value in [0, 127, 128, 300, 1 << 20, u32::MAX as usize] {
            let mut bytes = Vec::new();
            push(&mut bytes, value);
            assert_eq!(leb(&bytes, 0).unwrap(), (value, bytes.len()));
        }
        assert!(leb(&[0x80], 0).is_err());
        assert!(shorten(b"\0asm\x01\0\0\0\x02\x09\x01", "").is_err());
    }
}
