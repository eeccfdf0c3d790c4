//! PCD, the format of the Point Cloud Library: text, binary, and binary
//! compressed by LZF.

mod header;
mod lzf;

use super::cloud::{colours_of, Cloud, Parts, ReadOptions, ScalarColumn};
use super::error::{Place, ReadError};
use super::format::CloudFormat;
use super::scan::{self, Lines, Words};
use super::sink::check_count;
use header::{Encoding, Field, Header};

pub use header::looks_like;

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let (header, lines) = Header::read(bytes)?;
    check_count("points", header.points)?;
    if header.points == 0 {
        return Err(ReadError::Nothing {
            what: "points",
            format: "PCD",
        });
    }
    let mut columns = Columns::new(&header)?;
    let place: Box<dyn Fn(usize) -> Place> = match header.encoding {
        Encoding::Ascii => {
            let at = text(&header, lines, &mut columns)?;
            Box::new(move |i| {
                at.get(i)
                    .map_or(Place::Record(i as u64), |&l| Place::Line(l))
            })
        }
        Encoding::Binary => {
            columns.enough(&header, lines.rest().len())?;
            columns.rows(&header, lines.rest());
            Box::new(|i| Place::Record(i as u64))
        }
        Encoding::Compressed => {
            let start = bytes.len() - lines.rest().len();
            let data = unpacked(&header, lines.rest(), start)?;
            columns.enough(&header, data.len())?;
            columns.runs(&header, &data);
            Box::new(|i| Place::Record(i as u64))
        }
    };
    columns.finish().finish(options, "points", place)
}

/// What follows the sizes, decompressed.
fn unpacked(header: &Header, rest: &[u8], start: usize) -> Result<Vec<u8>, ReadError> {
    let size = |at: usize| {
        rest.get(at..)?
            .first_chunk()
            .map(|b| u32::from_le_bytes(*b))
    };
    let fault = |what: String| ReadError::Malformed {
        place: Place::Byte(start as u64),
        what,
    };
    let (Some(packed), Some(size)) = (size(0), size(4)) else {
        return Err(fault("the sizes of the compressed data are missing".into()));
    };
    let body = &rest[8..];
    let Some(body) = body.get(..packed as usize) else {
        return Err(ReadError::Truncated {
            what: "compressed bytes".into(),
            expected: u64::from(packed),
            found: body.len() as u64,
        });
    };
    let needed = header.points.saturating_mul(header.record as u64);
    if u64::from(size) != needed {
        return Err(fault(format!(
            "{size} bytes of points announced where the header needs {needed}"
        )));
    }
    lzf::decompress(body, size as usize).map_err(|at| ReadError::Malformed {
        place: Place::Byte((start + 8 + at) as u64),
        what: "the compressed data is damaged".into(),
    })
}

/// Where the values of a field go.
#[derive(Clone, Copy)]
enum Target {
    Nothing,
    Position(usize),
    Normal(usize),
    /// Red, green, blue in the bits of one number.
    Packed,
    Scalar(usize),
}

/// The columns as they fill.
struct Columns {
    targets: Vec<Target>,
    parts: Parts,
    count: usize,
}

impl Columns {
    fn new(header: &Header) -> Result<Columns, ReadError> {
        let single = |names: &[&str]| {
            let known = |f: &Field| f.count == 1 && names.iter().any(|n| f.name == *n);
            header.fields.iter().position(known)
        };
        let mut targets = vec![Target::Nothing; header.fields.len()];
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let at = single(&[name]).ok_or_else(|| ReadError::Missing {
                what: format!("field {name} in this PCD file"),
            })?;
            targets[at] = Target::Position(k);
        }
        let normals = [
            single(&["normal_x", "nx"]),
            single(&["normal_y", "ny"]),
            single(&["normal_z", "nz"]),
        ];
        let mut parts = Parts::new(CloudFormat::Pcd);
        parts.viewpoint = header.viewpoint;
        if let [Some(x), Some(y), Some(z)] = normals {
            for (k, at) in [x, y, z].into_iter().enumerate() {
                targets[at] = Target::Normal(k);
            }
            parts.normals = Some(Vec::new());
        }
        let colour = single(&["rgb", "rgba"]).filter(|&at| header.fields[at].size == 4);
        if let Some(at) = colour {
            targets[at] = Target::Packed;
            parts.colours = Some(Vec::new());
        }
        let mut left_out = Vec::new();
        for (target, field) in targets.iter_mut().zip(&header.fields) {
            if !matches!(target, Target::Nothing) || field.name == "_" {
                continue;
            }
            if field.count != 1 {
                left_out.push(field.name.as_str());
                continue;
            }
            *target = Target::Scalar(parts.scalars.len());
            parts.scalars.push(ScalarColumn {
                name: field.name.clone(),
                values: Vec::new(),
            });
        }
        if !left_out.is_empty() {
            parts.report.notes.push(format!(
                "Fields of more than one value are left out: {}.",
                left_out.join(", ")
            ));
        }
        Ok(Columns {
            targets,
            parts,
            count: header.points as usize,
        })
    }

    /// Refuses data that is too short and makes room for what is there.
    fn enough(&mut self, header: &Header, bytes: usize) -> Result<(), ReadError> {
        let found = (bytes / header.record) as u64;
        if found < header.points {
            return Err(ReadError::Truncated {
                what: "points".into(),
                expected: header.points,
                found,
            });
        }
        self.parts.points = vec![[0.0; 3]; self.count];
        let count = self.count;
        if let Some(normals) = &mut self.parts.normals {
            normals.resize(count, [0.0; 3]);
        }
        if let Some(colours) = &mut self.parts.colours {
            colours.resize(count, [0, 0, 0, 255]);
        }
        for column in &mut self.parts.scalars {
            column.values.resize(count, 0.0);
        }
        Ok(())
    }

    /// Points one after the other.
    fn rows(&mut self, header: &Header, data: &[u8]) {
        for (row, record) in data
            .chunks_exact(header.record)
            .take(self.count)
            .enumerate()
        {
            let mut at = 0;
            for (f, field) in header.fields.iter().enumerate() {
                self.put(f, field, row, &record[at..at + field.size]);
                at += field.bytes();
            }
        }
    }

    /// Fields one after the other, each for all points.
    fn runs(&mut self, header: &Header, data: &[u8]) {
        let mut at = 0;
        for (f, field) in header.fields.iter().enumerate() {
            let run = &data[at..at + field.bytes() * self.count];
            for (row, value) in run.chunks_exact(field.bytes().max(1)).enumerate() {
                self.put(f, field, row, &value[..field.size]);
            }
            at += run.len();
        }
    }

    fn put(&mut self, f: usize, field: &Field, row: usize, bytes: &[u8]) {
        match self.targets[f] {
            Target::Nothing => {}
            Target::Packed => {
                let bits = bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b));
                self.colour(field, row, bits);
            }
            target => self.number(target, row, field.number(bytes)),
        }
    }

    fn number(&mut self, target: Target, row: usize, value: f64) {
        match target {
            Target::Position(k) => self.parts.points[row][k] = value,
            Target::Normal(k) => {
                if let Some(normals) = &mut self.parts.normals {
                    normals[row][k] = value as f32;
                }
            }
            Target::Scalar(s) => self.parts.scalars[s].values[row] = value,
            Target::Packed | Target::Nothing => {}
        }
    }

    /// `rgb` has no alpha: those bits mean nothing there.
    fn colour(&mut self, field: &Field, row: usize, bits: u32) {
        let [b, g, r, a] = bits.to_le_bytes();
        if let Some(colours) = &mut self.parts.colours {
            let alpha = if field.name == "rgba" { a } else { 255 };
            colours[row] = [r, g, b, alpha];
        }
    }

    /// Three fields named r, g and b are colours too.
    fn finish(mut self) -> Parts {
        let named = |s: &ScalarColumn, name: &str| s.name == name;
        let find = |name: &str| (self.parts.scalars.iter()).position(|s| named(s, name));
        if let (None, Some(r), Some(g), Some(b)) =
            (&self.parts.colours, find("r"), find("g"), find("b"))
        {
            let of = |s: usize, i: usize| self.parts.scalars[s].values[i] as f32;
            let values: Vec<[f32; 4]> = (0..self.count)
                .map(|i| [of(r, i), of(g, i), of(b, i), 255.0])
                .collect();
            self.parts.colours = Some(colours_of(&values, false));
            self.parts
                .scalars
                .retain(|s| !["r", "g", "b"].iter().any(|n| named(s, n)));
        }
        self.parts
    }
}

/// One point a line; the line of each.
fn text(header: &Header, lines: Lines, columns: &mut Columns) -> Result<Vec<u64>, ReadError> {
    // A value takes a digit and a blank at least.
    let values: u64 = header.fields.iter().map(|f| f.count as u64).sum();
    let most = lines.rest().len() as u64 / (2 * values).max(1) + 1;
    if header.points > most {
        return Err(ReadError::Truncated {
            what: "points".into(),
            expected: header.points,
            found: most,
        });
    }
    columns.enough(header, usize::MAX)?;
    let mut places = Vec::with_capacity(columns.count);
    for (number, line) in lines {
        let row = places.len();
        if row == columns.count {
            break;
        }
        let mut words = Words::new(line);
        if words.clone().next().is_none_or(|(_, w)| w[0] == b'#') {
            continue;
        }
        let mut seen = 0;
        for (f, field) in header.fields.iter().enumerate() {
            for k in 0..field.count {
                let Some((at, word)) = words.next() else {
                    return Err(ReadError::Columns {
                        line: number,
                        found: seen,
                        expected: format!("the header announces {values}"),
                    });
                };
                seen += 1;
                if k > 0 || matches!(columns.targets[f], Target::Nothing) {
                    continue;
                }
                let value = scan::number(word)
                    .ok_or_else(|| scan::not_a("a number", scan::column(number, at), word))?;
                match columns.targets[f] {
                    Target::Packed => columns.colour(field, row, field.bits(value)),
                    target => columns.number(target, row, value),
                }
            }
        }
        if words.next().is_some() {
            return Err(ReadError::Columns {
                line: number,
                found: seen + 1 + words.count(),
                expected: format!("the header announces {values}"),
            });
        }
        places.push(number);
    }
    match places.len() == columns.count {
        true => Ok(places),
        false => Err(ReadError::Truncated {
            what: "points".into(),
            expected: header.points,
            found: places.len() as u64,
        }),
    }
}
