//! What the user may say. The default says nothing and suits clean scans.

use crate::error::Error;

/// Options of a reconstruction.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Options {
    /// Which poles are dropped for the shape of their cells (section 6.1).
    pub lambda: LambdaOption,
    /// Whether both poles of samples at sharp edges are dropped (section 6.2),
    /// so that faces extend to the edges, and what tells such samples.
    pub sharp: SharpOption,
    /// Whether samples amid noise are moved onto the surface before anything
    /// else. With [`NoiseOption::Auto`] a cloud that is not noisy gives the
    /// same result, to the last bit, as with [`NoiseOption::Off`].
    pub noise: NoiseOption,
    /// Whether samples that lie on no surface are left out before anything
    /// else. A cloud without any gives the same result, to the last bit, either way.
    pub outliers: OutlierOption,
    /// How far labels are worked on.
    pub label: LabelOption,
    /// Angle in degrees, in (90, 180), above which two balls intersect deeply
    /// and share evidence (section 5.2).
    pub deep_angle: f64,
    /// Half-side of the frame over half the largest side of the samples'
    /// bounding box; in [2, 100].
    pub box_factor: f64,
    /// Balls are merged when the surface moves by less than this share of the
    /// sampling error (fact F6); in [0, 1], 0 merges identical balls only.
    pub merge: f64,
    /// Polygons as the power diagram has them, triangles, or none.
    pub faces: Faces,
    /// Whether the surface must pass through every sample, as far as balls
    /// can be found that make it. `None`: unless so many samples are off it
    /// that they must be noise, or `sharp` says otherwise.
    pub interpolate: Option<bool>,
    /// How far the surface may move to lose a vertex that is no sample, as a
    /// share of the sampling error `h² / 2r`, `h` the local spacing and `r` the
    /// radius of the ball beside it; in [0, 10]. With 0 the faces are those of
    /// the power diagram, but for what must be mended.
    pub flatness: f64,
    /// Whether the cells of the power diagram come back with the result, which
    /// [`Reconstruction::axis`](crate::Reconstruction::axis) and its like need. Without
    /// them `power.complex` is empty, and a surface takes less memory.
    #[serde(skip)]
    pub cells: bool,
    /// Round coordinates to single precision, as files of it hold them, and
    /// make sure of the surface on those.
    pub single: bool,
}

/// The skinniness bound `lambda` of section 6.1.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LambdaOption {
    /// Chosen sample by sample from what is known about noise; without noise
    /// every pole is kept ([`crate::poles::Bound`]).
    Auto,
    /// None: every pole is kept.
    Off,
    /// The user's estimate of r', the distance between samples over that to the
    /// medial axis; in (0, 1].
    Value(f64),
}

impl LambdaOption {
    /// Whether the user gave a value.
    pub fn is_given(self) -> bool {
        matches!(self, LambdaOption::Value(_))
    }
}

/// Which samples lie at sharp edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SharpOption {
    /// None: every edge is a little blunt.
    #[default]
    Off,
    /// Those whose cell fails the skinniness test, as in the paper. Needs a
    /// value of [`Options::lambda`].
    Skinny,
    /// Those whose neighbours lie on two or three planes that meet there
    /// rather than on one smooth surface. A cloud without any gives the same
    /// result, to the last bit, as with [`SharpOption::Off`].
    Auto,
}

/// What to take for noise.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseOption {
    /// What the samples say themselves.
    Auto,
    /// Nothing: the surface goes through the samples.
    Off,
    /// Noise of this standard deviation, in the input's unit, positive and less than half
    /// the largest side of the box of the points.
    Scale(f64),
}

/// What to do with samples that lie on no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum OutlierOption {
    /// Leave them out, and report them.
    Auto,
    /// Keep every sample.
    Keep,
}

/// How far labels, inner or outer, are worked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LabelOption {
    /// As the queue of section 5.2 leaves them: a label once given stays.
    Greedy,
    /// Flipped where that agrees better with the evidence, and amid noise with
    /// winding numbers.
    Refined,
}

/// The kind of faces wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Faces {
    /// Triangles only.
    Triangles,
    /// The polygons between cells.
    Polygons,
    /// None: for those who want the balls only, the surface is not made
    /// ([`Reconstruction::crust`](crate::Reconstruction::crust) is empty). Labels are as found, also of balls that
    /// a surface in want of mending would have changed (`stats.relabelled`).
    None,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            lambda: LambdaOption::Auto,
            sharp: SharpOption::Off,
            noise: NoiseOption::Auto,
            outliers: OutlierOption::Auto,
            label: LabelOption::Refined,
            deep_angle: 113.578_178_478_201_83,
            box_factor: 5.0,
            merge: 0.5,
            interpolate: None,
            faces: Faces::Triangles,
            flatness: 0.35,
            cells: true,
            single: false,
        }
    }
}

impl Options {
    /// Checks the documented ranges.
    ///
    /// # Errors
    /// [`Error::Option`] names the first option out of range.
    ///
    /// ```
    /// use powercrust::{options::LambdaOption, Options};
    /// let lambda = LambdaOption::Value(7.0);
    /// let options = Options { lambda, ..Options::default() };
    /// assert_eq!(
    ///     options.validate().unwrap_err().to_string(),
    ///     "option lambda is 7: expected a number in (0, 1]"
    /// );
    /// ```
    pub fn validate(&self) -> Result<(), Error> {
        let within = |name, value: f64, ok: bool, expected| {
            if ok {
                Ok(())
            } else {
                Err(Error::Option {
                    name,
                    value,
                    expected,
                })
            }
        };
        if let LambdaOption::Value(lambda) = self.lambda {
            let ok = lambda > 0.0 && lambda <= 1.0;
            within("lambda", lambda, ok, "a number in (0, 1]")?;
        }
        if self.sharp == SharpOption::Skinny && !self.lambda.is_given() {
            within("sharp", 1.0, false, "lambda beside it")?;
        }
        if let NoiseOption::Scale(scale) = self.noise {
            let ok = scale > 0.0 && scale.is_finite();
            within("noise", scale, ok, "auto, off, or a positive length")?;
        }
        let angle = self.deep_angle;
        let ok = angle > 90.0 && angle < 180.0;
        within("deep_angle", angle, ok, "degrees in (90, 180)")?;
        let ok = (2.0..=100.0).contains(&self.box_factor);
        within("box_factor", self.box_factor, ok, "a number in [2, 100]")?;
        let ok = (0.0..=1.0).contains(&self.merge);
        within("merge", self.merge, ok, "a number in [0, 1]")?;
        let ok = (0.0..=10.0).contains(&self.flatness);
        within("flatness", self.flatness, ok, "a number in [0, 10]")
    }
}
