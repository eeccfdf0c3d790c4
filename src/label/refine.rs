//! Lowering the energy of a labelling by flips.
//!
//! The paper suspects that toggling labels to a local optimum 'might be
//! better' than never changing one. Here every ball whose flip lowers the
//! energy ([`super::energy`]) is flipped, the largest gain first, until none is left;
//! balls at the frame stay outer. Each flip lowers the energy, so it ends.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::{Evidence, LabelOptions, Labels, Neighbours, Partners};
use crate::geom::Side;

/// Flips to a local optimum; returns the number of flips.
pub fn refine(
    evidence: &Evidence,
    neighbours: &Neighbours,
    labels: &mut Labels,
    options: &LabelOptions,
) -> u32 {
    let partners = Partners::of(evidence.balls.len(), evidence.opposites);
    let sides = &mut labels.sides;
    let gain = |b: u32, sides: &[Side]| -> f64 {
        if evidence.outer[b as usize] {
            return f64::NEG_INFINITY;
        }
        let side = sides[b as usize];
        let mut gain = evidence.said(b, side.opposite());
        for &(q, weight) in partners.at(b) {
            gain += if sides[q as usize] == side {
                weight
            } else {
                -weight
            };
        }
        for &q in neighbours.at(b) {
            if let Some(depth) = evidence.depth(b, q, options) {
                gain += if sides[q as usize] == side {
                    -depth
                } else {
                    depth
                };
            }
        }
        gain
    };
    // Gains below this are rounding.
    const LEAST: f64 = 1e-9;
    let entry = |b: u32, gain: f64| (Gain(gain), Reverse(b));
    let mut queue: BinaryHeap<(Gain, Reverse<u32>)> = (0..sides.len() as u32)
        .into_par_iter()
        .map(|b| (b, gain(b, sides)))
        .filter(|(_, g)| *g > LEAST)
        .map(|(b, g)| entry(b, g))
        .collect();
    let mut flips = 0;
    while let Some((Gain(value), Reverse(b))) = queue.pop() {
        let now = gain(b, sides);
        if now <= LEAST {
            continue;
        }
        if now != value {
            queue.push(entry(b, now));
            continue;
        }
        sides[b as usize] = sides[b as usize].opposite();
        flips += 1;
        let touched = partners.at(b).iter().map(|&(q, _)| q);
        for q in touched.chain(neighbours.at(b).iter().copied()) {
            let g = gain(q, sides);
            if g > LEAST {
                queue.push(entry(q, g));
            }
        }
    }
    flips
}

/// A gain as a key.
#[derive(Clone, Copy, PartialEq)]
struct Gain(f64);

impl Eq for Gain {}

impl PartialOrd for Gain {
    fn partial_cmp(&self, other: &Gain) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Gain {
    fn cmp(&self, other: &Gain) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
