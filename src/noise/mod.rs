//! Noise: how much of it there is, and samples moved onto the surface that
//! it hides. A step beyond the paper, whose section 6.1 drops single poles.
//!
//! The power crust passes through its samples. Where they are off the true
//! surface by more than a share of their spacing, that makes ragged faces, and near the
//! spacing wrong handles. So, before anything else:
//!
//! 1. **Is there noise?** (`level.rs`) Quadrics fitted to the nearest 12, 24
//!    and 48 samples miss them by a share of the spacing. What noise leaves
//!    does not depend on how many samples are fitted; what shape leaves, grows
//!    with them; and what noise leaves at a sample says nothing of its neighbour. Where it
//!    grows and neighbours agree, or is small, nothing is done: the result is
//!    the same to the last bit as without this module.
//! 2. **How much where?** (`local.rs`) The same, at every sample: a low
//!    quantile over the neighbours, so that edges do not count as noise, of which neighbours
//!    tell the part that shape does not enter (`differences.rs`).
//! 3. **Projection** (`project.rs`) Every sample amid noise moves to the foot
//!    of a quadric fitted to its neighbours by weighted least squares: one step of
//!    the moving least squares of Levin (1998; Alexa and others, 2001). How many
//!    neighbours, follows from noise over spacing; near edges and in thin parts the fit
//!    grows from a small one and leaves out what lies off it, elsewhere wider ones are followed as far as noise
//!    explains it. Where points come with normals,
//!    neighbours across a thin wall are none (`sheets.rs`).
//!
//! Samples that lie on no surface at all are told apart before (`outliers/`),
//! samples at sharp edges afterwards, on demand (`corners/`).
//!
//! `docs/noise.md` has what was measured.

mod corners;
mod differences;
mod fit;
mod level;
mod local;
mod near;
mod outliers;
mod plane;
mod project;
mod sheets;

pub use corners::{corners, Corner, CornerReport, Corners, Foot};
pub use level::Level;
pub use outliers::{outliers, OutlierReport, Stray};

use crate::context::{Cancelled, Context, Stage};
use crate::delaunay::Samples;
use crate::geom::vec3::direction;
use crate::geom::Point;
use crate::options::NoiseOption;
pub(crate) use near::Near;
use sheets::Sheets;

/// What was found and done about noise.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct NoiseReport {
    /// What the cloud as a whole says; `None` where it was not asked.
    pub level: Option<Level>,
    /// Whether samples were moved.
    pub treated: bool,
    /// Whether normals, or the ways to scanners, told the two sides of thin walls apart.
    pub sheets_told: bool,
    /// Samples amid noise, which were moved.
    pub moved: usize,
    /// The median of the noise at those samples, as a standard deviation in
    /// the input's unit.
    pub scale: f64,
    /// The same as a share of the spacing.
    pub share: f64,
    /// The median of the numbers of neighbours fitted.
    pub neighbours: usize,
    /// How far samples were moved, root mean square, in the input's unit.
    pub mean_move: f64,
    /// How far at most.
    pub largest_move: f64,
}

/// Samples as they are to be reconstructed.
pub struct Treated {
    /// A place for each sample, in the input's coordinates.
    pub points: Vec<Point>,
    /// The noise that was at each sample as a share of the spacing; 0 at those
    /// not moved.
    pub shares: Vec<f32>,
    /// What was done.
    pub report: NoiseReport,
}

/// Recognises noise and moves samples onto the surface; only what was found where there is
/// no noise to speak of.
///
/// `outward` has a vector out of the solid for each sample, of any length, zero where none is
/// known, or is empty. Vectors part the two sides of walls thinner than a few times the
/// noise, where they do that better than chance.
///
/// # Errors
/// [`Cancelled`].
///
/// ```
/// use powercrust::{delaunay::samples, noise::treat, options::NoiseOption, Context};
/// // A sphere, clean: nothing is done.
/// let points: Vec<[f64; 3]> = (0..400).map(|k| {
///     let (z, a) = ((k as f64 + 0.5) / 200.0 - 1.0, k as f64 * 2.399963);
///     let r = (1.0 - z * z).sqrt();
///     [r * a.cos(), r * a.sin(), z]
/// }).collect();
/// let samples = samples(&points, 5.0)?;
/// let found = treat(&samples, &[], NoiseOption::Auto, &Context::default())?;
/// assert!(found.is_err());
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn treat(
    samples: &Samples,
    outward: &[Point],
    option: NoiseOption,
    context: &Context,
) -> Result<Result<Treated, NoiseReport>, Cancelled> {
    let mut report = NoiseReport::default();
    if option == NoiseOption::Off {
        return Ok(Err(report));
    }
    let places: Vec<Point> = (samples.sites.iter()).map(|s| [s[0], s[1], s[2]]).collect();
    let near = Near::of(&places);
    context.advance(Stage::Noise, 0, 100)?;
    let ways: Vec<Point> = outward.iter().map(|&w| direction(w)).collect();
    let sheets = Sheets::of(&near, &ways);
    let unit = samples.lattice.length_to_user(1.0);
    if option == NoiseOption::Auto {
        let level = level::level(&sheets);
        let noisy = level.noisy;
        report.level = Some(level);
        if !noisy {
            return Ok(Err(report));
        }
    }
    let given = match option {
        NoiseOption::Scale(scale) => Some(scale / unit),
        _ => None,
    };
    let local = local::local(&sheets, given, context)?;
    let feet = project::project(&sheets, &local, context)?;

    let mut scales = Vec::new();
    let mut shares = Vec::new();
    let mut counts = Vec::new();
    let mut sum = 0.0;
    for (s, (&from, to)) in places.iter().zip(&feet).enumerate() {
        let at: &local::Local = &local[s];
        if at.neighbours == 0 {
            continue;
        }
        let way = crate::geom::vec3::dist_sq(from, *to);
        sum += way;
        report.largest_move = report.largest_move.max(way);
        scales.push(at.noise);
        shares.push(at.noise / at.spacing);
        counts.push(f64::from(at.neighbours));
    }
    if scales.is_empty() {
        return Ok(Err(report));
    }
    report.treated = true;
    report.sheets_told = sheets.told();
    report.moved = scales.len();
    report.scale = level::quantile(&mut scales, 0.5) * unit;
    report.share = level::quantile(&mut shares, 0.5);
    report.neighbours = level::quantile(&mut counts, 0.5) as usize;
    report.mean_move = (sum / report.moved as f64).sqrt() * unit;
    report.largest_move = report.largest_move.sqrt() * unit;
    let shares = (local.iter())
        .map(|at| match at.neighbours {
            0 => 0.0,
            _ => (at.noise / at.spacing) as f32,
        })
        .collect();
    let points = (feet.iter().enumerate())
        .map(|(s, foot)| match local[s].neighbours {
            0 => samples.points[s],
            _ => samples.lattice.to_user(*foot),
        })
        .collect();
    Ok(Ok(Treated {
        points,
        shares,
        report,
    }))
}
