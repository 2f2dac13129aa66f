//! Plain bytes, for what passes between modules that share no memory.
//!
//! The page is made of several WebAssembly modules, so that nobody loads what is not needed. What one hands another is one
//! buffer of items in a row:
//!
//! ```text
//!   | number | length, bytes, padding | length, f32 f32 f32 ... | count, item, item, ... |
//! ```
//!
//! Every item is its length in 32 bits and its bytes, little-endian, padded to four. The layout is private to one build: it
//! is never stored. Reading checks every length and never panics. Cost: one copy each way. Limit: 4 GB an array.

use bytemuck::{Pod, pod_collect_to_vec};

/// The buffer is none that this build packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("its contents were damaged on the way; try again")]
pub struct Damaged;

/// Writes items one behind the other.
#[derive(Debug, Default)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// What was written.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }

    /// A number.
    pub fn number(&mut self, n: u32) {
        self.0.extend_from_slice(&n.to_le_bytes());
    }

    /// Bytes, at most 2^32 - 1.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u32);
        self.0.extend_from_slice(bytes);
        self.0.resize(self.0.len().next_multiple_of(4), 0);
    }

    /// A text.
    pub fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    /// Plain values.
    pub fn array<T: Pod>(&mut self, values: &[T]) {
        self.bytes(bytemuck::cast_slice(values));
    }

    /// Yes or no, a byte each.
    pub fn flags(&mut self, flags: &[bool]) {
        self.bytes(bytemuck::cast_slice(flags));
    }

    /// A list of anything: each item by `write`.
    pub fn list<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.number(items.len() as u32);
        items.iter().for_each(|item| write(self, item));
    }
}

/// Reads them in the same order.
#[derive(Debug)]
pub struct Reader<'a>(&'a [u8]);

/// What a reading comes to: every method of [`Reader`] fails if the buffer ends too early or holds something else.
pub type Read<T> = Result<T, Damaged>;

impl<'a> Reader<'a> {
    /// Begins at the start of a buffer.
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader(bytes)
    }

    fn take(&mut self, count: usize) -> Read<&'a [u8]> {
        let (head, tail) = self.0.split_at_checked(count).ok_or(Damaged)?;
        self.0 = tail;
        Ok(head)
    }

    /// A number.
    pub fn number(&mut self) -> Read<u32> {
        Ok(u32::from_le_bytes(self.take(4)?.try_into().map_err(|_| Damaged)?))
    }

    /// Bytes.
    pub fn bytes(&mut self) -> Read<&'a [u8]> {
        let count = self.number()? as usize;
        let bytes = self.take(count)?;
        self.take(count.next_multiple_of(4) - count)?;
        Ok(bytes)
    }

    /// A text.
    pub fn text(&mut self) -> Read<String> {
        String::from_utf8(self.bytes()?.to_vec()).map_err(|_| Damaged)
    }

    /// Plain values.
    pub fn array<T: Pod>(&mut self) -> Read<Vec<T>> {
        let bytes = self.bytes()?;
        if bytes.len().checked_rem(size_of::<T>()) != Some(0) {
            return Err(Damaged);
        }
        Ok(pod_collect_to_vec(bytes))
    }

    /// So many plain values.
    pub fn exactly<T: Pod, const N: usize>(&mut self) -> Read<[T; N]> {
        self.array()?.try_into().map_err(|_| Damaged)
    }

    /// Yes or no, a byte each.
    pub fn flags(&mut self) -> Read<Vec<bool>> {
        Ok(self.bytes()?.iter().map(|&b| b != 0).collect())
    }

    /// A list: each item by `read`.
    pub fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Read<T>) -> Read<Vec<T>> {
        // No room is made in advance: a damaged count must not cost memory.
        (0..self.number()?).map(|_| read(self)).collect()
    }

    /// A flag, then the value, which is there either way.
    pub fn option<T>(&mut self, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<Option<T>> {
        let is_there = self.number()? == 1;
        let value = read(self)?;
        Ok(is_there.then_some(value))
    }
}
