//! Typed arrays out of buffers: components of five types, strides, normalised integers, sparse replacements.
//!
//! ```text
//!   view     |....[x y z]...[x y z]...|      first element at byteOffset, one every byteStride
//!   value    f32, or integer, or integer / (its largest value) when normalised
//!   sparse   elements indices[i] are replaced by values[i]
//! ```
//!
//! All sizes are checked before the first element is read, in 64 bits, and what is built is counted against the memory
//! budget, so a header that claims two billion elements costs nothing. Cost: about 2 ns a component.

use std::fmt::Arguments;

use serde_json::Value;

use super::{
    container::Source,
    json::{bad, index, list, text, whole},
};
use crate::{ReadError, error::short};

/// A component type, by its number in the file.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(value: &Value, place: Arguments<'_>) -> Result<Self, ReadError> {
        Ok(match whole(value, "componentType", place)? {
            Some(5120) => Component::I8,
            Some(5121) => Component::U8,
            Some(5122) => Component::I16,
            Some(5123) => Component::U16,
            Some(5125) => Component::U32,
            Some(5126) => Component::F32,
            Some(other) => return Err(bad(place, format!("its componentType {other} is none that glTF 2.0 has"))),
            None => return Err(bad(place, "it has no componentType")),
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The value at the start of `bytes`, which has at least `size` bytes (else 0).
    #[inline]
    fn float(self, bytes: &[u8]) -> f32 {
        match (self, bytes) {
            (Component::I8, [a, ..]) => f32::from(*a as i8),
            (Component::U8, [a, ..]) => f32::from(*a),
            (Component::I16, [a, b, ..]) => f32::from(i16::from_le_bytes([*a, *b])),
            (Component::U16, [a, b, ..]) => f32::from(u16::from_le_bytes([*a, *b])),
            (Component::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
            (Component::F32, [a, b, c, d, ..]) => f32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0.0,
        }
    }

    #[inline]
    fn integer(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (Component::U8, [a, ..]) => u32::from(*a),
            (Component::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
            (Component::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0,
        }
    }

    /// What a normalised integer is divided by.
    fn full(self) -> f32 {
        match self {
            Component::I8 => 127.0,
            Component::U8 => 255.0,
            Component::I16 => 32767.0,
            Component::U16 => 65535.0,
            Component::U32 => u32::MAX as f32,
            Component::F32 => 1.0,
        }
    }
}

/// An accessor whose sizes have been checked.
pub(super) struct Accessor<'s> {
    number: usize,
    pub count: usize,
    component: Component,
    pub width: usize,
    normalized: bool,
    /// The first element's bytes and what follows; `None` means all zeros.
    data: Option<&'s [u8]>,
    stride: usize,
    sparse: Option<Sparse<'s>>,
}

struct Sparse<'s> {
    count: usize,
    component: Component,
    indices: &'s [u8],
    values: &'s [u8],
}

/// Cuts `count` elements of `size` bytes, `stride` apart, out of a view.
fn cut<'s>(
    source: &'s Source<'_>,
    holder: &Value,
    view: usize,
    (count, size): (u64, usize),
    place: Arguments<'_>,
) -> Result<(&'s [u8], usize), ReadError> {
    let offset = whole(holder, "byteOffset", place)?.unwrap_or(0);
    let (bytes, stride) = source.view(view)?;
    let stride = stride.unwrap_or(size as u64);
    if stride < size as u64 {
        return Err(bad(place, format!("its elements of {size} bytes do not fit the byteStride of {stride}")));
    }
    // The last element needs no padding up to the stride.
    let need = match count.checked_sub(1) {
        None => Some(0),
        Some(gaps) => gaps.checked_mul(stride).and_then(|n| n.checked_add(size as u64)),
    };
    let end = need.and_then(|need| need.checked_add(offset));
    let data = end.filter(|end| *end <= bytes.len() as u64).and_then(|end| bytes.get(offset as usize..end as usize));
    match data {
        // A stride that 32 bits cannot hold can only belong to a single element.
        Some(data) => Ok((data, usize::try_from(stride).unwrap_or(usize::MAX))),
        None => {
            let have = bytes.len();
            let end = end.map_or("more than 2^64".to_owned(), |end| end.to_string());
            Err(bad(place, format!("its {count} elements need {end} bytes, but bufferViews[{view}] has {have}")))
        }
    }
}

impl<'s> Accessor<'s> {
    /// Looks up and checks an accessor.
    pub fn new(source: &'s Source<'_>, number: usize) -> Result<Self, ReadError> {
        let place = format_args!("accessors[{number}]");
        let Some(value) = list(&source.root, "accessors").get(number) else {
            return Err(bad(place, "there is no such accessor"));
        };
        let views = list(&source.root, "bufferViews").len();
        let component = Component::of(value, place)?;
        let width = match text(value, "type") {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            other => {
                return Err(bad(
                    place,
                    format!("its type {} cannot be used here", short(other.unwrap_or("(missing)"))),
                ));
            }
        };
        let count = whole(value, "count", place)?.ok_or_else(|| bad(place, "it has no count"))?;
        if count >= u64::from(u32::MAX) {
            return Err(bad(place, format!("its {count} elements are more than 32 bits can number")));
        }
        let size = component.size() * width;
        let (data, stride) = match index(value, "bufferView", views, place)? {
            Some(view) => {
                let (data, stride) = cut(source, value, view, (count, size), place)?;
                (Some(data), stride)
            }
            None => (None, size),
        };
        let sparse = match value.get("sparse") {
            Some(sparse) => Some(Sparse::new(source, sparse, (number, count, size))?),
            None => None,
        };
        let normalized =
            component != Component::F32 && value.get("normalized").and_then(Value::as_bool).unwrap_or(false);
        Ok(Accessor { number, count: count as usize, component, width, normalized, data, stride, sparse })
    }

    /// Appends all elements as floats; of wider elements the first `N` components.
    ///
    /// The memory for them must have been reserved. Components that the file does not have are `rest`.
    pub fn floats<const N: usize>(&self, rest: f32, out: &mut Vec<[f32; N]>) -> Result<(), ReadError> {
        let start = out.len();
        let zero = self.element::<N>(rest, &[0; 16]);
        match self.data {
            None => out.resize(start + self.count, zero),
            Some(data) => {
                out.reserve(self.count);
                out.extend(data.chunks(self.stride.max(1)).take(self.count).map(|bytes| self.element(rest, bytes)));
            }
        }
        if let Some(sparse) = &self.sparse {
            let size = self.component.size() * self.width;
            for (index, bytes) in sparse.indices().zip(sparse.values.chunks(size)) {
                match out.get_mut(start + index as usize).filter(|_| (index as usize) < self.count) {
                    Some(slot) => *slot = self.element(rest, bytes),
                    None => return Err(sparse.out_of_range(self.number, index, self.count)),
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn element<const N: usize>(&self, rest: f32, bytes: &[u8]) -> [f32; N] {
        let mut out = [rest; N];
        let size = self.component.size();
        for (slot, bytes) in out.iter_mut().take(self.width).zip(bytes.chunks(size)) {
            let value = self.component.float(bytes);
            // The smallest integer of a signed type is one below -full.
            *slot = if self.normalized { (value / self.component.full()).max(-1.0) } else { value };
        }
        out
    }

    /// All elements as indices: one unsigned integer each.
    pub fn integers(&self) -> Result<Vec<u32>, ReadError> {
        let place = format_args!("accessors[{}]", self.number);
        if self.width != 1 || !matches!(self.component, Component::U8 | Component::U16 | Component::U32) {
            return Err(bad(place, "indices must be unsigned integers, one each"));
        }
        let mut out = match self.data {
            None => vec![0; self.count],
            Some(data) => {
                data.chunks(self.stride.max(1)).take(self.count).map(|bytes| self.component.integer(bytes)).collect()
            }
        };
        if let Some(sparse) = &self.sparse {
            for (index, bytes) in sparse.indices().zip(sparse.values.chunks(self.component.size())) {
                match out.get_mut(index as usize) {
                    Some(slot) => *slot = self.component.integer(bytes),
                    None => return Err(sparse.out_of_range(self.number, index, self.count)),
                }
            }
        }
        Ok(out)
    }
}

impl<'s> Sparse<'s> {
    fn new(source: &'s Source<'_>, sparse: &Value, (number, of, size): (usize, u64, usize)) -> Result<Self, ReadError> {
        let place = format_args!("accessors[{number}].sparse");
        let views = list(&source.root, "bufferViews").len();
        let count = whole(sparse, "count", place)?.ok_or_else(|| bad(place, "it has no count"))?;
        if count > of {
            return Err(bad(place, format!("it replaces {count} elements of {of}")));
        }
        let part = |key: &str| sparse.get(key).ok_or_else(|| bad(place, format!("it has no {key}")));
        let view = |holder: &Value| {
            index(holder, "bufferView", views, place)?.ok_or_else(|| bad(place, "it names no bufferView"))
        };
        let (indices, values) = (part("indices")?, part("values")?);
        let component = Component::of(indices, place)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(bad(place, "its indices are not unsigned integers"));
        }
        let (index_bytes, stride) = cut(source, indices, view(indices)?, (count, component.size()), place)?;
        let (value_bytes, value_stride) = cut(source, values, view(values)?, (count, size), place)?;
        if stride != component.size() || value_stride != size {
            return Err(bad(place, "its buffer views must not have a byteStride"));
        }
        Ok(Sparse { count: count as usize, component, indices: index_bytes, values: value_bytes })
    }

    fn indices(&self) -> impl Iterator<Item = u32> + '_ {
        self.indices.chunks(self.component.size()).take(self.count).map(|bytes| self.component.integer(bytes))
    }

    fn out_of_range(&self, number: usize, index: u32, count: usize) -> ReadError {
        bad(
            format_args!("accessors[{number}].sparse"),
            format!("it replaces element {index}, but there are only {count}"),
        )
    }
}
