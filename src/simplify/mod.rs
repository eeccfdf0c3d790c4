//! Fewer balls for the same shape (section 7.3 of the paper).

mod redundant;

pub use redundant::merge_redundant;
