//! The orientation of four sites.

use super::wide::Wide;
use super::{Counts, Sign, Site};

/// Filter: with exact differences and u = 2^-53, a 2 by 2 minor errs by at
/// most 2.01 u times its permanent, the sum of three products with it by at most 5.01 u
/// times the permanent of the matrix, itself at most 6 mx my mz: 30.1 u in
/// all, for which 2^-48 = 32 u stands.
const FILTER: f64 = 3.552_713_678_800_501e-15;

/// A row of a determinant.
type Row = [f64; 3];

#[inline]
fn minus(a: &Site, b: &Site) -> Row {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The sign of `det(b-a, c-a, d-a)`.
#[inline]
pub fn orient(a: &Site, b: &Site, c: &Site, d: &Site, counts: &mut Counts) -> Sign {
    sign(minus(b, a), minus(c, a), minus(d, a), counts)
}

/// A facet of the positive cell that has the site strictly on its other side;
/// facet `known` is known to have it on this side.
#[inline]
pub fn separating(cell: [&Site; 4], p: &Site, known: usize, counts: &mut Counts) -> Option<usize> {
    let [a, b, c, d] = [
        minus(cell[0], p),
        minus(cell[1], p),
        minus(cell[2], p),
        minus(cell[3], p),
    ];
    // The facets as in `tetra::FACETS`, counterclockwise seen from outside.
    if known != 0 && sign(b, c, d, counts) == Sign::Negative {
        Some(0)
    } else if known != 1 && sign(a, d, c, counts) == Sign::Negative {
        Some(1)
    } else if known != 2 && sign(a, b, d, counts) == Sign::Negative {
        Some(2)
    } else if known != 3 && sign(a, c, b, counts) == Sign::Negative {
        Some(3)
    } else {
        None
    }
}

/// The sign of the determinant of three rows.
#[inline]
fn sign(b: Row, c: Row, d: Row, counts: &mut Counts) -> Sign {
    let value = b[0] * (c[1] * d[2] - c[2] * d[1])
        + b[1] * (c[2] * d[0] - c[0] * d[2])
        + b[2] * (c[0] * d[1] - c[1] * d[0]);
    let largest = |k: usize| b[k].abs().max(c[k].abs()).max(d[k].abs());
    let bound = FILTER * largest(0) * largest(1) * largest(2);
    if value.abs() > bound {
        counts.orient_filter += 1;
        return if value > 0.0 {
            Sign::Positive
        } else {
            Sign::Negative
        };
    }
    counts.orient_exact += 1;
    exact([b, c, d])
}

#[cold]
#[inline(never)]
fn exact(rows: [Row; 3]) -> Sign {
    let mut whole = [[0i64; 3]; 3];
    let mut wide = 0;
    for k in 0..3 {
        for axis in 0..3 {
            whole[k][axis] = rows[k][axis] as i64;
            wide |= whole[k][axis].unsigned_abs();
        }
    }
    // Coordinates on a coarse grid are multiples of a power of two.
    let zeros = wide.trailing_zeros().min(63);
    let [b, c, d] = whole.map(|row| row.map(|v| v >> zeros));
    let bits = (64 - wide.leading_zeros()).saturating_sub(zeros);
    if 3 * bits + 3 <= 63 {
        let value = b[0] * (c[1] * d[2] - c[2] * d[1])
            + b[1] * (c[2] * d[0] - c[0] * d[2])
            + b[2] * (c[0] * d[1] - c[1] * d[0]);
        return Sign::of(i128::from(value));
    }
    let [b, c, d] = [b, c, d].map(|row| row.map(i128::from));
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
        fn agrees_with_robust_on_coarse_grids(p in prop::array::uniform4(site(9)), zeros in 0..42) {
            let p = p.map(|s| s.map(|v| v * 2f64.powi(zeros)));
            let mut counts = Counts::default();
            prop_assert_eq!(orient(&p[0], &p[1], &p[2], &p[3], &mut counts), oracle(p));
        }

        /// The facet found has the site strictly behind it; with none found no
        /// facet has.
        #[test]
        fn separating_agrees_with_the_orientation(p in prop::array::uniform5(site(4)), known in 0usize..5) {
            let mut counts = Counts::default();
            let cell = [&p[0], &p[1], &p[2], &p[3]];
            prop_assume!(orient(cell[0], cell[1], cell[2], cell[3], &mut counts) == Sign::Positive);
            let behind: Vec<usize> = (0..4)
                .filter(|&i| {
                    let mut replaced = cell;
                    replaced[i] = &p[4];
                    let sign = orient(replaced[0], replaced[1], replaced[2], replaced[3], &mut counts);
                    i != known && sign == Sign::Negative
                })
                .collect();
            prop_assert_eq!(separating(cell, &p[4], known, &mut counts), behind.first().copied());
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
