//! What a triangulation must satisfy, clause by clause.
//!
//! 1. Facets match: `neighbours` is an involution on packed facets that keeps
//!    their corners ([`Complex::check`]); facets without a neighbour have
//!    corners of the frame only.
//! 2. Every cell is positively oriented.
//! 3. No cell conflicts with the site behind any of its facets. By Delaunay's
//!    lemma no cell then conflicts with any site at all.
//! 4. Every site has a cell or is listed as hidden, not both; a hidden site
//!    does not conflict with the cell it lies in. The frame is never hidden.

use super::complex::{unpack, Complex, NONE};
use super::walk::locate;
use super::Conflict;
use crate::predicates::{Counts, Sign};

/// One thing wrong with a triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// A cell names a site that does not exist.
    NoSuchSite {
        /// The cell.
        cell: u32,
        /// The vertex it names.
        site: u32,
    },
    /// The facet behind a facet has other corners or does not lead back.
    Unmatched {
        /// The cell.
        cell: u32,
        /// Its facet.
        facet: usize,
    },
    /// A facet inside the frame has nothing behind it.
    Open {
        /// The cell.
        cell: u32,
        /// Its facet.
        facet: usize,
    },
    /// A cell is flat or negatively oriented.
    NotPositive {
        /// The cell.
        cell: u32,
    },
    /// A cell conflicts with the site behind one of its facets.
    Conflicting {
        /// The cell.
        cell: u32,
        /// The site.
        site: u32,
    },
    /// A site has no cell and is not listed as hidden.
    Lost {
        /// The site.
        site: u32,
    },
    /// A site has cells or belongs to the frame and is listed as hidden.
    NotHidden {
        /// The site.
        site: u32,
    },
    /// A hidden site conflicts with the cell it lies in.
    WronglyHidden {
        /// The site.
        site: u32,
        /// The cell.
        cell: u32,
    },
}

/// Everything wrong with the triangulation of the sites of `test`, the last
/// eight of which are the frame's.
pub fn check<C: Conflict>(complex: &Complex, hidden: &[u32], test: &C) -> Vec<Finding> {
    let mut counts = Counts::default();
    let sites = test.sites().len() as u32;
    let frame = sites - 8;
    let mut found = Vec::new();
    for (c, cell) in (0u32..).zip(&complex.cells) {
        for &site in cell.iter().filter(|&&v| v >= sites) {
            found.push(Finding::NoSuchSite { cell: c, site });
        }
    }
    for packed in complex.check() {
        let (cell, facet) = unpack(packed);
        found.push(Finding::Unmatched { cell, facet });
    }
    if !found.is_empty() {
        return found;
    }

    let mut has_cell = vec![false; sites as usize];
    for (c, cell) in (0u32..).zip(&complex.cells) {
        let positive = test.orient(*cell, &mut counts) == Sign::Positive;
        if !positive {
            found.push(Finding::NotPositive { cell: c });
        }
        for i in 0..4 {
            has_cell[cell[i] as usize] = true;
            let behind = complex.neighbours[c as usize][i];
            if behind == NONE {
                if (0..4).any(|k| k != i && cell[k] < frame) {
                    found.push(Finding::Open { cell: c, facet: i });
                }
                continue;
            }
            let (d, j) = unpack(behind);
            let site = complex.cells[d as usize][j];
            if positive && test.conflicts(*cell, site, &mut counts) {
                found.push(Finding::Conflicting { cell: c, site });
            }
        }
    }

    let mut listed = vec![false; sites as usize];
    for &site in hidden {
        listed[site as usize] = true;
    }
    for site in 0..sites {
        match (has_cell[site as usize], listed[site as usize]) {
            (false, false) => found.push(Finding::Lost { site }),
            (true, true) => found.push(Finding::NotHidden { site }),
            _ => {}
        }
    }
    if found.is_empty() {
        // The walk ends in triangulations that pass all of the above.
        let mut hint = 0;
        for &site in hidden {
            let at = &test.sites()[site as usize];
            hint = locate(complex, test.sites(), at, hint, &mut counts);
            if test.conflicts(complex.cells[hint as usize], site, &mut counts) {
                found.push(Finding::WronglyHidden { site, cell: hint });
            }
        }
    }
    found
}
