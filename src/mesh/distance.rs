//! Distances from points to a mesh.

use super::bvh::{Bvh, Cuboid};
use super::frame::Frame;
use super::soup::{place, Faces};
use super::PolygonMesh;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, cross, dot, norm_sq, scale, sub};
use crate::geom::Point;
use rayon::prelude::*;

/// Points between two looks at cancellation.
const CHUNK: usize = 1024;

/// A mesh made ready for distance queries: a tree over its triangles.
///
/// ```
/// use powercrust::mesh::{PolygonMesh, Surface};
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let mut square = PolygonMesh::with_vertices(corners);
/// square.push_face(&[0, 1, 2, 3]);
/// let surface = Surface::new(&square);
/// assert_eq!(surface.distance([1.0, 1.0, -3.0]), 3.0);
/// assert_eq!(surface.distance([5.0, 1.0, 4.0]), 5.0);
/// assert_eq!(surface.distance([2.0, 2.0, 0.0]), 0.0);
/// ```
pub struct Surface {
    frame: Frame,
    bvh: Bvh,
    /// Triangles by slot of the tree.
    triangles: Vec<[Point; 3]>,
}

impl Surface {
    /// Prepares a mesh; polygons are cut into triangles as
    /// [`super::check()`] does. Faces
    /// that cannot be walked or have corners that are not finite are left
    /// out.
    pub fn new(mesh: &PolygonMesh) -> Surface {
        let frame = Frame::rounded(&mesh.vertices);
        let faces = Faces::of(mesh, |_, _| ());
        let mut corners = faces.triangles(&frame).corners;
        corners
            .retain(|t| (t.iter().flat_map(|&v| mesh.vertices[v as usize])).all(|x| x.is_finite()));
        let boxes: Vec<Cuboid> = (corners.par_iter())
            .map(|&t| Cuboid::of(&place(&frame.points, t)))
            .collect();
        let bvh = Bvh::new(&boxes);
        let triangles = (bvh.order.iter())
            .map(|&t| place(&frame.points, corners[t as usize]))
            .collect();
        Surface {
            frame,
            bvh,
            triangles,
        }
    }

    /// The distance from a point to the nearest point of the surface, in the
    /// units of the mesh, up to rounding: infinite for a surface without
    /// triangles, NaN for a point that is not finite.
    pub fn distance(&self, point: Point) -> f64 {
        self.distance_with(point, &mut Vec::new())
    }

    /// The distances of many points, in their order, computed in parallel.
    pub fn distances(&self, points: &[Point], cx: &Context) -> Result<Vec<f64>, Cancelled> {
        cx.install(|| {
            let mut distances = vec![0.0; points.len()];
            distances
                .par_chunks_mut(CHUNK)
                .zip(points.par_chunks(CHUNK))
                .enumerate()
                .try_for_each(|(k, (distances, points))| {
                    let mut stack = Vec::new();
                    for (distance, &point) in distances.iter_mut().zip(points) {
                        *distance = self.distance_with(point, &mut stack);
                    }
                    let done = (k * CHUNK + points.len()) as u64;
                    cx.advance(Stage::Check, done, 0)
                })?;
            Ok(distances)
        })
    }

    /// The point of the surface nearest to one, in the units of the mesh, up to
    /// rounding; `None` for a surface without triangles and for a point that
    /// is not finite. `scratch` is memory that many calls may share.
    ///
    /// ```
    /// # use powercrust::mesh::{PolygonMesh, Surface};
    /// # let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
    /// # let mut square = PolygonMesh::with_vertices(corners);
    /// # square.push_face(&[0, 1, 2, 3]);
    /// let surface = Surface::new(&square);
    /// let mut scratch = Vec::new();
    /// assert_eq!(surface.nearest([0.5, 1.0, -3.0], &mut scratch), Some([0.5, 1.0, 0.0]));
    /// assert_eq!(surface.nearest([5.0, 1.0, 4.0], &mut scratch), Some([2.0, 1.0, 0.0]));
    /// ```
    pub fn nearest(&self, point: Point, scratch: &mut Vec<(f64, u32)>) -> Option<Point> {
        if !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        let p = self.frame.enter(point);
        let best = std::cell::Cell::new((f64::INFINITY, [0.0; 3]));
        self.bvh.nearest_sq(p, scratch, |slot| {
            let q = nearest_in_triangle(p, &self.triangles[slot as usize]);
            let found = norm_sq(sub(p, q));
            if found < best.get().0 {
                best.set((found, q));
            }
            found
        });
        let (found, q) = best.get();
        found.is_finite().then(|| q.map(|x| self.frame.leave(x)))
    }

    fn distance_with(&self, point: Point, stack: &mut Vec<(f64, u32)>) -> f64 {
        if !point.iter().all(|x| x.is_finite()) {
            return f64::NAN;
        }
        let p = self.frame.enter(point);
        let dist_sq = |slot: u32| triangle_dist_sq(p, &self.triangles[slot as usize]);
        let nearest = self.bvh.nearest_sq(p, stack, dist_sq);
        self.frame.leave(nearest.sqrt())
    }
}

/// The squared distance from a point to a triangle, which may be flat.
fn triangle_dist_sq(p: Point, &[a, b, c]: &[Point; 3]) -> f64 {
    let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
    let normal = cross(ab, sub(c, a));
    let inside = |from: Point, side: Point| dot(cross(side, sub(p, from)), normal) > 0.0;
    let length_sq = norm_sq(normal);
    // Strictly inside only, so that corners have distance zero exactly.
    if length_sq > 0.0 && inside(a, ab) && inside(b, bc) && inside(c, ca) {
        let height = dot(sub(p, a), normal);
        return height * height / length_sq;
    }
    (segment_dist_sq(p, a, ab, b))
        .min(segment_dist_sq(p, b, bc, c))
        .min(segment_dist_sq(p, c, ca, a))
}

/// The point of a triangle, which may be flat, nearest to one.
fn nearest_in_triangle(p: Point, &[a, b, c]: &[Point; 3]) -> Point {
    let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
    let normal = cross(ab, sub(c, a));
    let inside = |from: Point, side: Point| dot(cross(side, sub(p, from)), normal) > 0.0;
    let length_sq = norm_sq(normal);
    if length_sq > 0.0 && inside(a, ab) && inside(b, bc) && inside(c, ca) {
        return sub(p, scale(normal, dot(sub(p, a), normal) / length_sq));
    }
    let on = |from: Point, side: Point| {
        let length_sq = norm_sq(side);
        let along = match length_sq > 0.0 {
            true => (dot(sub(p, from), side) / length_sq).clamp(0.0, 1.0),
            false => 0.0,
        };
        add(from, scale(side, along))
    };
    let ends = [on(a, ab), on(b, bc), on(c, ca)];
    let off = |q: &Point| norm_sq(sub(p, *q));
    let nearer = |best: Point, q: Point| if off(&q) < off(&best) { q } else { best };
    ends.into_iter().fold(a, nearer)
}

/// The squared distance from a point to the segment from `a` to `b = a + ab`.
fn segment_dist_sq(p: Point, a: Point, ab: Point, b: Point) -> f64 {
    let along = dot(sub(p, a), ab);
    let length_sq = norm_sq(ab);
    if along <= 0.0 {
        norm_sq(sub(p, a))
    } else if along >= length_sq {
        norm_sq(sub(p, b))
    } else {
        norm_sq(sub(p, add(a, scale(ab, along / length_sq))))
    }
}
