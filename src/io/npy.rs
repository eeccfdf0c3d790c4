//! NumPy arrays: one table of numbers, (n, 3) or wider.

use super::cloud::{Cloud, Parts, ReadOptions};
use super::columns::{self, Table};
use super::error::{Place, ReadError};
use super::format::CloudFormat;
use super::sink::check_count;

struct Header {
    kind: u8,
    size: usize,
    big: bool,
    fortran: bool,
    shape: Vec<u64>,
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let (header, data) = header(bytes)?;
    let &[rows, columns] = header.shape.as_slice() else {
        return Err(unsupported(format!("an array of shape {:?}", header.shape)));
    };
    if columns < 3 {
        return Err(unsupported(format!("an array of shape {:?}", header.shape)));
    }
    if columns > columns::MOST as u64 {
        return Err(unsupported(format!(
            "an array of {columns} columns (the limit is {})",
            columns::MOST
        )));
    }
    if rows == 0 {
        return Err(ReadError::Nothing {
            what: "points",
            format: "NPY",
        });
    }
    check_count("points", rows)?;
    let record = columns.saturating_mul(header.size as u64);
    let found = data.len() as u64 / record;
    if rows > found {
        return Err(ReadError::Truncated {
            what: "points".into(),
            expected: rows,
            found,
        });
    }
    let (rows, columns) = (rows as usize, columns as usize);
    let mut table = Table::new(columns);
    table.points = vec![[0.0; 3]; rows];
    for column in &mut table.extra {
        column.resize(rows, 0.0);
    }
    let data = &data[..rows * columns * header.size];
    let mut put = |i: usize, value: f64| {
        let (row, column) = if header.fortran {
            (i % rows, i / rows)
        } else {
            (i / columns, i % columns)
        };
        if column < 3 {
            table.points[row][column] = value;
        } else {
            table.extra[column - 3][row] = value;
        }
    };
    each(&header, data, &mut put)?;
    let mut parts = Parts::new(CloudFormat::Npy);
    columns::assign(table, &mut parts);
    parts.finish(options, "points", |i| Place::Record(i as u64))
}

/// Decodes all numbers in their order.
fn each(header: &Header, data: &[u8], put: &mut impl FnMut(usize, f64)) -> Result<(), ReadError> {
    macro_rules! decode {
        ($t:ty) => {
            for (i, item) in data.chunks_exact(size_of::<$t>()).enumerate() {
                if let Some(&bytes) = item.first_chunk() {
                    let value = if header.big {
                        <$t>::from_be_bytes(bytes)
                    } else {
                        <$t>::from_le_bytes(bytes)
                    };
                    put(i, value as f64);
                }
            }
        };
    }
    match (header.kind, header.size) {
        (b'f', 4) => decode!(f32),
        (b'f', 8) => decode!(f64),
        (b'i', 1) => decode!(i8),
        (b'i', 2) => decode!(i16),
        (b'i', 4) => decode!(i32),
        (b'i', 8) => decode!(i64),
        (b'u', 1) => decode!(u8),
        (b'u', 2) => decode!(u16),
        (b'u', 4) => decode!(u32),
        (b'u', 8) => decode!(u64),
        (kind, size) => {
            return Err(unsupported(format!(
                "an array of `{}{size}`",
                char::from(kind)
            )))
        }
    }
    Ok(())
}

fn unsupported(what: String) -> ReadError {
    ReadError::Unsupported {
        what,
        remedy: "save an array of float32, float64 or integers of shape (n, 3) or wider",
    }
}

/// Magic, version, and the three entries of the dictionary.
fn header(bytes: &[u8]) -> Result<(Header, &[u8]), ReadError> {
    let fault = |at: usize, what: &str| ReadError::Malformed {
        place: Place::Byte(at as u64),
        what: what.into(),
    };
    let rest = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or_else(|| fault(0, "not an NPY file"))?;
    let cut = || fault(bytes.len(), "the file ends within the NPY header");
    let (length, start) = match rest.first().ok_or_else(cut)? {
        1 => {
            let length = rest
                .get(2..)
                .and_then(|r| r.first_chunk())
                .ok_or_else(cut)?;
            (usize::from(u16::from_le_bytes(*length)), 4)
        }
        2 | 3 => {
            let length = rest
                .get(2..)
                .and_then(|r| r.first_chunk())
                .ok_or_else(cut)?;
            (u32::from_le_bytes(*length) as usize, 6)
        }
        _ => return Err(fault(6, "an unknown version of NPY")),
    };
    let (text, data) = rest[start..].split_at_checked(length).ok_or_else(cut)?;
    let text = String::from_utf8_lossy(text);
    let entry = |name: &str| {
        let after = text.split_once(&format!("'{name}'"))?.1;
        Some(after.trim_start().strip_prefix(':')?.trim_start())
    };
    let bad = || fault(10, "the NPY header lacks descr, fortran_order or shape");
    let descr = entry("descr").ok_or_else(bad)?;
    let Some(descr) = descr.strip_prefix('\'').and_then(|d| d.split('\'').next()) else {
        return Err(unsupported("a structured NPY array".into()));
    };
    let (order, code) = match descr.as_bytes() {
        [order @ (b'<' | b'>' | b'|' | b'='), code @ ..] => (*order, code),
        code => (b'<', code),
    };
    let number = |b: &[u8]| std::str::from_utf8(b).ok()?.trim().parse::<u64>().ok();
    let (Some(&kind), Some(size)) = (code.first(), code.get(1..).and_then(number)) else {
        return Err(unsupported(format!("an array of `{descr}`")));
    };
    if !matches!(kind, b'f' | b'i' | b'u') || !matches!(size, 1 | 2 | 4 | 8) {
        return Err(unsupported(format!("an array of `{descr}`")));
    }
    let order_entry = entry("fortran_order").ok_or_else(bad)?;
    let shape = entry("shape")
        .and_then(|s| s.strip_prefix('(')?.split_once(')'))
        .ok_or_else(bad)?
        .0;
    let shape = shape
        .split(',')
        .filter(|s| !s.trim().is_empty())
        .map(|s| number(s.as_bytes()).ok_or_else(bad))
        .collect::<Result<Vec<u64>, _>>()?;
    let header = Header {
        kind,
        size: size as usize,
        big: order == b'>',
        fortran: order_entry.starts_with("True"),
        shape,
    };
    Ok((header, data))
}
