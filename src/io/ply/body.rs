//! The body of a PLY file: records of an element, one after the other.

use super::super::error::{Place, ReadError};
use super::super::scan::{self, Lines, Words};
use super::header::{Element, Encoding, Header, Kind, Shape};

/// Receives the records of one element.
pub trait Records {
    /// Whether this property is wanted; asked once.
    fn wants(&self, property: usize) -> bool;
    /// A number of a record.
    fn scalar(&mut self, property: usize, record: usize, value: f64);
    /// A list of a record.
    fn list(&mut self, property: usize, items: &[i64], place: Place) -> Result<(), ReadError>;
    /// The line of a record, in text files, after its numbers.
    fn line(&mut self, record: usize, line: u64);
}

/// Takes nothing: for elements to pass over.
pub struct Skip;

impl Records for Skip {
    fn wants(&self, _: usize) -> bool {
        false
    }
    fn scalar(&mut self, _: usize, _: usize, _: f64) {}
    fn list(&mut self, _: usize, _: &[i64], _: Place) -> Result<(), ReadError> {
        Ok(())
    }
    fn line(&mut self, _: usize, _: u64) {}
}

/// A position in the body.
pub struct Body<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    /// Bytes before `bytes` in the file.
    offset: usize,
    /// Lines before `bytes` in a text file.
    lines: u64,
}

impl<'a> Body<'a> {
    pub fn new(header: &Header<'a>) -> Body<'a> {
        Body {
            encoding: header.encoding,
            bytes: header.body,
            offset: header.body_at,
            lines: header.lines,
        }
    }

    /// What follows the last record, without blanks.
    pub fn left_over(&self) -> usize {
        match self.encoding {
            Encoding::Ascii => self.bytes.trim_ascii().len(),
            _ => self.bytes.len(),
        }
    }

    /// Refuses a count that the bytes cannot hold. Call before reserving.
    pub fn check(&self, element: &Element) -> Result<(), ReadError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let left = self.bytes.len() as u64;
        let (size, found) = match self.encoding {
            Encoding::Ascii => (2 * element.properties.len() as u64, None),
            _ => {
                let size = element.least_size();
                (size, Some(left / size))
            }
        };
        // The last record of a text file may lack its line break.
        if element.count.saturating_mul(size) <= left.saturating_add(1)
            && found.is_none_or(|found| element.count <= found)
        {
            return Ok(());
        }
        if let Some(found) = found {
            return Err(truncated(element, found));
        }
        let lines = Lines::after(self.bytes, self.lines);
        let mut found = 0;
        for (number, line) in lines.filter(|(_, l)| !l.trim_ascii().is_empty()) {
            let words = Words::new(line).count();
            if words < element.properties.len() {
                return Err(too_few(number, words, element));
            }
            found += 1;
        }
        Err(truncated(element, found))
    }

    /// Reads all records of an element.
    pub fn read(&mut self, element: &Element, out: &mut impl Records) -> Result<(), ReadError> {
        self.check(element)?;
        if element.properties.is_empty() {
            return Ok(());
        }
        match self.encoding {
            Encoding::Ascii => self.read_ascii(element, out),
            _ if element.has_lists() => self.read_lists(element, out),
            _ => {
                self.read_columns(element, out);
                Ok(())
            }
        }
    }

    /// Text: one record a line, blank lines passed over.
    fn read_ascii(&mut self, element: &Element, out: &mut impl Records) -> Result<(), ReadError> {
        let wanted: Vec<bool> = (0..element.properties.len())
            .map(|p| out.wants(p))
            .collect();
        let mut lines = Lines::after(self.bytes, self.lines);
        let mut items = Vec::new();
        let mut record = 0u64;
        while record < element.count {
            let Some((number, line)) = lines.next() else {
                return Err(truncated(element, record));
            };
            let mut words = Words::new(line);
            let mut start = words.next();
            if start.is_none() {
                continue;
            }
            let mut next = |done: usize| {
                let word = start.take().or_else(|| words.next());
                word.ok_or_else(|| too_few(number, done, element))
            };
            for (p, property) in element.properties.iter().enumerate() {
                let (at, word) = next(p)?;
                let place = scan::column(number, at);
                match property.shape {
                    Shape::Scalar(_) => {
                        if wanted[p] {
                            let value = scan::number(word)
                                .ok_or_else(|| scan::not_a("a number", place, word))?;
                            out.scalar(p, record as usize, value);
                        }
                    }
                    Shape::List { .. } => {
                        let count = scan::integer(word)
                            .filter(|&n| n >= 0)
                            .ok_or_else(|| scan::not_a("the length of a list", place, word))?;
                        items.clear();
                        for _ in 0..count {
                            let (at, word) = next(p)?;
                            if wanted[p] {
                                let place = scan::column(number, at);
                                items.push(
                                    scan::integer(word)
                                        .ok_or_else(|| scan::not_a("an index", place, word))?,
                                );
                            }
                        }
                        if wanted[p] {
                            out.list(p, &items, Place::Line(number))?;
                        }
                    }
                }
            }
            if let Some((at, _)) = words.next() {
                return Err(ReadError::Malformed {
                    place: scan::column(number, at),
                    what: format!(
                        "more values than the {} properties of element {}",
                        element.properties.len(),
                        element.name
                    ),
                });
            }
            out.line(record as usize, number);
            record += 1;
        }
        self.lines = lines.number();
        self.bytes = lines.rest();
        Ok(())
    }

    /// Binary records of one size: property after property, in blocks that
    /// stay in the cache.
    fn read_columns(&mut self, element: &Element, out: &mut impl Records) {
        let stride = element.least_size() as usize;
        let (data, rest) = self.bytes.split_at(stride * element.count as usize);
        let mut wanted = Vec::new();
        let mut offset = 0;
        for (p, property) in element.properties.iter().enumerate() {
            if let Shape::Scalar(kind) = property.shape {
                if out.wants(p) {
                    wanted.push((p, offset, kind));
                }
                offset += kind.size();
            }
        }
        const BLOCK: usize = 1024;
        let big = self.encoding == Encoding::Big;
        for (b, block) in data.chunks(stride * BLOCK).enumerate() {
            for &(p, offset, kind) in &wanted {
                column(block, stride, offset, kind, big, |i, value| {
                    out.scalar(p, b * BLOCK + i, value);
                });
            }
        }
        self.bytes = rest;
        self.offset += data.len();
    }

    /// Binary records with lists: number after number.
    fn read_lists(&mut self, element: &Element, out: &mut impl Records) -> Result<(), ReadError> {
        let big = self.encoding == Encoding::Big;
        let properties: Vec<(Shape, bool)> = element
            .properties
            .iter()
            .enumerate()
            .map(|(p, property)| (property.shape, out.wants(p)))
            .collect();
        let mut items: Vec<i64> = Vec::new();
        let mut bytes = self.bytes;
        for record in 0..element.count {
            let short = || truncated(element, record);
            for (p, &(shape, wanted)) in properties.iter().enumerate() {
                match shape {
                    Shape::Scalar(kind) => {
                        let (data, rest) = bytes.split_at_checked(kind.size()).ok_or_else(short)?;
                        if wanted {
                            out.scalar(p, record as usize, float(kind, big, data));
                        }
                        bytes = rest;
                    }
                    Shape::List { count, item } => {
                        let (data, rest) =
                            bytes.split_at_checked(count.size()).ok_or_else(short)?;
                        let length = int(count, big, data);
                        let at = self.offset + (self.bytes.len() - bytes.len());
                        if length < 0 {
                            return Err(ReadError::Malformed {
                                place: Place::Byte(at as u64),
                                what: format!(
                                    "a list of length {length} in element {}",
                                    element.name
                                ),
                            });
                        }
                        let size = (length as usize).saturating_mul(item.size());
                        let (data, rest) = rest.split_at_checked(size).ok_or_else(short)?;
                        if wanted {
                            items.clear();
                            let numbers = data.chunks_exact(item.size());
                            items.extend(numbers.map(|d| int(item, big, d)));
                            out.list(p, &items, Place::Byte(at as u64))?;
                        }
                        bytes = rest;
                    }
                }
            }
        }
        self.offset += self.bytes.len() - bytes.len();
        self.bytes = bytes;
        Ok(())
    }
}

#[cold]
fn truncated(element: &Element, found: u64) -> ReadError {
    let what = match element.name.to_ascii_lowercase().as_str() {
        "vertex" => "vertices".into(),
        "face" => "faces".into(),
        other => format!("records of element {other}"),
    };
    ReadError::Truncated {
        what,
        expected: element.count,
        found,
    }
}

#[cold]
fn too_few(line: u64, done: usize, element: &Element) -> ReadError {
    let property = element.properties.get(done);
    let name = property.map_or("", |p| p.name.as_str());
    ReadError::Malformed {
        place: Place::Line(line),
        what: format!(
            "the line ends before property {name} of element {}",
            element.name
        ),
    }
}

/// The bytes of a number in little-endian order; zeros where it is short,
/// which the callers rule out.
#[inline]
fn little<const N: usize>(data: &[u8], big: bool) -> [u8; N] {
    let mut bytes = data.first_chunk::<N>().copied().unwrap_or([0; N]);
    if big {
        bytes.reverse();
    }
    bytes
}

#[inline]
fn float(kind: Kind, big: bool, data: &[u8]) -> f64 {
    match kind {
        Kind::F32 => f64::from(f32::from_le_bytes(little(data, big))),
        Kind::F64 => f64::from_le_bytes(little(data, big)),
        _ => int(kind, big, data) as f64,
    }
}

/// Floats that are no indices become -1.
#[inline]
fn int(kind: Kind, big: bool, data: &[u8]) -> i64 {
    match kind {
        Kind::I8 => i64::from(i8::from_le_bytes(little(data, big))),
        Kind::U8 => i64::from(u8::from_le_bytes(little(data, big))),
        Kind::I16 => i64::from(i16::from_le_bytes(little(data, big))),
        Kind::U16 => i64::from(u16::from_le_bytes(little(data, big))),
        Kind::I32 => i64::from(i32::from_le_bytes(little(data, big))),
        Kind::U32 => i64::from(u32::from_le_bytes(little(data, big))),
        Kind::F32 | Kind::F64 => {
            let value = float(kind, big, data);
            if value.fract() == 0.0 && value.abs() < 9e15 {
                value as i64
            } else {
                -1
            }
        }
    }
}

/// One property of all records of a block.
#[inline]
fn column(
    block: &[u8],
    stride: usize,
    offset: usize,
    kind: Kind,
    big: bool,
    mut put: impl FnMut(usize, f64),
) {
    macro_rules! each {
        ($t:ty) => {
            for (i, row) in block.chunks_exact(stride).enumerate() {
                put(i, <$t>::from_le_bytes(little(&row[offset..], big)) as f64);
            }
        };
    }
    match kind {
        Kind::I8 => each!(i8),
        Kind::U8 => each!(u8),
        Kind::I16 => each!(i16),
        Kind::U16 => each!(u16),
        Kind::I32 => each!(i32),
        Kind::U32 => each!(u32),
        Kind::F32 => each!(f32),
        Kind::F64 => each!(f64),
    }
}
