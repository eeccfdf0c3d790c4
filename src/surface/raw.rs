//! The crust before and after clean-up: the contract between extraction
//! (which knows the power diagram) and clean-up (which knows only surfaces).

use crate::geom::Point;
use crate::mesh::PolygonMesh;

/// 'No such thing' among 32-bit ids.
pub const NONE: u32 = u32::MAX;

/// The crust as the perturbed power diagram has it, all of a sample in one
/// vertex.
///
/// A regular triangulation is simplicial, so every power vertex has four
/// cells and every power edge three: whatever the labels, each edge between
/// inner and outer cells lies on exactly two crust faces and each vertex link
/// is one cycle. This complex is therefore always a closed 2-manifold,
/// combinatorially. Geometrically many of its vertices coincide: all that
/// carry the same sample lie at that sample (fact F2), so they are one here,
/// and edges between them are left out.
///
/// What is left are half-edges: those with the same successors in turn are a
/// face, counterclockwise seen from outside. A face may return to a vertex or
/// have two edges only; a vertex may have several fans.
#[derive(Clone, Debug, Default)]
pub struct RawCrust {
    /// Position of each vertex: the sample's where it has one.
    pub positions: Vec<Point>,
    /// The sample at which each vertex lies, or [`NONE`].
    pub samples: Vec<u32>,
    /// The next half-edge of the same face: a permutation.
    pub next: Vec<u32>,
    /// The half-edge on the neighbouring face that runs the other way along
    /// the same power edge: an involution without fixed points.
    pub twins: Vec<u32>,
    /// The vertex at which each half-edge starts.
    pub corners: Vec<u32>,
    /// The inner and the outer ball of the face of each half-edge.
    pub balls: Vec<[u32; 2]>,
}

impl RawCrust {
    /// The half-edges of each face, in the order of the first ones.
    pub fn faces(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.next.len()];
        let mut faces = Vec::new();
        for first in 0..self.next.len() as u32 {
            let mut face = Vec::new();
            let mut h = first;
            while !std::mem::replace(&mut seen[h as usize], true) {
                face.push(h);
                h = self.next[h as usize];
            }
            if !face.is_empty() {
                faces.push(face);
            }
        }
        faces
    }
}

/// The finished crust: a closed, oriented manifold mesh that knows where its
/// parts come from.
#[derive(Clone, Debug, Default)]
pub struct Crust {
    /// The surface.
    pub mesh: PolygonMesh,
    /// The sample each vertex lies at, or [`NONE`]. A sample where the solid
    /// is pinched has several vertices, one for each sheet.
    pub vertex_samples: Vec<u32>,
    /// The inner and the outer ball whose cells each face separates.
    pub face_balls: Vec<[u32; 2]>,
}
