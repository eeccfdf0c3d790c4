//! Samples at sharp edges and corners, told by their neighbours, so that faces
//! reach the edge: section 6.2 of the paper without its lambda.
//!
//! The Voronoi cell of a sample beside an edge opens wide, and its pole looks
//! across the edge rather than along the normal: the crust bevels. The paper
//! drops both poles of samples whose cell is misshapen; noise makes other
//! cells so, and of samples beside an edge only the nearest have one. Here:
//!
//! 1. **Planes** (`planes.rs`). The samples around one lie on two or three
//!    planes that meet close to it, and on these much better than on a quadric.
//! 2. **Lines** (`lines.rs`). The place where two planes meet, nearest to the
//!    sample, is its foot on an edge. Feet that agree with others along a line
//!    are an edge; those of curved or noisy surfaces lie here and there.
//! 3. **Balls** (`poles/edges.rs`). The poles of a sample at an edge are dropped. In
//!    their place come balls that touch it on the normal of its own plane: the
//!    face of the power diagram between two balls that touch in a point is the
//!    plane through it. All other polar balls that hold a foot shrink until
//!    they do not: they pass between samples where the edge has none.
//!
//! `docs/edges.md` has what was measured.

mod lines;
mod planes;

use rayon::prelude::*;

use super::near::Near;
use crate::context::{Cancelled, Context, Stage};
use crate::delaunay::Samples;
use crate::geom::Point;
use planes::Around;

/// Samples between two reports of progress.
const BLOCK: usize = 1 << 14;

/// A sample at a sharp edge. Lengths are in lattice steps of the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    /// The sample.
    pub sample: u32,
    /// Where it lies: on its own plane, if samples were moved for noise.
    pub at: Point,
    /// The unit normal of the plane it is on, either way.
    pub normal: Point,
    /// How large balls that touch it from either side may be: along the
    /// normal, and against it. `None` where the sample is so close to the edge
    /// that one would be tiny: then it has no poles, as in the paper.
    pub radii: Option<[f64; 2]>,
    /// The nearest places where other planes meet its own: one along an edge,
    /// two at a corner.
    pub feet: Vec<Foot>,
    /// The spacing of the samples around.
    spacing: f64,
}

/// A place on an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// The place.
    pub at: Point,
    /// The unit direction of the edge, either way.
    pub along: Point,
    /// The unit normals of the planes that meet, either way.
    pub normals: [Point; 2],
}

/// The samples at sharp edges.
#[derive(Clone, Debug)]
pub struct Corners {
    /// Those samples, ascending.
    pub found: Vec<Corner>,
    /// All samples, in lattice steps.
    pub places: Vec<Point>,
}

/// What was found about sharp edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct CornerReport {
    /// Samples at edges, where two faces meet.
    pub edges: usize,
    /// Samples at corners, where three meet.
    pub corners: usize,
    /// Poles of other samples that were drawn back from an edge.
    pub drawn_back: usize,
}

/// Finds the samples at sharp edges. `treated` says that samples amid noise
/// were moved: then those found lie on their plane rather than where they are.
///
/// # Errors
/// [`Cancelled`].
///
/// ```
/// use powercrust::{delaunay::samples, noise::corners, Context};
/// // Two squares that meet at a right angle, and nothing on the edge.
/// let square = |k: u32| [f64::from(k % 20) + 0.5 + f64::from(k / 20 % 2) * 0.2, f64::from(k / 20) + 0.5];
/// let points: Vec<[f64; 3]> = (0..400).map(square)
///     .flat_map(|[x, y]| [[x, y, 0.0], [x, 0.0, y]])
///     .collect();
/// let samples = samples(&points, 5.0)?;
/// let corners = corners(&samples, false, &Context::default())?;
/// assert!(corners.found.len() >= 30, "{}", corners.found.len());
/// for corner in &corners.found {
///     let [_, y, z] = samples.points[corner.sample as usize];
///     assert!(y + z < 2.0, "{y} {z}");
/// }
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn corners(samples: &Samples, treated: bool, context: &Context) -> Result<Corners, Cancelled> {
    let places: Vec<Point> = (samples.sites.iter()).map(|s| [s[0], s[1], s[2]]).collect();
    let near = Near::of(&places);
    let count = places.len();
    let windows = in_blocks(count, [0, 30], context, |s| planes::window(&near, s))?;
    let around = Around {
        near: &near,
        windows,
        treated,
        most: samples.lattice.sample_half,
    };
    let found = in_blocks(count, [30, 100], context, |s| around.corner(s))?;
    let found: Vec<Corner> = found.into_iter().flatten().collect();
    drop(around);
    let found = lines::agreeing(found);
    Ok(Corners { found, places })
}

/// Asks something of every sample, between two percentages of the stage.
fn in_blocks<T: Send>(
    count: usize,
    [start, end]: [u64; 2],
    context: &Context,
    ask: impl Fn(usize) -> Option<T> + Sync,
) -> Result<Vec<Option<T>>, Cancelled> {
    let mut all = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        let done = (end - start) * from as u64 / count as u64;
        context.advance(Stage::Noise, start + done, 100)?;
        let block = from..count.min(from + BLOCK);
        all.par_extend(block.into_par_iter().map(&ask));
    }
    Ok(all)
}
