//! How torn a labelling is: the evidence it goes against.

use rayon::prelude::*;

use super::{Evidence, LabelOptions, Neighbours};
use crate::geom::Side;

/// Evidence against a labelling. Zero means that every pair of opposite poles
/// differs and every pair of deeply intersecting neighbours agrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Energy {
    /// Sum of the weights of opposite poles with the same label.
    pub opposites: f64,
    /// Samples whose two poles carry the same label.
    pub like_opposites: u64,
    /// Sum of `-cos alpha` over deeply intersecting neighbours with different
    /// labels.
    pub neighbours: f64,
    /// Number of such pairs.
    pub unlike_neighbours: u64,
    /// Sum of what normals say against the labels of balls; 0 where there are
    /// none.
    pub outward: f64,
}

impl Energy {
    /// The whole energy.
    pub fn total(&self) -> f64 {
        self.opposites + self.neighbours + self.outward
    }
}

/// The energy of a labelling.
pub fn energy(
    evidence: &Evidence,
    neighbours: &Neighbours,
    sides: &[Side],
    options: &LabelOptions,
) -> Energy {
    at_odds(evidence, neighbours, sides, options).0
}

/// The energy of a labelling, and the balls in pairs that it goes against,
/// ascending.
pub(super) fn at_odds(
    evidence: &Evidence,
    neighbours: &Neighbours,
    sides: &[Side],
    options: &LabelOptions,
) -> (Energy, Vec<u32>) {
    let mut energy = Energy::default();
    let mut odd = Vec::new();
    for pair in evidence.opposites {
        if sides[pair.poles[0] as usize] == sides[pair.poles[1] as usize] {
            energy.opposites += pair.weight;
            energy.like_opposites += 1;
            odd.extend(pair.poles);
        }
    }
    // The sum is taken in the order of the balls: no rounding by threads.
    let unlike: Vec<(f64, [u32; 2])> = (0..evidence.balls.len() as u32)
        .into_par_iter()
        .flat_map_iter(|p| {
            let side = sides[p as usize];
            let other = move |&&q: &&u32| q > p && sides[q as usize] != side;
            let unlike = neighbours.at(p).iter().filter(other);
            unlike.filter_map(move |&q| Some((evidence.depth(p, q, options)?, [p, q])))
        })
        .collect();
    energy.neighbours = unlike.iter().fold(0.0, |sum, (depth, _)| sum + depth);
    energy.unlike_neighbours = unlike.len() as u64;
    odd.extend(unlike.iter().flat_map(|(_, pair)| pair));
    for b in 0..evidence.outward.len() as u32 {
        let against = -evidence.said(b, sides[b as usize]);
        if against > 0.0 {
            energy.outward += against;
            odd.push(b);
        }
    }
    odd.sort_unstable();
    odd.dedup();
    (energy, odd)
}
