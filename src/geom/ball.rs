//! Balls, their power distance, and the two sides of a surface.

use super::{vec3, Point};

/// A ball: the weighted point of a power diagram, or a point of a medial axis
/// with its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre, in the units of the input.
    pub centre: Point,
    /// Radius, in the units of the input. Never negative.
    pub radius: f64,
}

impl Ball {
    /// The ball about `centre` with the given radius.
    pub fn new(centre: Point, radius: f64) -> Ball {
        Ball { centre, radius }
    }

    /// The power distance `|x - c|² - r²` of a point: negative inside the
    /// ball, zero on its sphere (section 2 of the paper).
    ///
    /// ```
    /// use powercrust::Ball;
    /// let ball = Ball::new([0.0, 0.0, 0.0], 2.0);
    /// assert_eq!(ball.power([3.0, 0.0, 0.0]), 5.0);
    /// assert_eq!(ball.power([0.0, 2.0, 0.0]), 0.0);
    /// ```
    pub fn power(&self, x: Point) -> f64 {
        vec3::dist_sq(x, self.centre) - self.radius * self.radius
    }

    /// How deeply two balls intersect, as `-cos alpha` of the angle at which
    /// their spheres meet (figure 7 of the paper): 1 when one lies inside the
    /// other, 0 when they cross at right angles, -1 when they touch from
    /// outside. `None` for disjoint balls, which say nothing about each other.
    pub fn depth(&self, other: &Ball) -> Option<f64> {
        let (p, q) = (self.radius, other.radius);
        let distance_sq = vec3::dist_sq(self.centre, other.centre);
        let both = p + q;
        if distance_sq >= both * both {
            return None;
        }
        let denominator = 2.0 * p * q;
        if denominator <= 0.0 {
            return None;
        }
        let cosine = (p * p + q * q - distance_sq) / denominator;
        Some(cosine.clamp(-1.0, 1.0))
    }
}

/// Which side of the surface a ball lies on: its label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Inside the solid.
    Inner,
    /// Outside the solid.
    Outer,
}

impl Side {
    /// The other side.
    pub fn opposite(self) -> Side {
        match self {
            Side::Inner => Side::Outer,
            Side::Outer => Side::Inner,
        }
    }
}
