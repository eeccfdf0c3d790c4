//! Watertight surfaces and medial axes from point clouds by the power crust
//! (Amenta, Choi and Kolluri 2001).

pub mod attributes;
pub mod context;
pub mod delaunay;
pub mod error;
pub mod geom;
pub mod io;
pub mod label;
pub mod memory;
pub mod mesh;
pub mod options;
pub mod pipeline;
pub mod poles;
pub mod power;
pub mod predicates;
pub mod simplify;
pub mod stats;
pub mod surface;
pub mod tetra;

pub use context::{Cancelled, Context, Progress, Silent, Stage};
pub use error::{Error, SampleError};
pub use geom::{Ball, Bounds, Point, Side};
pub use mesh::PolygonMesh;
pub use options::{Faces, Options};
pub use pipeline::{reconstruct, PolarBall, Reconstruction};
pub use stats::Stats;
pub use surface::{Crust, PowerShape};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
