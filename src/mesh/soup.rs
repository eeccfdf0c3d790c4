//! The faces of any mesh, made safe to walk, and the triangles they stand for.

use super::frame::Frame;
use super::polygon::triangulate;
use super::PolygonMesh;
use crate::geom::Point;

/// A fault of a face that keeps it out of all further checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A corner that is no vertex, or a run of corners that is not there.
    OutOfRange,
    /// Fewer than three corners.
    TooSmall,
}

/// The faces with three or more corners that all exist.
pub(super) struct Faces {
    /// As in [`PolygonMesh`].
    pub starts: Vec<u32>,
    /// As in [`PolygonMesh`].
    pub corners: Vec<u32>,
    /// The face's number in the mesh.
    pub number: Vec<u32>,
}

impl Faces {
    /// Sorts out the faces that can be walked; tells the others with their
    /// fault. Never panics, whatever the arrays hold.
    pub fn of(mesh: &PolygonMesh, mut faulty: impl FnMut(u32, Fault)) -> Faces {
        let mut faces = Faces {
            starts: Vec::with_capacity(mesh.starts.len().max(1)),
            corners: Vec::with_capacity(mesh.corners.len()),
            number: Vec::with_capacity(mesh.starts.len()),
        };
        faces.starts.push(0);
        let vertices = mesh.vertices.len();
        let mut end = 0;
        for (f, run) in mesh.starts.windows(2).enumerate() {
            // Runs in order and apart, so that the copy is never longer.
            let corners = match run[0] >= end {
                true => mesh.corners.get(run[0] as usize..run[1] as usize),
                false => None,
            };
            if corners.is_some() {
                end = run[1];
            }
            let fault = match corners {
                None => Some(Fault::OutOfRange),
                Some(c) if c.iter().any(|&v| v as usize >= vertices) => Some(Fault::OutOfRange),
                Some(c) if c.len() < 3 => Some(Fault::TooSmall),
                Some(_) => None,
            };
            match (fault, corners) {
                (None, Some(corners)) => {
                    faces.corners.extend_from_slice(corners);
                    faces.starts.push(faces.corners.len() as u32);
                    faces.number.push(f as u32);
                }
                (fault, _) => faulty(f as u32, fault.unwrap_or(Fault::OutOfRange)),
            }
        }
        faces
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.number.len()
    }

    /// Corners of face `f`.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    /// All faces in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> + '_ {
        (0..self.len()).map(|f| self.face(f))
    }

    /// For each corner the next corner of its face.
    pub fn next(&self) -> Vec<u32> {
        let mut next: Vec<u32> = (1..=self.corners.len() as u32).collect();
        for run in self.starts.windows(2) {
            if run[1] > run[0] {
                next[run[1] as usize - 1] = run[0];
            }
        }
        next
    }

    /// The triangles of each face; see [`triangulate`].
    pub fn triangles(&self, frame: &Frame) -> Triangles {
        let count = self.corners.len() - 2 * self.len();
        let mut triangles = Triangles {
            corners: Vec::with_capacity(count),
            face: Vec::with_capacity(count),
        };
        for (f, face) in self.iter().enumerate() {
            match face {
                &[a, b, c] => triangles.corners.push([a, b, c]),
                _ => triangulate(frame, face, &mut triangles.corners),
            }
            triangles.face.resize(triangles.corners.len(), f as u32);
        }
        triangles
    }
}

/// Triangles by vertex indices.
pub(super) struct Triangles {
    pub corners: Vec<[u32; 3]>,
    /// The face (of [`Faces`]) that each triangle belongs to.
    pub face: Vec<u32>,
}

/// The positions of a triangle's corners.
#[inline]
pub(super) fn place(points: &[Point], t: [u32; 3]) -> [Point; 3] {
    t.map(|v| points[v as usize])
}
