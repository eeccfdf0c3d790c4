//! Samples amid noise move to the foot of a quadric fitted around them.
//!
//! How many neighbours are best depends on the shape: on a sphere the more the better. So wider
//! fits are made too, and a sample moves on towards the foot on the next wider one as
//! far as the data allow. The feet on two fits, of which the second has more of the same samples, differ
//! by a variance `v` that noise explains, the difference of theirs, and by what the wider fit smooths away. If the
//! mean square of the differences around is `d`, then of all points between the
//! two feet that at a share of `min(1, v / d)` is expected nearest to the surface: a shrinkage
//! estimate (James and Stein, 1961) in place of the choice of Lepski (1991), without
//! jumps from sample to sample.

use rayon::prelude::*;

use super::fit::Fit;
use super::local::Local;
use super::sheets::Sheets;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, dot, norm, scale, sub};
use crate::geom::Point;

/// Samples between two reports of progress.
const BLOCK: usize = 1 << 14;

/// Wider fits than the first, at most: each to twice as many neighbours as the one before.
const WIDER: usize = 2;

/// And never to more than this, for the sake of time.
const WIDEST: u32 = 160;

/// The variance of a quadric's height at its middle, for samples spread evenly over a disc and the
/// weights used here, is so much, times that of the noise, over the number of samples.
const MIDDLE: f64 = 5.94;

/// Differences between feet are averaged over so many samples.
const AVERAGED: usize = 16;

/// Where each sample goes.
pub(super) fn project(
    sheets: &Sheets,
    local: &[Local],
    context: &Context,
) -> Result<Vec<Point>, Cancelled> {
    let count = sheets.places().len();
    let mut all = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        context.advance(Stage::Noise, (50 + from * 45 / count) as u64, 100)?;
        let block = from..count.min(from + BLOCK);
        all.par_extend(block.into_par_iter().map(|s| match local[s].neighbours {
            0 => Feet::at(sheets.places()[s]),
            _ => feet(sheets, s, &local[s]),
        }));
    }
    let mut moved = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        context.advance(Stage::Noise, (95 + from * 5 / count) as u64, 100)?;
        let block = from..count.min(from + BLOCK);
        moved.par_extend((block.into_par_iter()).map(|s| between(sheets, s, local[s].noise, &all)));
    }
    Ok(moved)
}

/// Feet of one sample.
#[derive(Clone, Copy, Debug)]
struct Feet {
    /// That on the first fit.
    first: Point,
    /// The ways from there to the foot on the next wider fit, and from that to the next.
    steps: [Point; WIDER],
    /// The parts of the noise's variance that these have, where noise is all.
    parts: [f64; WIDER],
    /// How many of them there are.
    wider: usize,
}

impl Feet {
    fn at(first: Point) -> Feet {
        Feet {
            first,
            steps: [[0.0; 3]; WIDER],
            parts: [0.0; WIDER],
            wider: 0,
        }
    }
}

/// The point between the feet of a sample.
fn between(sheets: &Sheets, s: usize, noise: f64, all: &[Feet]) -> Point {
    let own = &all[s];
    let mut to = own.first;
    if own.wider == 0 {
        return to;
    }
    let around = sheets.nearest(s, AVERAGED);
    let mut share = 1.0;
    for step in 0..own.wider {
        let others = around.iter().map(|n| &all[n.1 as usize]);
        let (sum, count) = (others.filter(|feet| feet.wider > step))
            .map(|feet| dot(feet.steps[step], feet.steps[step]))
            .fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
        let explained = own.parts[step] * noise * noise * count;
        if explained < sum {
            share *= explained / sum;
        }
        to = add(to, scale(own.steps[step], share));
    }
    to
}

/// A fit to so many samples that misses them by more than this times the noise there crosses an
/// edge, or reaches another sheet.
///
/// Of noise alone what is missed varies: for so many degrees of freedom with a deviation of
/// `1 / sqrt(2 freedom)` of itself. The weights make five ninths of the samples count.
fn crossed(count: usize) -> f64 {
    /// So many deviations.
    const SURE: f64 = 2.0;
    /// The noise is not known better than this.
    const LEAST: f64 = 1.2;
    let freedom = (count as f64 * 5.0 / 9.0 - 6.0).max(1.0);
    (1.0 + SURE / (2.0 * freedom).sqrt()).max(LEAST)
}

/// Then fits are made to so many samples, as a share of all in turn.
const GROWING: [f64; 4] = [0.3, 0.45, 0.67, 1.0];

/// The fewest.
const FEWEST: usize = 16;

/// And samples count less the farther they are from the fit before, to
/// nothing at so many times the noise (Tukey's biweight).
const CUT: f64 = 2.5;

/// The feet of a sample on quadrics through its neighbourhood. Weights fall
/// to 0 at the farthest neighbour, so that the surface is smooth.
///
/// Where the first quadric is no fit, it grows from a small one, leaving out what lies
/// off it (the forward search of Fleishman, Cohen-Or and Silva, 2005): of two
/// sheets, or the two sides of an edge, that which the sample is on. Then there are no wider ones.
fn feet(sheets: &Sheets, s: usize, local: &Local) -> Feet {
    let at = sheets.places()[s];
    let widths = |step: usize| local.neighbours << step;
    let steps = (1..=WIDER).take_while(|&step| widths(step) <= WIDEST);
    let steps = steps.count();
    let found = sheets.nearest(s, widths(steps) as usize);
    let offsets: Vec<Point> = (found.iter())
        .map(|n| sub(sheets.places()[n.1 as usize], at))
        .collect();
    let around = Around {
        at,
        found: &found,
        offsets: &offsets,
    };
    let first = found.len().min(local.neighbours as usize);
    let Some((fit, deviation)) = around.fit(first, None) else {
        return Feet::at(at);
    };
    if deviation > crossed(first) * local.noise {
        let grown = around.grown(first, local.noise);
        return Feet::at(around.held(grown.unwrap_or(fit).foot(), first));
    }
    let mut last = around.held(fit.foot(), first);
    let mut feet = Feet::at(last);
    for step in 1..=steps {
        let count = widths(step) as usize;
        if count > found.len() {
            break;
        }
        match around.fit(count, None) {
            Some((fit, deviation)) if deviation <= crossed(count) * local.noise => {
                let foot = around.held(fit.foot(), count);
                feet.steps[step - 1] = sub(foot, last);
                let variance = |step: usize| MIDDLE / f64::from(widths(step));
                feet.parts[step - 1] = variance(step - 1) - variance(step);
                feet.wider = step;
                last = foot;
            }
            _ => break,
        }
    }
    feet
}

/// The samples around one, nearest first.
struct Around<'a> {
    at: Point,
    /// With squared distances.
    found: &'a [(f64, u32)],
    /// Relative to it.
    offsets: &'a [Point],
}

impl Around<'_> {
    /// The distance of the farthest of the `count` nearest.
    fn reach(&self, count: usize) -> f64 {
        count
            .checked_sub(1)
            .map_or(0.0, |last| self.found[last].0.sqrt())
    }

    /// A fit to the `count` nearest, and what it misses; they count less the farther they are from a fit
    /// before, over the distance beside it. `None` where they span no plane, or hardly any counts.
    fn fit(&self, count: usize, before: Option<(Fit, f64)>) -> Option<(Fit, f64)> {
        let reach = self.reach(count);
        let offsets = &self.offsets[..count];
        let weight = |n: &(f64, u32)| {
            let t = 1.0 - n.0 / (reach * reach * 1.02);
            t * t
        };
        let mut weights: Vec<f64> = self.found[..count].iter().map(weight).collect();
        if let Some((before, cut)) = before {
            for (w, &offset) in weights.iter_mut().zip(offsets) {
                let off = before.height_of(offset) / cut;
                *w *= (1.0 - off * off).max(0.0).powi(2);
            }
            let sum: f64 = weights.iter().sum();
            let squares: f64 = weights.iter().map(|w| w * w).sum();
            if sum * sum < FEWEST as f64 / 2.0 * squares || sum <= 0.0 {
                return None;
            }
        }
        let fit = Fit::of(self.at, offsets, &weights, reach)?;
        Some((fit, fit.deviation(&weights)))
    }

    /// A fit that grew from a small one to the `most` nearest.
    fn grown(&self, most: usize, noise: f64) -> Option<Fit> {
        let mut before: Option<Fit> = None;
        for share in GROWING {
            let count = ((most as f64 * share) as usize).max(FEWEST.min(most));
            match self.fit(count, before.map(|fit| (fit, CUT * noise))) {
                Some((next, _)) => before = Some(next),
                None => break,
            }
        }
        before
    }

    /// A foot that does not leave the neighbourhood.
    fn held(&self, foot: Point, count: usize) -> Point {
        let way = sub(foot, self.at);
        let most = self.reach(count) / 2.0;
        match norm(way) {
            far if far > most => add(self.at, scale(way, most / far)),
            _ => foot,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::near::Near;
    use super::*;

    /// How far samples of waves, eight spacings long, with noise of deviation 1/8, are off, root mean square:
    /// on the first fit, and where they go.
    fn off(height: f64) -> [f64; 2] {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let wave = |v: f64| (v * std::f64::consts::TAU / 8.0).sin();
        let up = |p: Point| height * wave(p[0]) * wave(p[1]);
        let places: Vec<Point> = (0..3000)
            .map(|_| {
                let at = [next() * 55.0, next() * 55.0, 0.0];
                // Nearly normal, of deviation 1.
                let shaken = (0..12).map(|_| next()).sum::<f64>() - 6.0;
                [at[0], at[1], up(at) + shaken / 8.0]
            })
            .collect();
        let near = Near::of(&places);
        let sheets = Sheets::of(&near, &[]);
        let local = Local {
            noise: 0.125,
            spacing: 1.0,
            neighbours: 28,
        };
        let local = vec![local; places.len()];
        let moved = project(&sheets, &local, &Context::default()).unwrap_or_default();
        let firsts = (0..places.len()).map(|s| feet(&sheets, s, &local[s]).first);
        let rms = |feet: Vec<Point>| {
            let inside = |p: &&Point| (0..2).all(|k| (8.0..47.0).contains(&p[k]));
            let off: Vec<f64> = (feet.iter().filter(inside))
                .map(|&p| (p[2] - up(p)).powi(2))
                .collect();
            (off.iter().sum::<f64>() / off.len() as f64).sqrt()
        };
        [rms(firsts.collect()), rms(moved)]
    }

    #[test]
    fn fits_are_as_wide_as_the_shape_allows() {
        let [first, moved] = off(0.0);
        // The variance of the first fit is as it should be.
        let expected = 0.125 * (MIDDLE / 28.0).sqrt();
        assert!((first / expected - 1.0).abs() < 0.15, "{first} {expected}");
        assert!(moved < 0.7 * first, "{first} {moved}");
        let [first, moved] = off(0.6);
        assert!(moved < 1.02 * first, "{first} {moved}");
    }
}
