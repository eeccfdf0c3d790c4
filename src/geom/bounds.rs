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

    /// The length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        vec3::norm(vec3::sub(self.max, self.min))
    }
}
