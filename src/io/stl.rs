//! STL, text and binary. Equal corners become one vertex.
//!
//! Own code: the crate `stl_io` silently drops a second `solid` of a text
//! file, refuses `SOLID` in capitals, and reads text as 32-bit floats.

use super::attributes::WriteOptions;
use super::buffer::{comment_lines, Buffer};
use super::cloud::{Cloud, Parts, ReadOptions};
use super::error::{Place, ReadError, WriteError};
use super::format::CloudFormat;
use super::scan::{self, Stream};
use super::sink::{check_count, check_finite};
use crate::geom::{vec3, Point};
use crate::mesh::PolygonMesh;
use std::io::Write;

/// 80 bytes of text and a count.
const HEADER: usize = 84;
/// Normal, three corners, two spare bytes.
const RECORD: usize = 50;

fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.first_chunk::<4>()?;
    Some(u64::from(u32::from_le_bytes(*count)))
}

/// Whether the size is just what the count of a binary file asks for. Some
/// programs begin binary files with `solid`.
pub fn looks_binary(bytes: &[u8]) -> bool {
    announced(bytes)
        .is_some_and(|count| bytes.len() as u64 == HEADER as u64 + count * RECORD as u64)
}

/// Distinct points by their coordinates: an open hash table of indices.
#[derive(Default)]
struct Weld {
    points: Vec<Point>,
    slots: Vec<u32>,
}

const FREE: u32 = u32::MAX;

impl Weld {
    /// The index of a point, new or known. -0 equals 0, NaN equals itself.
    #[inline]
    fn index(&mut self, p: Point) -> u32 {
        // Adding 0 turns -0 into 0.
        let p = p.map(|c| c + 0.0);
        if self.points.len() * 2 >= self.slots.len() {
            self.grow();
        }
        let mask = self.slots.len() - 1;
        let mut slot = hash(p) & mask;
        loop {
            match self.slots[slot] {
                FREE => {
                    let index = self.points.len() as u32;
                    self.slots[slot] = index;
                    self.points.push(p);
                    return index;
                }
                index => {
                    let known = self.points[index as usize];
                    if known.map(f64::to_bits) == p.map(f64::to_bits) {
                        return index;
                    }
                }
            }
            slot = (slot + 1) & mask;
        }
    }

    /// Makes room for the vertices that a closed surface of so many triangles
    /// has: half as many.
    fn expect(&mut self, triangles: usize) {
        self.points.reserve(triangles / 2 + 8);
        self.resize((triangles + 16).next_power_of_two());
    }

    #[cold]
    fn grow(&mut self) {
        self.resize((self.slots.len() * 2).max(1024));
    }

    fn resize(&mut self, size: usize) {
        self.slots = vec![FREE; size];
        for (index, &p) in self.points.iter().enumerate() {
            let mut slot = hash(p) & (size - 1);
            while self.slots[slot] != FREE {
                slot = (slot + 1) & (size - 1);
            }
            self.slots[slot] = index as u32;
        }
    }
}

fn hash(p: Point) -> usize {
    let mut h = 0u64;
    for c in p {
        h = (h.rotate_left(23) ^ c.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        h ^= h >> 32;
    }
    h as usize
}

struct Contents {
    weld: Weld,
    /// Three indices for each triangle.
    corners: Vec<u32>,
    /// Where the first corner that is not finite is.
    first_invalid: Option<Place>,
    notes: Vec<String>,
}

impl Contents {
    #[inline]
    fn push(&mut self, p: Point, place: impl FnOnce() -> Place) {
        if !p.iter().all(|c| c.is_finite()) && self.first_invalid.is_none() {
            self.first_invalid = Some(place());
        }
        let index = self.weld.index(p);
        self.corners.push(index);
    }
}

fn read(bytes: &[u8]) -> Result<Contents, ReadError> {
    let mut out = Contents {
        weld: Weld::default(),
        corners: Vec::new(),
        first_invalid: None,
        notes: Vec::new(),
    };
    let text = scan::without_bom(bytes);
    let solid = scan::first_word(&text[..text.len().min(512)]).eq_ignore_ascii_case(b"solid");
    let printable = |b: &u8| *b >= b' ' || matches!(b, b'\t'..=b'\r');
    if solid && !looks_binary(bytes) && text.iter().take(1024).all(printable) {
        read_text(text, &mut out)?;
    } else {
        read_binary(bytes, &mut out)?;
    }
    if out.corners.is_empty() {
        return Err(ReadError::Nothing {
            what: "triangles",
            format: "STL",
        });
    }
    Ok(out)
}

fn read_binary(bytes: &[u8], out: &mut Contents) -> Result<(), ReadError> {
    let Some(count) = announced(bytes) else {
        return Err(ReadError::Malformed {
            place: Place::Byte(0),
            what: format!(
                "not an STL file: no `solid` at the start, and {} bytes where a binary header has {HEADER}",
                bytes.len()
            ),
        });
    };
    let records = bytes[HEADER..].chunks_exact(RECORD);
    let found = records.len() as u64;
    if found < count {
        return Err(ReadError::Truncated {
            what: "triangles".into(),
            expected: count,
            found,
        });
    }
    check_count("triangle corners", count * 3)?;
    let beyond = bytes.len() as u64 - HEADER as u64 - count * RECORD as u64;
    if beyond >= RECORD as u64 {
        return Err(ReadError::Malformed {
            place: Place::Byte(80),
            what: format!("{count} triangles announced, but there are bytes for {found}"),
        });
    }
    if beyond > 0 {
        let note = format!("{beyond} bytes after the last triangle were not read.");
        out.notes.push(note);
    }
    out.corners.reserve_exact(count as usize * 3);
    out.weld.expect(count as usize);
    for (r, record) in records.enumerate() {
        for corner in record[12..48].chunks_exact(12) {
            let mut p = [0.0; 3];
            for (c, data) in p.iter_mut().zip(corner.chunks_exact(4)) {
                let data = data.first_chunk::<4>().copied().unwrap_or_default();
                *c = f64::from(f32::from_le_bytes(data));
            }
            out.push(p, || Place::Record(r as u64));
        }
    }
    Ok(())
}

fn read_text(bytes: &[u8], out: &mut Contents) -> Result<(), ReadError> {
    let mut words = Stream::new(bytes, false);
    let mut open = false;
    let mut in_facet = 0usize;
    while let Some((place, word)) = words.next() {
        // No keyword is longer than eight letters: nine tell a longer word.
        let mut keyword = [0; 9];
        let length = word.len().min(keyword.len());
        keyword[..length].copy_from_slice(&word[..length]);
        keyword.make_ascii_lowercase();
        match &keyword[..length] {
            b"solid" => {
                open = true;
                words.skip_line();
            }
            b"endsolid" => {
                open = false;
                words.skip_line();
            }
            b"facet" => {
                in_facet = 0;
                // `normal` and its numbers: found again from the corners.
                words.skip_line();
            }
            b"vertex" => {
                let mut p = [0.0; 3];
                for c in &mut p {
                    let (place, word) = words.next().ok_or_else(|| cut(out))?;
                    *c = scan::number(word)
                        .ok_or_else(|| scan::not_a("a coordinate", place, word))?;
                }
                let line = words.line();
                out.push(p, || Place::Line(line));
                in_facet += 1;
            }
            b"endfacet" => {
                if in_facet != 3 {
                    return Err(ReadError::Malformed {
                        place,
                        what: format!("a facet of {in_facet} vertices: STL has 3"),
                    });
                }
                in_facet = 0;
            }
            b"outer" | b"loop" | b"endloop" => {}
            _ => return Err(scan::not_a("a keyword of STL", place, word)),
        }
    }
    if open || in_facet != 0 {
        return Err(cut(out));
    }
    Ok(())
}

/// A text file without its end.
fn cut(out: &Contents) -> ReadError {
    ReadError::Missing {
        what: format!(
            "`endsolid` at the end, after {} triangles: the file was cut off",
            out.corners.len() / 3
        ),
    }
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let contents = read(bytes)?;
    let mut parts = Parts::new(CloudFormat::Stl);
    parts.points = contents.weld.points;
    parts.report.faces_ignored = Some(contents.corners.len() / 3);
    parts.report.notes = contents.notes;
    let place = contents.first_invalid.unwrap_or(Place::Byte(0));
    parts.finish(options, "triangles", |_| place)
}

pub fn read_mesh(bytes: &[u8]) -> Result<PolygonMesh, ReadError> {
    let contents = read(bytes)?;
    let place = contents.first_invalid.unwrap_or(Place::Byte(0));
    check_finite(&contents.weld.points, |_| place)?;
    let ends = 0..=contents.corners.len() / 3;
    let starts = ends.map(|f| u32::try_from(3 * f)).collect::<Result<_, _>>();
    Ok(PolygonMesh {
        vertices: contents.weld.points,
        starts: starts.map_err(|_| ReadError::TooMany {
            what: "triangle corners",
            count: contents.corners.len() as u64,
            limit: u64::from(u32::MAX),
        })?,
        corners: contents.corners,
    })
}

/// Writes triangles; polygons are fanned from their first corner.
pub fn write_mesh<W: Write>(
    writer: &mut W,
    mesh: &PolygonMesh,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let fits = |p: &Point| p.iter().all(|&c| !c.is_finite() || (c as f32).is_finite());
    if let Some(i) = mesh.vertices.iter().position(|p| !fits(p)) {
        return Err(WriteError::Unsupported {
            format: "STL",
            what: format!("the coordinates {:?} of vertex {i}", mesh.vertices[i]),
            remedy: "write PLY, which has 64-bit floats",
        });
    }
    let count: usize = mesh.faces().map(|f| f.len().saturating_sub(2)).sum();
    let Ok(count) = u32::try_from(count) else {
        return Err(WriteError::Unsupported {
            format: "STL",
            what: format!("{count} triangles"),
            remedy: "write PLY",
        });
    };
    let triangles = mesh
        .faces()
        .flat_map(|face| (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]))
        .map(|t| t.map(|v| mesh.vertices[v as usize]));
    let mut out = Buffer::new(writer, options);
    if options.ascii {
        out.text("solid powercrust\n");
        for t in triangles {
            out.text("facet normal ");
            write_words(&mut out, normal(t));
            out.text("\nouter loop\n");
            for p in t {
                out.text("vertex ");
                out.triple(p);
                out.text("\n");
            }
            out.text("endloop\nendfacet\n");
            out.record()?;
        }
        out.text("endsolid powercrust\n");
        return out.finish();
    }
    let title = comment_lines(options).next().unwrap_or("powercrust");
    let mut header = [b' '; 80];
    // Never `solid` first: that would look like text.
    let title = title.as_bytes();
    let title = if title.len() >= 5 && title[..5].eq_ignore_ascii_case(b"solid") {
        b"powercrust"
    } else {
        title
    };
    let length = title.len().min(80);
    header[..length].copy_from_slice(&title[..length]);
    out.bytes.extend_from_slice(&header);
    out.bytes.extend_from_slice(&count.to_le_bytes());
    for t in triangles {
        let mut record = [0u8; RECORD];
        let numbers = normal(t)
            .into_iter()
            .chain(t.into_iter().flatten().map(|c| c as f32));
        for (slot, c) in record.chunks_exact_mut(4).zip(numbers) {
            slot.copy_from_slice(&c.to_le_bytes());
        }
        out.bytes.extend_from_slice(&record);
        out.record()?;
    }
    out.finish()
}

fn write_words<W: Write>(out: &mut Buffer<W>, n: [f32; 3]) {
    for (k, c) in n.into_iter().enumerate() {
        if k > 0 {
            out.text(" ");
        }
        out.number32(c);
    }
}

/// The unit normal; zero for a triangle without area.
fn normal([a, b, c]: [Point; 3]) -> [f32; 3] {
    let n = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
    let length = vec3::norm(n);
    if length > 0.0 && length.is_finite() {
        vec3::scale(n, 1.0 / length).map(|c| c as f32)
    } else {
        [0.0; 3]
    }
}
