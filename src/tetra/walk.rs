//! Finding the cell that holds a site.

use super::complex::{unpack, Complex};
use super::corners;
use crate::predicates::{separating, Counts, Site};

/// The cell of a complex that holds a site (its boundary included); the site
/// must lie inside the frame.
pub fn locate(
    complex: &Complex,
    sites: &[Site],
    site: &Site,
    hint: u32,
    counts: &mut Counts,
) -> u32 {
    let vertices = |c: u32| complex.cells[c as usize];
    let behind = |c: u32, i: usize| complex.neighbours[c as usize][i];
    match walk(sites, site, hint, vertices, behind, |_, _, _| true, counts) {
        Ok(cell) | Err(cell) => cell,
    }
}

/// The visibility walk: cross any facet that separates the site from the
/// cell. In a regular triangulation, with exact signs, it cannot go round in
/// circles (Edelsbrunner 1990). `enter` is asked before each step, with the
/// vertices here, the facet, and the packed facet behind it; where it says no the last
/// cell is an error.
#[inline]
pub(super) fn walk(
    sites: &[Site],
    site: &Site,
    hint: u32,
    vertices: impl Fn(u32) -> [u32; 4],
    behind: impl Fn(u32, usize) -> u32,
    mut enter: impl FnMut([u32; 4], usize, u32) -> bool,
    counts: &mut Counts,
) -> Result<u32, u32> {
    let mut at = hint;
    let mut v = vertices(at);
    // The facet crossed last: the site is known to lie on this side.
    let mut crossed = 4;
    loop {
        let Some(i) = separating(corners(sites, v), site, crossed, counts) else {
            return Ok(at);
        };
        let packed = behind(at, i);
        if !enter(v, i, packed) {
            return Err(at);
        }
        (at, crossed) = unpack(packed);
        v = vertices(at);
    }
}
