//! Small helpers over a parsed JSON value: lists, numbers and references, with errors that name the place.

use std::fmt::Arguments;

use serde_json::Value;

use crate::{ReadError, error::short};

/// An error about an element of the file.
pub(super) fn bad(place: Arguments<'_>, problem: impl Into<String>) -> ReadError {
    ReadError::Element { place: place.to_string(), problem: problem.into() }
}

/// An array property; empty if it is missing.
pub(super) fn list<'v>(value: &'v Value, key: &str) -> &'v [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// A text property.
pub(super) fn text<'v>(value: &'v Value, key: &str) -> Option<&'v str> {
    value.get(key).and_then(Value::as_str)
}

/// An extension of an object.
pub(super) fn extension<'v>(value: &'v Value, name: &str) -> Option<&'v Value> {
    value.get("extensions")?.get(name)
}

/// A property that must be a whole number, not negative; `None` if it is missing.
pub(super) fn whole(value: &Value, key: &str, place: Arguments<'_>) -> Result<Option<u64>, ReadError> {
    let Some(number) = value.get(key) else { return Ok(None) };
    // Some writers print 3.0.
    let float = number.as_f64().filter(|f| *f >= 0.0 && *f < 9e15 && f.trunc() == *f).map(|f| f as u64);
    match number.as_u64().or(float) {
        Some(number) => Ok(Some(number)),
        None => Err(bad(place, format!("its {key} is not a whole number"))),
    }
}

/// A property that refers to an element of a list of `count`; `None` if it is missing.
pub(super) fn index(value: &Value, key: &str, count: usize, place: Arguments<'_>) -> Result<Option<usize>, ReadError> {
    match whole(value, key, place)? {
        None => Ok(None),
        Some(number) if number < count as u64 => Ok(Some(number as usize)),
        Some(number) => Err(bad(place, format!("its {key} is {number}, but the file has only {count}"))),
    }
}

/// A property of exactly `N` finite numbers; `None` if it is missing.
pub(super) fn numbers<const N: usize>(
    value: &Value,
    key: &str,
    place: Arguments<'_>,
) -> Result<Option<[f64; N]>, ReadError> {
    let Some(list) = value.get(key) else { return Ok(None) };
    let mut out = [0.0; N];
    let given = list.as_array().map_or(&[][..], Vec::as_slice);
    let mut good = given.len() == N;
    for (slot, number) in out.iter_mut().zip(given) {
        match number.as_f64() {
            Some(number) => *slot = number,
            None => good = false,
        }
    }
    if good { Ok(Some(out)) } else { Err(bad(place, format!("its {key} is not a list of {N} numbers"))) }
}

/// A value for a message. Numbers and texts only: printing any JSON would bring in a whole serialiser.
pub(super) fn shown(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => number.to_string(),
        (_, Some(text)) => format!("\"{}\"", short(text)),
        _ => "(not a number)".to_owned(),
    }
}
