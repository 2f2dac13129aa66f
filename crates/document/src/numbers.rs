//! Numbers in text: what commands take, and how links and reports write them.
//!
//! One way in and one way out, so that the page holds one copy of each and both platforms agree on every bit. Reading is
//! exact (the f64 nearest to the decimal). Writing rounds to decimal places and then takes the fewest digits that read back.
//!
//! No number is written by the standard library: see `decimal.rs` for what that saves.

use crate::decimal::{self, DOUBLE, SINGLE};

/// A finite number: `3`, `-0.5`, `1e-3`.
pub fn number(text: &str) -> Option<f64> {
    decimal::read(text)
}

/// A number in the fewest digits that read back as it; zero without a sign.
pub fn text(value: f64) -> String {
    written(value, || decimal::write(value.abs().to_bits(), DOUBLE))
}

/// A single-precision number in the fewest digits that read back as it; zero without a sign.
pub fn text_single(value: f32) -> String {
    written(value.into(), || decimal::write(value.abs().to_bits().into(), SINGLE))
}

fn written(value: f64, size: impl Fn() -> String) -> String {
    let size = match value {
        _ if value.is_nan() => return "NaN".to_owned(),
        _ if value.is_infinite() => "inf".to_owned(),
        _ => size(),
    };
    if value < 0.0 { format!("-{size}") } else { size }
}

/// A finite single-precision number.
pub fn single(text: &str) -> Option<f32> {
    number(text).map(|v| v as f32).filter(|v| v.is_finite())
}

/// The power of ten at or below a positive `value`, from -45 to 38: what single precision reaches.
pub fn decade(value: f64) -> i32 {
    // The tiny factor lifts values such as 0.01_f32, which lies just below its power of ten.
    let value = value * (1.0 + 1e-6);
    let reached = |n: &i32| if *n < 0 { value * ten(-n) >= 1.0 } else { value >= ten(*n) };
    (-45..=38).rev().find(reached).unwrap_or(-45)
}

/// `value` rounded to `places` decimal places (negative: to tens, hundreds ...), in the fewest characters.
pub fn decimal(value: f64, places: i32) -> String {
    let scale = ten(places.abs());
    let rounded = if places >= 0 { (value * scale).round() / scale } else { (value / scale).round() * scale };
    text(rounded)
}

/// `value` with so many digits that count: "0.9531", "1412", "2.1e-7".
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return text(value);
    }
    let places = digits - 1 - decade(value.abs());
    let text = decimal(value, places);
    let rounded = number(&text).unwrap_or(value);
    // Rounding may have reached the next power of ten.
    let power = decade(rounded.abs());
    if (-4..6).contains(&power) {
        return text;
    }
    let mantissa = if power < 0 { rounded * ten(-power) } else { rounded / ten(power) };
    format!("{}e{power}", decimal(mantissa, digits - 1))
}

/// `10^n`, `n >= 0`; exact up to 22.
fn ten(n: i32) -> f64 {
    (0..n).fold(1.0, |p, _| p * 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_finite_and_whole_words() {
        assert_eq!(number("1e-3"), Some(0.001));
        assert_eq!(number("-.5"), Some(-0.5));
        assert_eq!(number("+7."), Some(7.0));
        for bad in ["", "nan", "inf", "-infinity", "1e999", "1 ", "0x10", "1,5", "--1", "e5", "."] {
            assert_eq!(number(bad), None, "{bad}");
        }
        assert_eq!(single("1e39"), None);
    }

    #[test]
    fn halves_and_ends() {
        // Between two floats, exactly or by the last of many digits.
        for (text, value) in [
            ("9007199254740993", 9_007_199_254_740_992.0),
            ("9007199254740993.0000000000000000000000000000000001", 9_007_199_254_740_994.0),
            ("9007199254740995", 9_007_199_254_740_996.0),
            ("2.4703282292062327208e-324", 0.0),
            ("2.4703282292062328e-324", 5e-324),
            ("1.7976931348623158e308", f64::MAX),
        ] {
            assert_eq!(number(text), Some(value), "{text}");
        }
        let half = format!("{}5{}1", "0.", "0".repeat(900));
        assert_eq!(number(&half), Some(0.5));
        let tie = format!("9007199254740993.{}1", "0".repeat(900));
        assert_eq!(number(&tie), Some(9_007_199_254_740_994.0), "what is left out still counts");
        assert_eq!(number("1.7976931348623159e308"), None);
        for value in [5e-324, f64::MIN_POSITIVE, f64::MAX, 2.0_f64.powi(-44), 9_007_199_254_740_992.0, 1e23, 0.1] {
            assert_eq!(text(value), value.to_string());
        }
        for value in [1e-45_f32, f32::MIN_POSITIVE, f32::MAX, 16_777_216.0, 0.3, 8.5e-8] {
            assert_eq!(text_single(-value), (-value).to_string());
        }
        assert_eq!((text(-0.0), text_single(0.0)), ("0".into(), "0".into()));
    }

    #[test]
    fn decades_and_places() {
        assert_eq!([0.01_f32, 0.99, 1.0, 999.9, 1e30].map(|v| decade(v.into())), [-2, -1, 0, 2, 30]);
        assert_eq!([decade(0.0), decade(1e-40), decade(1e40)], [-45, -40, 38]);
        assert_eq!(decimal(4.567_891, 3), "4.568");
        assert_eq!(decimal(123_456.0, -1), "123460");
        assert_eq!(decimal(-0.04, 1), "0");
        assert_eq!(
            [0.953_141, 1411.6, -2.1e-7, 9.9999e7, 0.0, 123_456.0, 1e6].map(|v| significant(v, 4)),
            ["0.9531", "1412", "-2.1e-7", "1e8", "0", "123500", "1e6"]
        );
    }

    proptest! {
        /// As exact as the standard library's reader.
        #[test]
        fn reading_agrees_with_the_standard_library(bits in any::<u64>(), places in 0..20_usize) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(number(&value.to_string()), Some(value));
            let short = format!("{value:.places$e}");
            prop_assert_eq!(number(&short), short.parse().ok().filter(|v: &f64| v.is_finite()));
        }

        /// And its writer.
        #[test]
        fn writing_agrees_with_the_standard_library(bits in any::<u64>(), power in any::<bool>()) {
            // Powers of two have a nearer neighbour below than above.
            let bits = if power { bits & !((1 << 52) - 1) } else { bits };
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite() && value != 0.0);
            prop_assert_eq!(text(value), value.to_string());
            let bits = (bits >> 32) as u32;
            let value = f32::from_bits(if power { bits & !((1 << 23) - 1) } else { bits });
            prop_assume!(value.is_finite() && value != 0.0);
            prop_assert_eq!(text_single(value), value.to_string());
        }

        #[test]
        fn numbers_of_few_digits_are_written_so(mantissa in -99_999_i32..99_999, exponent in 0..8_i32) {
            let value = f64::from(mantissa) / ten(exponent);
            prop_assert_eq!(text(value), (value + 0.0).to_string());
            prop_assert_eq!(text_single(value as f32), (value as f32 + 0.0).to_string());
        }

        #[test]
        fn long_and_broken_texts_are_read_like_there(text in "[-+]?[0-9]{0,30}[.]?[0-9]{0,40}([eE][-+]?[0-9]{0,4})?") {
            prop_assert_eq!(number(&text), text.parse().ok().filter(|v: &f64| v.is_finite()), "{}", text);
        }
    }
}
