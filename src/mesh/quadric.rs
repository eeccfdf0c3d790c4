//! Sums of squared distances to planes (Garland and Heckbert 1997).

use crate::geom::vec3::{add, dot, norm, scale};
use crate::geom::Point;

/// `x -> sum of weight * distance(x, plane)^2`, for points of size about 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quadric {
    /// xx, xy, xz, yy, yz, zz.
    square: [f64; 6],
    linear: Point,
    constant: f64,
}

impl Quadric {
    /// Of the plane through `p` at right angles to `normal`, weighted by the
    /// length of that.
    pub fn of_plane(p: Point, normal: Point) -> Quadric {
        let weight = norm(normal);
        if weight <= 0.0 || !weight.is_finite() {
            return Quadric::default();
        }
        let n = scale(normal, 1.0 / weight);
        let d = -dot(n, p);
        Quadric {
            square: [
                n[0] * n[0],
                n[0] * n[1],
                n[0] * n[2],
                n[1] * n[1],
                n[1] * n[2],
                n[2] * n[2],
            ]
            .map(|x| weight * x),
            linear: scale(n, weight * d),
            constant: weight * d * d,
        }
    }

    pub fn add(&mut self, other: &Quadric) {
        for (a, b) in self.square.iter_mut().zip(other.square) {
            *a += b;
        }
        self.linear = add(self.linear, other.linear);
        self.constant += other.constant;
    }

    pub fn at(&self, p: Point) -> f64 {
        let s = &self.square;
        let rows = [
            dot([s[0], s[1], s[2]], p),
            dot([s[1], s[3], s[4]], p),
            dot([s[2], s[4], s[5]], p),
        ];
        dot(rows, p) + 2.0 * dot(self.linear, p) + self.constant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_two_planes() {
        let mut q = Quadric::of_plane([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]);
        q.add(&Quadric::of_plane([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
        let away = [5.0, 9.0, 2.0];
        assert!((q.at(away) - (2.0 * 1.0 + 4.0)).abs() < 1e-12);
        assert_eq!(Quadric::of_plane([1.0; 3], [0.0; 3]).at([7.0; 3]), 0.0);
    }
}
