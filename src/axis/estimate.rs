//! What the samples on a ball span, where a file does not say.
//!
//! Along a sheet of the medial axis the radius changes with the slope
//! `g = |grad r|`, and the two points where the ball touches the surface are
//! seen from its centre under half the angle `arccos(g)` from the sheet: they are
//! `2 r sqrt(1 - g²)` apart. The gradient is found by least squares over the
//! edges of the shape at a ball; with a single edge, or with edges in one line, it
//! is the slope along them. Balls without edges count as touched on opposite
//! sides.

use crate::geom::vec3::{dot, sub};
use crate::geom::{Ball, Point};
use crate::simplify::Contact;
use crate::surface::PowerShape;

/// Estimates the contacts of the balls of a shape, then of those of its other
/// side.
pub fn contacts(shape: &PowerShape) -> Vec<Contact> {
    let complex = shape.simplices();
    let mut normal = vec![Normal::default(); shape.balls.len()];
    for &[a, b] in &complex.edges {
        let (p, q) = (&shape.balls[a as usize], &shape.balls[b as usize]);
        normal[a as usize].add(sub(q.centre, p.centre), q.radius - p.radius);
        normal[b as usize].add(sub(p.centre, q.centre), p.radius - q.radius);
    }
    let own = shape.balls.iter().zip(&normal);
    let own = own.map(|(ball, n)| across(ball, n.slope()));
    own.chain(shape.others.iter().map(|ball| across(ball, 0.0)))
        .collect()
}

fn across(ball: &Ball, slope: f64) -> Contact {
    let diameter = 2.0 * ball.radius * (1.0 - slope * slope).max(0.0).sqrt();
    Contact {
        diameter,
        circumradius: diameter / 2.0,
        spacing: 0.0,
    }
}

/// Normal equations of a gradient, edges weighted by the inverse of their
/// squared lengths.
#[derive(Clone, Default)]
struct Normal {
    matrix: [[f64; 3]; 3],
    right: Point,
    edges: usize,
}

impl Normal {
    fn add(&mut self, along: Point, rise: f64) {
        let length_sq = dot(along, along);
        if length_sq <= 0.0 {
            return;
        }
        for i in 0..3 {
            for j in 0..3 {
                self.matrix[i][j] += along[i] * along[j] / length_sq;
            }
            self.right[i] += along[i] * rise / length_sq;
        }
        self.edges += 1;
    }

    /// The length of the gradient, at most 1. A little is added to the
    /// diagonal: across the sheet there is nothing to tell.
    fn slope(&self) -> f64 {
        if self.edges == 0 {
            return 0.0;
        }
        let little = 1e-3 * self.edges as f64;
        let mut rows = self.matrix;
        let mut right = self.right;
        for i in 0..3 {
            rows[i][i] += little;
        }
        // Positive definite: no pivot is 0.
        for i in 0..3 {
            for j in i + 1..3 {
                let factor = rows[j][i] / rows[i][i];
                for k in i..3 {
                    rows[j][k] -= factor * rows[i][k];
                }
                right[j] -= factor * right[i];
            }
        }
        let mut g = [0.0; 3];
        for i in (0..3).rev() {
            let known: f64 = (i + 1..3).map(|k| rows[i][k] * g[k]).sum();
            g[i] = (right[i] - known) / rows[i][i];
        }
        dot(g, g).sqrt().min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_of_balls_is_touched_at_its_angle() {
        // Balls along a line whose radius grows by 0.6 of the distance.
        let balls: Vec<Ball> = (1..6)
            .map(|k| Ball::new([f64::from(k), 0.0, 0.0], 0.6 * f64::from(k)))
            .collect();
        let shape = PowerShape {
            edges: (0..4).map(|k| [k, k + 1]).collect(),
            balls,
            ..PowerShape::default()
        };
        for (ball, contact) in shape.balls.iter().zip(contacts(&shape)) {
            let expected = 2.0 * ball.radius * 0.8;
            assert!(
                (contact.diameter / expected - 1.0).abs() < 1e-2,
                "{contact:?}"
            );
        }
    }

    #[test]
    fn a_ball_alone_is_touched_on_opposite_sides() {
        let shape = PowerShape {
            balls: vec![Ball::new([0.0; 3], 2.0)],
            ..PowerShape::default()
        };
        assert_eq!(contacts(&shape)[0].diameter, 4.0);
    }
}
