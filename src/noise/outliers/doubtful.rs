//! Samples no denser than chance makes strays, that hang together with the surface.
//!
//! Strays are no farther apart than a few spacings of the surface where they are many, and
//! chains of them reach it. How many are strewn in how much room tells how dense
//! chance makes them: samples that are no denser than that are doubtful. Groups of them stay
//! where they lie on a sheet, as those of a coarse surface do, or are hardly sparser than the surface
//! next to them. Of others the rougher half is taken out, until they are sheets.

use rayon::prelude::*;

use super::floating::{median, roughness, sparser, RANK, REACH, SHEET};
use super::{Cloud, Stray};
use crate::geom::Sets;

/// Times that the rougher half of a group is taken out at most.
const HALVINGS: usize = 10;

/// What is known of the samples.
pub(super) struct Doubtful<'a> {
    pub cloud: &'a Cloud<'a>,
    /// The spacing at each, and held to its growth.
    pub raw: &'a [f64],
    pub spacing: &'a [f64],
    /// [`chance_spacing`] of the strays known.
    pub limit: f64,
    /// Groups of more are surface.
    pub most: usize,
}

impl Doubtful<'_> {
    /// Marks those that are strays; in how many groups they were.
    pub fn mark(&self, strays: &mut [Option<Stray>]) -> usize {
        let all = 0..self.cloud.len() as u32;
        let mut left: Vec<u32> = all
            .into_par_iter()
            .filter(|&s| strays[s as usize].is_none() && self.is_apart(s))
            .collect();
        let mut found = 0;
        for halving in 0..HALVINGS {
            let rough = self.rough(&left, strays);
            if halving == 0 {
                found = rough.len();
            }
            if rough.is_empty() {
                break;
            }
            for s in rough.into_iter().flatten() {
                strays[s as usize] = Some(Stray::Floating);
            }
            left.retain(|&s| strays[s as usize].is_none());
        }
        found
    }

    /// Whether its [`RANK`] nearest others are farther away than `limit`.
    fn is_apart(&self, s: u32) -> bool {
        let beyond = |square: f64| square > self.limit * self.limit;
        // A sample may have fewer short edges than near others.
        let apart = || {
            let near = self.cloud.around::<RANK>(s, |_| true);
            near.found().last().is_some_and(|n| beyond(n.0))
        };
        self.raw[s as usize] > self.limit && apart()
    }

    /// The rougher halves of the groups among these that are sparse and no sheets, looked
    /// at without strays.
    fn rough(&self, these: &[u32], strays: &[Option<Stray>]) -> Vec<Vec<u32>> {
        let mut place = vec![u32::MAX; self.cloud.len()];
        for (i, &s) in these.iter().enumerate() {
            place[s as usize] = i as u32;
        }
        let mut groups = Sets::new(these.len());
        for (i, &s) in these.iter().enumerate() {
            for &v in self.cloud.graph.at(s).iter().filter(|&&v| v > s) {
                let reach = REACH * self.spacing[s as usize].min(self.spacing[v as usize]);
                let other = place[v as usize];
                if other != u32::MAX && self.cloud.dist_sq(s, v) <= reach * reach {
                    groups.join(i as u32, other);
                }
            }
        }
        let known: Vec<f64> = (these.par_iter())
            .map(|&s| roughness(self.cloud, s, |v| strays[v as usize].is_none()))
            .collect();
        let mut members: Vec<(u32, u32)> = (0..these.len() as u32)
            .map(|i| (groups.find(i), i))
            .collect();
        members.sort_unstable();
        let halves = members.chunk_by(|a, b| a.0 == b.0).filter_map(|group| {
            let each = || group.iter().map(|m| known[m.1 as usize]);
            let samples: Vec<u32> = group.iter().map(|m| these[m.1 as usize]).collect();
            let usual = median(&mut each().collect::<Vec<f64>>());
            let surface = |s: u32| strays[s as usize].is_none() && place[s as usize] == u32::MAX;
            let spacings = [self.raw, self.spacing];
            let is_rough = usual > SHEET
                && samples.len() <= self.most
                && sparser(self.cloud, &samples, spacings, &surface) != Some(false);
            let halved = samples.iter().zip(each()).filter(|m| m.1 >= usual);
            is_rough.then(|| halved.map(|m| *m.0).collect())
        });
        halves.collect()
    }
}

/// How near the [`RANK`] nearest others of one are by chance: of so many samples strewn in so much room
/// less than one is expected to have them within this distance. There must be some.
pub(super) fn chance_spacing(strewn: usize, room: f64) -> f64 {
    let strewn = strewn as f64;
    // Of those with so many others within the distance in the mean (Poisson).
    let crowded = |mean: f64| {
        let (mut exactly, mut fewer) = ((-mean).exp(), 0.0);
        for k in 1..=RANK {
            fewer += exactly;
            exactly *= mean / k as f64;
        }
        strewn * (1.0 - fewer)
    };
    let (mut low, mut high) = (0.0, strewn);
    // As many as an `f64` tells apart.
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        match crowded(middle) < 1.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    (low * room / strewn * 0.75 / std::f64::consts::PI).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_spacing_follows_the_density() {
        let one = chance_spacing(500, 1.0);
        assert!((one - 0.0847).abs() < 1e-4, "{one}");
        assert!((chance_spacing(500, 8.0) - 2.0 * one).abs() < 1e-9);
        assert!(chance_spacing(4000, 1.0) < 0.5 * one);
    }
}
