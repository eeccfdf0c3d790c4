//! Samples and their Delaunay triangulation (section 5 of the paper, step 1).
//!
//! The frame is a **cube** about the bounding box, `box_factor` times its
//! largest half-side (the paper takes a box five times the bounding box). A
//! box as thin as a flat cloud would put its corners so near the cloud's plane that the
//! outer balls of a plate grow without bound; the cube bounds every ball by
//! about twice its own size, and it has all the symmetries of the lattice.

mod check;
mod samples;
mod voronoi;

pub use check::{check, Finding};
pub(crate) use samples::times_power;
pub use samples::{samples, Lattice, Samples, NO_SAMPLE};
pub use voronoi::{circumcentre, rounded_circumcentre, Centre};

use crate::context::{Cancelled, Context, Portion, Stage};
use crate::error::Error;
use crate::predicates::{Counts, Site};
use crate::tetra::{triangulate, Complex, Edges, InSphere};

/// The Delaunay triangulation of the samples and the frame.
#[derive(Clone, Debug)]
pub struct Delaunay {
    /// Cells; vertex `v` is sample `v`, or corner `v - n` of the frame for
    /// `v >= n`, `n` the number of samples.
    pub complex: Complex,
    /// The lattice sites of the samples, then of the frame's eight corners.
    pub sites: Vec<Site>,
    /// Number of samples.
    pub samples: usize,
    /// How its predicates were decided.
    pub counts: Counts,
}

impl Delaunay {
    /// Whether a vertex is a corner of the frame rather than a sample.
    #[inline]
    pub fn is_frame(&self, v: u32) -> bool {
        v as usize >= self.samples
    }
}

/// Triangulates the samples.
///
/// # Errors
/// [`Error::TooLarge`] and [`Error::Cancelled`].
///
/// ```
/// use powercrust::{delaunay, Context};
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let samples = delaunay::samples(&points, 5.0)?;
/// let delaunay = delaunay::delaunay(&samples, &Context::default())?;
/// let of_samples = |cell: &&[u32; 4]| cell.iter().all(|&v| !delaunay.is_frame(v));
/// assert_eq!(delaunay.complex.cells.iter().filter(of_samples).count(), 1);
/// assert_eq!(delaunay::check(&delaunay), []);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn delaunay(samples: &Samples, context: &Context) -> Result<Delaunay, Error> {
    let mut sites = samples.sites.clone();
    sites.extend(corners(samples.lattice.frame_half));
    let count = samples.sites.len() as u32;
    let built = triangulate(&InSphere(&sites), count, Stage::Delaunay, context)?;
    Ok(Delaunay {
        complex: built.complex,
        sites,
        samples: count as usize,
        counts: built.counts,
    })
}

impl Delaunay {
    /// The edges among the samples.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn edges(&self, context: &Context) -> Result<Edges, Cancelled> {
        let progress = Portion {
            context,
            stage: Stage::Delaunay,
            percent: [99, 100],
        };
        Edges::of(&self.complex, self.samples, &progress)
    }
}

/// The corners of the cube `[-half, half]³` as unweighted sites.
pub(crate) fn corners(half: f64) -> impl Iterator<Item = Site> {
    (0..8u32).map(move |k| {
        let side = |bit: u32| if k >> bit & 1 == 1 { half } else { -half };
        [side(0), side(1), side(2), 0.0]
    })
}
