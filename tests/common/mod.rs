//! What the integration tests share: random numbers, shapes whose true
//! surface is known, and a judge of meshes that uses nothing of the crate
//! but its plain types.

// Each test crate uses its own part.
#![allow(dead_code)]

pub mod judge;
pub mod random;
pub mod shapes;

use powercrust::{reconstruct, Context, Faces, Options, Point, Reconstruction};
use std::num::NonZeroUsize;

/// Whether the long versions of the tests are wanted (`POWERCRUST_FULL=1`).
pub fn full() -> bool {
    std::env::var_os("POWERCRUST_FULL").is_some_and(|value| value == "1")
}

/// The default options with polygons instead of triangles.
pub fn polygons() -> Options {
    Options {
        faces: Faces::Polygons,
        ..Options::default()
    }
}

/// A context with a given number of threads.
pub fn threads(count: usize) -> Context<'static> {
    Context {
        threads: NonZeroUsize::new(count),
        ..Context::default()
    }
}

/// Reconstructs, or fails the test with the name of the case.
#[track_caller]
pub fn crust(name: &str, points: &[Point], options: &Options) -> Reconstruction {
    match reconstruct(points, options, &Context::default()) {
        Ok(result) => result,
        Err(error) => panic!("{name}: no reconstruction: {error}"),
    }
}
