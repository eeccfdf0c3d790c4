//! From labelled power cells to the surface (section 5 of the paper, steps 5
//! and 6): the crust between inner and outer cells, and the power shape.

pub mod raw;
mod shape;
pub use raw::{Crust, RawCrust, NONE};
pub use shape::PowerShape;
