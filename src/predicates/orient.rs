//! The orientation of four sites.

use super::wide::Wide;
use super::{Counts, Sign, Site};

/// The sign of `det(b-a, c-a, d-a)`.
///
/// Filter: with exact differences and u = 2^-53, a 2 by 2 minor errs by at
/// most 2.01 u times its permanent, the sum of three products with it by at most 5.01 u
/// times the permanent of the matrix, itself at most 6 mx my mz: 30.1 u in
/// all, for which 2^-48 = 32 u stands.
#[inline]
pub fn orient(a: &Site, b: &Site, c: &Site, d: &Site, counts: &mut Counts) -> Sign {
    let (bx, by, bz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    let (cx, cy, cz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
    let (dx, dy, dz) = (d[0] - a[0], d[1] - a[1], d[2] - a[2]);
    let value = bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx);
    let largest = |p: f64, q: f64, r: f64| p.abs().max(q.abs()).max(r.abs());
    let bound =
        3.552_713_678_800_501e-15 * largest(bx, cx, dx) * largest(by, cy, dy) * largest(bz, cz, dz);
    if value > bound {
        counts.orient_filter += 1;
        return Sign::Positive;
    }
    if value < -bound {
        counts.orient_filter += 1;
        return Sign::Negative;
    }
    counts.orient_exact += 1;
    exact([[bx, by, bz], [cx, cy, cz], [dx, dy, dz]])
}

#[cold]
#[inline(never)]
fn exact(rows: [[f64; 3]; 3]) -> Sign {
    let [b, c, d] = rows.map(|row| row.map(|v| v as i128));
    let x = c[1] * d[2] - c[2] * d[1];
    let y = c[2] * d[0] - c[0] * d[2];
    let z = c[0] * d[1] - c[1] * d[0];
    Wide::product(x, b[0])
        .plus(Wide::product(y, b[1]))
        .plus(Wide::product(z, b[2]))
        .sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::LIMIT;
    use proptest::prelude::*;

    fn site(range: i64) -> impl Strategy<Value = Site> {
        prop::array::uniform3(-range..=range)
            .prop_map(|p| [p[0] as f64, p[1] as f64, p[2] as f64, 0.0])
    }

    fn oracle(p: [Site; 4]) -> Sign {
        let q = p.map(|s| robust::Coord3D {
            x: s[0],
            y: s[1],
            z: s[2],
        });
        // `robust` calls `det(a-d, b-d, c-d)` positive: the mirror of ours.
        let value = robust::orient3d(q[0], q[1], q[2], q[3]);
        if value == 0.0 {
            Sign::Zero
        } else if value < 0.0 {
            Sign::Positive
        } else {
            Sign::Negative
        }
    }

    proptest! {
        #[test]
        fn agrees_with_robust_on_tiny_integers(p in prop::array::uniform4(site(3))) {
            let mut counts = Counts::default();
            let ours = orient(&p[0], &p[1], &p[2], &p[3], &mut counts);
            prop_assert_eq!(ours, oracle(p));
        }

        #[test]
        fn agrees_with_robust_near_a_plane(p in prop::array::uniform4(site(LIMIT as i64)), k in -2i64..=2) {
            // d on the plane of a, b, c up to k lattice steps.
            let mut p = p.map(|s| s.map(|v| (v / 4.0).trunc()));
            for axis in 0..3 {
                p[3][axis] = p[0][axis] + (p[1][axis] - p[0][axis]) - (p[2][axis] - p[0][axis]);
            }
            p[3][0] += k as f64;
            prop_assume!(p[3].iter().all(|v| v.abs() <= LIMIT));
            let mut counts = Counts::default();
            prop_assert_eq!(orient(&p[0], &p[1], &p[2], &p[3], &mut counts), oracle(p));
        }
    }

    #[test]
    fn the_unit_corner_is_positive() {
        let mut counts = Counts::default();
        let o = [0.0; 4];
        let (x, y, z) = (
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        );
        assert_eq!(orient(&o, &x, &y, &z, &mut counts), Sign::Positive);
        assert_eq!(orient(&o, &y, &x, &z, &mut counts), Sign::Negative);
        assert_eq!(orient(&o, &x, &y, &y, &mut counts), Sign::Zero);
    }
}
