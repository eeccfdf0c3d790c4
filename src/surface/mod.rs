//! From labelled power cells to the surface (section 5 of the paper, steps 5
//! and 6): the crust between inner and outer cells, and the power shape.

#[cfg(test)]
mod check;
mod clean;
pub mod components;
mod contract;
mod extract;
mod flat;
mod halfedges;
mod handles;
mod mend;
mod mend_blocks;
mod mend_coarsen;
mod mend_local;
mod mend_mesh;
mod mend_pinch;
mod mend_place;
mod mend_shell;
mod pinch;
mod polygon;
#[cfg(test)]
mod polygon_tests;
pub mod raw;
mod shape;
mod short;
pub(crate) mod stage;
#[cfg(test)]
mod tests;
mod triangulate;
mod unfold;

pub(crate) use clean::clean_counted;
pub use clean::{clean, CleanOptions};
pub(crate) use components::{drop_inverted, drop_strays, FEWEST, FEWEST_AMID_NOISE};
pub use components::{filter_shells, Keep, MinVolume, Selection, ShellFilter, Shells};
pub use extract::{raw_crust, Placement};
pub use mend::{mend_crust, MendOptions, Mending};
pub use raw::{Crust, RawCrust, NONE};
pub use shape::{power_shape, PowerShape};
pub use triangulate::triangulate;
pub(crate) use triangulate::{triangulate_faces, Triangles};
