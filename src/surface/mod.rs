//! From labelled power cells to the surface (section 5 of the paper, steps 5
//! and 6): the crust between inner and outer cells, and the power shape.

mod clean;
pub mod extract;
pub mod raw;
mod shape;
pub use clean::{clean, triangulate};
pub use extract::{raw_crust, Placement};
pub use raw::{Crust, RawCrust, NONE};
pub use shape::{power_shape, PowerShape};
