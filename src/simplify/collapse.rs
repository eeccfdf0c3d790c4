//! A thin complex of the same homotopy type: the flat tetrahedra of a power
//! shape (section 3.4 of the paper) collapsed away.
//!
//! Two steps, none of which changes a Betti number, as each is one or two
//! elementary collapses:
//! 1. an edge that only one tetrahedron and two triangles have goes with them:
//!    of four balls about a quadrilateral the two triangles along the other
//!    diagonal stay;
//! 2. where there is no such edge, a triangle that only one tetrahedron has
//!    goes with it.
//!
//! Step 1 goes first, the longest edge before others, then the triangle with
//! the longest border; equals in the order of their corners. A set of
//! tetrahedra in space always has a triangle on its outside, so none is left;
//! only a complex read from a file can hold tetrahedra that close up on each other,
//! and those are counted. Sheets are left alone: where they enclose a void
//! they go on doing so.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::incidence::{Cofaces, Simplices};

/// A complex without the tetrahedra that could be collapsed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thinned {
    /// What is left.
    pub complex: Simplices,
    /// Tetrahedra collapsed.
    pub collapsed: usize,
}

/// Collapses tetrahedra; `length_sq` is the squared length of an edge given by
/// its corners. The complex must have all faces of its simplices, as
/// [`Simplices::closed`] makes it.
///
/// ```
/// use powercrust::simplify::{thin, Simplices};
/// let flat = Simplices::closed(4, &[], &[], &[[0, 1, 2, 3]]);
/// let longer = |_: [u32; 2]| 1.0;
/// let sheet = thin(&flat, &longer).complex;
/// assert_eq!((sheet.triangles.len(), sheet.tetrahedra.len()), (2, 0));
/// ```
pub fn thin(complex: &Simplices, length_sq: &dyn Fn([u32; 2]) -> f64) -> Thinned {
    if complex.tetrahedra.is_empty() {
        return Thinned {
            complex: complex.clone(),
            collapsed: 0,
        };
    }
    let mut work = Work::new(complex, length_sq);
    work.run();
    fn kept<const N: usize>(list: &[[u32; N]], there: &[bool]) -> Vec<[u32; N]> {
        let both = list.iter().zip(there);
        both.filter(|(_, &there)| there).map(|(s, _)| *s).collect()
    }
    let tetrahedra = kept(&complex.tetrahedra, &work.tetrahedra);
    Thinned {
        collapsed: complex.tetrahedra.len() - tetrahedra.len(),
        complex: Simplices {
            vertices: complex.vertices,
            edges: kept(&complex.edges, &work.edges),
            triangles: kept(&complex.triangles, &work.triangles),
            tetrahedra,
        },
    }
}

/// A length as a key whose order is that of the lengths.
type Key = (u64, Reverse<u32>);

struct Work<'a> {
    triangle_edges: Vec<[u32; 3]>,
    tetrahedron_triangles: Vec<[u32; 4]>,
    tetrahedron_edges: Vec<[u32; 6]>,
    lengths: Vec<f64>,
    complex: &'a Simplices,
    edges: Vec<bool>,
    triangles: Vec<bool>,
    tetrahedra: Vec<bool>,
    /// Triangles at edges, tetrahedra at triangles, tetrahedra at edges.
    at_edge: Cofaces,
    at_triangle: Cofaces,
    round_edge: Cofaces,
    diagonals: BinaryHeap<Key>,
    free: BinaryHeap<Key>,
}

impl<'a> Work<'a> {
    fn new(complex: &'a Simplices, length_sq: &dyn Fn([u32; 2]) -> f64) -> Work<'a> {
        let incidence = complex.incidence();
        let (triangle_edges, tetrahedron_triangles) =
            (incidence.triangle_edges, incidence.tetrahedron_triangles);
        let six = |faces: &[u32; 4]| {
            // Every edge lies in two faces: three of the first, and of the
            // others those it has not.
            let mut all: Vec<u32> = (faces.iter())
                .flat_map(|&t| triangle_edges[t as usize])
                .collect();
            all.sort_unstable();
            all.dedup();
            let mut edges = all.into_iter();
            [0; 6].map(|_| edges.next().unwrap_or_default())
        };
        let tetrahedron_edges: Vec<[u32; 6]> = tetrahedron_triangles.iter().map(six).collect();
        let lengths = complex.edges.iter().map(|&e| length_sq(e)).collect();
        Work {
            edges: vec![true; complex.edges.len()],
            triangles: vec![true; complex.triangles.len()],
            tetrahedra: vec![true; complex.tetrahedra.len()],
            at_edge: Cofaces::of(complex.edges.len(), &triangle_edges),
            at_triangle: Cofaces::of(complex.triangles.len(), &tetrahedron_triangles),
            round_edge: Cofaces::of(complex.edges.len(), &tetrahedron_edges),
            diagonals: BinaryHeap::new(),
            free: BinaryHeap::new(),
            triangle_edges,
            tetrahedron_triangles,
            tetrahedron_edges,
            lengths,
            complex,
        }
    }

    fn run(&mut self) {
        for e in 0..self.complex.edges.len() as u32 {
            self.offer_edge(e);
        }
        for t in 0..self.complex.triangles.len() as u32 {
            self.offer_triangle(t);
        }
        loop {
            if let Some((_, Reverse(e))) = self.diagonals.pop() {
                self.drop_diagonal(e);
            } else if let Some((_, Reverse(t))) = self.free.pop() {
                self.drop_triangle(t);
            } else {
                return;
            }
        }
    }

    /// The tetrahedron of an edge that no other one has and that lies in no
    /// triangle but its two.
    fn flat_at(&self, e: u32) -> Option<u32> {
        let there = self.edges[e as usize] && self.at_edge.count[e as usize] == 2;
        self.round_edge.only(e).filter(|_| there)
    }

    fn offer_edge(&mut self, e: u32) {
        if self.flat_at(e).is_some() {
            let key = self.lengths[e as usize].to_bits();
            self.diagonals.push((key, Reverse(e)));
        }
    }

    fn offer_triangle(&mut self, t: u32) {
        if self.triangles[t as usize] && self.at_triangle.only(t).is_some() {
            let lengths = self.triangle_edges[t as usize].map(|e| self.lengths[e as usize].sqrt());
            let border = lengths[0] + lengths[1] + lengths[2];
            self.free.push((border.to_bits(), Reverse(t)));
        }
    }

    fn drop_diagonal(&mut self, e: u32) {
        let Some(solid) = self.flat_at(e) else {
            return;
        };
        self.remove_tetrahedron(solid);
        for t in self.tetrahedron_triangles[solid as usize] {
            if self.triangle_edges[t as usize].contains(&e) {
                self.remove_triangle(t);
            }
        }
        self.edges[e as usize] = false;
        self.offer_around(solid);
    }

    fn drop_triangle(&mut self, t: u32) {
        if !self.triangles[t as usize] {
            return;
        }
        let Some(solid) = self.at_triangle.only(t) else {
            return;
        };
        self.remove_tetrahedron(solid);
        self.remove_triangle(t);
        self.offer_around(solid);
    }

    fn remove_tetrahedron(&mut self, s: u32) {
        self.tetrahedra[s as usize] = false;
        let faces = &self.tetrahedron_triangles[s as usize];
        self.at_triangle.remove(s, faces);
        self.round_edge
            .remove(s, &self.tetrahedron_edges[s as usize]);
    }

    fn remove_triangle(&mut self, t: u32) {
        self.triangles[t as usize] = false;
        self.at_edge.remove(t, &self.triangle_edges[t as usize]);
    }

    /// What a tetrahedron that went may have made ready.
    fn offer_around(&mut self, solid: u32) {
        for e in self.tetrahedron_edges[solid as usize] {
            self.offer_edge(e);
        }
        for t in self.tetrahedron_triangles[solid as usize] {
            self.offer_triangle(t);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{betti, Betti};
    use super::*;

    fn even(_: [u32; 2]) -> f64 {
        1.0
    }

    #[test]
    fn the_shorter_diagonal_stays() {
        let flat = Simplices::closed(4, &[], &[], &[[0, 1, 2, 3]]);
        let long = |e: [u32; 2]| if e == [1, 2] { 3.0 } else { 1.0 };
        let sheet = thin(&flat, &long).complex;
        assert_eq!(sheet.triangles, [[0, 1, 3], [0, 2, 3]]);
        assert_eq!(sheet.edges.len(), 5);
    }

    #[test]
    fn all_tetrahedra_go_and_betti_numbers_stay() {
        // A bar of cubes cut into six tetrahedra each, bent to a ring.
        for (cubes, ring) in [(3u32, false), (5, true)] {
            let layer = |k: u32| if ring { k % cubes } else { k };
            let corner = |k: u32, bits: u32| 4 * layer(k + (bits & 1)) + (bits >> 1);
            let mut solids = Vec::new();
            for k in 0..cubes {
                // Paths along three axes from corner 0 to corner 7.
                for order in [
                    [1, 2, 4],
                    [1, 4, 2],
                    [2, 1, 4],
                    [2, 4, 1],
                    [4, 1, 2],
                    [4, 2, 1],
                ] {
                    let mut at = 0;
                    let mut path = [corner(k, 0); 4];
                    for (i, step) in order.into_iter().enumerate() {
                        at += step;
                        path[i + 1] = corner(k, at);
                    }
                    solids.push(path);
                }
            }
            let vertices = 4 * (cubes as usize + usize::from(!ring));
            let complex = Simplices::closed(vertices, &[], &[], &solids);
            let before = betti(&complex);
            let tunnels = u64::from(ring);
            assert_eq!(
                before,
                Betti {
                    parts: 1,
                    tunnels,
                    ..Betti::default()
                }
            );
            let thinned = thin(&complex, &even);
            assert_eq!(thinned.collapsed, complex.tetrahedra.len());
            assert_eq!(thinned.complex.tetrahedra, [[0; 4]; 0]);
            assert_eq!(betti(&thinned.complex), before);
        }
    }

    #[test]
    fn what_closes_up_on_itself_stays() {
        let sphere: Vec<[u32; 4]> = vec![
            [1, 2, 3, 4],
            [0, 2, 3, 4],
            [0, 1, 3, 4],
            [0, 1, 2, 4],
            [0, 1, 2, 3],
        ];
        let complex = Simplices::closed(5, &[], &[], &sphere);
        let thinned = thin(&complex, &even);
        assert_eq!(thinned.collapsed, 0);
        assert_eq!(thinned.complex, complex);
    }
}
