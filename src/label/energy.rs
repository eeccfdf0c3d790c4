//! How torn a labelling is: the evidence it goes against.

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
}

impl Energy {
    /// The whole energy.
    pub fn total(&self) -> f64 {
        self.opposites + self.neighbours
    }
}

/// The energy of a labelling.
pub fn energy(
    evidence: &Evidence,
    neighbours: &Neighbours,
    sides: &[Side],
    options: &LabelOptions,
) -> Energy {
    let mut energy = Energy::default();
    for pair in evidence.opposites {
        if sides[pair.poles[0] as usize] == sides[pair.poles[1] as usize] {
            energy.opposites += pair.weight;
            energy.like_opposites += 1;
        }
    }
    for (p, ball) in evidence.balls.iter().enumerate() {
        for &q in neighbours.at(p as u32) {
            if q as usize > p && sides[q as usize] != sides[p] {
                if let Some(depth) = ball.depth(&evidence.balls[q as usize]) {
                    if depth > options.deep {
                        energy.neighbours += depth;
                        energy.unlike_neighbours += 1;
                    }
                }
            }
        }
    }
    energy
}
