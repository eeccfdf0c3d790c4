//! Fewer balls for the same shape (section 7.3 of the paper), and what is
//! asked of a simplicial complex meanwhile: its Betti numbers, and a thinner
//! one of the same homotopy type.

mod betti;
mod collapse;
mod contact;
mod contained;
mod incidence;
mod redundant;

pub use betti::{betti, Betti};
pub use collapse::{thin, Thinned};
pub use contact::{Contact, Touching};
pub use contained::redundant as contained_balls;
pub use incidence::Simplices;
pub use redundant::merge_redundant;
