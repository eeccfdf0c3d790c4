//! Centres of cells: Voronoi vertices (circumcentres) and power vertices
//! (orthocentres) by one formula. Constructions, never used to decide.
//!
//! With rows `v - a` and right-hand sides `k_v = |v - a|² - w_v + w_a` the
//! centre is `a + (k_u v×w + k_v w×u + k_w u×v) / (2 det(u, v, w))`. It is
//! computed in floats with a bound on its error, and from the exact integers
//! in twice the precision where that bound is above what the caller tolerates:
//! flat cells are where centres go wrong.

use crate::geom::vec3::{add, cross, dot, scale};
use crate::geom::Point;
use crate::predicates::wide::Wide;
use crate::predicates::Site;

/// A centre, in the units of the sites, with a bound on its error.
#[derive(Clone, Copy, Debug)]
pub struct Centre {
    /// Position.
    pub position: Point,
    /// No coordinate is off by more than this.
    pub error: f64,
}

/// The point of equal power to four sites (their circumcentre when the
/// weights are equal), each coordinate to within `tolerance` or to within
/// rounding of the result, whichever is larger. The sites must not be coplanar.
pub fn circumcentre(sites: [&Site; 4], tolerance: f64) -> Centre {
    let quick = in_floats(sites);
    if quick.error <= tolerance {
        quick
    } else {
        in_integers(sites)
    }
}

/// The circumcentre rounded to multiples of `step`. Where the error of the
/// floats could change the outcome the integers decide, so it is the same
/// however the axes are permuted or mirrored.
pub fn rounded_circumcentre(sites: [&Site; 4], step: f64) -> Point {
    let round = |v: f64| (v / step).round_ties_even() * step + 0.0;
    let quick = in_floats(sites);
    let sure = quick.error.is_finite()
        && quick
            .position
            .iter()
            .all(|&v| round(v - quick.error) == round(v + quick.error));
    if sure {
        quick.position.map(round)
    } else {
        in_integers(sites).position.map(round)
    }
}

fn rows(sites: [&Site; 4]) -> ([Point; 3], [f64; 3], [f64; 3]) {
    let a = sites[0];
    let mut rows = [[0.0; 3]; 3];
    let mut sides = [0.0; 3];
    let mut sizes = [0.0; 3];
    for k in 0..3 {
        let v = sites[k + 1];
        rows[k] = [v[0] - a[0], v[1] - a[1], v[2] - a[2]];
        let square = dot(rows[k], rows[k]);
        let gain = v[3] - a[3];
        sides[k] = square - gain;
        sizes[k] = square + gain.abs();
    }
    (rows, sides, sizes)
}

fn in_floats(sites: [&Site; 4]) -> Centre {
    let ([u, v, w], k, sizes) = rows(sites);
    let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
    let det = 2.0 * dot(u, vw);
    let mut offset = [0.0; 3];
    for axis in 0..3 {
        offset[axis] = (k[0] * vw[axis] + k[1] * wu[axis] + k[2] * uv[axis]) / det;
    }
    // Permanents bound the rounding: 5.01 u on the determinant, 9.02 u on the
    // numerators; both taken as 12 u, together with the division.
    let abs = |p: Point| p.map(f64::abs);
    let permanent = |p: Point, q: Point| {
        let (p, q) = (abs(p), abs(q));
        [
            p[1] * q[2] + p[2] * q[1],
            p[2] * q[0] + p[0] * q[2],
            p[0] * q[1] + p[1] * q[0],
        ]
    };
    let (pvw, pwu, puv) = (permanent(v, w), permanent(w, u), permanent(u, v));
    let below = 2.0 * dot(abs(u), pvw);
    let mut error = 0.0f64;
    const U12: f64 = 12.0 * 1.110_223_024_625_156_5e-16;
    for axis in 0..3 {
        let above = sizes[0] * pvw[axis] + sizes[1] * pwu[axis] + sizes[2] * puv[axis];
        error = error.max(U12 * (above + offset[axis].abs() * below) / det.abs());
    }
    let position = add([sites[0][0], sites[0][1], sites[0][2]], offset);
    // A determinant of the size of its own error bounds nothing.
    if det.abs() <= 4.0 * U12 * below {
        error = f64::INFINITY;
    }
    Centre { position, error }
}

#[cold]
#[inline(never)]
fn in_integers(sites: [&Site; 4]) -> Centre {
    let ([u, v, w], _, _) = rows(sites);
    let [iu, iv, iw] = [u, v, w].map(|row| row.map(|x| x as i128));
    let mut k = [0i128; 3];
    for (side, (row, site)) in k.iter_mut().zip([iu, iv, iw].iter().zip(&sites[1..])) {
        *side = row.iter().map(|x| x * x).sum::<i128>() - site[3] as i128 + sites[0][3] as i128;
    }
    let cross = |p: [i128; 3], q: [i128; 3]| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let (vw, wu, uv) = (cross(iv, iw), cross(iw, iu), cross(iu, iv));
    let combine = |p: (i128, i128), q: (i128, i128), r: (i128, i128)| {
        Wide::product(p.0, p.1)
            .plus(Wide::product(q.0, q.1))
            .plus(Wide::product(r.0, r.1))
    };
    let det = combine((vw[0], iu[0]), (vw[1], iu[1]), (vw[2], iu[2]));
    let det = det.plus(det).to_double();
    let mut position = [0.0; 3];
    for axis in 0..3 {
        let above = combine((vw[axis], k[0]), (wu[axis], k[1]), (uv[axis], k[2]));
        let (high, low) = divide(above.to_double(), det);
        // The site is an integer below 2^47: adding the parts from the small
        // end keeps what the sum can hold.
        position[axis] = (sites[0][axis] + high) + low;
    }
    let largest = scale(position, f64::EPSILON).map(f64::abs);
    Centre {
        position,
        error: largest[0].max(largest[1]).max(largest[2]),
    }
}

/// Quotient of two unevaluated sums, to about 2^-100 of itself.
fn divide(n: (f64, f64), d: (f64, f64)) -> (f64, f64) {
    let first = n.0 / d.0;
    let product = first * d.0;
    let error = first.mul_add(d.0, -product);
    let rest = ((n.0 - product) - error) + (n.1 - first * d.1);
    let second = rest / d.0;
    let sum = first + second;
    (sum, second - (sum - first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_integers_agree() {
        let mut state = 7u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            ((state >> 20) as i64 % (1 << 40)) as f64
        };
        for _ in 0..2000 {
            let mut site = || [next(), next(), next(), next().abs()];
            let s = [site(), site(), site(), site()];
            let refs = [&s[0], &s[1], &s[2], &s[3]];
            let (a, b) = (in_floats(refs), in_integers(refs));
            for axis in 0..3 {
                let off = (a.position[axis] - b.position[axis]).abs();
                assert!(off <= a.error + b.error, "{off} {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_needle_keeps_its_centre() {
        // Four points on a great circle, the last a step off its plane: the
        // determinant is tiny, the centre known.
        let r = (1u64 << 40) as f64;
        let s = [
            [r, 0.0, 0.0, 0.0],
            [0.0, r, 0.0, 0.0],
            [-r, 0.0, 0.0, 0.0],
            [0.0, -r, 1.0, 0.0],
        ];
        let c = circumcentre([&s[0], &s[1], &s[2], &s[3]], 1e-3);
        // x = y = 0 by symmetry; the last site asks for 2 z = 1.
        assert!(c.position[0].abs() < 1e-3 && c.position[1].abs() < 1e-3);
        assert!((c.position[2] - 0.5).abs() < 1e-3, "{c:?}");
    }
}
