//! What poles and polar balls must satisfy.

use super::{Poles, NO_POLE};
use crate::delaunay::Samples;
use crate::geom::vec3::{dot, norm, sub};
use crate::geom::Point;

/// One thing wrong with the poles. Lengths are in steps of the samples'
/// lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// A sample names a ball that does not touch it.
    NotTouching {
        /// The sample.
        sample: u32,
        /// Its pole.
        ball: u32,
    },
    /// The two poles of a sample lie on one side of it.
    OneSide {
        /// The sample.
        sample: u32,
    },
    /// A ball is the pole of no sample.
    NoOnesPole {
        /// The ball.
        ball: u32,
    },
    /// The samples a ball touches are not ascending, or do not exist.
    Unsorted {
        /// The ball.
        ball: u32,
    },
    /// A sphere passes by a sample the ball is said to touch.
    Misses {
        /// The ball.
        ball: u32,
        /// The sample.
        sample: u32,
        /// Distance from the sample to the sphere, negative inside the ball.
        by: f64,
    },
}

/// Everything wrong with poles that have not been merged: where poles lie,
/// and whether balls pass through what they touch, to within two steps of the
/// ball lattice.
pub fn check(samples: &Samples, poles: &Poles) -> Vec<Finding> {
    let balls = &poles.balls;
    let step = balls.lattice.step();
    let site = |s: u32| -> Point { [0, 1, 2].map(|k| samples.sites[s as usize][k]) };
    let centre = |b: u32| -> Point { [0, 1, 2].map(|k| balls.sites[b as usize][k] * step) };
    let mut found = Vec::new();
    let mut owned = vec![false; balls.len()];
    for (sample, pair) in (0u32..).zip(&poles.of_sample) {
        for &ball in pair.iter().filter(|&&b| b != NO_POLE) {
            owned[ball as usize] = true;
            if !balls.touching(ball).contains(&sample) {
                found.push(Finding::NotTouching { sample, ball });
            }
        }
        if !pair.contains(&NO_POLE) {
            let [p, q] = pair.map(|b| sub(centre(b), site(sample)));
            if dot(p, q) >= 0.0 {
                found.push(Finding::OneSide { sample });
            }
        }
    }
    for (ball, owned) in (0u32..).zip(owned) {
        if !owned {
            found.push(Finding::NoOnesPole { ball });
        }
        let touching = balls.touching(ball);
        let ascending = touching.windows(2).all(|two| two[0] < two[1]);
        if !ascending || touching.iter().any(|&s| s as usize >= samples.len()) {
            found.push(Finding::Unsorted { ball });
            continue;
        }
        let radius = balls.sites[ball as usize][3].sqrt() * step;
        for &sample in touching {
            let by = norm(sub(site(sample), centre(ball))) - radius;
            if by.abs() > 2.0 * step {
                found.push(Finding::Misses { ball, sample, by });
            }
        }
    }
    found
}
