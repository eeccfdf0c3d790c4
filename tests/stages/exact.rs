//! The definitions, in plain integers: determinants by expansion along a
//! column, conflicts by the whole lifted determinant, perturbation by one
//! determinant for each site, triangulations by trying every quadruple.

use powercrust::predicates::Site;

/// A site as integers: x, y, z, weight. Sizes up to about 2^20.
pub type Whole = [i128; 4];

pub fn whole(site: &Site) -> Whole {
    site.map(|v| v as i128)
}

/// The determinant, expanded along the first column.
fn det<const N: usize>(rows: [[i128; N]; N]) -> i128 {
    expand(&rows, 0, (1 << N) - 1)
}

/// The minor of the columns from `column` on and the rows in `left`.
fn expand<const N: usize>(rows: &[[i128; N]; N], column: usize, left: u32) -> i128 {
    let mut sum = 0;
    let mut sign = 1;
    for k in (0..N).filter(|k| left >> k & 1 == 1) {
        let factor = rows[k][column];
        if factor != 0 {
            let rest = left & !(1 << k);
            let minor = if rest == 0 {
                1
            } else {
                expand(rows, column + 1, rest)
            };
            sum += sign * factor * minor;
        }
        sign = -sign;
    }
    sum
}

/// Six times the signed volume of a tetrahedron.
pub fn six_volumes(v: [Whole; 4]) -> i128 {
    det([1, 2, 3].map(|k| [0, 1, 2].map(|axis| v[k][axis] - v[0][axis])))
}

/// Five sites' lifted determinant with the given heights. For a positive cell
/// and a site after it, the site lies below the cell's lifted plane when this
/// is positive.
fn lifted(v: [Whole; 5], heights: [i128; 5]) -> i128 {
    det([0, 1, 2, 3, 4].map(|k| [heights[k], v[k][0], v[k][1], v[k][2], 1]))
}

/// By how much the last site is in conflict with the positive cell before it,
/// times the cell's volume; zero when it lies on the orthosphere.
pub fn conflict(v: [Whole; 5]) -> i128 {
    let heights = v.map(|s| s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - s[3]);
    lifted(v, heights)
}

/// The same decision with every weight raised by an infinitesimal, a later
/// site's (in lexicographic order) beyond all earlier ones'.
pub fn conflicts(v: [Whole; 5]) -> bool {
    let strict = conflict(v);
    if strict != 0 {
        return strict > 0;
    }
    let mut order = [0, 1, 2, 3, 4];
    order.sort_by_key(|&k| std::cmp::Reverse(v[k]));
    for k in order {
        let mut heights = [0; 5];
        heights[k] = -1;
        let value = lifted(v, heights);
        if value != 0 {
            return value > 0;
        }
    }
    panic!("a flat cell");
}

/// A cell as the ascending list of its sites.
pub type Cell = [Whole; 4];

/// The regular triangulation by definition: of all quadruples that are not
/// flat, those with which no other site conflicts. Ascending.
pub fn cells(sites: &[Site]) -> Vec<Cell> {
    let sites: Vec<Whole> = sites.iter().map(whole).collect();
    let n = sites.len();
    let mut found = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                for d in c + 1..n {
                    let mut cell = [a, b, c, d].map(|k| sites[k]);
                    match six_volumes(cell) {
                        0 => continue,
                        v if v < 0 => cell.swap(0, 1),
                        _ => {}
                    }
                    let [p, q, r, s] = cell;
                    let empty = (0..n)
                        .filter(|k| ![a, b, c, d].contains(k))
                        .all(|k| !conflicts([p, q, r, s, sites[k]]));
                    if empty {
                        cell.sort_unstable();
                        found.push(cell);
                    }
                }
            }
        }
    }
    found.sort_unstable();
    found
}

#[test]
fn a_point_inside_a_sphere_conflicts() {
    let cell = [[0, 0, 0, 0], [4, 0, 0, 0], [0, 4, 0, 0], [0, 0, 4, 0]];
    assert_eq!(six_volumes(cell), 64);
    let [a, b, c, d] = cell;
    assert!(conflict([a, b, c, d, [1, 1, 1, 0]]) > 0);
    assert!(conflict([a, b, c, d, [5, 4, 4, 0]]) < 0);
    assert_eq!(conflict([a, b, c, d, [4, 4, 4, 0]]), 0);
    // The last of all five raises its own height most: it conflicts.
    assert!(conflicts([a, b, c, d, [4, 4, 4, 0]]));
}
