//! The triangulation of the frame's eight corners, by definition: of all
//! quadruples that are not flat, those with which none of the other corners
//! conflicts. The corners of a cube are cospherical, so perturbation decides;
//! doing it by definition keeps it in step with the predicates.

use super::complex::{pack, Complex, FACETS, NONE};
use super::Conflict;
use crate::predicates::{Counts, Sign};

/// The cells of the frame, whose corners are the vertices
/// `first .. first + 8`.
pub fn frame<C: Conflict>(test: &C, first: u32, counts: &mut Counts) -> Complex {
    let mut complex = Complex::default();
    for a in 0..8u32 {
        for b in a + 1..8 {
            for c in b + 1..8 {
                for d in c + 1..8 {
                    let mut cell = [a, b, c, d].map(|k| first + k);
                    match test.orient(cell, counts) {
                        Sign::Zero => continue,
                        Sign::Negative => cell.swap(0, 1),
                        Sign::Positive => {}
                    }
                    let empty = (first..first + 8)
                        .filter(|v| !cell.contains(v))
                        .all(|v| !test.conflicts(cell, v, counts));
                    if empty {
                        complex.cells.push(cell);
                    }
                }
            }
        }
    }
    complex.neighbours = vec![[NONE; 4]; complex.cells.len()];
    let facet = |c: usize, i: usize| {
        let mut f = FACETS[i].map(|k| complex.cells[c][k]);
        f.sort_unstable();
        f
    };
    for c in 0..complex.cells.len() {
        for i in 0..4 {
            for d in 0..complex.cells.len() {
                for j in 0..4 {
                    if d != c && facet(c, i) == facet(d, j) {
                        complex.neighbours[c][i] = pack(d as u32, j);
                    }
                }
            }
        }
    }
    complex
}
