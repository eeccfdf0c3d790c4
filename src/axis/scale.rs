//! The scale axis (Giesen, Miklos, Pauly and Wormser 2009; section 4 of
//! Miklos, Giesen and Pauly 2010): balls matter that still show when all are
//! grown by a factor.
//!
//! A grown ball that lies within the union of the others has no part of the
//! union's border. In the power diagram of the grown balls its cell is then
//! beyond it, so that the ball is not in the dual complex ([`dual`]), or within it:
//! the power at every corner of the cell is negative, since along
//! a segment power has no maximum inside. Such balls, and those without a cell, go.

use super::dual::{self, of_four};
use super::labelled::STEP;
use super::LabelledBalls;
use crate::context::Context;
use crate::error::Error;
use crate::geom::{Ball, Side};
use crate::power::power_diagram;
use crate::predicates::Site;

/// The balls of a side, among those that `keep` says, that the others cover
/// when grown by a factor.
pub fn covered(
    balls: &LabelledBalls,
    keep: &[bool],
    side: Side,
    factor: f64,
    context: &Context,
) -> Result<Vec<u32>, Error> {
    let own: Vec<u32> = (0..keep.len() as u32)
        .filter(|&b| keep[b as usize] && balls.sides[b as usize] == side)
        .collect();
    let grown = |&b: &u32| {
        let [x, y, z, weight] = balls.sites()[b as usize];
        [x, y, z, (weight * factor * factor).round()]
    };
    let sites: Vec<Site> = own.iter().map(grown).collect();
    let power = power_diagram(&sites, STEP, context)?;
    let mut shows = vec![false; own.len()];
    for cell in &power.complex.cells {
        let at = |v: u32| &power.sites[v as usize];
        let outside = cell.iter().any(|&v| power.is_sentinel(v))
            || of_four(cell.map(at)).is_some_and(|(_, size)| {
                // The power at a sample is 0 but for the lattice.
                let weight = cell.iter().map(|&v| at(v)[3]).fold(0.0, f64::max);
                size > -1e-7 * weight
            });
        if outside {
            for &v in cell.iter().filter(|&&v| !power.is_sentinel(v)) {
                shows[v as usize] = true;
            }
        }
    }
    let old: Vec<Ball> = own.iter().map(|&b| balls.balls[b as usize]).collect();
    let sides = vec![side; own.len()];
    let mut stays = vec![false; own.len()];
    for b in dual::complex(&power, &old, &sides, side).ids {
        stays[b as usize] = shows[b as usize];
    }
    let covered = own.iter().zip(&stays).filter(|(_, &stays)| !stays);
    Ok(covered.map(|(&b, _)| b).collect())
}
