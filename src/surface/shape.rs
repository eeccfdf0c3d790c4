//! The power shape: the medial axis as a simplicial complex.

use crate::geom::{Ball, Side};
use crate::power::PowerDiagram;
use crate::tetra::FACETS;

/// The part of the regular triangulation whose balls all carry one label
/// (section 3.4): an approximation of the medial axis.
#[derive(Clone, Debug, Default)]
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
