//! Samples near a surface, but not on it.

use rayon::prelude::*;

use super::floating::median;
use super::{Cloud, Stray};
use crate::geom::vec3::dist_sq;
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
    let around = cloud.around::<AROUND>(s, |_| true);
    if around.found().len() < AROUND {
        return false;
    }
    let at = cloud.places[s as usize];
    let places = around.all.map(|n| cloud.places[n.1 as usize]);
    // Nine samples of a sheet, one included, lie within 1.6 spacings of it.
    let mut apart = places.map(|p| dist_sq(p, places[0]));
    apart.sort_unstable_by(f64::total_cmp);
    let spacing = apart[8].sqrt() / 1.6;
    let mut kept = [true; AROUND];
    let mut off = false;
    for _ in 0..ROUNDS {
        let mut some = [[0.0; 3]; AROUND];
        let mut count = 0;
        for (place, _) in places.iter().zip(kept).filter(|(_, kept)| *kept) {
            some[count] = *place;
            count += 1;
        }
        let Some(plane) = Plane::through(&some[..count]) else {
            return false;
        };
        let heights = places.map(|p| plane.height(p).abs());
        let usual = median(&mut heights.clone());
        off = plane.height(at).abs() > spacing.max(OFF * usual);
        let near = heights.map(|height| height <= TRIM * usual);
        if near == kept {
            break;
        }
        kept = near;
    }
    off
}
