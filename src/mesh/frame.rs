//! Exact signs for the vertices of one mesh.
//!
//! [`Frame`] brings the vertices to magnitude one by a power of two, which
//! changes no sign and rounds nothing, and picks the arithmetic that is exact
//! for them. Each predicate first tries one floating-point evaluation with a
//! proven error bound.

use super::wide;
use crate::geom::vec3::{cross, sub};
use crate::geom::Point;
use rayon::prelude::*;
use robust::{Coord, Coord3D};

/// Binary orders below the largest magnitude down to which every bit of every
/// coordinate may lie for the expansions of `robust` to be exact: products of
/// three multiples of 2^-340 are multiples of 2^-1020, a representable number.
const LATTICE: i32 = -340;

/// Shewchuk's bound for a 3 x 3 determinant of differences, a little enlarged.
const BOUND_3D: f64 = 7.8e-16;
/// The same for a 2 x 2 determinant.
const BOUND_2D: f64 = 3.4e-16;
/// Covers underflow in the filters, where all magnitudes are below one.
const UNDERFLOW: f64 = 1e-300;

/// Vertices scaled by a power of two so that magnitudes lie below one.
pub(super) struct Frame {
    /// The scaled vertices; vertices that are not finite are at the origin.
    pub points: Vec<Point>,
    /// Which arithmetic decides signs for them.
    pub kernel: Kernel,
    /// `points` are the vertices times this.
    inward: Shift,
    outward: Shift,
    /// Times two to this power magnitudes lie below one, whatever is rounded.
    unit: i32,
    sizes: Shift,
}

/// The arithmetic that decides signs, by the range of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kernel {
    /// All bits within 340 binary orders: filter, then expansions.
    Lattice,
    /// Smaller bits occur: filter, then long integers.
    Wide,
    /// Scaling would round: long integers on the coordinates as they are.
    Extreme,
}

impl Frame {
    /// The frame in which signs are exact.
    pub fn new(vertices: &[Point]) -> Frame {
        Frame::with(vertices, false)
    }

    /// The frame in which lengths are within range; bits far below the
    /// largest magnitude may be rounded away.
    pub fn rounded(vertices: &[Point]) -> Frame {
        Frame::with(vertices, true)
    }

    fn with(vertices: &[Point], round: bool) -> Frame {
        let (top, low) = (vertices.par_iter().flatten().copied())
            .filter_map(bits)
            .reduce(|| (i32::MIN, i32::MAX), |a, b| (a.0.max(b.0), a.1.min(b.1)));
        let (exponent, kernel) = match (top, low) {
            (i32::MIN, _) => (0, Kernel::Lattice),
            _ if low - top >= LATTICE => (-top, Kernel::Lattice),
            _ if round || low - top >= -1074 => (-top, Kernel::Wide),
            _ => (0, Kernel::Extreme),
        };
        let unit = if top == i32::MIN { 0 } else { -top };
        let inward = Shift::by(exponent);
        let points = (vertices.par_iter())
            .map(|p| match p.iter().all(|x| x.is_finite()) {
                true => p.map(|x| inward.of(x)),
                false => [0.0; 3],
            })
            .collect();
        Frame {
            points,
            kernel,
            inward,
            outward: Shift::by(-exponent),
            unit,
            sizes: Shift::by(unit),
        }
    }

    /// A point of the mesh's units in the frame's.
    pub fn enter(&self, p: Point) -> Point {
        p.map(|x| self.inward.of(x))
    }

    /// A length of the frame in the mesh's units.
    pub fn leave(&self, length: f64) -> f64 {
        self.outward.of(length)
    }

    /// A point in units in which no size overflows, and none that matters
    /// underflows. They are those of the frame, but for [`Kernel::Extreme`].
    pub fn enter_sizes(&self, p: Point) -> Point {
        p.map(|x| self.sizes.of(x))
    }

    /// The power of two that takes volumes of the mesh's units to those.
    pub fn volume_unit(&self) -> i32 {
        3 * self.unit
    }

    /// A length (1), area (2) or volume (3) in those units, in the mesh's. Out
    /// of the range of doubles it is the nearest of its sign.
    pub fn leave_size(&self, size: f64, dimension: u32) -> f64 {
        let own = (0..dimension).fold(size, |x, _| shift(x, -self.unit));
        match own {
            0.0 if size != 0.0 => f64::from_bits(1).copysign(size),
            _ if own.is_infinite() && size.is_finite() => f64::MAX.copysign(size),
            _ => own,
        }
    }
}

/// The power of two above the highest bit of a finite number that is not
/// zero, and that of the lowest.
fn bits(x: f64) -> Option<(i32, i32)> {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let (whole, unit) = match ((bits >> 52) & 0x7ff) as i32 {
        0 => (fraction, -1074),
        0x7ff => return None,
        field => (fraction | 1 << 52, field - 1075),
    };
    let high = unit + 64 - whole.leading_zeros() as i32;
    (whole != 0).then_some((high, unit + whole.trailing_zeros() as i32))
}

/// `x` times two to the power `e`, for powers beyond the range of doubles too.
pub(super) fn shift(x: f64, e: i32) -> f64 {
    Shift::by(e).of(x)
}

/// Multiplication by a power of two, in three steps.
#[derive(Clone, Copy)]
struct Shift(f64, f64);

impl Shift {
    fn by(e: i32) -> Shift {
        let third = e / 3;
        Shift(2f64.powi(third), 2f64.powi(e - 2 * third))
    }

    fn of(&self, x: f64) -> f64 {
        x * self.0 * self.0 * self.1
    }
}

fn sign(x: f64) -> i8 {
    (x > 0.0) as i8 - (x < 0.0) as i8
}

impl Kernel {
    /// The sign of `det(a - d, b - d, c - d)`: positive when `d` sees `a`,
    /// `b`, `c` turn clockwise.
    pub fn orient3d(self, a: Point, b: Point, c: Point, d: Point) -> i8 {
        if self == Kernel::Extreme {
            return wide::orient3d(a, b, c, d);
        }
        let (u, v, w) = (sub(a, d), sub(b, d), sub(c, d));
        let (vw, wv) = (v[0] * w[1], w[0] * v[1]);
        let (wu, uw) = (w[0] * u[1], u[0] * w[1]);
        let (uv, vu) = (u[0] * v[1], v[0] * u[1]);
        let det = u[2] * (vw - wv) + v[2] * (wu - uw) + w[2] * (uv - vu);
        let size = u[2].abs() * (vw.abs() + wv.abs())
            + v[2].abs() * (wu.abs() + uw.abs())
            + w[2].abs() * (uv.abs() + vu.abs());
        let bound = BOUND_3D * size + UNDERFLOW;
        if det.abs() > bound {
            return sign(det);
        }
        if self == Kernel::Wide {
            return wide::orient3d(a, b, c, d);
        }
        if size == 0.0 {
            return 0; // nothing underflows on the lattice
        }
        let at = |p: Point| Coord3D {
            x: p[0],
            y: p[1],
            z: p[2],
        };
        sign(robust::orient3d(at(a), at(b), at(c), at(d)))
    }

    /// The sign of `det(a - c, b - c)`: positive when `a`, `b`, `c` turn left.
    pub fn orient2d(self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
        if self == Kernel::Extreme {
            return wide::orient2d(a, b, c);
        }
        let left = (a[0] - c[0]) * (b[1] - c[1]);
        let right = (a[1] - c[1]) * (b[0] - c[0]);
        let det = left - right;
        let size = left.abs() + right.abs();
        if det.abs() > BOUND_2D * size + UNDERFLOW {
            return sign(det);
        }
        if self == Kernel::Wide {
            return wide::orient2d(a, b, c);
        }
        if size == 0.0 {
            return 0;
        }
        let at = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
        sign(robust::orient2d(at(a), at(b), at(c)))
    }

    /// The axis to drop so that the triangle keeps an area, the dominant one
    /// of its normal where that can be told; `None` for zero area.
    pub fn projection(self, t: &[Point; 3]) -> Option<usize> {
        let n = cross(sub(t[1], t[0]), sub(t[2], t[0])).map(f64::abs);
        let first = match () {
            () if n[2] >= n[0] && n[2] >= n[1] => 2,
            () if n[1] >= n[0] => 1,
            () => 0,
        };
        [first, (first + 1) % 3, (first + 2) % 3]
            .into_iter()
            .find(|&axis| {
                let [a, b, c] = t.map(|p| drop_axis(p, axis));
                self.orient2d(a, b, c) != 0
            })
    }
}

/// The point without one coordinate, the other two in cyclic order.
pub(super) fn drop_axis(p: Point, axis: usize) -> [f64; 2] {
    [p[(axis + 1) % 3], p[(axis + 2) % 3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernel_follows_the_range() {
        let mesh = |x: f64, y: f64| Frame::new(&[[x, y, 0.0]]).kernel;
        assert_eq!(mesh(0.0, 0.0), Kernel::Lattice);
        assert_eq!(mesh(1e300, 2e300), Kernel::Lattice);
        assert_eq!(mesh(1.0, 1e-80), Kernel::Lattice);
        assert_eq!(mesh(1.0, 1e-200), Kernel::Wide);
        assert_eq!(mesh(1e300, 1e-300), Kernel::Extreme);
        assert_eq!(mesh(f64::NAN, f64::INFINITY), Kernel::Lattice);
    }

    #[test]
    fn scaling_is_undone_at_both_ends_of_the_range() {
        for x in [f64::MAX, f64::MIN_POSITIVE, f64::from_bits(1), 3.0] {
            let frame = Frame::new(&[[x, 0.0, -x]]);
            let p = frame.points[0];
            assert!(p[0] >= 0.5 && p[0] < 1.0 && p[2] == -p[0]);
            assert_eq!(frame.leave(p[0]), x);
            assert_eq!(frame.enter([x, 0.0, -x]), p);
        }
    }

    #[test]
    fn every_kernel_gives_the_same_sign() {
        let third = 1.0 / 3.0;
        let a = [third, 0.2, 0.1];
        let b = [0.2, third, 0.7];
        let c = [0.9, 0.3, third];
        let d: Point = std::array::from_fn(|k| (a[k] + b[k]) / 2.0);
        for e in [a, d, [0.5, 0.5, 0.5]] {
            let [x, y, z] =
                [Kernel::Lattice, Kernel::Wide, Kernel::Extreme].map(|k| k.orient3d(a, b, c, e));
            assert!(x == y && y == z);
        }
    }
}
