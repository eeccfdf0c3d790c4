//! The medial axis as labelled balls: simplified, and written as a power
//! shape again (section 7.3 of the paper).
//!
//! [`LabelledBalls`] holds balls of both sides with their power diagram,
//! whether they come from a reconstruction or from a file. [`simplify`] takes
//! balls out and makes the diagram of those that stay, with the old labels.
//! Files of other programs hold inner balls only: the dual complex then says which
//! simplices there are, by the union of the balls alone.

mod cover;
mod dual;
mod estimate;
mod labelled;
mod options;
mod query;
mod scale;
mod simplify;
mod skeleton;
mod structure;

pub use labelled::LabelledBalls;
pub use options::SimplifyOptions;
pub use query::{Answer, MedialAxis, NO_BALL};
pub use simplify::{simplify, Simplified, SimplifyReport};
pub use skeleton::{skeleton, Skeleton};
pub use structure::{structure, Curve, Junction, Sheet, Structure, NO_PART};
