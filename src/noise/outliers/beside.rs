//! Samples near a surface, but not on it.

use rayon::prelude::*;

use super::floating::median;
use super::{Cloud, Stray};
use crate::geom::vec3::dist_sq;
use crate::geom::Point;
use crate::noise::plane::Plane;

/// Neighbours whose plane is taken.
const AROUND: usize = 16;

/// Times of refitting without those far off the plane.
const ROUNDS: usize = 4;

/// Neighbours farther off than this many times the median do not count.
const TRIM: f64 = 3.0;

/// A sample is off if it is farther than this many times the median, and than the
/// spacing.
const OFF: f64 = 8.0;

/// Marks them among samples not marked yet; how many.
pub(super) fn beside(cloud: &Cloud, strays: &mut [Option<Stray>]) -> usize {
    let off: Vec<u32> = (0..cloud.len() as u32)
        .into_par_iter()
        .filter(|&s| strays[s as usize].is_none() && is_off(cloud, s))
        .collect();
    for &s in &off {
        strays[s as usize] = Some(Stray::Beside);
    }
    off.len()
}

/// Whether a sample is off the plane of those around it.
fn is_off(cloud: &Cloud, s: u32) -> bool {
    let around = cloud.around(s, AROUND);
    if around.len() < AROUND {
        return false;
    }
    let at = cloud.places[s as usize];
    let places: Vec<Point> = around.iter().map(|n| cloud.places[n.1 as usize]).collect();
    let mut kept = places.clone();
    let mut usual = 0.0;
    let mut plane = None;
    for _ in 0..ROUNDS {
        let Some(fitted) = Plane::through(&kept) else {
            return false;
        };
        let mut off: Vec<f64> = places.iter().map(|&p| fitted.height(p).abs()).collect();
        usual = median(&mut off);
        plane = Some(fitted);
        let near = places
            .iter()
            .filter(|&&p| fitted.height(p).abs() <= TRIM * usual);
        kept = near.copied().collect();
    }
    // Nine samples of a sheet, one included, lie within 1.6 spacings of it.
    let first = places[0];
    let mut apart: Vec<f64> = places.iter().map(|&p| dist_sq(p, first)).collect();
    apart.sort_unstable_by(f64::total_cmp);
    let spacing = apart[8].sqrt() / 1.6;
    plane.is_some_and(|plane| plane.height(at).abs() > spacing.max(OFF * usual))
}
