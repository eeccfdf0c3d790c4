//! The power diagram of balls, as its dual: the regular triangulation
//! (section 5 of the paper, step 3).
//!
//! It takes balls and knows no poles. Eight **sentinels**, balls of radius 0
//! at the corners of a cube beyond all centres, stand around them (fact F4):
//! every other cell is then bounded, so whatever the labels, the faces between
//! unlike cells close up as long as the sentinels count as outer.

mod check;
mod tree;

pub use check::{check, Finding};
pub(crate) use tree::{BallTree, Extent};

use std::collections::HashSet;

use crate::context::{Context, Stage};
use crate::delaunay::{circumcentre, corners, Centre};
use crate::error::Error;
use crate::predicates::{Counts, Site, LIMIT};
use crate::tetra::{extend, locate, triangulate, Complex, InPower, NONE};

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

    /// The ball whose power at a site is least, found by walking from a cell;
    /// `None` for a sentinel.
    pub fn owner(&self, site: &Site, hint: u32) -> Option<u32> {
        let mut counts = Counts::default();
        let cell = locate(&self.complex, &self.sites, site, hint, &mut counts);
        let at = |v: u32| {
            let s = &self.sites[v as usize];
            let d = [s[0] - site[0], s[1] - site[1], s[2] - site[2]];
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - s[3]
        };
        // Cells are convex: a ball that is not the owner has a neighbour of
        // less power, so going downhill ends at the owner.
        let least = |corners: [u32; 4], best: u32| {
            let all = corners.into_iter().chain([best]);
            all.min_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)))
                .unwrap_or(best)
        };
        let corners = self.complex.cells[cell as usize];
        let mut best = least(corners, corners[0]);
        // Stars of large balls have thousands of cells: those are looked up by hash.
        const FEW: usize = 32;
        let mut star = vec![cell];
        let mut many: HashSet<u32> = HashSet::new();
        let mut next = 0;
        while next < star.len() {
            let c = star[next];
            next += 1;
            let better = least(self.complex.cells[c as usize], best);
            if at(better) < at(best) {
                best = better;
                star.clear();
                many.clear();
                star.push(c);
                next = 0;
                continue;
            }
            for packed in self.complex.neighbours[c as usize] {
                let d = packed >> 2;
                if packed == NONE || !self.complex.cells[d as usize].contains(&best) {
                    continue;
                }
                let new = match star.len() {
                    ..FEW => !star.contains(&d),
                    _ => {
                        if many.is_empty() {
                            many.extend(&star);
                        }
                        many.insert(d)
                    }
                };
                if new {
                    star.push(d);
                }
            }
        }
        (!self.is_sentinel(best)).then_some(best)
    }

    /// Inserts more balls: they get the ids after the present ones. The rules
    /// of [`power_diagram`] hold for all of them together.
    ///
    /// # Errors
    /// [`Error::TooLarge`] and [`Error::Cancelled`]; the diagram is of no use
    /// then.
    pub fn extend(&mut self, balls: &[Site], context: &Context) -> Result<(), Error> {
        if balls.is_empty() {
            return Ok(());
        }
        let (old, added) = (self.balls as u32, balls.len() as u32);
        let sentinels = self.sites.split_off(self.balls);
        self.sites.extend_from_slice(balls);
        self.sites.extend(sentinels);
        let mut complex = std::mem::take(&mut self.complex);
        for v in complex.cells.iter_mut().flatten() {
            *v += if *v < old { 0 } else { added };
        }
        let built = extend(
            &InPower(&self.sites),
            complex,
            old..old + added,
            Stage::Power,
            context,
        )?;
        self.complex = built.complex;
        self.balls += balls.len();
        self.hidden.extend(built.hidden);
        self.hidden.sort_unstable();
        self.counts += built.counts;
        Ok(())
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
