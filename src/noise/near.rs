//! The nearest samples, by a k-d tree.

use std::num::NonZeroUsize;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::geom::Point;

/// Samples to be asked for those near a place.
pub(crate) struct Near<'a> {
    /// The samples, in steps of the lattice.
    pub places: &'a [Point],
    tree: ImmutableKdTree<f64, 3>,
}

impl Near<'_> {
    pub fn of(places: &[Point]) -> Near<'_> {
        Near {
            places,
            tree: ImmutableKdTree::new_from_slice(places),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The `count` samples nearest to a place, or all, nearest first, with
    /// squared distances. Equal distances are told apart by id.
    pub fn nearest(&self, place: Point, count: usize) -> Vec<(f64, u32)> {
        let Some(count) = NonZeroUsize::new(count.min(self.len())) else {
            return Vec::new();
        };
        let found = self.tree.nearest_n::<SquaredEuclidean>(&place, count);
        let mut found: Vec<(f64, u32)> = (found.into_iter())
            .map(|n| (n.distance, n.item as u32))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::vec3::dist_sq;

    /// Against all distances; and where thousands share coordinates.
    #[test]
    fn the_nearest_are_the_nearest() {
        let spiral = |k: u32| [f64::from(k).sin() * 50.0, f64::from(k % 7), f64::from(k)];
        let grid = |k: u32| {
            [
                f64::from(k % 20),
                f64::from(k / 20 % 20),
                f64::from(k / 400),
            ]
        };
        let flat = |k: u32| [0.0, f64::from(k % 50), f64::from(k / 50)];
        let clouds: [Vec<Point>; 3] = [
            (0..900).map(spiral).collect(),
            (0..4000).map(grid).collect(),
            (0..3000).map(flat).collect(),
        ];
        for places in clouds {
            let near = Near::of(&places);
            for k in (0..places.len()).step_by(97) {
                let mut all: Vec<f64> = places.iter().map(|&p| dist_sq(p, places[k])).collect();
                all.sort_by(f64::total_cmp);
                let found = near.nearest(places[k], 24);
                assert_eq!(found.len(), 24);
                for (n, truth) in found.iter().zip(&all) {
                    assert_eq!(n.0, *truth);
                    assert_eq!(n.0, dist_sq(places[n.1 as usize], places[k]));
                }
            }
        }
    }
}
