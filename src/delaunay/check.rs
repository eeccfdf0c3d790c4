//! What a Delaunay triangulation must satisfy.

use super::{corners, Delaunay};
use crate::tetra::{self, InSphere};

/// One thing wrong with a Delaunay triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// The last eight sites are not the corners of a cube about the origin.
    NoFrame,
    /// A sample is not strictly inside the frame.
    OutsideFrame {
        /// The sample.
        sample: u32,
    },
    /// The complex breaks a clause of triangulations.
    Complex(tetra::Finding),
}

/// Everything wrong with a triangulation of samples: the frame, then the
/// clauses of [`tetra::check`], empty spheres among them.
pub fn check(delaunay: &Delaunay) -> Vec<Finding> {
    let (samples, frame) = delaunay.sites.split_at(delaunay.samples);
    let half = frame.first().map_or(0.0, |corner| corner[0].abs());
    if half == 0.0 || !corners(half).eq(frame.iter().copied()) {
        return vec![Finding::NoFrame];
    }
    let mut found = Vec::new();
    for (sample, site) in (0u32..).zip(samples) {
        if site[..3].iter().any(|v| v.abs() >= half) {
            found.push(Finding::OutsideFrame { sample });
        }
    }
    let broken = tetra::check(&delaunay.complex, &[], &InSphere(&delaunay.sites));
    found.extend(broken.into_iter().map(Finding::Complex));
    found
}
