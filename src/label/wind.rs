//! Labels that agree with winding numbers: a step beyond the paper, for noise.
//!
//! The queue of figure 8 knows what is near: through one ball amid noise belief
//! leaks, and a whole ear may turn inside out. What lies inside is also told
//! from afar, by the winding number of the samples around
//! ([`super::winding`]), once they are oriented. The poles orient them: a
//! sample looks from its inner to its outer pole, or that way of both which its normal, if
//! believed ([`super::Seen`]), is nearer to. So, in turn: orient the samples by the
//! labels, take winding numbers at the centres of the balls, and let those balls
//! change sides that they contradict clearly; until nothing changes.
//! (Iterating between normals and winding numbers is due to Lin, Shi and Liu, 2024, and finds its way
//! from random normals; here it starts from labels that are nearly all right.)
//!
//! Winding numbers mean little where samples surround nothing, as in a scan of one
//! side. Then they are far from 0 and 1 at many balls, and nothing is changed.

use rayon::prelude::*;

use super::winding::Winding;
use super::{Evidence, Labels};
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{dot, norm, scale, sub};
use crate::geom::{Point, Side};
use crate::poles::NO_POLE;
use crate::predicates::Site;

/// A winding number contradicts a label if it is beyond 1/2 by this much: at
/// edges it is less than 1/2 within the solid, too.
const CLEARLY: f64 = 0.15;

/// A ball whose number is nearer to 0 or 1 than this is looked at only once.
const SURE: f64 = 0.1;

/// The mean square by which winding numbers differ from labels, beyond which samples
/// surround nothing. Noisy closed surfaces were found to have 0.004 to 0.044, scans of one
/// side 0.09 to 0.16.
const OPEN: f64 = 0.05;

/// Samples look softer than points by this share of their spacing.
const SOFT: f64 = 0.5;

/// Rounds at most.
const ROUNDS: usize = 8;

/// What winding numbers said of the labels, and what was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Wound {
    /// Labels changed.
    pub changed: u32,
    /// The mean square by which winding numbers differed from labels.
    pub before: f64,
    /// The same in the end; as before if no label was changed.
    pub after: f64,
}

/// Lets balls change sides that winding numbers contradict. `of_sample` has
/// the poles of each sample, `sites` its place, `spacing` the distance to its
/// neighbours, all in steps of the lattice; `ways` a vector out of the solid,
/// zero where none is known, or is empty.
///
/// # Errors
/// [`Cancelled`].
pub fn wind(
    evidence: &Evidence,
    of_sample: &[[u32; 2]],
    sites: &[Site],
    spacing: &[f64],
    ways: &[Point],
    labels: &mut Labels,
    context: &Context,
) -> Result<Wound, Cancelled> {
    let places: Vec<Point> = (sites[..of_sample.len()].iter())
        .map(|s| [s[0], s[1], s[2]])
        .collect();
    let axes = axes(evidence, of_sample, &places, spacing);
    let soft: Vec<f64> = spacing.iter().map(|h| (SOFT * h).powi(2)).collect();
    let first = labels.sides.clone();
    let mut looked_at: Vec<u32> = (0..evidence.balls.len() as u32)
        .filter(|&b| !evidence.outer[b as usize])
        .collect();
    let mut field = vec![f64::NAN; evidence.balls.len()];
    let mut wound = Wound::default();
    let mut factor = 1.0;
    for round in 0..ROUNDS {
        context.advance(Stage::Labels, 95, 100)?;
        let dipoles = (of_sample.iter().zip(&axes).enumerate())
            .map(|(s, (poles, &axis))| {
                let told = ways.get(s).map_or(0.0, |&way| dot(axis, way));
                let sign = match told == 0.0 {
                    true => orientation(poles, &labels.sides, &field),
                    false => told.signum(),
                };
                scale(axis, sign)
            })
            .collect();
        let winding = Winding::of(&places, dipoles, &soft);
        let found: Vec<f64> = (looked_at.par_iter())
            .map(|&b| winding.at(evidence.balls[b as usize].centre))
            .collect();
        if round == 0 {
            // Areas are known but for a factor.
            let inner = looked_at.iter().zip(&found);
            let inner = inner.filter(|(&b, _)| first[b as usize] == Side::Inner);
            match median(inner.map(|(_, &w)| w).collect()) {
                Some(middle) => factor = 1.0 / middle.clamp(0.5, 2.0),
                None => return Ok(wound),
            }
        }
        for (&b, w) in looked_at.iter().zip(found) {
            field[b as usize] = factor * w;
        }
        let off = off(&field, &labels.sides);
        wound.after = off;
        if round == 0 {
            wound.before = off;
            if off > OPEN {
                return Ok(wound);
            }
        }
        let mut changed = 0;
        looked_at.retain(|&b| {
            let (w, side) = (field[b as usize], &mut labels.sides[b as usize]);
            let wanted = match w - 0.5 {
                above if above > CLEARLY => Side::Inner,
                above if above < -CLEARLY => Side::Outer,
                _ => *side,
            };
            let contradicted = *side != wanted;
            changed += u32::from(contradicted);
            *side = wanted;
            contradicted || (w > SURE && w < 1.0 - SURE)
        });
        wound.changed += changed;
        if changed == 0 {
            break;
        }
    }
    if wound.after > wound.before {
        labels.sides = first;
        wound.changed = 0;
        wound.after = wound.before;
    }
    Ok(wound)
}

/// The normal of each sample from its first pole to its second, as long as
/// the area it stands for: four samples lie within the distance of the
/// fourth.
fn axes(
    evidence: &Evidence,
    of_sample: &[[u32; 2]],
    places: &[Point],
    spacing: &[f64],
) -> Vec<Point> {
    let unit = |d: Point| match norm(d) {
        n if n > 0.0 => scale(d, 1.0 / n),
        _ => [0.0; 3],
    };
    let axis = |((poles, &s), &h): ((&[u32; 2], &Point), &f64)| {
        let way = |p: u32| unit(sub(evidence.balls[p as usize].centre, s));
        let normal = match *poles {
            [NO_POLE, NO_POLE] => [0.0; 3],
            [p, NO_POLE] => scale(way(p), -1.0),
            [NO_POLE, q] => way(q),
            [p, q] => unit(sub(way(q), way(p))),
        };
        scale(normal, std::f64::consts::FRAC_PI_4 * h * h)
    };
    let samples = of_sample.par_iter().zip(places).zip(spacing);
    samples.map(axis).collect()
}

/// 1 if the first pole of a sample is inside and the second outside, -1 if
/// it is the other way round. Where both carry one label, the winding numbers
/// of the round before decide, if there are any.
fn orientation(poles: &[u32; 2], sides: &[Side], field: &[f64]) -> f64 {
    let sign = |inner| if inner { 1.0 } else { -1.0 };
    let side = |p: u32| sides[p as usize];
    match *poles {
        [NO_POLE, NO_POLE] => 0.0,
        [p, NO_POLE] => sign(side(p) == Side::Inner),
        [NO_POLE, q] => sign(side(q) == Side::Outer),
        [p, q] if side(p) != side(q) => sign(side(p) == Side::Inner),
        [p, q] => match field[p as usize] - field[q as usize] {
            unknown if unknown.is_nan() => 0.0,
            difference => difference.signum(),
        },
    }
}

/// The mean square by which winding numbers differ from labels.
fn off(field: &[f64], sides: &[Side]) -> f64 {
    let known = field.iter().zip(sides).filter(|(w, _)| w.is_finite());
    let (sum, count) = known.fold((0.0, 0u32), |(sum, count), (w, &side)| {
        let off = (w - f64::from(u8::from(side == Side::Inner))).clamp(-1.0, 1.0);
        (sum + off * off, count + 1)
    });
    sum / f64::from(count.max(1))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let at = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Ball;

    /// A sphere of samples, each with a pole inside and one outside.
    fn sphere(count: usize) -> (Vec<Site>, Vec<[u32; 2]>, Vec<Ball>, Labels) {
        let mut sites = Vec::new();
        let mut balls = Vec::new();
        let mut poles = Vec::new();
        for k in 0..count {
            let z = (k as f64 + 0.5) / count as f64 * 2.0 - 1.0;
            let (r, a) = ((1.0 - z * z).sqrt(), k as f64 * 2.399_963);
            let p = [r * a.cos(), r * a.sin(), z];
            sites.push([p[0], p[1], p[2], 0.0]);
            poles.push([balls.len() as u32, balls.len() as u32 + 1]);
            balls.push(Ball::new(scale(p, 0.4), 0.6));
            balls.push(Ball::new(scale(p, 1.6), 0.6));
        }
        let sides = (0..balls.len())
            .map(|b| [Side::Inner, Side::Outer][b % 2])
            .collect();
        let labels = Labels {
            sides,
            unreached: 0,
        };
        (sites, poles, balls, labels)
    }

    #[test]
    fn balls_on_the_wrong_side_change_it() {
        let (sites, poles, balls, truth) = sphere(600);
        let outer = vec![false; balls.len()];
        let evidence = Evidence {
            balls: &balls,
            outer: &outer,
            opposites: &[],
            outward: &[],
        };
        let spacing = vec![(4.0 * std::f64::consts::PI / 600.0f64).sqrt(); 600];
        let mut labels = truth.clone();
        // A cap turned inside out, and single balls.
        for b in (0..60).chain([200, 301, 777]) {
            labels.sides[b] = labels.sides[b].opposite();
        }
        let cx = Context::default();
        let wound = wind(&evidence, &poles, &sites, &spacing, &[], &mut labels, &cx).unwrap();
        assert!(labels.sides == truth.sides);
        assert_eq!(wound.changed, 63);
        assert!(wound.after < wound.before);
        // A cap surrounds nothing.
        let cap = 150;
        let mut labels = Labels {
            sides: truth.sides[..2 * cap].to_vec(),
            unreached: 0,
        };
        labels.sides[7] = labels.sides[7].opposite();
        let before = labels.sides.clone();
        let evidence = Evidence {
            balls: &balls[..2 * cap],
            outer: &outer[..2 * cap],
            opposites: &[],
            outward: &[],
        };
        let wound = wind(
            &evidence,
            &poles[..cap],
            &sites[..cap],
            &spacing[..cap],
            &[],
            &mut labels,
            &cx,
        )
        .unwrap();
        assert!(wound.changed == 0 && labels.sides == before, "{wound:?}");
    }
}
