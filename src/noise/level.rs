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
//! Little noise on a detailed shape grows too. So a cloud is noisy as well where nearest
//! neighbours differ (`differences.rs`) by much of what quadrics through 24 samples miss, for the
//! distance between them. (For noise near the spacing it is no help: of samples in a lump
//! those are nearest that noise moved alike.)
//!
//! A wall as thin as the spacing looks the same by these measures: its two sheets
//! are missed alike by all quadrics. But then what is missed has two values,
//! and its fourth moment is near 1 in units of the squared second, where that of a
//! normal distribution is 3, of an even one 1.8.

use rayon::prelude::*;

use super::differences::differences;
use super::fit::Fit;
use super::sheets::Sheets;
use crate::geom::vec3::sub;
use crate::geom::Point;

/// Samples looked at.
const LOOKED_AT: usize = 500;

/// Clouds smaller than this say nothing about noise.
const FEWEST: usize = 200;

/// Noise below this share of the spacing is left alone: the crust through
/// such samples is nearer to the surface than its flat faces are.
pub(super) const LEAST_SHARE: f64 = 0.05;

/// The kurtosis below which what is missed has two values.
const TWO_SHEETS: f64 = 1.7;

/// The independence above which what is missed is noise (`docs/noise.md` has what was measured).
///
/// Without noise it is at most 0.43, of closed surfaces sampled at random and of public scans and meshes alike; with a noise of
/// 0.1 % of the diagonal on 10,000 samples 0.55 and more, but for walls as thin as the spacing.
const INDEPENDENT: f64 = 0.5;

/// But where quadrics through 48 samples miss so many times as much as those through 24, they cross to another sheet.
const CROSSING: f64 = 2.2;

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
    /// Half the mean square of the differences, between nearest neighbours, of what quadrics
    /// through 24 samples miss, over the mean square of what they miss, for a mean square of the
    /// distances between these neighbours that is that of the reach over 24: the median. Up to
    /// 0.9 for little noise, below 0.45 for shape.
    pub independence: f64,
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
        independence: 0.0,
        noisy: false,
    };
    let count = sheets.places().len();
    if count < FEWEST {
        return level;
    }
    let looked = count.min(LOOKED_AT);
    let missed: Vec<Option<[f64; 6]>> = (0..looked)
        .into_par_iter()
        .map(|k| missed(sheets, (k as u64 * count as u64 / looked as u64) as usize))
        .collect();
    let of = |f: &dyn Fn(&[f64; 6]) -> f64| -> Vec<f64> {
        let values = missed.iter().flatten().map(f);
        values.filter(|v| v.is_finite()).collect()
    };
    level.share = quantile(&mut of(&|m| m[0] / m[3]), 0.4);
    level.growth = quantile(&mut of(&|m| m[1] / m[0]), 0.5);
    level.further_growth = quantile(&mut of(&|m| m[2] / m[1]), 0.5);
    level.kurtosis = quantile(&mut of(&|m| m[4]), 0.5);
    level.independence = quantile(&mut of(&|m| m[5]), 0.5);
    // From 1.3 for little noise to 1.45 where it is half the spacing.
    let most = 1.3 + 0.15 * ((level.share - 0.3) / 0.2).clamp(0.0, 1.0);
    let flat = level.growth < most && level.further_growth < most.min(1.4);
    let independent = level.independence > INDEPENDENT && level.further_growth < CROSSING;
    level.noisy = level.share > LEAST_SHARE && (flat || independent) && level.kurtosis > TWO_SHEETS;
    level
}

/// What quadrics through 12, 24 and 48 samples miss, the spacing, the
/// kurtosis of what the last misses, and the independence of what that through 24 misses.
fn missed(sheets: &Sheets, s: usize) -> Option<[f64; 6]> {
    let at = sheets.places()[s];
    let found = sheets.nearest(s, 48);
    let mut offsets = Vec::with_capacity(found.len());
    offsets.extend(found.iter().map(|n| sub(sheets.places()[n.1 as usize], at)));
    let mut out = [0.0; 6];
    for (slot, count) in [12, 24, 48].into_iter().enumerate() {
        let reach = found.get(count - 1)?.0.sqrt();
        let fit = Fit::of(at, &offsets[..count], &[1.0; 48][..count], reach)?;
        out[slot] = fit.residual(count);
        let heights: Vec<f64> = (offsets[..count].iter())
            .map(|&o| fit.height_of(o))
            .collect();
        match count {
            24 => out[5] = independence(&offsets[..count], &heights, reach),
            48 => out[4] = kurtosis(&heights),
            _ => {}
        }
    }
    out[3] = spacing(found[11].0.sqrt(), 12);
    Some(out)
}

/// The fourth moment over the square of the second.
fn kurtosis(heights: &[f64]) -> f64 {
    let powers = heights.iter().map(|h| h * h);
    let (second, fourth) = powers.fold((0.0, 0.0), |(s, f), p| (s + p, f + p * p));
    fourth * heights.len() as f64 / (second * second)
}

/// Half the mean square of the differences between nearest neighbours, over the mean square of the
/// heights, and over the mean square of the distances between those neighbours in units of the
/// squared reach by the number.
fn independence(offsets: &[Point], heights: &[f64], reach: f64) -> f64 {
    let (half, way) = differences(offsets, heights);
    let squares: f64 = heights.iter().map(|h| h * h).sum();
    half / squares * (reach * reach / way)
}

#[cfg(test)]
mod tests {
    use super::super::near::Near;
    use super::*;

    /// Waves of this height, eight spacings long, with noise; sampled at random, or one sample in each square.
    fn waves(height: f64, noise: f64, even: bool) -> Level {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let places: Vec<Point> = (0..4000)
            .map(|k| {
                let (x, y) = match even {
                    true => (
                        f64::from(k % 63) + next() * 0.5,
                        f64::from(k / 63) + next() * 0.5,
                    ),
                    false => (next() * 63.0, next() * 63.0),
                };
                // Nearly normal, of deviation 1.
                let shaken = (0..12).map(|_| next()).sum::<f64>() - 6.0;
                let wave = |v: f64| (v * std::f64::consts::TAU / 8.0).sin();
                [x, y, height * wave(x) * wave(y) + noise * shaken]
            })
            .collect();
        level(&Sheets::of(&Near::of(&places), &[]))
    }

    #[test]
    fn little_noise_is_told_from_much_shape() {
        // Flat as far as 12 samples reach, not as 48 do.
        let noisy = waves(0.5, 0.12, false);
        assert!(noisy.further_growth > 1.4, "{noisy:?}");
        assert!(noisy.noisy, "{noisy:?}");
        // As much missed, by shape alone.
        let clean = waves(2.0, 0.0, false);
        assert!(clean.share > LEAST_SHARE, "{clean:?}");
        assert!(!clean.noisy, "{clean:?}");
        // Neighbours farther from each other differ more.
        let even = waves(1.2, 0.0, true);
        assert!(even.share > LEAST_SHARE, "{even:?}");
        assert!(even.independence < 0.45 && !even.noisy, "{even:?}");
        // Hardly any of either.
        let flat = waves(0.5, 0.01, false);
        assert!(!flat.noisy, "{flat:?}");
    }
}
