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
const FILTER: f64 = 336.0 * 1.110_223_024_625_156_5e-16;

#[inline]
fn test<const WEIGHTED: bool>(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    let d = cell.map(|v| [v[0] - p[0], v[1] - p[1], v[2] - p[2]]);
    let mut lift = [0.0; 4];
    let mut size = 0.0f64;
    for k in 0..4 {
        let square = d[k][0] * d[k][0] + d[k][1] * d[k][1] + d[k][2] * d[k][2];
        if WEIGHTED {
            let gain = cell[k][3] - p[3];
            lift[k] = square - gain;
            size = size.max(square + gain.abs());
        } else {
            lift[k] = square;
            size = size.max(square);
        }
    }
    let [a, b, c, e] = d;
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
    let value = (lift[0] * bce - lift[1] * cea) + (lift[2] * eab - lift[3] * abc);
    let largest = |k: usize| a[k].abs().max(b[k].abs()).max(c[k].abs().max(e[k].abs()));
    let bound = FILTER * largest(0) * largest(1) * largest(2) * size;
    if value > bound {
        counts.sphere_filter += 1;
        return true;
    }
    if value < -bound {
        counts.sphere_filter += 1;
        return false;
    }
    match exact::<WEIGHTED>(&d, cell, p) {
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

/// The same determinant in integers, as narrow as the differences allow.
#[inline(never)]
fn exact<const WEIGHTED: bool>(d: &[[f64; 3]; 4], cell: [&Site; 4], p: &Site) -> Sign {
    let [a, b, c, e] = d.map(|row| row.map(|v| v as i128));
    let mut lift = [0i128; 4];
    let mut highest = 0;
    let mut widest = 0;
    for (k, row) in [a, b, c, e].iter().enumerate() {
        lift[k] = row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
        if WEIGHTED {
            lift[k] -= cell[k][3] as i128 - p[3] as i128;
        }
        highest |= lift[k].unsigned_abs();
        widest |= (row[0].unsigned_abs() | row[1].unsigned_abs()) | row[2].unsigned_abs();
    }
    let bits = 128 - widest.leading_zeros();
    let lift_bits = 128 - highest.leading_zeros();
    let ab = a[0] * b[1] - b[0] * a[1];
    let bc = b[0] * c[1] - c[0] * b[1];
    let ce = c[0] * e[1] - e[0] * c[1];
    let ea = e[0] * a[1] - a[0] * e[1];
    let ac = a[0] * c[1] - c[0] * a[1];
    let be = b[0] * e[1] - e[0] * b[1];
    if bits <= 41 {
        // A minor is a sum of six products: 3 * 41 + 3 bits.
        let abc = a[2] * bc - b[2] * ac + c[2] * ab;
        let bce = b[2] * ce - c[2] * be + e[2] * bc;
        let cea = c[2] * ea + e[2] * ac + a[2] * ce;
        let eab = e[2] * ab + a[2] * be + b[2] * ea;
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
    let abc = minor((bc, a[2]), (ac, -b[2]), (ab, c[2]));
    let bce = minor((ce, b[2]), (be, -c[2]), (bc, e[2]));
    let cea = minor((ea, c[2]), (ac, e[2]), (ce, a[2]));
    let eab = minor((ab, e[2]), (be, a[2]), (ea, b[2]));
    bce.times(lift[0])
        .minus(cea.times(lift[1]))
        .plus(eab.times(lift[2]))
        .minus(abc.times(lift[3]))
        .sign()
}

/// The sign of `Q` when every weight is raised by an infinitesimal, a later
/// site's beyond all earlier ones'. Raising `p` raises `Q`; raising a corner
/// lowers `Q` by the corner's barycentric coordinate at `p`, whose sign is
/// that of the cell with the corner replaced by `p`.
#[cold]
#[inline(never)]
fn perturbed(cell: [&Site; 4], p: &Site, counts: &mut Counts) -> bool {
    let mut order = [0usize, 1, 2, 3, 4];
    let site = |k: usize| if k == 4 { p } else { cell[k] };
    order.sort_unstable_by(|&i, &j| {
        if precedes(site(i), site(j)) {
            std::cmp::Ordering::Greater
        } else if precedes(site(j), site(i)) {
            std::cmp::Ordering::Less
        } else {
            std::cmp::Ordering::Equal
        }
    });
    for k in order {
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
