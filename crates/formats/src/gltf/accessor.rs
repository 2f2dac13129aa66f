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

use gltf::json::{
    accessor::{ComponentType, Type, sparse},
    validation::{Checked, USize64},
};

use super::{container::Source, document::bad};
use crate::ReadError;

/// What an accessor's component type says of its bytes.
trait Component: Copy {
    /// Bytes. The crate's own `size` is a call that is not inlined, in loops over every component.
    fn bytes(self) -> usize;

    /// The value at the start of `bytes`, which has at least `size` bytes (else 0).
    fn float(self, bytes: &[u8]) -> f32;

    /// The same as an index; 0 for types that cannot be one.
    fn integer(self, bytes: &[u8]) -> u32;

    /// What a normalised integer is divided by.
    fn full(self) -> f32;
}

impl Component for ComponentType {
    #[inline]
    fn bytes(self) -> usize {
        match self {
            ComponentType::I8 | ComponentType::U8 => 1,
            ComponentType::I16 | ComponentType::U16 => 2,
            ComponentType::U32 | ComponentType::F32 => 4,
        }
    }

    #[inline]
    fn float(self, bytes: &[u8]) -> f32 {
        match (self, bytes) {
            (ComponentType::I8, [a, ..]) => f32::from(*a as i8),
            (ComponentType::U8, [a, ..]) => f32::from(*a),
            (ComponentType::I16, [a, b, ..]) => f32::from(i16::from_le_bytes([*a, *b])),
            (ComponentType::U16, [a, b, ..]) => f32::from(u16::from_le_bytes([*a, *b])),
            (ComponentType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
            (ComponentType::F32, [a, b, c, d, ..]) => f32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0.0,
        }
    }

    #[inline]
    fn integer(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (ComponentType::U8, [a, ..]) => u32::from(*a),
            (ComponentType::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
            (ComponentType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0,
        }
    }

    fn full(self) -> f32 {
        match self {
            ComponentType::I8 => 127.0,
            ComponentType::U8 => 255.0,
            ComponentType::I16 => 32767.0,
            ComponentType::U16 => 65535.0,
            ComponentType::U32 => u32::MAX as f32,
            ComponentType::F32 => 1.0,
        }
    }
}

/// An accessor whose sizes have been checked.
pub(super) struct Accessor<'s> {
    number: usize,
    pub count: usize,
    component: ComponentType,
    pub width: usize,
    normalized: bool,
    /// The first element's bytes and what follows; `None` means all zeros.
    data: Option<&'s [u8]>,
    stride: usize,
    sparse: Option<Sparse<'s>>,
}

struct Sparse<'s> {
    count: usize,
    component: ComponentType,
    indices: &'s [u8],
    values: &'s [u8],
}

/// Cuts `count` elements of `size` bytes, `stride` apart, out of a view.
fn cut<'s>(
    source: &'s Source<'_>,
    (view, offset): (usize, u64),
    (count, size): (u64, usize),
    place: Arguments<'_>,
) -> Result<(&'s [u8], usize), ReadError> {
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
        let value = source.document.accessors.get(number)?;
        let Checked::Valid(component) = value.component_type else {
            return Err(bad(place, "its componentType is none that glTF 2.0 has"));
        };
        let component = component.0;
        let width = match value.type_ {
            Checked::Valid(kind @ (Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4)) => kind.multiplicity(),
            Checked::Valid(_) => return Err(bad(place, "its type is a matrix, which cannot be used here")),
            Checked::Invalid => return Err(bad(place, "its type is none that glTF 2.0 has")),
        };
        let USize64(count) = value.count;
        if count >= u64::from(u32::MAX) {
            return Err(bad(place, format!("its {count} elements are more than 32 bits can number")));
        }
        let size = component.bytes() * width;
        let (data, stride) = match value.buffer_view {
            Some(view) => {
                let view = source.document.views.check(view.value(), "bufferView", place)?;
                let offset = value.byte_offset.unwrap_or_default().0;
                let (data, stride) = cut(source, (view, offset), (count, size), place)?;
                (Some(data), stride)
            }
            None => (None, size),
        };
        let sparse = match &value.sparse {
            Some(sparse) => Some(Sparse::new(source, sparse, (number, count, size))?),
            None => None,
        };
        let normalized = component != ComponentType::F32 && value.normalized;
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
            let size = self.component.bytes() * self.width;
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
        let size = self.component.bytes();
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
        if self.width != 1 || !matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return Err(bad(place, "indices must be unsigned integers, one each"));
        }
        let mut out = match self.data {
            None => vec![0; self.count],
            Some(data) => {
                data.chunks(self.stride.max(1)).take(self.count).map(|bytes| self.component.integer(bytes)).collect()
            }
        };
        if let Some(sparse) = &self.sparse {
            for (index, bytes) in sparse.indices().zip(sparse.values.chunks(self.component.bytes())) {
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
    fn new(
        source: &'s Source<'_>,
        sparse: &sparse::Sparse,
        (number, of, size): (usize, u64, usize),
    ) -> Result<Self, ReadError> {
        let place = format_args!("accessors[{number}].sparse");
        let USize64(count) = sparse.count;
        if count > of {
            return Err(bad(place, format!("it replaces {count} elements of {of}")));
        }
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(bad(place, "its indices are not unsigned integers"));
        };
        let component = component.0;
        let (indices, values) = (&sparse.indices, &sparse.values);
        let part = |view: usize, offset: USize64, size: usize| {
            let view = source.document.views.check(view, "bufferView", place)?;
            cut(source, (view, offset.0), (count, size), place)
        };
        let (index_bytes, stride) = part(indices.buffer_view.value(), indices.byte_offset, component.bytes())?;
        let (value_bytes, value_stride) = part(values.buffer_view.value(), values.byte_offset, size)?;
        if stride != component.bytes() || value_stride != size {
            return Err(bad(place, "its buffer views must not have a byteStride"));
        }
        Ok(Sparse { count: count as usize, component, indices: index_bytes, values: value_bytes })
    }

    fn indices(&self) -> impl Iterator<Item = u32> + '_ {
        self.indices.chunks(self.component.bytes()).take(self.count).map(|bytes| self.component.integer(bytes))
    }

    fn out_of_range(&self, number: usize, index: u32, count: usize) -> ReadError {
        bad(
            format_args!("accessors[{number}].sparse"),
            format!("it replaces element {index}, but there are only {count}"),
        )
    }
}
