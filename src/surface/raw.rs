//! The crust before and after clean-up: the contract between extraction
//! (which knows the power diagram) and clean-up (which knows only surfaces).

use crate::geom::Point;
use crate::mesh::PolygonMesh;

/// 'No such thing' among 32-bit ids.
pub const NONE: u32 = u32::MAX;

/// The crust exactly as the perturbed power diagram has it.
///
/// A regular triangulation is simplicial, so every power vertex has four
/// cells and every power edge three: whatever the labels, each edge between
/// inner and outer cells lies on exactly two crust faces and each vertex link
/// is one cycle. This complex is therefore always a closed 2-manifold,
/// combinatorially. Geometrically many of its vertices coincide: all that
/// carry the same `sample` lie at that sample (fact F2).
#[derive(Clone, Debug, Default)]
pub struct RawCrust {
    /// Position of each raw vertex: the sample's where it has one.
    pub positions: Vec<Point>,
    /// The sample at which each raw vertex lies, or [`NONE`].
    pub samples: Vec<u32>,
    /// Face `f` owns corners `starts[f]..starts[f + 1]`, counterclockwise
    /// seen from outside. Half-edge `c` runs from corner `c` to the next
    /// corner of the same face (cyclically).
    pub starts: Vec<u32>,
    /// The raw vertex of each corner.
    pub corners: Vec<u32>,
    /// The half-edge on the neighbouring face that runs the other way along
    /// the same power edge: an involution without fixed points.
    pub twins: Vec<u32>,
    /// The inner and the outer ball of each face.
    pub balls: Vec<[u32; 2]>,
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
