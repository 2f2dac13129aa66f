//! A byte cursor for the line-based text formats: one pass, no allocation, and the line number always at hand.
//!
//! The end of the data reads as a line break, so no caller checks for it. `\n`, `\r\n` and a lone `\r` all end a line, and
//! a backslash before a line break counts as a space (a continuation), wherever it stands.
//!
//! Numbers are read in the spirit of Clinger ("How to read floating point numbers accurately", 1990): up to 19 digits are
//! summed in an integer, and one multiplication or division by a power of ten gives an f64 that is wrong in its last two
//! bits at most. Unless that f64 lies almost exactly between two f32s, rounding it gives the correctly rounded f32; the few
//! others, longer numbers and large exponents go to the standard library's slower parser.

/// Why a number could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberError {
    /// The line ended before a number came.
    Missing,
    /// What stands there is not a number.
    NotANumber,
    /// NaN, an infinity, or a number beyond the range of f32.
    NotFinite,
}

/// A position in a text.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    data: &'a [u8],
    at: usize,
    line: u64,
}

/// Powers of ten as f64: exact up to 1e22, then rounded.
const POWERS: [f64; 39] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22, 1e23, 1e24, 1e25, 1e26, 1e27, 1e28, 1e29, 1e30, 1e31, 1e32, 1e33, 1e34, 1e35, 1e36, 1e37, 1e38,
];

impl<'a> Cursor<'a> {
    /// Starts at the first line, past a UTF-8 byte order mark.
    pub fn new(data: &'a [u8]) -> Self {
        let data = data.strip_prefix(b"\xef\xbb\xbf").unwrap_or(data);
        Cursor { data, at: 0, line: 1 }
    }

    /// The 1-based number of the line that the cursor is on.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Whether all bytes are used up.
    pub fn at_end(&self) -> bool {
        self.at >= self.data.len()
    }

    #[inline(always)]
    fn peek(&self) -> u8 {
        self.data.get(self.at).copied().unwrap_or(b'\n')
    }

    fn peek_at(&self, ahead: usize) -> u8 {
        self.data.get(self.at + ahead).copied().unwrap_or(b'\n')
    }

    /// Skips blanks and line continuations.
    #[inline(always)]
    pub fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                b'\\' if matches!(self.peek_at(1), b'\n' | b'\r') && self.at < self.data.len() => {
                    self.at += 1;
                    self.line_break();
                }
                _ => break,
            }
        }
    }

    /// Steps over one line break if the cursor stands on it.
    #[inline(always)]
    fn line_break(&mut self) {
        if self.at_end() {
            return;
        }
        match self.peek() {
            b'\r' => self.at += if self.peek_at(1) == b'\n' && self.at + 1 < self.data.len() { 2 } else { 1 },
            b'\n' => self.at += 1,
            _ => return,
        }
        self.line += 1;
    }

    /// Skips blanks and says whether the statement ends here (line break, comment or end of data).
    #[inline(always)]
    pub fn at_line_end(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.peek(), b'\n' | b'\r' | b'#')
    }

    /// Goes to the start of the next statement: past the line break, following continuations unless in a comment.
    pub fn next_line(&mut self) {
        loop {
            match self.peek() {
                b'\n' | b'\r' => return self.line_break(),
                b'#' => {
                    self.skip_to_break();
                    return self.line_break();
                }
                b'\\' => {
                    self.at += 1;
                    self.line_break();
                }
                _ => self.at += 1,
            }
        }
    }

    fn skip_to_break(&mut self) {
        let rest = self.data.get(self.at..).unwrap_or_default();
        self.at += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
    }

    /// The next word: everything up to a blank or the line's end. Empty at the line's end.
    pub fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        loop {
            match self.peek() {
                b' ' | b'\t' | 0x0b | 0x0c | b'\n' | b'\r' => break,
                b'\\' if matches!(self.peek_at(1), b'\n' | b'\r') => break,
                _ => self.at += 1,
            }
        }
        self.data.get(start..self.at).unwrap_or_default()
    }

    /// The rest of the line as a name: trimmed, without a comment that has blanks on both sides of its `#`.
    ///
    /// A `#` inside or at the start of a word stays, because names such as `Material #25` are common.
    pub fn rest(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        let mut end = start;
        loop {
            match self.peek() {
                b'\n' | b'\r' => break,
                b'\\' if matches!(self.peek_at(1), b'\n' | b'\r') => break,
                b'#' if (end < self.at || end == start) && matches!(self.peek_at(1), b' ' | b'\t' | b'\n' | b'\r') => {
                    break;
                }
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                _ => {
                    self.at += 1;
                    end = self.at;
                }
            }
        }
        self.data.get(start..end).unwrap_or_default()
    }

    /// Reads one number as an f32, correctly rounded.
    #[inline(always)]
    pub fn float(&mut self) -> Result<f32, NumberError> {
        self.skip_blanks();
        let start = self.at;
        if let Some(value) = self.quick_number() {
            // The dropped 29 bits are one half, give or take the f64's own error: the direction is not certain. Nor is it
            // where f32 has fewer bits than usual (below its smallest normal number).
            let between = (value.to_bits() & 0x1fff_ffff).abs_diff(0x1000_0000) <= 8;
            let size = value.abs();
            if !between && (size == 0.0 || (1.2e-38..3.4e38).contains(&size)) {
                return Ok(value as f32);
            }
        }
        self.at = start;
        self.slow_number()
    }

    /// Reads one number as an f64, exact but for its last bits. Colours need more than f32: the conversion to linear light
    /// and back must give the same f32.
    pub fn double(&mut self) -> Result<f64, NumberError> {
        self.skip_blanks();
        let start = self.at;
        if let Some(value) = self.quick_number() {
            return Ok(value);
        }
        self.at = start;
        self.slow_number()
    }

    /// A number of up to 19 digits, wrong in the last two bits at most; `None` leaves the cursor anywhere in the word.
    #[inline(always)]
    fn quick_number(&mut self) -> Option<f64> {
        let negative = match self.peek() {
            b'-' => {
                self.at += 1;
                true
            }
            b'+' => {
                self.at += 1;
                false
            }
            _ => false,
        };
        let mut mantissa = 0u64;
        let start = self.at;
        mantissa = self.digits(mantissa);
        // A lone zero before the point takes no room in the sum.
        let mut digits = if mantissa == 0 && self.at == start + 1 { 0 } else { self.at - start };
        let mut any = self.at > start;
        let mut exponent = 0i32;
        if self.peek() == b'.' {
            self.at += 1;
            let point = self.at;
            mantissa = self.digits(mantissa);
            let decimals = self.at - point;
            digits += decimals;
            any |= decimals > 0;
            exponent = -(decimals.min(100) as i32);
        }
        if !any || digits > 19 {
            return None;
        }
        if matches!(self.peek(), b'e' | b'E') {
            self.at += 1;
            let minus = match self.peek() {
                b'-' => {
                    self.at += 1;
                    true
                }
                b'+' => {
                    self.at += 1;
                    false
                }
                _ => false,
            };
            let start = self.at;
            let power = self.digits(0);
            if self.at == start || self.at - start > 4 {
                return None;
            }
            exponent += if minus { -(power as i32) } else { power as i32 };
        }
        if !self.at_token_end() || self.peek() == b'#' {
            return None;
        }
        let scale = *POWERS.get(exponent.unsigned_abs() as usize)?;
        let value = if exponent < 0 { mantissa as f64 / scale } else { mantissa as f64 * scale };
        Some(if negative { -value } else { value })
    }

    #[inline(always)]
    fn digits(&mut self, mut sum: u64) -> u64 {
        loop {
            let digit = self.peek().wrapping_sub(b'0');
            if digit > 9 {
                return sum;
            }
            // May wrap around past 19 digits; the caller counts them.
            sum = sum.wrapping_mul(10).wrapping_add(u64::from(digit));
            self.at += 1;
        }
    }

    #[inline(always)]
    fn at_token_end(&self) -> bool {
        matches!(self.peek(), b' ' | b'\t' | 0x0b | 0x0c | b'\n' | b'\r' | b'\\' | b'#')
    }

    #[cold]
    #[inline(never)]
    fn slow_number<T: std::str::FromStr + Into<f64> + Copy>(&mut self) -> Result<T, NumberError> {
        if self.at_line_end() {
            return Err(NumberError::Missing);
        }
        let start = self.clone();
        let whole = self.word();
        // A comment may touch the number.
        let word = whole.split(|b| *b == b'#').next().unwrap_or_default();
        let special = |word: &[u8]| {
            // What C libraries print: "-nan(ind)", "1.#QNAN", "-1.#INF".
            let lower = word.to_ascii_lowercase();
            let bare = lower.strip_prefix(b"-").or(lower.strip_prefix(b"+")).unwrap_or(&lower);
            [&b"nan"[..], b"inf", b"1.#"].iter().any(|p| bare.starts_with(p))
        };
        let touching = word.len() < whole.len();
        let error = match std::str::from_utf8(word).ok().map(str::parse::<T>) {
            Some(Ok(value)) if value.into().is_finite() && !(touching && special(whole)) => return Ok(value),
            Some(Ok(_)) => NumberError::NotFinite,
            _ if special(whole) => NumberError::NotFinite,
            _ => NumberError::NotANumber,
        };
        *self = start;
        Err(error)
    }

    /// Reads an integer that ends at a blank, a slash or the line's end; `None` if there is none. Numbers of more than 18
    /// digits come out as the largest value.
    #[inline(always)]
    pub fn integer(&mut self) -> Option<i64> {
        let negative = match self.peek() {
            b'-' => {
                self.at += 1;
                true
            }
            b'+' => {
                self.at += 1;
                false
            }
            _ => false,
        };
        let start = self.at;
        let value = self.digits(0);
        let count = self.at - start;
        if count == 0 {
            return None;
        }
        let value = if count > 18 { i64::MAX } else { value as i64 };
        Some(if negative { -value } else { value })
    }

    /// Steps over `byte` if it stands here.
    #[inline(always)]
    pub fn eat(&mut self, byte: u8) -> bool {
        let hit = self.peek() == byte && !self.at_end();
        self.at += usize::from(hit);
        hit
    }

    /// Whether the word ends here.
    #[inline(always)]
    pub fn word_ends(&self) -> bool {
        self.at_token_end()
    }

    /// The word under the cursor for a message: whole even if the cursor is inside it, at most 40 characters.
    pub fn quote(&self) -> String {
        let mut start = self.at;
        while start > 0 && self.data.get(start - 1).is_some_and(|b| !b.is_ascii_whitespace()) {
            start -= 1;
        }
        let mut cursor = self.clone();
        cursor.at = start;
        quote(cursor.word())
    }
}

/// Bytes as text for a message: at most 40 characters, control characters shown as `?`.
pub(crate) fn quote(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes.get(..bytes.len().min(200)).unwrap_or_default());
    let mut out: String = text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().count() > 40 {
        out.push('\u{2026}');
    }
    out
}
