//! The distance from the crust, as a field that faces are fitted to.

use crate::fit::{Field, Foot};
use crate::geom::vec3::plain::{dot, norm};
use crate::geom::vec3::{scale, sub};
use crate::geom::Point;
use crate::mesh::Surface;

/// All that is at a distance from a surface.
pub(super) struct Distance<'a> {
    /// The crust.
    pub base: &'a Surface,
    /// The distance from it, positive outside.
    pub distance: f64,
    /// How far faces may be off.
    pub tolerance: f64,
}

impl Field for Distance<'_> {
    fn foot(&self, at: Point, outward: Point, scratch: &mut Vec<(f64, u32)>) -> Option<Foot> {
        let away = sub(at, self.base.nearest(at, scratch)?);
        let far = norm(away);
        // The side is known but near the crust.
        let positive = match 2.0 * far > self.distance.abs() {
            true => self.distance > 0.0,
            false => dot(away, outward) >= 0.0,
        };
        let signed = if positive { far } else { -far };
        let normal = match far > 0.0 {
            true => scale(away, 1.0 / signed),
            false => outward,
        };
        Some(Foot {
            normal,
            off: signed - self.distance,
        })
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The tips of mitres go this far.
    fn reach(&self) -> f64 {
        self.distance.abs()
    }
}
