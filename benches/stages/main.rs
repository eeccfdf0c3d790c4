//! How long each stage takes, by the public API, on clouds made here.
//!
//! ```sh
//! cargo bench                     # everything
//! cargo bench -- delaunay         # what has that in its name
//! cargo bench -- mend --sample-count 20
//! RAYON_NUM_THREADS=1 cargo bench # on one thread
//! ```
//!
//! Stages and clouds are those of the tests, so that there is one place to
//! change. Whole runs, and the comparison with other programs, are the business
//! of `scripts/bench`.

#[path = "../../tests/common/mod.rs"]
mod common;
// The tests use more of it.
#[allow(dead_code)]
#[path = "../../tests/stages/run.rs"]
mod run;

mod clouds;
mod files;
mod kernel;
mod surface;

fn main() {
    // Stages take up to seconds: five runs each unless the caller says otherwise.
    divan::Divan::default()
        .sample_count(5)
        .config_with_args()
        .main();
}
