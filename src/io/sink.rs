//! Faces as they are read: kept, or only counted and checked.

use super::error::{Place, ReadError};
use crate::mesh::PolygonMesh;

/// Receives the faces of a file.
pub struct FaceSink {
    /// The faces, where they are wanted.
    pub mesh: Option<PolygonMesh>,
    /// Faces seen, the short ones included.
    pub count: usize,
    /// Faces of fewer than three corners, when faces are only counted.
    pub short: usize,
}

impl FaceSink {
    /// Counts faces and checks their indices.
    pub fn counting() -> FaceSink {
        FaceSink {
            mesh: None,
            count: 0,
            short: 0,
        }
    }

    /// Keeps faces too.
    pub fn keeping() -> FaceSink {
        FaceSink {
            mesh: Some(PolygonMesh::with_vertices(Vec::new())),
            ..FaceSink::counting()
        }
    }

    /// Takes a face given by indices from 0, of which there are `limit`.
    pub fn push(&mut self, corners: &[i64], limit: u64, place: Place) -> Result<(), ReadError> {
        for &index in corners {
            if index < 0 || index as u64 >= limit {
                return Err(ReadError::Index {
                    place,
                    index,
                    count: limit,
                    what: "vertices",
                    range: "counting from 0",
                });
            }
        }
        self.count += 1;
        if corners.len() < 3 {
            self.short += 1;
            if self.mesh.is_some() {
                return Err(short(corners.len(), place));
            }
            return Ok(());
        }
        if let Some(mesh) = &mut self.mesh {
            mesh.corners.extend(corners.iter().map(|&i| i as u32));
            let end = u32::try_from(mesh.corners.len()).map_err(|_| ReadError::TooMany {
                what: "face corners",
                count: mesh.corners.len() as u64,
                limit: u64::from(u32::MAX),
            })?;
            mesh.starts.push(end);
        }
        Ok(())
    }

    /// A sentence about short faces that were only counted.
    pub fn note(&self) -> Option<String> {
        (self.short > 0).then(|| {
            format!(
                "{} of {} faces have fewer than 3 corners.",
                self.short, self.count
            )
        })
    }
}

#[cold]
fn short(corners: usize, place: Place) -> ReadError {
    ReadError::Malformed {
        place,
        what: format!("a face of {corners} corners: at least 3 are needed"),
    }
}

/// Refuses vertices that are not finite in a mesh.
pub fn check_finite(
    vertices: &[crate::geom::Point],
    place_of: impl Fn(usize) -> Place,
) -> Result<(), ReadError> {
    match vertices
        .iter()
        .position(|p| !p.iter().all(|c| c.is_finite()))
    {
        None => Ok(()),
        Some(first) => Err(ReadError::Malformed {
            place: place_of(first),
            what: format!(
                "the vertex {:?} is not finite: a mesh needs finite coordinates",
                vertices[first]
            ),
        }),
    }
}

/// Refuses more vertices than 32-bit indices can name.
pub fn check_count(what: &'static str, count: u64) -> Result<(), ReadError> {
    let limit = u64::from(u32::MAX) - 1;
    if count > limit {
        return Err(ReadError::TooMany { what, count, limit });
    }
    Ok(())
}
