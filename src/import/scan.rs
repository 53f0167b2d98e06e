//! A scanner over the bytes of a text mesh: numbers and words, line by line, without allocation.

use super::json::printable;

/// Where in a mesh file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spot {
    /// The file as a whole.
    File,
    /// Line and column in bytes, from 1.
    Line(usize, usize),
    /// Byte offset.
    Byte(usize),
}

/// What is wrong with a mesh file.
#[derive(Debug)]
pub(super) struct MeshError {
    /// Where.
    pub at: Spot,
    /// What was found and what is allowed.
    pub message: String,
}

/// The result of reading a part of a mesh file; the error is boxed so that numbers come back in registers.
pub(super) type Scanned<T> = Result<T, Box<MeshError>>;

impl MeshError {
    /// An error at a place.
    #[cold]
    pub fn new(at: Spot, message: impl Into<String>) -> Box<Self> {
        Box::new(Self { at, message: message.into() })
    }

    /// An error about the whole file.
    #[cold]
    pub fn file(message: impl Into<String>) -> Box<Self> {
        Self::new(Spot::File, message)
    }

    /// An error at a byte.
    #[cold]
    pub fn byte(offset: usize, message: impl Into<String>) -> Box<Self> {
        Self::new(Spot::Byte(offset), message)
    }
}

/// A position in a text.
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    /// Offset of the next byte.
    pos: usize,
    line: usize,
    line_start: usize,
}

/// Bytes as text for a message.
pub(super) fn show(bytes: &[u8]) -> String {
    printable(&String::from_utf8_lossy(&bytes[..bytes.len().min(200)]))
}

impl<'a> Scanner<'a> {
    /// A scanner at an offset that is the start of a line (counted from 1).
    pub fn new(bytes: &'a [u8], pos: usize, line: usize) -> Self {
        Self { bytes, pos, line, line_start: pos }
    }

    /// The offset of the next byte.
    pub fn offset(&self) -> usize {
        self.pos
    }

    /// The line of the next byte, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Where the scanner stands.
    pub fn here(&self) -> Spot {
        Spot::Line(self.line, self.pos - self.line_start + 1)
    }

    /// An error where the scanner stands.
    #[cold]
    pub fn error<T>(&self, message: impl Into<String>) -> Scanned<T> {
        Err(MeshError::new(self.here(), message))
    }

    /// Whether the text has ended.
    pub fn at_end(&self) -> bool {
        self.pos >= self.bytes.len()
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.pos).copied()
    }

    /// Skips blanks within the line, and line ends that a backslash hides.
    #[inline]
    pub fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            match byte {
                b' ' | b'\t' | b'\r' => self.pos += 1,
                b'\\' => {
                    let rest = &self.bytes[self.pos + 1..];
                    let newline = if rest.starts_with(b"\r\n") { 2 } else { 1 };
                    if rest.get(newline - 1) != Some(&b'\n') {
                        break;
                    }
                    self.pos += 1 + newline;
                    self.line += 1;
                    self.line_start = self.pos;
                }
                _ => break,
            }
        }
    }

    /// Whether nothing but blanks and perhaps a comment (`#`) is left on the line.
    #[inline]
    pub fn line_is_done(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.peek(), None | Some(b'\n' | b'#'))
    }

    /// Goes to the start of the next line, or to the end of the last.
    pub fn next_line(&mut self) {
        match self.bytes[self.pos..].iter().position(|&b| b == b'\n') {
            Some(n) => {
                self.pos += n + 1;
                self.line += 1;
                self.line_start = self.pos;
            }
            None => self.pos = self.bytes.len(),
        }
    }

    /// The word at the scanner, up to a blank or the line's end; empty when there is none.
    #[inline]
    fn word_here(&self) -> &'a [u8] {
        let rest = &self.bytes[self.pos..];
        let end = rest.iter().position(|b| matches!(b, b' ' | b'\t' | b'\r' | b'\n')).unwrap_or(rest.len());
        &rest[..end]
    }

    /// Reads the next word of the line; empty when there is none.
    #[inline]
    pub fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let word = self.word_here();
        self.pos += word.len();
        word
    }

    #[cold]
    fn expected<T>(&mut self, what: &str) -> Scanned<T> {
        if self.line_is_done() {
            return self.error(format!("the line ends where {what} is expected"));
        }
        let found = show(self.word_here());
        self.error(format!("expected {what}, found `{found}`"))
    }

    /// Reads a finite number, rounded correctly to 32 bits.
    #[inline]
    pub fn float(&mut self, what: &str) -> Scanned<f32> {
        self.skip_blanks();
        let rest = &self.bytes[self.pos..];
        if let Some((value, length)) = simple_float(rest) {
            self.pos += length;
            return Ok(value);
        }
        let word = self.word_here();
        let value = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f32>().ok());
        match value {
            Some(value) if value.is_finite() => {
                self.pos += word.len();
                Ok(value)
            }
            // A number that is too large, and no word for infinity.
            Some(value) if value.is_infinite() && word.iter().any(u8::is_ascii_digit) => {
                let message =
                    format!("{what} {} is out of range; allowed: -3.4e38 to 3.4e38 (32-bit floats)", show(word));
                self.error(message)
            }
            Some(_) => {
                let message = format!("{what} `{}` is not finite; allowed: -3.4e38 to 3.4e38", show(word));
                self.error(message)
            }
            None => self.expected(&format!("a number ({what})")),
        }
    }

    /// Reads a whole number that ends at a blank, the line's end or a `/`.
    #[inline]
    pub fn integer(&mut self, what: &str) -> Scanned<i64> {
        self.skip_blanks();
        let rest = &self.bytes[self.pos..];
        let negative = rest.first() == Some(&b'-');
        let signed = usize::from(negative || rest.first() == Some(&b'+'));
        let mut value = 0i64;
        let mut end = signed;
        while let Some(digit) = rest.get(end).filter(|b| b.is_ascii_digit()) {
            // Eighteen digits fit; more are no index of anything, and saturate.
            value = if end - signed < 18 { value * 10 + i64::from(digit - b'0') } else { i64::MAX };
            end += 1;
        }
        let ends_well = matches!(rest.get(end), None | Some(b' ' | b'\t' | b'\r' | b'\n' | b'/' | b'\\'));
        if end == signed || !ends_well {
            return self.expected(&format!("a whole number ({what})"));
        }
        self.pos += end;
        Ok(if negative { -value } else { value })
    }

    /// Skips a `/`, if one is next.
    #[inline]
    pub fn slash(&mut self) -> bool {
        let found = self.peek() == Some(b'/');
        self.pos += usize::from(found);
        found
    }

    /// Whether a digit or a sign is next.
    #[inline]
    pub fn at_integer(&self) -> bool {
        matches!(self.peek(), Some(b'0'..=b'9' | b'-' | b'+'))
    }

    /// Demands that the line is over and goes to the next.
    pub fn finish_line(&mut self, what: &str) -> Scanned<()> {
        if !self.line_is_done() {
            let found = show(self.word_here());
            return self.error(format!("`{found}` follows {what}; the line should end here"));
        }
        self.next_line();
        Ok(())
    }
}

/// Powers of ten that f64 holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// The number at the start of `bytes` and its length, where it is of the kind meshes are full of: at most 15 digits and
/// a small exponent. Mantissa and power of ten are then exact in f64 and their quotient is rounded once (Clinger 1990,
/// "How to read floating point numbers accurately"). Rounding that to f32 is a second rounding, harmless unless the f64
/// lies exactly between two f32 values. In every other case: `None`, and the standard library's parser decides.
#[inline]
fn simple_float(bytes: &[u8]) -> Option<(f32, usize)> {
    let negative = bytes.first() == Some(&b'-');
    let mut i = usize::from(negative || bytes.first() == Some(&b'+'));
    let (mut mantissa, mut digits, mut decimals) = (0u64, 0i32, 0i32);
    while let Some(d) = bytes.get(i).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
        digits += 1;
        i += 1;
    }
    if bytes.get(i) == Some(&b'.') {
        i += 1;
        while let Some(d) = bytes.get(i).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
            decimals += 1;
            i += 1;
        }
    }
    digits += decimals;
    if digits == 0 || digits > 15 {
        return None;
    }
    let mut exponent = -decimals;
    if matches!(bytes.get(i), Some(b'e' | b'E')) {
        i += 1;
        let minus = bytes.get(i) == Some(&b'-');
        i += usize::from(minus || bytes.get(i) == Some(&b'+'));
        let start = i;
        let mut written = 0i32;
        while let Some(d) = bytes.get(i).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            written = written * 10 + i32::from(d);
            i += 1;
            if i - start > 4 {
                return None;
            }
        }
        if i == start {
            return None;
        }
        exponent += if minus { -written } else { written };
    }
    if !matches!(bytes.get(i), None | Some(b' ' | b'\t' | b'\r' | b'\n' | b'\\')) {
        return None;
    }
    let power = *EXACT_POWERS.get(exponent.unsigned_abs() as usize)?;
    let m = mantissa as f64;
    let exact = if exponent < 0 { m / power } else { m * power };
    // The 29 bits that f32 drops: exactly one half means a tie that the first rounding may have made.
    if exact.to_bits() & 0x1fff_ffff == 0x1000_0000 {
        return None;
    }
    let value = exact as f32;
    Some((if negative { -value } else { value }, i))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_rounded_as_the_standard_library_rounds_them() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        let mut fast = 0;
        for _ in 0..200_000 {
            let (digits, place, exponent) = (next() % 1_000_000_000_000, next() % 10, next() % 50);
            let mut text = digits.to_string();
            text.insert((place as usize).min(text.len()), '.');
            match exponent {
                0..=20 => {}
                e => text.push_str(&format!("e{}", e as i64 - 35)),
            }
            let expected: f32 = text.parse().unwrap();
            if let Some((value, length)) = simple_float(text.as_bytes()) {
                fast += 1;
                assert_eq!((value.to_bits(), length), (expected.to_bits(), text.len()), "{text}");
            }
            let got = Scanner::new(text.as_bytes(), 0, 1).float("x");
            assert_eq!(got.ok(), Some(expected).filter(|x| x.is_finite()), "{text}");
        }
        assert!(fast > 150_000, "the fast road is hardly used: {fast}");
    }

    #[test]
    fn a_tie_made_by_the_first_rounding_is_left_to_the_slow_parser() {
        // 1 + 2^-24 is the tie between 1 and its successor.
        let tie = "1.000000059604645";
        assert_eq!(simple_float(tie.as_bytes()), None);
        assert_eq!(Scanner::new(tie.as_bytes(), 0, 1).float("x").unwrap(), tie.parse::<f32>().unwrap());
    }

    #[test]
    fn odd_floats() {
        for bad in ["", ".", "-", "1e", "e5", "1.2.3", "0x10", "1,5", "--1", "nan", "inf", "1e999", "-1e39"] {
            assert!(Scanner::new(bad.as_bytes(), 0, 1).float("x").is_err(), "{bad}");
        }
        for (good, value) in [("+1.", 1.0), (".5", 0.5), ("-0", 0.0), ("1E2", 100.0), ("1e-60", 0.0)] {
            assert_eq!(Scanner::new(good.as_bytes(), 0, 1).float("x").unwrap(), value, "{good}");
        }
    }

    #[test]
    fn integers_saturate_and_hidden_line_ends_continue() {
        let mut s = Scanner::new(b" 12/-3 \\\r\n +4 99999999999999999999 x", 0, 1);
        assert_eq!(s.integer("i").unwrap(), 12);
        assert!(s.slash());
        assert_eq!(s.integer("i").unwrap(), -3);
        assert_eq!(s.integer("i").unwrap(), 4);
        assert_eq!(s.here(), Spot::Line(2, 4));
        assert_eq!(s.integer("i").unwrap(), i64::MAX);
        assert_eq!(s.integer("i").unwrap_err().message, "expected a whole number (i), found `x`");
    }
}
