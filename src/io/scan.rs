//! Text as bytes: lines, words, numbers, and places in them.

use super::error::{Place, ReadError};

/// The bytes after a UTF-8 byte order mark, if there is one.
pub fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The first word; empty when there is none.
pub fn first_word(bytes: &[u8]) -> &[u8] {
    Words::new(bytes).next().map_or(&[], |(_, word)| word)
}

/// Lines with their numbers from 1. Ends with LF or CR LF; in a file without
/// any LF a CR ends a line.
#[derive(Clone)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: u64,
    end: u8,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Lines<'a> {
        let end = if memchr::memchr(b'\n', bytes).is_some() {
            b'\n'
        } else {
            b'\r'
        };
        Lines {
            rest: bytes,
            number: 0,
            end,
        }
    }

    /// Lines of the rest of a file of which `passed` lines are read.
    pub fn after(bytes: &'a [u8], passed: u64) -> Lines<'a> {
        Lines {
            number: passed,
            ..Lines::new(bytes)
        }
    }

    /// What is not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The number of the line read last.
    pub fn number(&self) -> u64 {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u64, &'a [u8]);

    #[inline]
    fn next(&mut self) -> Option<(u64, &'a [u8])> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr::memchr(self.end, self.rest);
        let (line, rest) = match end {
            Some(i) => (&self.rest[..i], &self.rest[i + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// The words of a line, split at blanks, each with its offset in the line.
#[derive(Clone)]
pub struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    pub fn new(line: &'a [u8]) -> Words<'a> {
        Words { line, at: 0 }
    }
}

#[inline]
fn blank(b: u8) -> bool {
    b == b' ' || b.wrapping_sub(b'\t') < 5
}

impl<'a> Iterator for Words<'a> {
    type Item = (usize, &'a [u8]);

    #[inline]
    fn next(&mut self) -> Option<(usize, &'a [u8])> {
        let bytes = self.line;
        let mut start = self.at;
        while start < bytes.len() && blank(bytes[start]) {
            start += 1;
        }
        let mut end = start;
        while end < bytes.len() && !blank(bytes[end]) {
            end += 1;
        }
        self.at = end;
        (start < end).then(|| (start, &bytes[start..end]))
    }
}

/// The words of a whole file, line breaks being blanks like others and `#`
/// starting a comment up to the end of its line.
pub struct Stream<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
    line: u64,
    comments: bool,
}

impl<'a> Stream<'a> {
    pub fn new(bytes: &'a [u8], comments: bool) -> Stream<'a> {
        Stream {
            lines: Lines::new(bytes),
            words: Words::new(&[]),
            line: 1,
            comments,
        }
    }

    /// The next word and its place; `None` at the end of the file.
    #[inline]
    pub fn next(&mut self) -> Option<(Place, &'a [u8])> {
        loop {
            if let Some(found) = self.next_in_line() {
                return Some(found);
            }
            let (line, text) = self.lines.next()?;
            self.line = line;
            self.words = Words::new(text);
        }
    }

    /// The next word of the current line.
    #[inline]
    pub fn next_in_line(&mut self) -> Option<(Place, &'a [u8])> {
        let (at, word) = self.words.next()?;
        if self.comments && word[0] == b'#' {
            self.skip_line();
            return None;
        }
        Some((column(self.line, at), word))
    }

    /// Passes over the rest of the current line.
    pub fn skip_line(&mut self) {
        self.words = Words::new(&[]);
    }

    /// The current line, counting from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Bytes after the current line.
    pub fn bytes_left(&self) -> usize {
        self.lines.rest().len()
    }
}

/// The place of a word by its offset in a line.
pub fn column(line: u64, offset: usize) -> Place {
    Place::Column {
        line,
        column: offset as u64 + 1,
    }
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// A decimal number, NaN or infinity; `None` for anything else. Correctly
/// rounded: short decimals are one exact division, all else goes to `std`.
#[inline]
pub fn number(word: &[u8]) -> Option<f64> {
    let digits = match word.first() {
        Some(b'-' | b'+') => &word[1..],
        _ => word,
    };
    let mut mantissa = 0u64;
    let mut point = None;
    if digits.len() <= 16 {
        for (i, &b) in digits.iter().enumerate() {
            let digit = b.wrapping_sub(b'0');
            if digit < 10 {
                mantissa = mantissa * 10 + u64::from(digit);
            } else if b == b'.' && point.is_none() {
                point = Some(i);
            } else {
                return slow_number(word);
            }
        }
        let count = digits.len() - usize::from(point.is_some());
        if count > 0 && mantissa < 1 << 53 {
            let decimals = point.map_or(0, |p| digits.len() - 1 - p);
            let value = mantissa as f64 / POWERS[decimals];
            return Some(if word[0] == b'-' { -value } else { value });
        }
    }
    slow_number(word)
}

fn slow_number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    // What C libraries print for numbers that are none.
    let bare = text.trim_start_matches(['-', '+']).to_ascii_lowercase();
    let nan = bare.starts_with("nan(") || bare.starts_with("1.#qnan") || bare.starts_with("1.#ind");
    if nan || bare.starts_with("1.#snan") {
        return Some(f64::NAN);
    }
    let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
    bare.starts_with("1.#inf").then_some(sign * f64::INFINITY)
}

/// An integer, also one written like `3.0`.
#[inline]
pub fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word.first()? {
        b'-' => (true, &word[1..]),
        b'+' => (false, &word[1..]),
        _ => (false, word),
    };
    if !digits.is_empty() && digits.len() <= 18 && digits.iter().all(u8::is_ascii_digit) {
        let value = digits
            .iter()
            .fold(0i64, |n, &b| n * 10 + i64::from(b - b'0'));
        return Some(if negative { -value } else { value });
    }
    let value = number(word)?;
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

/// A word for an error message, cut to 40 characters.
pub fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(200)]);
    let mut cut: String = text
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if text.chars().count() > 40 {
        cut.push('…');
    }
    cut
}

/// The error for a word that is not what it should be.
#[cold]
pub fn not_a(expected: &'static str, place: Place, word: &[u8]) -> ReadError {
    if decimal_comma(word) {
        return ReadError::DecimalComma {
            place,
            token: shown(word),
        };
    }
    ReadError::NotANumber {
        place,
        expected,
        token: shown(word),
    }
}

/// Whether a word reads like `12,5`: one comma between digits.
pub fn decimal_comma(word: &[u8]) -> bool {
    let mut parts = word.split(|&b| b == b',');
    let (Some(whole), Some(decimals), None) = (parts.next(), parts.next(), parts.next()) else {
        return false;
    };
    let whole = whole.strip_prefix(b"-").unwrap_or(whole);
    let numeric = |b: &u8| b.is_ascii_digit() || matches!(b, b'e' | b'E' | b'-' | b'+');
    !whole.is_empty()
        && whole.iter().all(u8::is_ascii_digit)
        && decimals.first().is_some_and(u8::is_ascii_digit)
        && decimals.iter().all(numeric)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_agree_with_std() {
        let words = [
            "0",
            "-0",
            "1",
            "+1",
            "2.",
            ".5",
            "-.5",
            "3.25",
            "1e5",
            "1e300",
            "1e-300",
            "5e-324",
            "0.1",
            "123456789012345",
            "9007199254740993",
            "0.30000000000000004",
            "1e22",
            "-1e-7",
            "1234567.891011",
            "00012.500",
            "179769313486231570000000000000000000000",
        ];
        for word in words {
            let expected: f64 = word.parse().unwrap();
            let got = number(word.as_bytes()).unwrap();
            assert_eq!(got.to_bits(), expected.to_bits(), "{word}");
        }
        let mut state = 1u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            let word = format!("{:.*}", (state >> 60) as usize, (state >> 20) as f64 * 1e-7);
            let expected: f64 = word.parse().unwrap();
            assert_eq!(number(word.as_bytes()), Some(expected), "{word}");
        }
    }

    #[test]
    fn words_that_are_no_numbers() {
        for word in [
            "", ".", "-", "+", "e5", "1.2.3", "3.1+e2", "0x10", "1,5", "--1", "1e", "abc",
        ] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
        for word in [
            "nan",
            "-nan(ind)",
            "1.#QNAN",
            "-1.#IND",
            "inf",
            "-Infinity",
            "1.#INF",
            "1e999",
        ] {
            let value = number(word.as_bytes()).unwrap();
            assert!(!value.is_finite(), "{word}");
        }
        assert_eq!(integer(b"3.0"), Some(3));
        assert_eq!(integer(b"3.5"), None);
        assert_eq!(integer(b"-12"), Some(-12));
    }

    #[test]
    fn line_ends() {
        let all = |b: &'static [u8]| Lines::new(b).map(|(_, l)| l).collect::<Vec<_>>();
        assert_eq!(all(b"a\nb\r\n\nc"), [&b"a"[..], b"b", b"", b"c"]);
        assert_eq!(all(b"a\rb\r"), [&b"a"[..], b"b"]);
        assert!(decimal_comma(b"1,5") && decimal_comma(b"-12,5e3"));
        assert!(!decimal_comma(b"1,2,3") && !decimal_comma(b"1,") && !decimal_comma(b"a,b"));
    }
}
