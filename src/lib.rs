//! Watertight surfaces and medial axes from point clouds by the power crust
//! (Amenta, Choi and Kolluri 2001).
//!
//! ```
//! use powercrust::{reconstruct, Context, Options, Side};
//! # let points: Vec<[f64; 3]> = (0..400).map(|k| {
//! #     let (z, a) = ((k as f64 + 0.5) / 200.0 - 1.0, k as f64 * 2.399963);
//! #     let r = (1.0 - z * z).sqrt();
//! #     [r * a.cos(), r * a.sin(), z]
//! # }).collect();
//! let result = reconstruct(&points, &Options::default(), &Context::default())?;
//! println!("{} triangles", result.crust.mesh.face_count());
//! let axis = result.power_shape(Side::Inner);
//! # assert!((result.crust.mesh.volume() - 4.1).abs() < 0.1);
//! # assert!(!axis.balls.is_empty());
//! # Ok::<(), powercrust::Error>(())
//! ```
//!
//! # Catalogue
//!
//! **The whole way**
//! - [`reconstruct`], [`reconstruct_seen`]: points in, [`Reconstruction`] out
//! - [`Options`], [`Faces`], [`LabelOption`], [`LambdaOption`], [`NoiseOption`], [`OutlierOption`], [`SharpOption`]: what may be said; the default says nothing
//! - [`Context`], [`Progress`], [`Silent`], [`Stage`], [`Cancelled`]: threads, progress, a stop button
//! - [`Error`], [`SampleError`]: why there is no surface
//! - [`Stats`]: counts, timings, options of a run
//!
//! **Results**
//! - [`Crust`]: the surface, its samples, the balls at its faces
//! - [`PowerShape`]: a medial axis as balls, edges, triangles, tetrahedra
//! - [`PolarBall`], [`Ball`], [`Side`]: the balls and their labels
//! - [`PolygonMesh`], [`Point`], [`Bounds`]: plain geometry
//! - [`attributes`]: colours, normals and values of the input on the surface, thickness on its faces
//! - [`holes`]: faces that bridge missing data, and the surface without them
//!
//! **One stage at a time** (section 5 of the paper)
//! - [`delaunay::samples`]: finite, distinct points on a lattice
//! - [`noise::outliers`]: samples on no surface
//! - [`noise::treat`]: samples amid noise moved onto the surface
//! - [`delaunay::delaunay`]: their Delaunay triangulation
//! - [`noise::corners`]: samples at sharp edges
//! - [`poles::poles`]: poles and polar balls, the skinniness test
//! - [`simplify::merge_redundant`]: one ball for many that say the same
//! - [`power::power_diagram`]: the regular triangulation of balls
//! - [`label::label`], [`label::refine`], [`label::energy`], [`label::hold`]: inner or outer
//! - [`surface::raw_crust`], [`surface::clean`], [`surface::triangulate`]: the surface between unlike cells
//! - [`surface::power_shape`]: the axis among like balls
//!
//! **Medial axes** (section 7.3)
//! - [`axis::LabelledBalls`]: balls with labels and power diagram, of a result or of a file
//! - [`axis::simplify`]: without unstable and redundant balls
//! - [`Reconstruction::medial_axis`], [`axis::MedialAxis`]: side, distance, nearest ball, thickness at points
//! - [`axis::structure`], [`axis::skeleton`]: sheets, seams, junctions, rims; edges only
//! - [`PowerShape::thin`], [`PowerShape::betti`]: without flat tetrahedra; parts, tunnels, voids
//! - [`simplify::Contact`]: what the samples on a ball span
//!
//! **Made from a result, or from balls**
//! - [`inverse::crust_of_balls`]: the surface that a medial axis stands for; unions of balls
//! - [`offset::Offsets`]: surfaces at a distance, shells
//!
//! **Meshes**
//! - [`mesh::check`]: is a mesh closed, manifold, oriented and free of crossings? Exact
//! - [`mesh::components`], [`mesh::component_volumes`], [`mesh::enclosing`]: its parts
//! - [`mesh::Surface`]: distances to it
//!
//! **Files**
//! - [`io::read_cloud`], [`io::read_mesh`], [`io::read_axis`], [`io::read_balls`]
//! - [`io::write_mesh`], [`io::write_axis`], [`io::write_axis_parts`], [`io::write_balls`]
//!
//! **Kernel**
//! - [`predicates`]: orientation, in-sphere, in-power-sphere: filter, exact, perturbed
//! - [`tetra`]: cells, walk, cavity, order
//! - [`memory`]: what a run takes
//!
//! # Features
//! `cli` (default) builds the command; libraries turn it off with
//! `default-features = false`.

#![forbid(unsafe_code)]

pub mod attributes;
pub mod axis;
pub mod context;
pub mod delaunay;
pub mod error;
mod fit;
pub mod geom;
pub mod holes;
pub mod inverse;
pub mod io;
pub mod label;
pub mod memory;
pub mod mesh;
pub mod noise;
pub mod offset;
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
pub use options::{
    Faces, LabelOption, LambdaOption, NoiseOption, Options, OutlierOption, SharpOption,
};
pub use pipeline::{reconstruct, reconstruct_seen, PolarBall, Reconstruction};
pub use stats::Stats;
pub use surface::{Crust, PowerShape};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
