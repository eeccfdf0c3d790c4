//! How much noise there is at each sample, and how many neighbours it takes
//! to see through it.
//!
//! Quadrics are fitted to the nearest 24 samples, and where those are a lump
//! to 48 and 96. At edges they miss by more than the noise; so the noise
//! at a sample is a low quantile over its neighbours, most of which are on
//! one side of the edge.
//!
//! Where the shape is detailed all of them miss it by more. How much of that is noise is told by
//! neighbours that differ (`differences.rs`): those nearest to each other along the
//! surface, so that they are not those that noise moved alike.

use rayon::prelude::*;

use super::differences::differences;
use super::fit::Fit;
use super::level::{quantile, spacing, LEAST_SHARE};
use super::sheets::Sheets;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::sub;
use crate::geom::Point;

/// Neighbours fitted at first, and whose noise is compared.
const FIRST: usize = 24;

/// The quantile taken of theirs.
const LOW: f64 = 0.3;

/// Samples between two reports of progress.
const BLOCK: usize = 1 << 14;

/// The noise at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    /// Standard deviation, in lattice steps.
    pub noise: f64,
    /// Spacing, in lattice steps.
    pub spacing: f64,
    /// How many neighbours to fit; 0 to leave the sample where it is.
    pub neighbours: u32,
}

/// The noise at every sample; or that which is given.
pub(super) fn local(
    sheets: &Sheets,
    given: Option<f64>,
    context: &Context,
) -> Result<Vec<Local>, Cancelled> {
    let count = sheets.places().len();
    let mut raw: Vec<Raw> = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        context.advance(Stage::Noise, (from * 30 / count) as u64, 100)?;
        let block = from..count.min(from + BLOCK);
        raw.par_extend(block.into_par_iter().map(|s| at_sample(sheets, s)));
    }
    let mut found = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        context.advance(Stage::Noise, (30 + from * 20 / count) as u64, 100)?;
        let block = from..count.min(from + BLOCK);
        found.par_extend(block.into_par_iter().map_init(Vec::new, |values, s| {
            let noise = given.unwrap_or_else(|| {
                values.clear();
                let around = raw[s].around.iter().filter(|&&v| v != NONE);
                values.extend(around.map(|&v| raw[v as usize].missed));
                let low = quantile(values, LOW);
                values.clear();
                let around = raw[s].around.iter().filter(|&&v| v != NONE);
                values.extend(around.map(|&v| raw[v as usize].alone));
                let alone = values.iter().sum::<f64>() / values.len().max(1) as f64;
                low * up(low / raw[s].spacing, alone)
            });
            let spacing = raw[s].spacing;
            Local {
                noise,
                spacing,
                neighbours: neighbours(noise / spacing),
            }
        }));
    }
    if given.is_none() {
        level_off(&mut found);
    }
    Ok(found)
}

/// In thin parts all quadrics reach the other sheet, and the low quantile is
/// no help; more neighbours would make it worse. So noise over spacing is
/// taken to be at most a quantile near the median over the noisy samples.
fn level_off(found: &mut [Local]) {
    const MOST: f64 = 0.4;
    let shares = found.iter().map(|l| l.noise / l.spacing);
    let mut shares: Vec<f64> = shares.filter(|&s| s > LEAST_SHARE).collect();
    let most = quantile(&mut shares, MOST);
    for local in found.iter_mut().filter(|l| l.noise > most * l.spacing) {
        local.noise = most * local.spacing;
        local.neighbours = neighbours(most);
    }
}

/// What makes the low quantile the deviation of the noise again.
///
/// With it what is found is 0.97 to 1.18 of a noise of 0.1 and 0.25 % of the diagonal on 10,000
/// samples of 23 surfaces.
fn up(share: f64, alone: f64) -> f64 {
    /// Where noise is all, and neighbours tell so.
    const SHEET: f64 = 1.29;
    /// And in a lump, where there are no neighbours along the surface.
    const LUMP: f64 = 1.06;
    let lump = ((share - 0.25) / 0.35).clamp(0.0, 1.0);
    (1.0 - lump) * SHEET * alone.clamp(0.0, 1.0).sqrt() + lump * LUMP
}

/// Of the variance that shape leaves, the part that is in the differences between
/// neighbours a mean spacing apart: from 0.3 to 0.43 on noise-free surfaces.
const OF_SHAPE: f64 = 0.35;

/// On grids neighbours are so far from each other that differences would say nothing.
const MOST_OF_SHAPE: f64 = 0.8;

/// How many neighbours to fit where the noise is this share of the spacing.
///
/// The error that noise leaves falls with the number, the error of the
/// quadric rises. The best numbers on tori, bunny and a block with edges are about
/// 22, 43, 77 and 120 at shares of .09, .22, .43 and .7: a line.
fn neighbours(share: f64) -> u32 {
    const MOST: f64 = 256.0;
    match share > LEAST_SHARE {
        true => (8.0 + 160.0 * share).clamp(20.0, MOST) as u32,
        false => 0,
    }
}

const NONE: u32 = u32::MAX;

/// What is found at one sample.
struct Raw {
    /// What a quadric misses.
    missed: f64,
    /// How much of its square is noise, as neighbours tell: a share, far from exact.
    alone: f64,
    spacing: f64,
    /// The nearest samples, itself included.
    around: [u32; FIRST],
}

/// What a quadric misses at a sample, and the spacing.
fn at_sample(sheets: &Sheets, s: usize) -> Raw {
    let at = sheets.places()[s];
    let mut found = sheets.nearest(s, FIRST);
    let mut raw = Raw {
        missed: 0.0,
        alone: 1.0,
        spacing: 0.0,
        around: [NONE; FIRST],
    };
    for (slot, n) in raw.around.iter_mut().zip(&found) {
        *slot = n.1;
    }
    let mut offsets = Vec::with_capacity(found.len());
    for count in [FIRST, 48, 96] {
        if count > FIRST {
            found = sheets.nearest(s, count);
        }
        offsets.clear();
        offsets.extend(found.iter().map(|n| sub(sheets.places()[n.1 as usize], at)));
        let Some(reach) = found.last().map(|n| n.0.sqrt()) else {
            break;
        };
        let ones = [1.0; 96];
        let fit = Fit::of(at, &offsets, &ones[..found.len()], reach);
        raw.missed = fit.map_or(0.0, |fit| fit.residual(found.len()));
        raw.spacing = spacing(reach, found.len());
        raw.alone = match fit {
            Some(fit) if raw.missed > 0.0 => alone(&fit, raw.missed, &offsets, reach),
            _ => 1.0,
        };
        // A sheet, or all there is.
        if raw.missed < 0.4 * raw.spacing || found.len() < count {
            break;
        }
    }
    raw
}

/// How much of the square of what a quadric misses is noise. Of noise all of it is in the
/// differences, of shape a part.
fn alone(fit: &Fit, missed: f64, offsets: &[Point], reach: f64) -> f64 {
    let heights: Vec<f64> = offsets.iter().map(|&o| fit.height_of(o)).collect();
    let places: Vec<Point> = offsets.iter().map(|&o| fit.under(o)).collect();
    let (half, way) = differences(&places, &heights);
    let of_shape = OF_SHAPE * way * offsets.len() as f64 / (reach * reach);
    let of_shape = of_shape.min(MOST_OF_SHAPE);
    (half / (missed * missed) - of_shape) / (1.0 - of_shape)
}

#[cfg(test)]
mod tests {
    use super::super::near::Near;
    use super::*;

    /// Waves eight spacings long, so high that quadrics miss them by half as much again as the noise.
    #[test]
    fn shape_does_not_count_as_noise() {
        const NOISE: f64 = 0.12;
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let wave = |v: f64| (v * std::f64::consts::TAU / 8.0).sin();
        let places: Vec<Point> = (0..4000)
            .map(|_| {
                let (x, y) = (next() * 63.0, next() * 63.0);
                // Nearly normal, of deviation 1.
                let shaken = (0..12).map(|_| next()).sum::<f64>() - 6.0;
                [x, y, 0.8 * wave(x) * wave(y) + NOISE * shaken]
            })
            .collect();
        let near = Near::of(&places);
        let sheets = Sheets::of(&near, &[]);
        let found = local(&sheets, None, &Context::default()).unwrap_or_default();
        let median = quantile(&mut found.iter().map(|l| l.noise).collect::<Vec<_>>(), 0.5);
        assert!((median / NOISE - 1.0).abs() < 0.2, "{median}");
        let mut missed: Vec<f64> = (0..4000).map(|s| at_sample(&sheets, s).missed).collect();
        let missed = quantile(&mut missed, 0.5);
        assert!(missed > 1.5 * NOISE, "{missed}");
    }
}
