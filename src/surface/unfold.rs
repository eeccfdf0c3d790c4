//! Triangles for a polygon that is not simple seen from its own side: rounding
//! has pulled its corners off their plane or past each other.
//!
//! Some triangles must then face backward. Dynamic programming over the
//! diagonals finds the triangulation with the least area facing backward and
//! the best shapes among equals: cubic in the number of corners, so for the
//! few odd polygons only, and only up to a size.

use super::flat::{collinear, vector_area};
use crate::geom::vec3::{cross, dist_sq, dot, norm, sub};
use crate::geom::Point;

/// Larger polygons are left to the caller.
const MOST: usize = 40;

/// Appends the triangles, as corner numbers; false if there are none without
/// forbidden diagonals or triangles on a line.
pub(crate) fn least_folded(
    points: &[Point],
    allowed: &impl Fn(u32, u32) -> bool,
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    let n = points.len();
    let normal = vector_area(points.iter().copied());
    let size = norm(normal);
    if !(3..=MOST).contains(&n) || size <= 0.0 {
        return false;
    }
    // best[i * n + j]: the cost of the corners i ..= j, and the third corner
    // of the triangle at the diagonal i - j.
    let mut best = vec![(0.0, 0); n * n];
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            best[i * n + j] = (f64::INFINITY, 0);
            if span < n - 1 && !allowed(i as u32, j as u32) {
                continue;
            }
            for k in i + 1..j {
                let parts = best[i * n + k].0 + best[k * n + j].0;
                let cost = parts + cost([points[i], points[k], points[j]], normal, size);
                if cost < best[i * n + j].0 {
                    best[i * n + j] = (cost, k);
                }
            }
        }
    }
    if best[n - 1].0 == f64::INFINITY {
        return false;
    }
    let mut open = vec![(0, n - 1)];
    while let Some((i, j)) = open.pop() {
        if j > i + 1 {
            let k = best[i * n + j].1;
            triangles.push([i as u32, k as u32, j as u32]);
            open.extend([(i, k), (k, j)]);
        }
    }
    true
}

/// What faces backward counts by its share of the whole area; shape (longest
/// side squared over area) decides only among equals.
fn cost([a, b, c]: [Point; 3], normal: Point, size: f64) -> f64 {
    if collinear(a, b, c) {
        return f64::INFINITY;
    }
    let n = cross(sub(b, a), sub(c, a));
    let area = norm(n);
    let longest = dist_sq(a, b).max(dist_sq(b, c)).max(dist_sq(c, a));
    let shape = 1e-12 * (longest / area).min(1e12);
    if dot(n, normal) > 0.0 {
        shape
    } else {
        1.0 + 1e6 * area / size + shape
    }
}
