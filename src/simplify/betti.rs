//! Betti numbers over Z/2, exactly.
//!
//! The complex is collapsed first, a free face and the simplex it bounds at a
//! time, which changes no Betti number and leaves little of most shapes.
//! Of what is left the ranks of the boundary maps are found by their kernels:
//! a cycle is a set of simplices that meets every face an even number of
//! times, so at a face of two simplices both are in it or neither, and at a
//! face of one that one is not. Simplices joined in this way are one unknown: a
//! sheet. Only faces where three or more sheets meet are equations, which are
//! solved by elimination.

use std::collections::HashMap;

use super::incidence::{Cofaces, Incidence, Simplices};
use crate::geom::Sets;

/// The Betti numbers of a complex: parts, tunnels, voids; the last is not 0
/// only where tetrahedra enclose a solid that space cannot hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Betti {
    /// Connected parts, b0.
    pub parts: u64,
    /// Independent tunnels, b1.
    pub tunnels: u64,
    /// Enclosed voids, b2.
    pub voids: u64,
    /// Independent closed sets of tetrahedra, b3: 0 for all that fits in
    /// space.
    pub solids: u64,
}

impl Betti {
    /// The Euler characteristic.
    pub fn euler(&self) -> i64 {
        self.parts as i64 - self.tunnels as i64 + self.voids as i64 - self.solids as i64
    }
}

impl std::fmt::Display for Betti {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, {}, {}", self.parts, self.tunnels, self.voids)?;
        match self.solids {
            0 => Ok(()),
            b3 => write!(f, ", {b3}"),
        }
    }
}

/// The Betti numbers of a complex that has all faces of its simplices, as
/// [`Simplices::closed`] makes it.
///
/// ```
/// use powercrust::simplify::{betti, Simplices};
/// // The surface of a tetrahedron encloses a void.
/// let faces = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
/// let b = betti(&Simplices::closed(4, &[], &faces, &[]));
/// assert_eq!((b.parts, b.tunnels, b.voids), (1, 0, 1));
/// ```
pub fn betti(complex: &Simplices) -> Betti {
    let core = Core::of(complex);
    let [v, e, t, s] = core.counts();
    let parts = core.parts(complex);
    let rank_1 = v - parts;
    let cycles_2 = kernel(
        t,
        &core.equations(&core.incidence.triangle_edges, &core.triangles),
    );
    let cycles_3 = kernel(
        s,
        &core.equations(&core.incidence.tetrahedron_triangles, &core.tetrahedra),
    );
    Betti {
        parts,
        tunnels: (e - rank_1) - (t - cycles_2),
        voids: cycles_2 - (s - cycles_3),
        solids: cycles_3,
    }
}

/// What is left of a complex when nothing can be collapsed any more.
struct Core {
    incidence: Incidence,
    vertices: Vec<bool>,
    edges: Vec<bool>,
    triangles: Vec<bool>,
    tetrahedra: Vec<bool>,
}

impl Core {
    fn of(complex: &Simplices) -> Core {
        let incidence = complex.incidence();
        let mut core = Core {
            vertices: vec![true; complex.vertices],
            edges: vec![true; complex.edges.len()],
            triangles: vec![true; complex.triangles.len()],
            tetrahedra: vec![true; complex.tetrahedra.len()],
            incidence,
        };
        let Incidence {
            triangle_edges,
            tetrahedron_triangles,
        } = &core.incidence;
        let solid = squeeze(
            tetrahedron_triangles,
            &mut core.triangles,
            &mut core.tetrahedra,
            |_| true,
        );
        // A triangle may go only when no tetrahedron has it any more.
        let bare = |t: u32| solid.count[t as usize] == 0;
        let flat = squeeze(triangle_edges, &mut core.edges, &mut core.triangles, bare);
        let bare = |e: u32| flat.count[e as usize] == 0;
        squeeze(&complex.edges, &mut core.vertices, &mut core.edges, bare);
        core
    }

    fn counts(&self) -> [u64; 4] {
        let there = |list: &[bool]| list.iter().filter(|&&b| b).count() as u64;
        [
            there(&self.vertices),
            there(&self.edges),
            there(&self.triangles),
            there(&self.tetrahedra),
        ]
    }

    fn parts(&self, complex: &Simplices) -> u64 {
        let mut sets = Sets::new(complex.vertices);
        let mut parts = self.vertices.iter().filter(|&&v| v).count() as u64;
        for (e, &[a, b]) in complex.edges.iter().enumerate() {
            parts -= u64::from(self.edges[e] && sets.join(a, b));
        }
        parts
    }

    /// For each face the simplices there, numbered among those that are left.
    fn equations<const N: usize>(&self, boundaries: &[[u32; N]], there: &[bool]) -> Vec<Vec<u32>> {
        let mut of_face: Vec<(u32, u32)> = Vec::new();
        let mut number = 0;
        for (s, boundary) in boundaries.iter().enumerate() {
            if there[s] {
                of_face.extend(boundary.iter().map(|&face| (face, number)));
                number += 1;
            }
        }
        of_face.sort_unstable();
        of_face
            .chunk_by(|a, b| a.0 == b.0)
            .map(|group| group.iter().map(|&(_, s)| s).collect())
            .collect()
    }
}

/// Takes out free faces with the simplices they bound, as long as `may` allows
/// it for the simplex; what is left is known by the lists. Returns how many simplices each face
/// has left.
fn squeeze<const N: usize>(
    boundaries: &[[u32; N]],
    faces: &mut [bool],
    simplices: &mut [bool],
    may: impl Fn(u32) -> bool,
) -> Cofaces {
    // Simplices that went before must not count.
    let mut cofaces = Cofaces::of(faces.len(), boundaries);
    for (s, boundary) in boundaries.iter().enumerate() {
        if !simplices[s] {
            cofaces.remove(s as u32, boundary);
        }
    }
    let mut queue: Vec<u32> = (0..faces.len() as u32).rev().collect();
    while let Some(face) = queue.pop() {
        if !faces[face as usize] {
            continue;
        }
        let Some(simplex) = cofaces.only(face) else {
            continue;
        };
        if !may(simplex) {
            continue;
        }
        faces[face as usize] = false;
        simplices[simplex as usize] = false;
        let boundary = &boundaries[simplex as usize];
        cofaces.remove(simplex, boundary);
        queue.extend(boundary.iter().filter(|&&f| f != face));
    }
    cofaces
}

/// The dimension of the space of solutions of equations over Z/2, each the
/// sum of some of `unknowns`.
fn kernel(unknowns: u64, equations: &[Vec<u32>]) -> u64 {
    let zero = unknowns as u32;
    let mut sets = Sets::new(unknowns as usize + 1);
    let mut open: Vec<Vec<u32>> = equations.to_vec();
    // Equations of one or two unknowns join them; then others become short.
    loop {
        let mut joined = false;
        let mut left = Vec::new();
        for mut equation in open {
            for x in &mut equation {
                *x = sets.find(*x);
            }
            let none = sets.find(zero);
            equation.retain(|&x| x != none);
            odd_ones(&mut equation);
            match equation[..] {
                [] => {}
                [a] => joined |= sets.join(a, zero),
                [a, b] => joined |= sets.join(a, b),
                _ => left.push(equation),
            }
        }
        open = left;
        if !joined {
            break;
        }
    }
    let classes = (0..=zero).filter(|&x| sets.find(x) == x).count() as u64 - 1;
    open.sort_unstable();
    open.dedup();
    classes - rank(open)
}

/// Sorts a list and keeps what it holds an odd number of times.
fn odd_ones(list: &mut Vec<u32>) {
    list.sort_unstable();
    let mut kept: Vec<u32> = Vec::with_capacity(list.len());
    for &x in list.iter() {
        match kept.last() {
            Some(&last) if last == x => {
                kept.pop();
            }
            _ => kept.push(x),
        }
    }
    *list = kept;
}

/// The rank of rows given by their columns, ascending.
fn rank(rows: Vec<Vec<u32>>) -> u64 {
    let mut by_lead: HashMap<u32, Vec<u32>> = HashMap::new();
    for mut row in rows {
        while let Some(&lead) = row.first() {
            match by_lead.get(&lead) {
                None => {
                    by_lead.insert(lead, row);
                    break;
                }
                Some(other) => {
                    row.extend_from_slice(other);
                    odd_ones(&mut row);
                }
            }
        }
    }
    by_lead.len() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(vertices: usize, triangles: &[[u32; 3]]) -> (u64, u64, u64) {
        let b = betti(&Simplices::closed(vertices, &[], triangles, &[]));
        assert_eq!(b.solids, 0);
        (b.parts, b.tunnels, b.voids)
    }

    /// The torus of 7 vertices.
    fn torus() -> Vec<[u32; 3]> {
        let turn = |k: u32| [[k, k + 1, k + 3], [k, k + 2, k + 3]].map(|t| t.map(|v| v % 7));
        (0..7).flat_map(turn).collect()
    }

    #[test]
    fn known_shapes() {
        assert_eq!(of(1, &[]), (1, 0, 0));
        assert_eq!(of(5, &[]), (5, 0, 0));
        assert_eq!(of(3, &[[0, 1, 2]]), (1, 0, 0));
        assert_eq!(of(7, &torus()), (1, 2, 1));
        // The projective plane of 6 vertices: over Z/2 it has a 2-cycle.
        let plane = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        assert_eq!(of(6, &plane), (1, 1, 1));
        // Two tetrahedral shells with a face in common: two voids.
        let two = [
            [0, 1, 2],
            [0, 1, 3],
            [0, 2, 3],
            [1, 2, 3],
            [0, 1, 4],
            [0, 2, 4],
            [1, 2, 4],
        ];
        assert_eq!(of(5, &two), (1, 0, 2));
        let circle = Simplices::closed(3, &[[0, 1], [1, 2], [2, 0]], &[], &[]);
        assert_eq!(betti(&circle).tunnels, 1);
    }

    #[test]
    fn solids() {
        let full = Simplices::closed(4, &[], &[], &[[0, 1, 2, 3]]);
        assert_eq!(
            betti(&full),
            Betti {
                parts: 1,
                ..Betti::default()
            }
        );
        // The boundary of the simplex of dimension 4: a 3-sphere.
        let sphere: Vec<[u32; 4]> = (0..5u32)
            .map(|k| {
                let mut rest = (0..5).filter(|&v| v != k);
                [0; 4].map(|_| rest.next().unwrap())
            })
            .collect();
        let b = betti(&Simplices::closed(5, &[], &[], &sphere));
        assert_eq!((b.parts, b.tunnels, b.voids, b.solids), (1, 0, 0, 1));
    }

    /// Ranks of dense boundary matrices, as in a textbook.
    fn naive(complex: &Simplices) -> Betti {
        let rank_of = |columns: Vec<Vec<usize>>, rows: usize| {
            let mut matrix: Vec<Vec<bool>> = columns
                .iter()
                .map(|c| (0..rows).map(|r| c.contains(&r)).collect())
                .collect();
            let mut rank = 0;
            for r in 0..rows {
                let Some(p) = (rank..matrix.len()).find(|&c| matrix[c][r]) else {
                    continue;
                };
                matrix.swap(rank, p);
                for c in 0..matrix.len() {
                    if c != rank && matrix[c][r] {
                        for k in 0..rows {
                            matrix[c][k] ^= matrix[rank][k];
                        }
                    }
                }
                rank += 1;
            }
            rank as u64
        };
        let place = |list: &[Vec<u32>], s: &[u32]| list.iter().position(|t| t == s).unwrap();
        let lists: Vec<Vec<Vec<u32>>> = vec![
            (0..complex.vertices as u32).map(|v| vec![v]).collect(),
            complex.edges.iter().map(|s| s.to_vec()).collect(),
            complex.triangles.iter().map(|s| s.to_vec()).collect(),
            complex.tetrahedra.iter().map(|s| s.to_vec()).collect(),
        ];
        let ranks: Vec<u64> = (1..4)
            .map(|d| {
                let column = |s: &Vec<u32>| {
                    (0..s.len())
                        .map(|k| {
                            let mut face = s.clone();
                            face.remove(k);
                            place(&lists[d - 1], &face)
                        })
                        .collect()
                };
                rank_of(lists[d].iter().map(column).collect(), lists[d - 1].len())
            })
            .collect();
        let n = |d: usize| lists[d].len() as u64;
        Betti {
            parts: n(0) - ranks[0],
            tunnels: n(1) - ranks[0] - ranks[1],
            voids: n(2) - ranks[1] - ranks[2],
            solids: n(3) - ranks[2],
        }
    }

    #[test]
    fn random_complexes_agree_with_dense_ranks() {
        let mut state = 7u32;
        let mut draw = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for round in 0..60 {
            let vertices = 4 + draw(5);
            let edges: Vec<[u32; 2]> = (0..draw(6))
                .map(|_| [draw(vertices), draw(vertices)])
                .collect();
            let triangles: Vec<[u32; 3]> = (0..draw(14))
                .map(|_| [0; 3].map(|_| draw(vertices)))
                .collect();
            let tetrahedra: Vec<[u32; 4]> = (0..draw(8))
                .map(|_| [0; 4].map(|_| draw(vertices)))
                .collect();
            let complex = Simplices::closed(vertices as usize, &edges, &triangles, &tetrahedra);
            assert_eq!(
                betti(&complex),
                naive(&complex),
                "round {round}: {complex:?}"
            );
        }
    }
}
