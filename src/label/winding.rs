//! Winding numbers of the oriented samples at any place.
//!
//! A closed surface seen from a place covers the whole sphere of directions
//! once if the place is inside, and cancels if it is outside. With samples
//! for the surface that is a sum of dipoles, one a sample, along its
//! normal and as strong as the area it stands for (Barill and others, Fast
//! winding numbers for soups and clouds, 2018). Near by they are summed one by one,
//! farther away by blocks: samples follow a space-filling curve, so blocks
//! of consecutive ones are compact, and so are blocks of blocks.

use rayon::prelude::*;

use crate::geom::vec3::{add, dist_sq, dot, scale, sub};
use crate::geom::Point;

/// Samples in a block, and blocks in a larger one.
const FANOUT: usize = 8;

/// A block stands for its samples where it is this many times its radius
/// away.
const FAR: f64 = 2.0;

/// The sum of some dipoles, as seen from afar.
#[derive(Clone, Copy, Debug)]
struct Block {
    centre: Point,
    /// Square of the distance from which it may stand for its parts.
    far: f64,
    dipole: Point,
}

/// Oriented samples, in blocks.
pub(super) struct Winding<'a> {
    places: &'a [Point],
    dipoles: Vec<Point>,
    /// Squared lengths: no dipole is nearer than this.
    soft: &'a [f64],
    /// Blocks of [`FANOUT`] samples, of as many blocks, and so on to one.
    levels: Vec<Vec<Block>>,
}

impl<'a> Winding<'a> {
    /// Takes the places of samples along a curve, their normals times
    /// the areas they stand for, and squared lengths over which each is blurred.
    pub fn of(places: &'a [Point], dipoles: Vec<Point>, soft: &'a [f64]) -> Winding<'a> {
        let near = |range: std::ops::Range<usize>, dipoles: &[Point]| {
            let members = &places[range.clone()];
            let mut dipole = [0.0; 3];
            for &d in &dipoles[range] {
                dipole = add(dipole, d);
            }
            block(members, dipole)
        };
        let mut levels: Vec<Vec<Block>> = Vec::new();
        let mut size = FANOUT;
        loop {
            let count = places.len().div_ceil(size);
            let level = (0..count)
                .into_par_iter()
                .map(|b| near(b * size..places.len().min((b + 1) * size), &dipoles));
            levels.push(level.collect());
            if count <= 1 {
                break;
            }
            size *= FANOUT;
        }
        Winding {
            places,
            dipoles,
            soft,
            levels,
        }
    }

    /// The winding number at a place, were the areas right.
    pub fn at(&self, place: Point) -> f64 {
        let mut sum = 0.0;
        if let Some(top) = self.levels.len().checked_sub(1) {
            for b in 0..self.levels[top].len() {
                sum += self.within(top, b, place);
            }
        }
        sum / (4.0 * std::f64::consts::PI)
    }

    fn within(&self, level: usize, b: usize, place: Point) -> f64 {
        let block = &self.levels[level][b];
        let away = sub(block.centre, place);
        let square = dot(away, away);
        if square > block.far {
            return dot(away, block.dipole) / (square * square.sqrt());
        }
        let parts = b * FANOUT..(b + 1) * FANOUT;
        if level > 0 {
            let parts = parts.start..parts.end.min(self.levels[level - 1].len());
            return parts.map(|part| self.within(level - 1, part, place)).sum();
        }
        let parts = parts.start..parts.end.min(self.places.len());
        parts
            .map(|s| {
                let away = sub(self.places[s], place);
                let square = dot(away, away) + self.soft[s];
                match square > 0.0 {
                    true => dot(away, self.dipoles[s]) / (square * square.sqrt()),
                    false => 0.0,
                }
            })
            .sum()
    }
}

fn block(members: &[Point], dipole: Point) -> Block {
    let sum = members.iter().fold([0.0; 3], |sum, &p| add(sum, p));
    let centre = scale(sum, 1.0 / members.len().max(1) as f64);
    let radius = members
        .iter()
        .map(|&p| dist_sq(p, centre))
        .fold(0.0, f64::max);
    Block {
        centre,
        far: FAR * FAR * radius,
        dipole,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_is_one_and_outside_none() {
        // A cube of 6 times 400 samples, in the order of its faces.
        let side = 20u32;
        let mut places = Vec::new();
        let mut dipoles = Vec::new();
        for (axis, way) in [
            (0, 1.0),
            (0, -1.0),
            (1, 1.0),
            (1, -1.0),
            (2, 1.0),
            (2, -1.0),
        ] {
            for k in 0..side * side {
                let at = |k: u32| (f64::from(k) + 0.5) / f64::from(side) * 2.0 - 1.0;
                let mut p = [way; 3];
                p[(axis + 1) % 3] = at(k % side);
                p[(axis + 2) % 3] = at(k / side);
                let mut dipole = [0.0; 3];
                dipole[axis] = way * 4.0 / f64::from(side * side);
                places.push(p);
                dipoles.push(dipole);
            }
        }
        let soft = vec![0.0; places.len()];
        let winding = Winding::of(&places, dipoles.clone(), &soft);
        for (place, truth) in [
            ([0.0; 3], 1.0),
            ([0.8, -0.7, 0.6], 1.0),
            ([1.3, 0.0, 0.0], 0.0),
            ([-2.0, 5.0, 1.0], 0.0),
        ] {
            let found = winding.at(place);
            assert!((found - truth).abs() < 0.05, "{place:?}: {found}");
            // Against the sum of all.
            let sum: f64 = (places.iter().zip(&dipoles))
                .map(|(&p, &d)| {
                    let away = sub(p, place);
                    dot(away, d) / dot(away, away).powf(1.5)
                })
                .sum();
            let sum = sum / (4.0 * std::f64::consts::PI);
            assert!((found - sum).abs() < 0.05, "{place:?}: {found} and {sum}");
        }
        assert_eq!(Winding::of(&[], Vec::new(), &[]).at([0.0; 3]), 0.0);
    }
}
