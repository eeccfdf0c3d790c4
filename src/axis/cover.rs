//! A given number of balls: those that stand for all others best, moved to fit
//! them.
//!
//! The greedy cover of section 7.3 leaves the fewer balls the larger delta
//! is; the delta that leaves no more than wanted is found by halving. Then
//! each ball is moved to fit the samples of the balls that it stands for: where a
//! ball touches a sample, its tangent plane is one of the surface, and the sum of squares
//! of `n (q - c) - r` over those planes, the spherical quadric error (Thiery, Guy and
//! Boubekeur 2013; Li and others 2015), has its least value where a system
//! of four linear equations says. A little of the old ball is mixed in: a flat
//! cluster does not fix a ball.

use super::LabelledBalls;
use crate::context::{Cancelled, Context, Portion};
use crate::error::Error;
use crate::geom::vec3::{norm, sub};
use crate::geom::{Ball, Side};
use crate::simplify::contained_balls;
use crate::tetra::Edges;

/// Halvings of delta.
const HALVINGS: usize = 24;

/// Weight of the old ball, as a share of that of its samples.
const HOLD: f64 = 0.05;

/// What the fewest balls are sought among.
pub struct Cover<'a> {
    pub balls: &'a LabelledBalls,
    pub keep: &'a [bool],
    pub graph: &'a Edges,
    pub side: Side,
}

impl Cover<'_> {
    /// The balls that go so that at most so many of the side stay, each with
    /// the ball that stands for it.
    pub fn at_most(&self, most: usize, progress: &Portion) -> Result<Vec<[u32; 2]>, Cancelled> {
        let own = |b: u32| self.balls.sides[b as usize] == self.side;
        let count = (0..self.keep.len() as u32)
            .filter(|&b| self.keep[b as usize] && own(b))
            .count();
        let alike = |a: u32, b: u32| own(a) && own(b);
        let (mut low, mut high) = (0.0, 4.0 * self.balls.diagonal);
        let mut best = Vec::new();
        for step in 0..HALVINGS {
            progress.advance(step, HALVINGS)?;
            let delta = if step == 0 { high } else { (low + high) / 2.0 };
            let context = progress.context;
            let part = Portion {
                context,
                stage: progress.stage,
                percent: [progress.percent[0], progress.percent[0]],
            };
            let gone = contained_balls(
                &self.balls.balls,
                self.keep,
                &alike,
                self.graph,
                delta,
                &part,
            )?;
            if count - gone.len() <= most {
                best = gone;
                high = delta;
            } else {
                low = delta;
            }
            // As near to the number as a hundredth is near enough.
            if count - best.len() <= most && (count - best.len()) * 100 >= most * 99 {
                break;
            }
        }
        Ok(best)
    }
}

/// Moves the balls of `kept` to fit the samples of the balls of `all` that
/// they stand for. None where there is nothing to move.
pub fn improved(
    all: &LabelledBalls,
    kept: &LabelledBalls,
    stands_for: &[[u32; 2]],
    context: &Context,
) -> Result<Option<LabelledBalls>, Error> {
    if stands_for.is_empty() || all.places.is_empty() {
        return Ok(None);
    }
    // Ids need not ascend where a file gave them.
    let mut place: Vec<(u32, u32)> = kept.ids.iter().copied().zip(0..).collect();
    place.sort_unstable();
    let at = |id: u32| {
        let found = place.binary_search_by_key(&id, |p| p.0);
        found.ok().map(|k| place[k].1 as usize)
    };
    let mut fits = vec![Fit::default(); kept.balls.len()];
    let own = (0..all.balls.len() as u32).map(|b| [b, b]);
    for [b, by] in stands_for.iter().copied().chain(own) {
        let Some(k) = at(all.ids[by as usize]) else {
            continue;
        };
        let ball = &all.balls[b as usize];
        for &s in all.touching.at(b) {
            fits[k].add(ball, &kept.balls[k], all.places[s as usize]);
        }
    }
    let taken: Vec<usize> = {
        let mut taken: Vec<usize> = stands_for
            .iter()
            .filter_map(|pair| at(all.ids[pair[1] as usize]))
            .collect();
        taken.sort_unstable();
        taken.dedup();
        taken
    };
    let mut balls = kept.balls.clone();
    for k in taken {
        if let Some(ball) = fits[k].solve(&kept.balls[k]) {
            balls[k] = ball;
        }
    }
    kept.moved(balls, context).map(Some)
}

/// The normal equations of the change of a ball: centre, then radius.
#[derive(Clone, Default)]
struct Fit {
    matrix: [[f64; 4]; 4],
    right: [f64; 4],
    planes: f64,
}

impl Fit {
    /// The plane that touches `ball` at a sample is to touch `old` moved.
    fn add(&mut self, ball: &Ball, old: &Ball, sample: [f64; 3]) {
        let to = sub(sample, ball.centre);
        let length = norm(to);
        if length <= 0.0 {
            return;
        }
        let normal = to.map(|x| x / length);
        let row = [normal[0], normal[1], normal[2], 1.0];
        let ahead = sub(sample, old.centre);
        let miss = (0..3).map(|k| normal[k] * ahead[k]).sum::<f64>() - old.radius;
        for i in 0..4 {
            for j in 0..4 {
                self.matrix[i][j] += row[i] * row[j];
            }
            self.right[i] += row[i] * miss;
        }
        self.planes += 1.0;
    }

    fn solve(&self, old: &Ball) -> Option<Ball> {
        if self.planes == 0.0 {
            return None;
        }
        let (mut m, mut x) = (self.matrix, self.right);
        for i in 0..4 {
            m[i][i] += HOLD * self.planes;
        }
        for i in 0..4 {
            for j in i + 1..4 {
                let factor = m[j][i] / m[i][i];
                for k in i..4 {
                    m[j][k] -= factor * m[i][k];
                }
                x[j] -= factor * x[i];
            }
        }
        for i in (0..4).rev() {
            for k in i + 1..4 {
                x[i] -= m[i][k] * x[k];
            }
            x[i] /= m[i][i];
        }
        let centre = [0, 1, 2].map(|k| old.centre[k] + x[k]);
        let radius = old.radius + x[3];
        (x.iter().all(|v| v.is_finite()) && radius > 0.0).then(|| Ball::new(centre, radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_moves_to_the_one_that_fits() {
        let truth = Ball::new([1.0, 2.0, 3.0], 2.0);
        let old = Ball::new([1.1, 1.9, 3.0], 1.8);
        let mut fit = Fit::default();
        for k in 0..3 {
            for side in [-2.0, 2.0] {
                let mut sample = truth.centre;
                sample[k] += side;
                fit.add(&truth, &old, sample);
            }
        }
        let ball = fit.solve(&old).unwrap();
        // Six planes against a weight of 0.3: a little of the old one stays.
        assert!((ball.radius - 2.0).abs() < 0.011, "{ball:?}");
        assert!((ball.centre[0] - 1.0).abs() < 0.014, "{ball:?}");
        assert!(Fit::default().solve(&old).is_none());
    }
}
