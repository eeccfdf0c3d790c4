//! How two triangles meet, decided exactly.
//!
//! The intersection of two triangles is compared with what they share: the
//! corners at equal positions (none, one vertex, an edge). All decisions are
//! signs of determinants of the corners; nothing is constructed.
//!
//! 1. The signs of each triangle's corners against the other's plane. All on
//!    one strict side: disjoint. All zero: coplanar, step 3.
//! 2. Both triangles meet the line of the two planes in an interval. An end
//!    of an interval is a point of an edge with one end above the other
//!    triangle's plane (or on it) and one below (or on it, not both). For an
//!    edge pq of the one and rs of the other, the sign of orient3d(p, q, r, s)
//!    orders the ends along the line up to one common sign: with the line as
//!    x axis and the two planes as xy and xz, row operations turn the
//!    determinant into (x of rs - x of pq) times (height of pq) times (height
//!    of rs) times a constant. The four signs between the two ends of the one
//!    and the two of the other tell how the intervals lie.
//! 3. Coplanar triangles are projected along an axis that keeps their area;
//!    two convex polygons have disjoint interiors just when a line through an
//!    edge of one of them separates them, and are disjoint just when such a
//!    line separates them strictly.

use super::frame::{drop_axis, Kernel};
use crate::geom::vec3::plain::{larger, norm, smaller};
use crate::geom::vec3::{add, scale, sub};
use crate::geom::Point;

/// How two triangles of positive area meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Contact {
    /// They have no point in common.
    Disjoint,
    /// They meet in a common vertex or a common edge and nowhere else.
    Shared,
    /// Their interiors do not meet, but they have more in common than their
    /// corners at equal positions.
    Touching,
    /// Their interiors meet: they pierce or overlap.
    Crossing,
}

/// For each corner of the first triangle the corner of the second at the same
/// position.
pub(super) type Twins = [Option<u8>; 3];

/// How triangles `a` and `b`, both of positive area, meet. `twins` must list
/// exactly the corners at equal positions.
pub(super) fn contact(kernel: Kernel, a: &[Point; 3], b: &[Point; 3], twins: &Twins) -> Contact {
    let shared = twins.iter().flatten().count();
    if shared == 3 {
        return Contact::Crossing;
    }
    let apart = match shared {
        0 => Contact::Disjoint,
        _ => Contact::Shared,
    };
    let above_b = |i: usize| match twins[i] {
        Some(_) => 0,
        None => kernel.orient3d(b[0], b[1], b[2], a[i]),
    };
    if kernel != Kernel::Extreme && shared < 2 && apart_at(a, b, twins) {
        return apart;
    }
    let signs_a = [above_b(0), above_b(1), above_b(2)];
    if one_side(&signs_a, shared) {
        return apart;
    }
    if signs_a == [0; 3] {
        return coplanar(kernel, a, b, twins, shared);
    }
    let above_a = |j: usize| match twins.contains(&Some(j as u8)) {
        true => 0,
        false => kernel.orient3d(a[0], a[1], a[2], b[j]),
    };
    let signs_b = [above_a(0), above_a(1), above_a(2)];
    if one_side(&signs_b, shared) {
        return apart;
    }
    let (span_a, span_b) = (Span::new(signs_a), Span::new(signs_b));
    let (mut less, mut more) = (0, 0);
    for p in &span_a.ends {
        for q in &span_b.ends {
            let same = match (p.corner, q.corner) {
                (Some(i), Some(j)) => twins[i as usize] == Some(j),
                _ => false,
            };
            if !same {
                let order = kernel.orient3d(
                    a[p.upper as usize],
                    a[p.lower as usize],
                    b[q.upper as usize],
                    b[q.lower as usize],
                );
                less += (order < 0) as u32;
                more += (order > 0) as u32;
            }
        }
    }
    if less == 4 || more == 4 {
        return Contact::Disjoint;
    }
    let overlap = less > 0 && more > 0;
    if overlap && span_a.inner && span_b.inner {
        return Contact::Crossing;
    }
    let point = !overlap || span_a.point || span_b.point;
    match shared {
        2 => Contact::Shared,
        1 if point => Contact::Shared,
        _ => Contact::Touching,
    }
}

/// Whether a plane surely separates two triangles that share at most a corner
/// (through that corner, if there is one): a filter before anything exact. The
/// plane stands across the line between their middles.
fn apart_at(a: &[Point; 3], b: &[Point; 3], twins: &Twins) -> bool {
    let corner = twins.iter().position(|t| t.is_some());
    let at = a[corner.unwrap_or(0)];
    let (u, v) = (a.map(|p| sub(p, at)), b.map(|p| sub(p, at)));
    let sum = |t: &[Point; 3]| add(add(t[0], t[1]), t[2]);
    let (mut s, mut t) = (sum(&u), sum(&v));
    if corner.is_some() {
        // Seen from the corner only the directions count.
        let (m, n) = (norm(s), norm(t));
        (s, t) = (scale(s, n), scale(t, m));
    }
    let normal = sub(s, t);
    // The differences and each product are off by less than 2^-52 of their
    // size, the sums by as much again.
    let heights = |t: &[Point; 3], skip: Option<usize>| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in (0..3).filter(|&k| Some(k) != skip) {
            let products: Point = std::array::from_fn(|i| normal[i] * t[k][i]);
            let size = products[0].abs() + products[1].abs() + products[2].abs();
            let height = products[0] + products[1] + products[2];
            let off = 1e-15 * size + 1e-300;
            low = smaller(low, height - off);
            high = larger(high, height + off);
        }
        (low, high)
    };
    let same = corner.and_then(|k| twins[k]).map(usize::from);
    let (low, _) = heights(&u, corner);
    let (_, high) = heights(&v, same);
    match corner {
        Some(_) => low > 0.0 && high < 0.0,
        None => low > high,
    }
}

/// Whether all corners that are not shared lie strictly on one side, so that
/// nothing but the shared vertex or edge lies in the other's plane.
fn one_side(signs: &[i8; 3], shared: usize) -> bool {
    let above = signs.iter().filter(|&&s| s > 0).count();
    let below = signs.iter().filter(|&&s| s < 0).count();
    above == 3 - shared || below == 3 - shared
}

/// What a triangle cuts out of the line of two planes.
struct Span {
    ends: [End; 2],
    /// The line passes through the triangle's interior.
    inner: bool,
    /// Both ends are the same corner.
    point: bool,
}

/// One end of a span: where the edge from `upper` to `lower` meets the line.
#[derive(Clone, Copy)]
struct End {
    upper: u8,
    lower: u8,
    /// The corner that the end is, if it is one.
    corner: Option<u8>,
}

impl Span {
    /// From the signs of the corners, which are not all zero and not all on
    /// one strict side.
    fn new(signs: [i8; 3]) -> Span {
        let edge = |i: usize, j: usize, corner: Option<usize>| {
            let (upper, lower) = match signs[i] > signs[j] {
                true => (i as u8, j as u8),
                false => (j as u8, i as u8),
            };
            End {
                upper,
                lower,
                corner: corner.map(|c| c as u8),
            }
        };
        let zeros = signs.iter().filter(|&&s| s == 0).count();
        // The corner that differs: alone on its side, on the line, or off it.
        let odd = match zeros {
            0 => (0..3).find(|&i| signs[i] != signs[(i + 1) % 3] && signs[i] != signs[(i + 2) % 3]),
            1 => signs.iter().position(|&s| s == 0),
            _ => signs.iter().position(|&s| s != 0),
        };
        let i = odd.unwrap_or(0);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        match zeros {
            0 => Span {
                ends: [edge(i, j, None), edge(i, k, None)],
                inner: true,
                point: false,
            },
            1 if signs[j] != signs[k] => Span {
                ends: [edge(i, j, Some(i)), edge(j, k, None)],
                inner: true,
                point: false,
            },
            1 => Span {
                ends: [edge(i, j, Some(i)); 2],
                inner: false,
                point: true,
            },
            _ => Span {
                ends: [edge(j, i, Some(j)), edge(k, i, Some(k))],
                inner: false,
                point: false,
            },
        }
    }
}

/// Step 3: triangles of one plane.
fn coplanar(
    kernel: Kernel,
    a: &[Point; 3],
    b: &[Point; 3],
    twins: &Twins,
    shared: usize,
) -> Contact {
    let Some(axis) = kernel.projection(a) else {
        return Contact::Disjoint; // not reached for triangles with an area
    };
    let flat = |t: &[Point; 3]| t.map(|p| drop_axis(p, axis));
    let (fa, fb) = (flat(a), flat(b));
    let same = |i: usize, j: usize| twins[i] == Some(j as u8);
    let mut line = None;
    for (p, q, swapped) in [(&fa, &fb, false), (&fb, &fa, true)] {
        let turn = kernel.orient2d(p[0], p[1], p[2]);
        let equal = |i: usize, j: usize| if swapped { same(j, i) } else { same(i, j) };
        for i in 0..3 {
            let next = (i + 1) % 3;
            let side = |j: usize| match equal(i, j) || equal(next, j) {
                true => 0,
                false => turn * kernel.orient2d(p[i], p[next], q[j]),
            };
            let sides = [side(0), side(1), side(2)];
            if sides.iter().all(|&s| s < 0) {
                return Contact::Disjoint;
            }
            if line.is_none() && sides.iter().all(|&s| s <= 0) {
                line = Some((p[i], p[next], q, sides));
            }
        }
    }
    // All they have in common lies on the separating line, if there is one.
    let Some((u, v, q, sides)) = line else {
        return Contact::Crossing;
    };
    if shared == 2 {
        return Contact::Shared;
    }
    let along = (u[0] == v[0]) as usize;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for j in (0..3).filter(|&j| sides[j] == 0) {
        low = low.min(q[j][along]);
        high = high.max(q[j][along]);
    }
    let low = low.max(u[along].min(v[along]));
    let high = high.min(u[along].max(v[along]));
    match shared == 1 && low >= high {
        true => Contact::Shared,
        false => Contact::Touching,
    }
}
