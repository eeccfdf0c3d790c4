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
        let size = value.abs();
        // Writing to a Vec cannot fail.
        let _ = if size != 0.0 && !(1e-5..1e16).contains(&size) && size.is_finite() {
            write!(self.bytes, "{value:e}")
        } else {
            write!(self.bytes, "{value}")
        };
    }

    /// A 32-bit number, shortest for 32 bits.
    pub fn number32(&mut self, value: f32) {
        if self.digits.is_some() {
            return self.number(f64::from(value));
        }
        let size = value.abs();
        let _ = if size != 0.0 && !(1e-5..1e16).contains(&size) && size.is_finite() {
            write!(self.bytes, "{value:e}")
        } else {
            write!(self.bytes, "{value}")
        };
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
