//! Sheets told apart by vectors out of the solid, where points come with any.
//!
//! In a wall thinner than a few times the noise the nearest samples are of both
//! sides, and a quadric fitted to them runs between. Normals, or the ways to
//! the scanner, of the two sides look across the wall in opposite ways; so the
//! neighbours of a sample are then the nearest of its own side.
//!
//! Vectors may be wrong: they may look either way at random. So they are asked where it
//! matters, around samples whose neighbours do not all look one way: of two sheets one alone is
//! missed by far less than both, of one sheet with normals at random half is missed
//! like the whole. Only their signs against each other count, so it does not matter whether all
//! look outwards or inwards.

use rayon::prelude::*;

use super::fit::Fit;
use super::level::quantile;
use super::near::Near;
use super::plane::Plane;
use crate::geom::vec3::{dot, sub};
use crate::geom::Point;

/// Samples looked at to know whether to believe the vectors.
const LOOKED_AT: usize = 4000;

/// Neighbours of each, and the fewest among them that must look the other way for
/// the vectors to matter there.
const AROUND: usize = 24;
const OTHERS: usize = 4;

/// The fewest places where they must matter.
const FEWEST: usize = 10;

/// What one side alone misses over what both miss, the most for belief in
/// the vectors: the median.
const ENOUGH: f64 = 0.8;

/// Or the share of neighbours that look the same way, the least.
const AGREED: f64 = 0.75;

/// Neighbours are searched for among so many times as many of both sides.
const WIDER: usize = 4;

/// The samples near a sample, on its own sheet as far as is known.
pub(super) struct Sheets<'a> {
    near: &'a Near<'a>,
    /// Unit vectors, zero where none is known; empty where they are not believed.
    ways: &'a [Point],
}

impl<'a> Sheets<'a> {
    /// `ways` has a unit vector out of the solid for each sample, zero where none is known,
    /// or is empty.
    pub fn of(near: &'a Near, ways: &'a [Point]) -> Sheets<'a> {
        let sheets = Sheets { near, ways };
        match !ways.is_empty() && sheets.believed() {
            true => sheets,
            false => Sheets { near, ways: &[] },
        }
    }

    /// Whether vectors are made use of.
    pub fn told(&self) -> bool {
        !self.ways.is_empty()
    }

    /// All samples.
    pub fn places(&self) -> &[Point] {
        self.near.places
    }

    /// The `count` samples nearest to a sample and not known to be of another sheet, nearest
    /// first, itself included, with squared distances; fewer where there are not so many around.
    pub fn nearest(&self, s: usize, count: usize) -> Vec<(f64, u32)> {
        let at = self.near.places[s];
        let found = self.near.nearest(at, count);
        if self.ways.is_empty() {
            return found;
        }
        let Some(normal) = self.normal(&found) else {
            return found;
        };
        if !found.iter().any(|n| self.across(normal, s, n.1)) {
            return found;
        }
        let mut found = self.near.nearest(at, count * WIDER);
        found.retain(|n| !self.across(normal, s, n.1));
        found.truncate(count);
        found
    }

    /// That of the plane through some samples.
    fn normal(&self, found: &[(f64, u32)]) -> Option<Point> {
        let places: Vec<Point> = (found.iter())
            .map(|n| self.near.places[n.1 as usize])
            .collect();
        Some(Plane::through(&places)?.normal)
    }

    /// Whether the vectors of two samples look away from each other, and to the two sides of
    /// a plane of that normal. The first alone they do where two scanners
    /// saw one sheet from left and right.
    fn across(&self, normal: Point, s: usize, other: u32) -> bool {
        let (a, b) = (self.ways[s], self.ways[other as usize]);
        dot(a, b) < 0.0 && dot(a, normal) * dot(b, normal) < 0.0
    }

    fn believed(&self) -> bool {
        let count = self.near.len();
        let looked = count.min(LOOKED_AT);
        let place = |k: usize| (k as u64 * count as u64 / looked as u64) as usize;
        let found = (0..looked)
            .into_par_iter()
            .filter_map(|k| self.share(place(k)));
        let (across, mut shares): (Vec<usize>, Vec<f64>) = found.unzip();
        let across = across.iter().sum::<usize>() as f64;
        let agree = across < (1.0 - AGREED) * (AROUND * looked) as f64;
        shares.len() >= FEWEST && (agree || quantile(&mut shares, 0.5) < ENOUGH)
    }

    /// How many neighbours look the other way, and what a quadric through neighbours on one side misses over what one
    /// through all neighbours misses; `None` where all are on one side.
    fn share(&self, s: usize) -> Option<(usize, f64)> {
        let at = self.near.places[s];
        let both = self.near.nearest(at, AROUND);
        let normal = self.normal(&both)?;
        let across = both.iter().filter(|n| self.across(normal, s, n.1)).count();
        if across < OTHERS {
            return None;
        }
        let own = self.nearest(s, AROUND);
        let missed = |found: &[(f64, u32)]| {
            let offsets: Vec<Point> = (found.iter())
                .map(|n| sub(self.near.places[n.1 as usize], at))
                .collect();
            let reach = found.last()?.0.sqrt();
            let fit = Fit::of(at, &offsets, &[1.0; AROUND][..found.len()], reach)?;
            Some(fit.residual(found.len()))
        };
        let (own, both) = (missed(&own)?, missed(&both)?);
        (both > 0.0).then_some((across, own / both))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::vec3::scale;

    /// Two sheets 0.6 apart, samples 1 apart and shaken by up to 0.2.
    fn wall() -> Vec<Point> {
        let shaken = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 16 & 255) / 640.0 - 0.2;
        let at = |k: u32| {
            [
                f64::from(k / 2 % 30),
                f64::from(k / 60),
                f64::from(k % 2) * 0.6,
            ]
        };
        (0..1800)
            .map(|k| {
                let [x, y, z] = at(k);
                [x + shaken(k), y + shaken(k + 5000), z + shaken(k + 10_000)]
            })
            .collect()
    }

    #[test]
    fn normals_that_part_two_sheets_are_believed() {
        let places = wall();
        let near = Near::of(&places);
        let up = |k: usize| [0.0, 0.0, f64::from(k as u32 % 2) * 2.0 - 1.0];
        let ways: Vec<Point> = (0..places.len()).map(up).collect();
        let inwards: Vec<Point> = ways.iter().map(|&w| scale(w, -1.0)).collect();
        for ways in [&ways, &inwards] {
            let sheets = Sheets::of(&near, ways);
            assert!(sheets.told());
            for s in [0, 901, 1799] {
                let found = sheets.nearest(s, 24);
                assert_eq!(found.len(), 24);
                assert!(found.iter().all(|n| n.1 as usize % 2 == s % 2));
                assert_eq!(found[0], (0.0, s as u32));
            }
        }
    }

    #[test]
    fn normals_at_random_are_not() {
        let places = wall();
        let near = Near::of(&places);
        let random = |k: usize| {
            [
                0.0,
                0.0,
                f64::from((k as u32).wrapping_mul(747_796_405) >> 31) * 2.0 - 1.0,
            ]
        };
        let ways: Vec<Point> = (0..places.len()).map(random).collect();
        assert!(!Sheets::of(&near, &ways).told());
        assert!(!Sheets::of(&near, &[]).told());
        // One sheet that looks one way: nothing to tell apart.
        let ways = vec![[0.0, 0.0, 1.0]; places.len()];
        assert!(!Sheets::of(&near, &ways).told());
    }
}
