//! Surface meshes: vertices and faces by index, and what can be asked of them.
//!
//! [`check()`] judges a mesh exactly and returns everything it finds;
//! [`components`] and [`component_volumes`] take it apart; [`Surface`] answers
//! distances to it.

mod bvh;
mod check;
pub(crate) mod clash;
mod corners;
mod crossing;
mod decimate;
mod deviation;
mod distance;
mod frame;
pub(crate) mod halves;
mod intersect;
mod measure;
mod moving;
mod nesting;
pub(crate) mod polygon;
mod quadric;
mod report;
mod soup;
mod topology;
mod wide;

pub use check::{check, CheckOptions};
pub use decimate::{decimate, DecimateError, Decimated};
pub use deviation::{deviation, Deviation};
pub use distance::Surface;
pub use measure::{component_volumes, components, Shape};
pub use nesting::enclosing;
pub(crate) use nesting::Anatomy;
pub use report::{Counts, Finding, Report, Shell};

use crate::geom::Point;

/// The triangles that the faces of a mesh fall into, in their order, cut as
/// [`check()`] cuts them; faces that cannot be walked are left out.
pub fn triangles(mesh: &PolygonMesh) -> Vec<[u32; 3]> {
    let faces = soup::Faces::of(mesh, |_, _| ());
    faces.triangles(&frame::Frame::new(&mesh.vertices)).corners
}

/// A polygon mesh: vertex positions, and faces as runs of vertex indices,
/// counterclockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonMesh {
    /// Vertex positions, in the units of the input.
    pub vertices: Vec<Point>,
    /// Face `f` has the corners `corners[starts[f]..starts[f + 1]]`; one
    /// entry more than there are faces, the first 0 (empty for no faces).
    pub starts: Vec<u32>,
    /// Vertex indices of all faces, face after face.
    pub corners: Vec<u32>,
}

impl PolygonMesh {
    /// A mesh of the given vertices without faces.
    pub fn with_vertices(vertices: Vec<Point>) -> PolygonMesh {
        PolygonMesh {
            vertices,
            starts: vec![0],
            corners: Vec::new(),
        }
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The vertex indices of face `f`.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    /// All faces in order.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> + '_ {
        (0..self.face_count()).map(|f| self.face(f))
    }

    /// Appends a face.
    pub fn push_face(&mut self, corners: &[u32]) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        self.corners.extend_from_slice(corners);
        self.starts.push(self.corners.len() as u32);
    }

    /// Six times the signed volume by the divergence theorem, faces fanned
    /// from their first corner, divided by six: positive for a closed mesh
    /// whose faces look outward. Meaningless for open meshes.
    pub fn volume(&self) -> f64 {
        use crate::geom::vec3::{cross, dot, sub};
        let Some(&origin) = self.vertices.first() else {
            return 0.0;
        };
        let at = |i: u32| sub(self.vertices[i as usize], origin);
        let mut six = 0.0;
        for face in self.faces() {
            for k in 1..face.len().saturating_sub(1) {
                six += dot(at(face[0]), cross(at(face[k]), at(face[k + 1])));
            }
        }
        six / 6.0
    }
}
