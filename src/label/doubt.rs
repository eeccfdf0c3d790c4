//! Which balls stay torn, and how much: labels to be doubted.
//!
//! Evidence is weighed as in [`super::energy`]: opposite poles should differ,
//! deeply intersecting neighbours agree, and normals be right. The doubt about a ball is the share of its
//! evidence that its label goes against: 0 where all agree, at most 1/2
//! after [`super::refine`]. The surface between an inner and an outer ball is as
//! doubtful as the more doubtful of both.

use super::energy::{at_odds, Energy};
use super::{Evidence, LabelOptions, Neighbours};
use crate::geom::Side;

/// The doubt from which a ball counts as torn.
pub const TORN: f32 = 0.25;

/// The energy of a labelling, and the doubt about each ball, in [0, 1].
///
/// ```
/// use powercrust::{reconstruct, Context, Options};
/// # let mut points = vec![];
/// # for x in -1..=1 { for y in -1..=1 { for z in -1..=1 {
/// #     if [x, y, z] != [0, 0, 0] { points.push([x as f64, y as f64, z as f64]); }
/// # }}}
/// let result = reconstruct(&points, &Options::default(), &Context::default())?;
/// // A cube leaves little doubt, and no ball torn.
/// assert!(result.doubt.iter().all(|&d| d < powercrust::label::TORN));
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn doubt(
    evidence: &Evidence,
    neighbours: &Neighbours,
    sides: &[Side],
    options: &LabelOptions,
) -> (Energy, Vec<f32>) {
    // Few balls are at odds with any; only theirs is weighed.
    let (energy, odd) = at_odds(evidence, neighbours, sides, options);
    let mut doubt = vec![0.0; sides.len()];
    if odd.is_empty() {
        return (energy, doubt);
    }
    let mut weighed = vec![[0.0f64; 2]; odd.len()];
    let place = |b: u32| odd.binary_search(&b).ok();
    for pair in evidence.opposites {
        let [p, q] = pair.poles;
        let against = sides[p as usize] == sides[q as usize];
        for at in [p, q].into_iter().filter_map(place) {
            weighed[at][0] += if against { pair.weight } else { 0.0 };
            weighed[at][1] += pair.weight;
        }
    }
    for (&b, [mut against, mut all]) in odd.iter().zip(weighed) {
        let side = sides[b as usize];
        let said = evidence.said(b, side);
        against += (-said).max(0.0);
        all += said.abs();
        for &q in neighbours.at(b) {
            if let Some(depth) = evidence.depth(b, q, options) {
                against += if sides[q as usize] != side {
                    depth
                } else {
                    0.0
                };
                all += depth;
            }
        }
        doubt[b as usize] = (against / all) as f32;
    }
    (energy, doubt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::geom::Ball;
    use crate::label::Opposite;
    use crate::power::power_diagram;

    /// Three balls in a row, the outer two deep in the middle one: what they say of it.
    #[test]
    fn doubt_is_the_share_of_evidence_against_a_label() {
        let balls = [-1.0, 0.0, 1.0].map(|x| Ball::new([x, 0.0, 0.0], 2.0));
        let sites = balls.map(|b| [b.centre[0], 0.0, 0.0, 4.0]);
        let power = power_diagram(&sites, 1.0, &Context::default()).unwrap();
        let neighbours = Neighbours::of(&power, &Context::default()).unwrap();
        let depth = balls[0].depth(&balls[1]).unwrap();
        let evidence = Evidence {
            balls: &balls,
            outer: &[false; 3],
            opposites: &[Opposite {
                poles: [0, 2],
                weight: 1.0,
            }],
            outward: &[],
        };
        let of =
            |sides: [Side; 3]| doubt(&evidence, &neighbours, &sides, &LabelOptions::default()).1;
        let (i, o) = (Side::Inner, Side::Outer);
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-6;
        let found = of([i, i, o]);
        assert!(near(found[0], 0.0) && near(found[1], 0.5), "{found:?}");
        assert!(near(found[2], depth / (1.0 + depth)), "{found:?}");
        let found = of([i, i, i]);
        assert!(
            near(found[0], 1.0 / (1.0 + depth)) && near(found[1], 0.0),
            "{found:?}"
        );
    }
}
