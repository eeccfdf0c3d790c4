//! The vertex element of a PLY file: positions, normals, colours, scalars.

use super::super::cloud::{colours_of, ScalarColumn};
use super::super::error::{Place, ReadError};
use super::super::sink::check_count;
use super::body::{Body, Records};
use super::header::{Element, Kind, Shape};
use crate::geom::Point;

/// Where a property goes.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Nothing,
    Position(usize),
    Normal(usize),
    ByteColour(usize),
    /// Divided by this to get 0 to 255 or 0 to 1.
    Colour(usize, f32),
    Scalar(usize),
}

/// Receives vertices.
pub struct Vertices {
    targets: Vec<Target>,
    pub points: Vec<Point>,
    normals: Vec<[f32; 3]>,
    colours: Vec<[u8; 4]>,
    float_colours: Vec<[f32; 4]>,
    scalars: Vec<ScalarColumn>,
    /// The line of the first vertex that is not finite, in text files.
    pub first_invalid: Option<u64>,
}

/// Positions and what comes with them.
pub struct VertexData {
    pub points: Vec<Point>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub colours: Option<Vec<[u8; 4]>>,
    pub scalars: Vec<ScalarColumn>,
}

const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
];
const COLOUR: [&[&str]; 4] = [
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "diffuse_alpha", "a"],
];

impl Vertices {
    /// Decides what each property is and makes room, once `body` has agreed
    /// that there can be so many. With `all` unset only positions are taken.
    pub fn new(element: &Element, body: &Body, all: bool) -> Result<Vertices, ReadError> {
        check_count("vertices", element.count)?;
        body.check(element)?;
        let mut targets = vec![Target::Nothing; element.properties.len()];
        let scalar = |names: &[&str]| {
            element
                .find(names)
                .and_then(|p| match element.properties[p].shape {
                    Shape::Scalar(kind) => Some((p, kind)),
                    Shape::List { .. } => None,
                })
        };
        for (k, names) in POSITION.iter().enumerate() {
            let Some((p, _)) = scalar(names) else {
                return Err(ReadError::Missing {
                    what: format!(
                        "property {} in the vertex element of this PLY file",
                        names[0]
                    ),
                });
            };
            targets[p] = Target::Position(k);
        }
        let count = element.count as usize;
        let mut out = Vertices {
            targets,
            points: vec![[0.0; 3]; count],
            normals: Vec::new(),
            colours: Vec::new(),
            float_colours: Vec::new(),
            scalars: Vec::new(),
            first_invalid: None,
        };
        if !all {
            return Ok(out);
        }
        if let [Some(x), Some(y), Some(z)] = NORMAL.map(scalar) {
            for (k, (p, _)) in [x, y, z].into_iter().enumerate() {
                out.targets[p] = Target::Normal(k);
            }
            out.normals = vec![[0.0; 3]; count];
        }
        if let [Some(r), Some(g), Some(b), a] = COLOUR.map(scalar) {
            let channels = [Some(r), Some(g), Some(b), a];
            let bytes = channels.iter().flatten().all(|c| c.1 == Kind::U8);
            for (k, channel) in channels.into_iter().enumerate() {
                if let Some((p, kind)) = channel {
                    out.targets[p] = if bytes {
                        Target::ByteColour(k)
                    } else if kind.is_float() {
                        Target::Colour(k, 1.0)
                    } else {
                        Target::Colour(k, if kind == Kind::U16 { 65535.0 } else { 255.0 })
                    };
                }
            }
            if bytes {
                out.colours = vec![[0, 0, 0, 255]; count];
            } else {
                out.float_colours = vec![[0.0, 0.0, 0.0, f32::INFINITY]; count];
            }
        }
        for (target, property) in out.targets.iter_mut().zip(&element.properties) {
            if *target == Target::Nothing && matches!(property.shape, Shape::Scalar(_)) {
                *target = Target::Scalar(out.scalars.len());
                out.scalars.push(ScalarColumn {
                    name: property.name.clone(),
                    values: vec![0.0; count],
                });
            }
        }
        Ok(out)
    }

    /// The finished lists.
    pub fn finish(self) -> VertexData {
        let colours = if self.float_colours.is_empty() {
            self.colours
        } else {
            colours_of(&self.float_colours, true)
        };
        VertexData {
            points: self.points,
            normals: Some(self.normals).filter(|n| !n.is_empty()),
            colours: Some(colours).filter(|c| !c.is_empty()),
            scalars: self.scalars,
        }
    }
}

impl Records for Vertices {
    fn wants(&self, property: usize) -> bool {
        self.targets[property] != Target::Nothing
    }

    #[inline]
    fn scalar(&mut self, property: usize, record: usize, value: f64) {
        match self.targets[property] {
            Target::Position(k) => self.points[record][k] = value,
            Target::Normal(k) => self.normals[record][k] = value as f32,
            Target::ByteColour(k) => self.colours[record][k] = value as u8,
            Target::Colour(k, scale) => self.float_colours[record][k] = value as f32 / scale,
            Target::Scalar(s) => self.scalars[s].values[record] = value,
            Target::Nothing => {}
        }
    }

    fn list(&mut self, _: usize, _: &[i64], _: Place) -> Result<(), ReadError> {
        Ok(())
    }

    #[inline]
    fn line(&mut self, record: usize, line: u64) {
        if self.first_invalid.is_none() && !self.points[record].iter().all(|c| c.is_finite()) {
            self.first_invalid = Some(line);
        }
    }
}
