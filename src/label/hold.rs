//! Holding the surface to the samples: a step beyond the paper.
//!
//! A sample lies on the crust when balls of both labels touch it: its power
//! to them is 0, to all others it is positive. At edges, where a Voronoi
//! cell opens wide on one side, both poles can fall on that side, and the sample
//! ends up off the surface by as much as the spacing. Any Delaunay ball at the sample
//! touches it, not only its poles. So for a sample whose balls all carry one
//! label, the largest of its Delaunay balls whose centre lies in a cell of the other
//! label is added to the diagram with that label. Balls are only ever added where labels
//! already say what they must be; where no centre qualifies the sample stays off.
//!
//! On noisy input many samples lie off any good surface: there the step is
//! left out ([`MOST_UNHELD`]).

use std::cmp::Ordering;

use rayon::prelude::*;

use super::Labels;
use crate::context::Context;
use crate::delaunay::Delaunay;
use crate::error::Error;
use crate::geom::Side;
use crate::poles::{Balls, Candidates};
use crate::power::PowerDiagram;
use crate::predicates::Site;
use crate::tetra::NONE;

/// Share of unheld samples beyond which they are taken for noise.
pub const MOST_UNHELD: f64 = 0.05;

/// What holding found and did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Held {
    /// Samples all of whose balls carried one label.
    pub unheld: u32,
    /// Balls added for them.
    pub added: u32,
    /// Samples that stay off for want of a ball, or because there are too
    /// many of them.
    pub left: u32,
}

/// Adds balls for samples that are off the crust. With `most` the share of
/// the samples up to which this is done.
///
/// # Errors
/// Those of [`PowerDiagram::extend`].
pub fn hold(
    delaunay: &Delaunay,
    balls: &mut Balls,
    power: &mut PowerDiagram,
    labels: &mut Labels,
    most: f64,
    context: &Context,
) -> Result<Held, Error> {
    let unheld = unheld(delaunay.samples, balls, &labels.sides);
    let mut held = Held {
        unheld: unheld.len() as u32,
        added: 0,
        left: unheld.len() as u32,
    };
    if unheld.is_empty() || unheld.len() as f64 > most * delaunay.samples as f64 {
        return Ok(held);
    }
    let candidates = Candidates::of(delaunay, &unheld, balls.lattice);
    let start = power.complex.cell_at_vertex(power.sites.len());
    let one_touching = one_ball_each(balls, &unheld);
    // No two balls of a diagram have one centre.
    let mut centres: Vec<&Site> = balls.sites.iter().collect();
    centres.par_sort_unstable_by(|a, b| by_centre(a, b));
    let taken = |site: &Site| centres.binary_search_by(|c| by_centre(c, site)).is_ok();
    let chosen: Vec<Option<(usize, Side)>> = (0..unheld.len())
        .into_par_iter()
        .map(|k| {
            let at = one_touching[k];
            let wanted = labels.sides[at as usize].opposite();
            // A hidden ball has no cell to start from.
            let hint = match start[at as usize] {
                NONE => 0,
                cell => cell,
            };
            candidates
                .at(k)
                .filter(|&c| !taken(candidates.site(c)))
                .filter(|&c| {
                    let owner = power.owner(candidates.site(c), hint);
                    let side = match owner {
                        Some(ball) => labels.sides[ball as usize],
                        None => Side::Outer,
                    };
                    side == wanted
                })
                .max_by(|&a, &b| {
                    let (p, q) = (candidates.site(a), candidates.site(b));
                    p[3].total_cmp(&q[3]).then_with(|| {
                        (q[..3])
                            .partial_cmp(&p[..3])
                            .unwrap_or(std::cmp::Ordering::Equal)
                    })
                })
                .map(|c| (c, wanted))
        })
        .collect();
    held.left = chosen.iter().filter(|c| c.is_none()).count() as u32;
    let sides = candidates.append(balls, chosen.into_iter().flatten());
    held.added = sides.len() as u32;
    let from = power.balls;
    power.extend(&balls.sites[from..], context)?;
    labels.sides.extend(sides);
    Ok(held)
}

/// The order of sites by centre alone.
fn by_centre(a: &Site, b: &Site) -> Ordering {
    (0..3).fold(Ordering::Equal, |o, k| o.then(a[k].total_cmp(&b[k])))
}

/// Samples touched by balls, all of one label.
fn unheld(samples: usize, balls: &Balls, sides: &[Side]) -> Vec<u32> {
    let mut seen = vec![0u8; samples];
    for (b, &side) in sides.iter().enumerate() {
        for &s in balls.touching(b as u32) {
            seen[s as usize] |= 1 << side as u8;
        }
    }
    (0..samples as u32)
        .filter(|&s| matches!(seen[s as usize], 1 | 2))
        .collect()
}

/// A ball touching each of the samples, which are ascending.
fn one_ball_each(balls: &Balls, samples: &[u32]) -> Vec<u32> {
    let mut found = vec![u32::MAX; samples.len()];
    for b in 0..balls.len() as u32 {
        for s in balls.touching(b) {
            if let Ok(k) = samples.binary_search(s) {
                found[k] = found[k].min(b);
            }
        }
    }
    found
}
