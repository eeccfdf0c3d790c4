//! Points in, surface and medial axis out: the stages in order.

use crate::context::Context;
use crate::error::Error;
use crate::geom::{Ball, Point, Side};
use crate::surface::{Crust, PowerShape};

/// What the user may say. The default says nothing and suits clean scans.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Options {
    /// Skinniness bound `lambda` of section 6.1, the user's estimate of r';
    /// in (0, 1]. `None` keeps every pole.
    pub lambda: Option<f64>,
    /// Drop both poles of a sample whose cell fails the skinniness test
    /// (section 6.2), so that faces extend to sharp edges. Needs `lambda`.
    pub sharp: bool,
    /// Angle in degrees, in (90, 180), above which two balls intersect deeply
    /// and share evidence (section 5.2).
    pub deep_angle: f64,
    /// Half-side of the frame over half the largest side of the samples'
    /// bounding box; in [1.5, 100].
    pub box_factor: f64,
    /// Balls are merged when the surface moves by less than this share of the
    /// sampling error (fact F6); in [0, 1], 0 merges identical balls only.
    pub merge: f64,
    /// Polygons as the power diagram has them, or triangles.
    pub faces: Faces,
}

/// The kind of faces wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Faces {
    /// Triangles only.
    Triangles,
    /// The polygons between cells.
    Polygons,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            lambda: None,
            sharp: false,
            deep_angle: 113.578_178_478_201_83,
            box_factor: 5.0,
            merge: 0.1,
            faces: Faces::Triangles,
        }
    }
}

/// A polar ball with what the pipeline found out about it.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarBall {
    /// Centre and radius.
    pub ball: Ball,
    /// Its label.
    pub side: Side,
    /// One sample of which it is a pole (the smallest sample id).
    pub sample: u32,
}

/// Counts, timings and every option of one run; the content of `--stats`.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Stats {
    /// Points given.
    pub points: usize,
    /// Distinct samples.
    pub samples: usize,
    /// Points merged into an equal one.
    pub duplicates: usize,
    /// Seconds by stage, in order.
    pub seconds: Vec<(String, f64)>,
    // more follow
}

/// The result: everything owned, nothing borrowed.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// The watertight surface.
    pub crust: Crust,
    /// All polar balls of the power diagram with their labels.
    pub balls: Vec<PolarBall>,
    /// For each sample id (the `vertex_samples` of the crust) the index of
    /// the first input point at that place.
    pub sample_source: Vec<u32>,
    /// Counts and timings.
    pub stats: Stats,
}

impl Reconstruction {
    /// The power shape of one side: the approximate medial axis (section 3.4).
    pub fn power_shape(&self, _side: Side) -> PowerShape {
        unimplemented!()
    }
}

/// Points in, watertight crust and medial axis out (section 5).
pub fn reconstruct(
    _points: &[Point],
    _options: &Options,
    _context: &Context,
) -> Result<Reconstruction, Error> {
    unimplemented!()
}
