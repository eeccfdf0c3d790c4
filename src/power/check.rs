//! What a power diagram must satisfy.

use super::PowerDiagram;
use crate::delaunay::corners;
use crate::tetra::{self, InPower};

/// One thing wrong with a power diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// The last eight sites are not the corners of a cube about the origin.
    NoSentinels,
    /// The centre of a ball is not strictly inside the cube of sentinels.
    OutsideSentinels {
        /// The ball.
        ball: u32,
    },
    /// Two balls have one centre.
    SameCentre {
        /// The balls.
        balls: [u32; 2],
    },
    /// The complex breaks a clause of triangulations.
    Complex(tetra::Finding),
}

/// Everything wrong with a power diagram: the sentinels, then the clauses of
/// [`tetra::check`] on the regular triangulation, empty orthospheres and
/// truly hidden balls among them.
pub fn check(power: &PowerDiagram) -> Vec<Finding> {
    let (balls, sentinels) = power.sites.split_at(power.balls);
    let half = sentinels.first().map_or(0.0, |corner| corner[0].abs());
    if half == 0.0 || !corners(half).eq(sentinels.iter().copied()) {
        return vec![Finding::NoSentinels];
    }
    let mut found = Vec::new();
    for (ball, site) in (0u32..).zip(balls) {
        if site[..3].iter().any(|v| v.abs() >= half) {
            found.push(Finding::OutsideSentinels { ball });
        }
    }
    let centre = |b: u32| &balls[b as usize][..3];
    let mut order: Vec<u32> = (0..balls.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| {
        let by_centre = centre(a).partial_cmp(centre(b));
        by_centre
            .unwrap_or(std::cmp::Ordering::Equal)
            .then(a.cmp(&b))
    });
    for pair in order.windows(2) {
        if centre(pair[0]) == centre(pair[1]) {
            let balls = [pair[0], pair[1]];
            found.push(Finding::SameCentre { balls });
        }
    }
    let broken = tetra::check(&power.complex, &power.hidden, &InPower(&power.sites));
    found.extend(broken.into_iter().map(Finding::Complex));
    found
}
