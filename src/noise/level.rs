//! Is a cloud noisy? Decided once, on a part of the samples.
//!
//! A quadric fitted to the `k` nearest samples misses them by `m(k)`, root
//! mean square. White noise of deviation sigma leaves `m(k) = sigma` for all
//! `k`; a smooth shape leaves a term of the third degree, which grows as
//! `k^1.5`, an edge one that grows as `k^0.5` where it is crossed at all. So a cloud is taken
//! for noisy when the median of `m(24) / m(12)` is near 1 and `m(12)` is
//! no small part of the spacing. Where noise is as large as the spacing,
//! twelve samples form a lump rather than a sheet, and `m` grows at first: the bound on the
//! ratio rises with the level, and `m(48) / m(24)` must be smaller.
//!
//! A wall as thin as the spacing looks the same by these measures: its two sheets
//! are missed alike by all quadrics. But then what is missed has two values,
//! and its fourth moment is near 1 in units of the squared second, where that of a
//! normal distribution is 3, of an even one 1.8.

use rayon::prelude::*;

use super::fit::Fit;
use super::sheets::Sheets;
use crate::geom::vec3::sub;

/// Samples looked at.
const LOOKED_AT: usize = 500;

/// Clouds smaller than this say nothing about noise.
const FEWEST: usize = 200;

/// Noise below this share of the spacing is left alone: the crust through
/// such samples is nearer to the surface than its flat faces are.
pub(super) const LEAST_SHARE: f64 = 0.05;

/// The kurtosis below which what is missed has two values.
const TWO_SHEETS: f64 = 1.7;

/// What the cloud as a whole says about its noise.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Level {
    /// What quadrics through 12 samples miss, over the spacing: the quantile
    /// of 0.4 over the samples looked at.
    pub share: f64,
    /// What quadrics through 24 samples miss over what those through 12 miss:
    /// the median. Near 1 for noise, near 2 for shape.
    pub growth: f64,
    /// The same for 48 and 24.
    pub further_growth: f64,
    /// The fourth moment of what quadrics through 48 samples miss, over the
    /// square of the second: the median. Near 3 for noise, 1 for two sheets.
    pub kurtosis: f64,
    /// Whether that is noise.
    pub noisy: bool,
}

/// The value below which a share of the values lie; reorders them.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// The spacing of samples of which `count` lie within `reach`.
pub(super) fn spacing(reach: f64, count: usize) -> f64 {
    reach * (std::f64::consts::PI / count as f64).sqrt()
}

/// Looks at some samples.
pub(super) fn level(sheets: &Sheets) -> Level {
    let mut level = Level {
        share: 0.0,
        growth: f64::INFINITY,
        further_growth: f64::INFINITY,
        kurtosis: 0.0,
        noisy: false,
    };
    let count = sheets.places().len();
    if count < FEWEST {
        return level;
    }
    let looked = count.min(LOOKED_AT);
    let missed: Vec<Option<[f64; 5]>> = (0..looked)
        .into_par_iter()
        .map(|k| missed(sheets, (k as u64 * count as u64 / looked as u64) as usize))
        .collect();
    let of = |f: &dyn Fn(&[f64; 5]) -> f64| -> Vec<f64> {
        let values = missed.iter().flatten().map(f);
        values.filter(|v| v.is_finite()).collect()
    };
    level.share = quantile(&mut of(&|m| m[0] / m[3]), 0.4);
    level.growth = quantile(&mut of(&|m| m[1] / m[0]), 0.5);
    level.further_growth = quantile(&mut of(&|m| m[2] / m[1]), 0.5);
    level.kurtosis = quantile(&mut of(&|m| m[4]), 0.5);
    // From 1.3 for little noise to 1.45 where it is half the spacing.
    let most = 1.3 + 0.15 * ((level.share - 0.3) / 0.2).clamp(0.0, 1.0);
    level.noisy = level.share > LEAST_SHARE
        && level.growth < most
        && level.further_growth < most.min(1.4)
        && level.kurtosis > TWO_SHEETS;
    level
}

/// What quadrics through 12, 24 and 48 samples miss, the spacing, and the
/// kurtosis of what the last misses.
fn missed(sheets: &Sheets, s: usize) -> Option<[f64; 5]> {
    let at = sheets.places()[s];
    let found = sheets.nearest(s, 48);
    let mut offsets = Vec::with_capacity(found.len());
    offsets.extend(found.iter().map(|n| sub(sheets.places()[n.1 as usize], at)));
    let mut out = [0.0; 5];
    for (slot, count) in [12, 24, 48].into_iter().enumerate() {
        let reach = found.get(count - 1)?.0.sqrt();
        let fit = Fit::of(at, &offsets[..count], &[1.0; 48][..count], reach)?;
        out[slot] = fit.residual(count);
        let powers = offsets[..count].iter().map(|&o| fit.height_of(o).powi(2));
        let (second, fourth) = powers.fold((0.0, 0.0), |(s, f), p| (s + p, f + p * p));
        out[4] = fourth * count as f64 / (second * second);
    }
    out[3] = spacing(found[11].0.sqrt(), 12);
    Some(out)
}
