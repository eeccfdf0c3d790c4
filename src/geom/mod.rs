//! Points, balls and boxes: plain values shared by every stage.
//!
//! A point is `[f64; 3]`, so that slices of coordinates go in and out without
//! conversion. The unit is the user's: nothing here knows millimetres.

mod ball;
mod bounds;
mod sets;
pub mod vec3;

pub use ball::{Ball, Side};
pub use bounds::Bounds;
pub(crate) use sets::Sets;

/// A point in space, in the units of the input.
pub type Point = [f64; 3];
