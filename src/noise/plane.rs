//! The plane through some samples by least squares.

use crate::geom::vec3::{add, dist_sq, dot, scale, sub};
use crate::geom::Point;
use crate::noise::fit::principal_axes;

/// A plane with its unit normal.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    middle: Point,
    /// The unit normal, either way.
    pub normal: Point,
    /// How far the samples are off it, root mean square.
    pub missed: f64,
}

impl Plane {
    /// `None` where the samples span none.
    pub fn through(places: &[Point]) -> Option<Plane> {
        let first = *places.first()?;
        let share = 1.0 / places.len() as f64;
        let offsets = places.iter().map(|&p| sub(p, first));
        let reach = places
            .iter()
            .map(|&p| dist_sq(p, first))
            .fold(0.0, f64::max);
        let sum = offsets.clone().fold([0.0; 3], add);
        let [.., normal] = principal_axes(offsets.map(|o| (o, 1.0)), reach.sqrt())?;
        let mut plane = Plane {
            middle: add(first, scale(sum, share)),
            normal,
            missed: 0.0,
        };
        let squares: f64 = places.iter().map(|&p| plane.height(p).powi(2)).sum();
        plane.missed = (squares * share).sqrt();
        Some(plane)
    }

    /// How far above the plane a place is.
    pub fn height(&self, place: Point) -> f64 {
        dot(sub(place, self.middle), self.normal)
    }
}
