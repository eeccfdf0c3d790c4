//! The power shape: the medial axis as a simplicial complex.

use crate::geom::vec3::dist_sq;
use crate::geom::{Ball, Side};
use crate::power::PowerDiagram;
use crate::simplify::{betti, thin, Betti, Contact, Simplices, Touching};
use crate::tetra::FACETS;

/// The part of the regular triangulation whose balls all carry one label
/// (section 3.4): an approximation of the medial axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PowerShape {
    /// The balls, with indices of their own.
    pub balls: Vec<Ball>,
    /// The index of each ball in [`crate::Reconstruction::balls`].
    pub ids: Vec<u32>,
    /// Pairs of balls whose cells share a face, smaller index first, sorted.
    pub edges: Vec<[u32; 2]>,
    /// Triples of balls whose cells share an edge, ascending, sorted.
    pub triangles: Vec<[u32; 3]>,
    /// Quadruples of balls whose cells share a vertex, ascending, sorted.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The side of each ball; empty where it is not known.
    pub sides: Vec<Side>,
    /// What the samples on each ball span; empty where it is not known.
    pub contacts: Vec<Contact>,
    /// The input points that each ball touches; empty where they are not
    /// known.
    pub touching: Touching,
    /// The balls of the other side, which the simplices do not use: with them
    /// the power diagram can be made again.
    pub others: Vec<Ball>,
    /// What the samples on those span; empty where it is not known.
    pub other_contacts: Vec<Contact>,
}

impl PowerShape {
    /// The simplices with all their faces.
    pub fn simplices(&self) -> Simplices {
        let (edges, triangles) = (&self.edges, &self.triangles);
        Simplices::closed(self.balls.len(), edges, triangles, &self.tetrahedra)
    }

    /// The Betti numbers over Z/2, exact. Those of the inner shape are those
    /// of the solid.
    pub fn betti(&self) -> Betti {
        betti(&self.simplices())
    }

    /// Leaves out balls that no simplex uses and `keep` does not say.
    pub fn keep_balls(&mut self, keep: &[bool]) {
        let mut used = keep.to_vec();
        used.resize(self.balls.len(), false);
        let corners = (self.edges.iter().flatten())
            .chain(self.triangles.iter().flatten())
            .chain(self.tetrahedra.iter().flatten());
        for &v in corners {
            used[v as usize] = true;
        }
        let mut number = vec![0; used.len()];
        let mut next = 0;
        for (n, &used) in number.iter_mut().zip(&used) {
            *n = next;
            next += u32::from(used);
        }
        fn pick<T: Copy>(list: &mut Vec<T>, used: &[bool]) {
            let mut k = 0;
            list.retain(|_| {
                k += 1;
                used[k - 1]
            });
        }
        pick(&mut self.balls, &used);
        pick(&mut self.ids, &used);
        pick(&mut self.sides, &used);
        pick(&mut self.contacts, &used);
        if !self.touching.starts.is_empty() {
            let old = std::mem::take(&mut self.touching);
            self.touching.starts.push(0);
            for v in (0..used.len() as u32).filter(|&v| used[v as usize]) {
                self.touching.samples.extend_from_slice(old.at(v));
                let end = self.touching.samples.len() as u32;
                self.touching.starts.push(end);
            }
        }
        let renumber = |v: &mut u32| *v = number[*v as usize];
        self.edges.iter_mut().flatten().for_each(renumber);
        self.triangles.iter_mut().flatten().for_each(renumber);
        self.tetrahedra.iter_mut().flatten().for_each(renumber);
    }

    /// Collapses the flat tetrahedra (section 3.4) without a change of the
    /// Betti numbers. Returns how many there were; any still there close up
    /// on each other, as those of a power shape cannot.
    pub fn thin(&mut self) -> usize {
        let at = |v: u32| self.balls[v as usize].centre;
        let thinned = thin(&self.simplices(), &|[a, b]| dist_sq(at(a), at(b)));
        self.edges = thinned.complex.edges;
        self.triangles = thinned.complex.triangles;
        self.tetrahedra = thinned.complex.tetrahedra;
        thinned.collapsed
    }
}

/// Collects the simplices among the balls of one side. `balls` are the balls
/// of the diagram in the units wanted. Balls without a cell are left out.
pub fn power_shape(power: &PowerDiagram, balls: &[Ball], sides: &[Side], side: Side) -> PowerShape {
    let mut number = vec![u32::MAX; balls.len()];
    for cell in &power.complex.cells {
        for &v in cell {
            if !power.is_sentinel(v) && sides[v as usize] == side {
                number[v as usize] = 0;
            }
        }
    }
    let mut shape = PowerShape::default();
    for (b, n) in number.iter_mut().enumerate() {
        if *n == 0 {
            *n = shape.ids.len() as u32;
            shape.ids.push(b as u32);
            shape.balls.push(balls[b]);
            shape.sides.push(side);
        }
    }
    let of = |v: u32| {
        if power.is_sentinel(v) {
            u32::MAX
        } else {
            number[v as usize]
        }
    };
    for cell in &power.complex.cells {
        let own = cell.map(of);
        if own.iter().filter(|&&v| v != u32::MAX).count() < 2 {
            continue;
        }
        for i in 0..4 {
            for j in i + 1..4 {
                push_simplex(&mut shape.edges, [own[i], own[j]]);
            }
        }
        for facet in FACETS {
            push_simplex(&mut shape.triangles, facet.map(|k| own[k]));
        }
        push_simplex(&mut shape.tetrahedra, own);
    }
    shape.edges.sort_unstable();
    shape.edges.dedup();
    shape.triangles.sort_unstable();
    shape.triangles.dedup();
    shape.tetrahedra.sort_unstable();
    shape
}

/// Adds a simplex if all its corners belong to the shape.
fn push_simplex<const N: usize>(to: &mut Vec<[u32; N]>, mut simplex: [u32; N]) {
    if !simplex.contains(&u32::MAX) {
        simplex.sort_unstable();
        to.push(simplex);
    }
}
