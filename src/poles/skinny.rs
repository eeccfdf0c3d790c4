//! The skinniness test of section 6.1: is a Voronoi cell long and thin?
//!
//! By Lemma 1 every Voronoi vertex `x` of a sample `s` whose direction makes
//! an angle `beta > lambda` with the normal gives a lower bound on the local
//! feature size, `|x - s| sin(beta - lambda) / lambda`. Each of them holds, so
//! the tightest is the *largest*: the `min` in the printed formula cannot be
//! meant (at the pole itself beta is 0 and the bound negative). A pole
//! nearer than the bound contradicts Lemma 2: the cell is misshapen there.

use crate::geom::vec3::{dot, norm, sub};
use crate::geom::Point;

/// The lower bound on the local feature size at `s`, given the direction to
/// its first pole and its Voronoi vertices. Angles are taken to the line of
/// the normal: acute.
pub fn feature_size_bound(
    s: Point,
    pole: Point,
    vertices: impl Iterator<Item = Point>,
    lambda: f64,
) -> f64 {
    let normal = sub(pole, s);
    let length = norm(normal);
    let mut bound = 0.0f64;
    for x in vertices {
        let to = sub(x, s);
        let distance = norm(to);
        if distance == 0.0 || length == 0.0 {
            continue;
        }
        let cosine = (dot(to, normal) / (distance * length)).abs().min(1.0);
        let beta = cosine.acos();
        if beta > lambda {
            bound = bound.max(distance * (beta - lambda).sin() / lambda);
        }
    }
    bound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skinny_cell_passes_and_a_round_one_fails() {
        let s = [0.0; 3];
        let pole = [0.0, 0.0, 1.0];
        let ring = |r: f64| {
            (0..8).map(move |k| {
                let a = k as f64 * std::f64::consts::FRAC_PI_4;
                [r * a.cos(), r * a.sin(), 0.0]
            })
        };
        // A thin cell: side vertices at 0.01, bound 0.01 sin(pi/2 - 0.1) / 0.1.
        let thin = feature_size_bound(s, pole, ring(0.01), 0.1);
        assert!((thin - 0.1 * (0.1f64).cos()).abs() < 1e-12);
        assert!(thin < 1.0);
        assert!(feature_size_bound(s, pole, ring(0.5), 0.1) > 1.0);
    }
}
