//! PLY out: meshes, medial axes, balls.

use super::super::attributes::{Attribute, AttributeValues, MeshAttributes, WriteOptions};
use super::super::buffer::{comment_lines, Buffer};
use super::super::error::WriteError;
use crate::axis::Structure;
use crate::geom::{Ball, Side};
use crate::mesh::PolygonMesh;
use crate::pipeline::PolarBall;
use crate::simplify::Contact;
use crate::surface::{PowerShape, NONE};
use std::io::Write;

/// A PLY file being written: numbers go out as text or little-endian.
struct Ply<'w, W: Write> {
    out: Buffer<'w, W>,
    ascii: bool,
    float32: bool,
    /// Whether a blank is due before the next number of a text record.
    inside: bool,
}

impl<'w, W: Write> Ply<'w, W> {
    fn new(writer: &'w mut W, options: &WriteOptions) -> Ply<'w, W> {
        let mut out = Buffer::new(writer, options);
        out.text("ply\nformat ");
        out.text(if options.ascii {
            "ascii 1.0\n"
        } else {
            "binary_little_endian 1.0\n"
        });
        for line in comment_lines(options) {
            out.text(&format!("comment {line}\n"));
        }
        Ply {
            out,
            ascii: options.ascii,
            float32: options.float32,
            inside: false,
        }
    }

    fn element(&mut self, name: &str, count: usize) {
        self.out.text(&format!("element {name} {count}\n"));
    }

    fn properties(&mut self, kind: &str, names: &[&str]) {
        for name in names {
            self.out.text("property ");
            self.out.text(kind);
            self.out.text(" ");
            // A blank in a name would break the header.
            let word = |c: char| {
                if c.is_whitespace() || c.is_control() {
                    '_'
                } else {
                    c
                }
            };
            let name: String = name.chars().map(word).collect();
            self.out.text(if name.is_empty() { "_" } else { &name });
            self.out.text("\n");
        }
    }

    fn attribute_properties(&mut self, attributes: &[Attribute]) {
        for a in attributes {
            let kind = match a.values {
                AttributeValues::Byte(_) => "uchar",
                AttributeValues::Int(_) => "int",
                AttributeValues::Float(_) => self.real_kind(),
            };
            self.properties(kind, &[a.name]);
        }
    }

    fn real_kind(&self) -> &'static str {
        if self.float32 {
            "float"
        } else {
            "double"
        }
    }

    fn end_header(&mut self) {
        self.out.text("end_header\n");
    }

    #[inline]
    fn gap(&mut self) {
        if self.inside {
            self.out.bytes.push(b' ');
        }
        self.inside = true;
    }

    #[inline]
    fn real(&mut self, value: f64) {
        if self.ascii {
            self.gap();
            if self.float32 {
                self.out.number32(value as f32);
            } else {
                self.out.number(value);
            }
        } else if self.float32 {
            let bytes = (value as f32).to_le_bytes();
            self.out.bytes.extend_from_slice(&bytes);
        } else {
            self.out.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    fn ball(&mut self, ball: &Ball) {
        for c in ball.centre {
            self.real(c);
        }
        self.real(ball.radius);
    }

    fn contact(&mut self, contact: Option<&Contact>) {
        if let Some(c) = contact {
            for length in [c.diameter, c.circumradius, c.spacing] {
                self.real(length);
            }
        }
    }

    #[inline]
    fn float(&mut self, value: f32) {
        if self.ascii {
            self.gap();
            self.out.number32(value);
        } else {
            self.out.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    #[inline]
    fn byte(&mut self, value: u8) {
        if self.ascii {
            self.gap();
            self.out.integer(i64::from(value));
        } else {
            self.out.bytes.push(value);
        }
    }

    /// A 32-bit index; -1 as `int` for [`NONE`].
    #[inline]
    fn index(&mut self, value: u32) {
        if self.ascii {
            self.gap();
            let value = if value == NONE { -1 } else { i64::from(value) };
            self.out.integer(value);
        } else {
            self.out.bytes.extend_from_slice(&value.to_le_bytes());
        }
    }

    fn attributes(&mut self, attributes: &[Attribute], record: usize) {
        for a in attributes {
            match a.values {
                AttributeValues::Byte(v) => self.byte(v[record]),
                AttributeValues::Float(v) => self.real(v[record]),
                AttributeValues::Int(v) if self.ascii => {
                    self.gap();
                    self.out.integer(i64::from(v[record]));
                }
                AttributeValues::Int(v) => {
                    self.out.bytes.extend_from_slice(&v[record].to_le_bytes());
                }
            }
        }
    }

    #[inline]
    fn end(&mut self) -> Result<(), WriteError> {
        if self.ascii {
            self.out.bytes.push(b'\n');
        }
        self.inside = false;
        self.out.record()
    }
}

/// Ids are written as `int`, as most readers expect; they must fit.
fn check_ids(name: &str, ids: impl IntoIterator<Item = u32>) -> Result<(), WriteError> {
    match ids
        .into_iter()
        .find(|&id| id != NONE && id > i32::MAX as u32)
    {
        None => Ok(()),
        Some(id) => Err(WriteError::Unsupported {
            format: "PLY",
            what: format!("the {name} {id} as int"),
            remedy: "leave this attribute out",
        }),
    }
}

/// Refuses what 32 bits cannot hold.
fn check_range(points: &[[f64; 3]], options: &WriteOptions) -> Result<(), WriteError> {
    if !options.float32 {
        return Ok(());
    }
    let fits = |p: &[f64; 3]| p.iter().all(|&c| !c.is_finite() || (c as f32).is_finite());
    match points.iter().position(|p| !fits(p)) {
        None => Ok(()),
        Some(i) => Err(WriteError::Unsupported {
            format: "PLY with 32-bit floats",
            what: format!("the coordinates {:?} of vertex {i}", points[i]),
            remedy: "write 64-bit floats",
        }),
    }
}

pub fn write_mesh<W: Write>(
    writer: &mut W,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    check_range(&mesh.vertices, options)?;
    check_ids("sample", attributes.samples.into_iter().flatten().copied())?;
    let largest = mesh.faces().map(<[u32]>::len).max().unwrap_or(0);
    let small = largest <= usize::from(u8::MAX);
    let int = mesh.vertices.len() <= i32::MAX as usize;
    let mut ply = Ply::new(writer, options);
    ply.element("vertex", mesh.vertices.len());
    ply.properties(ply.real_kind(), &["x", "y", "z"]);
    if attributes.normals.is_some() {
        ply.properties("float", &["nx", "ny", "nz"]);
    }
    if attributes.colours.is_some() {
        ply.properties("uchar", &["red", "green", "blue", "alpha"]);
    }
    if attributes.samples.is_some() {
        ply.properties("int", &["sample"]);
    }
    ply.attribute_properties(&attributes.vertices);
    ply.element("face", mesh.face_count());
    ply.properties(
        match (small, int) {
            (true, true) => "list uchar int",
            (true, false) => "list uchar uint",
            (false, true) => "list uint int",
            (false, false) => "list uint uint",
        },
        &["vertex_indices"],
    );
    ply.attribute_properties(&attributes.faces);
    ply.end_header();
    for (i, p) in mesh.vertices.iter().enumerate() {
        for &c in p {
            ply.real(c);
        }
        if let Some(normals) = attributes.normals {
            for c in normals[i] {
                ply.float(c);
            }
        }
        if let Some(colours) = attributes.colours {
            for c in colours[i] {
                ply.byte(c);
            }
        }
        if let Some(samples) = attributes.samples {
            ply.index(samples[i]);
        }
        ply.attributes(&attributes.vertices, i);
        ply.end()?;
    }
    for (f, face) in mesh.faces().enumerate() {
        if small {
            ply.byte(face.len() as u8);
        } else {
            ply.index(face.len() as u32);
        }
        for &corner in face {
            ply.index(corner);
        }
        ply.attributes(&attributes.faces, f);
        ply.end()?;
    }
    ply.out.finish()
}

/// Vertices with radius, ball id, label and what the samples on them span,
/// edges, triangles, tetrahedra, balls of the other side.
pub fn write_axis<W: Write>(
    writer: &mut W,
    shape: &PowerShape,
    parts: Option<&Structure>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let all = shape.balls.iter().chain(&shape.others);
    let centres: Vec<_> = all.map(|b| b.centre).collect();
    let span = ["diameter", "circumradius", "spacing"];
    check_range(&centres, options)?;
    let mut ply = Ply::new(writer, options);
    ply.element("vertex", shape.balls.len());
    ply.properties(ply.real_kind(), &["x", "y", "z", "radius"]);
    if !shape.ids.is_empty() {
        ply.properties("uint", &["ball"]);
    }
    if !shape.sides.is_empty() {
        ply.properties("uchar", &["label"]);
    }
    if !shape.contacts.is_empty() {
        ply.properties(ply.real_kind(), &span);
    }
    if parts.is_some() {
        ply.properties(ply.real_kind(), &["thickness"]);
        ply.properties("int", &["junction"]);
    }
    ply.element("edge", shape.edges.len());
    ply.properties("int", &["vertex1", "vertex2"]);
    if parts.is_some() {
        ply.properties("int", &["seam", "rim", "curve"]);
    }
    ply.element("face", shape.triangles.len());
    ply.properties("list uchar int", &["vertex_indices"]);
    if parts.is_some() {
        ply.properties("int", &["sheet"]);
    }
    if !shape.tetrahedra.is_empty() {
        ply.element("tetrahedron", shape.tetrahedra.len());
        ply.properties("list uchar int", &["vertex_indices"]);
    }
    if !shape.others.is_empty() {
        ply.element("other", shape.others.len());
        ply.properties(ply.real_kind(), &["x", "y", "z", "radius"]);
        if !shape.other_contacts.is_empty() {
            ply.properties(ply.real_kind(), &span);
        }
    }
    ply.end_header();
    for (i, ball) in shape.balls.iter().enumerate() {
        ply.ball(ball);
        if let Some(&id) = shape.ids.get(i) {
            ply.index(id);
        }
        if let Some(&side) = shape.sides.get(i) {
            ply.byte(side as u8);
        }
        ply.contact(shape.contacts.get(i));
        if let Some(parts) = parts {
            ply.real(2.0 * ball.radius);
            ply.index(parts.junction_of[i]);
        }
        ply.end()?;
    }
    for (e, &[a, b]) in shape.edges.iter().enumerate() {
        ply.index(a);
        ply.index(b);
        if let Some(parts) = parts {
            for of in [&parts.seam_of, &parts.rim_of, &parts.curve_of] {
                ply.index(of[e]);
            }
        }
        ply.end()?;
    }
    let triangles = shape.triangles.iter().map(|t| &t[..]);
    let tetrahedra = shape.tetrahedra.iter().map(|t| &t[..]);
    for (t, corners) in triangles.chain(tetrahedra).enumerate() {
        ply.byte(corners.len() as u8);
        for &c in corners {
            ply.index(c);
        }
        if let Some(&sheet) = parts.and_then(|parts| parts.sheet_of.get(t)) {
            ply.index(sheet);
        }
        ply.end()?;
    }
    for (i, ball) in shape.others.iter().enumerate() {
        ply.ball(ball);
        ply.contact(shape.other_contacts.get(i));
        ply.end()?;
    }
    ply.out.finish()
}

pub fn write_balls<W: Write>(
    writer: &mut W,
    balls: &[PolarBall],
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let centres: Vec<_> = balls.iter().map(|b| b.ball.centre).collect();
    check_range(&centres, options)?;
    check_ids("sample", balls.iter().map(|b| b.sample))?;
    let mut ply = Ply::new(writer, options);
    ply.element("vertex", balls.len());
    ply.properties(ply.real_kind(), &["x", "y", "z", "radius"]);
    ply.properties("uchar", &["label"]);
    ply.properties("int", &["sample"]);
    ply.end_header();
    for b in balls {
        for c in b.ball.centre {
            ply.real(c);
        }
        ply.real(b.ball.radius);
        ply.byte(match b.side {
            Side::Inner => 0,
            Side::Outer => 1,
        });
        ply.index(b.sample);
        ply.end()?;
    }
    ply.out.finish()
}
