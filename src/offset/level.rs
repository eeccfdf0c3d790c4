//! Planes of the crust made exact.
//!
//! Vertices of the crust that are no samples lie off planes by a share of the
//! sampling error, for the balls that make them were merged, and vertices in
//! planes were taken off them by a hair. Where all samples around such a
//! vertex lie in one plane it is put there, so that an offset of a plane is a
//! plane.

use rayon::prelude::*;

use crate::geom::vec3::plain::{dot, norm};
use crate::geom::vec3::{cross, scale, sub};
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use crate::surface::{Crust, NONE};

/// Samples lie in one plane when they are off it by this share of the
/// distance between them.
const FLAT: f64 = 1e-7;

/// So many samples tell of a plane: three always lie in one, and a vertex
/// beside three on a curved surface would be taken off it.
const ENOUGH: usize = 4;

/// The vertices of a crust, levelled.
pub(super) fn level(crust: &Crust) -> Vec<Point> {
    let mesh = &crust.mesh;
    let points = &mesh.vertices;
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    for face in mesh.faces() {
        for (k, &v) in face.iter().enumerate() {
            around[v as usize].push(face[(k + 1) % face.len()]);
        }
    }
    let is_sample = |v: u32| crust.vertex_samples[v as usize] != NONE;
    (0..points.len() as u32)
        .into_par_iter()
        .map(|v| {
            let p = points[v as usize];
            if is_sample(v) {
                return p;
            }
            // Samples next to it, and next to its neighbours that are none.
            let mut near: Vec<u32> = around[v as usize].clone();
            for &w in around[v as usize].iter().filter(|&&w| !is_sample(w)) {
                near.extend_from_slice(&around[w as usize]);
            }
            near.retain(|&w| is_sample(w));
            near.sort_unstable();
            near.dedup();
            let near: Vec<Point> = near.iter().map(|&w| points[w as usize]).collect();
            plane(&near).map_or(p, |(at, normal)| {
                sub(p, scale(normal, dot(sub(p, at), normal)))
            })
        })
        .collect()
}

/// What a smooth surface rises above the edges of a triangle mesh: the length
/// of an edge times the angle between its faces over 8. That of a share of the
/// edges is not more than the one returned.
pub(super) fn sagitta(mesh: &PolygonMesh, share: f64) -> f64 {
    let mut halves: Vec<([u32; 2], Point)> = Vec::with_capacity(mesh.corners.len());
    for face in mesh.faces() {
        let at = |k: usize| mesh.vertices[face[k] as usize];
        let normal = cross(sub(at(1), at(0)), sub(at(2), at(0)));
        let size = norm(normal);
        let unit = if size > 0.0 {
            scale(normal, 1.0 / size)
        } else {
            [0.0; 3]
        };
        for (k, &v) in face.iter().enumerate() {
            let w = face[(k + 1) % face.len()];
            halves.push(([v.min(w), v.max(w)], unit));
        }
    }
    halves.par_sort_unstable_by_key(|h| h.0);
    let pairs = halves.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() == 2);
    let mut rises: Vec<f64> = pairs
        .map(|pair| {
            let [v, w] = pair[0].0.map(|v| mesh.vertices[v as usize]);
            let angle = norm(sub(pair[0].1, pair[1].1));
            norm(sub(v, w)) * angle / 8.0
        })
        .collect();
    if rises.is_empty() {
        return 0.0;
    }
    rises.par_sort_unstable_by(f64::total_cmp);
    rises[((rises.len() - 1) as f64 * share) as usize]
}

/// The plane that all points lie in, by a point and the unit normal.
fn plane(points: &[Point]) -> Option<(Point, Point)> {
    if points.len() < ENOUGH {
        return None;
    }
    let (&a, rest) = points.split_first()?;
    let far = |p: &&Point| norm(sub(**p, a));
    let b = rest.iter().max_by(|p, q| far(p).total_cmp(&far(q)))?;
    let along = sub(*b, a);
    let beside = |p: &&Point| norm(cross(sub(**p, a), along));
    let c = rest.iter().max_by(|p, q| beside(p).total_cmp(&beside(q)))?;
    let normal = cross(along, sub(*c, a));
    let size = norm(normal);
    let longest = norm(along);
    // Points nearly on a line tell of no plane.
    if size <= 0.1 * longest * longest {
        return None;
    }
    let normal = scale(normal, 1.0 / size);
    let flat = |p: &Point| dot(sub(*p, a), normal).abs() <= FLAT * longest;
    points.iter().all(flat).then_some((a, normal))
}
