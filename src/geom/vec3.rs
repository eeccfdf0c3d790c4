//! The handful of vector operations the pipeline needs, on `[f64; 3]`.

use super::Point;

/// `a - b`.
#[inline]
pub fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + b`.
#[inline]
pub fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a * k`.
#[inline]
pub fn scale(a: Point, k: f64) -> Point {
    [a[0] * k, a[1] * k, a[2] * k]
}

/// The dot product, the same to the last bit however the axes are permuted
/// or mirrored: the products are added from the smallest up.
#[inline]
pub fn dot(a: Point, b: Point) -> f64 {
    let (x, y, z) = (a[0] * b[0], a[1] * b[1], a[2] * b[2]);
    let (low, high) = (x.min(y), x.max(y));
    (low.min(z) + high.min(low.max(z))) + high.max(z)
}

/// The cross product.
#[inline]
pub fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The squared length.
#[inline]
pub fn norm_sq(a: Point) -> f64 {
    dot(a, a)
}

/// The length.
#[inline]
pub fn norm(a: Point) -> f64 {
    norm_sq(a).sqrt()
}

/// The vector of unit length that way, whatever its own length; zero if it has none.
pub fn direction(way: Point) -> Point {
    let most = way.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let way = way.map(|c| c / most);
    match norm(way) {
        length if length.is_finite() && most > 0.0 && most.is_finite() => scale(way, 1.0 / length),
        _ => [0.0; 3],
    }
}

/// The squared distance from `a` to `b`.
#[inline]
pub fn dist_sq(a: Point, b: Point) -> f64 {
    norm_sq(sub(a, b))
}

/// Products and lengths summed in the order of the axes: five times faster
/// than [`dot`], for values that need not turn with the axes to the last bit.
pub mod plain {
    use super::Point;

    /// The dot product.
    #[inline]
    pub fn dot(a: Point, b: Point) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// The squared length.
    #[inline]
    pub fn norm_sq(a: Point) -> f64 {
        dot(a, a)
    }

    /// The length.
    #[inline]
    pub fn norm(a: Point) -> f64 {
        norm_sq(a).sqrt()
    }

    /// The squared distance from `a` to `b`.
    #[inline]
    pub fn dist_sq(a: Point, b: Point) -> f64 {
        norm_sq(super::sub(a, b))
    }

    /// The larger of two numbers.
    #[inline]
    pub fn larger(a: f64, b: f64) -> f64 {
        if a > b {
            a
        } else {
            b
        }
    }

    /// The smaller of two numbers.
    #[inline]
    pub fn smaller(a: f64, b: f64) -> f64 {
        if a < b {
            a
        } else {
            b
        }
    }
}
