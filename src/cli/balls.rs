//! Inputs that hold balls, or points to make them of.

use std::path::Path;

use powercrust::io::{AxisFormat, CloudFormat};

use super::fail::Failure;
use super::formats::{dotted, extension};

/// What an input turned out to be.
pub enum Input {
    Axis(AxisFormat),
    Points(CloudFormat),
}

/// A format by its name: of an axis where there is one, else of points.
pub fn named(said: &str) -> Result<Input, Failure> {
    // OBJ has no radii: as an input it is points. PLY and JSON may be both.
    let axis =
        AxisFormat::from_extension(said).filter(|&f| f != AxisFormat::Obj && f != AxisFormat::Ply);
    match (axis, CloudFormat::from_extension(said)) {
        (Some(format), _) => Ok(Input::Axis(format)),
        (None, Some(format)) => Ok(Input::Points(format)),
        _ => Err(
            Failure::usage(format!("--input-format {said}: unknown format")).hint(format!(
                "known: .ma .json {}",
                dotted(CloudFormat::extensions())
            )),
        ),
    }
}

/// What a file is, by its name and its first bytes.
pub fn judged(path: &Path, bytes: &[u8]) -> Input {
    let by_name =
        extension(path).and_then(|extension| match AxisFormat::from_extension(extension) {
            Some(format @ (AxisFormat::Ma | AxisFormat::Json)) => Some(Input::Axis(format)),
            Some(AxisFormat::Ply) => None,
            _ => CloudFormat::from_extension(extension).map(Input::Points),
        });
    by_name.unwrap_or_else(|| match AxisFormat::sniff(bytes) {
        Some(format) => Input::Axis(format),
        None => Input::Points(CloudFormat::sniff(bytes)),
    })
}
