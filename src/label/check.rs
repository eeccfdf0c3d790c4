//! What labels must satisfy, and the evidence they go against.

use super::{Evidence, LabelOptions, Labels, Neighbours};
use crate::geom::Side;

/// One thing wrong with a labelling, or one piece of evidence against it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// There is not one label for each ball.
    Count {
        /// Balls.
        balls: usize,
        /// Labels.
        labels: usize,
    },
    /// A ball at the frame is not outer: always a fault.
    InnerAtFrame {
        /// The ball.
        ball: u32,
    },
    /// The poles of a sample carry one label: evidence.
    LikeOpposites {
        /// The poles.
        poles: [u32; 2],
    },
    /// Deeply intersecting neighbours carry different labels: evidence.
    UnlikeNeighbours {
        /// The balls, smaller id first.
        balls: [u32; 2],
    },
}

/// Everything wrong with a labelling and all evidence against it.
pub fn check(
    evidence: &Evidence,
    neighbours: &Neighbours,
    options: &LabelOptions,
    labels: &Labels,
) -> Vec<Finding> {
    let sides = &labels.sides;
    let (balls, labels) = (evidence.balls.len(), sides.len());
    if balls != labels {
        return vec![Finding::Count { balls, labels }];
    }
    let mut found = Vec::new();
    for (ball, (&outer, &side)) in (0u32..).zip(evidence.outer.iter().zip(sides)) {
        if outer && side == Side::Inner {
            found.push(Finding::InnerAtFrame { ball });
        }
    }
    for pair in evidence.opposites {
        let [p, q] = pair.poles;
        if sides[p as usize] == sides[q as usize] {
            found.push(Finding::LikeOpposites { poles: pair.poles });
        }
    }
    for p in 0..balls as u32 {
        for &q in neighbours.at(p).iter().filter(|&&q| q > p) {
            let depth = evidence.balls[p as usize].depth(&evidence.balls[q as usize]);
            let unlike = sides[p as usize] != sides[q as usize];
            if unlike && depth.is_some_and(|depth| depth > options.deep) {
                found.push(Finding::UnlikeNeighbours { balls: [p, q] });
            }
        }
    }
    found
}
