//! Poles and polar balls (section 5.1 of the paper), and which of them to
//! drop (section 6).
//!
//! 1. Each Voronoi vertex is the circumcentre of a Delaunay cell, rounded to
//!    the **ball lattice** ([`BallLattice`]): fact F1.
//! 2. The first pole of a sample is its farthest Voronoi vertex, the second
//!    the farthest on the other side; it can be missing.
//! 3. A pole belongs to its cell, not to a sample: up to four samples share
//!    it. Cells whose rounded centres coincide are one ball that touches the
//!    samples of all of them: on a sphere every inner pole is the centre.
//! 4. With a bound `lambda`, poles that fail the skinniness test are dropped
//!    (`skinny.rs`). Which bound, and of which samples it is asked, is chosen
//!    from the noise (`bound.rs`).
//! 5. Samples told to be at sharp edges get balls that touch on the normal of
//!    their plane, and other balls are drawn back from the edges (`edges.rs`,
//!    `tangent.rs`).
//!
//! Balls come numbered along a space-filling curve by their centres, those of
//! step 5 after them by their coordinates, so ids depend on nothing but the set of samples.

mod balls;
mod bound;
mod candidates;
mod check;
mod edges;
mod select;
mod skinny;
mod tangent;

pub use balls::{BallLattice, Balls};
pub use bound::{Bound, BoundReport, LOUD};
pub use candidates::Candidates;
pub use check::{check, Finding};
pub use select::{DroppedPole, Reason};
pub use tangent::Tangent;

use crate::context::{Cancelled, Context, Portion, Stage};
use crate::delaunay::{Delaunay, Samples};
use crate::tetra::Stars;

/// 'No such pole' among ball ids.
pub const NO_POLE: u32 = u32::MAX;

/// Which poles to drop (section 6).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoleOptions {
    /// The skinniness bound.
    pub bound: Bound,
    /// Drop both poles of a sample that fails.
    pub sharp: bool,
}

/// The polar balls and what they belong to.
#[derive(Clone, Debug)]
pub struct Poles {
    /// The balls.
    pub balls: Balls,
    /// First and second pole of each sample, [`NO_POLE`] where there is none
    /// or it was dropped.
    pub of_sample: Vec<[u32; 2]>,
    /// Poles (sides of samples) dropped, by sample.
    pub dropped: Vec<DroppedPole>,
}

impl Poles {
    /// The number of samples that lost a pole.
    pub fn samples_short(&self) -> usize {
        let samples = self.dropped.chunk_by(|a, b| a.sample == b.sample);
        samples.count()
    }
}

/// Finds the poles of all samples.
///
/// # Errors
/// [`Cancelled`].
///
/// ```
/// use powercrust::{delaunay, poles, Context};
/// // The corners of an octahedron: one ball touches them all from inside.
/// let mut points = vec![];
/// for axis in 0..3 { for side in [-1.0, 1.0] {
///     let mut p = [0.0; 3];
///     p[axis] = side;
///     points.push(p);
/// }}
/// let cx = Context::default();
/// let samples = delaunay::samples(&points, 5.0)?;
/// let delaunay = delaunay::delaunay(&samples, &cx)?;
/// let poles = poles::poles(&samples, &delaunay, &poles::PoleOptions::default(), &cx)?;
/// let inner: Vec<u32> = (0..poles.balls.len() as u32)
///     .filter(|&b| poles.balls.touching(b).len() == 6)
///     .collect();
/// assert_eq!(inner.len(), 1);
/// assert!(poles.of_sample.iter().all(|pair| pair.contains(&inner[0])));
/// assert_eq!(poles::check(&samples, &poles), []);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn poles(
    samples: &Samples,
    delaunay: &Delaunay,
    options: &PoleOptions,
    context: &Context,
) -> Result<Poles, Cancelled> {
    let part = |percent| Portion {
        context,
        stage: Stage::Poles,
        percent,
    };
    let lattice = BallLattice::DEFAULT;
    let stars = Stars::of(&delaunay.complex, samples.len(), &part([0, 10]))?;
    let centres = select::centres(delaunay, lattice, &part([10, 25]))?;
    let chosen = select::select(delaunay, &stars, &centres, options, &part([25, 35]))?;
    drop(stars);
    let chosen_cells = &chosen.cells;
    let part = part([35, 50]);
    let (balls, of_sample) = balls::gather(delaunay, &centres, chosen_cells, lattice, &part)?;
    Ok(Poles {
        balls,
        of_sample,
        dropped: chosen.dropped,
    })
}
