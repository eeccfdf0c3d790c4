//! Places where nothing was sampled and the crust bridges what it does not
//! know (section 7.1 of the paper): which faces they are, and the surface
//! without them.
//!
//! **Which faces.** The paper asks whether inner and outer ball intersect
//! deeply, by more than an angle. That finds places where the balls bulge
//! through a gap, but not gaps in flat or gently curved surface, where large
//! balls meet at shallow angles: of a sphere without a cap of 60 degrees and
//! of a hemisphere it marks nothing, and what it marks elsewhere is speckled.
//!
//! Polar balls hold no sample. Those on both sides of a face intersect in a
//! lens, and the disc across the lens is as empty; a point of it
//! at power `-p` from both balls lies in the middle of a chord of the lens of
//! length `2 sqrt(p)`, which no sample touches. So every face tells how wide the gap is
//! that it spans: its **width**, that chord at its middle (`width.rs`). Where the surface
//! is sampled that is about the spacing of the samples, in the middle of a
//! round hole its diameter, whatever the angle.
//!
//! **How wide is a hole.** Faces wider than [`GROWN`] spacings of the samples around, joined
//! by edges, are a patch. Its width is that of its widest face, but no more
//! than the diameter of a disc of its area: a chord reaches beyond a sliver of surface
//! between flat places. On 32 clouds of closed surfaces (1,435 to 20,000
//! samples, random, adaptive, in scan lines) patches come to 2.9 spacings at most, 4.0 with
//! other seeds, without the disc to 7.4; the end of the club's shaft has 7.7, the ankle of
//! `foot.ply` 11, the wrist of `hand.ply` 33. [`DEFAULT_SPACINGS`] lies between.
//! `docs/holes.md` has the figures.
//!
//! **Without them** the crust is an oriented manifold with a border: see
//! [`Holes::open`]. **Drawn taut** it stays closed: see [`Holes::fill`].

mod fill;
mod open;
mod patches;
mod width;

#[cfg(test)]
mod tests;

pub use fill::Filled;
pub use open::{Loop, Opened};
pub use patches::{Holes, Patch};

use crate::pipeline::Reconstruction;

/// Gaps from so many spacings on are holes, unless another size is asked for.
pub const DEFAULT_SPACINGS: f64 = 5.0;

/// Faces of a hole span at least so many spacings: below, gaps cannot be told
/// from the sampling.
pub const GROWN: f64 = 3.5;

/// From which width on a gap is a hole.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HoleSize {
    /// In spacings of the samples around; at least [`GROWN`].
    Spacings(f64),
    /// A length in the input's unit; gaps below [`GROWN`] spacings are none
    /// whatever it is.
    Length(f64),
}

impl Default for HoleSize {
    fn default() -> HoleSize {
        HoleSize::Spacings(DEFAULT_SPACINGS)
    }
}

impl Reconstruction {
    /// The places that the crust bridges without samples.
    pub fn holes(&self, size: HoleSize) -> Holes {
        Holes::of(self, size)
    }

    /// For each face 1 where it spans a hole of the default size, else 0.
    pub fn face_holes(&self) -> Vec<u8> {
        self.holes(HoleSize::default()).flags()
    }
}
