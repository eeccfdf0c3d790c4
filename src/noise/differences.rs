//! What differences between neighbours say about noise.
//!
//! What noise leaves at a sample says nothing about what it leaves at the next, where shape leaves
//! much the same. So half the mean square of the differences between nearest neighbours is the
//! variance of noise alone (von Neumann, 1941; Rice, 1984), and of shape a part that rises
//! with the square of the distance between them.

use crate::geom::vec3::dist_sq;
use crate::geom::Point;

/// Half the mean square of the differences of heights between nearest neighbours, and the mean
/// square of the distances between those.
pub(super) fn differences(places: &[Point], heights: &[f64]) -> (f64, f64) {
    let mut nearest = vec![(f64::INFINITY, 0); places.len()];
    for (s, &from) in places.iter().enumerate() {
        for (t, &to) in places.iter().enumerate().skip(s + 1) {
            let way = dist_sq(from, to);
            for (one, other) in [(s, t), (t, s)] {
                if way < nearest[one].0 {
                    nearest[one] = (way, other);
                }
            }
        }
    }
    let (mut squares, mut ways) = (0.0, 0.0);
    for (s, &(way, t)) in nearest.iter().enumerate() {
        squares += (heights[s] - heights[t]).powi(2);
        ways += way;
    }
    let count = places.len() as f64;
    (squares / (2.0 * count), ways / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_differs_from_the_nearest() {
        let places = [0.0, 1.0, 3.0, 3.5].map(|x| [x, 0.0, 0.0]);
        // 0 and 1 are nearest to each other, and so are the other two.
        let (half, way) = differences(&places, &[1.0, 2.0, 5.0, 8.0]);
        assert_eq!(half, (1.0 + 1.0 + 9.0 + 9.0) / 8.0);
        assert_eq!(way, (1.0 + 1.0 + 0.25 + 0.25) / 4.0);
    }
}
