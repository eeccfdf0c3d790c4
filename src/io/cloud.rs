//! Points read from a file, with what came along and what was left out.

use super::error::{Place, ReadError};
use super::format::CloudFormat;
use crate::geom::Point;

/// How to read points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Drop points with a NaN or infinite coordinate and count them in the
    /// report, where the default is an error. Organised depth images carry
    /// such points as a matter of course.
    pub skip_invalid: bool,
}

/// A named number at each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScalarColumn {
    /// The name in the file's header, or `column 4`, ... where it has none.
    pub name: String,
    /// One value for each point; NaN where the file has none.
    pub values: Vec<f64>,
}

/// Points with what the file says about them. All lists have one entry for
/// each point.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    /// Positions, all finite, in the units of the file and in its order.
    pub points: Vec<Point>,
    /// Normals as the file has them: not made unit length, may be NaN.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Where the scanner stood, if the file says so for all points at once (PCD
    /// does), in the units of the points.
    pub viewpoint: Option<Point>,
    /// Red, green, blue, alpha; alpha is 255 where the file has none.
    pub colours: Option<Vec<[u8; 4]>>,
    /// Everything else that is one number for each point.
    pub scalars: Vec<ScalarColumn>,
    /// What was read and what was not.
    pub report: ReadReport,
}

/// What a reader found: for people and for `--stats`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ReadReport {
    /// The format read.
    pub format: CloudFormat,
    /// Points in the file, before any were dropped.
    pub points_in_file: usize,
    /// Points dropped because a coordinate is NaN or infinite.
    pub invalid_dropped: usize,
    /// The first of them, as in `line 12`.
    pub first_invalid: Option<String>,
    /// Lines or records that are no points: comments, header lines, other
    /// record letters.
    pub records_passed_over: usize,
    /// Faces in the file: a mesh is taken as its vertices. `None` for formats
    /// and files without faces.
    pub faces_ignored: Option<usize>,
    /// Whole sentences about anything a user should know.
    pub notes: Vec<String>,
}

impl ReadReport {
    pub(super) fn new(format: CloudFormat) -> ReadReport {
        ReadReport {
            format,
            points_in_file: 0,
            invalid_dropped: 0,
            first_invalid: None,
            records_passed_over: 0,
            faces_ignored: None,
            notes: Vec::new(),
        }
    }
}

/// A cloud under construction: what the readers fill.
pub(super) struct Parts {
    pub points: Vec<Point>,
    pub viewpoint: Option<Point>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub colours: Option<Vec<[u8; 4]>>,
    pub scalars: Vec<ScalarColumn>,
    pub report: ReadReport,
}

impl Parts {
    pub fn new(format: CloudFormat) -> Parts {
        Parts {
            points: Vec::new(),
            viewpoint: None,
            normals: None,
            colours: None,
            scalars: Vec::new(),
            report: ReadReport::new(format),
        }
    }

    /// Checks that every point is finite or drops those that are not.
    /// `place_of` says where the first such point is, given its index.
    pub fn finish(
        mut self,
        options: &ReadOptions,
        what: &'static str,
        place_of: impl Fn(usize) -> Place,
    ) -> Result<Cloud, ReadError> {
        self.report.points_in_file = self.points.len();
        if self.points.is_empty() {
            return Err(ReadError::Nothing {
                what,
                format: self.report.format.name(),
            });
        }
        let finite = |p: &Point| p.iter().all(|c| c.is_finite());
        if let Some(first) = self.points.iter().position(|p| !finite(p)) {
            let place = place_of(first);
            if !options.skip_invalid {
                return Err(ReadError::NotFinite {
                    place,
                    point: self.points[first],
                });
            }
            let keep: Vec<bool> = self.points.iter().map(finite).collect();
            retain(&mut self.points, &keep);
            if let Some(normals) = &mut self.normals {
                retain(normals, &keep);
            }
            if let Some(colours) = &mut self.colours {
                retain(colours, &keep);
            }
            for column in &mut self.scalars {
                retain(&mut column.values, &keep);
            }
            self.report.invalid_dropped = keep.len() - self.points.len();
            self.report.first_invalid = Some(place.to_string());
            if self.points.is_empty() {
                return Err(ReadError::NothingFinite { points: keep.len() });
            }
            self.report.notes.push(format!(
                "{} of {} points have NaN or infinite coordinates and were dropped, the first at {place}.",
                self.report.invalid_dropped,
                keep.len(),
            ));
        }
        if let Some(faces) = self.report.faces_ignored.filter(|&f| f > 0) {
            self.report.notes.push(format!(
                "This is a mesh of {faces} faces: only its {} vertices are taken.",
                self.points.len(),
            ));
        }
        Ok(Cloud {
            points: self.points,
            viewpoint: self.viewpoint,
            normals: self.normals,
            colours: self.colours,
            scalars: self.scalars,
            report: self.report,
        })
    }
}

fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    list.retain(|_| keep.next().copied().unwrap_or(false));
}

/// Colours from numbers in 0 to 1 or 0 to 255, whichever they are: above 1
/// they must be bytes. NaN becomes 0.
pub(super) fn colours_of(values: &[[f32; 4]], alpha: bool) -> Vec<[u8; 4]> {
    let bytes = values.iter().flat_map(|c| &c[..3]).any(|&v| v > 1.0);
    let scale = if bytes { 1.0 } else { 255.0 };
    let byte = |v: f32| (v * scale).round() as u8;
    values
        .iter()
        .map(|c| {
            let a = if alpha { byte(c[3]) } else { 255 };
            [byte(c[0]), byte(c[1]), byte(c[2]), a]
        })
        .collect()
}
