//! Quadrics fitted to nearby samples by weighted least squares.
//!
//! The frame is that of the principal axes, the height a polynomial of the
//! second degree over the two larger ones. Where the samples do not
//! determine it, a plane is fitted.

use crate::geom::vec3::{add, cross, dot, scale, sub};
use crate::geom::Point;

/// Coefficients of `1, x, y, x², xy, y²`.
const TERMS: usize = 6;

/// A height over a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    origin: Point,
    /// Two directions in the plane, and that of the height.
    axes: [Point; 3],
    /// A length: coordinates in the plane are divided by it.
    size: f64,
    height: [f64; TERMS],
    /// Sum of the weights times the squares of what the fit misses.
    missed: f64,
    /// Number of coefficients that were fitted.
    pub terms: usize,
}

impl Fit {
    /// Fits samples, given relative to `origin`, with their weights; `reach`
    /// is the distance of the farthest. `None` where they span no plane.
    pub fn of(origin: Point, offsets: &[Point], weights: &[f64], reach: f64) -> Option<Fit> {
        if reach <= 0.0 {
            return None;
        }
        let weighted = offsets.iter().copied().zip(weights.iter().copied());
        let axes = principal_axes(weighted, reach)?;
        let mut moments = [[0.0; TERMS]; TERMS];
        let mut right = [0.0; TERMS];
        let mut square = 0.0;
        for (&offset, &w) in offsets.iter().zip(weights) {
            let [x, y, z] = axes.map(|a| dot(a, offset) / reach);
            let row = [1.0, x, y, x * x, x * y, y * y];
            for i in 0..TERMS {
                let v = w * row[i];
                right[i] += v * z;
                for j in 0..=i {
                    moments[i][j] += v * row[j];
                }
            }
            square += w * z * z;
        }
        let (height, terms) = match solve::<TERMS>(&moments, &right) {
            Some(height) => (height, TERMS),
            None => {
                let small = [0, 1, 2].map(|i| [0, 1, 2].map(|j| moments[i][j]));
                let plane = solve::<3>(&small, &[right[0], right[1], right[2]])?;
                ([plane[0], plane[1], plane[2], 0.0, 0.0, 0.0], 3)
            }
        };
        let explained: f64 = height.iter().zip(&right).map(|(h, r)| h * r).sum();
        Some(Fit {
            origin,
            axes,
            size: reach,
            height,
            missed: (square - explained).max(0.0) * reach * reach,
            terms,
        })
    }

    /// The root mean square of what the fit misses, for weights of 1.
    pub fn residual(&self, count: usize) -> f64 {
        match count > self.terms {
            true => (self.missed / (count - self.terms) as f64).sqrt(),
            false => 0.0,
        }
    }

    /// How far above the surface a sample is, given relative to the origin.
    pub fn height_of(&self, offset: Point) -> f64 {
        let [x, y, z] = self.axes.map(|a| dot(a, offset) / self.size);
        let row = [1.0, x, y, x * x, x * y, y * y];
        let surface: f64 = self.height.iter().zip(&row).map(|(h, r)| h * r).sum();
        (z - surface) * self.size
    }

    /// Where a sample, given relative to the origin, is in the plane under the surface.
    pub fn under(&self, offset: Point) -> Point {
        [dot(self.axes[0], offset), dot(self.axes[1], offset), 0.0]
    }

    /// The standard deviation of what the fit misses, for the weights it was
    /// made with.
    pub fn deviation(&self, weights: &[f64]) -> f64 {
        let sum: f64 = weights.iter().sum();
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        let count = sum * sum / squares;
        match count > self.terms as f64 {
            true => (self.missed / sum * count / (count - self.terms as f64)).sqrt(),
            false => 0.0,
        }
    }

    /// The foot of the origin on the surface, by one step of Newton's method
    /// along the gradient.
    pub fn foot(&self) -> Point {
        let [c, x, y, ..] = self.height;
        let steepness = 1.0 + x * x + y * y;
        let step = c * self.size / steepness;
        let normal = add(
            add(scale(self.axes[0], -x), scale(self.axes[1], -y)),
            self.axes[2],
        );
        add(self.origin, scale(normal, step))
    }
}

/// The principal axes, that of the least spread last.
pub(super) fn principal_axes(
    offsets: impl Iterator<Item = (Point, f64)> + Clone,
    reach: f64,
) -> Option<[Point; 3]> {
    let total: f64 = offsets.clone().map(|o| o.1).sum();
    let mut mean = [0.0; 3];
    for (offset, w) in offsets.clone() {
        mean = add(mean, scale(offset, w / total));
    }
    let mut spread = [[0.0; 3]; 3];
    for (offset, w) in offsets {
        let d = scale(sub(offset, mean), 1.0 / reach);
        for i in 0..3 {
            for j in 0..=i {
                spread[i][j] += w * d[i] * d[j];
            }
        }
    }
    for i in 0..3 {
        for j in 0..i {
            spread[j][i] = spread[i][j];
        }
    }
    let (values, vectors) = eigen(spread);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    // Samples on a line have no plane.
    if values[order[1]] <= 1e-12 * values[order[0]] || !values[order[0]].is_finite() {
        return None;
    }
    let (x, z) = (vectors[order[0]], vectors[order[2]]);
    Some([x, cross(z, x), z])
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix, by rotations
/// (Jacobi, 1846).
fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [Point; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const SWEEPS: usize = 12;
    for _ in 0..SWEEPS {
        let off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
        let on = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
        if off <= 1e-30 * on {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for k in 0..3 {
                let (u, v) = (a[k][p], a[k][q]);
                a[k][p] = c * u - s * v;
                a[k][q] = s * u + c * v;
            }
            for k in 0..3 {
                let (u, v) = (a[p][k], a[q][k]);
                a[p][k] = c * u - s * v;
                a[q][k] = s * u + c * v;
            }
            for k in 0..3 {
                let (u, v) = (vectors[p][k], vectors[q][k]);
                vectors[p][k] = c * u - s * v;
                vectors[q][k] = s * u + c * v;
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

/// Solves a symmetric positive definite system, of which the lower half is
/// given (Cholesky); `None` where it is near singular.
fn solve<const N: usize>(matrix: &[[f64; N]; N], right: &[f64; N]) -> Option<[f64; N]> {
    let mut low = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| low[i][k] * low[j][k]).sum();
            let rest = matrix[i][j] - sum;
            if i == j {
                if rest <= 1e-9 * matrix[i][i] || !rest.is_finite() {
                    return None;
                }
                low[i][i] = rest.sqrt();
            } else {
                low[i][j] = rest / low[j][j];
            }
        }
    }
    let mut found = *right;
    for i in 0..N {
        let sum: f64 = (0..i).map(|k| low[i][k] * found[k]).sum();
        found[i] = (found[i] - sum) / low[i][i];
    }
    for i in (0..N).rev() {
        let sum: f64 = (i + 1..N).map(|k| low[k][i] * found[k]).sum();
        found[i] = (found[i] - sum) / low[i][i];
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadric_is_fitted_exactly() {
        let at = |x: f64, y: f64| [x, y, 0.3 + 0.1 * x - 0.2 * y + 0.05 * x * x - 0.1 * x * y];
        let offsets: Vec<Point> = (0..30)
            .map(|k| at(f64::from(k % 6) * 0.4 - 1.0, f64::from(k / 6) * 0.5 - 1.0))
            .collect();
        let fit = Fit::of([0.0; 3], &offsets, &[1.0; 30], 1.5).unwrap();
        assert_eq!(fit.terms, 6);
        // The frame is tilted, so the height is no polynomial of degree 2
        // there; but nearly.
        assert!(fit.residual(30) < 0.01, "{}", fit.residual(30));
        let foot = fit.foot();
        let off = foot[2] - at(foot[0], foot[1])[2];
        assert!(off.abs() < 0.01, "{off}");
    }

    #[test]
    fn the_foot_on_a_plane_is_the_nearest_point() {
        let offsets: Vec<Point> = (0..25)
            .map(|k| [f64::from(k % 5) - 2.0, f64::from(k / 5) - 2.0, 1.0])
            .collect();
        let fit = Fit::of([7.0, 0.0, 0.0], &offsets, &[1.0; 25], 3.0).unwrap();
        let foot = fit.foot();
        let off = sub(foot, [7.0, 0.0, 1.0]);
        assert!(off.iter().all(|v| v.abs() < 1e-9), "{foot:?}");
        // The sums of squares leave half the digits.
        assert!(fit.residual(25) < 1e-7, "{}", fit.residual(25));
    }

    #[test]
    fn samples_on_a_line_have_no_fit() {
        let offsets: Vec<Point> = (0..9).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        assert!(Fit::of([0.0; 3], &offsets, &[1.0; 9], 8.0).is_none());
        assert!(Fit::of([0.0; 3], &offsets, &[1.0; 9], 0.0).is_none());
    }

    #[test]
    fn eigenvectors_are_what_they_should_be() {
        let a = [[2.0, -1.0, 0.3], [-1.0, 3.0, 0.5], [0.3, 0.5, 1.0]];
        let (values, vectors) = eigen(a);
        for (value, v) in values.iter().zip(vectors) {
            for i in 0..3 {
                assert!((dot(a[i], v) - value * v[i]).abs() < 1e-12);
            }
            assert!((dot(v, v) - 1.0).abs() < 1e-12);
        }
    }
}
