//! The boundary of a union of balls, as a field that faces are fitted to.

use rayon::prelude::*;

use crate::fit::{Field, Foot};
use crate::geom::vec3::plain::norm;
use crate::geom::vec3::{add, scale, sub};
use crate::geom::{Ball, Point};
use crate::mesh::PolygonMesh;
use crate::power::BallTree;

/// Balls, of which the nearest sphere tells how far the boundary is: outside
/// of the union exactly, inside at least.
pub(super) struct Union {
    balls: Vec<Ball>,
    tree: BallTree,
    tolerance: f64,
}

impl Union {
    pub fn new(balls: Vec<Ball>, tolerance: f64) -> Union {
        Union {
            tree: BallTree::new(&balls),
            balls,
            tolerance,
        }
    }

    /// The largest and the mean distance of the vertices and middles of the
    /// faces of a triangle mesh.
    pub fn distances(&self, mesh: &PolygonMesh) -> [f64; 2] {
        let middle = |face: &[u32]| {
            let sum = face
                .iter()
                .fold([0.0; 3], |s, &v| add(s, mesh.vertices[v as usize]));
            scale(sum, 1.0 / face.len() as f64)
        };
        let mut points = mesh.vertices.clone();
        points.extend(mesh.faces().map(middle));
        let off: Vec<f64> = (points.par_iter())
            .map_init(Vec::new, |stack, &p| {
                let near = self.tree.nearest_sphere(&self.balls, p, stack);
                near.map_or(0.0, |(off, _)| off.abs())
            })
            .collect();
        let most = off.iter().copied().fold(0.0, f64::max);
        [most, off.iter().sum::<f64>() / off.len().max(1) as f64]
    }
}

impl Field for Union {
    fn foot(&self, at: Point, outward: Point, stack: &mut Vec<(f64, u32)>) -> Option<Foot> {
        let (off, b) = self.tree.nearest_sphere(&self.balls, at, stack)?;
        let from = sub(at, self.balls[b as usize].centre);
        let far = norm(from);
        let normal = match far > 0.0 {
            true => scale(from, 1.0 / far),
            false => outward,
        };
        Some(Foot { normal, off })
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Spikes that rounding and cleaning leave are this long.
    fn reach(&self) -> f64 {
        10.0 * self.tolerance
    }
}
