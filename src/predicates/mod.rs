//! Exact decisions on lattice sites: orientation, in-sphere, in-power-sphere.
//!
//! Sites are integers held in `f64`: samples are rounded once, on entry, to a
//! lattice of about 2^-42 of the bounding box ([`crate::delaunay::Samples`]),
//! balls to a coarser one ([`crate::power`]); section 8 of the paper calls
//! this 'rounded to a fixed precision', and fact F1 says why it pays. Every
//! decision about sites is then taken in three stages, each counted:
//!
//! 1. **filter**: the determinant in floats with a bound on its error.
//!    Differences of sites are exact, so the bound starts at the products;
//! 2. **exact**: the same determinant in integers of 128 or 256 bits, no
//!    allocation. Coordinates are at most [`LIMIT`] = 2^46 in size, hence
//!    differences at most 2^47, lifted differences at most 2^96, a 3 by 3
//!    minor at most 2^144 (Hadamard) and the 4 by 4 determinant at most 2^242;
//! 3. **perturbation**: where the determinant is exactly zero, the weight of
//!    each site is raised by an infinitesimal of its own, larger for sites that
//!    come later in lexicographic order (Edelsbrunner and Mücke 1990; for
//!    spheres Devillers and Teillaud 2011). The order knows coordinates only, so the outcome
//!    depends on neither input order, insertion order nor threads.
//!
//! `robust` decides the same signs; it is the oracle of the tests and judges
//! output meshes. It is not used here: on cospherical points its in-sphere
//! test takes 14,700 ns where the integers take about a hundred, and it has no weighted
//! test at all.
//!
//! Convention: a tetrahedron `abcd` is positive when `det(b-a, c-a, d-a) > 0`.

mod orient;
mod power;
pub mod wide;

pub use orient::{orient, separating};
pub use power::{conflict, conflict_weighted};

/// A site: integer coordinates and, last, an integer weight (the squared
/// radius of a ball; 0 for a sample).
pub type Site = [f64; 4];

/// Largest size of a coordinate of a site.
pub const LIMIT: f64 = 70_368_744_177_664.0; // 2^46

/// The sign of a determinant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sign {
    /// Below zero.
    Negative,
    /// Exactly zero.
    Zero,
    /// Above zero.
    Positive,
}

impl Sign {
    /// The sign of an integer.
    #[inline]
    pub fn of(v: i128) -> Sign {
        match v.cmp(&0) {
            std::cmp::Ordering::Less => Sign::Negative,
            std::cmp::Ordering::Equal => Sign::Zero,
            std::cmp::Ordering::Greater => Sign::Positive,
        }
    }
}

/// How many decisions each stage took. Several threads take some twice, for
/// insertions put off: the numbers depend on threads, what was decided does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// Orientation tests decided by the float filter.
    pub orient_filter: u64,
    /// Orientation tests decided in integers.
    pub orient_exact: u64,
    /// Sphere tests decided by the float filter.
    pub sphere_filter: u64,
    /// Sphere tests decided in integers.
    pub sphere_exact: u64,
    /// Sphere tests that were exactly zero and decided by perturbation.
    pub sphere_perturbed: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.orient_filter += other.orient_filter;
        self.orient_exact += other.orient_exact;
        self.sphere_filter += other.sphere_filter;
        self.sphere_exact += other.sphere_exact;
        self.sphere_perturbed += other.sphere_perturbed;
    }
}

/// The squared distance of two sites, rounded: a hint where to start, never
/// a decision.
#[inline]
pub fn distance_sq(a: &Site, b: &Site) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

/// The order of perturbation: lexicographic by coordinates, then weight.
#[inline]
pub fn precedes(a: &Site, b: &Site) -> bool {
    for k in 0..4 {
        if a[k] != b[k] {
            return a[k] < b[k];
        }
    }
    false
}
