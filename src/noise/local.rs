//! How much noise there is at each sample, and how many neighbours it takes
//! to see through it.
//!
//! Quadrics are fitted to the nearest 24 samples, and where those are a lump
//! to 48 and 96. At edges they miss by more than the noise; so the noise
//! at a sample is a low quantile over its neighbours, most of which are on
//! one side of the edge.

use rayon::prelude::*;

use super::fit::Fit;
use super::level::{quantile, spacing, LEAST_SHARE};
use super::sheets::Sheets;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::sub;

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
                quantile(values, LOW) * UP
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

/// What makes the low quantile a median again where all is noise.
const UP: f64 = 1.06;

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
        // A sheet, or all there is.
        if raw.missed < 0.4 * raw.spacing || found.len() < count {
            break;
        }
    }
    raw
}
