//! Fewer and better triangles: vertices that are no samples go where the
//! surface hardly moves, and edges are turned where that makes better angles.
//!
//! Most vertices of the power crust are no samples but power vertices, a hair
//! from a sample or from each other, and no measurement of the surface. One
//! goes, drawn into the neighbour that leaves the best triangles, if it lies
//! within a tolerance of the triangles that take its place and no triangle
//! turns by much. Along an edge of the solid that is all that may happen: its
//! vertices are drawn along it and never off it, so edges that the power
//! faces found between samples stay. The distances add up in the vertices
//! around, so that many small moves do not make a large one.

use super::mend_mesh::{next, prev, TriMesh};
use super::raw::NONE;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, cross, dist_sq, dot, norm, norm_sq, scale, sub};
use crate::geom::Point;

/// The least cosine of the angle by which a triangle may turn.
const TURN: f64 = 0.7;
/// The same against the mean normal, for needles, whose own says nothing.
const NEEDLE_TURN: f64 = 0.3;
/// Triangles this good (height over longest side) need not be kept as good.
const GOOD: f64 = 0.2;
/// Edges of triangles this good stay.
const FINE: f64 = 0.5;
/// Rounds of collapsing and turning.
const ROUNDS: usize = 3;

/// What coarsening did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Coarsened {
    pub collapsed: usize,
    pub flipped: usize,
}

/// Coarsens `mesh`; `tolerance` says how far the surface may move at each
/// vertex.
pub(crate) fn coarsen(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    let mut work = Work {
        mesh,
        tolerance,
        moved: vec![0.0; tolerance.len()],
        fan: Vec::new(),
        ring: Vec::new(),
        places: Vec::new(),
        normals: Vec::new(),
    };
    let mut done = Coarsened::default();
    let mut todo: Vec<bool> = work.mesh.samples.iter().map(|&s| s == NONE).collect();
    for _ in 0..ROUNDS {
        let mut collapsed = 0;
        for v in 0..todo.len() as u32 {
            if v % 65536 == 0 {
                cx.advance(Stage::Crust, 1, 3)?;
            }
            if std::mem::take(&mut todo[v as usize]) && work.collapse(v) {
                collapsed += 1;
                for &w in &work.ring {
                    todo[w as usize] = work.mesh.samples[w as usize] == NONE;
                }
            }
        }
        let flipped = work.flips(&mut todo);
        done.collapsed += collapsed;
        done.flipped += flipped;
        if collapsed == 0 {
            break;
        }
    }
    Ok(done)
}

struct Work<'a> {
    mesh: &'a mut TriMesh,
    tolerance: &'a [f64],
    /// How far the surface has moved at each vertex.
    moved: Vec<f64>,
    fan: Vec<u32>,
    /// The neighbours of a vertex; triangle k lies between k and k + 1.
    ring: Vec<u32>,
    /// Where they are, the first again at the end.
    places: Vec<Point>,
    /// Vector area of each triangle of a fan, its squared size, and whether
    /// it says which way the surface looks.
    normals: Vec<(Point, f64, bool)>,
}

impl Work<'_> {
    /// Draws `v` into the best of its neighbours, if there is one.
    fn collapse(&mut self, v: u32) -> bool {
        let mesh = &*self.mesh;
        mesh.fan(v, &mut self.fan);
        let n = self.fan.len();
        if n < 3 {
            return false;
        }
        let p = mesh.at(v);
        let limit = self.tolerance[v as usize] - self.moved[v as usize];
        if limit <= 0.0 {
            return false;
        }
        self.ring.clear();
        self.ring.extend(self.fan.iter().map(|&h| mesh.head(h)));
        self.places.clear();
        self.places.extend(self.ring.iter().map(|&w| mesh.at(w)));
        self.places.push(self.places[0]);
        self.normals.clear();
        let mut mean = [0.0; 3];
        let mut worst = GOOD * GOOD;
        for k in 0..n {
            let (normal, longest) = area(&[p, self.places[k], self.places[k + 1]]);
            let size = norm_sq(normal);
            worst = worst.min(size / (longest * longest));
            mean = add(mean, normal);
            // The height over the longest side tells needles.
            let fat = size > limit * limit * longest;
            self.normals.push((normal, size, fat));
        }
        let mut best = (worst, 0.0, NONE);
        for j in 0..n {
            let Some((quality, distance)) = self.try_collapse(p, j, mean, best.0, limit) else {
                continue;
            };
            if self.mesh.can_collapse(self.fan[j], &self.fan) {
                best = (quality, distance, self.fan[j]);
            }
        }
        let (_, distance_sq, h) = best;
        if h == NONE {
            return false;
        }
        let total = self.moved[v as usize] + distance_sq.sqrt();
        self.mesh.collapse(h, &self.fan);
        for &w in &self.ring {
            let moved = &mut self.moved[w as usize];
            *moved = moved.max(total);
        }
        true
    }

    /// The squared quality of the triangles if the vertex at `p` is drawn
    /// into neighbour `j` and its squared distance from them; `None` if some
    /// are no better than `least` or turn over, or the distance is beyond the
    /// limit.
    fn try_collapse(
        &self,
        p: Point,
        j: usize,
        mean: Point,
        least: f64,
        limit: f64,
    ) -> Option<(f64, f64)> {
        let n = self.ring.len();
        let to = self.places[j];
        let mut quality = f64::INFINITY;
        let others = (j + 1..n).chain(0..j.saturating_sub(1));
        let others = others.filter(|&k| k + 1 != j + n);
        for k in others.clone() {
            let (normal, longest) = area(&[to, self.places[k], self.places[k + 1]]);
            let size = norm_sq(normal);
            quality = quality.min(size / (longest * longest));
            if quality <= least {
                return None;
            }
            let (old, old_size, fat) = self.normals[k];
            let turned = if fat {
                turns(dot(normal, old), TURN, size * old_size)
            } else {
                turns(dot(normal, mean), NEEDLE_TURN, size * norm_sq(mean))
            };
            if turned {
                return None;
            }
        }
        // The neighbour itself is a point of the triangles.
        let mut distance_sq = dist_sq(p, to);
        for k in others {
            distance_sq = distance_sq.min(point_triangle_sq(
                p,
                &[to, self.places[k], self.places[k + 1]],
            ));
        }
        if distance_sq > limit * limit {
            return None;
        }
        // Nor may the new edges leave the old triangles.
        for k in (j + 2..j + n - 1).map(|k| k % n) {
            let middle = scale(add(to, self.places[k]), 0.5);
            let mut off = f64::INFINITY;
            for i in 0..n {
                let t = [p, self.places[i], self.places[i + 1]];
                off = off.min(point_triangle_sq(middle, &t));
                if off <= distance_sq {
                    break;
                }
            }
            if off > limit * limit {
                return None;
            }
            distance_sq = distance_sq.max(off);
        }
        Some((quality, distance_sq))
    }

    /// Turns edges that make better triangles; returns how many.
    fn flips(&mut self, todo: &mut [bool]) -> usize {
        let mut flipped = 0;
        for h in 0..self.mesh.twin.len() as u32 {
            if !self.mesh.alive(h / 3) || h > self.mesh.twin(h) {
                continue;
            }
            if self.flip_helps(h) && self.mesh.can_flip(h) {
                let t = self.mesh.twin(h);
                for g in [h, next(h), prev(h), prev(t)] {
                    let v = self.mesh.tail(g);
                    todo[v as usize] |= self.mesh.samples[v as usize] == NONE;
                }
                self.mesh.flip(h);
                flipped += 1;
            }
        }
        flipped
    }

    fn flip_helps(&self, h: u32) -> bool {
        let mesh = &*self.mesh;
        let t = mesh.twin(h);
        let ids = [
            mesh.tail(h),
            mesh.head(h),
            mesh.tail(prev(h)),
            mesh.tail(prev(t)),
        ];
        let [u, v, a, b] = ids.map(|v| mesh.at(v));
        let (n1, l1) = area(&[u, v, a]);
        let (n2, l2) = area(&[v, u, b]);
        let (m1, k1) = area(&[b, a, u]);
        let (m2, k2) = area(&[a, b, v]);
        let quality = |n: Point, longest: f64| norm_sq(n) / (longest * longest);
        let before = quality(n1, l1).min(quality(n2, l2));
        if before > FINE * FINE {
            return false;
        }
        let after = quality(m1, k1).min(quality(m2, k2));
        if after <= 1.2 * before {
            return false;
        }
        let tolerance = ids
            .iter()
            .map(|&v| self.tolerance[v as usize] - self.moved[v as usize]);
        let tolerance = tolerance.fold(f64::INFINITY, f64::min);
        // The distance between the lines of the two diagonals.
        let normal = cross(sub(v, u), sub(a, b));
        let size = norm(normal);
        if size <= 0.0 || dot(sub(a, u), normal).abs() > tolerance * size {
            return false;
        }
        let mean = add(n1, n2);
        let size = norm_sq(mean);
        !turns(dot(m1, mean), TURN, norm_sq(m1) * size)
            && !turns(dot(m2, mean), TURN, norm_sq(m2) * size)
    }
}

/// Whether two vectors make an angle of a smaller cosine than given: `product`
/// is that of their squared lengths.
#[inline]
fn turns(dot: f64, cosine: f64, product: f64) -> bool {
    dot <= 0.0 || dot * dot < cosine * cosine * product
}

/// Twice the vector area, and the square of the longest side.
pub(crate) fn area(t: &[Point; 3]) -> (Point, f64) {
    let (u, v) = (sub(t[1], t[0]), sub(t[2], t[0]));
    let longest = norm_sq(u).max(norm_sq(v)).max(dist_sq(t[1], t[2]));
    (cross(u, v), longest.max(f64::MIN_POSITIVE))
}

/// The squared distance from a point to a triangle.
pub(crate) fn point_triangle_sq(p: Point, t: &[Point; 3]) -> f64 {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let mut inside = true;
    let mut edges = f64::INFINITY;
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let (along, to) = (sub(b, a), sub(p, a));
        if dot(cross(along, to), normal) < 0.0 {
            inside = false;
            let s = (dot(along, to) / norm_sq(along)).clamp(0.0, 1.0);
            edges = edges.min(norm_sq(sub(to, scale(along, s))));
        }
    }
    if inside {
        let off = dot(sub(p, t[0]), normal);
        return off * off / norm_sq(normal).max(f64::MIN_POSITIVE);
    }
    edges
}
