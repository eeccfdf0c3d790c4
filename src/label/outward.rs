//! What normals, or the places of scanners, say of balls: a step beyond the
//! paper, which has points only.
//!
//! A vector out of the solid at a sample, its normal or the way to the scanner
//! that saw it, tells the sides of both poles: with the weight of the cosine
//! between the vector and the way to the pole. Files are often wrong about normals:
//! they may point inwards, or either way at random. So labels found
//! without them are asked first ([`Agreement`]): where they agree with most
//! vectors, or with the opposites of most, the vectors are believed, as evidence
//! among other; else not at all. (What walls amid noise need, whose labels would be lost,
//! `noise/sheets.rs` sees to before there are labels.)

use super::{energy, label, Evidence, LabelOptions, Labels, Neighbours};
use crate::context::{Cancelled, Context};
use crate::geom::vec3::{direction, dot, norm, scale, sub};
use crate::geom::{Point, Side};
use crate::poles::NO_POLE;
use crate::predicates::Site;

/// The share of vectors, by weight, that labels must agree with for any to be
/// believed; of vectors that point either way they agree with half.
const ENOUGH: f64 = 0.8;

/// How labels agree with the vectors given.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Agreement {
    /// Samples with a vector.
    pub samples: usize,
    /// The share of the vectors, by weight, that agree with labels found without
    /// them.
    pub share: f64,
    /// Whether they were taken as evidence.
    pub believed: bool,
    /// Whether they were turned around for that: nearly all point inwards.
    pub turned: bool,
}

/// Vectors out of the solid that are believed.
#[derive(Clone, Debug)]
pub struct Seen {
    /// One for each sample, of unit length, zero where nothing is known.
    pub ways: Vec<Point>,
    /// What they say of each ball ([`Evidence::outward`]): the sum of the cosines
    /// between them and the ways from the samples to the ball.
    pub said: Vec<f32>,
}

impl Seen {
    /// Holds vectors of any length against the sides of the balls found without them; turns them
    /// around if nearly all point inwards. `of_sample` has the poles of
    /// each sample, `sites` its place. `None` if they are not believed.
    pub fn of(
        evidence: &Evidence,
        of_sample: &[[u32; 2]],
        sites: &[Site],
        mut ways: Vec<Point>,
        sides: &[Side],
    ) -> (Agreement, Option<Seen>) {
        ways.iter_mut().for_each(|w| *w = direction(*w));
        let mut said = said(evidence, of_sample, sites, &ways);
        let agreement = Agreement::of(&said, sides, &ways);
        if !agreement.believed {
            return (agreement, None);
        }
        if agreement.turned {
            ways.iter_mut().for_each(|w| *w = scale(*w, -1.0));
            said.iter_mut().for_each(|v| *v = -*v);
        }
        (agreement, Some(Seen { ways, said }))
    }

    /// Labels once more, with what the vectors say in the evidence; as before where
    /// less evidence is against those.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn label_again(
        evidence: &Evidence,
        neighbours: &Neighbours,
        before: Labels,
        options: &LabelOptions,
        context: &Context,
    ) -> Result<Labels, Cancelled> {
        let again = label(evidence, neighbours, options, context)?;
        let against = |l: &Labels| energy(evidence, neighbours, &l.sides, options).total();
        Ok(if against(&again) < against(&before) {
            again
        } else {
            before
        })
    }
}

/// What `ways` say of each ball.
fn said(evidence: &Evidence, of_sample: &[[u32; 2]], sites: &[Site], ways: &[Point]) -> Vec<f32> {
    let mut said = vec![0.0f64; evidence.balls.len()];
    for ((poles, site), &way) in of_sample.iter().zip(sites).zip(ways) {
        if way == [0.0; 3] {
            continue;
        }
        let s = [site[0], site[1], site[2]];
        for &p in poles.iter().filter(|&&p| p != NO_POLE) {
            let to = sub(evidence.balls[p as usize].centre, s);
            let far = norm(to);
            if far > 0.0 {
                said[p as usize] += dot(to, way) / far;
            }
        }
    }
    said.into_iter().map(|v| v as f32).collect()
}

impl Agreement {
    /// How what is said of balls agrees with their labels.
    fn of(said: &[f32], sides: &[Side], ways: &[Point]) -> Agreement {
        let (mut agreed, mut all) = (0.0, 0.0);
        for (&v, &side) in said.iter().zip(sides) {
            let v = f64::from(v);
            all += v.abs();
            if (v > 0.0) == (side == Side::Outer) {
                agreed += v.abs();
            }
        }
        let share = if all > 0.0 { agreed / all } else { 0.5 };
        Agreement {
            samples: ways.iter().filter(|w| w.iter().any(|&c| c != 0.0)).count(),
            share,
            believed: share.max(1.0 - share) >= ENOUGH,
            turned: share < 0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Ball;

    #[test]
    fn normals_are_believed_where_most_agree() {
        let n = 40;
        let balls: Vec<Ball> = (0..2 * n)
            .map(|b| Ball::new([f64::from(b / 2), 0.0, f64::from(b % 2 * 2 - 1)], 1.0))
            .collect();
        let evidence = Evidence {
            balls: &balls,
            outer: &vec![false; balls.len()],
            opposites: &[],
            outward: &[],
        };
        let of_sample: Vec<[u32; 2]> = (0..n as u32).map(|s| [2 * s, 2 * s + 1]).collect();
        let sites: Vec<Site> = (0..n).map(|s| [f64::from(s), 0.0, 0.0, 0.0]).collect();
        let sides: Vec<Side> = (0..2 * n)
            .map(|b| [Side::Inner, Side::Outer][b as usize % 2])
            .collect();
        let ask = |way: &dyn Fn(i32) -> f64| {
            let ways: Vec<Point> = (0..n).map(|s| [0.0, 0.0, way(s)]).collect();
            let (agreement, seen) = Seen::of(&evidence, &of_sample, &sites, ways, &sides);
            (agreement, seen.map(|s| s.said).unwrap_or_default())
        };
        let (up, said) = ask(&|_| 2.5);
        assert!(up.believed && up.share == 1.0 && up.samples == 40);
        assert_eq!(said[..2], [-1.0, 1.0]);
        // Inwards: turned around.
        let (down, said) = ask(&|_| -1.0);
        assert!(down.believed && down.turned && down.share == 0.0);
        assert_eq!(said[..2], [-1.0, 1.0]);
        let (either, _) = ask(&|s| f64::from(s % 2 * 2 - 1));
        assert!(!either.believed && either.share == 0.5);
        let (few, _) = ask(&|s| if s < 3 { 1.0 } else { 0.0 });
        assert!(few.believed && few.samples == 3);
    }
}
