//! Geomview OFF and its kin COFF, NOFF, STOFF: text, three dimensions.

use super::attributes::{MeshAttributes, WriteOptions};
use super::buffer::{comment_lines, Buffer};
use super::cloud::{colours_of, Cloud, Parts, ReadOptions};
use super::error::{Place, ReadError, WriteError};
use super::format::CloudFormat;
use super::scan::{self, Stream};
use super::sink::{check_count, check_finite, FaceSink};
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use std::io::Write;

/// What the keyword says about each vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Keyword {
    texture: bool,
    colour: bool,
    normal: bool,
    /// `4` or `n`: points that are not in space.
    other_dimension: bool,
    /// Bytes of the word that belong to the keyword: counts may be glued on.
    length: usize,
}

/// Takes `[ST][C][N][4][n]OFF` from the front of a word.
pub fn keyword(word: &[u8]) -> Option<Keyword> {
    let mut key = Keyword::default();
    let mut rest = word;
    let mut take = |prefix: &[u8]| {
        let found = rest.strip_prefix(prefix);
        rest = found.unwrap_or(rest);
        found.is_some()
    };
    key.texture = take(b"ST");
    key.colour = take(b"C");
    key.normal = take(b"N");
    key.other_dimension = take(b"4") | take(b"n");
    if !take(b"OFF") || rest.first().is_some_and(|b| !b.is_ascii_digit()) {
        return None;
    }
    key.length = word.len() - rest.len();
    Some(key)
}

struct Contents {
    points: Vec<Point>,
    normals: Vec<[f32; 3]>,
    colours: Vec<[f32; 4]>,
    alpha: bool,
    /// Extra numbers after the coordinates that the keyword does not announce.
    extra: bool,
    first_invalid: Option<u64>,
}

/// The next number of the stream, or the error for its end.
fn next_number(
    words: &mut Stream,
    expected: &'static str,
    at_end: impl Fn() -> ReadError,
) -> Result<f64, ReadError> {
    let (place, word) = words.next().ok_or_else(at_end)?;
    scan::number(word).ok_or_else(|| scan::not_a(expected, place, word))
}

fn next_integer(
    words: &mut Stream,
    expected: &'static str,
    at_end: impl Fn() -> ReadError,
) -> Result<i64, ReadError> {
    let (place, word) = words.next().ok_or_else(at_end)?;
    scan::integer(word).ok_or_else(|| scan::not_a(expected, place, word))
}

/// Keyword and counts.
fn header(words: &mut Stream) -> Result<(Keyword, u64, u64), ReadError> {
    let missing = || ReadError::Missing {
        what: "counts of vertices and faces after the keyword OFF".into(),
    };
    let (place, word) = words.next().ok_or_else(missing)?;
    let key = keyword(word);
    let mut first = Some((place, word)).filter(|_| key.is_none());
    if let Some(key) = key {
        if key.other_dimension {
            return Err(ReadError::Unsupported {
                what: "OFF of another dimension than 3 (4OFF, nOFF)".into(),
                remedy: "export it in three dimensions",
            });
        }
        let glued = &word[key.length..];
        if !glued.is_empty() {
            first = Some((place, glued));
        }
    }
    let mut counts = [0u64; 2];
    for (k, what) in ["the number of vertices", "the number of faces"]
        .into_iter()
        .enumerate()
    {
        let (place, word) = match first.take() {
            Some(found) => found,
            None => words.next().ok_or_else(missing)?,
        };
        if word.eq_ignore_ascii_case(b"BINARY") {
            return Err(ReadError::Unsupported {
                what: "binary OFF".into(),
                remedy: "convert it to text OFF or to PLY",
            });
        }
        counts[k] = scan::integer(word)
            .and_then(|n| u64::try_from(n).ok())
            .ok_or_else(|| {
                let expected = if key.is_none() && k == 0 {
                    "the keyword OFF"
                } else {
                    what
                };
                scan::not_a(expected, place, word)
            })?;
    }
    // The number of edges, where it is given: nobody uses it.
    words.skip_line();
    Ok((key.unwrap_or_default(), counts[0], counts[1]))
}

fn read(bytes: &[u8], faces: &mut FaceSink, all: bool) -> Result<Contents, ReadError> {
    let mut words = Stream::new(scan::without_bom(bytes), true);
    let (key, vertex_count, face_count) = header(&mut words)?;
    check_count("vertices", vertex_count)?;
    let cut = |what: &str, expected: u64, found: u64| ReadError::Truncated {
        what: what.into(),
        expected,
        found,
    };
    // Three numbers with a blank after each, one with a blank for a face.
    let left = words.bytes_left() as u64 + 1;
    if vertex_count > left / 6 {
        return Err(cut("vertices", vertex_count, left / 6));
    }
    if face_count > left / 2 {
        return Err(cut("faces", face_count, left / 2));
    }
    let mut out = Contents {
        points: Vec::with_capacity(vertex_count as usize),
        normals: Vec::new(),
        colours: Vec::new(),
        alpha: false,
        extra: false,
        first_invalid: None,
    };
    for found in 0..vertex_count {
        let at_end = || cut("vertices", vertex_count, found);
        let mut point = [0.0; 3];
        for c in &mut point {
            *c = next_number(&mut words, "a coordinate", at_end)?;
        }
        if out.first_invalid.is_none() && !point.iter().all(|c| c.is_finite()) {
            out.first_invalid = Some(words.line());
        }
        out.points.push(point);
        if key.normal {
            let mut normal = [0.0; 3];
            for c in &mut normal {
                *c = next_number(&mut words, "a normal", at_end)? as f32;
            }
            if all {
                out.normals.push(normal);
            }
        }
        if key.colour && all {
            colour(&mut words, key, &mut out)?;
        } else if words.next_in_line().is_some() {
            out.extra |= !key.texture && !key.colour;
        }
        words.skip_line();
    }
    let mut corners = Vec::new();
    for found in 0..face_count {
        let at_end = || cut("faces", face_count, found);
        let count = next_integer(&mut words, "the number of corners of a face", at_end)?;
        let place = Place::Line(words.line());
        if count < 0 {
            return Err(ReadError::Malformed {
                place,
                what: format!("a face of {count} corners"),
            });
        }
        corners.clear();
        for _ in 0..count {
            corners.push(next_integer(&mut words, "a vertex index", at_end)?);
        }
        faces.push(&corners, vertex_count, place)?;
        // Colours of faces.
        words.skip_line();
    }
    Ok(out)
}

/// The rest of a vertex line: three or four numbers, before the two of a
/// texture.
fn colour(words: &mut Stream, key: Keyword, out: &mut Contents) -> Result<(), ReadError> {
    let mut values = [0.0f32; 8];
    let mut count = 0;
    while let Some((place, word)) = words.next_in_line() {
        let value = scan::number(word).ok_or_else(|| scan::not_a("a colour", place, word))?;
        if let Some(slot) = values.get_mut(count) {
            *slot = value as f32;
            count += 1;
        }
    }
    if key.texture {
        count = count.saturating_sub(2);
    }
    if count < 3 {
        return Err(ReadError::Columns {
            line: words.line(),
            found: count,
            expected: "COFF has 3 or 4 for the colour".into(),
        });
    }
    out.alpha |= count > 3;
    let alpha = if count > 3 { values[3] } else { f32::INFINITY };
    out.colours.push([values[0], values[1], values[2], alpha]);
    Ok(())
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let mut faces = FaceSink::counting();
    let contents = read(bytes, &mut faces, true)?;
    let mut parts = Parts::new(CloudFormat::Off);
    parts.points = contents.points;
    parts.normals = Some(contents.normals).filter(|n| !n.is_empty());
    if !contents.colours.is_empty() {
        parts.colours = Some(colours_of(&contents.colours, contents.alpha));
    }
    let notes = &mut parts.report.notes;
    if contents.extra {
        notes.push(
            "Vertex lines have more than three numbers, which the keyword OFF does not announce: the rest was left out.".into(),
        );
    }
    notes.extend(faces.note());
    parts.report.faces_ignored = Some(faces.count).filter(|&f| f > 0);
    let line = contents.first_invalid;
    parts.finish(options, "vertices", |_| Place::Line(line.unwrap_or(0)))
}

pub fn read_mesh(bytes: &[u8]) -> Result<PolygonMesh, ReadError> {
    let mut faces = FaceSink::keeping();
    let contents = read(bytes, &mut faces, false)?;
    if contents.points.is_empty() {
        return Err(ReadError::Nothing {
            what: "vertices",
            format: "OFF",
        });
    }
    let line = contents.first_invalid;
    check_finite(&contents.points, |_| Place::Line(line.unwrap_or(0)))?;
    let mut mesh = faces.mesh.unwrap_or_default();
    mesh.vertices = contents.points;
    Ok(mesh)
}

pub fn write_mesh<W: Write>(
    writer: &mut W,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let mut out = Buffer::new(writer, options);
    out.text(match (attributes.colours, attributes.normals) {
        (None, None) => "OFF\n",
        (Some(_), None) => "COFF\n",
        (None, Some(_)) => "NOFF\n",
        (Some(_), Some(_)) => "CNOFF\n",
    });
    for line in comment_lines(options) {
        out.text(&format!("# {line}\n"));
    }
    // The third count is of edges, which readers ignore.
    out.text(&format!(
        "{} {} 0\n",
        mesh.vertices.len(),
        mesh.face_count()
    ));
    for (i, &p) in mesh.vertices.iter().enumerate() {
        out.triple(p);
        if let Some(normals) = attributes.normals {
            for c in normals[i] {
                out.text(" ");
                out.number32(c);
            }
        }
        if let Some(colours) = attributes.colours {
            for c in colours[i] {
                out.text(" ");
                out.integer(i64::from(c));
            }
        }
        out.text("\n");
        out.record()?;
    }
    for face in mesh.faces() {
        out.integer(face.len() as i64);
        for &c in face {
            out.text(" ");
            out.integer(i64::from(c));
        }
        out.text("\n");
        out.record()?;
    }
    out.finish()
}
