//! The combinatorial core of both triangulations: cells, neighbours, walk,
//! cavity, spatial order. It knows no coordinates; what a site is and when it
//! conflicts with a cell is the business of a [`Conflict`].
//!
//! Every triangulation here lives inside a **frame**: eight sites at the
//! corners of a cube that holds all others strictly inside. The cube is
//! triangulated first (`frame.rs`), its hull never changes, and no insertion
//! ever leaves it: there are no infinite cells and no special cases for them.
//! Since the perturbed weights of [`crate::predicates`] make the regular
//! triangulation unique, the result does not depend on the order of insertion.

mod build;
mod cavity;
mod check;
mod complex;
mod frame;
mod number;
pub mod order;
mod region;
mod store;
mod walk;

pub use build::{extend, triangulate, Triangulation};
pub use check::{check, Finding};
pub use complex::{facet_of, pack, unpack, Complex, FACETS, MOST_CELLS, NONE};
pub use walk::locate;

use crate::predicates::{conflict, conflict_weighted, orient, Counts, Sign, Site};

/// When does a site destroy a cell? The two triangulations differ here only.
pub trait Conflict: Sync {
    /// Whether sites have weights: then some may end up without a cell.
    const WEIGHTED: bool;
    /// The sites by vertex id.
    fn sites(&self) -> &[Site];
    /// Does site `p` conflict with the positive cell?
    fn conflicts(&self, cell: [u32; 4], p: u32, counts: &mut Counts) -> bool;
    /// The orientation of four sites.
    #[inline]
    fn orient(&self, v: [u32; 4], counts: &mut Counts) -> Sign {
        let s = self.sites();
        orient(
            &s[v[0] as usize],
            &s[v[1] as usize],
            &s[v[2] as usize],
            &s[v[3] as usize],
            counts,
        )
    }
}

/// Conflict with the circumsphere: the Delaunay triangulation.
pub struct InSphere<'a>(pub &'a [Site]);

impl Conflict for InSphere<'_> {
    const WEIGHTED: bool = false;
    #[inline]
    fn sites(&self) -> &[Site] {
        self.0
    }
    #[inline]
    fn conflicts(&self, cell: [u32; 4], p: u32, counts: &mut Counts) -> bool {
        conflict(corners(self.0, cell), &self.0[p as usize], counts)
    }
}

/// Conflict with the orthosphere: the regular triangulation.
pub struct InPower<'a>(pub &'a [Site]);

impl Conflict for InPower<'_> {
    const WEIGHTED: bool = true;
    #[inline]
    fn sites(&self) -> &[Site] {
        self.0
    }
    #[inline]
    fn conflicts(&self, cell: [u32; 4], p: u32, counts: &mut Counts) -> bool {
        conflict_weighted(corners(self.0, cell), &self.0[p as usize], counts)
    }
}

/// The sites of a cell.
#[inline]
fn corners(sites: &[Site], cell: [u32; 4]) -> [&Site; 4] {
    let [a, b, c, d] = cell;
    [
        &sites[a as usize],
        &sites[b as usize],
        &sites[c as usize],
        &sites[d as usize],
    ]
}
