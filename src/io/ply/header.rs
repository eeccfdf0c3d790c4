//! The header of a PLY file: what elements with what properties follow.

use super::super::error::{Place, ReadError};
use super::super::scan::{self, Words};

/// How the body is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    Little,
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn of(name: &[u8]) -> Option<Kind> {
        Some(match name.to_ascii_lowercase().as_slice() {
            b"char" | b"int8" => Kind::I8,
            b"uchar" | b"uint8" => Kind::U8,
            b"short" | b"int16" => Kind::I16,
            b"ushort" | b"uint16" => Kind::U16,
            b"int" | b"int32" => Kind::I32,
            b"uint" | b"uint32" => Kind::U32,
            b"float" | b"float32" => Kind::F32,
            b"double" | b"float64" => Kind::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }

    pub fn is_float(self) -> bool {
        matches!(self, Kind::F32 | Kind::F64)
    }
}

/// One number or a counted list of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Scalar(Kind),
    List { count: Kind, item: Kind },
}

#[derive(Clone, Debug)]
pub struct Property {
    pub name: String,
    pub shape: Shape,
}

#[derive(Clone, Debug)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    pub fn is(&self, name: &str) -> bool {
        self.name.eq_ignore_ascii_case(name)
    }

    /// The place among the properties of one of these names.
    pub fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| names.iter().any(|n| p.name.eq_ignore_ascii_case(n)))
    }

    /// The fewest bytes a binary record can take.
    pub fn least_size(&self) -> u64 {
        let size = |p: &Property| match p.shape {
            Shape::Scalar(kind) => kind.size(),
            Shape::List { count, .. } => count.size(),
        };
        self.properties.iter().map(|p| size(p) as u64).sum()
    }

    pub fn has_lists(&self) -> bool {
        self.properties
            .iter()
            .any(|p| matches!(p.shape, Shape::List { .. }))
    }
}

pub struct Header<'a> {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Comments and `obj_info` lines.
    pub comments: usize,
    /// Lines up to and with `end_header`.
    pub lines: u64,
    /// All after the header, and where that begins.
    pub body: &'a [u8],
    pub body_at: usize,
}

impl Header<'_> {
    pub fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|e| e.is(name))
    }
}

/// Reads the header. Lines may end in LF, CR LF or CR, blanks at either end
/// of a line do not matter.
pub fn parse(bytes: &[u8]) -> Result<Header<'_>, ReadError> {
    let fault = |line: u64, what: String| ReadError::Malformed {
        place: Place::Line(line),
        what,
    };
    let start = bytes.len() - scan::without_bom(bytes).len();
    let text = &bytes[start..];
    // The first line break tells which kind the header uses.
    let end = match text.iter().position(|b| matches!(b, b'\n' | b'\r')) {
        Some(i) if text[i] == b'\r' && text.get(i + 1) != Some(&b'\n') => b'\r',
        _ => b'\n',
    };
    let mut header = Header {
        encoding: Encoding::Ascii,
        elements: Vec::new(),
        comments: 0,
        lines: 0,
        body: &[],
        body_at: 0,
    };
    let mut format = None;
    let mut at = start;
    loop {
        let line = header.lines + 1;
        let rest = &bytes[at..];
        if rest.is_empty() {
            return Err(fault(line, "the header has no end_header line".into()));
        }
        let length = rest.iter().position(|&b| b == end);
        let full = &rest[..length.unwrap_or(rest.len())];
        at += length.map_or(rest.len(), |l| l + 1);
        header.lines = line;
        let words: Vec<&[u8]> = Words::new(full).map(|(_, w)| w).take(8).collect();
        if line == 1 {
            if words.len() != 1 || !words[0].eq_ignore_ascii_case(b"ply") {
                return Err(fault(
                    1,
                    "not a PLY file: the first line is not `ply`".into(),
                ));
            }
            continue;
        }
        let Some(&keyword) = words.first() else {
            continue;
        };
        match keyword.to_ascii_lowercase().as_slice() {
            b"comment" | b"obj_info" => header.comments += 1,
            b"format" => {
                format = Some(encoding(&words).ok_or_else(|| {
                    fault(
                        line,
                        format!(
                            "expected `format ascii 1.0` or `format binary_little_endian 1.0` or `format binary_big_endian 1.0`, found `{}`",
                            scan::shown(full)
                        ),
                    )
                })?);
            }
            b"element" => {
                let count = match words[..] {
                    [_, _, count] => scan::integer(count).filter(|&n| n >= 0),
                    _ => None,
                };
                let Some(count) = count else {
                    return Err(fault(
                        line,
                        format!(
                            "expected `element NAME COUNT`, found `{}`",
                            scan::shown(full)
                        ),
                    ));
                };
                header.elements.push(Element {
                    name: scan::shown(words[1]),
                    count: count as u64,
                    properties: Vec::new(),
                });
            }
            b"property" => {
                let property = property(&words).ok_or_else(|| {
                    fault(
                        line,
                        format!(
                            "expected `property TYPE NAME` or `property list TYPE TYPE NAME`, found `{}`",
                            scan::shown(full)
                        ),
                    )
                })?;
                let Some(element) = header.elements.last_mut() else {
                    return Err(fault(line, "a property before any element".into()));
                };
                element.properties.push(property);
            }
            b"end_header" => break,
            _ => {
                return Err(fault(
                    line,
                    format!("unknown header keyword `{}`", scan::shown(keyword)),
                ));
            }
        }
    }
    header.encoding = format.ok_or_else(|| ReadError::Missing {
        what: "`format` line in the PLY header".into(),
    })?;
    header.body = &bytes[at..];
    header.body_at = at;
    Ok(header)
}

fn encoding(words: &[&[u8]]) -> Option<Encoding> {
    let [_, name, version] = words else {
        return None;
    };
    if *version != b"1.0" {
        return None;
    }
    match name.to_ascii_lowercase().as_slice() {
        b"ascii" => Some(Encoding::Ascii),
        b"binary_little_endian" => Some(Encoding::Little),
        b"binary_big_endian" => Some(Encoding::Big),
        _ => None,
    }
}

fn property(words: &[&[u8]]) -> Option<Property> {
    let (shape, name) = match words {
        [_, list, count, item, name] if list.eq_ignore_ascii_case(b"list") => {
            let count = Kind::of(count).filter(|k| !k.is_float())?;
            let item = Kind::of(item)?;
            (Shape::List { count, item }, name)
        }
        [_, kind, name] => (Shape::Scalar(Kind::of(kind)?), name),
        _ => return None,
    };
    Some(Property {
        name: scan::shown(name),
        shape,
    })
}
