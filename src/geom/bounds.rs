//! Axis-aligned boxes.

use super::{vec3, Point};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Point,
    /// Largest coordinates.
    pub max: Point,
}

impl Bounds {
    /// The smallest box holding all points; `None` for no points.
    pub fn of(points: &[Point]) -> Option<Bounds> {
        let first = *points.first()?;
        let mut bounds = Bounds {
            min: first,
            max: first,
        };
        for p in points {
            for k in 0..3 {
                bounds.min[k] = bounds.min[k].min(p[k]);
                bounds.max[k] = bounds.max[k].max(p[k]);
            }
        }
        Some(bounds)
    }

    /// The length of the diagonal, also where its square is no number.
    pub fn diagonal(&self) -> f64 {
        let sides = vec3::sub(self.max, self.min);
        let most = sides.iter().fold(0.0, |most: f64, s| most.max(*s));
        match most {
            // Squares are numbers of full precision.
            1e-140..1e140 => vec3::norm(sides),
            _ if most == 0.0 || !most.is_finite() => most,
            _ => most * vec3::norm(sides.map(|s| s / most)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonals_of_any_size() {
        for size in [1.0, 1e-300, 1e-320, 1e300, 1e139, 1e-141] {
            let bounds = Bounds {
                min: [0.0; 3],
                max: [2.0 * size, 3.0 * size, 6.0 * size],
            };
            let off = bounds.diagonal() / (7.0 * size) - 1.0;
            assert!(off.abs() < 1e-3, "{size:e}: {off}");
        }
        let point = Bounds {
            min: [1.0; 3],
            max: [1.0; 3],
        };
        assert_eq!(point.diagonal(), 0.0);
        let widest = Bounds {
            min: [-f64::MAX; 3],
            max: [f64::MAX; 3],
        };
        assert_eq!(widest.diagonal(), f64::INFINITY);
    }
}
