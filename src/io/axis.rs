//! Medial axes: the `.ma` text format, and checks shared by all formats.
//!
//! A `.ma` file is `balls edges triangles`, then so many lines `v x y z r`,
//! `e i j`, `f i j k`, counting from 0. Programs read as many lines as were
//! announced, so what else there is comes after them, a word in front:
//!
//! | line | meaning |
//! | --- | --- |
//! | `side inner`, `side outer` | the label of all the balls |
//! | `tet i j k l` | a tetrahedron |
//! | `span i d c h` | of the samples on ball `i`: the largest distance, the radius of the smallest ball around them, their spacing |
//! | `other x y z r d c h` | a ball of the other side, and the same of it |

use super::attributes::WriteOptions;
use super::buffer::{comment_lines, Buffer};
use super::error::{Place, ReadError, WriteError};
use super::format::AxisFormat;
use super::scan::{self, Stream};
use super::sink::{check_count, check_finite};
use super::{json, ply};
use crate::axis::Structure;
use crate::geom::{Ball, Side};
use crate::simplify::Contact;
use crate::surface::PowerShape;
use std::io::Write;

pub fn write<W: Write>(
    writer: &mut W,
    format: AxisFormat,
    shape: &PowerShape,
    parts: Option<&Structure>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    check(shape)?;
    if let Some(parts) = parts {
        check_parts(shape, parts)?;
    }
    match format {
        AxisFormat::Ma => write_ma(writer, shape, options),
        AxisFormat::Ply => ply::write_axis(writer, shape, parts, options),
        AxisFormat::Obj => write_obj(writer, shape, options),
        AxisFormat::Json => json::write_axis(writer, shape, parts, options),
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

/// Every simplex has a number.
fn check_parts(shape: &PowerShape, parts: &Structure) -> Result<(), WriteError> {
    let lists = [
        ("sheets", parts.sheet_of.len(), shape.triangles.len()),
        ("seams", parts.seam_of.len(), shape.edges.len()),
        ("rims", parts.rim_of.len(), shape.edges.len()),
        ("curves", parts.curve_of.len(), shape.edges.len()),
        ("junctions", parts.junction_of.len(), shape.balls.len()),
    ];
    match lists.into_iter().find(|(_, given, wanted)| given != wanted) {
        None => Ok(()),
        Some((name, given, wanted)) => Err(WriteError::Inconsistent {
            what: format!("axis: {given} numbers of {name} for {wanted} simplices"),
        }),
    }
}

/// A contact whose lengths can be such.
pub(super) fn contact(numbers: [f64; 3], place: Place) -> Result<Contact, ReadError> {
    if let Some(bad) = numbers.iter().find(|n| !(**n >= 0.0 && n.is_finite())) {
        return Err(ReadError::Malformed {
            place,
            what: format!("the length {bad}: must be finite and not negative"),
        });
    }
    let [diameter, circumradius, spacing] = numbers;
    Ok(Contact {
        diameter,
        circumradius,
        spacing,
    })
}

/// The side that all balls share.
pub(super) fn common_side(shape: &PowerShape) -> Option<Side> {
    let first = *shape.sides.first()?;
    shape.sides.iter().all(|&s| s == first).then_some(first)
}

/// Every index names a ball, every ball has an id or none has; the same of
/// sides and contacts.
fn check(shape: &PowerShape) -> Result<(), WriteError> {
    let count = shape.balls.len();
    let inside = |i: &u32| (*i as usize) < count;
    let inconsistent = |what: String| Err(WriteError::Inconsistent { what });
    if !shape.ids.is_empty() && shape.ids.len() != count {
        return inconsistent(format!("axis: {} ids for {count} balls", shape.ids.len()));
    }
    let others = shape.others.len();
    let parallel = [
        ("sides", shape.sides.len(), count),
        ("contacts", shape.contacts.len(), count),
        (
            "contacts of the other side",
            shape.other_contacts.len(),
            others,
        ),
        (
            "lists of points touched",
            shape.touching.starts.len().saturating_sub(1),
            count,
        ),
    ];
    for (name, given, balls) in parallel {
        if given != 0 && given != balls {
            return inconsistent(format!("axis: {given} {name} for {balls} balls"));
        }
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
    for b in &shape.balls {
        out.text("v ");
        ball(&mut out, b);
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
    for line in comment_lines(options) {
        out.text(&format!("# {line}\n"));
    }
    match common_side(shape) {
        Some(Side::Inner) => out.text("side inner\n"),
        Some(Side::Outer) => out.text("side outer\n"),
        None => {}
    }
    for t in &shape.tetrahedra {
        simplex(&mut out, "tet", t, 0);
        out.record()?;
    }
    for (i, c) in shape.contacts.iter().enumerate() {
        out.text("span ");
        out.integer(i as i64);
        span(&mut out, c);
        out.record()?;
    }
    for (i, b) in shape.others.iter().enumerate() {
        out.text("other ");
        ball(&mut out, b);
        match shape.other_contacts.get(i) {
            Some(c) => span(&mut out, c),
            None => out.text("\n"),
        }
        out.record()?;
    }
    out.finish()
}

fn ball<W: Write>(out: &mut Buffer<W>, ball: &Ball) {
    out.triple(ball.centre);
    out.text(" ");
    out.number(ball.radius);
}

fn span<W: Write>(out: &mut Buffer<W>, contact: &Contact) {
    out.text(" ");
    out.triple([contact.diameter, contact.circumradius, contact.spacing]);
    out.text("\n");
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
    let mut spans: Vec<(u32, Contact)> = Vec::new();
    let mut side = None;
    while let Some((place, word)) = words.next() {
        let line = words.line();
        let at = Place::Line(line);
        // A ball, then indices, then other numbers.
        let (wanted, of_indices) = match word {
            b"v" => (4, 0..0),
            b"e" => (2, 0..2),
            b"f" => (3, 0..3),
            b"tet" => (4, 0..4),
            b"span" => (4, 0..1),
            b"other" => (4, 0..0),
            b"side" => {
                side = Some(read_side(&mut words, at)?);
                words.skip_line();
                continue;
            }
            _ => return Err(scan::not_a("v, e or f", place, word)),
        };
        let mut numbers = [0.0f64; 7];
        let mut given = 0;
        while given < numbers.len() {
            let Some((place, value)) = words.next_in_line() else {
                break;
            };
            let read = match of_indices.contains(&given) {
                true => scan::integer(value).map(|i| i as f64),
                false => scan::number(value),
            };
            match read {
                Some(value) => numbers[given] = value,
                // Some programs write more after the numbers.
                None if given >= wanted => break,
                None => return Err(scan::not_a("a number", place, value)),
            }
            given += 1;
        }
        if given < wanted {
            return Err(ReadError::Malformed {
                place: at,
                what: format!("a line `{}` has {wanted} numbers", scan::shown(word)),
            });
        }
        words.skip_line();
        let [x, y, z, r, d, c, h] = numbers;
        let bad = numbers[of_indices]
            .iter()
            .find(|&&i| !(i >= 0.0 && i < balls as f64));
        if let Some(&bad) = bad {
            return Err(ReadError::Index {
                place: at,
                index: bad as i64,
                count: balls,
                what: "balls",
                range: "counting from 0",
            });
        }
        match word {
            b"v" | b"other" => {
                check_finite(&[[x, y, z]], |_| at)?;
                let ball = ply::ball([x, y, z], r, at)?;
                if word == b"v" {
                    shape.balls.push(ball);
                } else {
                    shape.others.push(ball);
                    if given == numbers.len() {
                        shape.other_contacts.push(contact([d, c, h], at)?);
                    }
                }
            }
            b"e" => shape.edges.push([x as u32, y as u32]),
            b"f" => shape.triangles.push([x as u32, y as u32, z as u32]),
            b"tet" => shape.tetrahedra.push([x, y, z, r].map(|i| i as u32)),
            _ => spans.push((x as u32, contact([y, z, r], at)?)),
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
    if let Some(side) = side {
        shape.sides = vec![side; shape.balls.len()];
    }
    // Contacts of some balls only are of no use.
    spans.sort_by_key(|s| s.0);
    spans.dedup_by_key(|s| s.0);
    if spans.len() == shape.balls.len() {
        shape.contacts = spans.into_iter().map(|s| s.1).collect();
    }
    if shape.other_contacts.len() != shape.others.len() {
        shape.other_contacts.clear();
    }
    Ok(shape)
}

fn read_side(words: &mut Stream, at: Place) -> Result<Side, ReadError> {
    match words.next_in_line() {
        Some((_, b"inner")) => Ok(Side::Inner),
        Some((_, b"outer")) => Ok(Side::Outer),
        Some((place, word)) => Err(scan::not_a("inner or outer", place, word)),
        None => Err(ReadError::Malformed {
            place: at,
            what: "a line `side` says inner or outer".into(),
        }),
    }
}
