//! Samples amid noise move to the foot of a quadric fitted around them.

use rayon::prelude::*;

use super::fit::Fit;
use super::local::Local;
use super::sheets::Sheets;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, norm, scale, sub};
use crate::geom::Point;

/// Samples between two reports of progress.
const BLOCK: usize = 1 << 14;

/// Where each sample goes.
pub(super) fn project(
    sheets: &Sheets,
    local: &[Local],
    context: &Context,
) -> Result<Vec<Point>, Cancelled> {
    let count = sheets.places().len();
    let mut moved = Vec::with_capacity(count);
    for from in (0..count).step_by(BLOCK) {
        context.advance(Stage::Noise, (50 + from * 50 / count) as u64, 100)?;
        let block = from..count.min(from + BLOCK);
        moved.par_extend(block.into_par_iter().map(|s| match local[s].neighbours {
            0 => sheets.places()[s],
            _ => foot(sheets, s, &local[s]),
        }));
    }
    Ok(moved)
}

/// A fit that misses its samples by more than this times the noise there
/// crosses an edge, or reaches another sheet.
const CROSSED: f64 = 1.2;

/// Then fits are made to so many samples, as a share of all in turn.
const GROWING: [f64; 4] = [0.3, 0.45, 0.67, 1.0];

/// The fewest.
const FEWEST: usize = 16;

/// And samples count less the farther they are from the fit before, to
/// nothing at so many times the noise (Tukey's biweight).
const CUT: f64 = 2.5;

/// The foot of a sample on the quadric through its neighbourhood. Weights fall
/// to 0 at the farthest neighbour, so that the surface is smooth.
///
/// Where that quadric is no fit, it grows from a small one, leaving out what lies
/// off it (the forward search of Fleishman, Cohen-Or and Silva, 2005): of two
/// sheets, or the two sides of an edge, that which the sample is on.
fn foot(sheets: &Sheets, s: usize, local: &Local) -> Point {
    let at = sheets.places()[s];
    let found = sheets.nearest(s, local.neighbours as usize);
    let Some(reach) = found.last().map(|n| n.0.sqrt()) else {
        return at;
    };
    let offsets: Vec<Point> = (found.iter())
        .map(|n| sub(sheets.places()[n.1 as usize], at))
        .collect();
    let weights_within = |reach: f64, count: usize| -> Vec<f64> {
        let weight = |d: f64| {
            let t = 1.0 - d / (reach * reach * 1.02);
            t * t
        };
        found[..count].iter().map(|n| weight(n.0)).collect()
    };
    let weights = weights_within(reach, found.len());
    let Some(mut fit) = Fit::of(at, &offsets, &weights, reach) else {
        return at;
    };
    if fit.deviation(&weights) > CROSSED * local.noise {
        let cut = CUT * local.noise;
        let mut before: Option<Fit> = None;
        for share in GROWING {
            let count = ((found.len() as f64 * share) as usize).max(FEWEST.min(found.len()));
            let reach = found[count - 1].0.sqrt();
            let mut weights = weights_within(reach, count);
            if let Some(before) = before {
                for (w, &offset) in weights.iter_mut().zip(&offsets) {
                    let off = before.height_of(offset) / cut;
                    *w *= (1.0 - off * off).max(0.0).powi(2);
                }
                let sum: f64 = weights.iter().sum();
                let squares: f64 = weights.iter().map(|w| w * w).sum();
                if sum * sum < FEWEST as f64 / 2.0 * squares || sum <= 0.0 {
                    break;
                }
            }
            match Fit::of(at, &offsets[..count], &weights, reach) {
                Some(next) => before = Some(next),
                None => break,
            }
        }
        fit = before.unwrap_or(fit);
    }
    // No sample leaves its neighbourhood.
    let foot = fit.foot();
    let way = sub(foot, at);
    let most = reach / 2.0;
    match norm(way) {
        far if far > most => add(at, scale(way, most / far)),
        _ => foot,
    }
}
