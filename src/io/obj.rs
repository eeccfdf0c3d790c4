//! Wavefront OBJ: `v`, `vn` and `f` lines in; meshes out.
//!
//! The crate `tobj` drops every vertex that no face uses, which is all of a
//! point cloud, and takes a line continued by `\` for an error.

use super::attributes::{MeshAttributes, WriteOptions};
use super::buffer::{comment_lines, Buffer};
use super::cloud::{colours_of, Cloud, Parts, ReadOptions};
use super::error::{Place, ReadError, WriteError};
use super::format::CloudFormat;
use super::scan::{self, Lines, Words};
use super::sink::{check_count, check_finite, FaceSink};
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use std::io::Write;

#[derive(Default)]
struct Contents {
    points: Vec<Point>,
    colours: Vec<[f32; 4]>,
    alpha: bool,
    normals: Vec<[f32; 3]>,
    /// Whether every face names for each corner the normal of the same number.
    normals_in_step: bool,
    first_invalid: Option<u64>,
    nan_colours: usize,
    passed_over: usize,
}

fn read(bytes: &[u8], faces: &mut FaceSink) -> Result<Contents, ReadError> {
    let mut out = Contents {
        normals_in_step: true,
        ..Contents::default()
    };
    let mut lines = Lines::new(scan::without_bom(bytes));
    let mut joined = Vec::new();
    let mut corners = Vec::new();
    // The largest vertex named so far, its place and how it is written: a
    // face may come before its vertices.
    let mut furthest = (-1i64, Place::Line(0));
    while let Some((number, first)) = lines.next() {
        let mut line = first;
        if line.last() == Some(&b'\\') {
            joined.clear();
            while let Some(part) = line.strip_suffix(b"\\") {
                joined.extend_from_slice(part);
                joined.push(b' ');
                line = lines.next().map_or(&[], |(_, l)| l);
            }
            joined.extend_from_slice(line);
            line = &joined;
        }
        let mut words = Words::new(line);
        let Some((_, keyword)) = words.next() else {
            continue;
        };
        match keyword {
            b"v" => vertex(&mut out, number, words)?,
            b"vn" => {
                let mut normal = [0.0; 3];
                for n in &mut normal {
                    *n = next_number(&mut words, number, "a component of a normal")? as f32;
                }
                out.normals.push(normal);
            }
            b"f" => {
                corners.clear();
                for (at, word) in words {
                    let place = scan::column(number, at);
                    let (vertex, normal) = corner(&out, word, place)?;
                    out.normals_in_step &= normal.is_none_or(|n| n == vertex);
                    if vertex > furthest.0 {
                        furthest = (vertex, place);
                    }
                    corners.push(vertex);
                }
                faces.push(&corners, u64::from(u32::MAX) - 1, Place::Line(number))?;
            }
            // Known statements that are no vertices, and comments.
            _ if keyword[0].is_ascii_alphabetic() || matches!(keyword[0], b'#' | b'$') => {
                out.passed_over += 1;
            }
            _ => {
                return Err(ReadError::Malformed {
                    place: Place::Line(number),
                    what: format!(
                        "`{}` starts no OBJ statement (bare numbers are read as xyz)",
                        scan::shown(keyword)
                    ),
                });
            }
        }
    }
    let count = out.points.len() as u64;
    check_count("vertices", count)?;
    if furthest.0 >= count as i64 && count > 0 {
        return Err(index_error(furthest.0 + 1, count, furthest.1));
    }
    Ok(out)
}

fn index_error(index: i64, count: u64, place: Place) -> ReadError {
    ReadError::Index {
        place,
        index,
        count,
        what: "vertices",
        range: "counting from 1, or back from -1",
    }
}

fn next_number(words: &mut Words, line: u64, expected: &'static str) -> Result<f64, ReadError> {
    let Some((at, word)) = words.next() else {
        return Err(ReadError::Malformed {
            place: Place::Line(line),
            what: format!("the line ends where {expected} should be"),
        });
    };
    scan::number(word).ok_or_else(|| scan::not_a(expected, scan::column(line, at), word))
}

/// `x y z`, `x y z w`, `x y z r g b` or `x y z r g b a`.
fn vertex(out: &mut Contents, line: u64, mut words: Words) -> Result<(), ReadError> {
    let mut point = [0.0; 3];
    for c in &mut point {
        *c = next_number(&mut words, line, "a coordinate")?;
    }
    let mut more = [f32::INFINITY; 4];
    let mut count = 0;
    for (at, word) in words {
        if word[0] == b'#' {
            break;
        }
        let value = scan::number(word)
            .ok_or_else(|| scan::not_a("a colour", scan::column(line, at), word))?;
        if let Some(slot) = more.get_mut(count) {
            *slot = value as f32;
        }
        count += 1;
    }
    if out.first_invalid.is_none() && !point.iter().all(|c| c.is_finite()) {
        out.first_invalid = Some(line);
    }
    if count >= 3 {
        if out.colours.len() < out.points.len() {
            out.colours.resize(out.points.len(), [0.0; 4]);
        }
        if more[..3].iter().any(|c| c.is_nan()) {
            out.nan_colours += 1;
        }
        out.alpha |= count > 3;
        out.colours.push(more);
    }
    out.points.push(point);
    Ok(())
}

/// A corner `v`, `v/t`, `v//n` or `v/t/n`: vertex and normal from 0.
fn corner(out: &Contents, word: &[u8], place: Place) -> Result<(i64, Option<i64>), ReadError> {
    let mut parts = word.split(|&b| b == b'/');
    let mut index = |count: usize| {
        let part = parts.next()?;
        let value = scan::integer(part)?;
        Some(if value < 0 {
            count as i64 + value
        } else {
            value - 1
        })
    };
    let count = out.points.len();
    let vertex = index(count).ok_or_else(|| scan::not_a("a vertex index", place, word))?;
    if vertex < 0 {
        let written = scan::integer(word.split(|&b| b == b'/').next().unwrap_or(word));
        return Err(index_error(written.unwrap_or(0), count as u64, place));
    }
    let normal = parts.nth(1).and_then(scan::integer).map(|value| {
        if value < 0 {
            out.normals.len() as i64 + value
        } else {
            value - 1
        }
    });
    Ok((vertex, normal))
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let mut faces = FaceSink::counting();
    let contents = read(bytes, &mut faces)?;
    let mut parts = Parts::new(CloudFormat::Obj);
    let count = contents.points.len();
    parts.points = contents.points;
    if !contents.colours.is_empty() {
        let mut colours = contents.colours;
        colours.resize(count, [0.0; 4]);
        parts.colours = Some(colours_of(&colours, contents.alpha));
    }
    let notes = &mut parts.report.notes;
    if contents.normals.len() == count && contents.normals_in_step {
        parts.normals = Some(contents.normals);
    } else if !contents.normals.is_empty() {
        notes.push(format!(
            "{} normals for {count} vertices are not in step with them and were left out.",
            contents.normals.len()
        ));
    }
    if contents.nan_colours > 0 {
        notes.push(format!(
            "{} vertices have NaN as a colour: 0 is taken.",
            contents.nan_colours
        ));
    }
    notes.extend(faces.note());
    parts.report.records_passed_over = contents.passed_over;
    parts.report.faces_ignored = Some(faces.count).filter(|&f| f > 0);
    let line = contents.first_invalid;
    parts.finish(options, "vertices", |_| Place::Line(line.unwrap_or(0)))
}

pub fn read_mesh(bytes: &[u8]) -> Result<PolygonMesh, ReadError> {
    let mut faces = FaceSink::keeping();
    let contents = read(bytes, &mut faces)?;
    if contents.points.is_empty() {
        return Err(ReadError::Nothing {
            what: "vertices",
            format: "OBJ",
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
    for line in comment_lines(options) {
        // A backslash at the end would swallow the next line.
        out.text(&format!("# {}\n", line.trim_end_matches('\\')));
    }
    for (i, &p) in mesh.vertices.iter().enumerate() {
        out.text("v ");
        out.triple(p);
        if let Some(colours) = attributes.colours {
            for &c in &colours[i][..3] {
                // Three decimals tell all 256 steps apart.
                let thousandths = (u32::from(c) * 1000 + 127) / 255;
                out.text(&format!(
                    " {}.{:03}",
                    thousandths / 1000,
                    thousandths % 1000
                ));
            }
        }
        out.text("\n");
        out.record()?;
    }
    for n in attributes.normals.into_iter().flatten() {
        out.text("vn");
        for &c in n {
            out.text(" ");
            out.number32(c);
        }
        out.text("\n");
        out.record()?;
    }
    for face in mesh.faces() {
        out.text("f");
        for &c in face {
            let index = i64::from(c) + 1;
            out.text(" ");
            out.integer(index);
            if attributes.normals.is_some() {
                out.text("//");
                out.integer(index);
            }
        }
        out.text("\n");
        out.record()?;
    }
    out.finish()
}
