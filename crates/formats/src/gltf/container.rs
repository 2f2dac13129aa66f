//! From bytes to a parsed document and its buffers.
//!
//! ```text
//!   .glb   "glTF" version length | length "JSON" {...} | length "BIN\0" bytes     (little-endian u32s)
//!   .gltf  {...}, buffers beside it or in data: URIs
//! ```
//!
//! Every length is checked against the bytes that are really there before anything is cut out. Buffers are looked up when
//! first used, so a file with a missing buffer that no surface needs still opens.

use std::{borrow::Cow, cell::OnceCell, cell::RefCell};

use gltf::json::{self, deserialize};

use super::document::{Document, bad};
use crate::{
    Files, Limits, ReadError,
    error::{Budget, short},
    files::{data_uri, find},
};

/// A parsed file with access to its buffers.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub document: Document,
    pub files: &'a dyn Files,
    pub budget: RefCell<Budget>,
    binary: Option<&'a [u8]>,
    buffers: Vec<OnceCell<Cow<'a, [u8]>>>,
}

impl<'a> Source<'a> {
    pub fn open(file: &'a str, bytes: &'a [u8], files: &'a dyn Files, limits: &Limits) -> Result<Self, ReadError> {
        let (json, binary) = if bytes.starts_with(b"glTF") { split_glb(file, bytes)? } else { (bytes, None) };
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let mut budget = Budget::new(limits);
        // A parsed value takes 32 bytes, keys and map nodes more, and every value but the first follows one of these.
        let values = json.iter().filter(|b| matches!(b, b',' | b'[' | b'{')).count() as u64;
        budget.spend("The file's JSON", values, 64)?;
        budget.spend("The file's JSON", json.len() as u64, 1)?;
        let root = deserialize::from_slice(json).map_err(|e: json::Error| {
            let text = e.to_string();
            ReadError::Json {
                file: file.to_owned(),
                line: e.line() as u64,
                column: e.column() as u64,
                problem: text.split(" at line ").next().unwrap_or_default().to_owned(),
            }
        })?;
        let document = Document::new(root, &mut budget)?;
        let buffers = (0..document.buffers.len()).map(|_| OnceCell::new()).collect();
        Ok(Source { file, document, files, budget: RefCell::new(budget), binary, buffers })
    }

    /// The bytes of a buffer.
    pub fn buffer(&self, number: usize) -> Result<&[u8], ReadError> {
        let buffer = self.document.buffers.get(number)?;
        let Some(cell) = self.buffers.get(number) else { return Ok(&[]) };
        if cell.get().is_none() {
            let bytes = self.load_buffer(buffer, number)?;
            let (stated, have) = (buffer.byte_length.0, bytes.len());
            if stated > have as u64 {
                let problem =
                    format!("it should have {stated} bytes, but only {have} are there; the file is cut short");
                return Err(bad(format_args!("buffers[{number}]"), problem));
            }
            let _ = cell.set(bytes);
        }
        Ok(cell.get().map_or(&[], |bytes| bytes))
    }

    fn load_buffer(&self, buffer: &json::Buffer, number: usize) -> Result<Cow<'a, [u8]>, ReadError> {
        let place = format_args!("buffers[{number}]");
        let Some(uri) = buffer.uri.as_deref() else {
            return match self.binary {
                Some(bytes) if number == 0 => Ok(Cow::Borrowed(bytes)),
                _ => Err(bad(place, "it has neither a uri nor a binary part in the file")),
            };
        };
        if uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:")) {
            self.budget.borrow_mut().spend("An embedded buffer", uri.len() as u64, 1)?;
            return match data_uri(uri) {
                Some((_, bytes)) => Ok(Cow::Owned(bytes)),
                None => Err(bad(place, "its data: URI does not decode")),
            };
        }
        match find(self.files, uri) {
            Some((_, bytes)) => Ok(Cow::Borrowed(bytes)),
            None => Err(ReadError::MissingFile { missing: short(uri), needed_by: self.file.to_owned() }),
        }
    }

    /// The bytes of a buffer view and its stride, if it states one.
    pub fn view(&self, number: usize) -> Result<(&[u8], Option<u64>), ReadError> {
        let place = format_args!("bufferViews[{number}]");
        let view = self.document.views.get(number)?;
        let buffer = self.document.buffers.check(view.buffer.value(), "buffer", place)?;
        let (from, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let stride = view.byte_stride.map(|stride| stride.0 as u64);
        let bytes = self.buffer(buffer)?;
        let cut =
            from.checked_add(length).and_then(|end| bytes.get(usize::try_from(from).ok()?..usize::try_from(end).ok()?));
        match cut {
            Some(cut) => Ok((cut, stride)),
            None => {
                let have = bytes.len();
                let problem =
                    format!("its {length} bytes from byte {from} lie outside buffer {buffer}, which has {have}");
                Err(bad(place, problem))
            }
        }
    }
}

/// The JSON and the binary part of a GLB file.
fn split_glb<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), ReadError> {
    let damaged = |problem: String| ReadError::Container { file: file.to_owned(), problem };
    let word =
        |at: usize| -> Option<u32> { bytes.get(at..at.checked_add(4)?)?.try_into().ok().map(u32::from_le_bytes) };
    let cut_short = |at: usize| damaged(format!("it ends at byte {} inside the header at byte {at}", bytes.len()));
    let version = word(4).ok_or_else(|| cut_short(0))?;
    if version != 2 {
        return Err(ReadError::Version { file: file.to_owned(), version: version.to_string() });
    }
    let length = word(8).ok_or_else(|| cut_short(0))? as usize;
    if length > bytes.len() {
        return Err(damaged(format!("its header claims {length} bytes, but the file has only {}", bytes.len())));
    }
    let mut at = 12;
    let (mut json, mut binary) = (None, None);
    while at < length {
        let size = word(at).ok_or_else(|| cut_short(at))? as usize;
        let kind = word(at + 4).ok_or_else(|| cut_short(at))?;
        let end = (at + 8).checked_add(size).filter(|end| *end <= length);
        let Some(chunk) = end.and_then(|end| bytes.get(at + 8..end)) else {
            return Err(damaged(format!(
                "the chunk at byte {at} claims {size} bytes, but only {} are left",
                length.saturating_sub(at + 8)
            )));
        };
        match kind {
            0x4e4f534a if json.is_none() => json = Some(chunk),
            0x004e4942 if binary.is_none() => binary = Some(chunk),
            _ => (),
        }
        // Chunks are padded to 4 bytes, and their size counts it; some writers forget.
        at = (at + 8 + size).next_multiple_of(4);
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => Err(damaged("it has no JSON part".to_owned())),
    }
}
