//! How far two surfaces are apart.

use super::{PolygonMesh, Surface};
use crate::context::{Cancelled, Context};
use crate::geom::vec3::{cross, norm, sub};
use crate::geom::Bounds;

/// How far two surfaces are apart, in the units of the meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Deviation {
    /// Mean distance from the middles of the faces of each to the other, by
    /// area.
    pub mean: f64,
    /// Largest of these distances and those of the vertices.
    pub max: f64,
    /// The mean over the diagonal of the first mesh.
    pub mean_of_diagonal: f64,
    /// The largest over the diagonal of the first mesh.
    pub max_of_diagonal: f64,
}

/// Measures how far the surfaces of two triangle meshes are apart.
///
/// # Errors
/// [`Cancelled`].
pub fn deviation(a: &PolygonMesh, b: &PolygonMesh, cx: &Context) -> Result<Deviation, Cancelled> {
    let mut out = Deviation::default();
    let (mut sum, mut weights) = (0.0, 0.0);
    for (from, to) in [(a, b), (b, a)] {
        let surface = Surface::new(to);
        let mut points = Vec::new();
        let mut areas = Vec::new();
        for t in super::triangles(from) {
            let [p, q, r] = t.map(|v| from.vertices[v as usize]);
            points.push(std::array::from_fn(|k| {
                p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0
            }));
            areas.push(norm(cross(sub(q, p), sub(r, p))));
        }
        points.extend_from_slice(&from.vertices);
        let distances = surface.distances(&points, cx)?;
        out.max = distances.iter().fold(out.max, |m, &d| m.max(d));
        sum += areas
            .iter()
            .zip(&distances)
            .map(|(a, d)| a * d)
            .sum::<f64>();
        weights += areas.iter().sum::<f64>();
    }
    if weights > 0.0 {
        out.mean = sum / weights;
    }
    let diagonal = Bounds::of(&a.vertices).map_or(0.0, |b| b.diagonal());
    if diagonal > 0.0 {
        out.mean_of_diagonal = out.mean / diagonal;
        out.max_of_diagonal = out.max / diagonal;
    }
    Ok(out)
}
