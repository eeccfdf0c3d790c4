//! Polygons cut into triangles.
//!
//! A polygon is seen along the axis its normal is closest to. If all the
//! triangles of the fan from its first corner turn the same way there, that
//! is the answer; the faces of a power crust are convex and end here. Else
//! ears are cut off, which is possible for every simple polygon. Neither way
//! makes triangles without area, not even at corners on a straight side. A
//! polygon that crosses itself gets the fan.

use super::frame::{drop_axis, Frame, Kernel};
use crate::geom::vec3::{add, cross, sub};
use crate::geom::Point;

/// Ears are cut in quadratic time, so not from polygons larger than this.
const MOST_CORNERS: usize = 4096;

/// Appends the triangles of one face of three corners or more, always two
/// less than it has corners.
pub(super) fn triangulate(frame: &Frame, face: &[u32], into: &mut Vec<[u32; 3]>) {
    let polygon = Polygon::new(frame, face);
    let named = |t: [usize; 3]| t.map(|k| face[k]);
    let fan = (1..face.len() - 1).map(|k| [0, k, k + 1]);
    if !fan.clone().all(|t| polygon.turns(t) > 0) {
        if let Some(ears) = polygon.ears() {
            into.extend(ears.into_iter().map(named));
            return;
        }
    }
    into.extend(fan.map(named));
}

/// Turns each ring to its first corner from which the fan of its triangles
/// turns one way: most programs cut faces so. False for rings without one.
pub(crate) fn start_fans(points: &[Point], rings: &mut [Vec<u32>]) -> Vec<bool> {
    let frame = Frame::new(points);
    let start = |ring: &mut Vec<u32>| {
        let n = ring.len();
        if n < 4 {
            return n == 3;
        }
        let polygon = Polygon::new(&frame, ring);
        let fans = |first: &usize| {
            let corner = |k: usize| (first + k) % n;
            (1..n - 1).all(|k| polygon.turns([corner(0), corner(k), corner(k + 1)]) > 0)
        };
        let first = (0..n).find(fans);
        ring.rotate_left(first.unwrap_or(0));
        first.is_some()
    };
    rings.iter_mut().map(start).collect()
}

/// A polygon in the plane.
struct Polygon {
    kernel: Kernel,
    points: Vec<[f64; 2]>,
    /// The way it runs round: 1 or -1.
    turn: i8,
}

impl Polygon {
    /// A face seen along the axis its normal is closest to.
    fn new(frame: &Frame, face: &[u32]) -> Polygon {
        let at = |k: usize| frame.points[face[k] as usize];
        let mut normal = [0.0f64; 3];
        for k in 1..face.len() - 1 {
            let sides = (sub(at(k), at(0)), sub(at(k + 1), at(0)));
            normal = add(normal, cross(sides.0, sides.1));
        }
        let axis = (1..3).fold(0, |best, k| match normal[k].abs() > normal[best].abs() {
            true => k,
            false => best,
        });
        Polygon {
            kernel: frame.kernel,
            points: (0..face.len()).map(|k| drop_axis(at(k), axis)).collect(),
            turn: if normal[axis] < 0.0 { -1 } else { 1 },
        }
    }

    /// 1 if the triangle runs round the same way as the polygon, 0 if it has
    /// no area.
    fn turns(&self, [a, b, c]: [usize; 3]) -> i8 {
        let p = &self.points;
        self.turn * self.kernel.orient2d(p[a], p[b], p[c])
    }

    /// Cuts ears; `None` where there is none to cut.
    fn ears(&self) -> Option<Vec<[usize; 3]>> {
        let mut left: Vec<usize> = (0..self.points.len()).collect();
        if left.len() > MOST_CORNERS {
            return None;
        }
        let mut ears = Vec::with_capacity(left.len() - 2);
        let mut from = 0;
        while left.len() > 3 {
            let n = left.len();
            let k = (0..n)
                .map(|i| (from + i) % n)
                .find(|&k| self.is_ear(&left, k))?;
            ears.push([left[(k + n - 1) % n], left[k], left[(k + 1) % n]]);
            left.remove(k);
            // Not at the same corner again, which would make a fan of slivers.
            from = k + 1;
        }
        let last = [left[0], left[1], left[2]];
        ears.push(last);
        (self.turns(last) > 0).then_some(ears)
    }

    /// Whether the corner's triangle turns right and holds no other corner.
    fn is_ear(&self, left: &[usize], k: usize) -> bool {
        let n = left.len();
        let ear = [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        let [a, b, c] = ear;
        self.turns(ear) > 0
            && (left.iter().filter(|&v| !ear.contains(v))).all(|&v| {
                self.turns([a, b, v]) < 0 || self.turns([b, c, v]) < 0 || self.turns([c, a, v]) < 0
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[[f64; 2]]) -> Vec<[u32; 3]> {
        let points: Vec<_> = points.iter().map(|p| [p[0], p[1], 3.0]).collect();
        let face: Vec<u32> = (0..points.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&Frame::new(&points), &face, &mut triangles);
        assert_eq!(triangles.len(), points.len() - 2);
        triangles
    }

    #[test]
    fn convex_polygons_are_fanned() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn straight_corners_get_triangles_with_an_area() {
        let side = [[0., 0.], [1., 0.], [2., 0.], [3., 0.], [0., 3.]];
        for t in cut(&side) {
            assert!(t.contains(&4), "{t:?}");
        }
    }

    #[test]
    fn a_comb_is_covered_once() {
        let mut comb = vec![[20., 3.], [-1., 3.]];
        for k in 0..20 {
            comb.push([f64::from(k), f64::from(k % 2)]);
        }
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| comb[k as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        let triangles = cut(&comb);
        let fan: f64 = (1..21).map(|k| area(&[0, k, k + 1])).sum();
        assert!(triangles.iter().all(|t| area(t) > 0.0));
        assert_eq!(triangles.iter().map(area).sum::<f64>(), fan);
    }

    #[test]
    fn rings_start_where_they_can_be_fanned() {
        // Not convex at the second corner: only from it and the fourth.
        let arrow: [Point; 4] = [
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [2.0, 0.0, 1.0],
            [1.0, 3.0, 1.0],
        ];
        // A U: no corner sees all others.
        let u = [
            [0, 0],
            [5, 0],
            [5, 5],
            [4, 5],
            [4, 1],
            [1, 1],
            [1, 5],
            [0, 5],
        ];
        let u = u.map(|[x, y]| [f64::from(x), f64::from(y), 2.0]);
        let points: Vec<Point> = arrow.into_iter().chain(u).collect();
        let mut rings = vec![
            vec![0, 1, 2, 3],
            vec![3, 2, 1, 0],
            vec![1, 2, 3, 0],
            (4..12).collect(),
            vec![0, 2, 3],
        ];
        let can = start_fans(&points, &mut rings);
        assert_eq!(can, [true, true, true, false, true]);
        assert_eq!(rings[..3], [[1, 2, 3, 0], [3, 2, 1, 0], [1, 2, 3, 0]]);
    }

    #[test]
    fn a_bow_tie_is_fanned() {
        let tie = [[0., 0.], [2., 2.], [2., 0.], [0., 3.]];
        assert_eq!(cut(&tie), [[0, 1, 2], [0, 2, 3]]);
    }
}
