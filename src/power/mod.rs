//! The power diagram of balls, as its dual: the regular triangulation
//! (section 5 of the paper, step 3).
//!
//! It takes balls and knows no poles. Eight **sentinels**, balls of radius 0
//! at the corners of a cube beyond all centres, stand around them (fact F4):
//! every other cell is then bounded, so whatever the labels, the faces between
//! unlike cells close up as long as the sentinels count as outer.

mod check;

pub use check::{check, Finding};

use crate::context::{Context, Stage};
use crate::delaunay::{circumcentre, corners, Centre};
use crate::error::Error;
use crate::predicates::{Counts, Site, LIMIT};
use crate::tetra::{triangulate, Complex, InPower};

/// The regular triangulation of balls and sentinels.
#[derive(Clone, Debug)]
pub struct PowerDiagram {
    /// Cells; vertex `v` is ball `v`, or a sentinel for `v >= balls`.
    pub complex: Complex,
    /// The sites of the balls, then of the sentinels.
    pub sites: Vec<Site>,
    /// Number of balls.
    pub balls: usize,
    /// Balls without a cell, ascending: other balls cover their share of
    /// space.
    pub hidden: Vec<u32>,
    /// How its predicates were decided.
    pub counts: Counts,
}

impl PowerDiagram {
    /// Whether a vertex is a sentinel.
    #[inline]
    pub fn is_sentinel(&self, v: u32) -> bool {
        v as usize >= self.balls
    }

    /// The power vertex dual to a cell, in the units of the sites.
    pub fn vertex(&self, cell: [u32; 4], tolerance: f64) -> Centre {
        let mut corners = cell;
        corners.sort_unstable();
        circumcentre(corners.map(|v| &self.sites[v as usize]), tolerance)
    }
}

/// Builds the power diagram of balls on a lattice: integer centres of at most
/// `LIMIT / scale / 2` in size, integer squared radii, no two centres equal; number them
/// along a space-filling curve. `scale` is the lattice's step in steps of the
/// samples' lattice.
///
/// # Errors
/// [`Error::TooLarge`] and [`Error::Cancelled`].
///
/// ```
/// use powercrust::{power, Context};
/// // A ball of radius 5 hides a smaller one inside it.
/// let balls = [[0.0, 0.0, 0.0, 25.0], [1.0, 0.0, 0.0, 4.0], [9.0, 0.0, 0.0, 4.0]];
/// let diagram = power::power_diagram(&balls, 1024.0, &Context::default())?;
/// assert_eq!(diagram.hidden, [1]);
/// assert_eq!(power::check(&diagram), []);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn power_diagram(balls: &[Site], scale: f64, context: &Context) -> Result<PowerDiagram, Error> {
    let mut sites = balls.to_vec();
    sites.extend(corners(LIMIT / scale));
    let built = triangulate(&InPower(&sites), balls.len() as u32, Stage::Power, context)?;
    Ok(PowerDiagram {
        complex: built.complex,
        balls: balls.len(),
        sites,
        hidden: built.hidden,
        counts: built.counts,
    })
}
