//! The header of a PCD file: which fields a point has and how they are coded.

use super::super::columns;
use super::super::error::{Place, ReadError};
use super::super::scan::{self, Lines, Words};
use crate::geom::Point;

/// How the points are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    Binary,
    Compressed,
}

/// One field of a point.
#[derive(Clone, Debug)]
pub struct Field {
    /// In lower case.
    pub name: String,
    /// Bytes of one value.
    pub size: usize,
    /// `F`, `I` or `U`.
    pub kind: u8,
    /// Values.
    pub count: usize,
}

impl Field {
    /// Bytes of all values.
    pub fn bytes(&self) -> usize {
        self.size * self.count
    }

    /// The value in these bytes.
    pub fn number(&self, bytes: &[u8]) -> f64 {
        macro_rules! decode {
            ($t:ty) => {
                bytes
                    .first_chunk()
                    .map_or(f64::NAN, |b| <$t>::from_le_bytes(*b) as f64)
            };
        }
        match (self.kind, self.size) {
            (b'F', 4) => decode!(f32),
            (b'F', _) => decode!(f64),
            (b'I', 1) => decode!(i8),
            (b'I', 2) => decode!(i16),
            (b'I', 4) => decode!(i32),
            (b'I', _) => decode!(i64),
            (_, 1) => decode!(u8),
            (_, 2) => decode!(u16),
            (_, 4) => decode!(u32),
            _ => decode!(u64),
        }
    }

    /// The bits of a colour written as a number.
    pub fn bits(&self, value: f64) -> u32 {
        match self.kind {
            b'F' => (value as f32).to_bits(),
            _ => value as i64 as u32,
        }
    }
}

/// What the header says.
#[derive(Clone, Debug)]
pub struct Header {
    pub fields: Vec<Field>,
    /// Points announced.
    pub points: u64,
    pub encoding: Encoding,
    /// Bytes of a point.
    pub record: usize,
    /// Where the scanner stood, if that is said: at the origin, which every program
    /// writes that knows nothing of it, says nothing.
    pub viewpoint: Option<Point>,
}

/// Whether a file starts like PCD.
pub fn looks_like(head: &[u8]) -> bool {
    let mut words = Lines::new(head)
        .map(|(_, l)| scan::first_word(l))
        .filter(|w| !w.is_empty() && w[0] != b'#');
    matches!(words.next(), Some(b"VERSION" | b"FIELDS"))
}

impl Header {
    /// The header, and the lines after it.
    pub fn read(bytes: &[u8]) -> Result<(Header, Lines<'_>), ReadError> {
        let mut lines = Lines::new(bytes);
        let mut entries: Vec<Entry> = Vec::new();
        loop {
            let Some((number, line)) = lines.next() else {
                return Err(ReadError::Missing {
                    what: "DATA line in the header of this PCD file".into(),
                });
            };
            let mut words = Words::new(line).map(|(_, w)| w);
            let Some(key) = words.next().filter(|w| w[0] != b'#') else {
                continue;
            };
            const KEYS: [&[u8]; 10] = [
                b"VERSION",
                b"FIELDS",
                b"SIZE",
                b"TYPE",
                b"COUNT",
                b"WIDTH",
                b"HEIGHT",
                b"VIEWPOINT",
                b"POINTS",
                b"DATA",
            ];
            if !KEYS.contains(&key) {
                return Err(fault(
                    number,
                    format!(
                        "`{}` is no entry of a PCD header (VERSION, FIELDS, SIZE, TYPE, ...)",
                        scan::shown(key)
                    ),
                ));
            }
            entries.push(Entry {
                key,
                line: number,
                words: words.collect(),
            });
            if key == b"DATA" {
                break;
            }
        }
        let entry = |key: &[u8]| entries.iter().find(|e| e.key == key);
        if let Some(Entry { line, words, .. }) = entry(b"VERSION") {
            let version = words.first().and_then(|w| scan::number(w));
            if !version.is_some_and(|v| (0.5..0.8).contains(&v)) {
                return Err(fault(*line, "this version of PCD is not known".into()));
            }
        }
        let Entry { words, .. } = entry(b"DATA").ok_or_else(|| missing("DATA"))?;
        let encoding = match words.first() {
            Some(&b"ascii") => Encoding::Ascii,
            Some(&b"binary") => Encoding::Binary,
            Some(&b"binary_compressed") => Encoding::Compressed,
            _ => {
                return Err(fault(
                    lines.number(),
                    "expected DATA ascii, binary or binary_compressed".into(),
                ))
            }
        };
        let fields = fields(&entry)?;
        let record = fields.iter().map(Field::bytes).sum::<usize>();
        Ok((
            Header {
                record: record.max(1),
                points: points(&entry)?,
                viewpoint: entry(b"VIEWPOINT").and_then(viewpoint),
                fields,
                encoding,
            },
            lines,
        ))
    }
}

fn fault(line: u64, what: String) -> ReadError {
    ReadError::Malformed {
        place: Place::Line(line),
        what,
    }
}

fn missing(key: &str) -> ReadError {
    ReadError::Missing {
        what: format!("{key} line in the header of this PCD file"),
    }
}

/// The place in a VIEWPOINT line: three numbers, before the four of a rotation.
fn viewpoint(entry: &Entry) -> Option<Point> {
    let mut place = [0.0; 3];
    for (k, slot) in place.iter_mut().enumerate() {
        *slot = scan::number(entry.words.get(k)?)?;
    }
    let said = place.iter().all(|c| c.is_finite()) && place != [0.0; 3];
    said.then_some(place)
}

/// A line of the header.
struct Entry<'a> {
    key: &'a [u8],
    line: u64,
    words: Vec<&'a [u8]>,
}

fn fields<'e, 'a: 'e>(
    entry: &dyn Fn(&[u8]) -> Option<&'e Entry<'a>>,
) -> Result<Vec<Field>, ReadError> {
    let Entry {
        line, words: names, ..
    } = entry(b"FIELDS").ok_or_else(|| missing("FIELDS"))?;
    if names.len() > columns::MOST {
        return Err(fault(
            *line,
            format!("{} fields (the limit is {})", names.len(), columns::MOST),
        ));
    }
    // One word a field; a missing COUNT means one value each.
    let words = |key: &str, default: Option<&'static [u8]>| {
        let Some(Entry { line, words, .. }) = entry(key.as_bytes()) else {
            return match default {
                Some(word) => Ok((0, vec![word; names.len()])),
                None => Err(missing(key)),
            };
        };
        match words.len() == names.len() {
            true => Ok((*line, words.clone())),
            false => Err(fault(
                *line,
                format!("{} values for {} fields", words.len(), names.len()),
            )),
        }
    };
    let (size_line, sizes) = words("SIZE", None)?;
    let (kind_line, kinds) = words("TYPE", None)?;
    let (count_line, counts) = words("COUNT", Some(b"1"))?;
    let integer = |line: u64, word: &[u8], most: i64| {
        let value = scan::integer(word).filter(|v| (1..=most).contains(v));
        value
            .map(|v| v as usize)
            .ok_or_else(|| scan::not_a("a number of bytes or values", Place::Line(line), word))
    };
    let mut fields = Vec::with_capacity(names.len());
    for (f, name) in names.iter().enumerate() {
        let field = Field {
            name: String::from_utf8_lossy(name).to_lowercase(),
            size: integer(size_line, sizes[f], 8)?,
            kind: kinds[f].first().map_or(0, u8::to_ascii_uppercase),
            count: integer(count_line, counts[f], 1 << 20)?,
        };
        let known = match field.kind {
            b'F' => matches!(field.size, 4 | 8),
            b'I' | b'U' => matches!(field.size, 1 | 2 | 4 | 8),
            _ => false,
        };
        if !known {
            return Err(fault(
                kind_line,
                format!(
                    "field {} is of type {} and {} bytes: F has 4 or 8, I and U 1, 2, 4 or 8",
                    field.name,
                    scan::shown(kinds[f]),
                    field.size
                ),
            ));
        }
        fields.push(field);
    }
    Ok(fields)
}

/// POINTS, or WIDTH times HEIGHT; where both are given they must agree.
fn points<'e, 'a: 'e>(entry: &dyn Fn(&[u8]) -> Option<&'e Entry<'a>>) -> Result<u64, ReadError> {
    let one = |key: &str| -> Result<Option<u64>, ReadError> {
        let Some(Entry { line, words, .. }) = entry(key.as_bytes()) else {
            return Ok(None);
        };
        let word = words.first().copied().unwrap_or_default();
        let value = scan::integer(word).and_then(|v| u64::try_from(v).ok());
        value
            .map(Some)
            .ok_or_else(|| scan::not_a("a count", Place::Line(*line), word))
    };
    let size = match (one("WIDTH")?, one("HEIGHT")?) {
        (Some(w), h) => Some(w.saturating_mul(h.unwrap_or(1))),
        _ => None,
    };
    match (one("POINTS")?, size) {
        (Some(points), Some(size)) if points != size => Err(ReadError::Malformed {
            place: Place::Line(entry(b"POINTS").map_or(0, |e| e.line)),
            what: format!("{points} points, but WIDTH times HEIGHT is {size}"),
        }),
        (Some(points), _) | (None, Some(points)) => Ok(points),
        (None, None) => Err(missing("POINTS")),
    }
}
