//! Files in and out, on byte slices and writers, never on paths.
//!
//! Readers take a whole file in memory. They believe no count in a header
//! before comparing it with the bytes that are there, need memory of a small
//! multiple of the file, never panic, and say what they left out
//! ([`ReadReport`]) or why they stopped ([`ReadError`]).
//!
//! ```
//! use powercrust::io::{read_cloud, CloudFormat, ReadOptions};
//! let file = b"x,y,z,intensity\n0,0,0,7\n1,0,0,8\n0,1,0,9\n";
//! let cloud = read_cloud(file, CloudFormat::Text, &ReadOptions::default())?;
//! assert_eq!(cloud.points[1], [1.0, 0.0, 0.0]);
//! assert_eq!(cloud.scalars[0].values, [7.0, 8.0, 9.0]);
//! # Ok::<(), powercrust::io::ReadError>(())
//! ```

mod attributes;
mod axis;
mod buffer;
mod cloud;
mod columns;
mod error;
mod format;
mod glb;
mod json;
mod las;
mod npy;
mod obj;
mod off;
mod pcd;
mod ply;
mod scan;
mod sink;
mod stl;
mod text;

use std::io::Write;

pub use attributes::{Attribute, AttributeValues, MeshAttributes, WriteOptions};
pub use cloud::{Cloud, ReadOptions, ReadReport, ScalarColumn};
pub use error::{Place, ReadError, WriteError};
pub use format::{AxisFormat, CloudFormat, MeshFormat};

use crate::axis::Structure;
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use crate::pipeline::PolarBall;
use crate::surface::PowerShape;

/// Points from the bytes of a file. Of a mesh file the vertices are taken,
/// and [`ReadReport::faces_ignored`] says so.
///
/// # Errors
/// [`ReadError`] where the file is empty, cut off, not in this format, or has
/// no points; and for NaN or infinite coordinates unless
/// [`ReadOptions::skip_invalid`] drops them.
pub fn read_cloud(
    bytes: &[u8],
    format: CloudFormat,
    options: &ReadOptions,
) -> Result<Cloud, ReadError> {
    check_bytes(bytes)?;
    match format {
        CloudFormat::Ply => ply::read_cloud(bytes, options),
        CloudFormat::Obj => obj::read_cloud(bytes, options),
        CloudFormat::Off => off::read_cloud(bytes, options),
        CloudFormat::Text => text::read_cloud(bytes, options),
        CloudFormat::Stl => stl::read_cloud(bytes, options),
        CloudFormat::Npy => npy::read_cloud(bytes, options),
        CloudFormat::Pcd => pcd::read_cloud(bytes, options),
        CloudFormat::Las => las::read_cloud(bytes, options),
    }
}

/// A mesh with faces from the bytes of a file. STL corners with equal
/// coordinates become one vertex; other formats keep their vertices, used or
/// not. A file of points without faces gives a mesh without faces.
///
/// # Errors
/// As [`read_cloud`]; also for coordinates that are not finite, indices out of
/// range and faces of fewer than three corners.
pub fn read_mesh(bytes: &[u8], format: MeshFormat) -> Result<PolygonMesh, ReadError> {
    check_bytes(bytes)?;
    match format {
        MeshFormat::Ply => ply::read_mesh(bytes),
        MeshFormat::Obj => obj::read_mesh(bytes),
        MeshFormat::Off => off::read_mesh(bytes),
        MeshFormat::Stl => stl::read_mesh(bytes),
        MeshFormat::Json => json::read_mesh(bytes),
        MeshFormat::Glb => Err(ReadError::Unsupported {
            what: "GLB".into(),
            remedy: "it is only written; convert the file to PLY, OBJ or STL first",
        }),
    }
}

/// Writes a mesh. The writer need not be buffered: data goes out in pieces of
/// a few megabytes.
///
/// # Errors
/// [`WriteError`] where the writer fails, an attribute has the wrong length,
/// the mesh contradicts itself or does not fit the format (STL holds only
/// 32-bit floats).
pub fn write_mesh<W: Write>(
    writer: &mut W,
    format: MeshFormat,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    buffer::check_mesh(mesh, attributes)?;
    match format {
        MeshFormat::Ply => ply::write_mesh(writer, mesh, attributes, options),
        MeshFormat::Obj => obj::write_mesh(writer, mesh, attributes, options),
        MeshFormat::Off => off::write_mesh(writer, mesh, attributes, options),
        MeshFormat::Stl => stl::write_mesh(writer, mesh, options),
        MeshFormat::Json => json::write_mesh(writer, mesh, attributes, options),
        MeshFormat::Glb => glb::write_mesh(writer, mesh, attributes, options),
    }
}

/// The vertices as a reader of the file will have them: rounded to 32 bits or
/// to so many digits, where the format or the options ask for it.
pub fn as_written(format: MeshFormat, vertices: &[Point], options: &WriteOptions) -> Vec<Point> {
    let single = |p: &Point| p.map(|c| f64::from(c as f32));
    let digits = options.digits;
    let text = |p: &Point| p.map(|c| buffer::with_digits(c, digits));
    let all = |round: &dyn Fn(&Point) -> Point| vertices.iter().map(round).collect();
    match format {
        MeshFormat::Ply if options.float32 && options.ascii => {
            all(&|p| text(&single(p)).map(|c| f64::from(c as f32)))
        }
        MeshFormat::Ply if options.float32 => all(&single),
        MeshFormat::Stl if !options.ascii => all(&single),
        MeshFormat::Ply if !options.ascii => vertices.to_vec(),
        MeshFormat::Glb => glb::as_written(vertices),
        _ => all(&text),
    }
}

/// Writes a medial axis.
///
/// Which input points a ball touches goes into JSON only; what else the shape
/// has goes into all formats but OBJ, which holds no radii and no
/// tetrahedra.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_axis<W: Write>(
    writer: &mut W,
    format: AxisFormat,
    shape: &PowerShape,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    axis::write(writer, format, shape, None, options)
}

/// The same with the numbers of the parts each simplex belongs to: PLY has
/// them as `sheet` of faces, `seam`, `rim` and `curve` of edges and `junction`
/// of vertices, -1 for none, beside the `thickness` of each ball, its
/// diameter; JSON as lists under `structure`. `.ma` and OBJ have none.
///
/// # Errors
/// As [`write_mesh`]; also where the parts are those of another shape.
pub fn write_axis_parts<W: Write>(
    writer: &mut W,
    format: AxisFormat,
    shape: &PowerShape,
    parts: Option<&Structure>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    axis::write(writer, format, shape, parts, options)
}

/// A medial axis from the bytes of a file. Where the file has no ball ids,
/// [`PowerShape::ids`] counts from 0.
///
/// # Errors
/// As [`read_mesh`]; also for negative radii, and for OBJ, which has none.
pub fn read_axis(bytes: &[u8], format: AxisFormat) -> Result<PowerShape, ReadError> {
    check_bytes(bytes)?;
    axis::read(bytes, format)
}

/// Writes polar balls as PLY vertices: `x y z radius` as doubles, `label` as
/// uchar (0 inner, 1 outer), `sample` as int.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_balls<W: Write>(
    writer: &mut W,
    balls: &[PolarBall],
    options: &WriteOptions,
) -> Result<(), WriteError> {
    ply::write_balls(writer, balls, options)
}

/// Polar balls from a PLY file as [`write_balls`] makes it.
///
/// # Errors
/// As [`read_cloud`]; also for missing properties, negative radii and unknown
/// labels.
pub fn read_balls(bytes: &[u8]) -> Result<Vec<PolarBall>, ReadError> {
    check_bytes(bytes)?;
    ply::read_balls(bytes)
}

/// What is wrong whatever the format.
fn check_bytes(bytes: &[u8]) -> Result<(), ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(ReadError::Unsupported {
            what: "UTF-16 text".into(),
            remedy: "save the file as UTF-8 or ASCII",
        });
    }
    Ok(())
}
