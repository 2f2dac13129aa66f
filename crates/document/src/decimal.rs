//! Decimal numbers, exactly: from text to the nearest float and back to the shortest text.
//!
//! ```text
//!   0.625  =  0.d₁d₂d₃ · 10^point      a row of digits that can be doubled and halved without losing any
//!      double, halve until 1/2 <= x < 1,  then double 53 times and round  ──>  mantissa
//!      mantissa · 2^e: double or halve |e| times, then the fewest digits that read back  ──>  text
//! ```
//!
//! The algorithm is the plain one that fast readers fall back on (N. Tao, "ParseNumberF64 by Simple Decimal Conversion", 2020;
//! the fewest digits: G. Steele and J. White, "How to print floating-point numbers accurately", 1990). It needs no table of
//! powers, which the standard library has in thirty kilobytes of reader and writer; a page that reads and writes a few numbers a
//! frame ships a tenth of that. Results are the standard library's, digit for digit; tests hold it to
//! that. Cost: a microsecond for numbers near 1, proportional to the exponent's square elsewhere.

/// Digits that are kept. The longest float has 767; of a longer text only whether more follow can matter.
const MOST: usize = 800;
/// Doublings at a time: a digit and a carry stay within 64 bits.
const STEP: u32 = 50;

/// How a float is laid out.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    /// Bits of the mantissa that are stored.
    fraction: u32,
    /// The exponent of the smallest positive number, negated.
    least: i32,
    /// The bits of infinity.
    infinite: u64,
}

/// Of `f64`.
pub(crate) const DOUBLE: Layout = Layout { fraction: 52, least: 1074, infinite: 0x7ff << 52 };
/// Of `f32`.
pub(crate) const SINGLE: Layout = Layout { fraction: 23, least: 149, infinite: 0xff << 23 };

/// A number from 0 up: `0.d₁d₂d₃... · 10^point`, without zeros at either end.
#[derive(Clone, Default)]
struct Decimal {
    digits: Vec<u8>,
    point: i32,
    /// Whether digits other than 0 were left out at the end.
    more: bool,
}

/// Reads `12`, `-0.5`, `+7.`, `1e-3`; none if it is no number or too large for a float.
pub(crate) fn read(text: &str) -> Option<f64> {
    let (negative, text) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (text, exponent) = match text.split_once(['e', 'E']) {
        Some((text, exponent)) => (text, whole(exponent)?),
        None => (text, 0),
    };
    let (before, after) = text.split_once('.').unwrap_or((text, ""));
    let mut decimal =
        Decimal { point: i32::try_from(before.len()).ok()?.saturating_add(exponent), ..Decimal::default() };
    for digit in before.bytes().chain(after.bytes()) {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        if decimal.digits.len() < MOST {
            decimal.digits.push(digit);
        } else {
            decimal.more |= digit > 0;
        }
    }
    if decimal.digits.is_empty() {
        return None;
    }
    decimal.trim();
    let bits = decimal.to_bits(DOUBLE)?;
    Some(f64::from_bits(bits | u64::from(negative) << 63))
}

/// The exponent's digits; far beyond any float's they count as a large number.
fn whole(text: &str) -> Option<i32> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let value = digits.bytes().fold(0_i32, |value, b| value.saturating_mul(10).saturating_add(i32::from(b - b'0')));
    Some(if negative { -value } else { value })
}

/// The shortest text that reads back as the finite float with these bits, its sign aside, and of those the nearest to it. No
/// exponent is written.
pub(crate) fn write(bits: u64, layout: Layout) -> String {
    let exact = Decimal::of_bits(bits, layout);
    let mut shortest = exact.clone();
    for count in 1..exact.digits.len() {
        let (down, up) = exact.around(count);
        let reads = |decimal: &Decimal| decimal.to_bits(layout) == Some(bits);
        // Digits beyond the cut are half of its last place or more.
        let high = exact.digits.get(count).is_some_and(|d| *d >= 5);
        match (reads(&down), reads(&up)) {
            (true, true) => shortest = if high { up } else { down },
            (true, false) => shortest = down,
            (false, true) => shortest = up,
            (false, false) => continue,
        }
        break;
    }
    shortest.text()
}

impl Decimal {
    /// `mantissa · 2^exponent`, exactly.
    fn of_bits(bits: u64, layout: Layout) -> Decimal {
        let stored = (bits >> layout.fraction) as i32;
        let fraction = bits & ((1 << layout.fraction) - 1);
        // Numbers with the least exponent have no hidden bit.
        let mantissa = if stored == 0 { fraction } else { fraction | 1 << layout.fraction };
        let text = mantissa.to_string();
        let mut decimal =
            Decimal { point: text.len() as i32, digits: text.bytes().map(|b| b - b'0').collect(), more: false };
        decimal.trim();
        decimal.scale(stored.max(1) - 1 - layout.least);
        decimal
    }

    /// The bits of the nearest float, of two the even one; none if it is too large for one.
    fn to_bits(&self, layout: Layout) -> Option<u64> {
        if self.digits.is_empty() || self.point < -400 {
            return Some(0);
        }
        if self.point > 400 {
            return None;
        }
        let mut x = self.clone();
        let mut exponent = 0;
        while x.point != 0 || x.digits.first().is_some_and(|d| *d < 5) {
            // Never past 1/2 downward by more than one decade, never up to 1.
            let by = if x.point > 0 { 2 - 3 * x.point } else { (-3 * x.point).max(1) };
            let by = by.clamp(-(STEP as i32), STEP as i32);
            x.scale(by);
            exponent -= by;
        }
        let unit = (exponent - layout.fraction as i32 - 1).max(-layout.least);
        x.scale(exponent - unit);
        // The hidden bit adds one to the exponent.
        Some(x.rounded() + (((unit + layout.least) as u64) << layout.fraction)).filter(|bits| *bits < layout.infinite)
    }

    /// Doubles so many times, or halves.
    fn scale(&mut self, by: i32) {
        let mut left = by.unsigned_abs();
        while left > 0 {
            let step = left.min(STEP);
            if by > 0 {
                self.double(step)
            } else {
                self.halve(step)
            }
            left -= step;
        }
    }

    fn double(&mut self, times: u32) {
        let mut carry = 0;
        for digit in self.digits.iter_mut().rev() {
            let n = (u64::from(*digit) << times) + carry;
            *digit = (n % 10) as u8;
            carry = n / 10;
        }
        while carry > 0 {
            self.digits.insert(0, (carry % 10) as u8);
            self.point += 1;
            carry /= 10;
        }
        self.trim();
    }

    fn halve(&mut self, times: u32) {
        let mut rest = 0;
        let mut given = std::mem::take(&mut self.digits).into_iter();
        loop {
            let next = given.next();
            if next.is_none() && (rest == 0 || self.digits.len() > MOST) {
                break;
            }
            rest = rest * 10 + u64::from(next.unwrap_or(0));
            self.digits.push((rest >> times) as u8);
            rest &= (1 << times) - 1;
        }
        self.more |= rest > 0;
        self.trim();
    }

    /// Takes zeros away at both ends, and digits that are too many.
    fn trim(&mut self) {
        let zeros = self.digits.iter().take_while(|d| **d == 0).count();
        self.digits.drain(..zeros);
        self.point -= zeros as i32;
        while let Some(digit) = self.digits.pop() {
            if self.digits.len() < MOST && digit > 0 {
                self.digits.push(digit);
                break;
            }
            self.more |= digit > 0;
        }
    }

    /// The nearest whole number, of two the even one; below 2^64.
    fn rounded(&self) -> u64 {
        let digit = |at: i32| usize::try_from(at).ok().and_then(|at| self.digits.get(at)).copied().unwrap_or(0);
        let whole = (0..self.point).fold(0, |n: u64, at| n * 10 + u64::from(digit(at)));
        let next = digit(self.point);
        let beyond = self.more || self.digits.len() as i32 > self.point + 1;
        let up = self.point >= 0 && (next > 5 || next == 5 && (beyond || whole % 2 == 1));
        whole + u64::from(up)
    }

    /// The numbers with `count` digits on either side.
    fn around(&self, count: usize) -> (Decimal, Decimal) {
        let mut down = Decimal { digits: self.digits.iter().take(count).copied().collect(), ..*self };
        let mut up = down.clone();
        up.digits.insert(0, 0);
        up.point += 1;
        for digit in up.digits.iter_mut().rev() {
            *digit = (*digit + 1) % 10;
            if *digit > 0 {
                break;
            }
        }
        down.trim();
        up.trim();
        (down, up)
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let end = self.digits.len() as i32;
        for at in self.point.min(1) - 1..end.max(self.point) {
            if at == self.point {
                text.push('.');
            }
            let digit = usize::try_from(at).ok().and_then(|at| self.digits.get(at)).copied().unwrap_or(0);
            text.push(char::from(b'0' + digit));
        }
        text
    }
}
