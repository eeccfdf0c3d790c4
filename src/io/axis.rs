//! Medial axes: the `.ma` text format, and checks shared by all formats.

use super::attributes::WriteOptions;
use super::buffer::{comment_lines, Buffer};
use super::error::{Place, ReadError, WriteError};
use super::format::AxisFormat;
use super::scan::{self, Stream};
use super::sink::{check_count, check_finite};
use super::{json, ply};
use crate::surface::PowerShape;
use std::io::Write;

pub fn write<W: Write>(
    writer: &mut W,
    format: AxisFormat,
    shape: &PowerShape,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    check(shape)?;
    match format {
        AxisFormat::Ma => write_ma(writer, shape, options),
        AxisFormat::Ply => ply::write_axis(writer, shape, options),
        AxisFormat::Obj => write_obj(writer, shape, options),
        AxisFormat::Json => json::write_axis(writer, shape, options),
    }
}

pub fn read(bytes: &[u8], format: AxisFormat) -> Result<PowerShape, ReadError> {
    let mut shape = match format {
        AxisFormat::Ma => read_ma(bytes)?,
        AxisFormat::Ply => ply::read_axis(bytes)?,
        AxisFormat::Json => json::read_axis(bytes)?,
        AxisFormat::Obj => {
            return Err(ReadError::Unsupported {
                what: "a medial axis in OBJ (it has no radii)".into(),
                remedy: "use .ma, PLY or JSON",
            })
        }
    };
    if shape.balls.is_empty() {
        return Err(ReadError::Nothing {
            what: "balls",
            format: "medial axis",
        });
    }
    if shape.ids.is_empty() {
        shape.ids = (0..shape.balls.len() as u32).collect();
    }
    check(&shape).map_err(|e| ReadError::Malformed {
        place: Place::Record(0),
        what: e.to_string(),
    })?;
    Ok(shape)
}

/// Every index names a ball, every ball has an id or none has.
fn check(shape: &PowerShape) -> Result<(), WriteError> {
    let count = shape.balls.len();
    let inside = |i: &u32| (*i as usize) < count;
    let inconsistent = |what: String| Err(WriteError::Inconsistent { what });
    if !shape.ids.is_empty() && shape.ids.len() != count {
        return inconsistent(format!("axis: {} ids for {count} balls", shape.ids.len()));
    }
    let lists = [
        (
            "edge",
            shape.edges.iter().position(|e| !e.iter().all(inside)),
        ),
        (
            "triangle",
            shape.triangles.iter().position(|t| !t.iter().all(inside)),
        ),
        (
            "tetrahedron",
            shape.tetrahedra.iter().position(|t| !t.iter().all(inside)),
        ),
    ];
    for (name, bad) in lists {
        if let Some(i) = bad {
            return inconsistent(format!(
                "axis: {name} {i} names a ball beyond the {count} there are"
            ));
        }
    }
    Ok(())
}

fn simplex<W: Write>(out: &mut Buffer<W>, letter: &str, corners: &[u32], base: i64) {
    out.text(letter);
    for &c in corners {
        out.text(" ");
        out.integer(i64::from(c) + base);
    }
    out.text("\n");
}

/// `balls edges triangles`, then `v x y z r`, `e i j`, `f i j k`, from 0.
fn write_ma<W: Write>(
    writer: &mut W,
    shape: &PowerShape,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let mut out = Buffer::new(writer, options);
    // Counts first: most readers know no comments before them.
    out.text(&format!(
        "{} {} {}\n",
        shape.balls.len(),
        shape.edges.len(),
        shape.triangles.len()
    ));
    for line in comment_lines(options) {
        out.text(&format!("# {line}\n"));
    }
    for b in &shape.balls {
        out.text("v ");
        out.triple(b.centre);
        out.text(" ");
        out.number(b.radius);
        out.text("\n");
        out.record()?;
    }
    for e in &shape.edges {
        simplex(&mut out, "e", e, 0);
        out.record()?;
    }
    for t in &shape.triangles {
        simplex(&mut out, "f", t, 0);
        out.record()?;
    }
    out.finish()
}

fn write_obj<W: Write>(
    writer: &mut W,
    shape: &PowerShape,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let mut out = Buffer::new(writer, options);
    for line in comment_lines(options) {
        out.text(&format!("# {}\n", line.trim_end_matches('\\')));
    }
    for b in &shape.balls {
        out.text("v ");
        out.triple(b.centre);
        out.text("\n");
        out.record()?;
    }
    for e in &shape.edges {
        simplex(&mut out, "l", e, 1);
        out.record()?;
    }
    for t in &shape.triangles {
        simplex(&mut out, "f", t, 1);
        out.record()?;
    }
    out.finish()
}

fn read_ma(bytes: &[u8]) -> Result<PowerShape, ReadError> {
    let mut words = Stream::new(scan::without_bom(bytes), true);
    let mut counts = [0u64; 3];
    for (count, what) in counts.iter_mut().zip(["balls", "edges", "triangles"]) {
        let Some((place, word)) = words.next() else {
            return Err(ReadError::Missing {
                what: format!("number of {what} in the first line of this .ma file"),
            });
        };
        let number = scan::integer(word).and_then(|n| u64::try_from(n).ok());
        *count = number.ok_or_else(|| scan::not_a("a count", place, word))?;
    }
    let [balls, edges, triangles] = counts;
    check_count("balls", balls)?;
    let mut shape = PowerShape::default();
    while let Some((place, word)) = words.next() {
        let line = words.line();
        let mut numbers = [0.0f64; 4];
        let wanted = match word {
            b"v" => 4,
            b"e" => 2,
            b"f" => 3,
            _ => return Err(scan::not_a("v, e or f", place, word)),
        };
        for n in &mut numbers[..wanted] {
            let Some((place, word)) = words.next_in_line() else {
                return Err(ReadError::Malformed {
                    place: Place::Line(line),
                    what: format!("a line `{}` has {wanted} numbers", scan::shown(word)),
                });
            };
            let value = if wanted == 4 {
                scan::number(word)
            } else {
                scan::integer(word).map(|i| i as f64)
            };
            *n = value.ok_or_else(|| scan::not_a("a number", place, word))?;
        }
        // Some programs write more after the numbers.
        words.skip_line();
        let [x, y, z, r] = numbers;
        if wanted == 4 {
            check_finite(&[[x, y, z]], |_| Place::Line(line))?;
            shape
                .balls
                .push(ply::ball([x, y, z], r, Place::Line(line))?);
            continue;
        }
        if let Some(&bad) = numbers[..wanted]
            .iter()
            .find(|&&i| !(i >= 0.0 && i < balls as f64))
        {
            return Err(ReadError::Index {
                place: Place::Line(line),
                index: bad as i64,
                count: balls,
                what: "balls",
                range: "counting from 0",
            });
        }
        if wanted == 2 {
            shape.edges.push([x as u32, y as u32]);
        } else {
            shape.triangles.push([x as u32, y as u32, z as u32]);
        }
    }
    let found = [shape.balls.len(), shape.edges.len(), shape.triangles.len()];
    let lists = [("balls", balls), ("edges", edges), ("triangles", triangles)];
    for ((what, expected), found) in lists.into_iter().zip(found) {
        if expected != found as u64 {
            return Err(ReadError::Truncated {
                what: what.into(),
                expected,
                found: found as u64,
            });
        }
    }
    Ok(shape)
}
