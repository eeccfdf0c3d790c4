//! What all writers share: a large buffer, numbers as text, checks first.

use super::attributes::{MeshAttributes, WriteOptions};
use super::error::WriteError;
use crate::mesh::PolygonMesh;
use std::io::Write;

/// Collects a few megabytes before it bothers the writer.
pub struct Buffer<'w, W: Write> {
    out: &'w mut W,
    /// Where to put bytes.
    pub bytes: Vec<u8>,
    digits: Option<u8>,
}

const LIMIT: usize = 4 << 20;

impl<'w, W: Write> Buffer<'w, W> {
    pub fn new(out: &'w mut W, options: &WriteOptions) -> Buffer<'w, W> {
        Buffer {
            out,
            bytes: Vec::with_capacity(LIMIT + (64 << 10)),
            digits: options.digits,
        }
    }

    /// Hands the bytes on when there are enough; call it once a record.
    #[inline]
    pub fn record(&mut self) -> Result<(), WriteError> {
        if self.bytes.len() >= LIMIT {
            self.out.write_all(&self.bytes)?;
            self.bytes.clear();
        }
        Ok(())
    }

    /// Hands the last bytes on.
    pub fn finish(self) -> Result<(), WriteError> {
        self.out.write_all(&self.bytes)?;
        self.out.flush()?;
        Ok(())
    }

    pub fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// A number with as few digits as will read back the same (or with the
    /// digits asked for).
    pub fn number(&mut self, value: f64) {
        let value = with_digits(value, self.digits);
        if value == 0.0 || !value.is_finite() {
            // Writing to a Vec cannot fail.
            let _ = write!(self.bytes, "{value}");
            return;
        }
        let plain = (1e-5..1e16).contains(&value.abs());
        lay_out(
            &mut self.bytes,
            zmij::Buffer::new().format_finite(value),
            plain,
        );
    }

    /// A 32-bit number, shortest for 32 bits.
    pub fn number32(&mut self, value: f32) {
        if self.digits.is_some() {
            return self.number(f64::from(value));
        }
        if value == 0.0 || !value.is_finite() {
            let _ = write!(self.bytes, "{value}");
            return;
        }
        let plain = (1e-5..1e16).contains(&value.abs());
        lay_out(
            &mut self.bytes,
            zmij::Buffer::new().format_finite(value),
            plain,
        );
    }

    pub fn integer(&mut self, value: i64) {
        let mut digits = [0u8; 20];
        let mut at = digits.len();
        let mut rest = value.unsigned_abs();
        loop {
            at -= 1;
            digits[at] = b'0' + (rest % 10) as u8;
            rest /= 10;
            if rest == 0 {
                break;
            }
        }
        if value < 0 {
            self.bytes.push(b'-');
        }
        self.bytes.extend_from_slice(&digits[at..]);
    }

    /// Three numbers with blanks between.
    pub fn triple(&mut self, p: [f64; 3]) {
        self.number(p[0]);
        self.bytes.push(b' ');
        self.number(p[1]);
        self.bytes.push(b' ');
        self.number(p[2]);
    }
}

/// Writes a number given as text with or without an exponent as `std` would:
/// plain (`0.001`, `12300`), or with an exponent (`1.23e-7`).
fn lay_out(out: &mut Vec<u8>, text: &str, plain: bool) {
    let text = text.as_bytes();
    let unsigned = text.strip_prefix(b"-").unwrap_or(text);
    out.extend_from_slice(&text[..text.len() - unsigned.len()]);
    let mantissa = unsigned.split(|&b| b == b'e').next().unwrap_or(unsigned);
    let exponent = unsigned[mantissa.len()..].get(1..).unwrap_or_default();
    let (negative, exponent) = match exponent.strip_prefix(b"-") {
        Some(digits) => (true, digits),
        None => (false, exponent.strip_prefix(b"+").unwrap_or(exponent)),
    };
    let size = exponent.iter().fold(0, |n, b| n * 10 + i32::from(b - b'0'));
    // The digits between the zeros, and where the point is among them.
    let mut digits = [0u8; 32];
    let mut count = 0;
    let mut point = if negative { -size } else { size };
    let mut past_point = false;
    for &b in mantissa {
        if b == b'.' {
            past_point = true;
            continue;
        }
        point += i32::from(!past_point);
        if count == 0 && b == b'0' {
            point -= 1;
        } else {
            digits[count] = b;
            count += 1;
        }
    }
    while count > 1 && digits[count - 1] == b'0' {
        count -= 1;
    }
    let digits = &digits[..count];
    if !plain {
        out.push(digits[0]);
        if count > 1 {
            out.push(b'.');
            out.extend_from_slice(&digits[1..]);
        }
        let _ = write!(out, "e{}", point - 1);
    } else if point <= 0 {
        out.extend_from_slice(b"0.");
        out.resize(out.len() + point.unsigned_abs() as usize, b'0');
        out.extend_from_slice(digits);
    } else if point as usize >= count {
        out.extend_from_slice(digits);
        out.resize(out.len() + point as usize - count, b'0');
    } else {
        let (whole, rest) = digits.split_at(point as usize);
        out.extend_from_slice(whole);
        out.push(b'.');
        out.extend_from_slice(rest);
    }
}

/// The nearest number of so many significant digits.
pub fn with_digits(value: f64, digits: Option<u8>) -> f64 {
    match digits.filter(|_| value.is_finite()) {
        None => value,
        Some(digits) => {
            let decimals = usize::from(digits.clamp(1, 17)) - 1;
            format!("{value:.decimals$e}").parse().unwrap_or(value)
        }
    }
}

/// Comments as lines: what a line break would smuggle in stays a comment.
pub fn comment_lines(options: &WriteOptions) -> impl Iterator<Item = &str> {
    options
        .comments
        .iter()
        .flat_map(|c| c.split(['\n', '\r']))
        .filter(|l| !l.is_empty())
}

/// Checks that indices exist and that attributes have the right lengths, so
/// that no writer can fail half-way or write nonsense.
pub fn check_mesh(mesh: &PolygonMesh, attributes: &MeshAttributes) -> Result<(), WriteError> {
    let inconsistent = |what: String| Err(WriteError::Inconsistent { what });
    if mesh.starts.windows(2).any(|w| w[0] > w[1])
        || mesh.starts.first().is_some_and(|&s| s != 0)
        || mesh.starts.last().map_or(0, |&e| e as usize) != mesh.corners.len()
    {
        return inconsistent("mesh: its face starts do not cover its corners in order".into());
    }
    let count = mesh.vertices.len();
    if let Some(at) = mesh.corners.iter().position(|&v| v as usize >= count) {
        let index = mesh.corners[at];
        return inconsistent(format!(
            "mesh: corner {at} names vertex {index} of {count} vertices"
        ));
    }
    let length = |name: &str, found: usize, expected: usize| {
        if found == expected {
            return Ok(());
        }
        Err(WriteError::Length {
            name: name.into(),
            expected,
            found,
        })
    };
    if let Some(normals) = attributes.normals {
        length("normals", normals.len(), count)?;
    }
    if let Some(colours) = attributes.colours {
        length("colours", colours.len(), count)?;
    }
    if let Some(samples) = attributes.samples {
        length("samples", samples.len(), count)?;
    }
    for a in &attributes.vertices {
        length(a.name, a.values.len(), count)?;
    }
    for a in &attributes.faces {
        length(a.name, a.values.len(), mesh.face_count())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl Fn(&mut Buffer<Vec<u8>>)) -> String {
        let mut sink = Vec::new();
        let mut buffer = Buffer::new(&mut sink, &WriteOptions::default());
        write(&mut buffer);
        String::from_utf8(buffer.bytes).unwrap()
    }

    #[test]
    fn numbers_are_as_short_as_those_of_std() {
        let as_std = |v: f64| match v != 0.0 && !(1e-5..1e16).contains(&v.abs()) && v.is_finite() {
            true => format!("{v:e}"),
            false => format!("{v}"),
        };
        let mut state = 3u64;
        let mut bits = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            state ^ state >> 29
        };
        let corners = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            10.0,
            1e15,
            9_999_999_999_999_998.0,
            1e16,
            1e-5,
            9.99e-6,
            1e22,
            1e300,
            5e-324,
            f64::MAX,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            0.1,
            123_000.0,
            1e-4,
            0.000_012_345,
        ];
        let near_one = |b: u64| (b >> 40) as f64 / 1e5;
        let random = (0..20_000).map(|k| {
            let b = bits();
            match k % 3 {
                0 => f64::from_bits(b),
                1 => (b >> 11) as f64 / (1u64 << 53) as f64 - 0.5,
                _ => near_one(b),
            }
        });
        for v in corners.into_iter().chain(random) {
            // Two shortest texts may be equally near: then either will do.
            let text = written(|b| b.number(v));
            let near = |text: &str, std: &str| text.len() == std.len() && text[..3] == std[..3];
            let same = text == as_std(v);
            assert!(
                same || near(&text, &as_std(v)) && text.parse() == Ok(v),
                "{v:e}: {text}"
            );
            let single = v as f32;
            let expected = match f64::from(single) {
                s if s != 0.0 && !(1e-5..1e16).contains(&single.abs()) && s.is_finite() => {
                    format!("{single:e}")
                }
                _ => format!("{single}"),
            };
            let text = written(|b| b.number32(single));
            let same = text == expected;
            assert!(
                same || near(&text, &expected) && text.parse() == Ok(single),
                "{single:e}: {text}"
            );
        }
    }
}
