//! GLB out: glTF 2.0 in one binary file.
//!
//! The format has only 32-bit floats, so the positions are taken from the
//! middle of the mesh, which is itself a triple of 32-bit numbers and becomes
//! the translation of the one node: a scan far from the origin keeps its
//! detail. (A mesh whose coordinates are 32-bit numbers already is written as
//! it is, with the translation 0.) Axes are left as they are (glTF says that y is up). Colours are
//! light intensities there: bytes, which follow the sRGB curve, become linear
//! 16-bit numbers. Polygons are cut into triangles as the checker cuts them.

use super::attributes::{MeshAttributes, WriteOptions};
use super::buffer::{comment_lines, Buffer};
use super::error::WriteError;
use crate::geom::{Bounds, Point};
use crate::mesh::{triangles, PolygonMesh};
use serde_json::{json, Value};
use std::io::Write;

/// The kinds of components, by glTF's numbers.
const UINT16: u32 = 5123;
const UINT32: u32 = 5125;
const FLOAT: u32 = 5126;

/// What a buffer view is for, by glTF's numbers.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The middle that positions are counted from: the origin where all vertices
/// are 32-bit numbers as they are, so that those are not rounded again.
fn middle(vertices: &[Point]) -> Point {
    let single = |&c: &f64| f64::from(c as f32) == c;
    if vertices.iter().flatten().all(single) {
        return [0.0; 3];
    }
    match Bounds::of(vertices) {
        Some(b) => std::array::from_fn(|k| f64::from((b.min[k] / 2.0 + b.max[k] / 2.0) as f32)),
        None => [0.0; 3],
    }
}

fn local(p: &Point, middle: &Point) -> [f32; 3] {
    std::array::from_fn(|k| (p[k] - middle[k]) as f32)
}

/// The vertices as the file holds them: middle plus local position.
pub fn as_written(vertices: &[Point]) -> Vec<Point> {
    let middle = middle(vertices);
    let whole = |p: &Point| {
        let local = local(p, &middle);
        std::array::from_fn(|k| middle[k] + f64::from(local[k]))
    };
    vertices.iter().map(whole).collect()
}

/// Views and accessors, as they are added one after the other.
#[derive(Default)]
struct Layout {
    views: Vec<Value>,
    accessors: Vec<Value>,
    size: u64,
}

impl Layout {
    /// Adds a table of `count` rows of `bytes` bytes; its number.
    fn add(&mut self, target: u32, bytes: u64, count: usize, mut accessor: Value) -> usize {
        let length = bytes * count as u64;
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.size, "byteLength": length, "target": target,
        }));
        self.size += length;
        accessor["bufferView"] = json!(self.views.len() - 1);
        accessor["count"] = json!(count);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

pub fn write_mesh<W: Write>(
    writer: &mut W,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let unsupported = |what: String, remedy| WriteError::Unsupported {
        format: "GLB",
        what,
        remedy,
    };
    let triangles = triangles(mesh);
    if triangles.is_empty() {
        return Err(unsupported("a mesh without faces".into(), "write PLY"));
    }
    let middle = middle(&mesh.vertices);
    let locals = || mesh.vertices.iter().map(|p| local(p, &middle));
    let finite = |p: &[f32; 3]| p.iter().all(|c| c.is_finite());
    if let Some(i) = locals().position(|p| !finite(&p)) {
        return Err(unsupported(
            format!("the coordinates {:?} of vertex {i}", mesh.vertices[i]),
            "write PLY, which has 64-bit floats",
        ));
    }
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for p in locals() {
        for k in 0..3 {
            min[k] = min[k].min(p[k]);
            max[k] = max[k].max(p[k]);
        }
    }

    let count = mesh.vertices.len();
    let mut layout = Layout::default();
    let mut parts = json!({});
    let positions = json!({ "componentType": FLOAT, "type": "VEC3", "min": min, "max": max });
    parts["POSITION"] = json!(layout.add(VERTICES, 12, count, positions));
    if attributes.normals.is_some() {
        let normals = json!({ "componentType": FLOAT, "type": "VEC3" });
        parts["NORMAL"] = json!(layout.add(VERTICES, 12, count, normals));
    }
    if attributes.colours.is_some() {
        let colours = json!({ "componentType": UINT16, "normalized": true, "type": "VEC4" });
        parts["COLOR_0"] = json!(layout.add(VERTICES, 8, count, colours));
    }
    let indices = json!({ "componentType": UINT32, "type": "SCALAR" });
    let indices = layout.add(INDICES, 4, triangles.len() * 3, indices);
    let comments: Vec<&str> = comment_lines(options).collect();
    let head = json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("powercrust ", env!("CARGO_PKG_VERSION")),
            "extras": { "comments": comments },
        },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "translation": middle }],
        "meshes": [{ "primitives": [{ "attributes": parts, "indices": indices }] }],
        "buffers": [{ "byteLength": layout.size }],
        "bufferViews": layout.views,
        "accessors": layout.accessors,
    });
    let mut head = head.to_string().into_bytes();
    head.resize(head.len().next_multiple_of(4), b' ');
    // Every table has rows of a multiple of four bytes.
    let body = layout.size;
    let total = 12 + 8 + head.len() as u64 + 8 + body;
    let Ok(total) = u32::try_from(total) else {
        return Err(unsupported(
            format!("{total} bytes"),
            "write PLY, or fewer faces",
        ));
    };

    let mut out = Buffer::new(writer, options);
    let word = |out: &mut Buffer<W>, w: u32| out.bytes.extend_from_slice(&w.to_le_bytes());
    out.text("glTF");
    word(&mut out, 2);
    word(&mut out, total);
    word(&mut out, head.len() as u32);
    out.text("JSON");
    out.bytes.extend_from_slice(&head);
    word(&mut out, body as u32);
    out.text("BIN\0");
    let normals = attributes.normals.into_iter().flatten().map(unit);
    for triple in locals().chain(normals) {
        for c in triple {
            out.bytes.extend_from_slice(&c.to_le_bytes());
        }
        out.record()?;
    }
    for colour in attributes.colours.into_iter().flatten() {
        for (k, &c) in colour.iter().enumerate() {
            let c = if k < 3 { linear(c) } else { u16::from(c) * 257 };
            out.bytes.extend_from_slice(&c.to_le_bytes());
        }
        out.record()?;
    }
    for t in triangles {
        for v in t {
            word(&mut out, v);
        }
        out.record()?;
    }
    out.finish()
}

/// Of length 1, as glTF demands.
fn unit(n: &[f32; 3]) -> [f32; 3] {
    let length = n.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
    match length > 0.0 && length.is_finite() {
        true => n.map(|c| (f64::from(c) / length) as f32),
        false => [0.0, 0.0, 1.0],
    }
}

/// The light intensity that a byte on the sRGB curve stands for.
fn linear(byte: u8) -> u16 {
    let c = f64::from(byte) / 255.0;
    let light = match c <= 0.04045 {
        true => c / 12.92,
        false => ((c + 0.055) / 1.055).powf(2.4),
    };
    (light * 65535.0).round() as u16
}
