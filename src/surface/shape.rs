//! The power shape: the medial axis as a simplicial complex.

use crate::geom::Ball;

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
