//! Everything that can go wrong between points and surface.

use crate::context::Cancelled;

/// Why there is no reconstruction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The samples do not span a solid, or are not numbers.
    #[error(transparent)]
    Samples(#[from] SampleError),
    /// An option is outside its documented range.
    #[error("option {name} is {value}: expected {expected}")]
    Option {
        /// The option's name in [`crate::Options`].
        name: &'static str,
        /// What was given.
        value: f64,
        /// The documented range, in words.
        expected: &'static str,
    },
    /// No cell of the power diagram was labelled inner: nothing to show.
    #[error("no part of space was found to be inside: the {samples} samples do not bound a solid")]
    NothingInside {
        /// Number of distinct samples.
        samples: usize,
    },
    /// An offset so far inside that no ball is left.
    #[error(
        "nothing is left at the distance {distance}: the largest inner ball has the radius {depth}"
    )]
    Vanished {
        /// The distance, negative inside.
        distance: f64,
        /// The largest radius of an inner ball.
        depth: f64,
    },
    /// Balls of which none is inner, or none with a radius and a cell.
    #[error("there is no inner ball with a cell of its own: nothing is inside")]
    NoInnerBalls,
    /// An index would not fit in 32 bits.
    #[error("too large: {what} would need {count} entries, the limit is {limit}")]
    TooLarge {
        /// What overflowed.
        what: &'static str,
        /// How many are needed.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// 32-bit coordinates were asked for where they cannot tell points apart.
    #[error("32-bit coordinates are {step:.1e} apart this far from the origin, the points spread over {extent:.1e}: keep 64 bits, or move and scale the points")]
    Single {
        /// Distance between neighbouring 32-bit numbers there.
        step: f64,
        /// Largest side of the bounding box.
        extent: f64,
    },
    /// The caller's progress handler stopped the work.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for Error {
    fn from(_: Cancelled) -> Error {
        Error::Cancelled
    }
}

/// Why points cannot serve as samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// A coordinate is NaN or infinite.
    #[error("point {index} (counting from 0) has the coordinates ({}, {}, {}): all must be finite", point[0], point[1], point[2])]
    NotFinite {
        /// Place in the input, counting from 0.
        index: usize,
        /// The offending point.
        point: [f64; 3],
    },
    /// Fewer than four distinct points.
    #[error("{given} points, {distinct} of them distinct: a solid needs at least 4")]
    TooFew {
        /// Points given.
        given: usize,
        /// Distinct points among them.
        distinct: usize,
    },
    /// All points lie on one line.
    #[error("all {given} points lie on one line: there is no solid")]
    Collinear {
        /// Points given.
        given: usize,
    },
    /// All points lie in one plane.
    #[error("all {given} points lie in one plane: there is no solid")]
    Coplanar {
        /// Points given.
        given: usize,
    },
    /// The points spread over more than a 64-bit number can hold.
    #[error("the points spread over {extent:e}, beyond the largest extent of {limit:e}: scale them down")]
    TooWide {
        /// Largest side of the bounding box.
        extent: f64,
        /// Largest side allowed.
        limit: f64,
    },
    /// More points than 32-bit ids can name.
    #[error("{given} points: at most {limit} are supported")]
    TooMany {
        /// Points given.
        given: usize,
        /// The limit.
        limit: usize,
    },
}
