//! JSON for scripts: meshes and medial axes as plain lists of numbers.

use super::attributes::{Attribute, AttributeValues, MeshAttributes, WriteOptions};
use super::buffer::Buffer;
use super::error::{Place, ReadError, WriteError};
use super::sink::{check_count, check_finite, FaceSink};
use crate::axis::Structure;
use crate::geom::Ball;
use crate::mesh::PolygonMesh;
use crate::simplify::{Contact, Touching};
use crate::surface::{PowerShape, NONE};
use serde::de::{Deserialize, DeserializeOwned, DeserializeSeed, Deserializer, SeqAccess, Visitor};
use std::fmt;
use std::io::Write;

#[derive(serde::Deserialize)]
struct MeshFile {
    vertices: Vec<[f64; 3]>,
    #[serde(default)]
    faces: Corners,
}

/// Lists of indices one after the other: a list for each face would take many
/// times the memory of the file.
#[derive(Default)]
struct Corners {
    indices: Vec<i64>,
    /// Where each list ends.
    ends: Vec<usize>,
}

impl<'de> Deserialize<'de> for Corners {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Corners, D::Error> {
        let mut all = Corners::default();
        source.deserialize_seq(Faces(&mut all))?;
        Ok(all)
    }
}

/// Reads the list of faces.
struct Faces<'a>(&'a mut Corners);

impl<'de> Visitor<'de> for Faces<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut faces: A) -> Result<(), A::Error> {
        while faces.next_element_seed(Face(self.0))?.is_some() {}
        Ok(())
    }
}

/// Reads one face.
struct Face<'a>(&'a mut Corners);

impl<'de> DeserializeSeed<'de> for Face<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<(), D::Error> {
        source.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Face<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut corners: A) -> Result<(), A::Error> {
        while let Some(corner) = corners.next_element()? {
            self.0.indices.push(corner);
        }
        self.0.ends.push(self.0.indices.len());
        Ok(())
    }
}

#[derive(serde::Deserialize)]
struct AxisFile {
    balls: Vec<[f64; 4]>,
    #[serde(default)]
    ids: Vec<u32>,
    #[serde(default)]
    edges: Vec<[u32; 2]>,
    #[serde(default)]
    triangles: Vec<[u32; 3]>,
    #[serde(default)]
    tetrahedra: Vec<[u32; 4]>,
    #[serde(default)]
    sides: Vec<u8>,
    #[serde(default)]
    contacts: Vec<[f64; 3]>,
    #[serde(default)]
    touching: Corners,
    #[serde(default)]
    others: Vec<[f64; 4]>,
    #[serde(default)]
    other_contacts: Vec<[f64; 3]>,
}

fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, ReadError> {
    serde_json::from_slice(super::scan::without_bom(bytes)).map_err(|e| {
        let text = e.to_string();
        ReadError::Malformed {
            place: Place::Column {
                line: e.line() as u64,
                column: e.column() as u64,
            },
            what: text.split(" at line ").next().unwrap_or(&text).into(),
        }
    })
}

pub fn read_mesh(bytes: &[u8]) -> Result<PolygonMesh, ReadError> {
    let file: MeshFile = parse(bytes)?;
    let count = file.vertices.len() as u64;
    check_count("vertices", count)?;
    if count == 0 {
        return Err(ReadError::Nothing {
            what: "vertices",
            format: "JSON",
        });
    }
    check_finite(&file.vertices, |i| Place::Record(i as u64))?;
    let mut faces = FaceSink::keeping();
    let mut start = 0;
    for (f, &end) in file.faces.ends.iter().enumerate() {
        let face = &file.faces.indices[start..end];
        faces.push(face, count, Place::Record(f as u64))?;
        start = end;
    }
    let mut mesh = faces.mesh.unwrap_or_default();
    mesh.vertices = file.vertices;
    Ok(mesh)
}

/// The axis without a check of its indices.
pub fn read_axis(bytes: &[u8]) -> Result<PowerShape, ReadError> {
    let file: AxisFile = parse(bytes)?;
    let ball = |(i, &[x, y, z, r]): (usize, &[f64; 4])| {
        let place = Place::Record(i as u64);
        check_finite(&[[x, y, z]], |_| place)?;
        super::ply::ball([x, y, z], r, place)
    };
    let balls = |list: &[[f64; 4]]| -> Result<Vec<Ball>, ReadError> {
        list.iter().enumerate().map(ball).collect()
    };
    let contact =
        |(i, numbers): (usize, &[f64; 3])| super::axis::contact(*numbers, Place::Record(i as u64));
    let contacts = |list: &[[f64; 3]]| -> Result<Vec<Contact>, ReadError> {
        list.iter().enumerate().map(contact).collect()
    };
    let side = |(i, label): (usize, &u8)| super::ply::side(f64::from(*label), i);
    let mut touching = Touching::default();
    if !file.touching.ends.is_empty() {
        touching.starts = vec![0];
        touching
            .starts
            .extend(file.touching.ends.iter().map(|&e| e as u32));
        for &point in &file.touching.indices {
            touching
                .samples
                .push(u32::try_from(point).map_err(|_| ReadError::Malformed {
                    place: Place::Record(0),
                    what: format!("touching: {point} is no number of a point"),
                })?);
        }
    }
    Ok(PowerShape {
        balls: balls(&file.balls)?,
        ids: file.ids,
        edges: file.edges,
        triangles: file.triangles,
        tetrahedra: file.tetrahedra,
        sides: file
            .sides
            .iter()
            .enumerate()
            .map(side)
            .collect::<Result<_, _>>()?,
        contacts: contacts(&file.contacts)?,
        touching,
        others: balls(&file.others)?,
        other_contacts: contacts(&file.other_contacts)?,
    })
}

/// Writes a list, one item a line.
fn list<W: Write, T>(
    out: &mut Buffer<W>,
    name: &str,
    items: impl Iterator<Item = T>,
    mut item: impl FnMut(&mut Buffer<W>, T),
) -> Result<(), WriteError> {
    // A string cannot fail to become JSON.
    out.text(&serde_json::to_string(name).unwrap_or_default());
    out.text(":[");
    for (i, value) in items.enumerate() {
        out.text(if i == 0 { "\n" } else { ",\n" });
        item(out, value);
        out.record()?;
    }
    out.text("]");
    Ok(())
}

/// JSON knows no NaN and no infinity: they become null.
fn real<W: Write>(out: &mut Buffer<W>, value: f64) {
    if value.is_finite() {
        out.number(value);
    } else {
        out.text("null");
    }
}

fn reals<W: Write>(out: &mut Buffer<W>, values: &[f64]) {
    for (k, &value) in values.iter().enumerate() {
        out.text(if k == 0 { "[" } else { "," });
        real(out, value);
    }
    out.text("]");
}

fn indices<W: Write>(out: &mut Buffer<W>, values: &[u32]) {
    out.text("[");
    for (k, &value) in values.iter().enumerate() {
        if k > 0 {
            out.text(",");
        }
        out.integer(i64::from(value));
    }
    out.text("]");
}

fn attributes<W: Write>(
    out: &mut Buffer<W>,
    name: &str,
    attributes: &[Attribute],
) -> Result<(), WriteError> {
    if attributes.is_empty() {
        return Ok(());
    }
    out.text(&format!(",\n\"{name}\":{{"));
    for (i, a) in attributes.iter().enumerate() {
        out.text(if i == 0 { "\n" } else { ",\n" });
        match a.values {
            AttributeValues::Byte(v) => list(out, a.name, v.iter(), |o, &v| o.integer(v.into()))?,
            AttributeValues::Int(v) => list(out, a.name, v.iter(), |o, &v| o.integer(v.into()))?,
            AttributeValues::Float(v) => list(out, a.name, v.iter(), |o, &v| real(o, v))?,
        }
    }
    out.text("}");
    Ok(())
}

pub fn write_mesh<W: Write>(
    writer: &mut W,
    mesh: &PolygonMesh,
    with: &MeshAttributes,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let mut out = Buffer::new(writer, options);
    out.text("{");
    list(&mut out, "vertices", mesh.vertices.iter(), |o, p| {
        reals(o, p)
    })?;
    out.text(",\n");
    list(&mut out, "faces", mesh.faces(), indices)?;
    if let Some(normals) = with.normals {
        out.text(",\n");
        list(&mut out, "normals", normals.iter(), |o, n| {
            reals(o, &n.map(f64::from))
        })?;
    }
    if let Some(colours) = with.colours {
        out.text(",\n");
        list(&mut out, "colours", colours.iter(), |o, c| {
            indices(o, &c.map(u32::from))
        })?;
    }
    if let Some(samples) = with.samples {
        out.text(",\n");
        list(&mut out, "samples", samples.iter(), |o, &s| {
            o.integer(if s == NONE { -1 } else { i64::from(s) })
        })?;
    }
    attributes(&mut out, "vertex_attributes", &with.vertices)?;
    attributes(&mut out, "face_attributes", &with.faces)?;
    out.text("}\n");
    out.finish()
}

pub fn write_axis<W: Write>(
    writer: &mut W,
    shape: &PowerShape,
    parts: Option<&Structure>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let mut out = Buffer::new(writer, options);
    out.text("{");
    list(&mut out, "balls", shape.balls.iter(), |o, b| {
        let [x, y, z] = b.centre;
        reals(o, &[x, y, z, b.radius]);
    })?;
    out.text(",\n");
    list(&mut out, "ids", shape.ids.iter(), |o, &i| {
        o.integer(i64::from(i))
    })?;
    out.text(",\n");
    list(&mut out, "edges", shape.edges.iter(), |o, e| indices(o, e))?;
    out.text(",\n");
    list(&mut out, "triangles", shape.triangles.iter(), |o, t| {
        indices(o, t)
    })?;
    out.text(",\n");
    list(&mut out, "tetrahedra", shape.tetrahedra.iter(), |o, t| {
        indices(o, t)
    })?;
    if !shape.sides.is_empty() {
        out.text(",\n");
        list(&mut out, "sides", shape.sides.iter(), |o, &s| {
            o.integer(s as i64)
        })?;
    }
    contacts(&mut out, "contacts", &shape.contacts)?;
    if !shape.touching.starts.is_empty() {
        out.text(",\n");
        let balls = 0..shape.balls.len() as u32;
        list(&mut out, "touching", balls, |o, b| {
            indices(o, shape.touching.at(b))
        })?;
    }
    if !shape.others.is_empty() {
        out.text(",\n");
        list(&mut out, "others", shape.others.iter(), |o, b| {
            let [x, y, z] = b.centre;
            reals(o, &[x, y, z, b.radius]);
        })?;
    }
    contacts(&mut out, "other_contacts", &shape.other_contacts)?;
    if let Some(parts) = parts {
        structure(&mut out, parts)?;
    }
    out.text("}\n");
    out.finish()
}

/// The diameter, circumradius and spacing of the samples on each ball.
fn contacts<W: Write>(
    out: &mut Buffer<W>,
    name: &str,
    contacts: &[Contact],
) -> Result<(), WriteError> {
    if contacts.is_empty() {
        return Ok(());
    }
    out.text(",\n");
    list(out, name, contacts.iter(), |o, c| {
        reals(o, &[c.diameter, c.circumradius, c.spacing])
    })
}

/// The parts, and for each simplex the number of its part.
fn structure<W: Write>(out: &mut Buffer<W>, parts: &Structure) -> Result<(), WriteError> {
    let told = serde_json::to_string(parts).unwrap_or_default();
    out.text(",\n\"structure\":");
    out.text(told.strip_suffix('}').unwrap_or("{"));
    let lists = [
        ("sheet_of_triangle", &parts.sheet_of),
        ("seam_of_edge", &parts.seam_of),
        ("rim_of_edge", &parts.rim_of),
        ("curve_of_edge", &parts.curve_of),
        ("junction_of_ball", &parts.junction_of),
    ];
    for (name, numbers) in lists {
        out.text(",\n");
        list(out, name, numbers.iter(), |o, &n| {
            o.integer(if n == NONE { -1 } else { i64::from(n) })
        })?;
    }
    out.text("}");
    Ok(())
}
