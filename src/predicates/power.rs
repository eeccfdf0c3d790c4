//! Does a site conflict with a cell: is it inside the cell's sphere
//! (unweighted) or does it have negative power to the cell's orthosphere
//! (weighted)? One determinant serves both.
//!
//! With rows `(v - p, |v - p|² - w_v + w_p)` for the corners `v` of a positive
//! cell, the determinant is `-V·Q`, where `V` is six times the cell's volume
//! and `Q` the height of the cell's lifted plane at `p` less the lifted height
//! of `p`: the site conflicts when `Q > 0`.

use super::wide::Wide;
use super::{orient, precedes, Counts, Sign, Site};

/// Does `p` lie inside the circumsphere of the positive cell `abcd`? Weights
/// are taken as equal; ties are broken by perturbation.
#[inline]
pub fn conflict(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    test::<false>(cell, p, counts)
}

/// Does `p` have negative power to the orthosphere of the positive cell
/// `abcd`? Ties are broken by perturbation.
#[inline]
pub fn conflict_weighted(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    test::<true>(cell, p, counts)
}

/// Filter: a lifted difference errs by at most 4.01 u (|d|² + |w_v - w_p|), a
/// 3 by 3 minor by 5.01 u times its permanent, their product by 10.1 u, the sum of four by
/// 13.1 u times 24 mx my mz ml: 315 u in all, for which 2^-44.6 = 336 u stands.
/// Here u = 2^-53, mx, my, mz are the largest differences along the axes and ml is
/// the largest |d|² + |w_v - w_p|.
const FILTER: f64 = 336.0 * 1.110_223_024_625_156_5e-16;

/// The rows of the determinant.
#[derive(Clone, Copy)]
struct Rows {
    /// Differences, exact.
    d: [[f64; 3]; 4],
    /// Lifted differences, rounded.
    lift: [f64; 4],
    /// The largest |d|².
    square: f64,
    /// The largest |d|² + |w_v - w_p|.
    size: f64,
}

#[inline]
fn test<const WEIGHTED: bool>(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    let mut rows = Rows {
        d: [[0.0; 3]; 4],
        lift: [0.0; 4],
        square: 0.0,
        size: 0.0,
    };
    for k in 0..4 {
        let v = cell[k];
        let d = [v[0] - p[0], v[1] - p[1], v[2] - p[2]];
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        rows.d[k] = d;
        rows.square = rows.square.max(square);
        if WEIGHTED {
            let gain = v[3] - p[3];
            rows.lift[k] = square - gain;
            rows.size = rows.size.max(square + gain.abs());
        } else {
            rows.lift[k] = square;
            rows.size = rows.square;
        }
    }
    let [a, b, c, e] = rows.d;
    let ab = a[0] * b[1] - b[0] * a[1];
    let bc = b[0] * c[1] - c[0] * b[1];
    let ce = c[0] * e[1] - e[0] * c[1];
    let ea = e[0] * a[1] - a[0] * e[1];
    let ac = a[0] * c[1] - c[0] * a[1];
    let be = b[0] * e[1] - e[0] * b[1];
    let abc = a[2] * bc - b[2] * ac + c[2] * ab;
    let bce = b[2] * ce - c[2] * be + e[2] * bc;
    let cea = c[2] * ea + e[2] * ac + a[2] * ce;
    let eab = e[2] * ab + a[2] * be + b[2] * ea;
    // Q·V: minus the determinant expanded along the lifted column.
    let [la, lb, lc, le] = rows.lift;
    let value = (la * bce - lb * cea) + (lc * eab - le * abc);
    // The three largest differences are each at most the root of the largest
    // square: a bound without roots and without looking at each.
    let bound_sq =
        (FILTER * FILTER) * (rows.square * rows.size) * (rows.square * rows.size) * rows.square;
    if value * value > bound_sq {
        counts.sphere_filter += 1;
        return value > 0.0;
    }
    undecided::<WEIGHTED>(&rows, value, cell, p, counts)
}

/// The stages after the first bound: the bound along the axes, integers,
/// perturbation.
#[inline(never)]
fn undecided<const WEIGHTED: bool>(
    rows: &Rows,
    value: f64,
    cell: [&Site; 4],
    p: &Site,
    counts: &mut Counts,
) -> bool {
    let largest = |k: usize| rows.d.iter().fold(0.0f64, |m, d| m.max(d[k].abs()));
    let bound = FILTER * largest(0) * largest(1) * largest(2) * rows.size;
    if value.abs() > bound {
        counts.sphere_filter += 1;
        return value > 0.0;
    }
    match exact::<WEIGHTED>(&rows.d, cell, p) {
        Sign::Zero => {
            counts.sphere_perturbed += 1;
            perturbed(cell, p, counts)
        }
        sign => {
            counts.sphere_exact += 1;
            sign == Sign::Positive
        }
    }
}

/// The product of two integers of 64 bits.
#[inline]
fn mul(a: i64, b: i64) -> i128 {
    i128::from(a) * i128::from(b)
}

/// An integer held in a float.
#[inline]
fn whole(v: f64) -> i128 {
    const NARROW: f64 = 9e18;
    if v.abs() < NARROW {
        i128::from(v as i64)
    } else {
        v as i128
    }
}

/// The same determinant in integers, as narrow as the differences allow.
fn exact<const WEIGHTED: bool>(d: &[[f64; 3]; 4], cell: [&Site; 4], p: &Site) -> Sign {
    let mut rows = [[0i64; 3]; 4];
    let mut gains = [0i128; 4];
    let (mut wide, mut gain) = (0, 0);
    for k in 0..4 {
        let row = [d[k][0] as i64, d[k][1] as i64, d[k][2] as i64];
        wide |= row[0].unsigned_abs() | row[1].unsigned_abs() | row[2].unsigned_abs();
        rows[k] = row;
        if WEIGHTED {
            gains[k] = whole(cell[k][3]) - whole(p[3]);
            gain |= gains[k].unsigned_abs();
        }
    }
    // Coordinates on a coarse grid, as integers and short decimals are, are
    // multiples of a power of two.
    let zeros = wide.trailing_zeros().min(gain.trailing_zeros() / 2).min(63);
    let bits = (64 - wide.leading_zeros()).saturating_sub(zeros);
    let mut lift = [0i128; 4];
    let mut high = 0;
    for k in 0..4 {
        let row = rows[k].map(|v| v >> zeros);
        lift[k] = mul(row[0], row[0]) + mul(row[1], row[1]) + mul(row[2], row[2]);
        if WEIGHTED {
            lift[k] -= gains[k] >> (2 * zeros);
        }
        high |= lift[k].unsigned_abs();
        rows[k] = row;
    }
    let lift_bits = 128 - high.leading_zeros();
    if 3 * bits + 3 + lift_bits + 2 <= 63 {
        return narrow(&rows, lift.map(|v| v as i64));
    }
    let [a, b, c, e] = rows;
    let ab = mul(a[0], b[1]) - mul(b[0], a[1]);
    let bc = mul(b[0], c[1]) - mul(c[0], b[1]);
    let ce = mul(c[0], e[1]) - mul(e[0], c[1]);
    let ea = mul(e[0], a[1]) - mul(a[0], e[1]);
    let ac = mul(a[0], c[1]) - mul(c[0], a[1]);
    let be = mul(b[0], e[1]) - mul(e[0], b[1]);
    let [az, bz, cz, ez] = [a[2], b[2], c[2], e[2]].map(i128::from);
    if bits <= 41 {
        // A minor is a sum of six products: 3 * 41 + 3 bits.
        let abc = az * bc - bz * ac + cz * ab;
        let bce = bz * ce - cz * be + ez * bc;
        let cea = cz * ea + ez * ac + az * ce;
        let eab = ez * ab + az * be + bz * ea;
        if 3 * bits + 3 + lift_bits + 2 <= 126 {
            let value = (lift[0] * bce - lift[1] * cea) + (lift[2] * eab - lift[3] * abc);
            return Sign::of(value);
        }
        return Wide::product(bce, lift[0])
            .minus(Wide::product(cea, lift[1]))
            .plus(Wide::product(eab, lift[2]))
            .minus(Wide::product(abc, lift[3]))
            .sign();
    }
    let minor = |x: (i128, i128), y: (i128, i128), z: (i128, i128)| {
        Wide::product(x.0, x.1)
            .plus(Wide::product(y.0, y.1))
            .plus(Wide::product(z.0, z.1))
    };
    let abc = minor((bc, az), (ac, -bz), (ab, cz));
    let bce = minor((ce, bz), (be, -cz), (bc, ez));
    let cea = minor((ea, cz), (ac, ez), (ce, az));
    let eab = minor((ab, ez), (be, az), (ea, bz));
    bce.times(lift[0])
        .minus(cea.times(lift[1]))
        .plus(eab.times(lift[2]))
        .minus(abc.times(lift[3]))
        .sign()
}

/// The determinant where 64 bits hold it.
fn narrow(rows: &[[i64; 3]; 4], lift: [i64; 4]) -> Sign {
    let [a, b, c, e] = rows;
    let ab = a[0] * b[1] - b[0] * a[1];
    let bc = b[0] * c[1] - c[0] * b[1];
    let ce = c[0] * e[1] - e[0] * c[1];
    let ea = e[0] * a[1] - a[0] * e[1];
    let ac = a[0] * c[1] - c[0] * a[1];
    let be = b[0] * e[1] - e[0] * b[1];
    let abc = a[2] * bc - b[2] * ac + c[2] * ab;
    let bce = b[2] * ce - c[2] * be + e[2] * bc;
    let cea = c[2] * ea + e[2] * ac + a[2] * ce;
    let eab = e[2] * ab + a[2] * be + b[2] * ea;
    let value = (lift[0] * bce - lift[1] * cea) + (lift[2] * eab - lift[3] * abc);
    Sign::of(i128::from(value))
}

/// The sign of `Q` when every weight is raised by an infinitesimal, a later
/// site's beyond all earlier ones'. Raising `p` raises `Q`; raising a corner
/// lowers `Q` by the corner's barycentric coordinate at `p`, whose sign is
/// that of the cell with the corner replaced by `p`.
#[cold]
#[inline(never)]
fn perturbed(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    let site = |k: usize| if k == 4 { p } else { cell[k] };
    let mut rest = [0usize, 1, 2, 3, 4];
    for len in (1..=5).rev() {
        // The last in the order among those not yet asked, of equals a corner.
        let mut last = 0;
        for k in 1..len {
            let (a, b) = (rest[last], rest[k]);
            if precedes(site(a), site(b)) || (a == 4 && !precedes(site(b), site(a))) {
                last = k;
            }
        }
        let k = rest[last];
        rest.swap(last, len - 1);
        if k == 4 {
            return true;
        }
        let mut replaced = cell;
        replaced[k] = p;
        match orient(replaced[0], replaced[1], replaced[2], replaced[3], counts) {
            Sign::Positive => return false,
            Sign::Negative => return true,
            Sign::Zero => {}
        }
    }
    // All four replaced cells are flat only if the cell itself is.
    debug_assert!(false, "a flat cell was tested");
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn site(range: i64, weight: i64) -> impl Strategy<Value = Site> {
        (prop::array::uniform3(-range..=range), 0..=weight)
            .prop_map(|(p, w)| [p[0] as f64, p[1] as f64, p[2] as f64, w as f64])
    }

    fn positive(mut p: [Site; 5], counts: &mut Counts) -> Option<[Site; 5]> {
        match orient(&p[0], &p[1], &p[2], &p[3], counts) {
            Sign::Zero => None,
            Sign::Positive => Some(p),
            Sign::Negative => {
                p.swap(0, 1);
                Some(p)
            }
        }
    }

    /// The determinant without filters, in 256 bits, rows not translated.
    fn plain(p: &[Site; 5]) -> Sign {
        let mut rows = [[0i128; 4]; 4];
        for k in 0..4 {
            for axis in 0..3 {
                rows[k][axis] = p[k][axis] as i128 - p[4][axis] as i128;
            }
            let square: i128 = rows[k][..3].iter().map(|v| v * v).sum();
            rows[k][3] = square - p[k][3] as i128 + p[4][3] as i128;
        }
        // Laplace expansion along the first row.
        let det3 = |r: [usize; 3], c: [usize; 3]| {
            let m = |i: usize, j: usize| rows[r[i]][c[j]];
            let mut sum = Wide::ZERO;
            for (i, j, k, sign) in [
                (0, 1, 2, 1),
                (1, 2, 0, 1),
                (2, 0, 1, 1),
                (0, 2, 1, -1),
                (1, 0, 2, -1),
                (2, 1, 0, -1),
            ] {
                sum = sum.plus(Wide::product(sign * m(0, i), m(1, j)).times(m(2, k)));
            }
            sum
        };
        det3([1, 2, 3], [1, 2, 3])
            .times(rows[0][0])
            .minus(det3([1, 2, 3], [0, 2, 3]).times(rows[0][1]))
            .plus(det3([1, 2, 3], [0, 1, 3]).times(rows[0][2]))
            .minus(det3([1, 2, 3], [0, 1, 2]).times(rows[0][3]))
            .negated()
            .sign()
    }

    fn compare(p: [Site; 5]) -> Result<(), TestCaseError> {
        let mut counts = Counts::default();
        let Some(p) = positive(p, &mut counts) else {
            return Ok(());
        };
        let ours = conflict_weighted([&p[0], &p[1], &p[2], &p[3]], &p[4], &mut counts);
        match plain(&p) {
            Sign::Positive => prop_assert!(ours),
            Sign::Negative => prop_assert!(!ours),
            Sign::Zero => prop_assert_eq!(counts.sphere_perturbed, 1),
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn agrees_with_the_plain_determinant(p in prop::array::uniform5(site(4, 20))) {
            compare(p)?;
        }

        #[test]
        fn agrees_on_coarse_grids(p in prop::array::uniform5(site(40, 1600)), zeros in 0..40) {
            let unit = 2f64.powi(zeros);
            compare(p.map(|s| [s[0] * unit, s[1] * unit, s[2] * unit, s[3] * unit * unit]))?;
            compare(p.map(|s| [s[0] * unit, s[1] * unit, s[2] * unit, s[3]]))?;
        }

        #[test]
        fn agrees_at_the_limit_of_the_range(p in prop::array::uniform5(site(1 << 46, 1 << 60))) {
            compare(p)?;
        }

        #[test]
        fn agrees_in_the_middle_of_the_range(p in prop::array::uniform5(site(1 << 40, 1 << 50))) {
            compare(p)?;
        }

        #[test]
        fn agrees_with_robust_without_weights(p in prop::array::uniform5(site(3, 0))) {
            let mut counts = Counts::default();
            if let Some(p) = positive(p, &mut counts) {
                let q = p.map(|s| robust::Coord3D { x: s[0], y: s[1], z: s[2] });
                let value = robust::insphere(q[0], q[1], q[2], q[3], q[4]);
                let ours = conflict([&p[0], &p[1], &p[2], &p[3]], &p[4], &mut counts);
                if value != 0.0 {
                    // `robust` orients tetrahedra the other way round.
                    prop_assert_eq!(ours, value < 0.0);
                } else {
                    prop_assert_eq!(counts.sphere_perturbed, 1);
                }
            }
        }

        /// Perturbation is consistent: of five cospherical sites without flat
        /// quadruples, the perturbed triangulation is one of the two possible ones,
        /// whichever cell asks.
        #[test]
        fn perturbation_does_not_depend_on_the_order_of_corners(p in prop::array::uniform5(site(2, 0)), s in 0usize..12) {
            let mut counts = Counts::default();
            if let Some(p) = positive(p, &mut counts) {
                let even = [[0,1,2,3],[1,2,0,3],[2,0,1,3],[1,0,3,2],[0,3,1,2],[3,1,0,2],[2,3,0,1],[3,0,2,1],[0,2,3,1],[3,2,1,0],[2,1,3,0],[1,3,2,0]];
                let base = conflict([&p[0], &p[1], &p[2], &p[3]], &p[4], &mut counts);
                let o = even[s];
                prop_assert_eq!(base, conflict([&p[o[0]], &p[o[1]], &p[o[2]], &p[o[3]]], &p[4], &mut counts));
            }
        }
    }

    #[test]
    fn inside_conflicts_and_outside_does_not() {
        let mut counts = Counts::default();
        let cell = [
            &[0.0, 0.0, 0.0, 0.0],
            &[4.0, 0.0, 0.0, 0.0],
            &[0.0, 4.0, 0.0, 0.0],
            &[0.0, 0.0, 4.0, 0.0],
        ];
        assert!(conflict(cell, &[1.0, 1.0, 1.0, 0.0], &mut counts));
        assert!(!conflict(cell, &[9.0, 9.0, 9.0, 0.0], &mut counts));
        assert!(conflict_weighted(
            cell,
            &[9.0, 9.0, 9.0, 400.0],
            &mut counts
        ));
    }
}
