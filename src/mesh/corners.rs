//! Triangle meshes by corners: triangle `t` owns the corners `3t..3t + 3`, and
//! half-edge `c` runs from corner `c` to the next one of its triangle.

use super::decimate::DecimateError;
use crate::geom::vec3::{cross, dot, scale, sub};
use crate::geom::{Bounds, Point};

/// No such face, corner or vertex.
pub(super) const GONE: u32 = u32::MAX;

/// The corner after `c` in its triangle.
pub(super) fn next(c: u32) -> u32 {
    if c % 3 == 2 {
        c - 2
    } else {
        c + 1
    }
}

/// The corner before `c` in its triangle.
pub(super) fn previous(c: u32) -> u32 {
    if c.is_multiple_of(3) {
        c + 2
    } else {
        c - 1
    }
}

/// The twin of each half-edge and a corner at each vertex.
pub(super) fn incidences(
    corners: &[u32],
    vertices: usize,
) -> Result<(Vec<u32>, Vec<u32>), DecimateError> {
    let mut edges: Vec<(u32, u32, u32)> = (0..corners.len() as u32)
        .map(|c| {
            let (a, b) = (corners[c as usize], corners[next(c) as usize]);
            (a.min(b), a.max(b), c)
        })
        .collect();
    edges.sort_unstable();
    let mut twins = vec![GONE; corners.len()];
    for group in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let &[(vertex, _, c), (_, _, d)] = group else {
            return Err(DecimateError::NotManifold { vertex: group[0].0 });
        };
        if corners[c as usize] == corners[d as usize] {
            return Err(DecimateError::NotManifold { vertex });
        }
        twins[c as usize] = d;
        twins[d as usize] = c;
    }
    let mut corner_at = vec![GONE; vertices];
    let mut left = vec![0u32; vertices];
    for (c, &v) in corners.iter().enumerate() {
        corner_at[v as usize] = c as u32;
        left[v as usize] += 1;
    }
    // One fan at each vertex.
    for (v, &start) in corner_at.iter().enumerate() {
        let mut c = start;
        while c != GONE {
            left[v] -= 1;
            c = twins[previous(c) as usize];
            if c == start {
                break;
            }
        }
        if left[v] > 0 {
            return Err(DecimateError::NotManifold { vertex: v as u32 });
        }
    }
    Ok((twins, corner_at))
}

/// The points about the middle of their box, of size about 1.
pub(super) fn centred(points: &[Point]) -> Vec<Point> {
    let Some(bounds) = Bounds::of(points) else {
        return Vec::new();
    };
    let side = |k: usize| bounds.max[k] / 2.0 - bounds.min[k] / 2.0;
    let size = side(0).max(side(1)).max(side(2));
    let middle: Point = std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
    let factor = if size > 0.0 { 1.0 / size } else { 1.0 };
    points
        .iter()
        .map(|&p| scale(sub(p, middle), factor))
        .collect()
}

/// Whether a tetrahedron holds a point, up to rounding.
pub(super) fn holds(t: &[Point; 4], p: Point) -> bool {
    let volume =
        |a: Point, b: Point, c: Point, d: Point| dot(cross(sub(b, a), sub(c, a)), sub(d, a));
    let whole = volume(t[0], t[1], t[2], t[3]);
    (0..4).all(|k| {
        let mut part = *t;
        part[k] = p;
        volume(part[0], part[1], part[2], part[3]) * whole.signum() >= -1e-12 * whole.abs()
    })
}
