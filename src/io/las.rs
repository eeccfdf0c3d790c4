//! LAS, the format of airborne and mobile laser scans, versions 1.0 to 1.4:
//! coordinates are integers with a scale and an offset. LAZ, its compressed
//! form, is not read.

use super::cloud::{Cloud, Parts, ReadOptions, ScalarColumn};
use super::error::{Place, ReadError};
use super::format::CloudFormat;
use super::sink::check_count;

/// The least size of a header.
const HEADER: usize = 227;

/// What a kind of point record has, by its number: its least length, and
/// where its colours are.
const RECORDS: [(usize, Option<usize>); 11] = [
    (20, None),
    (28, None),
    (26, Some(20)),
    (34, Some(28)),
    (57, None),
    (63, Some(28)),
    (30, None),
    (36, Some(30)),
    (38, Some(30)),
    (59, None),
    (67, Some(30)),
];

/// Whether a file starts like LAS.
pub fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(b"LASF")
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    if !looks_like(bytes) {
        return Err(fault(0, "not a LAS file: it does not start with LASF"));
    }
    let cut = || fault(bytes.len(), "the file ends within the LAS header");
    let header = bytes.get(..HEADER).ok_or_else(cut)?;
    if header[24] != 1 || header[25] > 4 {
        return Err(fault(24, "an unknown version of LAS"));
    }
    let short = |at: usize| u64::from(u16::from_le_bytes([header[at], header[at + 1]]));
    let long = |at: usize| short(at) | short(at + 2) << 16;
    let real = |at: usize| f64::from_bits(long(at) | long(at + 4) << 32);
    let (kind, length) = (header[104], short(105) as usize);
    if kind & 0xc0 != 0 {
        return Err(ReadError::Unsupported {
            what: "compressed LAS (LAZ)".into(),
            remedy: "decompress it to LAS first",
        });
    }
    let Some(&(least, colours)) = RECORDS.get(usize::from(kind)) else {
        return Err(fault(104, "an unknown kind of LAS point record"));
    };
    if length < least {
        return Err(fault(
            105,
            "LAS point records shorter than their kind needs",
        ));
    }
    let mut count = long(107);
    if header[25] == 4 && count == 0 {
        let wide = bytes.get(247..).and_then(|b| b.first_chunk());
        count = u64::from_le_bytes(*wide.ok_or_else(cut)?);
    }
    if count == 0 {
        return Err(ReadError::Nothing {
            what: "points",
            format: "LAS",
        });
    }
    check_count("points", count)?;
    let start = long(96);
    let data = usize::try_from(start).ok().and_then(|s| bytes.get(s..));
    let data = data.ok_or_else(|| fault(96, "the points start after the end of the file"))?;
    let found = (data.len() / length) as u64;
    if count > found {
        return Err(ReadError::Truncated {
            what: "points".into(),
            expected: count,
            found,
        });
    }
    let (scale, offset) = ([131, 139, 147].map(real), [155, 163, 171].map(real));
    if scale.iter().any(|s| !s.is_finite() || *s == 0.0) || offset.iter().any(|o| !o.is_finite()) {
        return Err(fault(
            131,
            "a scale of zero, or a scale or offset that is not finite",
        ));
    }

    let records = || data.chunks_exact(length).take(count as usize);
    let integer = |r: &[u8], at: usize| {
        let bytes = r.get(at..).and_then(|b| b.first_chunk());
        f64::from(bytes.map_or(0, |b| i32::from_le_bytes(*b)))
    };
    let word = |r: &[u8], at: usize| u16::from_le_bytes([r[at], r[at + 1]]);
    let mut parts = Parts::new(CloudFormat::Las);
    parts.points = records()
        .map(|r| [0, 1, 2].map(|k| integer(r, 4 * k) * scale[k] + offset[k]))
        .collect();
    if let Some(at) = colours {
        // Sixteen bits each, though many programs write eight.
        let channels = || records().map(|r| [0, 2, 4].map(|k| word(r, at + k)));
        let wide = channels().flatten().any(|c| c > 255);
        let byte = |c: u16| if wide { (c >> 8) as u8 } else { c as u8 };
        if channels().flatten().any(|c| c > 0) {
            let of = |c: [u16; 3]| [byte(c[0]), byte(c[1]), byte(c[2]), 255];
            parts.colours = Some(channels().map(of).collect());
        }
    }
    // The class shares its byte with flags in the older kinds.
    let class = |r: &[u8]| match kind {
        0..=5 => r[15] & 31,
        _ => r[16],
    };
    let mut column = |name: &str, values: Vec<f64>| {
        if values.iter().any(|&v| v != 0.0) {
            let name = name.into();
            parts.scalars.push(ScalarColumn { name, values });
        }
    };
    column(
        "intensity",
        records().map(|r| f64::from(word(r, 12))).collect(),
    );
    column(
        "classification",
        records().map(|r| f64::from(class(r))).collect(),
    );
    let announced = long(100);
    if announced.saturating_mul(54) > start.saturating_sub(short(94)) {
        parts.report.notes.push(format!(
            "The LAS header announces {announced} further records, for which there is no room before the points."
        ));
    }
    parts.finish(options, "points", |i| Place::Record(i as u64))
}

fn fault(at: usize, what: &str) -> ReadError {
    ReadError::Malformed {
        place: Place::Byte(at as u64),
        what: what.into(),
    }
}
